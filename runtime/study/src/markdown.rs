//! The Markdown of information sheets, consent forms and debriefings as HTML: headings, paragraphs, lists, strong and
//! emphasised words, code, and links. All else is text; no HTML of the file's own gets through.

/// The same text as HTML. Headings begin at the second level: the page has one above them.
#[must_use]
pub fn html(markdown: &str) -> String {
    let mut html = String::new();
    let mut lines = markdown.lines().peekable();
    while let Some(line) = lines.next() {
        let Some(block) = Block::of(line) else { continue };
        let mut items = vec![block.text(line)];
        // What follows without an empty line, and begins no other block, goes on with the same item.
        while let Some(next) =
            lines.peek().filter(|next| !next.trim().is_empty() && !matches!(block, Block::Heading(_)))
        {
            let text = match Block::of(next) {
                Some(other) if other == block && block != Block::Paragraph => {
                    items.push(other.text(next));
                    lines.next();
                    continue;
                }
                Some(Block::Paragraph) => next.trim(),
                _ => break,
            };
            if let Some(item) = items.last_mut() {
                item.push(' ');
                item.push_str(text);
            }
            lines.next();
        }
        html += &block.html(&items);
    }
    html
}

/// What a line begins.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Block {
    Heading(usize),
    Bullets,
    Numbers,
    Paragraph,
}

impl Block {
    fn of(line: &str) -> Option<Self> {
        let line = line.trim();
        let hashes = line.chars().take_while(|c| *c == '#').count();
        let digits = line.chars().take_while(char::is_ascii_digit).count();
        match line {
            "" => None,
            _ if (1..=6).contains(&hashes) && line[hashes..].starts_with(' ') => Some(Self::Heading(hashes)),
            _ if line.starts_with("- ") || line.starts_with("* ") => Some(Self::Bullets),
            _ if digits > 0 && line[digits..].starts_with(". ") => Some(Self::Numbers),
            _ => Some(Self::Paragraph),
        }
    }

    /// What a line of it says.
    fn text(self, line: &str) -> String {
        let line = line.trim();
        let mark = match self {
            Self::Heading(hashes) => hashes,
            Self::Bullets => 1,
            Self::Numbers => line.find('.').map_or(0, |at| at + 1),
            Self::Paragraph => 0,
        };
        line[mark..].trim().to_owned()
    }

    fn html(self, items: &[String]) -> String {
        let all =
            |tag: &str| -> String { items.iter().map(|item| format!("<{tag}>{}</{tag}>", inline(item))).collect() };
        match self {
            Self::Heading(hashes) => all(&format!("h{}", (hashes + 1).min(6))),
            Self::Bullets => format!("<ul>{}</ul>", all("li")),
            Self::Numbers => format!("<ol>{}</ol>", all("li")),
            Self::Paragraph => all("p"),
        }
    }
}

/// Marks within a line, longest first, and their tags.
const MARKS: [(&str, &str); 3] = [("**", "strong"), ("*", "em"), ("`", "code")];

fn inline(text: &str) -> String {
    let mut html = String::new();
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        if let Some((made, after)) = marked(rest).or_else(|| link(rest)) {
            html += &made;
            rest = after;
        } else {
            html += &escaped(&rest[..c.len_utf8()]);
            rest = &rest[c.len_utf8()..];
        }
    }
    html
}

/// What stands between two marks at the beginning, and what is behind it.
fn marked(text: &str) -> Option<(String, &str)> {
    let (mark, tag) = MARKS.into_iter().find(|(mark, _)| text.starts_with(mark))?;
    let (inner, after) = text[mark.len()..].split_once(mark)?;
    let is_marked = !inner.is_empty() && !inner.starts_with(' ') && !inner.ends_with(' ');
    let made = if tag == "code" { escaped(inner) } else { inline(inner) };
    is_marked.then(|| (format!("<{tag}>{made}</{tag}>"), after))
}

/// `[text](address)` at the beginning, and what is behind it. Addresses are of pages and of mail alone.
fn link(text: &str) -> Option<(String, &str)> {
    let (words, rest) = text.strip_prefix('[')?.split_once("](")?;
    let (address, after) = rest.split_once(')')?;
    let is_safe = ["https://", "http://", "mailto:"].iter().any(|scheme| address.starts_with(scheme));
    let made = format!("<a href=\"{}\" target=\"_blank\" rel=\"noreferrer\">{}</a>", escaped(address), inline(words));
    (is_safe && !words.contains('[')).then_some((made, after))
}

/// Text as HTML has it.
#[must_use]
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;").replace('\'', "&#39;")
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn what_sheets_are_written_in_becomes_html() {
        for (markdown, expected) in [
            ("# Robots\n\nYou talk\nto one.", "<h2>Robots</h2><p>You talk to one.</p>"),
            (
                "- one\n- *two*\n  more\n\n1. a\n2. b",
                "<ul><li>one</li><li><em>two</em> more</li></ul><ol><li>a</li><li>b</li></ol>",
            ),
            (
                "**You** may `stop` <now> & leave.",
                "<p><strong>You</strong> may <code>stop</code> &lt;now&gt; &amp; leave.</p>",
            ),
            (
                "Ask [us](mailto:lab@example.org).",
                "<p>Ask <a href=\"mailto:lab@example.org\" target=\"_blank\" rel=\"noreferrer\">us</a>.</p>",
            ),
            ("[x](javascript:alert(1))", "<p>[x](javascript:alert(1))</p>"),
            ("2 * 3 * 4 and a*", "<p>2 * 3 * 4 and a*</p>"),
            ("Text\n# Head\nmore", "<p>Text</p><h2>Head</h2><p>more</p>"),
        ] {
            assert_eq!(html(markdown), expected, "{markdown}");
        }
    }

    proptest! {
        #[test]
        fn no_tag_of_the_file_gets_through(text in "[<>a-z*`#\\[\\]()&\"' \n.1-]{0,80}") {
            let html = html(&text);
            let own = ["h2", "h3", "h4", "h5", "h6", "p", "ul", "ol", "li", "strong", "em", "code", "a"];
            for part in html.split('<').skip(1) {
                let tag = part.trim_start_matches('/');
                prop_assert!(own.iter().any(|own| tag.strip_prefix(own).is_some_and(|rest| rest.starts_with(['>', ' ']))), "{html}");
            }
        }
    }
}
