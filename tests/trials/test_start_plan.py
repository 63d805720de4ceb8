"""Searches that begin with a plan from a file."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from teamformer.base.errors import TeamformerError
from teamformer.files.drawn.named_settings import world_of
from teamformer.files.mission_files import read_mission, write_mission
from teamformer.mission.coordination import Plan
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.planning.continuous.continuous_mission import pose_mission
from teamformer.planning.continuous.solve import plan_together, solve
from teamformer.planning.problem.coalition_problem import CoalitionProblem
from teamformer.record.referee import judge
from teamformer.trials.planned import plan_mission
from teamformer.trials.start_plan import read_start_plan
from typed import teamformer

WAREHOUSE = Path(__file__).parents[2] / "examples" / "warehouse.yaml"
OF_WAREHOUSE = Path(__file__).parent / "warehouse-plan.json"
"""A plan that `central` found in two seconds: the mission is over after 50 steps."""

MISSION = Mission(
    "three",
    Grid(9, 1),
    ("a", "b"),
    (Robot("r", (0, 0), {"a": 1}), Robot("s", (4, 0), {"a": 1}), Robot("t", (8, 0), {"b": 1})),
    (
        Task("second", (2, 0), {"a": 1}, after=("first",)),
        Task("first", (2, 0), {"a": 1}),
        Task("pair", (6, 0), {"a": 1, "b": 1}),
    ),
)


def written(folder: Path, *routes: tuple[str, list[tuple[str, float]]]) -> Path:
    """Write a plan of robots with the starts of their tasks; return its file."""
    rows = [
        {"robot": robot, "stops": [{"task": task, "start": start} for task, start in stops]}
        for robot, stops in routes
    ]
    path = folder / "plan.json"
    path.write_text(json.dumps({"routes": rows}))
    return path


def test_a_plan_is_read_in_order_of_time(tmp_path: Path) -> None:
    """`second` comes after `first`, which starts at the same moment."""
    path = written(
        tmp_path,
        ("r", [("second", 2), ("first", 2)]),
        ("s", [("pair", 3)]),
        ("t", [("pair", 3)]),
    )
    assert read_start_plan(path, MISSION) == Plan((1, 0, 2), ((0,), (0,), (1, 2)))


def test_what_a_plan_leaves_out_comes_last(tmp_path: Path) -> None:
    """By robots of which none can be spared: the last ones that are not needed stay out."""
    path = written(tmp_path, ("s", [("first", 2), ("second", 3)]))
    assert read_start_plan(path, MISSION) == Plan((1, 0, 2), ((1,), (1,), (0, 2)))


LINKED = Mission(
    "linked",
    Grid(9, 1),
    ("a",),
    tuple(Robot(name, (0, 0), {"a": 1}) for name in "rst"),
    (
        Task("one", (2, 0), {"a": 1}),
        Task("two", (2, 0), {"a": 1}, starts={"one": (0, 9)}),
        Task("free", (2, 0), {"a": 1}),
    ),
    time="continuous",
)


def test_what_starts_at_one_moment_is_in_the_order_of_the_routes(tmp_path: Path) -> None:
    """`free` takes no time: were it behind `one`, it would be done later."""
    path = written(tmp_path, ("r", [("free", 2), ("one", 2)]), ("s", [("two", 2)]))
    assert read_start_plan(path, LINKED) == Plan((1, 2, 0), ((1,), (0,), (0,)))
    contradicted = ("t", [("one", 2), ("free", 2)])
    path = written(tmp_path, ("r", [("free", 2), ("one", 2)]), ("s", [("two", 2)]), contradicted)
    assert read_start_plan(path, LINKED).order == (0, 1, 2)


def test_a_linked_task_that_a_plan_leaves_out_is_given_to_another_robot(tmp_path: Path) -> None:
    path = written(tmp_path, ("r", [("one", 2), ("free", 2)]))
    assert read_start_plan(path, LINKED) == Plan((0, 2, 1), ((0,), (0,), (1,)))


@pytest.mark.parametrize(
    ("routes", "told"),
    [
        ([("r", [("one", 2), ("two", 3)])], "the plan gives 'one' and 'two' to r"),
        ([(name, [("one", 2)]) for name in "rst"], "leaves out task 'two', whose start is"),
    ],
)
def test_linked_tasks_are_not_given_to_one_robot(
    routes: list[tuple[str, list[tuple[str, float]]]], told: str, tmp_path: Path
) -> None:
    with pytest.raises(TeamformerError, match=told) as caught:
        read_start_plan(written(tmp_path, *routes), LINKED)
    assert caught.value.hint


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("routes: []", "this is no plan"),
        ('{"routes": [{"robot": "r"}]}', "this is no plan"),
        ('{"routes": [{"robot": "x", "stops": [{"task": "first", "start": 0}]}]}', "robot 'x'"),
        ('{"routes": [{"robot": "r", "stops": [{"task": "x", "start": 0}]}]}', "task 'x'"),
        (
            '{"routes": [{"robot": "r", "stops": [{"task": "pair", "start": 0}]}]}',
            "the plan gives task 'pair' to r, who cannot do it",
        ),
    ],
)
def test_a_file_that_is_no_plan_of_the_mission_is_refused(
    text: str, told: str, tmp_path: Path
) -> None:
    path = tmp_path / "plan.json"
    path.write_text(text)
    with pytest.raises(TeamformerError, match=told) as caught:
        read_start_plan(path, MISSION)
    assert str(caught.value).startswith(f"{path}: ")
    assert caught.value.hint


def test_in_steps_the_plan_is_played_and_kept_if_it_is_the_best() -> None:
    """Without any time to search, the first plan takes 52 steps."""
    mission = without_loads()
    first = plan_mission(mission, "central", 0.0)
    start = read_start_plan(OF_WAREHOUSE, mission)
    begun = plan_mission(mission, "central", 0.0, start)
    assert first is not None
    assert begun is not None
    assert (first.makespan, begun.makespan) == (52, 50)


@pytest.mark.thorough
def test_in_continuous_time_a_better_plan_is_begun_with() -> None:
    """The shared plans of other seeds differ: the best one is handed in, and is not lost."""
    problem = pose_mission(_continuous(world_of("real", 5))).problem
    assert isinstance(problem, CoalitionProblem)
    own, *others = [plan_together(problem, seed) for seed in range(6)]
    best = min((it for it in others if it is not None), key=lambda it: it.rank[0])
    kept = solve(problem, 0.0, start=best.plan)
    assert own is not None
    assert kept is not None
    assert kept.rank[0] == best.rank[0] < own.rank[0]


def test_what_was_planned_may_be_read_back(tmp_path: Path) -> None:
    """A plan with a cost: no plan found without any time is better than the one of a second."""
    mission = _continuous(world_of("deadlines", 5))
    made = plan_mission(mission, "central", 1.0)
    assert made is not None
    path = tmp_path / "plan.json"
    path.write_text(json.dumps(made.row))
    again = plan_mission(mission, "central", 0.0, read_start_plan(path, mission))
    assert again is not None
    assert again.cost is not None
    assert made.cost is not None
    assert again.cost <= made.cost + 1e-6


def without_loads() -> Mission:
    """Return the warehouse with pallets that stay in their places."""
    warehouse = read_mission(WAREHOUSE)
    return replace(warehouse, tasks=tuple(replace(task, to=None) for task in warehouse.tasks))


def test_only_central_begins_with_a_plan(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_mission(without_loads(), tmp_path / "warehouse.yaml")
    words = ("--from", str(OF_WAREHOUSE), "--json", "--time-limit", "0")
    assert teamformer("plan", str(tmp_path / "warehouse.yaml"), *words) == 0
    assert json.loads(capsys.readouterr().out)["makespan"] == 50
    mission = _continuous(world_of("real", 3))
    with pytest.raises(TeamformerError, match="method 'plan' cannot begin with a plan"):
        plan_mission(mission, "plan", 0.0, Plan())


def _continuous(mission: Mission) -> Mission:
    return replace(mission, time="continuous")


def test_a_plan_counts_with_tasks_that_appear_later() -> None:
    """Robot r is at `late` after 6, when it appears; its record is of a plan made in advance."""
    late = Task("late", (6, 0), {"a": 1}, appears=6, duration=2)
    mission = Mission(
        "late", Grid(9, 1), ("a",), (Robot("r", (0, 0), {"a": 1}),), (late,), time="continuous"
    )
    made = plan_mission(mission, "plan", 0.0)
    assert made is not None
    assert made.makespan == 8
    assert judge(made.record).findings == ()
