//! Numbers for the triangles of one picture: those of a draw follow those of the draws before it. They are the same
//! whatever part of the picture is drawn, and whatever of it turns out to be hidden.

use super::draw::Draw;

/// Which draw has which numbers.
#[derive(Debug)]
pub(super) struct Numbers {
    /// The first number of each draw, and behind them all the number of triangles.
    firsts: Vec<u32>,
}

impl Numbers {
    pub(super) fn new(draws: &[Draw<'_>]) -> Self {
        let mut next = 0;
        let mut firsts = Vec::with_capacity(draws.len() + 1);
        firsts.push(0);
        firsts.extend(draws.iter().map(|draw| {
            next += draw.piece.triangles.len() as u32;
            next
        }));
        Self { firsts }
    }

    /// How many triangles there are.
    pub(super) fn total(&self) -> u32 {
        self.firsts[self.firsts.len() - 1]
    }

    /// The number of a draw's first triangle.
    #[inline(always)]
    pub(super) fn first(&self, draw: usize) -> u32 {
        self.firsts[draw]
    }

    /// The draw that a triangle belongs to.
    #[inline(always)]
    pub(super) fn draw_of(&self, number: u32) -> usize {
        self.firsts.partition_point(|first| *first <= number) - 1
    }

    /// The numbers of a draw's triangles.
    #[inline(always)]
    pub(super) fn of(&self, draw: usize) -> core::ops::Range<u32> {
        self.firsts[draw]..self.firsts[draw + 1]
    }
}
