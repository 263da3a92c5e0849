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

#[test]
fn all_that_is_not_optional_is_there_where_all_tests_have_to_run() {
    if std::env::var("COHABIT_TESTS").is_ok_and(|tests| tests == "all") {
        let found: Vec<&str> = env!("NEEDS_FOUND").split(',').collect();
        let lacks: Vec<&str> =
            needs::NEEDED.iter().map(|need| need.name).filter(|name| !found.contains(name)).collect();
        assert!(lacks.is_empty(), "tests were ignored for want of {lacks:?}: provide it, then touch tests/needs.rs");
    }
}
