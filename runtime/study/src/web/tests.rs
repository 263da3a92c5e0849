use super::*;

#[test]
fn notes_are_shown_with_their_day() {
    let script = FILES.iter().find(|(path, ..)| *path == "/experimenter.js").map(|(.., text)| *text).unwrap();
    assert!(script.contains("new Date(at_ms).toLocaleString()"), "a study takes longer than a day");
}

#[test]
fn whose_link_is_not_known_reads_whom_to_ask() {
    let contact = "Ada <ada@example.org>".to_owned();
    for (language, title) in [("en", "This link is not known"), ("de", "Dieser Link ist nicht bekannt")] {
        let page_texts = PageTexts::of(language).unwrap();
        let page = strangers_page(&Study { contact: contact.clone(), page_texts, ..Study::default() });
        assert!(page.contains("Ada &lt;ada@example.org&gt;") && !page.contains('{'), "{page}");
        assert!(page.contains(title) && page.contains(&format!("<html lang=\"{language}\">")), "{page}");
    }
}
