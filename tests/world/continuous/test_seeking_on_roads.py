"""Tasks that are in one of several places of roads: which these are, and when they are found."""

from __future__ import annotations

import math

import pytest

import teamformer as tf
from teamformer.base.errors import MissionError
from teamformer.mission.model import Robot, Task
from teamformer.mission.parts.places import possible_places, sight_of
from teamformer.mission.parts.roads import Roads
from teamformer.mission.truth import draw_truth

INF = math.inf
LINE = Roads(
    ("west", "mid", "east", "far"),
    {
        "ground": ((0, 2, INF, INF), (2, 0, 3, INF), (INF, 3, 0, 4), (INF, INF, 4, 0)),
        "cart": ((0, 5, INF, INF), (5, 0, 2, INF), (INF, 2, 0, 9), (INF, INF, 9, 0)),
    },
)
"""Four places in a line; carts are quicker between `mid` and `east`."""


def mission(world: Roads = LINE, within: float = 5.0, **more: object) -> tf.Mission:
    """Return a robot at `west` and a task that is believed at `mid`."""
    task = Task("spill", (1, 0), {"clean": 1}, duration=1.0, within=within)
    robots = (Robot("mop", (0, 0), {"clean": 1}),)
    return tf.Mission("site", world, ("clean",), robots, (task,), time="continuous", **more)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("within", "places"),
    [(1.9, [1]), (2, [1, 0, 2]), (5.9, [1, 0, 2]), (7, [1, 0, 2, 3])],
)
def test_it_may_be_where_the_quickest_way_takes_no_longer(within: float, places: list[int]) -> None:
    """From `mid`: `west` 2 on foot, `east` 2 by cart, `far` 3 + 4 on foot or 2 + 9 by cart."""
    assert [n for n, _ in possible_places(LINE, (1, 0), within)] == places


def test_nothing_is_seen_from_another_place() -> None:
    assert sight_of(LINE, (1, 0), (1, 0)) == 0
    assert sight_of(LINE, (1, 0), (2, 0)) == INF


def test_it_is_looked_for_place_by_place() -> None:
    """It is neither at `west`, where the robot starts, nor at `mid` (2): at `east` (5), until 6.

    What is ruled out at `west` is so at once.
    """
    site = mission()
    seed = next(s for s in range(99) if draw_truth(site, s).tasks[0].at == (2, 0))
    trial = tf.run(site, seed=seed)
    assert trial.makespan == 6
    assert trial.check().is_legal
    told = [(event.at, event.kind) for event in trial.record.events]
    assert (2.0, "moved") in told
    assert (5.0, "found") in told


def test_who_looks_everywhere_finds_it_at_once() -> None:
    trial = tf.run(mission(finding_radius=INF))
    assert trial.record.events[0].kind == "found"
    assert trial.check().is_legal


def test_a_place_that_nobody_gets_to_is_refused() -> None:
    gone = Roads(("west", "mid", "end"), {"ground": ((0, 2, INF), (2, 0, INF), (1, 1, 0))})
    assert mission(gone, within=2.0).tasks[0].within == 2  # from `end` ways lead, to it none
    split = Roads(
        ("west", "mid", "end"),
        {"ground": ((0, 2, INF), (2, 0, INF), (1, 1, 0)), "air": ((0, 1, 1), (1, 0, 1), (1, 1, 0))},
    )
    with pytest.raises(MissionError, match="'spill' cannot be reached by robots that bring"):
        mission(split, within=2.0)
    with pytest.raises(MissionError, match="is within -1 of 'mid'; use 0 to 1e"):
        mission(within=-1.0)
