//! Guards against a pixel whose grey is not the share of its square that the disk covers: against the reference's 32 ×
//! 32 samples a pixel, against circles, and against shares found from the curves in another way (`shares.rs`),
//! over the built-in scenes and over random ones.

use std::path::Path;
use std::sync::Mutex;

use darkness::render::coverage;
use darkness::scene::{Scene, builtins};
use proptest::test_runner::{Config, TestCaseError, TestRng, TestRunner};

use crate::any_scene::{KINDS, any_scene};
use crate::shares::{Errors, LEVEL, Lattice, Picture, SWEPT, described};
use crate::tables::table;

/// What no picture may exceed, in parts of full scale: root mean square, worst pixel, mean.
///
/// An arc is off its edge by 1/512 of a pixel and its chords by 1/256 at most, along up to 1.4 pixels of two edges;
/// half a grey, 0.002, is rounded. Measured: 0.0007, 0.005, 0.0001.
const MOST: (f64, f64, f64) = (0.001, 0.01, 0.0002);

/// The same against the reference, whose 32 × 32 samples are themselves off by 0.016 at most.
const REFERENCE: (f64, f64, f64) = (0.0006, 0.018, 2e-5);

fn drawn(scene: &Scene) -> (Picture, Vec<u8>) {
    let picture = Picture::new(scene, &table("standard").lookup());
    let pixels = coverage::render(&picture.view, &picture.curves).unwrap();
    (picture, pixels)
}

fn builtin(name: &str, (width, height): (u32, u32)) -> Scene {
    let scene = Scene::builtin(name).unwrap();
    scene.with_size(width, height).unwrap()
}

fn assert_within(errors: &Errors, (rms, worst, bias): (f64, f64, f64), name: &str) {
    assert!(
        errors.rms <= rms && errors.worst <= worst && errors.bias.abs() <= bias,
        "{name}: {errors:?}"
    );
}

/// Guards against shares that only agree with curves of the program's own: the reference was computed in long double
/// by other means.
#[test]
fn the_reference_s_shares() {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference/masks/coverage-classic.toml");
    let scene = Scene::load(&path).unwrap();
    let known = image::open(path.with_extension("png")).unwrap().to_luma8();
    let known: Vec<f64> = known
        .into_raw()
        .iter()
        .map(|&value| f64::from(value) / 255.0)
        .collect();
    let (picture, pixels) = drawn(&scene);
    let errors = Errors::new(&pixels, &known, picture.width());
    errors.print("coverage-classic");
    assert_within(&errors, REFERENCE, "coverage-classic");

    // The truth of the other tests: two edges in a pixel may each hide half of a column of the reference's samples.
    let swept = picture.swept(&picture.orders());
    for (k, (swept, known)) in swept.iter().zip(&known).enumerate() {
        assert!(
            (swept - known).abs() <= 2.0 / 64.0 + LEVEL + SWEPT,
            "pixel {k}: {swept}, not {known}"
        );
    }
}

/// Guards against a truth that is wrong: swept and counted have nothing in common but the curves.
#[test]
fn both_truths_agree() {
    for scene in builtins() {
        let name = scene.name();
        let (picture, _) = drawn(&builtin(name, (97, 61)));
        let (swept, counted) = (
            picture.swept(&picture.orders()),
            picture.all_counted(Lattice::FINE),
        );
        let differences: Vec<f64> = swept.iter().zip(&counted).map(|(a, b)| a - b).collect();
        let worst = differences
            .iter()
            .fold(0.0, |most: f64, difference| most.max(difference.abs()));
        let mean = differences.iter().sum::<f64>() / differences.len() as f64;
        // Measured: 0.0064, 3.1e-6. What is left is the lattice's: on lattices of a fourth of the points it is 2.5
        // times that.
        assert!(
            worst < 0.01 && mean.abs() < 1e-5,
            "{name}: {worst}, {mean:e}"
        );
    }
}

#[test]
fn the_built_in_scenes() {
    for scene in builtins() {
        let name = scene.name();
        for size in [(240, 136), (97, 61), (61, 97)] {
            let (picture, pixels) = drawn(&builtin(name, size));
            let errors = Errors::new(&pixels, &picture.swept(&picture.orders()), picture.width());
            errors.print(&format!("{name}, {} × {}", size.0, size.1));
            assert_within(&errors, (MOST.0, 0.007, 5e-5), name);
            // One has no disk, and in a tall picture of the other most of the disk is beyond the side.
            let is_empty = name == "grid" || (name == "flyby" && size.0 < size.1);
            assert!(
                errors.edge > 100 || is_empty,
                "{name}: nothing to get wrong"
            );
        }
    }
}

/// Guards against a scene of a kind that nobody looked at: near and far, from inside the photon sphere, from the disk's
/// plane and axis, through long and wide lenses, threads of disks and disks below a pixel.
#[test]
fn random_scenes() {
    const CASES: u32 = 1500;
    let mut runner = TestRunner::new_with_rng(
        Config {
            cases: CASES,
            failure_persistence: None,
            ..Config::default()
        },
        TestRng::deterministic_rng(proptest::test_runner::RngAlgorithm::ChaCha),
    );
    let most: Mutex<[(f64, f64, f64, usize); KINDS.len()]> = Mutex::default();
    let outcome = runner.run(&any_scene(), |(kind, scene)| {
        let (picture, pixels) = drawn(&scene);
        let swept = picture.swept(&picture.orders());
        let errors = Errors::new(&pixels, &swept, picture.width());
        {
            let mut most = most.lock().unwrap();
            let of_kind = &mut most[KINDS.iter().position(|other| *other == kind).unwrap()];
            *of_kind = (
                of_kind.0.max(errors.rms),
                of_kind.1.max(errors.worst),
                of_kind.2.max(errors.bias.abs()),
                of_kind.3 + usize::from(errors.edge > 0),
            );
        }
        let (column, row) = errors.at;
        let counted = picture.counted(column, row, Lattice::FINE);
        let there = swept[row * picture.width() + column];
        // A thread thinner than the lattice is counted in jumps.
        if (counted - there).abs() > 0.02 {
            let told = format!(
                "the truths differ at {:?}: {counted}, {there}\n{}",
                errors.at,
                scene.to_toml()
            );
            return Err(TestCaseError::fail(told));
        }
        // The chords of a closed edge lie within it: by 2/3 of 1/256 of a pixel along all of it in the mean. An edge of
        // 200 pixels makes that half a pixel.
        let bias = MOST.2.max(1.0 / swept.len() as f64);
        if errors.rms > MOST.0 || errors.worst > MOST.1 || errors.bias.abs() > bias {
            return Err(TestCaseError::fail(format!(
                "{kind:?}: {errors:?}\n{}",
                scene.to_toml()
            )));
        }
        Ok(())
    });
    for (kind, (rms, worst, bias, seen)) in KINDS.iter().zip(most.into_inner().unwrap()) {
        println!(
            "{kind:?}: root mean square {rms:.5}, worst {worst:.4}, mean {bias:.6}, {seen} pictures with edges"
        );
        assert!(seen > 50, "{kind:?}: {seen} pictures with edges");
    }
    outcome.unwrap_or_else(|error| panic!("{error}"));
}

/// Guards against an edge that is straightened where it bends: circles of all radii from half a pixel on, seen from the
/// axis.
#[test]
fn circles_of_any_radius_keep_their_shares() {
    for step in 0..21 {
        let shadow = 0.4 * libm::pow(1.25, f64::from(step));
        // From 40 radii the shadow's edge is at tan ψ = 0.0645.
        let fov = 2.0 * libm::atan(0.0645 * 30.5 / shadow).to_degrees();
        let (x, y) = (0.013 * f64::from(step % 5), 0.02 * f64::from(step % 3));
        let text = described(
            [0.0, 0.0, 40.0],
            [x, y, 0.0],
            fov.min(150.0),
            (3.0, 12.0),
            (67, 61),
        );
        let (picture, pixels) = drawn(&Scene::from_toml(&text).unwrap());
        let swept = picture.swept(&picture.orders());
        let errors = Errors::new(&pixels, &swept, picture.width());
        // Ends of the images along columns: of every order its two circles, of all of them the smallest counts.
        let radii: Vec<f64> = picture
            .orders()
            .iter()
            .flat_map(|&order| picture.edges(order, 1.0).unwrap())
            .map(|kappa| 1.0 / (kappa * picture.view.pixel_side()))
            .collect();
        let least = radii.iter().copied().fold(f64::INFINITY, f64::min);
        println!(
            "R = {least:.2}: worst {:.4} at {:?}, mean {:+.6}",
            errors.worst, errors.at, errors.bias
        );
        assert!(errors.worst <= MOST.1, "R = {least}: {errors:?}");
    }
}

/// Guards against the sum of two images where they lie one upon the other, and against one image alone: the direct
/// image's inner edge crosses the first ring in front of the hole.
#[test]
fn where_two_orders_edges_share_a_pixel() {
    let (mut count, mut worst, mut squares, mut summed_squares, mut summed_worst) =
        (0, 0.0_f64, 0.0, 0.0, 0.0_f64);
    for height in [1.0, 3.0, 5.2, 8.0, 12.0, 20.0] {
        for (inner, outer) in [(3.0, 12.0), (3.0, 4.0), (5.0, 30.0)] {
            for size in [(97, 61), (240, 136), (400, 220)] {
                let text = described([29.0, 0.0, height], [0.0; 3], 22.0, (inner, outer), size);
                let scene = Scene::from_toml(&text).unwrap();
                let (picture, pixels) = drawn(&scene);
                let orders = picture.orders();
                let union = picture.swept(&orders);
                let each: Vec<Vec<f64>> = orders
                    .iter()
                    .map(|&order| picture.swept(&[order]))
                    .collect();
                for k in 0..union.len() {
                    let partial = each
                        .iter()
                        .filter(|shares| shares[k] > 0.02 && shares[k] < 0.98)
                        .count();
                    let sum: f64 = each.iter().map(|shares| shares[k]).sum();
                    if partial < 2 || sum - union[k] < 0.02 {
                        continue;
                    }
                    let error = f64::from(pixels[k]) / 255.0 - union[k];
                    let summed = sum.min(1.0) - union[k];
                    count += 1;
                    squares += error * error;
                    summed_squares += summed * summed;
                    worst = worst.max(error.abs());
                    summed_worst = summed_worst.max(summed);
                    assert!(error.abs() <= MOST.1, "{error} at pixel {k}\n{text}");
                }
            }
        }
    }
    let (rms, summed) = (
        (squares / f64::from(count)).sqrt(),
        (summed_squares / f64::from(count)).sqrt(),
    );
    println!(
        "{count} pixels: root mean square {rms:.5}, worst {worst:.4}; sums would be off by {summed:.4}, \
         {summed_worst:.4}"
    );
    assert!(
        count > 100 && summed_worst > 0.2,
        "{count} pixels, {summed_worst}"
    );
    // What an edge's bend makes of a pixel is the same whether it is alone in it.
    assert!(rms < 0.1 * summed, "{rms}, {summed}");
}

/// Guards against a disk seen from within a hundredth of its plane, whose direct image is a needle along a row, thinner
/// than a pixel's parts. There φ₁ runs through both quarter turns within a pixel: nothing is linear.
#[test]
fn needles_along_the_disks_plane() {
    let mut most = 0.0_f64;
    for radius in [30.0, 1e3, 1e5] {
        for rise in [1e-5, 1e-4, 1e-3, 3e-3, 1e-2] {
            for pixels in [20.0, 60.0, 90.0] {
                let fov = 2.0 * libm::atan(12.0 / radius / pixels * 61.0).to_degrees();
                let text = described(
                    [radius, 0.0, radius * rise],
                    [0.0, 0.1, 0.3],
                    fov,
                    (3.0, 12.0),
                    (97, 61),
                );
                for text in [text.clone(), text.replace("0.1, 0.2, 1.0", "0.0, 0.0, 1.0")] {
                    let (picture, pixels) = drawn(&Scene::from_toml(&text).unwrap());
                    let errors =
                        Errors::new(&pixels, &picture.swept(&picture.orders()), picture.width());
                    // A pixel is cut into sixteen rows: a needle in one of them has the light of none or of all of it.
                    assert_within(&errors, (MOST.0, 1.0 / 16.0, MOST.2), &text);
                    most = most.max(errors.worst);
                }
            }
        }
    }
    println!("worst {most:.4}");
    assert!(most > SWEPT, "no needle that is hard to draw");
}
