"""Whole missions: the paper's two experiments, the official simulator, and the folder for it."""

from __future__ import annotations

import importlib.util
import json
import math
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import teamformer as teamformer_package
from teamformer.base.errors import TeamformerError
from teamformer.files.mission_files import read_mission
from teamformer.methods.by_name import load_method
from teamformer.mission.model import Mission
from teamformer.robotarium.benchmark import ROUGH, bench_robotarium, count_missions, summarise
from teamformer.robotarium.deployment.folder import deploy, verify
from teamformer.robotarium.deployment.policies import maker_of
from teamformer.robotarium.draw import Film
from teamformer.robotarium.experiment import Experiment, Simulator, run_experiment
from teamformer.robotarium.flight import Snapshot
from teamformer.robotarium.random_missions import random_mission
from teamformer.robotarium.robots.plant import Weather
from teamformer.robotarium.robots.rps_robots import RpsRobots, is_accepted
from typed import teamformer

EXAMPLES = Path(__file__).parents[2] / "examples"
needs_rps = pytest.mark.skipif(
    importlib.util.find_spec("rps") is None or importlib.util.find_spec("cvxopt") is None,
    reason="robotarium-python-simulator is not installed",
)


def four() -> Mission:
    return read_mission(EXAMPLES / "robotarium-4.yaml")


def fly(
    mission: Mission,
    method: str,
    simulator: Simulator = "plant",
    weather: Weather | None = None,
    watch: list[Snapshot] | None = None,
) -> Experiment:
    keep = None if watch is None else watch.append
    return run_experiment(mission, load_method(method), 0, simulator, weather, keep)


def test_four_form_one_team_split_and_finish() -> None:
    """The story of the paper's figure 7."""
    moments: list[Snapshot] = []
    done = fly(four(), "heuristic", watch=moments)
    assert done.is_good
    sizes = [sorted(len(team.robots) for team in moment.teams) for moment in moments]
    story = [sizes.index(part) for part in ([1, 1, 1, 1], [4], [2, 2])]
    assert story == sorted(story)
    assert done.outcome.done_at[0] == min(t for t in done.outcome.done_at if t is not None)
    assert done.outcome.tally.splits >= 1


def test_twenty_form_all_teams_at_their_tasks() -> None:
    """The story of the paper's figure 8, late and blurred besides."""
    mission = read_mission(EXAMPLES / "robotarium-20.yaml")
    done = fly(mission, "teamformer", weather=ROUGH)
    assert done.is_good, done.faults
    assert done.row()["tasks_done"] == 5
    assert done.faults.min_separation > 0.11


def test_a_task_that_takes_time_and_one_that_comes_late() -> None:
    mission = four()
    first, second, third = mission.tasks
    tasks = (replace(first, duration=5), replace(second, appears=40), third)
    base = fly(mission, "join-all")
    done = fly(replace(mission, tasks=tasks), "join-all")
    assert done.is_good
    before, after = base.outcome.done_at, done.outcome.done_at
    assert before[0] is not None
    assert after[0] == before[0] + 5 * 30
    assert after[1] is not None
    assert after[1] > 40 * 30


def test_the_time_limit() -> None:
    done = fly(replace(four(), step_limit=3), "join-all")
    assert not done.is_good
    assert (done.outcome.ticks, done.row()["makespan"]) == (90, None)
    assert done.row()["status"] == "step limit"


def test_two_who_meet_where_only_one_can_pass_do_not_wait_for_each_other() -> None:
    """Between two rings: one is needed beyond them, the other wants out of the way."""
    mission = random_mission(20, 5, 10, np.random.default_rng(37))
    done = run_experiment(mission, load_method("teamformer"), 37)
    assert done.is_good
    assert done.outcome.ticks < 3000  # it takes 2190; before they gave up, 19,050


def test_same_seed_same_mission() -> None:
    mission = random_mission(6, 3, 4, np.random.default_rng(4))
    one, other = (fly(mission, "join-all", weather=ROUGH) for _ in range(2))
    assert one.outcome.done_at == other.outcome.done_at
    assert one.faults == other.faults


@pytest.mark.slow
def test_pictures_of_every_phase(tmp_path: Path) -> None:
    from PIL import Image

    film = Film()
    done = run_experiment(four(), load_method("join-all"), watch=film.watch)
    files = film.write(done.mission, tmp_path)
    assert [file.suffix for file in files] == [".png"] * (len(files) - 1) + [".gif"]
    # Alone, two teams, one team, and after each of three tasks.
    assert len(files) == 6 + 1
    with Image.open(files[-1]) as gif:
        assert gif.n_frames == done.outcome.ticks // 15 + 1


@pytest.mark.parametrize(
    "method", ["heuristic", "teamformer", "join-fitting", "teamformer-c8", "gnn-c8-ppo"]
)
def test_the_folder_to_upload(method: str, tmp_path: Path) -> None:
    files = deploy(four(), method, 0, tmp_path)
    assert files[0].name == "main.py"
    assert all(file.parent == tmp_path and file.suffix in (".py", ".npy") for file in files)
    assert (tmp_path / "weights.npy").exists() == (method not in ("heuristic", "join-fitting"))
    for file in files:
        if file.suffix == ".py":
            compile(file.read_text(), file.name, "exec")
    ours = Path(teamformer_package.__file__).parent
    for name in ("world/env.py", "world/phases/motion.py", "robotarium/flight.py"):
        copied = tmp_path / f"tf_{name.replace('/', '_')}"
        assert copied.read_text() == (ours / name).read_text()


@pytest.mark.parametrize(
    "name", ["teamformer", "teamformer-c4", "teamformer-c4-ppo", "deepset-c4-ppo", "gnn-c4"]
)
def test_the_folder_decides_as_we_do(name: str, tmp_path: Path) -> None:
    """Without the package, numba and ONNX Runtime, its views and decisions are the same."""
    mission = random_mission(8, 4, 4, np.random.default_rng(2))
    deploy(mission, name, 0, tmp_path)
    maker = maker_of(name)
    script = (
        "import os, sys, json, numpy as np; sys.path.insert(0, '.')\n"
        "sys.modules.update(dict.fromkeys(('numba', 'onnxruntime')))\n"
        "from tf_experiment import MISSION\n"
        "from teamformer.world.env import TeamFormation\n"
        f"from teamformer.{maker.module} import {maker.function} as maker\n"
        f"env, policy, steps = TeamFormation([MISSION]), maker(*{maker.arguments!r}), []\n"
        "policy.begin(None, np.random.default_rng(0))\n"
        "while env.is_running[0]:\n"
        "    env.step(policy.decide(env.view()))\n"
        "    steps.append(env.worlds.robots['team'][0].tolist())\n"
        "print(json.dumps(steps))\n"
        "ours = [m for name, m in sys.modules.items() if name.startswith('teamformer')]\n"
        "files = {getattr(m, '__file__', None) or '' for m in ours} - {''}\n"
        "print(json.dumps(sorted({os.path.dirname(file) for file in files})))"
    )
    said = subprocess.run(
        [sys.executable, "-c", script], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    from teamformer.world.env import TeamFormation

    env, policy, steps = TeamFormation([mission]), load_method(name).policy, []
    policy.begin(None, np.random.default_rng(0))
    while env.is_running[0]:
        env.step(policy.decide(env.view()))
        steps.append(env.worlds.robots["team"][0].tolist())
    told, folders = map(json.loads, said.stdout.splitlines())
    assert folders == [str(tmp_path)]  # no module came from elsewhere
    assert told == steps
    assert len(steps) > 5


def test_what_cannot_be_deployed(tmp_path: Path) -> None:
    with pytest.raises(TeamformerError, match="'central' cannot be deployed"):
        deploy(four(), "central", 0, tmp_path)
    (tmp_path / "main.py").write_text("raise ValueError('broken')")
    with pytest.raises(TeamformerError, match="broken"):
        verify(tmp_path)


def test_only_what_a_deployment_left_is_replaced(tmp_path: Path) -> None:
    everybody = replace(four(), sensing_radius=math.inf)
    first = deploy(everybody, "teamformer", 0, tmp_path)
    assert first == [tmp_path / "main.py", *sorted(set(tmp_path.iterdir()) - {first[0]})]
    code = "from tf_experiment import MISSION; print(MISSION.sensing_radius)"
    said = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert said.stdout == "inf\n"
    again = deploy(everybody, "heuristic", 0, tmp_path)  # no network, so fewer files
    left = {path for path in tmp_path.iterdir() if path.name != "__pycache__"}
    assert set(again) == left
    assert tmp_path / "weights.npy" in set(first) - left
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(
        TeamformerError, match=r"holds files that are not of a deployment, notes.txt"
    ):
        deploy(everybody, "heuristic", 0, tmp_path)


def test_a_main_file_of_somebody_else_s_stays(tmp_path: Path) -> None:
    (tmp_path / "main.py").write_text("mine")
    with pytest.raises(TeamformerError, match=r"main.py for example"):
        deploy(four(), "heuristic", 0, tmp_path)
    assert (tmp_path / "main.py").read_text() == "mine"


@needs_rps
def test_the_official_simulator_tells_the_same_story() -> None:
    mission = random_mission(10, 4, 6, np.random.default_rng(1))
    ours, theirs = fly(mission, "teamformer"), fly(mission, "teamformer", "rps")
    assert ours.is_good
    assert theirs.is_good
    assert ours.outcome.done_at == theirs.outcome.done_at
    assert is_accepted(theirs.report)


@needs_rps
def test_the_folder_runs_on_the_official_simulator(tmp_path: Path) -> None:
    deploy(four(), "teamformer", 0, tmp_path)
    found, ours = verify(tmp_path), fly(four(), "teamformer").row()
    for key in ("status", "done_at_tick", "collisions", "boundary_violations"):
        assert found[key] == ours[key]


@needs_rps
def test_what_is_deployed_is_run_where_the_simulator_is(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    words = ("robotarium", "deploy", str(EXAMPLES / "robotarium-4.yaml"), str(tmp_path))
    assert teamformer(*words) == 0
    told = capsys.readouterr()
    ours = fly(four(), "teamformer").row()
    assert told.out.count(f"  {ours['done_at_tick']}") == 2  # there and here
    monkeypatch.setattr("teamformer.cli.verbs.robots.robotarium.find_spec", lambda library: None)
    assert teamformer(*words) == 0
    told = capsys.readouterr()
    assert told.out == ""
    assert "the folder was not run" in told.err


class Newer:
    """The interface of version 2.1 as far as a script sees it: poses once a step, then debug()."""

    def __init__(self, number_of_robots: int, initial_conditions: np.ndarray, **_: object) -> None:
        print("Initializing ...")
        assert initial_conditions.shape == (3, number_of_robots)
        self.poses, self.log = initial_conditions, list[str]()

    def get_poses(self) -> np.ndarray:
        print("looking")
        self.log.append("look")
        return self.poses

    def set_velocities(self, ids: np.ndarray, velocities: np.ndarray) -> None:
        assert velocities.shape == (2, len(ids))
        self.velocities = velocities

    def step(self) -> None:
        print("stepping")
        self.log.append("step")
        self.poses = self.poses + 0.033 * np.vstack((self.velocities[:1], 0 * self.velocities))

    def debug(self) -> None:
        print("Simulation had 1 iteration(s) where robots collided.")


def test_both_dialects_are_spoken(capsys: pytest.CaptureFixture[str]) -> None:
    robots = RpsRobots(np.array([[0.0, 0.5, 0.0], [1.0, 0.5, 0.0]]), Newer)
    robots.drive(np.array([[0.1, 0.0], [0.0, 0.0]]))
    robots.poses()  # asking twice must not look twice
    np.testing.assert_allclose(robots.poses()[:, 0], [0.0033, 1.0])
    report = robots.finish()
    assert not is_accepted(report)
    assert report.splitlines()[:3] == ["Initializing ...", "looking", "stepping"]
    assert capsys.readouterr().out == ""  # as JSON alone is to stand there


def test_the_benchmark_flies_every_setting() -> None:
    rows = list(bench_robotarium(1, "join-all"))
    assert len(rows) == count_missions(1, with_rps=False) == 4
    summaries = summarise(rows)
    assert [s["completed"] for s in summaries] == [1, 1, 1, 1]
    assert summaries[0]["longest, s"] == rows[0]["makespan_seconds"]
    assert rows[0]["makespan_seconds"] == pytest.approx(0.99 * rows[0]["makespan"])
