"""What environments of one and of many bodies have in common: a world in this process, and what its bodies sense.

Observations are dictionaries. Pictures are those of each body's camera; all else is small:

===================  ======================  =================================================================
``color``            ``[H, W, 4]`` u1        red, green, blue, 255; the arrays of pictures are read-only views
``depth``            ``[H, W]`` f4           metres along the camera's axis
``normals``          ``[H, W, 4]`` i1        the surface's normal in the world, times 127, and 0
``ids``              ``[H, W]`` u4           whose pixel it is; objects in view are those in ``slot_ids``
``position``         ``[3]`` f4              where the body stands, m
``heading``          ``[2]`` f4              its yaw and the pitch of its head, rad
``room``             0 to rooms              an index into ``cohabit.ROOMS``, then those of world packs
``held``             0 to classes            1 + an index into ``cohabit.CLASSES``; 0 is nothing
``busy``             0, 1                    whether it still carries out a command
``goals``            ``[16]`` 0, 1           which goals are met
``slot_ids``         ``[S]`` u4              the id of each slot's object in the id plane; 0 is empty
``slot_classes``     ``[S]`` i8              its class, as ``held``
``slot_positions``   ``[S, 3]`` f4           where it is from the body: ahead, to the left, up, m
``slot_states``      ``[S, 28]`` 0, 1        its states, in the order of ``cohabit.FLAGS``
``instruction``      text                    what the robot is told to do, if it is asked for
===================  ======================  =================================================================

A panorama's planes have four pictures, ``[4, H, W, …]``: ahead, right, back, left.
"""

from __future__ import annotations

import copy
import json
import os
import time
from collections.abc import Mapping, Sequence
from typing import Any, Optional, Protocol, Union

import gymnasium
import numpy as np
import numpy.typing as npt

from . import _native
from .actions import Known, Names
from .missions import Mission, Suite, World as Packs, instruction_of, world_folders
from .records import NONE
from .sensing import CHOICES, MOST_GOALS, PLANES, Sensing, observable
from .session import Session

__all__ = ["CHOICES", "OPTIONS", "PLANES", "MissionLike", "Observation", "Office"]

MissionLike = Union[None, str, "os.PathLike[str]", Mapping[str, Any], Mission, Suite]
"""A built-in mission's name, a CDF file's path, a CDF as a dictionary, a mission of a suite, or a suite, of which a mission is
sampled for each episode; ``None`` is the default mission."""

Observation = dict[str, Any]
ActionMask = tuple[npt.NDArray[np.int8], npt.NDArray[np.int8]]

OPTIONS = ("mission", "layout", "seed")
"""What ``reset(options=…)`` takes, for the episode that begins: another ``mission``, another ``layout`` (the floor plan, such
as ``"OfficeLayout2_mirror"``), and the ``seed`` of what is placed at random, also where the mission has a seed of its own."""

_LONG_TICKS = 60 * 240
_WAIT_TICKS = 60


class World(Protocol):
    """What :class:`Office` needs of a world: one in this process, or that of a session."""

    def kinds(self) -> list[str]:
        """The kinds of all bodies that are played."""

    def reset(self, seed: int, mission: Optional[str] = None, text: Optional[str] = None) -> None:
        """Begins anew, with another mission, if one is given."""

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

    def reset(self, seed: int, mission: Optional[str] = None, text: Optional[str] = None) -> None:
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
        outcome: Optional[_native.Outcome] = None
        while True:
            if lock_step:
                tick = self.session.step(max(1, last - self.session.state().tick))
            else:
                time.sleep(1 / 60)
                tick = self.session.state().tick
            if self._pending is not None and (outcome := self._pending.poll()) is not None:
                # It is told as the step ends, however early it came.
                self._pending = None
                if ticks is None:
                    return [outcome]
            if tick >= last or self.session.state().ending != "running":
                return [] if outcome is None else [outcome]

    def choose(self, choices: list[tuple[int, int, int]], ticks: Optional[int] = None) -> list[_native.Outcome]:
        """The same with ``(body, choice, slot)``."""
        actions = []
        for body, choice, slot in choices:
            number = int(self._slots[slot]) - 1 if 0 <= slot < len(self._slots) and self._slots[slot] else NONE
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
        room, the nearest first; ``"all"``, by number. Left out, it is ``"seen"`` where ``ids`` are observed, else ``"near"``: ids
        that nobody asked for are not drawn.
    :param render: width and height of :meth:`render`'s pictures, if any are wanted.
    :param threads: threads that draw.
    :param session: a session that was joined, whose world it is instead; ``mission``, ``bodies`` and ``threads`` say nothing
        then, ``camera`` is the name of one of its cameras (``"egocentric"`` for the body's own), and ``size`` that camera's.
    :param randomize: whether what a mission places at random follows from the seed of each episode even where the mission has
        a seed of its own, as the built-in ones do.
    :param instruction: whether an observation has what the robot is told to do; it is in the info in any case.
    :param knows: which objects an action in words may name: ``"everything"`` there is, or what the body has ``"seen"`` in this
        episode: what was in its slots, in its pictures (if they have ids), or in its hand.
    :param world: the folder of a world pack, or the name of one that comes with the program (``"homes"``), or several in their
        order: floor plans, objects, devices and missions beside the built-in ones. Left out, it is that of the suite that is played.
    :param many: whether all bodies are played, those of the mission too.
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
        randomize: bool = False,
        instruction: bool = False,
        knows: str = "everything",
        world: Packs = (),
        many: bool = False,
    ) -> None:
        check_knows(knows)
        self.packs = packs_of(mission, world)
        if session is not None and self.packs:
            raise ValueError("the world of a session is as it was started: there are no world packs to give")
        self.classes = tuple(_native.class_ids(self.packs))
        """The ids of all classes of objects, by their numbers."""
        self.rooms = tuple(_native.room_ids(self.packs))
        """The ids of all rooms, by their numbers."""
        self.sensing = Sensing(planes, camera, size, slots, fill, instruction, len(self.classes), len(self.rooms))
        self.planes, self.slots, self.fill = self.sensing.planes, slots, self.sensing.fill
        self.knows = knows
        self._session_camera = camera if session is not None else None
        self._mission = as_it_is(mission)
        first = self._mission[0] if isinstance(self._mission, Suite) else self._mission
        self._played: Played = (first, None, None)
        self._randomize = randomize
        self._beside = len(bodies) if many else None
        self._has_begun = False
        self._known: dict[int, set[int]] = {}
        self.mission_name, self.instruction = "", ""
        self.world: World
        if session is None:
            name, text = mission_text(*self._played, packs=self.packs)
            count = 1 + len(bodies)
            if many:
                # All bodies are played, and a mission may have several robots of its own.
                count = len(_native.Stage(name, text, list(bodies), [], 0, threads, randomize, self.packs).kinds())
            cameras = self.sensing.cameras(count, render)
            self.world = _native.Stage(name, text, list(bodies), cameras, 0, threads, randomize, self.packs)
            self._told(name, text)
        else:
            drawn = self.sensing.drawn
            self.world = Guest(session, self._eyes(session.body) if drawn else None, drawn, self.sensing.size)
            self.mission_name = session.peer.mission
            self.instruction = instruction_in(None, session.peer.mission_text)
        self.kinds = tuple(self.world.kinds())
        self.observation_space = self.sensing.observation_space()
        self.action_space = self.sensing.action_space()

    def _told(self, name: str, text: str) -> None:
        """Notes what is played."""
        self.mission_name, self.instruction = name, instruction_in(self._played[0], text)

    def begin(self, seed: int, options: Optional[Mapping[str, Any]]) -> None:
        """Begins the mission anew, or another one that ``options`` name. Raises ``ValueError`` if they name anything else."""
        played = self._chosen(options or {}, seed)
        if self._randomize and played[2] is not None:
            seed = played[2]
        if played != self._played:
            name, text = mission_text(*played, packs=self.packs)
            self._check_bodies(name, text)
            self.world.reset(seed, name, text)
            self._played = played
            self._told(name, text)
        else:
            self.world.reset(seed)
        self._known.clear()
        self._has_begun = True

    def _check_bodies(self, name: str, text: str) -> None:
        """Raises ``ValueError`` if all bodies are played, and a mission has more or fewer of them than there are agents."""
        robots = _robots(text)
        if self._beside is None or robots is None:
            return
        count = robots + self._beside
        if count != len(self.kinds):
            raise ValueError(
                f"mission `{name}` has {count} bodies, and this environment has {len(self.kinds)} agents: "
                "play missions with as many robots in it, and others in an environment of their own"
            )

    def names(self, body: int) -> Names:
        """What an action in words of a body may name."""
        state = self.world.state()
        return state if self.knows == "everything" else Known(state, self._known.get(body, set()))

    def _remember(self, body: int, senses: _native.Senses, frame: Optional[_native.Frame]) -> None:
        """Notes which objects a body has seen by now."""
        known = self._known.setdefault(body, set())
        known.update(int(number) - 1 for number in senses.ids if number)
        if frame is not None:
            known.update(thing.object for thing in frame.seen if thing.object is not None)
        held = self.world.state().bodies[body].held
        if held is not None:
            known.add(held)

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

    def _chosen(self, options: Mapping[str, Any], episode: int) -> Played:
        """The mission, layout and seed of the next episode."""
        if (unknown := self.unknown_option(options)) is not None:
            raise ValueError(unknown)
        mission = as_it_is(options["mission"]) if "mission" in options else self._mission
        layout, seed = options.get("layout"), options.get("seed")
        if isinstance(mission, Suite):
            mission = mission.sample(episode)
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

    def observe(self, bodies: Sequence[int]) -> tuple[list[Observation], list[dict[str, Any]]]:
        """What each of these bodies observes, and what may be known beyond it."""
        frames: Sequence[Optional[_native.Frame]]
        frames = self.world.look([self._eyes(body) for body in bodies]) if self.sensing.drawn else [None] * len(bodies)
        tick, score, ending, goals = self.world.progress()
        met = np.zeros(MOST_GOALS, np.int8)
        for index, (_, is_met) in enumerate(goals[:MOST_GOALS]):
            met[index] = is_met
        seen = [frame for frame in frames if frame is not None] if self.fill == "seen" else []
        observations, infos = [], []
        sensed = self.world.sense(list(bodies), self.slots, self.fill, seen)
        for body, frame, senses in zip(bodies, frames, sensed):
            if self.knows == "seen":
                self._remember(body, senses, frame)
            observation: Observation = {}
            if frame is not None:
                for plane in self.planes:
                    observation[plane] = _own(frame[plane]) if isinstance(self.world, Guest) else frame[plane]
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
            if self.sensing.instruction:
                observation["instruction"] = observable(self.instruction)
            observations.append(observation)
            info = {"tick": tick, "score": score, "ending": ending, "goals": dict(goals)}
            info["mission"], info["instruction"] = self.mission_name, self.instruction
            info["affordances"] = senses.afforded
            info["action_mask"] = mask = _mask(senses)
            info["action_masks"] = np.concatenate(mask).astype(np.bool_)
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


def _own(plane: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """A picture in memory of its own: of a camera of a session no more than eight can be held, and who trains keeps more."""
    own = plane.copy()
    own.flags.writeable = False
    return own


def _mask(senses: _native.Senses) -> ActionMask:
    """Which choices and which slots make sense, as ``MultiDiscrete.sample`` takes them."""
    kinds = np.asarray(senses.afforded.any(axis=1), np.int8)
    slots = np.asarray(senses.ids != 0, np.int8)
    if not slots.any():
        # Something must be chosen, also by those that need nothing.
        slots[0] = 1
    return kinds, slots


Played = tuple[MissionLike, Optional[str], Optional[int]]
"""A mission, the layout that it is moved to, and the seed that it is given, if any is."""


def packs_of(mission: MissionLike, world: Packs) -> list[str]:
    """The folders of the world packs that a mission is played with: those that are given, else those of its suite."""
    folders = world_folders(world)
    return list(mission.world) if isinstance(mission, Suite) and not folders else folders


def as_it_is(mission: MissionLike) -> MissionLike:
    """A mission as it is now: whoever gave a dictionary may change it, and give it again."""
    return copy.deepcopy(dict(mission)) if isinstance(mission, Mapping) else mission


def _robots(text: str) -> Optional[int]:
    """How many robots a mission (CDF) has: one, if it does not say; nothing, where it cannot be read."""
    try:
        scene = json.loads(text.lstrip("\ufeff"))["scene"]
        return max(1, len(scene.get("simbot_init") or ()))
    except (AttributeError, KeyError, TypeError, ValueError):
        # Whoever plays it says what is wrong with it.
        return None


def mission_text(
    mission: MissionLike, layout: Optional[str] = None, seed: Optional[int] = None, *, packs: Sequence[str] = ()
) -> tuple[str, str]:
    """A mission's name and text, on another layout or with another seed."""
    if isinstance(mission, Suite):
        raise ValueError("a suite has many missions: one of them, such as suite[0]")
    if isinstance(mission, Mission):
        name, text = mission.id, mission.text
    elif isinstance(mission, Mapping):
        name, text = "mission", json.dumps(mission)
    elif mission is None or isinstance(mission, (str, os.PathLike)):
        name, text = _native.mission_text(None if mission is None else os.fspath(mission), list(packs))
    else:
        kinds = "a name, a path, a dictionary, a mission of a suite, or a suite"
        raise ValueError(f"a mission is {kinds}, not of type {type(mission).__name__}")
    return (name, text) if layout is None and seed is None else _changed(name, text, layout, seed)


def instruction_in(mission: MissionLike, text: str) -> str:
    """What the robot is told to do in a mission of that text."""
    if isinstance(mission, Mission):
        return mission.instruction
    try:
        return instruction_of(json.loads(text.lstrip("\ufeff")))
    except ValueError:
        # Whoever plays it says what is wrong with it.
        return ""


def _changed(name: str, text: str, layout: Optional[str], seed: Optional[int]) -> tuple[str, str]:
    """A mission's name and text, on another layout or with another seed."""
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


def check_knows(knows: str) -> None:
    """Raises ``ValueError`` if nobody can know that."""
    if knows not in ("everything", "seen"):
        raise ValueError(f"nobody knows `{knows}`: everything or seen")


def outcome_info(outcomes: Sequence[_native.Outcome], body: int) -> dict[str, Any]:
    """What came of a body's command, if it ended: ``status`` and ``detail``."""
    for outcome in outcomes:
        if outcome.body == body:
            return {"status": outcome.status, "detail": outcome.detail}
    return {"status": "", "detail": ""}
