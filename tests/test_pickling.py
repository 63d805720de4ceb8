"""Errors and all that `import teamformer` offers go from one process to another."""

from __future__ import annotations

import ast
import pickle
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import pytest

import teamformer as tf
from small_worlds import make, robot, task
from teamformer.base.errors import (
    MissionError,
    Problem,
    ReaderGoneError,
    RecordError,
    TeamformerError,
    UndoableError,
)
from teamformer.base.worker_processes import WorkerDiedError, work_in_processes
from teamformer.bench.peers.peer_plan import OutOfReachError
from teamformer.files.yaml.reader import StopReadingError
from teamformer.live.running.messages import TaskRefusedError
from teamformer.methods.by_name import load_method
from teamformer.methods.listings import method_names
from teamformer.methods.seam.protocol import Policy
from teamformer.mission.coordination import Coordinator
from teamformer.record.event_rules.names import BrokenRuleError
from teamformer.record.files.values import DamageError

Kind = TypeVar("Kind")

ERRORS: list[Exception] = [
    TeamformerError("it is wrong", "mend it"),
    MissionError([Problem(("name",), "no name"), Problem(("world",), "no world")], ["f:1: no"]),
    UndoableError("nobody can", "add robots"),
    RecordError("it is no record", "name one"),
    ReaderGoneError(),
    DamageError("damaged"),
    StopReadingError(),
    WorkerDiedError("it died", "again"),
    TaskRefusedError("it is wrong", ("at", "needs")),
    OutOfReachError("too far"),
    BrokenRuleError("it is served elsewhere"),
]


def sent(thing: Kind) -> Kind:
    """Return what another process gets."""
    return pickle.loads(pickle.dumps(thing))  # type: ignore[no-any-return]


@pytest.mark.parametrize("error", ERRORS, ids=lambda error: type(error).__name__)
def test_an_error_says_the_same_in_another_process(error: Exception) -> None:
    got = sent(error)
    assert type(got) is type(error)
    assert (str(got), got.args, vars(got)) == (str(error), error.args, vars(error))


def test_there_is_an_example_of_each_error() -> None:
    found = {
        node.name
        for file in Path(tf.__path__[0]).rglob("*.py")
        for node in ast.walk(ast.parse(file.read_text()))
        if isinstance(node, ast.ClassDef) and node.name.endswith("Error")
    }
    assert {type(error).__name__ for error in ERRORS} == found


def load_what_is_no_mission(name: str) -> Any:
    return tf.load(name)


def test_a_bad_mission_file_is_told_by_who_asked_a_process_to_load_it(tmp_path: Path) -> None:
    file = tmp_path / "bad.yaml"
    file.write_text("teamformer: 1\nnmae: x\n")
    with pytest.raises(MissionError, match=r"bad\.yaml:2: the file has no key 'nmae'") as told:
        list(work_in_processes(load_what_is_no_mission, [str(file)], 1))
    assert ("nmae",) in [problem.where for problem in told.value.problems]


MISSION = replace(
    make([robot("a", 0), robot("b", 5)], [task("ab", 9), task("a", 3, duration=2)]), name="sent"
)


def _trial() -> tf.Trial:
    return tf.run(MISSION, method="join-all")


def _experience() -> tf.Experience:
    unsure = replace(MISSION, tasks=(replace(MISSION.tasks[0], lasts=(1, 3)), MISSION.tasks[1]))
    return tf.learn(unsure, [tf.run(unsure, method="join-all").record])


EQUAL: dict[str, Callable[[], object]] = {
    "Advice": lambda: tf.advise(MISSION, seconds=0.1),
    "Experience": _experience,
    "Grid": lambda: MISSION.world,
    "Known": lambda: tf.TeamFormation([MISSION]).known(),
    "Mission": lambda: MISSION,
    "Page": lambda: _trial().show(),
    "Plan": lambda: tf.Plan((1, 0), ((0,), (0, 1))),
    "Plane": lambda: tf.Plane(3.0, 4.0),
    "Roads": lambda: tf.Roads(("p", "q"), {"ground": ((0.0, 1.0), (2.0, 0.0))}),
    "Robot": lambda: MISSION.robots[0],
    "Task": lambda: MISSION.tasks[0],
    "TeamformerError": lambda: None,  # above
    "Trial": _trial,
}
OTHERWISE = {"Decision", "Method", "TeamFormation", "TeamFormationParallel", "View"}
"""Public types that are not equal by their values; each has a test of its own here."""


@pytest.mark.parametrize("name", EQUAL)
def test_public_types_arrive_as_they_are(name: str) -> None:
    thing = EQUAL[name]()
    assert sent(thing) == thing
    assert repr(sent(thing)) == repr(thing)


def test_no_public_type_is_left_out() -> None:
    classes = {name for name in tf.__all__ if isinstance(getattr(tf, name), type)}
    seams = {Coordinator.__name__, Policy.__name__}
    assert classes - seams == {*EQUAL, *OTHERWISE}


@pytest.mark.parametrize("name", [name for name in method_names() if "-ppo" not in name])
def test_a_method_decides_alike_in_another_process(name: str) -> None:
    method = load_method(name, time_limit=0.05)
    theirs = sent(method)
    assert theirs.name == name
    ours = tf.run(MISSION, method)
    assert tf.run(MISSION, theirs).record.steps == ours.record.steps


@pytest.mark.parametrize("threads", [1, 2])
def test_an_environment_goes_on_from_where_it_was(threads: int) -> None:
    with tf.TeamFormation([MISSION, MISSION], threads=threads) as env:
        for _ in range(3):
            view = env.view()
            env.step(tf.Decision(view.counts))
        twin = sent(env)
        for _ in range(5):
            ours, theirs = env.view(), twin.view()
            for mine, other in zip(ours, sent(theirs), strict=True):
                np.testing.assert_array_equal(mine, other)
            decision = tf.Decision(ours.counts)
            env.step(decision)
            twin.step(sent(decision))
        np.testing.assert_array_equal(env.rewards, twin.rewards)
        twin.reset()
        assert twin.tally().steps == 0
        assert env.tally().steps == 8


def test_a_coordinated_environment_keeps_its_plans() -> None:
    coordinator = load_method("plan").coordinator
    env = tf.TeamFormation([MISSION], coordinator=coordinator)
    env.step(env.planned_decision(env.view()))
    twin = sent(env)
    assert twin.plans() == env.plans() != ()
    while env.is_running.any():
        for it in (env, twin):
            it.step(it.planned_decision(it.view()))
    assert twin.tally() == env.tally()
    assert env.tally().status == "completed"


def test_an_environment_of_agents_goes_on() -> None:
    env = tf.TeamFormationParallel(MISSION)
    env.reset(seed=0)
    twin = sent(env)
    actions = {agent: np.array([1, 1, 0]) for agent in env.agents}
    ours, theirs = env.step(actions), twin.step(actions)
    assert set(ours[0]) == set(env.agents)
    assert ours[1:4] == theirs[1:4]
