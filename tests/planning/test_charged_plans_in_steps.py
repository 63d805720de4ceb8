"""Plans in steps of robots with batteries: they are carried out as they say."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from coordinations import play_by_plan
from random_worlds import random_world, with_batteries
from small_worlds import done_at, make, robot, task
from teamformer.files.drawn.family_missions import WITH_BATTERY
from teamformer.files.drawn.named_settings import world_of
from teamformer.methods.coordinators.carried_out import best_carried_out, may_be_carried_out
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.mission.coordination import Plan, known_at_start
from teamformer.mission.parts.charging import Battery, Charger
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
