//! The newest state of the world, as somebody keeps it who looks at it now and again.

use std::time::Duration;

use cohabit_bus::{
    Inbox, Sample, Topic, Transport, Wake,
    message::{BodyRecord, StateView},
};

use crate::DialogError;

/// How long a state is waited for before it is seen whether the wait is over.
const LOOKS_EVERY: Duration = Duration::from_millis(20);

/// The newest state that was published.
pub struct NewestState {
    states: Inbox,
    newest: Option<Sample>,
}

impl NewestState {
    /// None yet: it comes with [`Self::refresh`].
    pub fn new(bus: &dyn Transport) -> Result<Self, DialogError> {
        Ok(Self { states: Inbox::new(bus, Topic::State)?, newest: None })
    }

    /// Takes in what was published since.
    pub fn refresh(&mut self) -> Result<(), DialogError> {
        while let Some((sample, ())) = self.states.next(|sample| StateView::new(sample.payload()).map(drop))? {
            self.newest = Some(sample);
        }
        Ok(())
    }

    /// The state; nothing before the first.
    pub fn view(&self) -> Result<Option<StateView<'_>>, DialogError> {
        Ok(self.newest.as_ref().map(|sample| StateView::new(sample.payload())).transpose()?)
    }

    /// Its tick; 0 before the first.
    pub fn tick(&self) -> u64 {
        self.newest.as_ref().map_or(0, |sample| sample.envelope().tick)
    }

    /// Waits for the first state, or until `over`.
    pub fn wait(&mut self, bus: &dyn Transport, over: &dyn Fn() -> bool) -> Result<(), DialogError> {
        let mut listener = bus.listener(Wake::State)?;
        while !over() {
            self.refresh()?;
            if self.newest.is_some() {
                break;
            }
            listener.wait(LOOKS_EVERY)?;
        }
        Ok(())
    }
}

/// Waits until the world can be seen, or until `over`; gives the bodies in it.
pub fn wait_for_world(bus: &dyn Transport, over: &dyn Fn() -> bool) -> Result<Vec<BodyRecord>, DialogError> {
    let mut state = NewestState::new(bus)?;
    state.wait(bus, over)?;
    Ok(state.view()?.map(|state| state.bodies.to_vec()).unwrap_or_default())
}
