//! Goals instead of steps: what is wished for, said as the request that brings it about.
//! `i want the mug to be hot` → `heat the mug`; `the green desk needs the hammer on it` → `put the hammer on the green desk`.

use crate::{
    read::{color, reader::Reader, segments},
    words::{
        inflect::{self, stem},
        lexicon::{Lexicon, Preposition},
        table::PhraseTable,
        token,
    },
};

/// The request that a wish at the start of `words` comes to, and how many words the wish took.
pub(crate) fn request(lexicon: &Lexicon, words: &[String]) -> Option<(Vec<String>, usize)> {
    let chunk = chunk(lexicon, words);
    let wished = spoken(lexicon, chunk).or_else(|| stated(lexicon, chunk))?;
    Some((wished, chunk.len()))
}

/// Whether a wish with words of its own begins there.
pub(crate) fn is_said(lexicon: &Lexicon, words: &[String]) -> bool {
    spoken(lexicon, chunk(lexicon, words)).is_some()
}

/// `it should stay there`: nothing is to be done to it.
pub(crate) fn leaves_as_is(lexicon: &Lexicon, words: &[String]) -> bool {
    let stays = |words: &[String]| {
        let (_, after) = thing(lexicon, words)?;
        let (must, ()) = lexicon.wishes.musts.longest(after)?;
        let (_, rest) = after[must..].split_first().filter(|(stay, _)| lexicon.wishes.stayers.contains(*stay))?;
        let (length, ()) = lexicon.wishes.as_is.longest(rest)?;
        is_after(lexicon, &rest[length..]).then_some(())
    };
    words.split(|word| token::is_punctuation(word)).any(|chunk| stays(chunk).is_some())
}

/// The words up to the next request, and to what is not wished for: `… than on the table`.
fn chunk<'a>(lexicon: &Lexicon, words: &'a [String]) -> &'a [String] {
    until_next(lexicon, segments::chunk(words))
}

fn spoken(lexicon: &Lexicon, chunk: &[String]) -> Option<Vec<String>> {
    let chunk = &chunk[..chunk.iter().position(|word| word == "than").unwrap_or(chunk.len())];
    wanted(lexicon, chunk)
        .or_else(|| ordered(lexicon, chunk))
        .or_else(|| made(lexicon, chunk))
        .or_else(|| given(lexicon, chunk))
        .or_else(|| asked(lexicon, chunk))
        .or_else(|| required(lexicon, chunk))
        .or_else(|| rid_of_dirt(lexicon, chunk))
        .or_else(|| ensured(lexicon, chunk))
        .or_else(|| performed(lexicon, chunk))
        .or_else(|| left_so(lexicon, chunk))
        .or_else(|| clefted(lexicon, chunk))
        .or_else(|| infected(lexicon, chunk))
        .or_else(|| subjected(lexicon, chunk))
        .or_else(|| shot(lexicon, chunk))
        .or_else(|| moved(lexicon, chunk))
        .or_else(|| cleared(lexicon, chunk))
        .or_else(|| kept(lexicon, chunk))
}

/// `it is the cereal that I want`
fn clefted(lexicon: &Lexicon, words: &[String]) -> Option<Vec<String>> {
    let rest = words.strip_prefix(["it", "is"].map(str::to_owned).as_slice())?;
    let (thing, after) = thing(lexicon, rest)?;
    let after = after.strip_prefix(["that".to_owned()].as_slice()).unwrap_or(after);
    let (wish, who) = after.split_last()?;
    let is_wish = lexicon.wishes.wishes.contains(wish) && !who.is_empty();
    (is_wish && who.iter().all(|word| lexicon.wishes.wishers.contains(word)))
        .then(|| joined(&[&["get"], &texts(thing)]))
}

/// `infect the computer with the floppy disk`: the disk goes into it.
fn infected(lexicon: &Lexicon, words: &[String]) -> Option<Vec<String>> {
    let (_, rest) = words.split_first().filter(|(first, _)| lexicon.wishes.infecters.contains(*first))?;
    let (thing, after) = thing(lexicon, rest)?;
    let (_, tool) = after.split_first().filter(|(with, _)| matches!(with.as_str(), "with" | "using"))?;
    Some(joined(&[&["put"], &texts(tool), &["in"], &texts(thing)]))
}

/// `subject the mug to the laser`: the laser is to be used on it.
fn subjected(lexicon: &Lexicon, words: &[String]) -> Option<Vec<String>> {
    let (_, rest) = words.split_first().filter(|(first, _)| lexicon.wishes.subjecters.contains(*first))?;
    let (thing, after) = thing(lexicon, rest)?;
    let (_, device) = after.split_first().filter(|(to, _)| *to == "to")?;
    Some(joined(&[&["use"], &texts(device), &["on"], &texts(thing)]))
}

/// `zap the mug with the freeze ray`: what it is shot with is to be used on it.
fn shot(lexicon: &Lexicon, words: &[String]) -> Option<Vec<String>> {
    let (length, ()) = lexicon.wishes.shooters.longest(words)?;
    let (thing, after) = thing(lexicon, &words[length..])?;
    let (_, device) = after.split_first().filter(|(with, _)| matches!(with.as_str(), "with" | "using"))?;
    let phrase = Reader::new(lexicon, device).phrase().filter(|phrase| !phrase.namings.is_empty())?;
    let is_carried = phrase.namings.iter().any(|naming| lexicon.carried.contains(&naming.class));
    (!is_carried).then(|| joined(&[&["use"], &texts(device), &["on"], &texts(thing)]))
}

/// `move the football out of the way`: it is to be put somewhere else. `hang the shirt up to dry`: it is to be dried.
fn moved(lexicon: &Lexicon, words: &[String]) -> Option<Vec<String>> {
    let (_, rest) = words.split_first().filter(|(first, _)| lexicon.wishes.movers.contains(*first))?;
    let split = |ends: &PhraseTable<()>| {
        let is_there =
            |at: &usize| ends.longest(&rest[*at..]).is_some_and(|(length, ())| is_end(lexicon, &rest[at + length..]));
        let named = &rest[..(1..rest.len()).find(is_there)?];
        thing(lexicon, named).filter(|(_, left)| left.is_empty()).map(|(thing, _)| texts(thing))
    };
    let dried = split(&lexicon.wishes.to_dry).map(|thing| joined(&[&["dry"], &thing]));
    dried.or_else(|| split(&lexicon.wishes.asides).map(|thing| joined(&[&["put"], &thing])))
}

/// `keep them on the shoe rack`: they are to be put there.
fn kept(lexicon: &Lexicon, words: &[String]) -> Option<Vec<String>> {
    let (_, rest) = words.split_first().filter(|(first, _)| *first == "keep")?;
    let (thing, after) = thing(lexicon, rest)?;
    let is_there = after.first().is_some_and(|word| matches!(word.as_str(), "on" | "in" | "inside" | "near" | "at"));
    is_there.then(|| joined(&[&["put"], &texts(thing), &texts(after)]))
}

/// `clear the table`: what is on it is to be put away.
fn cleared(lexicon: &Lexicon, words: &[String]) -> Option<Vec<String>> {
    let (length, ()) = lexicon.wishes.clearers.longest(words)?;
    let (thing, after) = thing(lexicon, &words[length..])?;
    let phrase = Reader::new(lexicon, thing).phrase().filter(|phrase| !phrase.namings.is_empty())?;
    let classes = || phrase.namings.iter().map(|naming| &naming.class);
    let is_furniture = classes().any(|class| lexicon.furniture.contains(class))
        && !classes().any(|class| lexicon.carried.contains(class));
    let is_whole = is_end(lexicon, after);
    (is_furniture && is_whole).then(|| joined(&[&["put", "away", "every", "thing", "on"], &texts(thing)]))
}

/// `you left the microwave open`: it is to be as it was.
fn left_so(lexicon: &Lexicon, words: &[String]) -> Option<Vec<String>> {
    let (_, rest) = words.split_first().filter(|(left, _)| *left == "left")?;
    let (thing, after) = thing(lexicon, rest)?;
    let (verb, left) = state(lexicon, after)?;
    let undone = lexicon.wishes.undoes.get(&verb.join(" "))?;
    finish(lexicon, undone.split(' ').map(str::to_owned).collect(), thing, left)
}

/// `drop the waste into the bin`, `scrape the leftovers off the plate`: whatever it is on is to be clean.
fn rid_of_dirt(lexicon: &Lexicon, words: &[String]) -> Option<Vec<String>> {
    let mut rest = &words[lexicon.wishes.removers.longest(words)?.0..];
    while rest.first().is_some_and(|word| matches!(word.as_str(), "the" | "all" | "any" | "that" | "this" | "of")) {
        rest = &rest[1..];
    }
    let (dirt, rest) = rest.split_first()?;
    if !lexicon.wishes.dirt.contains(dirt) {
        return None;
    }
    let of = rest.iter().position(|word| matches!(word.as_str(), "from" | "off" | "on"));
    let thing = of.map_or(&[][..], |at| &rest[at + 1..]);
    let end = thing.iter().position(|word| matches!(word.as_str(), "to" | "in" | "into")).unwrap_or(thing.len());
    let mut request = vec!["clean".to_owned()];
    request.extend_from_slice(if end == 0 { &[] } else { &thing[..end] });
    if end == 0 {
        request.push("it".to_owned());
    }
    Some(request)
}

/// The words up to `and`, `so` or `but` before a request of its own.
fn until_next<'a>(lexicon: &Lexicon, words: &'a [String]) -> &'a [String] {
    let end = (0..words.len()).find(|at| {
        let mut reader = Reader::new(lexicon, words);
        reader.at = at + 1;
        let is_joint = matches!(words[*at].as_str(), "and" | "so" | "but" | "then");
        reader.skip(|lexicon| &lexicon.lead);
        is_joint && reader.at_verb() || *at > 0 && asks_anew(&words[*at..])
    });
    &words[..end.unwrap_or(words.len())]
}

/// `i need it fixed, can you do it` without the pause.
fn asks_anew(words: &[String]) -> bool {
    matches!(words, [modal, you, ..] if matches!(modal.as_str(), "can" | "could" | "would" | "will") && you == "you")
}

/// `i want …`, `my boss would like …`.
fn wanted(lexicon: &Lexicon, words: &[String]) -> Option<Vec<String>> {
    let at = words.iter().position(|word| !lexicon.wishes.wishers.contains(word))?;
    let is_wish = lexicon.wishes.wishes.contains(&words[at])
        && (!matches!(words[at].as_str(), "like" | "love" | "use")
            || at > 0 && matches!(words[at - 1].as_str(), "would" | "really" | "could" | "will"));
    if !is_wish || at == 0 && !words[0].ends_with('s') && words[0] != "need" && words[0] != "want" {
        return None;
    }
    let rest = &words[at + 1..];
    if let Some(drink) = drink(lexicon, rest) {
        return Some(drink);
    }
    // `i need you over at the sink`
    if let [you, rest @ ..] = rest
        && you == "you"
    {
        let skipped = rest.iter().take_while(|word| matches!(word.as_str(), "over" | "back" | "right" | "up")).count();
        let is_place = lexicon.prepositions.longest(&rest[skipped..]).is_some();
        let does = rest[skipped..].first().is_some_and(|word| word == "to")
            && Reader::new(lexicon, &rest[skipped + 1..]).at_verb();
        let place = Reader::new(lexicon, &rest[skipped..]).place().filter(|_| is_place && !does);
        return place.map(|_| joined(&[&["go", "to"], &texts(inner(lexicon, &rest[skipped + 1..]))]));
    }
    // `i would want to have the bowl cold`
    if rest.first().is_some_and(|word| word == "to") {
        return made(lexicon, &rest[1..]);
    }
    let (thing, after) = thing(lexicon, rest)?;
    become_so(lexicon, thing, after).or_else(|| {
        let is_end = is_after(lexicon, after);
        is_end.then(|| joined(&[&["get"], &texts(thing)]))
    })
}

/// `make me a cup of coffee`, `let us have toast`.
fn ordered(lexicon: &Lexicon, words: &[String]) -> Option<Vec<String>> {
    let (first, rest) = words.split_first()?;
    if !lexicon.wishes.orders.contains(first) {
        return None;
    }
    let skipped = rest.iter().take_while(|word| matches!(word.as_str(), "me" | "us" | "him" | "her" | "up")).count();
    let rest = &rest[skipped..];
    let has_measure =
        rest.iter().take(3).any(|word| matches!(word.as_str(), "glass" | "cup" | "mug" | "drop" | "splash" | "pot"));
    let is_made = matches!(first.as_str(), "make" | "brew" | "do" | "prepare" | "have" | "cook" | "fix" | "produce");
    let is_coffee = rest.iter().take(3).any(|word| word == "coffee" || word == "tea")
        && rest.first().is_some_and(|word| word != "the");
    let is_some = rest.first().is_some_and(|word| word == "some") && rest.get(1).is_some_and(|word| word == "water");
    // `put water in the cup`
    let is_put = matches!(first.as_str(), "put" | "add" | "give")
        && rest.iter().take(3).any(|word| matches!(word.as_str(), "in" | "into" | "to" | "inside"));
    (is_made || has_measure || is_coffee || is_some || is_put).then(|| drink(lexicon, rest)).flatten()
}

/// Something to drink or to eat that has to be made.
fn drink(lexicon: &Lexicon, words: &[String]) -> Option<Vec<String>> {
    let measured = words.iter().take_while(|word| lexicon.wishes.measures.contains(*word)).count();
    let rest = &words[measured..];
    let (length, after) = match rest.first()?.as_str() {
        "toast" | "tea" => (1, &rest[1..]),
        _ => {
            let (length, _) = lexicon.fluids.longest(rest)?;
            let noun = lexicon.classes.longest(rest).map_or(0, |(length, _)| length);
            (length, rest.get(length..).filter(|_| noun <= length)?)
        }
    };
    let what = rest[..length].join(" ");
    let into =
        after.first().is_some_and(|word| matches!(word.as_str(), "in" | "into" | "to" | "inside")) && after.len() > 1;
    if !into && !is_after(lexicon, after) {
        return None;
    }
    let place: Vec<&str> = if into { texts(&after[1..]) } else { vec!["a", "mug"] };
    Some(match what.as_str() {
        "toast" => joined(&[&["toast", "the", "bread"]]),
        "tea" if into => joined(&[&["make", "tea", "in"], &place]),
        "tea" => joined(&[&["make", "tea"]]),
        "milk" if into => joined(&[&["pour", "the", "milk", "into"], &place]),
        "milk" => return None,
        _ if what.ends_with("coffee") && !into => joined(&[&["make", "coffee"]]),
        _ => joined(&[&["fill"], &place, &["with"], &texts(&rest[..length])]),
    })
}

/// `make it whole again`, `get the bowl really cold`.
fn made(lexicon: &Lexicon, words: &[String]) -> Option<Vec<String>> {
    let (first, rest) = words.split_first()?;
    if !lexicon.wishes.makers.contains(first) {
        return None;
    }
    // `put on the light` is a verb of its own, and may be something else.
    if lexicon.verbs.longest(words).is_none_or(|(length, _)| length < 2)
        && let Some(request) = made_first(lexicon, rest)
    {
        return Some(request);
    }
    let (thing, after) = thing(lexicon, rest)?;
    let skipped = after.iter().take_while(|word| lexicon.wishes.between.contains(*word)).count();
    let done = || participle(lexicon, &after[skipped..]).filter(|_| matches!(first.as_str(), "have" | "get"));
    let (request, left) = state(lexicon, &after[skipped..]).or_else(done)?;
    finish(lexicon, request, thing, left)
}

/// `make clean the plate`.
fn made_first(lexicon: &Lexicon, words: &[String]) -> Option<Vec<String>> {
    let (length, verb) = lexicon.brings_about.longest(words)?;
    let (thing, left) = thing(lexicon, &words[length..])?;
    // `make hot coffee`: that is made.
    let has_article = thing.first().is_some_and(|first| lexicon.articles.exact(std::slice::from_ref(first)).is_some());
    has_article.then(|| finish(lexicon, verb.clone(), thing, left)).flatten()
}

/// `make sure the freezer is open`.
fn ensured(lexicon: &Lexicon, words: &[String]) -> Option<Vec<String>> {
    let (length, ()) = lexicon.wishes.ensurers.longest(words)?;
    let (thing, after) = thing(lexicon, &words[length..])?;
    become_so(lexicon, thing, after)
}

/// `perform a quick scan of the hammer`.
fn performed(lexicon: &Lexicon, words: &[String]) -> Option<Vec<String>> {
    let (length, ()) = lexicon.wishes.performers.longest(words)?;
    let (article, rest) = words[length..].split_first()?;
    if !matches!(article.as_str(), "a" | "an" | "the" | "another") {
        return None;
    }
    let of = rest.iter().position(|word| matches!(word.as_str(), "of" | "on"))?;
    let (verb, thing) = (rest[..of].last()?, &rest[of + 1..]);
    lexicon.verbs.exact(std::slice::from_ref(verb))?;
    Some(joined(&[&[verb], &texts(thing)]))
}

/// `give it a wash`.
fn given(lexicon: &Lexicon, words: &[String]) -> Option<Vec<String>> {
    let (first, rest) = words.split_first()?;
    if !matches!(first.as_str(), "give" | "have" | "do") {
        return None;
    }
    let (thing, after) = thing(lexicon, rest)?;
    let skipped = after
        .iter()
        .take_while(|word| {
            matches!(
                word.as_str(),
                "a" | "an" | "another" | "good" | "quick" | "nice" | "little" | "proper" | "thorough"
            )
        })
        .count();
    let verb = after.get(skipped).filter(|_| skipped > 0)?;
    let verb = match verb.as_str() {
        "bath" | "shower" | "cleaning" | "washing" => "wash",
        other => other,
    };
    lexicon.verbs.exact(&[verb.to_owned()])?;
    Some(joined(&[&[verb], &texts(thing), &texts(&after[skipped + 1..])]))
}

/// `can the mug be heated`.
fn asked(lexicon: &Lexicon, words: &[String]) -> Option<Vec<String>> {
    let (first, rest) = words.split_first()?;
    let may = matches!(first.as_str(), "can" | "could" | "would" | "will" | "should" | "may" | "might" | "shall");
    let (thing, after) = thing(lexicon, rest).filter(|_| may)?;
    let is_passive = after.first().is_some_and(|word| matches!(word.as_str(), "be" | "get" | "go"));
    is_passive.then(|| become_so(lexicon, thing, after)).flatten()
}

/// `the plate needs to be cleaned`, `the trophy belongs on the blue desk`.
fn required(lexicon: &Lexicon, words: &[String]) -> Option<Vec<String>> {
    let (thing, after) = thing(lexicon, words)?;
    let (must, ()) = lexicon.wishes.musts.longest(after)?;
    let after = &after[must..];
    if let Some(request) = become_so(lexicon, thing, after) {
        return Some(request);
    }
    // `the desk needs the hammer on it`
    let mut reader = Reader::new(lexicon, after);
    let phrase = reader.phrase().filter(|phrase| !phrase.is_empty())?;
    let (part, left) = after.split_at(reader.at);
    match left {
        [preposition, it, ..] if matches!(it.as_str(), "it" | "there") && phrase.unknown.is_empty() => {
            Some(joined(&[&["put"], &texts(part), &[preposition.as_str()], &texts(thing)]))
        }
        [word, more @ ..] if matches!(word.as_str(), "inside" | "in") && more.is_empty() => {
            Some(joined(&[&["put"], &texts(part), &["in"], &texts(thing)]))
        }
        // `the mug needs a wash`, `the bowl needs water`
        _ => None,
    }
}

/// `sink on`, `the blue computer off please`: no more than the thing, and what it is to be.
fn stated(lexicon: &Lexicon, words: &[String]) -> Option<Vec<String>> {
    let (thing, after) = thing(lexicon, words)?;
    let names = |word: &String| lexicon.generic.exact(std::slice::from_ref(word)).is_none();
    let (verb, left) = state(lexicon, after).filter(|_| thing.iter().all(names))?;
    // Who says no more than that something is broken reports it.
    if verb[0] == "break" { None } else { finish(lexicon, verb, thing, left) }
}

/// What is to be done for `thing` to become what `after` says.
fn become_so(lexicon: &Lexicon, thing: &[String], after: &[String]) -> Option<Vec<String>> {
    let skipped = after.iter().take_while(|word| lexicon.wishes.between.contains(*word)).count();
    let rest = &after[skipped..];
    if let Some((request, left)) = state(lexicon, rest).or_else(|| participle(lexicon, rest)) {
        return finish(lexicon, request, thing, left);
    }
    if let Some((_, color)) = lexicon.colors.longest(rest).filter(|(length, _)| is_end(lexicon, &rest[*length..])) {
        return Some(joined(&[&["paint"], &texts(thing), &[color]]));
    }
    let mut reader = Reader::new(lexicon, rest);
    match reader.place()? {
        (Preposition::In | Preposition::On | Preposition::At | Preposition::Near | Preposition::To, _) => {
            let is_fluid = lexicon.fluids.longest(inner(lexicon, thing)).is_some();
            let verb = if is_fluid { "pour" } else { "put" };
            Some(joined(&[&[verb], &texts(thing), &texts(rest)]))
        }
        _ => None,
    }
}

/// The verb that brings a state about: its words, and what follows.
fn state<'a>(lexicon: &Lexicon, words: &'a [String]) -> Option<(Vec<String>, &'a [String])> {
    let (length, verb) = lexicon.brings_about.longest(words)?;
    let left = &words[length..];
    let is_end = is_end(lexicon, left) || lexicon.prepositions.longest(left).is_some();
    is_end.then(|| (verb.clone(), left))
}

/// `cleaned`, `picked up`, `filled` as the verb they come from.
fn participle<'a>(lexicon: &Lexicon, words: &'a [String]) -> Option<(Vec<String>, &'a [String])> {
    let (first, rest) = words.split_first()?;
    let verb = stem(lexicon, first).or_else(|| (inflect::is_verb(lexicon, first)).then(|| first.clone()))?;
    if let Some(particle) = rest.first() {
        let whole = [verb.clone(), particle.clone()];
        if lexicon.verbs.exact(&whole).is_some() && !matches!(particle.as_str(), "to" | "in" | "into") {
            return Some((whole.to_vec(), &rest[1..]));
        }
    }
    Some((vec![verb], rest))
}

/// The verb, the thing, and what follows it.
fn finish(lexicon: &Lexicon, verb: Vec<String>, thing: &[String], left: &[String]) -> Option<Vec<String>> {
    let left = if is_after(lexicon, left) { &[][..] } else { left };
    // `have the plate cleaned and returned to the table`
    if let Some((next, rest)) =
        left.split_first().filter(|(and, _)| *and == "and").and_then(|(_, left)| participle(lexicon, left))
    {
        return Some(joined(&[&texts(&verb), &texts(thing), &["and"], &texts(&next), &["it"], &texts(rest)]));
    }
    Some(joined(&[&texts(&verb), &texts(thing), &texts(left)]))
}

/// Whether all that follows says no more than for whom and when.
fn is_after(lexicon: &Lexicon, words: &[String]) -> bool {
    words.iter().all(|word| lexicon.wishes.after.contains(word))
}

/// Whether what follows is no noun: talk, a comparison, or nothing.
fn is_end(lexicon: &Lexicon, words: &[String]) -> bool {
    is_after(lexicon, words) || words.first().is_some_and(|word| matches!(word.as_str(), "like" | "as" | "please"))
}

/// The noun phrase at the start, with what describes it by `that is`, and what follows.
fn thing<'a>(lexicon: &Lexicon, words: &'a [String]) -> Option<(&'a [String], &'a [String])> {
    let mut reader = Reader::new(lexicon, words);
    let phrase = reader.phrase().filter(|phrase| !phrase.is_empty() && phrase.unknown.is_empty())?;
    // `the mug red`: what it is to be.
    let is_last = is_end(lexicon, reader.rest());
    if phrase.pronoun.is_none() && is_last && color::ends_in_color(lexicon, &phrase.text) && reader.at > 1 {
        reader.at -= 1;
        return Some(words.split_at(reader.at));
    }
    // `the cup that is on the desk`
    while reader.is_linked() && reader.place().is_some() {}
    Some(words.split_at(reader.at))
}

fn inner<'a>(lexicon: &Lexicon, words: &'a [String]) -> &'a [String] {
    let skipped = words.iter().take_while(|word| lexicon.articles.exact(std::slice::from_ref(*word)).is_some()).count();
    &words[skipped..]
}

fn texts(words: &[String]) -> Vec<&str> {
    words.iter().map(String::as_str).collect()
}

fn joined(parts: &[&[&str]]) -> Vec<String> {
    parts.iter().flat_map(|part| part.iter().map(|word| (*word).to_owned())).collect()
}
