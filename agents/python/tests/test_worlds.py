"""Environments in worlds with packs: their floor plans, objects, devices and missions."""

from __future__ import annotations

import copy
import pickle
from pathlib import Path

import numpy as np
import pytest

import cohabit
from cohabit import CHOICES, GoTo, Interact, PickUp, Place

TEMPLATE = Path(__file__).parents[3] / "cdf" / "templates" / "world"
WRENCH, DEGREASER = "Wrench_01_1", "Degreaser_01_1"
DONE = ("ActionSuccessful", "AlternateNavigationUsed")


@pytest.fixture
def pack(tmp_path: Path) -> Path:
    """The pack that `cohabit new world` writes."""
    if not TEMPLATE.is_dir():
        pytest.skip(f"{TEMPLATE} is not there")
    folder = tmp_path / "my-lab"
    for path in TEMPLATE.rglob("*"):
        if path.is_file():
            to = folder / path.relative_to(TEMPLATE)
            to.parent.mkdir(parents=True, exist_ok=True)
            to.write_text(path.read_text().replace('"NAME"', '"my-lab"'))
    return folder


def test_a_mission_of_a_pack_is_played(pack: Path) -> None:
    env = cohabit.Env("clean_wrench", planes=("color", "ids"), size=24, world=[pack])
    observation, info = env.reset(seed=0)
    assert info["instruction"] == "Clean the wrench" and env.observation_space.contains(observation)
    assert env.classes[: len(cohabit.CLASSES)] == cohabit.CLASSES and "Wrench_01" not in cohabit.CLASSES
    for action in [GoTo(WRENCH), PickUp(WRENCH)]:
        observation, *_, info = env.act(action)
        assert info["status"] in DONE, info
    assert env.classes[observation["held"] - 1] == "Wrench_01"
    assert env.state.find("wrench").instance == WRENCH
    (frame,) = env.office.world.look(["sense-0"])
    assert all(thing.class_id in env.classes for thing in frame.seen if thing.object is not None)
    for action in [GoTo(DEGREASER), Place(DEGREASER), Interact("toggle", DEGREASER)]:
        *_, info = env.act(action)
        assert info["status"] in DONE, info
    terminated = info["ending"] != "running"
    for _ in range(10):
        if not terminated:
            _, _, terminated, _, info = env.step(np.array([CHOICES.index("wait"), 0]))
    assert info["ending"] == "complete"


def test_what_a_pack_adds_is_afforded_and_named(pack: Path) -> None:
    env = cohabit.Env("clean_wrench", planes=(), world=pack, slots=64)
    env.reset(seed=0)
    observation, *_, info = env.act(GoTo(WRENCH))
    (slot,) = np.nonzero(observation["slot_classes"] == env.classes.index("Wrench_01") + 1)
    assert info["affordances"][CHOICES.index("pick_up"), slot[0]] == 1
    assert info["affordances"][CHOICES.index("open"), slot[0]] == 0
    assert not cohabit.tools(env).call("pick_up", {"object": "wrench"}).startswith("Refused")
    assert env.state.bodies[0].held == env.state.find(WRENCH).id


def test_vectors_suites_and_evaluation_take_packs(pack: Path) -> None:
    suite = cohabit.suite(world=pack)
    assert [one.id for one in suite] == ["clean_wrench"] and suite[:1].world == suite.world == (str(pack),)
    envs = cohabit.VectorEnv(suite, 2, planes=(), ticks_per_step=5)
    observation, infos = envs.reset(seed=0)
    single = cohabit.Env("clean_wrench", planes=(), ticks_per_step=5, world=str(pack))
    single.reset(seed=0)
    assert envs.stage.digest(0) == single.office.world.digest() and observation in envs.observation_space
    assert envs.classes == single.classes and list(infos["mission"]) == ["clean_wrench"] * 2

    def wait(observation: object, infos: dict[str, np.ndarray]) -> np.ndarray:
        return np.zeros((len(infos["tick"]), 2), np.int64)

    file = pack / "missions" / "clean_wrench.json"
    for missions, world in [(suite, ()), ("clean_wrench", pack), ([suite[0]], [pack]), (file, pack)]:
        told = cohabit.evaluate(wait, missions, planes=(), max_steps=2, ticks_per_step=5, world=world)
        assert [episode.mission for episode in told.episodes] == ["clean_wrench"]


def test_environments_with_packs_are_pickled_and_copied(pack: Path) -> None:
    env = cohabit.Env("clean_wrench", planes=(), ticks_per_step=3, world=[pack])
    env.reset(seed=4)
    env.step(np.array([CHOICES.index("move_ahead"), 0]))
    for other in (pickle.loads(pickle.dumps(env)), copy.deepcopy(env)):
        assert other.office.world.digest() == env.office.world.digest() and other.classes == env.classes
    state = pickle.loads(pickle.dumps(env.state))
    assert state.find(WRENCH).class_id == "Wrench_01" and state.world == [str(pack)]


def test_only_rooms_of_the_floor_plan_may_be_chosen(pack: Path) -> None:
    env = cohabit.Env("clean_wrench", planes=(), slots=4, world=[pack])
    envs = cohabit.VectorEnv("clean_wrench", 1, planes=(), slots=4, world=[pack])
    _, info = env.reset(seed=0)
    _, infos = envs.reset(seed=0)
    for masks in (info["action_masks"], infos["action_masks"][0]):
        may = {name for name, is_so in zip(CHOICES, masks) if is_so and name.removeprefix("go_to_") in cohabit.ROOMS}
        assert may == {"go_to_Hallway"}
    *_, info = env.step(np.array([CHOICES.index("go_to_Lab1"), 0]))
    assert info["status"] == "UnsupportedNavigation"


def test_what_is_wrong_with_a_pack_is_said(pack: Path) -> None:
    with pytest.raises(ValueError, match="clean_wrench: there is no such file, and no built-in mission"):
        cohabit.Env("clean_wrench", planes=())
    with pytest.raises(ValueError, match="nowhere: "):
        cohabit.Env("clean_wrench", planes=(), world=[pack.parent / "nowhere"])
    with pytest.raises(ValueError, match="no suite without a path"):
        cohabit.suite()
    (pack / "world.toml").unlink()
    with pytest.raises(ValueError, match="there is no `world.toml`"):
        cohabit.VectorEnv("clean_wrench", 2, planes=(), world=[pack])


def test_missions_are_made_with_packs(pack: Path) -> None:
    made = cohabit.generate(2, seed=3, world=pack)
    assert made.world == (str(pack),) and len(made) == 2
    cohabit.Env(made, planes=()).reset(seed=0)


def test_a_pack_that_comes_with_the_program_is_given_by_its_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    suite = cohabit.suite(world="homes")
    assert suite.world == ("homes",) and "make_tea" in [one.id for one in suite]
    env = cohabit.Env("make_tea", planes=(), world="homes")
    env.reset(seed=0)
    *_, info = env.act(GoTo("Kitchen"))
    assert info["status"] in DONE and env.state.bodies[0].room == "Kitchen", info
    assert pickle.loads(pickle.dumps(env)).office.world.digest() == env.office.world.digest()
    with pytest.raises(ValueError, match="hommes: "):
        cohabit.suite(world="hommes")
    # A folder of that name comes first.
    (tmp_path / "homes").mkdir()
    with pytest.raises(ValueError, match="there is no `world.toml`"):
        cohabit.suite(world="homes")
