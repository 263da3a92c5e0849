"""Missions: suites that environments sample from, read from files or made up, and the folders of world packs."""

from __future__ import annotations

import json
import logging
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Optional, Union, overload

import numpy as np

from . import _native

_LOG = logging.getLogger("cohabit")

_STREAM = 0x5317E
"""Keeps the draw of a mission apart from all else that follows from the same seed."""

_MANIFEST = "manifest.json"
"""What commands write beside the missions and episodes that they make; it is no mission itself."""

World = Union[str, "os.PathLike[str]", Sequence[Union[str, "os.PathLike[str]"]]]
"""The folder of a world pack, or the name of one that comes with the program (``"homes"``), or several of them in their order, each of
which may add to those before it."""


def world_folders(world: World) -> list[str]:
    """The folders of world packs, as paths that hold wherever this process goes; names of packs that come with the program stay names."""
    folders: list[Union[str, os.PathLike[str]]]
    folders = [world] if isinstance(world, (str, os.PathLike)) else list(world)
    return [_pack(os.fspath(folder)) for folder in folders]


def _pack(folder: str) -> str:
    """Where a pack lies; of one that comes with the program its name, as commands take it: a folder of that name comes first."""
    is_name = folder in _native.PACKS and not os.path.exists(folder)
    return folder if is_name else os.path.abspath(folder)


@dataclass(frozen=True, repr=False)
class Mission:
    """A mission of a suite. Printed, it is short: its ``text`` is not."""

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

    def __repr__(self) -> str:
        try:
            cdf = json.loads(self.text.lstrip("\ufeff"))
        except ValueError:
            cdf = None
        scene = cdf.get("scene") if isinstance(cdf, dict) else None
        objects = _count(scene, "required_objects")
        goals = _count(cdf, "task_goals")
        return f"<cohabit.Mission {self.id} on {self.layout or 'any floor plan'}: {objects} objects, {goals} goals>"


def _count(whole: Any, name: str) -> int:
    """How many there are in a list of a mission file."""
    found = whole.get(name) if isinstance(whole, dict) else None
    return len(found) if isinstance(found, list) else 0


class Suite(Sequence[Mission]):
    """Missions in an order. An environment that is given one plays a mission of it in each episode.

    ``world`` are the folders of the world packs that they need: environments take them from there.
    """

    def __init__(self, missions: Sequence[Mission], world: World = ()) -> None:
        if not missions:
            raise ValueError("a suite of 0 missions: at least 1")
        self.missions = tuple(missions)
        self.world = tuple(world_folders(world))

    @overload
    def __getitem__(self, index: int) -> Mission: ...
    @overload
    def __getitem__(self, index: slice) -> Suite: ...
    def __getitem__(self, index: Union[int, slice]) -> Union[Mission, Suite]:
        return Suite(self.missions[index], self.world) if isinstance(index, slice) else self.missions[index]

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
        return Suite([mission for mission in self.missions if mission.type in types], self.world)

    def sample(self, seed: int) -> Mission:
        """The mission that an episode with this seed plays."""
        return self.missions[int(np.random.default_rng([_STREAM, seed]).integers(len(self.missions)))]

    def split(self, share: float = 0.1, seed: int = 0) -> dict[str, Suite]:
        """Parts it for training (``train``) and for tests of what training has (``seen``) and does not have: ``unseen-object``,
        ``unseen-room``, ``unseen-floor-plan``, ``unseen-composition`` and ``unseen-several``. Each part but ``train`` gets about
        that share of the missions; parts without any are left out."""
        if not 0.01 <= share <= 0.2:
            raise ValueError(f"a share of {share}: from 0.01 to 0.2")
        # A mission for which several annotators have words is in one part, with all of them.
        once = {one.text: one for one in self.missions}
        facets = [(one.type, one.layout, list(one.rooms), list(one.things)) for one in once.values()]
        part_of = dict(zip(once, _native.part_missions(facets, share, seed)))
        parts: dict[str, list[Mission]] = {}
        for mission in self.missions:
            parts.setdefault(part_of[mission.text], []).append(mission)
        return {part: Suite(missions, self.world) for part, missions in sorted(parts.items())}

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


def suite(path: Union[None, str, os.PathLike[str]] = None, *, world: World = ()) -> Suite:
    """Reads the missions of a file of missions (``.jsonl``), of a mission file (CDF), of a folder of mission files, or of the
    trajectory data set of Alexa Arena, whose missions have the words of their annotators.

    Raises ``ValueError`` that names the file, the line and what is wrong.

    :param world: the folders of world packs that the missions need. Without a path, the suite is the missions of these packs.
    """
    folders = world_folders(world)
    if path is None:
        if not folders:
            raise ValueError("there is no suite without a path, unless world packs are given")
        packed = [_of_cdf(name, _parsed(text, name)) for name, text in _native.pack_missions(folders)]
        if not packed:
            raise ValueError(f"{', '.join(folders)}: no missions in these world packs")
        return Suite(packed, folders)
    path = Path(path)
    if path.is_dir():
        files = [file for file in sorted(path.glob("*.json")) if file.name != _MANIFEST]
        missions = [_of_cdf(file.stem, _read_json(file)) for file in files]
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
    return Suite(missions, folders)


Missions = Union[Suite, Mission, str, "os.PathLike[str]", Mapping[str, Any], Sequence[Any]]
"""What :func:`suite_of` makes a suite of."""


def suite_of(missions: Missions, world: World = ()) -> Suite:
    """A suite of what somebody calls missions: a suite, a mission, the name of one that is built in or of a world pack, a path
    that :func:`suite` reads, a mission file (CDF) as a dictionary, or a list of these.

    Raises ``ValueError`` for anything else.
    """
    folders = world_folders(world)
    if isinstance(missions, Suite):
        return Suite(missions.missions, folders) if folders else missions
    if isinstance(missions, Mission):
        return Suite([missions], folders)
    if isinstance(missions, Mapping):
        return Suite([_of_cdf("mission", dict(missions))], folders)
    if isinstance(missions, (str, os.PathLike)):
        name = os.fspath(missions)
        if name and Path(name).exists():
            return suite(name, world=folders)
        file, text = _native.mission_text(name, folders)
        return Suite([_of_cdf(file.removesuffix(".json"), _parsed(text, file))], folders)
    if isinstance(missions, Sequence) and not isinstance(missions, (bytes, bytearray)):
        parts = [suite_of(one, folders) for one in missions]
        worlds = sorted({part.world for part in parts})
        if len(worlds) > 1:
            raise ValueError(f"missions of {len(worlds)} worlds: name the world packs that all of them are played with")
        return Suite([mission for part in parts for mission in part], worlds[0] if worlds else ())
    raise ValueError(f"missions are {_shown(missions)}: a suite, a mission, a name, a path, a dictionary, or a list of these")


def _shown(value: Any) -> str:
    """A value in an error, cut off if it is long."""
    shown = repr(value)
    return shown if len(shown) <= 80 else f"{shown[:77]}…"


def generate(
    count: int,
    seed: int = 1,
    types: Optional[Sequence[str]] = None,
    blockers: Optional[float] = None,
    workers: Optional[int] = None,
    *,
    world: World = (),
) -> Suite:
    """Makes missions up: each is checked, solved by the planner and played once. The same seed makes the same ones. Types of which
    drafts were given up, so that fewer of them are made, are told to the logger ``cohabit``, with the reason.

    :param types: of the built-in types, those that are made; all of them, if left out.
    :param blockers: the share of missions in which something stands in the way, from 0 to 1.
    :param workers: threads; one for each core, if left out. They do not change what is made.
    :param world: the folders of world packs, whose objects missions may be made with.
    """
    if count < 1:
        raise ValueError(f"{count} missions: at least 1")
    if blockers is not None and not 0.0 <= blockers <= 1.0:
        raise ValueError(f"a share of {blockers} blockers: from 0 to 1")
    folders, named = world_folders(world), None if types is None else list(types)
    lines, given_up = _native.generate_missions(count, seed, named, blockers, workers or cores(), folders)
    for kind, missed, reason in given_up:
        _LOG.warning("%s: %s given up, the last because %s", kind, missed, reason)
    return Suite([_of_line(line, "generate") for line in lines], folders)


def cores() -> int:
    """The cores that this process may run on."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _read(path: Path) -> str:
    try:
        return path.read_text()
    except (OSError, UnicodeDecodeError) as error:
        raise ValueError(f"{path}: {error}") from None


def _read_json(path: Path) -> Any:
    return _parsed(_read(path), str(path))


def _parsed(text: str, name: str) -> Any:
    try:
        # Editors of another system put a byte order mark before the text.
        return json.loads(text.lstrip("\ufeff"))
    except json.JSONDecodeError as error:
        raise ValueError(f"{name}:{error.lineno}: {error.msg}") from None


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
