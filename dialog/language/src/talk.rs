//! A turn of a conversation: an utterance, the scene and the conversation so far in, what the robot makes of it out. The only layer that
//! knows all others.

mod absent_room;
mod alike;
mod asked;
mod cache;
mod carry_out;
mod chosen;
mod condition;
pub(crate) mod conversation;
mod corrected;
mod decide;
pub(crate) mod evidence;
mod faithful;
mod follow;
mod heard;
mod hinted;
mod inquiry;
pub(crate) mod interpret;
mod later;
mod legs;
mod prior;
mod requests;
mod rewritten;
mod room_kind;
mod search;
mod small_talk;
pub(crate) mod spoken;
mod told;
mod understand;
mod waiting;
mod way;
mod wording;
mod yes_no;
