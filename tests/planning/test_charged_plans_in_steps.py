"""Plans in steps of robots with batteries: they are carried out as they say."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from coordinations import play_by_plan
from random_worlds import random_world, with_batteries
from small_worlds import done_at, make, robot, task
from teamformer.files.drawn.family_missions import WITH_BATTERY
from teamformer.files.drawn.named_settings import world_of
from teamformer.methods.coordinators.carried_out import best_carried_out, may_be_carried_out
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.mission.coordination import Plan, known_at_start
from teamformer.mission.model import Mission
from teamformer.mission.parts.charging import Battery, Charger
from teamformer.planning.problem.coalition_plan import plan_of_lists
from teamformer.planning.problem.prices import STEP
from teamformer.planning.step_times.timing import LATE
from teamformer.planning.steps.shared_plan import plan_mission
from teamformer.planning.steps.situation import situation_of
from teamformer.planning.steps.timed_plan import time_team_plan
from teamformer.world.env import TeamFormation


def test_the_plan_is_the_one_that_is_done_first_with_its_queues() -> None:
    """Either robot can do both tasks, alone, but both have to charge first, 24 steps, one by one.

    The first one is full in step 25, does one task in step 29, and the other in step 37. The
    second one is full in step 49, and could do the other in step 53.
    """
    mission = make([robot("a", 9), robot("a", 9)], [task("a", 12), task("a", 4)])
    own = tuple(replace(one, battery=Battery(24, 24, 1 / 24)) for one in mission.robots)
    charged = replace(mission, robots=own, chargers=(Charger((8, 0)),), step_limit=0)
    known = known_at_start(charged)
    assert may_be_carried_out(known)
    each, both = Plan((0, 1), ((0,), (1,)), ends=(3, 5)), Plan((0, 1), ((0,), (0,)), ends=(3, 11))
    assert best_carried_out(known, [each]) == replace(each, ends=(29, 53))
    assert best_carried_out(known, [each, both]) == replace(both, ends=(29, 37))
    assert best_carried_out(known, [both, each]) == replace(both, ends=(29, 37))


def test_who_has_to_charge_does_so_before_its_task_in_the_times_of_a_plan() -> None:
    """As above, one robot: at the charger in step 1, full in step 25, there in steps 29 and 37.

    One that starts at the charger gets to 12 and back with 8. With 6 it charges there, 18 steps.
    With 12 it has 8 at 12, which is too little for the way to 4 and back: it is at the charger in
    step 8, lacks 20, and is at 4 in step 32.
    """
    from_9 = make([robot("a", 9)], [task("a", 12), task("a", 4)])
    assert timed_ends(from_9, Battery(24, 24, 1 / 24)) == [29, 37]
    from_8 = make([robot("a", 8)], [task("a", 12), task("a", 4)])
    assert timed_ends(from_8, Battery(24, 24, 1 / 4)) == [22, 30]
    assert timed_ends(from_8, Battery(24, 24, 1 / 2)) == [4, 32]


def test_serving_takes_energy_in_the_times_of_a_plan() -> None:
    """The second task is 8 away, serving takes 3, and back to the charger it is 4: 15 in all.

    With 24 there are 17 left for it, with 21 only 14: then the robot is at the charger in step 11,
    lacks 11, and is at the task in step 26.
    """
    slow = make([robot("a", 8)], [task("a", 12, duration=3), task("a", 4, duration=3)])
    assert timed_ends(slow, Battery(24, 24, serving=1)) == [7, 18]
    assert timed_ends(slow, Battery(21, 21, serving=1)) == [7, 29]


def timed_ends(mission: Mission, battery: Battery) -> list[int]:
    """Return when a robot has done two tasks one after the other; there is a charger in cell 8."""
    own = (replace(mission.robots[0], battery=battery),)
    charged = replace(mission, robots=own, chargers=(Charger((8, 0)),), step_limit=0)
    plan = plan_of_lists([0, 1], [[0], [0]])
    return time_team_plan(situation_of(known_at_start(charged)), plan).ends[:2].tolist()


@pytest.mark.parametrize(("waiting", "is_dry"), [(0.5, False), (1.0, True)])
def test_a_plan_by_which_a_robot_runs_dry_is_worse_than_all_others(
    waiting: float, is_dry: bool
) -> None:
    """a is at the task in step 1, with 5 left, and waits until step 9 for b, which comes in 8."""
    mission = make([robot("a", 10), robot("a", 19)], [task("aa", 11)])
    charged = replace(
        mission,
        robots=(
            replace(mission.robots[0], battery=Battery(6, 6, waiting=waiting)),
            mission.robots[1],
        ),
        chargers=(Charger((10, 0)),),
        step_limit=0,
    )
    timed = time_team_plan(situation_of(known_at_start(charged)), plan_of_lists([0], [[0, 1]]))
    assert timed.ends[0] == 9
    assert timed.cost == STEP * (9 + LATE * is_dry)


@pytest.mark.parametrize("setting", ["sparse-charging", "real-charging"])
def test_without_queues_the_times_of_a_plan_are_those_that_are_played(setting: str) -> None:
    mission = with_room_for_all(world_of(setting, 501))
    plan = plan_mission(known_at_start(mission))
    assert best_carried_out(known_at_start(mission), [plan]).ends == plan.ends


def test_so_they_are_in_nearly_all_small_random_worlds() -> None:
    rng, same = np.random.default_rng(5), 0
    for number in range(12):
        mission = with_batteries(random_world(rng, False, False, number % 3 == 0), rng)
        known = known_at_start(with_room_for_all(mission))
        plan = plan_mission(known)
        same += best_carried_out(known, [plan]).ends == plan.ends
    assert same >= 11


def with_room_for_all(mission: Mission) -> Mission:
    chargers = tuple(replace(it, room=len(mission.robots)) for it in mission.chargers)
    return replace(mission, chargers=chargers)


def test_an_undisturbed_plan_is_carried_out_as_it_says() -> None:
    rng = np.random.default_rng(5)
    charges = 0
    for number in range(12):
        mission = with_batteries(random_world(rng, False, False, number % 3 == 0), rng)
        plan = SharedPlan().update(known_at_start(mission), None)
        env = TeamFormation([mission], coordinator=SharedPlan())
        charges += bool((env.worlds.robots["lasts"] > 0).any())
        play_by_plan(env)
        if env.tally().status == "completed":
            ends = done_at(env)
            assert tuple(ends[k] for k in plan.order) == plan.ends
    assert charges > 8


def test_most_robots_of_the_family_have_batteries_and_all_get_everywhere() -> None:
    worlds = [world_of(f"{name}-charging", 500) for name in ("sparse", "real", "warehouse")]
    robots = [it for mission in worlds for it in mission.robots]
    share = sum(it.battery is not None for it in robots) / len(robots)
    assert abs(share - WITH_BATTERY) < 0.15
    assert all(3 <= len(mission.chargers) <= 6 for mission in worlds)
