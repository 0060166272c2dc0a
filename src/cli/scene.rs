//! `darkness scene`: the built-in scenes.

use std::fmt::Write as _;

use clap::Args;

use super::misuse::misuse;
use super::stdio::print;
use crate::scene::{Builtin, builtins};

/// List the built-in scenes, or print one as TOML to start from
#[derive(Debug, Args)]
pub(super) struct SceneArgs {
    /// The scene to print [default: list all]
    #[arg(value_name = "NAME")]
    name: Option<String>,
}

/// Runs the verb.
pub(super) fn run(args: &SceneArgs) -> anyhow::Result<()> {
    let text = match &args.name {
        None => list()?,
        Some(name) => builtin(name)?.to_owned(),
    };
    Ok(print(&text)?)
}

/// Names and descriptions, one scene a line.
fn list() -> Result<String, std::fmt::Error> {
    let longest = builtins().iter().map(|scene| scene.name().len()).max();
    let width = longest.unwrap_or_default();
    let mut text = String::new();
    for scene in builtins() {
        writeln!(text, "{:width$}  {}", scene.name(), scene.description())?;
    }
    Ok(text)
}

/// A scene's own text, with its comments.
fn builtin(name: &str) -> anyhow::Result<&'static str> {
    let scene = builtins().iter().find(|scene| scene.name() == name);
    scene.map(Builtin::toml).ok_or_else(|| {
        let names: Vec<_> = builtins().iter().map(Builtin::name).collect();
        let meant =
            Builtin::meant(name).map_or(String::new(), |name| format!("; did you mean {name}?"));
        misuse(format!(
            "there is no built-in scene {name}{meant} (the scenes are {})",
            names.join(", ")
        ))
    })
}
