//! Which of several candidates is meant: how probable each is, and whether that suffices.

use cohabit_cdf::{ClassId, ObjectId, Property, state::StateFlag};

use crate::{
    ground::{
        self, Described, Ground,
        confidence::{Doubt, Feature, Features},
        want::{Miss, Want},
    },
    known::{KnownObject, describe},
    read::phrase::Phrase,
    understanding::Asking,
    words::intent::Intent,
};

/// How far away counts, at most, m, and the unit in which it is counted.
const FARTHEST_M: f32 = 30.0;
const DISTANCE_UNIT_M: f32 = 10.0;
/// How much what was spoken of counts, the latest first.
const RECENCY: [f32; 3] = [1.0, 2.0 / 3.0, 1.0 / 3.0];
/// Candidates that are less probable than this part of the best are not asked about.
const RIVAL: f32 = 0.1;
/// Most candidates that a question is about.
const MOST_RIVALS: usize = 32;
/// What is named by no more than this is named by a word for many things.
const VAGUE_NAME: f32 = 0.6;
/// How likely the likeliest must be meant to count if it is in the room, whatever is elsewhere.
const HERE: f32 = 0.3;

impl<'a> Ground<'a> {
    /// The likeliest candidate, or all between which it would cost too much to guess.
    pub(crate) fn decide(&self, phrase: &Phrase, want: &Want<'_>, described: &Described<'a>) -> Result<ObjectId, Miss> {
        let ranked = self.ranked(phrase, want, described);
        let Some((_, best)) = ranked.first().copied() else { return Err(Miss::Unseen) };
        let may_settle = self.judge.repairs == 0
            && self.judge.asking == Asking::Unsure
            && !self.judge.is_for_good(want.intent, best.class);
        // The only one that is as described.
        let is_sole = described.left.len() == 1 && phrase.is_described() && phrase.unknown.is_empty();
        if may_settle && is_sole {
            return Ok(best.id);
        }
        if let Some(spoken) = self.spoken_of_kind(phrase, &described.left) {
            return Ok(spoken);
        }
        // Nothing but what is in the hand can be poured at once.
        let is_held = want.intent == Intent::Pour && self.scene.robot.held == Some(best.id);
        if is_held && phrase.naming(best.class).is_some() {
            return Ok(best.id);
        }
        let groups = self.told_apart(&ranked);
        let probability = groups.first().map_or(0.0, |(probability, _)| *probability);
        let rival = groups.get(1).map_or(0.0, |(probability, _)| *probability);
        if let Some(here) = self.likely_here(phrase, &groups).filter(|_| may_settle) {
            return Ok(here);
        }
        if !phrase.is_any && self.judge.asks(want.intent, best.class, probability, rival) {
            return Err(Miss::Several(ground::rivals(&groups, RIVAL)));
        }
        Ok(best.id)
    }

    /// `the table`, where the likeliest is in the room, and no other one there is likely: who means one elsewhere says where.
    fn likely_here(&self, phrase: &Phrase, groups: &[(f32, &KnownObject)]) -> Option<ObjectId> {
        let is_here = |object: &KnownObject| object.room == self.scene.robot.room;
        let ((probability, likeliest), others) = groups.split_first()?;
        let is_meant = *probability >= HERE && phrase.room.is_none() && !phrase.is_described() && is_here(likeliest);
        let has_rival = others.iter().any(|(other, object)| is_here(object) && *other >= probability * RIVAL);
        (is_meant && !has_rival).then_some(likeliest.id)
    }

    /// `the machine`, after the coffee machine was spoken of: a word for many things means the one at hand.
    fn spoken_of_kind(&self, phrase: &Phrase, left: &[&KnownObject]) -> Option<ObjectId> {
        let is_kind = !phrase.namings.is_empty() && phrase.namings.iter().all(|naming| naming.weight <= VAGUE_NAME);
        let mut spoken = self.focus.place.iter().chain(&self.focus.recent);
        spoken.find(|id| is_kind && !phrase.is_all && left.iter().any(|object| object.id == **id)).copied()
    }

    /// Those that are as described, with the probability of each, the likeliest first.
    pub(crate) fn ranked(
        &self,
        phrase: &Phrase,
        want: &Want<'_>,
        described: &Described<'a>,
    ) -> Vec<(f32, &'a KnownObject)> {
        let features: Vec<Features> = described.base.iter().map(|object| self.features(phrase, want, object)).collect();
        let (probabilities, _) = self.judge.weights.probabilities(&features, &self.doubt(phrase, &features));
        let is_left = |object: &KnownObject| described.left.iter().any(|left| left.id == object.id);
        let mut ranked: Vec<(f32, &KnownObject)> =
            probabilities.into_iter().zip(described.base.iter().copied()).filter(|(_, one)| is_left(one)).collect();
        // What is called white because others of its kind are painted may be none of the base.
        let others = described.left.iter().filter(|left| described.base.iter().all(|object| object.id != left.id));
        ranked.extend(others.map(|object| (0.0, *object)));
        ranked.sort_by(|(one, a), (other, b)| other.total_cmp(one).then(a.id.cmp(&b.id)));
        ranked
    }

    /// One of each kind that can be told apart in words, with the probability that it is one of that kind.
    pub(crate) fn told_apart(&self, ranked: &[(f32, &'a KnownObject)]) -> Vec<(f32, &'a KnownObject)> {
        let mut groups: Vec<(f32, &KnownObject)> = Vec::new();
        for (probability, object) in ranked {
            match groups.iter().position(|(_, seen)| self.is_told_alike(seen, object)) {
                Some(at) => groups[at].0 += probability,
                None if groups.len() < MOST_RIVALS => groups.push((*probability, object)),
                None => {}
            }
        }
        groups
    }

    /// Whether the same words describe both: they look alike, and so does what they are on.
    fn is_told_alike(&self, one: &KnownObject, other: &KnownObject) -> bool {
        let parent = |object: &KnownObject| object.parent.and_then(|parent| self.scene.object(parent));
        let is_same_place = one.room == other.room
            && match (parent(one), parent(other)) {
                (None, None) => true,
                (Some(one), Some(other)) => one.id == other.id || describe::look_alike(self.catalog, one, other),
                _ => false,
            };
        is_same_place && (describe::look_alike(self.catalog, one, other) || self.are_called_alike(one, other))
    }

    /// Whether each is also called by the name of the other, and of the same color, as the pieces of one worktop are.
    fn are_called_alike(&self, one: &KnownObject, other: &KnownObject) -> bool {
        let is_called = |class: ClassId, name: ClassId| {
            let (class, name) = (self.catalog.class(class), &self.catalog.class(name).name);
            std::iter::once(&class.name).chain(&class.words).any(|word| word.eq_ignore_ascii_case(name))
        };
        let [first, second] = [one, other].map(|object| self.catalog.class(object.class));
        let is_alike = first.tint.is_some() && first.tint == second.tint && !first.has(Property::Pickupable);
        is_alike && is_called(one.class, other.class) && is_called(other.class, one.class)
    }

    pub(crate) fn doubt(&self, phrase: &Phrase, candidates: &[Features]) -> Doubt {
        let has_mission = self.scene.objects.iter().any(|object| object.in_mission);
        Doubt::new(self.judge.repairs, phrase.unknown.len(), has_mission, candidates)
    }

    /// Whether it is behind a closed door: people speak of what they see.
    fn is_hidden(&self, object: &KnownObject) -> bool {
        let is_carried = self.catalog.class(object.class).has(Property::Pickupable);
        is_carried
            && self.scene.ancestors(object.id).next().is_some_and(|parent| {
                let class = self.catalog.class(parent.class);
                let encloses = class.receptacle.as_ref().is_some_and(|receptacle| receptacle.enclosed);
                encloses && class.has(Property::Openable) && !parent.has(StateFlag::Opened)
            })
    }

    /// What speaks for a candidate, and against it.
    pub(crate) fn features(&self, phrase: &Phrase, want: &Want<'_>, object: &KnownObject) -> Features {
        let is_held = self.scene.robot.held == Some(object.id);
        let is_here = object.room == self.scene.robot.room;
        let is_sought = want.intent == Intent::Find;
        let distance = self.scene.distance_m(object).min(FARTHEST_M) / DISTANCE_UNIT_M;
        let is_at = |place| self.scene.ancestors(object.id).any(|parent| parent.id == place);
        let recent = self.focus.recent.iter().position(|id| *id == object.id);
        let unrelated = phrase.relations.iter().filter(|relation| !self.is_related(object, relation)).count();
        let is_elsewhere = phrase.room.is_some_and(|room| object.room != room) || phrase.is_here && !is_here;
        let mut features = Features::default();
        features.set(Feature::Name, phrase.naming(object.class).unwrap_or(1.0));
        features
            .set_if(Feature::ColorMismatch, phrase.color.as_ref().is_some_and(|color| !self.has_color(object, color)));
        features.set_if(Feature::StateMismatch, phrase.states.iter().any(|state| !self.is_in_state(object, *state)));
        features.set_if(Feature::RoomMismatch, is_elsewhere);
        features.set(Feature::RelationMismatch, unrelated as f32);
        features.set_if(Feature::SameRoom, is_here);
        features.set_if(Feature::SameRoomSought, is_here && is_sought);
        features.set_if(Feature::Visible, object.visible || is_held);
        features.set_if(Feature::HeldFirst, is_held && want.held_first);
        features.set_if(Feature::StateFits, ground::fitting_state(want.intent, object) == Some(true));
        features.set_if(Feature::AtPlace, self.focus.place.is_some_and(is_at));
        features.set_if(Feature::Hidden, self.is_hidden(object));
        features.set_if(Feature::InMission, object.in_mission);
        features.set(Feature::Recency, recent.and_then(|at| RECENCY.get(at)).copied().unwrap_or_default());
        features.set(Feature::Distance, distance);
        features.set(Feature::DistanceSought, if is_sought { distance } else { 0.0 });
        features
    }
}
