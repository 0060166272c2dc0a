use super::mark::sin_cos_half_turns;
use super::*;

/// The direction of a place.
fn direction([u, v]: [f64; 2]) -> DVec3 {
    let (sin_longitude, cos_longitude) = libm::sincos((0.5 - u) * 2.0 * PI);
    let (sin_latitude, cos_latitude) = libm::sincos((v - 0.5) * PI);
    DVec3::new(
        cos_latitude * cos_longitude,
        cos_latitude * sin_longitude,
        sin_latitude,
    )
}

/// What the grid shows in one place.
fn point(step: f64, behind: DVec3, place: [f64; 2]) -> [f64; 4] {
    let here = direction(place);
    for (centre, [red, green, blue]) in [(behind, BEHIND), (-behind, BEFORE)] {
        if here.angle_between(centre) <= RADIUS.to_radians() {
            return [red, green, blue, 1.0];
        }
    }
    let latitude = libm::asin(here.z).to_degrees();
    let longitude = libm::atan2(here.y, here.x).to_degrees();
    let cos_latitude = libm::cos(latitude.to_radians());
    let from_line = |x: f64, step: f64| (x - (x / step).round() * step).abs();
    let parallel = |step: f64| from_line(latitude, step) <= 0.5 * WIDTH;
    let half_width = (0.5 * WIDTH / cos_latitude).min(0.25 * step);
    let meridian = |step: f64| from_line(longitude, step) <= half_width;
    let [red, green, blue] = if parallel(180.0) || meridian(360.0) {
        AXIS
    } else if parallel(step) || meridian(step) {
        LINE
    } else {
        return [0.0; 4];
    };
    [red, green, blue, 1.0]
}

fn supersampled(
    step: f64,
    behind: DVec3,
    [place, x, y]: [[f64; 2]; 3],
    counts: [u32; 2],
) -> [f64; 4] {
    let mut sum = [0.0; 4];
    let [columns, rows] = counts;
    for i in 0..columns * rows {
        let part = |i: u32, count: u32| (f64::from(i) + 0.5) / f64::from(count) - 0.5;
        let (s, t) = (part(i % columns, columns), part(i / columns, rows));
        let sample = [0, 1].map(|axis| place[axis] + s * x[axis] + t * y[axis]);
        for (sum, value) in sum.iter_mut().zip(point(step, behind, sample)) {
            *sum += value / f64::from(columns * rows);
        }
    }
    sum
}

fn mean(grid: &Grid, footprint: [[f64; 2]; 3]) -> [f64; 4] {
    let [x, y] = [1, 2].map(|side| footprint[side].map(|value| value as f32));
    grid.mean(footprint[0], x, y).map(f64::from)
}

/// Numbers from 0 to 1 that fill a square evenly.
fn even(index: u32) -> [f64; 2] {
    [0.754_877_666_246_692_8, 0.569_840_290_998_053_2]
        .map(|share| (f64::from(index) * share).fract())
}

/// The root mean square and the greatest error over a patch of 32 × 32 pixels of this size in degrees, turned by some
/// angle.
fn errors(step: f64, behind: DVec3, centre: [f64; 2], size: [f64; 2], angle: f64) -> [f64; 2] {
    let grid = Grid::new(step, -behind, behind);
    let (sin, cos) = libm::sincos(angle);
    // Pixels are rectangles of this size on the sky at the patch's centre.
    let stretch = 1.0 / libm::sin(PI * centre[1]);
    let x = [cos * size[0] / 360.0 * stretch, sin * size[0] / 180.0];
    let y = [-sin * size[1] / 360.0 * stretch, cos * size[1] / 180.0];
    // At least twelve samples across a line.
    let counts = size.map(|size| ((size * 12.0 / WIDTH) as u32).max(16));
    let (mut sum, mut worst) = (0.0, 0.0_f64);
    for i in 0..32_u32 * 32 {
        let (s, t) = (f64::from(i % 32) - 15.5, f64::from(i / 32) - 15.5);
        let place = [0, 1].map(|axis| centre[axis] + s * x[axis] + t * y[axis]);
        if !(0.0..=1.0).contains(&place[1]) {
            continue;
        }
        let found = mean(&grid, [place, x, y]);
        let expected = supersampled(step, behind, [place, x, y], counts);
        for (found, expected) in found.into_iter().zip(expected) {
            let error = found - expected;
            sum += error * error / (4.0 * 32.0 * 32.0);
            worst = worst.max(error.abs());
        }
    }
    [sum.sqrt(), worst]
}

#[test]
fn agrees_with_supersampling() {
    let behind = direction([0.31, 0.56]);
    let places = [[0.5, 0.5], [0.31, 0.56], [0.02, 0.78], [0.81, 0.44]];
    let sizes = [
        [0.02, 0.02],
        [0.1, 0.07],
        [0.3, 0.3],
        [0.05, 0.8],
        [1.0, 0.1],
        [3.0, 0.2],
    ];
    for centre in places {
        for size in sizes {
            for angle in [0.0, 0.3, 0.8] {
                let [rms, worst] = errors(15.0, behind, centre, size, angle);
                println!("{centre:?} {size:?} {angle}: rms {rms:.4} worst {worst:.3}");
                assert!(rms <= 0.01, "{centre:?} {size:?} {angle}: rms {rms}");
            }
        }
    }
}

/// Across a line's edge the mean of small footprints is the share on its inner side: of a square along the edge it
/// rises evenly, and of one across its diagonal as a parabola does.
#[test]
fn edges_are_sharp_in_the_smallest_footprints() {
    let lines = |inside: f64, along| Lines::new(0.01 - inside, along, 0.01, 12.0).mean();
    for size in [1e-3, 1e-6, 1e-9, 1e-12] {
        for i in -6..=6 {
            let share = f64::from(i) / 8.0;
            let inside = share * size;
            // Places are known to a few units in the last digit of the half width.
            let tolerance = 1e-9_f64.max(1e-16 / size);
            let even = (0.5 + share).clamp(0.0, 1.0);
            let straight = [[size, 0.0], [0.0, -size]].map(|along| lines(inside, along));
            let corner = 0.5 * (1.0 - share.abs()) * (1.0 - share.abs());
            let parabola = if share > 0.0 { 1.0 - corner } else { corner };
            let oblique = [[size, size], [-size, size]].map(|along| lines(inside, along));
            for (found, expected) in straight
                .map(|found| (found, even))
                .into_iter()
                .chain(oblique.map(|found| (found, parabola)))
            {
                let off = (found - expected).abs();
                assert!(off <= tolerance, "{size} {share}: {found} {expected}");
            }
        }
    }
}

#[test]
fn wide_footprints_show_the_share_of_the_lines() {
    for step in [1.0, 5.0, 15.0, 60.0, 90.0] {
        let grid = Grid::new(step, DVec3::Z, -DVec3::Z);
        for index in 0..200 {
            let [u, v] = even(index);
            let cos_latitude = libm::sin(PI * v);
            let half = grid.meridian_widths.mean_half(v, 0.0);
            let share = (WIDTH / cos_latitude / step).min(MOST_MERIDIANS);
            // The widths' curve is a polygon; at a latitude of 89° a cell is a twelfth of the distance to the pole.
            if (0.05..0.95).contains(&v) {
                assert!(
                    (half * 720.0 / step - share).abs() < 1e-4 * share,
                    "{step} {v}"
                );
            }
            let one = Lines::new(u, [step / 360.0, 0.0], half, 360.0 / step).mean();
            assert!(
                (one - half * 720.0 / step).abs() < 1e-3 * share,
                "{step} {v} {one}"
            );
            let along = [17.3, 3.1].map(|steps| steps * step / 360.0);
            let many = Lines::new(u, along, half, 360.0 / step).mean();
            assert!(
                (many - half * 720.0 / step).abs() < 5e-3 * share,
                "{step} {v} {many}"
            );
        }
        // Many times around the sky, and where the extent has no bound.
        for extent in [7.7, 100.0, f32::INFINITY, f32::NAN] {
            let shown = [[0.2, 0.3], [0.7, 0.9], [0.5, 0.5]]
                .map(|place| grid.mean(place, [extent, 0.3], [0.1, extent])[3]);
            let most = shown.iter().fold(0.0_f32, |most, &share| most.max(share));
            let least = shown.iter().fold(1.0_f32, |least, &share| least.min(share));
            assert!(
                least > 0.0 && most - least < 0.02 * most,
                "{step}: {shown:?}"
            );
        }
    }
}

#[test]
fn seams_do_not_show() {
    let grid = Grid::new(15.0, direction([0.999, 0.5]), direction([0.4, 0.995]));
    let close = |a: [f32; 4], b: [f32; 4]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 2e-3);
    for index in 0..20_000 {
        let [s, v] = even(index);
        let u = s * 0.02 - 0.01;
        let (x, y) = ([0.002, 0.001], [-0.0005, 0.003]);
        assert!(
            close(grid.mean([u, v], x, y), grid.mean([u + 1.0, v], x, y)),
            "{u} {v}"
        );
        // Over the pole.
        let above = 1.0 + 0.01 * s;
        let folded = 2.0 - above;
        let over = grid.mean([v, above], x, y);
        let same = grid.mean([v + 0.5, folded], [x[0], -x[1]], [y[0], -y[1]]);
        assert!(close(over, same), "{v} {above}: {over:?} {same:?}");
    }
}

/// The place of a direction.
fn place(direction: DVec3) -> [f64; 2] {
    [
        0.5 - libm::atan2(direction.y, direction.x) / (2.0 * PI),
        0.5 + libm::asin(direction.z.clamp(-1.0, 1.0)) / PI,
    ]
}

#[test]
fn small_moves_change_little() {
    let behind = direction([0.31, 0.56]);
    let grid = Grid::new(15.0, -behind, behind);
    for size in [0.0002, 0.002, 0.02, 0.2] {
        for index in 0..10_000 {
            // Every fourth place is within three pixels of a pole.
            let [s, t] = even(index);
            let v = if index % 4 == 0 {
                1.0 - 3.0 * size * t / PI
            } else {
                t
            };
            let here = direction([s, v]);
            // A pixel of this size in radians, a square on the sky.
            let [right, up] = [
                here.any_orthonormal_vector(),
                here.cross(here.any_orthonormal_vector()),
            ];
            let shown = |centre: DVec3| {
                let from = place(centre);
                let change = |side: DVec3| {
                    let side = side - centre * centre.dot(side);
                    let distance = centre.x * centre.x + centre.y * centre.y;
                    let longitude = (centre.x * side.y - centre.y * side.x) / distance;
                    [-longitude / (2.0 * PI), side.z / distance.sqrt() / PI].map(|c| c * size)
                };
                mean(&grid, [from, change(right), change(up)])
            };
            let is_at_pole = libm::hypot(here.x, here.y) < 3.0 * size;
            let moved = (here + 0.01 * size * right).normalize();
            for (here, there) in shown(here).into_iter().zip(shown(moved)) {
                // A hundredth of the pixel is new, and as much is gone. Next to a pole the footprint also turns: there
                // 0.053 was measured.
                let most = if is_at_pole { 0.08 } else { 0.025 };
                assert!(
                    (here - there).abs() < most,
                    "{size} {s} {v}: {here} {there}"
                );
                assert!((0.0..=1.0 + 1e-6).contains(&here));
            }
        }
    }
}

#[test]
fn sines_and_cosines() {
    for i in -1000..=1000 {
        let x = f64::from(i) / 1000.0;
        let (sine, cosine) = sin_cos_half_turns(x);
        assert!((sine - libm::sin(PI * x)).abs() < 1e-9, "{x}");
        assert!((cosine - libm::cos(PI * x)).abs() < 1e-9, "{x}");
    }
}
