"""Steps a second of one environment and of vectors of 16, on this machine.

    python benches/vector.py [SECONDS]
"""

from __future__ import annotations

import sys
import time
from typing import Callable

import numpy as np
from steps import machine

import cohabit
from cohabit import CHOICES

SECONDS = float(sys.argv[1]) if len(sys.argv) > 1 else 5.0
TURN = [CHOICES.index("turn_left"), 0]


def rate(step: Callable[[], int]) -> float:
    """Steps a second of ``step``, which gives how many it makes; after a warm-up."""
    for _ in range(3):
        step()
    steps, began = 0, time.perf_counter()
    while (took := time.perf_counter() - began) < SECONDS:
        steps += step()
    return steps / took


def one(planes: tuple[str, ...]) -> Callable[[], int]:
    """Steps one environment a tick at a time; it begins anew in good time."""
    env = cohabit.Env(planes=planes, size=84, ticks_per_step=1, max_steps=500)
    over = True

    def step() -> int:
        nonlocal over
        if over:
            env.reset(seed=0)
        _, _, terminated, truncated, _ = env.step(np.array(TURN))
        over = terminated or truncated
        return 1

    return step


def many(planes: tuple[str, ...], ticks: int | None = 1) -> Callable[[], int]:
    """Steps 16 of them in one call, so many ticks at a time or each to its outcome."""
    envs = cohabit.VectorEnv(None, 16, planes=planes, size=84, ticks_per_step=ticks, max_steps=500)
    envs.reset(seed=0)
    actions = np.tile(TURN, (16, 1))

    def step() -> int:
        envs.step(actions)
        return 16

    return step


def main() -> None:
    """Prints all of it."""
    print(machine())
    for name, step in [
        ("one, no pictures", one(())),
        ("one, 84x84, four planes", one(("color", "depth", "normals", "ids"))),
        ("16 in a vector, no pictures", many(())),
        ("16 in a vector, 84x84 colour", many(("color",))),
        ("16 to their outcomes, no pictures", many((), None)),
        ("16 to their outcomes, 84x84 colour", many(("color",), None)),
    ]:
        print(f"{name:34} {rate(step):9.0f} steps/s")


if __name__ == "__main__":
    main()
