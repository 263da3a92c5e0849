//! Tells the tests of this crate what of all needs is there.

#[path = "needs.rs"]
mod needs;

fn main() {
    needs::tell(&needs::ALL);
}
