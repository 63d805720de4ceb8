"""Changes of a plan that are judged by their plays, where no plan foresees what these come to."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace

from teamformer.methods.central.plan_centrally import plan_centrally
from teamformer.methods.central.plays import WORST, Plays, Rank
from teamformer.methods.central.variations import vary
from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.planning.problem.coalition_plan import CoalitionPlan, plan_of_lists
from teamformer.planning.steps.situation import situation_in_hindsight
from teamformer.planning.steps.timed_plan import time_team_plan

NOT_PROVEN = 0


def plays_of(mission: Mission) -> Plays:
    return Plays(mission, time.perf_counter(), time_limit=1e6)


def play(mission: Mission, *order: int) -> float:
    """Return the steps that the plan of one robot takes when it is played."""
    steps, _ = plays_of(mission).add_plan("plan", plan_of_one(order))
    return steps


def plan_of_one(order: Sequence[int]) -> CoalitionPlan:
    return plan_of_lists(order, [[0]] * len(order))


def test_a_plan_that_promises_more_is_played_in_fewer_steps() -> None:
    """Where robots are lost and come back, no plan counts with it.

    ..R.B    R is lost in step 6 and back in step 20. Task a is where it starts and takes 6 steps.
    a, b is promised by 1 + 6 + 2 = 9; but a is cut off, begun again at 20, done at 26, and b at 28.
    b, a is promised by 2 + 2 + 6 = 10; b is done at 2, a is cut off, and done at 26.
    """
    away = (Absence(lost=6, back=20),)
    robot = Robot("r", (2, 0), {"a": 1}, absences=away)
    tasks = (Task("a", (2, 0), {"a": 1}, duration=6), Task("b", (4, 0), {"a": 1}))
    mission = Mission("corridor", Grid(5, 1), ("a",), (robot,), tasks)
    situation = situation_in_hindsight(mission)
    promised = [
        time_team_plan(situation, plan_of_one(order)).makespan for order in ((0, 1), (1, 0))
    ]
    assert promised == [9, 10]
    assert (play(mission, 0, 1), play(mission, 1, 0)) == (28, 26)
    plays = plays_of(mission)
    plays.add_plan("search", plan_of_one((0, 1)))
    vary(situation.problem, plays, NOT_PROVEN, seed=0)
    assert plays.makespan == 26
    made = plan_centrally(mission, time_limit=10.0, workers=1)
    assert made.makespan == 26


def test_tasks_stay_behind_those_that_they_come_after_and_coalitions_are_able() -> None:
    """Of three orders in which c comes after b, and four robots of which any two do a task."""
    robots = tuple(Robot(f"r{x}", (x, 0), {"a": 1}) for x in range(4))
    needs, places = {"a": 2}, (3, 0, 2)
    tasks = [Task(name, (x, 0), needs) for name, x in zip("abc", places, strict=True)]
    tasks[2] = replace(tasks[2], after=("b",))
    mission = Mission("corridor", Grid(4, 1), ("a",), robots, tuple(tasks))
    played: list[CoalitionPlan] = []

    class Noted(Plays):
        def add_plan(self, name: str, plan: CoalitionPlan) -> Rank:
            played.append(plan)
            return super().add_plan(name, plan)

    plays = Noted(mission, time.perf_counter(), time_limit=1e6)
    plays.add_plan("search", plan_of_lists((1, 2, 0), [[0, 1, 2, 3]] * 3))
    vary(situation_in_hindsight(mission).problem, plays, NOT_PROVEN, seed=0)
    assert {tuple(plan.order.tolist()) for plan in played} == {(0, 1, 2), (1, 0, 2), (1, 2, 0)}
    assert min(int(plan.size.min()) for plan in played) == 2
    assert len({str(plan) for plan in played}) == len(played)


def test_where_windows_count_a_play_ends_when_it_is_beaten() -> None:
    """A robot in the middle; a, due at 3, is 2 to the left, and b, which takes 30, 2 to the right.

    a, b is done at 2 and 36: (36 + 2 x 0) / 3. b, a at 32 and 36: (36 + 2 x 33) / 3. Of this play
    it is known at step 20 that it costs (20 + 2 x 17) / 3 = 18 at least.
    """
    robot = Robot("r", (2, 0), {"a": 1})
    tasks = (Task("a", (0, 0), {"a": 1}, between=(0, 3)), Task("b", (4, 0), {"a": 1}, duration=30))
    mission = Mission("corridor", Grid(5, 1), ("a",), (robot,), tasks)
    plays = plays_of(mission)
    ranks = [plays.add_plan("plan", plan_of_one(order)) for order in ((1, 0), (0, 1), (1, 0))]
    assert ranks == [(34.0, -2), (12.0, -2), WORST]
