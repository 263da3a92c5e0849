//! Whether somebody sits at the wizard's seat: told on the bus, for the log and for whoever watches over the session.

use std::sync::Arc;

use cohabit_bus::message::{DialogKind, DialogMessage};

use super::{Inner, Talk};
use crate::{DialogError, wizard::SeatState};

/// A wizard's page at the seat, while this lives.
pub struct Seated(Arc<Talk>);

impl Drop for Seated {
    fn drop(&mut self) {
        let mut inner = self.0.lock();
        let before = inner.seat();
        inner.wizards = inner.wizards.saturating_sub(1);
        if let Err(error) = inner.tell_of_seat(before) {
            tracing::error!("{error}");
        }
    }
}

impl Talk {
    /// A wizard's page is open from now on, until what this gives is dropped.
    pub fn sit_down(self: &Arc<Self>) -> Result<Seated, DialogError> {
        let mut inner = self.lock();
        let before = inner.seat();
        inner.wizards += 1;
        inner.tell_of_seat(before)?;
        drop(inner);
        Ok(Seated(Arc::clone(self)))
    }

    /// Tells that a wizard is waited for: where a service before this one had one, they have to come again.
    pub fn offer_seat(&self) -> Result<(), DialogError> {
        let mut inner = self.lock();
        let now = inner.seat();
        inner.publish(&told(now))
    }
}

impl Inner {
    fn seat(&self) -> SeatState {
        if self.wizards == 0 { SeatState::Empty } else { SeatState::Taken }
    }

    /// Tells how the seat is, if it was otherwise before.
    fn tell_of_seat(&mut self, before: SeatState) -> Result<(), DialogError> {
        let now = self.seat();
        if now == before { Ok(()) } else { self.publish(&told(now)) }
    }
}

fn told(seat: SeatState) -> DialogMessage {
    DialogMessage::new(DialogKind::Seat, 0, 0, seat.name())
}
