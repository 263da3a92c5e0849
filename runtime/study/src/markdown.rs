//! The Markdown of information sheets, consent forms and debriefings as HTML. No HTML of the file's own gets through: it is
//! shown as the text that it is. Links lead to pages and mail alone, and pictures are their descriptions.

use pulldown_cmark::{CodeBlockKind, Event, HeadingLevel, Options, Parser, Tag, TagEnd, html::push_html};

/// Where a link may lead.
const SCHEMES: [&str; 3] = ["https://", "http://", "mailto:"];

/// The same text (CommonMark) as HTML. Headings begin at the second level: the page has one above them.
#[must_use]
pub fn html(markdown: &str) -> String {
    let mut is_in_link = false;
    let events = Parser::new_ext(markdown, Options::empty()).filter_map(|event| shown(event, &mut is_in_link));
    let mut html = String::new();
    push_html(&mut html, events);
    html
}

/// What is shown of a piece of the text; links do not lie in each other, so it is enough to know whether one is open.
fn shown<'a>(event: Event<'a>, is_in_link: &mut bool) -> Option<Event<'a>> {
    Some(match event {
        Event::Html(text) | Event::InlineHtml(text) => Event::Text(text),
        Event::Start(Tag::HtmlBlock) => Event::Start(Tag::Paragraph),
        Event::End(TagEnd::HtmlBlock) => Event::End(TagEnd::Paragraph),
        Event::Start(Tag::Image { .. }) | Event::End(TagEnd::Image) => return None,
        Event::Start(Tag::Link { dest_url, .. }) => {
            *is_in_link = SCHEMES.iter().any(|scheme| dest_url.starts_with(scheme));
            let open = format!("<a href=\"{}\" target=\"_blank\" rel=\"noreferrer\">", escaped(&dest_url));
            is_in_link.then(|| Event::InlineHtml(open.into()))?
        }
        Event::End(TagEnd::Link) => std::mem::take(is_in_link).then(|| Event::InlineHtml("</a>".into()))?,
        Event::Start(Tag::Heading { level, .. }) => {
            Event::Start(Tag::Heading { level: below(level), id: None, classes: Vec::new(), attrs: Vec::new() })
        }
        Event::End(TagEnd::Heading(level)) => Event::End(TagEnd::Heading(below(level))),
        Event::Start(Tag::CodeBlock(_)) => Event::Start(Tag::CodeBlock(CodeBlockKind::Indented)),
        other => other,
    })
}

fn below(level: HeadingLevel) -> HeadingLevel {
    HeadingLevel::try_from(level as usize + 1).unwrap_or(level)
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
            ("# Robots\n\nYou talk\nto one.", "<h2>Robots</h2>\n<p>You talk\nto one.</p>\n"),
            ("- one\n- *two*\n  more\n", "<ul>\n<li>one</li>\n<li><em>two</em>\nmore</li>\n</ul>\n"),
            ("1. a\n   - b\n2. c", "<ol>\n<li>a\n<ul>\n<li>b</li>\n</ul>\n</li>\n<li>c</li>\n</ol>\n"),
            ("**You** may `stop` & leave.", "<p><strong>You</strong> may <code>stop</code> &amp; leave.</p>\n"),
            ("A <b>bold</b> word", "<p>A &lt;b&gt;bold&lt;/b&gt; word</p>\n"),
            ("<script>\nalert(1)\n</script>", "<p>&lt;script&gt;\nalert(1)\n&lt;/script&gt;</p>\n"),
            (
                "Ask [us](mailto:lab@example.org).",
                "<p>Ask <a href=\"mailto:lab@example.org\" target=\"_blank\" rel=\"noreferrer\">us</a>.</p>\n",
            ),
            (
                "[*x*](https://a.org/?b=1&c=\"2\")",
                "<p><a href=\"https://a.org/?b=1&amp;c=&quot;2&quot;\" target=\"_blank\" rel=\"noreferrer\"><em>x</em></a></p>\n",
            ),
            ("[x](javascript:alert(1)) <javascript:y>", "<p>x javascript:y</p>\n"),
            ("![a robot](robot.png)", "<p>a robot</p>\n"),
            ("2 * 3 * 4 and a*", "<p>2 * 3 * 4 and a*</p>\n"),
            ("###### Head\nmore", "<h6>Head</h6>\n<p>more</p>\n"),
        ] {
            assert_eq!(html(markdown), expected, "{markdown}");
        }
    }

    proptest! {
        #[test]
        fn no_tag_of_the_file_gets_through(text in "[<>a-z!*`#\\[\\]()&\"' \n.1/:-]{0,80}") {
            const OWN: [&str; 17] = [
                "h2", "h3", "h4", "h5", "h6", "p", "ul", "ol", "li", "strong", "em", "code", "pre", "a", "hr", "br", "blockquote",
            ];
            let html = html(&text);
            for part in html.split('<').skip(1) {
                let tag = part.trim_start_matches('/');
                let is_own = |own: &&str| tag.strip_prefix(*own).is_some_and(|rest| rest.starts_with(['>', ' ']));
                prop_assert!(OWN.iter().any(is_own), "{html}");
            }
        }
    }
}
