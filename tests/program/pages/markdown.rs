//! The pages, and the parts of them that are code.

use std::fs;
use std::path::Path;

/// The project's folder.
pub(crate) const PROJECT: &str = env!("CARGO_MANIFEST_DIR");

/// A page of Markdown.
pub(crate) struct Page {
    /// Its path within the project.
    pub(crate) name: String,
    pub(crate) text: String,
}

/// A block of code.
pub(crate) struct Block<'a> {
    pub(crate) language: &'a str,
    pub(crate) lines: Vec<&'a str>,
    /// The lines of the block of `text` that follows at once, if there is one: what the commands print.
    pub(crate) printed: Option<Vec<&'a str>>,
}

/// Reads a page, by its path within the project.
pub(crate) fn page(name: &str) -> Page {
    let text = fs::read_to_string(Path::new(PROJECT).join(name)).unwrap();
    let name = name.to_owned();
    Page { name, text }
}

/// Returns the project's README and the pages in `docs`.
pub(crate) fn pages() -> Vec<Page> {
    let docs = fs::read_dir(Path::new(PROJECT).join("docs")).unwrap();
    let names = docs.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<_> = names.map(|name| format!("docs/{name}")).collect();
    names.sort();
    names.insert(0, "README.md".into());
    names.iter().map(|name| page(name)).collect()
}

impl Page {
    /// Returns the blocks of code in their order, without those that show what the block before them prints.
    pub(crate) fn blocks(&self) -> Vec<Block<'_>> {
        let mut blocks: Vec<Block> = Vec::new();
        let mut lines = self.text.lines();
        let mut is_right_after = false;
        while let Some(line) = lines.next() {
            let Some(language) = line.strip_prefix("```") else {
                is_right_after = false;
                continue;
            };
            let inside: Vec<_> = lines.by_ref().take_while(|&line| line != "```").collect();
            match blocks.last_mut() {
                Some(before) if is_right_after && language == "text" => {
                    before.printed = Some(inside);
                }
                _ => blocks.push(Block {
                    language,
                    lines: inside,
                    printed: None,
                }),
            }
            is_right_after = true;
        }
        blocks
    }

    /// Returns the pieces of code within sentences and tables.
    pub(crate) fn spans(&self) -> Vec<String> {
        let mut is_block = false;
        let outside = self.text.lines().filter(|line| {
            let is_fence = line.starts_with("```");
            is_block ^= is_fence;
            !is_block && !is_fence
        });
        let text: String = outside.flat_map(|line| [line, " "]).collect();
        text.split('`')
            .skip(1)
            .step_by(2)
            .map(str::to_owned)
            .collect()
    }

    /// Returns the targets of links and pictures that are files of the project.
    pub(crate) fn links(&self) -> Vec<&str> {
        let ends = self.text.split("](").skip(1);
        ends.filter_map(|end| end.split(')').next())
            .filter(|target| !target.starts_with("https://"))
            .collect()
    }
}
