//! The text of a floor plan's file as lists of entries that are changed one by one: comments and all that is not changed stay as they are.

use std::fmt::Write as _;

use serde::Deserialize;
use toml::{Spanned, Table, Value};

/// The lists of a floor plan's file.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum List {
    /// Instances of the base that are left out.
    Remove,
    /// Rooms.
    Room,
    /// Surfaces of rooms of the base.
    Finish,
    /// Doors, passages and windows.
    Opening,
    /// What stands where.
    Placement,
    /// Named places to look from.
    Viewpoint,
    /// Where notes can be stuck.
    NotePlace,
}

impl List {
    /// All of them, in the order in which files have them.
    const ALL: [Self; 7] =
        [Self::Remove, Self::Room, Self::Finish, Self::Opening, Self::Placement, Self::Viewpoint, Self::NotePlace];

    const fn key(self) -> &'static str {
        match self {
            Self::Remove => "remove",
            Self::Room => "room",
            Self::Finish => "finish",
            Self::Opening => "opening",
            Self::Placement => "placement",
            Self::Viewpoint => "viewpoint",
            Self::NotePlace => "note_place",
        }
    }
}

/// Keys of entries in the order in which they are written; others follow.
const KEYS: [&str; 21] = [
    "kind",
    "door",
    "id",
    "instance",
    "room",
    "number",
    "between",
    "on",
    "anchor",
    "rects_m",
    "at_m",
    "yaw_deg",
    "width_m",
    "wall_runs",
    "scale",
    "works",
    "floor",
    "wall",
    "wainscot",
    "material",
    "color",
];

type Entries = Option<Spanned<Vec<Spanned<Value>>>>;

/// Where all stands in a text. Whether it is the text of a floor plan, others say.
#[derive(Default, Deserialize)]
#[serde(default)]
struct Places {
    base: Option<String>,
    wall_height_m: Option<Spanned<Value>>,
    remove: Entries,
    room: Entries,
    finish: Entries,
    opening: Entries,
    placement: Entries,
    viewpoint: Entries,
    note_place: Entries,
}

impl Places {
    const fn of(&self, list: List) -> Option<&Spanned<Vec<Spanned<Value>>>> {
        match list {
            List::Remove => self.remove.as_ref(),
            List::Room => self.room.as_ref(),
            List::Finish => self.finish.as_ref(),
            List::Opening => self.opening.as_ref(),
            List::Placement => self.placement.as_ref(),
            List::Viewpoint => self.viewpoint.as_ref(),
            List::NotePlace => self.note_place.as_ref(),
        }
    }

    fn entries(&self, list: List) -> &[Spanned<Value>] {
        self.of(list).map_or(&[][..], |entries| entries.get_ref().as_slice())
    }
}

/// The text of a floor plan's file.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Entrywise(String);

impl Entrywise {
    /// That text; one whose entries are tables of their own (`[[placement]]`) is laid out anew as lists, and loses its comments.
    ///
    /// # Errors
    /// Why it cannot be read, in words.
    pub fn new(text: &str) -> Result<Self, String> {
        let places = places(text)?;
        let is_list = |list: &List| {
            let mut entries = places.entries(*list).iter();
            entries.all(|entry| text[entry.span().start..].starts_with(['{', '"', '\'']))
        };
        if List::ALL.iter().all(is_list) { Ok(Self(text.to_owned())) } else { laid_out(text).map(Self) }
    }

    /// The text.
    #[must_use]
    pub fn into_text(self) -> String {
        self.0
    }

    /// The plan that it begins with, if it does with one.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn base(&self) -> Result<Option<String>, String> {
        Ok(places(&self.0)?.base)
    }

    /// The entries of a list, in the order of the file.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn tables(&self, list: List) -> Result<Vec<Table>, String> {
        let places = places(&self.0)?;
        let tables = places.entries(list).iter();
        Ok(tables.map(|entry| entry.get_ref().as_table().cloned().unwrap_or_default()).collect())
    }

    /// The place in a list of the first entry that is meant.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn find(&self, list: List, is_meant: impl Fn(&Table) -> bool) -> Result<Option<usize>, String> {
        Ok(self.tables(list)?.iter().position(is_meant))
    }

    /// Writes an entry in the place of another one.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn set(&mut self, list: List, index: usize, entry: Table) -> Result<(), String> {
        let places = places(&self.0)?;
        if let Some(old) = places.entries(list).get(index) {
            self.0.replace_range(old.span(), &written(&Value::Table(entry)));
        }
        Ok(())
    }

    /// Takes an entry out, with its line if it is alone there.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn remove(&mut self, list: List, index: usize) -> Result<(), String> {
        let places = places(&self.0)?;
        let Some(entry) = places.entries(list).get(index) else { return Ok(()) };
        let span = entry.span();
        let text = &self.0;
        let behind = &text[span.end..];
        let comma = behind.trim_start();
        let mut end = span.end;
        if comma.starts_with(',') {
            end += behind.len() - comma.len() + 1;
        }
        let mut start = text[..span.start].rfind('\n').map_or(0, |at| at + 1);
        let is_alone = text[start..span.start].trim().is_empty();
        let line_end = text[end..].find('\n').map(|at| end + at);
        match line_end {
            Some(at) if is_alone && text[end..at].trim().is_empty() => end = at + 1,
            _ => start = span.start,
        }
        self.0.replace_range(start..end, "");
        Ok(())
    }

    /// Takes out all entries of a list that are meant.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn remove_all(&mut self, list: List, is_meant: impl Fn(&Table) -> bool) -> Result<(), String> {
        while let Some(index) = self.find(list, &is_meant)? {
            self.remove(list, index)?;
        }
        Ok(())
    }

    /// Adds an entry to the end of a list.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn add(&mut self, list: List, entry: &Value) -> Result<(), String> {
        let places = places(&self.0)?;
        let line = format!("  {},", written(entry));
        let text = &mut self.0;
        match (places.of(list), places.entries(list).last()) {
            (_, Some(last)) => {
                let end = last.span().end;
                let comma = text[end..].trim_start();
                let mut at = end;
                if comma.starts_with(',') {
                    at = text.len() - comma.len() + 1;
                } else {
                    text.insert(end, ',');
                    at += 1;
                }
                // A comment behind the last entry stays with it.
                let rest = text[at..].find('\n').map_or(&text[at..], |end| &text[at..at + end]);
                let is_comment = rest.trim_start().starts_with('#') || rest.trim().is_empty();
                let at = if is_comment { at + rest.len() } else { at };
                text.insert_str(at, &format!("\n{line}"));
            }
            (Some(list), None) => {
                let close = list.span().end - 1;
                let before = if text[..close].ends_with('\n') { "" } else { "\n" };
                text.insert_str(close, &format!("{before}{line}\n"));
            }
            (None, None) => {
                let before = if text.is_empty() || text.ends_with("\n\n") { "" } else { "\n" };
                let end = if text.is_empty() || text.ends_with('\n') { "" } else { "\n" };
                let _ = write!(text, "{end}{before}{} = [\n{line}\n]\n", list.key());
            }
        }
        Ok(())
    }

    /// Says how high the rooms are.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn set_height(&mut self, height_m: f32) -> Result<(), String> {
        let height = written(&number(height_m));
        match places(&self.0)?.wall_height_m {
            Some(old) => self.0.replace_range(old.span(), &height),
            None => {
                let _ = write!(self.0, "\nwall_height_m = {height}\n");
            }
        }
        Ok(())
    }
}

fn places(text: &str) -> Result<Places, String> {
    toml::from_str(text).map_err(|error| error.to_string())
}

/// The same plan as the project writes its own files: each entry a line of a list.
fn laid_out(text: &str) -> Result<String, String> {
    let places = places(text)?;
    let mut new = String::new();
    if let Some(base) = &places.base {
        let _ = writeln!(new, "base = {}", Value::String(base.clone()));
    }
    if let Some(height) = &places.wall_height_m {
        let _ = writeln!(new, "wall_height_m = {}", written(height.get_ref()));
    }
    for list in List::ALL.into_iter().filter(|list| places.of(*list).is_some()) {
        let lines = places.entries(list).iter().map(|entry| format!("  {},\n", written(entry.get_ref())));
        let _ = write!(new, "\n{} = [\n{}]\n", list.key(), lines.collect::<String>());
    }
    Ok(new)
}

/// A number of a plan: to the millimetre, and without a sign before 0.
#[must_use]
pub fn number(value: f32) -> Value {
    Value::Float((f64::from(value) * 1000.0).round() / 1000.0 + 0.0)
}

/// Some of them.
#[must_use]
pub fn numbers(values: &[f32]) -> Value {
    Value::Array(values.iter().map(|value| number(*value)).collect())
}

/// A text.
#[must_use]
pub fn string(text: &str) -> Value {
    Value::String(text.to_owned())
}

/// A value in one line.
fn written(value: &Value) -> String {
    match value {
        Value::Table(table) => {
            let rank = |key: &str| KEYS.iter().position(|known| *known == key).unwrap_or(KEYS.len());
            let mut keys: Vec<(&String, &Value)> = table.iter().collect();
            keys.sort_by_key(|(key, _)| rank(key));
            let parts: Vec<String> = keys.iter().map(|(key, value)| format!("{key} = {}", written(value))).collect();
            format!("{{ {} }}", parts.join(", "))
        }
        Value::Array(items) => format!("[{}]", items.iter().map(written).collect::<Vec<_>>().join(", ")),
        Value::Float(number) => format!("{number:?}"),
        other => other.to_string(),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    const PLAN: &str = "# A plan.
placement = [
  # By the door.
  { instance = \"A_1\", room = \"X\", at_m = [1.0, 2.0, 0.0] }, # heavy
  { instance = \"B_1\", room = \"X\" }
]
viewpoint = []
";

    fn entry(name: &str) -> Table {
        let pairs = [("room", string("X")), ("instance", string(name)), ("at_m", numbers(&[0.1, -0.0, 1.0 / 3.0]))];
        pairs.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
    }

    #[test]
    fn what_is_not_changed_stays_as_it_is() {
        let mut text = Entrywise::new(PLAN).unwrap();
        let is = |name: &'static str| move |table: &Table| table["instance"].as_str() == Some(name);
        let index = text.find(List::Placement, is("A_1")).unwrap().unwrap();
        text.set(List::Placement, index, entry("A_1")).unwrap();
        text.add(List::Placement, &Value::Table(entry("C_1"))).unwrap();
        text.add(List::Viewpoint, &Value::Table(entry("D_1"))).unwrap();
        text.add(List::NotePlace, &Value::Table(entry("E_1"))).unwrap();
        let line = |name: &str| format!("{{ instance = \"{name}\", room = \"X\", at_m = [0.1, 0.0, 0.333] }},");
        let expected = format!(
            "# A plan.\nplacement = [\n  # By the door.\n  {} # heavy\n  {{ instance = \"B_1\", room = \"X\" }},\n  {}\n]\n\
             viewpoint = [\n  {}\n]\n\nnote_place = [\n  {}\n]\n",
            line("A_1"),
            line("C_1"),
            line("D_1"),
            line("E_1")
        );
        assert_eq!(text.clone().into_text(), expected);
        text.remove_all(List::Placement, is("A_1")).unwrap();
        text.remove_all(List::Placement, is("C_1")).unwrap();
        let left_text = text.into_text();
        assert!(left_text.contains("# heavy\n  { instance = \"B_1\", room = \"X\" },\n]\nviewpoint"), "{left_text}");
        assert!(!left_text.contains("C_1") && !left_text.contains("A_1"), "{left_text}");
    }

    #[test]
    fn heights_are_written_where_they_stand_or_at_the_end() {
        let mut text = Entrywise::new("wall_height_m = 2.8 # high\nroom = []\n").unwrap();
        text.set_height(2.5).unwrap();
        assert_eq!(text.into_text(), "wall_height_m = 2.5 # high\nroom = []\n");
        let mut text = Entrywise::new("room = []\n").unwrap();
        text.set_height(2.5).unwrap();
        assert_eq!(text.into_text(), "room = []\n\nwall_height_m = 2.5\n");
    }

    #[test]
    fn entries_that_are_tables_of_their_own_become_a_list() {
        let entry = |name: &str| format!("[[placement]]\ninstance = \"{name}\"\nroom = \"X\"\n");
        let text = Entrywise::new(&format!("base = \"P\"\n{}{}", entry("A_1"), entry("B_1")));
        let line = |name: &str| format!("  {{ instance = \"{name}\", room = \"X\" }},\n");
        let expected = format!("base = \"P\"\n\nplacement = [\n{}{}]\n", line("A_1"), line("B_1"));
        assert_eq!(text.unwrap().into_text(), expected);
        assert!(Entrywise::new("room = [").is_err());
    }
}
