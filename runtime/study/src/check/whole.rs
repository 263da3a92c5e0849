//! What concerns several parts of a study: missions, conditions and their assignment.

use std::collections::BTreeSet;

use cohabit_cdf::mission::Pointer;
use toml::Spanned;

use super::Checking;
use crate::{
    design::{Assignment, Choice, FactorKind, Study, arguments, merged},
    written::{BlockKind, Written},
};

impl Checking<'_, '_> {
    /// What concerns the whole of it.
    pub(super) fn whole(&mut self, study: &mut Study, written: &Written) {
        self.missions(study, written);
        self.assignment(study, written);
        self.names(study, written);
        study.block_size = self.block_size(study, written);
        self.combinations(study, written);
    }

    fn missions(&mut self, study: &Study, written: &Written) {
        let place = Pointer::default().key("missions");
        let block = written.block.iter().find(|block| block.get_ref().kind == BlockKind::Missions);
        match (&written.missions, block) {
            (Some(missions), Some(_)) => {
                for (index, mission) in missions.get_ref().iter().enumerate() {
                    self.mission(mission, &place.item(index));
                }
                let (count, conditions) = (study.missions.len(), study.conditions(FactorKind::Within).len());
                if count == 0 || !count.is_multiple_of(conditions) {
                    let message = format!("{count} missions for {conditions} within-participant conditions");
                    let remedy = format!("name {conditions}, or a multiple of it, so that each condition has as many");
                    self.findings.add(missions.span(), &place, message, remedy);
                }
            }
            (Some(missions), None) => {
                let remedy = "add a `[[block]]` with kind = \"missions\"";
                self.findings.add(missions.span(), &place, "no block plays these missions", remedy);
            }
            (None, Some(block)) => {
                let remedy = "add `missions`, a list of their names";
                self.findings.add(block.span(), &place, "there are no missions to play", remedy);
            }
            (None, None) => {}
        }
    }

    fn assignment(&mut self, study: &Study, written: &Written) {
        let root = Pointer::default();
        let within = written.factor.iter().find(|factor| factor.get_ref().kind == FactorKind::Within);
        if let (Some(factor), None) = (within, study.missions_block()) {
            let remedy = "add a `[[block]]` with kind = \"missions\", which plays missions under each of its levels";
            self.findings.add(factor.span(), &root.key("factor"), "nobody meets the levels of this factor", remedy);
        }
        if let (Some(assignment), None) = (&written.assignment, within)
            && *assignment.get_ref() != Assignment::BlockRandom
        {
            let remedy = "write \"block_random\", or give a factor the kind \"within\"";
            let message = "a Latin square orders within-participant conditions, and there are none";
            self.findings.add(assignment.span(), &root.key("assignment"), message, remedy);
        }
    }

    /// Says which questionnaires have one name, by which their answers could not be told apart.
    fn names(&mut self, study: &Study, written: &Written) {
        let mut known = BTreeSet::new();
        for twice in study.questionnaires.iter().filter(|one| !known.insert(&one.name)) {
            let span = written.block.first().map_or(0..0, Spanned::span);
            let message = format!("two questionnaires are called `{}`", twice.name);
            self.findings.add(span, &Pointer::default().key("block"), message, "rename the file of one of them");
        }
    }

    fn block_size(&mut self, study: &Study, written: &Written) -> usize {
        let conditions = study.conditions(FactorKind::Between).len();
        let Some(size) = &written.block_size else { return conditions };
        if *size.get_ref() == 0 || !size.get_ref().is_multiple_of(conditions) {
            let message = format!("a block of {} for {conditions} between-participants conditions", size.get_ref());
            let remedy = format!("write {conditions}, or a multiple of it");
            self.findings.add(size.span(), &Pointer::default().key("block_size"), message, remedy);
        }
        (*size.get_ref()).max(1)
    }

    /// Whether `play` takes the settings of each combination of levels, which it may not though it takes each flag alone.
    fn combinations(&mut self, study: &Study, written: &Written) {
        if !self.findings.is_empty() {
            return;
        }
        let span = written.factor.first().map_or(0..0, Spanned::span);
        for between in study.conditions(FactorKind::Between) {
            for within in study.conditions(FactorKind::Within) {
                let settings = merged(&[&study.settings, &between.settings, &within.settings]);
                if let Err(problem) = self.program.check_arguments(&arguments(&settings)) {
                    let level = |choice: &Choice| format!("{} = {}", choice.factor, choice.level);
                    let levels: Vec<_> = between.choices.iter().chain(&within.choices).map(level).collect();
                    let message = format!("the settings of {} do not go together: {problem}", levels.join(", "));
                    self.findings.add(span.clone(), &Pointer::default().key("factor"), message, "change one of them");
                }
            }
        }
    }
}
