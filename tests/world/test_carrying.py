"""Loads: taken up, carried at the pace of the slowest, unloaded, set down where robots are lost."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from blocked_worlds import blocked_worlds
from coordinations import RandomPlans
from random_worlds import random_decision, random_world, with_loads, with_surprises
from teamformer.methods.by_name import Player
from teamformer.methods.coordinators.crews import Crews
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.methods.scripted.joining import JoinAll
from teamformer.mission.coordination import Known, Plan
from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.mission.truth import draw_truth
from teamformer.world.env import TeamFormation
from teamformer.world.rules.constants import NOBODY
from twins import Twin


@pytest.mark.parametrize("is_plane", [False, True], ids=["grid", "plane"])
@pytest.mark.parametrize("has_surprises", [False, True], ids=["sure", "unsure"])
@pytest.mark.thorough
def test_step_with_loads_is_what_the_plain_twin_does(is_plane: bool, has_surprises: bool) -> None:
    rng = np.random.default_rng(92 + is_plane)
    taken = left = done = 0
    for number in range(80):
        mission = random_world(rng, is_plane=is_plane)
        mission = with_surprises(mission, rng) if has_surprises else mission
        mission = with_loads(mission, rng)
        truth = draw_truth(mission, number)
        coordinator = [None, RandomPlans(number), RandomPlans(number), SharedPlan()][number % 4]
        env = TeamFormation([mission], truths=[truth], coordinator=coordinator)
        twin = Twin(env)
        while env.is_running[0] and env.tally().steps < 60:
            view = env.view()
            twin.check_rests(view)
            is_planned = coordinator is not None and rng.random() < 0.8
            decision = env.planned_decision(view) if is_planned else random_decision(view, rng)
            twin.step(view, decision)
        tasks = env.worlds.tasks[0]
        taken += int((tasks["taken_at"] != NOBODY).sum())
        left += int((tasks["left_at"] != NOBODY).sum())
        done += int((tasks["is_load"] & (tasks["done_at"] != NOBODY)).sum())
    assert min(taken, done) > 40
    assert left > 2


@pytest.mark.parametrize("is_plane", [False, True], ids=["grid", "plane"])
@pytest.mark.parametrize(
    "player", [JoinAll(), Crews(), SharedPlan()], ids=["join", "crews", "plan"]
)
@pytest.mark.thorough
def test_nothing_blocks_with_loads(player: Player, is_plane: bool) -> None:
    count = 12 if isinstance(player, SharedPlan) else 60
    assert blocked_worlds(player, count, seed=15, is_plane=is_plane, have_loads=True) == []


def piano(rows: tuple[str, ...] = (), **changes: object) -> Mission:
    """Return two movers at x = 0 and 1 of a corridor, and a piano at 3 that goes to 9, two rows up.

    It takes a step to take up, and two to unload; b crosses a cell in two steps.
    """
    robots = (Robot("a", (0, 0), {"lift": 1}), Robot("b", (1, 0), {"lift": 1}, speed=0.5))
    task = Task("piano", (3, 0), {"lift": 2}, duration=1, to=(9, 2), unload=2)
    world = Grid(12, 4, rows)
    return replace(Mission("move", world, ("lift",), robots, (task,)), **changes)


def play(env: TeamFormation) -> list[dict[str, object]]:
    """Return after each step where the load is headed for, who serves it, and whether it is up."""
    seen = []
    while env.is_running[0]:
        env.step(JoinAll().decide(env.view()))
        task = env.worlds.tasks[0, 0]
        seen.append({name: task[name].item() for name in ("x", "y", "is_carried", "server")})
    return seen


def test_load_goes_at_the_pace_of_the_slowest_and_is_done_once_unloaded() -> None:
    """They join at x = 1 in step 2, are there in step 6 and have it up in step 7.

    Eight cells take 16 steps, until step 23, and then it is unloaded for two.
    """
    env = TeamFormation([piano()])
    seen = play(env)
    assert env.tally().steps == 25
    assert [row["is_carried"] for row in seen] == [False] * 6 + [True] * 18 + [False]
    assert [row["server"] for row in seen[4:8]] == [NOBODY, 0, 0, 0]
    assert (seen[5]["x"], seen[6]["x"]) == (3, 9)


def test_load_goes_around_walls() -> None:
    """A wall at x = 6 is open at its top alone: the way is 6 + 3 + 1 = 10 cells, 20 steps."""
    rows = ("......@.....",) * 3 + ("............",)
    env = TeamFormation([piano(rows)])
    play(env)
    assert env.tally().steps == 7 + 20 + 2


def test_load_is_set_down_where_a_robot_is_lost_and_taken_up_by_others() -> None:
    """b is lost in step 12, when three cells are behind them: c comes from x = 11 and helps.

    Until step 12 the team is seen at 4, 5 and 6 after steps 9, 11 and (would be) 13, so the load is
    set down at x = 5. c, who has walked to the piano and waited there, goes back to it.
    """
    mission = piano()
    a, b = mission.robots
    c = Robot("c", (11, 3), {"lift": 1})
    robots = (a, replace(b, absences=(Absence(12),)), c)
    env = TeamFormation([replace(mission, robots=robots, step_limit=0)])
    seen = play(env)
    task = env.worlds.tasks[0, 0]
    assert (seen[10]["is_carried"], seen[11]["is_carried"]) == (True, False)
    assert (seen[11]["x"], seen[11]["y"]) == (5, 0)
    assert task["left_at"] == 12
    assert task["done_at"] == env.tally().steps
    assert env.tally().status == "completed"


def test_nobody_takes_up_a_load_in_passing_and_nobody_with_a_load_does_anything_else() -> None:
    """The crate at x = 3 lies on the way to the far task; a tile on the way of the crate stays."""
    robots = (Robot("a", (0, 0), {"lift": 1}),)
    tasks = (
        Task("far", (5, 0), {"lift": 1}),
        Task("crate", (3, 0), {"lift": 1}, to=(0, 0)),
        Task("tile", (1, 0), {"lift": 1}, after=("far",)),
    )
    mission = Mission("row", Grid(6, 1), ("lift",), robots, tasks)

    class InOrder:
        """Have the robot do the tasks in the order of the file."""

        def update(self, known: Known, plan: Plan | None) -> Plan:
            return Plan(known.open_tasks, ((0,),) * len(known.open_tasks))

    env = TeamFormation([mission], coordinator=InOrder())
    while env.is_running[0]:
        env.step(env.planned_decision(env.view()))
    # far in step 5; crate: there in 7, back at 0 in 10; tile: passed in 9, and done in 11
    assert env.worlds.tasks[0]["done_at"].tolist() == [5, 10, 11]


def test_views_tell_where_loads_are_brought() -> None:
    lamp = Task("lamp", (2, 3), {"lift": 1})
    mission = piano()
    env = TeamFormation([replace(mission, tasks=(*mission.tasks, lamp), step_limit=0)])
    view = env.view()
    row = dict(zip(view.task_number[0].tolist(), view.task_to_place[0].tolist(), strict=True))
    assert row == {0: [9, 2], 1: [2, 3]}
    assert TeamFormation([replace(mission, tasks=(lamp,))]).view().task_to_place.size == 0
