//! A set of furniture arranged: where each part is, told from the first. Knows no room.

use cohabit_cdf::{Catalog, ClassId};

use super::table::{Part, Set, Side};
use crate::{
    chance::Chance,
    geometry::{Block, Turn},
};

/// Something in its place.
#[derive(Clone, Debug)]
pub struct Placed {
    /// What it is.
    pub class: ClassId,
    /// The middle of its foot, m: told from the first part of its set, in the world once it is in a room, or in the frame of what it stands on.
    pub at_m: [f32; 3],
    /// Where its front faces.
    pub turn: Turn,
    /// What it stands on, by its place in the list.
    pub on: Option<usize>,
    /// What its device works from or on.
    pub works: Option<usize>,
    /// Its size: depth, width and height, m.
    pub size_m: [f32; 3],
}

impl Placed {
    /// What it fills, if it stands on nothing else.
    pub fn block(&self) -> Option<Block> {
        self.on.is_none().then(|| Block::of(self.size_m, self.at_m, self.turn))
    }

    /// What it fills, also if it stands on another one of these; nothing, if that one stands on yet another.
    pub fn filled(&self, all: &[Self]) -> Option<Block> {
        let Some(holder) = self.on else { return self.block() };
        let holder = all.get(holder).filter(|holder| holder.on.is_none())?;
        let [dx, dy] = holder.turn.apply([self.at_m[0], self.at_m[1]]);
        let at_m = [holder.at_m[0] + dx, holder.at_m[1] + dy, holder.at_m[2] + self.at_m[2]];
        Some(Block::of(self.size_m, at_m, self.turn))
    }
}

/// The pieces of a set that are there, in an order in which holders come first.
#[derive(Clone, Debug)]
pub struct Arrangement {
    /// The pieces.
    pub pieces: Vec<Placed>,
    /// The rectangle around all that stands on no other piece.
    pub bounds: Block,
}

impl Arrangement {
    /// One thing alone.
    pub fn of(class: ClassId, catalog: &Catalog) -> Self {
        let size_m = catalog.class(class).size_m;
        let piece = Placed { class, at_m: [0.0; 3], turn: Turn::EAST, on: None, works: None, size_m };
        Self { bounds: Block::of(size_m, piece.at_m, piece.turn), pieces: vec![piece] }
    }

    /// Draws classes and parts of a set.
    pub(crate) fn draw(set: &Set, catalog: &Catalog, chance: &mut Chance) -> Option<Self> {
        let mut pieces: Vec<Placed> = Vec::new();
        // The piece of each part; none, if the part is left out.
        let mut piece_of: Vec<Option<usize>> = Vec::new();
        let is_mirrored = chance.is(0.5);
        for part in &set.parts {
            let class = catalog.find(chance.pick(&part.any)?)?;
            let is_there = part.share.is_none_or(|share| chance.is(share));
            let told_from = part.on.unwrap_or(part.of);
            let of = if piece_of.is_empty() { None } else { piece_of.get(told_from).copied().flatten() };
            if !is_there || !piece_of.is_empty() && of.is_none() {
                piece_of.push(None);
                continue;
            }
            let size_m = catalog.class(class).size_m;
            let works = part.works.and_then(|other| piece_of.get(other).copied().flatten());
            let piece = match of {
                None => {
                    let turn = Turn::of_degrees(part.turn_deg);
                    Placed { class, at_m: [0.0; 3], turn, on: None, works, size_m }
                }
                Some(of) => placed(part, class, size_m, of, &pieces, catalog, works),
            };
            piece_of.push(Some(pieces.len()));
            pieces.push(piece);
        }
        let arrangement = Self { bounds: bounds(&pieces)?, pieces };
        Some(if is_mirrored { arrangement.mirrored() } else { arrangement })
    }

    /// Left and right exchanged.
    fn mirrored(mut self) -> Self {
        for piece in &mut self.pieces {
            piece.at_m[1] = -piece.at_m[1];
            piece.turn = piece.turn.inverse();
        }
        let (low, high) = (self.bounds.low[1], self.bounds.high[1]);
        (self.bounds.low[1], self.bounds.high[1]) = (-high, -low);
        self
    }
}

fn bounds(pieces: &[Placed]) -> Option<Block> {
    pieces.iter().filter_map(Placed::block).reduce(|one, other| Block {
        low: [0, 1, 2].map(|axis| one.low[axis].min(other.low[axis])),
        high: [0, 1, 2].map(|axis| one.high[axis].max(other.high[axis])),
    })
}

/// A part in its place beside, over or on another one.
fn placed(
    part: &Part,
    class: ClassId,
    size_m: [f32; 3],
    of: usize,
    pieces: &[Placed],
    catalog: &Catalog,
    works: Option<usize>,
) -> Placed {
    let other = &pieces[of];
    let turned = Turn::of_degrees(part.turn_deg);
    if part.on.is_some() {
        let height = top_m(catalog, other.class, part.surface);
        let at_m = [part.at_m[0], part.at_m[1], height];
        return Placed { class, at_m, turn: other.turn.then(turned), on: Some(of), works, size_m };
    }
    if let Some(at_m) = part.button_m {
        return Placed { class, at_m, turn: Turn::EAST, on: None, works, size_m };
    }
    let back_m = (size_m[0] - other.size_m[0]) / 2.0;
    let (offset, turn, height) = match (part.side, part.over_m) {
        (_, Some(over_m)) => ([back_m, part.slide_m], Turn::EAST, over_m),
        (None, None) => ([0.0, 0.0], Turn::EAST, 0.0),
        (Some(side), None) => {
            let (offset, turn) = beside(part, side, size_m, other.size_m);
            (offset, turn, 0.0)
        }
    };
    let [dx, dy] = other.turn.apply(offset);
    let at_m = [other.at_m[0] + dx, other.at_m[1] + dy, other.at_m[2] + height];
    Placed { class, at_m, turn: other.turn.then(turn).then(turned), on: None, works, size_m }
}

/// Where something of a size is beside another, in the other's frame, and its turn there.
fn beside(part: &Part, side: Side, size_m: [f32; 3], other_m: [f32; 3]) -> ([f32; 2], Turn) {
    let out = match side {
        Side::Front => Turn::EAST,
        Side::Left => Turn::NORTH,
        Side::Back => Turn::WEST,
        Side::Right => Turn::SOUTH,
    };
    let turn = if part.faces { out.back() } else { Turn::EAST };
    let is_lateral = matches!(side, Side::Left | Side::Right);
    let own = turn.size([size_m[0], size_m[1]])[usize::from(is_lateral)];
    let across = (own + other_m[usize::from(is_lateral)]) / 2.0 + part.gap_m;
    // What faces the same way beside it has its back level with it.
    let level = if is_lateral && !part.faces { (size_m[0] - other_m[0]) / 2.0 } else { 0.0 };
    let [x, y] = out.apply([across, 0.0]);
    let offset = if is_lateral { [x + level + part.slide_m, y] } else { [x, y + part.slide_m] };
    (offset, turn)
}

/// The height of one of the surfaces that things are put on, or of the highest one, m.
fn top_m(catalog: &Catalog, class: ClassId, surface: Option<usize>) -> f32 {
    let class = catalog.class(class);
    let open = class.receptacle.as_ref().filter(|receptacle| !receptacle.enclosed);
    let mut heights_m = open.into_iter().flat_map(|receptacle| &receptacle.surfaces).map(|surface| surface.center_m[2]);
    let height_m = match surface {
        Some(index) => heights_m.nth(index),
        None => heights_m.max_by(f32::total_cmp),
    };
    height_m.unwrap_or(class.size_m[2])
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::{furniture::table::FurnitureTable, kind::Kind};

    fn check_sets(kind: Kind) {
        let (catalog, table) = (kind.catalog(), FurnitureTable::of(kind));
        let mut chance = Chance::new(1, 0);
        for set in &table.sets {
            for _ in 0..8 {
                let arrangement = Arrangement::draw(set, &catalog, &mut chance).unwrap();
                for (index, piece) in arrangement.pieces.iter().enumerate() {
                    for (place, other) in arrangement.pieces[..index].iter().enumerate() {
                        let (Some(one), Some(two)) = (piece.block(), other.block()) else { continue };
                        let is_button = piece.works == Some(place) || other.works == Some(index);
                        assert!(is_button || !one.overlaps(&two), "{}: {index} and {place}", set.name);
                    }
                }
            }
        }
    }

    #[test]
    fn no_two_parts_of_a_set_are_in_one_place() {
        Kind::ALL.into_iter().for_each(check_sets);
    }

    #[test]
    fn a_bed_along_a_wall_has_its_nightstand_at_its_head() {
        let (catalog, table) = (Kind::Home.catalog(), FurnitureTable::of(Kind::Home));
        let set = table.set("single bed along the wall");
        let arrangement = Arrangement::draw(&set, &catalog, &mut Chance::new(1, 0)).unwrap();
        let [bed, stand] = [0, 1].map(|index| &arrangement.pieces[index]);
        assert!([Turn::NORTH, Turn::SOUTH].contains(&bed.turn) && stand.turn == Turn::EAST);
        let [bed_block, stand_block] = [bed, stand].map(|piece| piece.block().unwrap());
        assert!((bed_block.low[0] - stand_block.low[0]).abs() < 1e-3, "their backs are level");
        let [_, head] = bed.turn.apply([-1.0, 0.0]);
        assert!((stand.at_m[1] - bed.at_m[1]) * head > 1.0, "{:?}", stand.at_m);
    }

    #[test]
    fn what_is_put_on_something_stands_on_its_highest_surface_or_another_one() {
        let catalog = Kind::Home.catalog();
        let top_of = |class: &str, surface| top_m(&catalog, catalog.find(class).unwrap(), surface);
        assert_eq!((top_of("TV_Stand", None), top_of("TV_Stand", Some(1))), (0.5, 0.296));
        assert_eq!(top_of("Nightstand", None), 0.55);
        assert_eq!(top_of("Wardrobe", None), 2.0);
    }

    #[test]
    fn a_chair_faces_its_desk() {
        let (catalog, table) = (Kind::Office.catalog(), FurnitureTable::of(Kind::Office));
        let set = table.set("manager's desk");
        let arrangement = Arrangement::draw(&set, &catalog, &mut Chance::new(1, 0)).unwrap();
        let chair = &arrangement.pieces[1];
        assert_eq!((chair.turn, chair.at_m[1]), (Turn::WEST, 0.0));
        assert!((chair.at_m[0] - (0.45 + 0.12 + 0.35)).abs() < 1e-5, "{:?}", chair.at_m);
    }
}
