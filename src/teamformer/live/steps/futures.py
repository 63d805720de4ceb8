"""A mission in steps played ahead: its past is played again under each truth that could be.

Where the past comes out as it did, the mission is played to its end.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from teamformer.live.running.forecasts import IsOver, Played
from teamformer.live.running.possible_truths import Seen, possible_truth
from teamformer.methods.by_name import Method
from teamformer.methods.coordinators.replayed import Replayed
from teamformer.mission.coordination import Coordinator, Plan
from teamformer.mission.model import Mission
from teamformer.mission.parts.grid import Grid, Place
from teamformer.planning.steps.longer_search import search_longer
from teamformer.trials.trial import decide
from teamformer.world.env import Decision, TeamFormation
from teamformer.world.rules.constants import NOBODY


@dataclass(frozen=True)
class PastInSteps:
    """The present of a mission in steps, and how it came about."""

    mission: Mission
    env: TeamFormation
    begin: Callable[[], Method]
    decisions: Sequence[Decision]
    plans: Sequence[tuple[int, Plan]]  # taken over after so many steps

    @property
    def tasks(self) -> tuple[int, int]:
        """Return how many tasks there are but for those that are to appear yet, and with these."""
        return _tasks_known(self.env), len(self.env.missions[0].tasks)

    @property
    def is_planned(self) -> bool:
        """Say whether robots go by plans of a coordinator."""
        return bool(self.env.is_coordinated[0])

    def play_ahead(self, is_over: IsOver) -> Played:
        """Play to the end, or until nobody wants to know any more."""
        env, method = self.env.fork(), self.begin()
        while env.is_running[0] and not is_over():
            env.step(decide(env, method, env.view()))
        ends = env.worlds.tasks["done_at"][0].tolist()
        done_at = [None if step == NOBODY else step for step in ends]
        return Played(env.tally().status, env.tally().steps, done_at)

    def future(self, seed: int) -> PastInSteps | None:
        """Return the present under a truth that is drawn; None if the past would be another."""
        env = _future(self, seed)
        return None if env is None else replace(self, env=env)

    def possible_truth(self, seed: int) -> Mission:
        """Draw a truth that could be behind what has been seen so far."""
        env, seen = self.env, partial(seen_in, self.env)
        return possible_truth(self.mission, env.truths[0], env.tally().steps, seen, seed)

    def with_plan(self, plan: Plan) -> PastInSteps:
        """Return the same if a plan were taken over now."""
        env, steps = self.env.fork(), self.env.tally().steps
        env.take_over_plan(plan)
        return replace(self, env=env, plans=(*self.plans, (steps, plan)))

    def search_plan(self, seconds: float, seed: int, is_over: IsOver) -> Plan:
        """Search for a better plan from the present on, as `central` does."""
        return search_longer(self.env.known(), self.env.plan(), seconds, seed, is_over)


def replayed(env: TeamFormation, coordinator: Coordinator | None) -> Coordinator | None:
    """Return a coordinator that gives the plans of an environment again while the same happens."""
    return None if coordinator is None else Replayed(env.plans(), coordinator)


def _tasks_known(env: TeamFormation) -> int:
    """Return how many tasks there are but for those that are to appear at random yet.

    They are the last.
    """
    steps, tasks = env.tally().steps, env.missions[0].tasks
    return sum(not task.has_arrived or task.appears <= steps for task in tasks)


def _future(past: PastInSteps, seed: int) -> TeamFormation | None:
    """Return the present under a truth that is drawn; None if the past would have been another."""
    truth = past.possible_truth(seed)
    coordinator = replayed(past.env, past.begin().coordinator)
    env = TeamFormation([past.mission], truths=[truth], coordinator=coordinator)
    for made, decision in enumerate([*past.decisions, None]):
        for plan in (plan for steps, plan in past.plans if steps == made):
            env.take_over_plan(plan)
        if decision is None:
            break
        view = env.view()
        if not env.is_running[0] or len(view.slot) != len(decision.wanted):
            return None
        env.step(decision)
    if not _looks_alike(env, past.env):
        return None
    luck = env.worlds.robots["luck"]  # who stands still from now on, nobody knows
    luck[:] = np.random.default_rng(seed).integers(1, 2**63, size=luck.shape)
    return env


def _looks_alike(one: TeamFormation, other: TeamFormation) -> bool:
    """Say whether two environments stand alike, as far as anybody can see."""
    fields = {
        "teams": ("x", "y", "size", "serves"),
        "tasks": ("is_open", "served", "done_at", "shown_at", "found_at", "x", "y"),
        "robots": ("team",),
    }
    known = {"tasks": _tasks_known(other)}
    return all(
        np.array_equal(
            getattr(one.worlds, part)[name][:, : known.get(part)],
            getattr(other.worlds, part)[name][:, : known.get(part)],
        )
        for part, names in fields.items()
        for name in names
    )


def seen_in(env: TeamFormation, task: int) -> Seen:
    """Return what has been seen of a task in an environment so far."""
    row = env.worlds.tasks[0][task]
    return Seen(
        places=() if row["found_at"] != NOBODY else _places_left(env, task),
        are_needs_known=bool(row["shown_at"] != NOBODY),
        is_duration_known=bool(row["done_at"] != NOBODY or row["taken_at"] != NOBODY),
        served=int(row["served"]) or None,
    )


def _places_left(env: TeamFormation, task: int) -> list[Place]:
    """Return where a task may be whose place is not known."""
    along = int if isinstance(env.missions[0].world, Grid) else float
    spots = env.worlds.spots[0]
    left = spots[task][spots[task]["is_possible"]] if len(spots) else ()
    return [(along(spot["x"]), along(spot["y"])) for spot in left]
