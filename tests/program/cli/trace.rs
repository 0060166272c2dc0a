//! `darkness trace`.

use std::f64::consts::{PI, TAU};
use std::fs;
use std::path::Path;

use darkness::orbit::exact::Exact;
use darkness::orbit::{EventKind, Fate, Orbits, Ray};
use tempfile::tempdir;

use crate::harness::{
    REFERENCE_RAYS, darkness, fails, fed, finish, listing, printed, refused, run, with_draft,
};
use crate::reference_rays::reference_rays;

const HEADER: &str = "id,u0,dudphi,b,event,radius,angle,windings,deflection";

/// One row of the output of `trace`, of a crossing or an end.
struct Row {
    u0: f64,
    dudphi: f64,
    kind: EventKind,
    radius: f64,
    angle: f64,
}

/// The crossings and ends that `trace` printed, grouped by ray. A ray's id is its number, and the windings are its
/// angle in turns.
fn rows(csv: &str) -> Vec<Vec<Row>> {
    let mut lines = csv.lines();
    assert_eq!(lines.next(), Some(HEADER));
    let mut ids = Vec::new();
    let rows: Vec<Row> = lines
        .filter(|line| !line.contains("apsis"))
        .map(|line| {
            let fields: Vec<&str> = line.split(',').collect();
            let [id, u0, dudphi, _, event, radius, angle, windings, _] = fields[..] else {
                panic!("{line}");
            };
            let kind = match event {
                "inbound" => EventKind::Inbound,
                "outbound" => EventKind::Outbound,
                "capture" => EventKind::End(Fate::Capture),
                "escape" => EventKind::End(Fate::Escape),
                _ => panic!("{line}"),
            };
            let [u0, dudphi, radius, angle, windings] =
                [u0, dudphi, radius, angle, windings].map(|field| field.parse().unwrap());
            assert_eq!(windings, angle / TAU, "{line}");
            ids.push(id.to_owned());
            Row {
                u0,
                dudphi,
                kind,
                radius,
                angle,
            }
        })
        .collect();
    rows.into_iter()
        .zip(ids)
        .fold(vec![Vec::new()], |mut groups, (row, id)| {
            assert_eq!(id, groups.len().to_string());
            let ends = matches!(row.kind, EventKind::End(_));
            groups.last_mut().unwrap().push(row);
            if ends {
                groups.push(Vec::new());
            }
            groups
        })
}

#[test]
fn trace_prints_what_the_exact_method_answers_to_the_last_bit() {
    let folder = tempdir().unwrap();
    let args = ["trace", REFERENCE_RAYS, "--method", "exact"];
    let groups = rows(&printed(folder.path(), &args));
    let rays = reference_rays();
    assert_eq!(groups.len(), rays.len() + 1);
    for (row, group) in rays.iter().zip(&groups) {
        let ray = Ray::new(row.u0, row.dudphi).unwrap();
        let events = Exact.follow(ray, &[3.0, 6.0, 12.0, 30.0]).unwrap();
        assert_eq!(events.len(), group.len());
        for (event, found) in events.iter().zip(group) {
            assert_eq!(found.u0.to_bits(), row.u0.to_bits());
            assert_eq!(found.dudphi.to_bits(), row.dudphi.to_bits());
            assert_eq!((found.kind, found.radius), (event.kind, event.radius));
            assert_eq!(found.angle.to_bits(), event.angle.to_bits());
        }
    }
    assert!(listing(folder.path()).is_empty());
}

#[test]
fn trace_from_the_standard_table_is_as_right_as_the_table_promises() {
    let folder = tempdir().unwrap();
    let mut command = darkness(folder.path(), &["trace"]);
    command.stdin(fs::File::open(REFERENCE_RAYS).unwrap());
    let groups = rows(&String::from_utf8(finish(&mut command).0).unwrap());
    assert_eq!(listing(folder.path()), ["tables"]);
    let rays = reference_rays();
    assert_eq!(groups.len(), rays.len() + 1);
    for (row, group) in rays.iter().zip(&groups) {
        let found = group
            .iter()
            .find(|found| (found.kind, found.radius) == (row.kind, row.radius))
            .unwrap_or_else(|| panic!("{row:?}: not found"));
        let allowed = 1e-9 + 16.0 * f64::EPSILON * row.condition;
        let error = (found.angle - row.angle).abs();
        assert!(error <= allowed, "{row:?}: error {error:e}");
    }
}

#[test]
fn trace_takes_radial_rays_any_column_order_and_its_radii() {
    let folder = with_draft();
    let here = folder.path();
    let csv = "# by hand\n\nname, \"dudphi\" ,u0\r\n\"a, b\", inf ,0.1\nc,-inf,+2e-1\n";
    let zero = "0.0000000000000000e0,0.0,NaN";
    for method in ["table", "exact", "integrate"] {
        let args = ["trace", "-", "--table", "a.table", "--method", method];
        let radii = ["--radius", "7.5,2", "--radius", "1e20"];
        let output = fed(here, &[&args[..], &radii].concat(), csv);
        assert_eq!(
            String::from_utf8(output.stdout).unwrap(),
            format!(
                "{HEADER}\n\
                 1,0.1,inf,0.0,inbound,7.5,{zero}\n1,0.1,inf,0.0,inbound,2,{zero}\n1,0.1,inf,0.0,capture,1,{zero}\n\
                 2,0.2,-inf,0.0,outbound,7.5,{zero}\n2,0.2,-inf,0.0,outbound,1e20,{zero}\n\
                 2,0.2,-inf,0.0,escape,inf,{zero}\n"
            )
        );
    }
}

#[test]
fn trace_names_a_bad_row_and_goes_on_with_the_others() {
    let folder = with_draft();
    let here = folder.path();
    for (row, words) in [
        ("1.5,0", "u0 = 1.5"),
        ("0,1", "u0 = 0.0"),
        ("0.1,nan", "not a number"),
        ("0.1,quick", "\"quick\""),
        ("0.1", "1 fields"),
    ] {
        fs::write(
            here.join("rays.csv"),
            format!("u0,dudphi\n0.1,-inf\n{row}\n0.1,-inf\n"),
        )
        .unwrap();
        let args = ["trace", "rays.csv", "--table", "a.table", "--radius", "100"];
        let (output, stderr) = run(here, &args);
        assert_eq!(output.status.code(), Some(1));
        assert!(
            stderr.starts_with("darkness: rays.csv, line 3: ") && stderr.contains(words),
            "{stderr}"
        );
        let stdout = String::from_utf8(output.stdout).unwrap();
        assert!(stderr.contains("1 of 3 rows"), "{stderr}");
        // A header, and two events of each of the two good rows.
        assert_eq!(stdout.lines().count(), 5, "{stdout}");
    }
    // Only the first hundred bad rows are reported.
    let bad = "u0,dudphi\n".to_owned() + &"a,b\n".repeat(5000) + "0.1,-inf\n";
    fs::write(here.join("rays.csv"), bad).unwrap();
    let (_, stderr) = run(here, &["trace", "rays.csv", "--table", "a.table"]);
    assert_eq!(stderr.lines().count(), 101);
    assert!(
        stderr.contains("line 101: ") && stderr.contains("5000 of 5001 rows"),
        "{stderr}"
    );
    let args = ["trace", "--table", "a.table"];
    let headless = fed(here, &args, "0.1,0.2\n");
    fails(&headless, 1, &["standard input, line 1", "u0"]);
    fails(&fed(here, &args, ""), 1, &["standard input", "header"]);
    refused(here, &["trace", "no.csv"], 2, &["no.csv"]);
    let none = fed(here, &args, "u0,dudphi\na,b\n2,1\n");
    assert_eq!(none.status.code(), Some(1));
    let stderr = String::from_utf8(none.stderr).unwrap();
    assert!(
        stderr.ends_with("none of 2 rows holds a ray that can be followed\n"),
        "{stderr}"
    );
    assert_eq!(
        listing(here),
        ["a.table", "rays.csv"],
        "a table was made for nothing"
    );
}

/// The numbers of all rows, under the header that they must have; the ids are numbers.
fn table(here: &Path, args: &[&str], header: &str) -> Vec<Vec<f64>> {
    let csv = printed(here, args);
    let mut lines = csv.lines();
    assert_eq!(lines.next(), Some(header), "{args:?}");
    let row = |line: &str| {
        line.split(',')
            .map(|field| field.parse().unwrap())
            .collect()
    };
    lines.map(row).collect()
}

const PATH: &str = "id,phi,r,x,y";

#[test]
fn trace_tells_turning_points_and_deflections() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let text = fs::read_to_string("tests/reference/known_values.csv").unwrap();
    let mut known = 0;
    for line in text.lines().filter(|line| line.starts_with("deflection,")) {
        let fields: Vec<&str> = line.split(',').collect();
        let ratio: f64 = fields[1].parse().unwrap();
        let deflection: f64 = fields[2].parse().unwrap();
        let b = ratio * 1.5 * 3.0_f64.sqrt();
        let [b, near, far] = [b, b + 10.0, 100.0 * b].map(|number| format!("{number:?}"));
        // The deflection is that of the whole path, wherever the ray starts on it.
        for from in [&near, &far] {
            let args = [
                "trace", "--method", "exact", "--radius", "2.7", "--from", from, "--b", &b,
            ];
            let csv = printed(here, &args);
            let rows: Vec<Vec<&str>> = csv
                .lines()
                .skip(1)
                .map(|line| line.split(',').collect())
                .collect();
            let periapsis = rows.iter().position(|row| row[4] == "periapsis");
            let [at, last] = [periapsis.unwrap(), rows.len() - 1].map(|k| &rows[k]);
            for row in &rows {
                let found: f64 = row[8].parse().unwrap();
                // Rounding b changes it by 1e-16 / (b/bc - 1).
                let error = (found - deflection).abs();
                assert!(error < 1e-13 + 1e-15 / (ratio - 1.0), "{line}: {found}");
            }
            let [radius, b]: [f64; 2] = [at[5], &b].map(|field| field.parse().unwrap());
            // At a turning point b = r/sqrt(1 - 1/r).
            assert!(
                (radius / (1.0 - 1.0 / radius).sqrt() / b - 1.0).abs() < 1e-14,
                "{line}"
            );
            assert_eq!(last[4], "escape");
            known += 1;
        }
    }
    assert!(known >= 10, "{known}");
    let args = [
        "trace", "--method", "exact", "--radius", "1.2,1.05", "--from", "1.1", "--angle", "100,20",
    ];
    let csv = printed(here, &args);
    let events: Vec<Vec<&str>> = csv
        .lines()
        .skip(1)
        .map(|line| line.split(',').collect())
        .collect();
    let names: Vec<(&str, &str, &str)> =
        events.iter().map(|row| (row[0], row[4], row[8])).collect();
    let known = [
        ("1", "apoapsis", "NaN"),
        ("1", "inbound", "NaN"),
        ("1", "capture", "NaN"),
        ("2", "inbound", "NaN"),
        ("2", "capture", "NaN"),
    ];
    assert_eq!(names, known, "{csv}");
    assert!(listing(here).is_empty());
}

#[test]
fn trace_writes_paths() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let args = [
        "trace", "--from", "30", "--b", "2.5,2.7", "--angle", "100", "--paths", "200",
    ];
    let rows = table(here, &args, PATH);
    assert_eq!(rows.len(), 600);
    let rays = [
        Ray::from_impact_parameter(30.0, 2.5).unwrap(),
        Ray::from_impact_parameter(30.0, 2.7).unwrap(),
        Ray::from_angle(30.0, 100.0 * PI / 180.0).unwrap(),
    ];
    for (k, ray) in rays.into_iter().enumerate() {
        let path = &rows[200 * k..200 * (k + 1)];
        let ends = [path[0][2], path[199][2]];
        assert_eq!(ends, [30.0, if k == 0 { 1.0 } else { 60.0 }]);
        for row in path {
            let [id, phi, r, x, y] = row[..] else {
                panic!("{row:?}")
            };
            assert_eq!(id, (k + 1) as f64);
            assert_eq!([x, y], [r * libm::cos(phi), r * libm::sin(phi)]);
        }
        for row in &path[1..199] {
            let u = Exact.u_at_angle(ray, row[1]).unwrap().unwrap();
            assert!((1.0 / u - row[2]).abs() < 1e-9, "{row:?}");
        }
        let turning = Exact.turning_point(ray).unwrap();
        let there = turning.map(|turning| path.iter().any(|row| row[2] == 1.0 / turning.u));
        assert_eq!(there, (k == 1).then_some(true));
    }
    // A list's own ids, and the end that is given.
    let list = "id,r0,angle\n\"a, b\",10,120\nc,10,60\n";
    let output = fed(here, &["trace", "--paths", "3", "--to", "20"], list);
    let csv = String::from_utf8(output.stdout).unwrap();
    let lines: Vec<&str> = csv.lines().collect();
    assert!(lines[1].starts_with("\"a, b\",0.0,10.0,10.0,0.0"), "{csv}");
    assert!(
        lines[6].starts_with("c,") && lines[6].contains(",20.0,"),
        "{csv}"
    );
    assert!(listing(here).is_empty());
}

/// A pixel whose ray meets the disk shows it where the path meets the disk's plane.
#[test]
fn trace_follows_the_rays_of_pixels() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let header = format!("{PATH},scene_x,scene_y,scene_z");
    let args = [
        "trace", "--camera", "classic", "--pixel", "700,600", "--pixel", "1919,0", "--paths",
        "5000",
    ];
    let rows = table(here, &args, &header);
    assert_eq!(rows.len(), 10_000);
    for row in &rows {
        let [_, _, r, x, y, ..] = row[..] else {
            panic!("{row:?}")
        };
        let scene = glam::DVec3::from_slice(&row[5..]);
        assert!(
            (scene.length() / r - 1.0).abs() < 1e-14 && (libm::hypot(x, y) / r - 1.0).abs() < 1e-14
        );
    }
    let scene = darkness::scene::Scene::builtin("classic").unwrap();
    let camera = scene.camera();
    let view = darkness::scene::View::new(&scene);
    for (path, (i, j)) in rows.chunks(5000).zip([(700.5, 600.5), (1919.5, 0.5)]) {
        let place = |k: usize| glam::DVec3::from_slice(&path[k][5..]);
        assert!((place(0) - camera.position).length() < 1e-13);
        // Seen from the camera, the path begins in the direction of the pixel, up to the stretched radial part.
        let forward = (camera.focus - camera.position).normalize();
        let right = forward.cross(camera.up).normalize();
        let seen = forward + right * view.x_at(i) + right.cross(forward) * view.y_at(j);
        let p = camera.position.normalize();
        let across = |d: glam::DVec3| (d - p * d.dot(p)).normalize();
        assert!((across(place(1) - place(0)) - across(seen)).length() < 1e-9);
        let first = place(1) - place(0);
        let clock = view.clock_rate();
        let tangents = [first, seen].map(|d| (d - p * d.dot(p)).length() / -d.dot(p));
        // dr/(r dφ) = √(1 − u) cot ψ; the step's chord differs from the tangent.
        assert!(
            (tangents[0] * clock / tangents[1] - 1.0).abs() < 1e-3,
            "{tangents:?}"
        );
    }
    let png = [
        "trace", "--camera", "classic", "--pixel", "700,600", "--method", "exact",
    ];
    assert!(printed(here, &png).starts_with(HEADER));
}

#[test]
fn trace_refuses_rays_that_are_none() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    fs::write(here.join("rays.csv"), "b\n3\n").unwrap();
    for (line, words) in [
        ("--from 30 --b 31", "--b: the impact parameter 31.0"),
        ("--from 30 --b 3,-1", "--b: the impact parameter -1.0"),
        ("--from 30 --b nan", "--b: the impact parameter NaN"),
        ("--from 30 --b x", "invalid float"),
        ("--from 30 --angle 181", "from 0 to 180 degrees"),
        ("--from 1 --b 3", "above 1"),
        ("--from -30 --b 3", "above 1"),
        ("--b 3", "--from"),
        ("--angle 3", "--from"),
        ("rays.csv --from 30 --b 3", "cannot be used with"),
        ("--camera classic", "--pixel"),
        ("--pixel 1,2", "--camera"),
        (
            "--camera classic --pixel 1920,0",
            "columns 0 to 1919 and rows 0 to 1079",
        ),
        ("--camera classic --pixel 0,1080", "outside of the picture"),
        ("--camera classic --pixel -1,5", "two whole numbers"),
        ("--camera classic --pixel 5", "two whole numbers"),
        ("--camera clasic --pixel 1,2", "clasic"),
        (
            "--camera classic --pixel 1,2 --from 30",
            "cannot be used with",
        ),
        ("rays.csv --from 30 --paths 2", "3..=1000000"),
        ("rays.csv --from 30 --paths 1000001", "3..=1000000"),
        ("rays.csv --from 30 --paths 20 --to 1", "above 1"),
        ("rays.csv --from 30 --to 20", "--paths"),
        (
            "rays.csv --from 30 --paths 20 --method table",
            "cannot be used with",
        ),
        (
            "rays.csv --from 30 --paths 20 --radius 3",
            "cannot be used with",
        ),
    ] {
        let args: Vec<&str> = ["trace"].into_iter().chain(line.split(' ')).collect();
        refused(here, &args, 2, &[words]);
    }
    refused(
        here,
        &["trace", "rays.csv", "--paths", "5"],
        1,
        &["line 1", "--from"],
    );
    let args = [
        "trace", "--from", "30", "--angle", "100,10", "--paths", "5", "--to", "20",
    ];
    let (output, stderr) = run(here, &args);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        stderr.contains("ray 1: the ray does not go outward through radius 20.0"),
        "{stderr}"
    );
    assert_eq!(String::from_utf8(output.stdout).unwrap().lines().count(), 6);
    assert_eq!(listing(here), ["rays.csv"]);
}
