//! Rectangles of floor, walls seen from inside, quarter turns, and the boxes that things fill.
//!
//! Rooms lie on a lattice of 0.1 m, in decimetres. Furniture lies at any point, in metres; it faces along an axis.

use cohabit_cdf::model::Axis;

/// Half the thickness of walls, m.
pub const HALF_WALL_M: f32 = 0.06;

/// Decimetres in metres.
pub fn metres(dm: i32) -> f32 {
    dm as f32 / 10.0
}

/// To the millimetre, as floor plans are written.
pub fn rounded(m: f32) -> f32 {
    (m * 1000.0).round() / 1000.0
}

/// A rectangle of floor to the middle of its walls, dm.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Rect {
    /// Its western side.
    pub west: i32,
    /// Its southern side.
    pub south: i32,
    /// Its eastern side.
    pub east: i32,
    /// Its northern side.
    pub north: i32,
}

impl Rect {
    /// Between its four sides.
    pub const fn new(west: i32, south: i32, east: i32, north: i32) -> Self {
        Self { west, south, east, north }
    }

    /// Its extent along an axis.
    pub fn length(self, axis: Axis) -> i32 {
        if axis == Axis::X { self.east - self.west } else { self.north - self.south }
    }

    /// Floor area, m².
    pub fn area_m2(self) -> f32 {
        metres(self.length(Axis::X)) * metres(self.length(Axis::Y))
    }

    /// The length of its shorter side.
    pub fn least(self) -> i32 {
        self.length(Axis::X).min(self.length(Axis::Y))
    }

    /// The parts before and behind a line across `axis`.
    pub fn cut(self, axis: Axis, at: i32) -> [Self; 2] {
        if axis == Axis::X {
            [Self { east: at, ..self }, Self { west: at, ..self }]
        } else {
            [Self { north: at, ..self }, Self { south: at, ..self }]
        }
    }

    /// Where it begins along an axis.
    pub fn start(self, axis: Axis) -> i32 {
        if axis == Axis::X { self.west } else { self.south }
    }

    /// Whether a point is at least `margin_m` inside.
    fn has(self, [x, y]: [f32; 2], margin_m: f32) -> bool {
        x >= metres(self.west) + margin_m
            && x <= metres(self.east) - margin_m
            && y >= metres(self.south) + margin_m
            && y <= metres(self.north) - margin_m
    }
}

/// Whether a point of a floor of several rectangles is at least `margin_m` from the middle of its walls.
pub fn is_clear(rects: &[Rect], [x, y]: [f32; 2], margin_m: f32) -> bool {
    [[0.0, 0.0], [1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]].into_iter().all(|[dx, dy]| {
        let point = [x + dx * margin_m, y + dy * margin_m];
        rects.iter().any(|rect| rect.has(point, 0.0))
    })
}

/// The least rectangle around all of them.
pub fn bounds(rects: &[Rect]) -> Rect {
    let around = |a: Rect, b: &Rect| {
        Rect::new(a.west.min(b.west), a.south.min(b.south), a.east.max(b.east), a.north.max(b.north))
    };
    rects.iter().fold(Rect::new(i32::MAX, i32::MAX, i32::MIN, i32::MIN), around)
}

/// A direction along an axis, as quarter turns from east.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Turn(u8);

impl Turn {
    /// Along x.
    pub const EAST: Self = Self(0);
    /// Along y.
    pub const NORTH: Self = Self(1);
    /// Against x.
    pub const WEST: Self = Self(2);
    /// Against y.
    pub const SOUTH: Self = Self(3);
    /// All four.
    pub const ALL: [Self; 4] = [Self::EAST, Self::NORTH, Self::WEST, Self::SOUTH];

    /// The turn of some degrees, a multiple of 90.
    pub fn of_degrees(degrees: i32) -> Self {
        Self((degrees.rem_euclid(360) / 90) as u8)
    }

    /// As a yaw, degrees.
    pub const fn yaw_deg(self) -> f32 {
        match self.0 {
            0 => 0.0,
            1 => 90.0,
            2 => 180.0,
            _ => -90.0,
        }
    }

    /// One turn after the other.
    pub const fn then(self, other: Self) -> Self {
        Self((self.0 + other.0) % 4)
    }

    /// Turns as far the other way.
    pub const fn inverse(self) -> Self {
        Self((4 - self.0) % 4)
    }

    /// The opposite direction.
    pub const fn back(self) -> Self {
        self.then(Self::WEST)
    }

    /// A point turned about the origin.
    pub fn apply(self, [x, y]: [f32; 2]) -> [f32; 2] {
        match self.0 {
            0 => [x, y],
            1 => [-y, x],
            2 => [-x, -y],
            _ => [y, -x],
        }
    }

    /// A size along x and y, turned.
    pub const fn size(self, [x, y]: [f32; 2]) -> [f32; 2] {
        if self.0.is_multiple_of(2) { [x, y] } else { [y, x] }
    }

    /// The axis across which it points: that of a wall that faces this way.
    pub const fn wall_axis(self) -> Axis {
        if self.0.is_multiple_of(2) { Axis::Y } else { Axis::X }
    }
}

/// A stretch of a room's wall, seen from inside.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Wall {
    /// The way into the room.
    pub faces: Turn,
    /// Where it is, across its axis, dm.
    pub at: i32,
    /// From where along its axis, dm.
    pub from: i32,
    /// And to where, dm.
    pub to: i32,
}

impl Wall {
    /// Along which it runs.
    pub const fn axis(self) -> Axis {
        self.faces.wall_axis()
    }

    /// Its length, dm.
    pub const fn length(self) -> i32 {
        self.to - self.from
    }

    /// The point some way along its axis and some way into the room, m.
    pub fn point(self, along_m: f32, into_m: f32) -> [f32; 2] {
        let [dx, dy] = self.faces.apply([into_m, 0.0]);
        let at = metres(self.at);
        if self.axis() == Axis::X { [along_m, at + dy] } else { [at + dx, along_m] }
    }

    /// What is left of it without the stretches that these take.
    fn without(self, taken: &[(i32, i32)]) -> Vec<Self> {
        let mut left = vec![self];
        for (from, to) in taken {
            left = left
                .into_iter()
                .flat_map(|wall| [Self { to: wall.to.min(*from), ..wall }, Self { from: wall.from.max(*to), ..wall }])
                .filter(|wall| wall.length() > 0)
                .collect();
        }
        left
    }
}

/// The four walls of a rectangle.
fn sides(rect: Rect) -> [Wall; 4] {
    let Rect { west, south, east, north } = rect;
    [
        Wall { faces: Turn::NORTH, at: south, from: west, to: east },
        Wall { faces: Turn::SOUTH, at: north, from: west, to: east },
        Wall { faces: Turn::EAST, at: west, from: south, to: north },
        Wall { faces: Turn::WEST, at: east, from: south, to: north },
    ]
}

/// The walls around a floor of several rectangles.
pub fn walls(rects: &[Rect]) -> Vec<Wall> {
    let all: Vec<Wall> = rects.iter().flat_map(|rect| sides(*rect)).collect();
    all.iter().flat_map(|wall| wall.without(&stretches_behind(*wall, &all))).collect()
}

/// The stretches of walls behind which other floor is, whose walls these are.
fn stretches_behind(wall: Wall, others: &[Wall]) -> Vec<(i32, i32)> {
    others.iter().filter_map(|other| shared(wall, *other)).collect()
}

/// The stretch that two walls share back to back.
pub fn shared(one: Wall, other: Wall) -> Option<(i32, i32)> {
    let (from, to) = (one.from.max(other.from), one.to.min(other.to));
    (one.faces == other.faces.back() && one.at == other.at && from < to).then_some((from, to))
}

/// The walls of a floor behind which none of the other walls is.
pub fn outer_walls(own: &[Wall], others: &[Wall]) -> Vec<Wall> {
    own.iter().flat_map(|wall| wall.without(&stretches_behind(*wall, others))).collect()
}

/// A box along the axes: what a thing fills, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    /// Its lowest corner.
    pub low: [f32; 3],
    /// Its highest corner.
    pub high: [f32; 3],
}

impl Block {
    /// Of a size (depth, width, height), turned, the middle of its foot at a point.
    pub fn of([depth, width, height]: [f32; 3], [x, y, z]: [f32; 3], turn: Turn) -> Self {
        let [along, across] = turn.size([depth, width]).map(|side| side / 2.0);
        Self { low: [x - along, y - across, z], high: [x + along, y + across, z + height] }
    }

    /// Between two corners on the floor, from height to height.
    pub fn between(one: [f32; 2], other: [f32; 2], [from, to]: [f32; 2]) -> Self {
        Self {
            low: [one[0].min(other[0]), one[1].min(other[1]), from],
            high: [one[0].max(other[0]), one[1].max(other[1]), to],
        }
    }

    /// Larger by that much on each side; as high as before.
    #[must_use]
    pub fn grown(self, by_m: f32) -> Self {
        let Self { low: [west, south, bottom], high: [east, north, top] } = self;
        Self { low: [west - by_m, south - by_m, bottom], high: [east + by_m, north + by_m, top] }
    }

    /// Whether it is as thin as a rug, on which others stand.
    fn is_flat(&self) -> bool {
        const FLAT_M: f32 = 0.003;
        self.high[2] - self.low[2] < FLAT_M
    }

    /// Whether two share space. What is flat takes no space but of its like.
    pub fn overlaps(&self, other: &Self) -> bool {
        const SLACK_M: f32 = 0.001;
        let is_shared =
            |axis: usize| self.low[axis] + SLACK_M < other.high[axis] && other.low[axis] + SLACK_M < self.high[axis];
        self.is_flat() == other.is_flat() && (0..3).all(is_shared)
    }

    /// How far a point of the floor is from it, m; 0 inside.
    pub fn distance_m(&self, point: [f32; 2]) -> f32 {
        let [x, y] = [0, 1].map(|axis| (self.low[axis] - point[axis]).max(point[axis] - self.high[axis]).max(0.0));
        (x * x + y * y).sqrt()
    }

    /// Its corners on the floor.
    pub fn corners(&self) -> [[f32; 2]; 4] {
        let ([west, south, _], [east, north, _]) = (self.low, self.high);
        [[west, south], [east, south], [east, north], [west, north]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walls_of_an_l_have_no_gap_where_its_parts_meet() {
        let walls = walls(&[Rect::new(0, 0, 80, 40), Rect::new(0, 40, 30, 90)]);
        assert_eq!(walls.len(), 7);
        let around: i32 = walls.iter().map(|wall| wall.length()).sum();
        assert_eq!(around, 2 * (80 + 90));
        assert!(walls.contains(&Wall { faces: Turn::SOUTH, at: 40, from: 30, to: 80 }));
    }

    #[test]
    fn a_turn_and_its_inverse_cancel_out() {
        for turn in Turn::ALL {
            assert_eq!(turn.then(turn.inverse()), Turn::EAST);
            assert_eq!(turn.inverse().apply(turn.apply([2.0, 3.0])), [2.0, 3.0]);
            assert_eq!(Turn::of_degrees(turn.yaw_deg() as i32), turn);
        }
    }

    #[test]
    fn furniture_stands_on_a_rug_and_rugs_lie_side_by_side() {
        let block = |x: f32, height_m: f32| Block::of([1.0, 1.0, height_m], [x, 0.0, 0.0], Turn::EAST);
        let (rug, table) = (block(0.0, 0.002), block(0.2, 0.5));
        assert!(!rug.overlaps(&table) && !table.overlaps(&rug));
        assert!(rug.overlaps(&block(0.5, 0.002)) && !rug.overlaps(&block(1.1, 0.002)));
        assert!(table.overlaps(&block(0.5, 0.9)));
    }

    #[test]
    fn a_point_of_a_wall_lies_inside_its_room() {
        for wall in sides(Rect::new(0, 0, 40, 30)) {
            let middle = metres(wall.from + wall.to) / 2.0;
            assert!(is_clear(&[Rect::new(0, 0, 40, 30)], wall.point(middle, 0.5), 0.49), "{wall:?}");
        }
    }
}
