"""The filter leaves safe wishes alone and stops dangerous ones, by hand and over long crossings."""

from __future__ import annotations

import numpy as np
import pytest

from teamformer.robotarium.control.barrier import POINT, Barrier, Safety
from teamformer.robotarium.control.controller import Controller
from teamformer.robotarium.control.qp_solvers import with_daqp
from teamformer.robotarium.robots.plant import Plant, Weather

pytest.importorskip("daqp")

ROUGH = Weather(delay=0.066, blur=0.002, turn_blur=np.deg2rad(1))


def test_a_safe_wish_is_granted() -> None:
    poses = np.array([[0.0, 0.0, 0.0], [1.0, 0.5, np.pi / 2]])
    wanted = np.array([[0.1, 0.0], [0.01, 0.1]])
    velocities = Barrier(2, with_daqp()).filter(poses, wanted)
    # In the second robot's frame, (0.01, 0.1) is 0.1 ahead and 0.01 to the right.
    np.testing.assert_allclose(velocities, [[0.1, 0.0], [0.1, -0.01 / POINT]], atol=1e-6)


def test_two_that_meet_slow_down_alike() -> None:
    """0.06 m are between their points; they may come nearer by 3/s of what is beyond 0.185 m."""
    safety = Safety()
    apart = safety.apart + 0.02
    poses = np.array([[0.0, 0.0, 0.0], [apart + 2 * POINT, 0.0, np.pi]])
    velocities = Barrier(2, with_daqp()).filter(poses, np.array([[0.1, 0.0], [-0.1, 0.0]]))
    np.testing.assert_allclose(velocities, [[0.03, 0.0], [0.03, 0.0]], atol=1e-6)


def test_who_counts_less_gives_way() -> None:
    """With 0.05 m/s too much, one of weight 0.25 takes four fifths of it upon itself."""
    poses = np.array([[0.0, 0.0, 0.0], [Safety().apart, 0.0, 0.0]])
    wanted = np.array([[0.05, 0.0], [0.0, 0.0]])
    velocities = Barrier(2, with_daqp()).filter(poses, wanted, np.array([1.0, 0.25]))
    np.testing.assert_allclose(velocities[:, 0], [0.04, 0.04], atol=1e-6)


def test_a_wall_stops_the_point_ahead() -> None:
    poses = np.array([[1.6 - 0.06 - POINT - 0.01, 0.0, 0.0]])
    velocities = Barrier(1, with_daqp()).filter(poses, np.array([[0.15, 0.0]]))
    np.testing.assert_allclose(velocities, [[0.03, 0.0]], atol=1e-6)


def test_too_near_already_comes_no_nearer() -> None:
    poses = np.array([[0.0, 0.0, 0.0], [0.12, 0.0, 0.0], [0.24, 0.0, np.pi]])
    velocities = Barrier(3, with_daqp()).filter(poses, np.array([[0.1, 0], [0.0, 0], [-0.1, 0]]))
    assert np.isfinite(velocities).all()
    assert velocities[0, 0] <= 1e-6 + velocities[1, 0]
    assert -velocities[2, 0] >= velocities[1, 0] - 1e-6


class Asked:
    """Stands for a solver: finds nothing until it was asked so often, then a given answer."""

    def __init__(self, nothing: int, answer: list[float]) -> None:
        self.nothing, self.answer = nothing, np.array(answer)
        self.bounds: list[np.ndarray] = []

    def __call__(self, wanted: np.ndarray, rows: np.ndarray, bounds: np.ndarray) -> object:
        self.bounds.append(bounds)
        return None if len(self.bounds) <= self.nothing else self.answer


CROWDED = np.array([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0]])
"""Two whose points are nearer than they may be, so that their bound is below 0."""


def test_where_nothing_is_safe_nobody_comes_nearer_and_where_that_fails_all_stand() -> None:
    wish = np.array([[0.1, 0.0], [0.0, 0.0]])
    once, always = Asked(1, [0.01, 0.006, 0.02, 0.0]), Asked(2, [1.0, 1.0, 1.0, 1.0])
    velocities = Barrier(2, once).filter(CROWDED, wish, np.array([1.0, 4.0]))  # type: ignore[arg-type]
    np.testing.assert_allclose(velocities, [[0.01, 0.2], [0.01, 0.0]])  # the second counts double
    strict, lenient = once.bounds
    assert strict[0] == pytest.approx(Safety().gain * (0.1 - Safety().apart))
    assert lenient[0] == 0.0
    np.testing.assert_array_equal(lenient[1:], strict[1:])
    velocities = Barrier(2, always).filter(CROWDED, wish)  # type: ignore[arg-type]
    assert velocities.tolist() == [[0.0, 0.0], [0.0, 0.0]]
    assert len(always.bounds) == 2


@pytest.mark.parametrize("weather", [Weather(), ROUGH], ids=["calm", "rough"])
def test_twenty_cross_without_a_fault(weather: Weather) -> None:
    """Twenty on a circle swap sides through its middle."""
    angle = 2 * np.pi * np.arange(20) / 20
    circle = np.stack((1.3 * np.cos(angle), 0.85 * np.sin(angle)), axis=1)
    plant = Plant(np.column_stack((circle, angle)), weather, seed=1)
    controller, is_idle = Controller(20, with_daqp()), np.zeros(20, dtype=np.bool_)
    for _ in range(1500):
        plant.drive(controller.steer(plant.poses(), -circle, is_idle))
    assert plant.faults.is_clean, plant.faults
    left = np.linalg.norm(plant.true_poses[:, :2] + circle, axis=1)
    assert (left < 0.05).all(), left.round(2)
