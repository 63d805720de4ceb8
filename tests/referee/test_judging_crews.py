"""The referee on records with crews: what is legal is left alone, and forged lists are found."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from random_worlds import random_decision, random_world
from small_worlds import make, robot, task
from teamformer.policies.scripted.joining import JoinAll, JoinCrew
from teamformer.referee import judge
from teamformer.referee.allocation.lists import CrewLists
from teamformer.referee.completion import Tasks
from teamformer.referee.lifecycle import start_fleet
from teamformer.referee.truth import Knowledge
from teamformer.referee.verdict import Notes
from teamformer.sim.env import Decision, TeamFormation
from teamformer.sim.replay.record import Crew, Ending, Replay, TeamAt
from teamformer.trials.recorder import Recorder
from teamformer.trials.trial import run_trial


def two_crews() -> Replay:
    """
    T . A . U     A has two robots that can do both tasks: each is a crew and has one of them
    """
    scenario = make([robot("a", 2), robot("a", 2)], [task("a", 0), task("a", 4)])
    return run_trial(replace(scenario, allocation="crews"), JoinCrew(), "join-crew").replay


def test_each_of_two_crews_does_the_task_on_its_list() -> None:
    replay = two_crews()
    assert judge(replay).findings == ()
    [(made, crews)] = replay.crews
    assert made == 0
    assert sorted(crew.tasks for crew in crews) == [(0,), (1,)]
    assert replay.end.makespan == 2


def swap_lists(replay: Replay) -> Replay:
    [(made, (one, other))] = replay.crews
    swapped = (Crew(one.robots, other.tasks), Crew(other.robots, one.tasks))
    return replace(replay, crews=((made, swapped),))


def leave_a_robot_out(replay: Replay) -> Replay:
    [(made, (one, other))] = replay.crews
    return replace(replay, crews=((made, (Crew((), one.tasks), other)),))


def leave_a_task_out(replay: Replay) -> Replay:
    [(made, (one, other))] = replay.crews
    return replace(replay, crews=((made, (Crew(one.robots, ()), other)),))


def send_nowhere(replay: Replay) -> Replay:
    first = replay.steps[0]
    teams = (TeamAt(*first.teams[0][:3], None), *first.teams[1:])
    return replace(replay, steps=(replace(first, teams=teams), *replay.steps[1:]))


@pytest.mark.parametrize(
    ("forge", "message"),
    [
        (swap_lists, "by its crew's list it is task"),
        (leave_a_robot_out, "the crews made after 0 steps are not of all robots left, each in one"),
        (leave_a_task_out, "the crews made after 0 steps do not share out the open tasks"),
        (send_nowhere, "heads for nothing; by its crew's list it is task"),
        (lambda replay: replace(replay, crews=()), "there are no crews from after 0 steps"),
    ],
)
def test_a_forged_record_is_found(forge: Callable[[Replay], Replay], message: str) -> None:
    assert any(message in finding.message for finding in judge(forge(two_crews())).findings)


def test_a_list_must_be_one_that_its_robots_can_do() -> None:
    scenario = make([robot("a", 0), robot("b", 0)], [task("a", 2), task("ab", 4)])
    replay = run_trial(replace(scenario, allocation="crews"), JoinCrew(), "join-crew").replay
    [(made, [crew])] = replay.crews
    forged = (Crew((0,), crew.tasks), Crew((1,), ()))
    [finding] = [f for f in judge(replace(replay, crews=((made, forged),))).findings if not f.step]
    assert "have task" in finding.message
    assert "on the list of one that cannot do it" in finding.message


def test_legal_records_are_left_alone() -> None:
    """Random worlds with losses and late tasks, under policies and under random decisions."""
    rng = np.random.default_rng(5)
    for number in range(120):
        world = replace(random_world(rng, is_plane=number % 4 == 0), allocation="crews")
        if number % 3:
            replay = run_trial(world, JoinCrew() if number % 2 else JoinAll(), "any").replay
        else:
            replay = random_trial(world, rng)
        assert judge(replay).findings == ()


def random_trial(world, rng: np.random.Generator) -> Replay:  # type: ignore[no-untyped-def]
    """Play at random, and now and then name a task."""
    env = TeamFormation([world])
    recorder = Recorder(env)
    while env.is_running[0]:
        view = env.view()
        named = np.where(rng.random(len(view.slot)) < 0.1, view.task_number[:, 0], -1)
        env.step(Decision(random_decision(view, rng).wanted, named))
        recorder.step()
    return recorder.finish("random", 0, None)


def crossed() -> Replay:
    """
    T . A . U     two robots that can do both; U comes first in the order and is on r0's list
    """
    scenario = make([robot("a", 2), robot("a", 2)], [task("a", 0), task("a", 4)], teams=((0, 1),))
    scenario = replace(scenario, allocation="crews")
    crews = (Crew((0,), (1,)), Crew((1,), (0,)))
    start = ((0, (0, 1), 2, 0),)
    end = Ending("interrupted", None, 1, 0, 0, 0, 0)
    orders = ((0, (1, 0)),)
    return Replay(scenario, "by hand", 0, orders, start, (), end, crews=((0, crews),))


def test_a_team_of_two_crews_is_due_at_the_task_that_comes_first_in_the_order() -> None:
    """Not at the one with the lower number, nor at the one of its lowest robot's crew alone."""
    for order, due in (((1, 0), 1), ((0, 1), 0)):
        replay = replace(crossed(), orders=((0, order),))
        fleet = start_fleet(replay, Notes())
        CrewLists(replay, Knowledge(replay.scenario)).give_tasks(fleet, Tasks(replay.scenario), 0)
        assert fleet.teams[0].due == due


def test_a_union_made_on_the_way_is_due_at_the_earlier_task_if_both_have_one() -> None:
    for order, due in (((1, 0), 1), ((0, 1), 0)):
        replay = replace(crossed(), orders=((0, order),), start=((0, (0,), 2, 0), (1, (1,), 2, 0)))
        apart = replace(replay.scenario, teams=())
        replay = replace(replay, scenario=apart)
        lists, fleet = CrewLists(replay, Knowledge(replay.scenario)), start_fleet(replay, Notes())
        lists.give_tasks(fleet, Tasks(apart), 0)
        assert [fleet.teams[slot].due for slot in (0, 1)] == [1, 0]
        assert lists.tasks_of_unions(fleet, [(0, 1)]) == {frozenset({0, 1}): due}
        fleet.teams[1].due = None
        assert lists.tasks_of_unions(fleet, [(0, 1)]) == {frozenset({0, 1}): None}


def test_a_list_is_in_the_shared_order() -> None:
    replay = two_crews()
    [(made, (one, other))] = replay.crews
    both = (Crew(one.robots, (0, 1)), Crew(other.robots, ()))
    for order, is_told in (((0, 1), False), ((1, 0), True)):
        forged = replace(replay, crews=((made, both),), orders=((0, order),))
        told = [finding.message for finding in judge(forged).findings]
        assert ("the crews made after 0 steps have a list that is not in order" in told) == is_told
