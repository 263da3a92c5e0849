//! What the records of a log say, in their order.

use std::collections::BTreeMap;

use mcap::records::Record;
use serde::de::DeserializeOwned;

use crate::{
    channels::{CHANNELS, SNAPSHOTS},
    entry::{AnswerEntry, DialogEntry, Entry, EventEntry, GapEntry, SessionEntry, TickEntry},
    snapshot::Snapshot,
};

/// What was read so far.
#[derive(Default)]
pub(crate) struct Reading {
    pub session: Option<SessionEntry>,
    pub ticks: Vec<TickEntry>,
    pub events: Vec<EventEntry>,
    pub dialog: Vec<DialogEntry>,
    pub answers: Vec<AnswerEntry>,
    pub snapshots: Vec<Snapshot>,
    pub gaps: Vec<GapEntry>,
    channels: BTreeMap<u16, String>,
}

impl Reading {
    /// Takes a record in.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn take(&mut self, record: &Record<'_>) -> Result<(), String> {
        match record {
            Record::Channel(channel) => {
                self.channels.insert(channel.id, channel.topic.clone());
            }
            Record::Message { header, data } => match self.topic(header.channel_id) {
                Some(SessionEntry::TOPIC) if self.session.is_some() => {}
                Some(SessionEntry::TOPIC) => self.session = Some(decode(data)?),
                Some(TickEntry::TOPIC) => {
                    self.ticks.push(TickEntry { wall_nanos: header.log_time, ..decode(data)? });
                }
                Some(EventEntry::TOPIC) => self.events.push(decode(data)?),
                Some(DialogEntry::TOPIC) => self.take_dialog(decode(data)?),
                Some(AnswerEntry::TOPIC) => self.answers.push(decode(data)?),
                Some(GapEntry::TOPIC) => self.gaps.push(decode(data)?),
                Some(SNAPSHOTS) => self.snapshots.push(Snapshot::read(data).ok_or("a snapshot is too short")?),
                // A newer program may have written it.
                Some(_) => {}
                None => return Err(format!("channel {} is not known", header.channel_id)),
            },
            _ => {}
        }
        Ok(())
    }

    /// The topic of a channel; where the records of channels are lost, by its number.
    fn topic(&self, channel: u16) -> Option<&str> {
        if self.knows_channels() {
            return self.channels.get(&channel).map(String::as_str);
        }
        // Frames and sound follow, which are not read here.
        Some(CHANNELS.get(usize::from(channel).checked_sub(1)?).copied().unwrap_or_default())
    }

    /// Whether there was a record of a channel.
    pub fn knows_channels(&self) -> bool {
        !self.channels.is_empty()
    }

    /// What was said belongs to the newest tick, where that was not noted.
    fn take_dialog(&mut self, mut entry: DialogEntry) {
        if entry.tick == 0 {
            entry.tick = self.newest_tick();
        }
        self.dialog.push(entry);
    }

    /// The newest tick; 0 before the first.
    pub fn newest_tick(&self) -> u64 {
        self.ticks.last().map_or(0, |entry| entry.tick)
    }
}

fn decode<T: DeserializeOwned>(data: &[u8]) -> Result<T, String> {
    serde_json::from_slice(data).map_err(|error| error.to_string())
}

/// Why a file that another program wrote is none of ours.
pub(crate) fn library(found: &str) -> String {
    format!("`{found}` wrote it, not this program")
}
