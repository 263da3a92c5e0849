//! cohabit-agent
