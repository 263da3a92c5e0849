//! From clauses to steps: each clause is grounded on the scene as the steps before it are expected to leave it.

use cohabit_cdf::{Action, Catalog, ClassId, GoToTarget, ObjectId, Property, Verb, state::StateFlag};

use crate::{
    clause::{Amount, Clause},
    context::{Focus, Role, Slot},
    describe,
    ground::{Ground, Miss, Want},
    imagine,
    intent::Intent,
    judge::Judge,
    known::{Known, KnownObject},
    lexicon::{Direction, Manner, Preposition, Pronoun, Side},
    phrase::{Phrase, Place},
    process::Devices,
    report, saying, search,
    settle::{self, Settled},
    understanding::{Asking, Step},
};

/// How far from a person it stops that it comes to, m.
const BESIDE_M: f32 = 0.9;
/// Where nothing is said: how far to walk, turn and tilt the head.
const DEFAULT_MOVE_M: f32 = 1.0;
const DEFAULT_TURN_DEG: f32 = 90.0;
const DEFAULT_LOOK_DEG: f32 = 30.0;
/// How near what is seen is taken without another look, m.
const AT_HAND_M: f32 = 2.0;
/// The share of a room that was looked at by who has looked around in it.
const LOOKED_AT: f32 = 0.6;
/// Limits of one motion, beyond which somebody mistyped.
const LONGEST_MOVE_M: f32 = 30.0;
const LARGEST_TURN_DEG: f32 = 720.0;
const LARGEST_LOOK_DEG: f32 = 60.0;

/// Why there is no plan.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Fault {
    /// A phrase could not be grounded.
    Miss { slot: Option<Slot>, phrase: Box<Phrase>, miss: Miss, intent: Intent },
    /// Something else is in the hand.
    HandFull { held: ObjectId, wanted: ObjectId },
    /// Something of these classes is needed, and none is known; `text` says so.
    Need { classes: Vec<ClassId>, text: String },
    /// Nobody said which way to turn.
    Direction,
    /// It cannot be done, but this could.
    Offer { text: String, steps: Vec<Step> },
    /// It cannot be done, for this reason.
    Cannot(String),
}

/// Builds a plan.
pub(crate) struct Planner<'a> {
    pub(crate) catalog: &'a Catalog,
    pub(crate) devices: &'a Devices,
    pub(crate) judge: Judge<'a>,
    pub(crate) scene: Known,
    pub(crate) focus: Focus,
    /// Where the robot stands before the first step, m.
    pub(crate) from_m: [f32; 2],
    pub(crate) steps: Vec<Step>,
    /// What the robot should say beyond the steps: what it does unasked, what is done already.
    pub(crate) notes: Vec<String>,
    /// Whether it may put down what it holds to take something else.
    pub(crate) may_put_down: bool,
    /// Whether it has looked around for this request.
    pub(crate) has_looked: bool,
    pub(crate) clause: usize,
    /// What was done already to which thing: nobody wants it repaired twice.
    pub(crate) brought_about: Vec<(Intent, ObjectId)>,
    /// The steps, and what was spoken of, when that clause was begun.
    pub(crate) begun: (usize, Focus),
}

impl Planner<'_> {
    /// Adds the steps of all clauses.
    pub(crate) fn run(&mut self, clauses: &[Clause]) -> Result<(), Fault> {
        for (index, clause) in clauses.iter().enumerate() {
            self.clause = index;
            self.begun = (self.steps.len(), self.focus.clone());
            let before = clause.is_means.then(|| self.scene.clone());
            match (self.add(clause), clauses.get(index + 1)) {
                // `take it, take the knife`: what was meant was said at once.
                (Err(Fault::Miss { miss: Miss::NoReferent, .. }), Some(next)) if next.intent == clause.intent => {}
                (result, _) => result?,
            }
            before.into_iter().for_each(|scene| self.drop_known_means(scene));
        }
        Ok(())
    }

    /// `switch the power on by pulling the lever`: what the request comes to anyway is not done twice.
    fn drop_known_means(&mut self, scene: Known) {
        let (asked, means) = self.steps.split_at(self.begun.0);
        if means.iter().all(|step| asked.iter().any(|other| other.action == step.action)) {
            self.steps.truncate(self.begun.0);
            self.scene = scene;
        }
    }

    fn add(&mut self, clause: &Clause) -> Result<(), Fault> {
        match clause.intent {
            Intent::Stop => self.push(Action::Stop, "stopping".to_owned()),
            Intent::LookAround => self.push(Action::LookAround, "looking around".to_owned()),
            Intent::GoTo => return self.go_to(clause),
            Intent::Find => return self.find(clause),
            Intent::Travel => return self.travel(clause),
            Intent::Turn => return self.turn(clause),
            Intent::Look => self.look(clause),
            Intent::Mention => self.mention(clause),
            Intent::Swap => return self.swap(clause),
            Intent::Impossible => {
                let things = if clause.objects.is_empty() { "" } else { " things" };
                return Err(Fault::Cannot(format!("I cannot {}{things}, I am afraid.", clause.verb)));
            }
            _ => return self.add_object_clause(clause),
        }
        Ok(())
    }

    fn add_object_clause(&mut self, clause: &Clause) -> Result<(), Fault> {
        let settled = settle::settle(self, clause);
        if shifts(clause)
            && let [phrase] = clause.objects.as_slice()
        {
            let object = self.find_one(phrase, &Want::object(clause.intent), Some(Role::Object(0)))?;
            return Err(Fault::Cannot(format!(
                "I can put {} on something else, but I cannot shift it about.",
                self.the(object)
            )));
        }
        if clause.intent == Intent::Color && clause.color.is_none() && clause.places.is_empty() {
            return Err(Fault::Cannot("Which color shall it be? Say, for example, \"paint it red\".".to_owned()));
        }
        match clause.intent {
            Intent::PickUp => self.add_pick_up(&settled),
            Intent::Place | Intent::Bring | Intent::Drop => self.add_place(&settled),
            Intent::Pour => self.add_pour(&settled),
            Intent::Throw => self.add_throw(&settled),
            Intent::Break => self.add_break(&settled),
            Intent::Open | Intent::Close => self.add_door(&settled),
            Intent::Toggle | Intent::TurnOn | Intent::TurnOff => self.add_toggle(&settled),
            Intent::Use => self.add_use(&settled),
            Intent::Scan => self.add_simple(&settled, Verb::Scan, "scanning"),
            Intent::Examine => self.add_simple(&settled, Verb::Examine, "looking at"),
            Intent::LookIn => self.add_look_in(&settled),
            Intent::LookUnder => self.add_simple(&settled, Verb::Examine, report::LOOKS_UNDER),
            Intent::Highlight => self.add_highlight(&settled),
            _ => self.add_process(&settled),
        }
    }

    /// What was spoken of in passing is what `it` and `there` may stand for.
    fn mention(&mut self, clause: &Clause) {
        let want = Want::place(Intent::Find, &[], None);
        if let Some(Phrase { room: Some(room), .. }) = clause.objects.first().filter(|phrase| phrase.is_empty()) {
            (self.focus.room, self.focus.place) = (Some(*room), None);
        }
        let Some(phrase) = clause.objects.first() else { return };
        let Ok(object) = self.ground().one(phrase, &want) else {
            self.focus.unseen = Some(phrase.clone()).filter(|phrase| !phrase.namings.is_empty());
            return;
        };
        self.focus.mention(object);
        if !self.has(object, Property::Pickupable) {
            self.focus.place = Some(object);
        }
    }

    /// Adds a step and imagines its effect.
    pub(crate) fn push(&mut self, action: Action, says: String) {
        self.focus.remember(&self.scene, &action);
        imagine::apply(&mut self.scene, &action, self.devices);
        self.focus.follow(&action);
        self.steps.push(Step { action, says });
    }

    pub(crate) fn interact(&mut self, verb: Verb, object: ObjectId, participle: &str) {
        let says = format!("{participle} {}", self.the(object));
        self.push(Action::Interact { verb, object }, says);
    }

    pub(crate) fn the(&self, object: ObjectId) -> String {
        describe::short(self.catalog, &self.scene, object)
    }

    pub(crate) fn ground(&self) -> Ground<'_> {
        Ground { catalog: self.catalog, scene: &self.scene, focus: &self.focus, judge: self.judge }
    }

    /// Grounds a phrase, and says where it stands if that fails.
    pub(crate) fn find_one(&self, phrase: &Phrase, want: &Want<'_>, role: Option<Role>) -> Result<ObjectId, Fault> {
        let is_held = want.held_first && self.scene.robot.held.is_some();
        let is_it = phrase.pronoun == Some(Pronoun::Thing) && !phrase.is_described() && phrase.chosen.is_none();
        let phrase = self.focus.unseen.as_ref().filter(|_| is_it && !is_held).unwrap_or(phrase);
        let found = match self.ground().one(phrase, want) {
            Ok(id) if self.is_hasty(phrase, id, want.intent) => Err(Miss::Hasty),
            // One that is too doubtful to act on: perhaps the one that is meant is behind its back.
            Err(Miss::Several(ids)) if matches!(ids[..], [id] if self.has_yet_to_look(id)) => Err(Miss::Hasty),
            // It has looked, and there is no other: to ask would not help.
            Err(Miss::Several(ids)) => match ids[..] {
                [id] if self.is_settled(id, want.intent) => Ok(id),
                _ => Err(Miss::Several(ids)),
            },
            found => found,
        };
        found.map_err(|miss| self.miss(phrase, miss, want.intent, role))
    }

    /// Whether a look around has settled that this one is meant, where a mistake could be undone.
    fn is_settled(&self, id: ObjectId, intent: Intent) -> bool {
        let is_for_good = |object: &KnownObject| self.judge.is_for_good(intent, object.class);
        self.has_looked && !self.scene.object(id).is_none_or(is_for_good)
    }

    /// Whether to look around before this is taken for what was meant: it is nothing that the mission is about, it is
    /// not at hand, and most of the room was not looked at yet.
    fn is_hasty(&self, phrase: &Phrase, id: ObjectId, intent: Intent) -> bool {
        let Some(object) = self.scene.object(id) else { return false };
        let is_told = phrase.chosen.is_some() || phrase.pronoun.is_some() || phrase.instance.is_some();
        let is_at_hand = self.scene.robot.held == Some(id)
            || object.visible && self.scene.distance_m(object) < AT_HAND_M
            || self.focus.recent.contains(&id);
        let is_elsewhere = phrase.room.is_some_and(|named| named != self.scene.robot.room);
        let is_searched = self.has(id, Property::Pickupable) || intent == Intent::Find;
        !is_told && !is_at_hand && !object.in_mission && !is_elsewhere && is_searched && self.has_yet_to_look(id)
    }

    /// Whether such things may be in this room without its having seen them, and it has not looked around.
    fn has_yet_to_look(&self, id: ObjectId) -> bool {
        let Some((floor, object)) = self.scene.floor.as_ref().zip(self.scene.object(id)) else { return false };
        let reach_m = search::reach_of(self.catalog.class(object.class));
        !self.has_looked && floor.share_looked_at(self.scene.robot.room, reach_m) < LOOKED_AT
    }

    pub(crate) fn miss(&self, phrase: &Phrase, miss: Miss, intent: Intent, role: Option<Role>) -> Fault {
        let slot = role.map(|role| Slot { clause: self.clause, role });
        Fault::Miss { slot, phrase: Box::new(phrase.clone()), miss, intent }
    }

    /// That something of these classes is needed.
    pub(crate) fn need(&self, classes: &[ClassId], text: impl Into<String>) -> Fault {
        Fault::Need { classes: classes.to_vec(), text: text.into() }
    }

    /// Whether all that it can do about what it has not seen is to look around.
    fn looks_about(&self) -> bool {
        self.scene.floor.is_none() && !self.has_looked
    }

    /// Whether one of these classes is needed that may be found yet.
    pub(crate) fn may_find(&self, classes: &[ClassId]) -> bool {
        self.scene.floor.is_some() && !self.scene.objects.iter().any(|object| classes.contains(&object.class))
    }

    /// The objects of a clause: one each, or all of a kind.
    pub(crate) fn find_objects(&mut self, settled: &Settled, want: &Want<'_>) -> Result<Vec<ObjectId>, Fault> {
        let mut found = Vec::new();
        for (index, phrase) in settled.objects.iter().enumerate() {
            found.extend(self.find_each(phrase, want, Some(Role::Object(index)))?);
        }
        if found.len() > 1 {
            self.focus.group.clone_from(&found);
        }
        Ok(found)
    }

    pub(crate) fn find_each(
        &self,
        phrase: &Phrase,
        want: &Want<'_>,
        role: Option<Role>,
    ) -> Result<Vec<ObjectId>, Fault> {
        if self.is_group(phrase) {
            return Ok(self.focus.group.clone());
        }
        if phrase.is_all {
            return self.ground().all(phrase, want).map_err(|miss| self.miss(phrase, miss, want.intent, role));
        }
        Ok(vec![self.find_one(phrase, want, role)?])
    }

    /// `them`, of several that were spoken of together.
    fn is_group(&self, phrase: &Phrase) -> bool {
        phrase.pronoun == Some(Pronoun::Things) && phrase.chosen.is_none() && self.focus.group.len() > 1
    }

    /// Whether a clause is about more than one object.
    pub(crate) fn is_several(&self, settled: &Settled) -> bool {
        settled.objects.len() > 1 || settled.objects.iter().any(|phrase| phrase.is_all || self.is_group(phrase))
    }

    pub(crate) fn has(&self, object: ObjectId, property: Property) -> bool {
        self.scene.object(object).is_some_and(|object| self.catalog.class(object.class).has(property))
    }

    /// Opens what encloses an object, from the outside in, and says so.
    pub(crate) fn open_around(&mut self, object: ObjectId, with_itself: bool) {
        let mut around = self.around(object);
        around.extend(with_itself.then_some(object));
        for id in around {
            if self.is_shut(id) {
                self.notes.push(format!("{} is closed, so I open it first", self.the(id)));
                self.interact(Verb::Open, id, "opening");
            }
        }
    }

    /// What an object is in, from the outside in. A machine that cannot be carried stands on its parent: a microwave on
    /// a cupboard is not in the cupboard.
    pub(crate) fn around(&self, object: ObjectId) -> Vec<ObjectId> {
        let mut around = Vec::new();
        let mut child = object;
        for parent in self.scene.ancestors(object) {
            if !self.has(child, Property::Pickupable) {
                break;
            }
            around.push(parent.id);
            child = parent.id;
        }
        around.reverse();
        around
    }

    /// Whether its door keeps things in and could be opened.
    pub(crate) fn is_shut(&self, id: ObjectId) -> bool {
        self.scene.object(id).is_some_and(|object| {
            let class = self.catalog.class(object.class);
            let encloses = class.receptacle.as_ref().is_some_and(|receptacle| receptacle.enclosed);
            encloses
                && class.has(Property::Openable)
                && !object.has(StateFlag::Opened)
                && !object.has(StateFlag::Locked)
        })
    }

    fn add_simple(&mut self, settled: &Settled, verb: Verb, participle: &str) -> Result<(), Fault> {
        for object in self.find_objects(settled, &Want::object(settled.intent))? {
            self.interact(verb, object, participle);
        }
        Ok(())
    }

    fn add_look_in(&mut self, settled: &Settled) -> Result<(), Fault> {
        for object in self.find_objects(settled, &Want::object(settled.intent))? {
            self.open_around(object, true);
            self.interact(Verb::Examine, object, &format!("looking {}", self.preposition(object)));
        }
        Ok(())
    }

    fn add_highlight(&mut self, settled: &Settled) -> Result<(), Fault> {
        for object in self.find_objects(settled, &Want::object(settled.intent))? {
            let says = format!("pointing at {}", self.the(object));
            self.push(Action::Highlight { object }, says);
        }
        Ok(())
    }

    fn add_door(&mut self, settled: &Settled) -> Result<(), Fault> {
        let opens = settled.intent == Intent::Open;
        let wants_change =
            |place: &ObjectId| self.scene.object(*place).is_some_and(|place| place.has(StateFlag::Opened) != opens);
        let objects = match self.place_with_door(settled).filter(wants_change) {
            Some(place) => vec![place],
            None => self.find_objects(settled, &Want::object(settled.intent))?,
        };
        for object in objects {
            let is_open = self.scene.object(object).is_some_and(|object| object.has(StateFlag::Opened));
            if is_open == opens && self.has(object, Property::Openable) {
                let state = if opens { "open" } else { "closed" };
                self.focus.mention(object);
                self.notes.push(format!("{} is already {state}", self.the(object)));
            } else if opens {
                self.interact(Verb::Open, object, "opening");
            } else {
                self.interact(Verb::Close, object, "closing");
            }
        }
        Ok(())
    }

    /// `put it in the microwave and shut the door`: the microwave's.
    fn place_with_door(&self, settled: &Settled) -> Option<ObjectId> {
        let [phrase] = settled.objects.as_slice() else { return None };
        let door = self.catalog.find("Door_01")?;
        let is_bare = phrase.color.is_none() && phrase.side.is_none() && phrase.room.is_none() && !phrase.is_all;
        // `the door on it`
        let is_of_it = phrase.relations.iter().all(|relation| relation.to.is_bare_pronoun());
        let is_door = phrase.naming(door).is_some() && is_bare && is_of_it;
        let place = self.focus.place.filter(|place| self.has(*place, Property::Openable))?;
        is_door.then_some(place)
    }

    fn go_to(&mut self, clause: &Clause) -> Result<(), Fault> {
        let (mut target, mut rest) = match clause.places.split_first() {
            Some(((_, place), rest)) => (place.clone(), rest),
            None => return Err(Fault::Cannot("Tell me where to go.".to_owned())),
        };
        let is_room = matches!(target, Place::Room(_));
        let is_carried = |phrase: &Phrase| {
            let mut classes = phrase.namings.iter().map(|naming| self.catalog.class(naming.class));
            is_room && classes.any(|class| class.has(Property::Pickupable))
        };
        let is_taken_along = |(preposition, place): &&(Preposition, Place)| {
            *preposition == Preposition::With
                && matches!(place, Place::Object(phrase) if phrase.is_bare_pronoun() || is_carried(phrase))
        };
        // `head to the break room with it`
        if let Some((_, Place::Object(thing))) = rest.iter().find(is_taken_along) {
            let along = thing.clone();
            let places: Vec<_> = clause.places.iter().filter(|place| !is_taken_along(place)).cloned().collect();
            let object = self.find_one(&along, &Want::object(Intent::Bring), None)?;
            if self.scene.robot.held != Some(object) {
                self.add(&Clause::about(Intent::PickUp, "take", Phrase { chosen: Some(object), ..along }))?;
            }
            return self.go_to(&Clause { places, ..clause.clone() });
        }
        // `go to the kitchen by the fridge`: the fridge, in the kitchen.
        if let (Place::Room(room), [(_, Place::Object(phrase)), more @ ..]) = (&target, rest) {
            let mut phrase = phrase.clone();
            phrase.room = Some(room.id);
            target = Place::Object(phrase);
            rest = more;
        }
        if let Place::Object(phrase) = &mut target {
            rest.iter().for_each(|(preposition, place)| phrase.attach(*preposition, place.clone()));
        }
        match target {
            Place::Room(room) => self.go_to_room(room.id),
            Place::Viewpoint(room, number) => self.go_to_viewpoint(room.id, number),
            Place::Viewpoints(number) => self.go_to_viewpoint(self.scene.robot.room, number),
            Place::Here => self.notes.push("I am here already".to_owned()),
            Place::Side(side) => self.turn_to_side(side),
            Place::Object(Phrase { pronoun: Some(Pronoun::Place), .. }) if self.spoken_room().is_some() => {
                self.spoken_room().into_iter().for_each(|room| self.go_to_room(room));
            }
            Place::Object(phrase) if phrase.is_empty() && phrase.room.is_none() && phrase.side.is_some() => {
                phrase.side.into_iter().for_each(|side| self.turn_to_side(side));
            }
            Place::Object(phrase) => {
                let object = self.find_one(&phrase, &Want::object(clause.intent), Some(Role::Place(0)))?;
                self.mention_contents(&phrase, object);
                self.go_to_object(object);
            }
        }
        Ok(())
    }

    /// The room that `there` is, if it is none of the things spoken of.
    fn spoken_room(&self) -> Option<cohabit_cdf::RoomId> {
        self.focus.room.filter(|_| self.focus.place.is_none())
    }

    /// `the desk with the hammer on it`: the hammer was spoken of too.
    fn mention_contents(&mut self, phrase: &Phrase, object: ObjectId) {
        let spoken: Vec<ObjectId> = phrase
            .relations
            .iter()
            .flat_map(|relation| {
                let is_it = |other: &&crate::known::KnownObject| relation.to.naming(other.class).is_some();
                self.scene.contents(object).filter(is_it).map(|other| other.id)
            })
            .collect();
        spoken.into_iter().for_each(|id| self.focus.mention(id));
    }

    pub(crate) fn go_to_object(&mut self, object: ObjectId) {
        let says = format!("going to {}", self.the(object));
        self.push(Action::GoTo { target: GoToTarget::Object(object) }, says);
    }

    pub(crate) fn go_to_room(&mut self, room: cohabit_cdf::RoomId) {
        let says = format!("going to the {}", room.name_in(self.catalog));
        self.push(Action::GoTo { target: GoToTarget::Room(room) }, says);
    }

    fn go_to_viewpoint(&mut self, room: cohabit_cdf::RoomId, number: u8) {
        let says = format!("going to viewpoint {number} in the {}", room.name_in(self.catalog));
        self.push(Action::GoTo { target: GoToTarget::Viewpoint(room, number) }, says);
    }

    /// Goes to what it knows; looks around for what it does not.
    fn find(&mut self, clause: &Clause) -> Result<(), Fault> {
        let settled = settle::settle(self, clause);
        let want = Want::object(clause.intent);
        for (index, phrase) in settled.objects.iter().enumerate() {
            let is_nameable = !phrase.namings.is_empty() || phrase.instance.is_some();
            match self.find_one(phrase, &want, Some(Role::Object(index))) {
                Ok(object) => self.go_to_object(object),
                Err(Fault::Miss { miss: Miss::Unseen, .. }) if is_nameable && self.looks_about() => {
                    self.notes.push(format!("I have not seen {} yet, so I look around for it", saying::said(phrase)));
                    phrase.room.into_iter().for_each(|room| self.go_to_room(room));
                    self.push(Action::LookAround, "looking around".to_owned());
                }
                Err(fault) => return Err(fault),
            }
        }
        Ok(())
    }

    fn travel(&mut self, clause: &Clause) -> Result<(), Fault> {
        let distance = match clause.amount {
            Some(Amount::Meters(distance) | Amount::Bare(distance)) => distance,
            Some(Amount::Degrees(_)) => return self.turn(clause),
            None => DEFAULT_MOVE_M,
        };
        // `step away from the table`
        let is_away = clause.places.iter().any(|(preposition, _)| *preposition == Preposition::From);
        if is_away && clause.direction.is_none() {
            return self.walk(-distance);
        }
        let has_target = clause.places.iter().any(|(_, place)| !matches!(place, Place::Side(_)));
        let is_measured = clause.amount.is_some();
        if clause.verb == "come" && !is_measured && self.comes_to_person(clause) {
            return Ok(());
        }
        match clause.direction {
            _ if has_target && !is_measured => self.go_to(clause),
            Some(Direction::Left | Direction::Right | Direction::Around) if !is_measured => self.turn(clause),
            Some(Direction::Left | Direction::Right | Direction::Around) => {
                self.turn(&Clause { amount: None, ..clause.clone() })?;
                self.walk(distance)
            }
            Some(Direction::Backward) if !is_measured && clause.verb == "come" => self.go_back(),
            Some(Direction::Backward) if !is_measured && clause.verb == "go" && self.focus.start_m.is_some() => {
                self.go_back()
            }
            Some(Direction::Backward) => self.walk(-distance),
            Some(Direction::Up | Direction::Down) => Err(Fault::Cannot("I can only move over the floor.".to_owned())),
            Some(Direction::Forward) | None if clause.places.is_empty() || is_measured => self.walk(distance),
            Some(Direction::Forward) | None => self.go_to(clause),
        }
    }

    /// `come here`: to who says so, if they are there.
    fn comes_to_person(&mut self, clause: &Clause) -> bool {
        let is_meant = matches!(clause.direction, None | Some(Direction::Backward));
        let is_here = clause.places.iter().all(|(_, place)| matches!(place, Place::Here));
        is_meant && is_here && self.go_to_person("coming to you")
    }

    /// Goes to who speaks, if they are there: before their eyes, or to their side if they are in one room already.
    pub(crate) fn go_to_person(&mut self, says: &str) -> bool {
        let Some(person) = self.scene.person else { return false };
        let ([x, y, _], [from_x, from_y, _]) = (person.position_m, self.scene.robot.position_m);
        let is_here = person.room == self.scene.robot.room;
        let way_rad = if is_here { (from_y - y).atan2(from_x - x) } else { person.yaw_rad };
        if is_here && (from_x - x).hypot(from_y - y) < BESIDE_M + 0.3 {
            self.notes.push("I am with you already".to_owned());
            return true;
        }
        let target = GoToTarget::Point([x + BESIDE_M * way_rad.cos(), y + BESIDE_M * way_rad.sin()]);
        self.push(Action::GoTo { target }, says.to_owned());
        true
    }

    pub(crate) fn walk(&mut self, distance_m: f32) -> Result<(), Fault> {
        if distance_m.abs() > LONGEST_MOVE_M {
            return Err(Fault::Cannot(format!("That is too far: I can go {LONGEST_MOVE_M} meters at a time.")));
        }
        let way = if distance_m < 0.0 { "back" } else { "forward" };
        let meters = distance_m.abs();
        let unit = if (meters - 1.0).abs() < 1e-3 { "meter" } else { "meters" };
        self.push(Action::Move { distance_m }, format!("moving {way} {} {unit}", plain_number(meters)));
        Ok(())
    }

    fn turn(&mut self, clause: &Clause) -> Result<(), Fault> {
        let is_aim = |(preposition, place): &&(Preposition, Place)| {
            *preposition == Preposition::To && matches!(place, Place::Object(_) | Place::Room(_))
        };
        if let Some(aim) = clause.places.iter().find(is_aim) {
            return self.go_to(&Clause { places: vec![aim.clone()], ..clause.clone() });
        }
        let is_open = match self.judge.asking {
            Asking::Never => false,
            Asking::Unsure => clause.amount.is_none(),
            Asking::Always => true,
        };
        if clause.direction.is_none() && is_open {
            return Err(Fault::Direction);
        }
        let around = clause.direction == Some(Direction::Around);
        let degrees = match clause.amount {
            // `turn a quarter to the right`
            Some(Amount::Bare(part)) if part > 0.0 && part < 1.0 => part * 360.0,
            Some(Amount::Degrees(degrees) | Amount::Bare(degrees)) => degrees,
            _ if around => 180.0,
            _ => DEFAULT_TURN_DEG,
        };
        if degrees > LARGEST_TURN_DEG {
            return Err(Fault::Cannot("That is too many turns for me.".to_owned()));
        }
        let is_left = clause.direction == Some(Direction::Left);
        self.rotate(if is_left { degrees } else { -degrees }, around);
        Ok(())
    }

    pub(crate) fn rotate(&mut self, degrees: f32, around: bool) {
        let way = match (around, degrees > 0.0) {
            (true, _) => "around",
            (false, true) => "left",
            (false, false) => "right",
        };
        self.push(Action::Rotate { yaw_rad: degrees.to_radians() }, format!("turning {way}"));
    }

    fn turn_to_side(&mut self, side: Side) {
        match side {
            Side::Left => self.rotate(DEFAULT_TURN_DEG, false),
            Side::Right => self.rotate(-DEFAULT_TURN_DEG, false),
            Side::Behind => self.rotate(-180.0, true),
            _ => self.push(Action::Move { distance_m: DEFAULT_MOVE_M }, "moving forward 1 meter".to_owned()),
        }
    }

    fn look(&mut self, clause: &Clause) {
        let degrees = match clause.amount {
            Some(Amount::Degrees(degrees) | Amount::Bare(degrees)) => degrees.min(LARGEST_LOOK_DEG),
            _ => DEFAULT_LOOK_DEG,
        };
        match clause.direction {
            Some(Direction::Up) => {
                self.push(Action::Look { pitch_rad: degrees.to_radians() }, "looking up".to_owned());
            }
            Some(Direction::Down) => {
                self.push(Action::Look { pitch_rad: -degrees.to_radians() }, "looking down".to_owned());
            }
            Some(Direction::Left) => self.rotate(DEFAULT_TURN_DEG, false),
            Some(Direction::Right) => self.rotate(-DEFAULT_TURN_DEG, false),
            Some(Direction::Backward) => self.rotate(-180.0, true),
            Some(Direction::Around) => self.push(Action::LookAround, "looking around".to_owned()),
            Some(Direction::Forward) | None => {
                self.push(Action::Look { pitch_rad: 0.0 }, "looking ahead".to_owned());
            }
        }
    }
}

fn plain_number(value: f32) -> String {
    let rounded = (value * 100.0).round() / 100.0;
    format!("{rounded}")
}

/// `move the bowl a bit to the left`: to nowhere that could be named.
fn shifts(clause: &Clause) -> bool {
    let is_way = |place: &(Preposition, Place)| matches!(place.1, Place::Side(Side::Left | Side::Right | Side::Middle));
    clause.manner == Some(Manner::Shift) && !clause.places.is_empty() && clause.places.iter().all(is_way)
}
