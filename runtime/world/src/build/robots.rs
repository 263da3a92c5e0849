//! The robots that a mission starts with: one, unless it says more.

use cohabit_cdf::mission::RobotRequest;
use glam::Vec2;

use super::{BuildError, Builder, start};
use crate::{body::Body, effect::Effect, geometry::wrap, navigation::Navigation};
use cohabit_cdf::{BodyId, BodyKind, Property, RoomId};

/// How far off a wanted place a robot may stand, m.
const NEAR_M: f32 = 1.5;

impl Builder<'_> {
    /// Stands each robot where it is wanted, or else at the first free viewpoint of its room; returns the floor that
    /// they stand on.
    pub(super) fn add_robots(&mut self) -> Result<Navigation, BuildError> {
        let floor = Navigation::new(&self.facts());
        let alone = [RobotRequest::default()];
        let wanted = if self.mission.robots.is_empty() { &alone[..] } else { &self.mission.robots };
        for (number, request) in (0..).zip(wanted) {
            self.add_robot(&floor, BodyId(number), request)?;
        }
        Ok(floor)
    }

    fn add_robot(&mut self, floor: &Navigation, id: BodyId, request: &RobotRequest) -> Result<(), BuildError> {
        const NAME: &str = "the robot";
        let room = self.check_room(NAME, request.room.unwrap_or(self.mission.start_room))?;
        let (position, yaw_rad, room) = match self.wanted_place(floor, request, room) {
            Some(place) => place,
            None => {
                let (position, yaw_rad) =
                    start(&self.facts(), floor, self.layout, room).ok_or_else(|| self.no_free_spot(NAME, room))?;
                (position, yaw_rad, room)
            }
        };
        let yaw_rad = request.yaw_deg.map_or(yaw_rad, |yaw_deg| wrap(yaw_deg.to_radians()));
        let mut body = Body::new(BodyKind::Robot, position, yaw_rad, room);
        for (flag, value) in &request.flags {
            body.flags.set(*flag, *value);
        }
        self.state.bodies.push(body);
        let held = request.holds.as_ref().and_then(|held| self.state.find(held));
        let free = |id: &_| self.facts().has(*id, Property::Pickupable) && self.state.at(*id).held_by().is_none();
        if let Some(held) = held.filter(free) {
            self.changes().apply(vec![Effect::Hold(held, id)]);
        }
        Ok(())
    }

    /// The point or viewpoint that a robot wants, if it can stand near it.
    fn wanted_place(&self, floor: &Navigation, request: &RobotRequest, room: RoomId) -> Option<(Vec2, f32, RoomId)> {
        let mut viewpoints = self.layout.viewpoints.iter();
        let viewpoint = viewpoints.find(|known| known.room == room && Some(known.number) == request.viewpoint);
        let (at, yaw_rad) = match (request.at_m, viewpoint) {
            (Some(at_m), _) => (Vec2::from(at_m), 0.0),
            (None, Some(viewpoint)) => (Vec2::from(viewpoint.at_m), wrap(viewpoint.yaw_deg.to_radians())),
            (None, None) => return None,
        };
        let at = floor.snap(at, NEAR_M)?;
        let crowded = self.state.bodies.iter().any(|body| body.position.distance(at) < 2.5 * crate::body::RADIUS_M);
        let room = self.floor.room_at(at).filter(|_| !crowded)?;
        Some((at, yaw_rad, room))
    }
}
