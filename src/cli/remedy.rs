//! Adds to a table's error the command that mends it.

use std::path::Path;

use super::table_path::default_path;
use crate::table::{FormatError, Spec, TableError};

/// Returns the error, its message extended by what the user can do about it.
pub(super) fn with_remedy(error: &TableError) -> anyhow::Error {
    let remedy = match error {
        TableError::Missing { path } => format!("; make it with `{}`", command(path, "")),
        TableError::Unusable { path, problem } => format!(". {}", replacement(path, problem)),
        TableError::Unwritable { .. } => {
            ". Choose another place with -o, or make room or rights there".into()
        }
        TableError::Unreadable { .. } => String::new(),
    };
    anyhow::anyhow!("{error}{remedy}")
}

/// Returns the command that makes the table at `path`: of the specification that the file is named after, or of the
/// standard one. `option` is " --force" or nothing.
fn command(path: &Path, option: &str) -> String {
    let stem = path.file_stem().unwrap_or_default();
    let name = Spec::NAMES.into_iter().find(|&name| stem == name);
    let name = name.unwrap_or("standard");
    match path.to_str() {
        _ if default_path(name) == path => format!("darkness table {name}{option}"),
        Some(path) => {
            let quoted = path.replace('\'', "'\\''");
            format!("darkness table {name}{option} -o '{quoted}'")
        }
        // What can be shown of this name would name another file.
        None => format!("darkness table {name}{option} -o FILE"),
    }
}

/// Says how to get a table in place of an unusable file. A foreign file may be of value to its owner, unless it lies
/// where the program keeps its tables.
fn replacement(path: &Path, problem: &FormatError) -> String {
    let is_default = Spec::NAMES.iter().any(|name| default_path(name) == path);
    let command = command(path, " --force");
    match problem {
        FormatError::NoFile { .. } => "Name a table's file".into(),
        FormatError::Foreign if !is_default => {
            format!("Name another file, or overwrite this one with `{command}`")
        }
        _ => format!("Make it anew with `{command}`"),
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;

    fn missing(path: impl Into<PathBuf>) -> String {
        with_remedy(&TableError::Missing { path: path.into() }).to_string()
    }

    fn unusable(path: &str, problem: FormatError) -> String {
        let path = path.into();
        with_remedy(&TableError::Unusable { path, problem }).to_string()
    }

    #[test]
    fn a_missing_table_is_named_with_the_command_that_makes_it() {
        for (path, command) in [
            (
                "a b/fine.table",
                "`darkness table fine -o 'a b/fine.table'`",
            ),
            ("mine.table", "`darkness table standard -o 'mine.table'`"),
            ("it's", r"`darkness table standard -o 'it'\''s'`"),
        ] {
            let text = missing(path);
            assert!(text.starts_with(path) && text.ends_with(command), "{text}");
        }
        // No -o is needed where the program looks by itself.
        for name in Spec::NAMES {
            let text = missing(default_path(name));
            assert!(
                text.ends_with(&format!("`darkness table {name}`")),
                "{text}"
            );
        }
    }

    #[test]
    fn an_unusable_table_is_named_with_the_command_that_replaces_it() {
        let text = unusable("draft.table", FormatError::Changed);
        let command = "`darkness table draft --force -o 'draft.table'`";
        assert!(
            text.ends_with(&format!(". Make it anew with {command}")),
            "{text}"
        );
        let text = unusable("draft.table", FormatError::Foreign);
        assert!(
            text.ends_with(&format!("or overwrite this one with {command}")),
            "{text}"
        );
        let text = unusable("tables/draft.table", FormatError::Foreign);
        assert!(
            text.ends_with("Make it anew with `darkness table draft --force`"),
            "{text}"
        );
        let text = unusable("folder", FormatError::NoFile { kind: "folder" });
        assert!(!text.contains("--force"), "{text}");
    }
}
