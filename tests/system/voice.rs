//! Speaking to the robot, and hearing it.

use std::{fs, path::PathBuf, time::Duration};

use cohabit_bus::{
    Inbox, Session, Shm, Topic, Transport as _,
    message::{AudioHeader, AudioView},
};
use cohabit_record::Log;
use cohabit_speech::{Engines, VoiceSettings};
use cohabit_tests::{Browser, Page, Play, SpeechServer, Tab, babble, wav};
use serde_json::{Value, json};

use crate::COHABIT;

/// What the stand-in hears, by tenths of a second.
const HEARD: [(usize, &str); 3] =
    [(3, "stop"), (14, "go to the main office"), (28, "go to the break room and pick up the bowl")];
const STOP_S: f32 = 0.5;
const OFFICE_S: f32 = 1.6;
const BOWL_S: f32 = 3.0;

fn silence(seconds: f32) -> Vec<f32> {
    vec![0.0; (seconds * cohabit_speech::RATE as f32) as usize]
}

/// A session that hears with the stand-in, and nothing that is installed on this machine.
fn play(server: &SpeechServer, arguments: &[&str]) -> Play {
    let nothing = std::env::temp_dir().join("cohabit-no-voice");
    let folder = nothing.to_str().unwrap();
    let environment = [server.environment().as_slice(), &[("COHABIT_VOICE", folder)]].concat();
    Play::start_in(COHABIT, &[&["make_cereal", "--knows", "everything"], arguments].concat(), &environment).unwrap()
}

fn listen(page: &mut Page, held: bool) {
    page.send(&json!({ "type": "listen", "rate": cohabit_speech::RATE, "held": held })).unwrap();
    page.wait("the session to hear", |_, message| message["type"] == "voice" && message["hears"] == true).unwrap();
}

fn has_said(page: &Page, who: &str, part: &str) -> bool {
    page.chat.iter().any(|(from, text)| from == who && text.contains(part))
}

fn room(page: &Page) -> &str {
    page.state["robot"]["room"].as_str().unwrap_or_default()
}

#[test]
fn what_is_said_aloud_is_done_answered_aloud_and_in_the_log() {
    let server = SpeechServer::start(&HEARD).unwrap();
    let play = play(&server, &["--edit-heard", "0", "--record-audio"]);
    let bus = Shm::join(&Session::new(&play.session).unwrap()).unwrap();
    let mut ears = [Topic::Microphone, Topic::Speech].map(|topic| Inbox::new(&bus, topic).unwrap());
    let mut page = Page::open(play.authority()).unwrap();
    page.send(&json!({ "type": "aloud", "on": true })).unwrap();
    listen(&mut page, false);
    page.speak(&[babble(OFFICE_S), silence(1.2)].concat()).unwrap();
    page.wait("the robot to hear it", |page, _| has_said(page, "person", "go to the main office")).unwrap();
    page.wait("an answer aloud", |page, _| has_said(page, "robot", "main office") && page.heard_samples > 0).unwrap();
    page.send(&json!({ "type": "sounded", "turn": 1 })).unwrap();
    page.wait("the latency", |_, message| message["type"] == "latency" && message["sounded_ms"].is_number()).unwrap();
    page.wait("the robot to go there", |page, _| room(page) == "MainOffice").unwrap();
    assert!(server.said().iter().any(|said| said.contains("oing to the main office")), "{:?}", server.said());

    // Any agent can hear both.
    let heard = ears.each_mut().map(|ear| {
        let samples =
            std::iter::from_fn(|| ear.next(|sample| Ok(AudioView::new(sample.payload())?.samples.len())).unwrap());
        samples.map(|(_, samples)| samples).sum::<usize>()
    });
    assert!(heard.iter().all(|samples| *samples > 8_000), "{heard:?}");

    // And speak.
    let before = page.heard_samples;
    let mut mouth = bus.publisher(Topic::Speech).unwrap();
    let header = AudioHeader::of_body(22_050, 0, 0, 1);
    mouth.send(0, AudioView::bytes(1_000), &mut |bytes| AudioView::write(header, &[9; 1_000], bytes)).unwrap();
    page.wait("what an agent says", |page, _| page.heard_samples == before + 1_000).unwrap();

    let ended = play.end().unwrap();
    let log = Log::open(&ended.log).unwrap();
    assert!(log.session.audio);
    assert_eq!(log.session.settings["record_audio"], "yes");
    let spoken = log.dialog.iter().rfind(|entry| entry.kind == "Spoken").unwrap();
    let [began, ended_at, text, understood, sounded] = spoken.stamps;
    assert!(
        0 < began && began < ended_at && ended_at < text && text <= understood && understood < sounded,
        "{spoken:?}"
    );
    assert_eq!(spoken.text, "go to the main office");
    let raw = fs::read(&ended.log).unwrap();
    let has = |text: &str| raw.windows(text.len()).any(|window| window == text.as_bytes());
    assert!(has("/audio/microphone") && has("/audio/speech") && has("\"sample_rate\":16000"));
}

#[test]
fn stop_is_heard_while_the_robot_moves_and_speaks() {
    let server = SpeechServer::start(&HEARD).unwrap();
    let play = play(&server, &[]);
    let mut page = Page::open(play.authority()).unwrap();
    page.send(&json!({ "type": "aloud", "on": true })).unwrap();
    page.say("go to the main office").unwrap();
    page.wait("the robot to go", |page, _| page.state["robot"]["busy"] == true).unwrap();
    listen(&mut page, false);
    page.speak(&[babble(STOP_S), silence(1.0)].concat()).unwrap();
    page.wait("the speech to end", |_, message| message["type"] == "hush").unwrap();
    page.wait("the robot to stop", |page, _| has_said(page, "robot", "I stop") && page.state["robot"]["busy"] == false)
        .unwrap();
    assert_ne!(room(&page), "MainOffice");
    let ended = play.end().unwrap();
    assert!(!Log::open(&ended.log).unwrap().session.audio, "nobody agreed to that");
}

#[test]
fn what_was_heard_can_be_changed_before_the_robot_hears_it() {
    let server = SpeechServer::start(&HEARD).unwrap();
    let play = play(&server, &["--edit-heard", "30"]);
    let mut page = Page::open(play.authority()).unwrap();
    listen(&mut page, true);
    page.speak(&babble(OFFICE_S)).unwrap();
    page.send(&json!({ "type": "listened" })).unwrap();
    let heard = page.wait("what was heard", |_, message| message["type"] == "heard").unwrap();
    assert_eq!(heard["text"], "go to the main office");
    assert!(!page.chat.iter().any(|(from, _)| from == "person"), "it waits");
    page.send(&json!({ "type": "heard", "number": heard["number"], "text": "where is the milk?", "sure": true }))
        .unwrap();
    page.wait("the answer", |page, _| has_said(page, "person", "milk") && has_said(page, "robot", "milk")).unwrap();
    // What is forgotten is not said.
    page.send(&json!({ "type": "listen", "rate": 16_000, "held": true })).unwrap();
    page.speak(&babble(OFFICE_S)).unwrap();
    page.send(&json!({ "type": "listened" })).unwrap();
    let heard = page.wait("what was heard", |_, message| message["type"] == "heard").unwrap();
    page.send(&json!({ "type": "heard", "number": heard["number"], "text": null, "sure": true })).unwrap();
    page.do_and_wait("what are you holding?").unwrap();
    assert!(!has_said(&page, "person", "main office"), "{:?}", page.chat);
    play.end().unwrap();
}

#[test]
fn what_was_heard_before_can_be_said_when_more_was_heard() {
    let server = SpeechServer::start(&HEARD).unwrap();
    let play = play(&server, &["--edit-heard", "30"]);
    let mut page = Page::open(play.authority()).unwrap();
    listen(&mut page, false);
    let mut heard = Vec::new();
    for seconds in [OFFICE_S, BOWL_S] {
        page.send(&json!({ "type": "listen", "rate": 16_000, "held": true })).unwrap();
        page.speak(&babble(seconds)).unwrap();
        page.send(&json!({ "type": "listened" })).unwrap();
        heard.push(page.wait("what was heard", |_, message| message["type"] == "heard").unwrap());
    }
    for (heard, part) in heard.iter().zip(["main office", "bowl"]) {
        page.send(&json!({ "type": "heard", "number": heard["number"], "text": heard["text"], "sure": false }))
            .unwrap();
        page.wait("it to be said", |page, _| has_said(page, "person", part)).unwrap();
    }
    play.end().unwrap();
}

/// Text works, whatever came by the microphone.
fn text_goes_on(page: &mut Page) {
    page.do_and_wait("what are you holding?").unwrap();
    assert!(has_said(page, "robot", "My hand is empty"), "{:?}", page.chat);
}

#[test]
fn what_is_no_sound_is_refused_and_text_goes_on() {
    let server = SpeechServer::start(&HEARD).unwrap();
    let play = play(&server, &["--edit-heard", "0"]);
    let is_refusal = |part: &'static str| {
        move |_: &Page, message: &Value| message["type"] == "error" && message["text"].as_str().unwrap().contains(part)
    };
    let mut page = Page::open(play.authority()).unwrap();
    page.send(&json!({ "type": "listen", "rate": 48_000, "held": false })).unwrap();
    page.wait("a refusal of the rate", is_refusal("48000 samples a second, where 16000 are needed")).unwrap();
    // Half a sample.
    listen(&mut page, false);
    page.send_bytes(vec![1; 333]).unwrap();
    page.wait("a refusal of half a sample", is_refusal("333 bytes at once")).unwrap();
    page.wait("the end of listening", |_, message| message["type"] == "deaf").unwrap();
    // Sound of three times that rate.
    page.send(&json!({ "type": "listen", "rate": 16_000, "held": false })).unwrap();
    let fast: Vec<f32> = babble(12.0);
    for piece in fast.chunks(3072) {
        let bytes = cohabit_speech::to_pcm(piece).iter().flat_map(|sample| sample.to_le_bytes()).collect();
        page.send_bytes(bytes).unwrap();
        std::thread::sleep(Duration::from_millis(60));
    }
    page.wait("a refusal of what comes too fast", is_refusal("samples a second, where 16000 are needed: reload"))
        .unwrap();
    text_goes_on(&mut page);
    // Noise of all loudnesses, and nothing at all.
    page.send(&json!({ "type": "listen", "rate": 16_000, "held": false })).unwrap();
    let noise: Vec<u8> = (0..64_000_u32).map(|at| (at.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
    for piece in noise.chunks(2048) {
        page.send_bytes(piece.to_vec()).unwrap();
        std::thread::sleep(Duration::from_millis(64));
    }
    page.send_bytes(Vec::new()).unwrap();
    text_goes_on(&mut page);
    // A page that goes in the middle of a word.
    page.speak(&babble(0.4)).unwrap();
    drop(page);
    let mut page = Page::open(play.authority()).unwrap();
    text_goes_on(&mut page);
    play.end().unwrap();
}

#[test]
fn a_server_of_speech_that_dies_costs_the_voice_alone() {
    let server = SpeechServer::start(&HEARD).unwrap();
    let nowhere = [("COHABIT_RECOGNIZER", "wyoming://127.0.0.1:9"), ("COHABIT_SYNTHESIZER", server.address.as_str())];
    let play = Play::start_in(COHABIT, &["make_cereal"], &nowhere).unwrap();
    let mut page = Page::open(play.authority()).unwrap();
    page.send(&json!({ "type": "listen", "rate": 16_000, "held": false })).unwrap();
    let told = page.wait("what the session lacks", |_, message| message["type"] == "voice").unwrap();
    assert_eq!((&told["hears"], &told["speaks"]), (&json!(false), &json!(true)));
    assert!(told["lacks"].to_string().contains("127.0.0.1:9"), "{told}");
    text_goes_on(&mut page);
    play.end().unwrap();
}

/// A file with what somebody says into a browser's microphone, which begins when the browser does.
fn microphone(name: &str, sound: &[f32]) -> PathBuf {
    let path = std::env::temp_dir().join(format!("cohabit-{}-{name}.wav", std::process::id()));
    fs::write(&path, wav(sound)).unwrap();
    path
}

fn open(browser: &Browser, play: &Play) -> Tab {
    let mut tab = browser.open(&play.address, 1280, 800).unwrap();
    tab.wait_until("document.querySelector('#chat-input') !== null && window.cohabit?.frames > 0").unwrap();
    tab
}

const ROBOT_LINES: &str = "document.querySelectorAll('#chat .from-robot').length > 0";

#[test]
#[cfg_attr(not(browser), ignore = "needs a browser")]
fn a_person_speaks_to_the_robot_in_a_browser() {
    let server = SpeechServer::start(&HEARD).unwrap();
    let sound = microphone("bowl", &[silence(1.0), babble(BOWL_S), silence(60.0)].concat());
    let browser = Browser::start_speaking(&sound).unwrap();
    let play = play(&server, &["--edit-heard", "0.5"]);
    let mut tab = open(&browser, &play);
    // The file begins with the microphone.
    tab.evaluate("document.querySelector('#open-mic').click()").unwrap();
    tab.wait_until("window.cohabit.voice.mode === 'open' && window.cohabit.voice.engines?.hears === true").unwrap();
    tab.wait_until("document.querySelector('#chat').innerText.includes('go to the break room and pick up the bowl')")
        .unwrap();
    tab.wait_until(ROBOT_LINES).unwrap();
    tab.wait_until("window.cohabit.voice.spoken > 0").unwrap();
    tab.wait_until("/bowl/i.test(window.cohabit.state.robot.holding ?? '')").unwrap();
    tab.wait_until("window.cohabit.sounds.some(({ name }) => name === 'roll')").unwrap();
    tab.evaluate("document.querySelector('#open-mic').click()").unwrap();
    tab.wait_until("window.cohabit.voice.mode === 'off'").unwrap();
    drop((tab, browser));
    play.end().unwrap();
    let _ = fs::remove_file(sound);
}

#[test]
#[cfg_attr(not(browser), ignore = "needs a browser")]
fn what_is_typed_while_something_is_heard_is_sent_too_and_once() {
    let server = SpeechServer::start(&HEARD).unwrap();
    let sound = microphone("typed", &[silence(1.0), babble(OFFICE_S), silence(60.0)].concat());
    let browser = Browser::start_speaking(&sound).unwrap();
    let play = play(&server, &["--edit-heard", "10"]);
    let mut tab = open(&browser, &play);
    tab.evaluate("document.querySelector('#chat-input').value = 'what are you '").unwrap();
    tab.evaluate("document.querySelector('#open-mic').click()").unwrap();
    tab.wait_until("document.querySelector('#hearing-text').textContent === 'go to the main office'").unwrap();
    let end = "(input => { input.focus(); input.setSelectionRange(99, 99); })(document.querySelector('#chat-input'))";
    tab.evaluate(end).unwrap();
    tab.type_and_enter("holding?").unwrap();
    tab.wait_until("document.querySelector('#chat').innerText.includes('what are you holding?')").unwrap();
    assert_eq!(tab.evaluate("document.querySelector('#chat-input').value").unwrap(), "");
    // What was heard is said in its time.
    tab.wait_until("document.querySelector('#chat').innerText.includes('go to the main office')").unwrap();
    drop((tab, browser));
    play.end().unwrap();
    let _ = fs::remove_file(sound);
}

#[test]
#[cfg_attr(not(browser), ignore = "needs a browser")]
fn a_person_says_stop_in_a_browser_and_a_microphone_vanishes() {
    let server = SpeechServer::start(&HEARD).unwrap();
    let sound = microphone("stop", &[silence(3.0), babble(STOP_S), silence(60.0)].concat());
    let browser = Browser::start_speaking(&sound).unwrap();
    let play = play(&server, &[]);
    let mut tab = open(&browser, &play);
    tab.evaluate("document.querySelector('#open-mic').click()").unwrap();
    tab.evaluate("document.querySelector('#chat-input').focus()").unwrap();
    tab.type_and_enter("go to the main office").unwrap();
    tab.wait_until("window.cohabit.state.robot.busy").unwrap();
    tab.wait_until("document.querySelector('#chat').innerText.includes('I stop')").unwrap();
    tab.wait_until("!window.cohabit.state.robot.busy").unwrap();
    assert_ne!(tab.evaluate("window.cohabit.state.robot.room").unwrap(), "MainOffice");
    // It is pulled out: that is said, and text goes on.
    tab.evaluate("window.cohabit.loseMicrophone()").unwrap();
    tab.wait_until("window.cohabit.voice.mode === 'off' && /microphone is gone/.test(document.querySelector('#hearing').innerText)")
        .unwrap();
    tab.type_and_enter("what are you holding?").unwrap();
    tab.wait_until("/hand is empty/.test([...document.querySelectorAll('#chat .from-robot')].at(-1).innerText)")
        .unwrap();
    drop((tab, browser));
    play.end().unwrap();
    let _ = fs::remove_file(sound);
}

#[test]
#[cfg_attr(not(browser), ignore = "needs a browser")]
fn who_taps_and_speaks_in_vain_is_told_so() {
    let server = SpeechServer::start(&[]).unwrap();
    let sound = microphone("vain", &[silence(1.0), babble(OFFICE_S), silence(60.0)].concat());
    let browser = Browser::start_speaking(&sound).unwrap();
    let play = play(&server, &[]);
    let mut tab = open(&browser, &play);
    tab.evaluate("document.querySelector('#mic').click()").unwrap();
    tab.wait_until("/I heard nothing/.test(document.querySelector('#hearing').innerText)").unwrap();
    assert_eq!(tab.evaluate("window.cohabit.voice.mode").unwrap(), "off");
    drop((tab, browser));
    play.end().unwrap();
    let _ = fs::remove_file(sound);
}

/// The engines of this machine; nothing, which is said, where they are not installed.
fn installed() -> Engines {
    let engines = Engines::open(&VoiceSettings::from_env().unwrap());
    assert!(engines.recognizer.is_some() && engines.synthesizer.is_some(), "voice is incomplete: {:?}", engines.lacks);
    engines
}

/// How a text is spoken by what is installed, at 16 kHz.
fn spoken(engines: &mut Engines, text: &str) -> Vec<f32> {
    let synthesizer = engines.synthesizer.as_mut().unwrap();
    let mut pcm = Vec::new();
    synthesizer
        .speak(text, &mut |piece| {
            pcm.extend(piece);
            std::ops::ControlFlow::Continue(())
        })
        .unwrap();
    cohabit_speech::resample(&cohabit_speech::from_pcm(&pcm), synthesizer.rate(), cohabit_speech::RATE).unwrap()
}

#[test]
#[cfg_attr(not(all(browser, voice)), ignore = "optional: a browser, `cohabit voice install`, and espeak-ng")]
fn a_spoken_request_is_recognised_done_and_answered() {
    let mut engines = installed();
    let request = spoken(&mut engines, "Go to the break room and pick up the bowl.");
    let heard = engines.recognizer.as_mut().unwrap().recognize(&request).unwrap();
    println!("without a hint of what is likely: {:?}", heard.best());
    drop(engines);
    let sound = microphone("request", &[silence(1.5), request, silence(60.0)].concat());
    let browser = Browser::start_speaking(&sound).unwrap();
    let play = Play::start(COHABIT, &["make_cereal", "--knows", "everything", "--edit-heard", "0"]).unwrap();
    let mut tab = open(&browser, &play);
    tab.evaluate("document.querySelector('#open-mic').click()").unwrap();
    tab.wait_until("window.cohabit.voice.engines?.hears === true").unwrap();
    tab.wait_until("/bowl/i.test(window.cohabit.state.robot.holding ?? '')").unwrap();
    tab.wait_until("window.cohabit.voice.spoken > 0").unwrap();
    println!("latency: {}", tab.evaluate("document.querySelector('#latency').innerText").unwrap());
    println!("chat: {}", tab.evaluate("document.querySelector('#chat').innerText").unwrap());
    drop((tab, browser));
    play.end().unwrap();
    let _ = fs::remove_file(sound);
}

#[test]
#[cfg_attr(not(all(browser, voice)), ignore = "optional: a browser, `cohabit voice install`, and espeak-ng")]
fn a_spoken_stop_stops_it() {
    let mut engines = installed();
    let stop = spoken(&mut engines, "Stop!");
    drop(engines);
    let sound = microphone("real-stop", &[silence(4.0), stop, silence(60.0)].concat());
    let browser = Browser::start_speaking(&sound).unwrap();
    let play = Play::start(COHABIT, &["make_cereal", "--knows", "everything"]).unwrap();
    let mut tab = open(&browser, &play);
    tab.evaluate("document.querySelector('#open-mic').click()").unwrap();
    tab.evaluate("document.querySelector('#chat-input').focus()").unwrap();
    tab.type_and_enter("go to the main office, then to the reception, then to the warehouse and then to the lab")
        .unwrap();
    tab.wait_until("document.querySelector('#chat').innerText.includes('I stop')").unwrap();
    tab.wait_until("!window.cohabit.state.robot.busy").unwrap();
    // It was still on its way, however late a slow machine heard that.
    let arrived = tab.evaluate("/lab$/i.test(window.cohabit.state.robot.room ?? '')").unwrap();
    assert_eq!(arrived, json!(false));
    drop((tab, browser));
    play.end().unwrap();
    let _ = fs::remove_file(sound);
}
