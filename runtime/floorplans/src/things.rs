//! Small things on and in furniture, by the tables in `data`. `data/office/things.toml` says what the fields mean.

use cohabit_cdf::{
    Catalog, ClassId, ObjectClass, RoomId,
    catalog::{Receptacle, Surface},
};
use serde::Deserialize;

use crate::{chance::Chance, furniture::Placed, geometry::Block, kind::Kind};

/// The files of each kind of building.
const OFFICE: &[&str] = &[include_str!("../data/office/things.toml")];
// Those that name rooms come first: the first entry that is meant counts.
const HOME: &[&str] = &[
    include_str!("../data/home/things_bedrooms.toml"),
    include_str!("../data/home/things_bathrooms.toml"),
    include_str!("../data/home/things_kitchen.toml"),
    include_str!("../data/home/things_living.toml"),
    include_str!("../data/home/things_workrooms.toml"),
];

/// Half the width of what stands on an anchor, m, as plans are checked by.
const ANCHOR_M: f32 = 0.06;
/// Between two things on a surface, m.
const APART_M: f32 = 0.01;
/// The largest turn of a thing against its holder, degrees, beside quarter turns; and its sine.
const TURN_DEG: i32 = 12;
const TURN_SINE: f32 = 0.208;
/// Places that are tried for a thing.
const TRIES: usize = 12;
/// Kept free around what is put near a point, m.
const SPARE_M: f32 = 0.002;
/// As many that each has to fit on an anchor beside others.
const SEVERAL: usize = 2;

/// What is on and in furniture.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ThingTable {
    #[serde(rename = "on")]
    entries: Vec<Entry>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    holders: Vec<String>,
    /// All of them, if empty.
    #[serde(default)]
    rooms: Vec<RoomId>,
    count: [usize; 2],
    /// Whether these are what a holder with keys takes.
    #[serde(default)]
    keys: bool,
    /// Whether they are put at its anchors, whatever the room that these leave beside each other.
    #[serde(default)]
    anchors: bool,
    /// Whether they lie square to it.
    #[serde(default)]
    square: bool,
    things: Vec<Prior>,
}

/// How likely something is there.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Prior {
    any: Vec<String>,
    weight: f32,
    #[serde(default = "one")]
    most: usize,
}

const fn one() -> usize {
    1
}

/// A small thing on or in a piece of furniture.
#[derive(Clone, Debug)]
pub struct Thing {
    /// What it is.
    pub class: ClassId,
    /// What it is on or in, by its place among the furniture of the room.
    pub holder: usize,
    /// Where, in the frame of its holder, m; at the next free anchor, if absent.
    pub at_m: Option<[f32; 3]>,
    /// Its yaw in the world, degrees.
    pub yaw_deg: f32,
}

/// A level rectangle in the frame of a holder: what a thing covers.
#[derive(Clone, Copy, Debug)]
struct Cover {
    middle: [f32; 2],
    half: [f32; 2],
    height_m: f32,
}

impl ThingTable {
    /// That of a kind of building.
    pub fn of(kind: Kind) -> Self {
        let files = if kind == Kind::Office { OFFICE } else { HOME };
        files.iter().fold(Self::default(), |mut table, text| {
            let file: Self = toml::from_str(text).expect("invariant: the table of things parses");
            table.entries.extend(file.entries);
            table
        })
    }

    /// What is on a class of furniture in a room.
    fn entry(&self, holder: &str, room: RoomId) -> Option<&Entry> {
        let is_meant = |entry: &&Entry| {
            entry.holders.iter().any(|class| class == holder) && (entry.rooms.is_empty() || entry.rooms.contains(&room))
        };
        self.entries.iter().find(is_meant)
    }

    /// Draws what is on and in the furniture of a room.
    pub fn fill(&self, furniture: &[Placed], room: RoomId, catalog: &Catalog, chance: &mut Chance) -> Vec<Thing> {
        let mut things = Vec::new();
        for (index, placed) in furniture.iter().enumerate() {
            let class = catalog.class(placed.class);
            let Some(receptacle) = &class.receptacle else { continue };
            let Some(entry) = self.entry(&class.id, room).filter(|entry| entry.keys != receptacle.keys.is_empty())
            else {
                continue;
            };
            let holder = Holder { index, placed, receptacle, around: around(furniture, index), catalog };
            things.extend(holder.fill(entry, covers(furniture, index), chance));
        }
        things
    }
}

/// What a piece of furniture covers of the one that it stands on.
fn cover_of(piece: &Placed, holder: usize, placed: &Placed) -> Option<Cover> {
    (piece.on == Some(holder)).then(|| {
        let turn = placed.turn.inverse().then(piece.turn);
        let half = turn.size([piece.size_m[0] / 2.0, piece.size_m[1] / 2.0]);
        Cover { middle: [piece.at_m[0], piece.at_m[1]], half, height_m: piece.at_m[2] }
    })
}

/// A piece of furniture that takes things.
#[derive(Debug)]
struct Holder<'a> {
    index: usize,
    placed: &'a Placed,
    receptacle: &'a Receptacle,
    /// What all other furniture fills.
    around: Vec<Block>,
    catalog: &'a Catalog,
}

impl Holder<'_> {
    fn fill(&self, entry: &Entry, mut covers: Vec<Cover>, chance: &mut Chance) -> Vec<Thing> {
        let (mut things, mut drawn) = (Vec::new(), vec![0; entry.things.len()]);
        let wanted = entry.count[0] + chance.below(entry.count[1] + 1 - entry.count[0]);
        let covered = self.covered(&covers);
        for _ in 0..wanted {
            let weights: Vec<f32> = (entry.things.iter().zip(&drawn))
                .map(|(prior, drawn)| if *drawn < prior.most { prior.weight } else { 0.0 })
                .collect();
            if weights.iter().all(|weight| *weight == 0.0) {
                break;
            }
            let kind = chance.weighted(weights.iter().copied());
            drawn[kind] += 1;
            let class = chance.pick(&entry.things[kind].any).and_then(|id| self.catalog.find(id));
            let Some(class) = class else { continue };
            let thing = if entry.anchors {
                self.at_some_anchor(class, things.len() + covered)
            } else if self.has_anchors_alone() {
                self.at_anchor(class, things.len(), wanted)
            } else {
                self.somewhere(class, &mut covers, entry.square, chance)
            };
            things.extend(thing);
        }
        things
    }

    /// Whether things are put at its anchors: it is shut, takes keys, or its places lie otherwise in a mirror.
    fn has_anchors_alone(&self) -> bool {
        let Receptacle { enclosed, keys, surfaces, .. } = self.receptacle;
        *enclosed || !keys.is_empty() || surfaces.iter().any(|surface| surface.center_m[1] != 0.0)
    }

    /// How many of its anchors may be taken: half of them stay free for missions.
    fn most_taken(&self) -> usize {
        let anchors =
            self.receptacle.surfaces.iter().map(|surface| surface.anchors[0] * surface.anchors[1]).sum::<u32>();
        if anchors <= 1 || !self.receptacle.keys.is_empty() { anchors as usize } else { anchors as usize / 2 }
    }

    fn at_anchor(&self, class: ClassId, taken: usize, wanted: usize) -> Option<Thing> {
        let is_alone = wanted == 1 || !self.receptacle.keys.is_empty();
        let kind = self.catalog.class(class);
        let fits =
            |quarter: bool| self.receptacle.surfaces.iter().all(|surface| is_fit(kind, surface, quarter, is_alone));
        let quarter = [false, true].into_iter().find(|quarter| fits(*quarter))?;
        let yaw_deg = self.placed.turn.yaw_deg() + if quarter { 90.0 } else { 0.0 };
        (taken < self.most_taken()).then(|| Thing {
            class,
            holder: self.index,
            at_m: None,
            yaw_deg: within_turn(yaw_deg),
        })
    }

    /// At the next free anchor below which it is not too high.
    fn at_some_anchor(&self, class: ClassId, taken: usize) -> Option<Thing> {
        let height_m = self.catalog.class(class).size_m[2];
        let is_fit = self.receptacle.surfaces.iter().any(|surface| height_m <= surface.clearance_m);
        let yaw_deg = within_turn(self.placed.turn.yaw_deg());
        (is_fit && taken < self.most_taken()).then_some(Thing { class, holder: self.index, at_m: None, yaw_deg })
    }

    /// A free place on one of its surfaces.
    fn somewhere(
        &self,
        class: ClassId,
        covers: &mut Vec<Cover>,
        is_square: bool,
        chance: &mut Chance,
    ) -> Option<Thing> {
        let kind = self.catalog.class(class);
        for _ in 0..TRIES {
            let surface = chance.pick(&self.receptacle.surfaces)?;
            let (quarter, aside_deg) = (chance.below(4) as i32, chance.whole(-TURN_DEG, TURN_DEG));
            let (aside_deg, sine) = if is_square { (0, 0.0) } else { (aside_deg, TURN_SINE) };
            let [depth, width, height] = kind.size_m;
            let [depth, width] = if quarter % 2 == 0 { [depth, width] } else { [width, depth] };
            let half = [depth + width * sine, width + depth * sine].map(|side| side / 2.0);
            if height > surface.clearance_m || (0..2).any(|axis| half[axis] * 2.0 > surface.size_m[axis]) {
                continue;
            }
            let at = |axis: usize, chance: &mut Chance| {
                let aside = surface.size_m[axis] / 2.0 - half[axis];
                ((surface.center_m[axis] + chance.between(-aside, aside)) * 100.0).round() / 100.0
            };
            let cover = Cover { middle: [at(0, chance), at(1, chance)], half, height_m: surface.center_m[2] };
            let is_taken = covers.iter().any(|other| cover.touches(other)) || self.is_behind_something(cover, height);
            if is_taken || self.is_crowded(covers, cover) {
                continue;
            }
            covers.push(cover);
            let at_m = Some([cover.middle[0], cover.middle[1], cover.height_m]);
            let yaw_deg = within_turn(self.placed.turn.yaw_deg() + (quarter * 90 + aside_deg) as f32);
            return Some(Thing { class, holder: self.index, at_m, yaw_deg });
        }
        None
    }

    /// The free place for a thing with a yaw in the world that is nearest to a point.
    fn nearest(&self, class: ClassId, near_m: [f32; 3], yaw_deg: f32, covers: &[Cover]) -> Option<Cover> {
        let [depth, width, height] = self.catalog.class(class).size_m;
        let turn = (yaw_deg - self.placed.turn.yaw_deg()).to_radians();
        let [sin, cos] = [libm::sinf(turn).abs(), libm::cosf(turn).abs()];
        // A little more, so that rounding decides nothing where anchors are counted.
        let half = [depth * cos + width * sin, depth * sin + width * cos].map(|side| side / 2.0 + SPARE_M);
        let fits = |surface: &&Surface| {
            height <= surface.clearance_m && (0..2).all(|axis| half[axis] * 2.0 <= surface.size_m[axis])
        };
        let mut surfaces: Vec<&Surface> = self.receptacle.surfaces.iter().filter(fits).collect();
        let above = |surface: &Surface| (surface.center_m[2] - near_m[2]).abs();
        surfaces.sort_by(|one, other| above(one).total_cmp(&above(other)));
        let is_free = |cover: &Cover| {
            !covers.iter().any(|other| cover.touches(other))
                && !self.is_behind_something(*cover, height)
                && !self.is_crowded(covers, *cover)
        };
        surfaces.into_iter().find_map(|surface| lattice(surface, half, near_m).into_iter().find(is_free))
    }

    /// Whether what hangs above or stands beside the holder is where a thing of this height would be.
    fn is_behind_something(&self, cover: Cover, height_m: f32) -> bool {
        let [x, y, z] = self.placed.at_m;
        let [dx, dy] = self.placed.turn.apply(cover.middle);
        let size_m = [cover.half[0] * 2.0, cover.half[1] * 2.0, height_m];
        let block = Block::of(size_m, [x + dx, y + dy, z + cover.height_m], self.placed.turn);
        self.around.iter().any(|other| other.overlaps(&block.grown(APART_M)))
    }

    /// Whether more than half of the anchors would be covered.
    fn is_crowded(&self, covers: &[Cover], more: Cover) -> bool {
        let all: Vec<Cover> = covers.iter().copied().chain([more]).collect();
        self.covered(&all) > self.most_taken()
    }

    /// How many of the anchors are covered.
    fn covered(&self, covers: &[Cover]) -> usize {
        let anchors = self.receptacle.surfaces.iter().flat_map(anchors);
        anchors.filter(|at| covers.iter().any(|cover| cover.has_anchor(*at))).count()
    }
}

/// The free places on and in a piece of furniture, which things are put into one by one: each near where it is wanted.
#[derive(Debug)]
pub struct Places<'a> {
    holder: Holder<'a>,
    covers: Vec<Cover>,
    /// How many anchors are taken.
    taken: usize,
}

impl<'a> Places<'a> {
    /// Of one piece of the furniture of a room; nothing, if it takes no things.
    pub fn of(furniture: &'a [Placed], index: usize, catalog: &'a Catalog) -> Option<Self> {
        let placed = furniture.get(index)?;
        let receptacle = catalog.class(placed.class).receptacle.as_ref()?;
        let holder = Holder { index, placed, receptacle, around: around(furniture, index), catalog };
        Some(Self { holder, covers: covers(furniture, index), taken: 0 })
    }

    /// Puts a thing at the free place that is nearest to a point in the frame of the furniture, turned as it is wanted (degrees, in the
    /// world) or, where that does not fit, by a quarter; nothing, if no place is free.
    pub fn put(&mut self, class: ClassId, near_m: [f32; 3], yaw_deg: f32) -> Option<Thing> {
        let (id, receptacle) = (&self.holder.catalog.class(class).id, self.holder.receptacle);
        let is_taken = receptacle.keys.is_empty() || receptacle.keys.contains(id);
        if !is_taken || receptacle.refuses.contains(id) {
            return None;
        }
        if self.holder.has_anchors_alone() {
            let thing = self.holder.at_anchor(class, self.taken, SEVERAL)?;
            self.taken += 1;
            return Some(thing);
        }
        let own_deg = self.holder.placed.turn.yaw_deg();
        let yaws = [yaw_deg, own_deg, own_deg + 90.0];
        let found = |yaw_deg: f32| Some((self.holder.nearest(class, near_m, yaw_deg, &self.covers)?, yaw_deg));
        let (cover, yaw_deg) = yaws.into_iter().find_map(found)?;
        self.covers.push(cover);
        let at_m = Some([cover.middle[0], cover.middle[1], cover.height_m]);
        Some(Thing { class, holder: self.holder.index, at_m, yaw_deg: within_turn(yaw_deg) })
    }
}

/// What stands on a piece of furniture covers of it.
fn covers(furniture: &[Placed], index: usize) -> Vec<Cover> {
    furniture.iter().filter_map(|other| cover_of(other, index, &furniture[index])).collect()
}

/// What all furniture but one piece fills.
fn around(furniture: &[Placed], index: usize) -> Vec<Block> {
    let others = furniture.iter().enumerate().filter(|(other, _)| *other != index);
    others.filter_map(|(_, other)| other.filled(furniture)).collect()
}

/// Whether a thing fits on each anchor of a surface, turned by a quarter or not, beside its like.
fn is_fit(kind: &ObjectClass, surface: &Surface, quarter: bool, is_alone: bool) -> bool {
    let [depth, width, height] = kind.size_m;
    let sides = if quarter { [width, depth] } else { [depth, width] };
    let places = if is_alone { [1, 1] } else { surface.anchors };
    let is_beside = (0..2).all(|axis| sides[axis] <= surface.size_m[axis] / places[axis] as f32 + ANCHOR_M / 2.0);
    height <= surface.clearance_m && is_beside
}

/// Places on a surface for what covers twice `half`, those near a point first.
fn lattice(surface: &Surface, half: [f32; 2], near_m: [f32; 3]) -> Vec<Cover> {
    /// Between two of them, m.
    const STEP_M: f32 = 0.04;
    let along = |axis: usize| {
        let aside = surface.size_m[axis] / 2.0 - half[axis];
        let count = (aside / STEP_M) as i32;
        // To the centimetre, as things are put down by hand.
        (-count..=count).map(move |step| ((surface.center_m[axis] + step as f32 * STEP_M) * 100.0).round() / 100.0)
    };
    let height_m = surface.center_m[2];
    let all = along(0).flat_map(|x| along(1).map(move |y| Cover { middle: [x, y], half, height_m }));
    let mut all: Vec<Cover> = all.collect();
    let away = |cover: &Cover| {
        let [x, y] = [0, 1].map(|axis| cover.middle[axis] - near_m[axis]);
        x * x + y * y
    };
    all.sort_by(|one, other| away(one).total_cmp(&away(other)));
    all
}

/// The anchors of a surface.
fn anchors(surface: &Surface) -> impl Iterator<Item = [f32; 3]> + '_ {
    let along = |axis: usize, index: u32| {
        let share = (index as f32 + 0.5) / surface.anchors[axis] as f32 - 0.5;
        surface.center_m[axis] + surface.size_m[axis] * share
    };
    let all = (0..surface.anchors[0]).flat_map(|x| (0..surface.anchors[1]).map(move |y| (x, y)));
    all.map(move |(x, y)| [along(0, x), along(1, y), surface.center_m[2]])
}

impl Cover {
    fn touches(&self, other: &Self) -> bool {
        let is_near =
            |axis: usize| (self.middle[axis] - other.middle[axis]).abs() < self.half[axis] + other.half[axis] + APART_M;
        self.is_level(other.height_m) && is_near(0) && is_near(1)
    }

    fn has_anchor(&self, [x, y, z]: [f32; 3]) -> bool {
        let is_over = |axis: usize, at: f32| (self.middle[axis] - at).abs() < self.half[axis] + ANCHOR_M;
        self.is_level(z) && is_over(0, x) && is_over(1, y)
    }

    fn is_level(&self, height_m: f32) -> bool {
        (self.height_m - height_m).abs() < 0.02
    }
}

/// The same yaw from -180 to 180 degrees.
fn within_turn(yaw_deg: f32) -> f32 {
    let yaw_deg = yaw_deg % 360.0;
    if yaw_deg > 180.0 {
        yaw_deg - 360.0
    } else if yaw_deg <= -180.0 {
        yaw_deg + 360.0
    } else {
        yaw_deg
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn check_names(kind: Kind) {
        let (catalog, table) = (kind.catalog(), ThingTable::of(kind));
        for entry in &table.entries {
            for holder in &entry.holders {
                let class = catalog.class(catalog.find(holder).unwrap());
                let receptacle = class.receptacle.as_ref().unwrap();
                for id in entry.things.iter().flat_map(|prior| &prior.any) {
                    let thing = catalog.class(catalog.find(id).unwrap_or_else(|| panic!("there is no `{id}`")));
                    let is_fit = |surface: &Surface| {
                        let fits = |quarter: bool| is_fit(thing, surface, quarter, true);
                        if entry.anchors { thing.size_m[2] <= surface.clearance_m } else { fits(false) || fits(true) }
                    };
                    assert!(receptacle.surfaces.iter().any(is_fit), "`{id}` does not fit on `{holder}`");
                    assert_eq!(entry.keys, receptacle.keys.contains(id), "`{id}` and the keys of `{holder}`");
                }
            }
        }
    }

    #[test]
    fn all_that_the_tables_name_is_there_and_fits_somewhere() {
        Kind::ALL.into_iter().for_each(check_names);
    }
}
