"""Many environments that are stepped in one call by native threads, in the shape of gymnasium's vector environments."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Optional, Union

import gymnasium
import numpy as np
import numpy.typing as npt
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode, VectorEnv as _Base
from gymnasium.vector.utils import batch_space

from . import _native
from .actions import Action, Known, Names
from .missions import Suite, World, cores
from .office import (
    OPTIONS,
    MissionLike,
    Observation,
    as_it_is,
    check_knows,
    check_steps,
    instruction_in,
    mission_text,
    packs_of,
)
from .sensing import CHOICES, Sensing, checked_actions, observable, sample_actions

Step = tuple[Observation, npt.NDArray[np.float64], npt.NDArray[np.bool_], npt.NDArray[np.bool_], dict[str, Any]]
Beginning = tuple[int, int, Optional[tuple[Optional[str], Optional[str]]]]
Told = tuple[list[npt.NDArray[np.uint8]], list[str], list[str], list[str]]
Outcomes = tuple[list[str], list[str], list[str]]
"""Of each world the status and the detail of its command, and its ending."""

_NUMBERS = ("tick", "score", "affordances", "action_masks")
"""The arrays that are told in infos."""

_TEXTS = ("status", "detail", "ending", "mission", "instruction")
"""What is told there in words."""

_TOLD_OF_ALL = tuple(f"_{name}" for name in (*_NUMBERS, *_TEXTS))
"""Gymnasium's names for which worlds these are told of: all."""


class VectorEnv(_Base[Observation, npt.NDArray[np.int64], npt.NDArray[Any]]):
    """``num_envs`` worlds with one body each. World by world and step by step, they are what as many :class:`cohabit.Env` are.

    Observations are arrays of a row for each world, written by the threads that step the worlds; ``infos["action_masks"]`` is
    ``[N, choices + slots]``, and :meth:`action_masks` the same; :meth:`sample` draws actions by them. Arrays are read-only. Their
    memory is used again once nobody refers to it, so they can be kept as long as one likes; who keeps one that is no picture keeps
    all of the step's that are none.

    :param mission: what is played: a mission, or a suite, of which each world samples one for each episode by its seed.
    :param threads: threads that step and draw; one for each core that this process may run on, if left out.
    :param autoreset_mode: when an episode begins after another: in the ``NextStep`` (gymnasium's default, whose action is
        ignored for that world), in the ``SameStep`` (``infos["final_obs"]`` and ``infos["final_info"]`` are of the episode that
        ended), or ``Disabled``: when ``reset(options={"reset_mask": …})`` says so.

    All other parameters are those of :class:`cohabit.Env`, and so are scores and rewards.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 10, "autoreset_mode": AutoresetMode.NEXT_STEP}  # noqa: RUF012

    def __init__(
        self,
        mission: MissionLike = None,
        num_envs: int = 1,
        *,
        bodies: Sequence[str] = (),
        planes: Sequence[str] = ("color", "depth", "normals", "ids"),
        camera: str = "egocentric",
        size: Union[int, tuple[int, int]] = 300,
        slots: int = 32,
        fill: Optional[str] = None,
        max_steps: int = 200,
        ticks_per_step: Optional[int] = None,
        render_mode: Optional[str] = None,
        render_size: tuple[int, int] = (640, 360),
        threads: Optional[int] = None,
        randomize: bool = False,
        instruction: bool = False,
        knows: str = "everything",
        world: World = (),
        autoreset_mode: Union[str, AutoresetMode] = AutoresetMode.NEXT_STEP,
    ) -> None:
        if num_envs < 1:
            raise ValueError(f"{num_envs} environments: at least 1")
        check_steps(render_mode, ticks_per_step)
        check_knows(knows)
        self.autoreset_mode = AutoresetMode(autoreset_mode)
        self.metadata = {**self.metadata, "autoreset_mode": self.autoreset_mode}
        self.num_envs = num_envs
        self.render_mode = render_mode
        self._packs = packs_of(mission, world)
        self.classes = tuple(_native.class_ids(self._packs))
        """The ids of all classes of objects, by their numbers: ``cohabit.CLASSES``, then those of world packs."""
        self.rooms = tuple(_native.room_ids(self._packs))
        """The ids of all rooms, by their numbers: ``cohabit.ROOMS``, then those of world packs."""
        sensing = Sensing(planes, camera, size, slots, fill, instruction, len(self.classes), len(self.rooms))
        self.knows = knows
        self._mission, self._randomize = as_it_is(mission), randomize
        first = self._mission[0] if isinstance(self._mission, Suite) else self._mission
        self._played: list[MissionLike] = [first] * num_envs
        self._changed = [False] * num_envs
        """Whether a world plays a mission on another layout or with another seed, for one episode; or was to begin, and may not have."""
        self._coming = [False] * num_envs
        """The same of the episode that is to begin."""
        named = mission_text(self._played[0], packs=self._packs)
        self._names = [named[0]] * num_envs
        self._instructions = [instruction_in(self._played[0], named[1])] * num_envs
        self.stage = _native.VecStage(
            [named] * num_envs,
            list(bodies),
            sensing.cameras(1 + len(bodies), render_size if render_mode else None),
            "sense-0" if sensing.drawn else None,
            list(sensing.planes),
            slots,
            sensing.fill,
            ticks_per_step,
            max_steps,
            threads or cores(),
            randomize,
            knows == "seen",
            self._packs,
        )
        self._layout = [
            (name, page, at, tuple(shape), np.dtype(item)) for name, page, at, shape, item in self.stage.layout()
        ]
        space = sensing.observation_space()
        self._parts = list(space.spaces)
        self.single_observation_space = space
        self.single_action_space = sensing.action_space()
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._randoms: list[Optional[np.random.Generator]] = [None] * num_envs
        self._done = np.zeros(num_envs, np.bool_)
        self._has_begun = False
        self._latest: dict[str, npt.NDArray[Any]] = {}
        self._nobody = np.zeros(num_envs, np.bool_)
        self._everybody = np.ones(num_envs, np.bool_)
        self._everybody.flags.writeable = False
        self._no_choices = np.zeros((num_envs, 2), np.int64)
        self._slots = slots
        self._sampler: Optional[np.random.Generator] = None

    def reset(  # type: ignore[override, unused-ignore]
        self,
        *,
        seed: Union[None, int, Sequence[Optional[int]]] = None,
        options: Optional[dict[str, Any]] = None,
    ) -> tuple[Observation, dict[str, Any]]:
        """Begins all missions anew: world ``i`` with ``seed + i``, or with a seed of its own of a list.

        ``options`` are those of :meth:`cohabit.Env.reset`, for all worlds, but that ``mission`` may be a list of one for each;
        with ``reset_mask``, ``[N]`` truths, only those worlds begin anew, and the others stay as they are.
        """
        options = dict(options or {})
        mask = _mask(options.pop("reset_mask", None), self.num_envs)
        if not self._has_begun and not mask.all():
            raise gymnasium.error.ResetNeeded("Cannot reset some environments before calling env.reset() for all of them")
        unknown = next((name for name in options if name not in OPTIONS), None)
        if unknown is not None:
            raise ValueError(f"there is no option `{unknown}` of reset: one of {', '.join(OPTIONS)}, reset_mask")
        seeds = _seeds(seed, self.num_envs)
        missions = options.pop("mission", self._mission)
        if not isinstance(missions, (list, tuple)):
            missions = [missions] * self.num_envs
        missions = [as_it_is(mission) for mission in missions]
        if len(missions) != self.num_envs:
            raise ValueError(f"{len(missions)} missions for {self.num_envs} environments: one for each")
        chosen = [place for place in range(self.num_envs) if mask[place]]
        anew = [self._begin(place, seeds[place], {**options, "mission": missions[place]}) for place in chosen]
        observation, infos = self._told(*self._turn(self._no_choices, self._nobody, anew))
        self._has_begun = True
        self._done = self._done & ~mask
        return observation, infos

    def step(self, actions: npt.NDArray[np.int64]) -> Step:
        """A command for each world, ``[N, 2]``, carried out to its outcome, or for ``ticks_per_step``.

        Raises ``ValueError`` that says what shape and type actions have to have.
        """
        self._check_can_step("step")
        chosen = checked_actions(actions, self.num_envs)
        return self._step(lambda anew: self._turn(chosen, self._everybody, anew))

    def act(self, actions: Sequence[Action]) -> Step:
        """The same as :meth:`step` with an action in words for each world, such as ``GoTo("bowl")``."""
        self._check_can_step("act")
        if len(actions) != self.num_envs:
            raise ValueError(f"{len(actions)} actions for {self.num_envs} environments: one for each")
        plain = [action.plain(self._names_in(place), 0) for place, action in enumerate(actions)]
        return self._step(lambda anew: self._note(self.stage.act(plain, anew), anew))

    def _check_can_step(self, method: str) -> None:
        if not self._has_begun:
            raise gymnasium.error.ResetNeeded(f"Cannot call env.{method}() before calling env.reset()")
        if self.autoreset_mode is AutoresetMode.DISABLED and self._done.any():
            raise _is_over(self._done)

    def _step(self, turn: Callable[[list[Beginning]], Outcomes]) -> Step:
        """A step that ``turn`` has all worlds make but those that begin anew in it, and autoreset."""
        anew: list[Beginning] = []
        if self.autoreset_mode is AutoresetMode.NEXT_STEP:
            anew = [self._begin(int(place), None, {}) for place in np.flatnonzero(self._done)]
        statuses, details, endings = turn(anew)
        rewards = self._latest["reward"].copy()
        terminated, truncated = self._latest["terminated"].copy(), self._latest["truncated"].copy()
        self._done = done = terminated | truncated
        if self.autoreset_mode is not AutoresetMode.SAME_STEP or not done.any():
            observation, infos = self._told(statuses, details, endings)
            return observation, rewards, terminated, truncated, infos
        final_obs, final_info = self._told(statuses, details, endings)
        last: dict[str, Any] = {}
        over = [int(place) for place in np.flatnonzero(done)]
        for place in over:
            one = {"final_obs": _row(final_obs, place), "final_info": _row_of_infos(final_info, place)}
            last = self._add_info(last, one, place)
        anew = [self._begin(place, None, {}) for place in over]
        again = self._turn(self._no_choices, self._nobody, anew)
        # What came of the commands of worlds that go on is still to be told.
        statuses, details, endings = (
            [new if is_over else old for old, new, is_over in zip(olds, news, done)]
            for olds, news in zip((statuses, details, endings), again)
        )
        observation, infos = self._told(statuses, details, endings)
        self._done = np.zeros(self.num_envs, np.bool_)
        return observation, rewards, terminated, truncated, infos | last

    def step_where(self, actions: npt.NDArray[np.int64], where: npt.NDArray[np.bool_]) -> Step:
        """The same for some worlds alone, without any autoreset: the others stay as they are, and earn nothing."""
        if not self._has_begun:
            raise gymnasium.error.ResetNeeded("Cannot call env.step_where() before calling env.reset()")
        where = np.asarray(where)
        if where.shape != (self.num_envs,) or where.dtype != np.bool_:
            raise ValueError(f"`where` is of shape {where.shape} and type {where.dtype}: an array of {self.num_envs} truths")
        if (self._done & where).any():
            raise _is_over(self._done & where)
        told = self._turn(checked_actions(actions, self.num_envs), where, [])
        rewards = np.where(where, self._latest["reward"], 0.0)
        terminated, truncated = self._latest["terminated"].copy(), self._latest["truncated"].copy()
        self._done = terminated | truncated
        observation, infos = self._told(*told)
        return observation, rewards, terminated, truncated, infos

    def sample(self, masks: Optional[npt.ArrayLike] = None, seed: Optional[int] = None) -> npt.NDArray[np.int64]:
        """An action for each world, ``[N, 2]``, drawn as by :func:`cohabit.sample_actions`.

        :param masks: which may be tried, ``[N, choices + slots]``, as ``infos["action_masks"]``; the newest ones, if left out.
        :param seed: begins the series of draws anew.
        """
        newest = self.action_masks() if masks is None else np.asarray(masks)
        expected = (self.num_envs, len(CHOICES) + self._slots)
        if newest.shape != expected:
            raise ValueError(f"masks of shape {newest.shape}: expected shape {expected}, a truth for each choice and each slot")
        if seed is not None or self._sampler is None:
            self._sampler = np.random.default_rng(seed)
        return sample_actions(newest, self._sampler)

    def action_masks(self) -> npt.NDArray[np.bool_]:
        """Which choices and which slots of each world may be tried, ``[N, choices + slots]``."""
        if not self._has_begun:
            raise gymnasium.error.ResetNeeded("Cannot call env.action_masks() before calling env.reset()")
        return self._latest["action_masks"]

    def state(self, place: int) -> _native.State:
        """A whole world as it is, for those who may know it."""
        return self.stage.state(place)

    def render(self) -> Optional[tuple[npt.NDArray[np.uint8], ...]]:  # type: ignore[override, unused-ignore]
        """What somebody behind each body sees, ``[H, W, 3]`` each, if there is a ``render_mode``."""
        if not self.render_mode:
            return None
        frames = (self.stage.look(place, "watch-0") for place in range(self.num_envs))
        return tuple(np.ascontiguousarray(frame.color[..., :3]) for frame in frames)

    def _names_in(self, place: int) -> Names:
        """What an action in words may name in a world."""
        state = self.stage.state(place)
        return state if self.knows == "everything" else Known(state, set(self.stage.known(place)))

    def _turn(
        self, choices: npt.NDArray[np.int64], steps: npt.NDArray[np.bool_], beginnings: list[Beginning]
    ) -> Outcomes:
        """One turn of all worlds: some begin anew, of the others those step that are to."""
        return self._note(self.stage.turn(choices.tobytes(), steps.tobytes(), beginnings), beginnings)

    def _note(self, told: Told, beginnings: list[Beginning]) -> Outcomes:
        """Has what came of a turn, in which some worlds began anew, be the latest."""
        pages, statuses, details, endings = told
        for place, _, _ in beginnings:
            self._changed[place] = self._coming[place]
        self._latest = {
            name: np.ndarray(shape, dtype, pages[page], at) for name, page, at, shape, dtype in self._layout
        }
        return statuses, details, endings

    def _begin(self, place: int, seed: Optional[int], options: Mapping[str, Any]) -> Beginning:
        """What a world begins anew with, as a :class:`cohabit.Env` of its own would."""
        if seed is not None:
            self._randoms[place], _ = seeding.np_random(seed)
        elif self._randoms[place] is None:
            self._randoms[place], _ = seeding.np_random()
        random = self._randoms[place]
        assert random is not None
        episode = seed if seed is not None else int(random.integers(2**31))
        mission = options.get("mission", self._mission)
        if isinstance(mission, Suite):
            mission = mission.sample(episode)
        layout, own = options.get("layout"), options.get("seed")
        is_changed = layout is not None or own is not None
        named = None
        if is_changed or self._changed[place] or mission is not self._played[place]:
            named = mission_text(mission, layout, own, packs=self._packs)
            self._names[place], self._instructions[place] = named[0], instruction_in(mission, named[1])
        # Until it has begun: after what is refused nobody knows which mission the world has, and it is given one in any case.
        self._played[place], self._changed[place], self._coming[place] = mission, True, is_changed
        return place, own if self._randomize and own is not None else episode, named

    def _told(
        self, statuses: list[str], details: list[str], endings: list[str]
    ) -> tuple[Observation, dict[str, Any]]:
        """The latest observations, and what may be known beyond them."""
        latest = self._latest
        observation: Observation = {}
        for name in self._parts:
            if name == "instruction":
                observation[name] = tuple(observable(one) for one in self._instructions)
            else:
                observation[name] = latest[name]
        infos: dict[str, Any] = {name: latest[name] for name in _NUMBERS}
        for name, values in zip(_TEXTS, (statuses, details, endings, self._names, self._instructions)):
            infos[name] = np.array(values, dtype=object)
        infos |= dict.fromkeys(_TOLD_OF_ALL, self._everybody)
        return observation, infos


def _mask(mask: Any, count: int) -> npt.NDArray[np.bool_]:
    """Which worlds begin anew; all of them, if nothing is said."""
    if mask is None:
        return np.ones(count, np.bool_)
    if not isinstance(mask, np.ndarray) or mask.dtype != np.bool_ or mask.shape != (count,) or not mask.any():
        raise ValueError(f"option `reset_mask` is {mask!r}: an array of {count} truths, one of them true at least")
    return mask


def _is_over(done: npt.NDArray[np.bool_]) -> gymnasium.error.ResetNeeded:
    places = ", ".join(str(place) for place in np.flatnonzero(done))
    return gymnasium.error.ResetNeeded(f"the episodes of environments {places} are over: reset them by `reset_mask`")


def _seeds(seed: Union[None, int, Sequence[Optional[int]]], count: int) -> list[Optional[int]]:
    if seed is None:
        return [None] * count
    if isinstance(seed, (int, np.integer)):
        return [int(seed) + place for place in range(count)]
    if len(seed) != count:
        raise ValueError(f"{len(seed)} seeds for {count} environments: one for each")
    return [None if one is None else int(one) for one in seed]


def _row(batch: Observation, place: int) -> Observation:
    """The observation of one world."""
    return {name: value[place] for name, value in batch.items()}


def _row_of_infos(infos: Mapping[str, Any], place: int) -> dict[str, Any]:
    return {name: value[place] for name, value in infos.items() if not name.startswith("_")}
