//! What the guide is made of: its pages, their order, its pictures, and where links of its pages lead.

/// One page of the guide.
pub struct Page {
    /// Its name: that of its file without the ending, and of its address without the `/`.
    pub name: &'static str,
    /// Its text (Markdown). It begins with its only heading of the first level.
    pub text: &'static str,
}

macro_rules! pages {
    ($($name:literal),* $(,)?) => {
        &[$(Page { name: $name, text: include_str!(concat!("../../../guide/src/", $name, ".md")) }),*]
    };
}

/// All pages, in the order of [`SUMMARY`].
pub const PAGES: &[Page] = pages![
    "first-session",
    "how-it-works",
    "talk",
    "understanding",
    "missions",
    "goals",
    "worlds",
    "editors",
    "vision",
    "voice",
    "together",
    "pedestrians",
    "study",
    "dry-run",
    "questionnaires",
    "deploy",
    "host",
    "wizard",
    "tables",
    "replay",
    "steps",
    "rerun",
    "agents",
    "python",
    "expert",
    "evaluation",
    "benchmark",
    "arena",
    "language-model",
    "mcp",
    "performance",
    "latency",
    "limits",
    "stability",
    "security",
    "troubleshooting",
    "development",
];

/// The pages and their titles, as mdBook has them.
pub const SUMMARY: &str = include_str!("../../../guide/src/SUMMARY.md");

/// The pictures of pages: where they lie from the root of the repository, and what is in them (JPEG).
pub const PICTURES: &[(&str, &[u8])] = &[
    ("dialog/pictures/page.jpg", include_bytes!("../../../../dialog/pictures/page.jpg")),
    ("dialog/pictures/driving.jpg", include_bytes!("../../../../dialog/pictures/driving.jpg")),
    ("dialog/pictures/replay.jpg", include_bytes!("../../../../dialog/pictures/replay.jpg")),
    ("runtime/render/pictures/home.jpg", include_bytes!("../../../render/pictures/home.jpg")),
    ("runtime/render/pictures/modalities.jpg", include_bytes!("../../../render/pictures/modalities.jpg")),
    ("runtime/render/pictures/objects.jpg", include_bytes!("../../../render/pictures/objects.jpg")),
    ("runtime/render/pictures/people.jpg", include_bytes!("../../../render/pictures/people.jpg")),
    ("runtime/viewer/pictures/rerun.jpg", include_bytes!("../../../viewer/pictures/rerun.jpg")),
];

/// The folder of the pages, from the root of the repository.
const FOLDER: &str = "runtime/guide/src";

/// Where a link leads.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum Target {
    /// To a page of the guide, at the address that it has there, with the heading if there is one: `/study#consent`.
    Page(String),
    /// To a heading of the same page: `#consent`.
    Heading(String),
    /// To another site.
    Site(String),
    /// To a file of the repository, by its path from the root: the guide does not serve it.
    Source(String),
}

/// The page of that name.
pub fn page(name: &str) -> Option<&'static Page> {
    PAGES.iter().find(|page| page.name == name)
}

/// Where a link of a page leads.
pub fn target(link: &str) -> Target {
    if link.starts_with("https://") || link.starts_with("http://") {
        return Target::Site(link.to_owned());
    }
    let (path, heading) = link.split_at(link.find('#').unwrap_or(link.len()));
    match path.strip_suffix(".md").filter(|name| !name.contains('/')) {
        Some(name) => Target::Page(format!("/{name}{heading}")),
        None if path.is_empty() => Target::Heading(heading.to_owned()),
        None => Target::Source(from_root(path)),
    }
}

/// A path that is written in a page, from the root of the repository.
pub fn from_root(path: &str) -> String {
    let mut parts: Vec<&str> = FOLDER.split('/').collect();
    for part in path.split('/') {
        match part {
            ".." => {
                parts.pop();
            }
            "." | "" => {}
            name => parts.push(name),
        }
    }
    parts.join("/")
}

/// Where the guide serves a picture that lies there in the repository.
pub fn picture_address(path: &str) -> String {
    format!("/pictures/{}", path.rsplit('/').next().unwrap_or(path))
}
