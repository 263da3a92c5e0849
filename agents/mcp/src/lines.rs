//! The lines that a client writes, of bounded length.

use std::{
    io::{self, BufRead, ErrorKind},
    sync::mpsc::{Receiver, SyncSender, sync_channel},
    thread,
};

use crate::limits::{LONGEST_LINE, MOST_LINES};

/// A line, without its end.
#[derive(Clone, Debug, Eq, PartialEq)]
pub(crate) enum Line {
    /// All of it.
    Whole(Vec<u8>),
    /// It was longer than any that is taken; nothing of it is kept.
    TooLong,
}

/// The lines of an input as they come, read by a thread of its own; they end with the input.
pub(crate) fn lines(input: impl BufRead + Send + 'static) -> Receiver<Line> {
    let (sender, lines) = sync_channel(MOST_LINES);
    thread::spawn(move || read(input, &sender));
    lines
}

fn read(mut input: impl BufRead, to: &SyncSender<Line>) {
    loop {
        match next(&mut input) {
            Ok(Some(line)) => {
                if to.send(line).is_err() {
                    return;
                }
            }
            Ok(None) => return,
            Err(error) => {
                tracing::warn!("the client's messages cannot be read any more: {error}");
                return;
            }
        }
    }
}

/// The next line; none at the end of the input.
fn next(input: &mut impl BufRead) -> io::Result<Option<Line>> {
    let (mut line, mut is_too_long, mut is_begun) = (Vec::new(), false, false);
    loop {
        let part = match input.fill_buf() {
            Err(error) if error.kind() == ErrorKind::Interrupted => continue,
            part => part?,
        };
        if part.is_empty() {
            return Ok(is_begun.then(|| ended(line, is_too_long)));
        }
        is_begun = true;
        let end = part.iter().position(|byte| *byte == b'\n');
        let own = &part[..end.unwrap_or(part.len())];
        is_too_long |= line.len() + own.len() > LONGEST_LINE;
        if is_too_long {
            line = Vec::new();
        } else {
            line.extend_from_slice(own);
        }
        let used = end.map_or(part.len(), |end| end + 1);
        input.consume(used);
        if end.is_some() {
            return Ok(Some(ended(line, is_too_long)));
        }
    }
}

fn ended(line: Vec<u8>, is_too_long: bool) -> Line {
    if is_too_long { Line::TooLong } else { Line::Whole(line) }
}

#[cfg(test)]
mod tests {
    use std::io::{BufReader, Cursor};

    use super::*;

    fn whole(text: &str) -> Line {
        Line::Whole(text.as_bytes().to_vec())
    }

    /// The lines of a text that is read a few bytes at a time.
    fn check(text: Vec<u8>, expected: &[Line]) {
        let input = BufReader::with_capacity(7, Cursor::new(text));
        assert_eq!(lines(input).iter().collect::<Vec<_>>(), expected);
    }

    #[test]
    fn lines_are_read_up_to_the_end() {
        check(Vec::new(), &[]);
        check(b"one\n".to_vec(), &[whole("one")]);
        check(b"one\n\nthree, which is longer".to_vec(), &[whole("one"), whole(""), whole("three, which is longer")]);
    }

    #[test]
    fn a_line_that_is_too_long_is_passed_over_and_the_next_one_read() {
        let longest = vec![b'a'; LONGEST_LINE];
        let text = [longest.as_slice(), b"\n", longest.as_slice(), b"b\nnext\n"].concat();
        check(text, &[Line::Whole(longest), Line::TooLong, whole("next")]);
    }
}
