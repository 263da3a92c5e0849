//! cohabit-record
