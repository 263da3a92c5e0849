//! A study is read, or all that is wrong in it is said with its place.

use cohabit_dialog::OnTimeout;

use super::*;
use crate::{
    design::{Block, FactorKind, Limits},
    pair::{Pairing, PartnerAbsent, SkippedBy},
    schema,
    scratch::Scratch,
    settings::is_on,
};

/// A program that knows some flags and two missions.
struct Stub;

impl Program for Stub {
    fn check_arguments(&self, arguments: &[String]) -> Result<(), String> {
        let known = [
            "--ask=never",
            "--ask=always",
            "--paused",
            "--record-audio",
            "--wizard=yes",
            "--wizard=no",
            "--response-delay-ms=2000",
            "--body=person",
            "--drive=all",
            "--agent=scripted@0=walk.txt",
            "--agent=scripted@0=run.txt",
            "--agent=helper@1",
            "--questionnaire=after.toml",
            "--questionnaire=tlx",
        ];
        let is_known = |one: &&String| known.contains(&one.as_str());
        let is_alone = |one: &&String| !one.starts_with("--wizard=");
        match arguments.iter().find(|one| !is_known(one)) {
            Some(other) => Err(format!("unexpected argument `{other}`")),
            None if arguments.iter().filter(is_alone).count() > 1 => Err("one at a time".to_owned()),
            None => Ok(()),
        }
    }

    fn check_mission(&self, name: &str, world: Option<&WorldData>) -> Result<(), String> {
        if world.is_some_and(|world| world.missions().any(|(file, _)| file.strip_suffix(".json") == Some(name))) {
            return Ok(());
        }
        if name.ends_with("soda") || name.ends_with("cereal") {
            Ok(())
        } else {
            Err(format!("there is no mission {name}"))
        }
    }

    fn check_session(
        &self,
        arguments: &[String],
        mission: &str,
        _: &Path,
        _: Option<&WorldData>,
    ) -> Result<(), String> {
        let is_of_second = arguments.iter().any(|one| one == "--agent=helper@1");
        if is_of_second && mission == "cereal" { Err("there is no body 1".to_owned()) } else { Ok(()) }
    }

    fn pack_files(&self, folder: &Path) -> Result<Vec<PackFile>, String> {
        if !folder.ends_with("my-lab") {
            return Err(format!("{}: there is no such folder", folder.display()));
        }
        let files = cohabit_cdf::world_pack::template("my-lab").into_iter();
        Ok(files.map(|(path, text)| PackFile { path: path.to_owned(), bytes: text.into_bytes() }).collect())
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

/// The same with a practice, boxes that need not be ticked, and what pages show.
fn larger() -> String {
    let boxes = "required = [\"I agree.\"]\noptional = [\"Tell me.\", { text = \"Hear me.\", audio = true }]";
    let practice =
        "[[block]]\nkind = \"practice\"\nmission = \"soda\"\nsettings = { record-audio = true, score = true }\n\n";
    let text =
        STUDY.replacen("required = [\"I agree.\"]", boxes, 1).replacen("[[block]]", &format!("{practice}[[block]]"), 1);
    text.replacen("minutes = 0.5", "minutes = 0.5\nsettings = { clock = true }", 1)
}

/// The same with a wizard at one level, who takes part so.
fn with_wizard(seat: &str) -> String {
    let level = STUDY.replacen("settings = { ask = \"always\" }", "settings = { wizard = \"yes\" }", 1);
    format!("{level}\n[wizard]\n{seat}\n")
}

const SEAT: &str = r#"
timeout_s = 8
on_timeout = "say"
moment = "Hm."

[[wizard.phrase]]
key = "h"
text = "Hello!"

[[wizard.phrase]]
key = "1"
text = "One moment."
waits = true

[[wizard.error]]
name = "wrong object"
do = "pick up the apple"
step = 1
"#;

fn check(name: &str, text: &str) -> Result<Study, String> {
    let scratch = Scratch::new(&format!("check-{name}"));
    let _ = scratch.write("sheet.md", "# Robots\n");
    let _ = scratch.write("empty.md", " ");
    let _ = scratch.write("after.toml", "title = 'After'\n[[item]]\nask = 'Why?'\nwords = true");
    let _ = scratch.write("walk.txt", "loop");
    let path = scratch.write("study.toml", text);
    StudyFile::read(&path).unwrap().check(&Stub).map_err(|error| error.to_string())
}

#[test]
fn a_study_keeps_its_world_packs_and_plays_their_missions() {
    let text = STUDY.replacen("[\"soda\", \"cereal\"]", "[\"soda\", \"clean_wrench\"]", 1);
    let with = |world: &str| text.replacen("seed = 1", &format!("seed = 1\nworld = {world}"), 1);
    let study = check("world", &with("[\"packs/my-lab/\"]")).unwrap();
    let [world] = study.worlds.as_slice() else { panic!("{:?}", study.worlds) };
    assert_eq!((world.folder.as_str(), world.id.name.as_str()), ("packs/my-lab", "my-lab"));
    assert_eq!(world.arguments(), ["--world=packs/my-lab".to_owned(), format!("--world-hash={}", world.id.digest)]);
    assert!(study.files.contains_key("packs/my-lab/layouts/Workshop.toml"), "{:?}", study.files.keys());
    assert_eq!(crate::assign(&study, 1).world, study.world_ids());
    let at_home = STUDY.replacen("[\"soda\", \"cereal\"]", "[\"soda\", \"make_tea\"]", 1);
    let study = check("world", &at_home.replacen("seed = 1", "seed = 1\nworld = [\"homes\"]", 1)).unwrap();
    assert!(study.files.contains_key("homes/world.toml"), "{:?}", study.files.keys());
    for (text, part) in [
        (text.clone(), "there is no mission clean_wrench"),
        (with("[\"../my-lab\"]"), "it lies outside the folder of the study"),
        (with("[\"your-lab\"]"), "there is no such folder"),
        (with("[\"my-lab\", \"other/my-lab\"]"), "`my-lab`"),
    ] {
        let said = check("no-world", &text).unwrap_err();
        assert!(said.contains(part), "`{part}` is not in {said}");
    }
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
fn files_that_settings_name_are_kept_with_the_study() {
    let with = |setting: &str| {
        let level = format!("settings = {{ {setting} }}");
        let study = check("files", &STUDY.replacen("settings = { ask = \"never\" }", &level, 1))?;
        Ok::<_, String>(study.files.into_keys().collect::<Vec<_>>())
    };
    assert_eq!(with("agent = \"scripted@0=walk.txt\"").unwrap(), ["after.toml", "sheet.md", "walk.txt"]);
    for questionnaire in ["after.toml", "tlx"] {
        assert_eq!(with(&format!("questionnaire = \"{questionnaire}\"")).unwrap(), ["after.toml", "sheet.md"]);
    }
    let said = with("agent = \"scripted@0=run.txt\"").unwrap_err();
    assert!(
        said.contains("/factor/0/level/0/settings/agent: `run.txt`") && said.contains("name a file that"),
        "{said}"
    );
}

#[test]
fn the_day_until_which_data_are_kept_is_read() {
    let study = check("keep", &STUDY.replacen("contact", "keep_until = \"2031-12-31\"\ncontact", 1)).unwrap();
    assert_eq!(study.keep_until.as_deref(), Some("2031-12-31"));
    assert_eq!(check("keep", STUDY).unwrap().keep_until, None);
}

#[test]
fn boxes_practice_and_what_pages_show_are_read() {
    let study = check("larger", &larger()).unwrap();
    let boxes: Vec<_> = study.consents.iter().map(|one| (one.text.as_str(), one.is_required, one.audio)).collect();
    assert_eq!(boxes, [("I agree.", true, false), ("Tell me.", false, false), ("Hear me.", false, true)]);
    let Block::Mission { is_practice: true, settings, .. } = &study.blocks[0] else { panic!("a practice") };
    assert!(is_on(settings, "score") && is_on(settings, "record-audio"));
    assert!(is_on(&study.missions_block().unwrap().settings, "clock"));
}

#[test]
fn a_tutorial_has_its_own_exercises_or_the_usual_ones() {
    let with = |keys: &str| {
        let block = format!("[[block]]\nkind = \"tutorial\"\nmission = \"soda\"\n{keys}\n[[block]]");
        check("tutorial", &STUDY.replacen("[[block]]", &block, 1))
    };
    let exercises = |keys: &str| {
        let study = with(keys).unwrap();
        let Block::Mission { is_practice: true, exercises, .. } = &study.blocks[0] else { panic!("a tutorial") };
        exercises.iter().map(|one| one.what.name()).collect::<Vec<_>>()
    };
    assert_eq!(exercises(""), ["say", "point", "stop", "goal"]);
    let own = "[[block.exercise]]\nwhat = \"stop\"\ntext = \"Stop it.\"\n";
    assert_eq!(exercises(own), ["stop"]);
    for (keys, part) in [
        ("exercise = []".to_owned(), "`exercise` cannot be this empty list; write tables"),
        (own.replace("\"stop\"", "\"jump\""), "write one of \"say\", \"point\", \"answer\""),
        (own.replace("text = \"Stop it.\"\n", ""), "`text` is missing"),
        (format!("{own}{own}"), "`stop` is there twice"),
        (own.replace("\"stop\"", "\"move\""), "`move` is to be tried, and participants have no body; add `body"),
        (
            format!("settings = {{ ask = \"never\" }}\n{}", own.replace("\"stop\"", "\"answer\"")),
            "`answer` is to be tried, and the robot asks nothing",
        ),
    ] {
        let said = with(&keys).unwrap_err();
        assert!(said.contains(part), "no `{part}` in {said}");
    }
    let in_a_break = "kind = \"break\"\nexercise = [{ what = \"say\", text = \"Say.\" }]";
    let elsewhere = check("exercise", &STUDY.replacen("kind = \"break\"", in_a_break, 1));
    assert!(elsewhere.unwrap_err().contains("a block of kind \"break\" has no `exercise`"));
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
        (
            "settings = { ask = \"never\" }",
            "settings = { page-language = \"de\" }",
            "`page-language` is not a study's to set; it follows from `language`, a key above all tables",
        ),
        ("settings = { ask = \"never\" }", "settings = { ask = 1979-05-27 }", "this is no value of a flag"),
        ("name = \"always\"", "name = \"never\"", "`never` is there twice"),
        ("name = \"ask\"", "name = \"ask policy\"", "cannot be the name of a column; write letters"),
        ("skip_after_minutes = 0.25", "skip_after_minutes = 0.5", "it is never reached; make it less than `minutes`"),
        ("minutes = 1\n", "minutes = 0\n", "write a number of minutes above 0"),
        ("kind = \"break\"", "kind = \"pause\"", "write one of \"questionnaire\", \"practice\""),
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
        (
            "contact",
            "keep_until = \"31.12.2031\"\ncontact",
            "/keep_until: `31.12.2031` is no day; write year, month and day",
        ),
        ("contact", "keep_until = \"2031-13-01\"\ncontact", "/keep_until: `2031-13-01` is no day"),
        ("contact", "return_url = \"x\"\ncontact", "`x` is no address of a page"),
        (
            "contact",
            "return_url = \"https://{at}.org\"\ncontact",
            "/return_url: parameters can stand behind a ? alone; such as",
        ),
        ("contact", "completion_code = \"x\"\nreturn_url = \"http://x\"\ncontact", "keep one of them"),
        ("contact", "language = \"tlh\"\ncontact", "/language: there is no page in the language `tlh`; choose en, de"),
        ("contact", "page_texts = \"none.toml\"\ncontact", "/page_texts: `none.toml`: No such"),
        ("contact", "page_texts = \"sheet.md\"\ncontact", "/page_texts: sheet.md:"),
        ("contact", "language = \"de\"\npage_texts = \"sheet.md\"\ncontact", "/page_texts: participants' pages are in"),
        ("contact", "block_size = 0\ncontact", "a block of 0 for 1 between-participants conditions"),
        ("contact", "settings = { paused = true }\ncontact", "the settings of ask = never do not go together"),
        (
            "settings = { ask = \"never\" }",
            "settings = { agent = \"helper@1\" }",
            "the settings of ask = never do not fit the mission cereal: there is no body 1; change one of them",
        ),
        ("contact", "contact = \"x\"\ncontact", "duplicate key"),
        (
            "[[factor]]",
            "[[probe]]\nquestionnaire = \"sus\"\nat = \"goal_met\"\n\n[[factor]]",
            "/probe/0/questionnaire: `sus` has 10 questions; name a questionnaire of one item",
        ),
        (
            "[[factor]]",
            "[[probe]]\nquestionnaire = \"after.toml\"\nat = \"minutes\"\n\n[[factor]]",
            "/probe/0/at: after how many minutes?; add `minutes`",
        ),
        (
            "[[factor]]",
            "[[probe]]\nquestionnaire = \"after.toml\"\nat = \"goal_met\"\nminutes = 2\n\n[[factor]]",
            "leave it out, or write at = \"minutes\"",
        ),
        (
            "[[factor]]",
            "[minimisation]\ncertainty = 0.2\n[[minimisation.covariate]]\nname = \"a\"\nparameter = \"a\"\n\n[[factor]]",
            "/minimisation/certainty: with a certainty of 0.2 conditions would not be balanced; write a number from 0.5",
        ),
        (
            "[[factor]]",
            "[minimisation]\n[[minimisation.covariate]]\nname = \"a\"\nparameter = \"a\"\n\n[[factor]]",
            "/minimisation: there are no between-participants conditions to assign; give a factor the kind",
        ),
        (
            "[[factor]]",
            "[minimisation]\n[[minimisation.covariate]]\nname = \"a\"\n\n[[factor]]",
            "a covariate is known from a link or from an answer; write `parameter`",
        ),
        (
            "[[factor]]",
            "[minimisation]\n[[minimisation.covariate]]\nname = \"a\"\nquestionnaire = \"sus\"\nitem = 1\n\n[[factor]]",
            "`sus` is not asked before the first mission",
        ),
        ("contact", "settings = { score = \"yes\" }\ncontact", "/settings/score: `score` is shown to participants, or"),
        ("contact", "settings = { hide = \"score\" }\ncontact", "`hide` is not a study's to set"),
        (
            "contact",
            "settings = { record-audio = true }\ncontact",
            "no box of the consent form asks for that; add { text",
        ),
        ("[\"I agree.\"]", "[{ audio = true }]", "/consent/required/0: `text` is missing; add a text"),
        (
            "[\"I agree.\"]",
            "[{ text = \"I agree.\", audio = 1 }]",
            "`audio` cannot be this integer; write true or false",
        ),
        ("[\"I agree.\"]", "[1]", "write a list of sentences, or of tables such as { text"),
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

/// The study in pairs, with more at its beginning.
fn in_pairs(more: &str) -> String {
    STUDY.replacen("participants = 4\n", &format!("participants = 4\nparticipants_per_session = 2\n{more}\n"), 1)
}

/// A factor between participants with these keys, one level of which sets the first, the other one the second.
fn between(keys: &str, levels: [&str; 2]) -> String {
    let [first, second] = levels;
    format!(
        "[[factor]]\nname = \"own\"\nkind = \"between\"\n{keys}\nlevel = [{{ name = \"a\", settings = {{ {first} }} }}, \
         {{ name = \"b\", settings = {{ {second} }} }}]\n\n[[factor]]"
    )
}

#[test]
fn pairs_are_read_and_a_factor_of_the_pages_can_be_each_participants() {
    let pairing = |more: &str| check("pairs", &in_pairs(more)).unwrap().pairing;
    let usual = Pairing { wait_s: 300.0, partner_absent: PartnerAbsent::Wait, skip: SkippedBy::Both };
    assert_eq!((check("no-pairs", STUDY).unwrap().pairing, pairing("")), (None, Some(usual)));
    let more = "pair = { partner_absent = \"alone\", partner_minutes = 0.5, skip = \"either\" }";
    let other = Pairing { wait_s: 30.0, partner_absent: PartnerAbsent::Alone, skip: SkippedBy::Either };
    assert_eq!(pairing(more), Some(other));
    for (unit, kind) in [("participant", FactorKind::Own), ("pair", FactorKind::Between)] {
        let clock = between(&format!("unit = \"{unit}\""), ["clock = true", "clock = false"]);
        let study = check("unit", &in_pairs("").replacen("[[factor]]", &clock, 1)).unwrap();
        assert_eq!((study.factors[0].kind, study.conditions(kind).len()), (kind, 2));
    }
}

#[test]
fn what_is_ambiguous_about_pairs_is_refused() {
    let clock = ["clock = true", "clock = false"];
    let asks = ["ask = \"never\"", "ask = \"always\""];
    let factor = |keys: &str, levels| in_pairs("").replacen("[[factor]]", &between(keys, levels), 1);
    let alone = |keys: &str, levels| STUDY.replacen("[[factor]]", &between(keys, levels), 1);
    let minimisation = "[minimisation]\n[[minimisation.covariate]]\nname = \"a\"\nparameter = \"a\"\n\n[[factor]]";
    let within = in_pairs("").replacen("kind = \"within\"", "kind = \"within\"\nunit = \"pair\"", 1);
    let sessions = |settings: &str| {
        let block = format!("settings = {{ {settings} }}\nminutes = 0.5");
        in_pairs("").replacen("minutes = 0.5", &block, 1)
    };
    for (index, (text, part)) in [
        (
            STUDY.replacen("participants = 4", "participants = 4\nparticipants_per_session = 0", 1),
            "nobody plays a session",
        ),
        (
            STUDY.replacen("participants = 4", "participants = 4\nparticipants_per_session = 3", 1),
            "a whole number from 0 to 2",
        ),
        (
            STUDY.replacen("participants = 4", "participants = 4\npair = {}", 1),
            "not of a pair; write participants_per_session",
        ),
        (in_pairs("pair = { partner_absent = \"leave\" }"), "write one of \"wait\", \"alone\", \"end\""),
        (in_pairs("pair = { skip = \"none\" }"), "write one of \"both\", \"either\""),
        (
            in_pairs("").replacen("participants = 4", "participants = 5", 1),
            "5 participants are no whole pairs; plan an even",
        ),
        (in_pairs("").replacen("[[factor]]", minimisation, 1), "a condition is the pair's; leave it out"),
        (factor("", clock), "write unit = \"pair\" or unit = \"participant\""),
        (
            factor("unit = \"participant\"", asks),
            "`ask` is of the session, which both of a pair play; leave `unit` out",
        ),
        (alone("unit = \"pair\"", asks), "there are no pairs; leave it out, or write participants_per_session"),
        (within, "both of a pair meet all levels of a factor within participants"),
        (sessions("body = \"person\""), "there is one avatar for two participants; write body"),
        (sessions("drive = \"all\""), "each drives their own avatar, and nobody the robot; leave `drive` out"),
        (sessions("seats = 2"), "`seats` is not a study's to set"),
    ]
    .into_iter()
    .enumerate()
    {
        let said = check(&format!("pairs-{index}"), &text).expect_err(part);
        assert!(said.contains(part), "no `{part}` in {said}");
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
fn one_look_finds_what_is_wrong_with_the_file_its_keys_its_settings_and_its_missions() {
    let wrong = larger()
        .replacen("contact = \"lab@example.org\"", "contact = \"lab@example.org\" x", 1)
        .replacen("title = \"A study\"", "title = 3", 1)
        .replacen("seed = 1", "sed = 1", 1)
        .replacen("\"cereal\"]", "\"tea\"]", 1)
        .replacen("audio = true }]", "audio = 1 }]", 1)
        .replacen("ask = \"always\"", "ask = \"often\", paused = true", 1)
        .replacen("minutes = 0.5", "minutes = \"x\"", 1)
        .replacen("clock = true", "clock = 5", 1)
        .replacen("[\"sus\"]", "[\"nos\"]", 1);
    let said = check("once", &wrong).unwrap_err();
    let parts = [
        "study.toml:3:",
        "/title: `title` cannot be this integer",
        "`seed` is missing; add",
        "there is no key `sed`",
        "there is no mission tea",
        "`audio` cannot be this integer",
        "/factor/0/level/1/settings/ask: unexpected",
        "`minutes` cannot be this string",
        "`clock` is shown to participants",
        "nos",
    ];
    for part in parts {
        assert!(said.contains(part), "no `{part}` in {said}");
    }
    assert_eq!(said.lines().count(), parts.len(), "nothing is said that only follows from something else: {said}");
}

#[test]
fn what_follows_from_something_that_is_wrong_is_not_said() {
    for (right, instead) in [
        ("[\"soda\", \"cereal\"]", "3"),
        ("kind = \"within\"", "kind = \"inside\""),
        ("kind = \"missions\"", "kind = \"many\""),
        ("kind = \"break\"", "kind = 7"),
        ("questionnaires = [\"sus\"]", "questionnaires = 4"),
    ] {
        let said = check("follows", &STUDY.replacen(right, instead, 1)).unwrap_err();
        assert_eq!(said.lines().count(), 1, "{instead}: {said}");
    }
}

#[test]
fn the_schema_says_the_same() {
    let schema = schema();
    let valid = |text: &str| {
        let value: serde_json::Value = toml::from_str(text).unwrap();
        jsonschema::is_valid(&schema, &value)
    };
    assert!(valid(STUDY) && valid(&larger()) && valid(&with_wizard(SEAT)));
    for (right, instead) in
        [("seed = 1", ""), ("seed = 1", "seed = -1"), ("seed = 1", "seed = 1\nsed = 2"), ("\"within\"", "\"in\"")]
    {
        assert!(!valid(&STUDY.replacen(right, instead, 1)), "{instead}");
    }
}

#[test]
fn covariates_are_items_that_are_answered_before_any_mission() {
    let with = |keys: &str| {
        let minimisation = format!(
            "[minimisation]\n[[minimisation.covariate]]\nname = \"load\"\n{keys}\n\n[[factor]]\nname = \"group\"\nkind = \"between\"\n\
             level = [{{ name = \"a\", settings = {{ ask = \"never\" }} }}, {{ name = \"b\", settings = {{ ask = \"always\" }} }}]\n\n[[block]]\nkind = \"questionnaire\"\nquestionnaires = [\"tlx\"]\n"
        );
        let (head, rest) = STUDY.split_once("[[factor]]").unwrap();
        let (_, blocks) = rest.split_once("[[block]]").unwrap();
        check(
            "covariates",
            &format!(
                "{}\n{minimisation}\n[[block]]{blocks}",
                head.replace("assignment = \"balanced_latin_square\"\n", "")
            ),
        )
    };
    let study = with("questionnaire = \"tlx\"\nitem = 1\ncuts = [30, 60]").unwrap();
    let minimisation = study.minimisation.unwrap();
    assert_eq!(minimisation.questionnaires().collect::<Vec<_>>(), ["tlx"]);
    for (keys, part) in [
        ("questionnaire = \"tlx\"\nitem = 7", "`tlx` has no item 7: it has 6, from 1"),
        ("questionnaire = \"tlx\"", "`tlx` has no item 0"),
        ("questionnaire = \"tlx\"\nitem = 1\ncuts = [60, 30]", "these are no cuts of a scale from 0 to 100"),
        ("questionnaire = \"tlx\"\nitem = 1\ncuts = [0]", "these are no cuts"),
        (
            "questionnaire = \"tlx\"\nitem = 1\ncuts = [1.5]",
            "`cuts` cannot be this array; write a list of whole numbers",
        ),
    ] {
        let said = with(keys).unwrap_err();
        assert!(said.contains(part), "no `{part}` in {said}");
    }
}

#[test]
fn keys_that_are_missing_are_said_beside_what_cannot_be_read() {
    let said =
        check("partial", &STUDY.replacen("seed = 1\n", "", 1).replacen("participants = 4", "participants = 4 4", 1));
    let said = said.unwrap_err();
    assert!(said.contains("`seed` is missing") && !said.contains("`participants` is missing"), "{said}");
}

#[test]
fn a_wizard_takes_part_as_the_file_says() {
    let study = check("wizard", &with_wizard(SEAT)).unwrap();
    assert!(study.has_wizard() && !check("alone", STUDY).unwrap().has_wizard());
    let wizard = &study.wizard;
    assert_eq!(
        (wizard.timeout_s, wizard.on_timeout, wizard.moment.as_deref()),
        (Some(8.0), OnTimeout::Say, Some("Hm."))
    );
    let phrases: Vec<String> = wizard.phrases.iter().map(ToString::to_string).collect();
    assert_eq!(phrases, ["h=Hello!", "1:wait=One moment."]);
    let errors: Vec<String> = wizard.errors.iter().map(ToString::to_string).collect();
    assert_eq!(errors, [r#"{"name":"wrong object","do":"pick up the apple","step":1}"#]);
    // Latencies are not to tell the conditions apart.
    let note = study.wizard_note().unwrap();
    assert!(note.contains("a wizard takes longer"), "{note}");
    let delayed = with_wizard(SEAT).replacen("wizard = \"yes\"", "wizard = \"yes\", response-delay-ms = 2000", 1);
    let note = check("delayed", &delayed).unwrap().wizard_note().unwrap();
    assert!(note.contains("2000 ms after the words with a wizard and 0 ms without"), "{note}");
    let alike = delayed.replacen("ask = \"never\"", "response-delay-ms = 2000", 1);
    assert_eq!(check("alike", &alike).unwrap().wizard_note(), None);
}

#[test]
fn codes_have_a_key_each() {
    let code = |key: &str, text: &str| format!("\n[[code]]\nkey = \"{key}\"\ntext = \"{text}\"\n");
    let study = check("codes", &format!("{STUDY}{}{}", code("t", "thinks aloud"), code("2", " repairs "))).unwrap();
    let codes: Vec<_> = study.codes.iter().map(|code| (code.key, code.text.as_str())).collect();
    assert_eq!(codes, [('t', "thinks aloud"), ('2', "repairs")]);
    for (codes, part) in [
        (code("ab", "x"), "/code/0/key: `ab` is no key for a code; write a small letter"),
        (code("/", "x"), "/code/0/key: `/` is no key for a code"),
        (code("t", "x").repeat(2), "/code/1/key: two codes have the key `t`; give one of them another key"),
        (code("t", " "), "`text` cannot be this string"),
    ] {
        let said = check("codes", &format!("{STUDY}{codes}")).unwrap_err();
        assert!(said.contains(part) && said.lines().count() == 1, "no `{part}` in {said}");
    }
}

#[test]
fn what_is_wrong_with_a_seat_is_said() {
    let phrase = |key: &str, text: &str| format!("[[wizard.phrase]]\nkey = \"{key}\"\ntext = \"{text}\"\n");
    let error = |keys: &str| format!("[[wizard.error]]\nname = \"a\"\n{keys}\n");
    let delayed = with_wizard("timeout_s = 1").replacen("\"yes\"", "\"yes\", response-delay-ms = 2000", 1);
    let debriefing = "[[block]]\nkind = \"debriefing\"\nfile = \"sheet.md\"\n";
    let inside = STUDY.replacen("ask = \"always\"", "wizard-timeout-s = 3", 1);
    for (text, part) in [
        (
            with_wizard("on_timeout = \"say\""),
            "/wizard/on_timeout: there is no time-out that this follows; add `timeout_s`",
        ),
        (
            with_wizard("timeout_s = 0"),
            "/wizard/timeout_s: `timeout_s` cannot be this integer; write a number of seconds",
        ),
        (with_wizard("timeout_s = 5\non_timeout = \"panic\""), "write one of \"act\", \"say\", \"wait\""),
        (with_wizard("timeout_s = 5\nmoment = \"Hm.\""), "/wizard/moment: the robot never says this; write on_timeout"),
        (with_wizard(&phrase("hi", "Hello!")), "/wizard/phrase/0/key: `hi` is no key for a phrase"),
        (
            with_wizard(&phrase("h", &"a".repeat(401))),
            "/wizard/phrase/0/text: the phrase of key `h` has to have 1 to 400",
        ),
        (with_wizard(&phrase("h", "One.").repeat(2)), "/wizard/phrase/1/key: two phrases have the key `h`"),
        (with_wizard(&error("")), "/wizard/error/0: the robot has to say or do something at the planned error `a`"),
        (with_wizard(&error("say = \"Oh.\"\nstep = 1")), "/wizard/error/0: the step of the planned error `a`"),
        (with_wizard(&error("say = \"Oh.\"").repeat(2)), "/wizard/error/1/name: two planned errors are called"),
        (format!("{STUDY}\n[wizard]\n{SEAT}"), "/wizard: no session has a wizard; write wizard = \"yes\""),
        (
            with_wizard(SEAT).replacen(debriefing, "", 1),
            "/block: a wizard takes part, and nobody is told so in the end",
        ),
        (delayed, "/wizard/timeout_s: a wizard has 1 s to decide, and nothing is answered before 2000 ms"),
        (inside, "`wizard-timeout-s` is the same in all sessions; write it into `[wizard]`"),
        (with_wizard(SEAT).replacen("\"yes\"", "\"perhaps\"", 1), "unexpected argument `--wizard=perhaps`"),
    ] {
        let said = check("seat", &text).expect_err(part);
        assert!(said.contains(part), "no `{part}` in {said}");
        assert_eq!(said.lines().count(), 1, "{said}");
    }
}
