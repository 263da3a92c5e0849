use crate::support::Talk;

fn run(marks: &[&str], said: &[&str]) {
    let mut talk = Talk::new(marks);
    for said in said {
        let found = talk.say_and_do(said);
        eprintln!("> {said}\n   {found}");
    }
}

#[test]
fn tmp_people() {
    let cereal = &["plan OfficeLayout1 BreakRoom", "add Bowl_01 on TableRound_02", "Bowl_01 broken", "add Cereal_Box_01 on KitchenCounterTop_02"];
    run(cereal, &["is the time machine the time machine?", "is that purple thing the time machine?", "pick up the bowl", "Ooh, is that big purple thing with the clock on top the time machine, do you think?",
      "put the bowl in the time machine and close it and turn it on", "Has it worked, love? Is the bowl all in one piece?",
      "Right, get it out of there and put it back on the table, and then we'll see about the cereal."]);
    run(&["plan OfficeLayout1 BreakRoom", "add BreadLoaf on TableRound_02", "add Knife_01 on KitchenCounterTop_02"], &["cut the bread", "slice the loaf with the knife", "is the bread cut?", "cut the table"]);
    run(&["plan OfficeLayout1 BreakRoom", "add CanSodaNew_01 on TableRound_02"], &[
      "put the soda on the blue shelf", "go to the blue computer", "is that the blue one", "is that the blue computer?", "is it the blue one?", "is it blue", "is it blue though", "i said is it blue tho", "is it red?",
      "aight whatever hit the button on the computer and blast that soda",
      "pick up the soda", "bruh no why did u pick it up put it back then go fire the freeze ray", "fire the freeze ray again", "where is the soda?"]);
}
