"""Robots of the official Robotarium simulator, and of the testbed, which has the same interface.

Two dialects are known: that of 2020, on PyPI as robotarium-python-simulator, whose scripts end
with `call_at_scripts_end()`, and that of version 2.1, whose scripts end with `debug()`.
"""

from __future__ import annotations

import contextlib
import io
from typing import Any

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.errors import TeamformerError
from teamformer.base.extras import how_to_install
from teamformer.robotarium.robots.plant import Violations


def load_robotarium() -> Any:
    """Return the simulator's class; raises `TeamformerError` if it is not installed."""
    try:
        import matplotlib

        matplotlib.use("Agg")  # it imports pyplot, window or not
        from rps.robotarium import Robotarium
    except ImportError:
        hint = how_to_install("rps")
        raise TeamformerError("the official simulator is not installed", hint) from None
    return Robotarium


class RpsRobots:
    """Robots of one run of the simulator; begin with poses (robots, 3), end with `finish()`."""

    def __init__(self, poses: Array, robotarium: Any = None) -> None:
        self._said = io.StringIO()  # by the simulator, which prints among what we print
        self._robots = len(poses)
        with self._hushed():
            make = robotarium or load_robotarium()
            self._simulator = make(
                number_of_robots=self._robots,
                show_figure=False,
                sim_in_real_time=False,
                initial_conditions=np.array(poses, dtype=float).T.copy(),
            )
        self._measured = self._look()
        self.faults = Violations()

    @property
    def true_poses(self) -> Array:
        """Return where the robots are, as (robots, 3)."""
        return self._measured.copy()

    def poses(self) -> Array:
        """Return where the robots are, as (robots, 3)."""
        return self._measured.copy()

    def drive(self, velocities: Array) -> None:
        """Move for a tick at velocities (robots, 2)."""
        self.faults = self.faults.after(self._measured, velocities)
        told = np.array(velocities, dtype=float).T.copy()  # (2, robots)
        with self._hushed():
            self._simulator.set_velocities(np.arange(self._robots), told)
            self._simulator.step()
        self._measured = self._look()

    def finish(self) -> str:
        """End the run as the testbed wants it, and return what the simulator has said of it."""
        with self._hushed():
            if hasattr(self._simulator, "call_at_scripts_end"):
                self._simulator.call_at_scripts_end()
            else:
                self._simulator.debug()
        return self._said.getvalue()

    def _hushed(self) -> contextlib.AbstractContextManager[Any]:
        """Keep what the simulator prints for its report."""
        return contextlib.redirect_stdout(self._said)

    def _look(self) -> Array:
        with self._hushed():
            poses: Array = np.array(self._simulator.get_poses(), dtype=float).T.copy()
        return poses


def is_accepted(report: str) -> bool:
    """Say whether a report of the simulator's speaks of no fault."""
    return "Simulation had" not in report
