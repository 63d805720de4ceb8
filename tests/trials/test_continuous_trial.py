"""Missions in continuous time by `run` and `compare`, in Python and on the command line."""

from __future__ import annotations

import json
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import pytest

import teamformer as tf
from teamformer.base.errors import TeamformerError
from teamformer.mission.coordination import Known, Plan
from teamformer.mission.model import Absence
from teamformer.mission.parts.capabilities import covers, total
from typed import teamformer

ROADS = Path(__file__).parents[1] / "behaviour" / "roads.yaml"


class InTurn:
    """A coordinator of a user's own, for both kinds of missions: who is free first comes along."""

    def update(self, known: Known, plan: Plan | None) -> Plan:
        """Return the plan."""
        robots, tasks = known.mission.robots, known.mission.tasks
        crews = []
        for task in known.possible_tasks:
            crew: list[int] = []
            for robot in sorted(known.robots, key=lambda robot: known.free_at[robot]):
                if not covers(total(robots[r].can for r in crew), tasks[task].needs):
                    crew.append(robot)
            crews.append(tuple(crew))
        return Plan(known.possible_tasks, tuple(crews))


def with_loss() -> tf.Mission:
    """Return the ward, where a cart is lost from 2.5 to 9.25."""
    mission = tf.load(ROADS)
    lost = replace(mission.robots[0], absences=(Absence(2.5, 9.25),))
    return replace(mission, robots=(lost, *mission.robots[1:]))


def test_a_run_is_as_long_as_its_plan_and_legal() -> None:
    mission = tf.load(ROADS)
    made, trial = tf.plan(mission, method="plan"), tf.run(mission)
    assert made is not None
    assert (trial.completed, trial.makespan) == (True, made.makespan)
    assert trial.row["makespan"] == made.makespan
    assert sum(s.end - s.begin for s in trial.critical_path) == pytest.approx(made.makespan)
    assert trial.check().is_legal


def test_a_lost_robot_is_planned_for_and_told() -> None:
    trial = tf.run(with_loss())
    plans = [event.plan.reasons for event in trial.record.events if event.plan]
    assert trial.completed
    assert plans[:2] == [("start",), ("robot lost",)]
    assert ("robot back",) in plans
    assert trial.check().is_legal


def test_central_is_told_what_appears_and_gives_a_bound() -> None:
    """The scan at 9 away appears at 9: told of it the robot is there, else it sets out then."""
    mission = tf.Mission(
        "late",
        tf.Plane(20.0, 1.0),
        ("a",),
        (tf.Robot("one", (0, 0), {"a": 1}),),
        (tf.Task("late", (9, 0), {"a": 1}, 1.0, appears=9.0),),
        time="continuous",
    )
    told = replace(mission, tasks=(*mission.tasks, tf.Task("here", (0, 0), {"a": 1})))
    rows = {row["method"]: row for row in tf.compare(told, seconds=0.1)}
    assert list(rows) == ["plan", "central"]
    assert rows["central"]["makespan"] == 10
    assert rows["central"]["lower_bound"] == pytest.approx(10, abs=1e-5)  # by what is rounded
    assert rows["plan"]["makespan"] == 19


def test_methods_that_count_in_steps_are_refused_in_a_sentence() -> None:
    mission = tf.load(ROADS)
    for method, told in (
        ("heuristic", "decides step by step, which continuous time does not have"),
        ("crews", "plans in steps, and the mission is in continuous time"),
        ("teamformer-tasks", "plans in steps, and the mission is in continuous time"),
    ):
        with pytest.raises(TeamformerError, match=told):
            tf.run(mission, method)


@pytest.mark.parametrize("method", ["soonest", "reactive"])
def test_rules_without_search_go_on_after_losses(method: str) -> None:
    """What was given out stays until something is news that it did not foresee."""
    trial = tf.run(with_loss(), method)
    assert trial.completed
    assert trial.check().is_legal
    plans = [event.plan for event in trial.record.events if event.plan is not None]
    for before, after in pairwise(plans):
        if after.reasons == ("task done",):
            assert set(after.tasks) <= set(before.tasks)  # robots and ends alike
    assert any("robot lost" in plan.reasons for plan in plans)


@pytest.mark.parametrize("time", ["steps", "continuous"])
def test_a_coordinator_of_a_users_own_plans_both_kinds(time: str) -> None:
    mission = tf.load("examples/four-robots.yaml")
    trial = tf.run(replace(mission, time=time, step_limit=0), InTurn())
    assert trial.completed
    assert trial.check().is_legal


def test_the_command_line_tells_times_in_the_missions_unit(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "ward.yaml"
    tf.save(with_loss(), path)
    assert teamformer("run", str(path), "--out", str(tmp_path / "out")) == 0
    said = capsys.readouterr().out
    assert "steps" not in said
    assert "lost: cart-1 at 2.5 (back at 9.25)" in said
    assert "why so late: " in said
    assert teamformer("check", str(tmp_path / "out" / "record.json")) == 0
    capsys.readouterr()
    assert teamformer("compare", str(path), "--time-limit", "0.1", "--json") == 0
    rows = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [row["method"] for row in rows] == ["plan", "central"]
    assert all(row["broken_links"] == [] for row in rows)
