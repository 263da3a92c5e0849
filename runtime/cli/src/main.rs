//! `cohabit`: people and robots together in a simulated office.

// In all modules of this program these take the place of those of the standard library, which end the program where nobody reads
// any more: as in `cohabit play | tee file`, whose Ctrl-C ends `tee` before the session has ended.

/// Prints a line.
macro_rules! println {
    ($($text:tt)*) => { $crate::terminal::say(format_args!("{}\n", format_args!($($text)*))) };
}

/// Prints a text.
macro_rules! print {
    ($($text:tt)*) => { $crate::terminal::say(format_args!($($text)*)) };
}

/// Prints a line on standard error.
macro_rules! eprintln {
    ($($text:tt)*) => { $crate::terminal::warn(format_args!("{}\n", format_args!($($text)*))) };
}

mod annotate;
mod arena;
mod benchmark;
mod branch;
mod build;
mod capacity;
mod catalog;
mod check;
mod completions;
mod convert;
mod demonstrate;
mod doctor;
mod edit;
mod eval;
mod export;
mod failure;
mod gallery;
mod generate;
mod generate_world;
mod guide;
mod host;
mod import_house;
mod import_model;
mod man;
mod minds;
mod mission_file;
mod movement;
mod new;
mod pack_folder;
mod page_language;
mod pddl;
mod pedestrians;
mod peers;
mod play;
mod png_file;
mod readable_logs;
mod rendering;
mod replay;
mod rerun;
mod scratch;
mod self_test;
mod session_time;
mod sessions;
mod site;
mod splits;
mod steps;
mod stop;
mod study;
mod summing;
mod supervisor;
mod terminal;
mod time;
mod tls;
mod top;
mod vision;
mod voice;
mod wizard;
mod world;

use std::{ffi::OsString, io::IsTerminal as _, process::ExitCode};

use clap::{Parser, Subcommand};
use rustix::fs::Mode;
use tracing_subscriber::{EnvFilter, field::MakeExt as _, fmt::format::debug_fn};

use crate::terminal::shown;

/// People and robots together in a simulated office: start a session, watch it, talk to the robot.
#[derive(Parser)]
#[command(version, arg_required_else_help = true)]
struct Cohabit {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Play a mission: starts all that a session needs, and prints the address of its page
    Play(Box<play::Play>),
    /// Say what is wrong in mission files, and where
    Check(check::Check),
    /// Make a floor plan of a world pack, or a mission, in a page, by mouse or by keyboard
    Edit(Box<edit::Edit>),
    /// List what missions and world packs may name: classes, devices, rooms, goals, floor plans, conditions and changes
    Catalog(catalog::List),
    /// Write files to begin with: a world pack
    New(new::New),
    /// Re-simulate a recorded session and compare it tick by tick
    Replay(replay::Replay),
    /// Tell a recorded session step by step, and what comes of it if one of them is another
    Steps(Box<steps::Steps>),
    /// Lay two recorded sessions beside each other in rerun
    Compare(rerun::Compare),
    /// Write session logs as tables, or sum them up by condition
    Export(export::Export),
    /// Play many missions headless, by what is said in them, and report what came of them
    Eval(eval::Eval),
    /// Play fixed missions for a leaderboard, verify what others played, print a table of submissions
    Benchmark(benchmark::Benchmark),
    /// Make missions from a specification, each with a plan that solves it
    Generate(generate::Generate),
    /// Make furnished floor plans of offices or homes at random, as a world pack
    GenerateWorld(generate_world::GenerateWorld),
    /// Make floor plans of houses of ProcTHOR, as a world pack
    ImportHouse(import_house::ImportHouse),
    /// Import an object from a glTF file into a world pack
    ImportModel(Box<import_model::ImportModel>),
    /// Have the expert play missions, and write a data set of what it does and what the robot sees
    Demonstrate(demonstrate::Demonstrate),
    /// Draw annotated views of the floor plans at random, and write them as a data set (COCO)
    Vision(vision::Vision),
    /// Write a data set of demonstrations in a format that others read
    Convert(convert::Convert),
    /// Have people annotate a data set of demonstrations on a page: instructions, questions and answers
    Annotate(annotate::Annotate),
    /// Host many sessions on this machine as its load allows, with one page of all; or measure how many it carries
    Host(Box<host::Host>),
    /// Write a mission as a planning problem (PDDL), or check a plan for it against the world
    Pddl(pddl::PddlFiles),
    /// Run a study: participants, conditions, consent, sessions, data
    Study(study::Study),
    /// Show the guide in the browser or in the terminal, without a network
    Guide(guide::Guide),
    /// Print a script by which a shell completes commands and options
    Completions(completions::Completions),
    /// Write a manual page of each command into a folder
    Man(man::Man),
    /// Say what this machine lacks for a session, and what that costs
    Doctor(doctor::Doctor),
    /// Play a mission on this machine from end to end, and say line by line what works and what is missing
    SelfTest(self_test::SelfTest),
    /// Show a running session live: its ticks, how long their stages take, and its peers
    Top(top::Top),
    /// Have the world of a running session stand still, go on, step, or go faster
    Time(time::Time),
    /// Have this machine hear and speak
    Voice(voice::Voice),
    /// Draw all objects in all their states, all floor plans and all rooms
    Gallery(gallery::Gallery),
    /// The world of a session, its cameras and its clock; or, with --arena-port, a simulator for existing clients
    Sim(peers::Sim),
    /// One robot's mind
    Agent(peers::Agent),
    /// Lets another program, such as a client of a language model, control a body of a running session
    Bridge(peers::Bridge),
    /// The page, and the understanding of what people say
    Dialog(peers::Dialog),
    /// The session log
    Record(peers::Record),
}

impl Command {
    /// Has the files of a session, its log among them, readable by this user alone.
    fn keep_files_private(&self) {
        match self {
            Self::Play(_)
            | Self::Host(_)
            | Self::Sim(_)
            | Self::Agent(_)
            | Self::Bridge(_)
            | Self::Dialog(_)
            | Self::Record(_)
            | Self::Steps(_)
            | Self::Study(_)
            | Self::SelfTest(_) => {
                rustix::process::umask(Mode::RWXG | Mode::RWXO);
            }
            Self::Check(_)
            | Self::Edit(_)
            | Self::Catalog(_)
            | Self::New(_)
            | Self::Replay(_)
            | Self::Compare(_)
            | Self::Export(_)
            | Self::Eval(_)
            | Self::Benchmark(_)
            | Self::Generate(_)
            | Self::GenerateWorld(_)
            | Self::ImportHouse(_)
            | Self::ImportModel(_)
            | Self::Demonstrate(_)
            | Self::Vision(_)
            | Self::Convert(_)
            | Self::Annotate(_)
            | Self::Pddl(_)
            | Self::Guide(_)
            | Self::Completions(_)
            | Self::Man(_)
            | Self::Doctor(_)
            | Self::Top(_)
            | Self::Time(_)
            | Self::Voice(_)
            | Self::Gallery(_) => {}
        }
    }
}

fn main() -> ExitCode {
    let fields = debug_fn(|out, field, value| match field.name() {
        "message" => write!(out, "{}", shown(format_args!("{value:?}"))),
        name => write!(out, "{name}={}", shown(format_args!("{value:?}"))),
    });
    tracing_subscriber::fmt()
        .with_env_filter(EnvFilter::try_from_env("COHABIT_LOG").unwrap_or_else(|_| EnvFilter::new("info")))
        .with_writer(std::io::stderr)
        .with_ansi(std::io::stderr().is_terminal())
        .with_target(false)
        .compact()
        .fmt_fields(fields.delimited(" "))
        .init();
    match run(Cohabit::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => failure::report(&error),
    }
}

fn run(asked: Cohabit) -> anyhow::Result<()> {
    asked.command.keep_files_private();
    match asked.command {
        Command::Play(play) => play.run(),
        Command::Check(check) => check.run(),
        Command::Edit(edit) => edit.run(),
        Command::Catalog(list) => list.run(),
        Command::New(new) => new.run(),
        Command::Replay(replay) => replay.run(),
        Command::Steps(steps) => steps.run(),
        Command::Compare(compare) => compare.run(),
        Command::Export(export) => export.run(),
        Command::Eval(eval) => eval.run(),
        Command::Benchmark(benchmark) => benchmark.run(),
        Command::Generate(generate) => generate.run(),
        Command::GenerateWorld(generate) => generate.run(),
        Command::ImportHouse(house) => house.run(),
        Command::ImportModel(model) => model.run(),
        Command::Demonstrate(demonstrate) => demonstrate.run(),
        Command::Vision(vision) => vision.run(),
        Command::Convert(convert) => convert.run(),
        Command::Annotate(annotate) => annotate.run(),
        Command::Host(host) => host.run(),
        Command::Pddl(pddl) => pddl.run(),
        Command::Study(study) => study.run(),
        Command::Guide(guide) => guide.run(),
        Command::Completions(completions) => completions.run(),
        Command::Man(man) => man.run(),
        Command::Doctor(doctor) => doctor.run(),
        Command::SelfTest(test) => test.run(),
        Command::Top(top) => top.run(),
        Command::Time(time) => time.run(),
        Command::Voice(voice) => voice.run(),
        Command::Gallery(gallery) => gallery.run(),
        Command::Sim(sim) => sim.run(),
        Command::Agent(agent) => agent.run(),
        Command::Bridge(bridge) => bridge.run(),
        Command::Dialog(dialog) => dialog.run(),
        Command::Record(record) => record.run(),
    }
}

/// Plays as the command line of `play` says that these arguments are of.
fn play(arguments: impl IntoIterator<Item = OsString>) -> anyhow::Result<()> {
    let line = ["cohabit", "play"].map(OsString::from).into_iter().chain(arguments);
    // What is wrong with them is said as clap says it.
    run(Cohabit::parse_from(line))
}
