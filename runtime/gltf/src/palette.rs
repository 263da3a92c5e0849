//! Few colours instead of many: those that differ the least become one, by how much of the surface they cover.

use std::collections::BTreeMap;

/// Colours are told apart by so many steps of each channel before they are gathered.
const STEPS: f32 = 31.0;
/// Colours nearer to each other than this look alike, in Oklab.
const ALIKE: f32 = 0.025;
/// How often the middles are moved.
const ROUNDS: usize = 16;
/// Words for colours that people use, with a colour that each means, `[red, green, blue]`.
const WORDS: [(&str, [u8; 3]); 16] = [
    ("white", [240, 240, 238]),
    ("grey", [140, 142, 145]),
    ("dark grey", [75, 77, 80]),
    ("black", [28, 28, 30]),
    ("red", [196, 44, 40]),
    ("orange", [232, 128, 40]),
    ("yellow", [236, 205, 66]),
    ("green", [66, 146, 70]),
    ("teal", [40, 140, 140]),
    ("light blue", [140, 190, 230]),
    ("blue", [48, 92, 180]),
    ("purple", [120, 70, 160]),
    ("pink", [232, 150, 178]),
    ("brown", [112, 72, 42]),
    ("light brown", [176, 130, 86]),
    ("beige", [220, 205, 172]),
];

/// A colour in Oklab (Ottosson 2020), where distances are as large as they look.
type Lab = [f32; 3];

struct Cell {
    lab: Lab,
    /// Sum of linear light by area.
    light: [f64; 3],
    area: f64,
}

/// The colours, at most `most`, and which of them each face has; `faces` are linear light and area.
pub(crate) fn reduce(faces: &[([f32; 3], f32)], most: usize) -> (Vec<[u8; 3]>, Vec<usize>) {
    let mut cells: Vec<Cell> = Vec::new();
    let mut known: BTreeMap<[u16; 3], usize> = BTreeMap::new();
    let mut cell_of = Vec::with_capacity(faces.len());
    for (light, area) in faces {
        let key = light.map(|channel| (srgb(channel) * STEPS).round() as u16);
        let index = *known.entry(key).or_insert(cells.len());
        if index == cells.len() {
            cells.push(Cell { lab: [0.0; 3], light: [0.0; 3], area: 0.0 });
        }
        let area = f64::from(*area);
        let cell = &mut cells[index];
        cell.light = [0, 1, 2].map(|at| cell.light[at] + area * f64::from(light[at]));
        cell.area += area;
        cell_of.push(index);
    }
    for cell in &mut cells {
        cell.lab = oklab(cell.mean());
    }
    let mut middles = first(&cells, most);
    let mut nearest: Vec<usize> = Vec::new();
    for _ in 0..ROUNDS {
        let now = cells.iter().map(|cell| self::nearest(&middles, cell.lab)).collect();
        if now == nearest {
            break;
        }
        nearest = now;
        for (index, middle) in middles.iter_mut().enumerate() {
            let own = || cells.iter().zip(&nearest).filter(|(_, at)| **at == index).map(|(cell, _)| cell);
            let area: f64 = own().map(|cell| cell.area).sum();
            if area > 0.0 {
                *middle = [0, 1, 2]
                    .map(|at| (own().map(|cell| f64::from(cell.lab[at]) * cell.area).sum::<f64>() / area) as f32);
            }
        }
    }
    let colors = (0..middles.len()).map(|index| {
        let own = || cells.iter().zip(&nearest).filter(|(_, at)| **at == index).map(|(cell, _)| cell);
        let area: f64 = own().map(|cell| cell.area).sum();
        let light = [0, 1, 2].map(|at| own().map(|cell| cell.light[at]).sum::<f64>() / area.max(f64::MIN_POSITIVE));
        light.map(|channel| (srgb(channel as f32) * 255.0).round() as u8)
    });
    (colors.collect(), cell_of.into_iter().map(|cell| nearest[cell]).collect())
}

/// Where the middles begin: the colour that covers the most, then each time the one that is most missed.
fn first(cells: &[Cell], most: usize) -> Vec<Lab> {
    let mut middles: Vec<Lab> = Vec::new();
    let mut missed = vec![f32::INFINITY; cells.len()];
    while middles.len() < most {
        let weight = |index: &usize| match middles.is_empty() {
            true => cells[*index].area,
            false => cells[*index].area * f64::from(missed[*index]),
        };
        let apart = (0..cells.len()).filter(|index| missed[*index] > ALIKE * ALIKE);
        // The first of those that are missed alike.
        let Some(next) = apart.max_by(|a, b| weight(a).total_cmp(&weight(b)).then(b.cmp(a))) else { break };
        middles.push(cells[next].lab);
        for (missed, cell) in missed.iter_mut().zip(cells) {
            *missed = missed.min(apart_squared(cell.lab, cells[next].lab));
        }
    }
    middles
}

fn nearest(middles: &[Lab], lab: Lab) -> usize {
    let away = |index: &usize| apart_squared(middles[*index], lab);
    (0..middles.len()).min_by(|a, b| away(a).total_cmp(&away(b)).then(a.cmp(b))).unwrap_or(0)
}

fn apart_squared(one: Lab, other: Lab) -> f32 {
    (0..3).map(|at| (one[at] - other[at]) * (one[at] - other[at])).sum()
}

impl Cell {
    fn mean(&self) -> [f32; 3] {
        self.light.map(|channel| (channel / self.area.max(f64::MIN_POSITIVE)) as f32)
    }
}

/// The word that people use for a colour.
pub(crate) fn word(color: [u8; 3]) -> &'static str {
    let lab = |color: [u8; 3]| oklab(color.map(crate::picture::linear));
    let own = lab(color);
    let away = |other: [u8; 3]| apart_squared(lab(other), own);
    WORDS.iter().min_by(|a, b| away(a.1).total_cmp(&away(b.1))).map_or("grey", |(word, _)| word)
}

fn srgb(light: f32) -> f32 {
    let light = light.clamp(0.0, 1.0);
    if light <= 0.003_130_8 { light * 12.92 } else { 1.055 * libm::powf(light, 1.0 / 2.4) - 0.055 }
}

fn oklab([r, g, b]: [f32; 3]) -> Lab {
    let l = libm::cbrtf(0.412_221_46 * r + 0.536_332_55 * g + 0.051_445_995 * b);
    let m = libm::cbrtf(0.211_903_5 * r + 0.680_699_5 * g + 0.107_396_96 * b);
    let s = libm::cbrtf(0.088_302_46 * r + 0.281_718_85 * g + 0.629_978_7 * b);
    [
        0.210_454_26 * l + 0.793_617_8 * m - 0.004_072_047 * s,
        1.977_998_5 * l - 2.428_592_2 * m + 0.450_593_7 * s,
        0.025_904_037 * l + 0.782_771_77 * m - 0.808_675_77 * s,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::linear;

    fn faces(colors: &[[u8; 3]]) -> Vec<([f32; 3], f32)> {
        colors.iter().map(|color| (color.map(linear), 1.0)).collect()
    }

    #[test]
    fn few_colours_stay_what_they_are() {
        let own = [[200, 30, 30], [30, 30, 200], [200, 30, 30], [240, 240, 240]];
        let (colors, of) = reduce(&faces(&own), 12);
        let shown: Vec<[u8; 3]> = of.iter().map(|index| colors[*index]).collect();
        assert_eq!((colors.len(), shown), (3, own.to_vec()));
    }

    #[test]
    fn many_colours_become_few_that_look_like_them() {
        let own: Vec<[u8; 3]> = (0..=255).map(|red| [red, 255 - red, 60]).collect();
        let (colors, of) = reduce(&faces(&own), 12);
        assert_eq!(colors.len(), 12);
        for (own, index) in own.iter().zip(&of) {
            let apart = (0..3).map(|at| own[at].abs_diff(colors[*index][at])).max();
            assert!(apart < Some(40), "{own:?} became {:?}", colors[*index]);
        }
        assert_eq!(reduce(&faces(&own), 12), (colors, of));
        let alike = [[100, 100, 100], [101, 100, 100], [103, 101, 100]];
        assert_eq!(reduce(&faces(&alike), 12).0.len(), 1);
        assert_eq!(reduce(&[], 12), (Vec::new(), Vec::new()));
    }

    #[test]
    fn colours_have_the_words_that_people_use() {
        for (color, expected) in [
            ([255, 0, 0], "red"),
            ([255, 255, 255], "white"),
            ([0, 0, 0], "black"),
            ([128, 128, 128], "grey"),
            ([20, 60, 200], "blue"),
            ([250, 220, 30], "yellow"),
            ([30, 120, 40], "green"),
            ([101, 67, 33], "brown"),
        ] {
            assert_eq!(word(color), expected, "{color:?}");
        }
    }
}
