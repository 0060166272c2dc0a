//! `darkness table`, and the tables that other verbs read.

use std::fs;
use std::path::Path;

use darkness::table::Spec;
use darkness::table::format::VERSION;
use tempfile::tempdir;

use super::SMALL;
use crate::harness::{
    REFERENCE_RAYS, darkness, done, fails, finish, listing, printed, refused, with_draft,
};

#[test]
fn a_table_that_is_named_is_made_where_it_is_missing_unless_it_is_required() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let render = ["render", "--size", SMALL];
    let named = |by_flag: bool, file: &str, options: &[&str]| {
        let options = [&render[..], options].concat();
        if by_flag {
            return darkness(here, &[&options[..], &["--table", file]].concat());
        }
        let mut command = darkness(here, &options);
        command.env("DARKNESS_TABLE", file);
        command
    };
    for (by_flag, folder) in [(true, "flag"), (false, "variable")] {
        for (name, made) in [("draft", "draft"), ("fine", "fine"), ("mine", "standard")] {
            let file = format!("{folder}/{name}.table");
            let words = [&*file, "make it with `darkness table"];
            let required = named(by_flag, &file, &["--require-table"])
                .output()
                .unwrap();
            fails(&required, 1, &words);
            assert_eq!(
                String::from_utf8(required.stderr)
                    .unwrap()
                    .contains("DARKNESS_TABLE"),
                !by_flag
            );
            assert!(!here.join(&file).exists());
            let (_, stderr) = finish(&mut named(by_flag, &file, &[]));
            let told = format!("{file} is not there yet: making the {made} table, once");
            assert!(
                stderr.contains(&told) && stderr.contains(&format!("table {made} (")),
                "{stderr}"
            );
            let (_, stderr) = finish(&mut named(by_flag, &file, &[]));
            assert!(!stderr.contains("making"), "{stderr}");
            assert!(printed(here, &["table", "inspect", &file]).contains(made));
        }
        // What no table is good enough for takes the best.
        let file = format!("{folder}/best.table");
        let (_, stderr) = finish(&mut named(by_flag, &file, &["--tolerance", "1e-10"]));
        assert!(stderr.contains("making the fine table"), "{stderr}");
    }
    fs::remove_dir_all(here.join("flag")).unwrap();
    fs::remove_dir_all(here.join("variable")).unwrap();
    fs::remove_file(here.join("classic.png")).unwrap();

    // The flag has priority over the environment, and an empty variable counts as unset.
    done(here, &["table", "draft", "-o", "d.table"]);
    for (variable, flag, words) in [
        ("other.table", &["--table", "d.table"][..], "table draft"),
        ("d.table", &[], "table draft"),
        // A small picture needs the draft table; with a tenth of the tolerance it needs the standard one.
        ("", &["--tolerance", "0.0001"], "table standard"),
    ] {
        let mut command = darkness(here, &render);
        command.env("DARKNESS_TABLE", variable).args(flag);
        let (_, stderr) = finish(&mut command);
        assert!(stderr.contains(words), "{stderr}");
    }
    assert_eq!(listing(here), ["classic.png", "d.table", "tables"]);
}

/// Guards against a table beside every picture that a person makes, and one made again in every folder.
#[test]
#[cfg(target_os = "linux")]
fn without_a_folder_of_tables_they_go_to_the_users_cache() {
    let (folder, home) = (tempdir().unwrap(), tempdir().unwrap());
    let here = folder.path();
    let cache = home.path().join(".cache/darkness");
    let render = || {
        let mut command = darkness(here, &["render", "--size", SMALL]);
        command.env("DARKNESS_CACHE", "").env("HOME", home.path());
        finish(command.env_remove("XDG_CACHE_HOME")).1
    };
    let told = format!("{} is not there yet", cache.join("draft.table").display());
    assert!(render().contains(&told));
    assert!(!render().contains("draft.table is not there"));
    assert_eq!(listing(here), ["classic.png"]);
    assert_eq!(listing(&cache), ["draft.table"]);

    let mut command = darkness(here, &["table", "draft"]);
    command.env("DARKNESS_CACHE", "own");
    finish(&mut command);
    assert_eq!(listing(&here.join("own")), ["draft.table"]);

    // A clone has the folder, and keeps its tables there.
    fs::create_dir(here.join("tables")).unwrap();
    assert!(render().starts_with("tables/draft.table is not there yet"));
    assert_eq!(listing(&here.join("tables")), ["draft.table"]);
}

#[test]
#[cfg(target_os = "linux")]
fn a_table_that_cannot_be_kept_is_used_all_the_same() {
    let folder = tempdir().unwrap();
    let picture = folder.path().join("x.png");
    let mut command = darkness(Path::new("/proc"), &["render", "-q", "--size", SMALL, "-o"]);
    command.arg(&picture);
    let (_, stderr) = finish(&mut command);
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
    done(here, &["table", "draft", "-o", "good"]);
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
            refused(here, args, 1, &words);
            assert_eq!(fs::read(&default).unwrap(), bytes, "{args:?} changed it");
        }
    }
    assert_eq!(listing(here), ["good", "tables"]);
    assert_eq!(listing(&here.join("tables")), ["standard.table"]);

    // The command in the message helps.
    done(here, &["table", "standard", "--force"]);
    done(here, &["table", "verify", "tables/standard.table"]);
}

#[test]
fn a_table_is_made_once_and_replaced_only_on_demand() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let (stdout, stderr) = done(here, &["table", "draft"]);
    assert!(stdout.is_empty() && stderr.contains("tables/draft.table: table draft"));
    let path = here.join("tables/draft.table");
    let made = fs::metadata(&path).unwrap().modified().unwrap();
    let (_, stderr) = done(here, &["table", "draft"]);
    assert!(stderr.contains("already there"), "{stderr}");
    assert_eq!(fs::metadata(&path).unwrap().modified().unwrap(), made);

    let other = ["table", "standard", "-o", "tables/draft.table"];
    refused(here, &other, 1, &["draft", "--force"]);
    done(here, &[&other[..], &["--force"]].concat());
    let inspected = printed(here, &["table", "inspect", "tables/draft.table"]);
    assert!(inspected.contains("standard"), "{inspected}");

    for (place, words) in [
        ("tables", "tables is a folder"),
        ("tables/draft.table/x", "is not a folder"),
        #[cfg(target_os = "linux")]
        ("/dev/null", "not a regular file"),
        #[cfg(target_os = "linux")]
        ("/proc/a/b.table", "cannot be written"),
    ] {
        let args = ["table", "draft", "--force", "-o", place];
        refused(here, &args, 1, &[place, words]);
    }
    assert_eq!(listing(&here.join("tables")), ["draft.table"]);
}

#[test]
fn inspect_and_verify_describe_a_table() {
    let folder = with_draft();
    let here = folder.path();
    let size = fs::metadata(here.join("a.table")).unwrap().len();
    let lines = printed(here, &["table", "inspect", "a.table"]);
    for words in ["draft", "1e-6 rad", &format!("{size} bytes")] {
        assert!(lines.contains(words), "{lines}");
    }
    let json = printed(here, &["table", "inspect", "a.table", "--json"]);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["name"], "draft");
    assert_eq!(json["tolerance"], 1e-6);
    assert_eq!(json["file_bytes"], size);
    let spec = Spec::named("draft").unwrap();
    assert_eq!(json["grid"]["critical"]["place"], spec.critical.place);
    let error = json["measured_error"].as_f64().unwrap();
    assert!(error > 0.0 && error <= 1e-6, "{error}");
    assert!(json["measured_angles"].as_u64().unwrap() > 1000);

    let verified = printed(here, &["table", "verify", "a.table"]);
    assert!(
        verified.contains(&format!("all {size} bytes")),
        "{verified}"
    );
    for verb in ["inspect", "verify"] {
        refused(here, &["table", verb, "no.table"], 2, &["no.table"]);
    }
}

#[test]
fn verify_finds_what_the_checksums_cannot() {
    let folder = with_draft();
    let here = folder.path();
    let mut bytes = fs::read(here.join("a.table")).unwrap();
    // One bit of the last number is changed and all checksums are corrected: a valid file with a wrong table.
    let end = bytes.len();
    bytes[end - 8] ^= 1;
    let numbers = usize::try_from(u64::from_le_bytes(bytes[24..32].try_into().unwrap())).unwrap();
    let crc = crc32fast::hash(&bytes[end - numbers..]);
    bytes[20..24].copy_from_slice(&crc.to_le_bytes());
    let crc = crc32fast::hash(&bytes[..32]);
    bytes[32..36].copy_from_slice(&crc.to_le_bytes());
    fs::write(here.join("a.table"), bytes).unwrap();
    done(here, &["table", "inspect", "a.table"]);
    refused(
        here,
        &["table", "verify", "a.table"],
        1,
        &["a.table", "differs from byte 20"],
    );
}
