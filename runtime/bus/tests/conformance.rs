//! What holds of every transport.
#![allow(clippy::unwrap_used, missing_docs)]

use std::{
    sync::atomic::{AtomicU32, Ordering},
    thread,
    time::Duration,
};

use cohabit_bus::{CameraId, Envelope, Listener, Local, Publisher, Session, Shm, Subscriber, Topic, Transport, Wake};
use proptest::prelude::*;

const FRAMES: Topic = Topic::Frames(CameraId::Spectator(0));
/// Long enough for any machine.
const SOON: Duration = Duration::from_secs(20);
/// Whether something is there already.
const NOW: Duration = Duration::from_millis(1);

/// Runs a check on a fresh bus of each kind.
fn check(what: impl Fn(&dyn Transport)) {
    what(&Local::new(1));
    on_shm(|bus| what(bus));
}

fn on_shm<T>(what: impl FnOnce(&Shm) -> T) -> T {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let name = format!("c-{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
    let session = Session::new(&name).unwrap();
    let lock = session.supervise().unwrap();
    let done = what(&Shm::join(&session).unwrap());
    session.end(lock);
    done
}

fn send(publisher: &mut dyn Publisher, tick: u64, payload: &[u8]) -> u64 {
    publisher.send(tick, payload.len(), &mut |bytes| bytes.copy_from_slice(payload)).unwrap()
}

/// One sample for each tick.
fn send_each(publisher: &mut dyn Publisher, ticks: impl IntoIterator<Item = u64>, payload: &[u8]) {
    for tick in ticks {
        send(publisher, tick, payload);
    }
}

/// What is there, without keeping hold of it.
fn all(reader: &mut dyn Subscriber) -> Vec<Envelope> {
    std::iter::from_fn(|| reader.receive().unwrap().map(|sample| *sample.envelope())).collect()
}

fn ticks(reader: &mut dyn Subscriber) -> Vec<u64> {
    all(reader).iter().map(|envelope| envelope.tick).collect()
}

fn is_woken(listener: &mut dyn Listener, within: Duration) -> bool {
    listener.wait(within).unwrap()
}

// What arrives, and how.

#[test]
fn samples_arrive_whole_and_in_order() {
    check(|bus| {
        let mut reader = bus.subscriber(Topic::Commands).unwrap();
        let mut writer = bus.publisher(Topic::Commands).unwrap();
        for tick in 0..10u8 {
            send(&mut *writer, u64::from(tick), &vec![tick; usize::from(tick) * 100]);
        }
        for tick in 0..10u8 {
            let sample = reader.receive().unwrap().unwrap();
            assert_eq!(sample.envelope().version, Envelope::VERSION);
            assert_eq!(sample.envelope().tick, u64::from(tick));
            assert_eq!(sample.envelope().sequence, u64::from(tick));
            assert_eq!(sample.payload(), vec![tick; usize::from(tick) * 100]);
            assert_eq!(sample.payload().as_ptr().align_offset(64), 0);
        }
        assert!(reader.receive().unwrap().is_none());
        assert_eq!(reader.lost(), 0);
    });
}

#[test]
fn payloads_of_any_length_arrive() {
    check(|bus| {
        let mut reader = bus.subscriber(FRAMES).unwrap();
        let mut writer = bus.publisher(FRAMES).unwrap();
        // Smaller after larger ones too: memory that was used before shows nothing of what it held.
        for bytes in [0, 1, 63, 64, 65, 4096, 10_000_000, 64 << 20, 1_000, 0] {
            writer.send(0, bytes, &mut |payload| payload.fill(5)).unwrap();
            let sample = reader.receive().unwrap().unwrap();
            assert_eq!(sample.payload().len(), bytes);
            assert!(sample.payload().iter().all(|byte| *byte == 5), "{bytes}");
        }
        assert_eq!(reader.lost(), 0);
    });
}

#[test]
fn a_message_too_long_for_its_topic_is_refused_and_the_next_arrives() {
    check(|bus| {
        let mut reader = bus.subscriber(Topic::Commands).unwrap();
        let mut writer = bus.publisher(Topic::Commands).unwrap();
        let error = writer.send(1, 100_000, &mut |_| ()).unwrap_err();
        assert!(error.to_string().contains("100000 bytes on topic `commands`"), "{error}");
        send(&mut *writer, 2, b"x");
        assert_eq!((ticks(&mut *reader), reader.lost()), (vec![2], 0));
    });
}

#[test]
fn every_reader_gets_everything() {
    check(|bus| {
        let mut readers: Vec<_> = (0..16).map(|_| bus.subscriber(Topic::Dialog).unwrap()).collect();
        let mut writer = bus.publisher(Topic::Dialog).unwrap();
        send_each(&mut *writer, 0..5, b"all");
        for reader in &mut readers {
            assert_eq!(ticks(&mut **reader), [0, 1, 2, 3, 4]);
        }
    });
}

// Slow readers.

#[test]
fn a_slow_reader_loses_the_oldest_and_is_told_how_many() {
    for (topic, depth) in [(Topic::Mission, 1), (Topic::State, 4), (FRAMES, 2), (Topic::Events, 512)] {
        check(|bus| {
            let mut reader = bus.subscriber(topic).unwrap();
            let mut writer = bus.publisher(topic).unwrap();
            send(&mut *writer, 0, b"first");
            assert!(reader.receive().unwrap().is_some());
            let last = depth + 100;
            send_each(&mut *writer, 1..=last, b"x");
            assert_eq!(ticks(&mut *reader), ((last - depth + 1)..=last).collect::<Vec<_>>(), "{topic}");
            assert_eq!(reader.lost(), 100, "{topic}");
        });
    }
}

#[test]
fn a_slow_reader_slows_nobody_else() {
    check(|bus| {
        let mut slow = bus.subscriber(Topic::State).unwrap();
        let mut quick = bus.subscriber(Topic::State).unwrap();
        let mut writer = bus.publisher(Topic::State).unwrap();
        for tick in 0..50 {
            send(&mut *writer, tick, b"x");
            assert_eq!(ticks(&mut *quick), [tick]);
            if tick == 0 {
                assert_eq!(ticks(&mut *slow), [0]);
            }
        }
        assert_eq!(slow.latest().unwrap().unwrap().envelope().tick, 49);
        assert_eq!((slow.lost(), quick.lost()), (45, 0));
    });
}

#[test]
fn what_is_skipped_by_choice_is_not_lost() {
    check(|bus| {
        let mut reader = bus.subscriber(Topic::State).unwrap();
        let mut writer = bus.publisher(Topic::State).unwrap();
        send_each(&mut *writer, 0..4, b"x");
        assert_eq!(reader.latest().unwrap().unwrap().envelope().tick, 3);
        assert_eq!(reader.lost(), 0);
    });
}

#[test]
fn samples_that_are_held_stay_as_they_are() {
    check(|bus| {
        let mut reader = bus.subscriber(FRAMES).unwrap();
        let mut writer = bus.publisher(FRAMES).unwrap();
        let mut held = Vec::new();
        for value in 0..7u8 {
            send(&mut *writer, 0, &[value; 5000]);
            held.extend(reader.receive().unwrap());
        }
        send_each(&mut *writer, 0..100, &[99; 5000]);
        for (value, sample) in (0..7u8).zip(&held) {
            assert_eq!(sample.payload(), [value; 5000]);
        }
    });
}

#[test]
fn who_holds_too_many_samples_is_told_and_goes_on_after_letting_go() {
    check(|bus| {
        let mut reader = bus.subscriber(Topic::Events).unwrap();
        let mut writer = bus.publisher(Topic::Events).unwrap();
        send_each(&mut *writer, 0..20, b"x");
        let mut held: Vec<_> = (0..8).map(|_| reader.receive().unwrap().unwrap()).collect();
        let error = reader.receive().unwrap_err();
        assert!(error.to_string().contains("8 samples"), "{error}");
        held.pop();
        assert_eq!(reader.receive().unwrap().unwrap().envelope().tick, 8);
        drop(held);
        assert_eq!(ticks(&mut *reader), (9..20).collect::<Vec<_>>());
    });
}

// Late readers.

#[test]
fn late_readers_see_the_present_also_when_nothing_more_is_sent() {
    check(|bus| {
        let mut writer = bus.publisher(Topic::State).unwrap();
        send(&mut *writer, 41, b"old");
        send(&mut *writer, 42, b"now");
        for _ in 0..3 {
            let mut reader = bus.subscriber(Topic::State).unwrap();
            writer.update().unwrap();
            let sample = reader.receive().unwrap().unwrap();
            assert_eq!((sample.envelope().tick, sample.payload()), (42, &b"now"[..]));
            assert!(reader.receive().unwrap().is_none());
            assert_eq!(reader.lost(), 0);
        }
    });
}

#[test]
fn late_readers_get_what_is_kept_then_what_comes() {
    for (topic, kept) in [(Topic::Mission, 1), (Topic::Events, 512), (Topic::Ticks, 2048), (Topic::Commands, 0)] {
        check(|bus| {
            let mut writer = bus.publisher(topic).unwrap();
            send_each(&mut *writer, 0..2100, b"x");
            let mut reader = bus.subscriber(topic).unwrap();
            writer.update().unwrap();
            assert_eq!(ticks(&mut *reader), ((2100 - kept)..2100).collect::<Vec<_>>(), "{topic}");
            send(&mut *writer, 2100, b"x");
            assert_eq!(ticks(&mut *reader), [2100], "{topic}");
            assert_eq!(reader.lost(), 0, "{topic}");
        });
    }
}

// Several publishers, and those that are gone.

#[test]
fn each_publishers_samples_keep_their_order_and_count() {
    check(|bus| {
        let mut reader = bus.subscriber(Topic::Commands).unwrap();
        let mut writers: Vec<_> = (0..4).map(|_| bus.publisher(Topic::Commands).unwrap()).collect();
        for tick in 0..100 {
            for writer in &mut writers {
                send(&mut **writer, tick, b"x");
            }
        }
        let samples = all(&mut *reader);
        assert_eq!((samples.len(), reader.lost()), (400, 0));
        let mut runs: Vec<_> = samples.iter().map(|envelope| envelope.run).collect();
        runs.sort_unstable();
        runs.dedup();
        assert_eq!(runs.len(), 4);
        for run in runs {
            let of_run = samples.iter().filter(|envelope| envelope.run == run);
            let counted: Vec<_> = of_run.map(|envelope| (envelope.tick, envelope.sequence)).collect();
            assert_eq!(counted, (0..100).map(|tick| (tick, tick)).collect::<Vec<_>>());
        }
    });
}

#[test]
fn a_publisher_that_says_much_drowns_no_other() {
    check(|bus| {
        let mut reader = bus.subscriber(Topic::State).unwrap();
        let mut quiet = bus.publisher(Topic::State).unwrap();
        let mut loud = bus.publisher(Topic::State).unwrap();
        send(&mut *quiet, 1000, b"quiet");
        send_each(&mut *loud, 0..10, b"loud");
        let mut seen = ticks(&mut *reader);
        seen.sort_unstable();
        assert_eq!(seen, [6, 7, 8, 9, 1000]);
    });
}

#[test]
fn samples_outlive_their_publisher() {
    check(|bus| {
        let mut reader = bus.subscriber(Topic::Events).unwrap();
        let mut writer = bus.publisher(Topic::Events).unwrap();
        send(&mut *writer, 1, b"held");
        send(&mut *writer, 2, b"on its way");
        let held = reader.receive().unwrap().unwrap();
        drop(writer);
        assert_eq!(reader.receive().unwrap().unwrap().payload(), b"on its way");
        assert_eq!(held.payload(), b"held");
    });
}

#[test]
fn what_a_publisher_kept_goes_with_it() {
    check(|bus| {
        let mut gone = bus.publisher(Topic::State).unwrap();
        send(&mut *gone, 1, b"then");
        drop(gone);
        let mut reader = bus.subscriber(Topic::State).unwrap();
        assert!(reader.receive().unwrap().is_none());
        let mut next = bus.publisher(Topic::State).unwrap();
        send(&mut *next, 2, b"now");
        assert_eq!(ticks(&mut *reader), [2]);
    });
}

#[test]
fn a_publisher_that_comes_again_has_lost_nothing() {
    check(|bus| {
        let mut reader = bus.subscriber(Topic::Events).unwrap();
        let mut runs = Vec::new();
        for _ in 0..3 {
            let mut writer = bus.publisher(Topic::Events).unwrap();
            send_each(&mut *writer, 0..3, b"x");
            let samples = all(&mut *reader);
            assert_eq!(samples.iter().map(|envelope| envelope.sequence).collect::<Vec<_>>(), [0, 1, 2]);
            runs.push(samples[0].run);
        }
        runs.sort_unstable();
        runs.dedup();
        assert_eq!((runs.len(), reader.lost()), (3, 0));
    });
}

#[test]
fn publishers_count_their_readers() {
    check(|bus| {
        let writer = bus.publisher(Topic::Dialog).unwrap();
        assert_eq!(writer.subscribers(), 0);
        let readers = [bus.subscriber(Topic::Dialog).unwrap(), bus.subscriber(Topic::Dialog).unwrap()];
        let _other = bus.subscriber(Topic::State).unwrap();
        assert_eq!(writer.subscribers(), 2);
        drop(readers);
        assert_eq!(writer.subscribers(), 0);
    });
}

// Wake-ups.

#[test]
fn listeners_wake_for_their_group_alone() {
    let groups = [
        (Wake::Commands, vec![Topic::Commands]),
        (Wake::Talk, vec![Topic::Dialog, Topic::Events, Topic::Answers]),
        (Wake::State, vec![Topic::State, Topic::Mission, Topic::Ticks, Topic::Snapshots]),
        (Wake::Frames(CameraId::Eyes(1)), vec![Topic::Frames(CameraId::Eyes(1))]),
        (Wake::Frames(CameraId::Eyes(2)), vec![Topic::Frames(CameraId::Eyes(2))]),
    ];
    check(|bus| {
        let mut listeners: Vec<_> = groups.iter().map(|(wake, _)| bus.listener(*wake).unwrap()).collect();
        for (rung, (wake, topics)) in groups.iter().enumerate() {
            for topic in topics {
                assert_eq!(topic.wake(), *wake);
                send(&mut *bus.publisher(*topic).unwrap(), 1, b"x");
                for (index, listener) in listeners.iter_mut().enumerate() {
                    let within = if index == rung { SOON } else { NOW };
                    assert_eq!(is_woken(&mut **listener, within), index == rung, "{topic} and {wake}");
                }
            }
        }
    });
}

#[test]
fn what_was_sent_before_wakes_once() {
    check(|bus| {
        let mut listener = bus.listener(Wake::Commands).unwrap();
        let mut writer = bus.publisher(Topic::Commands).unwrap();
        send_each(&mut *writer, 0..3, b"x");
        assert!(is_woken(&mut *listener, SOON));
        assert!(!is_woken(&mut *listener, NOW));
        send(&mut *writer, 3, b"x");
        assert!(is_woken(&mut *listener, Duration::ZERO), "also one that does not wait");
        assert!(!is_woken(&mut *listener, Duration::ZERO));
    });
}

#[test]
fn all_listeners_in_other_threads_are_woken() {
    check(|bus| {
        let listeners: Vec<_> = (0..8).map(|_| bus.listener(Wake::Commands).unwrap()).collect();
        let mut writer = bus.publisher(Topic::Commands).unwrap();
        let woken = thread::scope(|scope| {
            let waits: Vec<_> =
                listeners.into_iter().map(|mut listener| scope.spawn(move || is_woken(&mut *listener, SOON))).collect();
            send(&mut *writer, 1, b"go");
            waits.into_iter().filter_map(|wait| wait.join().ok()).filter(|woken| *woken).count()
        });
        assert_eq!(woken, 8);
    });
}

#[test]
fn no_wake_up_is_missed() {
    check(|bus| {
        let mut listener = bus.listener(Wake::Commands).unwrap();
        let mut reader = bus.subscriber(Topic::Commands).unwrap();
        let mut writer = bus.publisher(Topic::Commands).unwrap();
        thread::scope(|scope| {
            // Fewer than a reader has room for: none may be lost, so each missed wake-up would show.
            scope.spawn(|| send_each(&mut *writer, 0..500, b"x"));
            let mut seen = Vec::new();
            while seen.len() < 500 {
                assert!(is_woken(&mut *listener, SOON), "after {}", seen.len());
                seen.extend(ticks(&mut *reader));
            }
            assert_eq!(seen, (0..500).collect::<Vec<_>>());
        });
    });
}

// Joining.

#[test]
fn joining_a_session_that_is_not_there_says_so() {
    let Err(error) = Shm::join(&Session::new("nobody-started-this").unwrap()) else { panic!("joined") };
    assert!(error.to_string().contains("nobody-started-this"), "{error}");
}

/// What is done to a bus, in any order.
#[derive(Clone, Copy, Debug)]
enum Deed {
    Join,
    Leave(usize),
    Send(u16),
    Receive(usize),
    Latest(usize),
}

fn deeds() -> impl Strategy<Value = Vec<Deed>> {
    let deed = prop_oneof![
        1 => Just(Deed::Join),
        1 => (0..4usize).prop_map(Deed::Leave),
        6 => (0..300u16).prop_map(Deed::Send),
        4 => (0..4usize).prop_map(Deed::Receive),
        1 => (0..4usize).prop_map(Deed::Latest),
    ];
    proptest::collection::vec(deed, 1..60)
}

/// What readers see of it: a sample's tick, its count, its length, and how many were lost so far.
fn act(bus: &dyn Transport, deeds: &[Deed]) -> Vec<Option<(u64, u64, usize, u64)>> {
    let topic = Topic::State;
    let mut writer = bus.publisher(topic).unwrap();
    let mut readers: Vec<Box<dyn Subscriber>> = Vec::new();
    let mut seen = Vec::new();
    let mut tick = 0;
    for deed in deeds {
        match *deed {
            Deed::Join if readers.len() < 8 => {
                readers.push(bus.subscriber(topic).unwrap());
                writer.update().unwrap();
            }
            Deed::Leave(index) if index < readers.len() => drop(readers.remove(index)),
            Deed::Send(bytes) => {
                tick += 1;
                send(&mut *writer, tick, &vec![7; bytes.into()]);
            }
            Deed::Receive(index) | Deed::Latest(index) if index < readers.len() => {
                let reader = &mut readers[index];
                let newest = matches!(deed, Deed::Latest(_));
                let sample = if newest { reader.latest() } else { reader.receive() }.unwrap();
                seen.push(sample.map(|sample| {
                    let envelope = sample.envelope();
                    (envelope.tick, envelope.sequence, sample.payload().len(), reader.lost())
                }));
            }
            _ => {}
        }
    }
    seen
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn readers_cannot_tell_the_transports_apart(deeds in deeds()) {
        let in_process = act(&Local::new(1), &deeds);
        let shared = on_shm(|bus| act(bus, &deeds));
        prop_assert_eq!(in_process, shared);
    }
}
