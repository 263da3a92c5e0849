//! One task, played to its end.

use std::{collections::BTreeMap, path::PathBuf, sync::Arc, time::Instant};

use cohabit_bus::message::DialogKind;
use cohabit_cdf::{BodyId, BodyRequest, Catalog};
use cohabit_dialog::{Conversation, Knowledge, TurnEnd};
use cohabit_engine::SessionPlan;
use cohabit_language::{Asking, Known, Knows, Language, Roster};
use cohabit_record::{LogError, SessionFacts};
use cohabit_speech::errors::Injector;
use cohabit_world::{Outcome, World};
use serde::{Deserialize, Serialize};

use crate::{
    family::family,
    lock_step::{LockStep, Noted},
    meaning::Meaning,
    simulated::{Style, User, expert},
    task::{Answer, Line, Task},
    trajectory,
};

/// What people wait after a turn before they speak again: machines that are on for a moment are done by then.
const PAUSE_TICKS: u64 = 150;
/// The longest that one line may take: a search through all of an office, and back.
const PATIENCE_TICKS: u64 = 60 * 900;

/// People call a robot that has a name by it in one of so many things that they say.
const CALLED_EVERY: usize = 3;

/// The most times that people speak for the sake of one thing they want.
const MOST_ROUNDS: u32 = 6;

/// How tasks are played.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    /// The seed where a mission leaves it to chance.
    pub seed: u64,
    /// What the robot may know.
    pub knows: Knows,
    /// When the robot asks.
    pub asking: Asking,
    /// How those speak who say what they want in their own words; in the expert's words, if nothing is said.
    pub style: Option<Style>,
    /// What people call the robot now and then, if it has a name.
    pub name: Option<String>,
    /// The share of words that the robot hears wrong, of people who speak aloud, from 0 to 1; what people write is read as it is.
    pub mishears: f32,
    /// Bodies beside those of the mission, which stand where they begin.
    pub bodies: Vec<BodyRequest>,
    /// When to give up.
    pub caps: Option<Caps>,
    /// The folder for session logs, if they are wanted.
    pub record: Option<PathBuf>,
}

impl Settings {
    /// How the expert plays, who knows everything and asks nothing.
    #[must_use]
    pub fn expert(seed: u64) -> Self {
        Self { seed, knows: Knows::Everything, asking: Asking::Never, ..Self::default() }
    }

    /// The session log of a task, if one is wanted.
    #[must_use]
    pub fn log(&self, id: &str) -> Option<PathBuf> {
        self.record.as_ref().map(|folder| folder.join(format!("{}.mcap", file_name(id))))
    }

    /// As a log notes them.
    fn noted(&self) -> BTreeMap<String, String> {
        let played = [("knows", self.knows.to_string()), ("ask", self.asking.to_string())];
        let speaks = |Style { vagueness, typos, mistakes }: Style| {
            [("vagueness", vagueness), ("typos", typos), ("mistakes", mistakes)]
                .map(|(name, share)| (name, share.to_string()))
        };
        let all = played.into_iter().chain(self.style.map(speaks).into_iter().flatten());
        all.map(|(name, value)| (name.to_owned(), value)).collect()
    }
}

/// The commands that a task may take; what prepares it is not counted.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub struct Caps {
    /// Commands in all.
    pub actions: u32,
    /// Commands that failed.
    pub failed: u32,
}

/// What came of a task.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct Played {
    /// The task.
    pub id: String,
    /// What kind of task it is, by its goals.
    pub family: String,
    /// Whether every goal was met.
    pub success: bool,
    /// Goals met.
    pub goals_met: usize,
    /// Goals in all.
    pub goals: usize,
    /// Goals that were met before the mission counted.
    pub goals_met_in_preparation: usize,
    /// What the goals that stayed open ask for.
    pub open_goals: Vec<String>,
    /// Commands that ended.
    pub actions: u32,
    /// Commands that failed.
    pub failed_actions: u32,
    /// Commands by status.
    pub statuses: BTreeMap<String, u32>,
    /// Questions that the robot asked.
    pub questions: u32,
    /// Simulated ticks.
    pub ticks: u64,
    /// Wall time from the text of the mission to its first tick, s.
    pub load_s: f64,
    /// Wall time in all, s.
    pub wall_s: f64,
    /// The first line that did not do what it says.
    pub first_trouble: Option<Trouble>,
    /// What was said, and what the robot said to it.
    pub transcript: Vec<Said>,
    /// Why it was not played to the end, if it was not.
    pub ended_early: Option<String>,
    /// Its session log.
    pub log: Option<PathBuf>,
}

/// A line that did not do what it says.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Trouble {
    /// The line.
    pub line: String,
    /// Why.
    pub why: String,
}

/// A line, and what the robot said to it.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Said {
    /// The line.
    pub line: String,
    /// What the robot said, in order.
    pub replies: Vec<String>,
}

/// Plays a task with a robot that speaks this language, asking as the settings say. That it cannot be played is a result too.
///
/// # Errors
/// [`LogError`], when its log cannot be written.
pub fn play(task: &Task, settings: &Settings, language: &Language) -> Result<Played, LogError> {
    let (began, catalog) = (Instant::now(), language.catalog());
    let mut played = Played { id: task.id.clone(), ..Played::default() };
    let Some((plan, world)) = played.set_up(task, settings, catalog, began) else { return Ok(played) };
    let knowledge = Knowledge::new(settings.knows, Arc::clone(catalog), world.layout(), BodyId(0))
        .with_mission(&plan.mission.goal_text);
    let conversation = Conversation::new(language.clone().asking(settings.asking), 0);
    let mut session = LockStep::new(world, conversation, knowledge);
    if let Some(path) = settings.log(&task.id) {
        let facts = SessionFacts { settings: settings.noted(), ..SessionFacts::named(&task.id) };
        session.record(&path, &facts, &plan)?;
        played.log = Some(path);
    }
    let user = settings.style.map(|style| {
        User::new(style, person_of(&task.id, settings.seed), Arc::clone(catalog), Arc::clone(&plan.layout))
    });
    let voice = Voice::new(settings, person_of(&task.id, settings.seed));
    let mut player = Player { session, played, user, voice, caps: settings.caps, counts: false, is_over: false };
    player.run(task)?;
    player.session.finish()?;
    let mut played = player.judged();
    played.wall_s = began.elapsed().as_secs_f64();
    Ok(played)
}

/// The seed of who speaks in a task: another person in each (FNV-1a).
fn person_of(id: &str, seed: u64) -> u64 {
    id.bytes().fold(0xcbf2_9ce4_8422_2325 ^ seed, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

/// A task's id as the name of a file.
fn file_name(id: &str) -> String {
    let fits = |letter: char| letter.is_ascii_alphanumeric() || matches!(letter, '-' | '_' | '.' | '#');
    id.chars().map(|letter| if fits(letter) { letter } else { '_' }).collect()
}

/// What the robot said, in order.
type Replies = Vec<(DialogKind, String)>;

/// How what people say reaches the robot.
struct Voice {
    /// What they call the robot, and who is called so.
    called: Option<(String, Roster)>,
    /// What makes errors in it.
    injector: Option<Injector>,
    /// How often they have spoken.
    lines: usize,
}

impl Voice {
    fn new(settings: &Settings, seed: u64) -> Self {
        let called = settings.name.clone().map(|name| (name.clone(), Roster::new([name.as_str()])));
        let injector = (settings.mishears > 0.0).then(|| Injector::new(settings.mishears, seed));
        Self { called, injector, lines: 0 }
    }

    /// A line as the robot hears it, and what of it is said to the robot: all but its name.
    fn heard(&mut self, text: &str) -> (String, String) {
        let is_called = self.lines.is_multiple_of(CALLED_EVERY);
        self.lines += 1;
        let name = self.called.as_ref().filter(|_| is_called).map(|(name, _)| name);
        let said = name.map_or_else(|| text.to_owned(), |name| format!("{name}, {text}"));
        let heard = self.injector.as_mut().map_or_else(|| said.clone(), |injector| injector.garble(&said));
        // What is not heard at all is said once more, and plainly.
        let heard = if heard.trim().is_empty() { said } else { heard };
        let plain = self.called.as_ref().map_or_else(|| heard.clone(), |(_, roster)| roster.addressed(&heard).text);
        (heard, plain)
    }
}

struct Player {
    session: LockStep,
    played: Played,
    /// Who says what is wanted in their own words.
    user: Option<User>,
    /// How what is said reaches the robot.
    voice: Voice,
    caps: Option<Caps>,
    /// Whether the preparation is over.
    counts: bool,
    /// Whether the mission is over: what is done after that counts for nothing.
    is_over: bool,
}

impl Player {
    fn run(&mut self, task: &Task) -> Result<(), LogError> {
        for line in &task.preparation {
            if !self.goes_on() {
                return Ok(());
            }
            self.line(line)?;
        }
        self.played.goals_met_in_preparation = goals_met(self.session.world());
        self.counts = true;
        for line in &task.script {
            if !self.goes_on() {
                break;
            }
            self.line(line)?;
        }
        Ok(())
    }

    fn goes_on(&self) -> bool {
        self.played.ended_early.is_none() && self.session.world().finished().is_none()
    }

    /// Says or does one line, and waits until it is over and done with.
    fn line(&mut self, line: &Line) -> Result<(), LogError> {
        let trouble = match line {
            Line::Utterance { text, answers } => self.utterance(text, answers)?,
            Line::Meant(meaning) => self.meant(meaning)?,
            Line::Action(action) => self.action(action)?,
        };
        if let Some(why) = trouble {
            self.played.first_trouble.get_or_insert(Trouble { line: line.to_string(), why });
        }
        self.wait(PAUSE_TICKS)
    }

    /// Says something; gives how the turn ended, if it did, and what the robot said.
    fn exchange(&mut self, text: &str) -> Result<(Option<TurnEnd>, Replies), LogError> {
        let (said, plain) = self.voice.heard(text);
        let turn = self.session.say_called(&said, &plain)?;
        let (end, told) =
            self.until(|noted| noted.turns.iter().find(|(ended, _)| *ended == turn).map(|(_, end)| *end))?;
        let replies = told.iter().map(|(_, text)| text.clone()).collect();
        self.played.transcript.push(Said { line: said, replies });
        Ok((end, told))
    }

    /// Says something and answers the questions that come back; gives why it did not do what it says.
    fn utterance(&mut self, text: &str, answers: &[Answer]) -> Result<Option<String>, LogError> {
        let mut answers: Vec<&Answer> = answers.iter().collect();
        let mut text = text;
        loop {
            let (end, said) = self.exchange(text)?;
            let Some(end) = end else { return Ok(Some("it did not come to an end".to_owned())) };
            let asked = said.iter().rev().find(|(kind, _)| *kind == DialogKind::Question);
            let Some((_, question)) = asked else {
                let last = said.last().map_or("", |(_, text)| text);
                return Ok((!end.is_success()).then(|| format!("{}: {last}", end.name())));
            };
            self.played.questions += 1;
            let Some(best) = best_answer(question, &answers) else {
                return Ok(Some(format!("nobody answers: {question}")));
            };
            text = &answers.remove(best).text;
        }
    }

    /// Says what is wanted, answers what is asked, and says it once more if it was not understood; gives why it was not
    /// done.
    fn meant(&mut self, meaning: &Meaning) -> Result<Option<String>, LogError> {
        let mut text = self.in_words(meaning, User::say);
        let mut left = MOST_ROUNDS;
        let mut may_repeat = true;
        loop {
            let (end, said) = self.exchange(&text)?;
            let last = said.last().map_or("", |(_, text)| text);
            left -= 1;
            text = match (end, self.session.asked().cloned()) {
                (None, _) => return Ok(Some("it did not come to an end".to_owned())),
                (Some(_), Some(asked)) if left > 0 => {
                    self.played.questions += 1;
                    self.in_words(meaning, |user, meaning, truth| user.answer(&asked, meaning, truth))
                }
                (Some(end), _) if end.is_success() => return Ok(None),
                (Some(_), _) if may_repeat && left > 0 => {
                    may_repeat = false;
                    self.in_words(meaning, User::say_clearly)
                }
                (Some(end), _) => return Ok(Some(format!("{}: {last}", end.name()))),
            };
        }
    }

    fn in_words(&mut self, meaning: &Meaning, say: impl FnOnce(&mut User, &Meaning, &Known) -> String) -> String {
        match (&mut self.user, self.session.truth()) {
            (Some(user), Some(truth)) => say(user, meaning, &truth),
            _ => expert(meaning),
        }
    }

    fn action(&mut self, action: &serde_json::Value) -> Result<Option<String>, LogError> {
        let action = match trajectory::action(action, self.session.world()) {
            Ok(Some(action)) => action,
            Ok(None) => return Ok(None),
            Err(why) => return Ok(Some(why)),
        };
        self.session.command(action);
        let (outcome, _) = self.until(|noted| noted.outcomes.last().cloned())?;
        Ok(match outcome {
            None => Some("it did not come to an end".to_owned()),
            Some(outcome) if outcome.status.is_failure() => Some(format!("{:?}: {}", outcome.status, outcome.detail)),
            Some(_) => None,
        })
    }

    /// Ticks until `done`; gives what it gave, and what the robot said meanwhile.
    fn until<T>(&mut self, done: impl Fn(&Noted) -> Option<T>) -> Result<(Option<T>, Replies), LogError> {
        let mut said = Vec::new();
        for _ in 0..PATIENCE_TICKS {
            let noted = self.session.take_noted();
            let found = done(&noted);
            noted.outcomes.iter().for_each(|outcome| self.count(outcome));
            // What ended in the tick that ended the mission was counted.
            self.is_over = self.session.world().finished().is_some();
            said.extend(noted.said);
            if found.is_some() || self.played.ended_early.is_some() {
                return Ok((found, said));
            }
            self.session.tick()?;
        }
        self.played.ended_early = Some("a line took too long".to_owned());
        Ok((None, said))
    }

    fn wait(&mut self, ticks: u64) -> Result<(), LogError> {
        for _ in 0..ticks {
            self.session.tick()?;
        }
        Ok(())
    }

    fn count(&mut self, outcome: &Outcome) {
        if self.counts && !self.is_over {
            self.played.count(outcome, self.caps);
        }
    }

    fn judged(self) -> Played {
        let mut played = self.played;
        played.judge(self.session.world());
        played
    }
}

impl Played {
    /// The plan of the task's session, and its world; nothing, if it cannot be played, which is noted.
    pub(crate) fn set_up(
        &mut self,
        task: &Task,
        settings: &Settings,
        catalog: &Arc<Catalog>,
        began: Instant,
    ) -> Option<(SessionPlan, World)> {
        let built = SessionPlan::new(&task.id, &task.cdf, Arc::clone(catalog), settings.seed)
            .map(|plan| plan.with_bodies(settings.bodies.clone()))
            .and_then(|plan| plan.build().map(|world| (plan, world)));
        let seconds = began.elapsed().as_secs_f64();
        match built {
            Ok((plan, world)) => {
                self.load_s = seconds;
                self.family = task.family.clone().unwrap_or_else(|| family(&plan.mission));
                Some((plan, world))
            }
            Err(error) => {
                self.ended_early = Some(format!("not playable: {error}"));
                self.wall_s = seconds;
                None
            }
        }
    }

    /// Counts a command that ended; too many of them end the mission.
    pub(crate) fn count(&mut self, outcome: &Outcome, caps: Option<Caps>) {
        self.actions += 1;
        self.failed_actions += u32::from(outcome.status.is_failure());
        *self.statuses.entry(format!("{:?}", outcome.status)).or_default() += 1;
        let Some(caps) = caps else { return };
        let too_much = [(self.actions > caps.actions, "actions"), (self.failed_actions >= caps.failed, "failures")];
        if let Some((_, what)) = too_much.into_iter().find(|(over, _)| *over) {
            self.ended_early = Some(format!("too many {what}"));
        }
    }

    /// Takes over what the world says of its goals in the end.
    pub(crate) fn judge(&mut self, world: &World) {
        // A goal that can open again may have done so since the mission was complete.
        let is_complete = matches!(world.finished(), Some(cohabit_world::Ending::AllGoalsMet));
        self.goals = world.goals().len();
        self.goals_met = if is_complete { self.goals } else { goals_met(world) };
        self.success = is_complete && self.goals > 0 && self.ended_early.is_none();
        self.open_goals = if is_complete { Vec::new() } else { open_goals(world) };
        self.ticks = world.tick();
        if self.ended_early.is_none()
            && let Some(cohabit_world::Ending::KilledByHazard) = world.finished()
        {
            self.ended_early = Some("a hazard destroyed the robot".to_owned());
        }
    }
}

fn goals_met(world: &World) -> usize {
    world.goals().iter().filter(|goal| goal.met).count()
}

/// The states of the open goals, in the words of their mission.
fn open_goals(world: &World) -> Vec<String> {
    let open: Vec<i64> = world.goals().iter().filter(|goal| !goal.met).map(|goal| goal.id).collect();
    let goals = world.mission().goals.iter().filter(|goal| open.contains(&goal.id));
    goals
        .map(|goal| {
            let states: Vec<String> = goal.states.iter().map(ToString::to_string).collect();
            format!("{}: {}", goal.id, states.join(", "))
        })
        .collect()
}

/// The answer whose question is most like the one asked; the first where none is.
fn best_answer(question: &str, answers: &[&Answer]) -> Option<usize> {
    let words = |text: &str| -> Vec<String> {
        let lower = text.to_lowercase();
        lower.split(|letter: char| !letter.is_alphanumeric()).filter(|word| word.len() > 2).map(str::to_owned).collect()
    };
    let asked = words(question);
    let likeness = |answer: &Answer| words(&answer.question).iter().filter(|word| asked.contains(word)).count();
    (0..answers.len()).max_by_key(|index| (likeness(answers[*index]), std::cmp::Reverse(*index)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn people_call_a_robot_by_its_name_now_and_then_and_are_misheard_as_often_as_they_are_to() {
        let check = |settings: &Settings, expected: [(&str, &str); 2]| {
            let mut voice = Voice::new(settings, 1);
            for (said, plain) in expected {
                assert_eq!(voice.heard("take the mug"), (said.to_owned(), plain.to_owned()));
            }
        };
        check(&Settings::default(), [("take the mug", "take the mug"); 2]);
        let named = Settings { name: Some("Rosie".to_owned()), ..Settings::default() };
        check(&named, [("Rosie, take the mug", "take the mug"), ("take the mug", "take the mug")]);
        let mishears = Settings { mishears: 1.0, ..Settings::default() };
        let heard = |settings: &Settings| Voice::new(settings, 1).heard("take the yellow mug in the kitchen").0;
        assert_ne!(heard(&mishears), "take the yellow mug in the kitchen");
        assert_eq!(heard(&mishears), heard(&mishears));
    }
}
