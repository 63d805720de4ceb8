"""Jobs: the trials that one process runs in one go, and the rows that come of them."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from teamformer.bench.rows import Row
from teamformer.bench.suites import player_of
from teamformer.model import Scenario
from teamformer.planning.bounds.makespan import lower_bound
from teamformer.policies import POLICIES
from teamformer.policies.protocol import Planner, Policy
from teamformer.scenarios.authors import read_world
from teamformer.scenarios.named_settings import world_of
from teamformer.sim.arrays import Array
from teamformer.sim.env import Decision, Tally
from teamformer.sim.view import View
from teamformer.trials.list_schedule import list_schedule
from teamformer.trials.registry import load_policy
from teamformer.trials.trial import begin_trials, run_trials
from teamformer.truth import draw_truth


@dataclass(frozen=True)
class Job:
    """Trials of one policy in one setting.

    `worlds` is the file that the worlds are read from, None if they are generated. Trials that are
    `timed` run one by one, others side by side. `with_bars` asks for the lower bound and the list
    schedule of each world too.
    """

    suite: str
    setting: str
    policy: str
    seeds: tuple[int, ...]
    time_limit: float
    code: str
    is_timed: bool = True
    with_bars: bool = False
    worlds: Path | None = None
    rules: Mapping[str, str | int] = field(default_factory=dict)

    def scenario(self, seed: int) -> Scenario:
        """Return the world of a trial, under the rules of the suite."""
        if self.worlds is None:
            scenario = world_of(self.setting, seed)
        else:
            scenario = read_world(self.worlds, seed).scenario
        return replace(scenario, **dict(self.rules))  # type: ignore[arg-type]


class Clock:
    """A policy that is timed; stands between the environment and the policy itself."""

    def __init__(self, policy: Policy, worlds: int) -> None:
        self.policy, self.needs_everything = policy, policy.needs_everything
        self.seconds = np.zeros(worlds)
        self.cpu_seconds = np.zeros(worlds)
        self.decisions = np.zeros(worlds, dtype=np.int64)

    def begin(self, everything: Sequence[Scenario] | None, rng: np.random.Generator) -> None:
        """Start the policy; what that takes is shared out evenly."""
        with self._sharing_evenly():
            self.policy.begin(everything, rng)

    def begin_in(
        self, truths: Sequence[Scenario], seen: Sequence[Scenario], rng: np.random.Generator
    ) -> Sequence[Scenario]:
        """Start the policy as trials do, likewise."""
        with self._sharing_evenly():
            return begin_trials(self.policy, truths, seen, rng)

    def decide(self, view: View) -> Decision:
        """Let the policy decide; what that takes is shared out by rows of the view."""
        began, began_cpu = time.perf_counter(), time.process_time()
        decision = self.policy.decide(view)
        rows = np.bincount(view.world, minlength=len(self.seconds))
        self._share_out(rows / rows.sum(), began, began_cpu)
        self.decisions += rows
        return decision

    @contextmanager
    def _sharing_evenly(self) -> Iterator[None]:
        began, began_cpu = time.perf_counter(), time.process_time()
        yield
        even = np.full(len(self.seconds), 1 / len(self.seconds))
        self._share_out(even, began, began_cpu)

    def _share_out(self, shares: Array, began: float, began_cpu: float) -> None:
        self.seconds += shares * (time.perf_counter() - began)
        self.cpu_seconds += shares * (time.process_time() - began_cpu)


def run_job(job: Job) -> list[Row]:
    """Run the trials of a job."""
    policy = ready_policy(player_of(job.policy), job.time_limit)
    worlds = {seed: job.scenario(seed) for seed in job.seeds}
    _warm_up(job, policy)
    parts = [[seed] for seed in job.seeds] if job.is_timed else [list(job.seeds)]
    rows = []
    for seeds in parts:
        clock = Clock(policy, len(seeds))
        began = time.perf_counter()
        tallies = run_trials([worlds[seed] for seed in seeds], clock, seeds[0], truth_seeds=seeds)
        seconds = (time.perf_counter() - began) / len(seeds)
        for place, seed in enumerate(seeds):
            row = _row(job, seed, worlds[seed], tallies[place])
            row = replace(row, total_seconds=round(seconds, 6), side_by_side=len(seeds))
            rows.append(_timed(row, clock, place))
    return [_with_bars(row, worlds[row.world_seed]) for row in rows] if job.with_bars else rows


@lru_cache(maxsize=16)
def ready_policy(name: str, time_limit: float) -> Policy:
    """Return a policy by name, kept for the next job; a planner is given its time, one thread."""
    policy = load_policy(name, POLICIES)
    if isinstance(policy, Planner):
        policy.time_limit = time_limit
        policy.workers = 1
    return policy


_WARM: set[tuple[str, str]] = set()
"""Policies and settings that have had a trial in this process."""


def _warm_up(job: Job, policy: Policy) -> None:
    """Run a trial that does not count, so that loading compiled code is not timed."""
    if (job.policy, job.setting) in _WARM:
        return
    _WARM.add((job.policy, job.setting))
    scenario = job.scenario(job.seeds[0])
    if policy.needs_everything:  # planning takes as long as it may
        scenario = world_of(f"{len(scenario.robots)}N1T-C{len(scenario.capabilities)}", 0)
    run_trials([scenario], policy)


def known_row(job: Job, seed: int, scenario: Scenario, makespan: int | None) -> Row:
    """Return the row of a trial of which nothing but the makespan is known; None: it failed."""
    return Row(
        suite=job.suite,
        setting=job.setting,
        world_seed=seed,
        scenario=scenario.name,
        policy=job.policy,
        seed=seed,
        completed=makespan is not None,
        makespan=makespan,
        steps=makespan,
        tasks_done=None,
        tasks=len(scenario.tasks),
        robots=len(scenario.robots),
        capabilities=len(scenario.capabilities),
        order=scenario.order,
        allocation=scenario.allocation,
        joins=None,
        splits=None,
        illegal_decisions=None,
        decisions=None,
        decision_seconds=None,
        decision_cpu_seconds=None,
        total_seconds=None,
        side_by_side=1,
        best_known=None,
        lower_bound=None,
        list_schedule=None,
        relaxed=None,
        relaxed_bound=None,
        curve=None,
        time_limit=None,
        code=job.code,
        rerun=rerun_command(job, seed),
    )


def _row(job: Job, seed: int, scenario: Scenario, tally: Tally) -> Row:
    makespan = tally.steps if tally.status == "completed" else None
    return replace(
        known_row(job, seed, scenario, makespan),
        steps=tally.steps,
        tasks_done=tally.tasks_done,
        joins=tally.joins,
        splits=tally.splits,
        illegal_decisions=tally.illegal_decisions,
    )


def _timed(row: Row, clock: Clock, place: int) -> Row:
    """Add what the clock says of a trial and, of a planner, what it found."""
    row = replace(
        row,
        decisions=int(clock.decisions[place]),
        decision_seconds=round(float(clock.seconds[place]), 6),
        decision_cpu_seconds=round(float(clock.cpu_seconds[place]), 6),
    )
    if not isinstance(clock.policy, Planner):
        return row
    plan = clock.policy.plans[place]
    return replace(
        row,
        time_limit=clock.policy.time_limit,
        lower_bound=plan.bound,
        relaxed=plan.solution.value,
        relaxed_bound=plan.solution.bound,
        curve=[[round(seconds, 3), steps] for seconds, steps in plan.curve],
    )


def _with_bars(row: Row, scenario: Scenario) -> Row:
    truth = draw_truth(scenario, row.seed)
    bound = max(lower_bound(truth), row.lower_bound or 0)
    return replace(row, lower_bound=bound, list_schedule=list_schedule(truth))


def rerun_command(job: Job, seed: int) -> str:
    """Return the command that runs this one trial again."""
    rules = {key: job.rules[key] for key in ("order", "allocation") if key in job.rules}
    options: dict[str, object] = {
        "worlds": job.worlds,
        "settings": job.setting,
        "policies": job.policy,
        "seed": seed,
        "trials": 1,
        **rules,
        "time-limit": f"{job.time_limit:g}" if job.policy == "central" else None,
    }
    said = [f"--{key} {value}" for key, value in options.items() if value is not None]
    return f"teamformer bench {job.suite} {' '.join(said)} --json"
