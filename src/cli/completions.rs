//! `darkness completions`: what a shell needs to complete the program's options.

use clap::{Args, Command};
use clap_complete::Shell;

use super::stdio::print;

/// Print a shell's completions
///
/// For bash: darkness completions bash > ~/.local/share/bash-completion/completions/darkness. For fish: darkness
/// completions fish > ~/.config/fish/completions/darkness.fish. For zsh, a file _darkness in a folder of $fpath. For
/// PowerShell, a line of the profile: darkness completions powershell | Out-String | Invoke-Expression.
#[derive(Debug, Args)]
pub(super) struct CompletionsArgs {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

/// Runs the verb. `program` is the definition of the command line.
pub(super) fn run(args: &CompletionsArgs, mut program: Command) -> anyhow::Result<()> {
    let mut text = Vec::new();
    let name = program.get_name().to_owned();
    clap_complete::generate(args.shell, &mut program, name, &mut text);
    Ok(print(&String::from_utf8(text)?)?)
}
