//! cohabit-world
