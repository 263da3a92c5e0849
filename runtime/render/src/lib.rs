//! cohabit-render
