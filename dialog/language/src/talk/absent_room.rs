//! Plain requests that name a room which this floor plan lacks: who has read of offices alone takes a kitchen for a break room.

use cohabit_cdf::RoomId;

use crate::talk::{conversation::Conversation, source::Source};

/// What a request to go somewhere begins with.
const TRIP: [&str; 2] = ["go", "to"];
/// What stands before a room.
const IN: [&str; 2] = ["in", "the"];
/// How a question about a room begins, and how it is put about this one.
const WHAT_IS: [&str; 2] = ["what", "is"];
const THIS_ROOM: [&str; 3] = ["in", "this", "room?"];

impl Conversation<'_> {
    /// Plain requests with the room that was said instead of one that there is not; where none was said, without it.
    pub(crate) fn with_rooms_there(&self, text: &str, source: &Source) -> String {
        // `you are still in the kitchen, mun! the living room, please`: who names the room that it is in wants it elsewhere.
        let there = || source.rooms_said.iter().copied().filter(|room| self.scene.may_have_room(*room));
        let said = there().find(|room| *room != self.scene.robot.room).or_else(|| there().next());
        text.split("; ").filter_map(|request| self.with_room_there(request, said)).collect::<Vec<_>>().join("; ")
    }

    /// The same of one of them; nothing, where nothing is left.
    fn with_room_there(&self, request: &str, said: Option<RoomId>) -> Option<String> {
        let words: Vec<&str> = request.split(' ').collect();
        let Some((at, end)) = self.absent_room(&words) else { return Some(request.to_owned()) };
        let mark = if words[end - 1].ends_with('?') { "?" } else { "" };
        let (before, after) = (&words[..at], &words[end..]);
        if let Some(room) = said {
            let name = format!("{}{mark}", room.name_in(self.catalog).to_lowercase());
            return Some([before, &[name.as_str()], after].concat().join(" "));
        }
        let Some(asked) = before.strip_suffix(&IN) else {
            return (!before.starts_with(&TRIP)).then(|| request.to_owned());
        };
        match asked == WHAT_IS {
            true => Some([asked, &THIS_ROOM].concat().join(" ")),
            false => Some(format!("{}{mark}", [asked, after].concat().join(" "))),
        }
    }

    /// Where words name a room that there is not, and nothing else by it: `kitchen` of a kitchen chair is none.
    fn absent_room(&self, words: &[&str]) -> Option<(usize, usize)> {
        let bare: Vec<String> = words.iter().map(|word| word.trim_end_matches(['?', ',']).to_owned()).collect();
        (0..bare.len()).find_map(|at| {
            let (length, room) = self.lexicon.rooms.longest(&bare[at..])?;
            let named = self.lexicon.classes.longest(&bare[at..]).map_or(0, |(length, _)| length);
            (named <= length && !self.scene.may_have_room(*room)).then_some((at, at + length))
        })
    }
}
