//! Guards against curves and outlines that are not where the rays are: Bézier paths against Luminet's figure of 1979
//! and against exact rays through the places that they pass, filled outlines against masks.

use std::f64::consts::{PI, TAU};

use darkness::Ray;
use darkness::figure::kurbo::{
    BezPath, Line, ParamCurve, ParamCurveNearest, PathEl, Point, Shape, Vec2,
};
use darkness::figure::{Contour, Level, Quantity, TOLERANCE, contours, write_csv};
use darkness::isoradial::{CurveSpec, Isoradials};
use darkness::light::{SightGeometry, flux};
use darkness::orbit::Orbits;
use darkness::orbit::exact::Exact;
use darkness::render::disk_outline;
use darkness::render::mask::render_every_pixel;
use darkness::scene::{Scene, View, builtins};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

fn levels(quantity: Quantity, values: &[f64]) -> Vec<Level> {
    let level = |&value| Level { quantity, value };
    values.iter().map(level).collect()
}

/// A scene of Luminet's figure: 40 Schwarzschild radii in a square, from so far away that the camera's radius is as
/// good as infinite.
fn plate(side: u32) -> Scene {
    Scene::from_toml(&format!(
        "[camera]\nradius = 1e12\ninclination = 80.0\nfov = {}\n[disk]\ninner = 3.0\nouter = 20.0\n\
         [image]\nwidth = {side}\nheight = {side}\n",
        (2.0 * libm::atan(20.0 / 1e12)).to_degrees()
    ))
    .unwrap()
}

/// Where a path meets a line from the picture's middle.
fn meeting(path: &BezPath, line: Line) -> Vec<Point> {
    let segments = path.segments();
    let meetings = segments.flat_map(|segment| {
        let at = segment.intersect_line(line);
        at.iter()
            .map(|at| segment.eval(at.segment_t))
            .collect::<Vec<_>>()
    });
    meetings.collect()
}

#[test]
fn luminet_s_figure_of_1979_has_the_known_values() {
    const SIDE: u32 = 60_000;
    let (middle, per_pixel) = (f64::from(SIDE) / 2.0, 40.0 / f64::from(SIDE));
    let scene = plate(SIDE);
    let view = View::new(&scene);
    let curves = contours(
        &view,
        (3.0, 20.0),
        &levels(Quantity::Radius, &[3.0, 5.0, 10.0, 15.0]),
        2,
    );
    assert_eq!(curves.len(), 8);
    assert!(curves.iter().all(Contour::is_closed));
    let text = include_str!("../reference/known_values.csv");
    let rows = text
        .lines()
        .filter_map(|line| line.strip_prefix("isoradial_80deg_b,r="));
    let mut compared = 0;
    for row in rows {
        let mut fields = row.split(',');
        let (place, b) = (fields.next().unwrap(), fields.next().unwrap());
        let (radius, rest) = place.split_once(" alpha=").unwrap();
        let (alpha, image) = rest.split_once(' ').unwrap();
        let (radius, alpha, b): (f64, f64, f64) = (
            radius.parse().unwrap(),
            alpha.parse().unwrap(),
            b.parse().unwrap(),
        );
        let order = u32::from(image == "first order");
        let of_radius = |curve: &&Contour| curve.order == order && curve.level.value == radius;
        let curve = curves.iter().find(of_radius).unwrap();
        // The near side is below. A little aside: segments meet on the axis, and neither may reach it, up to rounding.
        let (sine, cosine) = libm::sincos(alpha.to_radians() + 1e-9);
        let centre = Point::new(middle, middle);
        let line = Line::new(centre, centre + middle * Vec2::new(sine, cosine));
        let found = meeting(&curve.path, line);
        // Two segments may meet on the line.
        assert!((1..=2).contains(&found.len()), "{row}");
        // Near the axis of the picture an angle is its tangent.
        let distance = found[0].distance(centre) * per_pixel;
        assert!((distance - b).abs() < 2e-6, "{row}: {distance}");
        compared += 1;
    }
    assert_eq!(compared, 7);
}

/// The quantity at a place of the picture in the image of an order, from the exact ray through it.
fn seen(view: &View, quantity: Quantity, order: u32, place: Point) -> Option<f64> {
    let pixel = view.ray_at(view.x_at(place.x), view.y_at(place.y));
    let first = view.plane_crossing(pixel.ta, pixel.transverse());
    let first = if first > 0.0 { first } else { PI };
    let ray = Ray::new(view.u0(), view.dudphi(pixel)).unwrap();
    let u = Exact
        .u_at_angle(ray, first + f64::from(order) * PI)
        .unwrap()?;
    let g = SightGeometry::new(view).sight(pixel, order, u).redshift;
    Some(match quantity {
        Quantity::Radius => 1.0 / u,
        Quantity::Redshift => g,
        Quantity::Flux => g * g * g * g * flux::relative(u),
    })
}

/// How far a place is from a level, in pixels, by the level's gradient there: by differences over the longest of some
/// steps that leads to no ray that falls in before it meets the plane. Beside the shadow that is a short one.
fn distance(view: &View, contour: &Contour, place: Point) -> Option<f64> {
    let at = |dx: f64, dy: f64| {
        let place = place + Vec2::new(dx, dy);
        seen(view, contour.level.quantity, contour.order, place)
    };
    [1e-3, 1e-5, 1e-7].into_iter().find_map(|step| {
        let dx = (at(step, 0.0)? - at(-step, 0.0)?) / (2.0 * step);
        let dy = (at(0.0, step)? - at(0.0, -step)?) / (2.0 * step);
        Some((at(0.0, 0.0)? - contour.level.value).abs() / libm::hypot(dx, dy))
    })
}

/// Asserts that curves are where the exact rays say, all along. Returns how many places were compared.
fn check(name: &str, view: &View, curves: &[Contour]) -> usize {
    let (mut places, mut unseen) = (0, 0);
    for curve in curves {
        for segment in curve.path.segments() {
            for t in [0.0, 0.08, 0.25, 0.45, 0.58, 0.8, 0.95] {
                let place = segment.eval(t);
                places += 1;
                match distance(view, curve, place) {
                    Some(off) => assert!(
                        off < 0.01,
                        "{name}: {:?} {} at {place}: {off}",
                        curve.level,
                        curve.order
                    ),
                    None => unseen += 1,
                }
            }
        }
    }
    assert!(
        unseen * 1000 <= places,
        "{name}: {unseen} of {places} rays end before"
    );
    places
}

#[test]
fn curves_of_all_quantities_are_where_exact_rays_are() {
    for name in [
        "classic", "luminet", "face-on", "edge-on", "close-up", "inside",
    ] {
        let scene = Scene::builtin(name).unwrap().with_size(320, 180).unwrap();
        let view = View::new(&scene);
        let disk = scene.disk().unwrap();
        let all = [
            levels(Quantity::Radius, &[disk.inner, 5.0, disk.outer]),
            levels(Quantity::Redshift, &[0.7, 0.9, 1.0, 1.2]),
            levels(Quantity::Flux, &[0.05, 0.5, 1.5]),
        ]
        .concat();
        let curves = contours(&view, (disk.inner, disk.outer), &all, 2);
        let places = check(name, &view, &curves);
        assert!(places > 500, "{name}: {places}");
    }
}

/// Returns the first and last points of each subpath that is not closed, and the number of closed ones.
fn ends(path: &BezPath) -> (Vec<Point>, usize) {
    let (mut ends, mut closed, mut at) = (Vec::new(), 0, [Point::ZERO; 2]);
    let mut is_open = false;
    let elements = path.iter().chain([PathEl::MoveTo(Point::ZERO)]);
    for element in elements {
        match element {
            PathEl::MoveTo(first) => {
                if is_open {
                    ends.extend(at);
                }
                at = [first; 2];
                is_open = true;
            }
            PathEl::ClosePath => {
                closed += 1;
                is_open = false;
            }
            other => at[1] = other.end_point().unwrap(),
        }
    }
    (ends, closed)
}

#[test]
fn curves_of_redshift_and_flux_end_only_at_the_disk_s_edges() {
    let values: Vec<f64> = (1..16).map(|i| f64::from(i) * 0.1).collect();
    let all = [
        levels(Quantity::Redshift, &values),
        levels(Quantity::Flux, &values),
    ]
    .concat();
    let mut all_closed = 0;
    for inclination in [5.0, 80.0, 89.0] {
        let text = format!(
            "[camera]\nradius = 1000\ninclination = {inclination}\nfov = 3.0\n[disk]\ninner = 3.0\nouter = 20.0\n\
             [image]\nwidth = 640\nheight = 640\n"
        );
        let scene = Scene::from_toml(&text).unwrap();
        let view = View::new(&scene);
        for curve in contours(&view, (3.0, 20.0), &all, 2) {
            let (ends, closed) = ends(&curve.path);
            all_closed += closed;
            for end in ends {
                let edge = seen(&view, Quantity::Radius, curve.order, end).unwrap();
                let off = (edge / 3.0 - 1.0).abs().min((edge / 20.0 - 1.0).abs());
                assert!(
                    off < 1e-6,
                    "{inclination}: {:?} {} ends at r = {edge}",
                    curve.level,
                    curve.order
                );
            }
        }
    }
    assert!(all_closed > 20, "{all_closed}");
}

/// The greatest blueshift of this disk lies within it, near r = 9/(2 sin² i): levels just below it are closed around
/// it, and lower ones reach the outer edge.
#[test]
fn curves_around_the_greatest_blueshift_are_closed() {
    let text = "[camera]\nradius = 1000\ninclination = 50\nfov = 6.0\n[disk]\ninner = 3.0\nouter = 40.0\n\
                [image]\nwidth = 640\nheight = 640\n";
    let scene = Scene::from_toml(text).unwrap();
    let view = View::new(&scene);
    let values: Vec<f64> = (0..40).map(|i| 1.05 + 0.004 * f64::from(i)).collect();
    let curves = contours(&view, (3.0, 40.0), &levels(Quantity::Redshift, &values), 1);
    let closed: Vec<bool> = curves.iter().map(Contour::is_closed).collect();
    assert!(!closed[0] && closed[closed.len() - 1], "{closed:?}");
    assert!(closed.is_sorted() && closed.len() < 40, "{closed:?}");
}

/// Guards against a curve that is halved without end: a pixel here is smaller than the rounding of the curve.
#[test]
fn a_field_of_view_below_rounding_has_a_curve() {
    let wide = Scene::builtin("classic").unwrap();
    let view = View::new(&wide);
    let asked = levels(Quantity::Radius, &[5.0]);
    let curves = contours(&view, (3.0, 12.0), &asked, 1);
    let place = curves[0].path.segments().nth(3).unwrap().start();
    let ray = view.ray_at(view.x_at(place.x), view.y_at(place.y));
    let [outward, across, level] = view.axes();
    let towards = outward * -ray.z + across * ray.ta + level * ray.tb;
    let position = wide.camera().position;
    let focus = position + towards * 30.0;
    let text = format!(
        "[camera]\nposition = [{:?}, {:?}, {:?}]\nfocus = [{:?}, {:?}, {:?}]\nfov = 1e-11\n\
         [disk]\ninner = 3.0\nouter = 12.0\n[image]\nwidth = 96\nheight = 64\n",
        position.x, position.y, position.z, focus.x, focus.y, focus.z
    );
    let scene = Scene::from_toml(&text).unwrap();
    for curve in contours(&View::new(&scene), (3.0, 12.0), &asked, 1) {
        assert!(curve.path.elements().len() < 10_000);
    }
}

#[test]
fn points_of_a_csv_file_follow_the_curve() {
    let scene = plate(1000);
    let view = View::new(&scene);
    let curves = contours(
        &view,
        (3.0, 20.0),
        &levels(Quantity::Radius, &[3.0, 10.0]),
        2,
    );
    let mut csv = Vec::new();
    write_csv(&curves, &view, &mut csv).unwrap();
    let csv = String::from_utf8(csv).unwrap();
    let mut lines = csv.lines();
    assert_eq!(
        lines.next(),
        Some("curve,quantity,level,order,closed,x,y,b,alpha")
    );
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    for number in 1..=4 {
        let of_curve: Vec<_> = rows
            .iter()
            .filter(|row| row[0] == number.to_string())
            .collect();
        let curve = &curves[number - 1];
        assert_eq!(of_curve[0][1], "radius");
        assert_eq!(of_curve[0][2], curve.level.value.to_string());
        assert_eq!(of_curve[0][3], curve.order.to_string());
        assert_eq!(of_curve[0][4], "true");
        let number = |text: &str| text.parse::<f64>().unwrap();
        let points: Vec<Point> = of_curve
            .iter()
            .map(|row| Point::new(number(row[5]), number(row[6])))
            .collect();
        assert_eq!(points.first(), points.last());
        // Straight lines between the points are as near to the curve.
        for pair in points.windows(2) {
            let off = distance(&view, curve, pair[0].midpoint(pair[1])).unwrap();
            assert!(off < 0.01, "{off}");
        }
        // The azimuth goes around once, from the near side counterclockwise, and b is the distance in the picture.
        for (row, point) in of_curve.iter().zip(&points) {
            let (b, alpha) = (number(row[7]), number(row[8]));
            let from_centre = *point - Point::new(500.0, 500.0);
            assert!((from_centre.hypot() * 0.04 - b).abs() < 1e-5);
            let azimuth = libm::atan2(from_centre.x, from_centre.y);
            assert!(
                ((azimuth - alpha + PI).rem_euclid(TAU) - PI).abs() < 1e-4,
                "{azimuth} {alpha}"
            );
        }
    }
}

/// Asserts that an outline winds once around the centres of the mask's pixels, and not around others. A centre that is
/// within the tolerance of an edge may be on either side.
fn check_outline(name: &str, scene: &Scene) -> Result<(), TestCaseError> {
    let view = View::new(scene);
    let curves = Isoradials::new(&CurveSpec::new(scene, &view, TOLERANCE), &Exact);
    let Some(outline) = disk_outline(&view, &curves, TOLERANCE) else {
        return Ok(());
    };
    let mask = render_every_pixel(&view, &curves).unwrap();
    let (mut wrong, width) = (0, view.width() as usize);
    for (i, &pixel) in mask.iter().enumerate() {
        let centre = Point::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
        if outline.winding(centre) != -i32::from(pixel > 0) {
            // Its distance from the edges themselves: a ring may be thinner than the tolerance.
            let distance2 = outline
                .segments()
                .map(|segment| segment.nearest(centre, 1e-9).distance_sq);
            wrong += usize::from(distance2.fold(f64::INFINITY, f64::min) > 0.01 * 0.01);
        }
    }
    prop_assert_eq!(wrong, 0, "{}", name);
    Ok(())
}

#[test]
fn outlines_enclose_the_masks_of_built_in_scenes() {
    for builtin in builtins() {
        let scene = Scene::builtin(builtin.name()).unwrap();
        if scene.disk().is_some() {
            let small = scene.with_size(160, 90).unwrap();
            check_outline(builtin.name(), &small).unwrap();
        }
    }
}

/// Guards against differences that reach into the shadow: the ghost image of a ring at the horizon lies along its edge.
#[test]
fn a_ring_at_the_horizon_is_where_exact_rays_are() {
    let text = "[camera]\nradius = 44.61209\ninclination = 89.82001708225789\nfov = 116.52786767440767\n\
                [disk]\ninner = 3.0\nouter = 15.0\n[image]\nwidth = 96\nheight = 64\n";
    let view = View::new(&Scene::from_toml(text).unwrap());
    let rings = levels(Quantity::Radius, &[1.1]);
    let places = check(text, &view, &contours(&view, (3.0, 15.0), &rings, 2));
    assert!(places > 50, "{places}");
}

proptest! {
    // The same scenes in every run.
    #![proptest_config(ProptestConfig {
        cases: 100,
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(1),
        ..ProptestConfig::default()
    })]

    /// Cameras everywhere: curves that leave the picture or pass behind the camera.
    #[test]
    fn curves_of_random_scenes_are_where_exact_rays_are(
        log_r in 0.1..4.0_f64,
        inclination in 0.0..180.0_f64,
        aim in (-6.0..6.0_f64, -6.0..6.0_f64, -6.0..6.0_f64),
        fov in 5.0..120.0_f64,
        radius in 1.1..40.0_f64,
        g in 0.5..1.3_f64,
    ) {
        let text = format!(
            "[camera]\nradius = {}\ninclination = {inclination}\nfocus = [{}, {}, {}]\nfov = {fov}\n\
             [disk]\ninner = 3.0\nouter = 15.0\n[image]\nwidth = 96\nheight = 64\n",
            libm::exp(log_r), aim.0, aim.1, aim.2,
        );
        if let Ok(scene) = Scene::from_toml(&text) {
            let all = [levels(Quantity::Radius, &[radius]), levels(Quantity::Redshift, &[g])].concat();
            let view = View::new(&scene);
            check(&text, &view, &contours(&view, (3.0, 15.0), &all, 2));
        }
    }

    /// Cameras everywhere, within the disk's radii and looking past its rim too: outlines that leave the picture.
    #[test]
    fn outlines_enclose_the_masks_of_random_scenes(
        log_r in 0.05..4.0_f64,
        direction in (-1.0..1.0_f64, -1.0..1.0_f64, -1.0..1.0_f64),
        aim in (-6.0..6.0_f64, -6.0..6.0_f64, -6.0..6.0_f64),
        fov in 1.0..160.0_f64,
        width_log in -1.0..2.0_f64,
    ) {
        let (x, y, z) = direction;
        let length = (x * x + y * y + z * z).sqrt();
        prop_assume!(length > 0.1);
        let r = libm::exp(log_r);
        let text = format!(
            "[camera]\nposition = [{}, {}, {}]\nfocus = [{}, {}, {}]\nup = [0.1, 0.2, 1.0]\nfov = {fov}\n\
             [disk]\ninner = 3.0\nouter = {}\n[image]\nwidth = 48\nheight = 32\n",
            r * x / length, r * y / length, r * z / length, aim.0, aim.1, aim.2, 3.0 + libm::pow(10.0, width_log),
        );
        if let Ok(scene) = Scene::from_toml(&text) {
            check_outline(&text, &scene)?;
        }
    }
}
