//! Looking for what was named and is not known: when to look, and when to give up.
//!
//! A search goes from leg to leg: look around, go to a viewpoint, open what may hold it. After each, the request is
//! grounded again on what is known by then, and carried on as soon as that succeeds.

use cohabit_cdf::{Action, ClassId, ObjectClass, ObjectId, RoomId, Verb};

use crate::{
    context::{
        Context,
        search::{Consent, Search, Target},
    },
    ground::{
        focus::Focus,
        want::{Miss, Want},
    },
    known::{
        Known, describe, imagine,
        sight::{self, REACH_M},
    },
    plan::Fault,
    read::{
        clause::Clause,
        phrase::{Phrase, RelationKind},
        saying,
        slot::{self, Role, Slot},
    },
    say::reply,
    talk::conversation::Conversation,
    understanding::{Asking, Step, Understanding},
    words::{intent::Intent, prose},
};

/// The most legs of one request: an office has fewer viewpoints and doors.
const MOST_LEGS: u16 = 150;
/// How likely a thing is at least in the room where it is asked for, before what that says of it counts: where such things usually are says
/// little of the one that a person has in mind there.
const AT_HAND: f32 = 0.06;

impl Conversation<'_> {
    /// Goes on with a request: does it, as far as all it names is known, or looks for what is not.
    pub(crate) fn proceed(&self, mut search: Search, context: &mut Context) -> Understanding {
        self.heed_hint(&mut search.clauses, context);
        let mut planner = self.planner(context.focus.clone());
        planner.may_put_down = search.consent.may_put_down || self.judge.asking == Asking::Never;
        planner.has_looked = !search.looked_m.is_empty();
        let Err(fault) = planner.run(&search.clauses) else {
            let found = search
                .target
                .as_ref()
                .filter(|target| !target.is_hasty)
                .and_then(|target| self.found(target, &planner.steps));
            let understanding = self.planned(planner, search.consent, found, context);
            context.request = search.clauses;
            return understanding;
        };
        let Some(target) = self.sought(&fault).or_else(|| self.told_of(&fault, &search)) else {
            if let (true, Fault::Miss { phrase, miss: Miss::Unseen, .. }) =
                (planner.has_looked && search.is_told, &fault)
            {
                (context.pending, context.search) = (None, None);
                let found = format!("I have looked, and found no {}.", bare(&saying::said(phrase)));
                return Understanding::refusal(found);
            }
            return self.fault(fault, search.clauses, search.consent, context);
        };
        // What was looked for and is seen now is found, wherever else one might be.
        if target.is_hasty && search.is_for(&target) {
            search.looked_m.push(self.stands().1);
            return self.proceed(search, context);
        }
        let (done, focus) = planner.begun;
        if done > 0 && search.legs < MOST_LEGS {
            // What comes before is done first: the search begins where that leads.
            let steps = planner.steps[..done].to_vec();
            search.clauses.drain(..planner.clause);
            (search.target, search.legs) = (None, search.legs + 1);
            context.focus = focus;
            self.remember_start(&steps, context);
            context.begin(&steps);
            context.request.clone_from(&search.clauses);
            context.search = Some(search);
            return Understanding::Plan { reply: reply::plan_reply(&steps, &[]), steps };
        }
        let is_new = search.look_for(target);
        self.look_on(search, is_new, context)
    }

    /// Looks for what a request names, as somebody said when it asked where that is, and goes on with it.
    pub(crate) fn look_for(
        &self,
        clauses: Vec<Clause>,
        slot: Slot,
        consent: Consent,
        context: &mut Context,
    ) -> Understanding {
        if self.scene.floor.is_some() {
            return self.proceed(Search::told(clauses, consent), context);
        }
        // Who knows everything there is can but look once more where it was said to be.
        let understanding = self.go(self.look_once(slot::phrase(&clauses, slot)), context);
        context.request.clone_from(&clauses);
        let (_, here) = self.stands();
        context.search = Some(Search { looked_m: vec![here], ..Search::told(clauses, consent) });
        understanding
    }

    /// Looks where it was said to be, if that was said, or here.
    fn look_once(&self, phrase: Option<&Phrase>) -> Vec<Step> {
        let mut planner = self.planner(Focus::default());
        if let Some(room) = phrase.and_then(|phrase| phrase.room) {
            planner.go_to_room(room);
        } else if let Some(near) = phrase.and_then(|phrase| phrase.relations.first()) {
            let want = Want::place(Intent::Find, &[], None);
            planner.ground().one(&near.to, &want).into_iter().for_each(|object| planner.go_to_object(object));
        }
        planner.push(Action::LookAround, "looking around".to_owned());
        planner.steps
    }

    /// The next leg, or the end of the search.
    fn look_on(&self, mut search: Search, is_new: bool, context: &mut Context) -> Understanding {
        let Some((floor, target)) = self.scene.floor.as_ref().zip(search.target.clone()) else {
            return self.give_up(search, context);
        };
        let leg = if search.legs < MOST_LEGS { self.next_leg(floor, &search, &target) } else { None };
        let closing = search.to_close.take().filter(|id| self.scene.object(*id).is_some());
        let close = closing.map(|id| Step {
            action: Action::Interact { verb: Verb::Close, object: id },
            says: format!("closing {}", describe::short(self.catalog, self.scene, id)),
        });
        if leg.is_none() && close.is_none() {
            return self.give_up(search, context);
        }
        let before = self.scene.robot.room;
        let mut steps: Vec<Step> = close.into_iter().collect();
        if let Some(leg) = &leg {
            steps.extend(self.leg_steps(leg, &target, &mut search));
        }
        let begins = is_new && search.legs == 0;
        search.legs += 1;
        let said = &target.said;
        let reply = match &leg {
            _ if target.is_hasty => "I look around first.".to_owned(),
            _ if is_new => format!("I have not seen {said} yet, so I look for {}.", prose::it(said)),
            Some(leg) if leg.room != before && !search.announced.contains(&leg.room) => {
                search.announced.push(leg.room);
                format!("I do not see {said} here. I look in the {}.", leg.room.name_in(self.catalog))
            }
            _ => String::new(),
        };
        if is_new {
            self.remember_start(&steps, context);
        }
        if begins {
            context.begin_search(&steps);
        } else {
            context.begin_leg(&steps);
        }
        context.request.clone_from(&search.clauses);
        context.search = Some(search);
        Understanding::Plan { steps, reply }
    }

    /// Says that it was not found; what can be done without it is done.
    fn give_up(&self, search: Search, context: &mut Context) -> Understanding {
        context.search = None;
        let scene = Known { floor: None, ..self.scene.clone() };
        let here = Conversation { scene: &scene, ..*self };
        let mut planner = here.planner(context.focus.clone());
        planner.may_put_down = search.consent.may_put_down || self.judge.asking == Asking::Never;
        planner.has_looked = true;
        match (planner.run(&search.clauses), search.target) {
            (Ok(()), _) => here.planned(planner, search.consent, None, context),
            (Err(Fault::Miss { miss: Miss::Unseen, .. }), Some(target)) => {
                context.pending = None;
                let found = format!("I have looked everywhere I could, and found no {}.", bare(&target.said));
                Understanding::refusal(found)
            }
            (Err(fault), _) => here.fault(fault, search.clauses, search.consent, context),
        }
    }

    /// Whether to search rather than ask: what to look for, where that may help.
    fn sought(&self, fault: &Fault) -> Option<Target> {
        self.scene.floor.as_ref()?;
        match fault {
            // Where nothing of that name affords what is asked for, something else is meant: the person knows what.
            Fault::Miss { phrase, miss: Miss::Unseen, intent, slot } => {
                let is_place = slot.is_some_and(|slot| matches!(slot.role, Role::Place(_)));
                self.target_of(phrase).filter(|target| is_place || self.affords_any(&target.classes, *intent))
            }
            // Another one is known: the rooms at hand are looked at, then the person is asked.
            Fault::Miss { phrase, miss: Miss::Mismatch(others), .. } => {
                let mut target = self.target_of(phrase)?;
                let rooms = others.iter().filter_map(|id| self.scene.object(*id)).map(|object| object.room);
                let rooms: Vec<RoomId> = rooms.chain([self.scene.robot.room]).collect();
                if phrase.room.is_none() {
                    target.rooms.retain(|room| rooms.contains(room));
                }
                Some(target)
            }
            Fault::Miss { phrase, miss: Miss::Hasty, .. } => {
                let target = self.target_of(phrase)?;
                Some(Target { rooms: vec![self.scene.robot.room], is_hasty: true, ..target })
            }
            Fault::Need { classes, .. } if !classes.is_empty() => {
                let said = prose::indefinite(&describe::name(self.catalog, classes[0]));
                Some(self.target(said, classes.clone(), None))
            }
            _ => None,
        }
    }

    /// What somebody told it to look for, whatever it is.
    fn told_of(&self, fault: &Fault, search: &Search) -> Option<Target> {
        self.scene.floor.as_ref().filter(|_| search.is_told)?;
        let Fault::Miss { phrase, miss: Miss::Unseen, .. } = fault else { return None };
        let room = phrase.room.or(phrase.is_here.then_some(self.scene.robot.room));
        Some(self.target_of(phrase).unwrap_or_else(|| self.target(saying::said(phrase), Vec::new(), room)))
    }

    fn affords_any(&self, classes: &[ClassId], intent: Intent) -> bool {
        let wanted = intent.affordances();
        let affords = |class: &ClassId| wanted.iter().any(|property| self.catalog.class(*class).has(*property));
        wanted.is_empty() || classes.iter().any(affords)
    }

    fn target_of(&self, phrase: &Phrase) -> Option<Target> {
        let mut classes = classes_of(phrase);
        if let Some(instance) = &phrase.instance {
            classes.extend(self.class_called(instance));
        }
        if let Some(fluid) = phrase.fluid.filter(|_| classes.is_empty()) {
            let is_part = |part: &str| part.eq_ignore_ascii_case(fluid.name());
            let named = self.classes().filter(|(_, class)| class.name.split(' ').any(is_part));
            classes.extend(named.map(|(id, _)| id));
        }
        if classes.is_empty() {
            // `the blue thing in the basket`: the basket first.
            let is_unseen = |to: &&Phrase| {
                let classes = classes_of(to);
                !classes.is_empty() && !self.scene.objects.iter().any(|object| classes.contains(&object.class))
            };
            return self.target_of(phrase.relations.iter().map(|relation| &relation.to).find(is_unseen)?);
        }
        let room = phrase.room.or(phrase.is_here.then_some(self.scene.robot.room));
        let mut target = self.target(saying::said(phrase), classes, room);
        // That it lies on the floor says nothing of the room.
        for relation in phrase.relations.iter().filter(|relation| !relation.to.is_floor) {
            let other = self.only_one(&relation.to, None);
            if let Some(room) = other.and_then(|id| self.scene.object(id)).map(|object| object.room) {
                target.likely_in(room, self.catalog).into_iter().for_each(|likely| *likely *= 10.0);
            } else {
                self.weigh_by_place(&relation.to, &mut target);
            }
            target.at = target.at.or(other.filter(|_| relation.kind == RelationKind::Inside));
        }
        phrase.hints.iter().for_each(|hint| self.heed_place(hint, &mut target));
        Some(target)
    }

    /// Looks first where somebody thinks that it is.
    fn heed_place(&self, hint: &Phrase, target: &mut Target) {
        target.hinted.extend(hint.room.or(hint.is_here.then_some(self.scene.robot.room)));
        for relation in hint.relations.iter().filter(|relation| !relation.to.is_floor) {
            let Some(other) = self.only_one(&relation.to, hint.room) else {
                self.weigh_by_place(&relation.to, target);
                continue;
            };
            target.at = target.at.or(Some(other));
            target.hinted.extend(self.scene.object(other).map(|object| object.room));
        }
    }

    /// What is by something that was not seen yet is likely where such things usually are.
    fn weigh_by_place(&self, place: &Phrase, target: &mut Target) {
        let rooms = self.habits.by_room(self.catalog, &classes_of(place));
        target.likely.iter_mut().zip(rooms).for_each(|(likely, share)| *likely *= share);
    }

    /// The one thing that it means, in that room if one was said.
    fn only_one(&self, phrase: &Phrase, room: Option<RoomId>) -> Option<ObjectId> {
        let focus = Focus::default();
        let phrase = Phrase { room: phrase.room.or(room), ..phrase.clone() };
        self.ground(&focus).one(&phrase, &Want::place(Intent::Find, &[], None)).ok()
    }

    pub(crate) fn classes(&self) -> impl Iterator<Item = (ClassId, &ObjectClass)> {
        (0..).map(ClassId).zip(self.catalog.classes())
    }

    /// The class of an instance id in any case.
    fn class_called(&self, instance: &str) -> Option<ClassId> {
        let called = |class: &ObjectClass| {
            let head = instance.get(..class.id.len()).is_some_and(|head| head.eq_ignore_ascii_case(&class.id));
            head && instance[class.id.len()..].chars().all(|letter| letter == '_' || letter.is_ascii_digit())
        };
        self.classes().filter(|(_, class)| called(class)).max_by_key(|(_, class)| class.id.len()).map(|(id, _)| id)
    }

    pub(crate) fn target(&self, said: String, classes: Vec<ClassId>, room: Option<RoomId>) -> Target {
        let likely = self.habits.by_room(self.catalog, &classes);
        let rooms = room.map_or_else(|| self.catalog.rooms().ids().collect(), |room| vec![room]);
        let from = self.scene.robot.room;
        let mut target = Target { said, classes, rooms, likely, at: None, hinted: Vec::new(), is_hasty: false, from };
        target.likely_in(from, self.catalog).into_iter().for_each(|likely| *likely = likely.max(AT_HAND));
        target
    }

    /// `the mug on the desk`, of what was looked for and is part of these steps.
    fn found(&self, target: &Target, steps: &[Step]) -> Option<String> {
        let objects = steps.iter().filter_map(|step| imagine::object_of(&step.action));
        let is_it = |id: &ObjectId| self.scene.object(*id).is_some_and(|object| target.classes.contains(&object.class));
        let id = objects.into_iter().find(is_it)?;
        Some(format!("I found {}", describe::full(self.catalog, self.scene, id)))
    }

    /// From how far such a thing shows, m.
    pub(crate) fn reach_m(&self, target: &Target) -> f32 {
        let reach = target.classes.iter().map(|class| sight::reach_of(self.catalog.class(*class)));
        reach.fold(REACH_M.1, f32::min)
    }
}

/// The classes that the words mean most.
pub(crate) fn classes_of(phrase: &Phrase) -> Vec<ClassId> {
    let best = phrase.namings.iter().map(|naming| naming.weight).fold(0.0, f32::max);
    let is_best = |naming: &&crate::words::lexicon::Naming| naming.weight > best - 0.25;
    phrase.namings.iter().filter(is_best).map(|naming| naming.class).collect()
}

/// `a mug` without its article.
fn bare(said: &str) -> &str {
    ["a ", "an ", "any "].iter().find_map(|article| said.strip_prefix(article)).unwrap_or(said)
}
