//! What whole-system tests are made of: a session in real processes, a client of its page, and a real browser.
//!
//! The system tests themselves are test targets of the `cohabit` package, since cargo tells only those where the
//! binary is.

mod browser;
mod page;
mod play;

pub use browser::{Browser, Tab};
pub use page::Page;
pub use play::{Play, reference_data, run};
