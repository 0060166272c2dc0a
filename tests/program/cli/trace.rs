//! `darkness trace`.

use std::fs;

use darkness::orbit::exact::Exact;
use darkness::orbit::{EventKind, Fate, Orbits, Ray};
use tempfile::tempdir;

use crate::harness::{
    REFERENCE_RAYS, darkness, fails, fed, finish, listing, printed, refused, run, with_draft,
};
use crate::reference_rays::reference_rays;

/// One row of the output of `trace`.
struct Row {
    u0: f64,
    dudphi: f64,
    kind: EventKind,
    radius: f64,
    angle: f64,
}

/// The rows that `trace` printed, grouped by ray.
fn rows(csv: &str) -> Vec<Vec<Row>> {
    let mut lines = csv.lines();
    assert_eq!(lines.next(), Some("u0,dudphi,event,radius,angle"));
    let rows: Vec<Row> = lines
        .map(|line| {
            let fields: Vec<&str> = line.split(',').collect();
            let [u0, dudphi, event, radius, angle] = fields[..] else {
                panic!("{line}");
            };
            let kind = match event {
                "inbound" => EventKind::Inbound,
                "outbound" => EventKind::Outbound,
                "capture" => EventKind::End(Fate::Capture),
                "escape" => EventKind::End(Fate::Escape),
                _ => panic!("{line}"),
            };
            let [u0, dudphi, radius, angle] =
                [u0, dudphi, radius, angle].map(|field| field.parse().unwrap());
            Row {
                u0,
                dudphi,
                kind,
                radius,
                angle,
            }
        })
        .collect();
    rows.into_iter().fold(vec![Vec::new()], |mut groups, row| {
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
    let zero = "0.0000000000000000e0";
    for method in ["table", "exact", "integrate"] {
        let args = ["trace", "-", "--table", "a.table", "--method", method];
        let radii = ["--radius", "7.5,2", "--radius", "1e20"];
        let output = fed(here, &[&args[..], &radii].concat(), csv);
        assert_eq!(
            String::from_utf8(output.stdout).unwrap(),
            format!(
                "u0,dudphi,event,radius,angle\n\
                 0.1,inf,inbound,7.5,{zero}\n0.1,inf,inbound,2,{zero}\n0.1,inf,capture,1,{zero}\n\
                 0.2,-inf,outbound,7.5,{zero}\n0.2,-inf,outbound,1e20,{zero}\n0.2,-inf,escape,inf,{zero}\n"
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
