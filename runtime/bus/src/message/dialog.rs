//! What people and robots say to each other, and the plans that come of it.

use bytemuck::{Pod, Zeroable};
use cohabit_cdf::Status;

use super::{ActionRecord, Malformed, layout};
use crate::text::Text;

/// What a dialog message is.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
#[repr(u32)]
pub enum DialogKind {
    /// A person said something.
    Utterance = 1,
    /// The robot says something.
    Reply = 2,
    /// The robot asks something, and waits for an answer; the steps that follow are answers that it offers.
    Question = 3,
    /// What the robot is to do about a turn: steps follow. A new plan ends the one before.
    Plan = 4,
    /// A step of a plan begins: `step`.
    StepStarted = 5,
    /// A step of a plan ended: `step`, `status`, and the world's sentence.
    StepEnded = 6,
    /// A plan ended, done or not: `status` of its last step.
    PlanEnded = 7,
    /// How long the turn took, in `stamps`: for logs.
    Latency = 8,
    /// How a turn was spoken: for logs. `stamps` are of other moments: speech began, speech ended, its text was there,
    /// understood, first sound of the answer. The text is what was heard, before it was made sense of.
    Spoken = 9,
    /// What an interpreter such as a language model said about a turn, and how long it took: for logs.
    Interpreted = 10,
    /// What a wizard decided about a turn, as JSON: for logs.
    Decided = 11,
    /// Whether somebody sits at the wizard's seat, as one word: `taken` or `empty`.
    Seat = 12,
    /// What the robot's face shows from now on, as one word.
    Expressed = 13,
    /// Somebody at a page pointed at a thing in the picture: `person`, and what it is called: for logs.
    Pointed = 14,
}

impl DialogKind {
    /// All kinds.
    pub const ALL: [Self; 14] = [
        Self::Utterance,
        Self::Reply,
        Self::Question,
        Self::Plan,
        Self::StepStarted,
        Self::StepEnded,
        Self::PlanEnded,
        Self::Latency,
        Self::Spoken,
        Self::Interpreted,
        Self::Decided,
        Self::Seat,
        Self::Expressed,
        Self::Pointed,
    ];
}

/// What stands before a dialog message's steps.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct DialogHeader {
    /// `DialogKind`.
    kind: u32,
    /// The body spoken to, or speaking.
    pub body: u32,
    /// The turn: counts utterances in the session, from 1; 0 is none.
    pub turn: u64,
    /// Which step of the turn's plan.
    pub step: u32,
    /// `Status` of the step.
    status: u32,
    /// Steps that follow.
    pub steps: u32,
    /// The number of the page at which a person said it; 0 where none did.
    pub person: u32,
    /// [`monotonic_nanos`](crate::monotonic_nanos) of: text received, understood, first motion, first changed frame,
    /// that frame shown by a page; 0 where it did not happen (yet). Of [`DialogKind::Spoken`], of other moments.
    pub stamps: [u64; 5],
    /// What is said.
    pub text: Text<8006>,
}

/// One step of a plan; or an answer that a question offers, which is to look at an object, or to say something.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct PlanStep {
    /// What to do.
    pub action: ActionRecord,
    /// In people's words, such as "opening the fridge".
    pub says: Text<126>,
}

/// A dialog message to send.
#[derive(Clone, Debug, PartialEq)]
pub struct DialogMessage {
    /// All but the steps.
    pub header: DialogHeader,
    /// The steps of a plan, or the answers of a question.
    pub steps: Vec<PlanStep>,
}

/// The most steps a plan may have.
const MAX_STEPS: usize = 256;

impl DialogMessage {
    /// A message of that kind about a turn.
    #[must_use]
    pub fn new(kind: DialogKind, body: u32, turn: u64, text: &str) -> Self {
        let text = Text::new(text);
        let header = DialogHeader { kind: kind as u32, body, turn, text, ..DialogHeader::zeroed() };
        Self { header, steps: Vec::new() }
    }

    /// The same with a step's number and how it went.
    #[must_use]
    pub const fn at_step(mut self, step: u32, status: Status) -> Self {
        self.header.step = step;
        self.header.status = status as u32;
        self
    }

    /// Bytes of the payload.
    #[must_use]
    pub fn bytes(&self) -> usize {
        layout::space::<DialogHeader>(1) + layout::space::<PlanStep>(self.steps.len().min(MAX_STEPS))
    }

    /// Writes the payload.
    ///
    /// # Panics
    /// When `payload` is shorter than [`Self::bytes`].
    pub fn write(&self, payload: &mut [u8]) {
        let steps = &self.steps[..self.steps.len().min(MAX_STEPS)];
        let mut writer = layout::Writer::new(payload);
        writer.put(&[DialogHeader { steps: u32::try_from(steps.len()).unwrap_or(0), ..self.header }]);
        writer.put(steps);
    }
}

/// A dialog message as received.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DialogView<'a> {
    /// All but the steps.
    pub header: &'a DialogHeader,
    /// The steps of a plan, or the answers of a question.
    pub steps: &'a [PlanStep],
}

impl<'a> DialogView<'a> {
    /// Views a payload in place.
    ///
    /// # Errors
    /// [`Malformed`].
    pub fn new(payload: &'a [u8]) -> Result<Self, Malformed> {
        let mut reader = layout::Reader::new(payload);
        let header: &DialogHeader = reader.one()?;
        Ok(Self { header, steps: reader.take(header.steps)? })
    }
}

impl DialogHeader {
    /// What it is; `None` if a peer wrote a kind that does not exist.
    #[must_use]
    pub fn kind(&self) -> Option<DialogKind> {
        DialogKind::ALL.into_iter().find(|kind| *kind as u32 == self.kind)
    }

    /// How the step went.
    #[must_use]
    pub fn status(&self) -> Option<Status> {
        Status::ALL.get(self.status as usize).copied()
    }
}
