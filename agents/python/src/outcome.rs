//! What came of a command, as Python sees it.

use cohabit_cdf::Status;
use pyo3::prelude::*;

/// What came of a command.
#[pyclass(frozen, get_all, module = "cohabit._native")]
pub struct Outcome {
    /// The command's number.
    pub command: u64,
    /// The body.
    pub body: u32,
    /// One of `STATUSES`.
    pub status: String,
    /// Whether it did what was asked.
    pub success: bool,
    /// A sentence for people.
    pub detail: String,
}

impl Outcome {
    /// The outcome of a command of a body.
    pub fn new(command: u64, body: u32, status: Status, detail: &str) -> Self {
        let success = status.is_success();
        Self { command, body, status: format!("{status:?}"), success, detail: detail.to_owned() }
    }

    /// The same; or, of a command on something that nobody knows, that it was refused for this reason.
    pub fn or_unknown(self, unknown: Option<&str>) -> Self {
        match unknown.filter(|_| !self.success) {
            Some(why) => Self::new(self.command, self.body, Status::InvalidObjectClass, why),
            None => self,
        }
    }
}

#[pymethods]
impl Outcome {
    fn __bool__(&self) -> bool {
        self.success
    }

    fn __repr__(&self) -> String {
        format!("Outcome({}, {:?})", self.status, self.detail)
    }
}
