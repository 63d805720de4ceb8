"""Robots that fly and robots that walk carry a load together, round a wall."""

from __future__ import annotations

import pytest

import teamformer as tf

WALL = tf.Grid(9, 5, (".........", "....@....", "....@....", "....@....", "....@...."))


@pytest.mark.parametrize(
    ("drone", "cart", "makespan"),
    [(1.0, 1.0, 14.0), (0.25, 1.0, 23.0), (1.0, 0.5, 26.0)],
)
def test_they_go_round_it_and_take_as_long_as_the_slower_alone(
    drone: float, cart: float, makespan: float
) -> None:
    """The drone is there, the cart one cell away; they serve for 1, unload for 1.

    Round the wall, by its row without one, it is 11 cells for the cart, and 5 cells straight on for
    the drone: 11, 5 / 0.25 = 20, and 11 / 0.5 = 22, after 1 / 0.5 = 2 to get there.
    """
    robots = (
        tf.Robot("drone", (2, 3), {"a": 1}, drone, moves="air"),
        tf.Robot("cart", (1, 3), {"b": 1}, cart),
    )
    load = tf.Task("load", (2, 3), {"a": 1, "b": 1}, duration=1.0, to=(7, 3), unload=1.0)
    mission = tf.Mission("wall", WALL, ("a", "b"), robots, (load,), time="continuous")
    trial = tf.run(mission)
    assert trial.makespan == makespan
    assert trial.check().is_legal
    [way] = [event.way for event in trial.record.events if event.kind == "lift"]
    assert len(way) == 12
    assert all(WALL.is_free(passed.place) for passed in way)
