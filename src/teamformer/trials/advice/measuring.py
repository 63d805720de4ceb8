"""How long a mission takes, searched several times: the same mission, written in other orders."""

from __future__ import annotations

import time
from collections.abc import Callable, Generator, Iterable
from contextlib import closing
from dataclasses import dataclass
from typing import NamedTuple

from teamformer.base.errors import TeamformerError
from teamformer.base.worker_processes import work_in_processes
from teamformer.methods.by_name import load_method
from teamformer.mission.model import Mission
from teamformer.mission.orders import in_order
from teamformer.mission.truth import expected_mission
from teamformer.planning.continuous.continuous_mission import pose_mission
from teamformer.planning.continuous.rules import plan_continuous
from teamformer.record.critical_path.stretches import Stretch
from teamformer.record.task_times import cost_of_record
from teamformer.record.telling.whole import path_of_record
from teamformer.trials.continuous_trial import carry_out
from teamformer.trials.trial import run_trial


@dataclass(frozen=True)
class PlannedSearch:
    """A search to make: for a plan of a mission, or a whole trial by a method.

    `order` is one of the orders in which it can be written, 0 the one that it is written in.
    """

    about: int  # what the mission is, to whom wants to know the result
    mission: Mission
    method: str
    order: int = 0
    with_path: bool = False  # whether what the end hangs on is asked for too


class Found(NamedTuple):
    """How long a mission takes, or what it costs if it has a cost; None if it is not done."""

    value: float | None
    seconds: float  # that the search took
    path: tuple[Stretch, ...] = ()


def search(job: PlannedSearch) -> Found:
    """Make a search."""
    begun = time.perf_counter()
    mission = in_order(job.mission, job.order)
    if mission.time == "steps":
        value, path = _run(expected_mission(mission), job.method, 0, job.with_path)
    elif goes_as_planned(mission):
        value, path = _planned(mission, job.method, job.with_path)
    else:
        value, path = _run(mission, job.method, job.order, job.with_path)
    return Found(value, time.perf_counter() - begun, path)


def goes_as_planned(mission: Mission) -> bool:
    """Say whether nothing happens in a mission that a plan made beforehand does not know."""
    happens = any(robot.absences for robot in mission.robots) or any(
        task.appears > 0 or task.cancelled is not None for task in mission.tasks
    )
    return not (happens or mission.has_surprises)


def _run(
    mission: Mission, method: str, seed: int, with_path: bool
) -> tuple[float | None, tuple[Stretch, ...]]:
    """Return what a mission comes to that is run; `seed` says what it really is.

    So each search in continuous time meets another truth where something is uncertain.
    """
    record = run_trial(mission, load_method(method), seed).record
    value = record.end.makespan if mission.cost is None else cost_of_record(record)
    path = path_of_record(record) if with_path else ()
    return None if value is None else float(value), path


def _planned(
    mission: Mission, method: str, with_path: bool
) -> tuple[float | None, tuple[Stretch, ...]]:
    try:
        made = plan_continuous(pose_mission(mission), method, 0.0)
    except TeamformerError:  # no coalitions for tasks that are linked
        return None, ()
    if made is None:
        return None, ()
    path = path_of_record(carry_out(mission, made, method)) if with_path else ()
    return made.makespan if made.cost is None else made.cost, path


def searched(
    jobs: Iterable[PlannedSearch], workers: int
) -> Generator[tuple[PlannedSearch, Found], None, None]:
    """Make searches, in processes if there is more than one worker; yield them with results."""
    if workers <= 1:
        for job in jobs:
            yield job, search(job)
        return
    given: list[PlannedSearch] = []

    def noted() -> Generator[PlannedSearch, None, None]:
        for job in jobs:
            given.append(job)
            yield job

    with closing(work_in_processes(search, noted(), workers)) as results:
        for number, result in results:
            yield given[number], result


Progress = Callable[[int, float], None]
"""Is told how many searches are made, and for how many seconds more it is expected to go on."""
