//! Kinds of minds, and how one is asked for.

use std::{
    collections::BTreeMap,
    ffi::OsString,
    fmt, fs,
    path::Path,
    str::FromStr,
    sync::{Arc, atomic::AtomicBool},
};

use clap::ValueEnum;
use cohabit_agent::{Agent, Expert, Helper, PlanFollower, Random, Script, Scripted, wait_for_mission};
use cohabit_bus::Transport;
use cohabit_cdf::{BodyId, BodyKind, Catalog};
use cohabit_engine::SessionPlan;

use crate::{
    failure::bad_input,
    pedestrians::{fault, read_schedule},
};

/// Kinds of minds.
#[derive(Clone, Copy, Debug, Eq, PartialEq, ValueEnum)]
pub enum MindKind {
    /// Does what the dialog service plans
    Dialog,
    /// Acts at random, the same for the same seed
    Random,
    /// Does what a script says, line by line
    Scripted,
    /// Keeps the office in order, by what its own camera shows
    Helper,
    /// Plays the mission to its goals with a planner; it knows what the simulator knows
    Expert,
    /// Has people walk about by a schedule: all bodies that its file names, in one process
    Pedestrian,
}

impl MindKind {
    fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }

    /// A mind of this kind for a body; what is random in it follows from `seed`. None, if it has to know the mission first:
    /// [`expert`] makes it once the session is joined, or [`crowd`](crate::pedestrians::crowd) makes several.
    pub fn mind(
        self,
        catalog: &Arc<Catalog>,
        body: u32,
        seed: u64,
        script: Option<&Path>,
    ) -> anyhow::Result<Option<Box<dyn Agent>>> {
        // Two at random in one world do not do the same.
        let seed = seed.wrapping_add(u64::from(body));
        Ok(match self {
            Self::Dialog => Some(Box::new(PlanFollower::new(body))),
            Self::Random => Some(Box::new(Random::with_catalog(Arc::clone(catalog), seed))),
            Self::Helper => Some(Box::new(Helper::with_catalog(Arc::clone(catalog), body, seed))),
            Self::Scripted => {
                Some(Box::new(Scripted::with_catalog(Arc::clone(catalog), body, read_script(script, catalog)?)))
            }
            Self::Expert | Self::Pedestrian => None,
        })
    }
}

/// The mind that plays the mission of the session on `bus` to its goals; `None` if `stop` comes before the mission is known.
pub fn expert(
    catalog: &Arc<Catalog>,
    body: u32,
    bus: &dyn Transport,
    stop: &AtomicBool,
) -> anyhow::Result<Option<Box<dyn Agent>>> {
    let Some(mission) = wait_for_mission(bus, stop)? else { return Ok(None) };
    let (file, seed) = (mission.header.file.as_str(), mission.header.seed);
    let plan = SessionPlan::new(file, &mission.text, Arc::clone(catalog), seed)?;
    let plan = plan.with_bodies(mission.bodies);
    let world = plan.build()?;
    if body as usize >= world.bodies().len() {
        let last = world.bodies().len() - 1;
        return Err(bad_input(format!("there is no body {body}: the session has bodies 0 to {last}")));
    }
    Ok(Some(Box::new(Expert::new(body, Arc::clone(&plan.mission), world.symbols(BodyId(body))))))
}

fn read_script(file: Option<&Path>, catalog: &Catalog) -> anyhow::Result<Script> {
    let file = file.ok_or_else(|| bad_input("a scripted agent needs a script: `--script FILE`, or in play `=FILE`"))?;
    let name = file.display();
    let text = fs::read_to_string(file).map_err(|error| bad_input(format!("{name}: {error}")))?;
    Script::parse(&name.to_string(), &text, catalog).map_err(bad_input)
}

/// A mind that a session starts with: its kind, perhaps its body, perhaps its script, such as `scripted@1=walk.txt`. Pedestrians
/// are several at once, whose schedule says which: `pedestrian=office.toml`.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct MindRequest {
    kind: MindKind,
    body: u32,
    script: Option<String>,
}

impl FromStr for MindRequest {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (who, script) = text.split_once('=').map_or((text, None), |(who, file)| (who, Some(file.to_owned())));
        let (kind, body) = who.split_once('@').unwrap_or((who, "0"));
        let kinds = || MindKind::value_variants().iter().map(|kind| kind.name()).collect::<Vec<_>>().join(", ");
        let kind = MindKind::from_str(kind, false).map_err(|_| format!("there is no agent `{kind}`: {}", kinds()))?;
        let body = body
            .parse()
            .map_err(|_| format!("`{body}` is no body: bodies count from 0, such as `{kind}@1`", kind = kind.name()))?;
        match (kind, &script) {
            (MindKind::Pedestrian, Some(_)) if !who.contains('@') => Ok(Self { kind, body, script }),
            (MindKind::Pedestrian, _) => {
                Err("pedestrians need a schedule, which names their bodies: `pedestrian=FILE`".to_owned())
            }
            (MindKind::Scripted, None) => Err(format!("a scripted agent needs a script: `scripted@{body}=FILE`")),
            (MindKind::Scripted, Some(_)) | (_, None) => Ok(Self { kind, body, script }),
            (_, Some(_)) => Err(format!("only a scripted agent takes a script: write `{}@{body}`", kind.name())),
        }
    }
}

impl fmt::Display for MindRequest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.kind.name())?;
        if self.kind != MindKind::Pedestrian {
            write!(f, "@{}", self.body)?;
        }
        self.script.as_ref().map_or(Ok(()), |file| write!(f, "={file}"))
    }
}

impl MindRequest {
    /// The arguments of the process that is such a mind.
    pub fn arguments(&self, seed: u64) -> Vec<OsString> {
        let body = self.body.to_string();
        let mut arguments = vec![self.kind.name(), "--body".to_owned(), body, "--seed".to_owned(), seed.to_string()];
        arguments.extend(self.script.iter().flat_map(|file| ["--script".to_owned(), file.clone()]));
        arguments.into_iter().map(OsString::from).collect()
    }

    /// The same with its file in that folder.
    pub fn in_folder(&self, folder: &Path) -> Self {
        let place = |file: &String| folder.join(file).to_string_lossy().into_owned();
        Self { script: self.script.as_ref().map(place), ..self.clone() }
    }

    /// Whether it is the expert in this body.
    pub fn is_expert(&self, body: u32) -> bool {
        self.kind == MindKind::Expert && self.body == body
    }

    /// The body of one that does what people ask of it.
    pub fn spoken_to(&self) -> Option<u32> {
        (self.kind == MindKind::Dialog).then_some(self.body)
    }

    /// The body of one that does what it does whatever people ask of it. To pedestrians nobody speaks.
    pub fn on_its_own(&self) -> Option<u32> {
        (!matches!(self.kind, MindKind::Dialog | MindKind::Pedestrian)).then_some(self.body)
    }

    /// Says what is wrong with these minds for a session, before anything of it is started.
    pub fn check(requests: &[Self], plan: &SessionPlan) -> anyhow::Result<()> {
        let robots = std::iter::repeat_n(BodyKind::Robot, plan.mission.robots.len().max(1));
        let kinds: Vec<BodyKind> = robots.chain(plan.bodies.iter().map(|body| body.kind)).collect();
        let mut taken = BTreeMap::<u32, &Self>::new();
        for request in requests {
            for body in request.bodies(&kinds, plan)? {
                if body as usize >= kinds.len() {
                    let last = kinds.len() - 1;
                    let remedy = format!("the session has bodies 0 to {last}; `--body robot` adds one");
                    return Err(bad_input(format!("`--agent {request}`: there is no body {body}: {remedy}")));
                }
                if let Some(other) = taken.insert(body, request) {
                    let remedy = format!("give one of them another body, such as `@{}`", body + 1);
                    return Err(bad_input(format!("`--agent {request}`: body {body} is that of `{other}`: {remedy}")));
                }
            }
            if request.kind == MindKind::Scripted {
                read_script(request.script.as_deref().map(Path::new), &plan.catalog)?;
            }
        }
        Ok(())
    }

    /// The bodies that it commands in a session of bodies of these kinds.
    fn bodies(&self, kinds: &[BodyKind], plan: &SessionPlan) -> anyhow::Result<Vec<u32>> {
        if self.kind != MindKind::Pedestrian {
            return Ok(vec![self.body]);
        }
        let schedule = read_schedule(self.script.as_deref().map(Path::new), &plan.catalog)?;
        match fault(&schedule, kinds, &plan.layout) {
            Some(fault) => Err(bad_input(format!("`--agent {self}`: {fault}"))),
            None => Ok(schedule.people().collect()),
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::sync::Arc;

    use cohabit_cdf::mission;

    use super::*;

    #[test]
    fn requests_read_as_they_print() {
        for (text, whole) in [
            ("dialog", "dialog@0"),
            ("helper@1", "helper@1"),
            ("expert", "expert@0"),
            ("random@0", "random@0"),
            ("scripted@2=a=b.txt", "scripted@2=a=b.txt"),
            ("pedestrian=office.toml", "pedestrian=office.toml"),
        ] {
            assert_eq!(text.parse::<MindRequest>().unwrap().to_string(), whole);
        }
        for (text, body) in
            [("dialog", None), ("expert", Some(0)), ("helper@1", Some(1)), ("pedestrian=office.toml", None)]
        {
            assert_eq!(text.parse::<MindRequest>().unwrap().on_its_own(), body, "{text}");
        }
        for (text, error) in [
            ("butler", "there is no agent `butler`: dialog, random, scripted, helper, expert, pedestrian"),
            ("helper@one", "`one` is no body"),
            ("scripted@1", "`scripted@1=FILE`"),
            ("helper@1=a.txt", "write `helper@1`"),
            ("pedestrian", "`pedestrian=FILE`"),
            ("pedestrian@1=office.toml", "`pedestrian=FILE`"),
        ] {
            let found = text.parse::<MindRequest>().unwrap_err();
            assert!(found.contains(error), "{found}");
        }
    }

    #[test]
    fn two_minds_at_one_body_and_minds_without_one_are_refused() {
        let (file, text) = mission::builtin()[0];
        let plan = SessionPlan::new(file, text, Arc::new(Catalog::builtin()), 1).unwrap();
        let plan = plan.with_bodies(vec!["robot".parse().unwrap()]);
        let check = |texts: &[&str]| {
            let requests: Vec<MindRequest> = texts.iter().map(|text| text.parse().unwrap()).collect();
            MindRequest::check(&requests, &plan).map_err(|error| error.to_string())
        };
        assert_eq!(check(&["dialog", "helper@1"]), Ok(()));
        let twice = check(&["dialog", "helper"]).unwrap_err();
        assert!(twice.contains("`--agent helper@0`") && twice.contains("`dialog@0`"), "{twice}");
        let absent = check(&["dialog@2"]).unwrap_err();
        assert!(absent.contains("bodies 0 to 1"), "{absent}");
        let unread = check(&["scripted@1=/nowhere.txt"]).unwrap_err();
        assert!(unread.contains("/nowhere.txt"), "{unread}");
        let unread = check(&["dialog", "pedestrian=/nowhere.toml"]).unwrap_err();
        assert!(unread.contains("/nowhere.toml"), "{unread}");
    }
}
