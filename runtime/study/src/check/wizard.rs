//! How a wizard takes part in a study.

use std::collections::BTreeSet;

use cohabit_cdf::mission::Pointer;
use cohabit_dialog::{NotOfWizard, OnTimeout, Phrase, PlannedError};
use toml::Spanned;

use super::Checking;
use crate::{
    design::Study,
    settings::{has_wizard, response_delay_ms},
    wizard::Wizard,
    written::{BlockKind, Written, WrittenError, WrittenPhrase, WrittenWizard},
};

const MS: f64 = 1000.0;

impl Checking<'_, '_> {
    pub(super) fn wizard(&mut self, written: Option<&Spanned<WrittenWizard>>) -> Wizard {
        let Some(written) = written.map(Spanned::get_ref) else { return Wizard::default() };
        let at = Pointer::default().key("wizard");
        let on_timeout = written.on_timeout.as_ref().and_then(|what| what.get_ref().parse().ok()).unwrap_or_default();
        if let (Some(what), None) = (&written.on_timeout, &written.timeout_s)
            && !self.findings.is_unread(&at.key("timeout_s"))
        {
            let remedy = "add `timeout_s`, how long a wizard may take to decide";
            self.findings.add(what.span(), &at.key("on_timeout"), "there is no time-out that this follows", remedy);
        }
        if let Some(moment) = written.moment.as_ref().filter(|_| on_timeout != OnTimeout::Say)
            && !self.findings.is_unread(&at.key("on_timeout"))
        {
            let remedy = "write on_timeout = \"say\", or leave this out";
            self.findings.add(moment.span(), &at.key("moment"), "the robot never says this", remedy);
        }
        Wizard {
            timeout_s: written.timeout_s.as_ref().map(|seconds| *seconds.get_ref()),
            on_timeout,
            moment: written.moment.as_ref().map(|text| text.get_ref().clone()),
            phrases: self.phrases(&written.phrase, &at.key("phrase")),
            errors: self.planned_errors(&written.error, &at.key("error")),
        }
    }

    fn planned_errors(&mut self, written: &[Spanned<WrittenError>], at: &Pointer) -> Vec<PlannedError> {
        let mut names = BTreeSet::new();
        let mut all = Vec::new();
        for (index, error) in written.iter().enumerate() {
            let place = at.item(index);
            let WrittenError { name: Some(name), say, order, step } = error.get_ref() else { continue };
            let text = |text: &Option<Spanned<String>>| {
                text.as_ref().map(|text| text.get_ref().trim().to_owned()).unwrap_or_default()
            };
            let (step, say, order) = (step.as_ref().map(|step| *step.get_ref()), text(say), text(order));
            match (PlannedError { name: name.get_ref().clone(), say, order, step }).checked() {
                Ok(planned) if names.insert(planned.name.clone()) => all.push(planned),
                Ok(planned) => {
                    let message = format!("two planned errors are called `{}`", planned.name);
                    self.findings.add(name.span(), &place.key("name"), message, "give one of them another name");
                }
                Err(problem) => {
                    let remedy = "such as name = \"wrong object\" and do = \"pick up the apple\"";
                    self.findings.add(error.span(), &place, problem.to_string(), remedy);
                }
            }
        }
        all
    }

    fn phrases(&mut self, written: &[Spanned<WrittenPhrase>], at: &Pointer) -> Vec<Phrase> {
        let mut keys = BTreeSet::new();
        let mut all = Vec::new();
        for (index, phrase) in written.iter().enumerate() {
            let place = at.item(index);
            let WrittenPhrase { key: Some(key), text: Some(text), waits } = phrase.get_ref() else { continue };
            match Phrase::new(key.get_ref(), text.get_ref(), *waits) {
                Ok(phrase) if keys.insert(phrase.key) => all.push(phrase),
                Ok(phrase) => {
                    let message = format!("two phrases have the key `{}`", phrase.key);
                    self.findings.add(key.span(), &place.key("key"), message, "give one of them another key");
                }
                Err(error @ NotOfWizard::Key(_)) => {
                    self.findings.add(key.span(), &place.key("key"), error.to_string(), "such as key = \"h\"");
                }
                Err(error) => {
                    self.findings.add(text.span(), &place.key("text"), error.to_string(), "write it in one short line");
                }
            }
        }
        all
    }

    /// What of a wizard concerns sessions.
    pub(super) fn takes_part(&mut self, study: &Study, written: &Written) {
        let at = Pointer::default().key("wizard");
        let of_wizards: Vec<_> = study.all_settings().into_iter().filter(has_wizard).collect();
        if of_wizards.is_empty() {
            if let Some(wizard) = written.wizard.as_ref().filter(|_| self.knows_wizards) {
                let remedy = "write wizard = \"yes\" into `[settings]`, or into those of a level; or leave this out";
                self.findings.add(wizard.span(), &at, "no session has a wizard", remedy);
            }
            return;
        }
        if !written.block.iter().any(|block| block.get_ref().kind == BlockKind::Debriefing) {
            let span = written.block.last().map_or(0..0, Spanned::span);
            let message = "a wizard takes part, and nobody is told so in the end";
            let remedy = "add a `[[block]]` with kind = \"debriefing\" that tells participants that a person decided for the robot";
            self.findings.add(span, &Pointer::default().key("block"), message, remedy);
        }
        let Some(timeout) = written.wizard.as_ref().and_then(|wizard| wizard.get_ref().timeout_s.as_ref()) else {
            return;
        };
        let delay_ms = of_wizards.iter().map(response_delay_ms).max().unwrap_or(0);
        #[allow(clippy::cast_precision_loss, reason = "a delay is no 10^15 ms long")]
        if *timeout.get_ref() * MS < delay_ms as f64 {
            let message =
                format!("a wizard has {} s to decide, and nothing is answered before {delay_ms} ms", timeout.get_ref());
            let remedy = "write a time-out that is no shorter than `response-delay-ms`";
            self.findings.add(timeout.span(), &at.key("timeout_s"), message, remedy);
        }
    }
}
