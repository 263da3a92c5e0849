//! What was absent when the tests were built is still absent: otherwise tests that could run are reported as ignored.

#[path = "needs.rs"]
mod needs;

#[test]
fn what_was_absent_when_the_tests_were_built_still_is() {
    let found: Vec<&str> = env!("NEEDS_FOUND").split(',').collect();
    let came: Vec<&str> = needs::ALL.iter().filter(|need| !(need.find)().is_empty()).map(|need| need.name).collect();
    let missed: Vec<&&str> = came.iter().filter(|name| !found.contains(name)).collect();
    assert!(
        missed.is_empty(),
        "{missed:?} were not there when the tests were built, and are now: touch tests/needs.rs"
    );
}
