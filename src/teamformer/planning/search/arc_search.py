"""A search for plans as graphs of arcs: where it stands, the best plan since it began, its heat."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from random import Random
from typing import Any

import numpy as np

from teamformer.planning.dispatch.futures import first_plan
from teamformer.planning.graph.arc_problem import StepRules, pose_arcs
from teamformer.planning.graph.graph import COST, LEADS, empty_graph, lay, plan_of
from teamformer.planning.graph.ledger import BEST, NOW, open_ledger
from teamformer.planning.operators.state import empty_state
from teamformer.planning.operators.table import shares_of
from teamformer.planning.problem.batteries import are_charged
from teamformer.planning.problem.charged_ways import RESCUE
from teamformer.planning.problem.coalition_plan import CoalitionPlan, with_seats, without_tasks
from teamformer.planning.problem.coalition_problem import NEVER, CoalitionProblem
from teamformer.planning.problem.links import have_weights
from teamformer.planning.problem.misses import LEFT_OUT, can_miss
from teamformer.planning.race import Race, search_by_clock
from teamformer.planning.search.annealing import anneal, copy_graph
from teamformer.world.rules.chance import SLACKS

HOT, COLD = 20, 800
"""An annealing begins and ends at what a task takes a robot on average, divided by these."""

FEW_TASKS, HOT_IF_FEW, COLD_IF_FEW = 30, 8, 80
"""With fewer tasks than the first of these it is divided by the others: one moved task changes more
of a small plan, so that more has to get worse before it gets better."""

ROUNDS_EACH, FEW_ANNEALINGS = 9_000, 2
"""The shared plan of few tasks takes so many rounds for each task, so many times."""

HOT_IF_WEIGHED, COOLER, COOLINGS = 2, 0.96, 100
"""If plans have a cost an annealing begins at what a visit costs on average, times the first of
these, and is cooled down by the second so many times, to a sixtieth."""

QUENCHED = 40
"""Rounds for each task without heat, before the first annealing: what a plan costs then says how
hot it begins."""

QUENCHED_IF_CHARGED = 500
"""The same where robots have batteries."""

HOTTER_IF_CHARGED = 2
"""If robots charge, annealings begin hotter by this factor than those of few tasks, however many
there are. A moved task changes where they charge later, so it changes more of a plan."""

WEIGHED_ROUNDS_EACH, MOST_WEIGHED_ROUNDS = 20_000, 600_000
"""The shared plan takes so many rounds for each task then, and so many at most: about a second."""

SHORTER, SHORTER_IF_MANY = 5, 10
"""After news the rounds are so many times fewer than those of the shared plan: the first of these
if it has few tasks, or a cost, the other if it takes a second."""

LESS_HOT, LESS_HOT_IF_WEIGHED = 3, 8
"""They begin less hot, too, the last of these if plans have a cost."""

TRIES = 100
"""How many first plans are begun before nobody is said to be able: linked tasks take robots from
one another."""


def has_few_tasks(tasks: int) -> bool:
    """Say whether a problem of so many tasks is so small that it is searched hotter."""
    return tasks < FEW_TASKS


def rounds_of_a_second(tasks: int) -> int:
    """Return how many rounds take a second of one core, about."""
    return 880_000_000 // (350 + tasks)


class ArcSearch:
    """A search: the graph where it stands, the best one since it began, and room to work in."""

    def __init__(
        self, problem: CoalitionProblem, seed: int, steps: StepRules | None = None
    ) -> None:
        self.problem = problem
        self.arcs = pose_arcs(problem, steps)
        self.state = empty_state(problem, self.arcs, steps, seed)
        self.graph, self._best = self.state.graph, empty_graph(problem, steps)
        self._is_weighed = have_weights(problem.links)
        self._shares, self._draws = shares_of(problem, steps), Random(seed)

    def begin_anew(self) -> bool:
        """Make a first plan; say whether every task has an able coalition."""
        for number in range(TRIES):
            plan = first_plan(self.problem, self._draws if number else None)
            if plan is not None and self.begin_at(plan):
                return True
        return False

    def begin_at(self, plan: CoalitionPlan) -> bool:
        """Stand at a plan; say whether nobody waits in it for ever.

        Who can be spared is left out where there are not enough seats.
        """
        seated = with_seats(self.problem, plan, int(self.arcs.most[0]))
        if not self._lay(seated):
            return False
        while late := self._late():
            seated = without_tasks(self.problem.before, seated, late)
            if not self._lay(seated):
                return False
        copy_graph(self.graph, self._best)
        for costs in (self.state.ledger.cost, self.state.ledger.lead):
            costs[BEST] = costs[NOW]
        return True

    def _lay(self, plan: CoalitionPlan) -> bool:
        """Lay a plan out; say whether nobody waits in it for ever."""
        lay(self.arcs, self.graph, plan, np.zeros(len(self.problem.counts), np.int64))
        return self._open()

    def _late(self) -> list[int]:
        """Return the optional tasks that the plan has end too late.

        If none does, return those after which robots are not home by the end of their shifts.
        """
        if not can_miss(self.problem.misses):
            return []
        nodes, worth, tasks = self.graph.nodes, self.graph.worth, len(self.problem.needs)
        is_late = (nodes.taken[:tasks] > 0) & (nodes.end[:tasks] > worth.until)
        late = is_late & (worth.is_optional > 0)
        if late.any() or not self._is_late(int(self.graph.back.max())):
            return [int(task) for task in np.flatnonzero(late)]
        seats, homes = self.graph.seats, len(self.graph.seats) - len(self.graph.back)
        is_late_home = self.graph.back >= self.problem.rotas.late[0]
        last = seats.node[seats.prev[homes:][is_late_home]]
        return [int(task) for task in np.unique(last) if task < tasks and worth.is_optional[task]]

    def begin_at_best(self) -> None:
        """Go back to the best plan."""
        copy_graph(self._best, self.graph)
        self._open()

    def _open(self) -> bool:
        """Work out what the plan costs that the graph holds; say if its times come to an end."""
        return bool(open_ledger(self.arcs, self.graph, self.state.trial, self.state.ledger))

    @property
    def heats(self) -> tuple[float, float]:
        """Return where an annealing begins and ends."""
        if self._is_weighed:
            visits = max(1, int(self.graph.nodes.taken.sum()))
            lead = float(self.state.ledger.lead[NOW])
            hot = HOT_IF_WEIGHED * (
                self.leg if self._is_late(lead) or self._is_dry else lead / visits
            )
            return hot, hot * COOLER**COOLINGS
        is_few = has_few_tasks(len(self.problem.needs)) or are_charged(self.problem.batteries)
        hottest, coldest = (HOT_IF_FEW, COLD_IF_FEW) if is_few else (HOT, COLD)
        return self.leg // hottest, self.leg // coldest

    @property
    def leg(self) -> int:
        """Return the ticks that a task takes a robot on average, with the way there.

        If plans have a cost, or one cannot be carried out, it is the ticks of a task, with half of
        the way to a near one.
        """
        if self._is_weighed or self._is_late(int(self.graph.total[COST])):
            near = self.arcs.near
            ways = np.take_along_axis(self.arcs.ways[0][: len(near)], near, axis=1)
            way = float(ways.mean()) if ways.size else 0.0
            return max(1, int(self.problem.duration.mean() + way / 2))
        visits, total = max(1, int(self.graph.nodes.taken.sum())), self.graph.total
        if self._is_dry:
            return max(1, int(self.problem.duration.mean()) + int(self.arcs.ways[0].mean()))
        return max(1, int(total[COST] - total[LEADS]) * len(self.problem.counts) // visits)

    def _is_late(self, cost: float) -> bool:
        """Say whether a plan takes longer than any does that keeps to the shifts of its robots."""
        return bool(cost >= self.problem.rotas.late.min(initial=NEVER))

    @property
    def _is_dry(self) -> bool:
        """Say whether somebody runs dry in the plan."""
        nodes = self.graph.nodes
        ends = nodes.end[nodes.end < LEFT_OUT].max(initial=0)
        is_rescued = max(int(ends), int(self.graph.back.max(initial=0))) >= RESCUE
        return is_rescued and are_charged(self.problem.batteries)

    def anneal(self, hot: float, cold: float, begin: int, end: int, rounds: int) -> None:
        """Make the rounds from `begin` to `end` of so many, from `hot` to `cold`."""
        parts = (self.state, self._best, self._shares, SLACKS)
        anneal(self.arcs, *parts, self.leg, float(hot), float(cold), begin, end, rounds)

    def anneal_shared(self) -> None:
        """Make the rounds of the plan that every robot computes for itself, from a first plan."""
        if self._is_weighed:
            self.quench()
            self._cool(self.heats[0], sum(self._shared_rounds))
            return
        for rounds in self._shared_rounds:
            self.anneal(*self.heats, 0, rounds, rounds)
            self.begin_at_best()

    def anneal_again(self) -> None:
        """Make the rounds of that plan after news, from what is left of the old one."""
        is_quick = self._is_weighed or has_few_tasks(len(self.problem.needs))
        rounds = sum(self._shared_rounds) // (SHORTER if is_quick else SHORTER_IF_MANY)
        hot, cold = self.heats
        if self._is_weighed:
            self._cool(hot / LESS_HOT_IF_WEIGHED, rounds)
        else:
            self.anneal(max(cold, hot // LESS_HOT), cold, 0, rounds, rounds)

    def anneal_in_parts(self, searches: int, parts: int, is_again: bool) -> Iterator[None]:
        """Make one of so many parts of the rounds of the shared plan, and stop after each of these.

        It begins with a quench, after which hardly anybody runs dry; `is_again` is less hot.
        """
        self.quench(QUENCHED_IF_CHARGED)
        rounds, (hot, cold) = sum(self._shared_rounds) // searches, self.heats
        if self._is_weighed:
            hot /= LESS_HOT_IF_WEIGHED if is_again else 1
            for part in range(parts):
                coolings = range(COOLINGS * part // parts, COOLINGS * (part + 1) // parts)
                self._cool(
                    hot * COOLER ** coolings[0], rounds * len(coolings) // COOLINGS, coolings
                )
                yield
            return
        hot *= HOTTER_IF_CHARGED
        heats = (max(cold, hot / LESS_HOT) if is_again else hot, cold)
        for part in range(parts):
            self.anneal(*heats, rounds * part // parts, rounds * (part + 1) // parts, rounds)
            yield

    @property
    def _shared_rounds(self) -> list[int]:
        """Return how many rounds each annealing of the shared plan takes."""
        tasks = len(self.problem.needs)
        if self._is_weighed:
            return [min(MOST_WEIGHED_ROUNDS, WEIGHED_ROUNDS_EACH * tasks)]
        is_few = has_few_tasks(tasks)
        return [ROUNDS_EACH * tasks] * FEW_ANNEALINGS if is_few else [rounds_of_a_second(tasks)]

    def _cool(self, heat: float, rounds: int, coolings: Sequence[int] = range(COOLINGS)) -> None:
        """Make so many rounds, cooler each time."""
        for _ in coolings:
            self.anneal(heat, heat, 0, rounds // len(coolings), rounds // len(coolings))
            heat *= COOLER

    def quench(self, rounds_each: int = QUENCHED) -> None:
        """Take whatever is better, without heat, for some rounds for each task."""
        rounds = rounds_each * len(self.problem.needs)
        self.anneal(0, 0, 0, rounds, rounds)

    def anneal_until(
        self,
        deadline: float,
        race: Race[Any],
        offer: Callable[[], None],
        heats: tuple[float, float],
        rounds: float = math.inf,
    ) -> None:
        """Anneal from one heat to another until `time.perf_counter` shows the deadline.

        The end of the race or so many rounds end it sooner. Each better plan is offered.
        """

        def anneal_at(passed: float, rounds: int) -> None:
            heat = self._heat_at(passed, heats)
            self.anneal(heat, heat, 0, rounds, rounds)

        search_by_clock(anneal_at, lambda: self.rank, deadline, race, offer, rounds)

    def _heat_at(self, passed: float, heats: tuple[float, float]) -> float:
        """Return the heat when a share of an annealing has passed.

        It falls by as much each time or, if plans have a cost, by as large a part.
        """
        hot, cold = heats
        if self._is_weighed:
            return hot * COOLER ** (COOLINGS * passed)
        return hot + int((cold - hot) * passed)

    @property
    def rank(self) -> tuple[float, float]:
        """Return what the best plan is compared by: what it is judged by, then what leads on."""
        return float(self.state.ledger.cost[BEST]), float(self.state.ledger.lead[BEST])

    @property
    def present(self) -> CoalitionPlan:
        """Return the plan where it stands."""
        return plan_of(self.problem, self.arcs, self.graph)

    @property
    def best(self) -> CoalitionPlan:
        """Return the best plan."""
        return plan_of(self.problem, self.arcs, self._best)
