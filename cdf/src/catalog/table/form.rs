//! How conditions and changes are written: forms, of which texts are read and lists are printed.

/// How something is written, what it means, and what comes of the words in the places of those in capitals.
pub(super) type Form<T> = (&'static str, &'static str, fn(&[&str]) -> Option<T>);

/// What is written in one of these forms.
pub(super) fn read<T>(forms: &[Form<T>], words: &[&str]) -> Option<T> {
    forms.iter().find_map(|(form, _, read)| read(&filled(form, words)?))
}

/// The words that stand in the places of those in capitals; `None` if the words are not of that form.
fn filled<'w>(form: &str, words: &[&'w str]) -> Option<Vec<&'w str>> {
    if form.split(' ').count() != words.len() {
        return None;
    }
    let mut filled = Vec::new();
    for (part, word) in form.split(' ').zip(words) {
        if is_place(part) {
            filled.push(*word);
        } else if part != *word {
            return None;
        }
    }
    Some(filled)
}

/// Whether a word of a form stands for another one.
pub(super) fn is_place(part: &str) -> bool {
    part.starts_with(|first: char| first.is_ascii_uppercase())
}
