//! `cohabit doctor`: what this machine lacks, and what that costs.

mod devices;
mod finding;
mod machine;
mod memory;
mod processor;
mod speech;
mod system;

use std::{io, net::SocketAddr};

use cohabit_tables::{Align, columns};
use serde_json::{Value, json};

use crate::{peers::Listening, terminal::print};
use machine::Machine;

pub use finding::{Finding, State};
pub use memory::{ensure_room, shared_memory_fault};

/// A look at one thing that a session needs or is better with.
struct Check {
    name: &'static str,
    look: fn(&Machine) -> Finding,
}

/// All of them, in the order in which they are told.
const CHECKS: [Check; 18] = [
    Check { name: "shared memory", look: memory::shared_memory },
    Check { name: "sessions in it", look: memory::leftovers },
    Check { name: "sessions running", look: system::running },
    Check { name: "runtime folder", look: system::runtime_folder },
    Check { name: "session logs", look: system::log_folder },
    Check { name: "page's port", look: devices::port },
    Check { name: "browser", look: devices::browser },
    Check { name: "cores", look: processor::cores },
    Check { name: "priority", look: processor::urgency },
    Check { name: "vectors", look: processor::vectors },
    Check { name: "memory", look: memory::memory },
    Check { name: "GPU", look: devices::gpu },
    Check { name: "audio", look: devices::audio },
    Check { name: "voice", look: speech::voice },
    Check { name: "open files", look: system::open_files },
    Check { name: "locked memory", look: system::swap },
    Check { name: "clock", look: processor::clock },
    Check { name: "timers", look: processor::timers },
];

/// Says what this machine lacks for a session, what that costs, and what to do about it; fails if no session can run
#[derive(clap::Args)]
pub struct Doctor {
    /// Print one JSON document
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    listening: Listening,
    /// Print the GPU, and nothing else
    #[arg(long, hide = true)]
    print_gpu: bool,
}

impl Doctor {
    /// Looks at all and tells.
    pub fn run(&self) -> anyhow::Result<()> {
        if self.print_gpu {
            devices::print_gpu();
            return Ok(());
        }
        let mut findings = Vec::new();
        let page = SocketAddr::new(self.listening.listen, self.listening.port);
        look(page, &mut |name, finding| findings.push((name, finding)))?;
        print(&if self.json { json_text(&findings) } else { text(&findings) })?;
        let broken = count(&findings, State::Broken);
        anyhow::ensure!(broken == 0, "no session can run here");
        Ok(())
    }
}

fn json_text(findings: &[(&str, Finding)]) -> String {
    let checks: Vec<Value> = findings.iter().map(|(name, finding)| finding.value(name)).collect();
    let able = count(findings, State::Broken) == 0;
    format!("{:#}\n", json!({ "can_run_sessions": able, "checks": checks }))
}

/// Each finding, below it what it costs and what to do, and then the verdict.
fn text(findings: &[(&str, Finding)]) -> String {
    let mut lines = Vec::new();
    for (name, finding) in findings {
        let told = [&finding.costs, &finding.remedy].into_iter().filter(|line| !line.is_empty());
        lines.push(vec![finding.state.name().to_owned(), (*name).to_owned(), finding.found.clone()]);
        lines.extend(told.map(|line| vec![String::new(), String::new(), line.clone()]));
    }
    format!("{}\n{}\n", columns(&lines, Align::Left), verdict(findings))
}

/// Looks at all of this machine, where a page is to be served at `page`; tells each check's name and what it finds.
pub fn look(page: SocketAddr, tell: &mut dyn FnMut(&'static str, Finding)) -> io::Result<()> {
    let machine = Machine::this(page)?;
    for check in &CHECKS {
        tell(check.name, (check.look)(&machine));
    }
    Ok(())
}

fn count(findings: &[(&str, Finding)], state: State) -> usize {
    findings.iter().filter(|(_, finding)| finding.state == state).count()
}

fn verdict(findings: &[(&str, Finding)]) -> String {
    match (count(findings, State::Broken), count(findings, State::Costs)) {
        (0, 0) => "Sessions run here, and nothing is lacking".to_owned(),
        (0, 1) => "Sessions run here; 1 thing could be better".to_owned(),
        (0, costs) => format!("Sessions run here; {costs} things could be better"),
        (1, _) => "No session can run here until 1 thing is mended".to_owned(),
        (broken, _) => format!("No session can run here until {broken} things are mended"),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::{fs, path::PathBuf};

    use cohabit_speech::{Source, VoiceSettings};

    use super::*;

    /// A made-up machine in a folder, which goes when this is dropped.
    pub struct Fake {
        pub machine: Machine,
        folder: PathBuf,
    }

    impl Fake {
        pub fn new(name: &str) -> Self {
            let folder = std::env::temp_dir().join(format!("cohabit-doctor-{}-{name}", std::process::id()));
            let _ = fs::remove_dir_all(&folder);
            fs::create_dir_all(&folder).unwrap();
            let machine = Machine {
                root: folder.clone(),
                runtime_folder: folder.join("run/cohabit"),
                log_folder: folder.join("data/sessions"),
                path: folder.join("bin").into(),
                page: SocketAddr::from(([127, 0, 0, 1], 0)),
                program: folder.join("cohabit"),
                user: rustix::process::getuid().as_raw(),
                urgency: cohabit_bus::Urgency::ShortTurns,
                voice: Ok(VoiceSettings::installed(folder.join("voice"))),
            };
            Self { machine, folder }
        }
    }

    impl Drop for Fake {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.folder);
        }
    }

    #[test]
    fn a_bare_machine_is_told_what_it_lacks_and_never_panics() {
        let fake = Fake::new("bare");
        let findings: Vec<_> = CHECKS.iter().map(|check| (check.name, (check.look)(&fake.machine))).collect();
        let of = |name: &str| &findings.iter().find(|(check, _)| *check == name).unwrap().1;
        assert_eq!(of("shared memory").state, State::Broken);
        assert_eq!(of("browser").state, State::Costs);
        assert_eq!(of("GPU").state, State::Costs);
        assert_eq!(of("priority").state, State::Costs);
        assert_eq!(of("voice").state, State::Costs);
        assert!(of("voice").remedy.contains("cohabit voice install"));
        for (name, finding) in &findings {
            assert!(!finding.found.is_empty(), "{name}");
            assert_eq!(finding.state == State::Good, finding.costs.is_empty(), "{name}: {finding:?}");
        }
        assert!(verdict(&findings).starts_with("No session can run here until 1 thing is mended"));
    }

    #[test]
    fn the_remedy_for_voice_is_that_of_what_it_lacks() {
        let mut fake = Fake::new("server");
        let server = Source::Wyoming("127.0.0.1:9".to_owned());
        let settings = VoiceSettings::installed(fake.machine.root.join("voice"));
        fake.machine.voice = Ok(VoiceSettings { recognizer: server, synthesizer: Source::Off, ..settings });
        let remedy = speech::voice(&fake.machine).remedy;
        assert!(remedy.contains("see that the speech server runs") && !remedy.contains("install"), "{remedy}");
    }

    #[test]
    fn what_is_there_is_found() {
        let fake = Fake::new("there");
        let file = |path: &str, text: &str| {
            let path = fake.machine.at(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        };
        file("bin/firefox", "");
        file("dev/snd/pcmC0D0p", "");
        file("dev/snd/pcmC0D0c", "");
        file("dev/snd/controlC0", "");
        file("proc/meminfo", "MemTotal: 1000000 kB\nMemAvailable:   4096 kB\n");
        file("sys/devices/system/clocksource/clocksource0/current_clocksource", "hpet\n");
        file(&format!("dev/shm/cohabit_{}_gone_x", fake.machine.user + 1), "12345678");
        file(&format!("dev/shm/cohabit_{}_never-was_x", fake.machine.user), "12345678");
        assert!(devices::browser(&fake.machine).found.ends_with("firefox"));
        assert!(devices::audio(&fake.machine).found.starts_with("1 to record, 1 to play"));
        assert_eq!(memory::memory(&fake.machine).state, State::Costs);
        assert_eq!(processor::clock(&fake.machine).state, State::Costs);
        let left = memory::leftovers(&fake.machine);
        assert_eq!(left.state, State::Costs);
        assert!(left.found.starts_with("1 that were not ended"), "{}", left.found);
        assert!(left.found.contains("1 of other users"), "{}", left.found);
    }
}
