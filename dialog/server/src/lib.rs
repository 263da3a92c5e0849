//! cohabit-dialog
