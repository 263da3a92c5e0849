//! Tables and summaries of sessions that are played here, against what those who played them counted.
#![allow(clippy::unwrap_used)]

use std::{convert::Infallible, fs, path::Path, sync::Arc};

use cohabit_cdf::{BodyKind, Catalog, PackId};
use cohabit_eval::{Settings, play, read_tasks};
use cohabit_language::{Asking, Language};
use cohabit_record::{Log, Movement, Stop, Trail};
use cohabit_tables::{Cell, NOTEBOOK, Played, Summary, Table, codebook, plain_text, plots, tables, write_csv};

const MISSIONS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../cdf/missions");
const FOLDER: &str = env!("CARGO_TARGET_TMPDIR");

/// The built-in missions by their scripts, of robots that ask like this, recorded in a folder of this name; and what was counted while they
/// were played.
fn sessions(folder: &str, asking: Asking) -> Vec<(Played, cohabit_eval::Played)> {
    let folder = Path::new(FOLDER).join(folder);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    let language = Language::new(Arc::new(Catalog::builtin()));
    let settings = Settings { asking, record: Some(folder), ..Settings::expert(1) };
    let tasks = read_tasks(Path::new(MISSIONS), None).unwrap();
    let played = tasks.iter().filter(|task| !task.id.contains("cereal")).map(|task| {
        let counted = play(task, &settings, &language).unwrap();
        let mut session = Played::open(counted.log.as_ref().unwrap(), language.catalog()).unwrap();
        session.name = format!("{}-{}", session.name, asking.name());
        (session, counted)
    });
    played.collect()
}

fn table<'a>(tables: &'a [Table], name: &str) -> &'a Table {
    tables.iter().find(|table| table.name == name).unwrap()
}

fn whole(cell: &Cell) -> i64 {
    match cell {
        Cell::Whole(number) => *number,
        other => panic!("{other:?} is no whole number"),
    }
}

#[test]
fn tables_hold_what_was_counted_while_sessions_were_played() {
    let (played, counted): (Vec<_>, Vec<_>) = sessions("export-counted", Asking::Always).into_iter().unzip();
    let tables = tables(&played);
    let sessions = table(&tables, "sessions");
    let column = |name: &str| sessions.column(name).map(whole).collect::<Vec<_>>();
    assert_eq!(column("questions"), counted.iter().map(|one| i64::from(one.questions)).collect::<Vec<_>>());
    assert!(column("questions").iter().all(|questions| *questions > 0), "a robot that always asks asks");
    assert_eq!(column("goals_met"), counted.iter().map(|one| one.goals_met as i64).collect::<Vec<_>>());
    assert_eq!(column("failed_actions"), counted.iter().map(|one| i64::from(one.failed_actions)).collect::<Vec<_>>());
    let success: Vec<_> = sessions.column("success").cloned().collect();
    assert_eq!(success, counted.iter().map(|one| Cell::Flag(one.success)).collect::<Vec<_>>());
    assert!(sessions.column("setting_ask").all(|cell| *cell == Cell::Text("always".to_owned())));
    assert!(sessions.column("branched_s").all(|cell| *cell == Cell::Nothing), "none goes on from another one");
    let fields: Vec<&str> = sessions.fields.iter().map(|field| &*field.name).collect();
    for name in NOTEBOOK.lines().find(|line| line.starts_with("outcomes = ")).unwrap().split('"').skip(1).step_by(2) {
        assert!(fields.contains(&name), "the script reads `{name}`, which no session has");
    }
    let turns = table(&tables, "turns");
    let asked: i64 = turns.column("question_count").map(whole).sum();
    assert_eq!(asked, column("questions").iter().sum::<i64>(), "each question belongs to a turn");
    let done: i64 = turns.column("actions").map(whole).sum();
    assert_eq!(done, column("actions").iter().sum::<i64>(), "and so does each action");
    assert_eq!(table(&tables, "actions").rows.len() as i64, done);
    assert_eq!(table(&tables, "goals").rows.len() as i64, column("goals").iter().sum::<i64>());
    let described = codebook(&tables);
    // By its codebook the script finds what was exported last, and which tables there are.
    let column = |name: &str| described.column(name).cloned().collect::<Vec<_>>();
    let tables_of = column("table");
    for name in tables.iter().map(|table| table.name).chain(["codebook"]) {
        assert!(tables_of.contains(&Cell::Text(name.to_owned())), "{name} is not in {tables_of:?}");
    }
    assert!(NOTEBOOK.contains("st_mtime_ns") && NOTEBOOK.contains(r#"set(fields["table"])"#));
    let columns: usize = tables.iter().map(|table| table.fields.len()).sum();
    assert_eq!(described.rows.len(), columns + tables.len() + 1, "and the codebook itself");
    for table in tables.iter().chain([&described]) {
        check_file(table);
    }
}

#[test]
fn actions_of_each_robot_that_is_spoken_to_are_counted() {
    let (one, counted) = sessions("export-robots", Asking::Never).remove(0);
    let mut log = Log::open(counted.log.as_ref().unwrap()).unwrap();
    // The same, had it been the second of two robots that was told all.
    log.session.settings.insert("robots".to_owned(), "0,1".to_owned());
    log.ticks.iter_mut().flat_map(|tick| &mut tick.inputs).for_each(|input| input.body = 1);
    log.dialog.iter_mut().for_each(|entry| entry.body = 1);
    let other = Played::new("other", log, &Catalog::builtin()).unwrap();
    let counts = |played: Played| {
        let all = tables(&[played]);
        let sum = |name: &str, column: &str| table(&all, name).column(column).map(whole).sum::<i64>();
        [("sessions", "actions"), ("sessions", "other_actions"), ("turns", "actions")]
            .map(|(name, column)| sum(name, column))
    };
    let alone = counts(one);
    assert!(alone[0] > 0 && alone[1] == 0 && alone[0] == alone[2], "{alone:?}");
    assert_eq!(counts(other), alone);
}

/// What is written as CSV is read back cell by cell.
fn check_file(table: &Table) {
    let path = write_csv(table, Path::new(FOLDER)).unwrap();
    let mut reader = csv::Reader::from_path(path).unwrap();
    let head: Vec<String> = reader.headers().unwrap().iter().map(str::to_owned).collect();
    assert_eq!(head, table.fields.iter().map(|field| field.name.to_string()).collect::<Vec<_>>());
    let mut rows = 0;
    for (record, row) in reader.records().zip(&table.rows) {
        rows += 1;
        for (text, cell) in record.unwrap().iter().zip(row) {
            let same = match cell {
                Cell::Nothing => text.is_empty(),
                Cell::Text(own) => plain_text(text) == own,
                Cell::Whole(own) => text.parse() == Ok(*own),
                Cell::Real(own) => text.parse() == Ok(*own),
                Cell::Flag(own) => text.parse() == Ok(*own),
            };
            assert!(same, "{text} was {cell:?}");
        }
    }
    assert_eq!(rows, table.rows.len());
}

#[test]
fn conditions_are_compared_and_fitted() {
    let never = sessions("export-never", Asking::Never);
    let always = sessions("export-always", Asking::Always);
    let mean = |all: &[(Played, cohabit_eval::Played)]| {
        all.iter().map(|(_, counted)| f64::from(counted.questions)).sum::<f64>() / all.len() as f64
    };
    let (less, more) = (mean(&never), mean(&always));
    let played: Vec<Played> = never.into_iter().chain(always).map(|(played, _)| played).collect();
    let summary = Summary::new(&played, &[]).unwrap();
    assert_eq!(summary.conditions, ["ask"], "the only setting in which they differ");
    let sizes: Vec<usize> = summary.groups.iter().map(|group| group.sessions).collect();
    assert_eq!(sizes, [6, 3, 3]);
    let questions = summary.fits.iter().find(|fit| fit.outcome == "questions").unwrap();
    let estimates: Vec<f64> = questions.terms.iter().map(|term| term.estimate).collect();
    // As many sessions of each: the first value is the reference.
    assert!((estimates[0] - more).abs() < 1e-9 && (estimates[1] - (less - more)).abs() < 1e-9, "{estimates:?}");
    let text = summary.to_string();
    for part in ["6 sessions", "ask always", "ask never", "least squares, each outcome on ask", "questions: 6 sessions"]
    {
        assert!(text.contains(part), "`{part}` is not in\n{text}");
    }
    let json = serde_json::to_value(&summary).unwrap();
    assert_eq!(json["groups"][1]["conditions"]["ask"], "always");
    assert_eq!(json["groups"][0]["measures"][0]["outcome"], "success");
    let plots = plots(&played, &[]).unwrap();
    let of = |file: &str| &plots.iter().find(|plot| plot.file == file).unwrap().svg;
    assert_eq!(of("plot_questions.svg").matches("<circle").count(), 6);
    assert!(of("plot_answered_ms.svg").contains("answered (ms)"), "the unit is that of the table's field");
    let unknown = Summary::new(&played, &["moon".to_owned()]).unwrap_err().to_string();
    assert!(unknown.contains("no session notes `moon`") && unknown.contains("ask, knows, mission"), "{unknown}");
}

#[test]
fn sessions_of_one_name_are_told_apart_by_the_folders_around_them() {
    let log = sessions("export-names", Asking::Never).remove(0).1.log.unwrap();
    let paths = ["never/logs", "unsure/logs"].map(|folder| {
        let folder = Path::new(FOLDER).join("export-names").join(folder);
        fs::create_dir_all(&folder).unwrap();
        let path = folder.join("cold_soda.mcap");
        fs::copy(&log, &path).unwrap();
        path
    });
    let catalog = Catalog::builtin();
    let names = |played: Vec<Played>| played.into_iter().map(|one| one.name).collect::<Vec<_>>();
    assert_eq!(names(Played::open_all(&paths, &catalog).unwrap()), ["never/logs/cold_soda", "unsure/logs/cold_soda"]);
    assert_eq!(names(Played::open_all(&paths[..1], &catalog).unwrap()), ["cold_soda"]);
}

#[test]
fn logs_that_cannot_be_read_keep_nobody_from_the_others() {
    let log = sessions("export-unread", Asking::Never).remove(0).1.log.unwrap();
    let folder = Path::new(FOLDER).join("export-unread");
    let [empty, other] = ["empty.mcap", "other.mcap"].map(|name| folder.join(name));
    fs::write(&empty, "").unwrap();
    fs::write(&other, "no log").unwrap();
    let catalog = Catalog::builtin();
    let paths = [empty.clone(), log.clone(), other.clone()];
    let (played, unread) = Played::open_readable(&paths, &catalog);
    assert_eq!(played.len(), 1);
    assert_eq!(unread.iter().map(|(path, _)| path).collect::<Vec<_>>(), [&empty, &other]);
    assert!(unread.iter().all(|(path, error)| error.to_string().contains(&path.display().to_string())), "{unread:?}");
    assert!(Played::open_all(&paths, &catalog).is_err());
}

/// A robot and a person who stand two metres apart for a second.
fn standing(_: &Log) -> Result<Movement, Infallible> {
    let trail = |body: u32, kind: BodyKind| {
        let stop = |tick: u64| Stop { tick, at_m: [2.0 * f64::from(body), 0.0], yaw_rad: 0.0 };
        Trail { body, kind, radius_m: 0.25, stops: (0..60).map(stop).collect() }
    };
    let trails = vec![trail(0, BodyKind::Robot), trail(1, BodyKind::Person)];
    Ok(Movement { trails, ..Movement::default() })
}

#[test]
fn a_session_of_a_world_pack_that_is_not_given_asks_for_it() {
    let (_, counted) = sessions("export-pack", Asking::Never).remove(0);
    let mut log = Log::open(counted.log.as_ref().unwrap()).unwrap();
    // Its floor plan is one of the pack.
    log.session.mission_text = log.session.mission_text.replace("OfficeLayout", "Flat");
    log.session.packs = vec![PackId { name: "homes".to_owned(), version: "1".to_owned(), digest: "ab".to_owned() }];
    let error = Played::new("tea", log, &Catalog::builtin()).unwrap_err().to_string();
    assert!(error.contains("tea: ") && error.contains("`homes`") && error.contains("`--world`"), "{error}");
}

#[test]
fn sessions_with_people_tell_how_robots_moved_around_them() {
    let folder = Path::new(FOLDER).join("export-people");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    let language = Language::new(Arc::new(Catalog::builtin()));
    let bodies = vec!["person".parse().unwrap()];
    let settings = Settings { asking: Asking::Never, record: Some(folder), bodies, ..Settings::expert(1) };
    let task = read_tasks(Path::new(MISSIONS), None).unwrap().into_iter().find(|task| !task.id.contains("cereal"));
    let counted = play(&task.unwrap(), &settings, &language).unwrap();
    let session = Played::open(counted.log.as_ref().unwrap(), language.catalog()).unwrap();
    let moved = session.clone().with_movement(standing);
    let all = tables(std::slice::from_ref(&moved));
    let social = table(&all, "social");
    assert_eq!(social.column("min_distance_m").collect::<Vec<_>>(), [&Cell::Real(1.5)]);
    check_file(social);
    let text = Summary::new(&[moved], &[]).unwrap().to_string();
    assert!(text.contains("minimum distance (m)"), "{text}");
    // What cannot be worked out is said; where nobody could be met, nothing is worked out.
    let failed = session.with_movement(|_| Err("no such mission"));
    let all = tables(&[failed]);
    let problems: Vec<&Cell> = table(&all, "social").column("problem").collect();
    assert_eq!(problems, [&Cell::Text("no such mission".to_owned())]);
    let (alone, _) = sessions("export-alone", Asking::Never).remove(0);
    assert!(!tables(&[alone.with_movement(standing)]).iter().any(|table| table.name == "social"));
}

#[test]
fn a_summary_tells_of_sessions_whose_logs_were_cut_off() {
    let (mut played, counted): (Vec<_>, Vec<_>) = sessions("export-cut", Asking::Never).into_iter().unzip();
    assert!(Summary::new(&played, &[]).unwrap().notes.is_empty());
    // Its recorder was killed half way.
    let path = counted[0].log.as_ref().unwrap();
    let bytes = fs::read(path).unwrap();
    fs::write(path, &bytes[..bytes.len() / 2]).unwrap();
    played[0] = Played::open(path, &Catalog::builtin()).unwrap();
    let summary = Summary::new(&played, &[]).unwrap();
    assert_eq!(summary.sessions, 3);
    let text = summary.to_string();
    assert!(text.contains("sessions whose logs were cut off or lack something: 1 of 3;"), "{text}");
}
