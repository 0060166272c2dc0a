//! Guards against wrong frames where the camera, the disk or the lens is at a limit of what is allowed. Each frame of
//! the program is compared with each pixel's own exact ray. A pixel may differ only where an edge is within a
//! thousandth of a pixel of its centre.

use darkness::orbit::exact::Exact;
use darkness::render::mask::WHITE;
use darkness::scene::{Scene, View};
use glam::DVec3;

use crate::drawn::Program;
use crate::methods::{by_pixels, differing, sees_disk};

/// The parameters of a scene; the disk's normal is the z axis.
#[derive(Debug, Clone, Copy)]
struct Shot {
    position: DVec3,
    focus: DVec3,
    fov: f64,
    disk: (f64, f64),
    size: (u32, u32),
}

impl Shot {
    fn new(position: DVec3, focus: DVec3, fov: f64, disk: (f64, f64)) -> Self {
        Self {
            position,
            focus,
            fov,
            disk,
            size: (72, 48),
        }
    }

    fn up(&self) -> DVec3 {
        // Not parallel to the view or to any axis.
        let view = (self.focus - self.position).normalize();
        let up = DVec3::new(0.1, 0.2, 1.0);
        if view.cross(up).length() > 0.3 {
            up
        } else {
            DVec3::new(0.2, 1.0, 0.1)
        }
    }

    fn scene(&self) -> Scene {
        let vector = |v: DVec3| format!("[{:?}, {:?}, {:?}]", v.x, v.y, v.z);
        let text = format!(
            "[camera]\nposition = {}\nfocus = {}\nup = {}\nfov = {:?}\n[disk]\ninner = {:?}\nouter = {:?}\n\
             [image]\nwidth = {}\nheight = {}\n",
            vector(self.position),
            vector(self.focus),
            vector(self.up()),
            self.fov,
            self.disk.0,
            self.disk.1,
            self.size.0,
            self.size.1
        );
        Scene::from_toml(&text).unwrap_or_else(|error| panic!("{error}\n{text}"))
    }

    /// The same camera with another lens, its picture's centre on an edge of the disk; none where the picture shows
    /// no edge.
    fn zoomed(&self, fov: f64) -> Option<Self> {
        let scene = self.scene();
        let view = View::new(&scene);
        let pixels = by_pixels(&scene, &Exact);
        let width = self.size.0 as usize;
        // The first pixels side by side that differ, from the middle row on.
        let middle = pixels.len() / width / 2 * width;
        let order = (middle..pixels.len()).chain(0..middle);
        let k = order
            .filter(|k| k % width != 0)
            .find(|&k| pixels[k] != pixels[k - 1])?;
        let row = (k / width) as f64 + 0.5;
        let (mut left, mut right) = ((k % width) as f64 - 0.5, (k % width) as f64 + 0.5);
        let before = sees_disk(&scene, &view, left, row);
        for _ in 0..60 {
            let column = 0.5 * (left + right);
            if sees_disk(&scene, &view, column, row) == before {
                left = column;
            } else {
                right = column;
            }
        }
        let f = (self.focus - self.position).normalize();
        let side = f.cross(self.up()).normalize();
        let top = side.cross(f);
        let direction = f + side * view.x_at(left) + top * view.y_at(row);
        Some(Self {
            focus: self.position + direction * self.position.length(),
            fov,
            ..*self
        })
    }
}

/// How many frames were drawn in which way, and what they show.
#[derive(Debug, Default)]
struct Count {
    frames: usize,
    with_both_colours: usize,
    differing: usize,
}

impl Count {
    fn check(&mut self, program: &Program, name: &str, shot: &Shot) {
        let scene = shot.scene();
        let drawn = program.draw(&scene);
        let exact = by_pixels(&scene, &Exact);
        let name = format!("{name}: {shot:?}");
        assert!(drawn.by_curves, "{name}: pixel by pixel");
        self.differing += differing(&name, &scene, &drawn.pixels, &exact);
        self.with_both_colours += usize::from(exact.contains(&WHITE) && exact.contains(&0));
        self.frames += 1;
    }
}

const DISK: (f64, f64) = (3.0, 12.0);

/// Cameras at every special place, with a field of view that shows the disk.
fn cameras() -> Vec<(&'static str, DVec3, f64)> {
    let slant = DVec3::new(0.8, 0.0, 0.6);
    let mut cameras = vec![
        ("ordinary", DVec3::new(28.0, 3.0, 6.0), 60.0),
        ("just above the horizon", slant * (1.0 + 1e-12), 170.0),
        ("far away", DVec3::new(0.9e12, 0.1e12, 0.3e12), 1.6e-9),
        ("in the plane, in the gap", DVec3::new(2.0, 0.0, 0.0), 120.0),
        ("on the axis", DVec3::new(0.0, 0.0, 20.0), 90.0),
        (
            "on the axis, near the hole",
            DVec3::new(0.0, 0.0, -1.2),
            120.0,
        ),
    ];
    for radius in [1.5, 1.5_f64.next_down(), 1.5_f64.next_up()] {
        // Components that square and add up to the radius exactly are those along an axis.
        cameras.push((
            "at the photon sphere, on the axis",
            DVec3::Z * radius,
            110.0,
        ));
        cameras.push((
            "at the photon sphere, in the plane",
            DVec3::X * radius,
            110.0,
        ));
        cameras.push(("at the photon sphere", slant * radius, 110.0));
    }
    cameras
}

/// Towards the hole, away from it, and past it.
fn directions(position: DVec3) -> [(&'static str, DVec3); 3] {
    let aside = position.any_orthogonal_vector().normalize() * position.length();
    [
        ("at the hole", DVec3::ZERO),
        ("away from it", 2.0 * position),
        ("aside", 0.7 * position + aside),
    ]
}

/// Every place with an ordinary disk, one that reaches out to 1e6, and in all directions.
#[test]
fn every_place_and_every_direction_is_drawn_right() {
    let program = Program::new();
    let mut count = Count::default();
    for (place, position, fov) in cameras() {
        for outer in [12.0, 1e6] {
            for (direction, focus) in directions(position) {
                let name = format!("{place}, looking {direction}, disk to {outer}");
                count.check(
                    &program,
                    &name,
                    &Shot::new(position, focus, fov, (3.0, outer)),
                );
            }
        }
    }
    println!("{count:?}");
    assert!(count.with_both_colours >= 40, "{count:?}");
}

/// The widest practical lens, and long ones, down to pictures of 1e-9° whose centre is on an edge.
#[test]
fn the_widest_and_the_longest_lenses_are_drawn_right() {
    let program = Program::new();
    let mut count = Count::default();
    for (place, position, fov) in cameras() {
        for (direction, focus) in directions(position) {
            let shot = Shot::new(position, focus, fov, DISK);
            let name = format!("{place}, looking {direction}");
            count.check(&program, &name, &Shot { fov: 179.9, ..shot });
            for fov in [1e-3, 1e-4, 1e-5, 1e-6, 1e-9] {
                if let Some(long) = shot.zoomed(fov) {
                    count.check(&program, &name, &long);
                }
            }
        }
    }
    println!("{count:?}");
    assert!(count.with_both_colours >= 30, "{count:?}");
}

/// A disk a millionth wide, seen by lenses that show its images from a tenth of a pixel to a hundred pixels thick.
#[test]
fn a_disk_a_millionth_wide_is_drawn_right() {
    let program = Program::new();
    let mut count = Count::default();
    for (place, position, fov) in cameras() {
        for radius in [3.0, 8.0] {
            // Its outer edge, found as the inner edge of a wide disk.
            let edge = radius + 1e-6;
            for (direction, focus) in directions(position) {
                let wide = Shot::new(position, focus, fov, (edge, 20.0));
                let name = format!("{place}, looking {direction}, at r = {radius}");
                for share in [3e-8, 3e-7, 3e-6] {
                    let Some(zoomed) = wide.zoomed(fov.min(60.0) * share) else {
                        continue;
                    };
                    let thin = Shot {
                        disk: (radius, edge),
                        ..zoomed
                    };
                    count.check(&program, &name, &thin);
                }
                count.check(
                    &program,
                    &name,
                    &Shot {
                        disk: (radius, edge),
                        ..wide
                    },
                );
            }
        }
    }
    println!("{count:?}");
    assert!(count.with_both_colours >= 40, "{count:?}");
}

/// In the plane of the disk, beyond its edge: a wide one's, and a narrow one's.
#[test]
fn a_camera_in_the_disks_plane_and_outside_it_is_drawn_right() {
    let program = Program::new();
    let mut count = Count::default();
    for (radius, outer, fov) in [
        (13.0, 12.0, 150.0),
        (12.000_001, 12.0, 150.0),
        (2e6, 1e6, 100.0),
        (1e12, 1e6, 3e-4),
    ] {
        let position = DVec3::new(0.6, 0.8, 0.0) * radius;
        for (direction, focus) in directions(position) {
            let shot = Shot::new(position, focus, fov, (3.0, outer));
            let name = format!("r = {radius}, looking {direction}");
            count.check(&program, &name, &shot);
            if let Some(zoomed) = shot.zoomed(fov * 1e-3) {
                count.check(&program, &name, &zoomed);
            }
        }
    }
    println!("{count:?}");
    assert!(count.with_both_colours >= 4, "{count:?}");
}

/// Pictures of one pixel, one row and one column.
#[test]
fn pictures_of_one_pixel_one_row_and_one_column_are_drawn_right() {
    let program = Program::new();
    let mut count = Count::default();
    let position = DVec3::new(28.0, 3.0, 6.0);
    for (focus, white) in [(DVec3::new(6.0, 1.0, 0.0), true), (DVec3::ZERO, false)] {
        let shot = Shot {
            size: (1, 1),
            ..Shot::new(position, focus, 30.0, DISK)
        };
        count.check(&program, "one pixel", &shot);
        assert_eq!(
            by_pixels(&shot.scene(), &Exact) == [WHITE],
            white,
            "{shot:?}"
        );
    }
    let across = 60.0;
    for (name, size, fov) in [
        ("a column", (1, 100_000), across),
        ("a row", (100_000, 1), across * 1e-5),
    ] {
        for focus in [
            DVec3::ZERO,
            DVec3::new(0.0, 1.0, 2.0),
            DVec3::new(-3.0, 0.0, 9.0),
        ] {
            let shot = Shot {
                size,
                ..Shot::new(position, focus, fov, DISK)
            };
            count.check(&program, name, &shot);
        }
    }
    println!("{count:?}");
    assert!(count.with_both_colours >= 5, "{count:?}");
}

/// A disk so wide that no curve of its outer edge can be drawn, since it bends within 1e-12 of a half turn: each
/// pixel's own ray is evaluated, and the program says so.
#[test]
fn a_disk_too_wide_for_curves_is_drawn_pixel_by_pixel() {
    let program = Program::new();
    let disk = (3.0, 1e20);
    let position = DVec3::new(1e6, 0.0, 1e-3);
    let mut shot = Shot {
        size: (480, 270),
        ..Shot::new(position, DVec3::ZERO, 30.0, disk)
    };
    let drawn = program.draw(&shot.scene());
    assert!(!drawn.by_curves);
    let exact = by_pixels(&shot.scene(), &Exact);
    differing("a wide disk", &shot.scene(), &drawn.pixels, &exact);
    // A lens that does not show that part of the curve does not need it.
    shot.fov = 1e-4;
    assert!(program.draw(&shot.scene()).by_curves);
}
