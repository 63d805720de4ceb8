"""What an incident would make of a mission, and how much of that is luck of the search."""

from __future__ import annotations

from pathlib import Path

import pytest

from small_worlds import make, robot, task
from teamformer.files.mission_files import read_mission
from teamformer.live.running.forecasts import Forecast, forecast
from teamformer.live.running.incidents import CancelledTask, Incident, LostRobot, NewTask
from teamformer.live.running.what_if import WhatIf, luck_of, what_if
from teamformer.live.steps.mission_with_past import RunningMission
from teamformer.methods.by_name import Method, load_method
from teamformer.mission.coordination import Coordinator, Known, Plan
from teamformer.mission.model import Mission, Task

EXAMPLES = Path(__file__).parents[2] / "examples"


def never() -> bool:
    return False


class Nearest:
    """Gives each task to the able robot that is written first, and never plans anew but for news.

    In what order robots are written is luck: one is far away and the other near.
    """

    def update(self, known: Known, plan: Plan | None) -> Plan:
        first = known.robots[0]
        return Plan(known.open_tasks, ((first,),) * len(known.open_tasks))


def far_and_near() -> Mission:
    """A robot 9 cells from the task, and one 2 cells from it."""
    return make([robot("a", 0), robot("a", 7)], [task("a", 9)])


def mission(mission: Mission, coordinator: Coordinator) -> RunningMission:
    return RunningMission(mission, lambda: Method("own", coordinator=coordinator), 0)


def test_a_loss_that_helps_is_luck_and_the_search_tells_how_much() -> None:
    """The far robot takes 9 steps. Once it is lost, the near one takes 2, from the next step on."""
    weighed = what_if(mission(far_and_near(), Nearest()), LostRobot("r0"), never)
    assert weighed.without.ends == (9,)
    assert weighed.found.ends[0] < 9
    assert weighed.is_luck
    luck = luck_of(weighed, never)
    assert luck is not None
    assert luck >= 9 - weighed.found.ends[0]


def test_what_no_order_changes_is_no_luck() -> None:
    run = RunningMission(far_and_near(), lambda: load_method("plan"), 0)
    weighed = what_if(run, LostRobot("r1"), never)
    assert weighed.found.ends[0] > weighed.without.ends[0]
    assert not weighed.is_luck
    assert luck_of(weighed, never) == 0


@pytest.mark.parametrize(
    ("incident", "more", "is_luck"),
    [
        (LostRobot("r0"), -1, True),
        (LostRobot("r0"), 1, False),
        (NewTask(Task("new", (0, 0), {"a": 1})), -1, True),
        (CancelledTask("t0"), 1, True),
        (CancelledTask("t0"), -1, False),
        (CancelledTask("t0"), 0, False),
    ],
)
def test_only_luck_moves_an_end_the_wrong_way(incident: Incident, more: int, is_luck: bool) -> None:
    now = mission(far_and_near(), Nearest())
    ends = [Forecast(1, (end,)) for end in (9 + more, 9)]
    assert WhatIf(now, incident, *ends).is_luck == is_luck
    assert not WhatIf(now, incident, Forecast(1, (), now.tally()), ends[1]).is_luck


@pytest.mark.parametrize("method", ["plan", "crews"])
def test_in_other_orders_the_same_mission_is_planned(method: str) -> None:
    """Teams, services under way and loads are there; whatever is planned can be done."""
    mission = read_mission(EXAMPLES / "warehouse.yaml")
    run = RunningMission(mission, lambda: load_method(method), 0)
    for _ in range(12):
        run.step()
    sooner = forecast(run.past())
    for order in (1, 2):
        anew = forecast(run.past_planned_anew(order))
        lost = forecast(run.past_with(LostRobot("bison"), order))
        assert anew.ends
        assert lost.ends
    assert forecast(run.past()) == sooner  # the mission itself is as it was
