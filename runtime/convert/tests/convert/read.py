"""Reads a converted data set with pandas or lerobot, and prints what it finds as JSON."""

import io
import json
import os
import sys
from pathlib import Path


def with_pandas(folder: Path) -> dict[str, object]:
    import pandas
    from PIL import Image

    frames = pandas.concat([pandas.read_parquet(file) for file in sorted(folder.glob("data/*/*.parquet"))])
    tasks = pandas.read_parquet(folder / "meta/tasks.parquet")
    first = frames.iloc[0]
    told: dict[str, object] = {
        "frames": len(frames),
        "object": first["step.object"],
        # As lerobot looks tasks up.
        "task": tasks.iloc[int(first["task_index"])].name,
    }
    for name in ("color", "depth"):
        picture = Image.open(io.BytesIO(first[f"observation.images.{name}"]["bytes"]))
        told[name] = [picture.mode, list(picture.size)]
    return told


def with_lerobot(folder: Path) -> dict[str, object]:
    os.environ["HF_HUB_OFFLINE"] = "1"
    from lerobot.datasets.lerobot_dataset import LeRobotDataset

    dataset = LeRobotDataset("cohabit/test", root=folder)
    return {"frames": len(dataset), "color": list(dataset[0]["observation.images.color"].shape), "task": dataset[0]["task"]}


print(json.dumps({"pandas": with_pandas, "lerobot": with_lerobot}[sys.argv[1]](Path(sys.argv[2]))))
