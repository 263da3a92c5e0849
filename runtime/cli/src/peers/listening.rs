//! How people meet a session: where its page is served, what it shows, how the robots answer.

use std::net::IpAddr;

use cohabit_dialog::{
    Asking, Consulting, Drivable, Effort, Hidden, HostName, Knows, Manner, Politeness, Questionnaire, Verbosity,
};

use super::body_name::BodyName;
use crate::{failure::bad_input, page_language::PageLanguage, tls::Tls, voice::VoiceOptions, wizard::WizardOptions};

/// More people than fit into the office.
const MOST_SEATS: i64 = 8;

/// Where the page is served.
#[derive(clap::Args, Clone)]
pub struct Listening {
    /// The port of the page; 0 takes any that is free
    #[arg(long, default_value_t = 8765)]
    pub port: u16,
    /// The address the page listens on, such as 0.0.0.0 for other machines
    #[arg(long, default_value = "127.0.0.1")]
    pub listen: IpAddr,
    /// A name by which browsers may ask for the page besides those of this machine, such as that of a proxy, with its port
    /// if it is another one; as often as needed
    #[arg(long = "host", value_name = "NAME[:PORT]")]
    pub hosts: Vec<HostName>,
    /// The port of the server of the same host whose pages may show the page within them, such as that of a study
    #[arg(long, value_name = "PORT")]
    pub framed_by: Option<u16>,
    #[command(flatten)]
    pub tls: Tls,
    /// What the page leaves out: `figures` for developers, the `microphone`, or the `score`; as often as needed
    #[arg(long, value_name = "PART")]
    pub hide: Vec<Hidden>,
    #[command(flatten)]
    pub language: PageLanguage,
    /// Whom people may drive from the page: the avatars of `people`, `all` bodies, which robots' minds then hand over for
    /// so long, or `none`
    #[arg(long, default_value_t)]
    pub drive: Drivable,
    /// Give so many people a page of their own. The address of each page is printed. The first page drives the first avatar and no
    /// other, the second page the second, and so on; name an avatar for each by `--body person`
    #[arg(long, value_name = "COUNT", default_value_t = 0, value_parser = clap::value_parser!(u8).range(0..=MOST_SEATS))]
    pub seats: u8,
    /// What the robot may know: `everything` there is, or what it has `seen` so far, beside the floor plan
    #[arg(long, default_value_t)]
    pub knows: Knows,
    /// What a body is called, such as `0=Rosie`, by those who speak to it and on the page; as often as needed
    #[arg(long = "name", value_name = "BODY=NAME")]
    pub names: Vec<BodyName>,
    /// When the robot asks: `never`, when it is `unsure`, or `always`, and before it does anything
    #[arg(long, value_name = "WHEN", default_value_t)]
    pub ask: Asking,
    /// How the robot words what it says: `plain`, or `polite`, which agrees with pleasure and is sorry when it refuses
    #[arg(long, value_name = "MANNER", default_value_t)]
    pub politeness: Politeness,
    /// How much the robot says of what it is about to do: `full`, or `brief`, which is no more than that it does it
    #[arg(long, value_name = "HOW-MUCH", default_value_t)]
    pub verbosity: Verbosity,
    /// How much work goes into what people say: `full`, with a small language model that rewrites it in plain requests, some
    /// tenths of a second each time, or `fast`, without
    #[arg(long, value_name = "EFFORT", default_value_t)]
    pub understanding: Effort,
    /// When the language model that COHABIT_MODEL_URL and COHABIT_MODEL name is asked what people mean: `never`, where the
    /// robot is `unsure`, or `always`
    #[arg(long, value_name = "WHEN", default_value_t)]
    pub model: Consulting,
    /// What people are asked on the page, before they play or after: `sus` (System Usability Scale), `tlx` (NASA Task Load
    /// Index), `tlx_weighted`, `rosas`, `trust`, `ueq_s`, `pssuq`, or a file (TOML); as often as needed
    #[arg(long = "questionnaire", value_name = "NAME|FILE")]
    pub questionnaires: Vec<String>,
    #[command(flatten)]
    pub wizard: WizardOptions,
    #[command(flatten)]
    pub voice: VoiceOptions,
}

impl Listening {
    /// How the robot words what it says.
    pub const fn manner(&self) -> Manner {
        Manner { politeness: self.politeness, verbosity: self.verbosity }
    }

    /// What people are asked.
    pub fn questionnaires(&self) -> anyhow::Result<Vec<Questionnaire>> {
        let found: Vec<_> = self
            .questionnaires
            .iter()
            .map(|name| Questionnaire::find(name))
            .collect::<Result<_, _>>()
            .map_err(bad_input)?;
        let twice = found.iter().enumerate().find(|(at, one)| found[..*at].iter().any(|other| other.name == one.name));
        match twice {
            Some((_, one)) => Err(bad_input(format!(
                "`--questionnaire`: two are called `{}` (a file's name, without its ending, is that of its questionnaire)",
                one.name
            ))),
            None => Ok(found),
        }
    }
}
