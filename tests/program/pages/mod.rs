//! Guards against a README and pages that promise what is not so: each of their commands, programs and scenes is run,
//! and what they show as printed is what is printed.

mod commands;
mod gallery;
mod markdown;
mod scenes;

use std::path::Path;

use markdown::{PROJECT, page, pages};

#[test]
fn the_readme_is_short_and_no_line_of_a_page_is_long() {
    let readme = page("README.md").text.lines().count();
    assert!(readme <= 150, "README.md has {readme} lines");
    for page in pages() {
        for line in page.text.lines() {
            assert!(line.chars().count() <= 120, "{}: {line}", page.name);
        }
    }
}

#[test]
fn links_lead_to_files() {
    for page in pages() {
        let folder = Path::new(PROJECT).join(&page.name);
        for link in page.links() {
            let file = folder.parent().unwrap().join(link);
            assert!(file.exists(), "{}: {link}", page.name);
        }
    }
}

#[test]
fn the_readmes_figures_are_those_of_the_benches() {
    let readme = page("README.md").text;
    let (_, section) = readme.split_once("## Speed and accuracy").unwrap();
    let rows = section.lines().filter(|line| line.starts_with("| "));
    let figures = page("benches/README.md").text.replace('\n', " ");
    let mut count = 0;
    for row in rows.skip(1) {
        let figure = row.split('|').nth(2).unwrap().trim();
        assert!(
            figures.contains(figure),
            "{figure} is not in benches/README.md"
        );
        count += 1;
    }
    assert_eq!(count, 4);
}
