//! What people call the classes of a catalogue.

use std::collections::HashMap;

use super::ObjectClass;

/// What people call a class.
#[derive(Clone, Debug)]
pub struct ClassNames {
    /// Its readable name in lower case, `TAM` and such kept; `table round small` in the order in which people say that.
    pub plain: String,
    /// A name of several words that ends in the plain one, and tells it from other classes of that name: `red computer`.
    pub special: Option<String>,
}

/// What people call these classes, in their order.
pub(super) fn of_classes(classes: &[ObjectClass]) -> Vec<ClassNames> {
    let mut by_name: HashMap<String, Vec<&ObjectClass>> = HashMap::new();
    for class in classes {
        by_name.entry(class.name.to_lowercase()).or_default().push(class);
    }
    let names = classes.iter().map(|class| {
        let plain = plain(class);
        let namesakes = by_name.get(&plain).map(Vec::as_slice).unwrap_or_default();
        ClassNames { special: special(class, &plain, namesakes), plain }
    });
    names.collect()
}

fn plain(class: &ObjectClass) -> String {
    let name = if class.name.is_empty() { &class.id } else { &class.name };
    let sorted = |name: &str| {
        let mut words: Vec<_> = name.split_whitespace().map(str::to_lowercase).collect();
        words.sort_unstable();
        words
    };
    let is_it = |said: &&String| said.len() == name.len() && sorted(said) == sorted(name);
    let name = class.words.iter().find(is_it).unwrap_or(name);
    let lower = |word: &str| {
        let is_acronym = word.chars().filter(|character| character.is_uppercase()).count() > 1;
        if is_acronym { word.to_owned() } else { word.to_lowercase() }
    };
    name.split_whitespace().map(lower).collect::<Vec<_>>().join(" ")
}

fn special(class: &ObjectClass, plain: &str, namesakes: &[&ObjectClass]) -> Option<String> {
    if namesakes.len() < 2 {
        return None;
    }
    let ending = format!(" {plain}");
    let colored = format!("{} {plain}", class.color.to_lowercase());
    let is_shared = |word: &String| namesakes.iter().filter(|other| other.words.contains(word)).count() > 1;
    let is_special = |word: &&String| word.ends_with(&ending) && !is_shared(word);
    let is_colored = |word: &&String| **word == colored;
    class.words.iter().find(is_colored).or_else(|| class.words.iter().find(is_special)).cloned()
}
