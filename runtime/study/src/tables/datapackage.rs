//! What exported tables are, for programs: a Frictionless Data Package (specs.frictionlessdata.io), version 1.
//!
//! All resources of a tabular data package are tabular data resources, and the data of these are CSV (or JSON within it). So the
//! Parquet file of a table is no resource: the resource of the CSV file names it in a property of its own, `parquet`, as the
//! standard lets descriptors have.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use cohabit_tables::{Field, Kind, Table};
use serde_json::{Value, json};

use crate::records::Records;

/// Its file, beside the tables.
const FILE: &str = "datapackage.json";

/// Why it could not be written.
#[derive(Debug, thiserror::Error)]
#[error("write {path}: {source}")]
pub struct DataPackageError {
    path: PathBuf,
    source: io::Error,
}

/// Writes it into the folder of the tables; gives its path.
pub(super) fn write(records: &Records, tables: &[Table], out: &Path) -> Result<PathBuf, DataPackageError> {
    let path = out.join(FILE);
    let text = format!("{:#}\n", datapackage(records, tables));
    match fs::write(&path, text) {
        Ok(()) => Ok(path),
        Err(source) => Err(DataPackageError { path, source }),
    }
}

fn datapackage(records: &Records, tables: &[Table]) -> Value {
    let title = &records.study.title;
    let described =
        if records.is_synthetic { format!("{title} (synthetic: no data of people)") } else { title.clone() };
    json!({
        "profile": "tabular-data-package",
        "name": "cohabit-study",
        "title": described,
        "synthetic": records.is_synthetic,
        "resources": tables.iter().map(resource).collect::<Vec<_>>(),
    })
}

fn resource(table: &Table) -> Value {
    json!({
        "profile": "tabular-data-resource",
        "name": table.name,
        "path": format!("{}.csv", table.name),
        "parquet": format!("{}.parquet", table.name),
        "description": table.meaning,
        "format": "csv",
        "mediatype": "text/csv",
        "encoding": "utf-8",
        "schema": { "fields": table.fields.iter().map(field).collect::<Vec<_>>(), "missingValues": [""] },
    })
}

fn field(field: &Field) -> Value {
    let kind = match field.kind {
        Kind::Text => "string",
        Kind::Whole => "integer",
        Kind::Real => "number",
        Kind::Flag => "boolean",
    };
    let mut described = json!({ "name": field.name, "type": kind, "description": field.meaning });
    if !field.unit.is_empty() {
        described["unit"] = json!(field.unit);
    }
    described
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::Study;

    #[test]
    fn a_package_names_each_table_with_its_columns() {
        let fields = [("who", Kind::Text, ""), ("played_s", Kind::Real, "s"), ("synthetic", Kind::Flag, "")];
        let fields = fields.map(|(name, kind, unit)| Field { name: name.into(), kind, unit, meaning: "m".into() });
        let table = Table { name: "missions", meaning: "a mission", fields: fields.to_vec(), rows: Vec::new() };
        let study = Study { title: "T".to_owned(), ..Study::default() };
        let records =
            Records { study, progress: Vec::new(), withdrawn: Vec::new(), notes: Vec::new(), is_synthetic: true };
        let package = datapackage(&records, &[table]);
        assert_eq!(package["title"], "T (synthetic: no data of people)");
        let resource = &package["resources"][0];
        assert_eq!((&resource["path"], &resource["name"]), (&json!("missions.csv"), &json!("missions")));
        assert_eq!((&resource["parquet"], &resource["format"]), (&json!("missions.parquet"), &json!("csv")));
        assert_eq!(package["resources"].as_array().map(Vec::len), Some(1), "Parquet is no tabular data resource");
        let types: Vec<&Value> = (0..3).map(|number| &resource["schema"]["fields"][number]["type"]).collect();
        assert_eq!(types, ["string", "number", "boolean"]);
        assert_eq!(resource["schema"]["fields"][1]["unit"], "s");
    }
}
