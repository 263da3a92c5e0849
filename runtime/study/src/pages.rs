//! What pages show, as JSON. A participant's page learns nothing about conditions.

use serde_json::{Value, json};

use crate::{
    company::Company,
    design::{Block, ConsentBox, Study},
    markdown::html,
    pair::{pair_label, pair_of, seat_of},
    plan::{Plan, PlannedMission, Step, pseudonym},
    progress::{Doing, Phase, Progress},
    registry::{Live, Participant, Reading, Registry, Who},
    settings::{CLOCK, is_on},
    tables::{levels, progress_name},
};

impl Registry {
    /// What somebody's page shows.
    pub(crate) fn page(&self, who: Who) -> Value {
        let mut page = match who {
            Who::Withdrawn => json!({ "page": "withdrawn" }),
            Who::Newcomer(index) => {
                self.newcomers_page(self.newcomers.get(index).map_or(Reading::Information, |one| one.reading))
            }
            Who::Participant(place) => match self.participants.get(&place) {
                Some(participant) => self.with_message(participant),
                None => json!({ "page": "withdrawn" }),
            },
        };
        page["title"] = json!(self.study.title);
        page["contact"] = json!(self.study.contact);
        page
    }

    fn newcomers_page(&self, reading: Reading) -> Value {
        let Study { information, consent, consents, .. } = &self.study;
        match reading {
            Reading::Information => json!({ "page": "information", "html": html(&information.text) }),
            Reading::Consent => json!({
                "page": "consent", "html": html(&consent.text), "version": consent.version,
                "boxes": consents.iter().map(shown_box).collect::<Vec<_>>(),
            }),
            Reading::Declined => json!({ "page": "declined" }),
        }
    }

    /// What a participant's page shows, and what the experimenter has told them.
    fn with_message(&self, participant: &Participant) -> Value {
        let mut page = self.participants_page(participant);
        if let Some((number, text)) = &participant.told {
            page["message"] = json!({ "number": number, "text": text });
        }
        page
    }

    fn participants_page(&self, participant: &Participant) -> Value {
        let progress = &participant.progress;
        let Some((index, step, doing)) = progress.step_now() else {
            return match progress.phase() {
                Phase::Finished => self.ended("finished", progress.plan().place),
                // Everybody who took part is debriefed.
                Phase::Excluded => json!({ "page": "excluded", "html": self.study.debriefing.as_deref().map(html) }),
                Phase::Assigning => json!({ "page": "starting" }),
                Phase::Parted => self.ended("parted", progress.plan().place),
                _ => json!({ "page": "withdrawn" }),
            };
        };
        let mut page = match (step, doing) {
            (Step::Questionnaire { name, .. }, _) => {
                let asked = self.study.questionnaire(name);
                json!({ "page": "questionnaire", "questionnaire": asked, "draft": progress.draft() })
            }
            (Step::Break { block, limit_s }, _) => {
                let rested_s = self.clock.now_ms().saturating_sub(progress.since_ms()) as f64 / 1000.0;
                let left_s = limit_s.map(|limit| (limit - rested_s).max(0.0));
                json!({ "page": "break", "html": self.text(*block), "left_s": left_s })
            }
            (Step::Mission(mission), Doing::Ready) => json!({
                "page": "ready",
                "html": self.text(mission.block),
                "is_tutorial": mission.is_tutorial(),
                "limit_s": mission.limits.limit_s,
                "skip_after_s": mission.limits.skip_after_s,
            }),
            (Step::Mission(_), Doing::Queued { .. }) => self.waiting(progress.plan().place),
            (Step::Mission(mission), Doing::Playing) => {
                let mut page = played(participant, mission);
                let is_asked = |live: &Live| live.over.is_none() || live.is_asked_last;
                if participant.live.as_ref().is_some_and(is_asked) {
                    page["probe"] = self.open_probe(progress);
                }
                page["skip"] = self.skipped_by(progress.plan().place);
                // Who is asked something sees that it waits for them; their partner does not.
                let is_asked = !page["probe"].is_null();
                page["is_paused"] = json!(!is_asked && self.stands_still(progress.plan().place));
                page
            }
        };
        if self.study.pairing.is_some() {
            page["is_with_partner"] = json!(self.partner(progress.plan().place).is_some());
        }
        page["step"] = json!(index + 1);
        page["steps"] = json!(progress.plan().steps.len());
        page
    }

    /// The last page of somebody whose answers are kept.
    fn ended(&self, page: &str, place: u32) -> Value {
        let text = self.study.debriefing.as_deref().map(html);
        json!({ "page": page, "html": text, "completion": self.completion(place) })
    }

    /// What somebody waits for before a mission: a session, or their partner.
    fn waiting(&self, place: u32) -> Value {
        if self.company(place) == Company::Awaited {
            let may = self.may_instead(place);
            return json!({ "page": "partner", "is_late": may.is_some(), "may": may });
        }
        let ahead = self.queue().iter().position(|party| party.contains(&place));
        json!({ "page": "waiting", "ahead": ahead })
    }

    /// Of a mission that is played with a partner: who has to agree that it is skipped, and who wants to.
    fn skipped_by(&self, place: u32) -> Value {
        match (&self.study.pairing, self.playmate(place)) {
            (Some(pairing), Some(partner)) => json!({
                "by": pairing.skip,
                "is_asked": self.wants_to_skip(place),
                "is_wanted": self.wants_to_skip(partner),
            }),
            _ => Value::Null,
        }
    }

    /// What a participant is asked during a mission and has not answered yet.
    fn open_probe(&self, progress: &Progress) -> Value {
        let open = progress.probed().iter().find(|one| one.answer.is_none());
        let probe = open.and_then(|open| Some((open.probe, self.study.probes.get(open.probe)?)));
        let item = probe
            .and_then(|(number, probe)| Some((number, self.study.questionnaire(&probe.questionnaire)?.items.first()?)));
        let pauses = |number: usize| self.study.probes.get(number).is_some_and(|probe| probe.pauses);
        item.map_or(Value::Null, |(number, item)| json!({ "number": number, "item": item, "pauses": pauses(number) }))
    }

    /// What participants read in a block.
    fn text(&self, block: usize) -> String {
        match self.study.blocks.get(block) {
            Some(Block::Mission { text, .. } | Block::Break { text, .. }) => html(text),
            Some(Block::Missions(missions)) => html(&missions.text),
            Some(Block::Questionnaires(_)) | None => String::new(),
        }
    }

    /// What the experimenter's page shows, where at most `most` sessions are played.
    pub(crate) fn overview(&self, most: usize) -> Value {
        let places = self.links.participants.keys().chain(self.participants.keys());
        let places: std::collections::BTreeSet<u32> = places.copied().collect();
        json!({
            "title": self.study.title,
            "planned": self.study.participants,
            "has_pairs": self.study.pairing.is_some(),
            "sign_up": format!("/sign-up/{}", self.links.sign_up),
            "observer": format!("/observer/{}", self.links.observer),
            "wizard": self.study.has_wizard().then(|| format!("/wizard/{}", self.links.wizard)),
            "sessions": { "running": self.running(), "most": most },
            "participants": places.into_iter().map(|place| self.row(place)).collect::<Vec<_>>(),
            "notes": self.notes,
            "codes": self.study.codes,
        })
    }

    /// What the wizard's page shows: the sessions that a wizard takes part in now, with what lets the wizard in.
    pub(crate) fn wizard_sessions(&self) -> Value {
        let session = |(place, participant): (&u32, &Participant)| {
            let live = participant.live.as_ref().filter(|_| self.stands_for_session(*place))?;
            let page = live.page.as_ref()?;
            let (_, mission, _) = participant.progress.mission()?;
            let is_shared = self.playmate(*place).is_some();
            let label = if is_shared { pair_label(pair_of(*place)) } else { pseudonym(*place) };
            Some(json!({
                "participant": label,
                "mission": mission.mission,
                "port": page.port,
                "token": page.wizard.as_ref()?,
                "is_over": live.over.is_some(),
            }))
        };
        let sessions: Vec<Value> = self.participants.iter().filter_map(session).collect();
        json!({ "title": self.study.title, "sessions": sessions })
    }

    /// What observers' pages show: the same as the experimenter's, but for what lets anybody in.
    pub(crate) fn observed(&self, most: usize) -> Value {
        let mut page = self.overview(most);
        page["is_observed"] = json!(true);
        for link in ["sign_up", "observer", "wizard"] {
            page[link] = Value::Null;
        }
        for row in page["participants"].as_array_mut().into_iter().flatten() {
            row["link"] = Value::Null;
        }
        page
    }

    fn row(&self, place: u32) -> Value {
        let link = self.links.participants.get(&place).map(|token| format!("/p/{token}"));
        let mut row = json!({ "participant": pseudonym(place), "link": link });
        if self.study.pairing.is_some() {
            row["pair"] = json!(format!("{}, seat {}", pair_label(pair_of(place)), seat_of(place) + 1));
        }
        let Some(participant) = self.participants.get(&place) else {
            row["progress"] = json!("not begun");
            return row;
        };
        let progress = &participant.progress;
        row["between"] = json!(levels(&progress.plan().between));
        row["order"] = json!(within_levels(progress.plan()));
        row["progress"] = json!(progress_name(progress));
        row["done"] = json!(progress.done().len());
        row["steps"] = json!(progress.plan().steps.len());
        row["since_ms"] = json!(progress.since_ms());
        row["away_s"] = json!(participant.seen.map(|seen| seen.elapsed().as_secs()));
        row["waited_s"] = json!(self.waited_s(place));
        row["partner_is_late"] = json!(self.may_instead(place).is_some());
        if let Some((_, mission, doing)) = progress.mission() {
            let failed = participant.failed.as_ref().filter(|_| doing != Doing::Ready);
            row["failed"] = json!(failed.map(|(_, reason)| reason));
            row["mission"] = json!(mission.mission);
            row["now"] = json!(levels(&mission.within));
            row["played_s"] = json!(progress.played_s() + participant.live.as_ref().map_or(0.0, |live| live.unsaved_s));
            row["is_paused"] = json!(participant.is_paused());
            row["health"] = json!(participant.live.as_ref().map(|live| live.playing.health()));
            let lacks_wizard = |live: &Live| live.over.is_none() && live.playing.lacks_wizard();
            row["lacks_wizard"] = json!(participant.live.as_ref().is_some_and(lacks_wizard));
        }
        row
    }
}

/// The within-participant conditions in their order, each once.
fn within_levels(plan: &Plan) -> Vec<String> {
    let mut all: Vec<String> = Vec::new();
    for step in &plan.steps {
        if let Step::Mission(mission) = step
            && !mission.within.is_empty()
        {
            all.push(levels(&mission.within));
        }
    }
    all.dedup();
    all
}

fn shown_box(one: &ConsentBox) -> Value {
    json!({ "text": one.text, "is_required": one.is_required })
}

/// The session of a mission. How much time is left is told only if the study shows a clock.
fn played(participant: &Participant, mission: &PlannedMission) -> Value {
    let live = participant.live.as_ref();
    let Some(page) = live.and_then(|live| live.page.as_ref()) else { return json!({ "page": "starting" }) };
    let unsaved_s = live.map_or(0.0, |live| live.unsaved_s);
    let progress = &participant.progress;
    let is_over = live.is_some_and(|live| live.over.is_some());
    let rest = |seconds: Option<f64>| seconds.map(|seconds| (seconds - unsaved_s).max(0.0));
    let skip_in_s = rest(progress.skip_in_s());
    let is_tried = |number: usize| progress.tried().iter().any(|one| one.exercise == number);
    let exercises = mission.exercises.iter().enumerate();
    let exercises: Vec<Value> =
        exercises.map(|(number, one)| json!({ "text": one.text, "is_tried": is_tried(number) })).collect();
    json!({
        "page": "mission",
        "session": { "port": page.port, "token": page.token, "has_microphone": live.is_some_and(|live| live.is_heard) },
        "is_over": is_over,
        "left_s": rest(progress.left_s().filter(|_| is_on(&mission.settings, CLOCK))),
        "skip_in_s": skip_in_s,
        "exercises": exercises,
        "may_go_on": progress.has_tried_all() || (mission.is_tutorial() && skip_in_s == Some(0.0)),
    })
}
