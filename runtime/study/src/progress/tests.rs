//! Whatever happens in whatever order, nobody loses their place.

use proptest::prelude::*;

use super::*;
use crate::{
    design::Limits,
    settings::Settings,
    tutorial::{Activity, Exercise},
};

fn mission(skip_after_s: Option<f64>) -> Step {
    Step::Mission(PlannedMission {
        block: 0,
        mission: "make_cereal".to_owned(),
        is_practice: false,
        exercises: Vec::new(),
        within: Vec::new(),
        settings: Settings::new(),
        limits: Limits { limit_s: Some(60.0), skip_after_s },
    })
}

fn plan() -> Plan {
    let asked = Step::Questionnaire { name: "sus".to_owned(), about: None };
    Plan {
        place: 1,
        steps: vec![mission(Some(10.0)), asked, Step::Break { block: 1, limit_s: None }, mission(None)],
        ..Plan::default()
    }
}

fn consented() -> Event {
    Event::Consented { version: "1".to_owned(), ticked: vec![0, 1], audio: true }
}

fn drafted(value: i32) -> Event {
    Event::Drafted { questionnaire: "sus".to_owned(), answers: vec![Some(Given::Value(value)), None] }
}

fn answered() -> Event {
    Event::Answered { questionnaire: "sus".to_owned(), answers: vec![Some(Given::Value(3)), None] }
}

fn over(ending: Ending) -> Event {
    Event::Over { ending }
}

fn interrupted() -> Event {
    Event::Interrupted { reason: "signal 9".to_owned() }
}

/// All effects of these events, one a second.
fn run(progress: &mut Progress, events: &[Event]) -> Vec<Effect> {
    let step = |(second, event): (u64, &Event)| progress.step(event, second * 1000).unwrap();
    (1..).zip(events).flat_map(step).collect()
}

#[test]
fn a_tutorial_is_left_when_all_was_tried_or_after_a_while() {
    let exercise = |what| Exercise { what, text: "Try.".to_owned() };
    let exercises = [Activity::Say, Activity::Stop].map(exercise).to_vec();
    let Step::Mission(mission) = mission(Some(10.0)) else { panic!("a mission") };
    let tutorial = Step::Mission(PlannedMission { is_practice: true, exercises, ..mission });
    let tried = |exercise| Event::Tried { exercise };
    let begun = || {
        let mut progress = Progress::new(Plan { steps: vec![tutorial.clone()], ..plan() });
        run(&mut progress, &[Event::Read, consented(), Event::GoesOn, Event::Started]);
        progress
    };
    let mut progress = begun();
    run(&mut progress, &[tried(1)]);
    for refused in [tried(1), tried(2), Event::GoesOn] {
        assert!(progress.step(&refused, 0).is_err(), "{refused:?}");
    }
    // What was tried is not lost with a session.
    run(&mut progress, &[interrupted(), Event::Started, tried(0)]);
    assert!(progress.has_tried_all());
    assert_eq!(run(&mut progress, &[Event::GoesOn]), [Effect::EndSession]);
    assert_eq!(progress.phase(), &Phase::Finished);
    let done = &progress.done()[0];
    let order: Vec<usize> = done.tried.iter().map(|one| one.exercise).collect();
    assert_eq!((done.ending, order), (Some(Ending::Complete), vec![1, 0]));
    let mut progress = begun();
    assert_eq!(run(&mut progress, &[tried(0), Event::Played { seconds: 10.0 }, Event::GoesOn]), [Effect::EndSession]);
    assert_eq!((progress.done()[0].ending, progress.tried()), (Some(Ending::Skipped), &[][..]));
}

#[test]
fn a_participant_does_one_step_after_the_other() {
    let mut progress = Progress::new(plan());
    assert!(!progress.has_consented());
    assert_eq!(run(&mut progress, &[Event::Read, consented()]), []);
    assert_eq!(progress.phase(), &Phase::At(0, Doing::Ready));
    let effects = run(&mut progress, &[Event::GoesOn, Event::Started, Event::Played { seconds: 4.0 }, interrupted()]);
    assert_eq!(effects, [Effect::StartSession { attempt: 1 }, Effect::EndSession]);
    assert_eq!(progress.phase(), &Phase::At(0, Doing::Queued { again: true }));
    assert_eq!(run(&mut progress, &[Event::Started]), [Effect::StartSession { attempt: 2 }]);
    assert!(progress.step(&over(Ending::Skipped), 0).is_err(), "10 s are not over");
    run(&mut progress, &[Event::Played { seconds: 6.0 }]);
    assert_eq!((progress.skip_in_s(), progress.left_s()), (Some(0.0), Some(50.0)));
    assert_eq!(run(&mut progress, &[over(Ending::Skipped)]), [Effect::EndSession]);
    let done = &progress.done()[0];
    assert_eq!((done.ending, done.played_s, done.attempts), (Some(Ending::Skipped), 10.0, 2));
    assert!(progress.step(&Event::GoesOn, 0).is_err(), "a questionnaire is not passed over");
    run(&mut progress, &[answered(), Event::GoesOn, Event::GoesOn, Event::Started]);
    assert_eq!(progress.skip_in_s(), None);
    assert!(progress.step(&over(Ending::Skipped), 0).is_err());
    run(&mut progress, &[over(Ending::Complete)]);
    assert_eq!((progress.phase(), progress.done().len()), (&Phase::Finished, 4));
    assert_eq!(run(&mut progress, &[Event::Withdrew]), [Effect::RemoveData], "also afterwards");
}

#[test]
fn a_draft_is_kept_until_it_is_answered_and_is_no_answer() {
    let mut progress = Progress::new(plan());
    assert!(!progress.agrees_to_audio());
    run(&mut progress, &[Event::Read, consented(), Event::GoesOn, Event::Started]);
    assert!(progress.agrees_to_audio());
    assert!(progress.step(&drafted(1), 0).is_err(), "no questionnaire is asked yet");
    run(&mut progress, &[over(Ending::Complete), drafted(1), drafted(2)]);
    assert_eq!(progress.draft(), [Some(Given::Value(2)), None]);
    assert_eq!((progress.done().len(), progress.phase()), (1, &Phase::At(1, Doing::Ready)));
    for _ in 2..MOST_DRAFTS {
        run(&mut progress, &[drafted(3)]);
    }
    assert!(progress.step(&drafted(4), 0).is_err(), "a page that runs wild fills no disk");
    run(&mut progress, &[answered()]);
    assert_eq!((progress.draft().len(), progress.done()[1].answers.len()), (0, 2));
}

#[test]
fn a_probe_is_asked_and_answered_while_a_mission_is_played() {
    let mut progress = Progress::new(plan());
    let (asked, answered) =
        (Event::Probed { probe: 1 }, Event::ProbeAnswered { probe: 1, answer: Some(Given::Value(4)) });
    run(&mut progress, &[Event::Read, consented(), Event::GoesOn]);
    assert!(progress.step(&asked, 0).is_err(), "nothing is played yet");
    run(&mut progress, &[Event::Started]);
    assert!(progress.step(&answered, 0).is_err(), "nothing was asked");
    run(&mut progress, std::slice::from_ref(&asked));
    assert!(progress.step(&Event::Probed { probe: 2 }, 0).is_err(), "one at a time");
    // A session that dies takes no question with it.
    run(&mut progress, &[interrupted(), Event::Started, answered.clone()]);
    assert!(progress.step(&asked, 0).is_err() && progress.step(&answered, 0).is_err(), "once");
    run(&mut progress, &[Event::Probed { probe: 2 }, over(Ending::Complete)]);
    let probed = &progress.done()[0].probed;
    assert_eq!((probed.len(), probed[0].probe, &probed[1].answer), (2, 1, &None));
    assert_eq!(probed[0].answer.as_ref().map(|(_, answer)| answer), Some(&Some(Given::Value(4))));
    assert!(progress.probed().is_empty());
}

#[test]
fn who_withdraws_or_is_excluded_while_playing_ends_the_session() {
    let mut playing = Progress::new(plan());
    run(&mut playing, &[Event::Read, consented(), Event::GoesOn, Event::Started]);
    let mut excluded = playing.clone();
    assert_eq!(run(&mut playing, &[Event::Withdrew]), [Effect::EndSession, Effect::RemoveData]);
    assert!(playing.step(&Event::GoesOn, 0).is_err_and(|refused| refused.to_string().contains("withdrawn")));
    let reason = "did not listen".to_owned();
    assert_eq!(run(&mut excluded, &[Event::Excluded { reason }]), [Effect::EndSession]);
    assert!(excluded.step(&Event::Started, 0).is_err());
}

#[test]
fn who_does_not_agree_is_asked_again_when_they_come_back() {
    let mut progress = Progress::new(plan());
    run(&mut progress, &[Event::Read, Event::Declined, Event::Read]);
    assert_eq!(progress.phase(), &Phase::Consent);
    assert!(!progress.has_consented());
    assert!(progress.step(&Event::Read, 0).is_err());
}

#[test]
fn a_mission_is_played_with_a_partner_until_one_of_them_goes_alone() {
    let mut progress = Progress::new(plan());
    let started = |attempt| Event::StartedTogether { attempt };
    run(&mut progress, &[Event::Read, consented(), Event::GoesOn]);
    assert!(progress.step(&Event::PartnerSkipped, 0).is_err(), "nothing is played yet");
    // The partner's session was started once before this one's was.
    assert_eq!(run(&mut progress, &[started(2)]), [Effect::StartSession { attempt: 2 }]);
    assert_eq!((progress.plays_together(), progress.together()), (Some(0), 2));
    assert!(progress.step(&Event::GoesAlone, 0).is_err(), "who plays does not wait");
    run(&mut progress, &[interrupted()]);
    assert!(progress.step(&started(2), 0).is_err(), "each time has its number");
    run(&mut progress, &[Event::GoesAlone, Event::Started]);
    assert!(progress.is_alone() && progress.plays_together().is_none());
    assert!(progress.step(&Event::PartnerLeft, 0).is_err(), "nobody is waited for any more");
    run(&mut progress, &[over(Ending::Complete)]);
    assert_eq!((progress.done()[0].attempts, progress.done()[0].together), (3, 2));
    assert_eq!((progress.attempts(), progress.together()), (0, 0));
}

#[test]
fn who_has_no_partner_any_more_comes_to_an_end() {
    let waiting = || {
        let mut progress = Progress::new(plan());
        run(&mut progress, &[Event::Read, consented(), Event::GoesOn]);
        progress
    };
    let mut stops = waiting();
    assert_eq!(run(&mut stops, &[Event::StopsWaiting]), []);
    let mut skips = waiting();
    assert_eq!(
        run(&mut skips, &[Event::StartedTogether { attempt: 1 }, Event::PartnerSkipped]),
        [Effect::StartSession { attempt: 1 }, Effect::EndSession],
        "when the partner may, whatever one's own time is"
    );
    assert_eq!(skips.done()[0].ending, Some(Ending::Skipped));
    let mut left = waiting();
    let events = [Event::StartedTogether { attempt: 1 }, Event::PartnerLeft];
    assert_eq!(run(&mut left, &events), [Effect::StartSession { attempt: 1 }, Effect::EndSession]);
    for mut progress in [stops, left] {
        assert_eq!((progress.phase(), progress.is_under_way()), (&Phase::Parted, false));
        assert!(progress.step(&Event::GoesOn, 0).is_err());
        assert_eq!(run(&mut progress, &[Event::Withdrew]), [Effect::RemoveData], "their data are theirs");
    }
}

fn any_event() -> impl Strategy<Value = Event> {
    let endings = [Ending::Complete, Ending::Failed, Ending::TimeUp, Ending::Skipped, Ending::Stopped];
    prop_oneof![
        Just(Event::Read),
        Just(consented()),
        Just(answered()),
        (1..5).prop_map(drafted),
        Just(Event::GoesOn),
        Just(Event::GoesOn),
        Just(Event::Started),
        (0.0..20.0).prop_map(|seconds| Event::Played { seconds }),
        Just(interrupted()),
        (1_u32..4).prop_map(|attempt| Event::StartedTogether { attempt }),
        Just(Event::PartnerSkipped),
        Just(Event::GoesAlone),
        Just(Event::PartnerGoesAlone),
        Just(Event::StopsWaiting),
        Just(Event::PartnerLeft),
        (0_usize..3).prop_map(|probe| Event::Probed { probe }),
        (0_usize..3).prop_map(|probe| Event::ProbeAnswered { probe, answer: Some(Given::Value(1)) }),
        proptest::sample::select(endings.to_vec()).prop_map(over),
    ]
}

proptest! {
    #[test]
    fn what_is_refused_changes_nothing_and_what_is_not_is_restored(events in proptest::collection::vec(any_event(), 0..80)) {
        let mut progress = Progress::new(plan());
        let mut kept = Vec::new();
        for (at, event) in (1..).zip(&events) {
            let before = progress.clone();
            let ran = |progress: &Progress| matches!(progress.phase(), Phase::At(_, Doing::Playing));
            match progress.step(event, at) {
                Ok(effects) => {
                    prop_assert_eq!(effects.contains(&Effect::EndSession), ran(&before) && !ran(&progress));
                    kept.push((at, event.clone()));
                }
                Err(_) => prop_assert_eq!(&before, &progress),
            }
            // Steps are done in order, each once.
            let steps: Vec<usize> = progress.done().iter().map(|done| done.step).collect();
            prop_assert_eq!(steps, (0..progress.done().len()).collect::<Vec<_>>());
        }
        let mut again = Progress::new(plan());
        for (at, event) in kept {
            let text = serde_json::to_string(&event).unwrap();
            again.step(&serde_json::from_str(&text).unwrap(), at).unwrap();
        }
        prop_assert_eq!(again, progress);
    }
}
