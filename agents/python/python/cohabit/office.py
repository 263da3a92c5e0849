"""What environments of one and of many bodies have in common: a world in this process, and what its bodies sense.

Observations are dictionaries. Pictures are those of each body's camera; all else is small:

===================  ======================  =================================================================
``color``            ``[H, W, 4]`` u1        red, green, blue, 255; the arrays of pictures are read-only views
``depth``            ``[H, W]`` f4           metres along the camera's axis
``normals``          ``[H, W, 4]`` i1        the surface's normal in the world, times 127, and 0
``ids``              ``[H, W]`` u4           whose pixel it is; objects in view are those in ``slot_ids``
``position``         ``[3]`` f4              where the body stands, m
``heading``          ``[2]`` f4              its yaw and the pitch of its head, rad
``room``             0 to 7                  an index into ``cohabit.ROOMS``
``held``             0 to classes            1 + an index into ``cohabit.CLASSES``; 0 is nothing
``busy``             0, 1                    whether it still carries out a command
``goals``            ``[16]`` 0, 1           which goals are met
``slot_ids``         ``[S]`` u4              the id of each slot's object in the id plane; 0 is empty
``slot_classes``     ``[S]`` i8              its class, as ``held``
``slot_positions``   ``[S, 3]`` f4           where it is from the body: ahead, to the left, up, m
``slot_states``      ``[S, 25]`` 0, 1        its states, in the order of ``cohabit.FLAGS``
===================  ======================  =================================================================

A panorama's planes have four pictures, ``[4, H, W, …]``: ahead, right, back, left.
"""

from __future__ import annotations

import json
import os
import time
from collections.abc import Mapping, Sequence
from typing import Any, Optional, Protocol, Union

import gymnasium
import numpy as np
import numpy.typing as npt
from gymnasium import spaces

from . import _native
from .records import NONE
from .session import Session

MissionLike = Union[None, str, "os.PathLike[str]", Mapping[str, Any]]
"""A built-in mission's name, a CDF file's path, or a CDF as a dictionary; ``None`` is the default mission."""

Observation = dict[str, Any]
ActionMask = tuple[npt.NDArray[np.int8], npt.NDArray[np.int8]]

PLANES = ("color", "depth", "normals", "ids")
"""The planes there are."""

CHOICES: tuple[str, ...] = tuple(name for name, _ in _native.CHOICES)
"""The kinds of actions of environments, by their numbers."""

OPTIONS = ("mission", "layout", "seed")
"""What ``reset(options=…)`` takes, for the episode that begins: another ``mission``, another ``layout`` (the floor plan, such
as ``"OfficeLayout2_mirror"``), and the ``seed`` of what is placed at random, also where the mission has a seed of its own."""

MOST_GOALS = 16
"""Goals that an observation tells of."""

_LONG_TICKS = 60 * 240
_WAIT_TICKS = 60
_FARTHEST_M = 1000.0
_CLASSES = len(_native.class_ids())
_PLANE_SPACES: dict[str, tuple[float, float, tuple[int, ...], Any]] = {
    "color": (0, 255, (4,), np.uint8),
    "depth": (0.0, np.inf, (), np.float32),
    "normals": (-128, 127, (4,), np.int8),
    "ids": (0, 2**32 - 1, (), np.uint32),
}
_VIEWS = {"panorama": 4}


class World(Protocol):
    """What :class:`Office` needs of a world: one in this process, or that of a session."""

    def kinds(self) -> list[str]:
        """The kinds of all bodies that are played."""

    def reset(self, seed: int) -> None:
        """Begins anew."""

    def act(self, actions: list[tuple[int, _native.Action]], ticks: Optional[int] = None) -> list[_native.Outcome]:
        """Has bodies carry out actions until all have ended, or for so many ticks."""

    def choose(self, choices: list[tuple[int, int, int]], ticks: Optional[int] = None) -> list[_native.Outcome]:
        """The same with ``(body, choice, slot)``."""

    def look(self, cameras: list[str]) -> list[_native.Frame]:
        """What cameras see."""

    def sense(self, bodies: list[int], slots: int, filling: str, frames: list[_native.Frame]) -> list[_native.Senses]:
        """What bodies sense besides pictures."""

    def progress(self) -> tuple[int, int, str, list[tuple[int, bool]]]:
        """Tick, score, ending, and goals with whether they are met."""

    def state(self) -> _native.State:
        """The state of the world."""


class Guest:
    """The world of a session, as one body takes part in it; in lock-step, if the session is."""

    def __init__(
        self, session: Session, camera: Optional[str], planes: Sequence[str], size: tuple[int, int]
    ) -> None:
        if camera is not None:
            told = {name: (width, height, has) for name, _, width, height, has in session.peer.cameras}
            if camera not in told:
                raise ValueError(f"session `{session.peer.name}` has no camera `{camera}`: {', '.join(told)}")
            width, height, has = told[camera]
            if (width, height) != size or not set(planes) <= set(has):
                raise ValueError(f"camera `{camera}` has pictures of {width}x{height} of {', '.join(has)}")
        self.session = session
        self._slots: npt.NDArray[np.uint32] = np.zeros(0, np.uint32)
        self._camera = camera
        self._begun = False
        self._frame: Optional[_native.Frame] = None
        self._pending: Optional[_native.Command] = None

    def kinds(self) -> list[str]:
        """The kind of the body that is played."""
        return [self.session.state().bodies[self.session.body].kind]

    def reset(self, seed: int) -> None:
        """A session's world goes on as it is."""
        if not self._begun:
            self.session.claim(self.session.take_over)
            if self.session.peer.lock_step:
                if self._camera is not None:
                    # A camera is drawn from the turn on after somebody first looks through it.
                    self.session.peer.open_camera(self._camera)
                self.session.attend()
            self._begun = True

    def act(self, actions: list[tuple[int, _native.Action]], ticks: Optional[int] = None) -> list[_native.Outcome]:
        """Has the body carry out an action until it has ended, or for so many ticks."""
        peer, lock_step = self.session.peer, self.session.peer.lock_step
        if lock_step:
            self.session.check_alone()
        for _, action in actions:
            self._pending = peer.act(action)
        last = self.session.state().tick + (ticks or (_LONG_TICKS if self._pending else _WAIT_TICKS))
        while True:
            if lock_step:
                tick = self.session.step(max(1, last - self.session.state().tick))
            else:
                time.sleep(1 / 60)
                tick = self.session.state().tick
            outcome = self._pending.poll() if self._pending else None
            if outcome is not None:
                self._pending = None
                if ticks is None:
                    return [outcome]
            if tick >= last or self.session.state().ending != "running":
                return [] if outcome is None else [outcome]

    def choose(self, choices: list[tuple[int, int, int]], ticks: Optional[int] = None) -> list[_native.Outcome]:
        """The same with ``(body, choice, slot)``."""
        actions = []
        for body, choice, slot in choices:
            number = int(self._slots[slot]) - 1 if slot < len(self._slots) and self._slots[slot] else NONE
            action = _native.choice_action(choice, number)
            if action is not None:
                actions.append((body, action))
        return self.act(actions, ticks)

    def look(self, cameras: list[str]) -> list[_native.Frame]:
        """What a camera saw last; in a turn in lock-step, what it sees."""
        (camera,) = cameras
        last, tick = self._frame, self.session.state().tick
        if last is None or last.tick != tick or not self.session.peer.lock_step:
            self._frame = last = self.session.look(camera)
        return [last]

    def sense(self, bodies: list[int], slots: int, filling: str, frames: list[_native.Frame]) -> list[_native.Senses]:
        """What the body senses besides pictures."""
        senses = self.session.peer.sense(slots, filling, frames[0] if frames else None)
        self._slots = senses.ids
        return [senses]

    def progress(self) -> tuple[int, int, str, list[tuple[int, bool]]]:
        """Tick, score, ending, and goals with whether they are met."""
        state = self.session.state()
        return state.tick, state.score, state.ending, [(goal.number, goal.met) for goal in state.goals]

    def state(self) -> _native.State:
        """The state of the world."""
        return self.session.state()


class Office:
    """A world in this process, stepped only when it is told to.

    :param mission: what is played.
    :param bodies: bodies beside the mission's robot, such as ``"person@Lab1"``.
    :param planes: of :data:`PLANES`, those that are observed; none for states alone, which is much faster.
    :param camera: a kind of camera with options, as ``cohabit play --camera`` takes them after the name:
        ``"egocentric"``, ``"panorama,fov=100"``.
    :param size: width and height of a picture, or one number.
    :param slots: objects that a body can choose from at once.
    :param fill: what fills them: ``"seen"`` in the body's picture, the largest first; ``"near"``, what is not hidden in its
        room, the nearest first; ``"all"``, by number. Left out, it is ``"seen"`` where there are pictures, else ``"near"``.
    :param render: width and height of :meth:`render`'s pictures, if any are wanted.
    :param threads: threads that draw.
    :param session: a session that was joined, whose world it is instead; ``mission``, ``bodies`` and ``threads`` say nothing
        then, ``camera`` is the name of one of its cameras (``"egocentric"`` for the body's own), and ``size`` that camera's.
    """

    def __init__(
        self,
        mission: MissionLike,
        bodies: Sequence[str],
        planes: Sequence[str],
        camera: str,
        size: Union[int, tuple[int, int]],
        slots: int,
        fill: Optional[str],
        render: Optional[tuple[int, int]],
        threads: int,
        session: Optional[Session] = None,
    ) -> None:
        unknown = [plane for plane in planes if plane not in PLANES]
        if unknown:
            raise ValueError(f"there is no plane `{unknown[0]}`: {', '.join(PLANES)}")
        if not 1 <= slots <= 4096:
            raise ValueError(f"{slots} slots: 1 to 4096")
        self.planes = tuple(plane for plane in PLANES if plane in planes)
        self.slots = slots
        self.fill = fill or ("seen" if self.planes else "near")
        self.size = (size, size) if isinstance(size, int) else size
        self.kind = camera.split(",", 1)[0]
        drawn = self.planes + (("ids",) if self.fill == "seen" and "ids" not in self.planes else ())
        self._drawn = bool(drawn)
        count = 1 + len(bodies)
        self._session_camera = camera if session is not None else None
        cameras = [self._camera(body, camera, drawn) for body in range(count)] if drawn and session is None else []
        if render is not None:
            cameras += [
                f"watch-{body}=third-person,body={body},size={render[0]}x{render[1]},planes=color" for body in range(count)
            ]
        self._mission = mission
        self._played: tuple[MissionLike, Optional[str], Optional[int]] = (mission, None, None)
        self._bodies, self._cameras, self._threads = list(bodies), cameras, threads
        self._has_begun = False
        self.world: World
        if session is None:
            self.world = self._stage(*self._played)
        else:
            self.world = Guest(session, self._eyes(session.body) if drawn else None, drawn, self.size)
        self.kinds = tuple(self.world.kinds())
        self.observation_space = self._observation_space()
        self.action_space = spaces.MultiDiscrete([len(CHOICES), slots])

    def _stage(self, mission: MissionLike, layout: Optional[str], seed: Optional[int]) -> _native.Stage:
        name, text = _mission(mission)
        if layout is not None or seed is not None:
            name, text = _changed(name, text, layout, seed)
        return _native.Stage(name, text, self._bodies, self._cameras, 0, self._threads)

    def begin(self, seed: int, options: Optional[Mapping[str, Any]]) -> None:
        """Begins the mission anew, or another one that ``options`` name. Raises ``ValueError`` if they name anything else."""
        played = self._chosen(options or {})
        if played != self._played:
            self.world = self._stage(*played)
            self._played = played
        self.world.reset(seed)
        self._has_begun = True

    def check_begun(self, method: str) -> None:
        """Raises :class:`gymnasium.error.ResetNeeded` before the first :meth:`begin`."""
        if not self._has_begun:
            raise gymnasium.error.ResetNeeded(f"Cannot call env.{method}() before calling env.reset()")

    def unknown_option(self, options: Mapping[str, Any]) -> Optional[str]:
        """What is wrong with the first option that :meth:`begin` does not take; nothing if it takes all."""
        known = () if isinstance(self.world, Guest) else OPTIONS
        takes = "one of " + ", ".join(known) if known else "none, for the world of a session goes on as it is"
        unknown = next((name for name in options if name not in known), None)
        return None if unknown is None else f"there is no option `{unknown}` of reset: {takes}"

    def _chosen(self, options: Mapping[str, Any]) -> tuple[MissionLike, Optional[str], Optional[int]]:
        """The mission, layout and seed of the next episode."""
        if (unknown := self.unknown_option(options)) is not None:
            raise ValueError(unknown)
        mission, layout, seed = options.get("mission", self._mission), options.get("layout"), options.get("seed")
        if layout is not None and not isinstance(layout, str):
            raise ValueError(f"option `layout` is {layout!r}: the id of a floor plan, such as `OfficeLayout2`")
        if seed is not None and (isinstance(seed, bool) or not isinstance(seed, (int, np.integer)) or seed < 0):
            raise ValueError(f"option `seed` is {seed!r}: a number from 0 up")
        return mission, layout, None if seed is None else int(seed)

    def _eyes(self, body: int) -> str:
        """The camera that a body sees by."""
        if self._session_camera is None:
            return f"sense-{body}"
        return f"egocentric/{body}" if self._session_camera == "egocentric" else self._session_camera

    def _camera(self, body: int, camera: str, planes: Sequence[str]) -> str:
        kind, _, options = camera.partition(",")
        width, height = self.size
        own = [f"size={width}x{height}", f"planes={'+'.join(planes)}", *([options] if options else [])]
        if kind != "fixed" and "body=" not in options:
            own.append(f"body={body}")
        return f"sense-{body}={kind},{','.join(own)}"

    def _observation_space(self) -> spaces.Dict:
        width, height = self.size
        views = (_VIEWS[self.kind],) if self.kind in _VIEWS else ()
        parts: dict[str, gymnasium.Space[Any]] = {}
        for plane in self.planes:
            low, high, channels, dtype = _PLANE_SPACES[plane]
            parts[plane] = spaces.Box(low, high, (*views, height, width, *channels), dtype)
        parts["position"] = spaces.Box(-_FARTHEST_M, _FARTHEST_M, (3,), np.float32)
        parts["heading"] = spaces.Box(-2 * np.pi, 2 * np.pi, (2,), np.float32)
        parts["room"] = spaces.Discrete(len(_native.ROOMS))
        parts["held"] = spaces.Discrete(_CLASSES + 1)
        parts["busy"] = spaces.Discrete(2)
        parts["goals"] = spaces.MultiBinary(MOST_GOALS)
        parts["slot_ids"] = spaces.Box(0, 2**32 - 1, (self.slots,), np.uint32)
        parts["slot_classes"] = spaces.Box(0, _CLASSES, (self.slots,), np.int64)
        parts["slot_positions"] = spaces.Box(-_FARTHEST_M, _FARTHEST_M, (self.slots, 3), np.float32)
        parts["slot_states"] = spaces.MultiBinary((self.slots, len(_native.FLAGS)))
        return spaces.Dict(parts)

    def observe(self, bodies: Sequence[int]) -> tuple[list[Observation], list[dict[str, Any]]]:
        """What each of these bodies observes, and what may be known beyond it."""
        frames: Sequence[Optional[_native.Frame]]
        frames = self.world.look([self._eyes(body) for body in bodies]) if self._drawn else [None] * len(bodies)
        tick, score, ending, goals = self.world.progress()
        met = np.zeros(MOST_GOALS, np.int8)
        for index, (_, is_met) in enumerate(goals[:MOST_GOALS]):
            met[index] = is_met
        seen = [frame for frame in frames if frame is not None] if self.fill == "seen" else []
        observations, infos = [], []
        for frame, senses in zip(frames, self.world.sense(list(bodies), self.slots, self.fill, seen)):
            observation: Observation = {}
            if frame is not None:
                for plane in self.planes:
                    observation[plane] = frame[plane]
            observation["position"] = senses.position
            observation["heading"] = np.array([senses.yaw_rad, senses.head_pitch_rad], np.float32)
            observation["room"] = senses.room
            observation["held"] = senses.held_class
            observation["busy"] = int(senses.busy)
            observation["goals"] = met
            observation["slot_ids"] = senses.ids
            observation["slot_classes"] = senses.classes
            observation["slot_positions"] = senses.positions
            observation["slot_states"] = senses.flags
            observations.append(observation)
            info = {"tick": tick, "score": score, "ending": ending, "goals": dict(goals)}
            info["affordances"] = senses.afforded
            info["action_mask"] = _mask(senses)
            infos.append(info)
        return observations, infos

    def progress(self) -> tuple[int, bool]:
        """The score, and whether the mission is over."""
        _, score, ending, _ = self.world.progress()
        return score, ending != "running"

    def render(self, body: int) -> npt.NDArray[np.uint8]:
        """What somebody behind a body sees, ``[H, W, 3]``."""
        (frame,) = self.world.look([f"watch-{body}"])
        return np.ascontiguousarray(frame.color[..., :3])


def _mask(senses: _native.Senses) -> ActionMask:
    """Which choices and which slots make sense, as ``MultiDiscrete.sample`` takes them."""
    kinds = np.asarray(senses.afforded.any(axis=1), np.int8)
    slots = np.asarray(senses.ids != 0, np.int8)
    if not slots.any():
        # Something must be chosen, also by those that need nothing.
        slots[0] = 1
    return kinds, slots


def _mission(mission: MissionLike) -> tuple[Optional[str], Optional[str]]:
    """A mission's name, and its text if it is none that can be found by it."""
    if mission is None or isinstance(mission, str):
        return mission, None
    if isinstance(mission, Mapping):
        return "mission", json.dumps(mission)
    return os.fspath(mission), None


def _changed(
    name: Optional[str], text: Optional[str], layout: Optional[str], seed: Optional[int]
) -> tuple[str, str]:
    """A mission's name and text, on another layout or with another seed."""
    if name is None or text is None:
        name, text = _native.mission_text(name)
    try:
        cdf = json.loads(text)
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None
    # What is no mission is left as it is: whoever reads it next says what is wrong with it.
    if isinstance(cdf, dict) and isinstance(cdf.get("scene"), dict):
        if layout is not None:
            cdf["scene"]["layoutOverride"] = layout
        if seed is not None:
            cdf["scene"]["floor_plan"] = str(seed)
    return name, json.dumps(cdf)


def check_steps(render_mode: Optional[str], ticks_per_step: Optional[int]) -> None:
    """Raises ``ValueError`` if an environment cannot be shown or stepped like that."""
    if render_mode not in (None, "rgb_array"):
        raise ValueError(f"there is no render_mode `{render_mode}`: rgb_array")
    if ticks_per_step is not None and ticks_per_step < 1:
        raise ValueError(f"{ticks_per_step} ticks a step: at least 1")


def outcome_info(outcomes: Sequence[_native.Outcome], body: int) -> dict[str, Any]:
    """What came of a body's command, if it ended: ``status`` and ``detail``."""
    for outcome in outcomes:
        if outcome.body == body:
            return {"status": outcome.status, "detail": outcome.detail}
    return {"status": "", "detail": ""}
