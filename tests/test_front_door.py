"""What `import teamformer` offers: each example of a docstring runs, and importing is quick."""

from __future__ import annotations

import doctest
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import teamformer
import teamformer as tf
from teamformer.methods.scripted.joining import JoinAll
from teamformer.trials import planned
from teamformer.trials.api import advice, missions, trials
from teamformer.viewer import notebook_page

ROOT = Path(__file__).parents[1]


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    monkeypatch.chdir(tmp_path)


MODULES = [teamformer, missions, trials, advice, planned, notebook_page]


@pytest.mark.parametrize("module", MODULES, ids=lambda m: m.__name__)
@pytest.mark.thorough
def test_examples_of_docstrings_run(module: object) -> None:
    result = doctest.testmod(module, extraglobs={"tf": tf})  # type: ignore[arg-type]
    assert result.attempted > 1
    assert result.failed == 0


def test_every_name_is_there_and_says_what_it_is() -> None:
    assert 20 <= len(tf.__all__) <= 30
    for name in tf.__all__:
        assert getattr(tf, name).__doc__, name
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        tf.nothing  # noqa: B018


def test_names_are_listed_and_nothing_else() -> None:
    """Not the rooms that were loaded, nor what the module itself imports."""
    assert tf.run.__doc__  # which loads rooms
    assert dir(tf) == sorted([*tf.__all__, "__version__"])


def test_importing_it_loads_nothing_heavy() -> None:
    code = (
        "import sys; before = set(sys.modules); import teamformer\n"
        "print(*sorted(name for name in set(sys.modules) - before if 'teamformer' not in name))"
    )
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    heavy = {"numpy", "numba", "ortools", "torch", "onnxruntime", "yaml", "rich", "typer"}
    assert {name.split(".")[0] for name in said.stdout.split()} & heavy == set()


def test_a_trial_is_saved_shown_and_checked(tmp_path: Path) -> None:
    trial = tf.run(tf.load("examples/warehouse.yaml"), method="plan", seed=0)
    folder = trial.save(tmp_path / "new" / "out")
    assert {path.name for path in folder.iterdir()} == {"record.json", "record.html"}
    assert tf.check(folder / "record.json") == trial.check()
    assert trial.row["makespan"] == trial.makespan == trial.record.end.makespan
    assert repr(trial) == "<warehouse morning by plan: completed after 56 steps>"
    frame = trial.show(height=400)._repr_html_()
    assert frame.startswith('<iframe height="400"')
    assert "<script" not in frame  # all of the page is inside the frame's attribute


def test_numbers_of_numpy_are_saved(tmp_path: Path) -> None:
    mission = tf.generate(robots=2, tasks=2)
    robots = (replace(it, at=(np.int64(it.at[0]), np.int32(it.at[1]))) for it in mission.robots)
    numpys = replace(mission, robots=tuple(robots))
    for name in ("mission.yaml", "mission.json"):
        tf.save(numpys, tmp_path / name)
        assert tf.load(tmp_path / name) == mission
    tf.run(numpys, method="join-all").save(tmp_path / "out")
    assert tf.check(tmp_path / "out" / "record.json").is_legal


def test_a_plan_is_shown_and_explained() -> None:
    made = tf.plan(tf.load("examples/four-robots.yaml"), seconds=1)
    assert made is not None
    assert made.why_so_late[0].startswith(f"why so late: {made.makespan:g} steps are ")
    assert made.row["critical_path"][-1]["to"] == made.makespan == made.row["makespan"]
    page = made.show(height=400)
    assert f'"makespan":{made.makespan},' in page.text
    assert page._repr_html_().startswith('<iframe height="400"')


def test_policies_and_coordinators_play_as_names_do() -> None:
    class Alone:
        """Gives each task to all robots, in the order of the file."""

        def update(self, known: tf.Known, plan: tf.Plan | None) -> tf.Plan:
            tasks = known.possible_tasks
            return tf.Plan(tasks, tuple(known.robots for _ in tasks))

    mission = tf.setting("4N4T-C4", seed=1)
    assert tf.run(mission, JoinAll()).makespan == tf.run(mission, "join-all").makespan
    assert tf.run(mission, Alone()).completed
    rows = tf.compare(mission, [Alone(), "plan"], seeds=2)
    assert [(row["method"], row["seed"]) for row in rows] == [
        *(("Alone", 0), ("Alone", 1)),
        *(("plan", 0), ("plan", 1)),
    ]


def test_mistakes_are_told() -> None:
    mission = tf.setting("4N4T-C4")
    with pytest.raises(tf.TeamformerError, match="generate knows no 'tsks'"):
        tf.generate(tsks=3)
    with pytest.raises(tf.TeamformerError, match="method 'best' makes no plans"):
        tf.plan(mission, method="best")
    with pytest.raises(tf.TeamformerError, match="there is no method 'quantum'") as caught:
        tf.run(mission, "quantum")
    assert caught.value.__notes__ == [f"hint: {caught.value.hint}"]  # Python prints it below
    with pytest.raises(tf.TeamformerError, match="'plan' is named twice"):
        tf.compare(mission, ["plan", "plan"])
    with pytest.raises(tf.TeamformerError, match="no method is named"):
        tf.compare(mission, [])
    with pytest.raises(tf.TeamformerError, match="methods is a text"):
        tf.compare(mission, "plan")
    with pytest.raises(tf.TeamformerError, match="seeds is 0"):
        tf.compare(mission, ["plan"], seeds=0)
    with pytest.raises(tf.TeamformerError, match=r"robots is 1\.5; use a whole number, 1 or more"):
        tf.generate(robots=1.5)
    with pytest.raises(tf.TeamformerError, match=r"world is \(3, 3\)"):
        tf.generate(world=(3, 3))
    with pytest.raises(tf.TeamformerError, match="save takes a mission, not NoneType"):
        tf.save(None, "mission.yaml")  # type: ignore[arg-type]


@pytest.mark.parametrize("seed", [-1, 1.5, "1", None, True])
def test_a_seed_is_a_whole_number(seed: Any) -> None:
    with pytest.raises(tf.TeamformerError, match="seed is ") as caught:
        tf.run(tf.setting("4N4T-C4"), "heuristic", seed=seed)
    assert caught.value.hint == "write a whole number from 0 on"
    with pytest.raises(tf.TeamformerError, match="seed is "):
        tf.setting("4N4T-C4", seed=seed)
    with pytest.raises(tf.TeamformerError, match="seed is "):
        tf.generate(seed=seed)


def test_numbers_of_numpy_are_numbers(tmp_path: Path) -> None:
    mission = tf.generate(seed=np.int64(3), robots=np.int64(3))
    assert mission == tf.generate(seed=3, robots=3)
    trial = tf.run(mission, "heuristic", seed=np.int64(3))
    assert tf.check(trial.save(tmp_path) / "record.json") == tf.check(trial)


def test_learning_takes_records() -> None:
    mission = tf.setting("4N4T-C4-durations")
    trial = tf.run(mission, "heuristic")
    with pytest.raises(tf.TeamformerError, match="learn takes records, not Trial"):
        tf.learn(mission, [trial])  # type: ignore[list-item]
    assert tf.learn(mission, trial.record) == tf.learn(mission, [trial.record])


def test_a_folder_that_is_a_file_is_told(tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text("a mission")
    with pytest.raises(tf.TeamformerError, match="cannot be written: File exists"):
        tf.run(tf.setting("4N4T-C4"), "heuristic").save(tmp_path / "mine.yaml")
    assert (tmp_path / "mine.yaml").read_text() == "a mission"
