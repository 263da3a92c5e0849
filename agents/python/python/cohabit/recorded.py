"""Recorded sessions step by step: what was said, understood, done and met, and what comes of another step.

The program ``cohabit``, which comes with this package, goes through the log.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sysconfig
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Optional, Union

from . import _native
from .missions import World, world_folders

Named = Union[str, "os.PathLike[str]"]
"""A file or a folder."""


def steps(log: Named, *, frames: Optional[Named] = None, world: World = ()) -> list[dict[str, Any]]:
    """The steps of a recorded session, as ``cohabit steps --json`` prints them; `frames` is a folder for what bodies saw before each.

    A step has ``said`` or ``did``. `world` has the world packs that the session was played with.
    """
    pictures = [] if frames is None else ["--frames", os.fspath(frames)]
    told = _told([os.fspath(log), *pictures], world)
    return [json.loads(line) for line in told.split("\n") if line]


def rerun(
    log: Named,
    step: int,
    *,
    instead: Union[str, Mapping[str, Any]],
    out: Named,
    world: World = (),
) -> dict[str, Any]:
    """Plays on from a step of a recorded session with something else in its place, and writes the log `out`.

    `instead` is what is said, or a command as ``step["did"]["action"]`` has it. Returns the steps of both sessions from there on: ``before`` and
    ``after``, and how many goals each met: ``goals_met``.
    """
    other = instead if isinstance(instead, str) else json.dumps(dict(instead))
    changed = [f"--step={step}", f"--instead={other}", f"--log={os.fspath(out)}"]
    told: dict[str, Any] = json.loads(_told([os.fspath(log), *changed], world))
    return told


def _told(arguments: list[str], world: World) -> str:
    packs = [f"--world={folder}" for folder in world_folders(world)]
    command = [_program(), "steps", "--json", *packs, *arguments]
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, encoding="utf-8", check=False)
    if done.returncode != 0:
        raise _native.Error(done.stderr.strip())
    return done.stdout


def _program() -> str:
    beside = Path(sysconfig.get_path("scripts")) / "cohabit"
    found = str(beside) if beside.is_file() else shutil.which("cohabit")
    if found is None:
        raise _native.Error("the program `cohabit` is not there: it comes with a wheel of this package")
    return found
