//! Plans of going, turning and looking.

use cohabit_cdf::{Action, GoToTarget, ObjectId, Property};

use crate::{
    ground::want::{Miss, Want},
    plan::{Fault, Planner, settle},
    read::{
        clause::{Amount, Clause},
        phrase::{Phrase, Place},
        saying,
        slot::Role,
    },
    understanding::Asking,
    words::{
        intent::Intent,
        lexicon::{Direction, NamedRoom, Preposition, Pronoun, Side},
        prose,
    },
};

/// How far from a person it stops that it comes to, m.
const BESIDE_M: f32 = 0.9;
/// Where nothing is said: how far to walk, turn and tilt the head.
const DEFAULT_MOVE_M: f32 = 1.0;
const DEFAULT_TURN_DEG: f32 = 90.0;
const DEFAULT_LOOK_DEG: f32 = 30.0;
/// Limits of one motion, beyond which somebody mistyped.
const LONGEST_MOVE_M: f32 = 30.0;
const LARGEST_TURN_DEG: f32 = 720.0;
const LARGEST_LOOK_DEG: f32 = 60.0;

impl Planner<'_> {
    pub(crate) fn go_to(&mut self, clause: &Clause) -> Result<(), Fault> {
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
            Place::Room(room) if !self.scene.may_have_room(room.id) => {
                return Err(Fault::Cannot(format!("There is no {} here.", room.name)));
            }
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
    pub(crate) fn find(&mut self, clause: &Clause) -> Result<(), Fault> {
        let settled = settle::settle(self, clause);
        let want = Want::object(clause.intent);
        for (index, phrase) in settled.objects.iter().enumerate() {
            let is_nameable = !phrase.namings.is_empty() || phrase.instance.is_some();
            match self.find_one(phrase, &want, Some(Role::Object(index))) {
                Ok(object) => self.go_to_object(object),
                Err(Fault::Miss { miss: Miss::Unseen, .. }) if is_nameable && self.looks_about() => {
                    let said = saying::said(phrase);
                    self.notes.push(format!("I have not seen {said} yet, so I look around for {}", prose::it(&said)));
                    phrase.room.into_iter().for_each(|room| self.go_to_room(room));
                    self.push(Action::LookAround, "looking around".to_owned());
                }
                Err(fault) => return Err(fault),
            }
        }
        Ok(())
    }

    pub(crate) fn travel(&mut self, clause: &Clause) -> Result<(), Fault> {
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

    pub(crate) fn turn(&mut self, clause: &Clause) -> Result<(), Fault> {
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

    /// Goes to a room, and looks around there.
    pub(crate) fn look_over(&mut self, room: &NamedRoom) -> Result<(), Fault> {
        if !self.scene.may_have_room(room.id) {
            return Err(Fault::Cannot(format!("There is no {} here.", room.name)));
        }
        if self.scene.robot.room != room.id {
            self.go_to_room(room.id);
        }
        self.push(Action::LookAround, "looking around".to_owned());
        Ok(())
    }

    pub(crate) fn look(&mut self, clause: &Clause) {
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
