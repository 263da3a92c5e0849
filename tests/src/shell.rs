//! Command lines as a shell reads them, as far as those of README and guide need it.

/// A call of this program.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Call {
    /// The variables that are set for it.
    pub variables: Vec<(String, String)>,
    /// Its arguments.
    pub arguments: Vec<String>,
}

/// How README starts the program before it is built.
const BY_CARGO: [&str; 4] = ["cargo", "run", "--release", "--"];

impl Call {
    /// What a command gives this program; `None`, if it starts another one.
    #[must_use]
    pub fn of(words: &[String]) -> Option<Self> {
        let variables: Vec<_> = words.iter().map_while(|word| variable(word)).collect();
        let words = &words[variables.len()..];
        let is_by_cargo = words.len() >= BY_CARGO.len() && words.iter().zip(BY_CARGO).all(|(word, part)| word == part);
        let begin = if is_by_cargo { BY_CARGO.len() } else { 1 };
        let is_own = is_by_cargo || words.first().is_some_and(|program| program == "cohabit");
        is_own.then(|| Self { variables, arguments: words[begin..].to_vec() })
    }

    /// Whether an option is among the arguments, by its name with dashes.
    #[must_use]
    pub fn has(&self, option: &str) -> bool {
        self.arguments.iter().any(|argument| argument.split('=').next() == Some(option))
    }

    /// The value of an option.
    #[must_use]
    pub fn value(&self, option: &str) -> Option<&str> {
        let at = self.arguments.iter().position(|argument| argument.split('=').next() == Some(option))?;
        match self.arguments[at].split_once('=') {
            Some((_, value)) => Some(value),
            None => self.arguments.get(at + 1).map(String::as_str),
        }
    }
}

/// An assignment to a variable before a command, such as `COHABIT_MODEL=m`.
fn variable(word: &str) -> Option<(String, String)> {
    let (name, value) = word.split_once('=')?;
    name.starts_with("COHABIT_").then(|| (name.to_owned(), value.to_owned()))
}

/// A line as this program is called in it once it is installed.
#[must_use]
pub fn installed(line: &str) -> String {
    line.replace(&BY_CARGO.join(" "), "cohabit")
}

/// The commands of a line, each as its words. Understands quotes, comments, `&`, `;` and `|`, and no more of a shell; what stands
/// behind `>` counts as a command, too.
#[must_use]
pub fn commands(line: &str) -> Vec<Vec<String>> {
    let mut commands: Vec<Vec<String>> = vec![Vec::new()];
    let (mut word, mut quote): (Option<String>, Option<char>) = (None, None);
    for letter in line.chars() {
        match (quote, letter) {
            (Some(open), _) if open == letter => quote = None,
            (Some(_), _) => word.get_or_insert_default().push(letter),
            (None, '\'' | '"') => {
                quote = Some(letter);
                word.get_or_insert_default();
            }
            (None, '#') if word.is_none() => break,
            (None, ' ' | '&' | ';' | '|' | '>') => {
                let done = word.take();
                if let Some(last) = commands.last_mut() {
                    last.extend(done);
                }
                if letter != ' ' {
                    commands.push(Vec::new());
                }
            }
            (None, _) => word.get_or_insert_default().push(letter),
        }
    }
    if let Some(last) = commands.last_mut() {
        last.extend(word);
    }
    commands.retain(|words| !words.is_empty());
    commands
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_read_as_a_shell_reads_them() {
        for (line, expected) in [
            ("cohabit play  # it starts", vec![vec!["cohabit", "play"]]),
            ("cohabit play --name 'a b' \"c#d\" e#f", vec![vec!["cohabit", "play", "--name", "a b", "c#d", "e#f"]]),
            ("a & b; c | d", vec![vec!["a"], vec!["b"], vec!["c"], vec!["d"]]),
            ("a b > c", vec![vec!["a", "b"], vec!["c"]]),
            ("a ''", vec![vec!["a", ""]]),
            ("# nothing", vec![]),
        ] {
            assert_eq!(commands(line), expected, "{line}");
        }
    }

    #[test]
    fn calls_of_the_program_are_told_from_others() {
        let call = |line: &str| Call::of(&commands(line)[0]);
        let arguments = |line: &str| call(line).map(|call| call.arguments.join(" "));
        assert_eq!(arguments("COHABIT_MODEL=m cohabit play"), Some("play".to_owned()));
        assert_eq!(arguments("cargo run --release -- play --seed 1"), Some("play --seed 1".to_owned()));
        assert_eq!(arguments("cargo test -p cohabit"), None);
        assert_eq!(installed("cargo run --release -- play   # it starts"), "cohabit play   # it starts");
        let call = call("COHABIT_MODEL=m cohabit play --log a.mcap --seed=3").unwrap();
        assert_eq!(call.variables, [("COHABIT_MODEL".to_owned(), "m".to_owned())]);
        assert!(call.has("--seed") && call.has("--log") && !call.has("--lo"));
        let values = ["--log", "--seed", "--port"].map(|option| call.value(option));
        assert_eq!(values, [Some("a.mcap"), Some("3"), None]);
    }
}
