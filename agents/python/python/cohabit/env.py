"""One body as a gymnasium environment."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Optional, Union

import gymnasium
import numpy as np
import numpy.typing as npt

from . import _native
from .actions import Action
from .missions import World
from .office import MissionLike, Observation, Office, check_steps, outcome_info
from .sensing import checked_actions
from .session import Session


class Env(gymnasium.Env[Observation, npt.NDArray[np.int64]]):
    """A mission in lock-step: simulated time goes by only in :meth:`step`.

    An action is ``[choice, slot]``: what to do (``cohabit.CHOICES``), and to which object of those in the body's slots
    (``slot_ids`` and the like in the observation). What makes no sense is refused by the world: ``info["status"]``
    and ``info["detail"]`` say how it went, ``info["action_mask"]`` what may be tried, as ``action_space.sample`` takes
    it, and ``info["affordances"]`` (``[choices, slots]``) which choice suits which slot. ``info["instruction"]`` is what the
    robot is told to do. An environment can be pickled and copied, but for one in a session: the copy goes on from there.

    The reward is the change of the score over 100: a goal is worth 1, and costs 1 if it opens again; a simulated second costs
    0.01. The score begins at 1000, falls by 1 a second, but not below 100, and has 100 more for each goal met: it is from 100 to
    1000 + 100 goals, and the rewards of an episode add up to at least -9 and at most the number of goals. An episode terminates
    when the mission ends, and is truncated after ``max_steps``.

    :param ticks_per_step: a step lasts so many ticks (of 1/60 s) whatever the body does, and a new command takes the place
        of one under way; ``wait`` lets it go on. Left out, a step lasts until its command came to its outcome.
    :param render_mode: ``"rgb_array"``, or none.

    :param session: a session that was joined (:func:`cohabit.join`), whose world is played instead of one in this process. Its
        world cannot begin anew: :meth:`reset` takes it as it is. In lock-step it waits for every step.

    All other parameters are those of :class:`~cohabit.office.Office`.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 10}  # noqa: RUF012

    def __init__(
        self,
        mission: MissionLike = None,
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
        threads: int = 1,
        session: Optional[Session] = None,
        randomize: bool = False,
        instruction: bool = False,
        knows: str = "everything",
        world: World = (),
    ) -> None:
        check_steps(render_mode, ticks_per_step)
        if session is not None and render_mode is not None:
            raise ValueError("a session is watched on its page: there is no render_mode then")
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
            session,
            randomize=randomize,
            instruction=instruction,
            knows=knows,
            world=world,
        )
        self.observation_space = self.office.observation_space
        self.action_space = self.office.action_space
        self._body = 0 if session is None else session.body
        self._steps = 0
        self._score = 0
        self._masks: npt.NDArray[np.bool_] = np.zeros(0, np.bool_)

    @property
    def state(self) -> _native.State:
        """The whole world as it is, for those who may know it."""
        return self.office.world.state()

    @property
    def classes(self) -> tuple[str, ...]:
        """The ids of all classes of objects, by their numbers: ``cohabit.CLASSES``, then those of world packs."""
        return self.office.classes

    def reset(
        self, *, seed: Optional[int] = None, options: Optional[dict[str, Any]] = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begins the mission anew. What it leaves to chance follows from ``seed``.

        ``options`` hold for the episode that begins: ``mission``, another mission, as the environment takes one; ``layout``, the
        id of another floor plan, such as ``"OfficeLayout2_mirror"``; ``seed``, a number that takes the place of the mission's own
        seed. Raises ``ValueError`` for any other, and for all of them in the world of a session.
        """
        super().reset(seed=seed)
        self.office.begin(seed if seed is not None else int(self.np_random.integers(2**31)), options)
        self._steps = 0
        self._score, _ = self.office.progress()
        (observation,), (info,) = self.office.observe([self._body])
        self._masks = info["action_masks"]
        return observation, info | outcome_info([], self._body)

    def action_masks(self) -> npt.NDArray[np.bool_]:
        """Which choices and which slots may be tried, one after the other, ``[choices + slots]``: as masked PPO asks for them.
        The same is in ``info["action_masks"]``, which stays an array where environments are made a vector of."""
        self.office.check_begun("action_masks")
        return self._masks

    def step(
        self, action: npt.NDArray[np.int64]
    ) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """One command, carried out to its outcome, or for ``ticks_per_step``.

        Raises :class:`gymnasium.error.ResetNeeded` before the first :meth:`reset`, and ``ValueError`` for what is no action.
        """
        self.office.check_begun("step")
        choice, slot = checked_actions(action).tolist()
        return self._after(self.office.world.choose([(self._body, choice, slot)], self.ticks_per_step))

    def act(self, action: Action) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """The same as :meth:`step` with an action in words, such as ``GoTo("bowl")``."""
        self.office.check_begun("act")
        plain = action.plain(self.office.names(self._body), self._body)
        return self._after(self.office.world.act([(self._body, plain)], self.ticks_per_step))

    def _after(self, outcomes: Sequence[_native.Outcome]) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        self._steps += 1
        (observation,), (info,) = self.office.observe([self._body])
        self._masks = info["action_masks"]
        reward = (info["score"] - self._score) / 100
        self._score = info["score"]
        terminated = info["ending"] != "running"
        truncated = not terminated and self._steps >= self.max_steps
        return observation, reward, terminated, truncated, info | outcome_info(outcomes, self._body)

    def render(self) -> Optional[npt.NDArray[np.uint8]]:
        """What somebody behind the body sees, ``[H, W, 3]``, if there is a ``render_mode``."""
        return self.office.render(0) if self.render_mode else None
