"""Many bodies in one world, in the shape of PettingZoo's parallel API."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from typing import Any, Optional, Union

import gymnasium
import numpy as np
import numpy.typing as npt

from . import _native
from .actions import Action
from .missions import World
from .office import OPTIONS, MissionLike, Observation, Office, check_steps, outcome_info
from .sensing import checked_actions

try:
    from pettingzoo import ParallelEnv as Base  # type: ignore[import-untyped, unused-ignore]
except ImportError:  # It is only needed for its wrappers.
    Base = object

Infos = dict[str, dict[str, Any]]
Step = tuple[dict[str, Observation], dict[str, float], dict[str, bool], dict[str, bool], Infos]


class ParallelEnv(Base):  # type: ignore[misc, unused-ignore]
    """A mission with many bodies in lock-step: each is an agent, ``robot_0``, ``person_1`` and so on.

    Actions, observations and rewards are those of :class:`~cohabit.Env`; all agents are rewarded alike. A step lasts
    until every agent's command came to its outcome, or ``ticks_per_step``.

    :param bodies: bodies beside the mission's robot, such as ``"robot"`` or ``"person@Lab1"``.
    """

    metadata = {"name": "cohabit_v0", "render_modes": ["rgb_array"], "is_parallelizable": True}  # noqa: RUF012

    def __init__(
        self,
        mission: MissionLike = None,
        *,
        bodies: Sequence[str] = ("robot",),
        planes: Sequence[str] = ("color", "depth", "normals", "ids"),
        camera: str = "egocentric",
        size: Union[int, tuple[int, int]] = 300,
        slots: int = 32,
        fill: Optional[str] = None,
        max_steps: int = 200,
        ticks_per_step: Optional[int] = None,
        render_mode: Optional[str] = None,
        render_size: tuple[int, int] = (640, 360),
        threads: int = 1,
        randomize: bool = False,
        instruction: bool = False,
        knows: str = "everything",
        world: World = (),
    ) -> None:
        check_steps(render_mode, ticks_per_step)
        self.render_mode = render_mode
        self.max_steps = max_steps
        self.ticks_per_step = ticks_per_step
        render = render_size if render_mode else None
        self.office = Office(
            mission,
            bodies,
            planes,
            camera,
            size,
            slots,
            fill,
            render,
            threads,
            randomize=randomize,
            instruction=instruction,
            knows=knows,
            world=world,
            many=True,
        )
        self.possible_agents = [f"{kind}_{number}" for number, kind in enumerate(self.office.kinds)]
        self.agents: list[str] = []
        self._number = {agent: number for number, agent in enumerate(self.possible_agents)}
        self.observation_spaces = {agent: self.office.observation_space for agent in self.possible_agents}
        self.action_spaces = {
            agent: gymnasium.spaces.MultiDiscrete(self.office.action_space.nvec) for agent in self.possible_agents
        }
        self._random = np.random.default_rng()
        self._steps = 0
        self._score = 0

    def observation_space(self, agent: str) -> gymnasium.spaces.Dict:
        """What an agent observes."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> gymnasium.spaces.MultiDiscrete:
        """What an agent chooses from."""
        return self.action_spaces[agent]

    @property
    def classes(self) -> tuple[str, ...]:
        """The ids of all classes of objects, by their numbers: ``cohabit.CLASSES``, then those of world packs."""
        return self.office.classes

    def state(self) -> _native.State:
        """The whole world as it is, for those who may know it."""
        return self.office.world.state()

    def reset(
        self, seed: Optional[int] = None, options: Optional[dict[str, Any]] = None
    ) -> tuple[dict[str, Observation], Infos]:
        """Begins the mission anew. What it leaves to chance follows from ``seed``; ``options`` are those of
        :meth:`cohabit.Env.reset`, of which unknown ones are warned of: PettingZoo's test of its API passes one."""
        options = options or {}
        if (unknown := self.office.unknown_option(options)) is not None:
            warnings.warn(unknown, stacklevel=2)
            options = {name: value for name, value in options.items() if name in OPTIONS}
        if seed is not None:
            self._random = np.random.default_rng(seed)
        self.office.begin(seed if seed is not None else int(self._random.integers(2**31)), options)
        self.agents = list(self.possible_agents)
        self._steps = 0
        self._score, _ = self.office.progress()
        observations, infos = self._observe([])
        return observations, infos

    def step(self, actions: Mapping[str, npt.NDArray[np.int64]]) -> Step:
        """A command for each agent; agents that are left out wait.

        Raises :class:`gymnasium.error.ResetNeeded` before the first :meth:`reset`.
        """
        self.office.check_begun("step")
        chosen = {agent: checked_actions(action).tolist() for agent, action in actions.items()}
        choices = [(self._number[agent], choice, slot) for agent, (choice, slot) in chosen.items()]
        return self._after(self.office.world.choose(choices, self.ticks_per_step))

    def act(self, actions: Mapping[str, Action]) -> Step:
        """The same as :meth:`step` with actions in words, such as ``GoTo("bowl")``."""
        self.office.check_begun("act")
        numbers = [(self._number[agent], action) for agent, action in actions.items()]
        plain = [(number, action.plain(self.office.names(number), number)) for number, action in numbers]
        return self._after(self.office.world.act(plain, self.ticks_per_step))

    def _observe(self, outcomes: Sequence[_native.Outcome]) -> tuple[dict[str, Observation], Infos]:
        numbers = [self._number[agent] for agent in self.agents]
        observations, infos = self.office.observe(numbers)
        told = [info | outcome_info(outcomes, number) for info, number in zip(infos, numbers)]
        return dict(zip(self.agents, observations)), dict(zip(self.agents, told))

    def _after(self, outcomes: Sequence[_native.Outcome]) -> Step:
        agents = self.agents
        if not agents:
            return {}, {}, {}, {}, {}
        self._steps += 1
        observations, infos = self._observe(outcomes)
        score = infos[agents[0]]["score"]
        reward = (score - self._score) / 100
        self._score = score
        terminated = infos[agents[0]]["ending"] != "running"
        truncated = not terminated and self._steps >= self.max_steps
        if terminated or truncated:
            self.agents = []
        every = dict.fromkeys
        return observations, every(agents, reward), every(agents, terminated), every(agents, truncated), infos

    def render(self) -> Optional[npt.NDArray[np.uint8]]:
        """What somebody behind the first body sees, ``[H, W, 3]``, if there is a ``render_mode``."""
        return self.office.render(0) if self.render_mode else None

    def close(self) -> None:
        """Nothing is left open."""
