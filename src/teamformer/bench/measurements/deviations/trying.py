"""Trying deviations in forks of a mission: each is played on to the end and compared with it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from teamformer.bench.measurements.deviations.edits import (
    KINDS,
    Deviation,
    draw_deviation,
    features_of,
)
from teamformer.bench.measurements.deviations.moments import moment_in
from teamformer.mission.rules import BEST_ALLOCATION
from teamformer.model import Scenario
from teamformer.policies.scripted.follow_plan import FollowPlan
from teamformer.scenarios.named_settings import world_of
from teamformer.sim.env import Tally, TeamFormation
from teamformer.truth import draw_truth

SHARE = 0.5
"""Of the plans of a mission, those that are deviated from."""

FOLDS = 5
"""Worlds are dealt out into so many parts; what is said about one is learned from the others."""


@dataclass(frozen=True)
class Tried:
    """A deviation, and by how many steps the mission ended earlier with it."""

    setting: str
    world: int
    step: int
    kind: str
    gain: int
    features: tuple[float, ...]

    @property
    def fold(self) -> int:
        """Return the part that its world belongs to."""
        return self.world % FOLDS


def try_deviations(setting: str, world: int, tries: int) -> list[Tried]:
    """Play a mission by the shared plan, and again with one deviation each, so many times.

    Where the plan made at a step is deviated from, it is so for once: whenever something shows, all
    plan anew as ever. The truth is the same in all forks; the world's number draws it. Nothing is
    returned for a mission that does not end.
    """
    mission = replace(world_of(setting, world), allocation=BEST_ALLOCATION)
    rng = np.random.default_rng([world, tries])
    env = TeamFormation([mission], truths=[draw_truth(mission, world)])
    offers: list[tuple[TeamFormation, Deviation, Tried]] = []
    planned = 0
    while env.is_running[0]:
        plans = int(env.worlds.count["plans"][0])
        if plans > planned and rng.random() < SHARE:
            offers += _offers_in(env, mission, Tried(setting, world, 0, "", 0, ()), rng)
        planned = plans
        follow(env)
    ended = env.tally()
    if ended.status != "completed":
        return []
    found = []
    for number in sorted(rng.permutation(len(offers))[:tries].tolist()):
        fork, deviation, tried = offers[number]
        other = end_with(fork, deviation)
        if other.status == "completed":
            found.append(replace(tried, gain=ended.steps - other.steps))
    return found


def _offers_in(
    env: TeamFormation, mission: Scenario, tried: Tried, rng: np.random.Generator
) -> list[tuple[TeamFormation, Deviation, Tried]]:
    """Return a deviation from the plan just made, with a fork to try it in, if there is one."""
    moment = moment_in(env, mission)
    if moment is None:
        return []
    kind = str(rng.choice(tuple(KINDS)))
    deviation = draw_deviation(moment, kind, rng)
    if deviation is None:
        return []
    features = features_of(moment, deviation)
    tried = replace(tried, step=moment.facts.step, kind=kind, features=features)
    return [(env.fork(), deviation, tried)]


def end_with(env: TeamFormation, deviation: Deviation) -> Tally:
    """Return how a mission ends if it goes on with a deviation."""
    env.take_over_plan(deviation.plan)
    return end_of(env)


def end_of(env: TeamFormation) -> Tally:
    """Return how a mission ends if it goes on by the shared plan."""
    while env.is_running[0]:
        follow(env)
    return env.tally()


def follow(env: TeamFormation) -> None:
    """Make one step by the shared plan."""
    env.step(FollowPlan().decide(env.view()))
