//! Where things usually are: counted in the built-in floor plans, so that a search begins where it is likely to end.

use std::{collections::BTreeMap, sync::LazyLock};

use cohabit_cdf::{Catalog, ClassId, Layout, ObjectClass, Property, RoomId, catalog::Stands};

/// How much another class's place says, where it affords all the same: less than the class's own.
const LIKENESS: f32 = 0.3;
/// What every room has of any class, so that none is never looked at.
const ANYWHERE: f32 = 0.02;
/// The share of small things that are behind doors, where the plans say nothing.
const ENCLOSED: f32 = 0.2;
/// What reaches no higher is out of view of who stands beside it and looks straight ahead, m.
const LOW_M: f32 = 0.6;
/// The least share of small things that lie low, whatever the plans say: on floors, in baskets, on low shelves.
const LOWLY: f32 = 0.25;

/// An instance, its room, what it is on or in, and how high above the floor or that, m.
type Placed = (String, RoomId, Option<String>, f32);

/// What stands in the built-in plans. Read once, for all languages.
static PLACES: LazyLock<Vec<Placed>> =
    LazyLock::new(|| placed(Layout::builtin_ids().iter().filter_map(|id| Layout::builtin(id).ok())));

/// What stands in the plans of world packs.
fn places_of_packs(catalog: &Catalog) -> Vec<Placed> {
    if catalog.packs().is_empty() {
        return Vec::new();
    }
    let (built_in, all) = (Layout::builtin_ids(), Layout::ids(catalog));
    placed(all.iter().filter(|id| !built_in.contains(id)).filter_map(|id| Layout::find(id, catalog).ok()))
}

fn placed(layouts: impl Iterator<Item = Layout>) -> Vec<Placed> {
    // Mirrored plans hold the same things in the same rooms.
    let placements = layouts.filter(|layout| !layout.id.ends_with("_mirror")).flat_map(|layout| layout.placements);
    placements.map(|placement| (placement.instance, placement.room, placement.on, placement.at_m[2])).collect()
}

/// Counts of classes by room, by what encloses them, and of those behind no door: of all, and of those that lie low.
#[derive(Debug)]
pub(crate) struct Habits {
    /// By the index of rooms.
    rooms: BTreeMap<ClassId, Vec<f32>>,
    enclosed: BTreeMap<(ClassId, ClassId), f32>,
    open: BTreeMap<ClassId, f32>,
    low: BTreeMap<ClassId, f32>,
}

impl Habits {
    /// Counts in the built-in plans, and in those of world packs, what the catalogue has.
    pub(crate) fn new(catalog: &Catalog) -> Self {
        let none = vec![0.0; catalog.rooms().all().len()];
        let (rooms, enclosed) = (BTreeMap::new(), BTreeMap::new());
        let mut habits = Self { rooms, enclosed, open: BTreeMap::new(), low: BTreeMap::new() };
        for (instance, room, on, up_m) in PLACES.iter().chain(&places_of_packs(catalog)) {
            let Some(class) = catalog.class_of_instance(instance) else { continue };
            let Some(index) = catalog.room_index(*room) else { continue };
            habits.rooms.entry(class).or_insert_with(|| none.clone())[usize::from(index)] += 1.0;
            let place = on.as_deref().and_then(|on| catalog.class_of_instance(on));
            let encloses =
                |place: &ClassId| catalog.class(*place).receptacle.as_ref().is_some_and(|kind| kind.enclosed);
            if let Some(place) = place.filter(encloses) {
                *habits.enclosed.entry((class, place)).or_default() += 1.0;
                continue;
            }
            *habits.open.entry(class).or_default() += 1.0;
            let foot_m = if on.is_some() { place.and_then(|place| top_m(catalog.class(place))) } else { Some(*up_m) };
            if foot_m.is_some_and(|foot_m| foot_m + catalog.class(class).size_m[2] < LOW_M) {
                *habits.low.entry(class).or_default() += 1.0;
            }
        }
        habits
    }

    /// How likely a thing of one of these classes is in each room, by its index; the sum is 1.
    pub(crate) fn by_room(&self, catalog: &Catalog, classes: &[ClassId]) -> Vec<f32> {
        let mut sums = vec![ANYWHERE; catalog.rooms().all().len()];
        for (class, counts) in &self.rooms {
            let weight = weight(catalog, classes, *class);
            let all: f32 = counts.iter().sum();
            sums.iter_mut().zip(counts).for_each(|(sum, count)| *sum += weight * count / all);
        }
        let all: f32 = sums.iter().sum();
        sums.into_iter().map(|sum| sum / all).collect()
    }

    /// How likely such a thing is in something of class `place` with a closed door, if one of those is where it is.
    pub(crate) fn inside(&self, catalog: &Catalog, classes: &[ClassId], place: ClassId) -> f32 {
        let sum = |counts: &mut dyn Iterator<Item = (ClassId, f32)>| -> f32 {
            counts.map(|(class, count)| weight(catalog, classes, class) * count).sum()
        };
        let kept = self.enclosed.iter().filter(|((_, at), _)| *at == place);
        let inside = sum(&mut kept.map(|((class, _), count)| (*class, *count)));
        let all = sum(&mut self.rooms.iter().map(|(class, counts)| (*class, counts.iter().sum())));
        if all <= 0.0 { ENCLOSED / 2.0 } else { (inside + ENCLOSED * ANYWHERE) / (all + ANYWHERE) }
    }

    /// How likely such a thing lies low, if it is behind no door; nothing that is not carried does, for all it matters.
    pub(crate) fn low(&self, catalog: &Catalog, classes: &[ClassId]) -> f32 {
        let may_lie_low = |class: &ObjectClass| class.has(Property::Pickupable) && class.size_m[2] < LOW_M;
        if !classes.iter().any(|class| may_lie_low(catalog.class(*class))) {
            return 0.0;
        }
        let sum = |counts: &BTreeMap<ClassId, f32>| -> f32 {
            counts.iter().map(|(class, count)| weight(catalog, classes, *class) * count).sum()
        };
        let (low, open) = (sum(&self.low), sum(&self.open));
        let counted = if open > 0.0 { low / open } else { 0.0 };
        LOWLY + (1.0 - LOWLY) * counted
    }

    /// How often things of this class, or of its kind, are in what encloses them, by the class of that.
    pub(crate) fn kept_in(&self, catalog: &Catalog, class: ClassId) -> BTreeMap<ClassId, f32> {
        let mut kept = BTreeMap::new();
        for ((other, place), count) in &self.enclosed {
            let is_kin = || are_kin(catalog.class(class), catalog.class(*other));
            let weight = if *other == class {
                1.0
            } else if is_kin() {
                LIKENESS
            } else {
                continue;
            };
            *kept.entry(*place).or_default() += weight * count;
        }
        kept
    }
}

/// How high above the floor the highest place for things is of what stands on it, m.
fn top_m(class: &ObjectClass) -> Option<f32> {
    let kind = class.receptacle.as_ref().filter(|_| class.stands == Stands::OnFloor)?;
    kind.surfaces.iter().map(|surface| surface.center_m[2]).reduce(f32::max)
}

/// Whether two classes have a word in common that people call them by: a doll and a teddy are toys.
fn are_kin(one: &ObjectClass, other: &ObjectClass) -> bool {
    let words = |class: &ObjectClass| -> Vec<String> {
        class.words.iter().chain([&class.name]).map(|word| word.to_lowercase()).collect()
    };
    let theirs = words(other);
    words(one).iter().any(|word| theirs.contains(word))
}

/// How much the place of a thing of class `other` says about those classes.
fn weight(catalog: &Catalog, classes: &[ClassId], other: ClassId) -> f32 {
    if classes.contains(&other) {
        return 1.0;
    }
    let other = catalog.class(other);
    let likeness = |class: &ClassId| likeness(catalog.class(*class), other);
    let best = classes.iter().map(likeness).fold(0.0, f32::max);
    LIKENESS * best * best * best / 8.0
}

/// The share of what either affords that both afford.
fn likeness(one: &ObjectClass, other: &ObjectClass) -> f32 {
    let is_carried = |class: &ObjectClass| class.has(Property::Pickupable);
    if is_carried(one) != is_carried(other) {
        return 0.0;
    }
    let both = one.properties.iter().filter(|property| other.has(**property)).count() as f32;
    let either = (one.properties.len() + other.properties.len()) as f32 - both;
    if either > 0.0 { both / either } else { 0.0 }
}
