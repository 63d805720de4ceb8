"""Many rehearsals of one mission: each from its own seed, judged, and summed up."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from contextlib import closing
from dataclasses import dataclass
from functools import partial

from teamformer.base.worker_processes import work_in_processes
from teamformer.fleet.agent.meeting import turn_time, turns
from teamformer.fleet.agent.planning import FleetPlan, first_plan
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.methods import PLAN, planner_of, policy_of
from teamformer.fleet.rehearsal.checking.checker import Checker
from teamformer.fleet.rehearsal.checking.trace import Trace
from teamformer.fleet.rehearsal.faults import Faults, draw_faults
from teamformer.fleet.rehearsal.outcome import Outcome
from teamformer.fleet.rehearsal.play import Rehearsal
from teamformer.mission.parts.roads import Roads

SLACK = 300.0
"""Seconds beyond the time that the slowest robot takes alone for every task, one by one."""


LONGEST_SHIFTS = 10_000.0
"""Units of time for which shifts may be waited for in a rehearsal."""

LOOKING = 3.0
"""Seconds that a robot takes at each cell, or metre, to see that a load is not there."""


@dataclass(frozen=True)
class Stage:
    """A mission with all that its rehearsals share."""

    mission: FleetMission
    plan: FleetPlan
    undisturbed: Outcome
    method: str = PLAN


@dataclass(frozen=True)
class ScheduleVerdict:
    """What came of one schedule."""

    schedule: int
    outcome: Outcome
    violations: tuple[str, ...]
    kinds: tuple[str, ...]

    @property
    def is_good(self) -> bool:
        """Say whether it ended, or could not, and every promise was kept."""
        return not self.violations and self.outcome.status != "blocked"


def set_stage(mission: FleetMission, method: str = PLAN) -> Stage:
    """Make the plan that ships with a mission, and play it undisturbed."""
    plan = first_plan(mission, planner_of(method))
    _, outcome, _ = play(mission, plan, Faults(), method=method)
    return Stage(mission, plan, outcome, method)


def play(
    mission: FleetMission,
    plan: FleetPlan,
    faults: Faults,
    trace: Trace | None = None,
    method: str = PLAN,
) -> tuple[Rehearsal, Outcome, list[str]]:
    """Play one schedule; return it, how it ended and what was promised and not kept."""
    trace = trace or Trace()
    make_policy = partial(policy_of, method)
    rehearsal = Rehearsal(mission, planner_of(method), plan, faults, trace, make_policy)
    outcome = rehearsal.run(deadline(mission, faults))
    names = set(outcome.blocked_tasks) if outcome.status == "blocked" else set()
    tasks = rehearsal.world.tasks
    undone = [key for key, task in tasks.items() if task.name in names]
    return rehearsal, outcome, Checker(mission, tasks).check(trace.events, undone)


def deadline(mission: FleetMission, faults: Faults) -> float:
    """Return when a mission must have ended that can end, in seconds; it is generous.

    The slack grows as the messages that arrive become fewer: of ten, one arrives where nine are
    lost, and waiting for one takes ten times as long.
    """
    across = mission.longest_walk
    tasks = [*mission.tasks, *(order.task for order in faults.orders)]
    walks = sum(across + task.duration + mission.forming * 4 for task in tasks)
    carried = sum(task.to is not None for task in tasks)
    walks += carried * (2 * across + LOOKING * _places_on_way(mission))
    walks += sum(task.unload for task in tasks)
    walks += across * sum(len(tour) for tour in mission.hidden.values())
    walks += across * mission.ends
    walks += 2 * turn_time(mission) * len(turns(mission))
    fills = sum(robot.battery.fills for robot in mission.source.robots if robot.battery)
    walks += (fills * mission.step + across * (mission.charging is not None)) * len(tasks)
    begins = max([*mission.opens.values(), *(task.appears for task in tasks)])
    if mission.until < math.inf:
        begins = max(begins, mission.until)
    seconds = faults.over + begins + SLACK / (1 - faults.loss) + 2 * walks
    rotas = [robot.rota for robot in mission.source.robots if robot.rota]
    if not rotas:
        return seconds
    seconds /= min(rota.share for rota in rotas)
    longest = max(rota.shifts[-1][1] + rota.every * (len(tasks) + 1) for rota in rotas)
    return seconds + mission.step * min(longest, LONGEST_SHIFTS)


def _places_on_way(mission: FleetMission) -> float:
    """Return at how many places a load may have to be looked for."""
    world = mission.source.world
    if isinstance(world, Roads):
        return len(world.places) * (1 + mission.longest_walk)
    return world.width + world.height


def faults_of(stage: Stage, seed: int, schedule: int) -> Faults:
    """Return the faults of a schedule, by number."""
    span = stage.undisturbed.makespan or stage.undisturbed.end
    return draw_faults(stage.mission, seed * 1_000_003 + schedule, span)


def judge(stage: Stage, seed: int, schedule: int) -> ScheduleVerdict:
    """Play and judge a schedule by its number."""
    faults = faults_of(stage, seed, schedule)
    _, outcome, violations = play(stage.mission, stage.plan, faults, method=stage.method)
    return ScheduleVerdict(schedule, outcome, tuple(violations), faults.kinds)


def judge_many(
    stage: Stage, seed: int, schedules: Iterable[int], workers: int
) -> Iterator[ScheduleVerdict]:
    """Judge schedules in several processes, in order."""
    one = partial(judge, stage, seed)
    if workers == 1:
        yield from map(one, schedules)
        return
    early: dict[int, ScheduleVerdict] = {}
    following = 0
    with closing(work_in_processes(one, schedules, workers)) as verdicts:
        for number, verdict in verdicts:
            early[number] = verdict
            while following in early:
                yield early.pop(following)
                following += 1


def fails(mission: FleetMission, faults: Faults, method: str = PLAN) -> bool:
    """Say whether a mission, planned anew, breaks a promise or blocks under a schedule."""
    plan = first_plan(mission, planner_of(method))
    _, outcome, violations = play(mission, plan, faults, method=method)
    return bool(violations) or outcome.status == "blocked"
