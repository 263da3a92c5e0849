//! Making way: bodies that meet pass each other on the right, go round who stands, step aside, or wait; and nobody
//! stands in the swing of a door that is to open. Never knows what a command is for.

use cohabit_cdf::{Action, BodyId, BodyKind, ObjectId};
use glam::Vec2;

use crate::{
    approach::Sweep,
    body::{Body, Step, Task},
    geometry::{Footprint, direction, heading, nearest_on},
    navigation::Navigation,
    passage::Obstruction,
    world::World,
};

/// How far ahead a body looks for others, m.
const AHEAD_M: f32 = 1.8;
/// Room that bodies leave between them when they can, m.
const BERTH_M: f32 = 0.06;
/// Ticks between two changes of a way for others.
const SETTLED_TICKS: u64 = 20;
/// Ticks after which a failed search for another way is tried again.
const RETRY_TICKS: u64 = 45;
/// Ticks between two looks ahead.
const LOOK_TICKS: u64 = 6;
/// A body that changed its way so often does not any more.
const MOST_DETOURS: u32 = 150;
/// Ticks after which a body with the higher, and the lower, id steps aside where two cannot pass.
const ASIDE_TICKS: [u32; 2] = [20, 100];
/// Ticks after which a robot that has nothing to do makes way.
const UNASKED_TICKS: u32 = 40;
/// So often one body has others make way.
const MOST_SENT_ASIDE: u32 = 3;
/// Nobody goes further to make way, m.
const FURTHEST_ASIDE_M: f32 = 12.0;
/// Ticks that a body that stepped aside waits at most.
const ASIDE_FOR_TICKS: u32 = 900;

impl World {
    /// Looks whether the way of a body is still good: what stands on the floor may have changed, somebody may come.
    pub(crate) fn mind_the_way(&self, id: BodyId, task: &mut Task) {
        let Some(way) = task.way() else { return };
        let body = &self.state.bodies[id.0 as usize];
        if task.floor_version != self.navigation.version {
            let points: Vec<Vec2> = std::iter::once(body.position).chain(way.iter().copied()).collect();
            task.floor_version = self.navigation.version;
            if !self.navigation.is_open(&points) {
                self.replan(id, task, &self.navigation, f32::MAX);
            }
            return;
        }
        let looks =
            (self.state.tick + u64::from(id.0)).is_multiple_of(LOOK_TICKS) && self.state.tick >= task.settled_until;
        if !looks || task.steps.iter().any(|step| matches!(step, Step::Yield { .. })) {
            return;
        }
        if let Some(other) = self.comes_ahead(id, way) {
            self.go_around(id, task, Some(other));
        }
    }

    /// Who is on the next stretch of a way, and does not walk off along it.
    fn comes_ahead(&self, id: BodyId, way: &[Vec2]) -> Option<BodyId> {
        let body = &self.state.bodies[id.0 as usize];
        let near = self.others(id).filter(|(_, other)| other.position.distance(body.position) < AHEAD_M + 0.8);
        near.into_iter()
            .find(|(_, other)| {
                let toward = (other.position - body.position).normalize_or_zero();
                let leaves = other.velocity().dot(toward) > 0.3;
                !leaves && passes_near(body.position, way, other.position, AHEAD_M) < berth(body, other)
            })
            .map(|(other, _)| other)
    }

    /// Plans a way around those who are near; keeps the old one if there is none.
    fn go_around(&self, id: BodyId, task: &mut Task, met: Option<BodyId>) -> bool {
        /// Who is further away than this will have moved by then, m.
        const NEAR_M: f32 = 4.0;
        /// Nobody goes further round for somebody who is walking, m.
        const ROUND_M: f32 = 4.0;
        task.settled_until = self.state.tick + RETRY_TICKS;
        if task.detours >= MOST_DETOURS {
            return false;
        }
        let body = &self.state.bodies[id.0 as usize];
        let near: Vec<(BodyId, &Body)> =
            self.others(id).filter(|(_, other)| other.position.distance(body.position) < NEAR_M).collect();
        let walks = met.is_some_and(|met| {
            let task = self.state.bodies[met.0 as usize].task.as_ref();
            task.is_some_and(|task| task.way().is_some())
        });
        let longest = if walks { length(body.position, task.way().unwrap_or(&[])) + ROUND_M } else { f32::MAX };
        // First with room to the left of who comes, so that both keep right; then as it may be.
        let wanted: &[bool] = if walks { &[true, false] } else { &[false] };
        let found = wanted.iter().any(|keeps_right| {
            let closed: Vec<Vec<Vec2>> = near
                .iter()
                .map(|(other_id, other)| {
                    let print = self.standing_room(body, other, *keeps_right && met == Some(*other_id));
                    // The outline keeps the middle of this body out.
                    print.inflated(berth(body, other) - BERTH_M / 2.0)
                })
                .collect();
            self.replan(id, task, &Navigation::around(&self.facts(), &closed), longest)
        });
        if found {
            task.settled_until = self.state.tick + SETTLED_TICKS;
            task.detours += 1;
        }
        found
    }

    /// What another body takes up: where it stands or, to pass it on the right, where it will be once it keeps right too,
    /// from there half the way to here, and some room beyond.
    fn standing_room(&self, body: &Body, other: &Body, keeps_right: bool) -> Footprint {
        /// Room beyond that nobody should choose, m.
        const SIDE_M: f32 = 0.6;
        const STEP_M: f32 = 0.1;
        if !keeps_right {
            return Footprint::new(other.position, Vec2::ZERO, 0.0);
        }
        let apart = other.position - body.position;
        let ahead = apart.normalize_or_zero();
        // Each gives way by half.
        let to_side = (1..=3_u8)
            .map(|step| other.position + ahead.perp() * (f32::from(step) * STEP_M))
            .take_while(|point| self.navigation.is_walkable(*point))
            .last()
            .unwrap_or(other.position);
        let half = Vec2::new(apart.length() / 4.0, SIDE_M / 2.0);
        Footprint::new(to_side + ahead.perp() * half.y - ahead * half.x, half, heading(ahead))
    }

    /// Plans the rest of a task anew on a floor, if that way is no longer than so many metres.
    fn replan(&self, id: BodyId, task: &mut Task, floor: &Navigation, longest: f32) -> bool {
        let body = &self.state.bodies[id.0 as usize];
        let new = match (task.action, task.way()) {
            (Action::GoTo { target }, _) => self.plan_walk(body, target, floor).ok(),
            (_, Some(way)) => way.last().and_then(|end| floor.path(body.position, *end)).map(|(path, _)| {
                let mut steps = task.steps.clone();
                steps.pop();
                steps.push(Step::Walk { path, next: 0 });
                (steps, task.alternate)
            }),
            (_, None) => None,
        };
        let Some((steps, alternate)) = new else { return false };
        let path: &[Vec2] = match steps.last() {
            Some(Step::Walk { path, .. }) => path,
            _ => &[],
        };
        if length(body.position, path) > longest {
            return false;
        }
        (task.steps, task.alternate) = (steps, alternate);
        true
    }

    /// What a body does that cannot go on: another way, a step aside, or nothing.
    pub(crate) fn make_way(&self, id: BodyId, task: &mut Task, met: Obstruction) {
        // Who makes way unasked does no more than that.
        if task.command().is_none() {
            return;
        }
        match met {
            Obstruction::Body(other) => {
                // Whoever comes first in the order of ids has the right of way, also where several wait for each other.
                let patience = |walker: BodyId| ASIDE_TICKS[usize::from(id.0 < walker.0)];
                let asks = |walker: BodyId| {
                    task.waited % patience(walker) == patience(walker) - 1 && self.wants_through(walker, id)
                };
                let asked = self.others(id).map(|(walker, _)| walker).find(|walker| asks(*walker));
                if asked.is_some_and(|walker| self.step_aside(id, task, walker)) {
                    return;
                }
                if self.state.tick >= task.settled_until {
                    self.go_around(id, task, Some(other));
                }
            }
            Obstruction::Leaf(door) if task.waited % 30 == 1 => self.leave_swing(id, task, door),
            Obstruction::Thing(_) | Obstruction::Fixture(_) if task.waited % 60 == 30 => {
                self.go_around(id, task, None);
            }
            Obstruction::Leaf(_) | Obstruction::Thing(_) | Obstruction::Fixture(_) => {}
        }
    }

    /// Whether the way of a walking body leads through where another one is.
    fn wants_through(&self, walker: BodyId, stander: BodyId) -> bool {
        let (walker, stander) = (&self.state.bodies[walker.0 as usize], &self.state.bodies[stander.0 as usize]);
        let way = walker.task.as_ref().and_then(Task::way);
        way.is_some_and(|way| passes_near(walker.position, way, stander.position, AHEAD_M) < berth(walker, stander))
    }

    /// Goes to the nearest place off the way of another body, and lets that pass.
    fn step_aside(&self, id: BodyId, task: &mut Task, other: BodyId) -> bool {
        // Whoever is already on the way aside goes on to where it was going before.
        let first = task.steps.iter().position(|step| matches!(step, Step::Walk { .. }));
        let Some((first, Step::Walk { path: whole, .. })) = first.map(|at| (at, &task.steps[at])) else { return false };
        let Some(goal) = whole.last().copied() else { return false };
        let walking = |other: &'_ Body| other.task.as_ref().and_then(Task::way).map(<[Vec2]>::to_vec);
        let ways: Vec<(Vec2, f32, Vec<Vec2>)> = self
            .near(id)
            .filter_map(|other| {
                Some((other.position, berth(&self.state.bodies[id.0 as usize], other), walking(other)?))
            })
            .collect();
        let found = self.way_aside(id, &ways, |place| self.navigation.path(place, goal).map(|(back, _)| back));
        let Some((aside, back)) = found else { return false };
        task.steps.truncate(first);
        task.steps.push(Step::Walk { path: back, next: 0 });
        task.steps.push(Step::Yield { to: other, ticks_left: ASIDE_FOR_TICKS });
        task.steps.push(Step::Walk { path: aside, next: 0 });
        task.detours += 1;
        true
    }

    /// Has a robot that has nothing to do go out of the way of a body that waits for it in vain.
    pub(crate) fn send_aside(&mut self, walker: BodyId, task: &mut Task, met: Obstruction) {
        let (Obstruction::Body(stander), Some(way), Some(_)) = (met, task.way(), task.command()) else { return };
        let (body, walking) = (&self.state.bodies[stander.0 as usize], &self.state.bodies[walker.0 as usize]);
        let is_idle = body.kind == BodyKind::Robot && body.alive && !body.busy();
        let is_due = task.waited % UNASKED_TICKS == UNASKED_TICKS - 1 && task.detours < MOST_DETOURS;
        if !is_idle || !is_due {
            return;
        }
        let way = [(walking.position, berth(body, walking), way.to_vec())];
        if let Some((path, ())) = self.way_aside(stander, &way, |_| Some(())) {
            let version = self.navigation.version;
            self.state.bodies[stander.0 as usize].task = Some(Task::aside(path, version));
            task.detours += MOST_DETOURS / MOST_SENT_ASIDE;
        }
    }

    /// The way to the nearest place where a body stands off these ways, each from a point with so much room beside it, and
    /// from which it can go on.
    fn way_aside<T>(
        &self,
        id: BodyId,
        ways: &[(Vec2, f32, Vec<Vec2>)],
        goes_on: impl Fn(Vec2) -> Option<T>,
    ) -> Option<(Vec<Vec2>, T)> {
        /// So many places are tried.
        const PLACES: usize = 80;
        let body = &self.state.bodies[id.0 as usize];
        let closed: Vec<Vec<Vec2>> = self
            .near(id)
            .map(|other| Footprint::new(other.position, Vec2::ZERO, 0.0).inflated(berth(body, other) - BERTH_M))
            .collect();
        let floor = Navigation::around(&self.facts(), &closed);
        let mut rooms: Vec<Vec2> = self.layout.viewpoints.iter().map(|viewpoint| viewpoint.at_m.into()).collect();
        rooms.sort_by(|one, two| one.distance(body.position).total_cmp(&two.distance(body.position)));
        let is_aside = |place: &Vec2| {
            floor.is_walkable(*place)
                && ways.iter().all(|(from, berth, way)| passes_near(*from, way, *place, FURTHEST_ASIDE_M) > *berth)
                && self.others(id).all(|(_, other)| other.position.distance(*place) > berth(body, other))
        };
        places_around(body.position, 3.0).chain(rooms).filter(is_aside).take(PLACES).find_map(|place| {
            let (aside, length) = floor.path(body.position, place)?;
            let then = goes_on(place)?;
            (length < FURTHEST_ASIDE_M).then_some((aside, then))
        })
    }

    /// The other bodies that are not far from one.
    fn near(&self, id: BodyId) -> impl Iterator<Item = &Body> {
        let at = self.state.bodies[id.0 as usize].position;
        self.others(id).map(|(_, other)| other).filter(move |other| other.position.distance(at) < FURTHEST_ASIDE_M)
    }

    /// Whether a body that stepped aside may go on: the other one has passed, or does not walk any more.
    pub(crate) fn has_passed(&self, id: BodyId, other: BodyId) -> bool {
        let (body, walker) = (&self.state.bodies[id.0 as usize], &self.state.bodies[other.0 as usize]);
        let walks = walker.task.as_ref().is_some_and(|task| task.way().is_some());
        let from = walker.position - body.position;
        !walks || (from.length() > berth(body, walker) + 0.3 && walker.velocity().dot(from) > 0.0)
    }

    /// Goes out of the swing of a door, and from there on as before.
    fn leave_swing(&self, id: BodyId, task: &mut Task, door: ObjectId) {
        let body = &self.state.bodies[id.0 as usize];
        let Some(goal) = task.way().and_then(|way| way.last().copied()) else { return };
        let sweep = Sweep::of(&self.facts(), door, body.figure().height_m);
        if sweep.distance(body.position) >= body.figure().radius_m {
            return;
        }
        let Some(aside) = self.place_clear_of(&sweep, body, |_| true) else { return };
        let Some((back, _)) = self.navigation.path(aside, goal) else { return };
        task.steps.pop();
        let path = std::iter::once(aside).chain(back).collect();
        task.steps.push(Step::Walk { path, next: 0 });
        task.detours += 1;
    }

    /// The nearest place, straight ahead in some direction, where a body stands out of the swing of something.
    pub(crate) fn place_clear_of(&self, sweep: &Sweep, body: &Body, is_fine: impl Fn(Vec2) -> bool) -> Option<Vec2> {
        let radius = body.figure().radius_m;
        places_around(body.position, 2.0).find(|place| {
            sweep.distance(*place) > radius + BERTH_M
                && self.navigation.is_walkable(*place)
                && is_fine(*place)
                && (1..=8_u8).all(|part| {
                    let at = body.position.lerp(*place, f32::from(part) / 8.0);
                    self.navigation.barrier(body.position, at, radius).is_none()
                })
        })
    }
}

/// Points in rings further and further out.
fn places_around(middle: Vec2, within: f32) -> impl Iterator<Item = Vec2> {
    const RING_M: f32 = 0.15;
    const SPOKES: u16 = 16;
    let rings = (within / RING_M) as u16;
    (1..=rings).flat_map(move |ring| {
        (0..SPOKES).map(move |spoke| {
            let angle = f32::from(spoke) * (std::f32::consts::TAU / f32::from(SPOKES));
            middle + direction(angle) * (f32::from(ring) * RING_M)
        })
    })
}

/// How far apart the middles of two bodies pass.
fn berth(one: &Body, two: &Body) -> f32 {
    one.figure().radius_m + two.figure().radius_m + BERTH_M
}

/// How near a way, as far as `within` m ahead, comes to a point.
fn passes_near(from: Vec2, way: &[Vec2], point: Vec2, within: f32) -> f32 {
    let (mut at, mut left, mut nearest) = (from, within, from.distance(point));
    for next in way {
        let stretch = at.distance(*next);
        let to = if stretch > left { at.lerp(*next, left / stretch) } else { *next };
        nearest = nearest.min(nearest_on(at, to, point).distance(point));
        left -= stretch;
        at = to;
        if left <= 0.0 {
            break;
        }
    }
    nearest
}

/// Length of a way, m.
fn length(from: Vec2, way: &[Vec2]) -> f32 {
    let points = std::iter::once(&from).chain(way);
    points.zip(way).map(|(one, two)| one.distance(*two)).sum()
}
