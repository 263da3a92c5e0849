//! What this program knows of the settings and missions that a study names.

use std::{cell::OnceCell, ffi::OsString, path::Path, sync::Arc};

use clap::{Parser, error::ErrorKind};
use cohabit_cdf::{PackFile, WorldData};
use cohabit_engine::SessionPlan;
use cohabit_study::Program;

use crate::{mission_file::MissionFile, play::Play};

/// This program.
#[derive(Default)]
pub struct ThisProgram {
    /// The world that is built in, once it was needed.
    builtin: OnceCell<WorldData>,
}

/// The command line of `play`, by itself.
#[derive(Parser)]
#[command(no_binary_name = true)]
struct PlayLine {
    #[command(flatten)]
    play: Play,
}

impl Program for ThisProgram {
    fn check_arguments(&self, arguments: &[String]) -> Result<(), String> {
        match PlayLine::try_parse_from(arguments.iter().map(OsString::from)) {
            Ok(_) => Ok(()),
            Err(error) if matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) => {
                Err("this is no setting of a session".to_owned())
            }
            Err(error) => Err(said(&error.to_string())),
        }
    }

    fn check_mission(&self, name: &str, world: Option<&WorldData>) -> Result<(), String> {
        let world = self.world(world);
        let file = MissionFile::find_in(Some(name), world).map_err(|error| format!("{error:#}"))?;
        let catalog = Arc::clone(world.catalog());
        let plan = SessionPlan::new(&file.name, &file.text, catalog, 0).map_err(|error| error.to_string())?;
        plan.build().map(drop).map_err(|error| error.to_string())
    }

    fn check_session(
        &self,
        arguments: &[String],
        mission: &str,
        folder: &Path,
        world: Option<&WorldData>,
    ) -> Result<(), String> {
        let line = PlayLine::try_parse_from(arguments.iter().map(OsString::from));
        let PlayLine { play } = line.map_err(|error| said(&error.to_string()))?;
        let world = self.world(world);
        let Ok(file) = MissionFile::find_in(Some(mission), world) else { return Ok(()) };
        let plan = SessionPlan::new(&file.name, &file.text, Arc::clone(world.catalog()), 0);
        plan.map_or(Ok(()), |plan| play.check_for(plan, folder).map_err(|error| format!("{error:#}")))
    }

    fn pack_files(&self, folder: &Path) -> Result<Vec<PackFile>, String> {
        cohabit_engine::world_folder_files(folder).map_err(|error| format!("{error:#}"))
    }
}

impl ThisProgram {
    /// That of the study's packs, or the one that is built in.
    fn world<'a>(&'a self, world: Option<&'a WorldData>) -> &'a WorldData {
        world.unwrap_or_else(|| self.builtin.get_or_init(WorldData::builtin))
    }
}

/// What clap says of an argument, in one line, without how the program is used.
fn said(text: &str) -> String {
    let text = text.trim_start_matches("error: ");
    let lines =
        text.lines().map(str::trim).take_while(|line| !line.starts_with("Usage:") && !line.starts_with("For more"));
    // A tip about dashes on the command line leads astray in a file.
    lines.filter(|line| !line.is_empty() && !line.starts_with("tip: to pass")).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_those_of_play() {
        let check = |arguments: &[&str]| {
            let arguments: Vec<String> = arguments.iter().map(|one| (*one).to_owned()).collect();
            ThisProgram::default().check_arguments(&arguments)
        };
        assert_eq!(check(&["--ask=never", "--understanding=fast", "--body=person@Lab1", "--lock-step"]), Ok(()));
        let seat = ["--wizard=yes", "--response_delay_ms=1500", "--wizard-timeout-s=8.5", "--wizard-on-timeout=say"];
        let phrases = ["--wizard-phrase=h=Hello!", "--wizard-phrase=m:wait=Hm."];
        assert_eq!(check(&[&seat[..], &phrases].concat()), Ok(()));
        for (arguments, part) in [
            (&["--ask=sometimes"][..], "sometimes"),
            (&["--hat"], "unexpected argument '--hat'"),
            (&["--wizard=perhaps"], "invalid value 'perhaps'"),
            (&["--wizard-on-timeout=say"], "--wizard-timeout-s"),
            (&["--wizard-timeout-s=0"], "a number of seconds above 0"),
            (&["--wizard-phrase=Hello!"], "is no phrase"),
            (&["--help"], "no setting"),
            (&["--lock-step", "--speed=2"], "cannot be used with"),
        ] {
            let said = check(arguments).expect_err("a wrong argument");
            assert!(said.contains(part) && !said.contains('\n') && !said.contains("Usage"), "{said}");
            assert!(!said.contains("tip: to pass"), "{said}");
        }
    }

    #[test]
    fn sessions_are_those_whose_bodies_and_agents_a_mission_has() {
        let check = |arguments: &[&str], mission: &str| {
            let arguments: Vec<String> = arguments.iter().map(|one| (*one).to_owned()).collect();
            ThisProgram::default().check_session(&arguments, mission, Path::new("/nowhere"), None)
        };
        assert_eq!(check(&["--agent=dialog", "--agent=helper@1", "--body=robot@Lab1"], "cold_soda"), Ok(()));
        assert_eq!(check(&["--agent=helper@1"], "warm_soda"), Ok(()), "what is wrong with it is said of the mission");
        for (arguments, part) in [
            (&["--agent=dialog", "--agent=helper@1"][..], "`--agent helper@1`: there is no body 1"),
            (&["--body=robot", "--agent=dialog", "--agent=scripted@1=walk.txt"], "/nowhere/walk.txt"),
            (&["--name=2=Rosie"], "there is no body 2"),
        ] {
            let said = check(arguments, "cold_soda").expect_err("what the mission does not have");
            assert!(said.contains(part), "{said}");
        }
    }

    #[test]
    fn missions_are_those_that_can_be_played() {
        let program = ThisProgram::default();
        assert_eq!(program.check_mission("cold_soda", None), Ok(()));
        let said = program.check_mission("warm_soda", None).expect_err("no mission");
        assert!(said.contains("there are"), "{said}");
    }
}
