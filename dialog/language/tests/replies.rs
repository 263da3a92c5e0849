//! What the robot says is English, whatever it is asked about: no article before a pronoun, and nothing offered that was denied.

use crate::support::Talk;
use cohabit_language::Understanding;

const REQUESTS: [&str; 38] = [
    "pick up {}",
    "bring me {}",
    "go to {}",
    "enter {}",
    "open {}",
    "close {}",
    "scan {}",
    "look at {}",
    "put {} on the table",
    "put the banana on {}",
    "put the banana in {}",
    "put down {}",
    "heat {}",
    "heat the banana in {}",
    "clean {}",
    "break {}",
    "turn on {}",
    "turn {} off",
    "fill {}",
    "fill {} with milk",
    "pour the milk into {}",
    "bring {} to the break room",
    "throw {} away",
    "find {}",
    "point at {}",
    "repair {}",
    "paint {} red",
    "use {}",
    "print {}",
    "swap {} with the banana",
    "where is {}",
    "what color is {}",
    "is {} broken",
    "how many of {} are there",
    "how many {} are there",
    "what is on {}",
    "what is next to {}",
    "do you see {}",
];

const REFERENCES: [&str; 40] = [
    "it",
    "that",
    "this",
    "them",
    "those",
    "one",
    "ones",
    "the one",
    "that one",
    "the other one",
    "the red one",
    "the purple one",
    "all of them",
    "both of them",
    "something",
    "anything",
    "the thing",
    "the red thing",
    "the thing over there",
    "there",
    "the mug",
    "a mug",
    "my mug",
    "all the mugs",
    "all mugs",
    "both mugs",
    "the mugs",
    "one of the mugs",
    "any of the mugs",
    "two mugs",
    "the second mug",
    "the purple mug",
    "the mug that is purple",
    "the mug in the quantum lab",
    "the mug in the quantum lab that is purple",
    "the fridge in the main office",
    "the hammer",
    "an orange hammer",
    "the sticky notes",
    "my flurbl",
];

const ARTICLES: [&str; 3] = ["a", "an", "the"];
const DETERMINERS: [&str; 12] = ["a", "an", "the", "my", "all", "both", "it", "that", "this", "them", "those", "there"];

/// What is said without a pause: the words between punctuation, outside of quotation marks.
fn phrases(said: &str) -> Vec<Vec<String>> {
    let plain: String = said.split('"').step_by(2).collect::<Vec<_>>().join(",");
    let words = |phrase: &str| phrase.split_whitespace().map(str::to_lowercase).collect();
    plain.split([',', '.', ':', ';', '?', '!']).map(words).collect()
}

/// What is wrong with a sentence, if something is.
fn fault(said: &str) -> Option<String> {
    if said.is_empty() || said.contains("  ") || !said.ends_with(['.', '?', '!', '"']) {
        return Some("no sentence".to_owned());
    }
    phrases(said).iter().flat_map(|words| words.windows(2)).find_map(|pair| {
        let [first, second] = [pair[0].as_str(), pair[1].as_str()];
        let is_vowel = second.starts_with(['a', 'e', 'i', 'o', 'u']);
        let is_doubled = ARTICLES.contains(&first) && DETERMINERS.contains(&second)
            || matches!(first, "no" | "any" | "one" | "some") && ARTICLES.contains(&second);
        let is_unfit = first == "a" && is_vowel || first == "an" && !is_vowel;
        (is_doubled || is_unfit).then(|| format!("{first} {second}"))
    })
}

/// `I do not know of a shelf. Do you mean the shelf?`
fn offers_what_it_denies(said: &str) -> bool {
    let Some((denied, offered)) = said.split_once("Do you mean ") else { return false };
    let words = |said: &str| phrases(said).concat();
    let (denied, offered) = (words(denied), words(offered));
    !denied.is_empty() && offered.iter().all(|word| word == "the" || denied.contains(word))
}

#[test]
fn replies_are_english_whatever_is_spoken_of() {
    let scenes = [&[][..], &["held Bowl_01_1"], &["without Hammer_1"]];
    // Each combination in one scene: a sentence takes a tenth of a second.
    for (first, marks) in scenes.iter().enumerate() {
        let all = REQUESTS.iter().flat_map(|one| REFERENCES.iter().map(move |other| (one, other)));
        for (request, reference) in all.skip(first).step_by(scenes.len()) {
            let mut talk = Talk::new(marks);
            let asked = request.replace("{}", reference);
            let understanding = talk.language.understand(&asked, &talk.scene, &mut talk.context);
            let said = match &understanding {
                Understanding::Plan { reply, .. } | Understanding::Stop { reply, .. } => reply.clone(),
                Understanding::Question { text, .. }
                | Understanding::Answer { text, .. }
                | Understanding::Refusal { text, .. } => text.clone(),
            };
            assert_eq!(fault(&said), None, "{asked} {marks:?}: {said}");
            assert!(!offers_what_it_denies(&said), "{asked} {marks:?}: {said}");
        }
    }
}
