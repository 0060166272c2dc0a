//! Tests of files that appear whole or not at all.

use super::*;

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn what_a_killed_process_left_is_removed_and_what_a_live_one_writes_is_not() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let path = here.join("f_1.png");
    fs::write(here.join(".f_1.png.Ab3xY9.part"), "half").unwrap();
    fs::write(here.join(".f_2.png.Ab3xY9.part"), "another's").unwrap();
    fs::write(here.join(".f_1.png.notes.part"), "somebody's own").unwrap();
    let mut alive = Unfinished::new(&path).unwrap();
    alive.file().write_all(b"slow").unwrap();
    write_whole(&path, |file| file.write_all(b"fast")).unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"fast");
    assert_eq!(names(here).len(), 4, "{:?}", names(here));
    alive.finish().unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"slow");
    assert_eq!(
        names(here),
        [".f_1.png.notes.part", ".f_2.png.Ab3xY9.part", "f_1.png"]
    );
}

#[test]
fn a_failure_leaves_the_old_file_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.table");
    fs::write(&path, "old").unwrap();
    let failed = write_whole(&path, |file| {
        file.write_all(b"new")?;
        Err(io::Error::other("the disk is gone"))
    });
    assert!(failed.is_err());
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_eq!(names(folder.path()), ["a.table"]);
}

#[test]
#[cfg(unix)]
fn links_are_followed_whether_or_not_they_lead_to_a_file() {
    use std::os::unix::fs::symlink;

    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    fs::create_dir(here.join("real")).unwrap();
    symlink("real/b", here.join("a")).unwrap();
    symlink("c", here.join("real/b")).unwrap();
    fs::write(here.join("real/.c.Ab3xY9.part"), "half").unwrap();
    for content in ["new", "newer"] {
        write_whole(&here.join("a"), |file| file.write_all(content.as_bytes())).unwrap();
        assert_eq!(fs::read_to_string(here.join("real/c")).unwrap(), content);
    }
    assert_eq!(names(here), ["a", "real"]);
    assert_eq!(names(&here.join("real")), ["b", "c"]);

    symlink("new/folder", here.join("out")).unwrap();
    make_folder(&here.join("out/within")).unwrap();
    assert!(here.join("new/folder/within").is_dir());

    symlink("round", here.join("round")).unwrap();
    assert!(write_whole(&here.join("round"), |_| Ok(())).is_err());
    assert!(make_folder(&here.join("round/within")).is_err());
    assert!(here.join("round").is_symlink());
}

#[test]
#[cfg(unix)]
fn a_read_only_file_is_not_replaced_and_other_modes_are_kept() {
    use std::os::unix::fs::PermissionsExt;

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    fs::write(&path, "old").unwrap();
    let set = |mode| fs::set_permissions(&path, fs::Permissions::from_mode(mode)).unwrap();
    set(0o444);
    let error = write_whole(&path, |file| file.write_all(b"new")).unwrap_err();
    assert!(error.to_string().contains("read-only"), "{error}");
    assert_eq!(fs::read(&path).unwrap(), b"old");
    for mode in [0o600, 0o664, 0o777] {
        set(mode);
        write_whole(&path, |file| file.write_all(b"new")).unwrap();
        let kept = fs::metadata(&path).unwrap().permissions().mode();
        assert_eq!(kept & 0o7777, mode);
    }
    assert_eq!(names(folder.path()), ["a.png"]);
}

#[test]
fn the_longest_names_that_a_file_can_have() {
    let folder = tempfile::tempdir().unwrap();
    let name = "n".repeat(255);
    let path = folder.path().join(&name);
    let leftover = format!(
        ".{}.Ab3xY9.part",
        label(OsStr::new(&name)).to_str().unwrap()
    );
    fs::write(folder.path().join(leftover), "half").unwrap();
    write_whole(&path, |file| file.write_all(b"all")).unwrap();
    assert_eq!(names(folder.path()), [name]);
}

#[test]
fn only_unfinished_files_are_leftovers() {
    let label = |name: &str| {
        leftover(OsStr::new(name)).map(|label| String::from_utf8(label.to_vec()).unwrap())
    };
    assert_eq!(label(".f_01.png.Ab3xY9.part").as_deref(), Some("f_01.png"));
    assert_eq!(label(".a.b.c.000000.part").as_deref(), Some("a.b.c"));
    for name in [
        "f_01.png",
        ".f_01.png",
        ".part",
        "..Ab3xY9.part",
        ".Ab3xY9.part",
        ".f.Ab3xY.part",
        ".f.Ab-xY9.part",
        "f.Ab3xY9.part",
        ".f.Ab3xY9.part~",
    ] {
        assert_eq!(label(name), None, "{name}");
    }
}
