"""What is different on a plane: straight ways, and places as wide as the arrival radius."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
import pytest

from coordinations import coordinator, play_by_plan
from random_worlds import random_decision, random_world
from teamformer.methods.central.plan_player import PlanPlayer
from teamformer.methods.coordinators.on_command import OnCommand
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.plane import Plane
from teamformer.world.env import Decision, TeamFormation
from teamformer.world.rules.constants import NOBODY

FIELD = Plane(10.0, 10.0)  # steps of a second, places 0.05 m wide


def field(
    starts: Sequence[Place],
    tasks: Sequence[tuple[Place, dict[str, int]]],
    plane: Plane = FIELD,
    speed: float = 1.0,
    **rules: float,
) -> Mission:
    """Robots r0, r1, ... that can a, b, ... each; tasks t0, t1, ..."""
    caps = tuple("abcdefgh"[: max(len(starts), 2)])
    return Mission(
        "field",
        plane,
        caps,
        tuple(Robot(f"r{r}", at, {caps[r]: 1}, speed) for r, at in enumerate(starts)),
        tuple(Task(f"t{k}", at, needs) for k, (at, needs) in enumerate(tasks)),
        **rules,  # type: ignore[arg-type]
    )


def maintain(env: TeamFormation) -> None:
    env.step(Decision(env.view().counts))


def decide(env: TeamFormation, wanted: list[list[int]]) -> None:
    env.view()
    env.step(Decision(np.array(wanted)))


def place(env: TeamFormation, slot: int) -> tuple[float, float]:
    team = env.worlds.teams[0, slot]
    return float(team["x"]), float(team["y"])


def test_a_way_is_straight_and_ends_exactly_at_the_task() -> None:
    """3 along and 4 up are 5 metres: five steps of 0.5 m/s times 2 s."""
    plane = Plane(10.0, 10.0, step=2.0)
    env = TeamFormation([field([(1.0, 1.0)], [((4.0, 5.0), {"a": 1})], plane, speed=0.5)])
    way = []
    while env.is_running[0]:
        maintain(env)
        way.append(place(env, 0))
    assert way == [(1.6, 1.8), (2.2, 2.6), (2.8, 3.4), (3.4, 4.2), (4.0, 5.0)]


def test_the_last_step_is_as_short_as_need_be() -> None:
    """r0 arrives and waits for r1, who is far away."""
    mission = field([(0.0, 0.0), (9.0, 0.0)], [((0.7, 0.0), {"a": 1, "b": 1})], speed=0.4)
    env, ways = TeamFormation([mission]), []
    for _ in range(3):
        maintain(env)
        ways.append(place(env, 0)[0])
    assert ways == [0.4, 0.7, 0.7]


def test_places_are_kept_to_a_micrometre() -> None:
    env = TeamFormation([field([(0.0, 0.0)], [((3.0, 3.0), {"a": 1})])])
    maintain(env)
    assert place(env, 0) == (0.707107, 0.707107)


def test_a_task_is_done_on_passing_within_the_arrival_radius() -> None:
    """On the way to t0 the robot is at (1, 0), 0.05 from t1 and 0.06 from t2."""
    tasks = [((2.0, 0.0), {"a": 1}), ((1.0, 0.05), {"a": 1}), ((1.06, 0.0), {"a": 1})]
    env = TeamFormation([field([(0.0, 0.0)], tasks)])
    env.worlds.teams["task"] = 0
    maintain(env)
    assert env.worlds.tasks["done_at"][0].tolist() == [NOBODY, 1, NOBODY]


def test_tasks_in_touching_places_are_done_together() -> None:
    tasks = [((2.0, 0.0), {"a": 1}), ((2.04, 0.0), {"a": 1}), ((2.08, 0.0), {"a": 1})]
    env = TeamFormation([field([(1.0, 0.0)], tasks)])
    maintain(env)
    assert env.worlds.tasks["done_at"][0].tolist() == [1, 1, NOBODY]


def test_a_union_stands_where_the_partner_is() -> None:
    env = TeamFormation([field([(1.0, 1.0), (1.03, 1.03)], [((5.0, 5.0), {"a": 1, "b": 1})])])
    assert env.view().is_here.tolist() == [[True], [True]]
    decide(env, [[1, 1], [0, 1]])  # r0 joins r1
    assert env.worlds.teams["size"][0].tolist() == [2, 0]
    assert place(env, 0) == (1.03, 1.03)


def test_a_union_stands_where_the_joiner_is_if_that_is_nearer_to_its_task() -> None:
    env = TeamFormation([field([(1.03, 1.03), (1.0, 1.0)], [((5.0, 5.0), {"a": 1, "b": 1})])])
    env.worlds.teams["task"][0] = 0
    decide(env, [[1, 1], [0, 1]])
    assert place(env, 0) == (1.03, 1.03)


def test_teams_farther_apart_than_the_arrival_radius_do_not_join() -> None:
    mission = field([(1.0, 1.0), (1.03, 1.05)], [((5.0, 5.0), {"a": 1, "b": 1})])
    env = TeamFormation([mission])
    view = env.view()
    assert view.seen_slot.tolist() == [[1], [0]]  # within the sensing radius
    assert view.is_here.tolist() == view.can_join.tolist() == [[False], [False]]
    decide(env, [[1, 1], [0, 1]])
    assert env.tally().illegal_decisions == 1


def test_a_joiner_walks_to_a_partner_within_the_join_radius() -> None:
    """The partner walks on along x; the joiner makes straight for where it is then."""
    mission = field(
        [(0.0, 1.0), (0.0, 0.0)], [((9.0, 0.0), {"b": 1})], sensing_radius=2, join_radius=2
    )
    env = TeamFormation([mission])
    decide(env, [[1, 1], [0, 1]])
    assert place(env, 1) == (1.0, 0.0)
    assert place(env, 0) == (0.707107, 0.292893)


def test_being_in_the_same_place_is_no_chain() -> None:
    """r0, r1 and r2 stand 0.04 apart in a row: r1 is with both, which are not with each other."""
    needs = {"a": 1, "b": 1, "c": 1}
    env = TeamFormation([field([(1.0, 1.0), (1.04, 1.0), (1.08, 1.0)], [((5.0, 5.0), needs)])])
    view = env.view()
    here = [set(view.seen_slot[row][view.is_here[row]].tolist()) for row in range(3)]
    assert here == [{1}, {0, 2}, {1}]
    decide(env, [[1, 1, 0], [0, 1, 1], [0, 1, 1]])  # r1 is joined by r0 first
    assert env.worlds.teams["size"][0].tolist() == [2, 0, 1]
    assert env.tally().joins == 1


def test_radii_below_the_arrival_radius_count_as_much() -> None:
    mission = field(
        [(1.0, 1.0), (1.04, 1.0)], [((5.0, 5.0), {"a": 1})], sensing_radius=0, join_radius=0
    )
    assert TeamFormation([mission]).view().can_join.tolist() == [[True], [True]]


def test_the_tour_is_straight() -> None:
    """From (0, 0) t1 is 1.4 away straight on, and t0 1.5; around corners t1 would be 2 away."""
    mission = field([(0.0, 0.0)], [((1.5, 0.0), {"a": 1}), ((1.0, 1.0), {"a": 1})])
    lengths = {
        order: sum(itertools.starmap(math.dist, itertools.pairwise([(0.0, 0.0), *order])))
        for order in itertools.permutations(task.at for task in mission.tasks)
    }
    best = min(lengths, key=lambda order: lengths[order])
    order = TeamFormation([mission]).worlds.order[0].tolist()
    assert tuple(mission.tasks[k].at for k in order) == best


def test_all_are_found_who_are_near() -> None:
    """Three hundred robots on planes of several shapes against a look at everybody."""
    rng = np.random.default_rng(0)
    for width, height, radius in ((8, 8, 0.5), (200, 0.5, 1.0), (3, 40, 0.2), (5, 5, 0.0)):
        places = rng.uniform((0, 0), (width, height), size=(300, 2)).round(3)
        places[::7] = places[::7].clip(0, (width / 3, height / 3))
        robots = tuple(Robot(f"r{r}", (x, y), {"a": 1}) for r, (x, y) in enumerate(places.tolist()))
        world, task = Plane(width, height), Task("t", (0.1, 0.1), {"a": 1})
        mission = Mission("crowd", world, ("a",), robots, (task,), sensing_radius=radius)
        view = TeamFormation([mission]).view()
        apart = np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1))  # (robots, robots)
        is_near = (apart <= max(radius, 0.05)) & ~np.eye(300, dtype=bool)
        assert is_near.sum() > 20
        seen = view.seen_slot != NOBODY
        assert (seen.sum(axis=1) == np.minimum(is_near.sum(axis=1), 16)).all()
        for row in np.flatnonzero(is_near.sum(axis=1) <= 16):
            near = np.flatnonzero(is_near[row]).tolist()
            assert sorted(view.seen_slot[row][seen[row]].tolist()) == near


def test_views_tell_the_lengths_that_matter() -> None:
    plane = Plane(10.0, 10.0, step=0.5, arrival_radius=0.1, unit=0.25)
    view = TeamFormation([field([(1.0, 2.0)], [((5.0, 5.0), {"a": 1})], plane, 0.8)]).view()
    assert view.place.tolist() == [[1.0, 2.0]]
    lengths = [float(column[0]) for column in (view.unit, view.arrival_radius, view.pace)]
    assert lengths == pytest.approx([0.25, 0.1, 0.4])


def two_sides_of_a_wide_place() -> Mission:
    """a . . T . . b on a plane, three metres each side of a task that is a metre wide all around.

    After five steps of 0.4 m both are there, two metres apart; who joins has to be within one.
    """
    wide = Plane(10.0, 10.0, arrival_radius=1.0)
    task = ((5.0, 5.0), {"a": 1, "b": 1})
    return field([(2.0, 5.0), (8.0, 5.0)], [task], wide, speed=0.4)


def test_the_shared_plan_has_nobody_join_who_is_out_of_reach() -> None:
    env = TeamFormation([two_sides_of_a_wide_place()], coordinator=SharedPlan())
    play_by_plan(env)
    tally = env.tally()
    assert (tally.status, tally.steps, tally.joins) == ("completed", 8, 1)  # near after seven
    assert tally.illegal_decisions == 0


def test_a_plan_that_is_played_has_nobody_join_who_is_out_of_reach() -> None:
    mission = two_sides_of_a_wide_place()
    env = TeamFormation([mission], coordinator=OnCommand())
    player = PlanPlayer(mission, [[0], [0]])
    while env.is_running[0]:
        env.view()
        env.step(player.decide_in(env))
    tally = env.tally()
    assert (tally.status, tally.steps, tally.joins) == ("completed", 8, 1)
    assert tally.illegal_decisions == 0


def test_a_batch_may_mix_planes_and_grids() -> None:
    from small_worlds import two_robots_one_task

    env = TeamFormation([two_robots_one_task(), field([(1.0, 1.0)], [((3.5, 1.0), {"a": 1})])])
    while env.is_running[1]:
        maintain(env)
    assert env.tally(1).steps == 3
    assert env.view().unit[0] == 1.0


CORNERED = pytest.mark.parametrize("side", [0.6, 0.9, 1.2, 1.8, 2.4, 3.6, 4.8])
"""With nine things on such a plane dividing by the width of a cell rounds otherwise than
multiplying by its inverse."""


@CORNERED
def test_a_team_in_the_far_corner_is_seen_there(side: float) -> None:
    """r0 stands in the corner, r1 within its reach, and all others far away."""
    starts = [(side, side), (side, side - 0.08), *[(0.0, 0.0)] * 4]
    tasks = [((0.1, 0.1), {"a": 1})] * 3
    plane = Plane(side, side)
    view = TeamFormation([field(starts, tasks, plane, sensing_radius=0.1)]).view()
    seen = {int(slot): set(view.seen_slot[row].tolist()) for row, slot in enumerate(view.slot)}
    assert 1 in seen[0]
    assert 0 in seen[1]


@CORNERED
def test_a_task_in_the_far_corner_is_done_there(side: float) -> None:
    corner = (side, side)
    tasks = [(corner, {"a": 1}), *[((0.1, 0.1), {"b": 1})] * 2]
    mission = field([corner] * 6, tasks, Plane(side, side), sensing_radius=0.1)
    env = TeamFormation([mission])
    maintain(env)
    assert env.worlds.tasks["done_at"][0, 0] == 1


@pytest.mark.parametrize("is_plane", [True, False], ids=["plane", "grid"])
def test_random_worlds_with_things_on_edges_stay_in_their_arrays(is_plane: bool) -> None:
    """Compiled code checks no index by itself; `make check` runs this where it does."""
    rng = np.random.default_rng(8)
    for coordination in ("paper", "crews"):
        worlds = [random_world(rng, is_plane=is_plane) for _ in range(60)]
        env = TeamFormation(worlds, coordinator=coordinator(coordination))
        for _ in range(30):
            view = env.view()
            for teams, world in zip(env.worlds.teams, worlds, strict=True):
                corner = world.world.corner
                there = teams[teams["size"] > 0]
                assert (there["x"] >= 0).all()
                assert (there["x"] <= corner[0] + 1e-6).all()
                assert (there["y"] >= 0).all()
                assert (there["y"] <= corner[1] + 1e-6).all()
            env.step(random_decision(view, rng))
