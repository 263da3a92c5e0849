//! How alike words sound, for what a recogniser of speech takes for another: `brake room`, `turn write`, `serial box`.

/// A word as sounds: consonants in classes, vowels.
type Sounds = Vec<char>;

/// The most by which what was heard may differ from what was said, and the most for each of its sounds.
const LIMIT: f32 = 1.1;
const LIMIT_EACH: f32 = 0.25;
/// So many sounds may be more or fewer.
const MOST_MORE: usize = 2;

/// Costs: one vowel for another, a vowel more or less, a consonant for one made nearly alike, a weak one more or less, an `h`,
/// any more or less, any for another.
const VOWEL: f32 = 0.2;
const EXTRA_VOWEL: f32 = 0.35;
const ALIKE: f32 = 0.35;
const WEAK: f32 = 0.5;
const BREATH: f32 = 0.25;
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
    ('m', 'b'),
    ('q', 's'),
    ('q', 'f'),
    ('q', 't'),
    ('q', 'd'),
    ('v', 'b'),
    ('x', 's'),
    ('v', 'w'),
    ('c', 't'),
];

/// Words by how they sound, for finding all that sound like one.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sounding {
    /// In the order of their sounds, so that what many begin with is compared once.
    words: Vec<(Sounds, String)>,
}

impl Sounding {
    pub(crate) fn new<'a>(words: impl Iterator<Item = &'a String>) -> Self {
        let mut words: Vec<(Sounds, String)> = words.map(|word| (sounds(word), word.clone())).collect();
        words.sort();
        Self { words }
    }

    /// Of words whose sounds are known.
    pub(crate) fn of(words: impl Iterator<Item = (Vec<char>, String)>) -> Self {
        let mut words: Vec<(Sounds, String)> = words.collect();
        words.sort();
        Self { words }
    }

    /// The words that may be taken for one with these sounds, and how differently they sound: 0 if they sound the same.
    pub(crate) fn alike(&self, heard: &[char]) -> Vec<(f32, &str)> {
        let mut table = Table::new(heard);
        let is_near = |meant: &Sounds| !meant.is_empty() && meant.len().abs_diff(heard.len()) <= MOST_MORE;
        let near = self.words.iter().filter(|(meant, _)| is_near(meant));
        near.filter_map(|(meant, word)| {
            let limit = LIMIT.min(LIMIT_EACH * meant.len().max(heard.len()) as f32);
            let cost = table.distance(meant).filter(|cost| *cost <= limit)?;
            Some((cost, word.as_str()))
        })
        .collect()
    }
}

/// What it costs to make the beginnings of `heard` of those of another word: a row for each sound of that.
struct Table<'a> {
    heard: &'a [char],
    against: Vec<char>,
    rows: Vec<Vec<f32>>,
}

impl<'a> Table<'a> {
    fn new(heard: &'a [char]) -> Self {
        let mut sum = 0.0;
        let rest = heard.iter().map(|sound| {
            sum += extra(*sound);
            sum
        });
        Self { heard, against: Vec::new(), rows: vec![std::iter::once(0.0).chain(rest).collect()] }
    }

    /// The least that it costs to make one of the other; nothing, if that is more than is allowed on the way already.
    fn distance(&mut self, meant: &[char]) -> Option<f32> {
        let shared = self.against.iter().zip(meant).take_while(|(one, other)| one == other).count();
        self.against.truncate(shared);
        self.rows.truncate(shared + 1);
        for sound in &meant[shared..] {
            if self.is_hopeless() {
                return None;
            }
            self.add(*sound);
        }
        self.rows.last().and_then(|row| row.last()).copied()
    }

    fn is_hopeless(&self) -> bool {
        self.rows.last().is_some_and(|row| row.iter().all(|cost| *cost > LIMIT))
    }

    fn add(&mut self, sound: char) {
        let Some(above) = self.rows.last() else { return };
        let mut row = Vec::with_capacity(above.len());
        let mut left = above[0] + extra(sound);
        row.push(left);
        for (at, heard) in self.heard.iter().enumerate() {
            let changed = above[at] + change(*heard, sound);
            left = changed.min(left + extra(*heard)).min(above[at + 1] + extra(sound));
            row.push(left);
        }
        self.against.push(sound);
        self.rows.push(row);
    }
}

fn is_vowel(sound: char) -> bool {
    matches!(sound, 'a' | 'e' | 'i' | 'o' | 'u')
}

fn extra(sound: char) -> f32 {
    match sound {
        _ if is_vowel(sound) => EXTRA_VOWEL,
        'h' => BREATH,
        't' | 'd' | 'n' | 'r' | 'l' | 's' | 'z' => WEAK,
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
            let words = ["mug", "tableau", meant, "zoo"].map(str::to_owned);
            let sounding = Sounding::new(words.iter());
            let found = sounding.alike(&sounds(heard)).iter().any(|(_, word)| *word == meant);
            assert_eq!(found, is_alike, "{heard} {meant}: {:?} {:?}", sounds(heard), sounds(meant));
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
