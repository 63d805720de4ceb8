"""Robots with batteries in missions in steps: by hand, and kernels beside plain rules."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from coordinations import RandomPlans
from random_worlds import (
    random_decision,
    random_world,
    with_batteries,
    with_loads,
    with_shifts,
    with_surprises,
)
from small_worlds import done_at, make, places, play, robot, task
from teamformer.base.errors import MissionError
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.mission.model import Mission
from teamformer.mission.parts.charging import Battery, Charger
from teamformer.mission.truth import draw_truth
from teamformer.world.env import TeamFormation
from twins import Twin


def charged(mission: Mission, battery: Battery, *chargers: Charger) -> Mission:
    """Return a mission whose robots have a battery."""
    robots = tuple(replace(one, battery=battery) for one in mission.robots)
    return replace(mission, robots=robots, chargers=chargers, step_limit=0)


def seen(mission: Mission, steps: int) -> tuple[list[int], list[float]]:
    """Return where the team of the first robot is after each step, and what that robot has left."""
    env, at, left = TeamFormation([mission]), list[int](), list[float]()
    for _ in range(steps):
        play(env)
        at.append(places(env)[0])
        left.append(float(env.worlds.robots["left"][0, 0]))
    return at, left


def test_a_robot_charges_before_what_it_could_not_do_and_get_away_from() -> None:
    """It has 6, and wants 9 for the way and 5 to get back to the charger at 4.

    It comes there with 2 and charges 3 a step, so it goes on after four steps, full.
    """
    way = make([robot("a", 0)], [task("a", 9, duration=2)])
    at, left = seen(charged(way, Battery(15, 5, 0.4), Charger((4, 0))), 15)
    assert at == [1, 2, 3, 4, 4, 4, 4, 4, 4, 5, 6, 7, 8, 9, 9]
    assert left == [5, 4, 3, 2, 5, 8, 11, 14, 15, 14, 13, 12, 11, 10, 10]
    enough = charged(way, Battery(15, 5, 14 / 15), Charger((4, 0)))
    assert seen(enough, 3) == ([1, 2, 3], [13, 12, 11])


def test_service_takes_what_the_battery_says_and_counts_beforehand() -> None:
    """Nine there, two for four steps of service, five back: 16 of 16 just do."""
    way = make([robot("a", 0)], [task("a", 9, duration=4)])
    env = TeamFormation([charged(way, Battery(16, 0, serving=0.5), Charger((4, 0)))])
    play(env, 13)
    assert done_at(env) == [13]
    assert env.worlds.robots["left"][0, 0] == 5
    short = charged(way, Battery(16, 0, starts=0.99, serving=0.5), Charger((4, 0)))
    assert seen(short, 6)[0] == [1, 2, 3, 4, 4, 5]  # it is full after one step


def test_a_robot_charges_before_another_task_where_it_stands() -> None:
    """There at 5 with 10, it has 4 left at 11, and wants 6 and one to the charger.

    It is there at 12, charges 3 a step for four steps, and is back at 17.
    """
    bay = make([robot("a", 0)], [task("a", 5, duration=6), task("a", 5, duration=6)])
    tasks = (bay.tasks[0], replace(bay.tasks[1], after=(bay.tasks[0].name,)))
    bay = charged(replace(bay, tasks=tasks), Battery(15, 5, serving=1), Charger((4, 0)))
    env = TeamFormation([bay])
    play(env, 30)
    assert done_at(env) == [11, 23]


def test_who_walks_with_slower_ones_takes_what_it_takes_alone() -> None:
    pair = make([robot("a", 0), robot("a", 0, speed=0.5)], [task("aa", 6)], teams=((0, 1),))
    env = TeamFormation([charged(pair, Battery(20, 0), Charger((6, 0)))])
    play(env, 12)
    assert done_at(env) == [12]
    assert env.worlds.robots["left"][0].tolist() == [14, 8]


def test_a_team_charges_until_all_are_full_one_after_the_other() -> None:
    """Each takes three steps, and there is room for one."""
    pair = make([robot("a", 0), robot("b", 0)], [task("ab", 9)], teams=((0, 1),))
    queue = charged(pair, Battery(15, 5, 0.4), Charger((3, 0)))
    assert seen(queue, 13)[0] == [1, 2, 3, *[3] * 8, 4, 5]
    room = replace(queue, chargers=(Charger((3, 0), 2),))
    assert seen(room, 9)[0] == [1, 2, 3, *[3] * 4, 4, 5]


def test_who_comes_first_charges_first() -> None:
    """The robot at 2 is a step sooner at 5 than that at 0, which therefore waits."""
    both = make([robot("b", 9), robot("a", 2)], [task("b", 0), task("a", 12)])
    env = TeamFormation([charged(both, Battery(20, 10, 0.25), Charger((5, 0)))])
    play(env, 3)
    assert env.worlds.robots["left"][0].tolist() == [2, 2]
    play(env, 2)
    assert env.worlds.robots["charges"][0].tolist() == [False, True]
    play(env, 7)
    assert env.worlds.robots["left"][0].tolist() == [1, 20]
    play(env)
    assert env.worlds.robots["left"][0].tolist() == [3, 19]


def test_who_waits_too_long_stands_still_for_good() -> None:
    """It waits for the other from step 5 on, and has five left: dry in the sixth step."""
    pair = make([robot("a", 0), robot("b", 19)], [task("ab", 5)])
    way = replace(pair, robots=(pair.robots[0], replace(pair.robots[1], speed=0.1)))
    battery = Battery(15, 0, starts=10 / 15, waiting=1)
    own = replace(way.robots[0], battery=battery)
    mission = replace(way, robots=(own, way.robots[1]), chargers=(Charger((0, 0)),), step_limit=0)
    env = TeamFormation([mission])
    play(env, 10)
    assert env.worlds.robots["left"][0, 0] == 0
    assert env.is_running[0]
    play(env)
    assert env.tally().status == "infeasible"


def test_nothing_is_begun_in_passing_after_which_no_charger_is_in_reach() -> None:
    """It passes 2 with 6.4: enough for the way to the charger at 8, where its task is.

    Five steps of service at 2 take 4.5, and 2 to the charger at 0.
    """
    way = make([robot("a", 0)], [task("a", 8), task("a", 2, duration=5)])
    mission = charged(
        way, Battery(10.5, 1, starts=0.8, serving=0.9), Charger((8, 0)), Charger((0, 0))
    )
    env = TeamFormation([mission], coordinator=SharedPlan())
    first = replace(env.plan(), order=(0, 1), coalitions=((0,), (0,)))
    env.take_over_plan(first)
    while env.is_running[0]:
        env.step(env.planned_decision(env.view()))
    assert env.tally().status == "completed"
    ends = done_at(env)
    assert ends[0] == 8
    assert ends[1] is not None
    assert ends[1] > 8


@pytest.mark.parametrize("is_plane", [False, True], ids=["grid", "plane"])
def test_step_with_batteries_is_what_the_plain_twin_does(is_plane: bool) -> None:
    rng = np.random.default_rng(31 + is_plane)
    charges = queues = dry = done = 0
    for number in range(100):
        try:
            mission = random_world(rng, is_plane=is_plane)
            if number % 2:
                mission = with_surprises(mission, rng)
            if number % 3 == 0:
                mission = with_loads(mission, rng)
            if number % 5 == 0:
                mission = with_shifts(mission, rng)
            mission = with_batteries(mission, rng)
            truth = draw_truth(mission, number)
        except MissionError:  # no common shift is long enough, or no charger in some part
            continue
        coordinator = [None, RandomPlans(number), RandomPlans(number), SharedPlan()][number % 4]
        env = TeamFormation([mission], truths=[truth], coordinator=coordinator)
        twin = Twin(env)
        while env.is_running[0] and env.tally().steps < 80:
            view = env.view()
            is_planned = coordinator is not None and rng.random() < 0.8
            decision = env.planned_decision(view) if is_planned else random_decision(view, rng)
            twin.step(view, decision)
            charges += len(twin.world.charging)
            queues += len(twin.world.queued.keys() - twin.world.charging)
        dry += len(twin.world.dry)
        done += env.tally().tasks_done
    assert charges > 100
    assert queues > 20
    assert done > 100
    assert dry > 0
