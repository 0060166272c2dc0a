//! `darkness man`: manual pages.

use std::io::Write;
use std::path::PathBuf;

use clap::{Args, Command};
use clap_mangen::Man;

use super::misuse::misuse;
use super::stdio::print;
use super::writable::{self, OUTPUT};
use crate::output::write_whole;

/// Print a manual page, or write all of them into a folder
///
/// To read one: darkness man render | man -l -. To install them: darkness man -o ~/.local/share/man/man1.
#[derive(Debug, Args)]
pub(super) struct ManArgs {
    /// The verb that the page is about [default: the program]
    verb: Option<String>,
    /// The folder for all pages
    #[arg(short, long, value_name = "FOLDER", conflicts_with = "verb")]
    output: Option<PathBuf>,
}

/// Runs the verb. `program` is the definition of the command line.
pub(super) fn run(args: &ManArgs, program: Command) -> anyhow::Result<()> {
    let mut program = program.disable_help_subcommand(true);
    program.build();
    if let Some(folder) = &args.output {
        return pages(&program).into_iter().try_for_each(|page| {
            let path = folder.join(page.get_filename());
            writable::check(&path, OUTPUT)?;
            let text = text(&page)?;
            Ok(write_whole(&path, |file| file.write_all(text.as_bytes()))?)
        });
    }
    let command = match &args.verb {
        None => &program,
        Some(verb) => program.find_subcommand(verb).ok_or_else(|| {
            misuse(format!(
                "there is no verb {verb}; `darkness help` lists them"
            ))
        })?,
    };
    Ok(print(&text(&page(command))?)?)
}

/// The pages of a command and of all its verbs.
fn pages(command: &Command) -> Vec<Man> {
    let verbs = command.get_subcommands().flat_map(pages);
    let mut pages: Vec<Man> = verbs.collect();
    pages.push(page(command));
    pages
}

fn page(command: &Command) -> Man {
    let source = concat!("darkness ", env!("CARGO_PKG_VERSION"));
    Man::new(command.clone()).source(source)
}

fn text(page: &Man) -> anyhow::Result<String> {
    let mut text = Vec::new();
    page.render(&mut text)?;
    Ok(String::from_utf8(text)?)
}
