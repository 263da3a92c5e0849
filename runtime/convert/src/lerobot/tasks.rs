//! `meta/tasks.parquet`: what the robot is told, each text once.

use std::collections::HashMap;

use cohabit_parquet::{Column, TableWriter, Values};
use serde_json::json;

use crate::{
    error::{ConvertError, in_table},
    native::Line,
    output::Output,
};

/// The column that pandas takes as the names of rows: LeRobot looks tasks up by them.
const ROW_NAMES: &str = "__index_level_0__";

/// Tasks by their texts.
#[derive(Debug, Default)]
pub(crate) struct Tasks {
    texts: Vec<String>,
    known: HashMap<String, i64>,
}

impl Tasks {
    /// The number of a task.
    pub fn number(&mut self, text: &str) -> i64 {
        if let Some(number) = self.known.get(text) {
            return *number;
        }
        let number = self.texts.len() as i64;
        self.texts.push(text.to_owned());
        self.known.insert(text.to_owned(), number);
        number
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.texts.len()
    }

    /// Writes them.
    pub fn write(self, output: &Output) -> Result<(), ConvertError> {
        let path = output.path("meta/tasks.parquet")?;
        let columns = [
            Column { name: "task_index", values: Values::Long((0..self.texts.len() as i64).collect()) },
            Column { name: ROW_NAMES, values: Values::Text(self.texts) },
        ];
        let names = pandas();
        let mut table = TableWriter::create(&path, &columns, &[("pandas", names.as_str())]).map_err(in_table(&path))?;
        table.write(&columns).and_then(|()| table.close()).map_err(in_table(&path))
    }
}

/// What a whole episode asks for: the instructions of its steps that succeeded, one after the other.
pub(crate) fn of_episode(lines: &[Line]) -> String {
    let done = lines.iter().filter(|line| line.step.has_succeeded());
    done.map(|line| line.step.instruction()).collect::<Vec<_>>().join("; ")
}

/// What pandas writes with a table whose rows have names.
fn pandas() -> String {
    let column = |name: Option<&str>, field: &str, kind: &str, numpy: &str| json!({ "name": name, "field_name": field, "pandas_type": kind, "numpy_type": numpy, "metadata": null });
    let names = json!({
        "name": null, "field_name": null, "pandas_type": "unicode", "numpy_type": "object",
        "metadata": { "encoding": "UTF-8" },
    });
    let meta = json!({
        "index_columns": [ROW_NAMES],
        "column_indexes": [names],
        "columns": [
            column(Some("task_index"), "task_index", "int64", "int64"),
            column(None, ROW_NAMES, "unicode", "object"),
        ],
        "creator": { "library": "cohabit", "version": env!("CARGO_PKG_VERSION") },
        "pandas_version": "2.2.0",
    });
    meta.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_task_has_one_number() {
        let mut tasks = Tasks::default();
        let numbers: Vec<i64> = ["a", "b", "a", "c"].map(|text| tasks.number(text)).to_vec();
        assert_eq!(numbers, [0, 1, 0, 2]);
        assert_eq!(tasks.count(), 3);
    }
}
