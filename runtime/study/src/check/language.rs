//! In which language the pages of participants are.

use cohabit_cdf::mission::Pointer;
use cohabit_dialog::{PageTexts, PageTextsError, languages};

use super::Checking;
use crate::written::Written;

impl Checking<'_, '_> {
    /// The texts of participants' pages, and the file that they lie in, if the study has its own; none, if it names none, or
    /// what is wrong was said.
    pub(super) fn page_texts(&mut self, written: &Written) -> Option<(PageTexts, Option<String>)> {
        let root = Pointer::default();
        match (&written.language, &written.page_texts) {
            (Some(_), Some(file)) => {
                let message = "participants' pages are in a language that ships, or in one of a file, not both";
                self.findings.add(file.span(), &root.key("page_texts"), message, "keep one of them");
                None
            }
            (Some(language), None) => PageTexts::of(language.get_ref()).ok().map(|texts| (texts, None)).or_else(|| {
                let message = format!("there is no page in the language `{}`", language.get_ref());
                let remedy = format!(
                    "choose {}, or write its texts into a file, and name that as `page_texts`",
                    languages().join(", ")
                );
                self.findings.add(language.span(), &root.key("language"), message, remedy);
                None
            }),
            (None, Some(file)) => {
                let place = root.key("page_texts");
                let text = self.file(file, &place)?;
                match PageTexts::parse(file.get_ref(), &text) {
                    Ok(texts) => Some((texts, Some(file.get_ref().clone()))),
                    Err(PageTextsError::Problems { file: name, problems }) => {
                        for problem in problems {
                            let at = problem.line.map(|line| format!(":{line}")).unwrap_or_default();
                            let message = format!("{name}{at}: {}", problem.problem);
                            self.findings.add(file.span(), &place, message, problem.remedy);
                        }
                        None
                    }
                    Err(other) => {
                        self.findings.add(file.span(), &place, other.to_string(), "name a file of texts");
                        None
                    }
                }
            }
            (None, None) => None,
        }
    }
}
