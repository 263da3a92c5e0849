//! README and guide: their links lead somewhere, and the commands in them are commands of this program.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};

use clap::{CommandFactory as _, Parser as _};
use cohabit_cdf::mission::goal_kinds;
use cohabit_tests::{Block, Call, blocks, commands};
use pulldown_cmark::{Event, HeadingLevel, Tag};

use super::{
    book::{PAGES, PICTURES, SUMMARY, Target, from_root, page, target},
    markdown::{Heading, events, headings, html},
    pages::{files, title},
};
use crate::Cohabit;

/// The root of the repository.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// README and all pages: the path from the root, and the text.
fn texts() -> Vec<(String, String)> {
    let pages = PAGES.iter().map(|page| (format!("runtime/guide/src/{}.md", page.name), page.text.to_owned()));
    let readme = fs::read_to_string(root().join("README.md")).unwrap();
    std::iter::once(("README.md".to_owned(), readme)).chain(pages).collect()
}

/// Where links and pictures of a text lead.
fn links(text: &str) -> Vec<String> {
    let link = |event| match event {
        Event::Start(Tag::Link { dest_url, .. } | Tag::Image { dest_url, .. }) => Some(dest_url.to_string()),
        _ => None,
    };
    events(text).filter_map(link).collect()
}

/// What the links to the headings of a text have behind the `#`.
fn anchors(text: &str) -> Vec<String> {
    headings(text).iter().map(Heading::anchor).collect()
}

#[test]
fn the_page_for_labs_names_the_port_of_all_that_listens() {
    let table = page("deploy").unwrap().text;
    for command in Cohabit::command().get_subcommands() {
        let port = command.get_arguments().find(|argument| argument.get_id() == "port");
        for usual in port.into_iter().flat_map(clap::Arg::get_default_values) {
            let usual = usual.to_string_lossy().into_owned();
            assert!(table.contains(&format!("| {usual}")), "{} listens at {usual}", command.get_name());
        }
    }
}

#[test]
fn every_link_leads_to_a_page_a_heading_or_a_file() {
    for (file, text) in texts() {
        let folder = root().join(&file).parent().unwrap().to_owned();
        for link in links(&text) {
            if matches!(target(&link), Target::Site(_)) {
                continue;
            }
            let (path, anchor) = link.split_once('#').unwrap_or((&link, ""));
            let meant = if path.is_empty() { root().join(&file) } else { folder.join(path) };
            assert!(meant.exists(), "{file}: `{link}` leads to no file");
            if !anchor.is_empty() {
                let there = anchors(&fs::read_to_string(&meant).unwrap());
                assert!(there.contains(&anchor.to_owned()), "{file}: `{link}` leads to no heading of {there:?}");
            }
        }
    }
}

#[test]
fn the_guide_serves_every_page_and_picture_that_its_pages_link_to() {
    let served: BTreeSet<String> = files().into_iter().map(|file| file.path).collect();
    for shown in PAGES {
        for event in events(shown.text) {
            match event {
                Event::Start(Tag::Link { dest_url, .. }) => {
                    if let Target::Page(address) = target(&dest_url) {
                        let path = address.split('#').next().unwrap_or_default();
                        assert!(served.contains(path), "{}: `{dest_url}`", shown.name);
                    }
                }
                Event::Start(Tag::Image { dest_url, .. }) => {
                    let path = from_root(&dest_url);
                    assert!(PICTURES.iter().any(|(known, _)| *known == path), "{}: `{dest_url}`", shown.name);
                }
                _ => {}
            }
        }
    }
}

#[test]
fn the_summary_has_all_pages_in_their_order_with_their_titles() {
    let listed: Vec<(String, String)> = SUMMARY
        .lines()
        .filter_map(|line| line.strip_prefix("- [")?.strip_suffix(".md)")?.split_once("]("))
        .map(|(title, name)| (title.to_owned(), name.to_owned()))
        .collect();
    let pages: Vec<(String, String)> = PAGES.iter().map(|page| (title(page), page.name.to_owned())).collect();
    assert_eq!(listed, pages);
    let folder = fs::read_dir(root().join("runtime/guide/src")).unwrap();
    let names: BTreeSet<String> =
        folder.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
    let known: BTreeSet<String> =
        PAGES.iter().map(|page| format!("{}.md", page.name)).chain(["SUMMARY.md".to_owned()]).collect();
    assert_eq!(names, known);
}

#[test]
fn a_page_has_one_title_and_no_heading_twice() {
    for page in PAGES {
        let headings = headings(page.text);
        let titles = headings.iter().filter(|heading| heading.level == HeadingLevel::H1).count();
        assert!(titles == 1 && headings[0].level == HeadingLevel::H1, "{}: {headings:?}", page.name);
        assert!(!title(page).contains(['<', '>', '&', '"', '`', '*', '_', '[']), "{}", title(page));
        let anchors = anchors(page.text);
        assert_eq!(anchors.iter().collect::<BTreeSet<_>>().len(), anchors.len(), "{}: {anchors:?}", page.name);
    }
    assert!(page("study").is_some() && page("nowhere").is_none());
}

#[test]
fn a_page_names_itself_in_the_list_of_pages() {
    for file in files().into_iter().filter(|file| file.kind.starts_with("text/html")) {
        let text = String::from_utf8(file.bytes).unwrap();
        assert_eq!(text.matches("aria-current=\"page\"").count(), 1, "{}", file.path);
        assert_eq!(text.matches("<h1").count(), 1, "{}", file.path);
        assert!(!["{title}", "{version}", "{contents}"].iter().any(|place| text.contains(place)), "{}", file.path);
    }
    assert_eq!(html(SUMMARY).matches("<a href=\"/").count(), PAGES.len());
}

#[test]
fn the_page_of_goals_has_all_that_goals_can_ask_for() {
    let shown = page("goals").unwrap();
    for kind in goal_kinds() {
        let line = format!("| `{}` | `{}` | {} |", kind.key, kind.example, kind.meaning);
        assert!(shown.text.lines().any(|own| own == line), "the page `goals` lacks the line: {line}");
    }
}

#[test]
fn the_readme_is_short() {
    let (_, readme) = texts().swap_remove(0);
    assert!(readme.lines().count() <= 150, "{} lines", readme.lines().count());
}

#[test]
fn every_command_is_one_of_this_program() {
    let mut count = 0;
    for (file, text) in texts() {
        let blocks = blocks(&text).unwrap();
        for (line, typed) in blocks.iter().filter(|block| block.is_of_shell()).flat_map(Block::commands) {
            for call in commands(&typed).iter().filter_map(|words| Call::of(words)) {
                count += 1;
                let arguments = std::iter::once("cohabit".to_owned()).chain(call.arguments);
                // The answer to `--help` is an error, too, but none of this kind.
                let refused = Cohabit::try_parse_from(arguments).err().filter(clap::Error::use_stderr);
                let said = refused.as_ref().map(ToString::to_string).unwrap_or_default();
                assert!(refused.is_none(), "{file}:{line}: `{typed}`: {said}");
            }
        }
    }
    assert!(count > 80, "only {count} commands were found");
}
