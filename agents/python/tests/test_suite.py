"""Suites of missions, what policies make of them, and what bodies can do as tools."""

from __future__ import annotations

import copy
import json
import pickle
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest

import cohabit
from cohabit import CHOICES, GoTo, PickUp, _native


@pytest.fixture(scope="module")
def made() -> cohabit.Suite:
    return cohabit.generate(24, seed=3)


def test_types_that_were_given_up_are_told(monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture) -> None:
    line = _native.generate_missions(1, 1, None, None, 1, [])[0][0]
    given_up = ([line], [("deliver", 3, "there is no room")])
    monkeypatch.setattr(_native, "generate_missions", lambda *_: given_up)
    assert len(cohabit.generate(1)) == 1
    assert "deliver: 3 given up, the last because there is no room" in caplog.text


def test_missions_are_made_by_a_seed(made: cohabit.Suite) -> None:
    few, again = cohabit.generate(4, seed=3), cohabit.generate(4, seed=3, workers=1)
    assert [one.text for one in few] == [one.text for one in again] == [one.text for one in made[:4]]
    assert all(one.instruction and one.type and one.layout for one in made)
    assert any(one.things for one in made)
    few = cohabit.generate(3, seed=1, types=["breakObject"])
    assert few.types == ["breakObject"]
    with pytest.raises(ValueError, match="no type `cook`; there are breakObject"):
        cohabit.generate(1, types=["cook"])


def test_a_suite_is_written_and_read(made: cohabit.Suite, tmp_path: Path) -> None:
    made.save(tmp_path / "missions.jsonl")
    assert list(cohabit.suite(tmp_path / "missions.jsonl")) == list(made)
    (tmp_path / "one.json").write_text(made[0].text)
    folder = tmp_path / "folder"
    folder.mkdir()
    (folder / "two.json").write_text(made[0].text)
    (folder / "manifest.json").write_text('{"parts": {}}')
    assert [one.id for one in cohabit.suite(folder)] == ["two"], "a manifest is no mission"
    assert [one.id for one in cohabit.suite(tmp_path / "one.json")] == ["one"]
    assert [one.id for one in cohabit.suite(tmp_path)] == ["one"]
    session = {"CDF": json.loads(made[0].text), "human_annotations": [{"instructions": [{"instruction": "Go."}]}]}
    (tmp_path / "arena.json").write_text(json.dumps({"T1": session}))
    (arena,) = cohabit.suite(tmp_path / "arena.json")
    assert (arena.id, arena.instruction) == ("T1#human1", "Go.")
    for text, problem in [("{", r"bad.jsonl:1: "), ('{"id": 1}', r'bad.jsonl:1: .*"id" and "cdf"'), ("", "no missions")]:
        (tmp_path / "bad.jsonl").write_text(text)
        with pytest.raises(ValueError, match=problem):
            cohabit.suite(tmp_path / "bad.jsonl")


def test_a_suite_is_parted(made: cohabit.Suite) -> None:
    parts = made.split(share=0.2, seed=1)
    assert sum(len(part) for part in parts.values()) == len(made) and "train" in parts
    assert {name: list(part) for name, part in parts.items()} == {
        name: list(part) for name, part in made.split(share=0.2, seed=1).items()
    }


def test_a_mission_with_words_of_several_people_is_in_one_part(made: cohabit.Suite, tmp_path: Path) -> None:
    sessions = {
        one.id: {
            "CDF": json.loads(one.text),
            "human_annotations": [{"instructions": [{"instruction": words}]} for words in ("Go.", "Walk.", "Move.")],
        }
        for one in made
    }
    (tmp_path / "arena.json").write_text(json.dumps(sessions))
    parts = cohabit.suite(tmp_path / "arena.json").split(share=0.2, seed=1)
    assert sum(len(part) for part in parts.values()) == 3 * len(made)
    texts = [{one.text for one in part} for part in parts.values()]
    assert len(set().union(*texts)) == sum(map(len, texts))


def test_missions_are_sampled_by_the_seed(made: cohabit.Suite) -> None:
    env = cohabit.Env(made, planes=(), instruction=True)
    played = []
    for seed in (1, 2, 3, 1):
        observation, info = env.reset(seed=seed)
        assert observation["instruction"] == made.sample(seed).instruction == info["instruction"]
        assert env.observation_space.contains(observation)
        played.append((info["mission"], env.office.world.digest()))
    assert played[0] == played[3] and len(set(played)) > 1
    many = cohabit.VectorEnv(made, 3, planes=())
    _, infos = many.reset(seed=1)
    assert list(infos["mission"]) == [made.sample(seed).id for seed in (1, 2, 3)]
    assert [many.stage.digest(place) for place in range(3)] == [digest for _, digest in played[:3]]


def test_built_in_missions_vary_if_they_are_to() -> None:
    def digests(**arguments: Any) -> list[bytes]:
        env = cohabit.Env("cold_soda", planes=(), **arguments)
        found = []
        for seed in (1, 2, 1):
            env.reset(seed=seed)
            found.append(env.office.world.digest())
        return found

    one, other, again = digests(randomize=True)
    assert one == again != other
    assert len(set(digests())) == 1


def test_a_policy_is_evaluated(made: cohabit.Suite, tmp_path: Path) -> None:
    def wait(observation: dict[str, Any], infos: dict[str, Any]) -> np.ndarray:
        return np.tile([CHOICES.index("turn_left"), 0], (len(infos["tick"]), 1))

    short: dict[str, Any] = {"planes": (), "max_steps": 3, "ticks_per_step": 5}
    told = cohabit.evaluate(wait, made, 5, seed=2, num_envs=2, record=tmp_path, **short)
    assert [episode.mission for episode in told.episodes] == [one.id for one in made[:5]]
    assert [episode.seed for episode in told.episodes] == [2, 3, 4, 5, 6]
    row = told.rows[-1]
    assert (row.type, row.episodes, row.solved, row.mean_steps) == ("all", 5, 0, 3.0)
    assert row.interval_95[0] == 0.0 and row.interval_95[1] == pytest.approx(0.4345, abs=1e-3)
    assert "all" in str(told) and "95 % interval" in str(told)
    lines = [json.loads(line) for line in (tmp_path / "episodes.jsonl").read_text().splitlines()]
    assert lines[3]["actions"] == [[CHOICES.index("turn_left"), 0]] * 3
    env = cohabit.Env(**short)
    env.reset(seed=lines[3]["seed"], options={"mission": made[3]})
    *_, info = [env.step(np.array(action)) for action in lines[3]["actions"]][-1]
    assert (info["tick"], info["score"]) == (lines[3]["ticks"], lines[3]["score"])
    alone = cohabit.evaluate(wait, made, 5, seed=2, num_envs=1, **short)
    assert alone == told


def test_missions_are_named_in_many_ways(made: cohabit.Suite, tmp_path: Path) -> None:
    def wait(observation: dict[str, Any], infos: dict[str, Any]) -> np.ndarray:
        return np.zeros((len(infos["tick"]), 2), np.int64)

    made[:3].save(tmp_path / "missions.jsonl")
    (tmp_path / "one.json").write_text(made[0].text)
    for missions, named in [
        ("make_cereal", ["make_cereal"]),
        (tmp_path / "missions.jsonl", [one.id for one in made[:3]]),
        (str(tmp_path / "one.json"), ["one"]),
        (made[:2], [one.id for one in made[:2]]),
        (made[0], [made[0].id]),
        (["cold_soda", made[1], tmp_path / "one.json"], ["cold_soda", made[1].id, "one"]),
        (json.loads(made[0].text), ["mission"]),
    ]:
        told = cohabit.evaluate(wait, missions, planes=(), max_steps=1, ticks_per_step=1)
        assert [episode.mission for episode in told.episodes] == named
    with pytest.raises(ValueError, match="make_serial: there is no such file, and no built-in mission of that name"):
        cohabit.evaluate(wait, "make_serial")
    for wrong in (3, None, b"make_cereal"):
        with pytest.raises(ValueError, match=f"missions are {wrong!r}: a suite, a mission, a name, a path"):
            cohabit.evaluate(wait, wrong)
    with pytest.raises(ValueError, match="0 missions"):
        cohabit.evaluate(wait, [])
    with pytest.raises(TypeError, match="a policy is a function of observations and infos, not of type str"):
        cohabit.evaluate("make_cereal", wait)


def test_a_mission_is_printed_in_a_line(made: cohabit.Suite) -> None:
    for mission in made:
        cdf = json.loads(mission.text)
        objects, goals = len(cdf["scene"]["required_objects"]), len(cdf["task_goals"])
        expected = f"<cohabit.Mission {mission.id} on {mission.layout}: {objects} objects, {goals} goals>"
        assert repr(mission) == expected and goals > 0
    assert repr(cohabit.Mission("broken", "{")) == "<cohabit.Mission broken on any floor plan: 0 objects, 0 goals>"


def test_scores_and_rewards_stay_between_their_bounds() -> None:
    env = cohabit.Env("cold_soda", planes=(), ticks_per_step=60 * 100, max_steps=12)
    _, info = env.reset(seed=0)
    assert info["score"] == 1000
    earned = 0.0
    for _ in range(12):
        _, reward, _, truncated, info = env.step(np.array([CHOICES.index("wait"), 0]))
        earned += reward
    assert truncated and info["score"] == 100 and earned == pytest.approx(-9.0)


def test_environments_are_pickled_and_copied() -> None:
    env = cohabit.Env(planes=("color", "ids"), size=24, slots=8, ticks_per_step=3)
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.action_masks()
    env.reset(seed=4)
    env.step(np.array([CHOICES.index("move_ahead"), 0]))
    for other in (pickle.loads(pickle.dumps(env)), copy.deepcopy(env)):
        assert other.office.world.digest() == env.office.world.digest()
    other = pickle.loads(pickle.dumps(env))
    for choice in ("wait", "turn_left", "wait", "go_to"):
        action = np.array([CHOICES.index(choice), 0])
        assert gymnasium.utils.env_checker.data_equivalence(env.step(action), other.step(action), exact=True)
    state = pickle.loads(pickle.dumps(env.state))
    assert (state.tick, state.score, repr(state)) == (env.state.tick, env.state.score, repr(env.state))


def test_masks_stay_arrays_in_vectors() -> None:
    env = cohabit.Env(planes=(), slots=8)
    _, info = env.reset(seed=0)
    kinds, slots = info["action_mask"]
    assert (env.action_masks() == np.concatenate([kinds, slots]).astype(bool)).all()
    envs = gymnasium.vector.SyncVectorEnv([lambda: cohabit.Env(planes=(), slots=8)] * 2)
    _, infos = envs.reset(seed=0)
    assert infos["action_masks"].shape == (2, len(CHOICES) + 8) and infos["action_masks"].dtype == np.bool_


def test_what_was_never_seen_cannot_be_named_if_that_is_asked_for() -> None:
    env = cohabit.Env("cold_soda", planes=(), knows="seen", slots=256)
    env.reset(seed=0)
    *_, info = env.act(GoTo("V_Monitor_FreezeRay_10000"))
    assert info["status"] == "InvalidObjectClass" and "`V_Monitor_FreezeRay_10000` has been seen yet" in info["detail"]
    assert env.act(GoTo("CanSodaNew_01_1"))[-1]["status"] == "ActionSuccessful"
    assert env.act(PickUp("CanSodaNew_01"))[-1]["status"] == "ActionSuccessful"
    env.act(GoTo("Lab1"))
    assert env.act(GoTo("V_Monitor_FreezeRay_10000"))[-1]["status"] in ("ActionSuccessful", "AlternateNavigationUsed")
    with pytest.raises(ValueError, match="nobody knows `all`"):
        cohabit.Env(knows="all")


def test_ids_that_nobody_asked_for_are_not_drawn() -> None:
    env = cohabit.Env(planes=("color",), size=16)
    env.reset(seed=0)
    (frame,) = env.office.world.look(["sense-0"])
    assert frame.planes == ["color"]


def test_only_a_body_has_tools() -> None:
    for other in (cohabit.VectorEnv("cold_soda", 2, planes=()), cohabit.ParallelEnv("cold_soda", planes=()), "cold_soda"):
        with pytest.raises(TypeError, match=f"tools are those of one body.*: a {type(other).__name__} has none"):
            cohabit.tools(other)
    wrapped = gymnasium.make("Cohabit/ColdSoda-v0", planes=())
    tools = cohabit.tools(wrapped)
    assert tools.call("look_around", {}) == "Refused: no episode has begun: reset the environment first."
    wrapped.reset(seed=0)
    assert tools.call("look_around", {}) == "I looked"


def test_a_body_has_tools() -> None:
    env = cohabit.Env("cold_soda", planes=())
    env.reset(seed=0)
    tools = cohabit.tools(env)
    named = {tool["function"]["name"]: tool["function"] for tool in tools.schemas()}
    assert {"go_to", "pick_up", "place", "toggle", "move", "look_around"} <= set(named)
    assert named["pick_up"]["parameters"]["required"] == ["object"] and "grab" in named["pick_up"]["description"]
    assert all("{" not in tool["description"] for tool in named.values())
    assert [tool["name"] for tool in tools.schemas("mcp")] == list(named)
    assert not tools.call("go_to", {"object": "CanSodaNew_01_1"}).startswith("Refused")
    refused = "Refused (InvalidObjectClass): there is no object `bowel`"
    assert tools.call("pick_up", {"object": "bowel"}).startswith(refused)
    assert tools.call("fly", {}).startswith("Refused: there is no tool `fly`")
    assert tools.call("move", {"distance_m": "far"}) == "Refused: `distance_m` is 'far': a number from -10.0 to 10.0."
    assert "takes object" in tools.call("open", {})


def test_what_was_played_is_kept_where_a_policy_fails(made: cohabit.Suite, tmp_path: Path) -> None:
    def policy(observation: Any, infos: dict[str, Any]) -> Any:
        if infos["mission"][0] == made[1].id:
            raise RuntimeError("out of memory")
        return np.zeros((1, 2), np.int64)

    with pytest.raises(RuntimeError, match="out of memory"):
        cohabit.evaluate(policy, made[:2], num_envs=1, record=tmp_path, planes=(), max_steps=1)
    (line,) = (tmp_path / "episodes.jsonl.part").read_text().splitlines()
    assert json.loads(line)["mission"] == made[0].id
    assert not (tmp_path / "episodes.jsonl").exists()
