//! What a rewriter reads of the world.

use crate::support::Talk;

fn surroundings(marks: &[&str]) -> String {
    let talk = Talk::new(marks);
    talk.language.surroundings(&talk.scene)
}

#[test]
fn a_room_and_what_is_in_it_are_told_in_a_few_lines() {
    let told = surroundings(&["held CoffeeMug_Boss_1", "CoffeeMug_Boss_1 coffee", "Microwave_01_1 open"]);
    let parts: Vec<&str> = told.split("; ").collect();
    assert!(parts[0].starts_with("break room with ") && parts[0].contains("sink"), "{told}");
    assert!(parts.contains(&"main office: trophy, record, hammer"), "{told}");
    assert!(parts.iter().any(|part| part.starts_with("round table: ") && part.contains("broken bowl")), "{told}");
    assert!(parts.contains(&"open microwave, off light switch"), "{told}");
    assert_eq!(parts.last(), Some(&"in my hand red mug with coffee"), "{told}");
}

#[test]
fn what_nobody_can_see_is_not_told() {
    let mut talk = Talk::new(&[]);
    for object in &mut talk.scene.objects {
        object.is_hidden = object.instance.starts_with("Apple");
    }
    let told = talk.language.surroundings(&talk.scene);
    assert!(!told.contains("apple") && told.contains("banana"), "{told}");
}
