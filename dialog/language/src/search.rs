//! Looking for what was named and is not known: where to look next, and when to give up.
//!
//! A search goes from leg to leg: look around, go to a viewpoint, open what may hold it. After each, the request is
//! grounded again on what is known by then, and carried on as soon as that succeeds.

use cohabit_cdf::{
    Action, Catalog, ClassId, GoToTarget, ObjectClass, ObjectId, Property, RoomId, StateFlag, Status, Verb,
};
use serde::{Deserialize, Serialize};

use crate::{
    asked,
    clause::Clause,
    context::{Consent, Context, Role, Slot},
    conversation::Conversation,
    describe,
    floor::Floor,
    ground::{Ground, Miss, Want},
    intent::Intent,
    known::{Known, KnownObject, distance_m},
    phrase::{Phrase, Place, RelationKind},
    plan::Fault,
    remedy, reply, saying, sight,
    understanding::{Asking, Step, Understanding},
};

/// The most legs of one request: an office has fewer viewpoints and doors.
const MOST_LEGS: u16 = 150;
/// How far off things are looked for, m: what is tiny is not looked for from a foot away, nor what is large from afar.
const REACH_M: (f32, f32) = (1.5, 8.0);
/// The share of a room that a look must add.
const LEAST_GAIN: f32 = 0.03;
/// The share of a room that must be looked at before doors are opened in it.
const LOOKED_AT: f32 = 0.6;
/// How much likelier things are where they are spoken of than elsewhere.
const HERE: f32 = 4.0;
/// How much better it is to stay in a room until it is looked at than to come back.
const STAY: f32 = 3.0;
/// The pace, and how long it takes to look around and to open a door, s.
const PACE_M_S: f32 = 0.8;
const LOOK_S: f32 = 4.0;
const OPEN_S: f32 = 4.0;
/// Two places that are closer are the same to look from, m.
const SAME_SPOT_M: f32 = 0.5;

/// A request that waits until what it names is found.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(crate) struct Search {
    clauses: Vec<Clause>,
    consent: Consent,
    /// What is looked for; nothing yet, while the beginning of the request is done first.
    target: Option<Target>,
    /// Where it looked all around, m.
    looked_m: Vec<[f32; 2]>,
    tried: Vec<Spot>,
    unreachable: Vec<RoomId>,
    /// What it opened in vain.
    to_close: Option<ObjectId>,
    legs: u16,
    /// Whether somebody told it to look, where it asked.
    #[serde(default)]
    is_told: bool,
}

/// What is looked for.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct Target {
    /// In words, such as `a red mug`.
    said: String,
    classes: Vec<ClassId>,
    /// The rooms where it may be.
    rooms: Vec<RoomId>,
    /// How likely it is in each room, by its index.
    likely: Vec<f32>,
    /// What it was said to be in or on.
    at: Option<ObjectId>,
    /// Whether one is known already, and a look around is all that is wanted.
    is_hasty: bool,
    /// Where the robot was when it was asked for.
    from: RoomId,
}

/// Somewhere to look from, or into.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
enum Spot {
    Here([f32; 2]),
    Viewpoint(RoomId, u8),
    Thing(ObjectId),
}

/// A place to look, and what speaks for it.
struct Leg {
    spot: Spot,
    room: RoomId,
    /// The chance to find it there, and how long that takes, s.
    chance: f32,
    takes_s: f32,
}

impl Search {
    /// Whether it is to do the same with the same in the end, wherever it begins to look: a pronoun may stand for what the other one names.
    pub(crate) fn comes_to(&self, other: &Self) -> bool {
        let (own, others) = (self.deeds(), other.deeds());
        let is_alike = |(one, other): (&&Clause, &&Clause)| {
            let (one_named, other_named) = (named(one), named(other));
            one.intent == other.intent
                && one_named.len() == other_named.len()
                && one_named.iter().zip(&other_named).all(|(one, other)| may_mean_the_same(one, other))
        };
        own.len() == others.len() && own.iter().zip(&others).all(is_alike)
    }

    /// What it is for, without what only brings the robot there and what is only spoken of, if there is more to it.
    pub(crate) fn deeds(&self) -> Vec<&Clause> {
        let only_goes =
            |clause: &&Clause| matches!(clause.intent, Intent::GoTo | Intent::Find | Intent::Look | Intent::Mention);
        let deeds: Vec<&Clause> = self.clauses.iter().filter(|clause| !only_goes(clause)).collect();
        if deeds.is_empty() { self.clauses.iter().collect() } else { deeds }
    }

    pub(crate) fn new(clauses: Vec<Clause>, consent: Consent) -> Self {
        Self {
            clauses,
            consent,
            target: None,
            looked_m: Vec::new(),
            tried: Vec::new(),
            unreachable: Vec::new(),
            to_close: None,
            legs: 0,
            is_told: false,
        }
    }

    /// The same, of which somebody said that it is to look for what it does not know.
    pub(crate) fn told(clauses: Vec<Clause>, consent: Consent) -> Self {
        Self { is_told: true, ..Self::new(clauses, consent) }
    }

    /// Whether it is under way, and not waiting for the beginning of the request to be done.
    pub(crate) const fn is_under_way(&self) -> bool {
        self.target.is_some()
    }

    /// A leg could not be walked.
    pub(crate) fn note_failure(&mut self, step: &Step, status: Status) {
        if status == Status::Interrupted {
            return;
        }
        if let (Action::GoTo { target: GoToTarget::Viewpoint(room, _) }, Status::UnsupportedNavigation) =
            (step.action, status)
        {
            self.unreachable.push(room);
        }
        if let Action::Interact { .. } = step.action {
            self.to_close = None;
        }
    }

    /// Where it was on its way to when something came between is still to be looked at, and what it was about to close to be closed.
    pub(crate) fn take_back(&mut self, step: &Step) {
        if let Some(Spot::Here(_)) = self.tried.pop() {
            self.looked_m.pop();
        }
        self.to_close = match step.action {
            Action::Interact { verb: Verb::Close, object } => Some(object),
            _ => None,
        };
    }

    fn is_for(&self, target: &Target) -> bool {
        self.target.as_ref().is_some_and(|before| !before.is_hasty && before.classes == target.classes)
    }

    fn look_for(&mut self, target: Target) -> bool {
        let is_same = |before: &Target| before.classes == target.classes && before.is_hasty == target.is_hasty;
        let is_new = !self.target.as_ref().is_some_and(is_same);
        if is_new {
            self.looked_m.clear();
            self.tried.clear();
            self.target = Some(target);
        } else if let Some(before) = &mut self.target {
            before.at = target.at;
        }
        is_new
    }
}

/// The things that a request names, in the order of its slots.
pub(crate) fn named(clause: &Clause) -> Vec<&Phrase> {
    let places = clause.places.iter().filter_map(|(_, place)| match place {
        Place::Object(phrase) => Some(phrase),
        _ => None,
    });
    clause.objects.iter().chain(places).collect()
}

/// Whether two phrases may mean the same: one is a pronoun, or both name things of one class in the same color.
fn may_mean_the_same(one: &Phrase, other: &Phrase) -> bool {
    let shares_class = || one.namings.iter().any(|naming| other.naming(naming.class).is_some());
    one.text == other.text
        || one.is_bare_pronoun()
        || other.is_bare_pronoun()
        || one.color == other.color && one.room == other.room && shares_class()
}

impl Conversation<'_> {
    /// Goes on with a request: does it, as far as all it names is known, or looks for what is not.
    pub(crate) fn proceed(&self, mut search: Search, context: &mut Context) -> Understanding {
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
        let understanding = self.go(self.look_once(asked::phrase(&clauses, slot)), context);
        context.request.clone_from(&clauses);
        let (_, here) = self.stands();
        context.search = Some(Search { looked_m: vec![here], ..Search::told(clauses, consent) });
        understanding
    }

    /// Looks where it was said to be, if that was said, or here.
    fn look_once(&self, phrase: Option<&Phrase>) -> Vec<Step> {
        let mut planner = self.planner(crate::context::Focus::default());
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
        steps.extend(leg.as_ref().map(|leg| self.leg_step(leg, &target, &mut search)));
        search.legs += 1;
        let said = &target.said;
        let reply = match &leg {
            _ if target.is_hasty => "I look around first.".to_owned(),
            _ if is_new => format!("I have not seen {said} yet, so I look for it."),
            Some(leg) if leg.room != before => {
                format!("I do not see {said} here. I look in the {}.", leg.room.name_in(self.catalog))
            }
            _ => String::new(),
        };
        if is_new {
            self.remember_start(&steps, context);
        }
        context.begin_leg(&steps);
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
                let said = describe::indefinite(&describe::name(self.catalog, classes[0]));
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
            return None;
        }
        let room = phrase.room.or(phrase.is_here.then_some(self.scene.robot.room));
        let mut target = self.target(saying::said(phrase), classes, room);
        for relation in &phrase.relations {
            let ground = Ground {
                catalog: self.catalog,
                scene: self.scene,
                focus: &crate::context::Focus::default(),
                judge: self.judge,
            };
            let other = ground.one(&relation.to, &Want::place(Intent::Find, &[], None)).ok();
            if let Some(room) = other.and_then(|id| self.scene.object(id)).map(|object| object.room) {
                target.likely_in(room, self.catalog).into_iter().for_each(|likely| *likely *= 10.0);
            } else {
                let rooms = self.habits.by_room(self.catalog, &classes_of(&relation.to));
                target.likely.iter_mut().zip(rooms).for_each(|(likely, share)| *likely *= share);
            }
            target.at = target.at.or(other.filter(|_| relation.kind == RelationKind::Inside));
        }
        Some(target)
    }

    fn classes(&self) -> impl Iterator<Item = (ClassId, &ObjectClass)> {
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

    fn target(&self, said: String, classes: Vec<ClassId>, room: Option<RoomId>) -> Target {
        let likely = self.habits.by_room(self.catalog, &classes);
        let rooms = room.map_or_else(|| self.catalog.rooms().ids().collect(), |room| vec![room]);
        Target { said, classes, rooms, likely, at: None, is_hasty: false, from: self.scene.robot.room }
    }

    fn next_leg(&self, floor: &Floor, search: &Search, target: &Target) -> Option<Leg> {
        if target.is_hasty {
            return self.looks(floor, search, target).into_iter().find(|leg| matches!(leg.spot, Spot::Here(_)));
        }
        let mut legs: Vec<Leg> = self.said_leg(floor, search, target).into_iter().collect();
        if legs.is_empty() {
            legs = self.looks(floor, search, target);
            legs.extend(self.openings(floor, search, target, &legs));
        }
        let worth = |leg: &Leg| {
            let stay = if leg.room == self.scene.robot.room { STAY } else { 1.0 };
            stay * leg.chance / leg.takes_s
        };
        legs.into_iter().reduce(|best, leg| if worth(&leg) > worth(&best) { leg } else { best })
    }

    /// What it was said to be in or on, if that is known.
    fn said_leg(&self, floor: &Floor, search: &Search, target: &Target) -> Option<Leg> {
        let place = self.scene.object(target.at?)?;
        let spot = Spot::Thing(place.id);
        let is_open_to = !search.tried.contains(&spot) && !search.unreachable.contains(&place.room);
        is_open_to.then(|| Leg { spot, room: place.room, chance: 1.0, takes_s: self.way_s(floor, place) + OPEN_S })
    }

    /// A look around from here, and from every viewpoint.
    fn looks(&self, floor: &Floor, search: &Search, target: &Target) -> Vec<Leg> {
        let (room, here) = self.stands();
        let reach_m = self.reach_m(target);
        let plan = &floor.plan;
        let leg = |spot, room: RoomId, at_m, takes_s: f32| {
            let (mut new, all) = (0, plan.count(room));
            new += plan.around(room, at_m, reach_m).filter(|cell| !floor.is_looked_at(*cell, reach_m)).count();
            let gain = new as f32 / all.max(1) as f32;
            let is_open_to = target.rooms.contains(&room) && !search.unreachable.contains(&room);
            let chance = target.chance(room, self.catalog) * gain;
            (is_open_to && gain >= LEAST_GAIN).then_some(Leg { spot, room, chance, takes_s: takes_s + LOOK_S })
        };
        let is_fresh = |at_m: [f32; 2]| search.looked_m.iter().all(|before| flat_m(*before, at_m) > SAME_SPOT_M);
        let mut legs: Vec<Leg> = Vec::new();
        legs.extend(is_fresh(here).then(|| leg(Spot::Here(here), room, here, 0.0)).flatten());
        for viewpoint in &plan.viewpoints {
            let spot = Spot::Viewpoint(viewpoint.room, viewpoint.number);
            if search.tried.contains(&spot) || flat_m(viewpoint.at_m, here) < SAME_SPOT_M {
                continue;
            }
            let way_s = plan.way_m((room, here), (viewpoint.room, viewpoint.at_m)) / PACE_M_S;
            legs.extend(leg(spot, viewpoint.room, viewpoint.at_m, way_s));
        }
        legs
    }

    /// What is closed and may hold it, in rooms that were looked at.
    fn openings(&self, floor: &Floor, search: &Search, target: &Target, looks: &[Leg]) -> Vec<Leg> {
        let is_carried = |class: &ClassId| self.catalog.class(*class).has(Property::Pickupable);
        if !target.classes.iter().any(is_carried) {
            return Vec::new();
        }
        let reach_m = self.reach_m(target);
        let is_looked_at = |room: RoomId| {
            floor.share_looked_at(room, reach_m) >= LOOKED_AT || !looks.iter().any(|leg| leg.room == room)
        };
        let may_hold = |object: &&KnownObject| {
            let class = self.catalog.class(object.class);
            let encloses = class.receptacle.as_ref().is_some_and(|kind| kind.enclosed && kind.keys.is_empty());
            let is_shut = !object.has(StateFlag::Opened) && !object.has(StateFlag::Locked);
            encloses
                && is_shut
                && class.has(Property::Openable)
                && target.rooms.contains(&object.room)
                && !search.unreachable.contains(&object.room)
                && !search.tried.contains(&Spot::Thing(object.id))
                && is_looked_at(object.room)
        };
        let leg = |object: &KnownObject| {
            let same = self.scene.objects.iter().filter(|other| other.class == object.class).count();
            let inside = self.habits.inside(self.catalog, &target.classes, object.class) / same.max(1) as f32;
            let here = if object.room == target.from { HERE } else { 1.0 };
            let takes_s = self.way_s(floor, object) + OPEN_S;
            Leg { spot: Spot::Thing(object.id), room: object.room, chance: inside * here, takes_s }
        };
        self.scene.objects.iter().filter(may_hold).map(leg).collect()
    }

    fn leg_step(&self, leg: &Leg, target: &Target, search: &mut Search) -> Step {
        search.tried.push(leg.spot);
        let says = format!("looking for {}", target.said);
        match leg.spot {
            Spot::Here(at_m) => {
                search.looked_m.push(at_m);
                Step { action: Action::LookAround, says }
            }
            Spot::Viewpoint(room, number) => {
                Step { action: Action::GoTo { target: GoToTarget::Viewpoint(room, number) }, says }
            }
            Spot::Thing(id) => {
                let planner = self.planner(Default::default());
                if planner.is_shut(id) {
                    search.to_close = Some(id);
                    let the = describe::short(self.catalog, self.scene, id);
                    let says = format!("opening {the} to look for {}", target.said);
                    return Step { action: Action::Interact { verb: Verb::Open, object: id }, says };
                }
                Step { action: Action::GoTo { target: GoToTarget::Object(id) }, says }
            }
        }
    }

    /// `the mug on the desk`, of what was looked for and is part of these steps.
    fn found(&self, target: &Target, steps: &[Step]) -> Option<String> {
        let objects = steps.iter().filter_map(|step| remedy::object_of(&step.action));
        let is_it = |id: &ObjectId| self.scene.object(*id).is_some_and(|object| target.classes.contains(&object.class));
        let id = objects.into_iter().find(is_it)?;
        Some(format!("I found {}", describe::full(self.catalog, self.scene, id)))
    }

    fn stands(&self) -> (RoomId, [f32; 2]) {
        let [x, y, _] = self.scene.robot.position_m;
        (self.scene.robot.room, [x, y])
    }

    fn way_s(&self, floor: &Floor, object: &KnownObject) -> f32 {
        let [x, y, _] = object.position_m;
        floor.plan.way_m(self.stands(), (object.room, [x, y])) / PACE_M_S
    }

    /// From how far such a thing shows, m.
    fn reach_m(&self, target: &Target) -> f32 {
        let reach = target.classes.iter().map(|class| reach_of(self.catalog.class(*class)));
        reach.fold(REACH_M.1, f32::min)
    }
}

impl Target {
    fn chance(&self, room: RoomId, catalog: &Catalog) -> f32 {
        let here = if room == self.from { HERE } else { 1.0 };
        let index = catalog.room_index(room).map(usize::from);
        index.and_then(|index| self.likely.get(index)).map_or(0.0, |likely| likely * here)
    }

    fn likely_in(&mut self, room: RoomId, catalog: &Catalog) -> Option<&mut f32> {
        self.likely.get_mut(usize::from(catalog.room_index(room)?))
    }
}

/// From how far a thing of a class is looked for, m.
pub(crate) fn reach_of(class: &ObjectClass) -> f32 {
    sight::reach_m(class).clamp(REACH_M.0, REACH_M.1)
}

/// The classes that the words mean most.
fn classes_of(phrase: &Phrase) -> Vec<ClassId> {
    let best = phrase.namings.iter().map(|naming| naming.weight).fold(0.0, f32::max);
    let is_best = |naming: &&crate::lexicon::Naming| naming.weight > best - 0.25;
    phrase.namings.iter().filter(is_best).map(|naming| naming.class).collect()
}

/// `a mug` without its article.
fn bare(said: &str) -> &str {
    ["a ", "an ", "any "].iter().find_map(|article| said.strip_prefix(article)).unwrap_or(said)
}

fn flat_m(one: [f32; 2], other: [f32; 2]) -> f32 {
    distance_m([one[0], one[1], 0.0], [other[0], other[1], 0.0])
}
