"""Recorded sessions step by step."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import cohabit


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The log of a mission in which somebody spoke."""
    logs = tmp_path_factory.mktemp("logs")
    binary = str(Path(sys.executable).with_name("cohabit"))
    played = ["eval", "--user", "simulated", "--missions", "1", "--seed", "3", "--record", str(logs)]
    subprocess.run([binary, *played], check=True, capture_output=True)
    (only,) = logs.glob("*.mcap")
    return only


def test_steps_are_dicts(log: Path) -> None:
    steps = cohabit.steps(log)
    assert [step["step"] for step in steps] == list(range(1, len(steps) + 1))
    said = next(step["said"] for step in steps if "said" in step)
    assert said["understood"]["readings"][0]["text"] == said["text"]
    assert all(step["did"]["outcome"] for step in steps if "did" in step)


def test_a_step_may_be_another(log: Path, tmp_path: Path) -> None:
    first = next(step for step in cohabit.steps(log) if "said" in step)
    told = cohabit.rerun(log, first["step"], instead="look around", out=tmp_path / "other.mcap")
    assert told["before"][0]["said"]["text"] == first["said"]["text"]
    assert told["after"][0]["said"]["text"] == "look around"
    assert cohabit.steps(told["log"])[first["step"] - 1]["said"]["text"] == "look around"


def test_what_is_wrong_is_said(log: Path, tmp_path: Path) -> None:
    with pytest.raises(cohabit.Error, match="none.mcap"):
        cohabit.steps(tmp_path / "none.mcap")
    with pytest.raises(cohabit.Error, match="step 999"):
        cohabit.rerun(log, 999, instead={"Stop": None}, out=tmp_path / "other.mcap")
