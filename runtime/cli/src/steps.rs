//! `cohabit steps`: a recorded session step by step, and what comes of another step.

mod eyes;
mod text;

use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
    sync::Arc,
};

use cohabit_cdf::Catalog;
use cohabit_dialog::{Effort, Language};
use cohabit_engine::Replayer;
use cohabit_eval::steps::{Instead, RerunError, Step, Told, listed, rerun, steps};
use cohabit_tables::Played;
use serde_json::json;

use crate::{
    failure::{bad_input, check_folder_of, environment},
    rendering::Rendering,
    terminal::{shown, shown_json, shown_lines},
    world::WorldPacks,
};
use eyes::Eyes;

/// Tells a recorded session step by step: what was said, how else it could be understood and how likely that is, what was planned and
/// done, and what came of it. Any step may be another one, and the session goes on from there
#[derive(clap::Args)]
pub struct Steps {
    /// The session log
    log: PathBuf,
    /// Only this step, by its number
    #[arg(long, value_name = "NUMBER")]
    step: Option<usize>,
    /// Play on from that step with something else in its place: words, or a command as JSON, as `--json` prints it. Nobody has to be there:
    /// the robot's mind does what it would do then, and people say what they said
    #[arg(long, value_name = "WORDS|COMMAND", requires_all = ["step", "out"], conflicts_with = "frames")]
    instead: Option<String>,
    /// The log of that, which must not exist yet
    #[arg(long = "log", value_name = "FILE.mcap", requires = "instead")]
    out: Option<PathBuf>,
    /// Draw what the body saw before each step into this folder, and in black and white where that shows what it acts on
    #[arg(long, value_name = "FOLDER")]
    frames: Option<PathBuf>,
    /// The size of these pictures: pixels across and down
    #[arg(long, value_name = "WxH", value_parser = eyes::read_size, requires = "frames")]
    size: Option<[u32; 2]>,
    /// Print JSON: a line for each step; with --instead one document
    #[arg(long)]
    json: bool,
    /// How much work goes into what people say: `full`, or `fast`, without the language model; as the session was played, if that is noted
    #[arg(long, value_name = "EFFORT")]
    understanding: Option<Effort>,
    #[command(flatten)]
    packs: WorldPacks,
    #[command(flatten)]
    rendering: Rendering,
}

impl Steps {
    /// Prints the steps, or what comes of another one.
    pub fn run(&self) -> anyhow::Result<()> {
        let world = self.packs.read()?;
        let catalog = world.catalog();
        let played = open(&self.log, catalog)?;
        let language = self.language(&played, catalog);
        if let (Some(step), Some(instead), Some(out)) = (self.step, &self.instead, &self.out) {
            return self.change(&played, &language, step, instead, out);
        }
        let Told { steps, problem } = self.tell(&played, &language)?;
        for step in steps.iter().filter(|step| self.step.is_none_or(|number| number == step.step)) {
            if self.json {
                println!("{}", shown_json(serde_json::to_string(step)?));
            } else {
                print!("{}", shown_lines(text::block(step)));
            }
        }
        match problem {
            Some(problem) => anyhow::bail!("what was understood and seen from there on is not known: {problem}"),
            None => Ok(()),
        }
    }

    /// The robot's language, as it was in the session.
    fn language(&self, played: &Played, catalog: &Arc<Catalog>) -> Language {
        let noted = played.log().session.settings.get("understanding").and_then(|noted| noted.parse().ok());
        cohabit_dialog::language(Arc::clone(catalog), self.understanding.or(noted).unwrap_or_default())
    }

    /// Goes through a session, and draws what is asked for.
    fn tell(&self, played: &Played, language: &Language) -> anyhow::Result<Told> {
        let all = listed(played);
        if let Some(number) = self.step.filter(|number| !(1..=all.len()).contains(number)) {
            let (log, count) = (self.log.display(), all.len());
            return Err(bad_input(format!("{log}: `--step {number}`: the session has {count} steps")));
        }
        let mut replayer = replayer(played, language)?;
        let bodies: BTreeSet<u32> = all.iter().map(|step| step.body).collect();
        let eyes = self.frames.as_ref();
        let eyes = eyes.map(|folder| Eyes::open(folder, self.size, &bodies, &replayer, self.rendering.start()?));
        let mut eyes = eyes.transpose()?;
        steps(played, &mut replayer, language, &mut |replayer, step| match &mut eyes {
            Some(eyes) if self.step.is_none_or(|number| number == step.step) => eyes.look(replayer, step),
            _ => Ok(()),
        })
    }

    /// Plays on with something else in a step's place, and prints how both sessions go on.
    fn change(
        &self,
        played: &Played,
        language: &Language,
        step: usize,
        instead: &str,
        out: &Path,
    ) -> anyhow::Result<()> {
        if out.exists() {
            return Err(bad_input(format!("{}: exists already; choose another `--log`", out.display())));
        }
        check_folder_of(out)?;
        rerun(played, language, step, &Instead::read(instead), out).map_err(|error| match error {
            RerunError::Log(_) => environment(error),
            other => bad_input(format!("{}: {other}", self.log.display())),
        })?;
        let changed = open(out, language.catalog())?;
        let [before, after] = [behind(played, language, step)?, behind(&changed, language, step)?];
        let goals_met = [played, &changed].map(Played::goals_met);
        if self.json {
            let log = out.display().to_string();
            let told = json!({ "log": log, "step": step, "before": before, "after": after, "goals_met": goals_met });
            println!("{}", shown_json(told));
            return Ok(());
        }
        print!("{}", shown_lines(text::difference(&before, &after)));
        let [met, met_now] = goals_met;
        println!("{met} goals met before, {met_now} now; the session is in {}", shown(out.display()));
        Ok(())
    }
}

fn open(log: &Path, catalog: &Catalog) -> anyhow::Result<Played> {
    let played = Played::open(log, catalog).map_err(bad_input)?;
    for problem in played.log().problems() {
        eprintln!("cohabit: {}", shown(format_args!("{}: {problem}", log.display())));
    }
    Ok(played)
}

fn replayer<'a>(played: &'a Played, language: &Language) -> anyhow::Result<Replayer<'a>> {
    Replayer::new(played.log(), Arc::clone(language.catalog())).map_err(bad_input)
}

/// The steps of a session from one of them on.
fn behind(played: &Played, language: &Language, step: usize) -> anyhow::Result<Vec<Step>> {
    let mut replayer = replayer(played, language)?;
    let Told { steps, .. } = steps(played, &mut replayer, language, &mut |_, _| anyhow::Ok(()))?;
    Ok(steps.into_iter().skip_while(|one| one.step < step).collect())
}
