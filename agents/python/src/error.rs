//! What Python is told when something fails.

use std::fmt::Display;

use pyo3::{PyErr, create_exception, exceptions::PyException};

create_exception!(
    cohabit,
    Error,
    PyException,
    "Something failed that is not the fault of an argument: a session that is not there, a bus that is full."
);

/// What went wrong, as an [`Error`].
pub fn failed(error: impl Display) -> PyErr {
    Error::new_err(error.to_string())
}

/// An argument is not one, as a `ValueError`.
pub fn bad_argument(error: impl Display) -> PyErr {
    pyo3::exceptions::PyValueError::new_err(error.to_string())
}
