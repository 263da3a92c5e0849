//! A room that is being furnished: what is in it, and what must stay free.

use cohabit_cdf::{Catalog, ObjectClass, Property};

use super::arrange::{Arrangement, Placed};
use crate::{
    geometry::{Block, HALF_WALL_M, Rect, Turn, Wall, is_clear, rounded, walls},
    ground::{Ground, Usable},
};

/// Height of all rooms, m.
pub const WALL_HEIGHT_M: f32 = 2.8;
/// Between two things that do not belong together, m.
const APART_M: f32 = 0.03;
/// Rounding, m.
const SLACK_M: f32 = 0.002;

/// The room.
#[derive(Clone, Debug)]
pub struct Site<'a> {
    /// All classes.
    pub catalog: &'a Catalog,
    /// Its floor.
    pub rects: Vec<Rect>,
    /// Its walls.
    pub walls: Vec<Wall>,
    /// Where windows are: in which wall, and their middles along it, dm.
    pub windows: Vec<(Wall, i32)>,
    /// What must stay free: before doors, in windows, before switches.
    pub kept_free: Vec<Block>,
    pub(crate) ground: Ground,
    /// What is in it.
    pub placed: Vec<Placed>,
}

impl<'a> Site<'a> {
    /// An empty room with doors at these places of its walls.
    pub fn new(catalog: &'a Catalog, rects: &[Rect], doors: &[(Wall, i32)], kept_free: Vec<Block>) -> Self {
        Self {
            catalog,
            rects: rects.to_vec(),
            walls: walls(rects),
            windows: Vec::new(),
            kept_free,
            ground: Ground::new(rects, doors),
            placed: Vec::new(),
        }
    }

    /// Its floor, m².
    pub fn area_m2(&self) -> f32 {
        self.rects.iter().map(|rect| rect.area_m2()).sum()
    }

    /// Puts an arrangement down, if there is room for it and all stays in reach; says whether it did.
    pub fn try_place(&mut self, arrangement: &Arrangement, origin_m: [f32; 3], turn: Turn) -> bool {
        let Some(pieces) = self.fitted(arrangement, origin_m, turn) else { return false };
        let blocks: Vec<Block> = pieces.iter().filter_map(Placed::block).collect();
        let usables: Vec<Usable> = pieces.iter().filter_map(|piece| self.usable(piece)).collect();
        if !self.ground.try_add(&blocks, &usables) {
            return false;
        }
        self.placed.extend(pieces);
        true
    }

    /// Whether there is room for an arrangement, whatever is then out of reach.
    pub fn is_free_for(&self, arrangement: &Arrangement, origin_m: [f32; 3], turn: Turn) -> bool {
        self.fitted(arrangement, origin_m, turn).is_some()
    }

    /// Whether all doors, and all that is used, can be walked to.
    pub fn is_walkable(&self) -> bool {
        self.ground.clone().try_add(&[], &[])
    }

    /// The middles of all cells of its floor that can be walked on, m, row by row from the south.
    pub fn walkable_m(&self) -> impl Iterator<Item = [f32; 2]> + '_ {
        self.ground.walkable()
    }

    /// The pieces of an arrangement in their places, if there is room for all of them.
    fn fitted(&self, arrangement: &Arrangement, origin_m: [f32; 3], turn: Turn) -> Option<Vec<Placed>> {
        let pieces = self.in_room(arrangement, origin_m, turn);
        let all: Vec<Placed> = self.placed.iter().chain(&pieces).cloned().collect();
        let has_room = pieces.iter().filter_map(|piece| piece.filled(&all)).all(|block| self.has_room(&block));
        has_room.then_some(pieces)
    }

    fn in_room(&self, arrangement: &Arrangement, [x, y, z]: [f32; 3], turn: Turn) -> Vec<Placed> {
        let first = self.placed.len();
        let placed = arrangement.pieces.iter().map(|piece| {
            let at_m = if piece.on.is_some() {
                piece.at_m
            } else {
                let [dx, dy] = turn.apply([piece.at_m[0], piece.at_m[1]]);
                [x + dx, y + dy, z + piece.at_m[2]]
            };
            Placed {
                at_m: at_m.map(rounded),
                turn: turn.then(piece.turn),
                on: piece.on.map(|on| first + on),
                works: piece.works.map(|works| first + works),
                ..piece.clone()
            }
        });
        placed.collect()
    }

    /// Whether a box is within the walls and in nobody's way.
    fn has_room(&self, block: &Block) -> bool {
        let margin_m = HALF_WALL_M - SLACK_M / 2.0;
        block.corners().into_iter().all(|corner| is_clear(&self.rects, corner, margin_m))
            && block.high[2] <= WALL_HEIGHT_M
            && !self.kept_free.iter().any(|free| free.overlaps(block))
            && !self.filled().any(|other| other.overlaps(&block.grown(APART_M)))
    }

    /// The first piece of one of these classes.
    pub fn find(&self, classes: &[String]) -> Option<&Placed> {
        self.placed.iter().find(|placed| classes.contains(&self.catalog.class(placed.class).id))
    }

    /// What all that is there fills.
    pub fn filled(&self) -> impl Iterator<Item = Block> + '_ {
        self.placed.iter().filter_map(|placed| placed.filled(&self.placed))
    }

    fn usable(&self, piece: &Placed) -> Option<Usable> {
        let class = self.catalog.class(piece.class);
        let block = piece.block().filter(|_| is_operable(class))?;
        let is_over = is_worked_over(class);
        let has_front = is_used_from_its_front(class) && !is_over;
        Some(Usable { block, front: has_front.then_some(piece.turn), is_over })
    }
}

/// Whether it does something or takes something.
fn is_operable(class: &ObjectClass) -> bool {
    use Property::{Openable, Powerable, Receptacle, Toggleable, Usable};
    [Openable, Powerable, Receptacle, Toggleable, Usable].into_iter().any(|property| class.has(property))
}

/// Whether a hand works it over what stands below: it hangs on a wall, and nothing is put into it.
fn is_worked_over(class: &ObjectClass) -> bool {
    class.stands == cohabit_cdf::catalog::Stands::OnWall && !class.has(Property::Receptacle)
}

/// Whether its doors, shelves or buttons are on one side: a table is used from all of them.
fn is_used_from_its_front(class: &ObjectClass) -> bool {
    /// A handle so far before the middle is at the front, m.
    const FORWARD_M: f32 = 0.05;
    let is_enclosed = class.receptacle.as_ref().is_some_and(|receptacle| receptacle.enclosed);
    let has_handle = class.handle_m.is_some_and(|handle| handle[0] > FORWARD_M);
    is_enclosed || has_handle || class.stands == cohabit_cdf::catalog::Stands::OnWall
}
