//! What is held back is answered as a wizard decides, or by itself when its time has come; and people see the same either way.

use std::time::Duration;

use cohabit_bus::message::DialogMessage;
use cohabit_cdf::{Action, GoToTarget, RoomId, Status};
use cohabit_language::Consulting;
use cohabit_record::DialogEntry;

use super::{
    super::tests::{conversation, knowledge, plans, says},
    deciding::{CHANGED, PAST},
    *,
};
use crate::{
    expression::FacialExpression,
    wizard::{Click, Decision, Holding, MOMENT, WizardSettings},
};

const MS: u64 = 1_000_000;
const SAID: &str = "go to the main office";

fn seat(timeout: Option<(u64, OnTimeout)>) -> WizardSettings {
    WizardSettings {
        timeout: timeout.map(|(ms, _)| Duration::from_millis(ms)),
        on_timeout: timeout.map(|(_, on)| on).unwrap_or_default(),
        moment: MOMENT.to_owned(),
        phrases: vec!["h=Hello!".parse().unwrap(), "m:wait=Hm, let me see.".parse().unwrap()],
        errors: vec![
            r#"{"name":"wrong room","do":"go to the reception","step":1}"#.parse().unwrap(),
            r#"{"name":"forgets","say":"I forgot what I was about."}"#.parse().unwrap(),
        ],
    }
}

fn with_wizard(delay_ms: u64, timeout: Option<(u64, OnTimeout)>) -> Conversation {
    conversation().holding(Holding { delay: Duration::from_millis(delay_ms), wizard: Some(seat(timeout)) })
}

fn delayed(delay_ms: u64) -> Conversation {
    conversation().holding(Holding { delay: Duration::from_millis(delay_ms), wizard: None })
}

/// Says something at 1 s; gives its turn.
fn say(conversation: &mut Conversation, text: &str) -> u64 {
    let (turn, outbox) = conversation.hear_called(text, text, 1000 * MS, &knowledge());
    assert!(!plans(&outbox) && says(&outbox).is_empty(), "{outbox:?}");
    turn
}

fn decide(conversation: &mut Conversation, decision: Decision, at_ms: u64) -> Vec<Outgoing> {
    conversation.decide(decision, at_ms * MS, &knowledge()).unwrap()
}

fn own(turn: Option<u64>, say: &str, order: &str) -> Decision {
    Decision::Own { turn, say: say.to_owned(), phrase: None, order: order.to_owned() }
}

/// What was noted for the log.
fn records(outbox: &[Outgoing]) -> Vec<WizardDecision> {
    let entries = outbox.iter().filter_map(|item| item.message(0)).filter_map(|message| {
        let view = cohabit_bus::message::DialogView { header: &message.header, steps: &[] };
        DialogEntry::new(0, &cohabit_bus::Envelope::default(), view)
    });
    entries.filter_map(|entry| WizardDecision::of(&entry)).collect()
}

fn outcome(outbox: &[Outgoing]) -> DecisionOutcome {
    let all = records(outbox);
    assert_eq!(all.len(), 1, "{outbox:?}");
    all[0].outcome
}

#[test]
fn what_is_accepted_is_done_as_the_robot_would_have() {
    let mut conversation = with_wizard(0, None);
    let turn = say(&mut conversation, SAID);
    let proposal = conversation.proposal(1000 * MS).unwrap();
    assert_eq!((proposal.turn, proposal.kind.as_str(), proposal.said.as_str()), (turn, "plan", SAID));
    assert!(proposal.reply.contains("main office") && proposal.left_ms.is_none(), "{proposal:?}");
    assert!(conversation.elapse(3_600_000 * MS, &knowledge()).is_empty(), "nothing follows by itself");
    let outbox = decide(&mut conversation, Decision::Accept { turn, revision: 0 }, 3500);
    let (_, by_itself) = super::super::tests::conversation().hear(SAID, &knowledge());
    assert!(plans(&outbox));
    assert_eq!(says(&outbox), says(&by_itself));
    let record = &records(&outbox)[0];
    assert_eq!((record.outcome, record.said.as_str()), (DecisionOutcome::Accepted, SAID));
    assert_eq!((record.decided_ms, record.answered_ms), (Some(2500.0), Some(2500.0)));
    assert!(conversation.proposal(0).is_none());
    let again = conversation.decide(Decision::Accept { turn, revision: 0 }, 0, &knowledge());
    assert_eq!(again, Err(PAST.to_owned()));
}

#[test]
fn an_edit_is_proposed_in_its_place() {
    let mut conversation = with_wizard(0, None);
    let turn = say(&mut conversation, "blorp the zargle");
    assert_eq!(conversation.proposal(0).unwrap().kind, "refusal");
    let edit = Decision::Edit { turn, text: " go to the reception ".to_owned() };
    assert!(!plans(&decide(&mut conversation, edit, 2000)));
    let proposal = conversation.proposal(0).unwrap();
    assert_eq!((proposal.kind.as_str(), proposal.revision), ("plan", 1));
    let stale = conversation.decide(Decision::Accept { turn, revision: 0 }, 0, &knowledge());
    assert_eq!(stale, Err(CHANGED.to_owned()));
    let outbox = decide(&mut conversation, Decision::Accept { turn, revision: 1 }, 3000);
    assert!(plans(&outbox) && says(&outbox).contains("reception"), "{}", says(&outbox));
    let record = &records(&outbox)[0];
    assert_eq!(
        (record.outcome, record.edits.as_slice()),
        (DecisionOutcome::Edited, &["go to the reception".to_owned()][..])
    );
    assert_eq!(record.proposed.as_ref().unwrap().kind, "refusal", "what the robot itself made of it");
}

#[test]
fn words_and_orders_take_the_place_of_what_was_proposed() {
    let mut conversation = with_wizard(0, None);
    let turn = say(&mut conversation, SAID);
    let outbox = decide(&mut conversation, own(Some(turn), "I would rather not.", ""), 2000);
    assert!(!plans(&outbox));
    assert_eq!((says(&outbox).as_str(), outcome(&outbox)), ("I would rather not.", DecisionOutcome::Replaced));
    // An order is carried out without a word, and can go with one.
    let turn = say(&mut conversation, SAID);
    let outbox = decide(&mut conversation, own(Some(turn), "", "go to the reception"), 2000);
    assert!(plans(&outbox) && says(&outbox).is_empty(), "{outbox:?}");
    assert_eq!(records(&outbox)[0].ordered, "go to the reception");
    let turn = say(&mut conversation, SAID);
    let outbox = decide(&mut conversation, own(Some(turn), "Off I go.", "go to the reception"), 2000);
    assert!(plans(&outbox) && says(&outbox) == "Off I go.");
    let turn = say(&mut conversation, SAID);
    let phrase = Decision::Own { turn: Some(turn), say: String::new(), phrase: Some('h'), order: String::new() };
    let outbox = decide(&mut conversation, phrase, 2000);
    assert_eq!((says(&outbox).as_str(), records(&outbox)[0].phrase), ("Hello!", Some('h')));
    // Nothing at all dismisses it.
    let turn = say(&mut conversation, SAID);
    let outbox = decide(&mut conversation, own(Some(turn), "", ""), 2000);
    assert!(!plans(&outbox) && says(&outbox).is_empty());
    assert_eq!(outcome(&outbox), DecisionOutcome::Dismissed);
}

#[test]
fn what_cannot_be_ordered_is_told_to_the_wizard_and_waits() {
    let mut conversation = with_wizard(0, None);
    let turn = say(&mut conversation, SAID);
    for (decision, part) in [
        (own(Some(turn), "", "blorp the zargle"), "would not do that"),
        (own(Some(turn), "", "what are you holding?"), "would not do that"),
        (own(Some(turn), &"a".repeat(401), ""), "400 characters"),
        (own(None, "", ""), "Write what"),
        (Decision::Own { turn: None, say: String::new(), phrase: Some('x'), order: String::new() }, "No phrase"),
        (Decision::Edit { turn, text: " ".to_owned() }, "Write a plain request"),
        (Decision::Edit { turn: turn + 1, text: SAID.to_owned() }, "past"),
    ] {
        let problem = conversation.decide(decision, 0, &knowledge()).unwrap_err();
        assert!(problem.contains(part), "{problem}");
        assert_eq!(conversation.proposal(0).unwrap().turn, turn, "it is held back yet");
    }
}

#[test]
fn a_wizard_acts_of_their_own_accord() {
    let mut conversation = with_wizard(0, None);
    let outbox = decide(&mut conversation, own(None, "Hello there.", ""), 2000);
    assert_eq!((says(&outbox).as_str(), outcome(&outbox)), ("Hello there.", DecisionOutcome::Unprompted));
    let outbox = decide(&mut conversation, own(None, "", "go to the reception"), 2000);
    assert!(plans(&outbox) && says(&outbox).is_empty());
    // A phrase that waits leaves what is held back as it is.
    let turn = say(&mut conversation, SAID);
    let phrase = Decision::Own { turn: None, say: String::new(), phrase: Some('m'), order: String::new() };
    assert_eq!(says(&decide(&mut conversation, phrase, 2000)), "Hm, let me see.");
    let outbox = decide(&mut conversation, Decision::Accept { turn, revision: 0 }, 3000);
    assert!(plans(&outbox) && outcome(&outbox) == DecisionOutcome::Accepted);
}

#[test]
fn what_comes_of_an_order_is_told_to_the_wizard_alone() {
    let mut conversation = with_wizard(0, None);
    let mut knowledge = knowledge();
    let end = |conversation: &mut Conversation, knowledge: &mut Knowledge, plan: u64| {
        let kinds = [DialogKind::StepEnded, DialogKind::PlanEnded];
        let told = kinds.map(|kind| DialogMessage::new(kind, 0, plan, "").at_step(0, Status::TargetOutOfRange));
        told.iter().flat_map(|message| conversation.follow(&message.header, knowledge)).collect::<Vec<_>>()
    };
    let outbox = decide(&mut conversation, own(None, "", SAID), 2000);
    let plan = plan_number(&outbox);
    let outbox = end(&mut conversation, &mut knowledge, plan);
    assert!(says(&outbox).is_empty(), "{outbox:?}");
    assert!(outbox.iter().any(|item| matches!(item, Outgoing::ForWizard(_))), "{outbox:?}");
    assert!(!outbox.iter().any(is_spoken), "{outbox:?}");
    // What was asked for is told as ever.
    let turn = say(&mut conversation, SAID);
    let plan = plan_number(&decide(&mut conversation, Decision::Accept { turn, revision: 0 }, 2000));
    assert!(!says(&end(&mut conversation, &mut knowledge, plan)).is_empty());
}

fn is_spoken(item: &Outgoing) -> bool {
    matches!(item, Outgoing::Say(_) | Outgoing::Ask(_))
}

fn plan_number(outbox: &[Outgoing]) -> u64 {
    let plan = outbox.iter().find_map(|item| match item {
        Outgoing::Plan { number, steps } => Some((*number, steps)),
        _ => None,
    });
    let (number, steps) = plan.unwrap();
    assert!(!steps.is_empty());
    number
}

#[test]
fn a_time_out_has_its_policy() {
    for (on, acts, moment) in
        [(OnTimeout::Act, true, ""), (OnTimeout::Say, false, MOMENT), (OnTimeout::Wait, false, "")]
    {
        let mut conversation = with_wizard(500, Some((3000, on)));
        let turn = say(&mut conversation, SAID);
        assert_eq!(conversation.due(1000 * MS), Some(4000 * MS));
        assert!(conversation.elapse(3999 * MS, &knowledge()).is_empty());
        let outbox = conversation.elapse(4000 * MS, &knowledge());
        assert_eq!(plans(&outbox), acts);
        if acts {
            let record = &records(&outbox)[0];
            assert_eq!((record.outcome, record.is_late), (DecisionOutcome::TimedOut, true));
            assert_eq!((record.decided_ms, record.answered_ms), (None, Some(3000.0)));
            continue;
        }
        assert_eq!(says(&outbox), moment);
        assert!(conversation.due(4000 * MS).is_none() && conversation.elapse(9000 * MS, &knowledge()).is_empty());
        assert!(conversation.proposal(0).unwrap().is_late);
        let outbox = decide(&mut conversation, Decision::Accept { turn, revision: 0 }, 9000);
        let record = &records(&outbox)[0];
        assert_eq!((record.outcome, record.is_late), (DecisionOutcome::Accepted, true));
    }
}

#[test]
fn the_time_to_decide_begins_when_the_interpreter_has_answered() {
    let mut conversation = with_wizard(500, Some((3000, OnTimeout::Act))).consulting(Consulting::Always);
    let (turn, outbox) = conversation.hear_called(SAID, SAID, 1000 * MS, &knowledge());
    assert!(outbox.iter().any(|item| matches!(item, Outgoing::Interpret { .. })), "{outbox:?}");
    assert!(conversation.proposal(1000 * MS).is_none(), "nothing can be decided yet");
    // It takes longer than the wizard may.
    conversation.interpreted(turn, None, "it does not know", 11_000 * MS, &knowledge());
    assert_eq!(conversation.proposal(11_000 * MS).unwrap().left_ms, Some(3000));
    assert!(conversation.elapse(13_999 * MS, &knowledge()).is_empty(), "the wizard decides");
    let outbox = decide(&mut conversation, Decision::Accept { turn, revision: 0 }, 12_000);
    let record = &records(&outbox)[0];
    assert_eq!((record.outcome, record.is_late), (DecisionOutcome::Accepted, false));
    assert_eq!((record.decided_ms, record.answered_ms), (Some(1000.0), Some(11_000.0)));
}

#[test]
fn the_delay_is_the_same_with_and_without_a_wizard() {
    let mut alone = delayed(800);
    let mut led = with_wizard(800, None);
    let turn = say(&mut alone, SAID);
    assert_eq!(say(&mut led, SAID), turn);
    let outbox = decide(&mut led, Decision::Accept { turn, revision: 0 }, 1200);
    assert!(!plans(&outbox) && led.proposal(0).unwrap().is_decided);
    for conversation in [&mut alone, &mut led] {
        assert_eq!(conversation.due(1200 * MS), Some(1800 * MS));
        assert!(conversation.elapse(1799 * MS, &knowledge()).is_empty());
    }
    let (alone, led) = (alone.elapse(1800 * MS, &knowledge()), led.elapse(1800 * MS, &knowledge()));
    assert!(records(&alone).is_empty(), "nobody decided it");
    // To people it is all one.
    let seen = |outbox: Vec<Outgoing>| -> Vec<Outgoing> {
        let is_decision = |item: &Outgoing| !records(std::slice::from_ref(item)).is_empty();
        outbox.into_iter().filter(|item| !is_decision(item)).collect()
    };
    assert_eq!(seen(alone), seen(led));
}

#[test]
fn what_is_said_meanwhile_waits_and_a_stop_does_not() {
    let mut conversation = with_wizard(0, Some((3000, OnTimeout::Act)));
    let first = say(&mut conversation, SAID);
    let second = say(&mut conversation, "then go there again");
    let third = say(&mut conversation, "go to the reception");
    assert_eq!(conversation.proposal(0).unwrap().waiting, ["then go there again", "go to the reception"]);
    decide(&mut conversation, Decision::Accept { turn: first, revision: 0 }, 2000);
    let proposal = conversation.proposal(2000 * MS).unwrap();
    assert_eq!((proposal.turn, proposal.left_ms), (second, Some(3000)), "time counts from when it could be decided");
    let (_, outbox) = conversation.hear_called("stop!", "stop!", 2500 * MS, &knowledge());
    assert!(plans(&outbox) && says(&outbox).contains("stop"), "{}", says(&outbox));
    let outcomes: Vec<_> = records(&outbox).iter().map(|record| record.outcome).collect();
    assert_eq!(outcomes, [DecisionOutcome::Stopped; 2]);
    let ended = |turn: u64| {
        let over = Outgoing::TurnEnded { turn, end: TurnEnd::Interrupted };
        outbox.contains(&over)
    };
    assert!(ended(second) && ended(third) && conversation.proposal(0).is_none());
}

#[test]
fn a_wizards_stop_waits_for_no_delay() {
    let mut conversation = with_wizard(3000, None);
    let turn = say(&mut conversation, SAID);
    let outbox = decide(&mut conversation, own(Some(turn), "", "stop"), 1500);
    assert!(plans(&outbox) && says(&outbox).is_empty(), "{outbox:?}");
    assert_eq!((outcome(&outbox), records(&outbox)[0].answered_ms), (DecisionOutcome::Replaced, Some(500.0)));
    assert!(conversation.proposal(0).is_none());
    // What is said is an answer, and comes when answers come.
    let turn = say(&mut conversation, SAID);
    let outbox = decide(&mut conversation, own(Some(turn), "I stop.", "stop"), 1500);
    assert!(!plans(&outbox) && conversation.due(1500 * MS) == Some(4000 * MS), "{outbox:?}");
}

#[test]
fn what_is_said_with_a_stop_is_held_back_by_itself() {
    let mut conversation = with_wizard(0, None);
    let text = "stop, and go to the reception";
    let (turn, outbox) = conversation.hear_called(text, text, 1000 * MS, &knowledge());
    let stop = plan_number(&outbox);
    assert!(!says(&outbox).contains("reception"), "{}", says(&outbox));
    assert_eq!(conversation.proposal(0).unwrap().kind, "plan");
    let outbox = decide(&mut conversation, Decision::Accept { turn, revision: 0 }, 2000);
    assert!(plan_number(&outbox) > stop && says(&outbox).contains("reception"));
}

#[test]
fn what_is_proposed_follows_what_the_robot_does_meanwhile() {
    let mut conversation = with_wizard(0, None);
    let turn = say(&mut conversation, SAID);
    let plan = plan_number(&decide(&mut conversation, Decision::Accept { turn, revision: 0 }, 2000));
    let held = say(&mut conversation, "what did you do?");
    let before = conversation.proposal(0).unwrap();
    let done = DialogMessage::new(DialogKind::StepEnded, 0, plan, "").at_step(0, Status::ActionSuccessful);
    let outbox = conversation.follow(&done.header, &mut knowledge());
    let after = conversation.proposal(0).unwrap();
    assert_eq!(after.turn, held);
    if after.reply != before.reply {
        assert_eq!(after.revision, before.revision + 1);
        assert!(outbox.contains(&Outgoing::Proposes));
    }
    assert_ne!(after.reply, before.reply, "it has done something since");
}

#[test]
fn a_conversation_goes_on_with_what_it_held_back() {
    let mut conversation = with_wizard(0, None);
    let turn = say(&mut conversation, SAID);
    let kept = serde_json::to_string(conversation.memory()).unwrap();
    let mut next = with_wizard(0, None);
    next.restore(serde_json::from_str(&kept).unwrap());
    assert_eq!(next.proposal(0), conversation.proposal(0));
    assert!(plans(&decide(&mut next, Decision::Accept { turn, revision: 0 }, 2000)));
}

#[test]
fn clicks_are_done_without_a_word_and_noted() {
    let mut conversation = with_wizard(0, None);
    let click = |turn, click| Decision::Click { turn, click, chosen_ms: Some(700.0) };
    let outbox = decide(&mut conversation, click(None, Click::Room { room: RoomId::RECEPTION }), 2000);
    assert!(plans(&outbox) && says(&outbox).is_empty(), "{outbox:?}");
    let record = &records(&outbox)[0];
    assert_eq!((record.outcome, record.chosen_ms), (DecisionOutcome::Unprompted, Some(700.0)));
    assert_eq!((record.clicked.as_deref(), record.ordered.as_str()), (Some("go_to_room"), "going to the reception"));
    // In place of what was proposed.
    let turn = say(&mut conversation, SAID);
    let outbox = decide(&mut conversation, click(Some(turn), Click::Point { object: 3 }), 2000);
    let record = &records(&outbox)[0];
    assert_eq!((record.outcome, record.object), (DecisionOutcome::Replaced, Some(3)));
    assert!(plans(&outbox) && conversation.proposal(0).is_none());
    let problem = conversation.decide(click(None, Click::Look { object: 3 }), 0, &knowledge()).unwrap_err();
    assert!(problem.contains("in that room"), "{problem}");
}

#[test]
fn planned_errors_take_the_place_of_what_was_proposed_and_are_marked() {
    let mut conversation = with_wizard(0, None);
    let inject = |turn, name: &str| Decision::Inject { turn, error: name.to_owned() };
    let turn = say(&mut conversation, SAID);
    let outbox = decide(&mut conversation, inject(Some(turn), "wrong room"), 2000);
    assert!(says(&outbox).contains("main office"), "it says what it would have said: {}", says(&outbox));
    let reception = Action::GoTo { target: GoToTarget::Room(RoomId::RECEPTION) };
    let does = |item: &Outgoing| match item {
        Outgoing::Plan { steps, .. } => steps.iter().any(|step| step.action == reception),
        _ => false,
    };
    assert!(outbox.iter().any(does), "{outbox:?}");
    let record = &records(&outbox)[0];
    assert_eq!((record.outcome, record.injected.as_deref()), (DecisionOutcome::Replaced, Some("wrong room")));
    let outbox = decide(&mut conversation, inject(None, "forgets"), 3000);
    assert_eq!(says(&outbox), "I forgot what I was about.");
    assert_eq!(records(&outbox)[0].injected.as_deref(), Some("forgets"));
    for (name, part) in [("wrong room", "none is proposed"), ("no such", "No planned error")] {
        let problem = conversation.decide(inject(None, name), 0, &knowledge()).unwrap_err();
        assert!(problem.contains(part), "{problem}");
    }
}

#[test]
fn the_face_follows_the_conversation_and_the_wizard() {
    let shown = |outbox: &[Outgoing]| -> Vec<FacialExpression> {
        let all = outbox.iter().filter_map(|item| match item {
            Outgoing::Express { shown, .. } => Some(*shown),
            _ => None,
        });
        all.collect()
    };
    let mut alone = conversation();
    let (_, outbox) = alone.hear("blorp the zargle", &knowledge());
    assert_eq!(shown(&outbox), [FacialExpression::Confused], "without a wizard, too");
    let (_, outbox) = alone.hear(SAID, &knowledge());
    assert_eq!(shown(&outbox), [FacialExpression::Neutral]);
    let mut led = with_wizard(0, None);
    let happy = || Decision::Express { expression: FacialExpression::Happy };
    let outbox = decide(&mut led, happy(), 2000);
    assert_eq!((shown(&outbox), outcome(&outbox)), (vec![FacialExpression::Happy], DecisionOutcome::Unprompted));
    assert_eq!(records(&outbox)[0].expression.as_deref(), Some("happy"));
    assert!(shown(&decide(&mut led, happy(), 2500)).is_empty(), "that is no news");
}

#[test]
fn what_is_undecided_when_the_session_ends_is_noted() {
    let mut led = with_wizard(0, None);
    say(&mut led, SAID);
    say(&mut led, "go to the reception");
    let noted = records(&led.left_undecided()).into_iter().map(|record| (record.outcome, record.said));
    let undecided = |said: &str| (DecisionOutcome::Undecided, said.to_owned());
    assert_eq!(noted.collect::<Vec<_>>(), [undecided(SAID), undecided("go to the reception")]);
    assert!(led.proposal(0).is_some(), "a service that goes on holds it back yet");
    let mut alone = delayed(500);
    say(&mut alone, SAID);
    assert!(alone.left_undecided().is_empty(), "nobody was to decide");
}
