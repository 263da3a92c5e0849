//! cohabit-language
