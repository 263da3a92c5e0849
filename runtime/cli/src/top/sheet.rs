//! What is shown: figures, as text for people and as JSON for programs.

use std::fmt;

use cohabit_bus::{
    message::{NONE, Stage},
    monotonic_nanos,
};
use cohabit_world::DT_NANOS;
use serde_json::{Value, json};

use super::window::{Peer, Window};
use crate::terminal::shown;

/// The figures of one moment.
pub struct Sheet {
    session: String,
    paused: bool,
    tick: u64,
    ticks_per_s: f64,
    late: Spread,
    /// Ticks that began a whole tick too late, of how many.
    missed: (usize, usize),
    stages: Vec<(&'static str, Spread)>,
    peers: Vec<Row>,
}

/// How values spread, µs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Spread {
    mean: f64,
    p50: f64,
    p99: f64,
    max: f64,
}

/// One peer.
struct Row {
    peer: String,
    body: Option<u32>,
    process: u32,
    behind: Option<u64>,
    lost: u64,
    beat_s: f64,
    core: Option<f64>,
    resident_bytes: u64,
}

/// A peer that is silent for so long may hang, s.
const SILENT_S: f64 = 2.0;

impl Spread {
    fn of(nanos: impl Iterator<Item = u64>) -> Self {
        let mut values: Vec<f64> = nanos.map(|nanos| nanos as f64 * 1e-3).collect();
        if values.is_empty() {
            return Self::default();
        }
        values.sort_by(f64::total_cmp);
        let at = |share: f64| values[((values.len() - 1) as f64 * share).round() as usize];
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        Self { mean, p50: at(0.5), p99: at(0.99), max: at(1.0) }
    }

    fn json(self) -> Value {
        json!({ "mean_us": self.mean, "p50_us": self.p50, "p99_us": self.p99, "max_us": self.max })
    }
}

impl Row {
    fn new(peer: &Peer) -> Self {
        let Peer { pulse, .. } = peer;
        Self {
            peer: shown(pulse.peer.as_str()).to_string(),
            body: (pulse.body != NONE).then_some(pulse.body),
            process: peer.process,
            behind: peer.behind,
            lost: pulse.lost,
            beat_s: monotonic_nanos().saturating_sub(peer.beat_nanos) as f64 * 1e-9,
            core: peer.usage.core,
            resident_bytes: peer.usage.resident_bytes,
        }
    }

    fn json(&self) -> Value {
        json!({
            "peer": self.peer, "body": self.body, "process": self.process, "ticks_behind": self.behind,
            "lost": self.lost, "last_beat_s": self.beat_s, "core": self.core, "resident_bytes": self.resident_bytes,
        })
    }
}

impl Sheet {
    pub fn new(session: &str, paused: bool, window: &Window) -> Self {
        let ticks = &window.ticks;
        let spans = ticks.front().zip(ticks.back()).map(|((first, _), (last, _))| last.saturating_sub(*first));
        let span_s = spans.unwrap_or(0) as f64 * 1e-9;
        let stage = |stage: Stage| {
            let nanos = ticks.iter().map(move |(_, header)| u64::from(header.stage_nanos[stage as usize]));
            (name(stage), Spread::of(nanos))
        };
        let late = |(_, header): &(u64, cohabit_bus::message::TickHeader)| header.late_nanos;
        let mut peers: Vec<Row> = window.peers.values().map(Row::new).collect();
        peers.sort_by(|one, other| (&one.peer, one.body, one.process).cmp(&(&other.peer, other.body, other.process)));
        Self {
            session: session.to_owned(),
            paused,
            tick: window.newest_tick(),
            ticks_per_s: if span_s > 0.0 { (ticks.len() - 1) as f64 / span_s } else { 0.0 },
            late: Spread::of(ticks.iter().map(late)),
            missed: (ticks.iter().map(late).filter(|late| *late >= DT_NANOS).count(), ticks.len()),
            stages: Stage::ALL.map(stage).to_vec(),
            peers,
        }
    }

    pub fn json(&self) -> Value {
        let stages: serde_json::Map<String, Value> =
            self.stages.iter().map(|(name, spread)| ((*name).to_owned(), spread.json())).collect();
        json!({
            "session": self.session, "paused": self.paused, "tick": self.tick, "ticks_per_s": self.ticks_per_s,
            "ticks": self.missed.1, "missed": self.missed.0, "late": self.late.json(), "stages": stages,
            "peers": self.peers.iter().map(Row::json).collect::<Vec<_>>(),
        })
    }
}

/// A stage in one word.
const fn name(stage: Stage) -> &'static str {
    match stage {
        Stage::Wait => "wait",
        Stage::Drain => "drain",
        Stage::Rule => "rule",
        Stage::Move => "move",
        Stage::Work => "work",
        Stage::Physics => "physics",
        Stage::Judge => "judge",
        Stage::Publish => "publish",
        Stage::Record => "record",
        Stage::Show => "show",
    }
}

impl fmt::Display for Sheet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { session, tick, ticks_per_s, late, missed: (missed, of), .. } = self;
        let seconds = (tick * DT_NANOS) as f64 * 1e-9;
        let standing = if self.paused { "   standing still" } else { "" };
        writeln!(f, "session {session}   tick {tick}, {seconds:.1} s of the world{standing}")?;
        writeln!(f, "{ticks_per_s:.1} ticks/s   {missed} of {of} missed")?;
        writeln!(
            f,
            "late: p50 {:.3} ms   p99 {:.3} ms   max {:.3} ms",
            late.p50 / 1e3,
            late.p99 / 1e3,
            late.max / 1e3
        )?;
        writeln!(f, "\n{:<10}{:>10}{:>10}{:>10}{:>10}  µs a tick", "stage", "mean", "p50", "p99", "max")?;
        for (name, Spread { mean, p50, p99, max }) in &self.stages {
            writeln!(f, "{name:<10}{mean:>10.1}{p50:>10.1}{p99:>10.1}{max:>10.1}")?;
        }
        let heads = ["body", "process", "behind", "lost", "beat", "core", "memory"];
        write!(f, "\n{:<12}", "peer")?;
        heads.iter().try_for_each(|head| write!(f, "{head:>9}"))?;
        writeln!(f)?;
        for row in &self.peers {
            let or_none = |number: Option<u64>| number.map_or_else(|| "–".to_owned(), |number| number.to_string());
            let (body, behind) = (or_none(row.body.map(u64::from)), or_none(row.behind));
            let core = row.core.map_or_else(|| "–".to_owned(), |core| format!("{:.0} %", 100.0 * core));
            let memory = format!("{} MB", row.resident_bytes >> 20);
            let beat = format!("{:.1} s", row.beat_s);
            let silent = if row.beat_s > SILENT_S { "  silent" } else { "" };
            let Row { peer, process, lost, .. } = row;
            writeln!(f, "{peer:<12}{body:>9}{process:>9}{behind:>9}{lost:>9}{beat:>9}{core:>9}{memory:>9}{silent}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_spread() {
        let spread = Spread::of((1..=100).map(|value| value * 1000));
        assert_eq!((spread.mean, spread.p50, spread.p99, spread.max), (50.5, 51.0, 99.0, 100.0));
        assert_eq!(Spread::of(std::iter::empty()), Spread::default());
    }
}
