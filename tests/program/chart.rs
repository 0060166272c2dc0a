//! Guards against a chart that leaves out a method, hides its failures, or writes where it should not. The times that a
//! chart measures are the machine's and are not tested; its errors are.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use tempfile::tempdir;

use crate::harness::{listing, refused, run};

const HEADER: &str =
    "panel,method,setting,ns_per_ray,ratio_to_rk4,error_p50,error_p99,error_max,failures,count";

const METHODS: [&str; 7] = [
    "euler",
    "rk4",
    "adaptive",
    "exact",
    "table-draft",
    "table-standard",
    "table-fine",
];

/// The scene `classic`, small.
fn small_scene(folder: &Path) {
    let scene = darkness::scene::Scene::builtin("classic").unwrap();
    let small = scene.with_size(64, 36).unwrap();
    fs::write(folder.join("small.toml"), small.to_toml()).unwrap();
}

/// A row of the CSV.
struct Row<'a> {
    fields: Vec<&'a str>,
}

impl<'a> Row<'a> {
    fn panel(&self) -> &'a str {
        self.fields[0]
    }

    fn method(&self) -> &'a str {
        self.fields[1]
    }

    /// The value of one of the setting's `key=value` words.
    fn word(&self, name: &str) -> Option<&'a str> {
        let words = self.fields[2].split(' ');
        words
            .filter_map(|word| word.split_once('='))
            .find(|(key, _)| *key == name)
            .map(|(_, value)| value)
    }

    fn number(&self, column: &str) -> Option<f64> {
        let at = HEADER.split(',').position(|name| name == column).unwrap();
        let field = self.fields[at];
        let number = || {
            field
                .parse()
                .unwrap_or_else(|_| panic!("{column}: {field:?}"))
        };
        (!field.is_empty()).then(number)
    }
}

/// The file's rows, after a check of its first two lines.
fn rows(csv: &str) -> Vec<Row<'_>> {
    let mut lines = csv.lines();
    let comment = lines.next().unwrap();
    for word in ["# darkness ", "core", "ratio_to_rk4", "faster than RK4"] {
        assert!(comment.contains(word), "{word:?} is not in {comment:?}");
    }
    assert_eq!(lines.next(), Some(HEADER));
    lines
        .map(|line| {
            let fields: Vec<_> = line.split(',').collect();
            assert_eq!(fields.len(), 10, "{line}");
            Row { fields }
        })
        .collect()
}

/// Panics unless `text` is one element with all its tags closed in order and its attributes quoted.
fn check_xml(text: &str) {
    let mut open = Vec::new();
    let mut rest = text;
    let mut roots = 0;
    while let Some(start) = rest.find('<') {
        let before = &rest[..start];
        assert!(!before.contains('>'), "a stray > in {before:?}");
        for (at, _) in before.match_indices('&') {
            let entity = &before[at..];
            let known = ["&amp;", "&lt;", "&gt;", "&quot;", "&apos;", "&#"];
            assert!(
                known.iter().any(|known| entity.starts_with(known)),
                "{entity:?}"
            );
        }
        let end = start + rest[start..].find('>').expect("a tag that does not end");
        let tag = &rest[start + 1..end];
        rest = &rest[end + 1..];
        if tag.starts_with('?') || tag.starts_with('!') {
            continue;
        }
        assert_eq!(tag.matches('"').count() % 2, 0, "{tag:?}");
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name), "</{name}>");
        } else {
            let name = tag.split_whitespace().next().unwrap().trim_end_matches('/');
            roots += usize::from(open.is_empty());
            if !tag.ends_with('/') {
                open.push(name);
            }
        }
    }
    assert!(open.is_empty(), "not closed: {open:?}");
    assert_eq!(roots, 1);
    assert!(rest.trim().is_empty(), "after the end: {rest:?}");
}

#[test]
fn a_quick_chart_has_every_method_with_its_errors_and_failures() {
    let folder = tempdir().unwrap();
    small_scene(folder.path());
    let args = [
        "chart",
        "small.toml",
        "--quick",
        "-o",
        "a.svg",
        "--csv",
        "a.csv",
    ];
    let (output, stderr) = run(folder.path(), &args);
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    let told = String::from_utf8(output.stdout).unwrap();
    assert!(
        told.starts_with("small: ") && told.lines().count() == 1,
        "{told}"
    );

    let svg = fs::read_to_string(folder.path().join("a.svg")).unwrap();
    check_xml(&svg);
    for label in [
        "Euler",
        "RK4",
        "adaptive (DOP853)",
        "exact",
        "table draft",
        "table standard",
        "table fine",
        "tables of other sizes",
        "Pareto front",
        "table draft, map",
        "exact, by pixel",
        "failed",
        "small at 64 × 36",
    ] {
        assert!(svg.contains(label), "{label:?} is not in the figure");
    }

    let csv = fs::read_to_string(folder.path().join("a.csv")).unwrap();
    let rows = rows(&csv);
    let of = |panel: &'static str| rows.iter().filter(move |row| row.panel() == panel);
    for panel in ["rays", "critical", "scene", "light"] {
        let methods: BTreeSet<_> = of(panel).map(Row::method).collect();
        let mut expected = BTreeSet::from(METHODS);
        if panel == "light" {
            expected.remove("euler");
        }
        if panel == "rays" {
            expected.insert("table-scaled");
        }
        assert_eq!(methods, expected, "{panel}");
    }
    for row in &rows {
        let of_one = [row.number("failures"), row.number("count")];
        let [Some(failures), Some(count)] = of_one else {
            panic!("{:?}", row.fields)
        };
        assert!(failures <= count && count > 0.0, "{:?}", row.fields);
        let timed = row.panel() != "critical";
        for column in ["ns_per_ray", "ratio_to_rk4"] {
            let time = row.number(column);
            assert_eq!(time.is_some(), timed, "{:?}", row.fields);
            assert!(time.is_none_or(|time| time > 0.0), "{:?}", row.fields);
        }
        let errors = ["error_p50", "error_p99", "error_max"].map(|column| row.number(column));
        if let [Some(p50), Some(p99), Some(max)] = errors {
            assert!(0.0 <= p50 && p50 <= p99 && p99 <= max, "{:?}", row.fields);
        }
    }
    rays_are_as_wrong_as_they_should_be(&of("rays").collect::<Vec<_>>());
    failures_are_told(&of("critical").collect::<Vec<_>>());
    edges_are_where_they_should_be(&of("scene").collect::<Vec<_>>());
    light_is_as_right_as_it_should_be(&of("light").collect::<Vec<_>>());

    // The verdict is on the standard error, and its two parts are lines of the figure.
    let verdict = stderr.lines().find(|line| line.contains("edges right to"));
    let verdict = verdict.unwrap_or_else(|| panic!("no verdict: {stderr}"));
    let (edges, colours) = verdict.split_at(verdict.find("in colour").unwrap());
    for (part, words) in [(edges, "0.001 pixels: table "), (colours, "1e-6: table ")] {
        assert!(svg.contains(part.trim()), "{part:?} is not in the figure");
        for word in [words, " ms, RK4 ", " ×"] {
            assert!(part.contains(word), "{word:?} is not in {part:?}");
        }
    }
}

fn rays_are_as_wrong_as_they_should_be(rows: &[&Row<'_>]) {
    let p99 = |row: &&Row<'_>| row.number("error_p99").unwrap();
    for (method, knob) in [("rk4", "h"), ("euler", "h")] {
        let mut settings: Vec<_> = rows
            .iter()
            .filter(|row| row.method() == method)
            .map(|row| (row.word(knob).unwrap().parse::<f64>().unwrap(), p99(row)))
            .collect();
        settings.sort_by(|a, b| b.0.total_cmp(&a.0));
        assert!(settings.len() >= 3);
        let finer_is_better = settings.windows(2).all(|pair| pair[1].1 < pair[0].1);
        assert!(finer_is_better, "{method}: {settings:?}");
    }
    let of = |method: &str| {
        rows.iter()
            .find(|row| row.method() == method)
            .map(p99)
            .unwrap()
    };
    for (method, promised) in [
        ("table-draft", 1e-6),
        ("table-standard", 1e-9),
        ("table-fine", 1e-12),
        ("exact", 1e-13),
    ] {
        assert!(of(method) <= promised, "{method}: {:e}", of(method));
    }
    let baseline = rows
        .iter()
        .find(|row| row.number("ratio_to_rk4") == Some(1.0));
    let baseline = p99(baseline.unwrap());
    assert!((0.9e-6..=1e-6).contains(&baseline), "{baseline:e}");
}

fn failures_are_told(rows: &[&Row<'_>]) {
    let failures = |method: &str, close: bool| -> f64 {
        let of = rows.iter().filter(|row| row.method() == method);
        let there = of.filter(|row| {
            let distance: f64 = row.word("distance").unwrap().parse().unwrap();
            (distance < 1e-9) == close
        });
        there.map(|row| row.number("failures").unwrap()).sum()
    };
    assert!(failures("rk4", true) > 0.0 && failures("euler", true) > 0.0);
    for method in ["exact", "table-draft", "table-standard", "table-fine"] {
        assert_eq!(
            failures(method, true) + failures(method, false),
            0.0,
            "{method}"
        );
    }
    for method in METHODS {
        for side in ["escape", "capture"] {
            let there = |row: &&&Row<'_>| row.method() == method && row.word("side") == Some(side);
            assert!(rows.iter().filter(there).count() >= 10, "{method}, {side}");
        }
    }
}

fn edges_are_where_they_should_be(rows: &[&Row<'_>]) {
    let finest = rows.iter().filter(|row| {
        row.method() == "table-standard" && row.word("curve-tolerance") == Some("1e-4")
    });
    let mut orders = 0;
    for row in finest {
        assert_eq!(row.number("failures"), Some(0.0), "{:?}", row.fields);
        if let Some(error) = row.number("error_max") {
            assert!(error <= 1e-4, "{:?}", row.fields);
            orders += 1;
        }
    }
    assert!(orders >= 2, "{orders}");
}

fn light_is_as_right_as_it_should_be(rows: &[&Row<'_>]) {
    let row = |method: &str, key: &str, value: &str, of: &str| {
        let mut found = rows.iter().filter(|row| {
            row.method() == method && row.word(key) == Some(value) && row.word("of") == Some(of)
        });
        let row = found.next();
        row.unwrap_or_else(|| panic!("{method}, {key}={value}, {of}"))
    };
    // Edges that hard pixels show are those of their centres' rays, by every method but coarse steps.
    for row in rows.iter().filter(|row| row.method() != "rk4") {
        assert_eq!(row.number("failures"), Some(0.0), "{:?}", row.fields);
    }
    let worst = |method: &str, key: &str, value: &str, of: &str| {
        row(method, key, value, of).number("error_max").unwrap()
    };
    let (coarse, fine) = (
        worst("rk4", "h", "0.2", "redshift"),
        worst("rk4", "h", "0.02", "redshift"),
    );
    assert!(coarse > 100.0 * fine && fine < 1e-5, "{coarse:e}, {fine:e}");
    // A float of 32 bits holds a redshift to 6e-8, the drawing adds as much, and the draft table's angles 6e-7 rad.
    for (method, by_pixel, by_map) in [
        ("exact", 1e-13, 2e-7),
        ("table-fine", 1e-11, 2e-7),
        ("table-standard", 1e-8, 2e-7),
        ("table-draft", 5e-6, 5e-6),
    ] {
        for (drawn, promised) in [
            ("pixel-by-pixel", by_pixel),
            ("map-of-new-radius", by_map),
            ("map-of-same-radius", by_map),
        ] {
            let redshift = worst(method, "drawn", drawn, "redshift");
            assert!(redshift <= promised, "{method}, {drawn}: {redshift:e}");
            // Luminance rises with up to the tenth power of the redshift, and its table is right to 1e-5.
            let luminance = worst(method, "drawn", drawn, "luminance");
            assert!(luminance <= 1e-4, "{method}, {drawn}: {luminance:e}");
        }
    }
}

#[test]
fn nothing_is_measured_for_files_that_cannot_be_written() {
    let folder = tempdir().unwrap();
    small_scene(folder.path());
    fs::create_dir(folder.path().join("there")).unwrap();
    let before = fs::read(folder.path().join("small.toml")).unwrap();
    #[cfg(unix)]
    std::os::unix::fs::symlink("../x.csv", folder.path().join("there/link.svg")).unwrap();
    for (args, code, words) in [
        (&["-o", "a.png"][..], 2, &[".svg"][..]),
        (&["no-such-scene"], 2, &["no-such-scene"]),
        (&["grid"], 2, &["[disk]"]),
        (&["-o", "small.toml/a.svg"], 1, &["small.toml", "-o"]),
        (&["--csv", "small.toml/a.csv"], 1, &["small.toml", "--csv"]),
        (&["--csv", "there"], 1, &["folder", "--csv"]),
        (&["--csv", "-"], 2, &["--csv"]),
        (
            &["-o", "a.svg", "--csv", "there/../a.svg"],
            2,
            &["-o and --csv"],
        ),
        // A link to a file that does not exist yet.
        #[cfg(unix)]
        (
            &["-o", "there/link.svg", "--csv", "x.csv"],
            2,
            &["-o and --csv"],
        ),
        (
            &["small.toml", "--csv", "small.toml"],
            2,
            &["--csv", "scene"],
        ),
    ] {
        refused(folder.path(), &[&["chart"], args].concat(), code, words);
    }
    assert_eq!(listing(folder.path()), ["small.toml", "there"]);
    assert_eq!(fs::read(folder.path().join("small.toml")).unwrap(), before);
}
