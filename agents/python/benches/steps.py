"""Steps a second of environments, and how long a view of a session's frame takes, on this machine.

    python benches/steps.py [SECONDS] [SESSION]
"""

from __future__ import annotations

import platform
import sys
import time
from pathlib import Path
from typing import Callable

import gymnasium
import numpy as np

import cohabit
from cohabit import CHOICES

SECONDS = float(sys.argv[1]) if len(sys.argv) > 1 else 5.0
TURN = np.array([CHOICES.index("turn_left"), 0])
ALL = ("color", "depth", "normals", "ids")


def rate(step: Callable[[], int]) -> tuple[float, float]:
    """Steps and ticks a second of ``step``, which gives its ticks; after a warm-up."""
    for _ in range(3):
        step()
    steps = ticks = 0
    began = time.perf_counter()
    while (took := time.perf_counter() - began) < SECONDS:
        ticks += step()
        steps += 1
    return steps / took, ticks / took


def stepper(agents: int, planes: tuple[str, ...], ticks: int | None, threads: int) -> Callable[[], int]:
    """Steps an environment of so many agents, all of which turn; it begins anew in good time."""
    env = cohabit.ParallelEnv(
        bodies=("robot@Lab1", "robot@MainOffice", "robot@Lab2")[: agents - 1],
        planes=planes,
        ticks_per_step=ticks,
        max_steps=500,
        threads=threads,
    )
    env.reset(seed=0)
    tick = 0

    def step() -> int:
        nonlocal tick
        if not env.agents:
            env.reset(seed=0)
            tick = 0
        infos = env.step(dict.fromkeys(env.agents, TURN))[-1]
        before, tick = tick, next(iter(infos.values()))["tick"]
        return tick - before

    return step


def machine() -> str:
    """What this is measured on."""
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    cpu = next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), platform.machine())
    count = sum(line.startswith("processor") for line in lines)
    versions = f"Python {platform.python_version()}, numpy {np.__version__}, gymnasium {gymnasium.__version__}"
    return f"{count} x {cpu}; cohabit {cohabit.__version__}, {versions}"


def starts() -> None:
    """How long environments take to begin."""
    for planes, name in [((), "states alone"), (ALL, "frames of 300x300")]:
        took = []
        for _ in range(2):
            began = time.perf_counter()
            env = cohabit.Env(planes=planes)
            env.reset(seed=0)
            took.append((time.perf_counter() - began) * 1e3)
        began = time.perf_counter()
        for _ in range(20):
            env.office.world.reset(0)
        again = (time.perf_counter() - began) / 20 * 1e3
        print(f"{name:22} first {took[0]:7.1f} ms, another {took[1]:6.1f} ms, its world anew {again:5.2f} ms")


def views(session: str) -> None:
    """How long the newest frame of a running session takes to be viewed, and how old it is then."""
    with cohabit.join(session) as joined:
        view, age = [], []
        for _ in range(int(SECONDS * 10)):
            frame = joined.look()
            age.append(time.monotonic_ns() - frame.seen_nanos)
            began = time.perf_counter_ns()
            _ = frame.color, frame.depth, frame.normals, frame.ids
            view.append(time.perf_counter_ns() - began)
    for what, nanos in [("four planes viewed", view), ("from world to Python", age)]:
        median, late = np.percentile(nanos, [50, 99]) / 1e3
        print(f"{what:22} {median:9.1f} us, p99 {late:9.1f} us")


def main() -> None:
    """Prints all of it."""
    print(machine())
    starts()
    print(f"{'agents':>6} {'planes':>10} {'ticks a step':>13} {'steps/s':>9} {'ticks/s':>9}")
    for planes in ((), ALL):
        for ticks in (1, 6, None):
            for agents in (1, 2, 4):
                steps, per_second = rate(stepper(agents, planes, ticks, threads=min(agents, 2)))
                name, length = "300x300 x4" if planes else "none", "to outcome" if ticks is None else str(ticks)
                print(f"{agents:6} {name:>10} {length:>13} {steps:9.0f} {per_second:9.0f}")
    if len(sys.argv) > 2:
        views(sys.argv[2])


if __name__ == "__main__":
    main()
