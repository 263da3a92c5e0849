//! Plots of outcomes by condition, as SVG that any browser and text program shows.
//!
//! A plot has a point for each participant in each combination of conditions (their mean there), thin lines that join the points
//! of one participant, and beside them the mean with its 95 % interval. Where no participant has several sessions, points are
//! sessions. It is 640 wide, and its text is large enough to read at that many pixels.

mod scale;
mod svg;

use std::collections::BTreeMap;

use crate::{
    played::Played,
    summary::{
        SummaryError,
        compared::{Compared, Group, mean},
        interval_95,
        outcomes::Outcome,
    },
};
use scale::Scale;
use svg::{Anchor, Svg};

/// A plot.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    /// The name of its file: `plot_questions.svg`.
    pub file: String,
    /// What the file holds.
    pub svg: String,
}

/// A plot of each outcome by these conditions, as [`Summary::new`](crate::Summary::new) takes them. None where sessions differ
/// in no condition.
///
/// # Errors
/// [`SummaryError::Unknown`].
pub fn plots(played: &[Played], by: &[String]) -> Result<Vec<Plot>, SummaryError> {
    Ok(all(&Compared::new(played, by)?.between_first()))
}

fn all(compared: &Compared) -> Vec<Plot> {
    if compared.conditions.is_empty() {
        return Vec::new();
    }
    let plot = |outcome| Some(Plot { file: file(outcome), svg: Chart::new(compared, outcome)?.svg() });
    compared.outcomes.iter().filter_map(plot).collect()
}

/// A questionnaire may be called by anything.
fn file(outcome: &Outcome) -> String {
    let plain = |character: char| if character.is_alphanumeric() || character == '-' { character } else { '_' };
    format!("plot_{}.svg", outcome.field.chars().map(plain).collect::<String>())
}

/// What a plot shows.
struct Chart<'a> {
    outcome: &'a Outcome,
    /// The names of the conditions.
    conditions: String,
    places: Vec<Place>,
    /// Participants by number, and how many there are.
    participants: usize,
    is_repeated: bool,
    scale: Scale,
}

/// What stands at one place of the horizontal axis.
struct Place {
    /// The level of each condition.
    levels: Vec<String>,
    /// Participants, by number, and their means.
    points: Vec<(usize, f64)>,
    mean: Option<f64>,
    interval_95: Option<[f64; 2]>,
}

const WIDTH: f64 = 640.0;
const LEFT: f64 = 76.0;
const RIGHT: f64 = 12.0;
const TOP: f64 = 60.0;
const HEIGHT: f64 = 280.0;
/// From the axis to the first line of its labels, and from line to line.
const LINE: f64 = 18.0;
/// Sizes of text.
const TITLE: f64 = 17.0;
const TEXT: f64 = 14.0;
/// How wide a character of [`TEXT`] is on average.
const CHARACTER: f64 = 7.4;
/// Characters of a label that is slanted because the places are too close for it, and its slope in degrees.
const SLANTED: usize = 20;
const SLOPE: f64 = -50.0;
/// How far points are to the left of their place, and the mean to the right, as shares of the distance of places.
const POINTS: f64 = -0.12;
const MEAN: f64 = 0.2;
/// How far apart the points of a place are at most, as that share: so points of one value show as several.
const SPREAD: f64 = 0.3;

impl<'a> Chart<'a> {
    fn new(compared: &Compared, outcome: &'a Outcome) -> Option<Self> {
        let everybody: Vec<usize> = (0..compared.len()).collect();
        let values = compared.values(outcome, &everybody);
        let number: BTreeMap<&str, usize> = values.keys().copied().zip(0..).collect();
        let place = |group: Group| {
            let own = compared.values(outcome, &group.members);
            let points: Vec<(usize, f64)> = own.iter().map(|(who, values)| (number[who], mean(values))).collect();
            let means: Vec<f64> = points.iter().map(|(_, value)| *value).collect();
            let is_single = own.values().all(|values| values.len() == 1);
            Place {
                levels: compared.conditions.iter().map(|name| group.conditions[name].clone()).collect(),
                mean: (!means.is_empty()).then(|| mean(&means)),
                interval_95: interval_95(outcome, &means, is_single),
                points,
            }
        };
        let places: Vec<Place> = compared.groups().into_iter().map(place).collect();
        let shown = places.iter().flat_map(|place| {
            place.points.iter().map(|(_, value)| *value).chain(place.interval_95.into_iter().flatten())
        });
        let scale = if outcome.is_share { Some(Scale::SHARE) } else { Scale::of(shown) }?;
        Some(Self {
            outcome,
            conditions: compared.conditions.join(", "),
            places,
            participants: number.len(),
            is_repeated: compared.is_repeated,
            scale,
        })
        .filter(|chart| chart.participants > 0)
    }

    fn svg(&self) -> String {
        let below = TOP + HEIGHT + LINE + self.labels_height();
        let mut svg = Svg::new([WIDTH, below + 2.4 * LINE], &self.outcome.name, &self.described());
        svg.text([LEFT, 24.0], TITLE, Anchor::Start, &self.outcome.name);
        svg.text(
            [LEFT, 44.0],
            TEXT - 1.0,
            Anchor::Start,
            &shortened(&self.outcome.meaning, (WIDTH - LEFT) / CHARACTER),
        );
        self.draw_axes(&mut svg);
        self.draw_lines(&mut svg);
        self.draw_points(&mut svg);
        self.draw_means(&mut svg);
        svg.text([f64::midpoint(LEFT, WIDTH - RIGHT), below + 4.0], TEXT, Anchor::Middle, &self.conditions);
        svg.text([LEFT, below + LINE + 10.0], TEXT - 1.0, Anchor::Start, &self.legend());
        svg.finish()
    }

    fn legend(&self) -> String {
        let points = if self.is_repeated { "points and lines: participants" } else { "points: sessions" };
        format!("{points}; square and bar: mean, 95 % interval")
    }

    /// The numbers of the plot in words, for who does not see it.
    fn described(&self) -> String {
        let place = |place: &Place| {
            let levels = place.levels.join(", ");
            match (place.mean, place.interval_95) {
                (Some(mean), Some([low, high])) => format!("{levels}: {mean:.3} ({low:.3} to {high:.3})"),
                (Some(mean), None) => format!("{levels}: {mean:.3}"),
                (None, _) => format!("{levels}: none"),
            }
        };
        let places: Vec<String> = self.places.iter().map(place).collect();
        format!("{} by {}; means and 95 % intervals: {}", self.y_label(), self.conditions, places.join("; "))
    }

    fn y_label(&self) -> String {
        let Outcome { name, unit, .. } = self.outcome;
        if unit.is_empty() { name.clone() } else { format!("{name} ({unit})") }
    }

    /// The distance of places.
    fn step(&self) -> f64 {
        (WIDTH - LEFT - RIGHT) / self.places.len() as f64
    }

    fn x(&self, place: usize, share: f64) -> f64 {
        LEFT + self.step() * (place as f64 + 0.5 + share)
    }

    fn y(&self, value: f64) -> f64 {
        TOP + HEIGHT * (1.0 - self.scale.share(value))
    }

    /// Where a participant's point is: at each place equally far to the side.
    fn point(&self, place: usize, (participant, value): (usize, f64)) -> [f64; 2] {
        let side = (participant as f64 + 0.5) / self.participants as f64 - 0.5;
        [self.x(place, POINTS + SPREAD * side), self.y(value)]
    }

    fn draw_axes(&self, svg: &mut Svg) {
        for (value, label) in self.scale.ticks() {
            let y = self.y(value);
            svg.line("grid", [LEFT, y], [WIDTH - RIGHT, y]);
            svg.text([LEFT - 8.0, y + TEXT / 3.0], TEXT, Anchor::End, &label);
        }
        svg.line("axis", [LEFT, TOP], [LEFT, TOP + HEIGHT]);
        svg.line("axis", [LEFT, TOP + HEIGHT], [WIDTH - RIGHT, TOP + HEIGHT]);
        svg.turned_text([18.0, TOP + HEIGHT / 2.0], -90.0, TEXT, Anchor::Middle, &self.y_label());
        (0..self.places.len()).for_each(|number| self.draw_label(svg, number));
    }

    /// Whether some level is too long to stand below its place.
    fn is_crowded(&self) -> bool {
        let widest = self.places.iter().flat_map(|place| &place.levels).map(|level| level.chars().count()).max();
        widest.unwrap_or(0) as f64 * CHARACTER > self.step()
    }

    fn labels_height(&self) -> f64 {
        let lines = self.places.first().map_or(1, |place| place.levels.len()) as f64;
        let longest = self.places.iter().map(|place| place.levels.join(", ").chars().count().min(SLANTED)).max();
        let slanted = longest.unwrap_or(0) as f64 * CHARACTER * SLOPE.to_radians().sin().abs();
        if self.is_crowded() { slanted + LINE } else { lines * LINE }
    }

    /// The levels of a place, line by line, or slanted in one line.
    fn draw_label(&self, svg: &mut Svg, number: usize) {
        let (levels, x, y) = (&self.places[number].levels, self.x(number, 0.0), TOP + HEIGHT + LINE);
        if self.is_crowded() {
            svg.turned_text(
                [x, y - LINE / 4.0],
                SLOPE,
                TEXT,
                Anchor::End,
                &shortened(&levels.join(", "), SLANTED as f64),
            );
            return;
        }
        for (line, level) in levels.iter().enumerate() {
            svg.text([x, y + LINE * line as f64], TEXT, Anchor::Middle, level);
        }
    }

    /// Lines from each point to the participant's next one.
    fn draw_lines(&self, svg: &mut Svg) {
        for participant in 0..self.participants {
            let own = |(number, place): (usize, &Place)| {
                let point = place.points.iter().find(|(who, _)| *who == participant)?;
                Some(self.point(number, *point))
            };
            let points: Vec<[f64; 2]> = self.places.iter().enumerate().filter_map(own).collect();
            if points.len() > 1 {
                svg.polyline("participant", &points);
            }
        }
    }

    fn draw_points(&self, svg: &mut Svg) {
        for (number, place) in self.places.iter().enumerate() {
            place.points.iter().for_each(|point| svg.circle("point", self.point(number, *point), 3.5));
        }
    }

    fn draw_means(&self, svg: &mut Svg) {
        for (number, place) in self.places.iter().enumerate() {
            let x = self.x(number, MEAN);
            if let Some(limits) = place.interval_95 {
                let [low, high] = limits.map(|limit| self.y(limit));
                svg.line("mean", [x, low], [x, high]);
                [low, high].into_iter().for_each(|y| svg.line("mean", [x - 6.0, y], [x + 6.0, y]));
            }
            if let Some(mean) = place.mean {
                svg.square("mean", [x, self.y(mean)], 9.0);
            }
        }
    }
}

/// Text of no more than so many characters.
fn shortened(text: &str, most: f64) -> String {
    let most = most as usize;
    if text.chars().count() <= most {
        return text.to_owned();
    }
    text.chars().take(most - 1).chain(['…']).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;
