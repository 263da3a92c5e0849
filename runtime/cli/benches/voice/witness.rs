//! What happens in the session, as the bus tells it.

use std::{
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::Duration,
};

use cohabit_bus::{
    Inbox, Session, Shm, Topic, Transport as _, Wake,
    message::{self, AudioView, DialogKind, DialogView, EventKind, EventMessage, StateView},
};

/// The body that is spoken to.
const ROBOT: u32 = 0;
/// A body that moves by less than this in a tick stands, m and rad.
const STANDS: f32 = 1e-4;

/// Watches the bus until it is dropped.
pub struct Witness {
    seen: Arc<Mutex<Seen>>,
    over: Arc<AtomicBool>,
    at_work: Option<thread::JoinHandle<()>>,
}

/// What was seen; times in ns.
#[derive(Default)]
pub struct Seen {
    /// When a tick's state was sent, where the robot stood in it, and how it was turned.
    poses: Vec<(u64, [f32; 4])>,
    /// When the first command of a turn began to move the robot.
    started: Vec<(u64, u64)>,
    pub dialog: Vec<Told>,
    /// When a piece of what robots say aloud was sent.
    pub speech: Vec<u64>,
}

/// A dialog message.
pub struct Told {
    pub nanos: u64,
    pub kind: DialogKind,
    pub turn: u64,
    pub text: String,
    pub stamps: [u64; 5],
}

impl Witness {
    pub fn new(session: &str) -> anyhow::Result<Self> {
        let bus = Shm::join(&Session::new(session)?)?;
        let (seen, over) = (Arc::<Mutex<Seen>>::default(), Arc::<AtomicBool>::default());
        let (noted, until) = (Arc::clone(&seen), Arc::clone(&over));
        let at_work = thread::spawn(move || {
            if let Err(error) = watch(&bus, &noted, &until) {
                println!("the bus is not seen any more: {error:#}");
            }
        });
        Ok(Self { seen, over, at_work: Some(at_work) })
    }

    pub fn seen(&self) -> MutexGuard<'_, Seen> {
        self.seen.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Witness {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Relaxed);
        if let Some(at_work) = self.at_work.take() {
            let _ = at_work.join();
        }
    }
}

impl Seen {
    /// When the robot began to move in a turn.
    pub fn moved(&self, turn: u64) -> Option<u64> {
        self.started.iter().find(|(of, _)| *of == turn).map(|(_, nanos)| *nanos)
    }

    /// How a turn was spoken, as the log has it.
    pub fn spoken(&self, turn: u64) -> Option<[u64; 5]> {
        self.dialog.iter().find(|told| told.kind == DialogKind::Spoken && told.turn == turn).map(|told| told.stamps)
    }

    /// Whether the robot moved in the last tick.
    pub fn is_moving(&self) -> bool {
        let [.., before, now] = &self.poses[..] else { return false };
        !is_same(&before.1, &now.1)
    }

    /// When the robot stood for good, which moved at that time; `None` if it moves yet.
    pub fn stood(&self, after: u64) -> Option<u64> {
        let moved = self.poses.windows(2).rposition(|pair| !is_same(&pair[0].1, &pair[1].1))?;
        // For long enough that it is no rest between two steps.
        (self.poses.len() > moved + 12).then(|| self.poses[moved + 1].0.max(after))
    }
}

fn is_same(one: &[f32; 4], other: &[f32; 4]) -> bool {
    one.iter().zip(other).all(|(one, other)| (one - other).abs() < STANDS)
}

fn watch(bus: &Shm, seen: &Mutex<Seen>, over: &AtomicBool) -> anyhow::Result<()> {
    let mut listener = bus.listener(Wake::State)?;
    let open = |topic| Inbox::new(bus, topic);
    let (mut states, mut events) = (open(Topic::State)?, open(Topic::Events)?);
    let (mut dialog, mut speech) = (open(Topic::Dialog)?, open(Topic::Speech)?);
    while !over.load(Ordering::Relaxed) {
        listener.wait(Duration::from_millis(50))?;
        let mut seen = seen.lock().unwrap_or_else(PoisonError::into_inner);
        let pose = |state: StateView<'_>| {
            let robot = state.bodies.iter().find(|body| body.body == ROBOT)?;
            let [x, y, z] = robot.position_m;
            Some([x, y, z, robot.yaw_rad])
        };
        while let Some((sample, pose)) = states.next(|sample| Ok(pose(StateView::new(sample.payload())?)))? {
            seen.poses.extend(pose.map(|pose| (sample.envelope().sent_nanos, pose)));
        }
        while let Some((sample, event)) = events.next(|sample| message::read::<EventMessage>(sample.payload()))? {
            if event.kind() == Some(EventKind::Started) {
                seen.started.push((event.turn, sample.envelope().sent_nanos));
            }
        }
        while let Some((sample, told)) = dialog.next(|sample| {
            let header = DialogView::new(sample.payload())?.header;
            let text = header.text.as_str().to_owned();
            Ok(header.kind().map(|kind| Told { nanos: 0, kind, turn: header.turn, text, stamps: header.stamps }))
        })? {
            seen.dialog.extend(told.map(|told| Told { nanos: sample.envelope().sent_nanos, ..told }));
        }
        while let Some((sample, samples)) = speech.next(|sample| Ok(AudioView::new(sample.payload())?.samples.len()))? {
            if samples > 0 {
                seen.speech.push(sample.envelope().sent_nanos);
            }
        }
    }
    Ok(())
}
