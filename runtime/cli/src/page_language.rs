//! In which language people read the page.

use std::{ffi::OsString, path::PathBuf};

use cohabit_dialog::PageTexts;

use crate::failure::bad_input;

/// The language of the page.
#[derive(clap::Args, Clone)]
pub struct PageLanguage {
    /// The language of the page: `en`, `de` or `es`. The session and the robot speak English all the same
    #[arg(long, value_name = "LANGUAGE", default_value = "en")]
    page_language: String,
    /// A file (TOML) with the texts of the page in any other language
    #[arg(long, value_name = "FILE", conflicts_with = "page_language")]
    page_texts: Option<PathBuf>,
}

impl PageLanguage {
    /// What people read, with nothing missing.
    pub fn texts(&self) -> anyhow::Result<PageTexts> {
        let texts = match &self.page_texts {
            Some(file) => PageTexts::read(file),
            None => PageTexts::of(&self.page_language),
        };
        texts.map_err(|error| bad_input(format!("`{}`: {error}", self.flag())))
    }

    const fn flag(&self) -> &'static str {
        if self.page_texts.is_some() { "--page-texts" } else { "--page-language" }
    }

    /// The arguments by which another process has the same.
    pub fn arguments(&self) -> [OsString; 2] {
        let value = match &self.page_texts {
            Some(file) => file.clone().into(),
            None => self.page_language.clone().into(),
        };
        [self.flag().into(), value]
    }
}
