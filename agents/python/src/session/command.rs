//! A command that was given in a session, and what comes of it.

use cohabit_bus::Wake;
use cohabit_cdf::Status;
use pyo3::{exceptions::PyTimeoutError, prelude::*};

use super::{Session, deadline, talk::lock};
use crate::outcome::Outcome;

/// A command that was given.
#[pyclass(frozen, module = "cohabit._native")]
pub struct Command {
    pub(super) session: Py<Session>,
    pub(super) number: u64,
    /// Why there is no object of the name that was given.
    pub(super) unknown: Option<String>,
}

#[pymethods]
impl Command {
    /// Its number in the session.
    #[getter]
    const fn number(&self) -> u64 {
        self.number
    }

    /// What came of it; waits up to `timeout` seconds, for ever if none is given. Raises `TimeoutError`.
    #[pyo3(signature = (timeout=None))]
    fn wait(&self, py: Python<'_>, timeout: Option<f64>) -> PyResult<Outcome> {
        let session = self.session.get();
        let end = session.wait_for(py, Wake::Talk, deadline(timeout)?, || {
            let mut talk = lock(&session.talk);
            talk.pump()?;
            Ok(talk.outcomes.get(&self.number).cloned().flatten())
        })?;
        let (status, detail) = end.ok_or_else(|| {
            let waited = timeout.unwrap_or_default();
            PyTimeoutError::new_err(format!("command {} has no outcome after {waited} s", self.number))
        })?;
        Ok(self.outcome(self.session.get().body(), status, &detail))
    }

    /// What came of it, if it has ended.
    fn poll(&self) -> PyResult<Option<Outcome>> {
        let session = self.session.get();
        let mut talk = lock(&session.talk);
        talk.pump()?;
        let end = talk.outcomes.get(&self.number).cloned().flatten();
        let body = talk.client.body();
        Ok(end.map(|(status, detail)| self.outcome(body, status, &detail)))
    }

    fn __repr__(&self) -> String {
        format!("Command({})", self.number)
    }
}

impl Command {
    fn outcome(&self, body: u32, status: Status, detail: &str) -> Outcome {
        Outcome::new(self.number, body, status, detail).or_unknown(self.unknown.as_deref())
    }
}

impl Drop for Command {
    fn drop(&mut self) {
        // Nobody can ask for it any more.
        lock(&self.session.get().talk).outcomes.remove(&self.number);
    }
}
