//! Seats of people who have a page each, at an address of its own: by its token the service knows whose page it is, and lets it drive
//! no avatar but theirs.

use std::io;

use cohabit_bus::message::BodyRecord;
use cohabit_cdf::BodyKind;
use serde::Serialize;

use crate::token;

/// The key of the first seat's page; that of the next one is one more. Keys that pages make up are smaller.
const FIRST_KEY: u64 = 1 << 63;

/// What a page with a seat may do.
#[derive(Clone, Copy, Debug, Eq, PartialEq, Serialize)]
pub struct PersonSeat {
    /// The avatar that it drives; none, where there are fewer avatars than seats.
    pub body: Option<u32>,
}

/// Whose page it is that comes.
#[derive(Clone, Copy, Debug)]
pub struct Comer {
    /// The key by which it is known when it comes again.
    pub key: u64,
    /// Its seat, if it has one.
    pub seat: Option<PersonSeat>,
}

/// The seats of a session.
#[derive(Clone, Debug, Default)]
pub struct PersonSeats(Vec<(String, PersonSeat)>);

impl PersonSeats {
    /// Seats behind these tokens, each with the avatar at its place in the order of all avatars.
    pub fn new(tokens: Vec<String>, bodies: &[BodyRecord]) -> Self {
        let people = bodies.iter().filter(|record| record.kind == BodyKind::Person as u32);
        let avatars = people.map(|record| Some(record.body)).chain(std::iter::repeat(None));
        Self(tokens.into_iter().zip(avatars).map(|(token, body)| (token, PersonSeat { body })).collect())
    }

    /// Fresh tokens for so many seats.
    ///
    /// # Errors
    /// When the system gives no chance.
    pub fn tokens(count: usize) -> io::Result<Vec<String>> {
        (0..count).map(|_| token::fresh()).collect()
    }

    /// The number of the seat with that token, from 0.
    pub fn find(&self, given: Option<&str>) -> Option<usize> {
        self.0.iter().position(|(token, _)| token::admits(token, given))
    }

    /// The page of a seat: the same person, however often it is opened.
    pub fn comer(&self, number: usize) -> Comer {
        Comer { key: FIRST_KEY + number as u64, seat: self.0.get(number).map(|(_, seat)| *seat) }
    }

    /// Somebody whose page made up its key.
    pub const fn stranger(key: u64) -> Comer {
        Comer { key: key & (FIRST_KEY - 1), seat: None }
    }

    /// All seats, with their tokens.
    pub fn all(&self) -> impl Iterator<Item = (&str, PersonSeat)> {
        self.0.iter().map(|(token, seat)| (token.as_str(), *seat))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn seats_have_the_avatars_in_their_order() {
        let kinds = [BodyKind::Robot, BodyKind::Person, BodyKind::Robot, BodyKind::Person];
        let bodies =
            (0..).zip(kinds).map(|(body, kind)| BodyRecord { body, kind: kind as u32, ..BodyRecord::default() });
        let bodies: Vec<BodyRecord> = bodies.collect();
        let tokens = PersonSeats::tokens(3).unwrap();
        let seats = PersonSeats::new(tokens.clone(), &bodies);
        let avatars: Vec<_> = seats.all().map(|(_, seat)| seat.body).collect();
        assert_eq!(avatars, [Some(1), Some(3), None]);
        assert_eq!((seats.find(Some(&tokens[1])), seats.find(Some("x")), seats.find(None)), (Some(1), None, None));
        assert_ne!(seats.comer(0).key, seats.comer(1).key);
        assert_eq!(seats.comer(1).seat, Some(PersonSeat { body: Some(3) }));
        // Nobody takes a seat by its key.
        assert_ne!(PersonSeats::stranger(seats.comer(0).key).key, seats.comer(0).key);
        assert_eq!(PersonSeats::stranger(17).key, 17);
    }
}
