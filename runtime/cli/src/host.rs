//! `cohabit host`: many sessions on this machine, or how many it carries.

mod starter;

use std::{
    ffi::OsString,
    path::{Path, PathBuf},
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, Ordering},
    },
    thread,
};

use anyhow::Context as _;
use clap::Parser;
use cohabit_dialog::token;
use cohabit_host::{Board, HostService, LEAST_PICTURES, MOST_MISSED, Needs, keep};
use serde_json::json;

use crate::{
    capacity::{MOST_TRIED, SessionCount, ThisMachine, Trial, WHOLE_S, cores, known, measure, note},
    doctor::ensure_room,
    failure::bad_input,
    mission_file::MissionFile,
    play::Play,
    sessions,
    site::{Ending, SiteOptions},
    stop,
    study::{PortRange, Ports},
    terminal::{print, shown, shown_json},
    world::WorldPacks,
};
use starter::HostStarter;

/// The mission that is played where none is named.
const MISSION: &str = "make_cereal";
/// What a session is expected to take, where nothing was measured of any: the first one shows what it takes before another is admitted.
const EXPECTED: Needs = Needs { cores: 0.25, memory_bytes: 384 << 20 };
/// A session alone draws with no more threads than this: as many as `play` has.
const MOST_THREADS: usize = 2;
/// Options of `play` that sessions do not share, or that the page of all of them has, too.
const OWN: [&str; 9] =
    ["--port", "--session", "--log", "--listen", "--host", "--tls", "--tls-certificate", "--tls-key", "--branch"];
/// The shortest and the longest time that sessions are watched, s.
const TIMES_S: std::ops::RangeInclusive<f64> = 1.0..=600.0;

/// Plays many sessions at a time, each at a port of its own, and serves a page of all of them that says how they are and starts and
/// ends them. One more begins only while the load that was measured admits it
#[derive(clap::Args)]
pub struct Host {
    /// Mission files (CDF), or names of built-in missions, which the sessions take in turn; making a bowl of cereal, if absent
    missions: Vec<String>,
    /// How many sessions there are to be: a number, `quick` for as many as the machine carries by what one takes, or `full` for as many as
    /// it was seen to carry, which takes minutes where it was not measured yet
    #[arg(long, value_name = "COUNT|quick|full", default_value_t = SessionCount::Quick)]
    sessions: SessionCount,
    /// Instead, measure how many sessions this machine carries: plays one, two and more at a time, each with one page, until more than
    /// 0.5 % of ticks are missed or pages get less than half of their pictures
    #[arg(long, conflicts_with_all = ["sessions", "port", "session_ports", "logs"])]
    measure: bool,
    /// With --measure, how long each number of sessions is watched
    #[arg(long, value_name = "SECONDS", default_value_t = WHOLE_S, value_parser = seconds, requires = "measure")]
    seconds: f64,
    /// With --measure, the most sessions that are tried; with 1, the rest is estimated by what one takes
    #[arg(long, value_name = "COUNT", default_value_t = MOST_TRIED, requires = "measure",
        value_parser = clap::value_parser!(u16).range(1..))]
    most: u16,
    /// With --measure, print one JSON document
    #[arg(long, requires = "measure")]
    json: bool,
    /// The port of the page of all sessions; 0 takes any that is free
    #[arg(long, default_value_t = 8720)]
    port: u16,
    #[command(flatten)]
    site: SiteOptions,
    /// The ports of the pages of sessions, such as 8721-8728: one for each; any that are free, if absent
    #[arg(long, value_name = "FIRST-LAST")]
    session_ports: Option<PortRange>,
    /// The folder for the logs of sessions; the user's data folder if absent
    #[arg(long, value_name = "DIR")]
    logs: Option<PathBuf>,
    #[command(flatten)]
    packs: WorldPacks,
    /// Options of `cohabit play` that all sessions have, behind two dashes
    #[arg(last = true, value_name = "OPTIONS")]
    options: Vec<OsString>,
}

fn seconds(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|seconds| TIMES_S.contains(seconds));
    seconds.ok_or_else(|| format!("seconds, from {} to {}", TIMES_S.start(), TIMES_S.end()))
}

/// The command line of `play`, by itself.
#[derive(Parser)]
#[command(no_binary_name = true)]
struct PlayLine {
    #[command(flatten)]
    play: Play,
}

impl Host {
    /// Hosts until the user ends it, or measures.
    pub fn run(&self) -> anyhow::Result<()> {
        let stop = stop::on_request()?;
        let options = self.options()?;
        if self.measure { self.measure(options, &stop) } else { self.host(options, &stop) }
    }

    fn missions(&self) -> Vec<String> {
        if self.missions.is_empty() { vec![MISSION.to_owned()] } else { self.missions.clone() }
    }

    /// What all sessions are played by besides, if their missions can be played so.
    fn options(&self) -> anyhow::Result<Vec<OsString>> {
        let world = self.packs.read()?;
        let options: Vec<OsString> = self.packs.arguments(&world).into_iter().chain(self.options.clone()).collect();
        let line = PlayLine::try_parse_from(&options).map_err(|error| bad_input(said(&error.to_string())))?;
        if let Some(option) = self.options.iter().find_map(|option| own(&option.to_string_lossy())) {
            return Err(bad_input(format!("`{option}` behind the two dashes: each session has its own")));
        }
        for mission in self.missions() {
            let file = MissionFile::find_in(Some(&mission), &world)?;
            let plan = file.plan(world.catalog(), 0, &[]).map_err(bad_input)?;
            line.play.check_for(plan, Path::new("."))?;
        }
        Ok(options)
    }

    fn measure(&self, options: Vec<OsString>, stop: &AtomicBool) -> anyhow::Result<()> {
        let mission = self.missions().swap_remove(0);
        let is_usual = self.missions.is_empty() && options.is_empty();
        let trial = Trial { most: usize::from(self.most), seconds: self.seconds, mission, arguments: options };
        let mut told = |step: &cohabit_host::Step| {
            if !self.json {
                println!("{step}");
            }
        };
        let capacity = measure(&trial, stop, &mut told)?;
        if is_usual {
            note(&capacity);
        }
        if !self.json {
            println!("{capacity}, with at most {} % of ticks missed", 100.0 * MOST_MISSED);
            return Ok(());
        }
        let mut document =
            json!({ "fits": capacity.fits(), "most_missed": MOST_MISSED, "least_pictures": LEAST_PICTURES });
        document["measured"] = json!(capacity);
        print(&format!("{}\n", shown_json(format!("{document:#}"))))
    }

    fn host(&self, options: Vec<OsString>, stop: &Arc<AtomicBool>) -> anyhow::Result<()> {
        ensure_room()?;
        let identity = self.site.identity()?;
        let (listener, listening) = self.site.listen("the page of all sessions", self.port, identity.as_ref())?;
        let count = self.count(stop)?;
        let missions = self.missions();
        let missions = missions.iter().cycle().take(count).cloned();
        // Whoever says how many threads draw is believed.
        let is_said = options.iter().any(|option| option.to_string_lossy().starts_with("--threads"));
        let threads = (!is_said).then(|| threads(count, cores()));
        let shares = shares(threads);
        let board = Arc::new(Mutex::new(Board::new(missions, expected(), &shares)));
        let service = HostService::new(Arc::clone(&board)).context("a token for the page")?;
        let mut starter = HostStarter {
            listen: listening.ip(),
            site: self.site.clone(),
            ports: self.session_ports.clone().map(Ports::new),
            logs: sessions::folder(self.logs.as_deref())?,
            threads,
            options,
            tries: 0,
        };
        println!("{shares}");
        println!("Sessions are recorded in {}", shown(starter.logs.display()));
        println!("Page of all sessions: {}{}", token::site_address(listening, identity.is_some()), service.door());
        println!("{count} sessions begin one after the other as load admits them; Ctrl-C ends all");
        thread::scope(|scope| {
            let (hosts, over) = (self.site.hosts.clone(), &**stop);
            let server = scope.spawn(move || {
                let ending = Ending(over);
                let served = service.serve(listener, hosts, identity, &|| over.load(Ordering::Relaxed));
                drop(ending);
                served
            });
            // Sessions end with the thread that starts them, so it is the one that lives longest.
            keep(&board, &mut starter, &mut ThisMachine::new(), over);
            server.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        })
        .context("serve the page of all sessions")?;
        println!("All sessions have ended");
        Ok(())
    }

    /// How many sessions there are to be.
    fn count(&self, stop: &AtomicBool) -> anyhow::Result<usize> {
        let ports = self.session_ports.as_ref().map_or(usize::MAX, PortRange::count);
        match self.sessions {
            SessionCount::Count(count) if usize::from(count) > ports => {
                Err(bad_input(format!("`--session-ports` are {ports} for {count} sessions: give more")))
            }
            asked => Ok(asked.find(stop).min(ports)),
        }
    }
}

/// The option of [`OWN`] that an argument is, if it is one.
fn own(argument: &str) -> Option<&'static str> {
    let name = argument.split('=').next()?;
    OWN.into_iter().find(|own| *own == name)
}

/// What clap says, in one line, without how `play` is used.
fn said(text: &str) -> String {
    let lines = text.trim_start_matches("error: ").lines().map(str::trim);
    let lines = lines.take_while(|line| !line.starts_with("Usage:") && !line.starts_with("For more"));
    lines.filter(|line| !line.is_empty()).collect::<Vec<_>>().join(" ")
}

/// What a session is expected to take, by what was measured of this machine.
fn expected() -> Needs {
    let step = known().and_then(|capacity| capacity.steps.first().copied());
    step.map_or(EXPECTED, |step| Needs { cores: step.cores_each(), memory_bytes: step.memory_each() })
}

/// With how many threads each of so many sessions draws: alike for all, and no more of them than there are cores where that is possible.
fn threads(sessions: usize, cores: usize) -> usize {
    (cores / sessions.max(1)).clamp(1, MOST_THREADS)
}

/// In words, how cores are shared.
fn shares(threads: Option<usize>) -> String {
    let drawn = match threads {
        None => "as many threads as its options say",
        Some(1) => "one thread",
        Some(_) => "two threads",
    };
    format!("Each session draws with {drawn}; its ticks go first, and no session is preferred to another")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        host: Host,
    }

    fn host(arguments: &[&str]) -> Host {
        Line::try_parse_from([&["host"][..], arguments].concat()).expect("a command line").host
    }

    #[test]
    fn cores_are_shared_alike() {
        for (sessions, cores, expected) in [(1, 1, 1), (1, 8, 2), (4, 8, 2), (5, 8, 1), (8, 8, 1), (9, 8, 1), (0, 8, 2)]
        {
            assert_eq!(threads(sessions, cores), expected, "{sessions} on {cores}");
        }
        assert!(shares(Some(1)).starts_with("Each session draws with one thread;"));
        assert!(shares(None).contains("as its options say"));
    }

    #[test]
    fn sessions_are_checked_before_any_begins() {
        assert!(host(&["cold_soda", "--", "--ask", "never"]).options().is_ok());
        for (arguments, part) in [
            (&["warm_soda"][..], "warm_soda: there is no such file"),
            (&["--", "--hat"], "unexpected argument '--hat'"),
            (&["--", "--port=7"], "`--port` behind the two dashes"),
            (&["cold_soda", "--", "--name=2=Rosie"], "there is no body 2"),
        ] {
            let said = format!("{:#}", host(arguments).options().expect_err("what cannot be played"));
            assert!(said.contains(part) && !said.contains("Usage"), "{said}");
        }
    }

    #[test]
    fn ports_are_one_for_each_session() {
        let stop = AtomicBool::new(false);
        let few =
            host(&["--sessions", "3", "--session-ports", "8721-8722"]).count(&stop).expect_err("one lacks a port");
        assert_eq!(few.to_string(), "`--session-ports` are 2 for 3 sessions: give more");
        assert_eq!(host(&["--sessions", "3", "--session-ports", "8721-8723"]).count(&stop).expect("ports"), 3);
    }

    #[test]
    fn what_measures_hosts_nothing() {
        for arguments in [&["--measure", "--sessions", "3"][..], &["--json"], &["--measure", "--seconds", "0"]] {
            assert!(Line::try_parse_from([&["host"][..], arguments].concat()).is_err(), "{arguments:?}");
        }
        assert!(host(&["--measure", "--json", "--most", "1", "cold_soda"]).measure);
    }
}
