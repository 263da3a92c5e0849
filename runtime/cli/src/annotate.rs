//! `cohabit annotate`: people write instructions, questions and answers for a data set of demonstrations.

use std::{
    path::PathBuf,
    sync::atomic::Ordering,
    time::{SystemTime, UNIX_EPOCH},
};

use anyhow::Context as _;
use clap::ValueEnum;
use cohabit_annotate::{
    AnnotateError, AnnotateService, Cut, Desk, Settings, agreement, agreement_path, export, links_path, pseudonyms,
};
use cohabit_dialog::token;

use crate::{
    failure::{bad_input, environment},
    site::SiteOptions,
    stop,
    terminal::shown,
};

/// How many annotate a data set for which nobody is named: as many as write each instruction.
const ANNOTATORS: usize = 3;

/// Serves a page for each annotator of a data set of `demonstrate`: they watch segments, write the instruction for each, ask about it, and
/// answer the questions of others. The same command goes on with what is there
#[derive(clap::Args)]
pub struct Annotate {
    /// The folder of a finished data set, with pictures in colour
    dataset: PathBuf,
    /// The port of the pages; 0 takes any that is free
    #[arg(long, default_value_t = 8790)]
    port: u16,
    #[command(flatten)]
    site: SiteOptions,
    /// How many annotate it: A01, A02 and so on, besides those who have a link already; 3 where nobody has one
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=999))]
    annotators: Option<u16>,
    /// Who annotates it, by pseudonyms with commas between, besides those who have a link already
    #[arg(long, value_name = "LIST", value_delimiter = ',', conflicts_with = "annotators")]
    names: Vec<String>,
    /// How many people write an instruction for each segment, ask about it, and answer each question
    #[arg(long, value_name = "K", default_value_t = 3, value_parser = clap::value_parser!(u16).range(1..=999))]
    per_segment: u16,
    /// What people watch in one go
    #[arg(long, value_name = "goals|episodes", default_value = "goals", hide_possible_values = true)]
    watch: Watched,
    /// After so many minutes without a sign of who has taken a task, it goes to somebody else
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u16).range(2..))]
    kept_minutes: u16,
    /// Instead, print how alike the annotations are, and write it by segment into `annotations/agreement.csv`
    #[arg(long, conflicts_with_all = ["port", "annotators", "names"])]
    agreement: bool,
    /// Instead, write the annotations into the episodes of the data set
    #[arg(long, conflicts_with_all = ["port", "annotators", "names"])]
    export: bool,
}

/// What people watch in one go.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Watched {
    /// From one goal that is met to the next.
    Goals,
    /// A whole episode.
    Episodes,
}

impl Annotate {
    /// Serves the pages, or sums up what came of them.
    pub fn run(&self) -> anyhow::Result<()> {
        if self.export {
            self.export()?;
        }
        if self.agreement {
            self.measure()?;
        }
        if self.export || self.agreement { Ok(()) } else { self.serve() }
    }

    fn export(&self) -> anyhow::Result<()> {
        let exported = export(&self.dataset).map_err(refused)?;
        println!(
            "{} instructions, {} questions and {} answers in {} episodes: {}",
            exported.instructions,
            exported.questions,
            exported.answers,
            exported.episodes,
            shown(self.dataset.display())
        );
        if exported.left_out > 0 {
            println!("{} texts are left out: they are about steps that this data set does not have", exported.left_out);
        }
        Ok(())
    }

    fn measure(&self) -> anyhow::Result<()> {
        let kinds = agreement::measure(&self.dataset).map_err(refused)?;
        print!("{}", agreement::lines(&kinds));
        println!("{}", shown(agreement_path(&self.dataset).display()));
        Ok(())
    }

    fn serve(&self) -> anyhow::Result<()> {
        let stop = stop::on_request()?;
        let identity = self.site.identity()?;
        let desk = self.desk()?;
        let segments = desk.segments();
        let (listener, listening) = self.site.listen("the pages of annotators", self.port, identity.as_ref())?;
        let service = AnnotateService::new(desk);
        let site = token::site_address(listening, identity.is_some());
        println!("{segments} segments of {} are to be annotated", shown(self.dataset.display()));
        for (name, path) in service.doors() {
            println!("{name}: {site}{path}");
        }
        println!("Ctrl-C ends it, and the same command goes on with it");
        let served = service.serve(listener, self.site.hosts.clone(), identity, &|| stop.load(Ordering::Relaxed));
        served.context("serve the pages of annotators")
    }

    fn desk(&self) -> anyhow::Result<Desk> {
        let names = match self.annotators {
            Some(count) => pseudonyms(usize::from(count)),
            None if self.names.is_empty() && !links_path(&self.dataset).exists() => pseudonyms(ANNOTATORS),
            None => self.names.clone(),
        };
        let cut = match self.watch {
            Watched::Goals => Cut::Goals,
            Watched::Episodes => Cut::Episodes,
        };
        let kept_ms = u64::from(self.kept_minutes) * 60 * 1000;
        let settings = Settings { per_segment: usize::from(self.per_segment), kept_ms };
        let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let now_ms = u64::try_from(since.as_millis())?;
        Desk::open(&self.dataset, &names, cut, settings, now_ms).map_err(refused)
    }
}

/// Of what class an error is.
fn refused(error: AnnotateError) -> anyhow::Error {
    if error.is_bad_input() { bad_input(error) } else { environment(error) }
}
