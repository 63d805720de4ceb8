"""Plans of missions, each as the record of what comes of it where nothing happens to it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

from teamformer.base.errors import MissionError, TeamformerError, UndoableError
from teamformer.methods.by_name import load_method
from teamformer.methods.central.policy import Central
from teamformer.methods.listings import DEFAULT as SHARED
from teamformer.mission.checks.costs import judged_by
from teamformer.mission.checks.optional import has_optional
from teamformer.mission.checks.rules import rules_not_planned
from teamformer.mission.coordination import Plan
from teamformer.mission.model import Mission
from teamformer.mission.truth import expected_mission
from teamformer.planning.continuous.continuous_mission import pose_mission
from teamformer.planning.continuous.rules import PLANNERS, plan_continuous, warm_up
from teamformer.planning.problem.routes import MissionPlan
from teamformer.record.critical_path.stretches import Stretch, path_rows
from teamformer.record.critical_path.words import why_so_late
from teamformer.record.files.writing import record_to_tree
from teamformer.record.record import Record
from teamformer.record.task_times import cost_of_record, lateness
from teamformer.record.telling.whole import path_of_record
from teamformer.trials.continuous_trial import carry_out
from teamformer.trials.memory import refuse_too_large
from teamformer.trials.routes import routes_of
from teamformer.trials.trial import run_trial
from teamformer.viewer.html import record_page
from teamformer.viewer.notebook_page import Page

CENTRAL = "central"

DIGITS = 6
"""Places after the point that are told of a time."""


@dataclass(frozen=True)
class PlannedMission(MissionPlan):
    """A plan of a mission, and the record of its being carried out.

    >>> made = tf.plan(tf.load("examples/four-robots.yaml"), seconds=1)
    >>> print(*made.why_so_late[:1])  # doctest: +ELLIPSIS
    why so late: ... steps are ... walking, ... forming
    >>> made.show(height=400).height
    400
    """

    record: Record = field(kw_only=True, repr=False)

    @property
    def mission(self) -> Mission:
        """Return what was planned: an uncertain mission as it is expected."""
        return self.record.mission

    @property
    def critical_path(self) -> tuple[Stretch, ...]:
        """Return the chain that the plan's end hangs on, the first stretch first."""
        return path_of_record(self.record)

    @property
    def why_so_late(self) -> list[str]:
        """Return the critical path in words, line by line, as `teamformer plan` prints it."""
        return why_so_late(self.mission, self.critical_path)

    def show(self, height: int = 620) -> Page:
        """Return the plan as a page; a notebook shows it in a frame `height` pixels high."""
        return Page(record_page(record_to_tree(self.record)), height)

    @property
    def row(self) -> dict[str, Any]:
        """Return what `teamformer plan --json` prints; times are in the mission's unit."""
        tasks, robots = self.mission.tasks, self.mission.robots
        return {
            "mission": self.mission.name,
            "makespan": round(self.makespan, DIGITS),
            **self._costs,
            "bound": round(self.bound, DIGITS),
            "proven": self.is_proven,
            "routes": [
                {
                    "robot": robots[route.robot].name,
                    "stops": [
                        {
                            "task": tasks[stop.task].name,
                            "arrive": round(stop.arrive, DIGITS),
                            "start": round(stop.start, DIGITS),
                            "end": round(stop.end, DIGITS),
                        }
                        for stop in route.stops
                    ],
                    "back": round(route.back, DIGITS),
                }
                for route in self.routes
            ],
            "late": {tasks[task].name: round(by, DIGITS) for task, by in self.late.items()},
            **({"missed": [tasks[k].name for k in self.missed]} if self.mission.until else {}),
            "windows": {task.name: list(task.between) for task in tasks if task.between},
            "critical_path": path_rows(self.mission, self.critical_path),
            "curve": [[round(seconds, 3), round(when, DIGITS)] for seconds, when in self.curve],
        }

    @property
    def _costs(self) -> dict[str, float]:
        """Return what the plan costs, and what none costs less than, if the mission has a cost."""
        if self.cost is None:
            return {}
        return {
            "cost": round(self.cost, DIGITS),
            "least_cost": math.floor(10**DIGITS * (self.least_cost or 0.0)) / 10**DIGITS,
        }


def plan_mission(
    mission: Mission, method: str, seconds: float, start: Plan | None = None
) -> PlannedMission | None:
    """Return the plan that a method makes in so many seconds; None if it finds none.

    `central` may begin with a plan of all tasks, `start`. What is uncertain is planned as it is
    expected, and the plan is carried out so; in steps that is how `central` plans. Raises what
    `refuse_unplannable` raises, and `UndoableError` for a mission that no plan can do in full.
    """
    refuse_unplannable(mission, method)
    if start is not None and method != CENTRAL:
        raise TeamformerError(f"method '{method}' cannot begin with a plan", f"use {CENTRAL}")
    expected = expected_mission(mission)
    if mission.time == "continuous":
        refuse_too_large(mission, load_method(SHARED))
        warm_up(mission)
        made = plan_continuous(pose_mission(expected), method, seconds, start)
        if made is None:
            return None
        return PlannedMission(**vars(made), record=carry_out(expected, made, method))
    player = load_method(method, seconds) if start is None else Central(seconds, start=start)
    trial = run_trial(expected, player)
    end, bound = trial.record.end, trial.record.lower_bound or 0
    if end.blocked_tasks:
        raise UndoableError(
            f"{mission.name}: {', '.join(end.blocked_tasks)} can never be done: since step "
            f"{end.steps} no robots are left that bring what is needed",
            "add such robots, or drop their lost or shifts",
        )
    if end.makespan is None:
        return None
    number_of = {task.name: number for number, task in enumerate(mission.tasks)}
    return PlannedMission(
        record=trial.record,
        makespan=end.makespan,
        bound=bound,
        is_proven=end.makespan <= bound
        and judged_by(mission) is None
        and not has_optional(mission),
        routes=routes_of(trial.record),
        missed=tuple(number_of[name] for name in end.missed),
        late={number_of[name]: by for name, by in lateness(trial.record).items()},
        curve=() if trial.plan is None else trial.plan.curve,
        cost=cost_of_record(trial.record),
    )


def refuse_unplannable(mission: Mission, method: str) -> None:
    """Raise `TeamformerError` for a method that does not plan such a mission, and for no method.

    Raises `MissionError` for rules that steps do not know.
    """
    if method not in PLANNERS:
        raise TeamformerError(f"method '{method}' makes no plans", f"use {', '.join(PLANNERS)}")
    if problems := list(rules_not_planned(mission)):
        raise MissionError(problems)
    if mission.time != "continuous" and method != CENTRAL:
        raise TeamformerError(
            f"method '{method}' plans missions in continuous time", f"in steps use {CENTRAL}"
        )
