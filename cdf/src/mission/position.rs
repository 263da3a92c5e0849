//! Where in a JSON text a value stands: what a parser forgets, and a person who must mend the text wants to know.
//!
//! The text must be JSON already; of anything else this makes some positions or other, but neither fails nor hangs.

use std::{
    collections::BTreeMap,
    ops::{ControlFlow, Range},
};

use super::problem::{Pointer, Problem, Severity};

/// A value in a text, by byte offsets.
#[derive(Clone, Debug, Eq, PartialEq)]
pub(super) struct Span {
    /// Where it begins: a member of an object with its key.
    pub start: usize,
    /// The value alone.
    pub value: Range<usize>,
}

/// Walks through `text`; `each` gets every value but the outermost, with its JSON pointer and how deep that is. Gives the
/// keys that an object has more than once, each with the place of the last.
pub(super) fn walk(text: &str, mut each: impl FnMut(&str, usize, Span)) -> Vec<(Pointer, usize)> {
    walk_while(text, |path, depth, span| {
        each(path, depth, span);
        ControlFlow::Continue(())
    })
}

/// The same, until `each` has seen enough.
pub(super) fn walk_while(
    text: &str,
    mut each: impl FnMut(&str, usize, Span) -> ControlFlow<()>,
) -> Vec<(Pointer, usize)> {
    let mut walker = Walker { text, at: 0, path: String::new(), open: Vec::new(), repeated: Vec::new() };
    while let Some((depth, span)) = walker.step() {
        if each(&walker.path, walker.open.len(), span).is_break() {
            break;
        }
        walker.path.truncate(depth);
    }
    walker.repeated
}

/// Writes into each problem the line and column of what it points at, or of the nearest that is there, and puts them into the
/// order of the text.
pub(super) fn locate(text: &str, problems: &mut Vec<Problem>, file: &str) {
    let mut wanted: BTreeMap<&str, Option<usize>> = BTreeMap::new();
    for problem in problems.iter() {
        let pointer = problem.pointer.as_str();
        wanted.extend(pointer.match_indices('/').map(|(end, _)| (&pointer[..end], None)));
        wanted.insert(pointer, None);
    }
    let repeated = walk(text, |path, _, span| {
        if let Some(place) = wanted.get_mut(path) {
            *place = Some(span.start);
        }
    });
    let lines = Lines::of(text);
    let outermost = text.len() - text.trim_start().len();
    let offsets: Vec<usize> = problems
        .iter()
        .map(|problem| {
            let mut pointer = problem.pointer.as_str();
            loop {
                if let Some(Some(offset)) = wanted.get(pointer) {
                    return *offset;
                }
                match pointer.rsplit_once('/') {
                    Some((parent, _)) => pointer = parent,
                    None => return outermost,
                }
            }
        })
        .collect();
    for (problem, offset) in problems.iter_mut().zip(offsets) {
        problem.position = problem.position.or(Some(lines.position(offset)));
    }
    problems.extend(repeated.into_iter().map(|(pointer, offset)| Problem {
        severity: Severity::Warning,
        file: file.to_owned(),
        position: Some(lines.position(offset)),
        message: format!("`{}` is there more than once; only the last counts", printable(pointer.last())),
        remedy: Some("keep one of them".to_owned()),
        pointer,
    }));
    problems.sort_by_key(|problem| problem.position);
}

/// On one line, whatever a key holds.
fn printable(key: String) -> String {
    key.replace(char::is_control, " ")
}

/// Where the lines of a text begin.
pub(super) struct Lines<'t> {
    text: &'t str,
    starts: Vec<usize>,
    /// How many characters begin before each block of bytes: a file may be one long line with many problems.
    before_block: Vec<usize>,
}

/// Bytes that are counted through to tell a column.
const BLOCK: usize = 4096;

fn characters(bytes: &[u8]) -> usize {
    // All but those that go on with a character.
    bytes.iter().filter(|byte| **byte & 0xc0 != 0x80).count()
}

impl<'t> Lines<'t> {
    pub fn of(text: &'t str) -> Self {
        let starts = std::iter::once(0).chain(text.match_indices('\n').map(|(at, _)| at + 1)).collect();
        let mut before = 0;
        let mut before_block = Vec::with_capacity(text.len() / BLOCK + 1);
        for block in text.as_bytes().chunks(BLOCK) {
            before_block.push(before);
            before += characters(block);
        }
        Self { text, starts, before_block }
    }

    /// Line and column of a byte, both from 1, the column in characters.
    pub fn position(&self, offset: usize) -> (usize, usize) {
        let line = self.starts.partition_point(|start| *start <= offset).max(1);
        let start = self.starts[line - 1];
        let before =
            self.text.is_char_boundary(offset).then(|| self.characters_before(offset) - self.characters_before(start));
        (line, before.unwrap_or(0) + 1)
    }

    /// How many characters are before a byte.
    fn characters_before(&self, offset: usize) -> usize {
        let block = (offset / BLOCK).min(self.before_block.len().saturating_sub(1));
        let before = self.before_block.get(block).copied().unwrap_or(0);
        before + self.text.as_bytes().get(block * BLOCK..offset).map_or(0, characters)
    }

    /// The position of a byte told by its line and its number in the line, both from 1.
    pub fn position_of_byte(&self, line: usize, byte: usize) -> (usize, usize) {
        let start = self.starts.get(line.saturating_sub(1)).copied().unwrap_or(self.text.len());
        let mut offset = (start + byte.saturating_sub(1)).min(self.text.len());
        while !self.text.is_char_boundary(offset) {
            offset -= 1;
        }
        (line, self.position(offset).1)
    }
}

struct Walker<'t> {
    text: &'t str,
    at: usize,
    path: String,
    open: Vec<Open<'t>>,
    repeated: Vec<(Pointer, usize)>,
}

/// An object or a list that is not closed yet.
struct Open<'t> {
    /// Length of the path without it.
    depth: usize,
    span: Span,
    /// The number of the next item, of a list.
    next: Option<usize>,
    /// Keys so far, as they are written, of an object.
    keys: Vec<(&'t str, usize)>,
}

impl<'t> Walker<'t> {
    /// Goes on to the end of the next value; gives the length that its parent's path has, and where it stands.
    fn step(&mut self) -> Option<(usize, Span)> {
        loop {
            self.blanks();
            match self.byte()? {
                b',' => self.at += 1,
                b'}' | b']' => {
                    self.at += 1;
                    let open = self.open.pop()?;
                    self.note_repeated(&open);
                    if self.open.is_empty() {
                        return None;
                    }
                    return Some((open.depth, Span { start: open.span.start, value: open.span.value.start..self.at }));
                }
                _ => {
                    let depth = self.path.len();
                    let start = self.at;
                    if !self.open.is_empty() {
                        self.enter();
                    }
                    let value = self.at;
                    match self.byte()? {
                        byte @ (b'{' | b'[') => {
                            self.at += 1;
                            let next = (byte == b'[').then_some(0);
                            let span = Span { start, value: value..value };
                            self.open.push(Open { depth, span, next, keys: Vec::new() });
                        }
                        byte => {
                            if byte == b'"' {
                                self.string()
                            } else {
                                self.plain()
                            }
                            if self.open.is_empty() {
                                return None;
                            }
                            return Some((depth, Span { start, value: value..self.at }));
                        }
                    }
                }
            }
        }
    }

    /// Puts the item's number, or the member's key, onto the path, and goes on to its value.
    fn enter(&mut self) {
        let Some(open) = self.open.last_mut() else { return };
        self.path.push('/');
        if let Some(next) = &mut open.next {
            self.path.push_str(&next.to_string());
            *next += 1;
            return;
        }
        let start = self.at;
        self.string();
        let key = self.text.get(start + 1..self.at.saturating_sub(1)).unwrap_or_default();
        if let Some(open) = self.open.last_mut() {
            open.keys.push((key, start));
        }
        self.path.push_str(&escaped(&unquoted(key)));
        self.blanks();
        if self.byte() == Some(b':') {
            self.at += 1;
        }
        self.blanks();
    }

    fn note_repeated(&mut self, open: &Open<'t>) {
        let mut keys: Vec<_> = open.keys.iter().map(|(key, at)| (unquoted(key), *at)).collect();
        keys.sort();
        for pair in keys.windows(2) {
            if pair[0].0 == pair[1].0 {
                let parent = Pointer::of(self.path.clone());
                self.repeated.push((parent.key(&pair[1].0), pair[1].1));
            }
        }
    }

    fn byte(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    fn blanks(&mut self) {
        while self.byte().is_some_and(|byte| byte.is_ascii_whitespace()) {
            self.at += 1;
        }
    }

    /// Goes past a string in quotes.
    fn string(&mut self) {
        self.at += 1;
        while let Some(byte) = self.byte() {
            self.at += if byte == b'\\' { 2 } else { 1 };
            if byte == b'"' {
                break;
            }
        }
        self.at = self.at.min(self.text.len());
    }

    /// Goes past a number or a word.
    fn plain(&mut self) {
        let end = |byte: u8| byte.is_ascii_whitespace() || matches!(byte, b',' | b']' | b'}');
        self.at += 1;
        while self.byte().is_some_and(|byte| !end(byte)) {
            self.at += 1;
        }
    }
}

fn unquoted(key: &str) -> String {
    if key.contains('\\') { serde_json::from_str(&format!("\"{key}\"")).unwrap_or_default() } else { key.to_owned() }
}

fn escaped(key: &str) -> String {
    if key.contains(['~', '/']) { key.replace('~', "~0").replace('/', "~1") } else { key.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_has_its_place() {
        let text = " {\"a\": [1, {\"b/c\": \"x\\\"]\"}, [] ],\n \"\\u00e9\" :null} ";
        let mut found = Vec::new();
        let repeated = walk(text, |path, _, span| found.push((path.to_owned(), text[span.value].to_owned())));
        let found: Vec<_> = found.iter().map(|(path, value)| (path.as_str(), value.as_str())).collect();
        let list = "[1, {\"b/c\": \"x\\\"]\"}, [] ]";
        let expected = [
            ("/a/0", "1"),
            ("/a/1/b~1c", "\"x\\\"]\""),
            ("/a/1", "{\"b/c\": \"x\\\"]\"}"),
            ("/a/2", "[]"),
            ("/a", list),
            ("/é", "null"),
        ];
        assert_eq!(found, expected);
        assert_eq!(repeated, []);
    }

    #[test]
    fn keys_that_are_there_twice_are_found() {
        let text = r#"{"a": {"b": 1, "c": 2, "\u0062": 3}, "a": 4}"#;
        let repeated: Vec<_> = walk(text, |_, _, _| {}).into_iter().map(|(at, _)| at.as_str().to_owned()).collect();
        assert_eq!(repeated, ["/a/b", "/a"]);
    }

    #[test]
    fn positions_count_characters() {
        let text = "{\"é\": 1,\n\"bb\": 2}";
        let lines = Lines::of(text);
        assert_eq!(lines.position(0), (1, 1));
        assert_eq!(lines.position(text.find('1').unwrap_or_default()), (1, 7));
        assert_eq!(lines.position(text.find("bb").unwrap_or_default()), (2, 2));
        assert_eq!(lines.position_of_byte(1, 8), (1, 7));
        let long = format!("\n{}x", "\u{e9}y".repeat(BLOCK));
        for characters in [0, 1, 2, BLOCK / 2, BLOCK, BLOCK + 1, 2 * BLOCK] {
            let offset = 1 + long[1..].chars().take(characters).map(char::len_utf8).sum::<usize>();
            assert_eq!(Lines::of(&long).position(offset), (2, characters + 1));
        }
        assert_eq!(lines.position_of_byte(9, 9), (9, 9).min((9, lines.position(text.len()).1)));
    }

    #[test]
    fn what_is_no_json_makes_no_trouble() {
        for text in ["", "{", "]", "{\"a", "{\"a\\", "[1,,2", "{{{{", "}{", "\"", "é", "{1:2", "[\"\\"] {
            walk(text, |_, _, _| {});
        }
    }
}
