"""Where a task may be whose place is not known."""

from __future__ import annotations

import numpy as np
import pytest

from teamformer.base.errors import MissionError
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.mission.parts.places import possible_places
from teamformer.mission.parts.plane import Plane
from teamformer.mission.truth import believed_mission, draw_truth, expected_mission


def test_the_nearest_places_come_first() -> None:
    assert possible_places(Grid(9, 9), (4, 4), 1) == ((4, 4), (4, 3), (3, 4), (5, 4), (4, 5))
    assert len(possible_places(Grid(9, 9), (4, 4), 3)) == 29  # lattice points of a disc
    assert possible_places(Grid(9, 9), (0, 0), 1) == ((0, 0), (1, 0), (0, 1))


def test_places_are_free_and_connected_with_the_nearest() -> None:
    """The task may be at 0 or 1; behind the wall it is not looked for.

    . T @ .
    """
    assert possible_places(Grid(4, 1, ("..@.",)), (1, 0), 2) == ((1, 0), (0, 0))
    assert possible_places(Grid(4, 1, ("..@.",)), (2, 0), 1) == ((1, 0), (0, 0))[:1]
    assert possible_places(Grid(4, 1, ("@.@.",)), (2, 0), 0.5) == ()


def test_on_a_plane_places_are_units_apart() -> None:
    plane = Plane(2.0, 1.0, unit=0.2)
    assert possible_places(plane, (1.0, 0.1), 0.2) == (
        (1.0, 0.1),
        (0.8, 0.1),
        (1.2, 0.1),
        (1.0, 0.3),
    )
    assert len(possible_places(plane, (1.0, 0.5), 0.3)) == 9


def lost_thing(within: float, world: Grid | None = None) -> Mission:
    robot, task = Robot("r", (0, 0), {"a": 1}), Task("t", (2, 0), {"a": 1}, within=within)
    return Mission("lost", world or Grid(5, 1), ("a",), (robot,), (task,))


def test_each_place_is_as_likely_as_any_other() -> None:
    mission = lost_thing(2)
    truths = [draw_truth(mission, seed) for seed in range(2000)]
    xs = [truth.tasks[0].at[0] for truth in truths]
    shares = np.bincount(np.array(xs, int)) / len(xs)
    assert shares == pytest.approx([0.2] * 5, abs=0.03)
    assert truths[0].tasks[0].within == 0


def test_what_is_believed_is_a_mission_without_regions() -> None:
    believed = expected_mission(lost_thing(2, Grid(5, 1, ("..@..",))))
    assert (believed.tasks[0].at, believed.tasks[0].within) == ((1, 0), 0)
    believed = believed_mission(lost_thing(2), {}, {0: (4, 0)})
    assert (believed.tasks[0].at, believed.tasks[0].within) == ((4, 0), 0)


@pytest.mark.parametrize(
    ("within", "rows", "words"),
    [
        (-1.0, (), "within -1 of [2, 0]; use 0 to 30"),
        (31.0, (), "within 31 of [2, 0]; use 0 to 30"),
        (float("nan"), (), "within nan of [2, 0]; use 0 to 30"),
        (1.0, (".@@@.",), "within 1 of [2, 0], where no cell is free; move it or widen it"),
        (2.0, (".@@..",), "cannot be reached by robots that bring a"),
    ],
)
def test_regions_that_cannot_be_are_refused(
    within: float, rows: tuple[str, ...], words: str
) -> None:
    with pytest.raises(MissionError) as refused:
        lost_thing(within, Grid(5, 1, rows))
    assert words in str(refused.value)
