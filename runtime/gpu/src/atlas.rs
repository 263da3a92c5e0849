//! Many pictures side by side on one large one.

/// Rows of an atlas begin at multiples of so many pixels of four bytes: what copies from textures ask for.
const ALIGN_PX: u32 = 64;

/// Pictures that are drawn together.
#[derive(Clone, Debug, Eq, PartialEq)]
pub(crate) struct Atlas {
    /// The first picture.
    pub first: usize,
    /// Where each picture's upper left corner lies.
    pub tiles: Vec<[u32; 2]>,
    /// Pixels a row, and rows.
    pub size: [u32; 2],
}

/// Lays out pictures of these sizes in their order, on as few atlases as it takes. None is larger than `most_side` nor,
/// if it holds more than one picture, has many more than `most_pixels`; every picture fits `most_side`.
pub(crate) fn pack(sizes: &[[u32; 2]], most_side: u32, most_pixels: u64) -> Vec<Atlas> {
    let most_width = most_side / ALIGN_PX * ALIGN_PX;
    let mut all = Vec::new();
    let mut first = 0;
    while first < sizes.len() {
        let mut total = 0;
        let chosen = sizes[first..].iter().take_while(|size| {
            total += u64::from(size[0]) * u64::from(size[1]);
            total <= most_pixels
        });
        let count = chosen.count().max(1);
        let atlas = shelves(first, &sizes[first..first + count], most_width, most_side);
        first += atlas.tiles.len();
        all.push(atlas);
    }
    all
}

/// Rows of pictures, nearly a square as a whole; ends before the picture that would be too low down.
fn shelves(first: usize, sizes: &[[u32; 2]], most_width: u32, most_height: u32) -> Atlas {
    let area: u64 = sizes.iter().map(|size| u64::from(size[0]) * u64::from(size[1])).sum();
    let widest = sizes.iter().map(|size| size[0]).max().unwrap_or(1);
    let side = (1..).find(|side: &u64| side * side >= area).unwrap_or(1) as u32;
    // A whole number of the widest ones, where they are all alike.
    let wanted = side.div_ceil(widest) * widest;
    let limit = wanted.max(widest).next_multiple_of(ALIGN_PX).min(most_width.max(widest));
    let (mut tiles, mut at, mut shelf, mut width) = (Vec::with_capacity(sizes.len()), [0, 0], 0, 0);
    for size in sizes {
        if at[0] + size[0] > limit {
            at = [0, at[1] + shelf];
            shelf = 0;
        }
        if at[1] + size[1] > most_height {
            break;
        }
        tiles.push(at);
        at[0] += size[0];
        shelf = shelf.max(size[1]);
        width = width.max(at[0]);
    }
    Atlas { first, tiles, size: [width.next_multiple_of(ALIGN_PX), at[1] + shelf] }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(sizes: &[[u32; 2]], most_side: u32, most_pixels: u64) -> Vec<Atlas> {
        let atlases = pack(sizes, most_side, most_pixels);
        let mut next = 0;
        for atlas in &atlases {
            assert_eq!(atlas.first, next);
            next += atlas.tiles.len();
            assert!(atlas.size[0] % ALIGN_PX == 0 && atlas.size[0] <= most_side && atlas.size[1] <= most_side);
            let rects: Vec<_> = atlas.tiles.iter().zip(&sizes[atlas.first..]).collect();
            for (index, (a, a_size)) in rects.iter().enumerate() {
                assert!(a[0] + a_size[0] <= atlas.size[0] && a[1] + a_size[1] <= atlas.size[1]);
                for (b, b_size) in &rects[..index] {
                    let apart = |axis: usize| a[axis] + a_size[axis] <= b[axis] || b[axis] + b_size[axis] <= a[axis];
                    assert!(apart(0) || apart(1), "{a:?} and {b:?} overlap");
                }
            }
        }
        assert_eq!(next, sizes.len(), "every picture has its place");
        atlases
    }

    #[test]
    fn pictures_lie_side_by_side() {
        assert!(check(&[], 4096, 1 << 24).is_empty());
        assert_eq!(check(&[[1, 1]], 4096, 1 << 24)[0].size, [64, 1]);
        assert_eq!(check(&[[84, 84]; 1024], 8192, 1 << 24).len(), 1);
        assert!(check(&[[1280, 720]; 40], 8192, 1 << 24).len() > 1);
        check(&[[300, 300], [84, 84], [854, 480], [1, 7], [84, 84], [300, 20]], 1024, 1 << 18);
        check(&[[1000, 1000]; 9], 1024, 1 << 30);
    }
}
