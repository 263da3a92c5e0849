//! The guide as files that are served: each page within its frame, with all pages at its side.

use cohabit_dialog::{SiteFile, media};
use pulldown_cmark::HeadingLevel;

use super::{
    book::{PAGES, PICTURES, Page, SUMMARY, picture_address},
    markdown::{headings, html},
};

/// What stands around each page.
const FRAME: &str = include_str!("../../../guide/web/page.html");
const STYLE: &str = include_str!("../../../guide/web/guide.css");
const ICON: &str = include_str!("../../../../dialog/web/favicon.svg");
const MISSING: &str = "# Not found\n\nThe guide has no such page. Choose one from the list of pages.\n";

/// All files. The first page is found at `/`, too.
pub fn files() -> Vec<SiteFile> {
    let text = |path: &str, kind, text: &str| SiteFile { path: path.to_owned(), kind, bytes: text.as_bytes().to_vec() };
    let pages = (0..PAGES.len()).map(|place| text(&format!("/{}", PAGES[place].name), media::HTML, &whole(place)));
    let pictures = PICTURES.iter().map(|(path, bytes)| SiteFile {
        path: picture_address(path),
        kind: "image/jpeg",
        bytes: bytes.to_vec(),
    });
    let others = [
        text("/", media::HTML, &whole(0)),
        text("/guide.css", media::STYLE, STYLE),
        text("/favicon.svg", media::SVG, ICON),
    ];
    others.into_iter().chain(pages).chain(pictures).collect()
}

/// What is served for pages that there are not.
pub fn missing() -> SiteFile {
    SiteFile { path: "/".to_owned(), kind: media::HTML, bytes: framed("Not found", "", MISSING).into_bytes() }
}

/// The title of a page: its heading of the first level.
pub fn title(page: &Page) -> String {
    let heading = headings(page.text).into_iter().find(|heading| heading.level == HeadingLevel::H1);
    heading.map(|heading| heading.text).unwrap_or_default()
}

/// The page at a place of [`PAGES`], and links to those before and after it.
fn whole(place: usize) -> String {
    let page = &PAGES[place];
    let link = |word: &str, page: &Page| format!("{word}: [{}]({}.md)", title(page), page.name);
    let before = place.checked_sub(1).and_then(|place| PAGES.get(place)).map(|page| link("Previous page", page));
    let after = PAGES.get(place + 1).map(|page| link("Next page", page));
    let links: Vec<String> = before.into_iter().chain(after).collect();
    framed(&title(page), page.name, &format!("{}\n---\n\n{}\n", page.text, links.join(" · ")))
}

/// A text with all that stands around it. The text comes last, so that nothing in it is taken for a place of the frame.
fn framed(title: &str, name: &str, markdown: &str) -> String {
    let link = format!("href=\"/{name}\"");
    let contents = html(list()).replace(&link, &format!("{link} aria-current=\"page\""));
    FRAME
        .replace("{title}", title)
        .replace("{version}", env!("CARGO_PKG_VERSION"))
        .replace("{contents}", &contents)
        .replace("{content}", &html(markdown))
}

/// The list of pages, without the heading that mdBook wants above it.
fn list() -> &'static str {
    SUMMARY.split_once('\n').map_or("", |(_, list)| list)
}
