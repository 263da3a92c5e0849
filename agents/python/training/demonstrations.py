"""Demonstrations as a PyTorch data set: the steps of `cohabit demonstrate`, or of `cohabit convert --to lerobot`.

    pip install torch numpy pandas pyarrow pillow
    python demonstrations.py FOLDER

Needs neither this package nor lerobot. An item is what the robot sees before a step, if the set has pictures in colour, and what it was
told, and the action.
"""

import io
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import torch
from PIL import Image
from torch.utils.data import DataLoader, Dataset

Item = dict[str, Any]

# The kinds of actions, in the order of LeRobot's `action`.
KINDS = "go_to pick_up place open close break scan pour toggle throw fill clean examine stop".split()


def picture(file: bytes) -> torch.Tensor:
    """Red, green and blue from 0 to 1: `[3, height, width]`."""
    pixels = np.array(Image.open(io.BytesIO(file)).convert("RGB"))
    return torch.from_numpy(pixels).permute(2, 0, 1).float() / 255


class NativeSteps(Dataset[Item]):
    """Each line of `steps.jsonl` of each episode, with its picture. Lines are read when they are asked for."""

    def __init__(self, folder: Path) -> None:
        manifest = json.loads((folder / "manifest.json").read_text())
        self.episodes = [folder / episode["folder"] for episode in manifest["episodes"]]
        # Where each line begins: the first of an episode has all objects, so all lines together are large.
        self.lines: list[tuple[int, int]] = []
        for number, episode in enumerate(self.episodes):
            with (episode / "steps.jsonl").open("rb") as file:
                at = 0
                for line in file:
                    self.lines.append((number, at))
                    at += len(line)

    def __len__(self) -> int:
        return len(self.lines)

    def __getitem__(self, index: int) -> Item:
        number, at = self.lines[index]
        episode = self.episodes[number]
        with (episode / "steps.jsonl").open("rb") as file:
            file.seek(at)
            step = json.loads(file.readline())
        action = step["action"] or {"kind": "stop"}
        item: Item = {
            "instruction": step.get("instructions", {}).get("plain", ""),
            "kind": KINDS.index(action["kind"]),
        }
        if (color := step.get("frames", {}).get("color")) is not None:
            item["color"] = picture((episode / color).read_bytes())
        return item


class LeRobotSteps(Dataset[Item]):
    """Each frame of the Parquet files, all of them in memory, pictures packed as they are in the files."""

    COLUMNS = ["observation.state", "action", "step.instruction"]
    COLOR = "observation.images.color"

    def __init__(self, folder: Path) -> None:
        features = json.loads((folder / "meta/info.json").read_text())["features"]
        names = features["action"]["names"]
        assert names[: len(KINDS)] == [f"is_{kind}" for kind in KINDS], names
        files = sorted(folder.glob("data/*/*.parquet"))
        self.has_color = self.COLOR in features
        columns = [*self.COLUMNS, self.COLOR] if self.has_color else self.COLUMNS
        self.frames = pd.concat([pd.read_parquet(file, columns=columns) for file in files], ignore_index=True)

    def __len__(self) -> int:
        return len(self.frames)

    def __getitem__(self, index: int) -> Item:
        frame = self.frames.iloc[index]
        action = np.asarray(frame["action"], dtype=np.float32)
        item: Item = {
            "state": torch.from_numpy(np.array(frame["observation.state"], dtype=np.float32)),
            "instruction": frame["step.instruction"],
            "kind": int(action[: len(KINDS)].argmax()),
        }
        if self.has_color:
            item["color"] = picture(frame[self.COLOR]["bytes"])
        return item


def steps(folder: Path) -> NativeSteps | LeRobotSteps:
    """The data set in a folder, whichever of both it is."""
    return LeRobotSteps(folder) if (folder / "meta/info.json").exists() else NativeSteps(folder)


def main() -> None:
    """Counts the kinds of actions, batch by batch, as training would go through them."""
    data = steps(Path(sys.argv[1]))
    kinds = torch.zeros(len(KINDS), dtype=torch.long)
    for batch in DataLoader(data, batch_size=16, shuffle=True, num_workers=2):
        kinds += torch.bincount(batch["kind"], minlength=len(KINDS))
    pictures = f"pictures {tuple(batch['color'].shape[1:])}" if "color" in batch else "no pictures in colour"
    print(f"{len(data)} steps, {pictures}")
    for kind, count in zip(KINDS, kinds.tolist(), strict=True):
        print(f"{kind:>8} {count}")


if __name__ == "__main__":
    main()
