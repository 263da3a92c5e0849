//! The keys of `study.toml`, as a table: what it is checked by, and what its JSON Schema is made of.

use crate::{probe::Moment, tutorial::Activity};

/// A key of a table.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// Its name.
    pub name: &'static str,
    /// What it holds.
    pub kind: Kind,
    /// Whether it must be there.
    pub required: bool,
    /// What it means, for the schema and for remedies.
    pub meaning: &'static str,
}

/// What a key holds.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    /// Text that is not empty.
    Text,
    /// A list of such texts.
    Texts,
    /// A list of boxes of a consent form, each a text, or a table with these keys.
    Boxes(&'static [Key]),
    /// True or false.
    Switch,
    /// A whole number from 0 to so many.
    Whole(u64),
    /// A number of minutes above 0.
    Minutes,
    /// A number of seconds above 0, of ten minutes at most.
    Seconds,
    /// A number from 0 to 1.
    Share,
    /// A list of whole numbers.
    Numbers,
    /// One of these words.
    OneOf(&'static [&'static str]),
    /// Settings, most of them flags of `cohabit play`, each with a text, a number, true or false, or a list of these.
    Settings,
    /// A table with these keys.
    Table(&'static [Key]),
    /// A list of tables with these keys.
    Tables(&'static [Key]),
}

const fn required(name: &'static str, kind: Kind, meaning: &'static str) -> Key {
    Key { name, kind, required: true, meaning }
}

const fn optional(name: &'static str, kind: Kind, meaning: &'static str) -> Key {
    Key { name, kind, required: false, meaning }
}

/// The largest whole number that JSON holds exactly.
const LARGEST_SEED: u64 = (1 << 53) - 1;
/// More people than a study of a lab has.
const MOST_PARTICIPANTS: u64 = 10_000;
/// More questions than a questionnaire has.
const LARGEST_ITEM: u64 = 100;
/// More steps than a plan is told in.
const LARGEST_STEP: u64 = 100;
/// The longest that is counted in seconds.
pub const LONGEST_SECONDS: f64 = 600.0;
/// The most participants of one session.
const LARGEST_SESSION: u64 = 2;
/// The longest block of a random assignment.
const LARGEST_BLOCK: u64 = 1_000;

/// The whole file.
pub const STUDY: &[Key] = &[
    required("title", Kind::Text, "what participants read above each page"),
    required("contact", Kind::Text, "whom participants can ask, such as a name and an address"),
    optional(
        "language",
        Kind::Text,
        "the language of participants' pages: de or es; en, if absent. The robot speaks English all the same",
    ),
    optional("page_texts", Kind::Text, "a file (TOML) with the texts of participants' pages in any other language"),
    required("seed", Kind::Whole(LARGEST_SEED), "the seed of the assignment and of all worlds"),
    required(
        "participants",
        Kind::Whole(MOST_PARTICIPANTS),
        "how many participants are planned; the sign-up link admits no more",
    ),
    optional(
        "participants_per_session",
        Kind::Whole(LARGEST_SESSION),
        "how many participants play a session together, each at their own page: 1, if absent, or 2",
    ),
    optional(
        "pair",
        Kind::Table(PAIR),
        "of two participants a session: how they wait for each other, and skip missions",
    ),
    optional(
        "assignment",
        Kind::OneOf(&["latin_square", "balanced_latin_square", "block_random"]),
        "how the order of within-participant conditions is assigned; block_random, if absent",
    ),
    optional(
        "block_size",
        Kind::Whole(LARGEST_BLOCK),
        "participants of a block, or pairs of one, in which each between-participants condition is as frequent; as many as there are, \
         if absent",
    ),
    optional(
        "minimisation",
        Kind::Table(MINIMISATION),
        "how between-participants conditions are assigned by what participants are like, instead of in blocks (Pocock and Simon 1975)",
    ),
    optional(
        "missions",
        Kind::Texts,
        "the missions of the block of kind `missions`: names of missions that are built in or in a pack of `world`, or files",
    ),
    optional(
        "world",
        Kind::Texts,
        "world packs that all sessions are played with, in their order: folders within that of the study, or names of packs that come \
         with the program, such as homes; they are kept with its data",
    ),
    optional(
        "settings",
        Kind::Settings,
        "settings of all sessions: flags of `cohabit play`; and `score` and `clock`, true if participants are to see them",
    ),
    optional(
        "keep_until",
        Kind::Text,
        "the day until which data of participants are kept, such as 2031-12-31; the methods sheet says so, and `cohabit study` once it is over",
    ),
    optional("completion_code", Kind::Text, "what participants are given at the end, to show that they took part"),
    optional(
        "return_url",
        Kind::Text,
        "where participants are led back to at the end; {survey_code} in it stands for what the link by which they came had as survey_code",
    ),
    required("information", Kind::Table(SHEET), "what participants read first"),
    required("consent", Kind::Table(CONSENT), "what participants agree to"),
    optional("factor", Kind::Tables(FACTOR), "a factor of the design"),
    required("block", Kind::Tables(BLOCK), "what participants do, in order"),
    optional("probe", Kind::Tables(PROBE), "a question that is asked during missions, once in each, while they go on"),
    optional(
        "wizard",
        Kind::Table(WIZARD),
        "how a wizard (Wizard of Oz) takes part in sessions with the setting wizard = \"yes\"",
    ),
    optional("code", Kind::Tables(CODE), "what the experimenter notes by a key, on the experimenter's page"),
];

const CODE: &[Key] = &[
    required("key", Kind::Text, "the key: a small letter or a digit"),
    required("text", Kind::Text, "the note, such as: thinks aloud"),
];

const PAIR: &[Key] = &[
    optional(
        "partner_absent",
        Kind::OneOf(&["wait", "alone", "end"]),
        "what follows when somebody has waited for their partner so long: they wait on (wait, if absent), may go on alone, or may \
         stop, which ends the study for both; the experimenter is alarmed each time",
    ),
    optional("partner_minutes", Kind::Minutes, "how long somebody waits for their partner until then; 5, if absent"),
    optional(
        "skip",
        Kind::OneOf(&["both", "either"]),
        "who has to agree that a mission is skipped, which it is for both; both, if absent",
    ),
];

const WIZARD: &[Key] = &[
    optional("timeout_s", Kind::Seconds, "how long a wizard may take to decide; as long as they like, if absent"),
    optional(
        "on_timeout",
        Kind::OneOf(&["act", "say", "wait"]),
        "what follows then: the robot does what it proposed (act, if absent), says that it takes a moment and waits on, or waits on",
    ),
    optional("moment", Kind::Text, "of on_timeout = \"say\": what the robot says"),
    optional("phrase", Kind::Tables(PHRASE), "a canned phrase, which a key says"),
    optional("error", Kind::Tables(ERROR), "a planned error of the robot, which the wizard injects"),
];

const ERROR: &[Key] = &[
    required("name", Kind::Text, "what it is called at the seat and in tables"),
    optional("say", Kind::Text, "what the robot says; of an error in a step, what it would have said, if absent"),
    optional("do", Kind::Text, "what the robot does: a plain request"),
    optional(
        "step",
        Kind::Whole(LARGEST_STEP),
        "the step of the proposed plan, from 1, in whose place it does that; in place of all of it, if absent",
    ),
];

const PHRASE: &[Key] = &[
    required("key", Kind::Text, "the key: a small letter or a digit"),
    required("text", Kind::Text, "what the robot says"),
    optional("waits", Kind::Switch, "whether what the robot proposed waits on, rather than being answered by it"),
];

const PROBE: &[Key] = &[
    required("questionnaire", Kind::Text, "a questionnaire of one item: one that ships, or a file"),
    required("at", Kind::OneOf(&Moment::NAMES), "when it is asked; minutes: when the mission was played for so long"),
    optional("minutes", Kind::Minutes, "of a probe at minutes: after how many"),
    optional("pause", Kind::Switch, "whether the mission stands still until it is answered; it goes on, if absent"),
];

const MINIMISATION: &[Key] = &[
    required("covariate", Kind::Tables(COVARIATE), "what participants differ in, and are to be spread by"),
    optional(
        "certainty",
        Kind::Share,
        "how probable it is that somebody gets a condition that spreads best, 0.5 to 1; 0.8, if absent",
    ),
];

const COVARIATE: &[Key] = &[
    required("name", Kind::Text, "what it is called in tables: letters, digits and _"),
    optional("parameter", Kind::Text, "of one known from the link by which somebody comes: the parameter's name"),
    optional("levels", Kind::Texts, "of one known from the link: the values; all others count as `other`"),
    optional("questionnaire", Kind::Text, "of one known from an answer: a questionnaire before the first mission"),
    optional("item", Kind::Whole(LARGEST_ITEM), "of one known from an answer: which question, from 1"),
    optional(
        "cuts",
        Kind::Numbers,
        "of an answer on a scale: where it is cut into levels; each number is one, if absent",
    ),
];

const SHEET: &[Key] = &[
    required("file", Kind::Text, "a Markdown file, from the folder of the study"),
    required("version", Kind::Text, "the version of its text"),
];

const CONSENT: &[Key] = &[
    required("file", Kind::Text, "a Markdown file, from the folder of the study"),
    required("version", Kind::Text, "the version of its text, for the consent records"),
    required("required", Kind::Boxes(BOX), "the sentences that participants have to agree to, a checkbox each"),
    optional("optional", Kind::Boxes(BOX), "the sentences that participants may agree to, a checkbox each"),
];

const BOX: &[Key] = &[
    required("text", Kind::Text, "the sentence"),
    optional(
        "audio",
        Kind::Switch,
        "whether it is about being heard: only who ticks such a box has a microphone; all others type",
    ),
];

const FACTOR: &[Key] = &[
    required("name", Kind::Text, "what it is called in tables: letters, digits and _"),
    required("kind", Kind::OneOf(&["between", "within"]), "whether a participant meets one of its levels, or all"),
    optional(
        "unit",
        Kind::OneOf(&["pair", "participant"]),
        "of a factor between participants in a study of pairs: whether both of a pair meet the same level (pair, if absent), or each a \
         level of their own, which can set `clock` alone",
    ),
    required("level", Kind::Tables(LEVEL), "its levels, two or more"),
];

const LEVEL: &[Key] = &[
    required("name", Kind::Text, "what it is called in tables: letters, digits and _"),
    required("settings", Kind::Settings, "the settings that make it, as those of all sessions"),
];

const BLOCK: &[Key] = &[
    required(
        "kind",
        Kind::OneOf(&["questionnaire", "practice", "tutorial", "mission", "missions", "break", "debriefing"]),
        "what is done; a practice is a mission under no condition, and tables leave it out; a tutorial is a practice that goes on \
         until each of its exercises was tried",
    ),
    optional("questionnaires", Kind::Texts, "of a questionnaire block: names of questionnaires that ship, or files"),
    optional("mission", Kind::Text, "of a mission, a practice or a tutorial: the mission"),
    optional("settings", Kind::Settings, "of missions: settings of this block, as those of all sessions"),
    optional(
        "order",
        Kind::OneOf(&["fixed", "random", "balanced"]),
        "of a missions block: in what order; balanced has each mission meet each condition, and stand at each position, as often",
    ),
    optional(
        "minutes",
        Kind::Minutes,
        "of missions: the most that one is played; of a break: the longest that it lasts",
    ),
    optional(
        "skip_after_minutes",
        Kind::Minutes,
        "of missions: when participants may skip one; of a tutorial: when they may go on whatever they have tried",
    ),
    optional(
        "exercise",
        Kind::Tables(EXERCISE),
        "of a tutorial: what is to be tried, shown as a list beside the mission; if absent, to say something, to point, to stop \
         the robot, and to meet a goal",
    ),
    optional("after_mission", Kind::Texts, "of a missions block: questionnaires after each mission"),
    optional(
        "after_condition",
        Kind::Texts,
        "of a missions block: questionnaires after the last mission of each within-participant condition",
    ),
    optional("file", Kind::Text, "of missions, a break or a debriefing: a Markdown file with what participants read"),
];

const EXERCISE: &[Key] = &[
    required(
        "what",
        Kind::OneOf(&Activity::NAMES),
        "what counts as tried: a message that the robot took, a click on a thing, an answer to a question of the robot's, a stop, \
         a goal that was met; move and look take an avatar",
    ),
    required("text", Kind::Text, "what participants read"),
];

/// The keys of each kind of block besides `kind`: those that it must have, and those that it may have.
pub const KEYS_OF_BLOCKS: [(&str, &[&str], &[&str]); 7] = [
    ("questionnaire", &["questionnaires"], &[]),
    ("practice", &["mission"], &["settings", "minutes", "skip_after_minutes", "file"]),
    ("tutorial", &["mission"], &["settings", "minutes", "skip_after_minutes", "exercise", "file"]),
    ("mission", &["mission"], &["settings", "minutes", "skip_after_minutes", "file"]),
    (
        "missions",
        &[],
        &["order", "settings", "minutes", "skip_after_minutes", "after_mission", "after_condition", "file"],
    ),
    ("break", &[], &["minutes", "file"]),
    ("debriefing", &["file"], &[]),
];

impl Kind {
    /// What is to be written.
    pub fn wanted(self) -> String {
        match self {
            Self::Text => "a text in quotation marks, not empty".to_owned(),
            Self::Texts => "a list of texts, such as [\"one\", \"two\"]".to_owned(),
            Self::Boxes(_) => {
                "a list of sentences, or of tables such as { text = \"I may be heard.\", audio = true }".to_owned()
            }
            Self::Switch => "true or false".to_owned(),
            Self::Whole(most) => format!("a whole number from 0 to {most}"),
            Self::Minutes => "a number of minutes above 0".to_owned(),
            Self::Seconds => format!("a number of seconds above 0, up to {LONGEST_SECONDS}"),
            Self::Share => "a number from 0 to 1".to_owned(),
            Self::Numbers => "a list of whole numbers, such as [3, 5]".to_owned(),
            Self::OneOf(words) => format!("one of \"{}\"", words.join("\", \"")),
            Self::Settings => "a table of settings, such as { ask = \"never\" }".to_owned(),
            Self::Table(_) => "a table".to_owned(),
            Self::Tables(_) => "tables, each below a head in double brackets".to_owned(),
        }
    }
}
