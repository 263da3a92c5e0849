//! How long understanding takes: every utterance of the test set, in a furnished office, on one core.
//!
//! ```text
//! cargo bench -p cohabit-language
//! ```

use std::{sync::Arc, time::Instant};

use cohabit_cdf::{Catalog, Layout};
use cohabit_language::{Context, Known, KnownObject, KnownRobot, Language};

const PLAN: &str = "OfficeLayout1";
/// How often each utterance is understood.
const REPEATS: usize = 5;

fn main() {
    let catalog = Arc::new(Catalog::builtin());
    let language = Language::new(Arc::clone(&catalog));
    let layout = Layout::builtin(PLAN).expect("a built-in plan");
    let scene = office(&catalog, &layout);
    let utterances: Vec<&str> = include_str!("../tests/utterances/seen.txt")
        .lines()
        .filter_map(|line| line.split_once(" -> "))
        .flat_map(|(said, _)| said.split(" / "))
        .collect();
    let mut taken_ms: Vec<f64> = Vec::new();
    for _ in 0..REPEATS {
        for utterance in &utterances {
            let began = Instant::now();
            let meant = language.understand(utterance, &scene, &mut Context::default());
            taken_ms.push(began.elapsed().as_secs_f64() * 1e3);
            drop(meant);
        }
    }
    taken_ms.sort_by(f64::total_cmp);
    let at = |share: f64| taken_ms[((taken_ms.len() - 1) as f64 * share) as usize];
    println!(
        "{} utterances among {} objects: median {:.2} ms, p99 {:.2} ms, longest {:.2} ms",
        utterances.len(),
        scene.objects.len(),
        at(0.5),
        at(0.99),
        at(1.0)
    );
}

/// A floor plan as a robot knows it that has seen all of it, from its first viewpoint.
fn office(catalog: &Catalog, layout: &Layout) -> Known {
    let viewpoint = layout.viewpoints.first().expect("a plan has viewpoints");
    let [x, y] = viewpoint.at_m;
    let robot = KnownRobot {
        position_m: [x, y, 0.0],
        yaw_rad: viewpoint.yaw_deg.to_radians(),
        room: viewpoint.room,
        held: None,
    };
    let mut objects = KnownObject::furniture(catalog, layout);
    objects.iter_mut().for_each(|object| object.visible = object.room == robot.room);
    Known::new(robot, objects)
}
