//! A small pack that works: what a pack of one's own begins with.

/// Its files, but for what depends on its name.
const FILES: &[(&str, &str)] = &[
    ("objects/things.toml", include_str!("../../templates/world/objects/things.toml")),
    ("models/things.toml", include_str!("../../templates/world/models/things.toml")),
    ("table/devices.toml", include_str!("../../templates/world/table/devices.toml")),
    ("layouts/Workshop.toml", include_str!("../../templates/world/layouts/Workshop.toml")),
    ("missions/clean_wrench.json", include_str!("../../templates/world/missions/clean_wrench.json")),
    ("missions/clean_wrench.script", include_str!("../../templates/world/missions/clean_wrench.script")),
];

/// Its head; `NAME` stands for the pack's name.
const HEAD: &str = include_str!("../../templates/world/world.toml");

/// What a pack's name is made of.
pub const NAME_RULE: &str = "begin with a small letter, and go on with small letters, digits, `-` and `_`, 64 at most";

/// Whether a pack may have this name.
#[must_use]
pub fn is_name(name: &str) -> bool {
    let is_inner = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || matches!(c, '-' | '_');
    name.starts_with(|c: char| c.is_ascii_lowercase()) && name.len() <= 64 && name.chars().all(is_inner)
}

/// The files of a pack with this name, as `(path from its folder, text)`: a floor plan with a room called workshop, a wrench, a
/// degreaser that works by the table alone, and a mission that needs all of them.
#[must_use]
pub fn files(name: &str) -> Vec<(&'static str, String)> {
    let rest = FILES.iter().map(|(path, text)| (*path, (*text).to_owned()));
    std::iter::once((super::HEAD, HEAD.replace("NAME", name))).chain(rest).collect()
}
