//! `cargo bench -p cohabit-rewriter`: how long an utterance takes to rewrite.

use std::time::Instant;

fn main() {
    let begun = Instant::now();
    let rewriter = cohabit_rewriter::builtin();
    println!("{} {}, one thread", std::env::consts::ARCH, env!("CARGO_PKG_VERSION"));
    println!("loaded in {:.2} s", begun.elapsed().as_secs_f64());
    let before = [
        (false, "pick up the white mug on the counter, would you?".to_owned()),
        (true, "OK, picking up the mug. I have the mug.".to_owned()),
    ];
    let around = "break room with sink, couch, time machine, 6 stool, trash can, light switch, toaster, coffee maker; main office: yellow mug, hammer; small office: \
                  boss mug; robotics lab: laser tip, control panel; fridge: milk, 2 apple, can, sandwich; freezer: pie; drawer: spoon; counter top: mug, banana; \
                  wall cabinet: yellow mug, bowl; round table: dirty plate, donut; open microwave; in my hand";
    let hands = ["banana", "spoon", "mug", "donut", "apple", "bowl", "can"];
    for said in [
        "turn it on",
        "could you put it in the microwave for me please, it has gone cold",
        "Lovely. Pop the mug in there now, careful not to spill it, then shut the door and give it a blast till it's good and hot.",
    ] {
        let mut seconds: Vec<f64> = Vec::new();
        let mut written = String::new();
        for held in hands {
            let begun = Instant::now();
            written = rewriter
                .rewrite(said, &before, &format!("{around} {held}"))
                .first()
                .map(|one| one.text.clone())
                .unwrap_or_default();
            seconds.push(begun.elapsed().as_secs_f64());
        }
        seconds.sort_by(f64::total_cmp);
        println!("{:.0} ms: {said} => {written}", 1e3 * seconds[seconds.len() / 2]);
    }
}
