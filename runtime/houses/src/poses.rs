//! Where something could stand in a room: the nearest place first.

use cohabit_floorplans::parts::{Arrangement, HALF_WALL_M, Site, Turn, Wall, against, metres};

/// Between the back of furniture and a wall, m.
const BEHIND_M: f32 = 0.02;
/// Between the back of what hangs there and a wall, m.
const HUNG_M: f32 = 0.01;
/// Between the side of furniture and a wall, m.
const BESIDE_M: f32 = 0.03;
/// Between two places that are tried, m.
const STEP_M: f32 = 0.1;
/// The farthest that something is moved, m.
const FARTHEST_M: f32 = 1.5;
/// What another direction counts for, m.
const TURNED_M: f32 = 0.6;
/// What standing free counts for, where the back is wanted at a wall, m.
const FREE_M: f32 = 0.7;

/// How something keeps its place.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Stance {
    /// Anywhere on the floor.
    Free,
    /// With its back to a wall, if one is near.
    Backed,
    /// On a wall.
    Hung,
}

/// Where something is wanted.
#[derive(Clone, Copy, Debug)]
pub struct Wanted {
    /// The middle of its foot, m; that of its back, if it hangs.
    pub middle_m: [f32; 2],
    pub height_m: f32,
    pub turn: Turn,
    pub stance: Stance,
}

/// A place to try.
#[derive(Clone, Copy, Debug)]
pub struct Pose {
    pub origin_m: [f32; 3],
    pub turn: Turn,
    /// How far it is from where it is wanted, m, with what else counts against it.
    pub cost_m: f32,
}

impl Wanted {
    /// Places for it in a room, the best first.
    pub fn poses(&self, site: &Site<'_>, arrangement: &Arrangement) -> Vec<Pose> {
        let mut poses = match self.stance {
            Stance::Free => self.around(0.0),
            Stance::Backed => {
                let mut poses = self.at_walls(site, arrangement, BEHIND_M);
                poses.extend(self.around(FREE_M));
                poses
            }
            Stance::Hung => self.at_walls(site, arrangement, HUNG_M),
        };
        poses.retain(|pose| pose.cost_m <= FARTHEST_M);
        poses.sort_by(|one, other| one.cost_m.total_cmp(&other.cost_m));
        poses
    }

    fn pose(&self, [x, y]: [f32; 2], turn: Turn, more_m: f32) -> Pose {
        let away_m = libm::hypotf(x - self.middle_m[0], y - self.middle_m[1]);
        Pose { origin_m: [x, y, self.height_m], turn, cost_m: away_m + more_m }
    }

    /// Around where it is wanted, as it is turned.
    fn around(&self, more_m: f32) -> Vec<Pose> {
        let count = (FARTHEST_M / STEP_M) as i32;
        let steps = (-count..=count).flat_map(|dx| (-count..=count).map(move |dy| [dx, dy]));
        let place = |step: [i32; 2]| {
            let [x, y] = [0, 1].map(|axis: usize| self.middle_m[axis] + step[axis] as f32 * STEP_M);
            self.pose([x, y], self.turn, more_m)
        };
        steps.map(place).collect()
    }

    /// Along all walls.
    fn at_walls(&self, site: &Site<'_>, arrangement: &Arrangement, behind_m: f32) -> Vec<Pose> {
        let half_m = (arrangement.bounds.high[1] - arrangement.bounds.low[1]) / 2.0 + HALF_WALL_M + BESIDE_M;
        let mut poses = Vec::new();
        for wall in &site.walls {
            let [from_m, to_m] = [metres(wall.from) + half_m, metres(wall.to) - half_m];
            if from_m > to_m {
                continue;
            }
            let more_m = if wall.faces == self.turn { 0.0 } else { TURNED_M };
            let place = |middle_m: f32| self.pose(against(*wall, middle_m, behind_m, arrangement), wall.faces, more_m);
            poses.extend(self.along(*wall, from_m, to_m).into_iter().map(place));
        }
        poses
    }

    /// Places along a wall, with the one that is nearest and both ends.
    fn along(&self, wall: Wall, from_m: f32, to_m: f32) -> Vec<f32> {
        let axis = usize::from(wall.axis() == cohabit_cdf::model::Axis::Y);
        let near_m = self.middle_m[axis].clamp(from_m, to_m);
        let count = (FARTHEST_M / STEP_M) as i32;
        let steps = (-count..=count).map(|step| near_m + step as f32 * STEP_M);
        steps.filter(|at_m| (from_m..=to_m).contains(at_m)).chain([from_m, to_m]).collect()
    }
}
