"""Searches in other orders: the same is known, and plans are in the mission's own numbers."""

from __future__ import annotations

from dataclasses import replace

from small_worlds import make, robot, task
from teamformer.methods.coordinators.reordered import Reordered
from teamformer.mission.coordination import Known, Plan
from teamformer.world.env import TeamFormation

ROBOTS = [robot("a", 0), robot("b", 0), robot("c", 5), robot("ab", 8)]
TASKS = [task("a", 4), task("b", 6), task("c", 1), task("ab", 9)]


class Spy:
    """Keeps what it is asked, and gives each robot the task of the same number."""

    def __init__(self) -> None:
        self.asked: list[tuple[Known, Plan | None]] = []

    def update(self, known: Known, plan: Plan | None) -> Plan:
        self.asked.append((known, plan))
        names = [robot.name[1:] for robot in known.mission.robots]
        order = known.open_tasks
        wanted = [known.mission.tasks[k].name[1:] for k in order]
        return Plan(order, tuple((names.index(name),) for name in wanted))


def test_the_same_is_known_in_other_numbers_and_the_plan_comes_back_in_ours() -> None:
    known = TeamFormation([make(ROBOTS, TASKS, teams=((0, 1),))]).known()
    spy = Spy()
    ours = Plan((2, 0), ((2,), (0, 1)), scouts=((3, 1),))
    made = Reordered(spy, 5).update(known, ours)
    ((there, plan),) = spy.asked
    robots, tasks = there.mission.robots, there.mission.tasks
    assert robots != known.mission.robots
    assert tasks != known.mission.tasks
    assert {robots[r].name: at for r, at in enumerate(there.places)} == {
        it.name: known.places[r] for r, it in enumerate(known.mission.robots)
    }
    teams = {frozenset(robots[r].name for r in team) for team in there.teams}
    assert teams == {frozenset({"r0", "r1"}), frozenset({"r2"}), frozenset({"r3"})}
    assert plan is not None
    assert [tasks[k].name for k in plan.order] == ["t2", "t0"]
    assert [{robots[r].name for r in those} for those in plan.coalitions] == [{"r2"}, {"r0", "r1"}]
    assert [(robots[r].name, tasks[k].name) for r, k in plan.scouts] == [("r3", "t1")]
    assert sorted(made.order) == [0, 1, 2, 3]
    assert made.coalitions == tuple((task,) for task in made.order)


def test_the_order_that_a_mission_is_written_in_changes_nothing() -> None:
    known = TeamFormation([make(ROBOTS, TASKS)]).known()
    spy = Spy()
    Reordered(spy, 0).update(known, None)
    assert spy.asked == [(known, None)]


def test_all_that_is_known_of_robots_and_tasks_is_in_the_other_numbers() -> None:
    """Whose battery has how much left, and which loads are taken up or unloaded, too."""
    known = TeamFormation([make(ROBOTS, TASKS)]).known()
    known = replace(known, left=(1.0, 2.0, 3.0, 4.0), loading={0: 7.0}, unloading=frozenset({2}))
    spy = Spy()
    Reordered(spy, 5).update(known, None)
    ((there, _),) = spy.asked
    robots, tasks = there.mission.robots, there.mission.tasks
    assert {it.name: there.left[r] for r, it in enumerate(robots)} == {
        it.name: known.left[r] for r, it in enumerate(known.mission.robots)
    }
    assert {tasks[k].name: until for k, until in there.loading.items()} == {"t0": 7.0}
    assert {tasks[k].name for k in there.unloading} == {"t2"}
    assert there.mission.step_limit == known.mission.step_limit
