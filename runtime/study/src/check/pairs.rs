//! What concerns pairs: whether a study has them, how they go together, and what of it cannot be told apart.

use std::ops::Range;

use cohabit_cdf::mission::Pointer;
use toml::Spanned;

use super::Checking;
use crate::{
    design::{FactorKind, Study, conditions_of},
    pair::{PAIR_SIZE, Pairing},
    settings::{OF_OWN_PAGE, avatars, drives_all},
    written::{Unit, Written, WrittenFactor},
};

/// How long somebody waits for their partner until something may follow, if the file does not say, s.
const WAIT_S: f64 = 300.0;
const MINUTE_S: f64 = 60.0;
/// The key that says how many participants a session is of.
const SIZE: &str = "participants_per_session";

impl Checking<'_, '_> {
    /// How two participants go together, if a session is of two.
    pub(super) fn pairing(&mut self, written: &Written) -> Option<Pairing> {
        let root = Pointer::default();
        if let Some(none) = written.participants_per_session.as_ref().filter(|size| *size.get_ref() == 0) {
            self.findings.add(none.span(), &root.key(SIZE), "nobody plays a session", "write 1 or 2");
        }
        let has_pairs = written.participants_per_session.as_ref().is_some_and(|size| *size.get_ref() == PAIR_SIZE);
        if !has_pairs {
            if let Some(pair) = written.pair.as_ref().filter(|_| !self.findings.is_unread(&root.key(SIZE))) {
                let remedy = "write participants_per_session = 2, or leave this out";
                self.findings.add(
                    pair.span(),
                    &root.key("pair"),
                    "a session is of one participant, not of a pair",
                    remedy,
                );
            }
            return None;
        }
        if let Some(odd) = written.participants.as_ref().filter(|count| !count.get_ref().is_multiple_of(PAIR_SIZE)) {
            let message = format!("{} participants are no whole pairs", odd.get_ref());
            self.findings.add(odd.span(), &root.key("participants"), message, "plan an even number");
        }
        if let Some(minimisation) = &written.minimisation {
            let message = "minimisation goes by what one participant is like, and a condition is the pair's";
            let remedy = "leave it out: conditions of pairs are assigned in blocks";
            self.findings.add(minimisation.span(), &root.key("minimisation"), message, remedy);
        }
        let pair = written.pair.as_ref().map(Spanned::get_ref);
        let minutes = pair.and_then(|pair| pair.partner_minutes.as_ref());
        Some(Pairing {
            wait_s: minutes.map_or(WAIT_S, |minutes| minutes.get_ref() * MINUTE_S),
            partner_absent: pair.map(|pair| pair.partner_absent).unwrap_or_default(),
            skip: pair.map(|pair| pair.skip).unwrap_or_default(),
        })
    }

    /// Who meets the levels of a factor: of one between participants in a study of pairs, both of a pair the same, or each their own.
    pub(super) fn kind(&mut self, factor: &Spanned<WrittenFactor>, has_pairs: bool, at: &Pointer) -> FactorKind {
        let WrittenFactor { kind, unit, level, .. } = factor.get_ref();
        let is_own = |name: &&Spanned<String>| OF_OWN_PAGE.contains(&name.get_ref().as_str());
        let set: Vec<&Spanned<String>> = level.iter().flat_map(|level| level.get_ref().settings.keys()).collect();
        let own = OF_OWN_PAGE.map(|name| format!("`{name}`")).join(", ");
        if self.findings.is_unread(&at.key("kind")) || self.findings.is_unread(&Pointer::default().key(SIZE)) {
            return *kind;
        }
        let Some(unit) = unit else {
            if has_pairs && *kind == FactorKind::Between && !set.is_empty() && set.iter().all(is_own) {
                let message =
                    format!("its levels set {own} alone, in which both of a pair can be alike, or each by themselves");
                let remedy = "write unit = \"pair\" or unit = \"participant\"";
                self.findings.add(factor.span(), at, message, remedy);
            }
            return *kind;
        };
        let place = at.key("unit");
        if !has_pairs {
            let remedy = "leave it out, or write participants_per_session = 2";
            self.findings.add(unit.span(), &place, "there are no pairs", remedy);
            return *kind;
        }
        match (kind, unit.get_ref()) {
            (FactorKind::Within, _) => {
                let message = "both of a pair meet all levels of a factor within participants, in the same order";
                self.findings.add(unit.span(), &place, message, "leave it out");
                *kind
            }
            (_, Unit::Pair) => *kind,
            (_, Unit::Participant) => {
                if let Some(other) = set.iter().find(|name| !is_own(name)) {
                    let message = format!("`{}` is of the session, which both of a pair play", other.get_ref());
                    let remedy = format!("leave `unit` out: the two of a pair can differ in {own} alone");
                    self.findings.add(other.span(), &place, message, remedy);
                }
                FactorKind::Own
            }
        }
    }

    /// Says in which sessions it would not be clear who of a pair drives what.
    pub(super) fn who_drives(&mut self, study: &Study, blocks: &[(Range<usize>, Pointer)]) {
        if study.pairing.is_none() {
            return;
        }
        for (block, (span, at)) in study.blocks.iter().zip(blocks) {
            let all = conditions_of(study, block);
            let all: Vec<_> = all.iter().map(|(between, within)| study.settings_of(block, between, within)).collect();
            if all.iter().any(|settings| avatars(settings) == 1) {
                let message = "there is one avatar for two participants";
                let remedy = "write body = [\"person\", \"person\"] into the settings, or leave the avatar out";
                self.findings.add(span.clone(), at, message, remedy);
            }
            if all.iter().any(drives_all) {
                let message = "of a pair each drives their own avatar, and nobody the robot";
                self.findings.add(span.clone(), at, message, "leave `drive` out of the settings");
            }
        }
    }
}
