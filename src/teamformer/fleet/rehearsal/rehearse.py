"""Many rehearsals of one mission: each from its own seed, judged, and summed up."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from itertools import islice

from teamformer.fleet.agent.planning import FleetPlan, first_plan
from teamformer.fleet.methods import PLAN, planner_of, policy_of
from teamformer.fleet.mission import Mission
from teamformer.fleet.rehearsal.checker import Checker
from teamformer.fleet.rehearsal.faults import Faults, draw_faults
from teamformer.fleet.rehearsal.outcome import Outcome
from teamformer.fleet.rehearsal.play import Rehearsal
from teamformer.fleet.rehearsal.trace import Trace
from teamformer.trials.worker_processes import begin_worker, ending

SLACK = 300.0
"""Seconds beyond the time that the slowest robot takes alone for every task, one by one."""

BATCH = 8
"""Schedules that a worker is given at once."""

AHEAD = 4
"""Batches that each worker has at hand, so that none waits for the order of the verdicts."""


@dataclass(frozen=True)
class Stage:
    """A mission with all that its rehearsals share."""

    mission: Mission
    plan: FleetPlan
    undisturbed: Outcome
    method: str = PLAN


@dataclass(frozen=True)
class Verdict:
    """What came of one schedule."""

    schedule: int
    outcome: Outcome
    violations: tuple[str, ...]
    kinds: tuple[str, ...]

    @property
    def is_good(self) -> bool:
        """Say whether it ended, or could not, and every promise was kept."""
        return not self.violations and self.outcome.status != "blocked"


def set_stage(mission: Mission, method: str = PLAN) -> Stage:
    """Make the plan that ships with a mission, and play it undisturbed."""
    plan = first_plan(mission, planner_of(method))
    _, outcome, _ = play(mission, plan, Faults(), method=method)
    return Stage(mission, plan, outcome, method)


def play(
    mission: Mission,
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


def deadline(mission: Mission, faults: Faults) -> float:
    """Return when a mission must have ended that can end, in seconds; it is generous."""
    world = mission.scenario.world
    slowest = min(mission.paces)
    across = (world.width + world.height) / slowest
    tasks = [*mission.tasks, *(order.task for order in faults.orders)]
    walks = sum(across + task.duration + mission.forming * 4 for task in tasks)
    return faults.over + max(task.appears for task in tasks) + SLACK + 2 * walks


def faults_of(stage: Stage, seed: int, schedule: int) -> Faults:
    """Return the faults of a schedule, by number."""
    span = stage.undisturbed.makespan or stage.undisturbed.end
    return draw_faults(stage.mission, seed * 1_000_003 + schedule, span)


def judge(stage: Stage, seed: int, schedule: int) -> Verdict:
    """Play and judge a schedule by its number."""
    faults = faults_of(stage, seed, schedule)
    _, outcome, violations = play(stage.mission, stage.plan, faults, method=stage.method)
    return Verdict(schedule, outcome, tuple(violations), faults.kinds)


def judge_many(
    stage: Stage, seed: int, schedules: Iterable[int], workers: int
) -> Iterator[Verdict]:
    """Judge schedules in several processes, in order."""
    one = partial(judge, stage, seed)
    if workers == 1:
        yield from map(one, schedules)
        return
    numbers = iter(schedules)
    batches = iter(lambda: tuple(islice(numbers, BATCH)), ())
    pool = ProcessPoolExecutor(workers, initializer=begin_worker)
    with ending(pool):
        going = deque(pool.submit(_judge_all, one, b) for b in islice(batches, AHEAD * workers))
        while going:
            yield from going.popleft().result()
            going.extend(pool.submit(_judge_all, one, b) for b in islice(batches, 1))


def _judge_all(one: Callable[[int], Verdict], schedules: Sequence[int]) -> list[Verdict]:
    return [one(schedule) for schedule in schedules]


def fails(mission: Mission, faults: Faults, method: str = PLAN) -> bool:
    """Say whether a mission, planned anew, breaks a promise or blocks under a schedule."""
    plan = first_plan(mission, planner_of(method))
    _, outcome, violations = play(mission, plan, faults, method=method)
    return bool(violations) or outcome.status == "blocked"
