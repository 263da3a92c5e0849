//! Arrays of many worlds, a row for each, in pages of memory that are used again once Python lets go of them.

use std::sync::Arc;

use pyo3::prelude::*;

use crate::{
    memory::{Memory, Owner},
    part::{Part, Sizes},
};

/// Where a cache line begins: arrays do too.
const LINE_BYTES: usize = 64;
/// Pages that are kept to be used again: Python may hold the newest, and the one before.
const MOST_SPARE: usize = 3;

/// An array in a page.
struct Column {
    part: Part,
    /// The shape of a row.
    row: Vec<usize>,
    /// Where it begins in its page.
    at: usize,
    /// The bytes of a row.
    bytes: usize,
}

/// Some arrays that are kept together: who keeps one of them keeps the page.
struct Page {
    columns: Vec<Column>,
    words: usize,
    latest: Arc<Vec<u64>>,
    spare: Vec<Arc<Vec<u64>>>,
}

/// All arrays of some worlds: those that are small on one page, and each plane of pictures on its own.
pub struct Book {
    pages: Vec<Page>,
    worlds: usize,
}

/// An array: its name, its page, where it begins there, its shape, and the type of an item.
pub type Layout = (&'static str, usize, usize, Vec<usize>, &'static str);

/// Memory that a turn is written into, by page.
pub type Fresh = Vec<Vec<u64>>;

fn in_lines(bytes: usize) -> usize {
    bytes.next_multiple_of(LINE_BYTES)
}

impl Page {
    fn new(parts: &[Part], sizes: Sizes, worlds: usize) -> Self {
        let (mut columns, mut at) = (Vec::new(), 0);
        for part in parts {
            let bytes = part.bytes(sizes);
            columns.push(Column { part: *part, row: part.row(sizes), at, bytes });
            at += in_lines(bytes * worlds);
        }
        let words = at / size_of::<u64>();
        Self { columns, words, latest: Arc::new(vec![0; words]), spare: Vec::new() }
    }

    /// A page that nobody else refers to.
    fn fresh(&mut self) -> Vec<u64> {
        let free = self.spare.iter().position(|page| Arc::strong_count(page) == 1);
        let again = free.and_then(|place| Arc::into_inner(self.spare.swap_remove(place)));
        again.unwrap_or_else(|| vec![0; self.words])
    }

    fn turn(&mut self, fresh: Vec<u64>) {
        let before = std::mem::replace(&mut self.latest, Arc::new(fresh));
        self.spare.push(before);
        if self.spare.len() > MOST_SPARE {
            // Whoever still refers to it keeps it.
            self.spare.remove(0);
        }
    }
}

impl Book {
    /// Arrays of these planes and of all that is small.
    pub fn new(planes: &[Part], sizes: Sizes, worlds: usize) -> Self {
        let small = Page::new(&Part::SMALL, sizes, worlds);
        let planes = planes.iter().map(|plane| Page::new(&[*plane], sizes, worlds));
        Self { pages: std::iter::once(small).chain(planes).collect(), worlds }
    }

    /// Its arrays, in the order of the rows of each world.
    pub fn parts(&self) -> Vec<Part> {
        self.pages.iter().flat_map(|page| &page.columns).map(|column| column.part).collect()
    }

    /// Where its arrays are.
    pub fn layout(&self) -> Vec<Layout> {
        let of_page = |(number, page): (usize, &Page)| -> Vec<Layout> {
            let shape = |column: &Column| [&[self.worlds][..], column.row.as_slice()].concat();
            let columns = page.columns.iter();
            columns.map(|one| (one.part.name(), number, one.at, shape(one), one.part.item())).collect()
        };
        self.pages.iter().enumerate().flat_map(of_page).collect()
    }

    /// Memory for the next turn, used before or new.
    pub fn fresh(&mut self) -> Fresh {
        self.pages.iter_mut().map(Page::fresh).collect()
    }

    /// The rows of each world there.
    pub fn rows<'a>(&self, fresh: &'a mut [Vec<u64>]) -> Vec<Vec<&'a mut [u8]>> {
        let mut rows: Vec<Vec<&'a mut [u8]>> = (0..self.worlds).map(|_| Vec::new()).collect();
        for (page, words) in self.pages.iter().zip(fresh) {
            let mut rest: &'a mut [u8] = bytemuck::cast_slice_mut(words.as_mut_slice());
            for column in &page.columns {
                let room = in_lines(column.bytes * self.worlds);
                let (own, after) = std::mem::take(&mut rest).split_at_mut(room);
                rest = after;
                for (rows, row) in rows.iter_mut().zip(own.chunks_exact_mut(column.bytes)) {
                    rows.push(row);
                }
            }
        }
        rows
    }

    /// The rows of a world as they were written last.
    pub fn written(&self, world: usize) -> impl Iterator<Item = &[u8]> {
        self.pages.iter().flat_map(move |page| {
            let bytes: &[u8] = bytemuck::cast_slice(page.latest.as_slice());
            page.columns.iter().map(move |column| &bytes[column.at + world * column.bytes..][..column.bytes])
        })
    }

    /// Has what was written be the newest.
    pub fn turn(&mut self, fresh: Fresh) {
        self.pages.iter_mut().zip(fresh).for_each(|(page, fresh)| page.turn(fresh));
    }

    /// The newest pages, as arrays of bytes.
    ///
    /// # Errors
    /// When numpy cannot be imported.
    pub fn arrays<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        let array = |page: &Page| {
            let bytes = page.words * size_of::<u64>();
            Memory::array(py, &Owner::Page(Arc::clone(&page.latest)), 0, vec![bytes], "|u1")
        };
        self.pages.iter().map(array).collect()
    }
}
