"""Choosing deviations by futures: each is played to the end in truths that may be the real one.

This is a policy with some hundred times the computing of the shared plan: a rollout (Tesauro and
Galperin 1996) of what is near to it. What it promises is measured again in futures that it did not
choose by, as the best of many is often only the luckiest.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from teamformer.bench.measurements.deviations.edits import KINDS, Deviation
from teamformer.bench.measurements.deviations.moments import Moment, moment_in
from teamformer.bench.measurements.deviations.trying import end_of, end_with, follow
from teamformer.mission.rules import BEST_ALLOCATION
from teamformer.model import Scenario
from teamformer.scenarios.named_settings import world_of
from teamformer.sim.env import TeamFormation
from teamformer.truth import draw_truth

OFFERED = 16
"""Deviations that are tried at a moment, drawn at random where there are more."""

FIRST, MORE, FRESH = 4, 8, 16
"""Futures that all are tried in, that the best are besides, and that tell what the chosen gains."""

BEST = 3
"""How many are tried in more futures."""

HASTE = 16
"""So many times shorter is the search for a plan in futures; missions take 2 to 10% longer so."""

LEAST = 0.2
"""Steps that a deviation must promise, besides its standard error, to be chosen."""


@dataclass(frozen=True)
class Chosen:
    """What was chosen at a moment, what it promised, and what it gained in other futures."""

    setting: str
    world: int
    step: int
    plans: int  # that are made in the mission
    offered: int
    kind: str  # empty: nothing
    promised: float
    gain: float


class _Best(NamedTuple):
    deviation: Deviation
    promised: float


def choose_in(setting: str, world: int, moments: int) -> list[Chosen]:
    """Play a mission by the shared plan; at random moments after a plan, choose a deviation."""
    mission = replace(world_of(setting, world), allocation=BEST_ALLOCATION)
    rng = np.random.default_rng([world, moments])
    forks = _after_each_plan(mission, world)
    numbers = sorted(rng.permutation(len(forks))[:moments].tolist())
    nothing = Chosen(setting, world, 0, len(forks), 0, "", 0.0, 0.0)
    return [_choose_at(forks[number], mission, nothing, rng) for number in numbers]


def _after_each_plan(mission: Scenario, world: int) -> list[TeamFormation]:
    env = TeamFormation([mission], truths=[draw_truth(mission, world)])
    forks, planned = [], 0
    while env.is_running[0]:
        plans = int(env.worlds.count["plans"][0])
        if plans > planned:
            forks.append(env.fork())
        planned = plans
        follow(env)
    return forks


def _choose_at(
    env: TeamFormation, mission: Scenario, nothing: Chosen, rng: np.random.Generator
) -> Chosen:
    nothing = replace(nothing, step=int(env.worlds.count["steps"][0]))
    moment = moment_in(env, mission)
    if moment is None or not moment.unseen:
        return nothing
    offers = offers_in(moment, rng)
    nothing = replace(nothing, offered=len(offers))
    best = best_by_futures(env, offers, rng)
    if best is None:
        return nothing
    fresh = gains_in_futures(env, {0: best.deviation}, rng.spawn(FRESH))
    return replace(
        nothing,
        kind=best.deviation.kind,
        promised=best.promised,
        gain=float(np.mean(fresh[0])),
    )


def offers_in(moment: Moment, rng: np.random.Generator) -> list[Deviation]:
    """Return deviations that change what somebody does now, drawn at random if there are many."""
    found = [it for kind in KINDS.values() for it in kind(moment) if _is_at_once(moment, it)]
    return [found[n] for n in sorted(rng.permutation(len(found))[:OFFERED].tolist())]


def _is_at_once(moment: Moment, deviation: Deviation) -> bool:
    """Say whether robots that are free now do something else by it than by the plan."""
    robots = deviation.robots
    if any(moment.free_at(robot) > moment.facts.step for robot in robots):
        return False
    if deviation.kind == "take along":
        return not moment.tasks_of(robots[0])
    return deviation.kind != "leave out" or moment.tasks_of(robots[0])[0] == deviation.task


def best_by_futures(
    env: TeamFormation, offers: list[Deviation], rng: np.random.Generator
) -> _Best | None:
    """Return the deviation with the best mean over sampled futures, if it promises enough.

    All are played in the same few futures, and the best of them in more.
    """
    gains = gains_in_futures(env, dict(enumerate(offers)), rng.spawn(FIRST))
    ahead = sorted(gains, key=lambda number: -np.mean(gains[number]))[:BEST]
    ahead = [number for number in ahead if np.mean(gains[number]) > 0]
    if not ahead:
        return None
    more = gains_in_futures(env, {number: offers[number] for number in ahead}, rng.spawn(MORE))
    best = max(ahead, key=lambda number: sum(gains[number]) + sum(more[number]))
    won = np.array(gains[best] + more[best])
    error = won.std(ddof=1) / np.sqrt(len(won))
    return _Best(offers[best], float(won.mean())) if won.mean() > max(LEAST, error) else None


def gains_in_futures(
    env: TeamFormation, offers: Mapping[int, Deviation], rngs: Iterable[np.random.Generator]
) -> dict[int, list[int]]:
    """Return by how many steps a mission ends earlier with each deviation, in each future."""
    gains: dict[int, list[int]] = {number: [] for number in offers}
    for rng in rngs if offers else ():
        future = env.imagine(rng, HASTE)
        without = end_of(future.fork()).steps
        for number, deviation in offers.items():
            gains[number].append(without - end_with(future.fork(), deviation).steps)
    return gains
