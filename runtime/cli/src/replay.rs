//! `cohabit replay`: does a recorded session come out the same, and what was to be seen of it?

mod film;
mod page;
pub mod picture;
mod y4m;

use std::{
    ffi::OsString,
    ops::ControlFlow,
    path::{Path, PathBuf},
    sync::Arc,
    time::Instant,
};

use cohabit_engine::{Replayer, replay};
use cohabit_record::{Log, SessionEntry, entry::fingerprint};

use crate::{
    branch::BranchPoint, failure::bad_input, rendering::Rendering, rerun, session_time::SessionTime, terminal::shown,
    world::WorldPacks,
};
use film::{Film, FilmOptions};
use page::PageOptions;

/// Feeds a log's inputs to a new world, and compares the digests of every tick.
#[derive(clap::Args)]
pub struct Replay {
    /// The session log
    log: PathBuf,
    /// Begin at this time of the session: seconds (83.5), minutes (1:23.5), or a tick (tick:4980); what was before is not
    /// compared
    #[arg(long, value_name = "TIME")]
    at: Option<SessionTime>,
    /// End at this time of the session
    #[arg(long, value_name = "TIME")]
    until: Option<SessionTime>,
    #[command(flatten)]
    film: FilmOptions,
    #[command(flatten)]
    page: PageOptions,
    #[command(flatten)]
    packs: WorldPacks,
    #[command(flatten)]
    rendering: Rendering,
    /// Go on live from this time of the session: starts a session as `play` does, whose log says where it went on from
    #[arg(long, value_name = "TIME", conflicts_with_all = ["at", "until", "frames", "video", "page", "renderer", "threads"])]
    branch: Option<SessionTime>,
    /// Options of `play` for `--branch`, such as `-- --port 0 --participant P07`
    #[arg(last = true, requires = "branch", value_name = "OPTIONS OF PLAY")]
    play: Vec<OsString>,
    /// Make a recording of it for rerun, with `--rate` pictures a second of the robot's eyes; beside the log, if no file is
    /// named
    #[arg(long, value_name = "FILE.rrd", num_args = 0..=1, conflicts_with_all = ["at", "until", "frames", "video", "page", "branch"])]
    rerun: Option<Option<PathBuf>>,
    /// What those pictures show; or `none`
    #[arg(long, value_name = "PLANE[+PLANE]", default_value = "color+depth+normals+ids", requires = "rerun")]
    planes: String,
}

impl Replay {
    /// Replays; fails if a tick differs.
    pub fn run(&self) -> anyhow::Result<()> {
        let named = self.rerun.iter().flatten().map(PathBuf::as_path);
        named.chain(self.film.video()).try_for_each(rerun::ensure_no_log)?;
        if let Some(out) = &self.rerun {
            if !self.packs.is_empty() {
                let remedy = "`--page`, `--video` and `--frames` can; one without packs needs no `--world`";
                return Err(bad_input(format!("`--rerun` cannot show a session of a world pack yet: {remedy}")));
            }
            let out = out.clone().unwrap_or_else(|| self.log.with_extension("rrd"));
            return rerun::replay(&self.log, &out, self.film.rate(), &self.planes);
        }
        if let Some(at) = self.branch {
            let point = BranchPoint { log: self.log.clone(), at };
            let packs = self.packs.folders();
            return crate::play(std::iter::once(point.argument()).chain(packs).chain(self.play.iter().cloned()));
        }
        let log = open(&self.log)?;
        let mut replayer = Replayer::new(&log, Arc::clone(self.packs.read()?.catalog())).map_err(bad_input)?;
        tell_what_changed(&log.session, &replayer);
        if let Some(at) = self.at {
            self.check_order(at)?;
            self.go_to(at, &mut replayer)?;
        }
        if self.page.page {
            return self.page.show(replayer, self.rendering);
        }
        let mut film = self.film.begin(&replayer, self.rendering)?;
        if let Some(film) = &mut film {
            film.see(&replayer)?;
        }
        self.replay(&mut replayer, film)
    }

    fn check_order(&self, at: SessionTime) -> anyhow::Result<()> {
        match self.until.filter(|until| *until < at) {
            Some(until) => Err(bad_input(format!("`--until {until}`: that is before `--at {at}`"))),
            None => Ok(()),
        }
    }

    fn go_to(&self, at: SessionTime, replayer: &mut Replayer<'_>) -> anyhow::Result<()> {
        let [first, last] = replayer.span();
        if !(first..=last).contains(&at.tick) {
            let [first, last] = [first, last].map(|tick| SessionTime { tick });
            return Err(bad_input(format!("{}: `--at {at}`: it goes from {first} to {last}", self.log.display())));
        }
        replayer.go_to(at.tick).map_err(bad_input)?;
        let world = replayer.world();
        println!("At {at} (tick {}):", world.tick());
        for body in world.bodies() {
            let held = body.held.and_then(|held| world.object(held));
            let holds = held.map_or_else(|| "nothing".to_owned(), |object| object.instance.to_owned());
            let [x, y, _] = body.position_m.to_array();
            println!("  body {} in {} at {x:.2} {y:.2}, holds {}", body.id.0, body.room.id(), shown(holds));
        }
        for goal in world.goals() {
            println!("  [{}] {}", if goal.met { "x" } else { " " }, shown(&goal.description));
        }
        Ok(())
    }

    fn replay(&self, replayer: &mut Replayer<'_>, mut film: Option<Film>) -> anyhow::Result<()> {
        let is_filmed = film.is_some();
        let last = self.until.map_or(u64::MAX, |until| until.tick);
        let (began, mut filmed) = (Instant::now(), Ok(()));
        let replay = replay::verify(replayer, &mut |replayer| {
            filmed = film.as_mut().map_or(Ok(()), |film| film.see(replayer));
            if filmed.is_err() || replayer.world().tick() >= last {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        filmed?;
        let simulated_s = replay.ticks as f64 * replay::TICK_S;
        let wall_s = began.elapsed().as_secs_f64();
        println!(
            "{} ticks ({simulated_s:.1} s) with {} inputs replayed in {wall_s:.2} s, {:.0} times real time; {} of {} goals met",
            replay.ticks,
            replay.inputs,
            simulated_s / wall_s.max(1e-9),
            replay.goals.0,
            replay.goals.1
        );
        if let Some(film) = film {
            println!("{}", shown(film.finish()?));
        }
        for gap in &replay.gaps {
            println!("{}: replayed on from the next snapshot", shown(gap));
        }
        if let Some(difference) = &replay.difference {
            anyhow::bail!("{difference}");
        }
        match self.compared(&replay) {
            Ok(compared) => println!("{compared}"),
            // A picture of the last moment is what was wanted.
            Err(nothing) if is_filmed => println!("{nothing}"),
            Err(nothing) => return Err(nothing),
        }
        Ok(())
    }

    /// What was compared, where nothing differs; an error if nothing was.
    fn compared(&self, replay: &replay::Replay) -> anyhow::Result<String> {
        let (all, log) = (replay.ticks, self.log.display());
        let Some([first, last]) = replay.span else {
            let of = if self.at.is_some() { "from `--at` on, the log has no tick" } else { "the log has no tick" };
            anyhow::bail!("{log}: nothing was compared: {of}");
        };
        let ticks = if all == 1 { format!("tick {first}") } else { format!("all {all} ticks from {first} to {last}") };
        match replay.gaps.len() {
            0 => Ok(format!("no tick differs: compared {ticks}")),
            gaps => {
                let gaps = if gaps == 1 { "1 gap".to_owned() } else { format!("{gaps} gaps") };
                Ok(format!("no tick differs of those compared: {all} from {first} to {last}, with {gaps} between"))
            }
        }
    }
}

/// Opens a log, and says what it is and what is wrong with it.
pub fn open(path: &Path) -> anyhow::Result<Log> {
    let log = Log::open(path).map_err(bad_input)?;
    let SessionEntry { session, mission_file, seed, participant, branched, .. } = &log.session;
    let path = path.display();
    let participant = participant.as_ref().map_or_else(String::new, |label| format!(", participant {label}"));
    println!("{}", shown(format_args!("{path}: session {session}, mission {mission_file}, seed {seed}{participant}")));
    if let Some(branch) = branched {
        let at = SessionTime { tick: branch.tick };
        let (tick, from) = (branch.tick, &branch.session);
        println!("{}", shown(format_args!("{path} goes on from {at} (tick {tick}) of session {from}")));
    }
    for problem in log.problems() {
        println!("{}", shown(format_args!("{path}: {problem}")));
    }
    Ok(log)
}

/// A session that was played with other objects or another floor plan will hardly come out the same.
fn tell_what_changed(session: &SessionEntry, replayer: &Replayer<'_>) {
    let plan = replayer.plan();
    let parts = [
        ("catalogue of objects", &session.catalog, fingerprint(plan.catalog.classes())),
        ("floor plan", &session.layout, fingerprint(&*plan.layout)),
    ];
    for (part, recorded, now) in parts.iter().filter(|(_, recorded, now)| !recorded.is_empty() && *recorded != now) {
        println!(
            "the {part} is another one than it was played with ({recorded} then, {now} now): it may come out otherwise"
        );
    }
}
