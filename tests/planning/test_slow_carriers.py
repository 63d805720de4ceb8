"""Loads go at the pace of those who carry them: who is near may be the wrong one to carry them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from teamformer.methods.by_name import load_method
from teamformer.mission.coordination import Known
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.planning.continuous.continuous_mission import pose_mission
from teamformer.planning.continuous.rules import plan_continuous
from teamformer.planning.continuous.solve import plan_together
from teamformer.planning.problem.coalition_plan import plan_of_lists
from teamformer.planning.problem.constants import TICKS
from teamformer.planning.steps.arc_search import TeamArcs
from teamformer.planning.steps.situation import situation_of
from teamformer.trials.trial import run_trial


def near_and_slow(**rules: object) -> Mission:
    """Return a crate that goes from x = 0 to 11, a slow mover beside it and a fast one at 10.

    The slow one takes 110 for the way; the fast one comes after 10 and takes 11.
    """
    robots = (
        Robot("slow", (0, 0), {"lift": 1}, speed=0.1),
        Robot("fast", (10, 0), {"lift": 1}),
    )
    crate = Task("crate", (0, 0), {"lift": 1}, to=(11, 0))
    return Mission("crate", Grid(12, 1), ("lift",), robots, (crate,), **rules)  # type: ignore[arg-type]


@pytest.mark.parametrize("method", ["plan", "central", "reactive"])
def test_the_one_who_has_it_there_first_carries_a_load(method: str) -> None:
    made = plan_continuous(pose_mission(near_and_slow(time="continuous")), method, 0.3)
    assert made is not None
    assert made.makespan == 21.0
    assert [len(route.stops) for route in made.routes] == [0, 1]


@pytest.mark.parametrize("method", ["plan", "central"])
def test_so_it_is_where_plans_have_a_cost(method: str) -> None:
    mission = near_and_slow(time="continuous", cost={"completion": 1.0})
    made = plan_continuous(pose_mission(mission), method, 0.1)
    assert made is not None
    assert made.cost == 21.0


def test_so_it_is_where_starts_are_linked() -> None:
    """Two crates start at once: the fast ones carry both, and who is near carries none."""
    mission = near_and_slow(time="continuous")
    other = Task("other", (0, 0), {"lift": 1}, to=(11, 0), starts={"crate": (0.0, 0.0)})
    more = Robot("fast too", (10, 0), {"lift": 1})
    mission = replace(mission, robots=(*mission.robots, more), tasks=(*mission.tasks, other))
    made = plan_continuous(pose_mission(mission), "plan", 0.0)
    assert made is not None
    assert made.makespan == 21.0


@pytest.mark.parametrize("method", ["plan", "crews", "central"])
def test_so_it_is_in_steps(method: str) -> None:
    end = run_trial(near_and_slow(), load_method(method, time_limit=0.3), 0).record.end
    assert end.makespan == 21


def test_a_plan_is_over_when_it_says_whoever_carries() -> None:
    """Both lift a crate: it goes as fast as the slower one, in ticks as by the mission's rules."""
    source = near_and_slow(time="continuous")
    both = replace(source, tasks=(replace(source.tasks[0], needs={"lift": 2}),))
    mission = pose_mission(both)
    found = plan_together(mission.problem)
    assert found is not None
    assert found.worth / mission.scale == mission.tell(found).makespan == 10 + 110
    assert mission.tell(found).is_proven is False


@pytest.mark.parametrize("crew", [(0,), (1,), (0, 1)])
def test_arcs_in_steps_have_the_times_of_the_plan(crew: tuple[int, ...]) -> None:
    mission = near_and_slow()
    crate = replace(mission.tasks[0], needs={"lift": len(crew)})
    mission = replace(mission, tasks=(crate,))
    known = Known(
        mission=mission,
        now=0,
        open_tasks=(0,),
        places=((0, 0), (10, 0)),
        teams=mission.starting_teams,
        free_at=(0, 0),
    )
    arcs = TeamArcs(situation_of(known))
    arcs.begin_at(plan_of_lists([0], [crew]))
    ends = arcs.search.graph.nodes.end[:1] // TICKS
    np.testing.assert_array_equal(ends, arcs.best.ends)
