//! A study is read, or all that is wrong in it is said with its place.

use super::*;
use crate::{
    design::{FactorKind, Limits},
    schema,
    scratch::Scratch,
};

/// A program that knows two flags and two missions.
struct Stub;

impl Program for Stub {
    fn check_arguments(&self, arguments: &[String]) -> Result<(), String> {
        let is_known = |one: &&String| ["--ask=never", "--ask=always", "--paused"].contains(&one.as_str());
        match arguments.iter().find(|one| !is_known(one)) {
            Some(other) => Err(format!("unexpected argument `{other}`")),
            None if arguments.len() > 1 => Err("one at a time".to_owned()),
            None => Ok(()),
        }
    }

    fn check_mission(&self, name: &str) -> Result<(), String> {
        if name.ends_with("soda") || name.ends_with("cereal") {
            Ok(())
        } else {
            Err(format!("there is no mission {name}"))
        }
    }
}

const STUDY: &str = r#"
title = "A study"
contact = "lab@example.org"
seed = 1
participants = 4
assignment = "balanced_latin_square"
missions = ["soda", "cereal"]

[information]
file = "sheet.md"
version = "1"

[consent]
file = "sheet.md"
version = "2"
required = ["I agree."]

[[factor]]
name = "ask"
kind = "within"
level = [
    { name = "never", settings = { ask = "never" } },
    { name = "always", settings = { ask = "always" } },
]

[[block]]
kind = "missions"
minutes = 0.5
skip_after_minutes = 0.25
after_mission = ["tlx"]
after_condition = ["after.toml"]

[[block]]
kind = "break"
minutes = 1

[[block]]
kind = "questionnaire"
questionnaires = ["sus"]

[[block]]
kind = "debriefing"
file = "sheet.md"
"#;

fn check(name: &str, text: &str) -> Result<Study, String> {
    let scratch = Scratch::new(&format!("check-{name}"));
    let _ = scratch.write("sheet.md", "# Robots\n");
    let _ = scratch.write("empty.md", " ");
    let _ = scratch.write("after.toml", "title = 'After'\n[[item]]\nask = 'Why?'\nwords = true");
    let path = scratch.write("study.toml", text);
    StudyFile::read(&path).unwrap().check(&Stub).map_err(|error| error.to_string())
}

#[test]
fn a_study_is_read() {
    let study = check("read", STUDY).unwrap();
    assert_eq!(study.conditions(FactorKind::Within).len(), 2);
    assert_eq!((study.block_size, study.blocks.len()), (1, 3));
    let missions = study.missions_block().unwrap();
    assert_eq!(missions.limits, Limits { limit_s: Some(30.0), skip_after_s: Some(15.0) });
    assert_eq!((&missions.after_mission[0], &missions.after_condition[0]), (&"tlx".to_owned(), &"after".to_owned()));
    let asked: Vec<_> = study.questionnaires.iter().map(|one| one.name.as_str()).collect();
    assert_eq!(asked, ["tlx", "after", "sus"]);
    assert_eq!(study.files.keys().collect::<Vec<_>>(), ["after.toml", "sheet.md"]);
}

#[test]
fn what_is_wrong_is_said_with_its_place_and_a_remedy() {
    let wrong = [
        ("title = \"A study\"", "title = 3", ":2:9: /title: `title` cannot be this integer; write a text"),
        ("seed = 1\n", "", "`seed` is missing; add a whole number"),
        ("seed = 1", "seed = -1", "cannot be this integer; write a whole number from 0"),
        ("seed = 1", "sed = 1", ":4:1: /sed: there is no key `sed` here; the keys are title"),
        ("participants = 4", "participants = 0", "nobody takes part"),
        ("\"balanced_latin_square\"", "\"latin\"", "write one of \"latin_square\", \"balanced_latin_square\""),
        ("[\"soda\", \"cereal\"]", "[\"soda\", \"tea\"]", ":7:21: /missions/1: there is no mission tea"),
        (
            "[\"soda\", \"cereal\"]",
            "[\"soda\"]",
            "1 missions for 2 within-participant conditions; name 2, or a multiple",
        ),
        ("required = [\"I agree.\"]", "required = [\"\"]", "`required` cannot be this string"),
        ("kind = \"within\"", "kind = \"between\"", ":6:14: /assignment: a Latin square orders within"),
        (
            "settings = { ask = \"never\" }",
            "settings = { ask = \"often\" }",
            "/factor/0/level/0/settings/ask: unexpected",
        ),
        ("settings = { ask = \"never\" }", "settings = { port = 80 }", "`port` is not a study's to set; leave it out"),
        ("settings = { ask = \"never\" }", "settings = { ask = 1979-05-27 }", "this is no value of a flag"),
        ("name = \"always\"", "name = \"never\"", "`never` is there twice"),
        ("name = \"ask\"", "name = \"ask policy\"", "cannot be the name of a column; write letters"),
        ("skip_after_minutes = 0.25", "skip_after_minutes = 0.5", "it is never reached; make it less than `minutes`"),
        ("minutes = 1\n", "minutes = 0\n", "write a number of minutes above 0"),
        ("kind = \"break\"", "kind = \"pause\"", "write one of \"questionnaire\", \"mission\""),
        (
            "kind = \"break\"",
            "kind = \"break\"\norder = \"random\"",
            "a block of kind \"break\" has no `order`; leave it out",
        ),
        ("kind = \"break\"\nminutes = 1", "kind = \"mission\"", "a block of kind \"mission\" lacks `mission`"),
        ("[\"sus\"]", "[\"none\"]", "name one that ships, or a file"),
        (
            "version = \"2\"",
            "version = \"2\"\nage = 18",
            "there is no key `age` here; the keys are file, version, required",
        ),
        (
            "file = \"sheet.md\"\nversion = \"2\"",
            "file = \"empty.md\"\nversion = \"2\"",
            "/consent/file: `empty.md` is empty",
        ),
        (
            "file = \"sheet.md\"\nversion = \"1\"",
            "file = \"none.md\"\nversion = \"1\"",
            ":10:8: /information/file: `none.md`: No such",
        ),
        ("contact", "return_url = \"x\"\ncontact", "`x` is no address of a page"),
        ("contact", "completion_code = \"x\"\nreturn_url = \"http://x\"\ncontact", "keep one of them"),
        ("contact", "block_size = 0\ncontact", "a block of 0 for 1 between-participants conditions"),
        ("contact", "settings = { paused = true }\ncontact", "the settings of ask = never do not go together"),
        ("contact", "contact = \"x\"\ncontact", "duplicate key"),
        (
            "kind = \"questionnaire\"\nquestionnaires = [\"sus\"]",
            "kind = \"debriefing\"\nfile = \"sheet.md\"",
            "move it to the end",
        ),
    ];
    for (index, (right, instead, part)) in wrong.into_iter().enumerate() {
        assert!(STUDY.contains(right), "{right}");
        let said = check(&format!("wrong-{index}"), &STUDY.replacen(right, instead, 1)).expect_err(instead);
        assert!(said.contains(part), "no `{part}` in {said}");
        assert!(said.lines().all(|line| line.contains("study.toml:")), "{said}");
    }
}

#[test]
fn all_problems_are_said_in_the_order_of_the_text() {
    let text = STUDY.replace("seed = 1", "sed = 1").replace("\"tlx\"", "\"txl\"").replace("never", "rarely");
    let said = check("all", &text).unwrap_err();
    let parts = ["`seed` is missing", "no key `sed`", "unexpected argument `--ask=rarely`", "txl"];
    let places: Vec<_> = parts.iter().map(|part| said.find(part)).collect();
    assert!(places.iter().all(Option::is_some) && places.is_sorted(), "{said}");
}

#[test]
fn the_schema_says_the_same() {
    let schema = schema();
    let valid = |text: &str| {
        let value: serde_json::Value = toml::from_str(text).unwrap();
        jsonschema::is_valid(&schema, &value)
    };
    assert!(valid(STUDY));
    for (right, instead) in
        [("seed = 1", ""), ("seed = 1", "seed = -1"), ("seed = 1", "seed = 1\nsed = 2"), ("\"within\"", "\"in\"")]
    {
        assert!(!valid(&STUDY.replacen(right, instead, 1)), "{instead}");
    }
}
