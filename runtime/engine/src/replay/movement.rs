//! How the bodies of a recorded session moved: it is gone through again, since a log holds no poses.

use std::{collections::BTreeMap, sync::Arc};

use cohabit_cdf::{Action, Catalog};
use cohabit_record::{Log, Movement, Stop, Trail, Travel};
use cohabit_world::{BodyView, Input, Outcome, Vec2, World};

use super::{ReplayError, Replayer};

/// How all bodies moved in the session of `log`, as far as it can be gone through again and is the same as it was recorded.
///
/// # Errors
/// [`ReplayError`], when the log's session cannot be played by this program.
pub fn movement(log: &Log, catalog: Arc<Catalog>) -> Result<Movement, ReplayError> {
    let mut replayer = Replayer::new(log, catalog)?;
    let trails = replayer.world().bodies().map(|body| trail(&body)).collect();
    let mut watched = Watched { movement: Movement { trails, ..Movement::default() }, sent: BTreeMap::new() };
    watched.note_stops(replayer.world());
    loop {
        if let Some(problem) = watched.go_through(&mut replayer) {
            watched.movement.problem = Some(problem);
            break;
        }
        let Some(gap) = replayer.gap() else { break };
        let problem = gap.to_string();
        if !replayer.skip_gap() {
            watched.movement.problem = Some(problem);
            break;
        }
        watched.movement.problem.get_or_insert(problem);
        // What happened in a gap is not known.
        watched.sent.clear();
        watched.note_stops(replayer.world());
    }
    Ok(watched.movement)
}

fn trail(body: &BodyView) -> Trail {
    Trail { body: body.id.0, kind: body.kind, radius_m: f64::from(body.radius_m), stops: Vec::new() }
}

/// What has been seen so far, and who is on the way, by body.
struct Watched {
    movement: Movement,
    sent: BTreeMap<u32, Sent>,
}

/// A way that is not over: its command, the tick after which it began, and where.
#[derive(Clone, Copy)]
struct Sent {
    command: u64,
    from: u64,
    start: Vec2,
    /// Length of the shortest way there was then, m.
    possible_m: Option<f64>,
}

impl Watched {
    /// Goes on up to a gap or the end; says why not further, if what follows is not what was recorded.
    fn go_through(&mut self, replayer: &mut Replayer<'_>) -> Option<String> {
        loop {
            let before: Vec<Vec2> = replayer.world().bodies().map(|body| body.position_m.truncate()).collect();
            let replayed = replayer.step()?;
            if let Some(difference) = replayed.difference {
                return Some(difference.to_string());
            }
            for input in &replayed.inputs {
                self.note_input(replayed.entry.tick.saturating_sub(1), input, &before, replayer.world());
            }
            for outcome in &replayed.report.outcomes {
                self.note_outcome(replayer.world(), outcome);
            }
            self.note_stops(replayer.world());
        }
    }

    fn note_input(&mut self, from: u64, input: &Input, before: &[Vec2], world: &World) {
        let Input { command, body, action } = *input;
        // A way that is interrupted is none.
        self.sent.remove(&body.0);
        if let (Action::GoTo { target }, Some(start)) = (action, before.get(body.0 as usize).copied()) {
            // The tick in which it set out is over.
            let set_out_m = world.body(body).map_or(0.0, |own| own.position_m.truncate().distance(start));
            let possible_m = world.way_m(body, target).map(|way_m| f64::from(set_out_m + way_m));
            self.sent.insert(body.0, Sent { command, from, start, possible_m });
        }
    }

    fn note_outcome(&mut self, world: &World, outcome: &Outcome) {
        let body = outcome.body.0;
        let is_this = |sent: &&Sent| sent.command == outcome.command;
        let Some(Sent { from, start, possible_m, .. }) = self.sent.get(&body).filter(is_this).copied() else { return };
        self.sent.remove(&body);
        let end = world.body(outcome.body).map_or(start, |body| body.position_m.truncate());
        self.movement.travels.push(Travel {
            body,
            from,
            to: world.tick(),
            success: outcome.status.is_success(),
            shortest_m: world.path(start, end).map(|(_, length_m)| f64::from(length_m)),
            possible_m,
        });
    }

    fn note_stops(&mut self, world: &World) {
        for (trail, body) in self.movement.trails.iter_mut().zip(world.bodies()) {
            let at_m = [f64::from(body.position_m.x), f64::from(body.position_m.y)];
            trail.stops.push(Stop { tick: world.tick(), at_m, yaw_rad: f64::from(body.yaw_rad) });
        }
    }
}
