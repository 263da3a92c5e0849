"""Vectors of environments: as many single ones, step by step."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

import cohabit
from cohabit import CHOICES, GoTo, PickUp

SHORT = {"ticks_per_step": 10, "max_steps": 5, "size": 24, "slots": 8}


def actions(seed: int, worlds: int, steps: int) -> np.ndarray:
    return np.random.default_rng(seed).integers([len(CHOICES), 8], size=(steps, worlds, 2))


def check_row(batch: dict[str, Any], place: int, single: dict[str, Any]) -> None:
    assert set(batch) == set(single)
    for name, value in single.items():
        assert np.array_equal(batch[name][place], value), (name, place)


@pytest.mark.parametrize("planes", [(), ("color",), ("color", "depth", "normals", "ids")])
@pytest.mark.parametrize("threads", [1, 3])
def test_many_worlds_are_as_many_single_ones(planes: tuple[str, ...], threads: int) -> None:
    same: dict[str, Any] = {"planes": planes, "randomize": True, "instruction": True, **SHORT}
    many = cohabit.VectorEnv("make_cereal", 3, threads=threads, **same)
    single = [cohabit.Env("make_cereal", **same) for _ in range(3)]
    observation, infos = many.reset(seed=7)
    assert many.observation_space.contains(observation)
    for place, env in enumerate(single):
        one, info = env.reset(seed=7 + place)
        check_row(observation, place, one)
        assert (infos["action_masks"][place] == info["action_masks"]).all()
    over = [False] * 3
    for chosen in actions(1, 3, 12):
        observation, rewards, terminated, truncated, infos = many.step(chosen)
        for place, env in enumerate(single):
            if over[place]:
                (one, info), reward, ends = env.reset(), 0.0, (False, False)
            else:
                one, reward, *ends, info = env.step(chosen[place])
            over[place] = any(ends)
            check_row(observation, place, one)
            assert (rewards[place], terminated[place], truncated[place]) == (reward, *ends)
            for name in ("status", "detail", "tick", "score", "ending", "mission", "instruction"):
                assert infos[name][place] == info[name], name
            assert (infos["action_masks"][place] == env.action_masks()).all()
            assert many.stage.digest(place) == env.office.world.digest()


def test_the_contract_of_gymnasium() -> None:
    envs = gymnasium.make_vec("Cohabit/MissionState-v0", 2, **SHORT)
    assert isinstance(envs.unwrapped, cohabit.VectorEnv)
    assert envs.metadata["autoreset_mode"] is AutoresetMode.NEXT_STEP
    assert envs.single_action_space == gymnasium.make("Cohabit/MissionState-v0", slots=8).action_space
    envs.action_space.seed(0)
    with pytest.raises(gymnasium.error.ResetNeeded):
        envs.step(envs.action_space.sample())
    envs.reset(seed=[3, None])
    for _ in range(8):
        observation, rewards, terminated, truncated, infos = envs.step(envs.action_space.sample())
        assert observation in envs.observation_space
        assert rewards.dtype == np.float64 and terminated.dtype == truncated.dtype == np.bool_
        assert infos["_status"].all() and infos["action_masks"].shape == (2, len(CHOICES) + 8)
    for wrong, given in [
        (np.zeros((1, 2), np.int64), r"shape \(1, 2\) and type int64"),
        (np.zeros(2, np.int64), r"shape \(2,\) and type int64"),
        (np.zeros((2, 2)), r"shape \(2, 2\) and type float64"),
        ([[0, 0], [0]], "no array"),
    ]:
        with pytest.raises(ValueError, match=given + r".*: expected an array of shape \(2, 2\) of integers"):
            envs.step(wrong)
    with pytest.raises(ValueError, match="no choice 99"):
        envs.step(np.full((2, 2), 99))
    wrapped = gymnasium.wrappers.vector.RecordEpisodeStatistics(envs)
    wrapped.reset(seed=0)
    told = [wrapped.step(np.zeros((2, 2), np.int64))[-1] for _ in range(5)][-1]
    assert (told["episode"]["l"] == 5).all()
    envs.close()


def test_an_episode_begins_in_the_step_in_which_one_ends() -> None:
    envs = cohabit.VectorEnv("cold_soda", 2, planes=(), autoreset_mode="SameStep", **SHORT)
    envs.reset(seed=0)
    for chosen in actions(2, 2, 4):
        *_, infos = envs.step(chosen)
        assert "final_obs" not in infos
    observation, _, _, truncated, infos = envs.step(actions(3, 2, 1)[0])
    assert truncated.all() and infos["_final_obs"].all()
    assert (infos["tick"] == 0).all() and (infos["final_info"]["tick"] == 50).all()
    assert infos["final_obs"][1]["position"].shape == (3,) and observation in envs.observation_space


def test_without_autoreset_a_mask_says_which_begin_anew() -> None:
    envs = cohabit.VectorEnv("cold_soda", 2, planes=("color",), autoreset_mode="Disabled", **SHORT)
    envs.reset(seed=0)
    turn = np.tile([CHOICES.index("turn_left"), 0], (2, 1))
    for _ in range(5):
        before, *_ = envs.step(turn)
    with pytest.raises(gymnasium.error.ResetNeeded, match="environments 0, 1 are over"):
        envs.step(turn)
    observation, infos = envs.reset(options={"reset_mask": np.array([True, False])})
    assert list(infos["tick"]) == [0, 50]
    assert (observation["color"][1] == before["color"][1]).all()
    *_, infos = envs.step_where(turn, np.array([True, False]))
    assert list(infos["tick"]) == [10, 50]


def test_arrays_can_be_kept() -> None:
    envs = cohabit.VectorEnv("cold_soda", 2, planes=("color",), size=16, slots=4, ticks_per_step=1)
    envs.reset(seed=0)
    turn = np.tile([CHOICES.index("turn_left"), 0], (2, 1))
    kept = [envs.step(turn)[0]["color"] for _ in range(20)]
    copies = [array.copy() for array in kept]
    for _ in range(20):
        envs.step(turn)
    assert all((array == copy).all() for array, copy in zip(kept, copies))
    assert len({array.ctypes.data for array in kept}) == 20 and not kept[0].flags.writeable


def test_pictures_of_a_vector() -> None:
    envs = cohabit.VectorEnv("cold_soda", 2, planes=(), render_mode="rgb_array", render_size=(32, 24))
    envs.reset(seed=0)
    pictures = envs.render()
    assert pictures is not None and [picture.shape for picture in pictures] == [(24, 32, 3)] * 2


@pytest.mark.parametrize("name", ["MakeCereal", "ColdSoda", "LaserLab", "WarmCoffee"])
def test_built_in_missions_are_registered(name: str) -> None:
    shown: dict[str, Any] = {"planes": (), "render_mode": "rgb_array", "render_size": (32, 24)}
    env = gymnasium.make(f"Cohabit/{name}-v0", **shown)
    _, info = env.reset(seed=0)
    assert info["instruction"] and env.render().shape == (24, 32, 3)
    envs = gymnasium.make_vec(f"Cohabit/{name}-v0", 2, **shown)
    assert isinstance(envs.unwrapped, cohabit.VectorEnv) and envs.unwrapped.render_mode == "rgb_array"
    _, infos = envs.reset(seed=0)
    assert list(infos["instruction"]) == [info["instruction"]] * 2 and list(infos["mission"]) == [info["mission"]] * 2
    pictures = envs.render()
    assert pictures is not None and (pictures[0] == env.render()).all()


def test_how_environments_are_shown_is_checked() -> None:
    for make in (cohabit.Env, cohabit.ParallelEnv, cohabit.VectorEnv):
        with pytest.raises(ValueError, match="no render_mode `human`: rgb_array"):
            make(planes=(), render_mode="human")
    envs = cohabit.VectorEnv("cold_soda", 2, planes=())
    envs.reset(seed=0)
    assert envs.render() is None


def test_actions_are_sampled_by_masks() -> None:
    envs = cohabit.VectorEnv("cold_soda", 3, planes=(), **SHORT)
    with pytest.raises(gymnasium.error.ResetNeeded):
        envs.sample()
    _, infos = envs.reset(seed=0)
    drawn = [envs.sample(seed=1), *[envs.sample() for _ in range(50)]]
    assert all(one.shape == (3, 2) and one.dtype == np.int64 for one in drawn)
    again = [envs.sample(infos["action_masks"], seed=1), *[envs.sample(infos["action_masks"]) for _ in range(50)]]
    assert all((one == other).all() for one, other in zip(drawn, again))
    for chosen in drawn:
        for place, (choice, slot) in enumerate(chosen):
            mask = infos["action_masks"][place]
            assert mask[choice] and mask[len(CHOICES) + slot]
    assert len({int(one[0, 0]) for one in drawn}) > 5, "choices vary"
    only = np.zeros((3, len(CHOICES) + 8), np.int8)
    only[:, CHOICES.index("turn_left")] = only[:, len(CHOICES) + 5] = 1
    assert (envs.sample(only) == [CHOICES.index("turn_left"), 5]).all()
    assert (envs.sample(np.zeros_like(only)) == 0).all()
    envs.step(envs.sample())
    with pytest.raises(ValueError, match=r"masks of shape \(3, 4\): expected shape \(3, "):
        envs.sample(np.ones((3, 4)))
    with pytest.raises(ValueError, match=r"masks of shape \(4,\): expected \[N, "):
        cohabit.sample_actions(np.ones(4))


def test_worlds_of_a_vector_act_in_words_on_what_was_seen() -> None:
    same: dict[str, Any] = {"planes": (), "knows": "seen", "slots": 256}
    envs, env = cohabit.VectorEnv("cold_soda", 2, **same), cohabit.Env("cold_soda", **same)
    with pytest.raises(gymnasium.error.ResetNeeded, match=r"env.act\(\)"):
        envs.act([GoTo("Lab1")] * 2)
    envs.reset(seed=0)
    env.reset(seed=0)
    ray, can = GoTo("V_Monitor_FreezeRay_10000"), "CanSodaNew_01_1"
    ones = [ray, GoTo(can), PickUp(can), GoTo("Lab1"), ray]
    others = [GoTo(can), ray, GoTo("Lab1"), GoTo("BreakRoom"), ray]
    for one, other in zip(ones, others):
        observation, _, _, _, infos = envs.act([one, other])
        single, *_, info = env.act(one)
        check_row(observation, 0, single)
        assert (infos["status"][0], infos["detail"][0]) == (info["status"], info["detail"])
    assert set(infos["status"]) <= {"ActionSuccessful", "AlternateNavigationUsed"}
    envs.reset(seed=0)
    *_, infos = envs.act([ray, ray])
    assert list(infos["status"]) == ["InvalidObjectClass"] * 2 and "has been seen yet" in infos["detail"][1]
    with pytest.raises(ValueError, match="1 actions for 2 environments"):
        envs.act([ray])
    with pytest.raises(ValueError, match="nobody knows `all`"):
        cohabit.VectorEnv(knows="all")


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_worlds_whose_steps_last_differently_are_stepped_alike_by_any_threads(threads: int) -> None:
    def digests(threads: int) -> list[bytes]:
        envs = cohabit.VectorEnv("cold_soda", 5, planes=(), slots=8, max_steps=4, threads=threads)
        envs.reset(seed=0)
        go = [CHOICES.index(name) for name in ("wait", "turn_left", "go_to_Lab1", "go_to_Warehouse", "look_up")]
        for turn in range(5):
            envs.step(np.array([[go[(place + turn) % 5], 0] for place in range(5)]))
        return [envs.stage.digest(place) for place in range(5)]

    assert digests(threads) == digests(3)


def test_a_choice_that_there_is_not_changes_no_world() -> None:
    envs = cohabit.VectorEnv("cold_soda", 2, planes=(), threads=2, **SHORT)
    envs.reset(seed=0)
    before = [envs.stage.digest(place) for place in range(2)]
    for choice in (len(CHOICES), -1):
        with pytest.raises(ValueError, match=f"no choice {choice}: 0 to {len(CHOICES) - 1}"):
            envs.step(np.array([[CHOICES.index("turn_left"), 0], [choice, 0]]))
    assert [envs.stage.digest(place) for place in range(2)] == before
    *_, infos = envs.step(np.array([[CHOICES.index("pick_up"), -1]] * 2))
    assert list(infos["status"]) == ["InvalidObjectClass"] * 2


def test_what_a_refused_reset_left_is_not_taken_for_what_was_to_be() -> None:
    envs = cohabit.VectorEnv("make_cereal", 2, planes=())
    envs.reset(seed=0)
    with pytest.raises(ValueError, match="warm_cofee"):
        envs.reset(options={"mission": ["cold_soda", "warm_cofee"]})
    _, infos = envs.reset(seed=0, options={"mission": ["cold_soda", "warm_coffee"]})
    for place, name in enumerate(["cold_soda", "warm_coffee"]):
        assert infos["mission"][place] == f"{name}.json"
        single = cohabit.Env(name, planes=())
        single.reset(seed=place)
        assert envs.stage.digest(place) == single.office.world.digest(), name
