//! Guards against a figure or an outline that is not what the options ask for, and against bad input that is taken.

use std::fs;
use std::path::Path;

use darkness::Scene;
use darkness::isoradial::{CurveSpec, Isoradials};
use darkness::orbit::exact::Exact;
use darkness::render::coverage::render;
use darkness::scene::View;
use tempfile::tempdir;

use crate::harness::{done, listing, printed, refused, tool_prints};
use crate::tools;

fn text(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap()
}

#[test]
fn without_options_it_is_luminet_s_figure() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    done(here, &["isoradials"]);
    // No table is made.
    assert_eq!(listing(here), ["isoradials.svg"]);
    let svg = text(here, "isoradials.svg");
    assert_eq!(
        svg.matches("<path class=\"radius direct\" d=\"M").count(),
        4
    );
    assert_eq!(svg.matches("<path class=\"radius ghost\" d=\"M").count(), 4);
    assert_eq!(svg.matches('M').count(), 8);
    assert_eq!(svg.matches("Z\">").count(), 8);
    for radius in [3, 5, 10, 15] {
        for order in [0, 1] {
            assert!(svg.contains(&format!("<title>radius {radius}, order {order}</title>")));
        }
    }
    assert_eq!(printed(here, &["isoradials", "-o", "-"]), svg);
}

#[test]
fn quantities_orders_and_csv_are_chosen_by_options() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let options = [
        "isoradials",
        "classic",
        "--radius",
        "4,6",
        "--redshift",
        "0.9",
        "--flux",
        "0.5",
        "--orders",
        "3",
    ];
    let csv = printed(
        here,
        &[&options[..], &["-o", "-", "--format", "csv"]].concat(),
    );
    done(here, &[&options[..], &["-o", "all.csv"]].concat());
    assert_eq!(text(here, "all.csv"), csv);
    let mut kinds: Vec<String> = csv
        .lines()
        .skip(1)
        .map(|line| {
            line.split(',')
                .skip(1)
                .take(3)
                .collect::<Vec<_>>()
                .join(" ")
        })
        .collect();
    kinds.sort();
    kinds.dedup();
    let expected = ["flux 0.5", "radius 4", "radius 6", "redshift 0.9"];
    let expected = expected
        .iter()
        .flat_map(|kind| (0..3).map(move |order| format!("{kind} {order}")));
    assert_eq!(kinds, expected.collect::<Vec<_>>());
}

#[test]
fn a_picture_is_drawn_over() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    done(
        here,
        &["render", "classic", "--size", "96x54", "-o", "a.png"],
    );
    done(
        here,
        &["isoradials", "classic", "--over", "a.png", "-o", "over.svg"],
    );
    let svg = text(here, "over.svg");
    assert!(svg.contains(
        "<image width=\"1920\" height=\"1080\" href=\"data:image/png;base64,iVBORw0KGgo"
    ));
    for (args, words) in [
        (
            &["--over", "a.png", "--set", "image.width=1000"][..],
            "96 × 54",
        ),
        (&["--over", "a.png", "-o", "b.csv"], "--over"),
        (&["--over", "none.png"], "none.png"),
        (
            &["--over", "over.svg", "-o", "c.svg"],
            "needs a PNG picture",
        ),
        (
            &["--over", "over.svg", "-o", "over.svg"],
            "choose another file",
        ),
    ] {
        refused(
            here,
            &[&["isoradials", "classic"][..], args].concat(),
            2,
            &[words],
        );
    }
    assert_eq!(text(here, "over.svg"), svg);
}

#[test]
fn what_makes_no_sense_is_refused_with_a_sentence() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    for (args, word) in [
        (&["isoradials", "--radius", "1"][..], "radius"),
        (&["isoradials", "--radius", "three"], "a number above 1"),
        (&["isoradials", "--radius=-3"], "radius"),
        (&["isoradials", "--radius", "inf"], "radius"),
        (&["isoradials", "--redshift", "0"], "above 0"),
        (&["isoradials", "--redshift", "nan"], "above 0"),
        (&["isoradials", "--flux=-1"], "above 0"),
        (&["isoradials", "--orders", "0"], "1..=8"),
        (&["isoradials", "--orders", "9"], "1..=8"),
        (&["isoradials", "-o", "a.png"], "expected .svg or .csv"),
        (
            &["isoradials", "-o", "a.csv", "--format", "svg"],
            "expected .svg",
        ),
        (&["isoradials", "nowhere.toml"], "nowhere.toml"),
        (
            &["isoradials", "grid", "--redshift", "1"],
            "--redshift and --flux are of a disk",
        ),
        (&["isoradials", "--set", "camera.fov=0"], "fov"),
        (&["render", "grid", "-o", "a.svg"], "outline of the disk"),
        (
            &["render", "orbit", "-o", "a.svg"],
            "choose one with --frames",
        ),
        (&["render", "-o", "a.svg", "--layers", "radius"], "--layers"),
        (&["render", "-o", "a.svg", "--bits", "16"], "--bits"),
        (&["render", "-o", "a.svg", "--method", "exact"], "--method"),
        (&["render", "--explain", "--format", "svg"], ".svg"),
        (&["job", "openjd", "orbit", "-o", "out/f_####.svg"], ".svg"),
    ] {
        refused(here, args, 2, &[word]);
    }
    assert_eq!(listing(here), [""; 0]);
    done(here, &["isoradials", "grid", "--radius", "5"]);
}

#[test]
fn a_level_that_is_not_there_is_told() {
    let folder = tempdir().unwrap();
    let (output, stderr) = crate::harness::run(folder.path(), &["isoradials", "--redshift", "9"]);
    assert!(output.status.success());
    assert!(
        stderr.contains("redshift 9: the picture shows no such place"),
        "{stderr}"
    );
}

#[test]
fn render_writes_the_outline_of_a_frame() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    done(here, &["render", "-o", "disk.svg"]);
    assert_eq!(listing(here), ["disk.svg"]);
    let svg = text(here, "disk.svg");
    assert_eq!(svg.matches("<path fill=\"#fff\" d=\"M").count(), 1);
    assert_eq!(
        printed(here, &["render", "-o", "-", "--format", "svg"]),
        svg
    );
    done(
        here,
        &["render", "orbit", "--frames", "12", "-o", "f_####.svg"],
    );
    assert_eq!(listing(here), ["disk.svg", "f_0012.svg"]);
}

/// Another program fills the outline as the mask, within its antialiasing. rsvg-convert's rasteriser, cairo, draws
/// curves as lines that are right to 0.1 pixels, and counts 15 rows of a pixel. Here it draws them eight times as
/// large, so that an edge may be off by (0.1 + 1/15)/8 of a pixel: 5.3 of 255, and twice as much where a pixel has two
/// edges.
#[test]
fn an_outline_that_another_program_fills_is_the_mask() {
    const ZOOM: usize = 8;
    if !tools::has("rsvg-convert") {
        return;
    }
    let folder = tempdir().unwrap();
    let here = folder.path();
    for name in [
        "classic",
        "edge-on",
        "close-up",
        "inside",
        "photon-ring",
        "luminet",
    ] {
        let scene = Scene::builtin(name).unwrap().with_size(320, 180).unwrap();
        done(
            here,
            &["render", name, "--size", "320x180", "-o", "disk.svg"],
        );
        let zoom = ZOOM.to_string();
        let rasterise = ["rsvg-convert", "-z", &zoom, "disk.svg", "-o", "filled.png"];
        tool_prints(here, &rasterise);
        let filled = image::open(here.join("filled.png")).unwrap().to_luma8();
        let view = View::new(&scene);
        let curves = Isoradials::new(&CurveSpec::new(&scene, &view, 1e-3), &Exact);
        let mask = render(&view, &curves).unwrap();
        let (mut most, mut sum) = (0.0_f64, 0.0);
        for (i, &share) in mask.iter().enumerate() {
            let (left, top) = (i % 320 * ZOOM, i / 320 * ZOOM);
            let places = (0..ZOOM * ZOOM).map(|k| (left + k % ZOOM, top + k / ZOOM));
            let values = places.map(|(x, y)| f64::from(filled[(x as u32, y as u32)].0[0]));
            let off = (values.sum::<f64>() / (ZOOM * ZOOM) as f64 - f64::from(share)).abs();
            most = most.max(off);
            sum += off;
        }
        let mean = sum / mask.len() as f64;
        assert!(most <= 11.6 && mean < 0.1, "{name}: {most}, {mean}");
    }
}
