//! Guards against a command line that writes where it should not, goes on with what is wrong, panics, or says
//! something else than the library answers.

mod common;

use std::fs;
use std::path::Path;
use std::process::{Command as Process, Stdio};

use assert_cmd::Command;
use assert_cmd::cargo::{cargo_bin, cargo_bin_cmd};
use common::reference_rays;
use darkness::orbit::exact::Exact;
use darkness::orbit::{EventKind, Fate, Orbits, Ray};
use darkness::scene::builtins;
use darkness::table::Spec;
use darkness::table::format::VERSION;
use tempfile::{TempDir, tempdir};

const SMALL: &str = "96x54";

const REFERENCE_RAYS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/reference/rays.csv");

/// The program with these arguments, run in `folder`.
fn darkness(folder: &Path, args: &[&str]) -> Command {
    let mut command = cargo_bin_cmd!("darkness");
    command
        .current_dir(folder)
        .env_remove("DARKNESS_TABLE")
        .args(args);
    command
}

/// Runs it, expects it to be done, and returns what it printed: standard output, standard error.
fn done(mut command: Command) -> (Vec<u8>, String) {
    let output = command.output().unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(0), "{command:?}: {stderr}");
    (output.stdout, stderr)
}

fn printed(command: Command) -> String {
    String::from_utf8(done(command).0).unwrap()
}

/// Runs it, and expects it to end with `code`, a sentence that has all of `words`, and nothing on the standard
/// output.
fn refused(mut command: Command, code: i32, words: &[&str]) {
    let output = command.output().unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(code), "{command:?}: {stderr}");
    assert!(
        stderr.starts_with("darkness: ") || (code == 2 && stderr.starts_with("error: ")),
        "{stderr}"
    );
    for word in words {
        assert!(stderr.contains(word), "{word:?} is not in: {stderr}");
    }
    assert!(output.stdout.is_empty(), "{command:?} printed something");
}

/// All that is in a folder, sorted.
fn listing(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

/// A folder with the draft table in it, which takes milliseconds to make.
fn with_draft() -> TempDir {
    let folder = tempdir().unwrap();
    done(darkness(
        folder.path(),
        &["table", "draft", "-o", "a.table"],
    ));
    folder
}

#[test]
fn render_works_at_once_in_an_empty_folder_and_leaves_nothing_else() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let (stdout, stderr) = done(darkness(here, &["render"]));
    assert!(stdout.is_empty());
    for words in [
        "tables/standard.table is not there yet",
        "classic.png: 1920 × 1080, table standard (error ",
    ] {
        assert!(stderr.contains(words), "{stderr}");
    }
    assert_eq!(listing(here), ["classic.png", "tables"]);
    assert_eq!(listing(&here.join("tables")), ["standard.table"]);
    let picture = image::open(here.join("classic.png")).unwrap().into_luma8();
    assert_eq!(picture.dimensions(), (1920, 1080));
    let white = picture.pixels().filter(|pixel| pixel.0 == [255]).count();
    assert!(
        (200_000..1_600_000).contains(&white),
        "{white} white pixels"
    );

    // The second time the table is there, and -q says nothing.
    let before = fs::read(here.join("classic.png")).unwrap();
    let (_, stderr) = done(darkness(here, &["render", "-q"]));
    assert_eq!(stderr, "");
    assert_eq!(fs::read(here.join("classic.png")).unwrap(), before);
}

/// The table follows from the picture: the draft one for a small picture, none for one that even the fine table is
/// too coarse for; `--explain` tells which and why, and draws nothing.
#[test]
fn a_picture_takes_the_smallest_table_that_is_good_enough() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    for (tolerance, name) in [("0.001", "draft"), ("1e-5", "standard"), ("1e-8", "fine")] {
        let size = ["--size", SMALL, "--tolerance", tolerance];
        let (_, stderr) = done(darkness(here, &[&["render"][..], &size].concat()));
        let words = [
            format!("tables/{name}.table is not there yet"),
            format!("96 × 54, table {name} (error "),
        ];
        for words in words {
            assert!(stderr.contains(&words), "{stderr}");
        }
        let explain = [&["render", "--explain"][..], &size].concat();
        let explained = printed(darkness(here, &explain));
        for words in [
            "96 × 54, edges to be right to ",
            &format!("{name} (tables/{name}.table), error "),
            "orders      0: ",
            "and up are left out",
            "edge error  ",
        ] {
            assert!(explained.contains(words), "no {words} in:\n{explained}");
        }
    }
    let finest = ["render", "--size", SMALL, "--tolerance", "1e-10"];
    let (_, stderr) = done(darkness(here, &finest));
    assert!(stderr.contains("exact curves"), "{stderr}");
    fs::remove_file(here.join("classic.png")).unwrap();
    done(darkness(here, &[&finest[..], &["--explain"]].concat()));
    assert_eq!(listing(here), ["tables"]);
    assert_eq!(
        listing(&here.join("tables")),
        ["draft.table", "fine.table", "standard.table"]
    );

    // A table that somebody names is taken all the same, and what comes of it is said.
    let coarse = ["--table", "tables/draft.table", "--tolerance", "1e-6"];
    let (_, stderr) = done(darkness(
        here,
        &[&["render", "--size", SMALL][..], &coarse].concat(),
    ));
    assert!(
        stderr.contains("the standard table is good enough"),
        "{stderr}"
    );
}

#[test]
fn tolerances_that_make_no_sense_are_misuse() {
    let folder = tempdir().unwrap();
    for (args, words) in [
        (&["--tolerance", "0"][..], "image.tolerance = 0.0"),
        (&["--tolerance", "-1"], "image.tolerance = -1.0"),
        (&["--tolerance", "nan"], "image.tolerance = NaN"),
        (&["--tolerance", "2"], "at most 1 pixel"),
        (
            &["--tolerance", "0.1", "--method", "exact"],
            "--tolerance is about isoradial curves",
        ),
        (
            &["--explain", "--method", "integrate"],
            "--explain is about isoradial curves",
        ),
        (
            &["--antialias", "true", "--method", "exact"],
            "--antialias is about isoradial curves",
        ),
        (&["--explain", "-o", "x.png"], "--explain"),
    ] {
        refused(
            darkness(folder.path(), &[&["render"], args].concat()),
            2,
            &[words],
        );
    }
    assert!(listing(folder.path()).is_empty());
}

#[test]
fn other_methods_need_no_table_and_draw_the_same_picture() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    for args in [
        &["render", "--method", "exact", "-o", "e.png"][..],
        &["render", "--method", "integrate", "-o", "i.png"],
        &[
            "render",
            "--method=integrate",
            "--integrate-tolerance=1e-5",
            "-o",
            "j.PNG",
        ],
    ] {
        let mut command = darkness(here, args);
        command.args(["--size", SMALL, "--table", "missing.table"]);
        done(command);
    }
    assert_eq!(listing(here), ["e.png", "i.png", "j.PNG"]);
    let hard = ["--antialias", "false", "--size", SMALL, "-o", "t.png"];
    done(darkness(here, &[&["render"][..], &hard].concat()));
    let pixels = |name: &str| image::open(here.join(name)).unwrap().into_luma8();
    for name in ["i.png", "j.PNG", "t.png"] {
        let pairs = pixels("e.png").into_raw().into_iter();
        let pairs = pairs.zip(pixels(name).into_raw());
        // A pixel whose centre is on an edge to the last digits may fall to either side.
        let different = pairs.filter(|(a, b)| a != b).count();
        assert!(different <= 1, "{name}: {different} pixels differ");
    }
}

#[test]
fn the_picture_can_go_to_the_standard_output() {
    let folder = with_draft();
    let here = folder.path();
    let draw = |to: &str| {
        let args = ["render", "--table", "a.table", "--size", SMALL, "-o", to];
        done(darkness(here, &args)).0
    };
    assert_eq!(draw("x.png"), b"");
    assert_eq!(draw("-"), fs::read(here.join("x.png")).unwrap());
    assert_eq!(listing(here), ["a.table", "x.png"]);
}

#[test]
fn render_checks_where_the_picture_goes_before_any_work() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    fs::create_dir(here.join("folder.png")).unwrap();
    fs::write(here.join("file"), "").unwrap();
    let before = listing(here);
    for (output, code, words) in [
        ("x.jpg", 2, &["x.jpg", ".png"][..]),
        ("x", 2, &[".png"]),
        ("folder.png", 1, &["folder.png is a folder"]),
        ("no/x.png", 1, &["no/x.png", "the folder no does not exist"]),
        ("file/x.png", 1, &["file/x.png", "file is no folder"]),
    ] {
        refused(darkness(here, &["render", "-o", output]), code, words);
    }
    // No one may write here, not even root, to whom modes mean nothing.
    #[cfg(target_os = "linux")]
    refused(
        darkness(here, &["render", "-o", "/proc/x.png"]),
        1,
        &["/proc/x.png", "nothing can be written"],
    );
    assert_eq!(listing(here), before, "something was written");
}

#[test]
fn render_does_not_write_over_what_it_reads() {
    let folder = with_draft();
    let here = folder.path();
    fs::rename(here.join("a.table"), here.join("table.png")).unwrap();
    fs::write(here.join("scene.png"), builtins()[0].toml()).unwrap();
    let before = fs::read(here.join("table.png")).unwrap();
    let args = ["render", "--table", "table.png", "-o", "./table.png"];
    refused(darkness(here, &args), 2, &["table.png", "the table"]);
    // The scene's default picture has the scene's own name here.
    let args = ["render", "--table", "table.png", "scene.png"];
    refused(darkness(here, &args), 2, &["scene.png", "the scene"]);
    assert_eq!(fs::read(here.join("table.png")).unwrap(), before);
    assert_eq!(listing(here), ["scene.png", "table.png"]);
}

#[test]
fn bad_options_are_misuse() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    for (args, words) in [
        (&["render", "--threads", "0"][..], "--threads"),
        (&["render", "--size", "96"], "1920x1080"),
        (&["render", "--size", "0x54"], "--size 0x54"),
        (&["render", "--size=-1x54"], "--size"),
        (&["render", "--size", "1000000x1000000"], "--size"),
        (&["render", "--method", "guess"], "integrate"),
        (
            &["render", "--integrate-tolerance", "1e-9"],
            "--method integrate",
        ),
        (
            &[
                "trace",
                "--method",
                "integrate",
                "--integrate-tolerance",
                "nan",
            ],
            "1e-13",
        ),
        (&["trace", "--radius", "1"], "above 1"),
        (&["trace", "--radius", "3,-6"], "above 1"),
        (&["trace", "--radius", "inf"], "above 1"),
        (&["table", "coarse"], "standard"),
        (&["table", "-o", "-"], "standard output"),
        (&["table", "draft", "inspect", "a.table"], "inspect"),
        (&["paint"], "paint"),
    ] {
        refused(darkness(here, args), 2, &[words]);
    }
    assert!(listing(here).is_empty(), "{:?}", listing(here));
}

#[test]
fn help_and_version_are_answers_and_no_verb_is_misuse() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    for args in [
        &["--help"][..],
        &["render", "--help"],
        &["table", "verify", "-h"],
        &["--version"],
    ] {
        assert!(printed(darkness(here, args)).len() > 10);
    }
    let output = darkness(here, &[]).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(stderr.contains("Usage:") && stderr.contains("Examples:"));
}

#[test]
fn bad_scenes_are_refused_with_their_name() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    refused(
        darkness(here, &["render", "clasic"]),
        1,
        &["clasic", "edge-on"],
    );
    refused(darkness(here, &["render", "."]), 1, &["scene file ."]);
    let text = builtins()[0].toml().replace("inner = 3.0", "inner = 2.0");
    fs::write(here.join("mine.toml"), text).unwrap();
    refused(
        darkness(here, &["render", "mine.toml"]),
        1,
        &["mine.toml", "disk.inner = 2.0", "ISCO"],
    );
    assert_eq!(listing(here), ["mine.toml"]);
}

#[test]
fn only_the_default_table_is_made_unasked() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let render = ["render", "--size", SMALL];
    let words = ["other.table", "darkness table standard"];
    let mut flag = darkness(here, &render);
    flag.args(["--table", "other.table"]);
    refused(flag, 1, &words);
    let mut variable = darkness(here, &render);
    variable.env("DARKNESS_TABLE", "other.table");
    refused(variable, 1, &[words[0], words[1], "DARKNESS_TABLE"]);
    assert!(listing(here).is_empty());

    // The flag goes before the environment, and an empty variable is none.
    done(darkness(here, &["table", "draft", "-o", "d.table"]));
    for (variable, flag, words) in [
        ("other.table", &["--table", "d.table"][..], "table draft"),
        ("d.table", &[], "table draft"),
        // A small picture needs the draft table, one with edges ten times as right the standard one.
        ("", &["--tolerance", "0.0001"], "table standard"),
    ] {
        let mut command = darkness(here, &render);
        command.env("DARKNESS_TABLE", variable).args(flag);
        let (_, stderr) = done(command);
        assert!(stderr.contains(words), "{stderr}");
    }
    assert_eq!(listing(here), ["classic.png", "d.table", "tables"]);
}

#[test]
#[cfg(target_os = "linux")]
fn a_table_that_cannot_be_kept_is_used_all_the_same() {
    let folder = tempdir().unwrap();
    let picture = folder.path().join("x.png");
    let mut command = darkness(Path::new("/proc"), &["render", "-q", "--size", SMALL, "-o"]);
    command.arg(&picture);
    let (_, stderr) = done(command);
    assert!(
        stderr.starts_with("darkness: tables/draft.table: the table cannot be kept"),
        "{stderr}"
    );
    assert!(picture.exists());
}

#[test]
fn a_table_that_is_not_whole_is_refused_and_left_as_it_is() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    done(darkness(here, &["table", "draft", "-o", "good"]));
    let good = fs::read(here.join("good")).unwrap();
    fs::create_dir(here.join("tables")).unwrap();
    let default = here.join("tables/standard.table");
    let flipped = |at: usize| {
        let mut bytes = good.clone();
        bytes[at] ^= 0x10;
        bytes
    };
    let end = good.len() - 1;
    for (bytes, problem) in [
        (flipped(0), "not a darkness table"),
        (flipped(8), &format!("format {}", VERSION ^ 0x10)),
        (flipped(16), "damaged"),
        (flipped(40), "damaged"),
        (flipped(good.len() / 2), "damaged"),
        (flipped(end), "damaged"),
        (good[..end].to_vec(), "bytes long"),
        (good[..20].to_vec(), "bytes long"),
        ([&good[..], &[0]].concat(), "bytes long"),
        (Vec::new(), "not a darkness table"),
        (b"u0,dudphi\n".to_vec(), "not a darkness table"),
    ] {
        fs::write(&default, &bytes).unwrap();
        let words = ["tables/standard.table", problem, "--force"];
        for args in [
            &["render"][..],
            &["trace", REFERENCE_RAYS],
            &["table"],
            &["table", "inspect", "tables/standard.table"],
            &["table", "verify", "tables/standard.table"],
        ] {
            refused(darkness(here, args), 1, &words);
            assert_eq!(fs::read(&default).unwrap(), bytes, "{args:?} changed it");
        }
    }
    assert_eq!(listing(here), ["good", "tables"]);
    assert_eq!(listing(&here.join("tables")), ["standard.table"]);

    // What the message says helps.
    done(darkness(here, &["table", "standard", "--force"]));
    done(darkness(
        here,
        &["table", "verify", "tables/standard.table"],
    ));
}

#[test]
fn a_table_is_made_once_and_replaced_only_on_demand() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let (stdout, stderr) = done(darkness(here, &["table", "draft"]));
    assert!(stdout.is_empty() && stderr.contains("tables/draft.table: table draft"));
    let path = here.join("tables/draft.table");
    let made = fs::metadata(&path).unwrap().modified().unwrap();
    let (_, stderr) = done(darkness(here, &["table", "draft"]));
    assert!(stderr.contains("already there"), "{stderr}");
    assert_eq!(fs::metadata(&path).unwrap().modified().unwrap(), made);

    let other = ["table", "standard", "-o", "tables/draft.table"];
    refused(darkness(here, &other), 1, &["draft", "--force"]);
    let mut forced = darkness(here, &other);
    forced.arg("--force");
    done(forced);
    let inspected = printed(darkness(here, &["table", "inspect", "tables/draft.table"]));
    assert!(inspected.contains("standard"), "{inspected}");

    for (place, words) in [
        ("tables", "tables is a folder"),
        ("tables/draft.table/x", "is no folder"),
        #[cfg(target_os = "linux")]
        ("/dev/null", "no regular file"),
        #[cfg(target_os = "linux")]
        ("/proc/a/b.table", "nothing can be written"),
    ] {
        let args = ["table", "draft", "--force", "-o", place];
        refused(darkness(here, &args), 1, &[place, words]);
    }
    assert_eq!(listing(&here.join("tables")), ["draft.table"]);
}

#[test]
fn inspect_and_verify_tell_what_a_table_is() {
    let folder = with_draft();
    let here = folder.path();
    let size = fs::metadata(here.join("a.table")).unwrap().len();
    let lines = printed(darkness(here, &["table", "inspect", "a.table"]));
    for words in ["draft", "1e-6 rad", &format!("{size} bytes")] {
        assert!(lines.contains(words), "{lines}");
    }
    let json = printed(darkness(here, &["table", "inspect", "a.table", "--json"]));
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["name"], "draft");
    assert_eq!(json["tolerance"], 1e-6);
    assert_eq!(json["file_bytes"], size);
    let spec = Spec::named("draft").unwrap();
    assert_eq!(json["grid"]["critical"]["place"], spec.critical.place);
    let error = json["measured_error"].as_f64().unwrap();
    assert!(error > 0.0 && error <= 1e-6, "{error}");
    assert!(json["measured_angles"].as_u64().unwrap() > 1000);

    let verified = printed(darkness(here, &["table", "verify", "a.table"]));
    assert!(
        verified.contains(&format!("all {size} bytes")),
        "{verified}"
    );
    refused(
        darkness(here, &["table", "verify", "no.table"]),
        1,
        &["no.table"],
    );
}

#[test]
fn verify_finds_what_the_checksums_cannot() {
    let folder = with_draft();
    let here = folder.path();
    let mut bytes = fs::read(here.join("a.table")).unwrap();
    // One bit of the last number, and all checksums put right: a whole file with a wrong table in it.
    let end = bytes.len();
    bytes[end - 8] ^= 1;
    let numbers = usize::try_from(u64::from_le_bytes(bytes[24..32].try_into().unwrap())).unwrap();
    let crc = crc32fast::hash(&bytes[end - numbers..]);
    bytes[20..24].copy_from_slice(&crc.to_le_bytes());
    let crc = crc32fast::hash(&bytes[..32]);
    bytes[32..36].copy_from_slice(&crc.to_le_bytes());
    fs::write(here.join("a.table"), bytes).unwrap();
    done(darkness(here, &["table", "inspect", "a.table"]));
    refused(
        darkness(here, &["table", "verify", "a.table"]),
        1,
        &["a.table", "differs from byte 20"],
    );
}

/// A row that `trace` printed.
struct Row {
    u0: f64,
    dudphi: f64,
    kind: EventKind,
    radius: f64,
    angle: f64,
}

/// What `trace` printed, a group of rows for each ray.
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
    let groups = rows(&printed(darkness(folder.path(), &args)));
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
    command.pipe_stdin(REFERENCE_RAYS).unwrap();
    let groups = rows(&printed(command));
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
        let mut command = darkness(here, &args);
        command
            .args(["--radius", "7.5,2", "--radius", "1e20"])
            .write_stdin(csv);
        assert_eq!(
            printed(command),
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
        let output = darkness(here, &args).output().unwrap();
        assert_eq!(output.status.code(), Some(1));
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert!(
            stderr.starts_with("darkness: rays.csv, line 3: ") && stderr.contains(words),
            "{stderr}"
        );
        let stdout = String::from_utf8(output.stdout).unwrap();
        assert!(stderr.contains("1 of 3 rows"), "{stderr}");
        // A header, and two events of each of the two good rows.
        assert_eq!(stdout.lines().count(), 5, "{stdout}");
    }
    // Of a file that is none of rays not every row is told.
    let bad = "u0,dudphi\n".to_owned() + &"a,b\n".repeat(5000) + "0.1,-inf\n";
    fs::write(here.join("rays.csv"), bad).unwrap();
    let output = darkness(here, &["trace", "rays.csv", "--table", "a.table"])
        .output()
        .unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(stderr.lines().count(), 101);
    assert!(
        stderr.contains("line 101: ") && stderr.contains("5000 of 5001 rows"),
        "{stderr}"
    );
    let mut headless = darkness(here, &["trace", "--table", "a.table"]);
    headless.write_stdin("0.1,0.2\n");
    refused(headless, 1, &["standard input, line 1", "u0"]);
    let mut empty = darkness(here, &["trace", "--table", "a.table"]);
    empty.write_stdin("");
    refused(empty, 1, &["standard input", "header"]);
    refused(darkness(here, &["trace", "no.csv"]), 1, &["no.csv"]);
    assert_eq!(
        listing(here),
        ["a.table", "rays.csv"],
        "a table was made for nothing"
    );
}

#[test]
fn a_reader_that_leaves_ends_the_run_quietly() {
    let folder = with_draft();
    for args in [
        &["trace", REFERENCE_RAYS, "--table", "a.table"][..],
        &["render", "--table", "a.table", "-q", "-o", "-"],
    ] {
        let mut child = Process::new(cargo_bin!("darkness"))
            .current_dir(folder.path())
            .args(args)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!(String::from_utf8_lossy(&output.stderr), "");
        assert_eq!(output.status.code(), Some(0));
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_standard_output_is_a_failure() {
    let folder = with_draft();
    for args in [
        &["trace", REFERENCE_RAYS, "--table", "a.table"][..],
        &["render", "--table", "a.table", "-q", "-o", "-"],
        &["table", "inspect", "a.table"],
        &["scene"],
    ] {
        let full = fs::File::options().write(true).open("/dev/full").unwrap();
        let output = Process::new(cargo_bin!("darkness"))
            .current_dir(folder.path())
            .args(args)
            .stdout(full)
            .stderr(Stdio::piped())
            .output()
            .unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{stderr}");
        assert!(
            stderr.starts_with("darkness: the standard output"),
            "{stderr}"
        );
    }
}

#[test]
fn scenes_are_listed_and_a_printed_one_renders_the_same_picture() {
    let folder = with_draft();
    let here = folder.path();
    let list = printed(darkness(here, &["scene"]));
    assert_eq!(list.lines().count(), builtins().len());
    for scene in builtins() {
        let name = scene.name();
        assert!(list.contains(name) && list.contains(scene.description()));
        let toml = printed(darkness(here, &["scene", name]));
        assert_eq!(toml, scene.toml());
        let file = format!("my {name}.toml");
        fs::write(here.join(&file), toml).unwrap();
        let [theirs, mine] = [name, &file].map(|scene| {
            let args = ["render", scene, "--table", "a.table", "--size", SMALL];
            let one = ["--frames", "1", "-o", "-"];
            done(darkness(here, &[&args[..], &one].concat())).0
        });
        assert_eq!(theirs, mine);
    }
    refused(
        darkness(here, &["scene", "clasic"]),
        1,
        &["clasic", "classic", "photon-ring"],
    );
}

#[test]
fn scenes_that_are_no_scenes_are_refused_in_a_sentence() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let scene = builtins()[0].toml();
    let longer = scene.replacen("0.0,", "0.0, 1.0,", 1);
    assert_ne!(longer, scene);
    for (text, word) in [
        (longer, "three numbers"),
        (scene.replace("outer = 12.0", "outer = 1e101"), "disk.outer"),
        ("#".repeat((1 << 20) + 1), "1 MiB"),
    ] {
        std::fs::write(here.join("scene.toml"), text).unwrap();
        let output = darkness(here, &["render", "scene.toml"]).output().unwrap();
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{stderr}");
        assert!(stderr.contains(word), "{word}: {stderr}");
        assert!(stderr.len() < 2000, "{} bytes of error", stderr.len());
    }
}
