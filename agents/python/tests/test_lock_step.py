"""A session in lock-step, played from Python."""

from __future__ import annotations

import gc
import threading

import numpy as np
import pytest

from gymnasium.error import ResetNeeded

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


TURN = np.array([CHOICES.index("turn_left"), 0])


def test_two_bodies_on_one_thread_are_refused(lock_step_session: str) -> None:
    with cohabit.join(lock_step_session, body=0, take_over=True) as one:
        with cohabit.join(lock_step_session, body=1) as other:
            envs = [
                cohabit.Env(session=one, planes=(), slots=8, ticks_per_step=4),
                cohabit.Env(session=other, camera="small", size=48, slots=8, ticks_per_step=4),
            ]
            ticks = [env.reset()[1]["tick"] for env in envs]
            assert ticks[0] == ticks[1]
            for env in envs:
                with pytest.raises(cohabit.Error, match=r"would wait for ever.*from a thread or process of its own"):
                    env.step(TURN)
            # Nothing was sent: from two threads they go on from there.
            threads = [threading.Thread(target=env.step, args=(TURN,), daemon=True) for env in envs]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join(60)
                assert not thread.is_alive()
        # The other is closed: one alone is stepped from this thread.
        *_, info = envs[0].step(TURN)
        assert info["tick"] == ticks[0] + 8


def test_a_session_that_is_dropped_is_not_waited_for(lock_step_session: str) -> None:
    dropped = cohabit.join(lock_step_session, body=1)
    dropped.attend(timeout=60)
    del dropped
    gc.collect()
    with cohabit.join(lock_step_session, body=1) as joined:
        tick = joined.attend(timeout=60)
        assert joined.step(3, timeout=60) == tick + 3


def test_the_world_of_a_session_has_no_options(lock_step_session: str) -> None:
    with cohabit.join(lock_step_session, body=1) as joined:
        env = cohabit.Env(session=joined, planes=(), slots=8)
        with pytest.raises(ValueError, match="no option `mission` of reset: none, for the world of a session"):
            env.reset(options={"mission": "cold_soda"})
        with pytest.raises(ResetNeeded):
            env.step(TURN)
