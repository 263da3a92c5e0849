"""Environments: their contracts, and that they repeat to the bit."""

from __future__ import annotations

import json
import runpy
import warnings
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from pettingzoo.test import parallel_api_test, parallel_seed_test

import cohabit
from cohabit import CHOICES, GoTo, Interact, PickUp, Place


def choose(env: cohabit.Env, name: str, object: str = "") -> np.ndarray:
    """That choice, with the slot of an object of that class."""
    if not object:
        return np.array([CHOICES.index(name), 0])
    number = cohabit.CLASSES.index(object) + 1
    observation = env.office.observe([0])[0][0]
    (slots,) = np.nonzero(observation["slot_classes"] == number)
    return np.array([CHOICES.index(name), slots[0]])


@pytest.mark.parametrize("planes", [(), ("color", "depth", "normals", "ids")])
def test_gymnasium_finds_nothing_wrong(planes: tuple[str, ...]) -> None:
    env = cohabit.Env(planes=planes, size=48, max_steps=20, render_mode="rgb_array", render_size=(64, 48))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", message=".*(infinity|not within the recommended|spec).*")
        check_env(env, skip_render_check=False)


@pytest.mark.parametrize("ticks", [None, 6])
def test_pettingzoo_finds_nothing_wrong(ticks: int | None) -> None:
    make = lambda: cohabit.ParallelEnv(  # noqa: E731
        bodies=("robot", "person@Lab1"), planes=(), max_steps=15, ticks_per_step=ticks
    )
    parallel_api_test(make(), num_cycles=30)
    parallel_seed_test(make, num_cycles=8)


def trace(env: cohabit.Env, seed: int, steps: int) -> list[Any]:
    """All that is observed and earned with choices drawn at random."""
    observation, info = env.reset(seed=seed)
    env.action_space.seed(seed)
    seen = [observation]
    for _ in range(steps):
        action = env.action_space.sample(mask=info["action_mask"])
        observation, reward, terminated, truncated, info = env.step(action)
        seen.append((observation, reward, terminated, truncated, info["status"], info["detail"], info["tick"]))
        if terminated or truncated:
            break
    return seen


def test_the_same_seed_and_actions_give_the_same_bits() -> None:
    one = cohabit.Env(size=64, ticks_per_step=20)
    first = trace(one, 5, 40)
    again = trace(one, 5, 40)
    other = trace(cohabit.Env(size=64, ticks_per_step=20, threads=2), 5, 40)
    for second in (again, other):
        assert gymnasium.utils.env_checker.data_equivalence(first, second, exact=True)
    assert one.office.world.digest() == one.office.world.digest()


def test_chance_follows_the_seed() -> None:
    mission = json.loads(builtin("make_cereal"))
    mission["scene"]["floor_plan"] = "-1"
    env = cohabit.Env(mission, planes=())
    digests = []
    for seed in (1, 2, 1):
        env.reset(seed=seed)
        digests.append(env.office.world.digest())
    assert digests[0] == digests[2] != digests[1]


def builtin(name: str) -> str:
    root = Path(__file__).parents[3]
    path = root / "cdf" / "missions" / f"{name}.json"
    if not path.is_file():
        pytest.skip(f"{path} is not there")
    return path.read_text()


def test_a_step_is_a_command_to_its_outcome() -> None:
    env = cohabit.Env(planes=())
    observation, _ = env.reset(seed=0)
    assert observation["held"] == 0
    assert observation["slot_states"].shape[1] == len(cohabit.FLAGS)
    assert f"``[S, {len(cohabit.FLAGS)}]``" in (cohabit.office.__doc__ or ""), "as its table says"
    *_, info = env.step(choose(env, "go_to", "Bowl_01"))
    assert info["status"] == "ActionSuccessful"
    observation, reward, terminated, _, info = env.step(choose(env, "pick_up", "Bowl_01"))
    assert cohabit.CLASSES[observation["held"] - 1] == "Bowl_01" and not terminated
    assert info["score"] == 1100 - env.state.tick // 60 and reward > 0.9, "a goal was met"
    assert observation["goals"].sum() == 1
    *_, info = env.step(choose(env, "pick_up", "Bowl_01"))
    assert info["status"] == "AlreadyHoldingObject" and info["detail"]


def test_what_makes_no_sense_is_refused_as_data() -> None:
    env = cohabit.Env(planes=(), slots=400)
    env.reset(seed=0)
    *_, info = env.step(np.array([CHOICES.index("pick_up"), 399]))
    assert info["status"] == "InvalidObjectClass" and "action_mask" in info
    with pytest.raises(ValueError, match="no choice 99"):
        env.step(np.array([99, 0]))
    many = cohabit.ParallelEnv(bodies=(), planes=())
    many.reset(seed=0)
    for wrong, given in [
        (np.array([0, 0, 0]), r"shape \(3,\) and type int64"),
        (np.array([0.0, 1.0]), r"shape \(2,\) and type float64"),
        (3, r"shape \(\) and type int64"),
    ]:
        for step in (lambda: env.step(wrong), lambda: many.step({"robot_0": wrong})):  # noqa: B023
            with pytest.raises(ValueError, match=given + r": expected an array of shape \(2,\) of integers, a choice and a slot"):
                step()


def test_an_unknown_name_is_refused_as_data() -> None:
    env = cohabit.Env(planes=())
    env.reset(seed=0)
    for action, near in [
        (PickUp("bowel"), "no object `bowel` in this world: did you mean `Bowl`"),
        (GoTo("Labb1"), "no object or room `Labb1` in this world: did you mean `Lab1`"),
        (Place("Bowl_01_7"), "`Bowl_01_1`"),
        (Place("Bowl_01_1", "Bowl_01_7"), "`Bowl_01_1`"),
        (Interact("open", "zzyzx"), "there is no object `zzyzx` in this world"),
    ]:
        before = env.state.tick
        _, reward, terminated, _, info = env.act(action)
        assert info["status"] == "InvalidObjectClass" and near in info["detail"], info
        assert (terminated, env.state.tick) == (False, before + 1) and reward <= 0.0
    assert not info["detail"].endswith("?"), "nothing is called anything like that"


def test_an_environment_is_reset_before_its_first_step() -> None:
    env = cohabit.Env(planes=())
    many = cohabit.ParallelEnv(planes=())
    for step in [
        lambda: env.step(choose(env, "wait")),
        lambda: env.act(GoTo("bowl")),
        lambda: many.step({"robot_0": choose(env, "wait")}),
        lambda: many.act({"robot_0": GoTo("bowl")}),
    ]:
        with pytest.raises(gymnasium.error.ResetNeeded, match=r"before calling env.reset\(\)"):
            step()
    assert env.state.tick == 0
    env.reset(seed=0)
    assert env.step(choose(env, "wait"))[1] <= 0.0, "waiting pays nothing"


def test_options_hold_for_an_episode() -> None:
    env = cohabit.Env("cold_soda", planes=(), ticks_per_step=1)
    rooms = {}
    for name, options in [
        ("own", None),
        ("other mission", {"mission": "make_cereal"}),
        ("mirrored", {"layout": "OfficeLayout2_mirror"}),
        ("seeded", {"seed": 5}),
        ("seeded alike", {"seed": 5}),
        ("seeded otherwise", {"seed": 6}),
        ("own again", {}),
    ]:
        env.reset(seed=0, options=options)
        rooms[name] = (env.office.world.digest(), len(env.state.goals), env.state.find("TableRound_02").position)
    assert rooms["own"] == rooms["own again"]
    assert rooms["other mission"][1] != rooms["own"][1]
    assert rooms["mirrored"][2] != rooms["own"][2]
    assert rooms["seeded"][0] == rooms["seeded alike"][0] != rooms["seeded otherwise"][0]
    for options, problem in [
        ({"mission": "nowhere"}, "nowhere: there is no such file"),
        ({"layout": "Moonbase"}, "Moonbase"),
        ({"layout": 2}, "option `layout` is 2"),
        ({"seed": "five"}, "option `seed` is 'five'"),
    ]:
        for other in (env, cohabit.ParallelEnv("cold_soda", bodies=(), planes=())):
            with pytest.raises(ValueError, match=problem):
                other.reset(options=options)
    unknown = "no option `missions` of reset: one of mission, layout, seed"
    with pytest.raises(ValueError, match=unknown):
        env.reset(options={"missions": "make_cereal"})
    with pytest.warns(UserWarning, match=unknown):
        cohabit.ParallelEnv(planes=()).reset(options={"missions": "make_cereal"})
    env.reset(seed=0)
    assert env.office.world.digest() == rooms["own"][0], "what failed changed nothing"


def test_the_example_meets_all_goals() -> None:
    example = Path(__file__).parents[1] / "examples" / "cold_soda.py"
    goals = runpy.run_path(str(example))["env"].state.goals
    assert len(goals) == 3 and all(goal.met for goal in goals), goals


def test_ticks_go_by_as_many_as_asked_for() -> None:
    env = cohabit.Env(planes=(), ticks_per_step=3, max_steps=1000)
    env.reset(seed=0)
    statuses = []
    observation, *_, info = env.step(choose(env, "move_ahead"))
    assert (info["tick"], observation["busy"], info["status"]) == (3, 1, "")
    while not (statuses and statuses[-1]):
        *_, info = env.step(choose(env, "wait"))
        statuses.append(info["status"])
    assert statuses[-1] == "ActionSuccessful"
    assert info["tick"] == 3 * (1 + len(statuses))


def test_seen_things_fill_slots_and_masks_say_what_they_afford() -> None:
    env = cohabit.Env(planes=("ids",), size=128, slots=16)
    observation, info = env.reset(seed=0)
    ids = set(observation["slot_ids"]) - {0}
    assert ids and ids <= set(np.unique(observation["ids"]))
    kinds, slots = info["action_mask"]
    assert slots.sum() == len(ids)
    assert not kinds[CHOICES.index("place")] and kinds[CHOICES.index("go_to")]
    assert info["affordances"].shape == (len(CHOICES), 16)


def test_observations_can_be_kept_as_long_as_one_likes() -> None:
    env = cohabit.Env(planes=("color",), size=16, ticks_per_step=1)
    env.reset(seed=0)
    kept = [env.step(choose(env, "turn_left"))[0]["color"] for _ in range(30)]
    assert not kept[0].flags.writeable
    assert len({array.ctypes.data for array in kept}) == 30
    assert (kept[0] != kept[-1]).any()


def test_an_episode_ends_with_its_mission() -> None:
    env = cohabit.Env("cold_soda", planes=())
    env.reset(seed=0)
    can, shelf, computer = "CanSodaNew_01_1", "AP_Prop_Shelf_Wall_04_10000", "V_Monitor_FreezeRay_10000"
    actions = [GoTo(can), PickUp(can), GoTo(shelf), Place(shelf), GoTo(computer), Interact("toggle", computer)]
    earned, terminated = 0.0, False
    for action in actions:
        assert not terminated
        _, reward, terminated, _, info = env.act(action)
        earned += reward
    for _ in range(20):
        if not terminated:
            _, reward, terminated, _, info = env.step(choose(env, "wait"))
            earned += reward
    assert (terminated, info["ending"], env.state.ending) == (True, "complete", "complete")
    assert earned == pytest.approx((env.state.score - 1000) / 100)


def test_an_episode_is_cut_off_after_so_many_steps() -> None:
    env = cohabit.Env(planes=(), max_steps=2)
    env.reset(seed=0)
    assert [env.step(choose(env, "turn_left"))[3] for _ in range(2)] == [False, True]


def test_bodies_act_at_once() -> None:
    env = cohabit.ParallelEnv(bodies=("robot",), planes=("color", "ids"), size=32)
    observations, _ = env.reset(seed=3)
    assert list(observations) == ["robot_0", "robot_1"]
    _, rewards, _, _, infos = env.act({"robot_0": cohabit.GoTo("Lab1"), "robot_1": cohabit.Rotate(1.0)})
    assert {info["status"] for info in infos.values()} == {"ActionSuccessful"}
    assert len(set(rewards.values())) == 1
    rooms = [body.room for body in env.state().bodies]
    assert rooms == ["Lab1", "BreakRoom"]


@pytest.mark.parametrize("kind", ["sync", "async"])
def test_many_worlds_beside_each_other(kind: str) -> None:
    envs = gymnasium.make_vec(
        "Cohabit/Mission-v0", 2, vectorization_mode=kind, planes=("color",), size=16, ticks_per_step=10
    )
    observations, _ = envs.reset(seed=1)
    assert observations["color"].shape == (2, 16, 16, 4)
    for _ in range(3):
        observations, *_ = envs.step(np.tile([CHOICES.index("turn_left"), 0], (2, 1)))
    assert (observations["color"][0] == observations["color"][1]).all()
    envs.close()


def test_bad_arguments_are_named() -> None:
    for arguments, problem in [
        ({"mission": "nowhere.json"}, "nowhere.json: there is no such file, and no built-in mission"),
        ({"mission": {"scene": 1}}, "/scene: expected an object"),
        ({"planes": ("colour",)}, "no plane `colour`: color, depth"),
        ({"camera": "periscope"}, "no kind of camera `periscope`"),
        ({"camera": "egocentric,zoom=3"}, "zoom"),
        ({"size": 100_000}, "100000"),
        ({"bodies": ("dog",)}, "no body `dog`"),
        ({"fill": "some"}, "no slots `some`"),
        ({"slots": 0}, "0 slots"),
        ({"ticks_per_step": 0}, "0 ticks a step"),
        ({"render_mode": "human"}, "no render_mode `human`"),
        ({"mission": ["make_cereal"]}, "a mission is a name, a path, a dictionary, .*, not of type list"),
    ]:
        with pytest.raises(ValueError, match=problem):
            cohabit.Env(**arguments).reset()


def test_a_command_in_the_place_of_another_is_told_of_alone() -> None:
    env = cohabit.Env(planes=(), ticks_per_step=10)
    env.reset(seed=0)
    env.act(GoTo("Lab1"))
    *_, info = env.act(PickUp("zzyzx"))
    assert info["status"] == "InvalidObjectClass", info["detail"]
    env.act(GoTo("Lab1"))
    *_, info = env.act(GoTo("MainOffice"))
    assert info["status"] == "", "it is under way"


def test_a_mission_has_robots_of_its_own() -> None:
    mission = json.loads(builtin("make_cereal"))
    robots = [{"name": "TAM_1", "roomLocation": ["BreakRoom"]}, {"name": "TAM_2", "roomLocation": ["Lab1"]}]
    mission["scene"]["simbot_init"] = robots
    env = cohabit.ParallelEnv(mission, bodies=(), planes=("color",), size=24)
    observations, _ = env.reset(seed=0)
    assert len(observations) == 2
    assert all(env.observation_space(agent).contains(one) for agent, one in observations.items())


def test_agents_are_those_of_missions_with_as_many_robots() -> None:
    mission = json.loads(builtin("make_cereal"))
    mission["scene"]["simbot_init"] = [{"name": name, "roomLocation": ["BreakRoom"]} for name in ("TAM_1", "TAM_2")]
    for planes in ((), ("color",)):
        env = cohabit.ParallelEnv(mission, bodies=(), planes=planes, size=24)
        env.reset(seed=0)
        with pytest.raises(ValueError, match="mission `.*` has 1 bodies, and this environment has 2 agents: play"):
            env.reset(seed=0, options={"mission": "cold_soda"})
        assert len(env.reset(seed=0, options={"mission": mission})[0]) == 2


def test_a_dictionary_that_was_changed_is_another_mission() -> None:
    mission = json.loads(builtin("make_cereal"))
    env = cohabit.Env(mission, planes=())
    envs = cohabit.VectorEnv(mission, 2, planes=())
    env.reset(seed=0)
    envs.reset(seed=0)
    mission["goal_text"] = "Have breakfast"
    _, info = env.reset(seed=0, options={"mission": mission})
    _, infos = envs.reset(seed=0, options={"mission": mission})
    assert [info["instruction"], *infos["instruction"]] == ["Have breakfast"] * 3
    assert '"Have breakfast"' in env.office.world.made_of()[1], "the world has it too"


def test_a_position_is_a_point_to_walk_to() -> None:
    env = cohabit.Env(planes=())
    env.reset(seed=0)
    begin = env.state.bodies[0].position
    assert len(begin) == 3 and env.act(GoTo("Lab1"))[-1]["status"] == "ActionSuccessful"
    *_, info = env.act(GoTo(begin))
    assert info["status"] in ("ActionSuccessful", "AlternateNavigationUsed"), info
    assert env.state.bodies[0].position == pytest.approx(begin, abs=0.3)
    with pytest.raises(ValueError, match=r"`target` is \(1.0,\): a room and a viewpoint's number, or a point"):
        env.act(GoTo((1.0,)))  # type: ignore[arg-type]
