"""From situations to plans: what operators added, robots that are gone, places that cannot be."""

from __future__ import annotations

import pytest

from fleets import PLANNER, pair, trio
from teamformer.files.drawn.named_settings import world_of
from teamformer.fleet.agent.planning import first_plan
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import TaskFact
from teamformer.fleet.planner import CoordinatedPlanner, FleetSituation
from teamformer.fleet.rehearsal.faults import Faults
from teamformer.fleet.rehearsal.rehearse import play
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.mission.coordination import Known, Plan
from teamformer.trials.trial import run_trials

FIRST_ADDED = 1 << 24


def added(number: int, x: float, needs: tuple[int, ...]) -> TaskFact:
    return TaskFact(FIRST_ADDED + number, f"more {number}", x, 0.0, needs)


def test_operators_tasks_are_planned_with_those_of_the_mission() -> None:
    """`c` is gone; `a` is at 0 and `b` at 14, beside what needs b, and both go to `ab` at 12."""
    mission = trio()
    more = (added(7, 1.0, (1, 0, 0)), added(3, 15.0, (0, 1, 0)))
    situation = FleetSituation({0: (0.0, 0.0), 1: (14.0, 0.0)}, (mission.tasks[4], *more))
    stops = CoordinatedPlanner().plan(mission, situation)
    assert dict(stops) == {4: (0, 1), FIRST_ADDED + 7: (0,), FIRST_ADDED + 3: (1,)}
    assert [key for key, _ in stops][-1] == 4


def test_one_planner_keeps_missions_apart() -> None:
    for mission in (pair(), trio(), pair()):
        needs = tuple(int(sum(has) > 0) for has in zip(*mission.counts, strict=True))
        task = added(0, 3.0, needs)  # for all robots together
        places = dict(enumerate(robot.at for robot in mission.source.robots))
        alone = dict(PLANNER.plan(mission, FleetSituation(places, mission.tasks)))
        with_it = dict(PLANNER.plan(mission, FleetSituation(places, (*mission.tasks, task))))
        assert alone.keys() == {task.key for task in mission.tasks}
        assert with_it.keys() == alone.keys() | {FIRST_ADDED}
        assert with_it[FIRST_ADDED] == tuple(range(mission.robots))


def test_old_plans_are_kept_where_little_would_be_gained() -> None:
    mission = pair()
    places = {0: (0.0, 0.0), 1: (4.0, 0.0)}
    old = ((99, (0, 1)), (0, (1, 0)))  # of a task that is done, too
    stops = PLANNER.plan(mission, FleetSituation(places, mission.tasks, {}, old))
    assert list(stops) == [(0, (0, 1))]


class InPassing:
    """Plans task 0 on the way to 1, and lists it behind that; says nothing of 2 and 4."""

    def update(self, known: Known, plan: Plan | None) -> Plan:
        return Plan((1, 3, 0), ((1, 2), (2,), (0, 1)), (7, 9, 2))


def test_stops_come_in_the_order_in_which_they_are_planned_to_be_done() -> None:
    """What nobody has planned comes last, and all do it."""
    mission = trio()
    places = dict(enumerate(robot.at for robot in mission.source.robots))
    stops = CoordinatedPlanner(InPassing()).plan(mission, FleetSituation(places, mission.tasks))
    assert stops[:3] == [(0, (0, 1)), (1, (1, 2)), (3, (2,))]
    assert stops[3:] == [(2, (0, 1, 2)), (4, (0, 1, 2))]


@pytest.mark.slow
def test_what_a_plan_does_in_passing_costs_no_way_of_its_own() -> None:
    """A world whose plan does a task in passing that it lists behind the one after it."""
    source = world_of("sparse", 5004)
    mission = FleetMission(source)
    plan = first_plan(mission, PLANNER)
    _, outcome, violations = play(mission, plan, Faults())
    simulated = run_trials([mission.source], SharedPlan())[0].steps
    assert (outcome.status, violations) == ("ended", [])
    assert outcome.makespan == pytest.approx(simulated, rel=0.05)  # 91; it was 103.8


def test_who_is_where_it_cannot_be_gets_the_plainest_plan() -> None:
    mission = trio()
    places = {0: (0.0, 0.0), 1: (-3.0, 0.0), 2: (1e300, 0.0)}
    stops = PLANNER.plan(mission, FleetSituation(places, mission.tasks))
    assert list(stops) == [(task.key, (0, 1, 2)) for task in mission.tasks]


def test_what_takes_longer_than_can_be_counted_gets_the_plainest_plan() -> None:
    """Half a second is a step here, so the longest duration of a message has two billion."""
    mission = FleetMission(pair().source, 0.5)
    task = TaskFact(FIRST_ADDED, "for ever", 3.0, 0.0, (1, 0, 0), 1e9)
    stops = PLANNER.plan(mission, FleetSituation({0: (0.0, 0.0), 1: (4.0, 0.0)}, (task,)))
    assert list(stops) == [(FIRST_ADDED, (0, 1))]
