//! Plots of sessions that are made up.

use super::*;
use crate::design::Conditions;

fn compared(participants: &[Option<&str>], levels: &[&str], values: &[Option<f64>], is_share: bool) -> Compared {
    let own: Vec<Conditions> = levels.iter().map(|level| [("ask".to_owned(), (*level).to_owned())].into()).collect();
    let names: Vec<String> = (0..levels.len()).map(|number| format!("s{number}")).collect();
    let participants = participants.iter().map(|name| name.map(str::to_owned)).zip(names.iter().map(String::as_str));
    let outcome = Outcome {
        name: "sus score".to_owned(),
        field: "score_sus & more".to_owned(),
        unit: "ms",
        meaning: "what <b> means".to_owned(),
        is_share,
        values: values.to_vec(),
    };
    Compared::of(own, participants.collect(), vec![outcome], &["ask".to_owned()]).unwrap()
}

#[test]
fn participants_are_joined_and_conditions_have_means() {
    let who = [Some("P1"), Some("P1"), Some("P2"), Some("P2"), Some("P3"), None];
    let levels = ["never", "<always>", "never", "<always>", "never", "never"];
    let values = [Some(10.0), Some(30.0), Some(12.0), Some(28.0), Some(11.0), None];
    let plots = all(&compared(&who, &levels, &values, false));
    assert_eq!(plots[0].file, "plot_score_sus___more.svg");
    let svg = &plots[0].svg;
    let count = |part: &str| svg.matches(part).count();
    assert_eq!((count("<circle"), count("<polyline"), count("<rect class=\"mean\"")), (5, 2, 2), "{svg}");
    assert!(svg.contains("&lt;always&gt;") && svg.contains("sus score (ms)") && svg.contains("what &lt;b&gt; means"));
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
}

#[test]
fn sessions_without_participants_are_points_alone() {
    let plots = all(&compared(&[None; 3], &["a", "a", "b"], &[Some(1.0), Some(0.0), Some(1.0)], true));
    let svg = &plots[0].svg;
    assert!(!svg.contains("<polyline") && svg.contains("points: sessions"), "{svg}");
    assert!(svg.contains(">0.5<") && svg.contains(">1<"), "{svg}");
    assert!(all(&compared(&[None; 2], &["a", "b"], &[None, None], false)).is_empty());
}
