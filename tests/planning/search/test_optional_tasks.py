"""Plans that leave tasks out: against every plan of small missions, and as they are timed anew."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from every_optional_plan import best_plan, draw_mission
from teamformer.mission.model import Mission
from teamformer.planning.continuous.continuous_mission import pose_mission
from teamformer.planning.continuous.rules import plan_continuous
from teamformer.planning.problem.routes import MissionPlan
from teamformer.planning.problem.schedule import COST, MAKESPAN, MISSED, schedule_of
from teamformer.planning.search.arc_search import ArcSearch

COST_OF_MISSING = {"makespan": 1.0, "missed": 20.0}


def planned(mission: Mission) -> MissionPlan:
    made = plan_continuous(pose_mission(mission), "plan", 0)
    assert made is not None
    return made


def missed_by(mission: Mission, made: MissionPlan) -> float:
    return sum(mission.tasks[task].weight for task in made.missed)


@pytest.mark.parametrize("seed", range(10))
def test_as_little_is_missed_as_can_be_and_then_all_is_over_soonest(seed: int) -> None:
    mission = draw_mission(seed, tasks=5, share=0.2)
    made, (missed, makespan) = planned(mission), best_plan(mission)
    assert (missed_by(mission, made), made.makespan) == pytest.approx((missed, makespan))
    assert max(stop.end for route in made.routes for stop in route.stops) <= mission.until


@pytest.mark.parametrize("seed", range(10))
def test_with_a_cost_what_is_missed_is_weighed_against_the_rest(seed: int) -> None:
    mission = draw_mission(seed, tasks=5, share=0.2, cost=COST_OF_MISSING)
    made, (cost, _) = planned(mission), best_plan(mission)
    assert made.cost == pytest.approx(cost)


@pytest.mark.parametrize("seed", range(3))
def test_what_comes_after_a_task_that_is_left_out_is_left_out(seed: int) -> None:
    mission = draw_mission(seed, tasks=5, share=0.15)
    tasks = list(mission.tasks)
    for task in (2, 4):
        tasks[task] = replace(tasks[task], after=(tasks[task - 1].name,))
    chained = replace(mission, tasks=tuple(tasks))
    made, (missed, makespan) = planned(chained), best_plan(chained)
    assert (missed_by(chained, made), made.makespan) == pytest.approx((missed, makespan))


def test_a_search_counts_what_its_plan_comes_to_when_timed_anew() -> None:
    """The ledger of changes, and the plain schedule of the plan that they have led to."""
    problem = pose_mission(draw_mission(3, tasks=14, share=0.12)).problem
    search = ArcSearch(problem, 1)
    assert search.begin_anew()
    for heat in (3000, 300, 0):
        search.anneal(heat, heat, 0, 4000, 4000)
        total = schedule_of(problem, search.best).total
        assert search.rank == (total[MAKESPAN] + total[MISSED], total[COST])


def test_linked_tasks_are_left_out_together() -> None:
    mission = draw_mission(5, tasks=8, share=0.05)
    tasks = list(mission.tasks)
    tasks[2] = replace(tasks[2], needs={"a": 1}, starts={"t1": (0.0, 8.0)})
    tasks[1] = replace(tasks[1], needs={"b": 1})
    made = planned(replace(mission, tasks=tuple(tasks)))
    assert {1, 2} <= set(made.missed) or not {1, 2} & set(made.missed)


def test_a_mission_that_must_be_done_is_not_left_out_for_a_worthier_one() -> None:
    """Both lie on opposite sides, and there is time for one of them."""
    mission = draw_mission(0, tasks=2, share=0.0)
    robot = replace(mission.robots[0], at=(50.0, 50.0), can={"a": 1})
    must = replace(mission.tasks[0], at=(90.0, 50.0), needs={"a": 1}, duration=5.0)
    may = replace(must, name="may", at=(10.0, 50.0), optional=True, weight=1e6)
    small = replace(mission, robots=(robot,), tasks=(must, may), until=60.0, ends=None)
    assert planned(small).missed == (1,)
    assert planned(replace(small, until=130.0)).missed == ()
    assert np.isclose(planned(replace(small, until=130.0)).makespan, 130.0)
