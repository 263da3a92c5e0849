//! Scripts: what a body is to do, one thing a line.
//!
//! ```text
//! # What follows a hash is for people.
//! on-failure continue          # or stop, as it is at first
//! goto room BreakRoom          # also: goto viewpoint BreakRoom_3, goto point 4.0 10.5, goto Bowl_01_1
//! pickup class Bowl_01         # the nearest of that class; so does `pickup Bowl_01`, if no instance is called so
//! place KitchenCounterTop_02_1
//! open FridgeLower_02_1        # open close toggle break scan pour throw fill clean examine
//! move 1.5                     # m; negative is backwards
//! rotate 90                    # degrees; positive is to the left
//! look -20                     # degrees; positive is up
//! look-around
//! highlight Bowl_01_1
//! say Here you are.
//! wait 2.0                     # simulated seconds
//! loop                         # from the start again; the last line
//! ```

use cohabit_cdf::{Action, Catalog, ClassId, GoToTarget, Verb};

use crate::agent::TICKS_PER_SECOND;

/// What a body is to do, in order.
#[derive(Clone, Debug, PartialEq)]
pub struct Script {
    /// Where it comes from, as it is named to people.
    pub file: String,
    pub(crate) lines: Vec<Line>,
    pub(crate) loops: bool,
}

/// One thing to do.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Line {
    /// Counts from 1.
    pub number: usize,
    pub order: Order,
    /// Whether the script goes on if this fails.
    pub goes_on: bool,
}

/// What a line asks for.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Order {
    /// As it stands.
    Act(Action),
    /// To a thing.
    Handle(Deal, Named),
    /// To everybody.
    Say(String),
    /// So many ticks.
    Wait(u64),
}

/// What can be done with a thing that is named.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Deal {
    GoTo,
    PickUp,
    Place,
    Highlight,
    Do(Verb),
}

/// A thing as a script names it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Named {
    /// The one of that id, or else the nearest of the class of that id.
    Instance(String),
    /// The nearest of a class.
    Class(ClassId),
}

/// A script is no longer than this.
const MOST_LINES: usize = 10_000;
/// Nobody waits longer, s.
const LONGEST_WAIT_S: f32 = 3600.0;

const DEALS: &[(&str, Deal)] = &[
    ("pickup", Deal::PickUp),
    ("place", Deal::Place),
    ("highlight", Deal::Highlight),
    ("open", Deal::Do(Verb::Open)),
    ("close", Deal::Do(Verb::Close)),
    ("toggle", Deal::Do(Verb::Toggle)),
    ("break", Deal::Do(Verb::Break)),
    ("scan", Deal::Do(Verb::Scan)),
    ("pour", Deal::Do(Verb::Pour)),
    ("throw", Deal::Do(Verb::Throw)),
    ("fill", Deal::Do(Verb::Fill)),
    ("clean", Deal::Do(Verb::Clean)),
    ("examine", Deal::Do(Verb::Examine)),
];
const OTHERS: &[&str] = &["goto", "move", "rotate", "look", "look-around", "stop", "say", "wait", "on-failure", "loop"];

/// What is wrong in a script, where, and what would be right.
#[derive(Clone, Debug, Eq, PartialEq, thiserror::Error)]
#[error("{file}:{line}: {what}")]
pub struct ScriptError {
    /// The file.
    pub file: String,
    /// The line, from 1.
    pub line: usize,
    /// What is wrong, and the remedy.
    pub what: String,
}

impl Script {
    /// Reads a script that comes from `file`.
    ///
    /// # Errors
    /// [`ScriptError`] for the first line that makes no sense.
    pub fn parse(file: &str, text: &str, catalog: &Catalog) -> Result<Self, ScriptError> {
        let mut script = Self { file: file.to_owned(), lines: Vec::new(), loops: false };
        let (mut goes_on, mut last) = (false, 1);
        for (number, line) in (1..).zip(text.lines()) {
            let wrong = |what: String| ScriptError { file: file.to_owned(), line: number, what };
            let line = line.split('#').next().unwrap_or_default().trim();
            if line.is_empty() {
                continue;
            }
            last = number;
            if script.loops {
                return Err(wrong("nothing comes after `loop`: make it the last line".to_owned()));
            }
            if script.lines.len() >= MOST_LINES {
                return Err(wrong(format!("a script has {MOST_LINES} lines at most: use `loop`")));
            }
            let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
            let rest = rest.trim();
            match word {
                "loop" => script.loops = nothing(word, rest).map(|()| true).map_err(wrong)?,
                "on-failure" => goes_on = on_failure(rest).map_err(wrong)?,
                _ => {
                    let order = order(word, rest, catalog).map_err(wrong)?;
                    script.lines.push(Line { number, order, goes_on });
                }
            }
        }
        let takes_time = script.lines.iter().any(|line| !matches!(line.order, Order::Say(_) | Order::Wait(0)));
        if script.loops && !takes_time {
            let what = "a loop must take time: add a `wait` or something to do".to_owned();
            return Err(ScriptError { file: file.to_owned(), line: last, what });
        }
        Ok(script)
    }
}

fn nothing(word: &str, rest: &str) -> Result<(), String> {
    if rest.is_empty() { Ok(()) } else { Err(format!("nothing comes after `{word}`: take `{rest}` away")) }
}

fn on_failure(rest: &str) -> Result<bool, String> {
    match rest {
        "stop" => Ok(false),
        "continue" => Ok(true),
        _ => Err(format!("`on-failure {rest}`: write `on-failure stop` or `on-failure continue`")),
    }
}

fn order(word: &str, rest: &str, catalog: &Catalog) -> Result<Order, String> {
    let degrees = |most: f32| number(word, rest, "degrees", most).map(f32::to_radians);
    if let Some((_, deal)) = DEALS.iter().find(|(name, _)| *name == word) {
        return Ok(Order::Handle(*deal, named(word, rest, catalog)?));
    }
    Ok(match word {
        "goto" => go_to(rest, catalog)?,
        "move" => Order::Act(Action::Move { distance_m: number(word, rest, "metres", 50.0)? }),
        "rotate" => Order::Act(Action::Rotate { yaw_rad: degrees(720.0)? }),
        "look" => Order::Act(Action::Look { pitch_rad: degrees(90.0)? }),
        "look-around" => nothing(word, rest).map(|()| Order::Act(Action::LookAround))?,
        "stop" => nothing(word, rest).map(|()| Order::Act(Action::Stop))?,
        "say" if rest.is_empty() => return Err("`say` what? Write the words after it".to_owned()),
        "say" => Order::Say(rest.to_owned()),
        "wait" => {
            let seconds = number(word, rest, "seconds", LONGEST_WAIT_S)?.max(0.0);
            Order::Wait((seconds * TICKS_PER_SECOND as f32).round() as u64)
        }
        _ => {
            let known = DEALS.iter().map(|(name, _)| *name).chain(OTHERS.iter().copied());
            let known: Vec<_> = known.collect();
            return Err(format!("there is no `{word}`: one of {}", known.join(", ")));
        }
    })
}

fn go_to(rest: &str, catalog: &Catalog) -> Result<Order, String> {
    let room = |name: &str| {
        let rooms = catalog.rooms();
        rooms.find(name).ok_or_else(|| format!("there is no room `{name}`: one of {}", rooms.listed()))
    };
    let (word, place) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
    let place = place.trim();
    let target = match word {
        "room" => GoToTarget::Room(room(place)?),
        "viewpoint" => {
            let remedy = || format!("there is no viewpoint `{place}`: such as `BreakRoom_3`, 1 to 8 of each room");
            let (name, number) = place.rsplit_once('_').ok_or_else(remedy)?;
            let number = number.parse().ok().filter(|number| (1..=8).contains(number)).ok_or_else(remedy)?;
            GoToTarget::Viewpoint(room(name)?, number)
        }
        "point" => {
            let (x, y) = place.split_once(char::is_whitespace).unwrap_or((place, ""));
            let coordinate = |text: &str| number("goto point", text.trim(), "metres twice, x and y", 1e3);
            GoToTarget::Point([coordinate(x)?, coordinate(y)?])
        }
        _ => return Ok(Order::Handle(Deal::GoTo, named("goto", rest, catalog)?)),
    };
    Ok(Order::Act(Action::GoTo { target }))
}

fn number(word: &str, text: &str, unit: &str, most: f32) -> Result<f32, String> {
    let number = text.parse::<f32>().ok().filter(|number| number.is_finite() && number.abs() <= most);
    number.ok_or_else(|| format!("`{word} {text}`: write a number of {unit}, at most {most}"))
}

fn named(word: &str, text: &str, catalog: &Catalog) -> Result<Named, String> {
    let no_class = |name: &str| {
        let lower = name.to_lowercase();
        let begins = |id: &&str| id.to_lowercase().starts_with(lower.trim_end_matches(|c: char| !c.is_alphabetic()));
        let near: Vec<_> = catalog.classes().iter().map(|class| class.id.as_str()).filter(begins).take(3).collect();
        let remedy = if near.is_empty() || lower.is_empty() {
            "write an instance id such as `Bowl_01_1`, or a class such as `Bowl_01`".to_owned()
        } else {
            format!("do you mean {}?", near.join(" or "))
        };
        format!("no class of object is called `{name}`: {remedy}")
    };
    if text.is_empty() {
        return Err(format!("`{word}` what? Write an instance id such as `Bowl_01_1`, or a class such as `Bowl_01`"));
    }
    match text.split_once(char::is_whitespace) {
        Some(("class", class)) => {
            let class = class.trim();
            catalog.find(class).map(Named::Class).ok_or_else(|| no_class(class))
        }
        Some((_, more)) => Err(format!("`{word}` takes one thing: take `{more}` away")),
        // What machines make is named after them.
        None if catalog.class_of_instance(text).is_some() => Ok(Named::Instance(text.to_owned())),
        None => Err(no_class(text)),
    }
}

#[cfg(test)]
mod tests {
    use cohabit_cdf::RoomId;

    use super::*;

    fn parse(text: &str) -> Result<Script, String> {
        Script::parse("a.txt", text, &Catalog::builtin()).map_err(|error| error.to_string())
    }

    #[test]
    fn every_line_of_the_documented_script_is_understood() {
        let documented = include_str!("script.rs").split("```").nth(1).unwrap();
        let text: String = documented.lines().skip(1).map(|line| format!("{}\n", &line[3.min(line.len())..])).collect();
        let script = parse(&text).unwrap();
        assert_eq!(script.lines.len(), 11);
        assert!(script.loops && script.lines.iter().all(|line| line.goes_on));
    }

    #[test]
    fn orders_are_what_they_say() {
        let catalog = Catalog::builtin();
        let bowl = catalog.find("Bowl_01").unwrap();
        let ninety = Action::Rotate { yaw_rad: 90f32.to_radians() };
        let there = Action::GoTo { target: GoToTarget::Point([1.5, -2.0]) };
        let viewpoint = Action::GoTo { target: GoToTarget::Viewpoint(RoomId::LAB2, 8) };
        for (line, order) in [
            ("rotate 90", Order::Act(ninety)),
            ("goto point 1.5 -2", Order::Act(there)),
            ("goto viewpoint Lab2_8", Order::Act(viewpoint)),
            ("  pickup   class Bowl_01 ", Order::Handle(Deal::PickUp, Named::Class(bowl))),
            ("goto Bowl_01_1", Order::Handle(Deal::GoTo, Named::Instance("Bowl_01_1".to_owned()))),
            ("wait 0.5 # s", Order::Wait(30)),
            ("say one two", Order::Say("one two".to_owned())),
        ] {
            let script = parse(line).unwrap();
            assert_eq!(script.lines, [Line { number: 1, order, goes_on: false }], "{line}");
        }
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line_and_a_remedy() {
        for (text, error) in [
            ("wait 1\njump", "a.txt:2: there is no `jump`: one of pickup,"),
            ("rotate left", "a.txt:1: `rotate left`: write a number of degrees"),
            ("move NaN", "a.txt:1: `move NaN`"),
            ("pickup Bowl", "a.txt:1: no class of object is called `Bowl`: do you mean Bowl_01"),
            ("pickup", "a.txt:1: `pickup` what?"),
            ("goto room Attic", "a.txt:1: there is no room `Attic`: one of BreakRoom"),
            ("goto viewpoint Lab1_9", "a.txt:1: there is no viewpoint `Lab1_9`"),
            ("place Desk_01 1", "a.txt:1: `place` takes one thing"),
            ("\n\non-failure shrug", "a.txt:3: `on-failure shrug`"),
            ("loop\nwait 1", "a.txt:2: nothing comes after `loop`"),
            ("say hey\nloop", "a.txt:2: a loop must take time"),
        ] {
            let found = parse(text).unwrap_err();
            assert!(found.starts_with(error), "{text:?}: {found}");
        }
    }
}
