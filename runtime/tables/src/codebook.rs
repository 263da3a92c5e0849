//! What every column of every table means.

use crate::table::{Cell, Field, Kind, Table};

const MEANING: &str = "a column of one of the tables, or a table. In CSV files, text that a spreadsheet program would take \
     for a formula has an apostrophe before it: text that begins with = + - @, a tab or a line break, or with apostrophes \
     and then one of these. Take one apostrophe away to have the text itself. Numbers are written as they are.";

/// The codebook of these tables, itself a table.
#[must_use]
pub fn codebook(tables: &[Table]) -> Table {
    let of_table = |table: &Table| {
        let row = |field: &Field| {
            vec![
                Cell::text(table.name),
                Cell::text(field.name.clone()),
                Cell::text(field.kind.name()),
                Cell::text(field.unit),
                Cell::text(field.meaning.clone()),
            ]
        };
        let itself =
            vec![Cell::text(table.name), Cell::Nothing, Cell::text("table"), Cell::Nothing, Cell::text(table.meaning)];
        std::iter::once(itself).chain(table.fields.iter().map(row)).collect::<Vec<_>>()
    };
    let itself = ["codebook", "", "table", "", MEANING].map(Cell::text).to_vec();
    Table {
        name: "codebook",
        meaning: MEANING,
        fields: vec![
            Field::new("table", Kind::Text, "", "the table, and the name of its file"),
            Field::new("name", Kind::Text, "", "the column; nothing where the table itself is meant"),
            Field::new("type", Kind::Text, "", "what kind of values it holds; an empty cell means that there is none"),
            Field::new("unit", Kind::Text, "", "their unit"),
            Field::new("meaning", Kind::Text, "", "what they mean"),
        ],
        rows: tables.iter().flat_map(of_table).chain([itself]).collect(),
    }
}
