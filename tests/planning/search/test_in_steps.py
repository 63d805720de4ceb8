"""Graphs of arcs in steps: times against a slow twin, changes that are undone, what is passed."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
import pytest
from test_arcs import run_script

from plain_teams import slow_ends
from random_worlds import random_world, with_precedence_and_windows
from teamformer.files.drawn.generate import Spec, generate
from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.planning.graph.graph import COST, END_SUM, MAKESPAN, Graph
from teamformer.planning.problem.coalition_plan import CoalitionPlan, plan_of_lists
from teamformer.planning.problem.constants import TICKS
from teamformer.planning.step_times.crossings import no_crossings
from teamformer.planning.steps.arc_search import TeamArcs
from teamformer.planning.steps.situation import Situation, situation_in_hindsight
from teamformer.planning.steps.solve import begin_race, from_best, improve
from teamformer.world.rules.constants import FAR

SEEDS = range(12)


def drawn(seed: int, forming_steps: int = 1) -> tuple[Mission, Situation]:
    """Draw a mission, and how it begins; nothing in it is done on the way.

    In every third one tasks come after others.
    """
    rng = np.random.default_rng(seed)
    mission = random_world(rng, with_losses=False) if seed % 2 else generate(Spec(6, 12, 3), rng)
    if seed % 3 == 0:
        mission = with_precedence_and_windows(mission, rng, windows=0)
    mission = replace(mission, forming_steps=forming_steps)
    return mission, situation_in_hindsight(mission)._replace(crossings=no_crossings())


def plan_of(arcs: TeamArcs, graph: Graph) -> CoalitionPlan:
    """Return the plan that a graph holds."""
    arcs.search._best = graph
    return arcs.plan


def ends_of(arcs: TeamArcs) -> list[int]:
    tasks = len(arcs.situation.tasks)
    ends: list[int] = (arcs.search.graph.nodes.end[:tasks] // TICKS).tolist()
    return ends


@pytest.mark.parametrize("seed", SEEDS)
def test_times_of_a_plan_that_is_laid_out_are_those_of_a_slow_twin(seed: int) -> None:
    mission, situation = drawn(seed)
    searched = TeamArcs(situation, seed)
    assert searched.plan_anew(rounds=300) is not None
    plan = searched.plan
    arcs = TeamArcs(situation)
    arcs.begin_at(plan)
    slow = slow_ends(mission, situation.problem, plan)
    assert ends_of(arcs) == slow
    assert arcs.search.graph.total[MAKESPAN] // TICKS == max(slow)
    assert arcs.search.graph.total[END_SUM] // TICKS >= sum(slow)


@pytest.mark.parametrize("seed", SEEDS)
def test_times_that_are_worked_out_as_they_change_are_those_of_the_whole_plan(seed: int) -> None:
    """Where parting is free: else the order in which groups part may be an old one."""
    mission, situation = drawn(seed, forming_steps=0)
    arcs = TeamArcs(situation, seed)
    assert arcs.begin_anew()
    best = arcs.search._best
    for turn in range(60):
        arcs.search.anneal(4 * TICKS, TICKS, turn * 5, turn * 5 + 5, 300)
        plan = plan_of(arcs, arcs.search.graph)
        arcs.search._best = best
        assert ends_of(arcs) == slow_ends(mission, situation.problem, plan)


@pytest.mark.parametrize("seed", SEEDS)
def test_searching_on_never_loses_the_best_and_every_coalition_is_able(seed: int) -> None:
    mission, situation = drawn(seed)
    arcs = TeamArcs(situation, seed)
    assert arcs.begin_anew()
    first = arcs.search.rank
    arcs.search.anneal(4 * TICKS, TICKS, 0, 3000, 3000)
    assert arcs.search.rank <= first
    plan, problem = arcs.plan, situation.problem
    for task, size in enumerate(plan.size.tolist()):
        crew = plan.coalition[task, :size].tolist()
        assert len(set(crew)) == size
        assert (problem.counts[crew].sum(axis=0) >= problem.needs[task]).all()
    assert max(slow_ends(mission, problem, plan)) <= arcs.search._best.total[MAKESPAN] // TICKS + 1


def test_a_group_serves_what_it_passes_on_its_way() -> None:
    ann, bob = (Robot(name, (x, 0), {"a": 1}) for name, x in (("ann", 0), ("bob", 25)))
    tasks = (Task("far", (10, 0), {"a": 1}), Task("passed", (5, 0), {"a": 1}, duration=3))
    mission = Mission("corridor", Grid(30, 1), ("a",), (ann, bob), tasks)
    arcs = TeamArcs(situation_in_hindsight(mission))
    arcs.begin_at(plan_of_lists([0, 1], [[0], [1]]))
    assert ends_of(arcs)[0] == 13  # five cells, three steps of service, five cells
    arcs.begin_at(plan_of_lists([1, 0], [[0], [0]]))
    assert ends_of(arcs) == [13, 8]


def test_large_coalitions_are_begun_without_robots_to_spare() -> None:
    robots = tuple(Robot(f"r{n}", (n, 0), {"a": 1}) for n in range(8))
    mission = Mission(
        "crowd",
        Grid(30, 1),
        ("a",),
        robots,
        (Task("t", (9, 0), {"a": 2}), Task("u", (1, 0), {"a": 1})),
    )
    arcs = TeamArcs(situation_in_hindsight(mission))
    arcs.begin_at(plan_of_lists([0, 1], [list(range(8)), [7]]))
    assert arcs.plan.size.tolist() == [6, 1]  # two that are needed, and four riders
    assert arcs.search.graph.total[COST] > 0


def test_searching_by_the_clock_begins_at_the_best_plan_and_offers_better_ones() -> None:
    situation = drawn(0)[1]
    first = TeamArcs(situation).plan_anew(rounds=1)
    assert first is not None
    begun = time.perf_counter()
    race = begin_race(first, begun, begun + 0.5)
    improve(race, situation, from_best(race), seed=0)
    assert race.judgement.value == race.plan.makespan < first.makespan
    assert race.curve[-1][1] == race.plan.makespan
    stopped = begin_race(first, begun, begun + 600)
    stopped.stop()
    improve(stopped, situation, from_best(stopped), seed=0)  # ends at once


def test_nobody_is_planned_for_what_ends_after_it_is_lost() -> None:
    lost = Robot("lost", (0, 0), {"a": 1}, absences=(Absence(5),))
    stays = Robot("stays", (20, 0), {"a": 1})
    tasks = (Task("near", (2, 0), {"a": 1}), Task("later", (6, 0), {"a": 1}))
    mission = Mission("corridor", Grid(30, 1), ("a",), (lost, stays), tasks)
    situation = situation_in_hindsight(mission)
    arcs = TeamArcs(situation)
    arcs.begin_at(plan_of_lists([0, 1], [[0], [0]]))
    assert arcs.search.graph.total[MAKESPAN] >= FAR * TICKS
    found = arcs.improve(arcs.best, rounds=200)
    assert found.plan.coalition[:, 0].tolist() == [0, 1]
    assert found.ends.tolist() == [2, 14]


UNDOING = """
import numpy as np
from test_in_steps import drawn
from teamformer.planning.search import annealing
from teamformer.planning.steps.arc_search import TeamArcs

tried = {}
def watch(name, made):
    def watched(problem, state, *rest):
        before = [array.copy() for array in state.graph]
        is_short = made(problem, state, *rest)
        tried[name] = tried.get(name, 0) + (state.trial.number[0] > 0)
        latest[0] = (problem, *before)
        return is_short
    return watched

def undo(graph, trial):
    undone(graph, trial)
    problem, nodes, *before = latest[0]
    most = problem.most[0]
    in_use = [nodes[n].first + np.arange(nodes[n].taken) for n in range(len(problem.near))]
    in_use = np.concatenate([*in_use, np.arange(len(problem.near) * most, len(graph.seats))])
    assert (before[0][in_use] == graph.seats[in_use]).all()
    assert (nodes == graph.nodes).all()
    assert (before[3][in_use] == graph.comes[in_use]).all()
    assert (before[2] == graph.total).all()

latest, undone = [None], annealing.undo
annealing.undo = undo
for name in ("exchange_rests", "ride", "move_task", "move_stretch"):
    setattr(annealing, name, watch(name, getattr(annealing, name)))
for seed in range(4):
    arcs = TeamArcs(drawn(seed)[1], seed)
    assert arcs.begin_anew()
    arcs.search.anneal(1000, 1000, 0, 300, 300)
    graph = arcs.search.graph
    for seat in range(len(graph.seats) - len(graph.back)):
        node = graph.nodes[graph.seats[seat].node]
        if seat < node.first + node.taken:
            to = graph.seats[seat].next
            assert graph.seats[to].prev == seat and graph.seats[to].kind == graph.seats[seat].kind
            assert node.key < graph.nodes[graph.seats[to].node].key
    for task, row in enumerate(arcs.search.arcs.before):
        assert (graph.nodes.key[row[row >= 0]] < graph.nodes.key[task]).all()
names = ("ride", "move_task", "move_stretch")
assert min(tried.get(name, 0) for name in names) > 5, tried
"""

SEARCHING = """
from test_in_steps import drawn
from teamformer.planning.steps.arc_search import TeamArcs
for seed in range(3):
    plan = TeamArcs(drawn(seed)[1], seed).plan_anew(150).plan
    print(plan.order.tolist(), plan.size.tolist(), plan.coalition.tolist())
"""


@pytest.mark.thorough
def test_a_change_that_is_refused_leaves_everything_as_it_was() -> None:
    run_script(UNDOING, NUMBA_DISABLE_JIT="1")


@pytest.mark.thorough
def test_the_plan_is_the_same_without_compiled_code() -> None:
    assert run_script(SEARCHING) == run_script(SEARCHING, NUMBA_DISABLE_JIT="1")
