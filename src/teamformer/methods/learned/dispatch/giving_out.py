"""Gives out the tasks of problems one by one, each by the offer that a network scores highest."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from teamformer.base.array_types import Array
from teamformer.methods.learned.dispatch.offers import (
    FEATURES,
    MOST_OFFERS,
    Dispatcher,
    OfferFeature,
    accept_offer,
    empty_dispatcher,
    make_offers,
)
from teamformer.planning.dispatch.futures import begin_dispatch, leg_of, play_out
from teamformer.planning.problem.coalition_problem import CoalitionProblem
from teamformer.planning.problem.schedule import Schedule, empty_schedule

Scorer = Callable[[Array, Array], Array]
"""From features (states, offers, FEATURES) and counts (states,), scores (states, offers)."""

Chooser = Callable[[list[int], int, Array, Array], Array]
"""From problems (numbers), the position, features and scores of what is on offer to each, the
offers that are accepted, (problems,)."""

MOST_GIVEN = 80
"""So many tasks are given out by the network; the rule `soonest` plays out what is left then."""


@dataclass(frozen=True)
class GivingOut:
    """A problem whose tasks are given out: what is given out stands in `schedule`."""

    problem: CoalitionProblem
    schedule: Schedule
    dispatcher: Dispatcher
    leg: int  # ticks that a task takes a robot on average

    @classmethod
    def of(cls, problem: CoalitionProblem, schedule: Schedule | None = None) -> Self:
        """Begin with nothing given out; a schedule may say when robots are free."""
        begun = empty_schedule(problem) if schedule is None else schedule
        begin_dispatch(problem, begun)
        return cls(problem, begun, empty_dispatcher(problem), max(1, leg_of(problem)))

    @property
    def tasks(self) -> int:
        """Return how many tasks there are."""
        return len(self.problem.needs)

    def offer(self, position: int) -> int:
        """Work out what is on offer at a position; return how many offers there are."""
        parts = self.problem, self.schedule, self.dispatcher
        count: int = make_offers(*parts, position, self.leg)
        return count

    def accept(self, offer: int, position: int) -> None:
        """Have an offer done next."""
        accept_offer(self.problem, self.schedule, self.dispatcher, offer, position)


def likeliest(rows: list[int], position: int, features: Array, scores: Array) -> Array:
    """Choose the offer with the highest score."""
    best: Array = scores.argmax(axis=1)
    return best


def by_chance(rng: np.random.Generator, heat: float) -> Chooser:
    """Return a chooser to whom the chance of an offer is the exponential of its score by `heat`."""

    def choose(rows: list[int], position: int, features: Array, scores: Array) -> Array:
        best: Array = (scores + heat * rng.gumbel(size=scores.shape)).argmax(axis=1)
        return best

    return choose


def give_out_all(
    problems: Sequence[GivingOut], score: Scorer, choose: Chooser = likeliest
) -> Array:
    """Give out all tasks of some problems, side by side; return which could be, (problems,) bool.

    Scores of what is not on offer, and of second offers of the same robots, are -inf.
    """
    could = np.ones(len(problems), np.bool_)
    last = max((min(one.tasks, MOST_GIVEN) for one in problems), default=0)
    features = np.zeros((len(problems), MOST_OFFERS, FEATURES), np.float32)
    for position in range(last):
        rows = [
            n
            for n, one in enumerate(problems)
            if could[n] and position < min(one.tasks, MOST_GIVEN)
        ]
        count = np.array([problems[n].offer(position) for n in rows], np.int64)
        for row, n in enumerate(rows):
            features[row] = problems[n].dispatcher.offers.features
        seen = features[: len(rows)]
        scores = score(seen, count)
        scores[~are_choices(seen, count)] = -np.inf
        chosen = choose(rows, position, seen, scores).tolist()
        for n, offers, offer in zip(rows, count.tolist(), chosen, strict=True):
            if offers:
                problems[n].accept(offer, position)
            could[n] &= offers > 0
    for n, one in enumerate(problems):
        if could[n] and one.tasks > MOST_GIVEN:
            could[n] = play_out(one.problem, one.schedule, one.dispatcher.first, MOST_GIVEN)
    return could


def are_choices(features: Array, count: Array) -> Array:
    """Return which offers there are, (states, offers), second ones of the same robots left out."""
    is_offer = np.arange(features.shape[1]) < count[:, None]
    is_alike, is_second = (
        features[..., OfferFeature.IS_ALIKE],
        features[..., OfferFeature.IS_SPARING],
    )
    chosen: Array = is_offer & (is_alike * is_second == 0)
    return chosen
