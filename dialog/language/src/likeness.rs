//! What people's own words are like: things told by use and look, hints and wishes, and the requests that would be said plainly.

use std::{collections::HashMap, sync::LazyLock};

use cohabit_cdf::{Catalog, ClassId};
use cohabit_parser::{Direction, Directions, Meaning};

use crate::cache::Cache;

static THINGS: &str = include_str!("../data/things.txt");
static HINTS: &str = include_str!("../data/hints.txt");
static DIRECTIONS: &[u8] = include_bytes!("../data/directions.safetensors");

/// By how much likenesses are divided to be utilities, whose exponentials are in the ratio of probabilities.
pub(crate) const SHARPNESS: f32 = 0.05;
/// How like an utterance is to a request that it is not like at all, and a description to a thing.
pub(crate) const UNLIKE: f32 = 0.3;
pub(crate) const UNLIKE_THING: f32 = 0.44;

/// How like texts are.
pub(crate) struct Likeness {
    directions: Directions,
    /// What people say for a thing, by its name.
    things: HashMap<&'static str, Vec<Direction>>,
    /// What people say instead of a plain request, by that request.
    hints: HashMap<&'static str, Vec<Direction>>,
    computed: Cache<Direction>,
}

impl Likeness {
    pub(crate) fn builtin() -> &'static Self {
        static BUILTIN: LazyLock<Likeness> = LazyLock::new(|| {
            let directions =
                Directions::new(DIRECTIONS).expect("invariant: the built-in directions load, which a test holds");
            let by_head = |data: &'static str| {
                let mut by_head: HashMap<&str, Vec<Direction>> = HashMap::new();
                for (head, said) in lines(data) {
                    by_head.entry(head).or_default().extend(directions.get(said).cloned());
                }
                by_head
            };
            Likeness { things: by_head(THINGS), hints: by_head(HINTS), computed: Cache::default(), directions }
        });
        &BUILTIN
    }

    /// The direction of any text.
    pub(crate) fn of(&self, text: &str) -> Direction {
        if let Some(known) = self.directions.get(text) {
            return known.clone();
        }
        self.computed.get_or_insert_with(text, || Meaning::builtin().of(text))
    }

    /// How like a description is to what things of a class are called, and to how people tell them by use and look.
    pub(crate) fn to_class(&self, said: &Direction, catalog: &Catalog, class: ClassId) -> f32 {
        let name = &catalog.names(class).plain;
        let most_like = |most: Option<f32>, like: f32| Some(most.map_or(like, |most| most.max(like)));
        let words = catalog.class(class).words.iter().map(|word| said.likeness(&self.of(&format!("the {word}"))));
        let called = words.chain([said.likeness(&self.of(&format!("the {name}")))]).fold(-1.0, f32::max);
        let told = self.things.get(name.as_str()).into_iter().flatten().map(|told| said.likeness(told));
        told.fold(None, most_like).map_or(called, |told| f32::midpoint(called, told))
    }

    /// How like an utterance is to a plain request, or to what people say instead of it.
    pub(crate) fn to_request(&self, said: &Direction, request: &str) -> f32 {
        let hints = self.hints.get(request).into_iter().flatten().map(|hint| said.likeness(hint));
        hints.fold(said.likeness(&self.of(request)), f32::max)
    }
}

/// Lines of `head | what is said`.
fn lines(data: &'static str) -> impl Iterator<Item = (&'static str, &'static str)> {
    data.lines().filter(|line| !line.starts_with('#')).filter_map(|line| line.split_once(" | "))
}

#[cfg(test)]
mod tests {
    use std::{collections::BTreeSet, fs, path::Path};

    use super::*;
    use crate::{acts, describe};

    /// All texts of the data and of the built-in catalogue whose directions are wanted often.
    fn wanted() -> Vec<String> {
        let catalog = Catalog::builtin();
        let classes = || (0..).zip(catalog.classes());
        let names: BTreeSet<String> = classes().map(|(id, _)| describe::name(&catalog, ClassId(id))).collect();
        let words = classes().flat_map(|(_, class)| class.words.iter());
        let called = names.iter().chain(words).map(|name| format!("the {name}"));
        let of_things = names.iter().flat_map(|name| acts::of_thing(name, |_| true)).map(|(_, request)| request);
        let said = lines(THINGS).chain(lines(HINTS)).map(|(_, said)| said.to_owned());
        let all: BTreeSet<String> = called.chain(of_things).chain(said).chain(acts::others()).collect();
        all.into_iter().collect()
    }

    #[test]
    #[ignore = "writes data/directions.safetensors: after a change of the data or of the model"]
    fn write_directions() {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/directions.safetensors");
        fs::write(file, Directions::file(&wanted()).unwrap()).unwrap();
    }

    #[test]
    fn the_directions_are_those_of_the_texts() {
        let likeness = Likeness::builtin();
        for (at, text) in wanted().iter().enumerate() {
            let known = likeness.directions.get(text);
            assert!(
                known.is_some(),
                "`{text}` lacks a direction: cargo test -p cohabit-language --lib write_directions -- --ignored"
            );
            if at % 50 == 0 {
                assert_eq!(known, Some(&Meaning::builtin().of(text)), "{text}");
            }
        }
    }
}
