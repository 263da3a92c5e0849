"""Validates a data package as Frictionless does; prints, as JSON, its tables with their rows, and all that is wrong with it."""

import json
import sys

from frictionless import validate

report = validate(sys.argv[1], type="package")
rows = {task.name: task.stats.get("rows") for task in report.tasks}
print(json.dumps({"valid": report.valid, "rows": rows, "errors": report.flatten(["type", "message"])}))
