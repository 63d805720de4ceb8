"""Missions in continuous time to which nothing happens: they run as they were planned."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from clock_missions import draw_mission
from clock_promises import check_promises, path_length
from teamformer.base.errors import MissionError, TeamformerError
from teamformer.files.drawn.named_settings import world_of
from teamformer.files.imports import import_missions
from teamformer.files.mission_files import read_mission
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.mission.model import Mission
from teamformer.planning.continuous.continuous_mission import pose_mission
from teamformer.planning.continuous.rules import plan_continuous
from teamformer.trials.continuous_trial import ending_of
from teamformer.world.continuous.course import Course

BEHAVIOUR = Path(__file__).parents[2] / "behaviour"
OTHERS = Path(os.environ.get("TEAMFORMER_OTHERS", "/nowhere"))
needs_data = pytest.mark.skipif(
    not OTHERS.is_dir(), reason="TEAMFORMER_OTHERS names no folder with other people's instances"
)

NEAR = 1e-12
"""Gaps between starts are added and taken away again, and costs are summed in another order."""


def near(expected: Any) -> Any:
    return pytest.approx(expected, rel=NEAR, abs=NEAR)


def check_run(mission: Mission) -> None:
    """Run a mission by `plan`, and compare starts, ends, arrivals, makespan and cost with it."""
    made = plan_continuous(pose_mission(mission), "plan", 0)
    assert made is not None
    course = Course(mission, mission, SharedPlan())
    course.begin()
    while course.is_running:
        course.go_on()
    world, ending = course.world, ending_of(course)
    stops = {(route.robot, stop.task): stop for route in made.routes for stop in route.stops}
    arrived = {}
    for event in world.events:
        if event.kind == "arrive" and event.task >= 0:
            arrived[event.robots[0], event.task] = event.at
    assert arrived == near({key: stop.arrive for key, stop in stops.items()})
    assert world.started == near({task: stop.start for (_, task), stop in stops.items()})
    ends = {task: world.events[number].at for task, number in world.over.items()}
    assert ends == near({task: stop.end for (_, task), stop in stops.items()})
    assert ending.makespan == near(made.makespan)
    assert ending.late == near({mission.tasks[task].name: by for task, by in made.late.items()})
    assert ending.broken_links == ()
    if made.cost is not None:
        assert ending.cost == near(made.cost)
    check_promises(mission, mission, world.events)
    assert path_length(world.events) == near(made.makespan)


def calm(mission: Mission) -> Mission:
    """Return a mission to which nothing happens and in which all is known."""
    sure = {"appears": 0.0, "cancelled": None, "lasts": None, "may_need": {}, "within": 0.0}
    robots = (replace(it, absences=(), breaks=None, delays=None) for it in mission.robots)
    tasks = (replace(task, **sure) for task in mission.tasks)  # type: ignore[arg-type]
    return replace(mission, robots=tuple(robots), tasks=tuple(tasks), arrivals=None)


@pytest.mark.parametrize("name", ["roads.yaml", "visits.yaml"])
def test_small_missions_run_as_they_are_planned(name: str) -> None:
    check_run(read_mission(BEHAVIOUR / name))


@pytest.mark.parametrize("setting", ["4N20T-C4", "8N20T-C8"])
@pytest.mark.parametrize("forming", [0.0, 2.5])
def test_missions_of_settings_run_as_they_are_planned(setting: str, forming: float) -> None:
    mission = world_of(setting, 3)
    check_run(replace(mission, time="continuous", ends="home", forming=forming, step_limit=0))


@pytest.mark.parametrize("seed", range(40))
def test_drawn_missions_run_as_they_are_planned(seed: int) -> None:
    try:
        check_run(calm(draw_mission(seed)))
    except (MissionError, TeamformerError):  # linked tasks for which there are too few robots
        return


@needs_data
@pytest.mark.slow
@pytest.mark.parametrize(
    ("form", "name"),
    [
        *(("hetero-mrta", f"ral/env_{number}.json") for number in range(20)),
        *(("hetero-mrta", f"heteromrta/MA-AT-50-5-50/env_{number}.json") for number in range(5)),
        *(("hetero-mrta", f"heteromrta/{it}/env_0.json") for it in ("SA-BT-50-5-50",)),
        ("hetero-mrta", "heteromrta/MA-AT-50-5-200/env_0.json"),
        ("hhcrsp", "hhcrsp/instances"),
        ("hhcrsp", "hhcrsp/kummer"),
        ("hhcrsp", "hhcrsp/italian"),
    ],
)
def test_other_peoples_instances_run_as_they_are_planned(form: str, name: str) -> None:
    path = OTHERS / name
    for file in sorted(path.glob("*.json")) if path.is_dir() else [path]:
        for mission in import_missions(form, file):
            check_run(mission)
