//! Guards against what other processes and the system do to a table while it is made, read and used.
#![cfg(unix)]

use std::fs::{self, OpenOptions};
use std::io::{self, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use darkness::output::write_whole;
use darkness::table::{Spec, Table, TableError, format};
use tempfile::tempdir;

use crate::harness::{darkness, done, files, refused, with_animation};

fn start(folder: &Path, args: &[&str]) -> Child {
    darkness(folder, args)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

/// Returns whether there is a table; panics if it is not a valid one.
fn is_there(path: &Path) -> bool {
    match Table::open(path) {
        Ok(_) => true,
        Err(TableError::Missing { .. }) => false,
        Err(error) => panic!("{error}"),
    }
}

/// Guards against a partial table, and against temporary files that nobody removes.
#[test]
fn a_writer_killed_at_any_moment_leaves_the_old_table_or_the_new_one() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let path = here.join("a.table");
    let make = ["table", "draft", "-o", "a.table", "--force"];
    // Moments over as long as the whole run takes here, and a little longer.
    let begun = Instant::now();
    done(here, &make);
    let whole = begun.elapsed();
    let mut kills = 0;
    for moment in 0..50_u32 {
        if moment % 2 == 0 {
            let _ = fs::remove_file(&path);
        }
        let mut child = start(here, &make);
        std::thread::sleep(whole * moment / 40);
        kills += usize::from(child.try_wait().unwrap().is_none());
        child.kill().unwrap();
        child.wait().unwrap();
        is_there(&path);
    }
    assert!(kills > 0);
    done(here, &make);
    let whole = Table::generate(&Spec::draft()).unwrap();
    let left = files(here);
    assert_eq!(
        left.keys().map(String::as_str).collect::<Vec<_>>(),
        ["a.table"]
    );
    assert!(left["a.table"] == whole.bytes());
}

#[test]
fn several_writers_at_once_make_one_whole_table() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let make = ["table", "draft", "-o", "a.table", "--force"];
    for _ in 0..3 {
        let mut children: Vec<Child> = (0..4).map(|_| start(here, &make)).collect();
        while children
            .iter_mut()
            .any(|child| child.try_wait().unwrap().is_none())
        {
            is_there(&here.join("a.table"));
        }
        for child in &mut children {
            assert!(child.wait().unwrap().success());
        }
    }
    assert_eq!(files(here).len(), 1);
}

#[test]
fn a_mapped_table_does_not_change_when_its_file_is_replaced() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("a.table");
    let made = |name| Table::generate(&Spec::named(name).unwrap()).unwrap();
    made("draft").save(&path).unwrap();
    let mapped = Table::open(&path).unwrap();
    let before = mapped.bytes().to_vec();
    made("standard").save(&path).unwrap();
    assert!(mapped.bytes() == before);
    assert_eq!(mapped.metadata().spec.name, "draft");
    assert_eq!(Table::open(&path).unwrap().metadata().spec.name, "standard");
}

/// Guards against a signal for a table that is cut short: a table that was read into memory is independent of its file.
#[test]
fn without_mmap_a_table_that_is_cut_short_stays_whole() {
    let folder = with_animation(400);
    let here = folder.path();
    let draw = [
        "render",
        "small.toml",
        "--table",
        "a.table",
        "--no-mmap",
        "-o",
    ];
    fs::copy(here.join("tables/draft.table"), here.join("a.table")).unwrap();
    done(here, &[&draw[..], &["whole.raw"]].concat());
    let mut child = start(here, &[&draw[..], &["cut.raw"]].concat());
    // The film's file appears once the table is read.
    let begun = || files(here).keys().any(|name| name.starts_with(".cut.raw"));
    while !begun() && child.try_wait().unwrap().is_none() {}
    OpenOptions::new()
        .write(true)
        .open(here.join("a.table"))
        .unwrap()
        .set_len(0)
        .unwrap();
    assert!(child.wait().unwrap().success());
    assert!(fs::read(here.join("cut.raw")).unwrap() == fs::read(here.join("whole.raw")).unwrap());
    refused(
        here,
        &[&draw[..], &["no.raw"]].concat(),
        1,
        &["a.table", "not a darkness table"],
    );
    refused(
        here,
        &["render", "--method", "exact", "--no-mmap"],
        2,
        &["--no-mmap"],
    );
}

/// A writer to a disk that is full after so many bytes.
struct Filling<W> {
    file: W,
    room: usize,
}

impl<W: Write> Write for Filling<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let some = bytes.len().min(self.room);
        if some == 0 && !bytes.is_empty() {
            return Err(io::ErrorKind::StorageFull.into());
        }
        let written = self.file.write(&bytes[..some])?;
        self.room -= written;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// Guards against a partial table in place of a whole one, wherever the disk fills up.
#[test]
fn a_disk_that_fills_up_after_any_byte_leaves_the_old_table_and_nothing_else() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("a.table");
    let made = Table::generate(&Spec::draft()).unwrap();
    let bytes = made.bytes();
    fs::write(&path, "the old one").unwrap();
    for room in 0..bytes.len() {
        let failed = write_whole(&path, |file| Filling { file, room }.write_all(bytes));
        assert_eq!(failed.unwrap_err().kind(), io::ErrorKind::StorageFull);
    }
    assert_eq!(files(folder.path()).len(), 1);
    assert_eq!(fs::read(&path).unwrap(), b"the old one");
    let room = bytes.len();
    write_whole(&path, |file| Filling { file, room }.write_all(bytes)).unwrap();
    assert!(is_there(&path));
}

/// Guards against waiting for the other end of a pipe, and for the end of a device that has none.
#[test]
fn pipes_devices_and_folders_are_refused_at_once() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let made = Command::new("mkfifo").arg(here.join("pipe")).status();
    assert!(made.unwrap().success());
    fs::create_dir(here.join("folder")).unwrap();
    fs::write(here.join("empty"), "").unwrap();
    fs::write(here.join("text"), "[camera]\nfov = 40\n").unwrap();
    let picture = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/reference/masks/face-on.png"
    );
    std::os::unix::fs::symlink(picture, here.join("picture")).unwrap();
    let _socket = std::os::unix::net::UnixListener::bind(here.join("socket")).unwrap();
    for (name, kind) in [
        ("pipe", "a pipe, a socket or a device"),
        ("socket", "a pipe, a socket or a device"),
        ("/dev/zero", "a pipe, a socket or a device"),
        ("/dev/null", "a pipe, a socket or a device"),
        ("folder", "a folder"),
        ("empty", "first eight bytes"),
        ("text", "first eight bytes"),
        ("picture", "first eight bytes"),
    ] {
        let names = || fs::read_dir(here).unwrap().count();
        let before = names();
        for args in [
            &["table", "inspect", name][..],
            &["table", "verify", name],
            &["render", "--table", name, "-o", "x.png"],
            &["render", "--table", name, "-o", "x.png", "--no-mmap"],
            &["trace", "--table", name, "text"],
        ] {
            refused(here, args, 1, &[name, "not a darkness table", kind]);
        }
        assert_eq!(names(), before, "{name}");
    }
}

/// Guards against mapping a file that is not as long as its first bytes say.
#[test]
fn a_file_of_another_length_is_refused_before_it_is_mapped() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("a.table");
    let whole = Table::generate(&Spec::draft()).unwrap();
    let bytes = whole.bytes();
    for length in [0, 1, 7, 8, 35, 36, 63, 64, 1000, bytes.len() - 1] {
        fs::write(&path, &bytes[..length]).unwrap();
        let [mapped, read] = [Table::open(&path).err(), Table::read(&path).err()];
        let [mapped, read] = [mapped, read].map(|error| error.unwrap().to_string());
        assert_eq!(mapped, read);
        let says = match length {
            0 => "not a darkness table".into(),
            _ => format!("{length} bytes long"),
        };
        assert!(mapped.contains(&says), "{length}: {mapped}");
    }
    fs::write(&path, [bytes, b"x"].concat()).unwrap();
    let longer = Table::open(&path).unwrap_err().to_string();
    assert!(
        longer.contains(&format!(
            "{} bytes long and should be {}",
            bytes.len() + 1,
            bytes.len()
        )),
        "{longer}"
    );
    fs::write(&path, bytes).unwrap();
    assert!(Table::read(&path).unwrap().bytes() == Table::open(&path).unwrap().bytes());
}

/// Guards against spending memory and time on a file that only claims to be a table, however long it is.
#[test]
fn a_sparse_file_of_a_terabyte_is_refused_by_its_beginning() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("a.table");
    let length = 1_u64 << 40;
    let mut start = b"\x89DRK\r\n\x1A\n".to_vec();
    for field in [format::VERSION, 28, crc32fast::hash(&[0; 28]), 0] {
        start.extend(field.to_le_bytes());
    }
    start.extend((length - 64).to_le_bytes());
    start.extend(crc32fast::hash(&start).to_le_bytes());
    fs::write(&path, &start).unwrap();
    // Its numbers are a hole in a sparse file.
    OpenOptions::new()
        .write(true)
        .open(&path)
        .unwrap()
        .set_len(length)
        .unwrap();
    for error in [Table::open(&path).err(), Table::read(&path).err()] {
        let message = error.unwrap().to_string();
        assert!(message.contains("its metadata"), "{message}");
    }
}

/// Guards against a copy of the table in each of many workers.
#[test]
#[cfg(target_os = "linux")]
fn many_processes_share_the_memory_of_one_table() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    done(here, &["table", "standard", "-o", "a.table"]);
    let size = fs::metadata(here.join("a.table")).unwrap().len();
    // The processes wait for rays.
    let mut children: Vec<Child> = (0..64)
        .map(|_| start(here, &["trace", "-", "--table", "a.table", "--quiet"]))
        .collect();
    // The table's memory, each page divided among the processes that hold it, and how many have mapped it.
    let shared_out = |children: &[Child]| {
        let (mut total, mut count) = (0, 0);
        for child in children {
            let maps =
                fs::read_to_string(format!("/proc/{}/smaps", child.id())).unwrap_or_default();
            let of_table = maps.split_once("a.table\n").map(|(_, rest)| rest);
            let line =
                of_table.and_then(|rest| rest.lines().find_map(|line| line.strip_prefix("Pss:")));
            let kib = line.and_then(|line| line.split_whitespace().next()?.parse::<u64>().ok());
            total += 1024 * kib.unwrap_or(0);
            count += usize::from(kib.is_some());
        }
        (total, count)
    };
    let mut seen = (0, 0);
    for _ in 0..400 {
        seen = shared_out(&children);
        if seen.1 == 64 {
            break;
        }
        std::thread::sleep(Duration::from_millis(25));
    }
    for child in &mut children {
        child.kill().unwrap();
        child.wait().unwrap();
    }
    println!("{} bytes for 64 processes, {size} in the file", seen.0);
    assert_eq!(seen.1, 64);
    assert!(
        seen.0 > size / 2 && seen.0 < 2 * size,
        "{} bytes of {size}",
        seen.0
    );
}

/// Guards against a file that differs from its documented layout: a reader written from the documentation reads it.
#[test]
fn the_documented_layout_is_the_one_of_the_files() {
    let python = Command::new("python3").arg("--version").output();
    if !python.is_ok_and(|python| python.status.success()) {
        eprintln!("python3 is not installed: passed over");
        return;
    }
    let folder = tempdir().unwrap();
    let reader = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/reader/read_table.py");
    for name in ["draft", "standard"] {
        let spec = Spec::named(name).unwrap();
        let made = Table::generate(&spec).unwrap();
        let path = folder.path().join("a.table");
        made.save(&path).unwrap();
        let read = Command::new("python3")
            .arg(reader)
            .arg(&path)
            .output()
            .unwrap();
        let told = String::from_utf8(read.stdout).unwrap();
        assert!(
            read.status.success(),
            "{}",
            String::from_utf8_lossy(&read.stderr)
        );
        let metadata = made.metadata();
        let charts = [spec.critical, spec.weak, spec.trapped, spec.radial];
        let nodes = charts.map(|nodes| format!("{}x{}", nodes.place, nodes.orbit));
        let numbers = (made.bytes().len() - 1) / 8;
        let words: Vec<&str> = told.split_whitespace().collect();
        assert_eq!(words[0], name);
        assert_eq!(words[3], metadata.measured_angles.to_string());
        assert_eq!(words[4..8], nodes);
        let count: usize = words[8].parse().unwrap();
        assert!(
            numbers - count < 64,
            "{count} numbers in {} bytes",
            made.bytes().len()
        );
    }
}
