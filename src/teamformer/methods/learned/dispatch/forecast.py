"""What a mission comes to if its tasks are given out so: in steps, and in continuous time."""

from __future__ import annotations

from typing import Protocol

from teamformer.base.array_types import Ints
from teamformer.methods.learned.dispatch.giving_out import GivingOut
from teamformer.mission.coordination import known_at_start
from teamformer.mission.model import Mission
from teamformer.planning.continuous.continuous_mission import ContinuousMission, pose_mission
from teamformer.planning.continuous.reactive import mean_future
from teamformer.planning.dispatch.futures import empty_calls
from teamformer.planning.problem.coalition_plan import CoalitionPlan
from teamformer.planning.problem.constants import TICKS
from teamformer.planning.problem.prices import STEP
from teamformer.planning.problem.schedule import COST, MAKESPAN, schedule_of
from teamformer.planning.steps.reactive import future_of_present, mean_future_in_steps
from teamformer.planning.steps.situation import Situation, situation_of
from teamformer.planning.steps.timed_plan import TimedPlan, time_team_plan

CALMER = 3
"""Futures that are averaged have so many times less noise than those of the reactive rule."""


class DispatchForecast(Protocol):
    """Judges what is given out of one problem, `given`."""

    @property
    def given(self) -> GivingOut:
        """Return the problem."""

    def worth(self, position: int, futures: int, seed: int) -> float:
        """Return what so many futures from a position on come to on average.

        The less the better, in what a task takes a robot. The makespan counts, and a little when
        tasks end on average, so that more than the last task tells something.
        """

    def makespan(self) -> float:
        """Return the makespan of what is given out, in the mission's unit."""

    def cost(self) -> float:
        """Return what is given out costs: the makespan, and a little when tasks end on average."""


class StepForecast:
    """Of a mission in steps: when everything is really done, forming counted."""

    def __init__(self, situation: Situation) -> None:
        self.situation = situation
        self._future = future_of_present(situation, 0)
        self.given = GivingOut.of(self._future.problem, self._future.schedule)

    def worth(self, position: int, futures: int, seed: int) -> float:
        """Return what so many futures come to on average."""
        self._future.calls.random[0] = seed + 1
        leg = self.given.leg // CALMER
        lead = mean_future_in_steps(self._future, position, futures, leg)
        whole = self.situation.problem.prices.whole
        step = int(whole[0]) if len(whole) and whole[0] else STEP * self.given.tasks
        return lead / step * TICKS / self.given.leg

    def timed(self) -> TimedPlan:
        """Return what is given out, timed."""
        return time_team_plan(self.situation, self.given.schedule.plan)

    def makespan(self) -> float:
        """Return the step in which everything is done."""
        return float(self.timed().makespan)

    def cost(self) -> float:
        """Return what leads a search."""
        return float(self.timed().lead)


class ContinuousForecast:
    """Of a mission in continuous time that is judged by its makespan and lateness."""

    def __init__(self, posed: ContinuousMission) -> None:
        self.given = GivingOut.of(posed.problem)
        self._scale = posed.scale
        self._calls = empty_calls(posed.problem, 0)

    def worth(self, position: int, futures: int, seed: int) -> float:
        """Return what so many futures come to on average."""
        self._calls.random[0] = seed + 1
        parts = self.given.problem, self.given.schedule, self._calls
        cost: float = mean_future(*parts, position, futures, self.given.leg // CALMER)
        return cost / self.given.leg

    def makespan(self) -> float:
        """Return when everything is over."""
        return float(self._total[MAKESPAN] / self._scale)

    def cost(self) -> float:
        """Return what plans are compared by, in ticks."""
        return float(self._total[COST])

    @property
    def _total(self) -> Ints:
        plan: CoalitionPlan = self.given.schedule.plan
        return schedule_of(self.given.problem, plan).total


def forecasts_of(mission: Mission, count: int) -> list[DispatchForecast]:
    """Return so many forecasts of a mission from its start on; each gives out its own tasks."""
    if mission.time == "continuous":
        posed = pose_mission(mission)
        return [ContinuousForecast(posed) for _ in range(count)]
    situation = situation_of(known_at_start(mission))
    return [StepForecast(situation) for _ in range(count)]


def forecast_of(mission: Mission) -> DispatchForecast:
    """Return a forecast of a mission from its start on."""
    return forecasts_of(mission, 1)[0]
