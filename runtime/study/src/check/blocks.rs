//! The blocks of a study: what is done, one after the other.

use std::ops::Range;

use cohabit_cdf::mission::Pointer;
use cohabit_dialog::Questionnaire;
use toml::Spanned;

use super::Checking;
use crate::{
    design::{Block, Limits, Missions},
    instrument::Instrument,
    shape::KEYS_OF_BLOCKS,
    written::{BlockKind, Words, WrittenBlock},
};

/// The blocks, and the debriefing, which ends them.
#[derive(Default)]
pub(super) struct Blocks {
    pub(super) all: Vec<Block>,
    /// Where each of them stands in the text.
    pub(super) places: Vec<(Range<usize>, Pointer)>,
    pub(super) debriefing: Option<String>,
}

impl Checking<'_, '_> {
    pub(super) fn blocks(&mut self, blocks: &[Spanned<WrittenBlock>], at: &Pointer) -> Blocks {
        let mut found = Blocks::default();
        for (index, block) in blocks.iter().enumerate() {
            let (place, span) = (at.item(index), block.span());
            let block = block.get_ref();
            // What nobody knows the kind of has no keys that it should have.
            if self.findings.is_unread(&place.key("kind")) {
                continue;
            }
            self.keys(block, &span, &place);
            if block.kind == BlockKind::Debriefing {
                if index + 1 < blocks.len() {
                    self.findings.add(span, &place, "something follows the debriefing", "move it to the end");
                }
                found.debriefing = self.text(block.file.as_ref(), &place);
                continue;
            }
            let is_second = |one: &Block| matches!(one, Block::Missions(_)) && block.kind == BlockKind::Missions;
            if found.all.iter().any(is_second) {
                let remedy = "put all missions into one, or name single ones in blocks of kind \"mission\"";
                self.findings.add(span.clone(), &place, "a second block of missions", remedy);
            }
            let block = self.block(block, &place);
            found.all.push(block);
            found.places.push((span, place));
        }
        found
    }

    /// Says which keys a block lacks, and which it has in vain.
    fn keys(&mut self, block: &WrittenBlock, span: &Range<usize>, at: &Pointer) {
        let kind = block.kind.name();
        let Some((_, must, may)) = KEYS_OF_BLOCKS.iter().find(|(name, ..)| *name == kind) else { return };
        let keys = block.keys();
        let is_read = |key: &&&str| !self.findings.is_unread(&at.key(key));
        let missing: Vec<_> = must.iter().filter(|key| !keys.contains(key)).filter(is_read).collect();
        for key in missing {
            let message = format!("a block of kind \"{kind}\" lacks `{key}`");
            self.findings.add(span.clone(), at, message, format!("add `{key}`"));
        }
        for key in keys.iter().filter(|key| !must.contains(key) && !may.contains(key)) {
            let all = [*must, *may].concat().join(", ");
            let message = format!("a block of kind \"{kind}\" has no `{key}`");
            self.findings.add(span.clone(), &at.key(key), message, format!("leave it out: its keys are {all}"));
        }
    }

    fn block(&mut self, block: &WrittenBlock, at: &Pointer) -> Block {
        let limits = self.limits(block, at);
        let text = self.text(block.file.as_ref(), at).unwrap_or_default();
        let settings = block.settings.as_ref().map(|settings| self.settings(settings, &at.key("settings")));
        let settings = settings.unwrap_or_default();
        match block.kind {
            BlockKind::Questionnaire | BlockKind::Debriefing => {
                Block::Questionnaires(self.questionnaires(block.questionnaires.as_ref(), &at.key("questionnaires")))
            }
            BlockKind::Mission | BlockKind::Practice | BlockKind::Tutorial => {
                if let Some(mission) = &block.mission {
                    self.mission(mission, &at.key("mission"));
                }
                let mission = block.mission.as_ref().map(|name| name.get_ref().clone()).unwrap_or_default();
                let exercises = match block.kind {
                    BlockKind::Tutorial => self.exercises(block, at),
                    _ => Vec::new(),
                };
                let is_practice = block.kind != BlockKind::Mission;
                Block::Mission { mission, is_practice, exercises, settings, limits, text }
            }
            BlockKind::Missions => Block::Missions(Missions {
                order: block.order.unwrap_or_default(),
                settings,
                limits,
                after_mission: self.questionnaires(block.after_mission.as_ref(), &at.key("after_mission")),
                after_condition: self.questionnaires(block.after_condition.as_ref(), &at.key("after_condition")),
                text,
            }),
            BlockKind::Break => Block::Break { limit_s: limits.limit_s, text },
        }
    }

    fn limits(&mut self, block: &WrittenBlock, at: &Pointer) -> Limits {
        const SECONDS: f64 = 60.0;
        let seconds = |minutes: &Option<Spanned<f64>>| minutes.as_ref().map(|minutes| minutes.get_ref() * SECONDS);
        let limits = Limits { limit_s: seconds(&block.minutes), skip_after_s: seconds(&block.skip_after_minutes) };
        if let (Some(limit), Some(skip), Some(place)) = (limits.limit_s, limits.skip_after_s, &block.skip_after_minutes)
            && skip >= limit
        {
            let remedy = "make it less than `minutes`, or leave it out";
            self.findings.add(place.span(), &at.key("skip_after_minutes"), "it is never reached", remedy);
        }
        limits
    }

    /// Finds questionnaires; gives their names.
    fn questionnaires(&mut self, names: Option<&Words>, at: &Pointer) -> Vec<String> {
        let numbered = names.into_iter().flatten().enumerate();
        numbered.filter_map(|(index, name)| Some(self.questionnaire(name, &at.item(index))?.name)).collect()
    }

    /// Finds a questionnaire.
    pub(super) fn questionnaire(&mut self, name: &Spanned<String>, at: &Pointer) -> Option<Questionnaire> {
        let path = self.beside(name, at);
        match Instrument::find(&path) {
            Ok((questionnaire, instrument)) => {
                if !self.asked.contains(&questionnaire) {
                    self.asked.push(questionnaire.clone());
                    self.instruments.insert(questionnaire.name.clone(), instrument);
                }
                Some(questionnaire)
            }
            Err(error) => {
                let remedy = "name one that ships, or a file from the folder of the study";
                self.findings.add(name.span(), at, error.to_string(), remedy);
                None
            }
        }
    }

    /// Where a file of that name is, if there is one; else the name, which may be one of those that ship.
    fn beside(&mut self, name: &Spanned<String>, at: &Pointer) -> String {
        let path = self.folder.join(name.get_ref());
        if path.is_file() {
            self.file(name, at);
        }
        self.path(name.get_ref())
    }

    /// The same of a name that was looked at.
    pub(super) fn path(&self, name: &str) -> String {
        let path = self.folder.join(name);
        if path.is_file() { path.to_string_lossy().into_owned() } else { name.to_owned() }
    }

    pub(super) fn mission(&mut self, name: &Spanned<String>, at: &Pointer) {
        let path = self.beside(name, at);
        if let Err(problem) = self.program.check_mission(&path, self.world.as_ref()) {
            let remedy = "name a built-in mission, or a file from the folder of the study; `cohabit check` says more";
            self.findings.add(name.span(), at, problem, remedy);
        }
    }
}
