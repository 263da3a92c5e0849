//! What concerns several parts of a study: missions, conditions and their assignment.

use std::{collections::BTreeSet, ops::Range};

use cohabit_cdf::mission::Pointer;
use toml::Spanned;

use super::Checking;
use crate::{
    design::{Assignment, Choice, FactorKind, Study, conditions_of},
    settings::arguments,
    written::{BlockKind, Written, WrittenSheet},
};

impl Checking<'_, '_> {
    /// What concerns the whole of it.
    pub(super) fn whole(&mut self, study: &mut Study, written: &Written, blocks: &[(Range<usize>, Pointer)]) {
        self.each_mission(written);
        let root = Pointer::default();
        let knows_factors = self.knows_all(&root.key("factor"), written.factor.len(), &["kind", "level"]);
        let knows_blocks = self.knows_all(&root.key("block"), written.block.len(), &["kind"]);
        if knows_factors && knows_blocks && !self.findings.is_unread(&root.key("missions")) {
            self.missions(study, written);
        }
        if knows_factors && knows_blocks {
            self.assignment(study, written);
        }
        self.names(study, written);
        study.block_size = if knows_factors { self.block_size(study, written) } else { 1 };
        self.combinations(study, written, blocks);
        self.can_be_tried(study, blocks);
        self.who_drives(study, blocks);
        self.audio(study, &written.consent);
        if knows_factors && knows_blocks {
            self.takes_part(study, written);
        }
    }

    /// Whether each table of a list could be read as far as these keys go.
    fn knows_all(&self, list: &Pointer, count: usize, keys: &[&str]) -> bool {
        let unread = |index: usize| keys.iter().any(|key| self.findings.is_unread(&list.item(index).key(key)));
        !self.findings.is_unread(list) && !(0..count).any(unread)
    }

    /// Says when what people say is kept, and nobody is asked whether they may be heard.
    fn audio(&mut self, study: &Study, written: &WrittenSheet) {
        let Some((span, place)) = self.keeps_audio.take() else { return };
        let consent = Pointer::default().key("consent");
        let boxes = [("required", written.required.len()), ("optional", written.optional.len())];
        let knows_boxes = boxes.iter().all(|(key, count)| self.knows_all(&consent.key(key), *count, &["audio"]));
        if knows_boxes && !self.findings.is_unread(&consent) && !study.consents.iter().any(|one| one.audio) {
            let message = "what people say is kept, and no box of the consent form asks for that";
            let remedy = "add { text = \"What I say may be recorded.\", audio = true } to `required` or `optional` of `[consent]`";
            self.findings.add(span, &place, message, remedy);
        }
    }

    fn each_mission(&mut self, written: &Written) {
        let place = Pointer::default().key("missions");
        for (index, mission) in written.missions.iter().flat_map(|missions| missions.get_ref()).enumerate() {
            self.mission(mission, &place.item(index));
        }
    }

    fn missions(&mut self, study: &Study, written: &Written) {
        let place = Pointer::default().key("missions");
        let block = written.block.iter().find(|block| block.get_ref().kind == BlockKind::Missions);
        match (&written.missions, block) {
            (Some(missions), Some(_)) => {
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
        if written.minimisation.is_some() {
            let message = "conditions are assigned by minimisation, not in blocks";
            self.findings.add(size.span(), &Pointer::default().key("block_size"), message, "leave one of them out");
        }
        if *size.get_ref() == 0 || !size.get_ref().is_multiple_of(conditions) {
            let message = format!("a block of {} for {conditions} between-participants conditions", size.get_ref());
            let remedy = format!("write {conditions}, or a multiple of it");
            self.findings.add(size.span(), &Pointer::default().key("block_size"), message, remedy);
        }
        (*size.get_ref()).max(1)
    }

    /// Whether `play` takes the settings of each session, which it may not though it takes each flag alone, or not with that mission.
    fn combinations(&mut self, study: &Study, written: &Written, blocks: &[(Range<usize>, Pointer)]) {
        let factors = written.factor.first().map(|factor| (factor.span(), Pointer::default().key("factor")));
        for (block, place) in study.blocks.iter().zip(blocks) {
            for (between, within) in conditions_of(study, block) {
                let arguments = arguments(&study.settings_of(block, &between, &within));
                let Err(problem) = self.plays(&arguments, study.missions_of(block)) else { continue };
                let level = |choice: &Choice| format!("{} = {}", choice.factor, choice.level);
                let levels: Vec<_> = between.choices.iter().chain(&within.choices).map(level).collect();
                let of = if levels.is_empty() { "this block".to_owned() } else { levels.join(", ") };
                let (span, pointer) = factors.as_ref().filter(|_| !levels.is_empty()).unwrap_or(place);
                let message = format!("the settings of {of} do not {problem}");
                self.findings.add(span.clone(), pointer, message, "change one of them");
            }
        }
    }

    /// Whether `play` takes these arguments, with each of the missions.
    fn plays(&self, arguments: &[String], missions: &[String]) -> Result<(), String> {
        let (program, world) = (self.program, self.world.as_ref());
        program.check_arguments(arguments).map_err(|problem| format!("go together: {problem}"))?;
        missions.iter().try_for_each(|mission| {
            let checked = program.check_session(arguments, &self.path(mission), self.folder, world);
            checked.map_err(|problem| format!("fit the mission {mission}: {problem}"))
        })
    }
}
