//! Rows of text as columns for a terminal.

/// To which side of their column cells are, but those of the first column, which are to the left.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Align {
    /// To the left, as words are.
    Left,
    /// To the right, as numbers are.
    Right,
}

/// A line for each row, with columns as wide as their widest cell and two spaces between them. Rows may end before the last column.
#[must_use]
pub fn columns(rows: &[Vec<String>], align: Align) -> String {
    let count = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..count).map(width).collect();
    let mut text = String::new();
    for row in rows {
        let cells = row.iter().zip(&widths).enumerate().map(|(column, (cell, width))| match align {
            Align::Right if column > 0 => format!("{cell:>width$}"),
            _ => format!("{cell:<width$}"),
        });
        text.push_str(cells.collect::<Vec<_>>().join("  ").trim_end());
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_stand_below_each_other() {
        let rows = [&["name", "count", ""][..], &["é", "1"], &["soup", "1000000", "–"], &[]];
        let rows = rows.map(|row| row.iter().map(|cell| (*cell).to_owned()).collect::<Vec<_>>());
        assert_eq!(columns(&rows, Align::Left), "name  count\né     1\nsoup  1000000  –\n\n");
        assert_eq!(columns(&rows, Align::Right), "name    count\né           1\nsoup  1000000  –\n\n");
        assert_eq!(columns(&[], Align::Left), "");
    }
}
