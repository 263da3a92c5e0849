//! Text from files and peers on a terminal: nothing in it controls the terminal.
//!
//! All text that this program did not write itself goes through [`shown`] before it is printed: names and titles of missions,
//! names of files and sessions, what people said.

use std::{
    fmt::{self, Display, Write},
    io::{self, Write as _},
};

use anyhow::Context as _;

/// Prints a text at once. It is no failure that nobody reads it any more: whoever reads may have read enough.
pub fn print(text: &str) -> anyhow::Result<()> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(error).context("print to the terminal"),
        _ => Ok(()),
    }
}

/// What `println!` and `print!` of this program do.
pub fn say(text: fmt::Arguments<'_>) {
    tell(&mut io::stdout().lock(), text);
}

/// What its `eprintln!` does.
pub fn warn(text: fmt::Arguments<'_>) {
    tell(&mut io::stderr().lock(), text);
}

/// Writes a text, if somebody still reads; a disk that is full is as bad as ever.
fn tell(out: &mut impl io::Write, text: fmt::Arguments<'_>) {
    match io::Write::write_fmt(out, text) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => panic!("print to the terminal: {error}"),
        _ => {}
    }
}

/// `text` on one line: characters that a terminal obeys or hides are written as escapes.
pub fn shown<T: Display>(text: T) -> Shown<T> {
    Shown { text, form: Form::Line }
}

/// The same of text that may have several lines.
pub fn shown_lines<T: Display>(text: T) -> Shown<T> {
    Shown { text, form: Form::Lines }
}

/// The same of a JSON document, whose meaning stays the same.
pub fn shown_json<T: Display>(text: T) -> Shown<T> {
    Shown { text, form: Form::Json }
}

/// Text as a terminal may have it.
pub struct Shown<T> {
    text: T,
    form: Form,
}

#[derive(Clone, Copy)]
enum Form {
    Line,
    Lines,
    Json,
}

impl<T: Display> Display for Shown<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(Escaping { out: f, form: self.form }, "{}", self.text)
    }
}

struct Escaping<'a, 'f> {
    out: &'a mut fmt::Formatter<'f>,
    form: Form,
}

impl Write for Escaping<'_, '_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for part in text.split_inclusive(is_obeyed) {
            let Some(last) = part.chars().next_back().filter(|last| is_obeyed(*last)) else {
                self.out.write_str(part)?;
                continue;
            };
            self.out.write_str(&part[..part.len() - last.len_utf8()])?;
            match self.form {
                Form::Lines | Form::Json if last == '\n' => self.out.write_char(last)?,
                Form::Line | Form::Lines => write!(self.out, "{}", last.escape_default())?,
                // Within its texts, where alone such characters stand, JSON has them so.
                Form::Json => write!(self.out, "\\u{:04x}", u32::from(last))?,
            }
        }
        Ok(())
    }
}

/// What moves the cursor, changes colours, titles or keys, or turns the order of the letters that follow.
fn is_obeyed(character: char) -> bool {
    character.is_control()
        || matches!(character, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_ends_because_nobody_reads_what_is_said() {
        let (reader, mut writer) = io::pipe().expect("a pipe");
        tell(&mut writer, format_args!("read\n"));
        drop(reader);
        tell(&mut writer, format_args!("not read\n"));
    }

    #[test]
    fn nothing_in_a_text_controls_the_terminal() {
        let title = "\u{1b}]0;owned\u{7}Soup\n\r\u{9b}2J \u{202e}é – 湯";
        assert_eq!(shown(title).to_string(), r"\u{1b}]0;owned\u{7}Soup\n\r\u{9b}2J \u{202e}é – 湯");
        assert_eq!(shown_lines("a\nb\u{1b}[2J\t").to_string(), "a\nb\\u{1b}[2J\\t");
        let json = serde_json::json!({ "title": title });
        let text = shown_json(format!("{json:#}")).to_string();
        assert!(text.chars().all(|character| character == '\n' || !is_obeyed(character)), "{text}");
        assert_eq!(serde_json::from_str::<serde_json::Value>(&text).expect("still JSON"), json);
        for text in ["", "plain", "ends in one\u{7}", "\u{7}"] {
            assert!(!shown(text).to_string().contains(char::is_control), "{text:?}");
        }
    }
}
