//! Answers about the robot itself: what it holds, does, did and why, and what the mission wants.

use cohabit_cdf::{ObjectId, RoomId};

use crate::{
    answer::{Answerer, NEIGHBOURS, claim::asked_state, things::says_name},
    context::awaited::Until,
    ground::want::Want,
    read::{phrase::Phrase, question::Question, slot, whether},
    say::{reply, report},
    understanding::Understanding,
    words::{intent::Intent, prose},
};

/// What it does who goes where somebody goes, while they stand still, too.
const FOLLOWING: &str = "following you";
/// How it begins to repeat what it said.
const SAID: &str = "I said: \"";

impl Answerer<'_> {
    pub(crate) fn holding(&self) -> Understanding {
        let Some(held) = self.scene.robot.held else { return empty_handed("My hand is empty.") };
        let text = format!("I am holding {}{}.", self.short(held), self.filling(held));
        Understanding::whether(true, text, Vec::new())
    }

    pub(crate) fn whether_holding(&self, phrase: &Phrase) -> Understanding {
        let Some(held) = self.scene.robot.held else { return empty_handed("No, my hand is empty.") };
        // `do you have it`: what was spoken of.
        let is_it = if phrase.is_bare_pronoun() {
            self.ground().one(phrase, &Want::place(Intent::Find, &[], None)) == Ok(held)
        } else {
            self.ground().narrow(phrase, &[held]) == [held]
        };
        let start = if is_it { "Yes" } else { "No" };
        Understanding::whether(is_it, format!("{start}, I am holding {}.", self.short(held)), Vec::new())
    }

    pub(crate) fn robot(&self) -> Understanding {
        Understanding::answer(format!("I am in the {}.", self.scene.robot.room.name_in(self.catalog)))
    }

    pub(crate) fn whether_in(&self, room: RoomId) -> Understanding {
        let here = self.scene.robot.room;
        let start = if here == room { "Yes" } else { "No" };
        let name = here.name_in(self.catalog);
        Understanding::whether(here == room, format!("{start}, I am in the {name}."), Vec::new())
    }

    pub(crate) fn doing(&self) -> Understanding {
        Understanding::answer(match self.under_way() {
            Some(doing) => format!("I am {doing}."),
            None => "I am waiting for you to tell me what to do.".to_owned(),
        })
    }

    /// What it is doing: what it looks for, the step that it is at, what it waits for, or whom it follows.
    fn under_way(&self) -> Option<String> {
        let context = self.context;
        let target = context.search.as_ref().and_then(|search| search.target.as_ref());
        let sought = target.filter(|target| !target.is_hasty).map(|target| format!("looking for {}", target.said));
        let step = || context.running.iter().map(|step| step.says.clone()).find(|says| !says.is_empty());
        let waits = || {
            let until = &context.awaited.first()?.until;
            Some(match until {
                Until::Seconds(_) => format!("waiting for {}", until.in_words()),
                Until::So(_) => format!("waiting until {}", until.in_words()),
            })
        };
        let follows = || (context.follows || context.followed).then(|| FOLLOWING.to_owned());
        sought.or_else(step).or_else(waits).or_else(follows)
    }

    /// Whether it has done what it was told last.
    pub(crate) fn finished(&self) -> Understanding {
        if let Some(doing) = self.under_way() {
            return Understanding::whether(false, format!("Not yet: I am {doing}."), Vec::new());
        }
        if let Some(failure) = &self.context.failed {
            let text = format!("No, I did not finish {}: {}.", failure.step.says, report::cause(failure.status));
            return Understanding::whether(false, text, Vec::new());
        }
        if self.context.left_undone > 0 {
            return Understanding::whether(false, "No, I was told to stop before I had done it.", Vec::new());
        }
        match self.context.deeds.told_of_last() {
            Some(told) => Understanding::whether(true, format!("Yes: {told}."), Vec::new()),
            None => Understanding::answer("I have done nothing yet."),
        }
    }

    pub(crate) fn goals(&self) -> Understanding {
        let goals = self.scene.goals.iter().filter(|goal| !goal.text.is_empty());
        let (met, left): (Vec<_>, Vec<_>) = goals.partition(|goal| goal.met);
        if left.is_empty() {
            let text = if met.is_empty() { "There is no goal that I know of." } else { "Nothing: everything is done!" };
            return Understanding::whether(false, text, Vec::new());
        }
        let texts: Vec<String> = left.iter().map(|goal| goal.text.trim_end_matches('.').to_owned()).collect();
        let done = if met.is_empty() { String::new() } else { format!(" Done so far: {}.", met.len()) };
        Understanding::whether(true, format!("Still to do: {}.{done}", texts.join("; ")), Vec::new())
    }

    /// What the mission wants next, and how to ask for it.
    pub(crate) fn options(&self) -> Understanding {
        let how = "Tell me where to go, what to pick up, put, open, close or switch, or ask me where something is.";
        let goals = || self.scene.goals.iter().filter(|goal| !goal.text.is_empty());
        Understanding::answer(match goals().find(|goal| !goal.met) {
            Some(goal) => format!("The mission's next goal: {}. {how}", goal.text.trim_end_matches('.')),
            None if goals().next().is_some() => format!("Everything is done! {how}"),
            None => how.to_owned(),
        })
    }

    /// Why something is as it is, or why the last step failed, if it did; or else what the last plan, or what of it was done to an
    /// object, was for.
    pub(crate) fn why(&self, about: Option<&Phrase>, question: &Question) -> Understanding {
        if let Some(phrase) = about.filter(|_| asked_state(self.lexicon, &question.rest).is_some()) {
            return self.with_object(phrase, |id| self.why_so(id));
        }
        if let Some(chosen) = about.and_then(|phrase| self.why_this_one(phrase)) {
            return chosen;
        }
        let (deed, object) = self.asked_why(about, question);
        let is_denied = question.rest.iter().any(|word| self.lexicon.ifs.negations.contains(word));
        // What it did is told although something else failed or was refused since.
        let is_done = deed.zip(object).is_some_and(|(intent, id)| !is_denied && self.context.deeds.did(intent, id));
        if is_done || !is_about_deeds(&question.rest) {
            let why = self.why_done(deed, object);
            return Understanding::answer(why.map_or_else(|| "I do not know why.".to_owned(), |why| format!("{why}.")));
        }
        if let Some(failure) = &self.context.failed {
            let cause = report::cause(failure.status);
            return Understanding::answer(match failure.step.says.as_str() {
                "" => prose::sentence(cause),
                says => format!("I did not finish {says}: {cause}."),
            });
        }
        let is_about_it = |why: &&String| is_denied || object.is_some_and(|id| says_name(why, &self.short(id)));
        if let Some(refused) = self.context.refused.as_ref().or(self.context.left_out.as_ref().filter(is_about_it)) {
            return Understanding::answer(refused);
        }
        if let Some(not) = self.not_asked_for(object, &question.rest) {
            return Understanding::answer(not);
        }
        if let Some(why) = self.why_done(deed, object) {
            return Understanding::answer(format!("{why}."));
        }
        let Some(last) = self.context.last_plan.last().filter(|_| !self.context.reason.is_empty()) else {
            return Understanding::answer(match self.context.reason.as_str() {
                "" => "Nothing went wrong that I know of, and I have done nothing yet.".to_owned(),
                reason => format!("Because {reason}."),
            });
        };
        let step = object.and_then(|id| self.context.last_plan.iter().find(|step| step.object() == Some(id)));
        let reason = &self.context.planned_for;
        Understanding::answer(match step.filter(|step| *step != last) {
            Some(step) => format!("Because {reason}, and {} was needed for {}.", step.says, last.says),
            None => format!(
                "Because {reason}: my plan was {}{}.",
                reply::plan_in_words(&self.context.last_plan),
                self.context.deeds.goals_of(reason)
            ),
        })
    }

    /// What kind of deed it is asked the reason of, and the thing that is named.
    pub(crate) fn asked_why(&self, about: Option<&Phrase>, question: &Question) -> (Option<Intent>, Option<ObjectId>) {
        let deed = whether::deed_asked_about(self.lexicon, self.catalog, &question.rest).map(|clause| clause.intent);
        let want = Want::place(Intent::Find, &[], None);
        (deed, about.and_then(|phrase| self.ground().one(phrase, &want).ok()))
    }

    /// `why did you not close the microwave`: that nobody asked for it, unless it was done.
    fn not_asked_for(&self, object: Option<ObjectId>, asked: &[String]) -> Option<String> {
        let at = asked.iter().position(|word| self.lexicon.ifs.negations.contains(word))?;
        let done = [&asked[..at], &asked[at + 1..]].concat();
        let intent = whether::deed_asked_about(self.lexicon, self.catalog, &done)?.intent;
        let what = object.map_or_else(|| "that".to_owned(), |id| self.short(id));
        let is_done = object.is_some_and(|id| self.context.deeds.did(intent, id));
        (!is_done).then(|| format!("You did not ask me to {} {what}.", intent.verb()))
    }

    /// Why a thing is as it is: what was done to it.
    fn why_so(&self, id: ObjectId) -> Understanding {
        let the = self.short(id);
        let text = match self.context.deeds.to(id).filter(|deed| deed.step.changes()) {
            Some(deed) => format!("I did that, since {}.", deed.reason),
            None => format!("I did not do that, as far as I remember: I found {the} so, and do not know why."),
        };
        Understanding::about(text, vec![id])
    }

    /// What it said last, in the same words however often it is asked.
    pub(crate) fn said(&self) -> Understanding {
        let last = self.context.lines.iter().rfind(|(is_robot, _)| *is_robot).map(|(_, text)| text.as_str());
        let Some(last) = last else { return Understanding::answer("I have not said anything yet.") };
        let repeated = last.strip_prefix(SAID).and_then(|said| said.strip_suffix('"'));
        Understanding::answer(format!("{SAID}{}\"", repeated.unwrap_or(last)))
    }

    /// What it did last, or to a thing.
    pub(crate) fn done(&self, about: Option<&Phrase>) -> Understanding {
        let want = Want::place(Intent::Find, &[], None);
        let deed = about
            .and_then(|phrase| self.ground().one(phrase, &want).ok())
            .map(|id| (id, self.context.deeds.told_of(id)));
        let failed = self.context.failed.as_ref().filter(|failure| !failure.step.says.is_empty());
        let failed = failed
            .map(|failure| format!(" I did not finish {}: {}.", failure.step.says, report::cause(failure.status)));
        Understanding::answer(match (deed, self.context.deeds.told()) {
            (Some((id, None)), _) => format!("I did nothing with {} that I remember.", self.short(id)),
            (Some((_, Some(told))), _) => prose::sentence(&told),
            (None, Some(told)) => prose::sentence(&told) + &failed.unwrap_or_default(),
            (None, None) => {
                failed.map_or_else(|| "I have done nothing yet.".to_owned(), |failed| failed.trim().to_owned())
            }
        })
    }

    pub(crate) fn done_so_far(&self) -> Understanding {
        let Some(told) = self.context.deeds.all_told() else {
            return Understanding::answer("I have done nothing yet.");
        };
        let goals: Vec<&str> = self.context.deeds.goals().map(|goal| goal.trim_end_matches('.')).collect();
        let told = Understanding::answer(prose::sentence(&told));
        if goals.is_empty() {
            told
        } else {
            told.before(&format!("That did what the mission wants: {}.", goals.join("; ")))
        }
    }

    /// Why one of several that may be meant was taken; nothing, where there was no choice.
    fn why_this_one(&self, phrase: &Phrase) -> Option<Understanding> {
        let want = Want::place(Intent::Find, &[], None);
        let chosen = self.ground().one(phrase, &want).ok()?;
        self.context.last_plan.iter().find(|step| step.object() == Some(chosen))?;
        let is_in = |said: &&&Phrase| self.ground().all(said, &want).is_ok_and(|all| all.contains(&chosen));
        let named: Vec<&Phrase> = self.context.request.iter().flat_map(slot::named).collect();
        let said = named.iter().filter(|said| said.chosen.is_none()).find(is_in)?;
        let others: Vec<ObjectId> =
            self.ground().all(said, &want).ok()?.into_iter().filter(|id| *id != chosen).collect();
        let in_mission = |id: ObjectId| self.scene.object(id).is_some_and(|object| object.in_mission);
        let why = match others.as_slice() {
            [] => return None,
            others if in_mission(chosen) && !others.iter().any(|other| in_mission(*other)) => {
                "it is part of the mission"
            }
            _ => "that seemed likeliest to me by what was near and what we spoke of",
        };
        let names: Vec<String> = others.iter().take(NEIGHBOURS).map(|id| self.short(*id)).collect();
        let text = format!(
            "You said \"{}\", which may also be {}; I took {}, since {why}. If you meant another one, tell me which.",
            said.text,
            prose::list(&names, "or"),
            self.short(chosen),
        );
        Some(Understanding::about(text, vec![chosen]))
    }

    /// Who is with the robot, or in the room that was named: it knows of nobody but who speaks to it, and of who is in another room it cannot
    /// tell.
    pub(crate) fn people(&self, room: Option<RoomId>) -> Understanding {
        let here = self.scene.robot.room;
        if let Some(room) = room.filter(|room| *room != here) {
            let (there, name) = (room.name_in(self.catalog), here.name_in(self.catalog));
            return match self.scene.person.filter(|person| person.room == room) {
                Some(_) => Understanding::whether(true, format!("You are in the {there}."), Vec::new()),
                None => Understanding::answer(format!(
                    "I cannot see into the {there} from here: I am in the {name}. Tell me to go there, and I will look."
                )),
            };
        }
        match self.scene.person.filter(|person| person.room == here) {
            Some(_) => Understanding::whether(true, "You are here with me. I see nobody else.", Vec::new()),
            None => Understanding::whether(false, "I see nobody here.", Vec::new()),
        }
    }
}

/// Whether it is asked why about what it did: `why`, `why did you do that`, but not `why is the milk in the fridge`.
fn is_about_deeds(asked: &[String]) -> bool {
    const DEEDS: [&str; 8] = ["you", "your", "we", "i", "it", "that", "this", "so"];
    asked.is_empty() || asked.iter().any(|word| DEEDS.contains(&word.as_str()))
}

fn empty_handed(text: &str) -> Understanding {
    Understanding::whether(false, text, Vec::new())
}
