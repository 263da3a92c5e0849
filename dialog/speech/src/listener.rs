//! When somebody speaks: turns of speech, cut out of sound that never ends.

use std::collections::VecDeque;

use crate::{
    RATE, SpeechError,
    audio::tame,
    vad::{Vad, WINDOW},
};

/// When a turn begins and ends. Times in seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turns {
    /// Speech is what is at least so likely speech, and goes on while it is at least [`Turns::goes_on`] likely.
    pub begins: f32,
    /// See [`Turns::begins`].
    pub goes_on: f32,
    /// So much speech makes a turn; less is a click, a cough.
    pub shortest_s: f32,
    /// What came before the speech was noticed belongs to it, for so long.
    pub before_s: f32,
    /// After so much silence it is asked whether the sentence is complete: what answers may take the time until the turn ends.
    pub asks_after_s: f32,
    /// So much silence ends a turn whose sentence is complete: as much as finding that out takes. Who makes such a pause in the
    /// middle of what they say goes on with it, where [`Turns::joins_s`] has them.
    pub complete_after_s: f32,
    /// So much silence ends any turn.
    pub incomplete_after_s: f32,
    /// Who speaks again so soon after a turn was told goes on with it; zero where each turn is one of its own.
    pub joins_s: f32,
    /// What was said so far is given so often.
    pub partial_every_s: f32,
    /// A longer turn is cut, and said to be.
    pub longest_s: f32,
}

impl Default for Turns {
    fn default() -> Self {
        Self {
            begins: 0.5,
            goes_on: 0.35,
            shortest_s: 0.12,
            before_s: 0.3,
            asks_after_s: 0.06,
            complete_after_s: 0.19,
            incomplete_after_s: 0.56,
            joins_s: 0.0,
            partial_every_s: 0.5,
            longest_s: 30.0,
        }
    }
}

/// Windows of silence after which what was said so far is given, if it is no longer than this, s.
const SOON: usize = 2;
const SHORT_S: f32 = 2.0;
/// It is not asked of longer turns whether they are complete, s: answers would take as long as they are.
const ASKED_S: f32 = 15.0;
/// Of a long turn, what was said so far is given whenever a quarter more was said: telling it costs as much as it is long.
const PARTIAL_SHARE: usize = 4;

impl Turns {
    /// How many more samples until what was said so far is given, in a turn of so many.
    fn until_partial(&self, length: usize) -> usize {
        samples(self.partial_every_s).max(length / PARTIAL_SHARE)
    }
}

/// What a listener has to say. Places are counted in samples from the first one that it was given.
#[derive(Clone, Debug, PartialEq)]
pub enum Turn {
    /// Somebody began to speak.
    Began {
        /// Where.
        began: u64,
    },
    /// They go on; from time to time.
    Partial {
        /// All they said so far.
        samples: Vec<f32>,
    },
    /// They are done.
    Ended {
        /// All they said.
        samples: Vec<f32>,
        /// Where the first of `samples` stands.
        began: u64,
        /// Where the speech ended: some silence before the turn did.
        ended: u64,
        /// Whether it was cut for its length; they speak on.
        is_cut: bool,
    },
}

/// Cuts turns of speech out of sound.
pub struct Listener {
    vad: Box<dyn Vad>,
    turns: Turns,
    /// Less than a window, that waits for the rest of it.
    pending: Vec<f32>,
    /// What came last before anybody speaks.
    before: VecDeque<f32>,
    position: u64,
    turn: Option<Open>,
    /// Whether a pause ends no turn.
    is_held: bool,
}

/// A turn that has not ended.
struct Open {
    samples: Vec<f32>,
    began: u64,
    /// Windows of speech in it.
    speech: usize,
    /// Windows since the last speech.
    silence: usize,
    /// How long it was when it was last given.
    given: usize,
    /// Whether the sentence is complete, if that was asked in this pause.
    is_complete: Option<bool>,
    /// Whether it was said that it began.
    is_told: bool,
}

impl Open {
    /// Whether enough more was said, or somebody pauses who said anything more: a word such as stop is to be known soon.
    fn is_worth_telling(&self, enough: usize) -> bool {
        let more = self.samples.len() - self.given;
        match self.silence {
            0 => more >= enough,
            SOON => more > SOON * WINDOW && self.samples.len() <= samples(SHORT_S),
            _ => false,
        }
    }

    /// Where the speech ended, within the samples.
    fn ended(&self) -> usize {
        self.samples.len() - self.silence * WINDOW
    }
}

impl Listener {
    /// A listener that has heard nothing.
    #[must_use]
    pub fn new(vad: Box<dyn Vad>, turns: Turns) -> Self {
        Self { vad, turns, pending: Vec::new(), before: VecDeque::new(), position: 0, turn: None, is_held: false }
    }

    /// How many samples it has listened to.
    #[must_use]
    pub fn position(&self) -> u64 {
        self.position
    }

    /// Whether somebody is speaking.
    #[must_use]
    pub fn is_in_turn(&self) -> bool {
        self.turn.as_ref().is_some_and(|turn| turn.is_told)
    }

    /// What voice activity is told by.
    #[must_use]
    pub fn vad(&self) -> &dyn Vad {
        &*self.vad
    }

    /// Takes samples at [`RATE`], any number of them; what is no number is silence.
    ///
    /// In each pause, after [`Turns::asks_after_s`], `is_complete` is asked once with all that was said so far; if it is, the turn
    /// ends after [`Turns::complete_after_s`].
    ///
    /// # Errors
    /// [`SpeechError::Engine`] if voice activity cannot be told, or what `is_complete` returns.
    pub fn push(
        &mut self,
        samples: &[f32],
        is_complete: &mut dyn FnMut(&[f32]) -> Result<bool, SpeechError>,
    ) -> Result<Vec<Turn>, SpeechError> {
        self.pending.extend(samples.iter().map(|sample| tame(*sample)));
        let mut turns = Vec::new();
        let pending = std::mem::take(&mut self.pending);
        let mut windows = pending.chunks_exact(WINDOW);
        for window in &mut windows {
            let window: &[f32; WINDOW] = window.try_into().expect("invariant: chunks are of this length");
            self.window(window, is_complete, &mut turns)?;
        }
        self.pending = windows.remainder().to_vec();
        Ok(turns)
    }

    /// No pause ends a turn until [`Listener::finish`], as where a key is held.
    pub fn hold(&mut self) {
        self.is_held = true;
    }

    /// Ends the turn at once, as where a key is released; none if nobody spoke.
    pub fn finish(&mut self) -> Option<Turn> {
        self.is_held = false;
        let turn = self.turn.take();
        self.vad.reset();
        self.before.clear();
        turn.filter(|turn| turn.is_told).map(|turn| Self::ended(turn, false))
    }

    /// Forgets what was said in an open turn, as where the microphone goes.
    pub fn reset(&mut self) {
        self.is_held = false;
        self.turn = None;
        self.pending.clear();
        self.before.clear();
        self.vad.reset();
    }

    fn window(
        &mut self,
        window: &[f32; WINDOW],
        is_complete: &mut dyn FnMut(&[f32]) -> Result<bool, SpeechError>,
        turns: &mut Vec<Turn>,
    ) -> Result<(), SpeechError> {
        let speech = self.vad.speech(window)?;
        self.position += WINDOW as u64;
        match &mut self.turn {
            None if speech >= self.turns.begins => self.begin(window),
            None => {
                self.before.extend(window);
                let surplus = self.before.len().saturating_sub(samples(self.turns.before_s));
                self.before.drain(..surplus);
                return Ok(());
            }
            Some(turn) => {
                turn.samples.extend(window);
                if speech >= self.turns.goes_on {
                    (turn.speech, turn.silence, turn.is_complete) = (turn.speech + 1, 0, None);
                } else {
                    turn.silence += 1;
                }
            }
        }
        self.judge(is_complete, turns)
    }

    fn begin(&mut self, window: &[f32; WINDOW]) {
        let mut samples: Vec<f32> = self.before.drain(..).collect();
        let began = self.position - WINDOW as u64 - samples.len() as u64;
        samples.extend(window);
        let turn = Open { samples, began, speech: 1, silence: 0, given: 0, is_complete: None, is_told: false };
        self.turn = Some(turn);
    }

    /// What there is to say of the open turn after one more window.
    fn judge(
        &mut self,
        is_complete: &mut dyn FnMut(&[f32]) -> Result<bool, SpeechError>,
        turns: &mut Vec<Turn>,
    ) -> Result<(), SpeechError> {
        let Some(turn) = &mut self.turn else { return Ok(()) };
        let silent = turn.silence * WINDOW;
        if !turn.is_told && turn.speech * WINDOW >= samples(self.turns.shortest_s) {
            turn.is_told = true;
            turns.push(Turn::Began { began: turn.began });
        }
        if !turn.is_told {
            if silent >= samples(self.turns.complete_after_s) {
                self.drop_turn();
            }
            return Ok(());
        }
        if turn.samples.len() >= samples(self.turns.longest_s) {
            self.end(true, turns);
            return Ok(());
        }
        if silent >= samples(self.turns.asks_after_s) && turn.is_complete.is_none() {
            let is_asked = turn.samples.len() <= samples(ASKED_S);
            turn.is_complete = Some(is_asked && is_complete(&turn.samples)?);
        }
        let is_complete = turn.is_complete == Some(true);
        let ends_after_s = if is_complete { self.turns.complete_after_s } else { self.turns.incomplete_after_s };
        if silent >= samples(ends_after_s) && !self.is_held {
            self.end(false, turns);
        } else if turn.is_worth_telling(self.turns.until_partial(turn.samples.len())) {
            turn.given = turn.samples.len();
            turns.push(Turn::Partial { samples: turn.samples.clone() });
        }
        Ok(())
    }

    fn end(&mut self, is_cut: bool, turns: &mut Vec<Turn>) {
        turns.extend(self.turn.take().map(|turn| Self::ended(turn, is_cut)));
        if !is_cut {
            self.vad.reset();
        }
    }

    fn ended(turn: Open, is_cut: bool) -> Turn {
        let ended = turn.began + turn.ended() as u64;
        Turn::Ended { began: turn.began, ended, samples: turn.samples, is_cut }
    }

    /// What was no turn comes before the next one.
    fn drop_turn(&mut self) {
        if let Some(turn) = self.turn.take() {
            let kept = turn.samples.len().min(samples(self.turns.before_s));
            self.before = turn.samples[turn.samples.len() - kept..].iter().copied().collect();
        }
    }
}

fn samples(seconds: f32) -> usize {
    (seconds * RATE as f32) as usize
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::fake::Loudness;

    const SPEECH: f32 = 0.5;

    fn sound(parts: &[(f32, f32)]) -> Vec<f32> {
        parts.iter().flat_map(|(level, seconds)| vec![*level; samples(*seconds)]).collect()
    }

    /// What is made of a sound, which comes in pieces, where every sentence is complete or none.
    fn turns_of(sound: &[f32], piece: usize, is_complete: bool) -> Vec<Turn> {
        let mut listener = Listener::new(Box::new(Loudness), Turns::default());
        sound.chunks(piece).flat_map(|piece| listener.push(piece, &mut |_| Ok(is_complete)).unwrap()).collect()
    }

    fn ends(turns: &[Turn]) -> Vec<(f32, f32, bool)> {
        let seconds = |place: u64| place as f32 / RATE as f32;
        let end = |turn: &Turn| match turn {
            Turn::Ended { began, ended, is_cut, .. } => Some((seconds(*began), seconds(*ended), *is_cut)),
            _ => None,
        };
        turns.iter().filter_map(end).collect()
    }

    #[test]
    fn a_turn_is_told_with_what_came_before_it() {
        let turns = turns_of(&sound(&[(0.0, 1.0), (SPEECH, 1.0), (0.0, 2.0)]), 160, false);
        assert!(matches!(turns[0], Turn::Began { .. }));
        assert!(turns.iter().any(|turn| matches!(turn, Turn::Partial { .. })));
        let [(began, ended, false)] = ends(&turns)[..] else { panic!("{turns:?}") };
        assert!((began - 0.7).abs() < 0.04 && (ended - 2.0).abs() < 0.04, "{began} {ended}");
        let Some(Turn::Ended { samples: said, .. }) = turns.last() else { panic!() };
        let expected_s = 0.3 + 1.0 + Turns::default().incomplete_after_s;
        assert!((said.len() as f32 / RATE as f32 - expected_s).abs() < 0.1, "{}", said.len());
    }

    #[test]
    fn the_size_of_pieces_makes_no_difference() {
        let sound = sound(&[(0.0, 0.5), (SPEECH, 1.2), (0.0, 0.3), (SPEECH, 0.7), (0.0, 2.0)]);
        let expected = turns_of(&sound, sound.len(), false);
        for piece in [1, 100, 512, 513, 16_000] {
            assert_eq!(turns_of(&sound, piece, false), expected, "pieces of {piece}");
        }
    }

    #[test]
    fn a_pause_ends_what_is_complete_alone() {
        let sound = sound(&[(SPEECH, 1.0), (0.0, 0.5), (SPEECH, 1.0), (0.0, 1.5)]);
        assert_eq!(ends(&turns_of(&sound, 160, true)).len(), 2);
        assert_eq!(ends(&turns_of(&sound, 160, false)).len(), 1);
    }

    #[test]
    fn it_is_asked_once_a_pause_whether_a_sentence_is_complete() {
        let mut asked = 0;
        let mut listener = Listener::new(Box::new(Loudness), Turns::default());
        let sound = sound(&[(SPEECH, 1.0), (0.0, 0.5), (SPEECH, 1.0), (0.0, 2.0)]);
        listener
            .push(&sound, &mut |_| {
                asked += 1;
                Ok(false)
            })
            .unwrap();
        assert_eq!(asked, 2);
    }

    #[test]
    fn a_long_story_is_not_asked_about_in_each_of_its_pauses() {
        let mut asked = 0;
        let mut listener = Listener::new(Box::new(Loudness), Turns::default());
        let story = sound(&[(SPEECH, 2.0), (0.0, 0.4)].repeat(10));
        listener
            .push(&story, &mut |_| {
                asked += 1;
                Ok(false)
            })
            .unwrap();
        assert_eq!(asked, 6);
    }

    #[test]
    fn a_click_is_no_turn_and_what_goes_on_for_ever_is_cut() {
        assert_eq!(turns_of(&sound(&[(0.0, 0.5), (SPEECH, 0.05), (0.0, 2.0)]), 160, true), []);
        let turns = turns_of(&sound(&[(SPEECH, 600.0), (0.0, 2.0)]), 16_000, true);
        let ends = ends(&turns);
        assert_eq!(ends.len(), 20, "{ends:?}");
        assert!(ends[..19].iter().all(|(began, ended, is_cut)| *is_cut && (ended - began - 30.0).abs() < 0.1));
        assert!(turns.len() < 20 * 25, "{} of them", turns.len());
    }

    #[test]
    fn while_it_is_held_pauses_end_nothing() {
        let mut listener = Listener::new(Box::new(Loudness), Turns::default());
        listener.hold();
        let sound = sound(&[(SPEECH, 1.0), (0.0, 3.0), (SPEECH, 1.0)]);
        assert_eq!(ends(&listener.push(&sound, &mut |_| Ok(true)).unwrap()), []);
        let Some(Turn::Ended { samples: said, .. }) = listener.finish() else { panic!() };
        assert!(said.len() > samples(4.9));
        assert_eq!(listener.finish(), None);
        assert_eq!(ends(&listener.push(&sound, &mut |_| Ok(true)).unwrap()).len(), 1);
    }

    #[test]
    fn what_is_no_sound_is_silence() {
        assert_eq!(turns_of(&[f32::NAN, f32::INFINITY, f32::NEG_INFINITY].repeat(16_000), 500, true), []);
        assert_eq!(turns_of(&[], 1, true), []);
    }
}
