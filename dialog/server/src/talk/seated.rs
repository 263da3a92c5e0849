//! Whether somebody sits at the wizard's seat: told on the bus, for the log and for whoever watches over the session.

use std::sync::Arc;

use cohabit_bus::message::{DialogKind, DialogMessage};

use super::{Talk, delivery::Delivery};
use crate::{DialogError, wizard::SeatState};

/// A wizard's page at the seat, while this lives.
pub struct Seated(Arc<Talk>);

impl Drop for Seated {
    fn drop(&mut self) {
        let mut delivery = self.0.delivery();
        let before = delivery.seat();
        delivery.wizards = delivery.wizards.saturating_sub(1);
        if let Err(error) = delivery.tell_of_seat(before) {
            tracing::error!("{error}");
        }
    }
}

impl Talk {
    /// A wizard's page is open from now on, until what this gives is dropped.
    pub fn sit_down(self: &Arc<Self>) -> Result<Seated, DialogError> {
        let mut delivery = self.delivery();
        let before = delivery.seat();
        delivery.wizards += 1;
        delivery.tell_of_seat(before)?;
        drop(delivery);
        Ok(Seated(Arc::clone(self)))
    }

    /// Tells that a wizard is waited for: where a service before this one had one, they have to come again.
    pub fn offer_seat(&self) -> Result<(), DialogError> {
        let mut delivery = self.delivery();
        let now = delivery.seat();
        delivery.publish(&told(now))
    }
}

impl Delivery {
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
