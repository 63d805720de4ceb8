"""What the rows of each method in each setting come to."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from teamformer.bench.rows import Row
from teamformer.bench.statistics import Mean, mean_of, wilson

BASELINES = ("heuristic", "join-all", "authors-heuristic")
"""What every method is compared with, world by world."""

CENTRAL = "central"

PLAN = "plan"
"""What methods are compared with where `central` has not planned."""

HOPEFUL = "plan@needed"
"""What makes its plan anew at every event and takes all that may be needed as needed.

Between it and `central`, which knows the truth, lies the room that there is to be won.
"""


@dataclass(frozen=True)
class Summary:
    """One method in one setting.

    `makespan` and `cost` are over completed trials only, as the paper has it; `missed` and `steps`
    over all, a failure counting as its step limit. `against` holds, for each baseline, the
    difference of makespans over the worlds that both completed; `to_central` is that to `central`
    as a part of its mean, and `cost_to_central` the same of costs.
    `room` is the part of the steps between `HOPEFUL` and `central` that is won, on the worlds that
    all three completed.
    `inference` is the CPU time that deciding took in a trial, `waiting` the time by the clock, both
    over completed trials that ran alone. `to_best` and `to_bound` are ratios of the makespan to the
    best known and to the lower bound of the same world, less one; they are over worlds that a
    planner has planned, where there are such. `to_list` is the difference to the list schedule. The
    means after that are of the worlds, whatever the method.
    """

    setting: str
    method: str
    trials: int
    failures: int
    makespan: Mean
    cost: Mean  # of missions that have one
    missed: Mean  # the weight of what was missed, of missions with `until`
    steps: Mean
    against: Mapping[str, Mean]
    to_central: Mean
    to_plan: Mean  # the same to `plan`, where `central` has not planned
    cost_to_central: Mean
    room: Mean
    inference: Mean
    waiting: Mean
    to_best: Mean
    to_bound: Mean
    to_list: Mean
    illegal: int
    lower_bound: Mean
    list_schedule: Mean
    best_known: Mean
    relaxed: Mean
    proven: int  # worlds in which the planner's schedule was proven optimal

    @property
    def failure_interval(self) -> tuple[float, float]:
        """Return the 95% interval of the failure rate."""
        return wilson(self.failures, self.trials)


def summarise(rows: Iterable[Row]) -> list[Summary]:
    """Return a summary for each setting and method, in the order in which the rows have them."""
    cells: dict[tuple[str, str], list[Row]] = defaultdict(list)
    for row in rows:
        cells[row.setting, row.method].append(row)
    makespans = {
        cell: {row.world_seed: row.makespan for row in cells[cell] if row.makespan is not None}
        for cell in cells
    }
    costs = {
        cell: {row.world_seed: row.cost for row in cells[cell] if row.cost is not None}
        for cell in cells
    }
    planned: dict[str, set[int]] = defaultdict(set)
    for (setting, _), found in cells.items():
        planned[setting] |= {row.world_seed for row in found if row.relaxed is not None}
    return [
        _summary(
            cells[setting, method],
            planned[setting],
            {
                bar: differences(makespans[setting, method], makespans[setting, bar])
                for bar in BASELINES
                if bar != method and (setting, bar) in makespans
            },
            share_of(makespans[setting, method], makespans.get((setting, CENTRAL), {})),
            share_of(
                makespans[setting, method],
                {} if (setting, CENTRAL) in makespans else makespans.get((setting, PLAN), {}),
            ),
            share_of(costs[setting, method], costs.get((setting, CENTRAL), {})),
            room_won(
                makespans[setting, method],
                makespans.get((setting, HOPEFUL), {}),
                makespans.get((setting, CENTRAL), {}),
            ),
        )
        for setting, method in cells
    ]


def on_shared_worlds(rows: Sequence[Row]) -> list[Row]:
    """Return, of each setting, the rows of worlds in which every method there has a trial."""
    methods: dict[str, set[str]] = defaultdict(set)
    played: dict[tuple[str, int], set[str]] = defaultdict(set)
    for row in rows:
        methods[row.setting].add(row.method)
        played[row.setting, row.world_seed].add(row.method)
    return [row for row in rows if played[row.setting, row.world_seed] == methods[row.setting]]


def differences(ours: Mapping[int, float], theirs: Mapping[int, float]) -> Mean:
    """Return the mean of ours less theirs over the worlds that both have."""
    return mean_of([ours[world] - theirs[world] for world in ours if world in theirs])


def share_of(ours: Mapping[int, float], theirs: Mapping[int, float]) -> Mean:
    """Return the mean of ours less theirs as a part of their mean, over the worlds of both."""
    shared = [world for world in ours if world in theirs]
    if not shared:
        return mean_of([])
    whole = sum(theirs[world] for world in shared) / len(shared)
    return mean_of([(ours[world] - theirs[world]) / whole for world in shared])


def room_won(
    ours: Mapping[int, float], hopeful: Mapping[int, float], clairvoyant: Mapping[int, float]
) -> Mean:
    """Return the part of the mean room between two bars that is won, on worlds that all have.

    Nothing where there is no room.
    """
    shared = [world for world in ours if world in hopeful and world in clairvoyant]
    room = sum(hopeful[world] - clairvoyant[world] for world in shared)
    if room <= 0:
        return mean_of([])
    return mean_of([(hopeful[world] - ours[world]) * len(shared) / room for world in shared])


def _summary(
    rows: Sequence[Row],
    planned: set[int],
    against: Mapping[str, Mean],
    to_central: Mean,
    to_plan: Mean,
    cost_to_central: Mean,
    room: Mean,
) -> Summary:
    known = [row for row in rows if row.world_seed in planned or not planned]
    done = [row for row in rows if row.makespan is not None]
    alone = [row for row in done if row.side_by_side == 1]
    return Summary(
        setting=rows[0].setting,
        method=rows[0].method,
        trials=len(rows),
        failures=len(rows) - len(done),
        makespan=_mean(row.makespan for row in done),
        cost=_mean(row.cost for row in done),
        missed=_mean(row.missed for row in rows),
        steps=_mean(row.steps for row in rows),
        against=against,
        to_central=to_central,
        to_plan=to_plan,
        cost_to_central=cost_to_central,
        room=room,
        inference=_mean(row.decision_cpu_seconds for row in alone),
        waiting=_mean(row.decision_seconds for row in alone),
        to_best=_mean(_ratio(row.makespan, row.best_known) for row in known),
        to_bound=_mean(_ratio(row.makespan, row.lower_bound) for row in known),
        to_list=_mean(_difference(row.makespan, row.list_schedule) for row in done),
        illegal=sum(row.illegal_decisions or 0 for row in rows),
        lower_bound=_mean(row.lower_bound for row in known),
        list_schedule=_mean(row.list_schedule for row in rows),
        best_known=_mean(row.best_known for row in known),
        relaxed=_mean(row.relaxed for row in rows),
        proven=sum(row.relaxed is not None and row.relaxed == row.relaxed_bound for row in rows),
    )


def _mean(values: Iterable[float | None]) -> Mean:
    return mean_of([value for value in values if value is not None])


def _ratio(makespan: float | None, bar: float | None) -> float | None:
    return makespan / bar - 1 if makespan is not None and bar else None


def _difference(makespan: float | None, bar: float | None) -> float | None:
    return makespan - bar if makespan is not None and bar is not None else None
