//! Turns around, and stands still while it sees a person.

use std::sync::atomic::AtomicBool;

use cohabit_agent::{Agent, Deed, Heard, Now, Senses};
use cohabit_bus::{Session, Shm};
use cohabit_cdf::{Action, SemanticClass};

struct Sentry;

impl Agent for Sentry {
    fn senses(&self) -> Senses {
        Senses { sight: true, state: false }
    }

    fn hear(&mut self, heard: &Heard<'_>, deeds: &mut Vec<Deed>) {
        let Heard::Now(Now { sight: Some(sight), .. }) = heard else { return };
        let sees_somebody = sight.things().any(|thing| thing.seen.class == SemanticClass::Person);
        let turn_rad_s = if sees_somebody { 0.0 } else { 0.5 };
        // For half a second, unless told again.
        let action = Action::Drive { forward_m_s: 0.0, turn_rad_s, pitch_rad_s: 0.0 };
        deeds.push(Deed::Act { turn: 0, action });
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let bus = Shm::join(&Session::new("with-sentry")?)?;
    // Body 1, until the flag is true, or Ctrl-C.
    cohabit_agent::run(&mut Sentry, 1, &bus, &AtomicBool::new(false))?;
    Ok(())
}
