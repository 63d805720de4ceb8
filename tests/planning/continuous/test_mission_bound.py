"""What no plan in continuous time beats: by hand, and below what drawn missions take."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

import teamformer as tf
from clock_missions import RandomPlans, draw_mission
from teamformer.mission.model import Absence
from teamformer.mission.parts.roads import Roads
from teamformer.mission.truth import draw_truth
from teamformer.planning.continuous.mission_bound import bound_in_time
from teamformer.trials.trial import bound_of, run_trial

NEAR = 1e-6
"""By what is rounded to ticks."""


def corridor(**changes: object) -> tf.Mission:
    """Return two robots at 0, one of speed 2; a task for both at 8 until 11, and one at 4."""
    mission = tf.Mission(
        "corridor",
        tf.Grid(20, 1),
        ("a", "b"),
        (
            tf.Robot("slow", (0, 0), {"a": 1}),
            tf.Robot("fast", (0, 0), {"b": 1}, speed=2.0),
        ),
        (
            tf.Task("both", (8, 0), {"a": 1, "b": 1}, duration=3.0),
            tf.Task("near", (4, 0), {"b": 1}, duration=1.0),
        ),
        time="continuous",
        ends="home",
    )
    return replace(mission, **changes)  # type: ignore[arg-type]


def test_nobody_is_there_before_the_slowest_nor_home_sooner() -> None:
    """At 8 the slow one is there, at 11 they are done, at 19 it is home."""
    assert bound_in_time(corridor()) == pytest.approx(19, abs=NEAR)


def test_what_is_called_off_need_not_be_done_and_who_is_lost_need_not_come_home() -> None:
    both, near = corridor().tasks
    off = corridor(tasks=(replace(both, cancelled=5.0), near))
    assert bound_in_time(off) == pytest.approx(5, abs=NEAR)  # there at 2, until 3, home at 5
    slow, fast = corridor().robots
    lost = corridor(robots=(replace(slow, absences=(Absence(30.0),)), fast))
    assert bound_in_time(lost) == pytest.approx(11, abs=NEAR)
    assert bound_in_time(corridor(tasks=(replace(both, cancelled=5.0),))) == 0


def test_who_has_a_long_way_home_may_do_nothing() -> None:
    """The fast one is there at 5, done at 6 and home at 11; the slow one stays where it is.

    If both shared the work and both had to go home, it would be 6 and their ways home, 5 and 50,
    divided by two.
    """
    fast, slow = (tf.Robot(name, (0, 0), {"a": 1}, speed) for name, speed in (("f", 1), ("s", 0.1)))
    task = tf.Task("t", (5, 0), {"a": 1}, duration=1.0)
    mission = corridor(robots=(fast, slow), tasks=(task,))
    assert bound_in_time(mission) == pytest.approx(11, abs=NEAR)


def test_a_run_tells_it_as_in_steps() -> None:
    trial = tf.run(corridor())
    assert (trial.makespan, trial.lower_bound) == (19, pytest.approx(19, abs=NEAR))


@pytest.mark.parametrize("seed", range(300, 340))
def test_no_run_whatever_happens_in_it_is_over_before(seed: int) -> None:
    mission = draw_mission(seed)
    bound = bound_of(draw_truth(mission, seed))
    end = run_trial(mission, RandomPlans(seed), seed, bound).record.end
    if end.makespan is not None and bound is not None:
        assert bound <= end.makespan + NEAR


def test_a_task_that_nobody_gets_to_any_more_ends_a_mission() -> None:
    """From the pit no way leads back, and who brings the load there is to do the rest elsewhere."""
    rows = {"p": (0, 1, 1), "q": (1, 0, 2), "pit": (math.inf, math.inf, 0)}
    world = Roads(tuple(rows), {"ground": tuple(rows.values())})
    load = tf.Task("load", (0, 0), {"a": 1}, to=(2, 0))
    rest = tuple(tf.Task(f"x{n}", (1, 0), {"a": 1}, after=("load",)) for n in range(3))
    given = tf.Mission(
        "pit", world, ("a",), (tf.Robot("r", (0, 0), {"a": 1}),), (load, *rest), time="continuous"
    )
    trial = tf.run(given)
    assert trial.record.end.status == "infeasible"
    assert trial.record.end.tasks_done == 1
    assert trial.check().is_legal
    assert bound_in_time(given) < math.inf
