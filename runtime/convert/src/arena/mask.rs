//! Masks as runs over the pixels of a picture, row by row: `[first, length]`.

/// The runs of a colour.
pub(crate) fn runs(pixels: &[[u8; 3]], color: [u8; 3]) -> Vec<[usize; 2]> {
    let mut runs: Vec<[usize; 2]> = Vec::new();
    for (place, _) in pixels.iter().enumerate().filter(|(_, pixel)| **pixel == color) {
        match runs.last_mut() {
            Some([first, length]) if *first + *length == place => *length += 1,
            _ => runs.push([place, 1]),
        }
    }
    runs
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn runs_go_on_over_the_ends_of_rows() {
        let (one, other) = ([1, 2, 3], [0, 0, 0]);
        assert_eq!(runs(&[other, one, one, other, one], one), [[1, 2], [4, 1]]);
        assert!(runs(&[other], one).is_empty());
    }

    proptest! {
        #[test]
        fn runs_are_the_pixels_and_no_two_touch(bits in prop::collection::vec(any::<bool>(), 0..200)) {
            let pixels: Vec<[u8; 3]> = bits.iter().map(|bit| [u8::from(*bit); 3]).collect();
            let runs = runs(&pixels, [1; 3]);
            let mut drawn = vec![false; bits.len()];
            for [first, length] in &runs {
                drawn[*first..first + length].fill(true);
            }
            prop_assert_eq!(drawn, bits);
            prop_assert!(runs.windows(2).all(|pair| pair[0][0] + pair[0][1] < pair[1][0]));
        }
    }
}
