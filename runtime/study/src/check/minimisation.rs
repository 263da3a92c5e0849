//! How between-participants conditions are assigned by covariates.

use std::collections::BTreeSet;

use cohabit_cdf::mission::Pointer;
use cohabit_dialog::{Form, Item};
use toml::Spanned;

use super::{Checking, blocks::Blocks};
use crate::{
    design::{Block, Covariate, CovariateSource, Factor, FactorKind, Minimisation},
    written::{WrittenCovariate, WrittenMinimisation},
};

/// How probable the best condition is, if the file does not say.
const CERTAINTY: f64 = 0.8;

impl Checking<'_, '_> {
    pub(super) fn minimisation(
        &mut self,
        written: Option<&Spanned<WrittenMinimisation>>,
        factors: &[Factor],
        blocks: &Blocks,
    ) -> Option<Minimisation> {
        let (root, at) = (Pointer::default(), Pointer::default().key("minimisation"));
        let (span, written) = (written?.span(), written?.get_ref());
        let has_between = factors.iter().any(|factor| factor.kind == FactorKind::Between);
        if !has_between && !self.findings.is_unread(&root.key("factor")) {
            let remedy = "give a factor the kind \"between\", or leave this out";
            self.findings.add(span, &at, "there are no between-participants conditions to assign", remedy);
        }
        let certainty = written.certainty.as_ref().map_or(CERTAINTY, |certainty| *certainty.get_ref());
        if let Some(low) = written.certainty.as_ref().filter(|certainty| *certainty.get_ref() < 0.5) {
            let message = format!("with a certainty of {certainty} conditions would not be balanced");
            self.findings.add(low.span(), &at.key("certainty"), message, "write a number from 0.5 to 1");
        }
        let mut names = BTreeSet::new();
        let mut covariates = Vec::new();
        for (index, covariate) in written.covariate.iter().enumerate() {
            let place = at.key("covariate").item(index);
            let name = self.name(covariate.get_ref().name.as_ref(), &mut names, &place);
            let from = self.source(covariate, &place, blocks);
            covariates.extend(from.map(|from| Covariate { name, from }));
        }
        Some(Minimisation { covariates, certainty })
    }

    fn source(
        &mut self,
        covariate: &Spanned<WrittenCovariate>,
        at: &Pointer,
        blocks: &Blocks,
    ) -> Option<CovariateSource> {
        let (span, written) = (covariate.span(), covariate.get_ref());
        match (&written.parameter, &written.questionnaire) {
            (Some(parameter), None) => {
                let levels = written.levels.iter().flatten().map(|level| level.get_ref().clone()).collect();
                Some(CovariateSource::Link { parameter: parameter.get_ref().clone(), levels })
            }
            (None, Some(questionnaire)) => self.answer(written, questionnaire, at, blocks),
            _ => {
                let remedy = "write `parameter` with `levels`, or `questionnaire` with `item`";
                self.findings.add(span, at, "a covariate is known from a link or from an answer", remedy);
                None
            }
        }
    }

    /// A covariate that is an answer: to an item of a questionnaire that is asked before any mission.
    fn answer(
        &mut self,
        written: &WrittenCovariate,
        questionnaire: &Spanned<String>,
        at: &Pointer,
        blocks: &Blocks,
    ) -> Option<CovariateSource> {
        let before = blocks.all.iter().take_while(|block| !matches!(block, Block::Mission { .. } | Block::Missions(_)));
        let asked: Vec<String> = before
            .filter_map(|block| match block {
                Block::Questionnaires(names) => Some(names.clone()),
                _ => None,
            })
            .flatten()
            .collect();
        let name = self.questionnaire(questionnaire, &at.key("questionnaire"))?.name;
        if !asked.contains(&name) {
            let remedy = "ask it in a questionnaire block before the first mission, since the condition depends on it";
            let message = format!("`{name}` is not asked before the first mission");
            self.findings.add(questionnaire.span(), &at.key("questionnaire"), message, remedy);
            return None;
        }
        let items = self.asked.iter().find(|one| one.name == name).map_or(0, |one| one.items.len());
        let number = written.item.as_ref().map_or(0, |item| *item.get_ref());
        let cuts: Vec<i32> = written.cuts.iter().flatten().map(|cut| *cut.get_ref()).collect();
        let problem = match self.asked.iter().find(|one| one.name == name)?.items.get(number.wrapping_sub(1)) {
            None => Some(format!("`{name}` has no item {number}: it has {items}, from 1")),
            Some(item) => unfit(item, &cuts),
        };
        if let Some(problem) = problem {
            let span = written.item.as_ref().map_or(questionnaire.span(), Spanned::span);
            let remedy = "name an item that is a scale or a choice, and `cuts` in rising order within its scale";
            self.findings.add(span, &at.key("item"), problem, remedy);
            return None;
        }
        Some(CovariateSource::Answer { questionnaire: name, item: number - 1, cuts })
    }
}

/// Why an item cannot be a covariate that is cut so.
fn unfit(item: &Item, cuts: &[i32]) -> Option<String> {
    match &item.form {
        Form::Words(_) => Some("it is answered in words, which are no levels".to_owned()),
        Form::Choice(_) if !cuts.is_empty() => {
            Some("a choice has no `cuts`: its levels are what can be chosen".to_owned())
        }
        Form::Scale(scale) => {
            let within = |cut: &i32| *cut > scale.least && *cut <= scale.most;
            let is_fit = cuts.is_sorted() && cuts.iter().all(within);
            (!is_fit).then(|| format!("these are no cuts of a scale from {} to {}", scale.least, scale.most))
        }
        Form::Choice(_) => None,
    }
}
