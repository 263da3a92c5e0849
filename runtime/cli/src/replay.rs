//! `cohabit replay`: does a recorded session come out the same?

use std::{path::PathBuf, sync::Arc, time::Instant};

use cohabit_cdf::Catalog;
use cohabit_record::Log;

use crate::failure::bad_input;

/// Feeds a log's inputs to a new world, and compares the digests of every tick.
#[derive(clap::Args)]
pub struct Replay {
    /// The session log
    log: PathBuf,
}

impl Replay {
    /// Replays; fails if a tick differs.
    pub fn run(&self) -> anyhow::Result<()> {
        let log = Log::open(&self.log).map_err(bad_input)?;
        let path = self.log.display();
        println!(
            "{path}: session {}, mission {}, seed {}",
            log.session.session, log.session.mission_file, log.session.seed
        );
        if let Some(reason) = &log.cut {
            println!("{path} ends early ({reason}); what it holds is replayed");
        }
        let missing = log.missing();
        if missing > 0 {
            println!("{path} misses {missing} events or dialog messages: its recorder was away for too long");
        }
        let began = Instant::now();
        let replay = cohabit_engine::replay::replay(&log, Arc::new(Catalog::builtin())).map_err(bad_input)?;
        let simulated_s = replay.ticks as f64 * cohabit_engine::replay::TICK_S;
        let wall_s = began.elapsed().as_secs_f64();
        println!(
            "{} ticks ({simulated_s:.1} s) with {} inputs replayed in {wall_s:.2} s, {:.0} times real time; {} of {} goals met",
            replay.ticks,
            replay.inputs,
            simulated_s / wall_s.max(1e-9),
            replay.goals.0,
            replay.goals.1
        );
        match replay.difference {
            None => {
                println!("no tick differs");
                Ok(())
            }
            Some(difference) => anyhow::bail!("{difference}"),
        }
    }
}
