//! `cohabit study report`: the methods sheet of a study.

use std::{fs, path::PathBuf};

use cohabit_record::{Log, entry::fingerprint};
use cohabit_study::{Apparatus, Records, all_tables, is_practice, report};
use cohabit_tables::{Played, tables};

use super::{data, kept, refused, world_of};
use crate::{
    failure::bad_input,
    movement::with_movement,
    terminal::{shown, shown_lines},
};

#[derive(clap::Args)]
pub struct Report {
    /// The folder that was given to `cohabit study run` or `cohabit study simulate`
    #[arg(long, value_name = "DATA")]
    pub(super) folder: PathBuf,
    /// The file to write it into; it is printed, if absent
    #[arg(long, value_name = "FILE")]
    pub(super) out: Option<PathBuf>,
}

impl Report {
    /// Writes it.
    pub fn run(&self) -> anyhow::Result<()> {
        let (file, study) = kept(&self.folder)?;
        let world = world_of(&study, file.folder())?;
        let records = Records::read(study, &self.folder).map_err(refused)?;
        let catalog = world.catalog();
        let (mut apparatus, mut played) = (Apparatus::default(), Vec::new());
        for path in data::logs(&self.folder, &records.progress, true)? {
            let log = Log::open(&path).map_err(bad_input)?;
            let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            note(&mut apparatus, &log);
            if is_practice(&records.progress, &name) {
                continue;
            }
            note_settings(&mut apparatus, &log);
            played.push(Played::new(&name, log, catalog).map_err(bad_input)?);
        }
        let played = with_movement(played, catalog);
        let text = report(&records, &apparatus, &all_tables(&records, tables(&played), false));
        let Some(out) = &self.out else {
            print!("{}", shown_lines(text));
            return Ok(());
        };
        fs::write(out, text).map_err(|error| bad_input(format!("{}: {error}", out.display())))?;
        println!("{}", shown(out.display()));
        Ok(())
    }
}

fn note(apparatus: &mut Apparatus, log: &Log) {
    let session = &log.session;
    let build = if session.build.is_empty() { String::new() } else { format!(" (build {})", session.build) };
    apparatus.programs.insert(format!("{}{build}", session.program));
    apparatus.catalogs.insert(session.catalog.clone());
    apparatus.missions.entry(session.mission_file.clone()).or_default().insert(fingerprint(&session.mission_text));
}

fn note_settings(apparatus: &mut Apparatus, log: &Log) {
    for (name, value) in &log.session.settings {
        apparatus.settings.entry(name.clone()).or_default().insert(value.clone());
    }
}
