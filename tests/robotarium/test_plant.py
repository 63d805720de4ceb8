"""The plant keeps Robotarium's rules: motion by hand, faults at the exact edge."""

from __future__ import annotations

import numpy as np
import pytest

from teamformer.robotarium.robots.arena import TICK, wheel_speeds
from teamformer.robotarium.robots.plant import Plant, Violations, Weather

STILL = np.zeros((2, 2))


def pair(apart: float, heading: float = 0.0, other: float = 0.0) -> np.ndarray:
    """Two robots beside each other, `apart` metres between their centres."""
    return np.array([[0.0, 0.0, heading], [apart, 0.0, other]])


def test_a_robot_moves_along_its_heading_and_turns() -> None:
    plant = Plant(np.array([[0.0, 0.0, np.pi / 2]]))
    plant.drive(np.array([[0.1, 1.0]]))
    np.testing.assert_allclose(plant.true_poses, [[0.0, 0.1 * TICK, np.pi / 2 + TICK]], atol=1e-12)


def test_headings_stay_within_half_a_turn() -> None:
    plant = Plant(np.array([[0.0, 0.0, np.pi - 0.01]]))
    plant.drive(np.array([[0.0, 1.0]]))
    assert plant.true_poses[0, 2] == pytest.approx(-np.pi - 0.01 + TICK)


@pytest.mark.parametrize(("apart", "collisions"), [(0.134, 1), (0.136, 0)])
def test_points_ahead_collide_at_135_mm(apart: float, collisions: int) -> None:
    assert Violations().after(pair(apart), STILL).collisions == collisions


@pytest.mark.parametrize(("apart", "collisions"), [(0.109, 1), (0.111, 0)])
def test_bodies_collide_back_to_back(apart: float, collisions: int) -> None:
    """The points ahead are 50 mm farther apart then."""
    assert Violations().after(pair(apart, np.pi, 0.0), STILL).collisions == collisions


def test_face_to_face_robots_collide_earlier() -> None:
    assert Violations().after(pair(0.18, 0.0, np.pi), STILL).collisions == 1
    assert Violations().after(pair(0.19, 0.0, np.pi), STILL).collisions == 0


@pytest.mark.parametrize(("x", "violations"), [(1.6, 0), (1.601, 1), (-1.601, 1)])
def test_the_boundary(x: float, violations: int) -> None:
    poses = np.array([[x, 0.0, 0.0], [0.0, 0.0, 0.0]])
    assert Violations().after(poses, STILL).boundary_violations == violations


@pytest.mark.parametrize(
    ("v", "turn", "violations"),
    [(0.2, 0.0, 0), (0.201, 0.0, 1), (0.0, 3.63, 0), (0.0, 3.65, 1), (0.1, 1.8, 0), (0.1, 1.9, 1)],
)
def test_actuators(v: float, turn: float, violations: int) -> None:
    """0.1 m/s leaves 0.1 m/s at the wheels, 55 mm from the middle: 1.82 rad/s."""
    told = np.array([[v, turn], [0.0, 0.0]])
    assert Violations().after(pair(1.0), told).actuator_violations == violations


def test_wheels_turn_against_each_other_on_the_spot() -> None:
    np.testing.assert_allclose(wheel_speeds(np.array([[0.0, 1.0]])), [[-3.4375, 3.4375]])


def test_a_delayed_plant_moves_late() -> None:
    plant = Plant(np.zeros((1, 3)), Weather(delay=0.066))
    xs = []
    for _ in range(4):
        plant.drive(np.array([[0.1, 0.0]]))
        xs.append(plant.true_poses[0, 0])
    np.testing.assert_allclose(xs, np.array([0, 0, 1, 2]) * 0.1 * TICK)


def test_blur_is_only_in_what_is_measured() -> None:
    plant = Plant(np.zeros((2000, 3)), Weather(blur=0.002, turn_blur=0.01), seed=3)
    assert plant.poses().std(axis=0) == pytest.approx([0.002, 0.002, 0.01], rel=0.1)
    assert not plant.true_poses.any()
