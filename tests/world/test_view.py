"""Views: what is in them, in which order, and what never is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from random_worlds import random_world
from small_worlds import make, play, robot, service, task, two_apart, two_tasks_two_pairs
from teamformer.methods.scripted.joining import JoinAll
from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.parts.grid import Grid, Place
from teamformer.world.env import TeamFormation
from teamformer.world.rules.constants import NOBODY
from teamformer.world.view import NEAREST_TEAMS, NEXT_TASKS, View


def snapshot(view: View) -> dict[str, list[object]]:
    return {name: getattr(view, name).tolist() for name in View._fields}


def test_a_view_by_hand() -> None:
    """a at 0 and b at 2 see each other; both head for T after the first step."""
    env = TeamFormation([two_apart(join_radius=1.0)])
    play(env)
    view = env.view()
    assert view.world.tolist() == [0, 0]
    assert view.slot.tolist() == [0, 1]
    assert view.place.tolist() == [[1, 0], [3, 0]]
    assert view.counts.tolist() == [[1, 0, 0], [0, 1, 0]]
    assert view.size.tolist() == [1, 1]
    assert view.task.tolist() == [0, 0]
    assert view.seen_slot.tolist() == [[1], [0]]
    assert view.seen_place.tolist() == [[[3, 0]], [[1, 0]]]
    assert view.seen_counts.tolist() == [[[0, 1, 0]], [[1, 0, 0]]]
    assert view.seen_task.tolist() == [[0], [0]]
    assert not view.is_here.any()
    assert not view.can_join.any()  # sensed at 2 cells, joined only within 1
    assert view.task_number.tolist() == [[0], [0]]
    assert view.task_place.tolist() == [[[9, 0]], [[9, 0]]]
    assert view.task_needs.tolist() == [[[1, 1, 0]], [[1, 1, 0]]]
    assert view.task_rank.tolist() == [[0], [0]]


def test_nobody_beyond_the_sensing_radius_is_seen() -> None:
    env = TeamFormation([two_apart(sensing_radius=1.99, join_radius=0)])
    view = env.view()
    assert (view.seen_slot == NOBODY).all()
    assert (
        TeamFormation([two_apart(sensing_radius=2.0, join_radius=0)]).view().seen_slot >= 0
    ).all()


def test_members_come_in_robot_order_team_by_team() -> None:
    robots = [robot(can, 0) for can in ("a", "bb", "c", "ac")]
    view = TeamFormation([make(robots, [task("c", 5)], teams=((1, 3), (0, 2)))]).view()
    assert view.slot.tolist() == [0, 1]
    assert view.first_member.tolist() == [0, 2, 4]
    assert view.member.tolist() == [0, 2, 1, 3]
    assert view.member_counts.tolist() == [[1, 0, 0], [0, 0, 1], [0, 2, 0], [1, 0, 1]]


def test_only_the_nearest_are_seen() -> None:
    """Twenty in a row, one a cell; of two equally far the lower slot comes first."""
    robots = [robot("a", x) for x in range(20)]
    view = TeamFormation([make(robots, [task("a", 9)], sensing_radius=np.inf)]).view()
    assert view.seen_slot.shape == (20, NEAREST_TEAMS)
    assert view.seen_slot[0].tolist() == list(range(1, 17))
    assert view.seen_slot[10].tolist() == [9, 11, 8, 12, 7, 13, 6, 14, 5, 15, 4, 16, 3, 17, 2, 18]
    assert view.seen_place[10, :3, 0].tolist() == [9, 11, 8]


def test_of_those_in_one_place_who_helps_comes_first_then_the_nearest_slots() -> None:
    """3 has the a and its task needs two b more: 1 and 5 bring them."""
    robots = [robot(can, 0) for can in "abaaab"]
    env = TeamFormation([make(robots, [task("abb", 9)])])
    assert env.view().seen_slot[3].tolist() == [2, 4, 1, 5, 0]  # no task yet: by slot alone
    play(env)
    assert env.view().seen_slot[3].tolist() == [1, 5, 2, 4, 0]


def test_a_helper_in_a_crowd_is_seen() -> None:
    """0 needs the b of slot 20, with 19 others in the same cell in between."""
    robots = [robot("a", 0) for _ in range(20)] + [robot("b", 0)]
    env = TeamFormation([make(robots, [task("ab", 5)])])
    assert 20 not in env.view().seen_slot[0]
    play(env)
    view = env.view()
    assert view.task[0] == 0
    assert view.seen_slot[0, :3].tolist() == [20, 1, 2]


def test_the_own_task_comes_first_then_the_order() -> None:
    env = TeamFormation([two_tasks_two_pairs()])
    assert env.view().task_number.tolist() == [[0, 1]] * 4
    play(env)
    view = env.view()
    assert view.task.tolist() == [0, 0, 1, 1]
    assert view.task_number.tolist() == [[0, 1], [0, 1], [1, 0], [1, 0]]
    assert view.task_rank.tolist() == [[0, 1], [0, 1], [1, 0], [1, 0]]


def test_only_the_next_tasks_are_seen_but_always_the_own_one() -> None:
    """Twenty tasks in a row; only the last needs b."""
    tasks = [task("a", x) for x in range(19)] + [task("b", 19)]
    robots = [robot("a", 0, speed=0.1), robot("b", 0, speed=0.1)]
    env = TeamFormation([make(robots, tasks)])
    assert env.view().task_number[1].tolist() == list(range(NEXT_TASKS))
    play(env)  # a does the task where it stands
    view = env.view()
    assert view.task_number[1].tolist() == [19, *range(1, NEXT_TASKS)]
    assert view.task_rank[1].tolist() == [18, *range(NEXT_TASKS - 1)]


def test_what_is_missing_is_padded() -> None:
    """A small world beside a large one: NOBODY and zeros fill its rows up."""
    small = make([robot("a", 0), robot("b", 0)], [task("ab", 5)])
    large = make([robot("a", x) for x in range(5)], [task("a", x) for x in range(3)])
    env = TeamFormation([large, small])
    play(env, 2)  # fills the rows with other things before
    view = env.view()
    row = int(np.flatnonzero(view.world == 1)[0])
    assert view.seen_slot[row].tolist() == [1, NOBODY, NOBODY, NOBODY]
    assert view.seen_task[row, 1:].tolist() == [NOBODY] * 3
    assert not view.seen_place[row, 1:].any()
    assert not view.seen_counts[row, 1:].any()
    assert not view.is_here[row, 1:].any()
    assert not view.can_join[row, 1:].any()
    assert view.task_number[row].tolist() == [0, NOBODY, NOBODY]
    assert not view.task_place[row, 1:].any()
    assert not view.task_needs[row, 1:].any()
    assert not view.task_rank[row, 1:].any()


def test_worlds_that_are_over_have_no_rows() -> None:
    env = TeamFormation([make([robot("a", 0)], [task("a", 1)]), two_tasks_two_pairs()])
    assert env.view().world.tolist() == [0, 1, 1, 1, 1]
    play(env)
    assert env.view().world.tolist() == [1, 1, 1, 1]


def test_standing_at_the_task_and_serving_it() -> None:
    env = TeamFormation([service(duration=2)])
    assert not env.view().is_at_task.any()
    play(env)
    view = env.view()
    assert view.is_at_task.tolist() == [True]
    assert view.is_serving.tolist() == [True]


def test_nobody_can_join_who_serves() -> None:
    robots = [robot("a", 1), robot("b", 1), robot("c", 1)]
    tasks = [task("ab", 1, duration=5), task("abc", 1)]
    env = TeamFormation([make(robots, tasks, teams=((0, 1),))])
    assert env.view().can_join.any()
    play(env)
    view = env.view()
    assert view.is_here.tolist() == [[True, False], [True, False]]
    assert not view.can_join.any()


def with_another_future(mission: Mission) -> Mission:
    """Change what late tasks are and where, who is lost and back when; not before step 10."""

    def change_task(one: Task) -> Task:
        if one.appears < 10:
            return one
        needs = dict.fromkeys(mission.robots[0].can, 1)
        return replace(one, at=mission.robots[0].at, needs=needs, appears=15)

    def change_robot(one: Robot) -> Robot:
        been = tuple(away for away in one.absences if away.lost < 10)
        if been and (been[-1].back or 0) >= 10:
            return replace(one, absences=(*been[:-1], replace(been[-1], back=been[-1].back + 5)))
        is_sure = been and been[-1].back is None
        return replace(one, absences=been if is_sure or not one.absences else (*been, Absence(29)))

    return replace(
        mission,
        robots=tuple(change_robot(one) for one in mission.robots),
        tasks=tuple(change_task(one) for one in mission.tasks),
    )


def test_the_future_cannot_be_seen() -> None:
    """Ten steps of views are the same whatever appears or is lost later."""
    rng = np.random.default_rng(6)
    changed = 0
    for _ in range(60):
        mission = random_world(rng)
        other = with_another_future(mission)
        changed += other != mission
        one, two, policy = TeamFormation([mission]), TeamFormation([other]), JoinAll()
        for _ in range(9):
            if not (one.is_running[0] and two.is_running[0]):
                break
            views = one.view(), two.view()
            assert snapshot(views[0]) == snapshot(views[1])
            for env, view in zip((one, two), views, strict=True):
                env.step(policy.decide(view))
    assert changed > 20


def test_a_task_is_seen_when_it_appears() -> None:
    env = TeamFormation([make([robot("a", 0)], [task("a", 9), task("a", 19, appears=2)])])
    seen = []
    for _ in range(4):
        seen.append(sorted(env.view().task_number[0].tolist()))
        play(env)
    assert seen == [[-1, 0], [-1, 0], [0, 1], [0, 1]]


@pytest.mark.parametrize("radius", [0, 1, 1.5, 2.5, np.inf])
def test_few_and_many_teams_are_found_alike(radius: float) -> None:
    """Looking through cells and looking through teams give what plain distances give."""
    rng = np.random.default_rng(8)
    for count in (3, 60):
        cells: list[Place] = [(int(x), int(y)) for x, y in rng.integers(0, 6, size=(count, 2))]
        robots = [robot("a", x, y) for x, y in cells]
        mission = make(robots, [task("a", 0)], Grid(6, 6), sensing_radius=radius)
        view = TeamFormation([mission]).view()
        at = np.array(cells)
        away = ((at[:, None] - at) ** 2).sum(axis=2)  # (robots, robots)
        near = away <= radius * radius
        np.fill_diagonal(near, val=False)
        seen = np.minimum(near.sum(axis=1), NEAREST_TEAMS)
        assert (view.seen_slot != NOBODY).sum(axis=1).tolist() == seen.tolist()
        for team in range(count):
            slots = view.seen_slot[team][: seen[team]]
            assert near[team, slots].all()
            nearest = np.sort(away[team][near[team]])[: seen[team]]
            assert away[team, slots].tolist() == nearest.tolist()


def test_in_a_crowd_who_helps_with_the_same_task_is_seen() -> None:
    """Forty helpful teams head elsewhere; the one for the same task has the last slot."""
    robots = [robot("a", 0), *(robot("b", 0) for _ in range(41))]
    env = TeamFormation([make(robots, [task("ab", 5), task("b", 9)])])
    teams = env.worlds.teams[0]
    teams["task"][0] = teams["task"][41] = 0
    teams["task"][1:41] = 1
    seen = env.view().seen_slot[0].tolist()
    assert seen[:3] == [41, 1, 2]
    assert len(seen) == 16
