"""Joining a running session: frames and state in place, commands and outcomes."""

from __future__ import annotations

import _thread
import gc
import signal
import threading

import numpy as np
import pytest
from conftest import playing

import cohabit


def test_who_joins_sees_the_world(session: str) -> None:
    with cohabit.join(session) as joined:
        state = joined.state()
        assert [body.kind for body in state.bodies] == ["robot", "robot"]
        assert state.find("Bowl_01_1").class_id == "Bowl_01"
        assert state.ending == "running"
        assert {goal.met for goal in state.goals} <= {True, False}
        assert joined.state().tick >= state.tick


def test_planes_are_views_of_shared_memory_that_cannot_be_written(session: str) -> None:
    joined = cohabit.join(session)
    frame = joined.look()
    shapes = {name: (frame[name].shape, frame[name].dtype) for name in frame.planes}
    assert shapes == {
        "color": ((300, 300, 4), np.uint8),
        "depth": ((300, 300), np.float32),
        "normals": ((300, 300, 4), np.int8),
        "ids": ((300, 300), np.uint32),
    }
    for name in frame.planes:
        array = frame[name]
        assert array.ctypes.data == frame[name].ctypes.data, "the same memory each time"
        assert_read_only(array)
    assert frame.seen, "something is seen"
    thing = max(frame.seen, key=lambda seen: seen.pixels)
    assert thing.pixels == int((frame.ids == thing.id).sum())
    left, top, right, bottom = thing.bounds
    rows, columns = np.nonzero(frame.ids == thing.id)
    assert (columns.min(), rows.min(), columns.max() + 1, rows.max() + 1) == (left, top, right, bottom)


def assert_read_only(array: np.ndarray) -> None:
    assert not array.flags.writeable and not array.flags.owndata
    views = [array, array[1:], array.view(np.uint8), array.T, array.reshape(-1), np.asarray(memoryview(array))]
    views.append(np.asarray(array.base))
    for view in views:
        assert not view.flags.writeable
        with pytest.raises(ValueError, match=r"WRITEABLE|read-only"):
            view.flags.writeable = True
        with pytest.raises(ValueError, match="read-only"):
            view[...] = 0
    with pytest.raises(TypeError):
        memoryview(array)[0] = b""
    with pytest.raises((ValueError, BufferError, TypeError)):
        np.frombuffer(array, np.uint8)[0] = 1
    with pytest.raises(TypeError):
        memoryview(array.base)
    with pytest.raises(ValueError, match="read-only"):
        np.add(array, array, out=array)
    with pytest.raises(ValueError, match="read-only"):
        array.sort()


def test_a_panorama_has_four_pictures_and_a_map_only_its_planes(session: str) -> None:
    joined = cohabit.join(session)
    around = joined.look("around")
    assert (around.views, around.color.shape, around.depth.shape) == (4, (4, 32, 32, 4), (4, 32, 32))
    plan = joined.look("map")
    assert (plan.planes, plan.color.shape) == (["color"], (48, 64, 4))
    with pytest.raises(AttributeError, match="color"):
        plan.depth  # noqa: B018
    with pytest.raises(KeyError, match="no plane `depths`"):
        plan["depths"]
    with pytest.raises(ValueError, match="around"):
        joined.look("nowhere")


def test_an_array_outlives_its_frame_and_its_session(session: str) -> None:
    joined = cohabit.join(session)
    color = joined.look().color[10:20]
    before = color.copy()
    joined.close()
    del joined
    gc.collect()
    other = cohabit.join(session)
    for _ in range(6):
        other.look()
    assert (color == before).all()


def test_an_array_outlives_the_processes_of_its_session() -> None:
    with playing() as name:
        joined = cohabit.join(name)
        color = joined.look().color
        before = color.copy()
    assert (color == before).all()
    joined.close()
    del joined
    gc.collect()
    assert (color == before).all() and not color.flags.writeable


def test_eight_frames_can_be_held_and_the_ninth_says_so(session: str) -> None:
    joined = cohabit.join(session)
    held = [joined.look().color for _ in range(8)]
    assert len({array.ctypes.data for array in held}) == 8
    with pytest.raises(cohabit.Error, match="8 samples are held already; let go of one"):
        joined.look()
    held.pop()
    held.append(joined.look().color)


def test_a_command_gets_its_outcome(session: str) -> None:
    with cohabit.join(session, take_over=True) as joined:
        assert joined.do(cohabit.GoTo("bowl"), timeout=60)
        outcome = joined.do(cohabit.PickUp("bowl"), timeout=60)
        assert outcome.success, outcome
        held = joined.state().bodies[0].held
        assert held is not None and joined.state().find(held).name == "Bowl"
        refused = joined.do(cohabit.PickUp("Bowl_01_1"), timeout=60)
        assert not refused and refused.status == "AlreadyHoldingObject" and refused.detail
        unknown = joined.do(cohabit.PickUp("bowel"), timeout=60)
        assert not unknown and unknown.status == "InvalidObjectClass"
        assert unknown.detail.startswith("there is no object `bowel` in this world: did you mean `Bowl`"), unknown
        unknown = joined.do(cohabit.GoTo("Lab9"), timeout=60)
        assert unknown.detail.startswith("there is no object or room `Lab9`") and "`Lab1`" in unknown.detail, unknown
        with pytest.raises(KeyError, match="no object unicorn"):
            joined.state().find("unicorn")


def test_a_body_has_one_commander(session: str) -> None:
    with cohabit.join(session) as joined, cohabit.join(session, body=1) as other:
        with pytest.raises(cohabit.Error, match="the agent commands body 0.*take_over=True"):
            joined.act(cohabit.Stop())
        other.claim()
        assert other.peer.commands_body and not joined.peer.commands_body
        taker = cohabit.join(session, body=1, take_over=True)
        assert taker.do(cohabit.Rotate(0.1), timeout=60)
        refused = other.do(cohabit.Rotate(0.1), timeout=60)
        assert refused.status == "InvalidCommand" and "python commands body 1" in refused.detail
        taker.close()
        assert any("back to the python" in heard.text for heard in other.listen(10.0))
        assert other.do(cohabit.Rotate(0.1), timeout=60), "it went back"


def test_a_body_is_driven_by_speeds(session: str) -> None:
    with cohabit.join(session, body=1) as joined:
        yaw = joined.state().bodies[1].yaw_rad
        assert joined.do(cohabit.Drive(turn_rad_s=1.0), timeout=60)
        assert joined.state().bodies[1].yaw_rad != yaw
        with pytest.raises(ValueError, match="forward_m_s.*must be finite"):
            joined.act(cohabit.Drive(forward_m_s=float("nan")))


def test_waiting_has_an_end(session: str) -> None:
    with cohabit.join(session, body=1) as joined:
        command = joined.act(cohabit.LookAround())
        with pytest.raises(TimeoutError, match="no outcome after"):
            command.wait(0.01)
        assert command.wait(60).command == command.number
        kinds = [heard.kind for heard in joined.listen(0.0) if heard.body == 1]
        # Whoever had the body before may let go of it only now.
        assert kinds[-4:] == ["commander", "outcome", "started", "outcome"], "of the claim and of the command"


def test_what_one_says_others_hear(session: str) -> None:
    with cohabit.join(session) as one, cohabit.join(session, body=1) as other:
        other.say("Good morning.")
        said = [heard for heard in one.listen(2.0) if heard.kind == "reply"]
        assert [(heard.body, heard.text) for heard in said] == [(1, "Good morning.")]


def test_ctrl_c_ends_waiting_and_other_threads_run_meanwhile(session: str) -> None:
    # Where tests run in the background, it may be ignored.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    with cohabit.join(session) as joined:
        counted = threading.Event()
        threading.Thread(target=counted.set).start()
        threading.Timer(0.3, lambda: _thread.interrupt_main(signal.SIGINT)).start()
        with pytest.raises(KeyboardInterrupt):
            for _ in joined.listen(None):
                pass
        assert counted.is_set()


def test_a_session_that_is_not_there_is_told() -> None:
    with pytest.raises(cohabit.Error, match="there is no such session here"):
        cohabit.join("nobody-is-here")
    with pytest.raises(ValueError, match="use 1 to 24 letters"):
        cohabit.join("no such name")


def test_a_body_that_is_not_there_is_told_at_once(session: str) -> None:
    with pytest.raises(ValueError, match="has no body 2: it has bodies 0 to 1; `cohabit play --body robot` adds one"):
        cohabit.join(session, body=2, take_over=True)


def test_the_world_of_a_session_in_real_time_is_an_environment(session: str) -> None:
    with cohabit.join(session, body=1) as joined:
        env = cohabit.Env(session=joined, planes=(), slots=8, instruction=True)
        env.reset()
        observation, _, _, _, info = env.act(cohabit.Rotate(0.3))
        assert observation["instruction"] == info["instruction"] == "Make a bowl of cereal with milk"
        assert info["status"] == "ActionSuccessful"
        assert env.observation_space.contains(observation)
        with pytest.raises(cohabit.Error, match="not in lock-step"):
            joined.attend()


def test_what_is_observed_in_a_session_can_be_kept(session: str) -> None:
    with cohabit.join(session, body=1) as joined:
        env = cohabit.Env(session=joined, planes=("color",), slots=8)
        kept = [env.reset()[0]["color"]]
        kept += [env.act(cohabit.Rotate(0.3))[0]["color"] for _ in range(12)]
        assert len({array.ctypes.data for array in kept}) == 13
        assert (kept[0] != kept[1]).any() and not kept[0].flags.writeable
