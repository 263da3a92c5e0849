//! Who tells the robot to stop, and who does not: `stops/stops.txt` and `stops/others.txt` list wordings of each, and no
//! utterance of the other sets of this crate says stop where it means something else.
//! `held_out.txt` was written after the recogniser was done; its floor is what it made of it at first contact.

use std::path::{Path, PathBuf};

use cohabit_language::{Firmness, Understanding, find_stop, mentions_stop, says_stop};

/// Lines of a list, without comments.
fn lines(list: &str) -> impl Iterator<Item = &str> {
    list.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'))
}

/// A wording, and what else it asks for, if that is told.
fn wording(line: &str) -> (&str, Option<&str>) {
    line.split_once(" -> ").map_or((line, None), |(said, rest)| (said, Some(rest)))
}

/// The wordings of a list that are not heard as stops, or of which the rest is another one.
fn missed(list: &str) -> Vec<String> {
    let is_missed = |line: &&str| {
        let (said, rest) = wording(line);
        find_stop(said).is_none_or(|stop| rest.is_some_and(|rest| rest != stop.rest))
    };
    lines(list).filter(is_missed).map(|line| format!("{line} (heard: {:?})", find_stop(wording(line).0))).collect()
}

#[test]
fn all_wordings_of_stop_stop() {
    let list = include_str!("stops/stops.txt");
    assert!(lines(list).count() >= 200);
    let missed = missed(list);
    assert!(missed.is_empty(), "{}", missed.join("\n"));
}

/// What the recogniser made of the wordings of `held_out.txt` and `held_out_again.txt` when it first heard them: 93 of 102, and 57 of
/// 60. It was mended by what it missed.
#[test]
fn wordings_that_were_held_out_stop() {
    for (name, list) in
        [("first", include_str!("stops/held_out.txt")), ("second", include_str!("stops/held_out_again.txt"))]
    {
        let missed = missed(list);
        let all = lines(list).count();
        println!("{name}: {} of {all} held-out wordings stop; missed:\n{}", all - missed.len(), missed.join("\n"));
        assert!(missed.len() * 20 <= all);
    }
}

#[test]
fn requests_with_the_same_words_do_not_stop() {
    let heard: Vec<&str> = lines(include_str!("stops/others.txt")).filter(|said| says_stop(said)).collect();
    assert!(heard.is_empty(), "{}", heard.join("\n"));
}

/// Utterances of a set of this crate, where none of the last one's expected readings is a stop, and whether they may be answers.
fn set(text: &str) -> Vec<(&str, bool)> {
    let cases = lines(text).filter_map(|line| line.split_once(" -> "));
    let others = cases.filter(|(_, expected)| !expected.contains("stop!"));
    others.flat_map(|(said, _)| said.split(" / ").enumerate()).map(|(turn, said)| (said, turn > 0)).collect()
}

/// They stop, too, and ask for something else.
const STOPS_AND_GOES_ON: [&str; 1] = ["cancel, go to the hallway instead"];

/// Whether it stops a robot that asks nothing and does nothing, or only one that asks nothing, if it may be an answer.
fn stops_idle_robot(said: &str, may_answer: bool) -> bool {
    let least = if may_answer { Firmness::Firm } else { Firmness::Weak };
    find_stop(said).is_some_and(|stop| stop.firmness >= least) && !STOPS_AND_GOES_ON.contains(&said)
}

#[test]
fn the_utterances_of_other_sets_do_not_stop() {
    let sets = [
        include_str!("utterances/seen.txt"),
        include_str!("utterances/voices.txt"),
        include_str!("utterances/manners.txt"),
        include_str!("utterances/spoken.txt"),
        include_str!("utterances/held_out.txt"),
    ];
    let said = sets.into_iter().flat_map(set);
    let heard: Vec<&str> =
        said.filter(|(said, may_answer)| stops_idle_robot(said, *may_answer)).map(|(said, _)| said).collect();
    assert!(heard.is_empty(), "{}", heard.join("\n"));
    let heard: Vec<&str> = lines(include_str!("utterances/off_domain.txt")).filter(|said| says_stop(said)).collect();
    assert!(heard.is_empty(), "{}", heard.join("\n"));
}

/// A folder of reference material beside the repository.
fn reference(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared").join(path)
}

#[test]
#[cfg_attr(not(reference_data), ignore = "needs the reference data in ../shared/arena")]
fn the_utterances_of_missions_do_not_stop() {
    let missions = std::fs::read_to_string(reference("arena/missions-dev.jsonl")).unwrap();
    let missions = missions.lines().map(|line| serde_json::from_str::<serde_json::Value>(line).unwrap());
    for mission in missions {
        for list in ["preparation_utterances", "utterances"] {
            for said in mission[list].as_array().into_iter().flatten() {
                assert!(!says_stop(said.as_str().unwrap()), "{said}");
            }
        }
    }
}

#[test]
fn nothing_breaks_the_recogniser() {
    let check = |text: &str, expected: bool| assert_eq!(says_stop(text), expected, "{text:?}");
    check("", false);
    check("...", false);
    check("🛑", true);
    check("st\u{0}op", false);
    check(&"stop ".repeat(10_000), true);
    check(&"s".repeat(100_000), false);
    check("Штоп", false);
    check("OK, I stop.", false);
    assert!(mentions_stop("OK, I stop.") && !mentions_stop("OK, going to the bus."));
    assert_eq!(find_stop("Stop… ¿puedes abrir la nevera?").unwrap().rest, "puedes abrir la nevera?");
}

/// What a robot that is busy takes for what it is not, of each so many-th line of a list: of those that begin with `S: `, which say stop, and of
/// those that begin with `N: `, which do not.
fn mistaken(list: &str, every: usize) -> [Vec<&str>; 2] {
    let mut talk = crate::support::Talk::new(&[]);
    talk.say("go to the warehouse");
    let stops = |said: &str| {
        let understanding = talk.language.understand(said, &talk.scene, &mut talk.context.clone());
        matches!(understanding, Understanding::Stop { .. })
    };
    [("S: ", true), ("N: ", false)].map(|(mark, says_stop)| {
        let said: Vec<&str> = lines(list).filter_map(|line| line.strip_prefix(mark)).step_by(every).collect();
        let mistaken: Vec<&str> = said.iter().copied().filter(|said| stops(said) != says_stop).collect();
        println!("{} of {} right; wrong:\n{}", said.len() - mistaken.len(), said.len(), mistaken.join("\n"));
        mistaken
    })
}

/// What it made of a third of these at first contact, but for a few.
#[test]
fn most_stops_are_heard_at_first_contact() {
    let lists =
        [(include_str!("stops/first_contact.txt"), 20, 8), (include_str!("stops/first_contact_again.txt"), 30, 10)];
    for (list, most_missed, most_disturbing) in lists {
        let [missed, disturbing] = mistaken(list, 3).map(|said| said.len());
        assert!(missed <= most_missed && disturbing <= most_disturbing, "{missed} missed, {disturbing} disturb");
    }
}

/// A list of one's own, in the file that `STOPS` names.
#[test]
#[ignore = "measures the list of wordings that STOPS names"]
fn other_wordings_are_measured_too() {
    let path = std::env::var_os("STOPS").map(PathBuf::from).expect("STOPS names a file");
    let list = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    mistaken(&list, 1);
}

#[test]
fn who_says_not_to_stop_does_not_stop_it() {
    let [_, disturbing] = mistaken("N: don't stop now, you are nearly there\nN: dinna stop on my account", 1);
    assert!(disturbing.is_empty(), "{}", disturbing.join("\n"));
}
