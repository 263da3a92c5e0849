//! What the changes of the table are in a world: each becomes the effects that bring it about.

use cohabit_cdf::{
    BodyId, Fluid, ObjectId, StateFlag,
    catalog::table::{Change, Scope, Term},
};
use glam::Vec3;

use super::{Observer, doors, places, press, work::settle};
use crate::{
    effect::Effect,
    facts::Facts,
    report::Event,
    works::{lab, portal, vending},
};

/// How long a throw flies, s: half a second is a gentle toss.
const FLIGHT_S: f32 = 0.5;
const GRAVITY_M_S2: f32 = 9.81;

/// The effects of changes that all follow from the facts.
pub(crate) fn effects_of(observer: &Observer<'_>, scope: &Scope, changes: &[&Change]) -> Vec<Effect> {
    changes.iter().filter_map(|change| effects_of_one(observer, scope, change)).flatten().collect()
}

/// The effects of one change; none, where what it is about is not there.
fn effects_of_one(observer: &Observer<'_>, scope: &Scope, change: &Change) -> Option<Vec<Effect>> {
    let facts = observer.facts;
    let id = |term: &Term| scope.get(observer, *term);
    Some(match change {
        Change::Set(of, flag, value) => vec![Effect::Set(id(of)?, *flag, *value)],
        Change::Copy(flag, from, to) => vec![Effect::Set(id(to)?, *flag, facts.is(id(from)?, *flag))],
        Change::Fill(of, fluid) => vec![Effect::Fill(id(of)?, *fluid)],
        Change::Pour(from, to) => pour(facts, id(from)?, id(to)?),
        Change::Drain(of, fluid) => drain(facts, id(of)?, *fluid),
        Change::Paint(of, color) => vec![Effect::Paint(id(of)?, *color)],
        // A walk is ruled by the ways that there are.
        Change::Approach(_) => Vec::new(),
        Change::Take(of) => vec![Effect::Hold(id(of)?, observer.body?)],
        Change::Put(of, to) => vec![places::put(observer, id(of)?, id(to)?)?],
        Change::Throw(of) => vec![throw(facts, observer.body?, id(of)?, scope.it?)],
        Change::Send(of, by) => portal::pass(facts, id(by)?, id(of)?)?,
        Change::Flip(of, other) => {
            let of = id(of)?;
            let on = !facts.is(of, StateFlag::Toggled);
            let both = std::iter::once(of).chain(other.as_ref().and_then(id));
            both.map(|id| Effect::Set(id, StateFlag::Toggled, on)).collect()
        }
        Change::Run(of, other) => vec![press::start(observer, id(of)?, other.as_ref().and_then(id))],
        Change::Feed(of, by) => {
            vec![Effect::Feed(facts.object(id(of)?).feeds?, !facts.is(id(by)?, StateFlag::Toggled))]
        }
        Change::SwingDoors => doors::swing(facts),
        Change::Turn(of) => vec![Effect::Turn(id(of)?)],
        Change::Settle(of) => settle(facts, id(of)?),
        Change::Slice(of) => vec![lab::slice(facts, id(of)?)?],
        Change::Restore(of) => lab::yesterday(facts, id(of)?, lab::spot_of(facts, id(of)?)),
        Change::Become(of, class) => lab::become_one(facts, id(of)?, class)?,
        Change::Print(of) => vec![lab::print(facts, id(of)?)?],
        Change::Spawn(of, class) => vec![lab::spawn(facts, id(of)?, class)?],
        Change::Remove(of) => vec![Effect::Remove(id(of)?)],
        Change::Resize(of) => lab::resize(facts, id(of)?).to_vec(),
        Change::Vend(of, slot) => vec![vending::vend(facts, id(of)?, *slot)?],
        Change::Scan(of) => vec![Effect::Tell(Event::Scanned { object: id(of)? })],
        Change::Read(of) => read(facts, id(of)?).into_iter().collect(),
        Change::Sound(kind, of) => vec![Effect::sound(*kind, id(of)?)],
    })
}

fn pour(facts: &Facts<'_>, from: ObjectId, to: ObjectId) -> Vec<Effect> {
    if facts.object(to).fluid != Fluid::None {
        return Vec::new();
    }
    vec![Effect::Fill(from, Fluid::None), Effect::Fill(to, facts.object(from).fluid)]
}

fn drain(facts: &Facts<'_>, of: ObjectId, fluid: Fluid) -> Vec<Effect> {
    let all = std::iter::once(of).chain(facts.contents(of));
    all.filter(|id| facts.object(*id).fluid == fluid).map(|id| Effect::Fill(id, Fluid::None)).collect()
}

fn throw(facts: &Facts<'_>, body: BodyId, object: ObjectId, target: ObjectId) -> Effect {
    let hand = facts.state.bodies[body.0 as usize].hand().position;
    let velocity = (facts.aim_point(target) - hand) / FLIGHT_S + Vec3::Z * (GRAVITY_M_S2 * FLIGHT_S / 2.0);
    Effect::LetGo(object, velocity)
}

fn read(facts: &Facts<'_>, object: ObjectId) -> Option<Effect> {
    let text = facts.object(object).text.clone();
    (!text.is_empty()).then_some(Effect::Tell(Event::NoteRead { object, text }))
}
