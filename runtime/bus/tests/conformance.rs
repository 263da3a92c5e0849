//! What holds of every transport.
#![allow(clippy::unwrap_used, missing_docs)]

use std::{
    sync::{
        Arc,
        atomic::{AtomicU32, Ordering},
    },
    time::Duration,
};

use cohabit_bus::{CameraId, Envelope, Local, Session, Shm, Topic, Transport};

/// Runs a check on a fresh bus of each kind.
fn check(what: impl Fn(&dyn Transport)) {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    what(&Local::new(1));
    let name = format!("c-{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
    let session = Session::new(&name).unwrap();
    let lock = session.supervise().unwrap();
    what(&Shm::join(&session).unwrap());
    session.end(lock);
}

fn send(publisher: &mut dyn cohabit_bus::Publisher, tick: u64, payload: &[u8]) -> u64 {
    publisher.send(tick, payload.len(), &mut |bytes| bytes.copy_from_slice(payload)).unwrap()
}

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
fn a_slow_reader_loses_the_oldest_and_is_told() {
    check(|bus| {
        let mut reader = bus.subscriber(Topic::State).unwrap();
        let mut writer = bus.publisher(Topic::State).unwrap();
        send(&mut *writer, 0, b"0");
        assert!(reader.receive().unwrap().is_some());
        for tick in 1..=100 {
            send(&mut *writer, tick, b"x");
        }
        let newest = reader.latest().unwrap().unwrap();
        assert_eq!(newest.envelope().tick, 100);
        assert!(reader.lost() > 50, "{}", reader.lost());
    });
}

#[test]
fn a_late_reader_sees_the_present() {
    check(|bus| {
        let mut writer = bus.publisher(Topic::State).unwrap();
        send(&mut *writer, 41, b"old");
        send(&mut *writer, 42, b"now");
        let mut reader = bus.subscriber(Topic::State).unwrap();
        writer.update().unwrap();
        let sample = reader.receive().unwrap().unwrap();
        assert_eq!((sample.envelope().tick, sample.payload()), (42, &b"now"[..]));
        assert_eq!(reader.lost(), 0);
    });
}

#[test]
fn samples_outgrow_the_first_guess() {
    check(|bus| {
        let topic = Topic::Frames(CameraId::Spectator(0));
        let mut reader = bus.subscriber(topic).unwrap();
        let mut writer = bus.publisher(topic).unwrap();
        for bytes in [1_000, 10_000_000, 20_000_000] {
            writer.send(0, bytes, &mut |payload| payload.fill(5)).unwrap();
            let sample = reader.receive().unwrap().unwrap();
            assert_eq!(sample.payload().len(), bytes);
            assert!(sample.payload().iter().all(|byte| *byte == 5));
        }
    });
}

#[test]
fn a_sample_outlives_its_publisher() {
    check(|bus| {
        let mut reader = bus.subscriber(Topic::Events).unwrap();
        let mut writer = bus.publisher(Topic::Events).unwrap();
        send(&mut *writer, 1, b"still here");
        let sample = reader.receive().unwrap().unwrap();
        drop(writer);
        assert_eq!(sample.payload(), b"still here");
    });
}

#[test]
fn listeners_wake_for_their_group_alone() {
    check(|bus| {
        let mut talk = bus.listener(Topic::Dialog.wake()).unwrap();
        let mut state = bus.listener(Topic::State.wake()).unwrap();
        let mut writer = bus.publisher(Topic::Events).unwrap();
        send(&mut *writer, 1, b"x");
        assert!(talk.wait(Duration::from_secs(5)).unwrap());
        assert!(!state.wait(Duration::from_millis(1)).unwrap());
        assert!(!talk.wait(Duration::from_millis(1)).unwrap());
    });
}

#[test]
fn a_listener_in_another_thread_is_woken() {
    check(|bus| {
        let mut listener = bus.listener(Topic::Commands.wake()).unwrap();
        let mut writer = bus.publisher(Topic::Commands).unwrap();
        let woken = Arc::new(AtomicU32::new(0));
        std::thread::scope(|scope| {
            let seen = Arc::clone(&woken);
            scope.spawn(move || {
                if listener.wait(Duration::from_secs(10)).unwrap() {
                    seen.store(1, Ordering::SeqCst);
                }
            });
            send(&mut *writer, 1, b"go");
        });
        assert_eq!(woken.load(Ordering::SeqCst), 1);
    });
}

#[test]
fn publishers_count_their_readers() {
    check(|bus| {
        let writer = bus.publisher(Topic::Dialog).unwrap();
        assert_eq!(writer.subscribers(), 0);
        let reader = bus.subscriber(Topic::Dialog).unwrap();
        assert_eq!(writer.subscribers(), 1);
        drop(reader);
        assert_eq!(writer.subscribers(), 0);
    });
}

#[test]
fn joining_a_session_that_is_not_there_says_so() {
    let Err(error) = Shm::join(&Session::new("nobody-started-this").unwrap()) else { panic!("joined") };
    assert!(error.to_string().contains("nobody-started-this"), "{error}");
}
