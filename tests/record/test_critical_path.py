"""Critical paths: by hand in small missions, and what holds for the path of any mission."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

import teamformer as tf
from random_worlds import random_world, with_loads, with_precedence_and_windows, with_surprises
from small_worlds import make, robot, task
from teamformer.methods.by_name import load_method
from teamformer.mission.model import Absence, Mission, Task
from teamformer.planning.continuous.continuous_mission import pose_mission
from teamformer.planning.continuous.rules import plan_continuous
from teamformer.planning.problem.routes import MissionPlan
from teamformer.record.critical_path.stretches import Stretch, path_rows
from teamformer.record.critical_path.words import why_so_late
from teamformer.record.export.moments import moments
from teamformer.record.phases import AT_WORK
from teamformer.record.record import Record
from teamformer.record.telling.whole import path_of_record
from teamformer.trials.continuous_trial import carry_out
from teamformer.trials.trial import run_trial
from teamformer.world.rules.constants import NOBODY


def played(mission: Mission, method: str = "plan", seed: int = 0) -> Record:
    return run_trial(mission, load_method(method), seed).record


def planned(mission: Mission) -> MissionPlan:
    made = plan_continuous(pose_mission(mission), "plan", 0.1)
    assert made is not None
    return made


def path_of_plan(mission: Mission) -> tuple[Stretch, ...]:
    return path_of_record(carry_out(mission, planned(mission), "plan"))


def told(path: tuple[Stretch, ...]) -> list[tuple[Any, ...]]:
    return [(s.begin, s.end, s.doing, s.robot, s.task) for s in path]


def test_the_path_leads_over_who_comes_last() -> None:
    """Robot a is at the task after 2 steps and waits; b takes 9, then they form and serve 3."""
    mission = make([robot("a", 0), robot("b", 11)], [task("ab", 2, duration=3)])
    assert told(path_of_record(played(mission))) == [
        (0, 9, "walking", 1, 0),
        (9, 10, "forming", 1, 0),
        (10, 13, "serving", 1, 0),
    ]


def test_who_takes_up_a_load_where_it_waited_for_it_has_not_walked() -> None:
    """The robot is there after 2 steps, takes the load up in the sixth, and carries it for 2."""
    load = replace(task("a", 0), to=(2, 0), between=(5, 50))
    mission = make([robot("a", 2)], [load])
    assert told(path_of_record(played(mission)))[1:] == [
        (5, 6, "waiting", 0, 0),
        (6, 8, "carrying", 0, 0),
    ]


def test_the_path_goes_back_through_tasks() -> None:
    """Robot a does t0 in 4 steps and 2 of work; b waits for it at t1, 6 on, where they form."""
    mission = make([robot("a", 0), robot("b", 10)], [task("a", 4, duration=2), task("ab", 10)])
    assert told(path_of_record(played(mission))) == [
        (0, 4, "walking", 0, 0),
        (4, 6, "serving", 0, 0),
        (6, 12, "walking", 0, 1),
        (12, 13, "forming", 0, 1),
    ]


def test_where_robots_wait_for_a_task_to_become_known_the_path_ends() -> None:
    """The robot stands where t1 appears after 20 steps, and does it in the next one."""
    mission = make([robot("a", 0)], [task("a", 5), task("a", 5, appears=20)])
    assert told(path_of_record(played(mission))) == [
        (0, 20, "unknown", NOBODY, 1),
        (20, 21, "waiting", 0, 1),
    ]


def test_the_path_goes_on_with_the_task_that_another_is_after() -> None:
    """Robot b is at t1 after 2 steps, which may begin when a has done t0: 6 steps and 3 of work."""
    mission = make([robot("a", 0), robot("b", 10)], [task("a", 6, duration=3), task("b", 12)])
    mission = replace(mission, tasks=(mission.tasks[0], replace(mission.tasks[1], after=("t0",))))
    path = told(path_of_record(played(mission)))
    assert path[:2] == [(0, 6, "walking", 0, 0), (6, 9, "serving", 0, 0)]
    assert [row[1] for row in path[2:]][-1] == played(mission).end.makespan
    assert {row[3] for row in path[2:]} == {1}


def load(caps: str, x: int, to: int, duration: int, unload: int) -> Task:
    return replace(task(caps, x, duration=duration), to=(to, 0), unload=unload)


def test_a_load_is_loaded_carried_and_unloaded() -> None:
    """Robot a is there after 3 steps, takes 2 to load, 5 to the goal and 4 to unload."""
    mission = make([robot("a", 0)], [load("a", 3, to=8, duration=2, unload=4)])
    path = path_of_record(played(mission))
    assert told(path) == [
        (0, 3, "walking", 0, 0),
        (3, 5, "loading", 0, 0),
        (5, 10, "carrying", 0, 0),
        (10, 14, "unloading", 0, 0),
    ]
    assert why_so_late(mission, path) == [
        "why so late: 14 steps are 3 walking, 2 loading, 5 carrying, 4 unloading",
        "  0-14: t0: r0 walks 3, loads 2, carries 5, unloads 4",
    ]
    timed = continuous(mission)
    assert told(path_of_plan(timed)) == told(path)


def test_who_came_last_to_a_load_is_named_until_it_is_unloaded() -> None:
    """r1 walks 7 to where r0 waits; together they load for 2, carry it 5 and unload it for 1."""
    mission = make([robot("a", 0), robot("b", 10)], [load("ab", 3, to=8, duration=2, unload=1)])
    assert told(path_of_record(played(mission))) == [
        (0, 7, "walking", 1, 0),
        (7, 8, "forming", 1, 0),
        (8, 10, "loading", 1, 0),
        (10, 15, "carrying", 1, 0),
        (15, 16, "unloading", 1, 0),
    ]


def test_after_a_load_is_set_down_the_path_leads_over_who_carried_it() -> None:
    """r0 carries the load from 3 on and is lost in step 8; r1, far off, fetches it and brings it.

    It lies at 7, where r0 was after 4 steps with it; r1 walks 12 there and 8 on to the goal.
    """
    mission = make([robot("a", 0, lost=8), robot("a", 19)], [load("a", 3, 15, 1, 0)])
    record = played(mission)
    path = told(path_of_record(record))
    down = next(n for n, step in enumerate(record.steps, start=1) if step.left)
    at = record.steps[down - 1].left[0].x
    assert path[:3] == [
        (0, 3, "walking", 0, 0),
        (3, 4, "loading", 0, 0),
        (4, down - 1, "carrying", 0, 0),
    ]
    walked = int(19 - at)
    assert path[3:] == [
        (down - 1, down, "lost", 0, NOBODY),
        (down, down + walked, "walking", 1, 0),
        (down + walked, down + walked + 1, "loading", 1, 0),
        (down + walked + 1, down + walked + 1 + int(15 - at), "carrying", 1, 0),
    ]


def test_a_window_that_opens_late_is_the_reason() -> None:
    mission = make([robot("a", 0)], [task("a", 3)])
    mission = replace(mission, tasks=(replace(mission.tasks[0], between=(10, 20)),))
    path = told(path_of_record(played(mission)))
    assert path[0] == (0, 10, "closed", NOBODY, 0)


def test_who_was_lost_holds_up_the_others() -> None:
    """Both are needed; b walks 3 of its 9 cells, is lost in step 3 and there again in step 12."""
    away = replace(robot("b", 11), absences=(Absence(3, 12),))
    mission = make([robot("a", 0), away], [task("ab", 2)])
    mission = replace(mission, robots=(mission.robots[0], replace(away, name="r1")))
    path = told(path_of_record(played(mission)))
    assert (2, 12, "lost", 1, NOBODY) in path
    assert path[-2:] == [(12, 18, "walking", 1, 0), (18, 19, "forming", 1, 0)]


def test_there_is_no_path_to_an_end_that_was_not_reached() -> None:
    mission = make([robot("a", 0, lost=2)], [task("a", 5)])
    assert path_of_record(played(mission)) == ()
    assert why_so_late(mission, ()) == []


def test_in_words_and_rows() -> None:
    mission = make([robot("a", 0), robot("b", 10)], [task("a", 4, duration=2), task("ab", 10)])
    path = path_of_record(played(mission))
    assert why_so_late(mission, path) == [
        "why so late: 13 steps are 10 walking, 1 forming, 2 serving",
        "  0-6: t0: r0 walks 4, serves 2",
        "  6-13: t1: r0 walks 6, forms a team 1",
    ]
    assert path_rows(mission, path)[0] == {
        "from": 0,
        "to": 4,
        "doing": "walking",
        "robot": "r0",
        "task": "t0",
    }


def continuous(mission: Mission, **rules: Any) -> Mission:
    return replace(mission, time="continuous", **rules)


def test_in_continuous_time_the_last_to_arrive_counts_and_the_way_home() -> None:
    """Robot b takes 9 at half speed: 18, then 2.5 to form and 3 of work, and 18 back."""
    mission = make([robot("a", 0), robot("b", 11, speed=0.5)], [task("ab", 2, duration=3)])
    mission = continuous(mission, forming=2.5, ends="home")
    assert told(path_of_plan(mission)) == [
        (0, 18, "walking", 1, 0),
        (18, 20.5, "forming", 1, 0),
        (20.5, 23.5, "serving", 1, 0),
        (23.5, 41.5, "walking", 1, NOBODY),
    ]


@pytest.mark.parametrize(
    ("second", "path"),
    [
        ({"after": ("t0",)}, [(0, 6, "walking", 0, 0), (6, 9, "serving", 0, 0)]),
        ({"between": (9.0, 30.0)}, [(0, 9, "closed", NOBODY, 1)]),
        ({"appears": 9}, [(0, 9, "unknown", NOBODY, 1)]),
        ({"starts": {"t0": (3.0, 5.0)}}, [(0, 6, "walking", 0, 0), (6, 9, "linked", NOBODY, 0)]),
    ],
)
def test_in_continuous_time_a_task_may_have_to_wait(second: Any, path: Any) -> None:
    """Robot b is at t1 after 2 and may begin at 9: t0 takes robot a 6 and 3 of work."""
    mission = make([robot("a", 0), robot("b", 10)], [task("a", 6, duration=3), task("b", 12)])
    later = replace(mission.tasks[1], duration=4, **second)
    mission = continuous(replace(mission, tasks=(mission.tasks[0], later)))
    assert told(path_of_plan(mission)) == [*path, (9, 13, "serving", 1, 1)]


def test_a_task_that_must_not_start_too_long_before_another_waits_for_it() -> None:
    """t1 starts at 15, when robot b is there; t0 at most 2 before that, so at 13, and takes 10.

    That it has to wait so long hangs on robot b's way, on which that sets out at once.
    """
    mission = make([robot("a", 0), robot("b", 0)], [task("a", 6, duration=10), task("b", 15)])
    later = replace(mission.tasks[1], starts={"t0": (0.0, 2.0)})
    mission = continuous(replace(mission, tasks=(mission.tasks[0], later)))
    assert told(path_of_plan(mission)) == [
        (0, 13, "linked", NOBODY, 1),
        (13, 23, "serving", 0, 0),
    ]


METHODS = ("plan", "crews", "heuristic", "join-all", "teamformer")


def random_mission(seed: int) -> Mission:
    """Return a mission with everything in it, on a plane every third time."""
    rng = np.random.default_rng(seed)
    mission = random_world(rng, is_plane=seed % 3 == 0)
    mission = with_precedence_and_windows(mission, rng) if seed % 2 else mission
    mission = with_loads(mission, rng) if seed % 4 < 2 else mission
    return with_surprises(mission, rng) if seed % 5 == 0 else mission


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.thorough
def test_the_stretches_add_up_and_tell_what_the_record_tells(method: str) -> None:
    """Held against `moments`, which goes through records in a way of its own."""
    completed = 0
    for seed in range(20):
        record = played(random_mission(seed), method, seed)
        path = path_of_record(record)
        if record.end.makespan is None:
            assert path == ()
            continue
        completed += 1
        assert sum(stretch.end - stretch.begin for stretch in path) == record.end.makespan
        assert [0, *(s.end for s in path)] == [*(s.begin for s in path), record.end.makespan]
        seen = list(moments(record))
        for stretch in path:
            if stretch.robot == NOBODY:
                assert stretch.begin == 0
                assert stretch.doing in ("unknown", "closed")
                continue
            for step in range(int(stretch.begin) + 1, int(stretch.end) + 1):
                shown = seen[step].phase[stretch.robot]
                if shown == "forming" and stretch.doing in AT_WORK:
                    continue  # others come or leave while it serves
                assert shown == stretch.doing, (seed, stretch, step)
    assert completed > 10


def test_in_continuous_time_the_stretches_add_up_and_tell_what_the_plan_tells() -> None:
    for seed in range(25):
        mission = tf.generate(seed, robots=5, tasks=8, capabilities=3, world=tf.Grid(12, 12))
        rng = np.random.default_rng(seed)
        mission = with_precedence_and_windows(mission, rng)
        tasks = tuple(replace(t, duration=float(rng.integers(5)) / 4) for t in mission.tasks)
        forming, ends = float(rng.integers(3)) / 2, (None, "home")[seed % 2]
        mission = continuous(mission, tasks=tasks, forming=forming, ends=ends)
        made = planned(mission)
        path = path_of_record(carry_out(mission, made, "plan"))
        assert path[0].begin == 0
        assert path[-1].end == made.makespan
        assert all(one.end == other.begin for one, other in pairwise(path))
        stops = {(r.robot, s.task): s for r in made.routes for s in r.stops}
        for stretch in path:
            if stretch.doing == "serving":
                stop = stops[stretch.robot, stretch.task]
                assert (stop.start, stop.end) == (stretch.begin, stretch.end)
            elif stretch.doing == "walking" and stretch.task != NOBODY:
                assert stops[stretch.robot, stretch.task].arrive == stretch.end
            elif stretch.doing == "forming":
                assert stretch.end - stretch.begin == pytest.approx(mission.forming)
            else:
                assert stretch.doing in ("walking", "closed", "unknown"), stretch
