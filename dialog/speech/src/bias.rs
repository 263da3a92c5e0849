//! What is likely to be said.

use std::{collections::BTreeSet, sync::Arc};

/// Shapes of what people say to a robot, with slots for what is there.
const REQUESTS: &str = include_str!("../data/requests.txt");

/// Of a shape with two slots, each filling of the first is said with so many of the second: the model looks at three words at
/// a time, and need not see all pairs.
const PAIRS: usize = 2;

const COLORS: &[&str] = &["red", "green", "blue", "yellow", "white", "black", "orange", "brown"];
const DEGREES: &[&str] = &["10", "15", "20", "30", "45", "60", "90", "180", "360"];
const COUNTS: &[&str] = &["a", "one", "two", "three", "four", "five", "six", "ten"];

/// What is likely to be said, from who knows the scene and the grammar of requests.
///
/// A recogniser makes a small language model of the sentences, and trusts words that stand in neither less.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Bias {
    /// Words that may be said, lower case, without punctuation.
    pub words: BTreeSet<String>,
    /// Sentences that are likely, each as it would be typed. How often one stands here is how likely it is.
    pub sentences: Vec<String>,
    /// Words that are as unlikely as any other, but would be understood.
    pub known: Arc<BTreeSet<String>>,
}

impl Bias {
    /// A bias of sentences; their words may be said in others.
    #[must_use]
    pub fn of(sentences: impl IntoIterator<Item = impl Into<String>>) -> Self {
        let sentences: Vec<String> = sentences.into_iter().map(Into::into).collect();
        let words = sentences.iter().flat_map(|sentence| words(sentence)).collect();
        Self { words, sentences, known: Arc::default() }
    }

    /// What is said to a robot that knows of these: requests, questions and answers.
    #[must_use]
    pub fn of_scene(scene: &Scene) -> Self {
        Self { known: Arc::clone(&scene.known), ..Self::shaped(REQUESTS, scene) }
    }

    /// Shapes with slots, one a line, filled with what is there; `=` begins a line of words, `#` one that says nothing.
    fn shaped(shapes: &str, scene: &Scene) -> Self {
        let mut bias = Self::default();
        for line in shapes.lines().filter(|line| !line.is_empty() && !line.starts_with('#')) {
            match line.strip_prefix('=') {
                Some(more) => bias.words.extend(words(more)),
                None => fill(line, scene, 0, &mut bias.sentences),
            }
        }
        bias.words.extend(bias.sentences.iter().flat_map(|sentence| words(sentence)));
        let plural = |name: &String| words(name).pop().map(|word| word + "s");
        bias.words.extend(scene.things.iter().filter_map(plural));
        bias.words.extend(scene.words.iter().flat_map(|word| words(word)));
        bias
    }

    /// Whether it says nothing.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.sentences.is_empty()
    }
}

/// What can be spoken of, as people call it: `mug`, `coffee maker`, `break room`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Scene {
    /// What can be taken.
    pub things: Vec<String>,
    /// What things are put on or in, and what is worked with.
    pub places: Vec<String>,
    /// Rooms.
    pub rooms: Vec<String>,
    /// Other words that may be said: names of robots and people, what goals speak of.
    pub words: Vec<String>,
    /// All other words that are understood, in small letters.
    pub known: Arc<BTreeSet<String>>,
}

impl Scene {
    fn slot(&self, name: &str) -> Vec<&str> {
        let of = |names: &[&'static str]| names.to_vec();
        match name {
            "thing" => self.things.iter().map(String::as_str).collect(),
            "place" => self.places.iter().map(String::as_str).collect(),
            "room" => self.rooms.iter().map(String::as_str).collect(),
            "color" => of(COLORS),
            "number" => of(DEGREES),
            "count" => of(COUNTS),
            _ => Vec::new(),
        }
    }
}

/// Fills the slots of a shape: the first with all there is, the others with a few each, from a place on that differs.
fn fill(shape: &str, scene: &Scene, from: usize, into: &mut Vec<String>) {
    let slot =
        shape.split_once('{').and_then(|(head, rest)| rest.split_once('}').map(|(name, tail)| (head, name, tail)));
    let Some((head, name, tail)) = slot else {
        into.push(shape.to_owned());
        return;
    };
    let names = scene.slot(name);
    let is_first = from == 0;
    let count = if is_first { names.len() } else { PAIRS.min(names.len()) };
    for at in 0..count {
        let name = names[(from * 7 + at) % names.len()];
        let is_an = head.ends_with(" a ") && name.starts_with(['a', 'e', 'i', 'o']);
        let filled =
            format!("{}{}{name}{tail}", head.trim_end(), if is_an { "n " } else { &head[head.trim_end().len()..] });
        fill(&filled, scene, from + at + 1, into);
    }
}

/// The words of a text: lower case, what stands between them left out, `don't` as one word.
pub(crate) fn words(text: &str) -> Vec<String> {
    let text = text.to_lowercase().replace('’', "'");
    let words = text.split(|c: char| !c.is_alphanumeric() && c != '\'');
    words.map(|word| word.trim_matches('\'').to_owned()).filter(|word| !word.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_told_apart() {
        let check = |text: &str, expected: &[&str]| assert_eq!(words(text), expected, "{text}");
        check("Open the fridge, please!", &["open", "the", "fridge", "please"]);
        check("Don’t  'drop' it.", &["don't", "drop", "it"]);
        check(" … ", &[]);
    }

    #[test]
    fn shapes_are_filled_with_what_is_there() {
        let owned = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
        let scene = Scene {
            things: owned(&["mug", "apple"]),
            places: owned(&["sink", "table", "fridge"]),
            rooms: owned(&["lab"]),
            words: owned(&["Rosie"]),
            known: Arc::default(),
        };
        let shapes = "# going\ngo to the {room}\nput the {thing} on the {place}\nfly {nowhere}\nfind a {thing}\nstop\n= uh, please";
        let bias = Bias::shaped(shapes, &scene);
        assert_eq!(bias.sentences.len(), 1 + 2 * PAIRS + 2 + 1, "{:?}", bias.sentences);
        for sentence in ["go to the lab", "find a mug", "find an apple"] {
            assert!(bias.sentences.contains(&sentence.to_owned()), "{sentence}");
        }
        let pairs = bias.sentences.iter().filter(|sentence| sentence.starts_with("put the apple on the ")).count();
        assert_eq!(pairs, PAIRS);
        assert!(["uh", "please", "rosie", "stop", "mugs"].into_iter().all(|word| bias.words.contains(word)));
        assert!(!bias.words.contains("nowhere"));
    }

    #[test]
    fn what_people_say_names_all_that_is_there() {
        let names = |kind: &str| (0..30).map(|at| format!("{kind}{at}")).collect::<Vec<_>>();
        let scene = Scene { things: names("thing"), places: names("place"), rooms: names("room"), ..Scene::default() };
        let bias = Bias::of_scene(&scene);
        assert!(
            names("thing").iter().chain(&names("place")).chain(&names("room")).all(|name| bias.words.contains(name))
        );
        assert!(bias.sentences.iter().all(|sentence| !sentence.contains(['{', '}'])));
        assert!(bias.sentences.len() < 20_000, "{}", bias.sentences.len());
        assert!(Bias::of_scene(&Scene::default()).words.contains("stop"));
    }

    #[test]
    fn a_bias_of_sentences_knows_their_words() {
        let bias = Bias::of(["Take the mug.", "take the bowl"]);
        assert_eq!(bias.words.into_iter().collect::<Vec<_>>(), ["bowl", "mug", "take", "the"]);
        assert!(Bias::default().is_empty());
    }
}
