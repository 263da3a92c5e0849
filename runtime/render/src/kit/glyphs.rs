//! A stroke font: each letter a few polylines on a grid 4 wide and 6 high.

/// The grid's height: that of a capital letter.
pub(super) const HEIGHT: f32 = 6.0;
/// From one letter to the next, in grid units.
pub(super) const ADVANCE: f32 = 5.6;
/// A stroke's width, in grid units.
pub(super) const STROKE: f32 = 0.85;

/// Polylines, parted by spaces, as pairs of digits: column, then row from the baseline. Only what is here is drawn;
/// small letters are drawn as small capitals.
const GLYPHS: [(char, &str); 61] = [
    ('A', "00 26 40|12 32"),
    ('B', "00 06 36 45 44 33 03|33 42 41 30 00"),
    ('C', "45 36 16 05 01 10 30 41"),
    ('D', "00 06 26 44 42 20 00"),
    ('E', "40 00 06 46|03 33"),
    ('F', "00 06 46|03 33"),
    ('G', "45 36 16 05 01 10 30 41 43 23"),
    ('H', "00 06|40 46|03 43"),
    ('I', "10 30|20 26|16 36"),
    ('J', "01 10 30 41 46"),
    ('K', "00 06|46 03 40"),
    ('L', "06 00 40"),
    ('M', "00 06 23 46 40"),
    ('N', "00 06 40 46"),
    ('O', "10 01 05 16 36 45 41 30 10"),
    ('P', "00 06 36 45 44 33 03"),
    ('Q', "10 01 05 16 36 45 41 30 10|22 40"),
    ('R', "00 06 36 45 44 33 03|23 40"),
    ('S', "01 10 30 41 42 33 13 04 05 16 36 45"),
    ('T', "20 26|06 46"),
    ('U', "06 01 10 30 41 46"),
    ('V', "06 20 46"),
    ('W', "06 10 23 30 46"),
    ('X', "00 46|06 40"),
    ('Y', "06 23 46|23 20"),
    ('Z', "06 46 00 40"),
    ('0', "10 01 05 16 36 45 41 30 10|12 34"),
    ('1', "14 26 20|10 30"),
    ('2', "05 16 36 45 44 00 40"),
    ('3', "05 16 36 45 44 33 42 41 30 10 01|13 33"),
    ('4', "30 36 02 42"),
    ('5', "46 06 03 33 42 41 30 10 01"),
    ('6', "36 16 05 01 10 30 41 42 33 03"),
    ('7', "06 46 10"),
    ('8', "13 04 05 16 36 45 44 33 13 02 01 10 30 41 42 33"),
    ('9', "10 30 41 45 36 16 05 04 13 43"),
    ('.', "20 21"),
    (',', "21 10"),
    (':', "21 22|24 25"),
    (';', "24 25|22 10"),
    ('!', "26 22|21 20"),
    ('?', "05 16 36 45 44 23 22|21 20"),
    ('-', "13 33"),
    ('+', "13 33|22 24"),
    ('=', "02 42|04 44"),
    ('/', "00 46"),
    ('\\', "06 40"),
    ('(', "36 24 22 30"),
    (')', "16 24 22 10"),
    ('[', "36 16 10 30"),
    (']', "16 36 30 10"),
    ('<', "45 03 41"),
    ('>', "05 43 01"),
    ('\'', "26 25"),
    ('"', "16 15|36 35"),
    ('#', "10 16|30 36|02 42|04 44"),
    ('%', "00 46|05 16|41 30"),
    ('&', "40 04 15 26 35 24 01 10 20 42"),
    ('~', "02 14 22 34 42"),
    ('_', "00 40"),
    ('*', "12 34|14 32|03 43"),
];

/// The strokes of a letter: segments from point to point, in grid units.
pub(super) fn strokes(letter: char) -> Vec<[[f32; 2]; 2]> {
    let Some((_, lines)) = GLYPHS.iter().find(|(known, _)| *known == letter) else {
        return Vec::new();
    };
    let mut segments = Vec::new();
    for line in lines.split('|') {
        let digits: Vec<f32> = line.chars().filter_map(|c| c.to_digit(10)).map(|digit| digit as f32).collect();
        let points: Vec<[f32; 2]> = digits.as_chunks::<2>().0.to_vec();
        segments.extend(points.windows(2).map(|pair| [pair[0], pair[1]]));
    }
    segments
}

/// Whether the font has this letter, or draws nothing for it on purpose.
pub(super) fn known(letter: char) -> bool {
    letter == ' ' || GLYPHS.iter().any(|(known, _)| *known == letter)
}
