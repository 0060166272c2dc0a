//! Stars: the light and the place of each image, against exact rays and their differences, wherever between pixels the
//! image falls.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use darkness::Renderer;
use darkness::isoradial::EscapeCurve;
use darkness::orbit::exact::Exact;
use darkness::scene::{Scene, Sky, SkyFile, StarSource, Stars, View};
use darkness::sky::{Orientation, SkySource, Star, StarColours, StarField};
use darkness::table::Lookup;
use glam::DVec3;

use crate::noise::Random;
use crate::sky_views::{ExactRays, derivative, light_of, looking, position, solid_angle};
use crate::tables::table;

/// The largest side of a pixel in X and Y. The renderer takes its solid angle at its centre, which is off by a
/// quarter of the side's square there.
const SIDE: f64 = 0.003;

/// The picture about an image, in pixels.
const SIZE: (u32, u32) = (32, 18);

fn with_stars(rotation: [f64; 3]) -> Sky {
    Sky {
        stars: Some(Stars::new(StarSource::File(SkyFile::new("of the test")))),
        rotation,
        ..Sky::default()
    }
}

fn one_star(direction: DVec3) -> (Star, SkySource) {
    let star = Star::at(direction, -10.0, 6000.0);
    let field = StarField { stars: vec![star] };
    (star, SkySource::new(None, Some(field), None))
}

/// The light of a star without magnification, as a camera at rest sees it.
fn unlensed(star: &Star, view: &View) -> [f32; 3] {
    StarColours::new(1.0 / view.clock_rate(), 0.0).light(star)
}

/// The image of a star: the ray from the camera that sweeps `angle`, in the plane of p̂ and a direction across it.
#[derive(Clone, Copy)]
struct Image {
    psi: f64,
    /// Of the ray, from the camera.
    ray: DVec3,
    /// In which it leaves.
    direction: DVec3,
}

/// The image at an angle, on the side of azimuth α about p̂.
fn image(rays: &ExactRays, position: DVec3, angle: f64, azimuth: f64) -> Image {
    let p = position.normalize();
    let a = p.any_orthonormal_vector();
    let t = a * libm::cos(azimuth) + p.cross(a) * libm::sin(azimuth);
    let psi = rays.psi_of(angle);
    let in_plane = |angle: f64| p * libm::cos(angle) + t * libm::sin(angle);
    Image {
        psi,
        ray: in_plane(PI - psi),
        direction: in_plane(angle),
    }
}

/// Where the picture shows a ray, in pixels, by the convention of the camera alone.
fn place_of(scene: &Scene, view: &View, ray: DVec3) -> (f64, f64) {
    let camera = scene.camera();
    let ahead = (camera.focus - camera.position).normalize();
    let right = ahead.cross(camera.up).normalize();
    let up = right.cross(ahead);
    let scale = 1.0 / (ray.dot(ahead) * view.pixel_side());
    (
        0.5 * f64::from(view.width()) + ray.dot(right) * scale,
        0.5 * f64::from(view.height()) - ray.dot(up) * scale,
    )
}

/// The light within some pixels of a place over that of a star without magnification, and its centroid.
fn gathered(
    view: &View,
    light: &[[f32; 3]],
    place: (f64, f64),
    star: [f32; 3],
) -> ([f64; 3], (f64, f64)) {
    let (mut sum, mut moment) = ([0.0; 3], (0.0, 0.0));
    let width = view.width() as usize;
    for (index, pixel) in light.iter().enumerate() {
        let (i, j) = (index % width, index / width);
        let (x, y) = (i as f64 + 0.5, j as f64 + 0.5);
        if (x - place.0).abs() > 3.0 || (y - place.1).abs() > 3.0 {
            continue;
        }
        let solid_angle = solid_angle(view, (i, j));
        for ((sum, c), star) in sum.iter_mut().zip(pixel).zip(star) {
            *sum += f64::from(*c) * solid_angle / f64::from(star);
        }
        let weight = f64::from(pixel[1]) * solid_angle / f64::from(star[1]);
        moment = (moment.0 + weight * x, moment.1 + weight * y);
    }
    (sum, (moment.0 / sum[1], moment.1 / sum[1]))
}

/// The vertical field of view of pictures whose pixels have a side, in degrees.
fn fov(side: f64) -> f64 {
    2.0 * libm::atan(0.5 * f64::from(SIZE.1) * side).to_degrees()
}

/// The least and the greatest of numbers.
#[derive(Clone, Copy)]
struct Range(f64, f64);

impl Range {
    const EMPTY: Self = Self(f64::INFINITY, f64::NEG_INFINITY);

    fn add(&mut self, value: f64) {
        assert!(value.is_finite(), "{value}");
        *self = Self(self.0.min(value), self.1.max(value));
    }
}

/// Checks the light of an image in 24 frames. `frame` gives the scene and the star's direction in the sky's own axes.
fn steady(
    renderer: Renderer<Lookup<'static>>,
    name: &str,
    order: u32,
    frame: impl Fn(f64) -> (Scene, DVec3),
) -> Renderer<Lookup<'static>> {
    let mut renderer = renderer;
    let (mut ratios, mut columns, mut rows) = (Range::EMPTY, Range::EMPTY, Range::EMPTY);
    for n in 0..24 {
        let (scene, own) = frame(f64::from(n) / 24.0);
        let view = View::new(&scene);
        let direction = Orientation::new(scene.sky().unwrap().rotation).from_sky(own);
        let p = view.axes()[0];
        let across = direction - p * direction.dot(p);
        let theta = libm::atan2(across.length(), direction.dot(p));
        let turns = TAU * f64::from(order / 2);
        let (angle, side) = if order.is_multiple_of(2) {
            (turns + theta, across.normalize())
        } else {
            (turns + TAU - theta, -across.normalize())
        };
        let curve = EscapeCurve::new(view.u0(), view.slope_scale(), &Exact);
        let image = curve.image(angle);
        let place = place_of(&scene, &view, side * image.sine - p * image.cosine);
        let (star, source) = one_star(own);
        let light;
        (renderer, light) = light_of(renderer, &scene, source);
        let (sums, _) = gathered(&view, &light, place, unlensed(&star, &view));
        for sum in sums {
            ratios.add(sum / image.magnification(libm::sin(angle)));
        }
        columns.add(place.0);
        rows.add(place.1);
    }
    let Range(least, most) = ratios;
    println!(
        "{name}, order {order}: {:.1e} to {:.1e}, moved by {:.2} × {:.2}",
        least - 1.0,
        most - 1.0,
        columns.1 - columns.0,
        rows.1 - rows.0
    );
    assert!(
        columns.1 - columns.0 > 0.5 || rows.1 - rows.0 > 0.5,
        "{name} stands still"
    );
    assert!(
        least > 1.0 - 1e-5 && most < 1.0 + 1e-5,
        "{name}: {least} to {most}"
    );
    renderer
}

#[test]
fn the_light_of_an_image_does_not_depend_on_where_between_pixels_it_falls() {
    let mut renderer = Renderer::new(table("standard"));
    for radius in [30.0, 3.0, 1.2, 1e6] {
        let rays = ExactRays::new(radius);
        let position = position(radius);
        for order in 0..3_u32 {
            let angle = PI * (f64::from(order) + 0.37);
            let image = image(&rays, position, angle, 0.7);
            let side = (0.1 * (image.psi - rays.critical)).min(SIDE);
            let right = image.ray.any_orthonormal_vector();
            let down = image.ray.cross(right);
            let turned = |share: f64| {
                let off = right * (1.7 * share) + down * (0.6 * share);
                let towards = (image.ray + off * side).normalize();
                let sky = with_stars([0.0; 3]);
                (
                    looking(position, towards, fov(side), SIZE, &sky),
                    image.direction,
                )
            };
            renderer = steady(
                renderer,
                &format!("r = {radius}, camera turns"),
                order,
                turned,
            );
            // The image moves by about two pixels at most.
            let radial = rays.rate(image.psi);
            let tangential = (libm::sin(angle) / libm::sin(image.psi)).abs();
            let reach = 2.0 * side * radial.min(tangential);
            let sky_turns = |share: f64| {
                let turn = (reach * share).to_degrees();
                let sky = with_stars([turn, 40.0 - 0.6 * turn, 0.3 * turn]);
                let own = Orientation::new([0.0, 40.0, 0.0]).to_sky(image.direction);
                (looking(position, image.ray, fov(side), SIZE, &sky), own)
            };
            renderer = steady(
                renderer,
                &format!("r = {radius}, sky turns"),
                order,
                sky_turns,
            );
        }
        // In a corner of a wide picture.
        let image = image(&rays, position, 0.3, 2.0);
        let right = image.ray.any_orthonormal_vector();
        let down = image.ray.cross(right);
        let corner = |share: f64| {
            let towards = image.ray + right * (0.8 + 0.03 * share) + down * (0.4 + 0.01 * share);
            let sky = with_stars([0.0; 3]);
            let scene = looking(position, towards.normalize(), 110.0, (1600, 900), &sky);
            (scene, image.direction)
        };
        renderer = steady(renderer, &format!("r = {radius}, wide"), 0, corner);
    }
}

/// How far off images are, at most.
#[derive(Default)]
struct Worst {
    magnification: f64,
    place: f64,
    count: u32,
}

/// Compares an image with exact rays: its light with a magnification, or with the differences of rays where there is
/// none; its place with the ray through it.
fn compare(
    renderer: Renderer<Lookup<'static>>,
    rays: &ExactRays,
    (image, side, angle): (Image, f64, f64),
    magnification: Option<f64>,
    (position, worst): (DVec3, &mut Worst),
) -> Renderer<Lookup<'static>> {
    let scene = looking(position, image.ray, fov(side), SIZE, &with_stars([0.0; 3]));
    let view = View::new(&scene);
    let expected = place_of(&scene, &view, image.ray);
    let (star, source) = one_star(image.direction);
    let (renderer, light) = light_of(renderer, &scene, source);
    let (sums, place) = gathered(&view, &light, expected, unlensed(&star, &view));
    let truth = magnification.unwrap_or_else(|| {
        let (x, y) = expected;
        let step = 0.2;
        let at = |place| rays.leaves(&view, place).unwrap();
        let along_x = derivative(step, |h| at((x + h, y)));
        let along_y = derivative(step, |h| at((x, y + h)));
        let (x, y) = (view.x_at(x), view.y_at(y));
        let square = 1.0 + x * x + y * y;
        let solid_angle = side * side / (square * square.sqrt());
        solid_angle / along_x.cross(along_y).length()
    });
    for sum in sums {
        let off = (sum / truth - 1.0).abs();
        assert!(off < 1e-4, "{angle}: {sum} and not {truth}");
        worst.magnification = worst.magnification.max(off);
    }
    let leaves = rays.leaves(&view, place).unwrap();
    let off = (leaves - image.direction).length();
    assert!(off < 1e-7, "{angle}: {off}");
    worst.place = worst.place.max(off);
    worst.count += 1;
    renderer
}

#[test]
fn images_are_where_exact_rays_say_and_as_bright() {
    let mut renderer = Renderer::new(table("standard"));
    let mut random = Random(11);
    for radius in [30.0, 6.0, 3.0, 1.5, 1.2, 1.01, 1e6] {
        let rays = ExactRays::new(radius);
        let position = position(radius);
        for order in 0..3_u32 {
            let mut worst = Worst::default();
            for _ in 0..25 {
                // Uniform over the sky.
                let theta = libm::acos(1.0 - 2.0 * random.number());
                let angle = f64::from(order) * PI
                    + if order.is_multiple_of(2) {
                        theta
                    } else {
                        PI - theta
                    };
                let image = image(&rays, position, angle, TAU * random.number());
                let from_axis = theta.min(PI - theta) / rays.rate(image.psi);
                let side = (0.1 * (image.psi - rays.critical))
                    .min(0.1 * from_axis)
                    .min(SIDE);
                let of = (position, &mut worst);
                renderer = compare(renderer, &rays, (image, side, angle), None, of);
            }
            println!(
                "r = {radius}, order {order}: magnification {:.1e}, place {:.1e} rad",
                worst.magnification, worst.place
            );
            assert_eq!(worst.count, 25);
        }
    }
}

#[test]
fn images_beside_the_axis_too() {
    let mut renderer = Renderer::new(table("standard"));
    for radius in [30.0, 3.0, 1.2, 1e6] {
        let rays = ExactRays::new(radius);
        let position = position(radius);
        for (name, axes) in [("before", [0.0, TAU]), ("behind", [PI, 3.0 * PI])] {
            let mut worst = Worst::default();
            for (axis, k) in axes
                .into_iter()
                .flat_map(|axis| (0..11).map(move |k| (axis, k)))
            {
                // From 0.03 to 3e-7 radians, by half orders of magnitude; not within the star's radius.
                let off = 0.03 * libm::exp(-0.5 * core::f64::consts::LN_10 * f64::from(k));
                if off < 1e-6 && axis > 0.0 {
                    continue;
                }
                for angle in [axis - off, axis + off] {
                    if angle < 0.0 {
                        continue;
                    }
                    let image = image(&rays, position, angle, 1.0);
                    let rate = rays.rate(image.psi);
                    let side = (0.1 * (image.psi - rays.critical))
                        .min(0.1 * off / rate)
                        .min(SIDE);
                    // sin Φ by the difference from the axis, which has all its digits.
                    let magnification = libm::sin(image.psi) / (libm::sin(off) * rate);
                    let of = (position, &mut worst);
                    let at = (image, side, angle);
                    renderer = compare(renderer, &rays, at, Some(magnification), of);
                }
            }
            println!(
                "r = {radius}, {name}: magnification {:.1e}, place {:.1e} rad, {} images",
                worst.magnification, worst.place, worst.count
            );
        }
    }
}

/// The light of all images of a star within a picture that shows the whole ring.
fn on_axis(radius: f64, star_radius: f64, off: f64) -> (f64, f64) {
    let rays = ExactRays::new(radius);
    let position = position(radius);
    let p = position.normalize();
    let t = p.any_orthonormal_vector();
    let direction = -p * libm::cos(off) + t * libm::sin(off);
    let psi = rays.psi_of(PI);
    let mut sky = with_stars([0.0; 3]);
    sky.stars.as_mut().unwrap().radius = star_radius;
    let fov = (3.0 * psi).to_degrees().min(150.0);
    let towards = if psi < FRAC_PI_2 { -p } else { p };
    let scene = looking(position, towards, fov, (240, 240), &sky);
    let view = View::new(&scene);
    let (star, source) = one_star(direction);
    let (_, light) = light_of(Renderer::new(table("standard")), &scene, source);
    let irradiance = unlensed(&star, &view)[1];
    let sum: f64 = (0..240 * 240)
        .map(|i| f64::from(light[i][1]) * solid_angle(&view, (i % 240, i / 240)))
        .sum();
    (
        sum / f64::from(irradiance),
        2.0 * libm::sin(psi) / rays.rate(psi),
    )
}

#[test]
fn a_star_straight_behind_the_hole_has_the_light_of_its_ring() {
    for radius in [30.0, 3.0, 1.2, 1e6] {
        for star_radius in [1e-9, 1e-6, 1e-3, 0.01] {
            let (found, one) = on_axis(radius, star_radius, 0.0);
            // Two images, each the ring of one order.
            let share = found / (2.0 * one / star_radius);
            println!("r = {radius}, star radius {star_radius}: {found:e}, of its rings {share}");
            // Higher orders and the curve of the ring within a star's radius.
            assert!((share - 1.0).abs() < 5e-3, "{share}");
            // Nearer to the axis than the star's radius nothing gets brighter, unless the star is as large as its ring.
            let psi = ExactRays::new(radius).psi_of(PI);
            if star_radius > 0.03 * psi {
                continue;
            }
            for off in [1e-16, 1e-12, 0.1 * star_radius, 0.49 * star_radius] {
                let (beside, _) = on_axis(radius, star_radius, off);
                assert!(
                    (beside / found - 1.0).abs() < 5e-3,
                    "{off}: {beside} {found}"
                );
            }
        }
    }
}

#[test]
fn a_star_straight_before_the_hole_has_no_cap() {
    // Order 0 sees it as it is: behind the camera there is no lens.
    for radius in [30.0, 1.2, 1e6] {
        let rays = ExactRays::new(radius);
        let position = position(radius);
        let expected = 1.0 / (rays.rate(PI) * rays.rate(PI));
        for star_radius in [1e-6, 0.01] {
            for off in [0.0, 1e-12, 0.9e-7, 1.1e-7, 0.4e-6, 1e-4, 1e-3, 0.004] {
                let p = position.normalize();
                let t = p.any_orthonormal_vector();
                let mut sky = with_stars([0.0; 3]);
                sky.stars.as_mut().unwrap().radius = star_radius;
                let scene = looking(position, p, 10.0, SIZE, &sky);
                let view = View::new(&scene);
                let (star, source) = one_star(p * libm::cos(off) + t * libm::sin(off));
                let (_, light) = light_of(Renderer::new(table("standard")), &scene, source);
                let centre = (16.0, 9.0);
                let (sums, _) = gathered(&view, &light, centre, unlensed(&star, &view));
                let share = sums[1] / expected;
                assert!(
                    (share - 1.0).abs() < 1e-4,
                    "r = {radius}, {star_radius}, {off}: {share}"
                );
            }
        }
    }
}
