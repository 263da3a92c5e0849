"""Missions by the thousand: suites that environments sample from, read from files or made up."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Optional, Union, overload

import numpy as np

from . import _native

_STREAM = 0x5317E
"""Keeps the draw of a mission apart from all else that follows from the same seed."""


@dataclass(frozen=True)
class Mission:
    """A mission of a suite."""

    id: str
    text: str
    """The mission file (CDF), as JSON."""
    type: str = ""
    """Its type, if it has one."""
    layout: str = ""
    """The id of its floor plan."""
    instruction: str = ""
    """What the robot is told to do."""
    rooms: tuple[str, ...] = ()
    """The rooms that its plan leads to, if it has one."""
    things: tuple[str, ...] = ()
    """The classes of the things that its goals are about."""
    line: str = ""
    """The line of the file that it is from."""


class Suite(Sequence[Mission]):
    """Missions in an order. An environment that is given one plays a mission of it in each episode."""

    def __init__(self, missions: Sequence[Mission]) -> None:
        if not missions:
            raise ValueError("a suite of 0 missions: at least 1")
        self.missions = tuple(missions)

    @overload
    def __getitem__(self, index: int) -> Mission: ...
    @overload
    def __getitem__(self, index: slice) -> Suite: ...
    def __getitem__(self, index: Union[int, slice]) -> Union[Mission, Suite]:
        return Suite(self.missions[index]) if isinstance(index, slice) else self.missions[index]

    def __len__(self) -> int:
        return len(self.missions)

    def __iter__(self) -> Iterator[Mission]:
        return iter(self.missions)

    @property
    def types(self) -> list[str]:
        """The types of its missions, each once, by name."""
        return sorted({mission.type for mission in self.missions})

    def of_type(self, *types: str) -> Suite:
        """Its missions of these types. Raises ``ValueError`` if there is none."""
        unknown = [name for name in types if name not in self.types]
        if unknown:
            raise ValueError(f"there is no mission of type `{unknown[0]}`: {', '.join(self.types)}")
        return Suite([mission for mission in self.missions if mission.type in types])

    def sample(self, seed: int) -> Mission:
        """The mission that an episode with this seed plays."""
        return self.missions[int(np.random.default_rng([_STREAM, seed]).integers(len(self.missions)))]

    def split(self, share: float = 0.1, seed: int = 0) -> dict[str, Suite]:
        """Parts it for training (``train``) and for tests of what training has (``seen``) and does not have: ``unseen-object``,
        ``unseen-room``, ``unseen-floor-plan``, ``unseen-composition`` and ``unseen-several``. Each part but ``train`` gets about
        that share of the missions; parts without any are left out."""
        if not 0.01 <= share <= 0.2:
            raise ValueError(f"a share of {share}: from 0.01 to 0.2")
        facets = [(one.type, one.layout, list(one.rooms), list(one.things)) for one in self.missions]
        parts: dict[str, list[Mission]] = {}
        for mission, part in zip(self.missions, _native.part_missions(facets, share, seed)):
            parts.setdefault(part, []).append(mission)
        return {part: Suite(missions) for part, missions in sorted(parts.items())}

    def save(self, path: Union[str, os.PathLike[str]]) -> None:
        """Writes a file of missions, a line each, as ``cohabit eval`` and :func:`suite` read it."""
        lines = [mission.line or _line(mission) for mission in self.missions]
        Path(path).write_text("".join(f"{line}\n" for line in lines))

    def __repr__(self) -> str:
        return f"<cohabit.Suite of {len(self)} missions>"


def _line(mission: Mission) -> str:
    line: dict[str, Any] = {"id": mission.id, "type": mission.type, "layout": mission.layout}
    line |= {"utterances": [mission.instruction], "rooms": list(mission.rooms), "things": list(mission.things), "cdf": json.loads(mission.text)}
    return json.dumps(line)


def instruction_of(cdf: Any) -> str:
    """What a mission file asks for: its ``goal_text``, or what its goals say."""
    if not isinstance(cdf, Mapping):
        return ""
    text = cdf.get("goal_text")
    if isinstance(text, str) and text.strip():
        return text.strip()
    goals = cdf.get("task_goals")
    found = [goal.get("description") for goal in goals if isinstance(goal, Mapping)] if isinstance(goals, list) else []
    return "; ".join(one for one in found if isinstance(one, str) and one)


def suite(path: Union[str, os.PathLike[str]]) -> Suite:
    """Reads the missions of a file of missions (``.jsonl``), of a mission file (CDF), of a folder of mission files, or of the
    trajectory data set of Alexa Arena, whose missions have the words of their annotators.

    Raises ``ValueError`` that names the file, the line and what is wrong.
    """
    path = Path(path)
    if path.is_dir():
        missions = [_of_cdf(file.stem, _read_json(file)) for file in sorted(path.glob("*.json"))]
    elif path.suffix == ".jsonl":
        lines = [(number, line) for number, line in enumerate(_read(path).split("\n"), 1) if line.strip()]
        missions = [_of_line(line, f"{path}:{number}") for number, line in lines]
    else:
        whole = _read_json(path)
        is_mission = not isinstance(whole, dict) or "scene" in whole
        missions = [_of_cdf(path.stem, whole)] if is_mission else _of_arena(whole, str(path))
    if not missions:
        raise ValueError(f"{path}: no missions in it; give a .jsonl of missions, a mission (CDF) or a folder of missions")
    seen: set[str] = set()
    for mission in missions:
        if mission.id in seen:
            raise ValueError(f"{path}: two missions are named {mission.id}")
        seen.add(mission.id)
    return Suite(missions)


def generate(
    count: int,
    seed: int = 1,
    types: Optional[Sequence[str]] = None,
    blockers: Optional[float] = None,
    workers: Optional[int] = None,
) -> Suite:
    """Makes missions up: each is checked, solved by the planner and played once. The same seed makes the same ones.

    :param types: of the built-in types, those that are made; all of them, if left out.
    :param blockers: the share of missions in which something stands in the way, from 0 to 1.
    :param workers: threads; one for each core, if left out. They do not change what is made.
    """
    if count < 1:
        raise ValueError(f"{count} missions: at least 1")
    if blockers is not None and not 0.0 <= blockers <= 1.0:
        raise ValueError(f"a share of {blockers} blockers: from 0 to 1")
    threads = workers or os.cpu_count() or 1
    lines = _native.generate_missions(count, seed, None if types is None else list(types), blockers, threads)
    return Suite([_of_line(line, "generate") for line in lines])


def _read(path: Path) -> str:
    try:
        return path.read_text()
    except (OSError, UnicodeDecodeError) as error:
        raise ValueError(f"{path}: {error}") from None


def _read_json(path: Path) -> Any:
    try:
        # Editors of another system put a byte order mark before the text.
        return json.loads(_read(path).lstrip("\ufeff"))
    except json.JSONDecodeError as error:
        raise ValueError(f"{path}:{error.lineno}: {error.msg}") from None


def _of_cdf(name: str, cdf: Any) -> Mission:
    return Mission(name, json.dumps(cdf), layout=_layout(cdf), instruction=instruction_of(cdf))


def _of_line(line: str, place: str) -> Mission:
    try:
        read = json.loads(line)
    except json.JSONDecodeError as error:
        raise ValueError(f"{place}: {error.msg}") from None
    if not isinstance(read, dict) or not isinstance(read.get("id"), str) or "cdf" not in read:
        raise ValueError(f'{place}: a line of missions is an object with "id" and "cdf"')
    said = [one for one in read.get("utterances") or [] if isinstance(one, str)]
    return Mission(
        read["id"],
        json.dumps(read["cdf"]),
        str(read.get("type", "")),
        _layout(read["cdf"]),
        "; ".join(said) or instruction_of(read["cdf"]),
        tuple(read.get("rooms") or ()),
        tuple(read.get("things") or ()),
        line,
    )


def _of_arena(sessions: dict[str, Any], place: str) -> list[Mission]:
    """A mission for each annotator's words, named as ``cohabit eval`` names them."""
    missions = []
    for name, session in sorted(sessions.items()):
        if not isinstance(session, dict) or "CDF" not in session:
            raise ValueError(f'{place}: session `{name}` has no "CDF"')
        text, layout = json.dumps(session["CDF"]), _layout(session["CDF"])
        for who in ("human", "synthetic"):
            for number, annotation in enumerate(session.get(f"{who}_annotations") or [], 1):
                said = [str(one.get("instruction", "")) for one in annotation.get("instructions") or []]
                missions.append(Mission(f"{name}#{who}{number}", text, layout=layout, instruction="; ".join(said)))
        if not session.get("human_annotations") and not session.get("synthetic_annotations"):
            instruction = instruction_of(session["CDF"])
            missions.append(Mission(f"{name}#expert", text, layout=layout, instruction=instruction))
    return missions


def _layout(cdf: Any) -> str:
    scene = cdf.get("scene") if isinstance(cdf, dict) else None
    layout = scene.get("layoutOverride") if isinstance(scene, dict) else None
    return layout if isinstance(layout, str) else ""
