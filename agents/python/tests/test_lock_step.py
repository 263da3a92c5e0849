"""A session in lock-step, played from Python."""

from __future__ import annotations

import numpy as np
import pytest

import cohabit
from cohabit import CHOICES


def test_no_time_goes_by_in_a_turn(lock_step_session: str) -> None:
    with cohabit.join(lock_step_session, body=1) as joined:
        tick = joined.attend(timeout=60)
        assert joined.state().tick == tick
        joined.peer.open_camera("small")
        for ticks in (1, 5, 60):
            assert joined.step(ticks, timeout=60) == tick + ticks
            tick += ticks
            assert (joined.state().tick, joined.look("small").tick) == (tick, tick)
        before = joined.state().bodies[1].yaw_rad
        assert joined.do(cohabit.Rotate(0.5), timeout=60)
        assert joined.state().bodies[1].yaw_rad == pytest.approx(before + 0.5, abs=1e-3)


def test_its_world_is_an_environment(lock_step_session: str) -> None:
    with cohabit.join(lock_step_session, body=1) as joined:
        env = cohabit.Env(session=joined, camera="small", size=48, slots=8, ticks_per_step=4)
        observation, info = env.reset()
        assert env.observation_space.contains(observation)
        tick = info["tick"]
        for count in range(1, 4):
            observation, _, _, _, info = env.step(np.array([CHOICES.index("turn_left"), 0]))
            assert info["tick"] == tick + 4 * count
            assert env.observation_space.contains(observation)
        whole = cohabit.Env(session=joined, planes=(), slots=8)
        whole.reset()
        *_, info = whole.step(np.array([CHOICES.index("turn_left"), 0]))
        assert info["status"] == "ActionSuccessful", info
        before = joined.state().bodies[1].yaw_rad
        *_, info = whole.act(cohabit.Rotate(-0.5))
        assert info["status"] == "ActionSuccessful", info
        assert joined.state().bodies[1].yaw_rad == pytest.approx(before - 0.5, abs=1e-3)
        *_, info = whole.step(np.array([CHOICES.index("pick_up"), 7]))
        assert info["status"] and info["status"] != "ActionSuccessful"


def test_a_camera_is_what_it_is(lock_step_session: str) -> None:
    joined = cohabit.join(lock_step_session, body=1)
    with pytest.raises(ValueError, match="has no camera `large`: egocentric/0"):
        cohabit.Env(session=joined, camera="large")
    with pytest.raises(ValueError, match="camera `small` has pictures of 48x48"):
        cohabit.Env(session=joined, camera="small", size=84)
