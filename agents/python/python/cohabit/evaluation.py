"""How well a policy does on a suite: success by type of mission, steps and return."""

from __future__ import annotations

import contextlib
import json
import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Optional, Union

import numpy as np
import numpy.typing as npt

from .missions import Mission, Missions, cores, suite_of
from .office import Observation
from .vector import VectorEnv

Policy = Callable[[Observation, dict[str, Any]], npt.ArrayLike]
"""What a policy is: observations and infos of ``N`` worlds, as :class:`cohabit.VectorEnv` has them, to their actions ``[N, 2]``."""

_Z = 1.959963984540054
"""The quantile of the standard normal distribution that a two-sided 95 % interval takes."""


@dataclass(frozen=True)
class Episode:
    """What came of an episode."""

    mission: str
    type: str
    seed: int
    success: bool
    """Whether the mission was completed."""
    ending: str
    steps: int
    ticks: int
    score: int
    reward: float
    """The sum of its rewards."""
    actions: tuple[tuple[int, int], ...]
    """What was chosen, step by step: choice and slot."""


@dataclass(frozen=True)
class Row:
    """Episodes of one type of missions, or all of them."""

    type: str
    episodes: int
    solved: int
    success: float
    interval_95: tuple[float, float]
    """Wilson's interval of the share of success."""
    mean_steps: float
    mean_return: float


@dataclass(frozen=True)
class Evaluation:
    """The episodes of an evaluation, in the order in which they were begun. Printed, it is a table."""

    episodes: tuple[Episode, ...]

    @property
    def rows(self) -> list[Row]:
        """A row for each type, by name, and the last for all."""
        types = sorted({episode.type for episode in self.episodes})
        of_type = [_row(one or "-", [episode for episode in self.episodes if episode.type == one]) for one in types]
        return [*of_type, _row("all", self.episodes)]

    def __str__(self) -> str:
        width = max(len(row.type) for row in self.rows)
        lines = [f"{'type':{width}}  episodes  solved   rate  95 % interval    steps  return"]
        for row in self.rows:
            low, high = (100 * bound for bound in row.interval_95)
            lines.append(
                f"{row.type:{width}}  {row.episodes:8}  {row.solved:6}  {100 * row.success:5.1f}  {low:5.1f} - {high:5.1f}  "
                f"{row.mean_steps:7.1f}  {row.mean_return:6.2f}"
            )
        return "\n".join(lines)


def wilson_95(good: int, count: int) -> tuple[float, float]:
    """Wilson's 95 % interval of a share; all there is, if nothing was counted."""
    if count == 0:
        return 0.0, 1.0
    share, square = good / count, _Z * _Z
    middle = (share + square / (2 * count)) / (1 + square / count)
    half = _Z / (1 + square / count) * float(np.sqrt(share * (1 - share) / count + square / (4 * count * count)))
    return max(0.0, middle - half), min(1.0, middle + half)


def evaluate(
    policy: Policy,
    missions: Missions,
    episodes: Optional[int] = None,
    *,
    seed: int = 0,
    num_envs: Optional[int] = None,
    record: Union[None, str, os.PathLike[str]] = None,
    **arguments: Any,
) -> Evaluation:
    """Has a policy play missions in their order, one episode each, and over again if there are more episodes.

    What comes of it does not depend on ``num_envs``, as long as the policy does for each world what it would do for it alone.

    :param missions: a suite, a mission, the name of a built-in one, a path that :func:`cohabit.suite` reads, or a list of these.
    :param episodes: how many; one for each mission, if left out.
    :param seed: episode ``i`` begins with ``seed + i``.
    :param num_envs: worlds that are played beside each other.
    :param record: a folder for ``episodes.jsonl``: what came of each episode, with its actions, which repeat it to the bit in a
        :class:`cohabit.Env` that is reset with its mission and its seed. Until all are played it is ``episodes.jsonl.part``, and
        stays that where the policy fails.
    :param arguments: those of :class:`cohabit.VectorEnv`.
    """
    if not callable(policy):
        raise TypeError(f"a policy is a function of observations and infos, not of type {type(policy).__name__}")
    suite = suite_of(missions, arguments.pop("world", ()))
    count = len(suite) if episodes is None else episodes
    if count < 1:
        raise ValueError(f"{count} episodes: at least 1")
    worlds = min(count, num_envs or cores())
    envs = VectorEnv(suite[0], worlds, autoreset_mode="Disabled", world=suite.world, **arguments)
    done: list[Episode] = []
    with contextlib.closing(envs), _taking_down(record) as take_down:
        for first in range(0, count, worlds):
            numbers = range(first, min(first + worlds, count))
            played = _play(envs, policy, [suite[number % len(suite)] for number in numbers], seed + first)
            take_down(played)
            done += played
    return Evaluation(tuple(done))


@contextlib.contextmanager
def _taking_down(record: Union[None, str, os.PathLike[str]]) -> Iterator[Callable[[Sequence[Episode]], None]]:
    """Writes episodes into a folder as they end: that it cannot be written shows before hours of play, and what was played stays."""
    if record is None:
        yield lambda episodes: None
        return
    folder = Path(record)
    folder.mkdir(parents=True, exist_ok=True)
    part = folder / "episodes.jsonl.part"
    with part.open("w") as out:

        def take_down(episodes: Sequence[Episode]) -> None:
            out.writelines(f"{json.dumps(asdict(episode))}\n" for episode in episodes)
            out.flush()

        yield take_down
    part.replace(folder / "episodes.jsonl")


def _play(envs: VectorEnv, policy: Policy, missions: Sequence[Mission], seed: int) -> list[Episode]:
    """An episode of each of these missions, beside each other; worlds that are left over play the last one."""
    count = len(missions)
    played = [missions[min(place, count - 1)] for place in range(envs.num_envs)]
    seeds = [seed + place for place in range(envs.num_envs)]
    observation, infos = envs.reset(seed=seeds, options={"mission": played})
    ended: list[Optional[Episode]] = [None] * count
    actions: list[list[tuple[int, int]]] = [[] for _ in missions]
    earned = np.zeros(envs.num_envs)
    while None in ended:
        chosen = np.asarray(policy(observation, infos))
        over = np.array([place >= count or ended[place] is not None for place in range(envs.num_envs)])
        observation, rewards, terminated, truncated, infos = envs.step_where(chosen, ~over)
        earned += rewards
        for place in range(count):
            if over[place]:
                continue
            actions[place].append((int(chosen[place][0]), int(chosen[place][1])))
            if terminated[place] or truncated[place]:
                ending, score = str(infos["ending"][place]), int(infos["score"][place])
                ended[place] = Episode(
                    missions[place].id,
                    missions[place].type,
                    seed + place,
                    ending == "complete",
                    ending,
                    len(actions[place]),
                    int(infos["tick"][place]),
                    score,
                    float(earned[place]),
                    tuple(actions[place]),
                )
    return [episode for episode in ended if episode is not None]


def _row(name: str, episodes: Sequence[Episode]) -> Row:
    count, solved = len(episodes), sum(episode.success for episode in episodes)
    steps = float(np.mean([episode.steps for episode in episodes]))
    earned = float(np.mean([episode.reward for episode in episodes]))
    return Row(name, count, solved, solved / count, wilson_95(solved, count), steps, earned)
