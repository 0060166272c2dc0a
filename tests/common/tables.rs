//! The tables that come with the program, each generated once a process.

use std::sync::OnceLock;

use darkness::table::{Spec, Table};

/// The table of one of [`Spec::NAMES`].
pub(crate) fn table(name: &str) -> &'static Table {
    static TABLES: [OnceLock<Table>; 3] = [const { OnceLock::new() }; 3];
    let index = Spec::NAMES
        .iter()
        .position(|known| *known == name)
        .unwrap_or_else(|| panic!("there is no table {name}"));
    TABLES[index].get_or_init(|| {
        let spec = Spec::named(name).expect("a specification that comes with the program");
        Table::generate(&spec).expect("a grid that a table can have")
    })
}
