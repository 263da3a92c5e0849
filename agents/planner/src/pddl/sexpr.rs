//! S-expressions: lists in brackets, of which PDDL files and plans are made.

/// An expression.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum Sexpr {
    /// A word, in lower case: PDDL tells no cases apart; and the line on which it stands, from 1.
    Word(String, usize),
    /// A list, and the line on which it begins, from 1.
    List(Vec<Self>, usize),
}

/// Brackets that do not match.
#[derive(Clone, Debug, thiserror::Error, Eq, PartialEq)]
#[error("line {line}: {reason}")]
pub struct SexprError {
    /// Where, from 1.
    pub line: usize,
    /// What is wrong.
    pub reason: &'static str,
}

impl Sexpr {
    /// Reads all expressions of a text; what follows a `;` in a line is a remark.
    ///
    /// # Errors
    /// [`SexprError`].
    pub fn read(text: &str) -> Result<Vec<Self>, SexprError> {
        let mut all = Vec::new();
        let mut open: Vec<(Vec<Self>, usize)> = Vec::new();
        let lines = (1_usize..).zip(text.lines());
        for (line, token) in lines.flat_map(|(line, text)| tokens(text).map(move |token| (line, token))) {
            match token {
                "(" => open.push((Vec::new(), line)),
                ")" => {
                    let (list, began) =
                        open.pop().ok_or(SexprError { line, reason: "a bracket is closed that was never opened" })?;
                    innermost(&mut open, &mut all).push(Self::List(list, began));
                }
                word => innermost(&mut open, &mut all).push(Self::Word(word.to_lowercase(), line)),
            }
        }
        match open.pop() {
            Some((_, line)) => Err(SexprError { line, reason: "this bracket is never closed" }),
            None => Ok(all),
        }
    }

    /// The word, if it is one.
    #[must_use]
    pub fn word(&self) -> Option<&str> {
        match self {
            Self::Word(word, _) => Some(word),
            Self::List(..) => None,
        }
    }

    /// The expressions in it; none in a word.
    #[must_use]
    pub fn list(&self) -> &[Self] {
        match self {
            Self::Word(..) => &[],
            Self::List(list, _) => list,
        }
    }

    /// The first word of a list.
    #[must_use]
    pub fn head(&self) -> Option<&str> {
        self.list().first().and_then(Self::word)
    }
}

/// The list that is being read, or all that was.
fn innermost<'a>(open: &'a mut [(Vec<Sexpr>, usize)], all: &'a mut Vec<Sexpr>) -> &'a mut Vec<Sexpr> {
    match open.last_mut() {
        Some((list, _)) => list,
        None => all,
    }
}

/// The brackets and words of a line.
fn tokens(line: &str) -> impl Iterator<Item = &str> {
    let code = line.split(';').next().unwrap_or_default();
    code.split_whitespace().flat_map(|piece| piece.split_inclusive(['(', ')'])).flat_map(|part| {
        let (word, bracket) = match part.char_indices().next_back() {
            Some((at, '(' | ')')) => part.split_at(at),
            _ => (part, ""),
        };
        [word, bracket].into_iter().filter(|token| !token.is_empty())
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn printed(all: &[Sexpr]) -> String {
        let one = |one: &Sexpr| match one {
            Sexpr::Word(word, _) => word.clone(),
            Sexpr::List(list, _) => format!("({})", printed(list)),
        };
        all.iter().map(one).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn lists_are_read_as_they_nest() {
        for (text, whole) in [
            ("(a (b c)(d))", "(a (b c) (d))"),
            ("a ; (remark\n(B\n  c)", "a (b c)"),
            ("((x)y)z", "((x) y) z"),
            ("", ""),
            ("()", "()"),
        ] {
            assert_eq!(printed(&Sexpr::read(text).unwrap()), whole, "{text}");
        }
        let all = Sexpr::read("\n(a\n(b))").unwrap();
        assert_eq!(all[0].head(), Some("a"));
        assert!(matches!(all[0].list()[1], Sexpr::List(_, 3)));
    }

    #[test]
    fn brackets_that_do_not_match_are_named_by_line() {
        for (text, line) in [("(a\n(b)", 1), ("(a)\n)", 2), ("x (\n(y", 2)] {
            assert_eq!(Sexpr::read(text).unwrap_err().line, line, "{text}");
        }
    }
}
