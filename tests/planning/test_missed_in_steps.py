"""Plans in steps that leave optional tasks out, and what rules without search do about ends."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import yaml

from teamformer.files.drawn.generate import Spec, generate
from teamformer.files.mission_files import mission_from_tree
from teamformer.methods.by_name import load_method
from teamformer.methods.central.policy import Central
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.mission.coordination import known_at_start
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.mission.parts.plane import Plane
from teamformer.planning.steps.shared_plan import plan_mission
from teamformer.record.record import Record
from teamformer.record.referee.judge import judge
from teamformer.record.task_times import missed_tasks, missed_weight
from teamformer.trials.trial import run_trial

A = {"a": 1}


def corridor(*tasks: Task, until: float = 10, **changes: object) -> Mission:
    """Return a robot at 10 of a corridor of 31 cells."""
    robots = (Robot("r", (10, 0), A),)
    return replace(Mission("corridor", Grid(31, 1), ("a",), robots, tasks, until=until), **changes)


def played(mission: Mission, name: str = "plan") -> Record:
    record = run_trial(mission, load_method(name)).record
    assert judge(record).findings == ()
    return record


def test_a_plan_leaves_out_what_weighs_less() -> None:
    """The robot can go left or right in ten steps, not both ways."""
    for weight, left_out in ((3.0, "right"), (0.5, "left")):
        left = Task("left", (2, 0), A, optional=True, weight=weight)
        right = Task("right", (18, 0), A, optional=True)
        record = played(corridor(left, right))
        assert (record.end.missed, record.end.makespan) == ((left_out,), 8)


def test_a_cost_says_what_is_worth_its_way() -> None:
    """Seven steps more for a task of weight 1, and then of 2, at 5 each."""
    for weight, makespan in ((1.0, 2), (2.0, 9)):
        near, far = Task("near", (12, 0), A), Task("far", (19, 0), A, optional=True, weight=weight)
        cost = {"makespan": 1.0, "missed": 5.0}
        record = played(corridor(near, far, until=20, cost=cost))
        assert record.end.makespan == makespan


@pytest.mark.parametrize("name", ["plan", "soonest", "reactive", "crews", "teamformer-tasks"])
def test_what_must_be_done_comes_before_what_is_nearer(name: str) -> None:
    """Whoever first does the near task, for five steps, is too late for the other one."""
    near = Task("near", (9, 0), A, 5, optional=True)
    record = played(corridor(near, Task("must", (18, 0), A)), name)
    assert (record.end.status, record.end.missed) == ("completed", ("near",))


@pytest.mark.parametrize("name", ["soonest", "reactive"])
def test_that_is_so_in_continuous_time_too(name: str) -> None:
    near = Task("near", (9, 0), A, 5, optional=True)
    tasks = (near, Task("must", (18, 0), A))
    robots, world = (Robot("r", (10, 0), A),), Plane(31.0, 1.0)
    record = played(Mission("it", world, ("a",), robots, tasks, time="continuous", until=10), name)
    assert (record.end.status, record.end.missed) == ("completed", ("near",))


def half_as_long(number: int) -> Mission:
    """Return a drawn mission of which seven tasks in ten may be left out, over in half the time."""
    rng = np.random.default_rng(number)
    mission = generate(Spec(robots=6, tasks=10, capabilities=4), rng)
    until = int(plan_mission(known_at_start(mission)).makespan * 0.55)
    tasks = tuple(
        replace(task, optional=rng.random() < 0.7, weight=float(rng.integers(1, 5)))
        for task in mission.tasks
    )
    return replace(mission, tasks=tasks, until=until)


@pytest.mark.parametrize("number", [0, 1, 2, 4])
def test_what_is_planned_is_what_happens(number: int) -> None:
    mission = half_as_long(number)
    made, record = plan_mission(known_at_start(mission)), played(mission)
    assert (record.end.status, record.end.makespan) == ("completed", made.makespan)
    left_out = set(range(len(mission.tasks))) - set(made.order)
    assert missed_tasks(record).keys() == left_out
    assert made.makespan <= mission.until


def test_central_misses_no_more_than_the_plan_and_proves_nothing() -> None:
    mission = half_as_long(1)
    record = run_trial(mission, Central(1.0)).record
    assert judge(record).findings == ()
    assert missed_weight(record) <= missed_weight(run_trial(mission, SharedPlan()).record)
    assert (record.lower_bound or 0) <= record.end.steps


CHAIN = """\
teamformer: 1
name: a chain
world: {plane: [2.08, 2.27], step: 0.2, arrival_radius: 0.05, unit: 0.2}
capabilities: [c0]
robots:
  - {name: r0, at: [1.52, 1.67], can: [c0]}
  - {name: r1, at: [1.809, 0.361], can: [c0], speed: 0.3}
  - {name: r2, at: [1.132, 0.0], can: [c0], lost: 26, back: 37}
  - {name: r3, at: [0.303, 0.217], can: [c0], speed: 0.3}
  - {name: r4, at: [1.809, 0.361], can: [c0], lost: 22}
  - {name: r5, at: [1.809, 0.361], can: [c0]}
tasks:
  - {name: t2, at: [1.056, 0.937],
     needs: [c0], duration: 4, after: [t1], weight: 0.5, optional: true}
  - {name: t3, at: [0.303, 0.217], needs: [c0], duration: 1, after: [t0, t2], optional: true}
  - {name: t1, at: [0.3, 0.2],
     needs: [c0], duration: 4, after: [t0], between: [7, 26], weight: 2.0, optional: true}
  - {name: t4, at: [1.056, 0.937],
     needs: [c0], duration: 6, after: [t0, t1, t2], between: [5, 34], weight: 2.0, optional: true}
  - {name: t0, at: [0.035, 2.27],
     needs: [c0], duration: 6, between: [16, 26], weight: 0.5, optional: true}
  - {name: t6, at: [2.08, 0.276], needs: {c0: 2}, after: [t5], optional: true}
  - {name: t5, at: [1.76, 0.384], needs: [c0], after: [t1, t3], weight: 0.5, optional: true}
forming_steps: 0
until: 30
zones: {dock: {tasks: [t2, t3, t1, t4, t6]}}
"""
"""Once a robot is lost, there is no time left for most of what comes one after the other."""


def test_a_search_comes_to_its_end_whatever_is_left_out_of_a_chain() -> None:
    """Tasks come after others that are left out, and robots go from one to another all the same."""
    record = run_trial(mission_from_tree(yaml.safe_load(CHAIN)), SharedPlan(), 50117).record
    assert judge(record).findings == ()
    assert record.end.status == "completed"
    assert "t0" not in record.end.missed
