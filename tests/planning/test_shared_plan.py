"""The plan that every robot works out alike: its times by hand, and what it promises."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace
from hashlib import sha256
from pathlib import Path

import numpy as np
import pytest

from coordinations import play_by_plan
from random_worlds import random_world
from teamformer.files.drawn.generate import Spec, generate
from teamformer.files.drawn.named_settings import world_of
from teamformer.methods.coordinators.replayed import Replayed
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.mission.coordination import Known, Plan
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.capabilities import covers, total
from teamformer.mission.parts.grid import Grid
from teamformer.planning.problem.coalition_plan import plan_of_lists
from teamformer.planning.steps.shared_plan import (
    Rounds,
    is_too_large,
    plan_mission,
    rounds_for,
    search,
    shared_plan_of,
)
from teamformer.planning.steps.situation import situation_in_hindsight, situation_of
from teamformer.planning.steps.starts import plan_from_crews
from teamformer.planning.steps.timed_plan import time_team_plan
from teamformer.world.env import TeamFormation


def start_of(mission: Mission) -> Known:
    """Return what everybody knows before the first step."""
    return Known(
        mission=mission,
        now=0,
        open_tasks=tuple(k for k, task in enumerate(mission.tasks) if task.appears == 0),
        places=tuple(robot.at for robot in mission.robots),
        teams=mission.starting_teams,
        free_at=(0,) * len(mission.robots),
    )


def corridor(
    places: list[int], tasks: list[Task], teams: tuple[tuple[int, ...], ...] = ()
) -> Mission:
    """Draw robots, each able to do "a" once, in a corridor."""
    robots = tuple(Robot(f"r{n}", (x, 0), {"a": 1}) for n, x in enumerate(places))
    return Mission("corridor", Grid(30, 1), ("a",), robots, tuple(tasks), teams)


def task(x: int, count: int, duration: int = 0) -> Task:
    return Task(f"t{x}-{count}", (x, 0), {"a": count}, duration=duration)


def settled(
    mission: Mission, order: list[int], crews: list[list[int]]
) -> tuple[list[int], list[list[int]]]:
    """Return the step in which each task of a plan is done, and by whom once it is settled."""
    situation = situation_of(start_of(mission))
    timed = time_team_plan(situation, plan_of_lists(order, crews))
    plan = timed.plan
    crew = [sorted(plan.coalition[k, : plan.size[k]].tolist()) for k in range(len(order))]
    return timed.ends.tolist(), crew


def played(mission: Mission, order: list[int], crews: list[list[int]]) -> list[int]:
    """Return the step in which each task is done if a plan is carried out."""
    plan = Plan(tuple(order), tuple(tuple(crew) for crew in crews), why=("start",))
    env = TeamFormation([mission], coordinator=Replayed([(0, plan)], SharedPlan()))
    play_by_plan(env)
    done: list[int] = env.worlds.tasks["done_at"][0].tolist()
    return done


def test_who_has_nothing_left_to_do_is_left_behind_at_the_cost_of_a_split() -> None:
    mission = corridor([4, 4], [task(4, 2), task(8, 1)])
    assert settled(mission, [0, 1], [[0, 1], [0]])[0] == [1, 6]
    assert settled(mission, [0, 1], [[0, 1], [0, 1]])[0] == [1, 5]


def test_who_passes_a_task_that_it_can_do_does_it() -> None:
    mission = corridor([0, 20], [task(10, 1), task(5, 1, duration=3)])
    ends, crew = settled(mission, [0, 1], [[0], [1]])
    assert ends == [13, 8]  # five cells, three steps of service, five cells
    assert crew == [[0], [0]]


def test_who_comes_past_a_task_before_those_who_are_planned_for_it_does_it() -> None:
    ann = Robot("ann", (0, 0), {"a": 1})
    bob = Robot("bob", (9, 0), {"a": 1, "b": 1})
    tasks = (Task("near-bob", (8, 0), {"a": 1}), Task("far", (2, 0), {"b": 1}))
    mission = Mission("corridor", Grid(30, 1), ("a", "b"), (ann, bob), tasks)
    assert settled(mission, [0, 1], [[0], [1]]) == ([1, 7], [[1], [1]])


@pytest.mark.parametrize(("places", "end"), [([0, 8], 18), ([8, 0], 14)])
def test_of_two_that_come_to_a_task_in_one_step_the_lower_slot_does_it(
    places: list[int], end: int
) -> None:
    """Both are at 4 in step 4: who is planned for it, from 8, and who passes it, from 0 to 14."""
    mission = corridor(places, [task(4, 1, duration=4), task(14, 1)])
    crews = [[places.index(8)], [places.index(0)]]
    found, crew = settled(mission, [0, 1], crews)
    assert (found, crew) == ([8, end], [[0], crews[1]])
    assert played(mission, [0, 1], crews) == found


@pytest.mark.parametrize(("speed", "ends"), [(0.5, [9, 19]), (1.0, [12, 5])])
def test_who_has_not_left_the_cell_where_it_starts_does_what_is_there(
    speed: float, ends: list[int]
) -> None:
    mission = corridor([5, 9], [task(5, 1, duration=8), task(10, 1)])
    slow = replace(mission.robots[0], speed=speed)
    mission = replace(mission, robots=(slow, mission.robots[1]))
    assert settled(mission, [0, 1], [[1], [0]])[0] == ends
    assert played(mission, [0, 1], [[1], [0]]) == ends


def test_a_team_does_all_that_it_can_where_it_is_at_once() -> None:
    mission = corridor([0, 0], [task(3, 2, duration=4), task(3, 1, duration=6)], ((0, 1),))
    assert settled(mission, [0, 1], [[0, 1], [0]])[0] == [7, 9]


def test_nobody_waits_for_robots_that_a_task_can_do_without() -> None:
    mission = corridor([0, 20], [task(3, 1)])
    assert settled(mission, [0], [[0, 1]]) == ([3], [[0]])


def test_robots_are_free_when_their_service_ends() -> None:
    mission = corridor([0, 9], [task(3, 1)])
    known = replace(start_of(mission), now=10, free_at=(14, 10))
    assert plan_mission(known) == Plan((0,), ((1,),), (16,), made_from="crews")


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.thorough
def test_every_coalition_can_do_its_task(seed: int) -> None:
    rng = np.random.default_rng(seed)
    for number in range(30):
        mission = random_world(rng, is_plane=number % 3 == 0)
        known = start_of(mission)
        plan = plan_mission(known)
        assert sorted(plan.order) == sorted(known.open_tasks)
        for doing, coalition in zip(plan.order, plan.coalitions, strict=True):
            assert covers(
                total(mission.robots[r].can for r in coalition), mission.tasks[doing].needs
            )


def test_a_plan_is_no_worse_than_what_crews_do() -> None:
    """As it begins with their lists, some of them longer searched."""
    rng = np.random.default_rng(7)
    for _ in range(6):
        mission = generate(Spec(robots=8, tasks=12, capabilities=3), rng)
        situation = situation_of(start_of(mission))
        rounds = rounds_for(situation.problem, is_again=False)
        crews = plan_from_crews(situation.problem, situation.company, rounds.crews)
        assert plan_mission(start_of(mission)).makespan <= time_team_plan(situation, crews).makespan


def test_rounds_become_fewer_as_missions_grow() -> None:
    def rounds(robots: int, tasks: int, capabilities: int) -> Rounds:
        rng = np.random.default_rng(0)
        mission = generate(Spec(robots, tasks, capabilities, world=Grid(40, 40)), rng)
        return rounds_for(situation_of(start_of(mission)).problem, is_again=False)

    assert (rounds(16, 60, 6).crews, rounds(16, 60, 6).arcs) == (90_000, 30_000)
    assert rounds(4, 4, 4).arcs == 300 * 16
    assert rounds(20, 100, 4).arcs == 900_000
    assert rounds(100, 300, 8).arcs == 210_000_000 // 300


def test_robots_that_are_best_apart_are_planned_from_coalitions() -> None:
    """Four robots that start together and tasks in four directions: one crew would do them all."""
    robots = tuple(Robot(f"r{n}", (20, 20), {"a": 1}) for n in range(4))
    far = ((20, 0), (20, 40), (0, 20), (40, 20))
    tasks = tuple(Task(f"t{n}", at, {"a": 1}) for n, at in enumerate(far))
    both = Task("both", (20, 20), {"a": 4})
    mission = Mission("star", Grid(41, 41), ("a",), robots, (*tasks, both))
    plan = plan_mission(start_of(mission))
    assert plan.made_from == "coalitions"
    assert sorted(len(crew) for crew in plan.coalitions) == [1, 1, 1, 1, 4]


def test_a_large_mission_is_planned_by_one_search_over_graphs_of_arcs() -> None:
    mission = generate(
        Spec(20, 100, 6, requirements=2, world=Grid(30, 30)), np.random.default_rng(0)
    )
    known = start_of(mission)
    situation = situation_of(known)
    plan = plan_mission(known)
    assert plan.made_from == "arcs"
    rounds = rounds_for(situation.problem, is_again=False)
    crews = plan_from_crews(situation.problem, situation.company, rounds.crews)
    assert plan.makespan < time_team_plan(situation, crews).makespan
    lost = replace(known, teams=known.teams[1:])
    again = plan_mission(lost, plan)
    assert sorted(again.order) == list(range(100))
    assert not any(0 in coalition for coalition in again.coalitions)


def test_only_vast_missions_are_too_large() -> None:
    tasks = [task(0, 1)]
    robots = [0] * 330
    many = tuple(replace(tasks[0], name=f"t{n}") for n in range(3000))
    assert not is_too_large(replace(corridor(robots, tasks), tasks=many))  # 3000 * 3330 = 9,990,000
    assert is_too_large(replace(corridor([0] * 340, tasks), tasks=many))


def test_a_plan_made_again_is_never_worse_by_its_own_count() -> None:
    rng = np.random.default_rng(1)
    for _ in range(20):
        mission = random_world(rng, with_losses=False, with_arrivals=False)
        known = start_of(mission)
        old = plan_mission(known)
        assert plan_mission(known, old).makespan <= old.makespan
        assert plan_mission(known, old, is_brief=True).makespan <= old.makespan


HASHED = """
from test_shared_plan import BRIEFLY, hash_of
print(hash_of(seed={seed}, worlds={worlds}, rounds={rounds}))
"""

BRIEFLY = Rounds(crews=30, coalition=10, arcs=30, coalitions=2)


def hash_of(seed: int, worlds: int, rounds: Rounds | None = None) -> str:
    """Return a hash of the plans of many worlds, by fewer rounds than usual if these are given."""
    rng, stamp = np.random.default_rng(seed), sha256()
    for number in range(worlds):
        known = start_of(random_world(rng, is_plane=number % 3 == 0))
        if rounds is None:
            stamp.update(repr(plan_mission(known)).encode())
        else:
            situation = situation_of(known)
            found = shared_plan_of(situation, *search(situation, rounds, known.step))
            stamp.update(repr(found).encode())
    return stamp.hexdigest()


def hash_elsewhere(seed: int, worlds: int, rounds: str = "None", **environment: str) -> str:
    """Return the hash that another process finds."""
    here = Path(__file__).parent
    paths = [str(here), str(here.parent), os.environ.get("PYTHONPATH", "")]
    told = subprocess.run(
        [sys.executable, "-c", HASHED.format(seed=seed, worlds=worlds, rounds=rounds)],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, **environment, "PYTHONPATH": os.pathsep.join(paths)},
    )
    return told.stdout.strip()


@pytest.mark.thorough
def test_plans_are_the_same_without_the_compiler_and_in_another_process() -> None:
    ours = hash_of(seed=4, worlds=6, rounds=BRIEFLY)
    assert hash_elsewhere(4, 6, "BRIEFLY", NUMBA_DISABLE_JIT="1") == ours


@pytest.mark.slow
def test_thousands_of_plans_are_the_same_in_other_processes() -> None:
    ours = hash_of(seed=5, worlds=2000)
    assert hash_elsewhere(5, 2000, NUMBA_NUM_THREADS="1") == ours
    assert hash_elsewhere(5, 2000, NUMBA_NUM_THREADS="2", OMP_NUM_THREADS="2") == ours


def test_wide_coalitions_have_fewer_rounds_as_each_takes_longer() -> None:
    """Of 30,000 rounds a start, a twenty-fifth where fifty robots do a task and not ten."""
    for setting, rounds in (
        ("8N20T-C8", 30_000),
        ("100N20T-C100-R10", 30_000),
        ("100N20T-C100-R50", 1_200),
    ):
        problem = situation_in_hindsight(world_of(setting, 0)).problem
        assert rounds_for(problem, is_again=False).arcs == rounds
