//! Commands in the making: what a body does, tick by tick, from being told to the outcome.

use std::cell::Cell;

use cohabit_cdf::{Action, BodyId, GoToTarget, ObjectId, StateFlag, Status, Verb};
use glam::{Vec2, Vec3};

use crate::{
    approach::{Approach, Sweep},
    body::{Body, Controls, Step, Task},
    drive::HELD_TICKS,
    effect::Effect,
    geometry::wrap,
    kinematics::{PITCH_LIMIT_RAD, Progress},
    motion::{advance, retract},
    navigation::Navigation,
    passage::Obstruction,
    physics,
    report::{Event, Input, Outcome},
    rules::{self, Ruling},
    world::World,
};

/// Ticks that a body waits for its way to become free: five seconds for what stands, fifteen for who is about to go.
const PATIENCE_TICKS: u32 = 300;
const PATIENCE_WITH_WALKERS_TICKS: u32 = 900;
/// No command moves a body further than this, m.
const FURTHEST_M: f32 = 100.0;
/// How near a body comes to a closed door before it opens it, m: an arm's reach, beyond the swing of the leaf.
const DOOR_NEAR_M: f32 = 1.5;

/// An outcome before it has a command: status and detail.
type End = (Status, String);

impl World {
    /// Takes a command up; its outcome is at hand if it is refused, or done at once.
    pub(crate) fn begin(&mut self, input: &Input, outcomes: &mut Vec<Outcome>, events: &mut Vec<Event>) {
        let outcome = |(status, detail): End| Outcome { command: input.command, body: input.body, status, detail };
        let Some(body) = self.state.body(input.body) else {
            let detail = format!("there is no body {}", input.body.0);
            outcomes.push(outcome((Status::InvalidCommand, detail)));
            return;
        };
        if !body.alive {
            outcomes.push(outcome(out_of_order()));
            return;
        }
        let driven = self.drive_on(input, outcomes);
        if driven.is_none() {
            outcomes.extend(self.interrupt(input.body));
        }
        match self.plan(input.body, &input.action, events) {
            Err(end) => outcomes.push(outcome(end)),
            Ok((steps, alternate)) => {
                let version = self.state.floor_version;
                let mut task = Task::new(input.command, input.action, steps, alternate, version);
                task.pushing = driven.unwrap_or_default();
                self.state.bodies[input.body.0 as usize].task = Some(task);
            }
        }
    }

    /// Ends the driving of a body that is driven on, without a halt; gives back what it is pushing along.
    fn drive_on(&mut self, input: &Input, outcomes: &mut Vec<Outcome>) -> Option<Vec<ObjectId>> {
        let is_drive = |action: &Action| matches!(action, Action::Drive { .. });
        if !is_drive(&input.action) || check_numbers(&input.action).is_err() {
            return None;
        }
        let task = self.state.bodies[input.body.0 as usize].task.take_if(|task| is_drive(&task.action))?;
        let (status, detail) = arrived(&task);
        outcomes.push(Outcome { command: task.command, body: input.body, status, detail });
        Some(task.pushing)
    }

    /// Ends what a body is doing.
    fn interrupt(&mut self, id: BodyId) -> Option<Outcome> {
        let body = &mut self.state.bodies[id.0 as usize];
        body.turn_rad_s = 0.0;
        body.speed_m_s = 0.0;
        let task = body.task.take()?;
        self.let_stand(&task.pushing);
        Some(Outcome {
            command: task.command()?,
            body: id,
            status: Status::Interrupted,
            detail: "another command took its place".to_owned(),
        })
    }

    /// The steps of a command, the next one last, and whether they lead elsewhere than asked.
    fn plan(&mut self, id: BodyId, action: &Action, events: &mut Vec<Event>) -> Result<(Vec<Step>, bool), End> {
        check_numbers(action)?;
        for object in mentioned(action).into_iter().chain(action.beside()) {
            let known = self.state.object(object).is_some_and(crate::entity::Object::exists);
            if !known {
                return Err((Status::InvalidObjectClass, "there is no such object".to_owned()));
            }
        }
        let facts = self.facts();
        let body = &self.state.bodies[id.0 as usize];
        match *action {
            Action::Move { distance_m } => Ok((vec![Step::Straight { left_m: distance_m }], false)),
            Action::Rotate { yaw_rad } => Ok((vec![Step::Turn { left_rad: yaw_rad }], false)),
            Action::Look { pitch_rad } => {
                let to_rad = (body.head_pitch_rad + pitch_rad).clamp(-PITCH_LIMIT_RAD, PITCH_LIMIT_RAD);
                Ok((vec![Step::Pitch { to_rad }], false))
            }
            Action::LookAround => Ok((vec![Step::Turn { left_rad: std::f32::consts::TAU }], false)),
            Action::GoTo { target } => self.plan_any_walk(body, target),
            Action::PickUp { .. } | Action::Place { .. } | Action::PlaceBeside { .. } | Action::Interact { .. } => {
                let ruling = rules::rule(&facts, id, action);
                if ruling.is_plain_refusal() {
                    return Err((ruling.status, ruling.detail));
                }
                Ok((self.hand_steps(id, action), false))
            }
            Action::Highlight { object } => {
                let name = facts.name(object);
                events.push(Event::Highlighted { body: id, object });
                Err((Status::ActionSuccessful, format!("I pointed out {name}")))
            }
            Action::Stop => Err((Status::ActionSuccessful, "I stopped".to_owned())),
            Action::Drive { forward_m_s, turn_rad_s, pitch_rad_s } => {
                let controls = Controls { forward_m_s, turn_rad_s, pitch_rad_s }.within(body);
                Ok((vec![Step::Drive { controls, ticks_left: HELD_TICKS }], false))
            }
        }
    }

    /// The steps of a walk: around what stands open, if that can be; else through it; else as near as can be. A refusal
    /// names the lock, if it is one.
    fn plan_any_walk(&self, body: &Body, target: GoToTarget) -> Result<(Vec<Step>, bool), End> {
        let facts = self.facts();
        let (status, detail) = match self.plan_walk(body, target, &self.navigation) {
            Err(end) if end.0 == Status::UnsupportedNavigation => end,
            planned => return planned,
        };
        if let Some(floor) = Navigation::but_for_leaves(&facts)
            && let Ok(planned) = self.plan_walk(body, target, &floor)
        {
            return Ok(planned);
        }
        let locked = self.locked_out(body, target);
        if let (None, GoToTarget::Object(object)) = (locked, target)
            && let Some(approach) = self.navigation.approach_afar(&facts, body.position, object)
        {
            let steps =
                vec![Step::Face { point: facts.aim_point(object) }, Step::Walk { path: approach.path, next: 0 }];
            return Ok((steps, true));
        }
        Err((status, locked.map_or(detail, |door| format!("{} on the way there is locked", facts.name(door)))))
    }

    /// The steps of a walk over a floor.
    pub(crate) fn plan_walk(
        &self,
        body: &Body,
        target: GoToTarget,
        floor: &Navigation,
    ) -> Result<(Vec<Step>, bool), End> {
        let facts = self.facts();
        let from = body.position;
        let viewpoints = |room| self.layout.viewpoints.iter().filter(move |viewpoint| viewpoint.room == room);
        let no_way = |what: String| (Status::UnsupportedNavigation, format!("I find no way to {what}"));
        let (approach, last) = match target {
            GoToTarget::Object(object) => {
                if facts.object(object).held_by().is_some() {
                    return Err((Status::InvalidCommand, format!("{} is in a hand", facts.name(object))));
                }
                let approach = floor.approach_object(&facts, from, object);
                let approach = approach.ok_or_else(|| no_way(facts.name(object)))?;
                (approach, Step::Face { point: facts.aim_point(object) })
            }
            GoToTarget::Room(room) => {
                let points: Vec<Vec2> = viewpoints(room).map(|viewpoint| viewpoint.at_m.into()).collect();
                let approach = floor.approach_room(&facts, from, room, &points);
                let approach = approach.ok_or_else(|| no_way(format!("the {}", room.name_in(facts.catalog))))?;
                let yaw_rad = self.viewpoint_yaw(&approach).unwrap_or(body.yaw_rad);
                (approach, Step::Head { yaw_rad })
            }
            GoToTarget::Viewpoint(room, number) => {
                let viewpoint = viewpoints(room).find(|viewpoint| viewpoint.number == number);
                let viewpoint = viewpoint
                    .ok_or_else(|| (Status::InvalidCommand, format!("there is no viewpoint {}_{number}", room.id())))?;
                let approach = floor.approach_point(from, viewpoint.at_m.into());
                let approach = approach.ok_or_else(|| no_way(format!("viewpoint {}_{number}", room.id())))?;
                (approach, Step::Head { yaw_rad: wrap(viewpoint.yaw_deg.to_radians()) })
            }
            GoToTarget::Point(point) => {
                let approach = floor.approach_point(from, point.into());
                (approach.ok_or_else(|| no_way("that place".to_owned()))?, Step::Pitch { to_rad: 0.0 })
            }
        };
        Ok((vec![last, Step::Walk { path: approach.path, next: 0 }], approach.alternate))
    }

    /// The heading of the viewpoint that an approach ends at, rad.
    fn viewpoint_yaw(&self, approach: &Approach) -> Option<f32> {
        let end = *approach.path.last()?;
        let viewpoint =
            self.layout.viewpoints.iter().find(|viewpoint| Vec2::from(viewpoint.at_m).distance(end) < 1.0)?;
        Some(wrap(viewpoint.yaw_deg.to_radians()))
    }

    /// Carries the command of one body on by one tick; returns its outcome once it ends.
    pub(crate) fn advance_task(&mut self, id: BodyId, events: &mut Vec<Event>) -> Option<Outcome> {
        let index = id.0 as usize;
        let Some(mut task) = self.state.bodies[index].task.take() else {
            retract(&mut self.state.bodies[index]);
            return None;
        };
        if !self.state.bodies[index].alive {
            let body = &mut self.state.bodies[index];
            (body.speed_m_s, body.turn_rad_s) = (0.0, 0.0);
            return self.finish(id, &task, out_of_order());
        }
        self.mind_the_way(id, &mut task);
        let from = self.state.bodies[index].position;
        let mut body = self.state.bodies[index].clone();
        let Some(mut step) = task.steps.pop() else {
            return self.finish(id, &task, (Status::ActionSuccessful, "done".to_owned()));
        };
        if let Step::Yield { to, ticks_left } = &mut step
            && self.has_passed(id, *to)
        {
            *ticks_left = 0;
        }
        if let Some(door) = self.door_ahead(&body, &step) {
            self.changes(events).open(door);
        }
        if !matches!(step, Step::Reach) {
            retract(&mut body);
        }
        let walking = matches!(step, Step::Walk { .. });
        let met = Cell::new(None);
        let progress = advance(&mut body, &mut step, &|point| {
            met.set(self.obstruction(id, point, walking));
            met.get().is_none()
        });
        body.room = self.floor.room_at(body.position).unwrap_or(body.room);
        self.state.bodies[index] = body;
        if self.state.bodies[index].position != from {
            self.push_along(id, from, &mut task.pushing, events);
            self.push_leaves(id);
        }
        let end = match progress {
            Progress::Going => {
                // Turning on the spot is no progress; who gets on forgets by and by how long it stood.
                let moved = self.state.bodies[index].position != from;
                task.waited = task.waited.saturating_sub(u32::from(moved));
                task.steps.push(step);
                None
            }
            // The hand waits at what a machine has not done with.
            Progress::Done if matches!(step, Step::Reach) && self.is_worked_on(&task.action) => {
                task.steps.push(step);
                None
            }
            Progress::Done if matches!(step, Step::Reach) => Some(self.carry_out(id, &task.action, events)),
            Progress::Done if task.steps.is_empty() => Some(arrived(&task)),
            Progress::Done => None,
            Progress::Blocked if walking && task.waited < self.patience(met.get()) => {
                task.waited += 1;
                task.steps.push(step);
                if let Some(met) = met.get() {
                    self.make_way(id, &mut task, met);
                    self.send_aside(id, &mut task, met);
                }
                None
            }
            Progress::Blocked => Some((Status::TargetInaccessible, self.complaint(met.get()))),
        };
        match end {
            Some(end) => self.finish(id, &task, end),
            None => {
                self.state.bodies[index].task = Some(task);
                None
            }
        }
    }

    /// Whether the action would take a thing from a machine, or open the machine, before its work is done.
    fn is_worked_on(&self, action: &Action) -> bool {
        let (Action::PickUp { object } | Action::Interact { verb: Verb::Open, object }) = *action else { return false };
        let mut around = std::iter::once(object).chain(self.state.ancestors(object));
        around.any(|id| self.is_at_work_in(id))
    }

    fn patience(&self, met: Option<Obstruction>) -> u32 {
        match met {
            Some(Obstruction::Body(other)) if self.state.bodies[other.0 as usize].busy() => PATIENCE_WITH_WALKERS_TICKS,
            _ => PATIENCE_TICKS,
        }
    }

    fn finish(&mut self, body: BodyId, task: &Task, (status, detail): End) -> Option<Outcome> {
        self.let_stand(&task.pushing);
        Some(Outcome { command: task.command()?, body, status, detail })
    }

    /// Rules the action as things stand now, and applies what follows.
    fn carry_out(&mut self, id: BodyId, action: &Action, events: &mut Vec<Event>) -> End {
        let facts = self.facts();
        let Ruling { status, detail, effects } = rules::rule(&facts, id, action);
        // What lay on a thing that is taken away falls.
        let falling = match action {
            Action::PickUp { object } if status.is_success() => physics::lying_on(&facts, *object),
            _ => Vec::new(),
        };
        let effects = effects.into_iter().chain(falling.into_iter().map(|object| Effect::LetGo(object, Vec3::ZERO)));
        let effects = effects.collect();
        self.changes(events).apply(effects);
        (status, detail)
    }

    /// What a hand does: step out of the swing of what it opens, turn to it, reach out. What is in the hand already
    /// needs no turning.
    fn hand_steps(&self, id: BodyId, action: &Action) -> Vec<Step> {
        let facts = self.facts();
        let mut steps = vec![Step::Reach];
        let Some(object) = rules::object_of(action).filter(|object| facts.object(*object).held_by() != Some(id)) else {
            return steps;
        };
        steps.push(Step::Face { point: facts.aim_point(object) });
        if matches!(action, Action::Interact { verb: Verb::Open | Verb::Close, .. }) {
            let body = &self.state.bodies[id.0 as usize];
            let sweep = Sweep::of(&facts, object, body.figure().height_m);
            let beside = (sweep.distance(body.position) < body.figure().radius_m)
                .then(|| {
                    self.place_clear_of(&sweep, body, |place| {
                        facts.reach_to(object, place) < rules::REACH_M - 0.1 && !facts.walled_off(object, place)
                    })
                })
                .flatten();
            steps.extend(beside.map(|place| Step::Walk { path: vec![place], next: 0 }));
        }
        steps
    }

    /// The closed door on the next stretch of a walk that a body is close enough to, and may open.
    fn door_ahead(&self, body: &Body, step: &Step) -> Option<ObjectId> {
        let Step::Walk { path, next } = step else { return None };
        self.floor.gaps.iter().find_map(|gap| {
            let door = gap.door_object?;
            let object = self.state.at(door);
            let shut = object.exists()
                && !object.flags.has(StateFlag::Opened)
                && !object.flags.has(StateFlag::Locked)
                && gap.print.distance(body.position) < DOOR_NEAR_M;
            let on_the_way = shut && {
                let points = std::iter::once(body.position).chain(path.iter().skip(*next).copied());
                let points: Vec<Vec2> = points.take(4).collect();
                points.windows(2).any(|stretch| gap.print.cut_by(stretch[0], stretch[1]))
            };
            on_the_way.then_some(door)
        })
    }
}

/// How the command of a robot that a hazard killed ends.
fn out_of_order() -> End {
    (Status::KilledByHazard, "this robot is out of order".to_owned())
}

/// How a motion ends that came to its end.
fn arrived(task: &Task) -> End {
    if task.alternate {
        return (Status::AlternateNavigationUsed, "I went as near as I could".to_owned());
    }
    let detail = match task.action {
        Action::GoTo { .. } => "I am there",
        Action::Move { .. } => "I moved",
        Action::Rotate { .. } => "I turned",
        Action::Look { .. } | Action::LookAround => "I looked",
        Action::Drive { .. } => "I went as I was driven",
        _ => "done",
    };
    (Status::ActionSuccessful, detail.to_owned())
}

/// The object that an action names.
fn mentioned(action: &Action) -> Option<ObjectId> {
    match *action {
        Action::GoTo { target: GoToTarget::Object(object) } => Some(object),
        _ => rules::object_of(action),
    }
}

fn check_numbers(action: &Action) -> Result<(), End> {
    let fine = match *action {
        Action::Move { distance_m } => distance_m.is_finite() && distance_m.abs() <= FURTHEST_M,
        Action::Rotate { yaw_rad } => yaw_rad.is_finite() && yaw_rad.abs() <= 2.0 * std::f32::consts::TAU,
        Action::Look { pitch_rad } => pitch_rad.is_finite(),
        Action::Drive { forward_m_s, turn_rad_s, pitch_rad_s } => {
            [forward_m_s, turn_rad_s, pitch_rad_s].iter().all(|speed| speed.is_finite())
        }
        Action::GoTo { target: GoToTarget::Point(point) } => {
            point.iter().all(|coordinate| coordinate.is_finite() && coordinate.abs() < 1e4)
        }
        _ => true,
    };
    if fine { Ok(()) } else { Err((Status::IncorrectActionFormat, "that is no sensible number".to_owned())) }
}
