//! Every command and every Python program of the pages, run in the order in which they stand there.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use tempfile::tempdir;

use super::markdown::{Block, PROJECT, Page, page, pages};
use crate::harness::{finish, printed, tool};
use crate::tools;

/// How commands begin that are not run, and why.
const NOT_RUN: [(&str, &str); 6] = [
    (
        "git clone ",
        "the project's address is the reader's to fill in",
    ),
    ("cargo install ", "it would change the machine"),
    ("cargo add ", "it belongs to a project of the reader's"),
    (
        "cargo run --release --features view ",
        "it opens a window; the tests of `view` open some",
    ),
    ("darkness view ", "the same"),
    (
        "sbatch ",
        "it needs a cluster; the tests of `farm` run such a script",
    ),
];

/// How a built-in animation or a film is known in a command: few small frames are drawn.
const ANIMATIONS: [&str; 7] = [
    "orbit", "approach", "tilt", "plunge", "flyby", "####", "film",
];

#[test]
fn commands_and_programs_of_the_readme_do_what_it_shows() {
    run(&page("README.md"));
}

#[test]
fn commands_and_programs_of_the_other_pages_do_what_they_show() {
    for page in &pages()[1..] {
        run(page);
    }
}

#[test]
fn what_is_not_run_stands_in_a_page() {
    let text: String = pages().into_iter().map(|page| page.text).collect();
    for (start, _) in NOT_RUN {
        assert!(text.contains(&format!("\n{start}")), "{start}");
    }
}

#[test]
fn the_readmes_first_command_is_the_one_that_is_tried_in_a_clean_folder() {
    let readme = page("README.md");
    let blocks = readme.blocks();
    let first = blocks.iter().find(|block| block.language == "sh").unwrap();
    let mut commands = first.lines.iter().map(|line| without_comment(line));
    let clone = commands.next().unwrap();
    assert!(
        clone.starts_with("git clone ") && clone.ends_with("&& cd darkness"),
        "{clone}"
    );
    let tried = page(".ci/run").text;
    assert!(tried.contains(&format!("clean folder: {}\"", commands.next().unwrap())));
}

/// Runs what is in a page's blocks, in one folder.
fn run(page: &Page) {
    let folder = tempdir().unwrap();
    for block in page.blocks() {
        match block.language {
            "sh" => run_commands(folder.path(), &block, &page.name),
            "python" => run_python(folder.path(), &block),
            // Scenes have tests of their own, Rust is a documentation test, and text is for reading.
            "toml" | "rust" | "text" => assert!(block.printed.is_none(), "{}", page.name),
            other => panic!("{}: a block of {other:?}", page.name),
        }
    }
}

fn run_commands(folder: &Path, block: &Block, page: &str) {
    let mut told = String::new();
    for line in &block.lines {
        let command = without_comment(line);
        if !command.is_empty() && !is_left_out(command) {
            assert!(
                !command.ends_with('\\'),
                "{page}: a command of several lines"
            );
            let output = finish(&mut tool(folder, &["sh", "-c", &runnable(command)]));
            told += str::from_utf8(&output.0).unwrap();
            told += &output.1;
        }
    }
    if let Some(shown) = &block.printed {
        let told: Vec<_> = told.lines().map(without_times).collect();
        let shown: Vec<_> = shown.iter().map(|line| without_times(line)).collect();
        assert_eq!(told, shown, "{page}: the second is what it shows");
    }
}

/// Returns whether a command is one of [`NOT_RUN`], or needs a program that is not installed.
fn is_left_out(command: &str) -> bool {
    NOT_RUN.iter().any(|(start, _)| command.starts_with(start))
        || command.contains(".mp4") && !tools::has("ffmpeg")
        || command.starts_with("openjd ") && !tools::has("openjd")
}

/// Returns the command as it is run: the program under test in place of one that cargo would build, and few small
/// frames of animations.
fn runnable(command: &str) -> String {
    let command = command.replace("cargo run --release -- ", "darkness ");
    if !ANIMATIONS.iter().any(|name| command.contains(name)) {
        return command;
    }
    let frames = if command.contains("--frames ") {
        ""
    } else {
        "--frames 1-12 "
    };
    command.replace(
        "darkness render ",
        &format!("darkness render --size 96x54 {frames}"),
    )
}

/// Returns a command without the comment behind it, which is two spaces away or more. (`'f_####.png'` has none.)
fn without_comment(line: &str) -> &str {
    line.split("  # ").next().unwrap().trim_end()
}

/// Returns a line in which every time is `T`.
fn without_times(line: &str) -> String {
    let mut words: Vec<_> = line.split(' ').collect();
    for i in 1..words.len() {
        if ["ms", "s"].contains(&words[i]) && words[i - 1].parse::<f64>().is_ok() {
            words[i - 1] = "T";
            words[i] = "";
        }
    }
    words.join(" ")
}

/// Runs a program in Python, where there is NumPy. Without matplotlib, the lines that need it are left out. What the
/// program prints is behind `# prints `.
fn run_python(folder: &Path, block: &Block) {
    if !tools::has("python3") || !tools::has_module("numpy") {
        return;
    }
    let can_plot = tools::has_module("matplotlib");
    let lines = block
        .lines
        .iter()
        .filter(|line| can_plot || !line.contains("plt"));
    let program: String = lines.flat_map(|line| [line, "\n"]).collect();
    let mut python = tool(folder, &["python3", "-c", &program]);
    let (told, _) = finish(python.env("MPLBACKEND", "Agg"));
    let shown = block
        .lines
        .iter()
        .filter_map(|line| line.split("# prints ").nth(1));
    assert!(str::from_utf8(&told).unwrap().lines().eq(shown), "{told:?}");
}

#[test]
fn commands_within_sentences_name_verbs_options_and_files_that_there_are() {
    let folder = tempdir().unwrap();
    let here = folder.path();
    let mut help = printed(here, &["--help"]);
    let verbs = verbs(&help);
    for verb in verbs
        .iter()
        .map(String::as_str)
        .chain(["table inspect", "table verify"])
    {
        help += &printed(
            here,
            &[&["help"], &verb.split(' ').collect::<Vec<_>>()[..]].concat(),
        );
    }
    let options: BTreeSet<_> = help
        .split(|c: char| !c.is_alphanumeric() && c != '-')
        .collect();
    let mut all = pages();
    all.extend(["benches/README.md", "tests/README.md"].map(page));
    for page in all {
        let blocks = page.blocks();
        let commands = blocks.iter().filter(|block| block.language == "sh");
        let commands = commands.flat_map(|block| block.lines.iter().map(|line| (*line).to_owned()));
        for span in page.spans().into_iter().chain(commands) {
            let words: Vec<_> = span
                .split([' ', ',', ';'])
                .filter(|word| !word.is_empty())
                .collect();
            match words[..] {
                ["cargo", "bench", "--bench", name, ..] => exists(&format!("benches/{name}.rs")),
                ["cargo", "test", "--test", name, ref rest @ ..] => {
                    exists(&format!("tests/{name}/main.rs"));
                    let filter = rest.first().filter(|word| !word.starts_with(['-', '#']));
                    assert!(
                        filter.is_none_or(|filter| has_module(name, filter)),
                        "{}: {span}",
                        page.name
                    );
                }
                ["darkness", verb, ..] if verb != "help" && !verb.starts_with('-') => {
                    assert!(
                        verbs.iter().any(|known| known == verb),
                        "{}: {span}",
                        page.name
                    );
                }
                _ => {}
            }
            if words.first().is_some_and(|word| {
                *word == "darkness" || word.starts_with("--") && page.name != "tests/README.md"
            }) {
                for option in words.iter().filter(|word| word.starts_with("--")) {
                    assert!(
                        options.contains(option),
                        "{}: {option} of {span}",
                        page.name
                    );
                }
            }
        }
    }
}

#[test]
fn the_page_of_commands_has_every_verb() {
    let folder = tempdir().unwrap();
    let text = page("docs/commands.md").text;
    for verb in verbs(&printed(folder.path(), &["--help"])) {
        assert!(text.contains(&format!("| `darkness {verb} ")), "{verb}");
    }
}

#[test]
fn the_page_of_the_window_has_every_control_of_its_help() {
    let folder = tempdir().unwrap();
    let text = page("docs/view.md").text;
    let help = printed(folder.path(), &["help", "view"]);
    let (_, controls) = help.split_once("In the window:\n").unwrap();
    let rows = controls.lines().map(|line| {
        let (input, effect) = line.trim().split_once("  ").unwrap();
        format!("| {input} | {} |", effect.trim())
    });
    let lines = text
        .lines()
        .skip_while(|line| !line.starts_with("| input |"));
    let shown = lines.skip(2).take_while(|line| line.starts_with('|'));
    assert!(rows.eq(shown.map(str::to_owned)), "{controls}");
}

/// Returns the verbs that the program's help lists, and those that it only mentions.
fn verbs(help: &str) -> Vec<String> {
    let (_, list) = help.split_once("Commands:\n").unwrap();
    let lines = list.lines().take_while(|line| !line.is_empty());
    let names = lines.filter_map(|line| line.split_whitespace().next());
    let hidden = ["completions", "man"];
    let verbs = names.filter(|name| *name != "help").chain(hidden);
    let verbs: Vec<_> = verbs.map(str::to_owned).collect();
    assert!(verbs.len() > hidden.len() + 5, "{help}");
    verbs
}

fn exists(file: &str) {
    assert!(Path::new(PROJECT).join(file).exists(), "{file}");
}

/// Returns whether a test has a module whose name begins so.
fn has_module(test: &str, name: &str) -> bool {
    let files = fs::read_dir(Path::new(PROJECT).join("tests").join(test)).unwrap();
    let mut names = files.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    names.any(|file| file.starts_with(name))
}
