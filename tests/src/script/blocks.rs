//! The blocks of a page, and what is to be done with each.

/// What is to be done with a block.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum Role {
    /// Its lines are typed. With a need, only where that is there.
    Typed {
        /// Such as `python`.
        needs: Option<String>,
    },
    /// Nothing, for a reason.
    NotRun(String),
    /// It is the whole of a file.
    File(String),
    /// It is added to the end of a file.
    AddedTo(String),
    /// It is a part of a file that is there.
    PartOf(String),
    /// It is shown, and no more.
    Shown,
}

/// A block of a page.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Block {
    /// The line of the page that begins it, from 1.
    pub line: usize,
    /// Its language.
    pub language: String,
    /// What is to be done with it.
    pub role: Role,
    /// Its text.
    pub text: String,
}

/// What begins and ends a block.
const FENCE: &str = "```";
/// The language of command lines.
const SHELL: &str = "sh";
/// Languages of blocks that need say nothing of themselves.
const PLAIN: [&str; 2] = ["text", "bibtex"];

impl Block {
    /// The command lines of a block that is typed, each with its line of the page. A line that ends with `\` goes on in the
    /// next one.
    #[must_use]
    pub fn commands(&self) -> Vec<(usize, String)> {
        let mut commands: Vec<(usize, String)> = Vec::new();
        let mut goes_on = false;
        for (number, line) in (self.line + 1..).zip(self.text.lines()) {
            let (line, is_open) = line.strip_suffix('\\').map_or((line, false), |line| (line, true));
            match commands.last_mut().filter(|_| goes_on) {
                Some((_, whole)) => whole.push_str(line),
                None => commands.push((number, line.to_owned())),
            }
            goes_on = is_open;
        }
        commands.retain(|(_, line)| !line.trim().is_empty());
        commands
    }

    /// The file that the block is, or is of.
    #[must_use]
    pub fn file(&self) -> Option<&str> {
        match &self.role {
            Role::File(name) | Role::AddedTo(name) | Role::PartOf(name) => Some(name),
            Role::Typed { .. } | Role::NotRun(_) | Role::Shown => None,
        }
    }

    /// Whether its lines are for a shell.
    #[must_use]
    pub fn is_of_shell(&self) -> bool {
        self.language == SHELL
    }
}

/// The blocks of a page, in their order.
///
/// # Errors
/// What the first line says that begins a block and makes no sense.
pub fn blocks(markdown: &str) -> Result<Vec<Block>, String> {
    let mut blocks: Vec<Block> = Vec::new();
    let mut is_open = false;
    for (number, line) in (1..).zip(markdown.lines()) {
        match (line.strip_prefix(FENCE), is_open) {
            (Some(_), true) => is_open = false,
            (Some(info), false) => {
                let (language, note) = info.split_once(' ').unwrap_or((info, ""));
                let role = role(language, note.trim()).map_err(|wrong| format!("line {number}: {wrong}"))?;
                blocks.push(Block { line: number, language: language.to_owned(), role, text: String::new() });
                is_open = true;
            }
            (None, true) => {
                if let Some(block) = blocks.last_mut() {
                    block.text.push_str(line);
                    block.text.push('\n');
                }
            }
            (None, false) => {}
        }
    }
    if is_open { Err(format!("its last block is not ended by {FENCE}")) } else { Ok(blocks) }
}

/// What the words behind a block's language say.
fn role(language: &str, note: &str) -> Result<Role, String> {
    let is_of_shell = language == SHELL;
    let (key, value) = note.split_once(':').map_or(("", note), |(key, value)| (key, value.trim()));
    let is_wrong = |why: &str| Err(format!("a block of `{language}` with `{note}`: {why}"));
    match (key, value) {
        ("not-run", "") => is_wrong("say why it is not run: `not-run: REASON`"),
        ("not-run", reason) => Ok(Role::NotRun(reason.to_owned())),
        ("", "") if is_of_shell => Ok(Role::Typed { needs: None }),
        ("needs", name) if is_of_shell && is_word(name) => Ok(Role::Typed { needs: Some(name.to_owned()) }),
        _ if is_of_shell => is_wrong("write `not-run: REASON`, `needs: NAME`, or nothing"),
        ("", "") if PLAIN.contains(&language) => Ok(Role::Shown),
        ("", name) if is_word(name) => Ok(Role::File(name.to_owned())),
        ("added-to", name) if is_word(name) => Ok(Role::AddedTo(name.to_owned())),
        ("part-of", name) if is_word(name) => Ok(Role::PartOf(name.to_owned())),
        _ => is_wrong("name its file, or write `added-to: FILE`, `part-of: FILE` or `not-run: REASON`"),
    }
}

fn is_word(text: &str) -> bool {
    !text.is_empty() && !text.contains(char::is_whitespace)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn blocks_say_what_they_are() {
        let check = |info: &str, expected: Role| {
            let page = format!("# A page\n\n```{info}\na\n```\n");
            let found = blocks(&page).unwrap();
            assert_eq!((found.len(), found[0].line, found[0].text.as_str()), (1, 3, "a\n"), "{info}");
            assert_eq!(found[0].role, expected, "{info}");
        };
        let typed = |needs: Option<&str>| Role::Typed { needs: needs.map(str::to_owned) };
        check("sh", typed(None));
        check("sh needs: python", typed(Some("python")));
        check("sh not-run: needs a network", Role::NotRun("needs a network".to_owned()));
        check("toml study.toml", Role::File("study.toml".to_owned()));
        check("toml added-to: study.toml", Role::AddedTo("study.toml".to_owned()));
        check("toml part-of: my-lab/world.toml", Role::PartOf("my-lab/world.toml".to_owned()));
        check("text walk.txt", Role::File("walk.txt".to_owned()));
        check("rust not-run: a part of a program", Role::NotRun("a part of a program".to_owned()));
        check("text", Role::Shown);
        check("bibtex", Role::Shown);
    }

    #[test]
    fn blocks_that_say_nothing_of_use_are_refused() {
        let check = |info: &str, expected: &str| {
            let problem = blocks(&format!("```{info}\n```\n")).unwrap_err();
            assert!(problem.starts_with("line 1: ") && problem.contains(expected), "{info}: {problem}");
        };
        check("sh not-run:", "say why");
        check("toml not-run: ", "say why");
        check("sh not-run", "`not-run: REASON`");
        check("sh study.toml", "`needs: NAME`");
        check("sh needs:", "`needs: NAME`");
        check("toml", "name its file");
        check("toml added-to:", "name its file");
        check("python two words", "name its file");
        check("", "name its file");
        assert!(blocks("```sh\na\n").unwrap_err().contains("not ended"));
    }

    #[test]
    fn a_command_may_take_several_lines() {
        let found = blocks("```sh\na \\\n  b\n\nc\n```\n").unwrap();
        assert_eq!(found[0].commands(), [(2, "a   b".to_owned()), (5, "c".to_owned())]);
    }
}
