//! What must hold of any bytes that are read as a table, a scene, a range of frames or a list of rays: they are
//! accepted or refused, and what is accepted can be used. Fuzzers run these functions on bytes of their own,
//! `tests/files/corpora.rs` on the bytes that were kept.

// Each fuzzing program uses one of these functions.
#![allow(dead_code)]

pub(crate) mod crafted;

use std::collections::BTreeSet;
use std::sync::OnceLock;

use crafted::{METADATA_AT, METADATA_LENGTH_AT, sealed};
use darkness::cli::FrameRange;
use darkness::cli::rays::RayReader;
use darkness::isoradial::{CurveSpec, Isoradials};
use darkness::orbit::exact::Exact;
use darkness::orbit::path::SweptAngles;
use darkness::orbit::{Event, EventKind, Orbits, Ray, arc_points};
use darkness::render::needs::Needs;
use darkness::render::{Form, coverage, mask};
use darkness::scene::{Animation, Scene, View};
use darkness::table::{Spec, Table};

/// Reads the bytes as a table's file: as they are, and with all checksums and lengths corrected, so that the checks
/// behind these are reached.
pub(crate) fn table(bytes: &[u8]) {
    let mended = mended(bytes);
    let both: [&[u8]; 2] = [bytes, &mended];
    for bytes in &both[usize::from(mended == bytes)..] {
        if let Ok(table) = Table::from_bytes(bytes) {
            use_table(&table);
        }
    }
}

/// Returns the bytes with all lengths and checksums of a table's file corrected.
fn mended(bytes: &[u8]) -> Vec<u8> {
    let Some((preamble, rest)) = bytes.split_at_checked(METADATA_AT) else {
        return bytes.to_vec();
    };
    let claimed = core::array::from_fn(|k| preamble[METADATA_LENGTH_AT + k]);
    let metadata = (u32::from_le_bytes(claimed) as usize).min(rest.len());
    let end = METADATA_AT + metadata;
    let numbers = end.next_multiple_of(64).min(bytes.len());
    sealed(&bytes[METADATA_AT..end], &bytes[numbers..])
}

/// Rays, curves and frames from a table whose numbers may be anything finite: whatever they are, they come to an end.
fn use_table(table: &Table) {
    let lookup = table.lookup();
    for (u, slope) in RAYS {
        let ray = Ray::new(u, slope).unwrap();
        let events = lookup.follow(ray, &RADII).unwrap();
        assert!(matches!(
            events.last(),
            Some(Event {
                kind: EventKind::End(_),
                ..
            })
        ));
    }
    // Curves through noise get the largest number of nodes, which takes seconds: they are drawn for one table in 256.
    let sum = crc32fast::hash(table.bytes()) as usize;
    if sum.is_multiple_of(256) {
        let name = ["classic", "inside", "edge-on"][sum / 256 % 3];
        let scene = Scene::builtin(name).unwrap().with_size(24, 16).unwrap();
        draw(&scene, &lookup);
    }
}

const RADII: [f64; 3] = [3.0, 12.0, 30.0];

/// Rays of every kind: far and near, past the hole and into it, about the critical ray.
const RAYS: [(f64, f64); 8] = [
    (0.03, 0.1),
    (0.03, 0.3836),
    (0.03, -0.2),
    (0.3, 0.5),
    (0.7, 0.01),
    (0.9, -1e-3),
    (1e-9, 1.0),
    (0.2, f64::INFINITY),
];

/// Both kinds of frames of a scene.
fn draw(scene: &Scene, angles: &impl SweptAngles) {
    let view = View::new(scene);
    let curves = Isoradials::new(&CurveSpec::new(scene, &view, scene.tolerance()), angles);
    let pixels = view.width() as usize * view.height() as usize;
    let hard = mask::render(&view, &curves).unwrap();
    assert!(hard.len() == pixels && hard.iter().all(|&pixel| pixel == 0 || pixel == 255));
    assert_eq!(coverage::render(&view, &curves).unwrap().len(), pixels);
}

/// Reads the bytes as a scene file. A scene that is accepted is unchanged when it is written and read again, and can be
/// drawn.
pub(crate) fn scene(bytes: &[u8]) {
    let Ok(text) = str::from_utf8(bytes) else {
        return;
    };
    let animation = match Animation::from_toml(text) {
        Ok(animation) => animation,
        Err(error) => return sentence(&error),
    };
    let written = animation.to_toml();
    let back = Animation::from_toml(&written).unwrap();
    assert_eq!(back.to_toml(), written);
    let small = animation.with_size(24, 16).unwrap();
    if let Err(error) = Needs::of_animation(&small, Form::Grey8) {
        sentence(&error);
    }
    let (first, last) = (small.first(), small.last());
    for number in BTreeSet::from([first, first + i64::from(small.frames()) / 2, last]) {
        if let Err(error) = small.check(number) {
            sentence(&error);
        }
        match small.frame(number) {
            Ok(scene) => draw(&scene, &draft().lookup()),
            Err(error) => sentence(&error),
        }
    }
}

/// Asserts that a message is not empty, not too long, and has no control characters.
fn sentence(error: &impl std::error::Error) {
    let message = error.to_string();
    assert!(!message.trim().is_empty());
    assert!(message.len() < 4000, "{} bytes: {message}", message.len());
    let obeyed = |c: char| c.is_control() && c != '\n';
    assert!(!message.contains(obeyed), "{message:?}");
}

fn draft() -> &'static Table {
    static DRAFT: OnceLock<Table> = OnceLock::new();
    DRAFT.get_or_init(|| Table::generate(&Spec::draft()).unwrap())
}

/// Reads the bytes as a range of frames: its numbers rise, their count is right, and writing and reading keeps them.
pub(crate) fn frames(bytes: &[u8]) {
    const MOST: usize = 10_000;
    let Ok(text) = str::from_utf8(bytes) else {
        return;
    };
    let range: FrameRange = match text.parse() {
        Ok(range) => range,
        Err(error) => return sentence(&error),
    };
    let written = range.to_string();
    assert_eq!(
        written.parse::<FrameRange>().as_ref(),
        Ok(&range),
        "{written}"
    );
    let numbers: Vec<i64> = range.iter().take(MOST).collect();
    assert!(Some(numbers[0]) == range.first() && numbers.is_sorted_by(|a, b| a < b));
    assert!(
        numbers
            .iter()
            .all(|&number| number <= range.last() && range.contains(number))
    );
    if numbers.len() < MOST {
        assert_eq!(range.count(), numbers.len() as u64);
        assert_eq!(numbers.last(), Some(&range.last()));
        // By the definition of a range.
        let first = range.first().unwrap();
        let end = range.last().min(first + MOST as i64);
        let all = (first..=end).filter(|&number| range.contains(number));
        assert!(all.eq(numbers.iter().copied().filter(|&number| number <= end)));
    }
}

/// Reads the bytes as a list of rays: each line gives a ray or an error, and each ray ends.
pub(crate) fn rays(bytes: &[u8]) {
    let mut rays = match RayReader::new(bytes, "list".into(), None) {
        Ok(rays) => rays,
        Err(error) => return sentence(&error),
    };
    let lookup = draft().lookup();
    for row in &mut rays {
        let ray = match row {
            Ok(listed) => listed.ray,
            Err(error) => {
                sentence(&error);
                if error.is_final() {
                    break;
                }
                continue;
            }
        };
        match arc_points(ray, 5, 100.0) {
            Ok(points) => assert!(
                points.iter().all(|point| point.u > 0.0 && point.u <= 1.0),
                "{ray:?}: {points:?}"
            ),
            Err(error) => sentence(&error),
        }
        for events in [Exact.follow(ray, &RADII), lookup.follow(ray, &RADII)] {
            let events = match events {
                Ok(events) => events,
                Err(error) => {
                    sentence(&error);
                    continue;
                }
            };
            assert!(matches!(
                events.last(),
                Some(Event {
                    kind: EventKind::End(_),
                    ..
                })
            ));
            assert!(
                events
                    .iter()
                    .all(|event| event.angle >= 0.0 && event.angle.is_finite()),
                "{ray:?}: {events:?}"
            );
        }
    }
}
