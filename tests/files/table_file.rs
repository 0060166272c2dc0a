//! Guards against a table file that is accepted although it is damaged, cut short, foreign or of another version;
//! against a write that leaves half a file or other files behind; and against bytes that depend on the number of
//! threads.

use std::path::Path;

use darkness::table::format::{CONVENTIONS, VERSION};
use darkness::table::{ChartNodes, FormatError, Metadata, Spec, SpecError, Table, TableError};

use crate::fuzzed::crafted::{
    METADATA_AT, METADATA_LENGTH_AT, NUMBERS_LENGTH_AT, VERSION_AT, mend_preamble, sealed,
    write_u32,
};

fn draft() -> Table {
    Table::generate(&Spec::draft()).unwrap()
}

/// What is wrong with the bytes.
fn problem(bytes: &[u8]) -> FormatError {
    match Table::from_bytes(bytes) {
        Err(problem) => problem,
        Ok(table) => panic!("accepted: {:?}", table.metadata()),
    }
}

fn encode(metadata: &impl serde::Serialize) -> Vec<u8> {
    bincode::serde::encode_to_vec(metadata, bincode::config::standard()).unwrap()
}

/// The numbers of a table: all that follows its header.
fn numbers_of(table: &Table) -> &[u8] {
    let header = METADATA_AT + encode(table.metadata()).len();
    &table.bytes()[header.next_multiple_of(64)..]
}

/// The draft table with its metadata changed and everything else made to fit.
fn with_metadata(change: impl FnOnce(&mut Metadata)) -> Vec<u8> {
    let table = draft();
    let mut metadata = table.metadata().clone();
    change(&mut metadata);
    sealed(&encode(&metadata), numbers_of(&table))
}

#[test]
fn a_crafted_file_without_changes_equals_the_real_one() {
    let table = draft();
    assert_eq!(with_metadata(|_| ()), table.bytes());
    assert!(Table::from_bytes(&with_metadata(|_| ())).is_ok());
    assert_eq!(table.metadata().conventions, CONVENTIONS);
}

#[test]
fn every_changed_byte_is_refused() {
    let mut bytes = draft().bytes().to_vec();
    for at in 0..bytes.len() {
        // One bit, and all of them.
        for change in [1 << (at % 8), 0xff] {
            bytes[at] ^= change;
            let problem = problem(&bytes);
            match at {
                0..VERSION_AT => assert_eq!(problem, FormatError::Foreign, "byte {at}"),
                VERSION_AT..METADATA_LENGTH_AT => {
                    assert!(
                        matches!(problem, FormatError::Outdated { .. }),
                        "byte {at}: {problem}"
                    );
                }
                _ => assert!(
                    matches!(problem, FormatError::Damaged { .. }),
                    "byte {at}: {problem}"
                ),
            }
            bytes[at] ^= change;
        }
    }
    assert!(Table::from_bytes(&bytes).is_ok());
}

#[test]
fn every_shorter_and_longer_file_is_refused() {
    let table = draft();
    let bytes = table.bytes();
    for length in 0..bytes.len() {
        let problem = problem(&bytes[..length]);
        let actual = length as u64;
        match problem {
            FormatError::Foreign => assert_eq!(length, 0),
            FormatError::Length {
                expected,
                actual: told,
            } => {
                assert_eq!(told, actual);
                let whole = if length < METADATA_AT {
                    METADATA_AT
                } else {
                    bytes.len()
                };
                assert_eq!(expected, whole as u64, "cut to {length}");
            }
            other => panic!("cut to {length}: {other}"),
        }
    }
    for more in [1, 7, 8, 64, 4096] {
        for filler in [0, 0xff] {
            let longer = [bytes, &vec![filler; more]].concat();
            let expected = FormatError::Length {
                expected: bytes.len() as u64,
                actual: longer.len() as u64,
            };
            assert_eq!(problem(&longer), expected);
        }
    }
}

#[test]
fn a_file_of_another_kind_is_called_foreign() {
    let png = include_bytes!("../reference/masks/face-on.png");
    for (name, bytes) in [
        ("empty", &[][..]),
        ("zeros", &[0; 4096]),
        ("a picture", png),
        ("text", b"[camera]\nposition = [30.0, 0.0, 5.0]\n"),
        (
            "a table after a transfer as text",
            b"\x89DRK\n\x1A\n and more of it",
        ),
        (
            "a table without its eighth bits",
            b"\x09DRK\r\n\x1A\n and more of it",
        ),
    ] {
        let problem = problem(bytes);
        assert_eq!(problem, FormatError::Foreign, "{name}");
        assert!(
            problem.to_string().contains("not a darkness table"),
            "{name}: {problem}"
        );
    }
}

#[test]
fn a_file_of_another_version_is_refused_with_its_version() {
    for found in [0, VERSION + 1, 0x0100_0000, u32::MAX] {
        let mut bytes = draft().bytes().to_vec();
        write_u32(&mut bytes, VERSION_AT, found);
        // The preamble of another version may be laid out in another way: with and without a checksum that fits.
        for mended in [false, true] {
            if mended {
                mend_preamble(&mut bytes);
            }
            let problem = problem(&bytes);
            assert_eq!(problem, FormatError::Outdated { found });
            let message = problem.to_string();
            assert!(
                message.contains(&found.to_string()) && message.contains(&VERSION.to_string()),
                "{message}"
            );
        }
    }
}

/// A table as a machine of the other byte order would write it, or a tool that swaps words.
#[test]
fn a_file_with_swapped_bytes_is_refused_as_such() {
    let table = draft();
    for width in [2, 4, 8] {
        let words = table.bytes().chunks(width);
        let swapped: Vec<u8> = words.flat_map(|word| word.iter().rev().copied()).collect();
        let found = problem(&swapped);
        assert_eq!(found, FormatError::Swapped, "by {width}");
        assert!(
            found
                .to_string()
                .contains(&format!("reads format {VERSION}")),
            "{found}"
        );
    }
}

#[test]
fn bytes_may_begin_anywhere_in_memory() {
    let table = draft();
    for shift in 1..8 {
        let shifted = [&vec![0; shift], table.bytes()].concat();
        let copied = Table::from_bytes(&shifted[shift..]).unwrap();
        assert_eq!(copied.bytes(), table.bytes());
    }
}

type Change = fn(&mut Metadata);

/// Metadata that `generate` never writes, with checksums that fit.
#[test]
fn metadata_that_make_no_sense_are_refused() {
    let changes: [(&str, Change); 15] = [
        ("tolerance NaN", |m| m.spec.tolerance = f64::NAN),
        ("tolerance 0", |m| m.spec.tolerance = 0.0),
        ("tolerance < 0", |m| m.spec.tolerance = -1e-6),
        ("tolerance infinite", |m| m.spec.tolerance = f64::INFINITY),
        ("error NaN", |m| m.measured_error = f64::NAN),
        ("error infinite", |m| m.measured_error = f64::INFINITY),
        ("error < 0", |m| m.measured_error = -1e-7),
        ("other conventions", |m| m.conventions.push('!')),
        ("too few nodes", |m| m.spec.critical.orbit = 5),
        ("another grid", |m| m.spec.weak.place += 1),
        ("no nodes", |m| m.spec.radial.orbit = 0),
        ("as many nodes as there are numbers", |m| {
            m.spec.radial.orbit = u32::MAX;
        }),
        ("no name", |m| m.spec.name.clear()),
        ("a name of many lines", |m| m.spec.name.push('\n')),
        ("a name that terminals obey", |m| m.spec.name.push('\u{1b}')),
    ];
    let mut accepted = Vec::new();
    for (name, change) in changes {
        match Table::from_bytes(&with_metadata(change)) {
            Err(FormatError::Damaged { .. }) => (),
            Err(other) => panic!("{name}: {other}"),
            Ok(_) => accepted.push(name),
        }
    }
    assert!(accepted.is_empty(), "accepted: {accepted:?}");
}

#[test]
fn metadata_with_trailing_bytes_and_numbers_that_are_not_finite_are_refused() {
    let table = draft();
    let spare = [&encode(table.metadata())[..], &[0]].concat();
    assert!(matches!(
        problem(&sealed(&spare, numbers_of(&table))),
        FormatError::Damaged { .. }
    ));
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut numbers = numbers_of(&table).to_vec();
        let middle = numbers.len() / 16 * 8;
        numbers[middle..middle + 8].copy_from_slice(&value.to_le_bytes());
        let bytes = sealed(&encode(table.metadata()), &numbers);
        assert_eq!(
            problem(&bytes),
            FormatError::Damaged {
                what: "one of its numbers is not finite"
            }
        );
    }
}

/// Every length in the file, made absurd with checksums that fit, is refused, and no memory is allocated for it. An
/// allocation of 2^44 bytes or more would end this process; one of 2^37 bytes would show as address space.
#[test]
fn absurd_lengths_are_refused_before_memory_is_allocated() {
    let table = draft();
    for length in [
        1 << 37,
        1 << 44,
        1 << 62,
        u64::MAX - 320,
        u64::MAX - 319,
        u64::MAX,
    ] {
        let mut bytes = table.bytes().to_vec();
        bytes[NUMBERS_LENGTH_AT..NUMBERS_LENGTH_AT + 8].copy_from_slice(&u64::to_le_bytes(length));
        mend_preamble(&mut bytes);
        assert!(
            matches!(
                problem(&bytes),
                FormatError::Length { .. } | FormatError::Damaged { .. }
            ),
            "{length} bytes of numbers"
        );
    }
    for length in [0, 1, 4097, 1 << 20, u32::MAX] {
        let mut bytes = table.bytes().to_vec();
        write_u32(&mut bytes, METADATA_LENGTH_AT, length);
        mend_preamble(&mut bytes);
        assert!(
            matches!(
                problem(&bytes),
                FormatError::Length { .. } | FormatError::Damaged { .. }
            ),
            "{length} bytes of metadata"
        );
    }
    // Metadata begin with the length of a text: bincode writes 253 and then eight bytes.
    for length in [1_u64 << 37, 1 << 44, u64::MAX] {
        let mut metadata = vec![253];
        metadata.extend(length.to_le_bytes());
        metadata.extend(encode(table.metadata()));
        assert!(matches!(
            problem(&sealed(&metadata, numbers_of(&table))),
            FormatError::Damaged { .. }
        ));
    }
    // Grids of 2^37 bytes and of more than 2^64.
    for nodes in [4096, 1 << 17, u32::MAX] {
        let grid = ChartNodes {
            place: nodes,
            orbit: nodes,
        };
        let bytes = with_metadata(|m| (m.spec.critical, m.spec.radial) = (grid, grid));
        assert!(matches!(problem(&bytes), FormatError::Damaged { .. }));
    }
    if let Some(peak) = peak_address_space() {
        // The threads of a test binary reserve some hundred megabytes.
        assert!(peak < 1 << 36, "{peak} bytes of address space");
    }
}

/// The largest address space that this process ever had, in bytes, if the system tells it.
fn peak_address_space() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmPeak:"))?;
    let kilobytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kilobytes << 10)
}

/// The names in a folder.
fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn a_saved_table_opens_again_and_leaves_no_other_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("deep/down/draft.table");
    let table = draft();
    table.save(&path).unwrap();
    assert_eq!(names(path.parent().unwrap()), ["draft.table"]);
    assert_eq!(std::fs::read(&path).unwrap(), table.bytes());
    let opened = Table::open(&path).unwrap();
    assert_eq!(opened.metadata(), table.metadata());
    assert_eq!(opened.bytes(), table.bytes());
}

/// A longer file does not keep its old end, and a process that has the old file open keeps it whole.
#[test]
fn saving_replaces_a_file_as_a_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("some.table");
    std::fs::write(&path, vec![b'x'; 1 << 20]).unwrap();
    let table = draft();
    table.save(&path).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), table.bytes());

    let before = Table::open(&path).unwrap();
    let mut spec = Spec::named("draft").unwrap();
    spec.weak.orbit += 3;
    let other = Table::generate(&spec).unwrap();
    other.save(&path).unwrap();
    assert_eq!(before.bytes(), table.bytes());
    assert_eq!(Table::open(&path).unwrap().bytes(), other.bytes());
    assert_eq!(names(folder.path()), ["some.table"]);
}

/// The mode is compared with that of a plain new file, so that any umask is right.
#[cfg(unix)]
#[test]
fn a_saved_table_has_the_mode_of_any_new_file() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let mode = |path: &Path| std::fs::metadata(path).unwrap().permissions().mode();
    let (plain, saved) = (folder.path().join("plain"), folder.path().join("t.table"));
    std::fs::write(&plain, "").unwrap();
    draft().save(&saved).unwrap();
    assert_eq!(mode(&saved), mode(&plain), "{:o}", mode(&saved));
}

#[test]
fn a_save_that_fails_names_the_file_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let table = draft();
    // There is a folder in place of the file, or a file in place of the folder.
    let taken = folder.path().join("taken.table");
    std::fs::create_dir(&taken).unwrap();
    std::fs::write(taken.join("inside"), "").unwrap();
    std::fs::write(folder.path().join("file"), "as it was").unwrap();
    let below = folder.path().join("file/some.table");
    for path in [&taken, &below] {
        let error = table.save(path).unwrap_err();
        assert!(matches!(error, TableError::Unwritable { .. }), "{error:?}");
        let message = error.to_string();
        assert!(message.contains(&path.display().to_string()), "{message}");
        assert!(!message.contains("-o"), "a flag in: {message}");
    }
    assert_eq!(names(folder.path()), ["file", "taken.table"]);
    assert_eq!(names(&taken), ["inside"]);
    assert_eq!(
        std::fs::read(folder.path().join("file")).unwrap(),
        b"as it was"
    );
}

#[test]
fn a_file_that_cannot_be_opened_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("empty.table"), "").unwrap();
    std::fs::write(at("draft.table"), &draft().bytes()[..1000]).unwrap();
    for path in [
        at("none.table"),
        at("empty.table"),
        at("draft.table"),
        folder.path().into(),
    ] {
        let error = Table::open(&path).unwrap_err();
        match error {
            TableError::Missing { .. } => assert!(path.ends_with("none.table")),
            TableError::Unusable { .. } => assert!(path.exists()),
            _ => panic!("{error:?}"),
        }
        let text = error.to_string();
        assert!(text.starts_with(&path.display().to_string()), "{text}");
        assert!(!text.contains('`'), "a command in: {text}");
    }
}

/// Also with an odd grid, whose rows do not divide evenly among threads.
#[test]
fn a_tables_bytes_depend_on_its_specification_alone() {
    let mut odd = Spec::named("draft").unwrap();
    odd.critical.orbit = 29;
    odd.trapped.orbit = 7;
    for spec in [
        Spec::named("draft").unwrap(),
        odd,
        Spec::named("standard").unwrap(),
    ] {
        let first = Table::generate(&spec).unwrap();
        for threads in [1, 2, 5] {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            let again = pool.install(|| Table::generate(&spec)).unwrap();
            assert!(
                again.bytes() == first.bytes(),
                "{} differs with {threads} threads",
                spec.name
            );
        }
    }
}

/// A specification that no table can have gives an error.
#[test]
fn a_grid_that_no_table_can_have_is_refused() {
    let draft = || Spec::named("draft").unwrap();
    let few = ChartNodes {
        place: 5,
        orbit: 20,
    };
    let many = ChartNodes {
        place: 20,
        orbit: 4097,
    };
    for spec in [
        Spec {
            weak: few,
            ..draft()
        },
        Spec {
            radial: many,
            ..draft()
        },
        Spec {
            tolerance: f64::NAN,
            ..draft()
        },
        Spec {
            tolerance: 0.0,
            ..draft()
        },
        Spec {
            name: "n".repeat(5000),
            ..draft()
        },
    ] {
        assert_eq!(Table::generate(&spec).unwrap_err(), SpecError);
    }
}
