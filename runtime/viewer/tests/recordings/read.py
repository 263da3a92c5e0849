"""Reads what stands in a recording or a table by rerun's package and pyarrow, and prints it as JSON."""

import json
import sys


def recording(path: str) -> dict[str, object]:
    """Each entity of a recording: its rows, its timelines, and the last value of each of its columns that is short."""
    from rerun.experimental import RrdReader

    reader = RrdReader(path)
    entities: dict[str, dict[str, object]] = {}
    for chunk in reader.stream():
        entity = entities.setdefault(chunk.entity_path, {"rows": 0, "timelines": [], "columns": {}})
        entity["rows"] += chunk.num_rows
        entity["timelines"] = sorted({*entity["timelines"], *chunk.timeline_names})
        batch = chunk.to_record_batch()
        for name, column in zip(batch.schema.names, batch.columns, strict=True):
            if ":" not in name:
                continue
            short = str(column[-1].as_py())
            entity["columns"][name] = short if len(short) <= 200 else f"{len(short)} characters"
    return {"blueprints": len(reader.blueprints()), "entities": entities}


def table(path: str) -> dict[str, object]:
    """A Parquet table: its fields with unit and meaning, and its rows."""
    from pyarrow import parquet

    read = parquet.read_table(path)
    told = {field.name: {key.decode(): value.decode() for key, value in field.metadata.items()} for field in read.schema}
    return {"fields": told, "rows": read.to_pylist()}


print(json.dumps({"recording": recording, "table": table}[sys.argv[1]](sys.argv[2])))
