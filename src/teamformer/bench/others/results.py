"""What methods reach on instances of others, and how that compares."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean
from typing import Any

from teamformer.bench.others.instances import Instance, prize_of
from teamformer.bench.others.plan_given_out import plan_given_out
from teamformer.bench.others.published import Published
from teamformer.bench.peers.names import PEERS, plan_by_peer
from teamformer.methods.by_name import load_method
from teamformer.mission.model import Mission
from teamformer.planning.continuous.continuous_mission import pose_mission
from teamformer.planning.continuous.rules import PLANNERS, plan_continuous
from teamformer.planning.problem.routes import MissionPlan

EQUAL = 1e-3
"""Makespans that differ by less are the same: published ones are told to three places."""

DIGITS = 6
"""Places after the point that are written of a makespan."""

THREADS = {"central": 2}
"""Threads of the methods that have more than one."""

MOMENTS = (0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 60.0)
"""Seconds at which the curve of `central` is told."""


@dataclass(frozen=True)
class Result:
    """What a method reached on an instance; `curve` holds (seconds, makespan).

    `processor_seconds` are those that its threads together were given of the machine. Where plans
    are judged by a cost, it stands in place of the makespan, and what they miss of all `prizes`
    where tasks are optional.
    """

    collection: str
    instance: str
    method: str
    makespan: float
    bound: float
    proven: bool
    seconds: float
    time_limit: float
    curve: tuple[tuple[float, float], ...]
    published: Published
    processor_seconds: float = 0.0
    prizes: float = 0.0

    @property
    def best(self) -> float | None:
        """Return the best published makespan."""
        return min(self.published.values(), default=None)

    @property
    def percent_above_best(self) -> float | None:
        """Return by how much it is above the best published makespan, or below the best prize."""
        if self.best is None:
            return None
        reference = self.prizes - self.best if self.prizes else self.best
        return 100 * (self.makespan - self.best) / reference if reference > 0 else 0.0


@dataclass(frozen=True)
class MethodMeans:
    """A method's means, and how often it is better than the best published, or worse.

    `bound` is the method's own; `gap` and `proven` are by the best bound of any method.
    """

    method: str
    instances: int
    makespan: float
    percent_above_best: float | None  # of the instances whose best is published
    bound: float
    gap: float  # percent that the makespans are above the bounds, together
    proven: int
    wins: int
    ties: int
    losses: int
    threads: int
    seconds: float
    processor_seconds: float


def measure(instance: Instance, method: str, time_limit: float) -> Result | None:
    """Plan an instance by a method; `central` and peers have so many seconds.

    None if a peer finds no plan in that time. Raises `OutOfReachError` if it cannot be asked.
    """
    mission = pose_mission(instance.mission)
    begun, worked = time.perf_counter(), time.process_time()
    if method in PEERS:
        made = plan_by_peer(mission, method, time_limit)
        if made is None:
            return None
    elif method in PLANNERS:
        made = plan_continuous(mission, method, time_limit)
    else:
        made = plan_given_out(mission, load_method(method))
    seconds, worked = time.perf_counter() - begun, time.process_time() - worked
    assert made is not None, "tasks that nobody can do are refused with the mission"
    prizes = prize_of(instance.mission) if made.cost is None else 0.0
    return Result(
        collection=instance.collection,
        instance=instance.name,
        method=method,
        makespan=round(_judged(made, instance.mission), DIGITS),
        bound=0.0 if prizes else round(_bound_told(made), DIGITS),
        proven=made.is_proven and not prizes,
        seconds=round(seconds, 3),
        time_limit=time_limit,
        curve=() if prizes else _rounded(made.curve),
        published=instance.published,
        processor_seconds=round(worked, 3),
        prizes=prizes,
    )


def _bound_told(made: MissionPlan) -> float:
    return made.bound if made.least_cost is None else made.least_cost


def _rounded(curve: Sequence[tuple[float, float]]) -> tuple[tuple[float, float], ...]:
    return tuple((round(when, 3), round(value, DIGITS)) for when, value in curve)


def _judged(made: MissionPlan, mission: Mission) -> float:
    """Return what a plan is judged by: its cost, what it misses of the prizes, or its makespan."""
    if made.cost is not None:
        return made.cost
    if any(task.optional for task in mission.tasks):
        return sum(mission.tasks[task].weight for task in made.missed)
    return made.makespan


def result_of(row: dict[str, Any]) -> Result:
    """Return the result in a row of a file; KeyError, TypeError or ValueError if there is none."""
    curve = tuple((float(when), float(value)) for when, value in row["curve"])
    return Result(**{**row, "curve": curve})


def compare(results: Sequence[Result], method: str) -> MethodMeans:
    """Return how a method did on the instances of one collection."""
    mine = [result for result in results if result.method == method]
    compared = [(result.makespan, result.best) for result in mine if result.best is not None]
    bound = {name: _bound_of(results, name) for name in {result.instance for result in mine}}
    makespan = fmean(result.makespan for result in mine)
    floor = fmean(bound[result.instance] for result in mine)
    return MethodMeans(
        method=method,
        instances=len(mine),
        makespan=makespan,
        percent_above_best=mean_percent_above_best(mine),
        bound=fmean(result.bound for result in mine),
        gap=100 * (makespan / floor - 1) if floor > 0 else 0.0,
        proven=sum(result.makespan <= bound[result.instance] for result in mine),
        wins=sum(reached < best - EQUAL for reached, best in compared),
        ties=sum(abs(reached - best) <= EQUAL for reached, best in compared),
        losses=sum(reached > best + EQUAL for reached, best in compared),
        threads=THREADS.get(method, 1),
        seconds=fmean(result.seconds for result in mine),
        processor_seconds=fmean(result.processor_seconds for result in mine),
    )


def percent_above_optimum(results: Sequence[Result], method: str) -> float | None:
    """Return how far a method is above the optima in the mean; None if one is not proven."""
    optimum = {
        name: min(r.makespan for r in results if r.instance == name)
        for name in {r.instance for r in results if r.proven}
    }
    mine = [result for result in results if result.method == method]
    if not mine or any(result.instance not in optimum for result in mine):
        return None
    return fmean(100 * (result.makespan / optimum[result.instance] - 1) for result in mine)


def mean_percent_above_best(results: Sequence[Result]) -> float | None:
    """Return how far results are above the best published in the mean; None if none is."""
    above = [each for result in results if (each := result.percent_above_best) is not None]
    return fmean(above) if above else None


def _bound_of(results: Sequence[Result], instance: str) -> float:
    """Return the best bound of an instance: `central` and `cp-sat` work one out."""
    return max(result.bound for result in results if result.instance == instance)


def published_means(results: Sequence[Result]) -> Published:
    """Return the mean of each published method that has all instances."""
    tables = list({result.instance: result.published for result in results}.values())
    methods = dict.fromkeys(name for table in tables for name in table)
    return {
        name: fmean(table[name] for table in tables)
        for name in methods
        if all(name in table for table in tables)
    }


def anytime_curve(results: Sequence[Result]) -> list[tuple[float, float]]:
    """Return the mean makespan that `central` had found at some moments."""
    planned = [result for result in results if result.method == "central"]
    limit = min((result.time_limit for result in planned), default=0.0)
    return [
        (moment, fmean(_best_by(result.curve, moment) for result in planned))
        for moment in MOMENTS
        if moment <= limit and all(each.curve and each.curve[0][0] <= moment for each in planned)
    ]


def _best_by(curve: Sequence[tuple[float, float]], moment: float) -> float:
    return min(makespan for seconds, makespan in curve if seconds <= moment)
