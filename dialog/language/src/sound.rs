//! How alike words sound, for what a recogniser of speech takes for another: `brake room`, `turn write`, `serial box`.

/// A word as sounds: consonants in classes, vowels.
type Sounds = Vec<char>;

/// The most by which what was heard may differ from what was said, and the most for each of its sounds.
const LIMIT: f32 = 1.1;
const LIMIT_EACH: f32 = 0.25;

/// Costs: one vowel for another, a vowel more or less, a consonant for one made nearly alike, a weak one more or less,
/// any more or less, any for another.
const VOWEL: f32 = 0.2;
const EXTRA_VOWEL: f32 = 0.35;
const ALIKE: f32 = 0.35;
const WEAK: f32 = 0.5;
const EXTRA: f32 = 0.9;
const OTHER: f32 = 1.0;

/// Sounds made nearly alike.
const PAIRS: &[(char, char)] = &[
    ('b', 'p'),
    ('d', 't'),
    ('g', 'k'),
    ('v', 'f'),
    ('z', 's'),
    ('j', 'c'),
    ('j', 'x'),
    ('c', 'x'),
    ('m', 'n'),
    ('q', 's'),
    ('q', 'f'),
    ('q', 't'),
    ('q', 'd'),
    ('v', 'b'),
    ('x', 's'),
    ('v', 'w'),
    ('c', 't'),
];

/// How differently two words sound: 0 if they sound the same; nothing, if nobody would take one for the other.
pub(crate) fn difference(heard: &Sounds, meant: &Sounds) -> Option<f32> {
    let longest = heard.len().max(meant.len());
    if heard.is_empty() || meant.is_empty() || heard.len().abs_diff(meant.len()) > 2 {
        return None;
    }
    let limit = LIMIT.min(LIMIT_EACH * longest as f32);
    distance(heard, meant, limit).filter(|cost| *cost <= limit)
}

/// The least that it costs to make one of the other; nothing, if that is more than `limit` on the way already.
fn distance(one: &[char], other: &[char], limit: f32) -> Option<f32> {
    let mut row: Vec<f32> =
        std::iter::once(0.0).chain(other.iter().scan(0.0, |sum, sound| Some(more(sum, *sound)))).collect();
    for sound in one {
        let mut corner = row[0];
        row[0] += extra(*sound);
        for (at, against) in other.iter().enumerate() {
            let changed = corner + change(*sound, *against);
            corner = row[at + 1];
            row[at + 1] = changed.min(row[at] + extra(*against)).min(corner + extra(*sound));
        }
        if row.iter().all(|cost| *cost > limit) {
            return None;
        }
    }
    row.last().copied()
}

fn more(sum: &mut f32, sound: char) -> f32 {
    *sum += extra(sound);
    *sum
}

fn is_vowel(sound: char) -> bool {
    matches!(sound, 'a' | 'e' | 'i' | 'o' | 'u')
}

fn extra(sound: char) -> f32 {
    match sound {
        _ if is_vowel(sound) => EXTRA_VOWEL,
        't' | 'd' | 'n' | 'r' | 'l' | 's' | 'z' | 'h' => WEAK,
        _ => EXTRA,
    }
}

fn change(one: char, other: char) -> f32 {
    if one == other {
        0.0
    } else if is_vowel(one) && is_vowel(other) {
        VOWEL
    } else if PAIRS.contains(&(one, other)) || PAIRS.contains(&(other, one)) {
        ALIKE
    } else {
        OTHER
    }
}

/// Letters that stand for one sound, the longest first; `` is silent. At the start, anywhere, at the end.
const START: &[(&str, &str)] =
    &[("kn", "n"), ("two", "to"), ("wr", "r"), ("gn", "n"), ("ps", "s"), ("wh", "w"), ("who", "hu"), ("x", "z")];
const ANYWHERE: &[(&str, &str)] = &[
    ("thes", "s"),
    ("tch", "c"),
    ("dge", "j"),
    ("igh", "i"),
    ("ough", "o"),
    ("augh", "o"),
    ("sch", "sk"),
    ("tion", "xun"),
    ("sh", "x"),
    ("ch", "c"),
    ("th", "q"),
    ("ph", "f"),
    ("ck", "k"),
    ("gh", ""),
    ("qu", "kw"),
    ("ce", "se"),
    ("ci", "si"),
    ("cy", "si"),
    ("ge", "je"),
    ("gi", "ji"),
    ("wh", "w"),
    ("mb", "m"),
    ("ee", "i"),
    ("ea", "i"),
    ("oo", "u"),
    ("ou", "u"),
    ("ow", "o"),
    ("oa", "o"),
    ("ai", "e"),
    ("ay", "e"),
    ("ey", "i"),
    ("ie", "i"),
    ("ei", "i"),
    ("au", "o"),
    ("aw", "o"),
    ("ew", "u"),
    ("ue", "u"),
    ("ui", "u"),
    ("oe", "o"),
    ("y", "i"),
    ("c", "k"),
    ("x", "ks"),
    ("q", "k"),
];

/// The sounds of a word of plain letters.
pub(crate) fn sounds(word: &str) -> Sounds {
    let mut rest = word;
    let mut sounds = String::new();
    if let Some((letters, sound)) = START.iter().find(|(letters, _)| rest.starts_with(letters)) {
        sounds.push_str(sound);
        rest = &rest[letters.len()..];
    }
    while let Some(first) = rest.chars().next() {
        // A last `e` is silent.
        if rest == "e" && sounds.len() > 1 {
            break;
        }
        match ANYWHERE.iter().find(|(letters, _)| rest.starts_with(letters)) {
            Some((letters, sound)) => {
                sounds.push_str(sound);
                rest = &rest[letters.len()..];
            }
            None => {
                sounds.push(first);
                rest = &rest[first.len_utf8()..];
            }
        }
    }
    let mut sounds: Vec<char> = sounds.chars().collect();
    sounds.dedup();
    if sounds.len() > 3 && sounds.last() == Some(&'e') && word.ends_with('e') {
        sounds.pop();
    }
    sounds
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_sounds_alike_is_near() {
        let check = |heard: &str, meant: &str, is_alike: bool| {
            let found = difference(&sounds(heard), &sounds(meant));
            assert_eq!(found.is_some(), is_alike, "{heard} {meant}: {:?} {:?} {found:?}", sounds(heard), sounds(meant));
        };
        for (heard, meant) in [
            ("write", "right"),
            ("read", "red"),
            ("french", "fridge"),
            ("brake", "break"),
            ("think", "sink"),
            ("wherehouse", "warehouse"),
            ("serial", "cereal"),
            ("clothes", "close"),
            ("lock", "look"),
            ("two", "to"),
            ("lap", "lab"),
            ("lied", "light"),
            ("shelve", "shelf"),
            ("boll", "bowl"),
            ("plait", "plate"),
        ] {
            check(heard, meant, true);
        }
        for (heard, meant) in [("flurbl", "fridge"), ("zebra", "table"), ("monday", "mug"), ("everything", "every")] {
            check(heard, meant, false);
        }
    }
}
