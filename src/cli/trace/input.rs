//! The file or the standard input that holds a list of rays.

use std::fs::File;
use std::io::{self, BufRead, BufReader, IsTerminal};
use std::path::Path;

use super::BUFFER;
use crate::cli::destination::stdout_onto_input;
use crate::cli::misuse::misuse;
use crate::cli::stdio::is_stdout;

/// Opens the input, and returns its name for messages.
pub(super) fn open(input: Option<&Path>) -> anyhow::Result<(Box<dyn BufRead>, String)> {
    match input {
        Some(path) if path != Path::new("-") => {
            let name = path.display().to_string();
            let file = File::open(path).map_err(|error| {
                let text = format!("{name}: the rays cannot be read: {error}");
                match error.kind() {
                    io::ErrorKind::NotFound => misuse(text),
                    _ => anyhow::anyhow!(text),
                }
            })?;
            check_is_not_written(&file, path)?;
            Ok((Box::new(BufReader::with_capacity(BUFFER, file)), name))
        }
        // Without a word the program would seem to hang.
        None if io::stdin().is_terminal() => Err(misuse(
            "there are no rays to trace; name a CSV file with the columns u0 and dudphi, send one to the standard \
             input (`-` reads it from the terminal), or give rays by --from and --b",
        )),
        _ => {
            let name = "standard input";
            if let Ok(list) = stdin() {
                check_is_not_written(&list, Path::new(name))?;
            }
            Ok((Box::new(io::stdin().lock()), name.into()))
        }
    }
}

/// Refuses to print to the end of the list that is read, since each line would be read in its turn, without end.
fn check_is_not_written(list: &File, name: &Path) -> anyhow::Result<()> {
    if list.metadata().is_ok_and(|file| is_stdout(&file)) {
        return Err(stdout_onto_input(name, "list"));
    }
    Ok(())
}

/// Returns the standard input as a file, to find out what it is.
fn stdin() -> io::Result<File> {
    #[cfg(unix)]
    let owned = std::os::fd::AsFd::as_fd(&io::stdin()).try_clone_to_owned()?;
    #[cfg(windows)]
    let owned = std::os::windows::io::AsHandle::as_handle(&io::stdin()).try_clone_to_owned()?;
    Ok(File::from(owned))
}
