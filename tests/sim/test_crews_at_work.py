"""Crews while a trial runs: who heads where, when they are planned anew, and what comes of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from small_worlds import assignments, make, order_of, play, robot, task
from teamformer.grid import Grid
from teamformer.model import Absence, Scenario
from teamformer.policies.scripted.joining import JoinCrew
from teamformer.scenarios.generate import Spec, generate
from teamformer.sim.env import TeamFormation
from teamformer.trials.trial import run_trials


def crewed(*things, **rules) -> Scenario:  # type: ignore[no-untyped-def]
    return replace(make(*things, **rules), allocation="crews")


def plans(env: TeamFormation) -> int:
    return int(env.worlds.count["plans"][0])


def test_every_robot_heads_for_the_first_task_of_its_list_that_needs_it() -> None:
    """a b T . U: T needs a, U both; one crew, so b goes straight on to U."""
    env = TeamFormation([crewed([robot("a", 0), robot("b", 1)], [task("a", 2), task("ab", 4)])])
    play(env)
    assert order_of(env) == [0, 1]
    assert assignments(env) == {0: 0, 1: 1}


def test_a_team_takes_the_earliest_of_its_robots_tasks() -> None:
    robots, tasks = [robot("a", 0), robot("b", 0)], [task("a", 2), task("b", 4)]
    env = TeamFormation([crewed(robots, tasks, teams=((0, 1),))])
    play(env)
    assert assignments(env) == {0: 0}


def test_an_assignment_is_not_kept_when_robots_part() -> None:
    robots, tasks = [robot("a", 0), robot("b", 0)], [task("a", 2), task("b", 4)]
    env = TeamFormation([crewed(robots, tasks, teams=((0, 1),))])
    play(env)
    play(env, splits={0: [0]})
    assert assignments(env) == {0: 0, 1: 1}


def test_mates_are_seen_and_joined_before_others_that_bring_the_same() -> None:
    """Two crews a b in one place: 0 wants b and gets its own crew's, though the other is lower."""
    robots = [robot("a", 3), robot("a", 3), robot("b", 3), robot("b", 3)]
    env = TeamFormation([crewed(robots, [task("ab", 0), task("ab", 6)])])
    crew = env.worlds.robots["crew"][0].tolist()
    mate = next(r for r in (2, 3) if crew[r] == crew[1])
    view = env.view()
    assert view.is_mate[1, view.seen_slot[1] == mate].all()
    assert view.is_mate[1].sum() == 1
    play(env, joins={1: mate})
    assert env.worlds.robots["team"][0].tolist()[mate] == 1


def test_without_crews_all_are_mates() -> None:
    robots = [robot("a", 3), robot("a", 3), robot("b", 3)]
    view = TeamFormation([make(robots, [task("ab", 0)])]).view()
    assert view.is_mate.all()


def test_the_own_crews_tasks_come_first_in_a_view() -> None:
    env = TeamFormation([crewed([robot("a", 5), robot("a", 5)], [task("a", x) for x in range(9)])])
    view = env.view()
    for row in range(2):
        crew = env.worlds.robots["crew"][0, row]
        lists = [env.worlds.tasks["crew"][0, k] for k in view.task_number[row]]
        assert lists == sorted(lists, key=lambda number: number != crew)


def test_crews_are_planned_anew_when_a_robot_is_lost() -> None:
    """Two crews of a with a side each; one is lost on its way, and the other does both tasks."""
    robots = [robot("a", 5, lost=2), robot("a", 5)]
    env = TeamFormation([crewed(robots, [task("a", 0), task("a", 10)], Grid(11, 1))])
    assert plans(env) == 1
    play(env, 2)
    assert plans(env) == 2
    assert env.worlds.tasks["crew"][0].tolist() == [env.worlds.robots["crew"][0, 1]] * 2
    [tally] = run_trials(list(env.scenarios), JoinCrew())
    assert (tally.status, tally.steps) == ("completed", 15)  # the nearer one first: 5 + 10


def test_crews_merge_so_that_nothing_blocks() -> None:
    """The crews are a b and a b; both lose one that the other has, and the rest become one."""
    robots = [robot("a", 2, lost=1), robot("b", 2), robot("a", 2), robot("b", 2, lost=1)]
    env = TeamFormation([crewed(robots, [task("ab", 0), task("ab", 4)])])
    before = env.worlds.robots["crew"][0].tolist()
    play(env)
    after = env.worlds.robots["crew"][0].tolist()
    if before[1] != before[2]:
        assert after[1] == after[2]
    assert run_trials(list(env.scenarios), JoinCrew())[0].status == "completed"


def test_all_is_planned_anew_when_tasks_appear() -> None:
    late = [task("a", 8), task("a", 4, appears=1), task("a", 2, appears=1)]
    env = TeamFormation([crewed([robot("a", 0)], late)])
    play(env)
    assert order_of(env) == [2, 1, 0]
    assert plans(env) == 2


def test_sharing_out_beats_one_order() -> None:
    rng = np.random.default_rng(7)
    fleets = [generate(Spec(20, 60, 4, world=Grid(20, 20)), rng) for _ in range(10)]

    def mean(worlds: list[Scenario], **rules: str) -> float:
        tallies = run_trials([replace(world, **rules) for world in worlds], JoinCrew())
        return float(np.mean([tally.steps for tally in tallies]))

    assert mean(fleets, allocation="crews") < 0.5 * mean(fleets, allocation="paper")


def test_one_robot_lost_costs_little_where_a_complete_crew_is_left() -> None:
    rng = np.random.default_rng(8)
    worlds = [generate(Spec(20, 60, 4, world=Grid(20, 20)), rng) for _ in range(12)]
    worlds = [replace(world, allocation="crews") for world in worlds]
    whole = run_trials(worlds, JoinCrew())
    short = []
    for world, tally in zip(worlds, whole, strict=True):
        gone, when = int(rng.integers(20)), int(rng.integers(1, tally.steps))
        robots = [
            replace(r, absences=(Absence(when),)) if i == gone else r
            for i, r in enumerate(world.robots)
        ]
        short.append(replace(world, robots=tuple(robots)))
    ended = run_trials(short, JoinCrew())
    assert {tally.status for tally in ended} == {"completed"}
    assert sum(t.steps for t in ended) < 1.25 * sum(t.steps for t in whole)
