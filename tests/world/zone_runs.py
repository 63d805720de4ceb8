"""Missions in continuous time with zones, on a line, carried out by plans that are given."""

from __future__ import annotations

from typing import Any

import pytest

from clock_promises import path_length
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.mission.coordination import Known, Plan
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.plane import Plane
from teamformer.mission.parts.zones import Zone
from teamformer.record.record import Record
from teamformer.record.referee import judge
from teamformer.trials.trial import run_trial


class InThisOrder:
    """Plans that robots do tasks in an order that is given: it is asked once, and keeps to it."""

    heeds: tuple[str, ...] = ()

    def __init__(self, *rows: tuple[int, tuple[int, ...]]) -> None:
        self._rows = rows

    def update(self, known: Known, plan: Plan | None) -> Plan:
        """Return the plan, or what is left of it."""
        if plan is not None:
            return plan
        order, coalitions = zip(*self._rows, strict=True)
        return Plan(order=order, coalitions=coalitions)


def on_a_line(
    tasks: tuple[Task, ...], robots: tuple[Robot, ...], zones: tuple[Zone, ...], **more: Any
) -> Mission:
    """Return a mission on a line; everybody walks at speed 1."""
    given = (("a", "b"), robots, tasks)
    return Mission("m", Plane(40, 10), *given, time="continuous", zones=zones, **more)


def run(given: Mission, coordinator: Any = None) -> Record:
    """Return the record of a mission, which is legal."""
    record = run_trial(given, coordinator or SharedPlan()).record
    assert judge(record).findings == ()
    if record.end.makespan is not None:
        assert path_length(record.events) == pytest.approx(record.end.makespan, rel=1e-12)
    return record
