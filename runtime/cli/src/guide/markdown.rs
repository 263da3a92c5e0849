//! The Markdown of pages as HTML. Headings have names that links lead to, and links lead to where the guide serves what
//! they mean. HTML of a page's own does not get through: it is shown as the text that it is.

use pulldown_cmark::{CowStr, Event, HeadingLevel, Options, Parser, Tag, TagEnd, html::push_html};

use super::book::{Target, from_root, picture_address, target};

/// What is wider than the page is scrolled by itself, also by the keyboard.
const WIDE: &str = "<div class=\"wide\" tabindex=\"0\">";

/// A heading of a page.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Heading {
    /// Its level.
    pub level: HeadingLevel,
    /// Its text, without marks.
    pub text: String,
}

impl Heading {
    /// What a link to it has behind the `#`: small letters and figures, with a hyphen for each space, as GitHub has it.
    pub fn anchor(&self) -> String {
        let is_kept = |letter: &char| letter.is_alphanumeric() || matches!(letter, ' ' | '-' | '_');
        let kept = self.text.chars().filter(is_kept).flat_map(char::to_lowercase);
        kept.map(|letter| if letter == ' ' { '-' } else { letter }).collect()
    }
}

/// The pieces of a text.
pub fn events(markdown: &str) -> impl Iterator<Item = Event<'_>> {
    Parser::new_ext(markdown, Options::ENABLE_TABLES)
}

/// The headings of a page, in their order.
pub fn headings(markdown: &str) -> Vec<Heading> {
    let mut headings: Vec<Heading> = Vec::new();
    let mut is_within = false;
    for event in events(markdown) {
        match event {
            Event::Start(Tag::Heading { level, .. }) => {
                headings.push(Heading { level, text: String::new() });
                is_within = true;
            }
            Event::End(TagEnd::Heading(_)) => is_within = false,
            Event::Text(text) | Event::Code(text) if is_within => {
                if let Some(heading) = headings.last_mut() {
                    heading.text.push_str(&text);
                }
            }
            _ => {}
        }
    }
    headings
}

/// A page, or a part of one, as HTML.
pub fn html(markdown: &str) -> String {
    let mut anchors = headings(markdown).into_iter().map(|heading| CowStr::from(heading.anchor()));
    let mut shown = Vec::new();
    let mut link_end = None;
    for event in events(markdown) {
        match event {
            Event::Html(text) | Event::InlineHtml(text) => shown.push(Event::Text(text)),
            Event::Start(Tag::HtmlBlock) => shown.push(Event::Start(Tag::Paragraph)),
            Event::End(TagEnd::HtmlBlock) => shown.push(Event::End(TagEnd::Paragraph)),
            Event::Start(Tag::Heading { level, .. }) => {
                let heading = Tag::Heading { level, id: anchors.next(), classes: Vec::new(), attrs: Vec::new() };
                shown.push(Event::Start(heading));
            }
            Event::Start(Tag::Link { link_type, dest_url, title, id }) => match target(&dest_url) {
                Target::Page(address) | Target::Heading(address) | Target::Site(address) => {
                    let dest_url = CowStr::from(address);
                    shown.push(Event::Start(Tag::Link { link_type, dest_url, title, id }));
                }
                Target::Source(path) => link_end = Some(path),
            },
            Event::End(TagEnd::Link) => match link_end.take() {
                Some(path) => shown.extend([Event::Text(" ".into()), Event::Code(path.into())]),
                None => shown.push(Event::End(TagEnd::Link)),
            },
            Event::Start(Tag::Image { link_type, dest_url, title, id }) => {
                let dest_url = CowStr::from(picture_address(&from_root(&dest_url)));
                shown.push(Event::Start(Tag::Image { link_type, dest_url, title, id }));
            }
            Event::Start(Tag::Table(alignments)) => {
                shown.extend([Event::Html(WIDE.into()), Event::Start(Tag::Table(alignments))]);
            }
            Event::End(TagEnd::Table) => {
                shown.extend([Event::End(TagEnd::Table), Event::Html("</div>\n".into())]);
            }
            Event::Start(Tag::CodeBlock(_)) => shown.push(Event::Html("<pre tabindex=\"0\"><code>".into())),
            Event::End(TagEnd::CodeBlock) => shown.push(Event::Html("</code></pre>\n".into())),
            other => shown.push(other),
        }
    }
    let mut html = String::new();
    push_html(&mut html, shown.into_iter());
    html
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pages_become_html() {
        for (markdown, expected) in [
            ("# Run a study", "<h1 id=\"run-a-study\">Run a study</h1>\n"),
            (
                "## Who? `--ask`, and _when_",
                "<h2 id=\"who---ask-and-when\">Who? <code>--ask</code>, and <em>when</em></h2>\n",
            ),
            ("[A](study.md)", "<p><a href=\"/study\">A</a></p>\n"),
            ("[A](study.md#b)", "<p><a href=\"/study#b\">A</a></p>\n"),
            ("[A](#b)", "<p><a href=\"#b\">A</a></p>\n"),
            ("[A](https://a.org/?b=1&c)", "<p><a href=\"https://a.org/?b=1&amp;c\">A</a></p>\n"),
            ("[The map](../../ARCHITECTURE.md).", "<p>The map <code>runtime/ARCHITECTURE.md</code>.</p>\n"),
            ("[x](javascript:y)", "<p>x <code>runtime/guide/src/javascript:y</code></p>\n"),
            (
                "![A page](../../../dialog/pictures/page.jpg)",
                "<p><img src=\"/pictures/page.jpg\" alt=\"A page\" /></p>\n",
            ),
            ("A <b>bold</b> word", "<p>A &lt;b&gt;bold&lt;/b&gt; word</p>\n"),
            ("<script>\nalert(1)\n</script>", "<p>&lt;script&gt;\nalert(1)\n&lt;/script&gt;</p>\n"),
            ("```sh\na < b\n```", "<pre tabindex=\"0\"><code>a &lt; b\n</code></pre>\n"),
            (
                "```sh not-run: needs a network\na\n```\n```toml a.toml\nb\n```",
                "<pre tabindex=\"0\"><code>a\n</code></pre>\n<pre tabindex=\"0\"><code>b\n</code></pre>\n",
            ),
            (
                "| a |\n|---|\n| b |",
                "<div class=\"wide\" tabindex=\"0\"><table><thead><tr><th>a</th></tr></thead><tbody>\n<tr><td>b</td></tr>\n</tbody></table>\n</div>\n",
            ),
        ] {
            assert_eq!(html(markdown), expected, "{markdown}");
        }
    }
}
