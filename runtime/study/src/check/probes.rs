//! The probes of a study: questions during missions.

use cohabit_cdf::mission::Pointer;
use toml::Spanned;

use super::Checking;
use crate::{
    probe::{Happening, Moment, Probe},
    written::WrittenProbe,
};

impl Checking<'_, '_> {
    pub(super) fn probes(&mut self, probes: &[Spanned<WrittenProbe>], at: &Pointer) -> Vec<Probe> {
        let numbered = probes.iter().enumerate();
        numbered.filter_map(|(index, probe)| self.probe(probe.get_ref(), &at.item(index))).collect()
    }

    fn probe(&mut self, probe: &WrittenProbe, at: &Pointer) -> Option<Probe> {
        let moment = self.moment(probe, at);
        let name = probe.questionnaire.as_ref()?;
        let place = at.key("questionnaire");
        let questionnaire = self.questionnaire(name, &place)?;
        if questionnaire.items.len() != 1 {
            let message = format!("`{}` has {} questions", name.get_ref(), questionnaire.items.len());
            self.findings.add(
                name.span(),
                &place,
                message,
                "name a questionnaire of one item, which takes a moment to answer",
            );
        }
        Some(Probe { questionnaire: questionnaire.name, at: moment?, pauses: probe.pause })
    }

    fn moment(&mut self, probe: &WrittenProbe, at: &Pointer) -> Option<Moment> {
        const SECONDS: f64 = 60.0;
        let written = probe.at.as_ref()?;
        let Some(happening) = Happening::named(written.get_ref()) else {
            if probe.minutes.is_none() && !self.findings.is_unread(&at.key("minutes")) {
                self.findings.add(written.span(), &at.key("at"), "after how many minutes?", "add `minutes`");
            }
            return Some(Moment::Played(probe.minutes.as_ref()?.get_ref() * SECONDS));
        };
        if let Some(minutes) = &probe.minutes {
            let remedy = "leave it out, or write at = \"minutes\"";
            self.findings.add(minutes.span(), &at.key("minutes"), "this probe is asked when something happens", remedy);
        }
        Some(Moment::Happens(happening))
    }
}
