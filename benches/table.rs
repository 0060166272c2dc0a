//! Making and opening the tables, on as many threads as there are cores.
//!
//! `cargo bench --bench table`

mod interleaved;

use darkness::table::{Spec, Table};
use interleaved::{Contender, compare};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = tempfile::tempdir()?;
    for name in Spec::NAMES {
        let spec = Spec::named(name).ok_or("no such table")?;
        let made = Table::generate(&spec)?;
        let path = folder.path().join(name);
        made.save(&path)?;
        let bytes = made.bytes().len();
        let error = made.metadata().measured_error;
        let opened = || Table::open(&path).map_or(0.0, |table| table.metadata().measured_error);
        let read = || std::fs::read(&path).map_or(0.0, |bytes| bytes.len() as f64);
        compare(
            &format!("{name}: {bytes} bytes, error {error:.1e}"),
            1,
            if name == "fine" { 5 } else { 21 },
            &mut [
                Contender {
                    name: "reading the file",
                    run: Box::new(read),
                },
                Contender {
                    name: "opening it: map and every check",
                    run: Box::new(opened),
                },
                Contender {
                    name: "making it, error measured",
                    run: Box::new(|| {
                        Table::generate(&spec).map_or(0.0, |table| table.metadata().measured_error)
                    }),
                },
            ],
        );
    }
    Ok(())
}
