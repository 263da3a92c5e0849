//! What people read on the page: a table, which the server writes into the page.

use std::collections::BTreeMap;

use serde_json::json;

const TABLE: &str = include_str!("../data/texts.toml");
/// What stands in the page for the whole table, for its scripts.
const ALL: &str = "texts";

/// A page with its texts: `html` has their keys in braces. Other names in braces stay.
///
/// # Panics
/// Never: a test reads the same table.
#[must_use]
pub fn filled(html: &str) -> String {
    let texts = table();
    // Within a script no letter may begin a tag.
    let all = json!(texts).to_string().replace('<', "\\u003c");
    let page =
        texts.iter().fold(html.to_owned(), |page, (key, text)| page.replace(&format!("{{{key}}}"), &escaped(text)));
    page.replace(&format!("{{{ALL}}}"), &all)
}

fn table() -> BTreeMap<String, String> {
    toml::from_str(TABLE).expect("invariant: the built-in texts parse, which a test holds")
}

/// A text as HTML shows it, in its text and in its attributes.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    const PAGES: [&str; 2] = [include_str!("../web/edit.html"), include_str!("../web/stranger.html")];
    const SCRIPTS: [&str; 4] = [
        include_str!("../web/edit.js"),
        include_str!("../web/plan.js"),
        include_str!("../web/drawing.js"),
        include_str!("../web/mission.js"),
    ];

    #[test]
    fn all_texts_of_pages_and_scripts_are_in_the_table_and_no_others() {
        let mut named: BTreeSet<String> = BTreeSet::new();
        for page in PAGES {
            let keys = page.split('{').skip(1).filter_map(|rest| rest.split_once('}')).map(|(key, _)| key.to_owned());
            named.extend(keys.filter(|key| key != ALL));
        }
        for script in SCRIPTS {
            let keys = script.split("text(\"").skip(1).filter_map(|rest| rest.split_once('"'));
            named.extend(keys.map(|(key, _)| key.to_owned()));
        }
        let known: BTreeSet<String> = table().into_keys().collect();
        assert_eq!(named, known);
        assert!(table().values().all(|text| !text.trim().is_empty()));
    }

    #[test]
    fn a_page_shows_texts_as_they_are() {
        let page = filled("<title>{play}</title>{texts}{other}");
        assert!(page.starts_with("<title>Save and play</title>{\"") && page.ends_with("}{other}"), "{page}");
        assert_eq!(escaped("<a \"b\">"), "&lt;a &quot;b&quot;&gt;");
    }
}
