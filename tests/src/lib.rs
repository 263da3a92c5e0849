//! cohabit-tests
