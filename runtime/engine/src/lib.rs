//! cohabit-engine
