//! The nearest known name to one that is not known.

/// The name of `known` that is fewest edits away from `name`, if near enough to be a slip of the pen.
///
/// Case does not count. Of names equally near the first one wins.
pub(crate) fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let name = lower(name);
    let most = (name.len() / 3).max(1);
    known
        .into_iter()
        .filter_map(|known| Some((edits(&name, &lower(known), most)?, known)))
        .min_by_key(|(edits, _)| *edits)
        .map(|(_, known)| known)
}

/// A remedy that names the known name nearest to `name`.
pub(crate) fn did_you_mean<'k>(name: &str, known: impl IntoIterator<Item = &'k str>) -> Option<String> {
    nearest(name, known).map(suggestion)
}

/// What a message says of the known name that is near to one that is not.
#[must_use]
pub fn suggestion(near: &str) -> String {
    format!("did you mean `{near}`?")
}

/// The same within a sentence; nothing, if no name is near.
pub(crate) fn aside(near: &Option<String>) -> String {
    near.as_deref().map_or_else(String::new, |near| format!(" ({})", suggestion(near)))
}

fn lower(text: &str) -> Vec<char> {
    text.chars().take(LONGEST).flat_map(char::to_lowercase).collect()
}

/// Names in mission files are shorter; longer ones are cut, to bound the work.
const LONGEST: usize = 80;

/// Insertions, deletions, replacements and swaps of neighbours from `a` to `b` (optimal string alignment);
/// `None` if more than `most`.
fn edits(a: &[char], b: &[char], most: usize) -> Option<usize> {
    if a.len().abs_diff(b.len()) > most {
        return None;
    }
    let mut before: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.iter().enumerate() {
        let mut row = vec![i + 1];
        for (j, to) in b.iter().enumerate() {
            let mut cost = (last[j] + usize::from(from != to)).min(last[j + 1] + 1).min(row[j] + 1);
            if i > 0 && j > 0 && *from == b[j - 1] && a[i - 1] == *to {
                cost = cost.min(before[j - 1] + 1);
            }
            row.push(cost);
        }
        before = std::mem::replace(&mut last, row);
    }
    last.last().copied().filter(|edits| *edits <= most)
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn the_nearest_name_wins() {
        let known = ["Bowl_01", "Bowls", "BreakRoom", "isToggledOn", "isOpen"];
        for (name, expected) in [
            ("Bowl", Some("Bowls")),
            ("Bowl_1", Some("Bowl_01")),
            ("Braekroom", Some("BreakRoom")),
            ("isToggled", Some("isToggledOn")),
            ("isopen", Some("isOpen")),
            ("Xylophone", None),
            ("", None),
        ] {
            assert_eq!(nearest(name, known), expected, "{name}");
        }
    }
}
