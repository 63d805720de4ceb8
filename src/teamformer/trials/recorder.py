"""Writes down a trial while it runs: what each step changed, as a record."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from teamformer.base.array_types import Array
from teamformer.mission.checks.rules import FORESIGHTS
from teamformer.mission.coordination import NEWS
from teamformer.mission.parts.capabilities import covers
from teamformer.mission.parts.plane import Plane
from teamformer.mission.parts.reach import totals_by_region
from teamformer.mission.truth import truth_until
from teamformer.record.decisions import rows_of
from teamformer.record.phases import CHARGING, QUEUEING
from teamformer.record.record import Ending, Record, SharedPlanMade, Step, TaskAt, TeamAt, Wants
from teamformer.record.why_missed import why_missed
from teamformer.world.env import Tally, TeamFormation
from teamformer.world.phases.energy import dry_robots
from teamformer.world.rules.constants import NOBODY

Groups = dict[int, tuple[int, ...]]
"""The robots of each team, by slot."""


@dataclass(frozen=True)
class _Snapshot:
    teams: Array
    groups: Groups
    has: Array  # (robots, caps)
    tally: Tally
    served: dict[int, tuple[int, ...]]  # by task, who serves it
    left: Array  # (robots,) what each has left
    at_chargers: dict[int, str]  # by robot, what it does there


class Recorder:
    """Records the first world of an environment; call `step()` after each of its steps.

    The totals of the record are those of the last step written down, so that a trial that is cut
    short anywhere, between or inside the two calls too, still leaves a record that agrees with
    itself.
    """

    def __init__(self, env: TeamFormation) -> None:
        self._env = env
        self._mission, self._truth = env.missions[0], env.truths[0]
        self._is_coordinated = bool(env.is_coordinated[0])
        self._foresight = FORESIGHTS[env.worlds.rules["foresight"][0]]
        self._along = float if isinstance(self._mission.world, Plane) else int
        self._steps: list[Step] = []
        self._orders: list[tuple[int, tuple[int, ...]]] = []
        self._shared_plans: list[tuple[int, SharedPlanMade]] = []
        self._scouts: list[tuple[int, tuple[tuple[int, int], ...]]] = []
        self._decisions: list[tuple[int, tuple[Wants, ...]]] = []
        self._standing: dict[int, Wants] = {}
        self._orders_made = 0
        self._before = self._snapshot()
        self._start = tuple(
            (slot, robots, *self._mission.robots[slot].at)
            for slot, robots in sorted(self._before.groups.items())
        )
        self._write_order(0)

    def step(self) -> None:
        """Write down what the step just made has changed."""
        before, after = self._before, self._snapshot(self._before)
        steps = after.tally.steps
        robots, tasks = self._env.worlds.robots[0], self._env.worlds.tasks[0]
        shown = np.flatnonzero(tasks["shown_at"] == steps)
        formed = _groups(robots["formed"])
        is_lost = (robots["formed"] != NOBODY) & (robots["team"] == NOBODY)
        is_back = (robots["formed"] == NOBODY) & (robots["team"] != NOBODY)
        done = np.flatnonzero(tasks["done_at"] == steps)
        self._steps.append(
            Step(
                joins=self._joins(before.groups, formed),
                splits=_splits(before.groups, formed, after.teams["row"] != NOBODY),
                lost=tuple(np.flatnonzero(is_lost).tolist()),
                back=tuple(np.flatnonzero(is_back).tolist()),
                teams=_changed_teams(before, after, self._along),
                done=tuple((int(k), int(tasks["done_by"][k])) for k in done),
                named=self._named(formed),
                took=_exchanges(self._env.exchanges()),
                shown=tuple(shown.tolist()),
                found=tuple(np.flatnonzero(tasks["found_at"] == steps).tolist()),
                moved=self._moved(tasks, steps),
                taken=tuple(
                    (int(k), int(tasks["done_by" if k in done else "server"][k]))
                    for k in np.flatnonzero(tasks["taken_at"] == steps)
                ),
                left=tuple(
                    self._task_at(int(k), tasks[k])
                    for k in np.flatnonzero(tasks["left_at"] == steps)
                ),
                pursued=_pursued(before, after),
                served=_served(before, after, tasks),
                unloads=_unloads(tasks),
                missed=tuple(self._missed(before, after)),
                charge=_charge(before, after),
            )
        )
        decided = self._decided(before)
        if rows := rows_of(self._standing, decided, before.groups.keys()):
            self._decisions.append((steps, rows))
        self._standing = decided
        orders_made = self._env.worlds.count["orders"][0]
        if (tasks["ordered_at"] == steps).any() or self._orders_made < orders_made:
            self._write_order(steps)
        self._before = after  # last: only now does the step count as written down

    def replan(self) -> None:
        """Write down the plan that has been taken over since the latest step."""
        steps = self._before.tally.steps
        replaced = [plan for at, plan in self._shared_plans if at == steps]
        self._orders = [row for row in self._orders if row[0] < steps]
        self._shared_plans = [row for row in self._shared_plans if row[0] < steps]
        self._write_order(steps)
        (_, plan) = self._shared_plans.pop()
        why = tuple(dict.fromkeys(reason for it in (*replaced, plan) for reason in it.reasons))
        self._shared_plans.append((steps, SharedPlanMade(why, plan.coalitions)))

    @property
    def latest(self) -> Step:
        """Return what the latest step has changed."""
        return self._steps[-1]

    def finish(self, method: str, seed: int, lower_bound: float | None) -> Record:
        """Return the record so far: one of a trial that still runs is of an interrupted one."""
        made, is_uncertain = self._before.tally.steps, self._mission.has_surprises
        return Record(
            mission=self._mission,
            method=method,
            seed=seed,
            orders=tuple(order for order in self._orders if order[0] <= made),
            start=self._start,
            steps=tuple(self._steps[:made]),
            end=self._ending(),
            lower_bound=lower_bound,
            plans=tuple(plan for plan in self._shared_plans if plan[0] <= made),
            truth=truth_until(self._mission, self._truth, made + 1) if is_uncertain else None,
            scouts=tuple(row for row in self._scouts if row[0] <= made),
            foresight=self._foresight,
            heeds=tuple(word for word in NEWS if word in self._env.heeds()),
            decisions=tuple(row for row in self._decisions if row[0] <= made),
        )

    def _snapshot(self, before: _Snapshot | None = None) -> _Snapshot:
        groups = _groups(self._env.worlds.robots["team"][0])
        worlds = self._env.worlds
        robots = worlds.robots[0]
        server = worlds.tasks["server"][0]
        served = {k: groups[server[k]] for k in np.flatnonzero(server != NOBODY).tolist()}
        return _Snapshot(
            teams=worlds.teams[0].copy(),
            groups=groups,
            has=worlds.has[0].copy(),
            tally=self._env.tally(),
            served=served,
            left=robots["left"].copy(),
            at_chargers=_at_chargers(robots, before.left) if before else {},
        )

    def _decided(self, before: _Snapshot) -> dict[int, Wants]:
        """Return what the teams that there were wanted in the latest step, but to stay as is."""
        slots = sorted(before.groups)
        wanted, named = (rows[: len(slots)] for rows in self._env.decided())
        is_other = (wanted != before.has[slots]).any(axis=1)
        return {
            slots[row]: Wants(
                slots[row],
                self._counts(wanted[row]) if is_other[row] else None,
                None if named[row] == NOBODY else int(named[row]),
            )
            for row in np.flatnonzero(is_other | (named != NOBODY)).tolist()
        }

    def _counts(self, wanted: Array) -> tuple[float, ...]:
        caps = self._mission.capabilities
        counts = dict(zip(caps, wanted.tolist(), strict=False))
        return tuple(self._mission.out_of_units(counts).values())

    def _write_order(self, steps: int) -> None:
        worlds = self._env.worlds
        order = tuple(worlds.order[0, : worlds.count["open"][0]].tolist())
        self._orders.append((steps, order))
        made = int(worlds.count["orders"][0])
        plans = self._env.plans()
        if plans and made > self._orders_made:
            _, plan = plans[-1]
            self._shared_plans.append((steps, SharedPlanMade(plan.why, plan.coalitions)))
            if plan.scouts:
                self._scouts.append((steps, plan.scouts))
        self._orders_made = made

    def _named(self, formed: Groups) -> tuple[int, ...]:
        """Return the teams that decisions gave their task, where only those differ from lists."""
        if not self._is_coordinated:
            return ()
        is_commanded = self._env.worlds.teams["is_commanded"][0]
        return tuple(slot for slot in sorted(formed) if is_commanded[slot])

    def _moved(self, tasks: Array, steps: int) -> tuple[TaskAt, ...]:
        """Return the tasks that are believed elsewhere since a step, be it taken up by now."""
        spots = self._env.worlds.spots[0]
        return tuple(
            self._task_at(int(k), spots[k, tasks["believed_in"][k]])
            for k in np.flatnonzero(tasks["moved_at"] == steps)
        )

    def _task_at(self, task: int, place: Array) -> TaskAt:
        return TaskAt(task, self._along(place["x"]), self._along(place["y"]))

    def _joins(self, before: Groups, formed: Groups) -> tuple[tuple[int, int], ...]:
        """Return (joiner, partner) for each team that holds two earlier teams."""
        slot_of = {robot: slot for slot, robots in before.items() for robot in robots}
        partners = self._env.worlds.teams["partner"][0]
        joins = []
        for robots in formed.values():
            slots = sorted({slot_of[robot] for robot in robots})
            if len(slots) == 2:
                lower, higher = slots
                joins.append((lower, higher) if partners[lower] == higher else (higher, lower))
        return tuple(sorted(joins, key=min))

    def _ending(self) -> Ending:
        tally = self._before.tally
        return Ending(
            status="interrupted" if tally.status == "running" else tally.status,
            makespan=tally.steps if tally.status == "completed" else None,
            steps=tally.steps,
            tasks_done=tally.tasks_done,
            joins=tally.joins,
            splits=tally.splits,
            illegal_decisions=tally.illegal_decisions,
            blocked_tasks=self._blocked_tasks() if tally.status == "infeasible" else (),
            missed=self._missed_until(tally.steps),
        )

    def _missed_until(self, steps: int) -> tuple[str, ...]:
        """Name the tasks that were missed in the steps written down."""
        tasks = self._mission.tasks
        return tuple(tasks[k].name for k, at in self._env.missed().items() if at <= steps)

    def _missed(self, before: _Snapshot, after: _Snapshot) -> Iterator[tuple[int, str]]:
        """Yield the tasks that are not done any more since the latest step, and why."""
        headed_for = after.teams["pursued"][sorted(after.groups)].tolist()
        for task, at in self._env.missed().items():
            if at == after.tally.steps:
                yield task, why_missed(self._truth, task, before.served, headed_for)

    def _blocked_tasks(self) -> tuple[str, ...]:
        """Name the tasks that the robots left and those due back can never do."""
        mission, made = self._truth, self._before.tally.steps
        left = {robot for robots in self._before.groups.values() for robot in robots}
        due = {r for r, robot in enumerate(mission.robots) if robot.is_due(made)}
        left |= due - dry_robots(self._env.worlds.robots[0])
        at_work = (mission.robots[r] for r in left if mission.robots[r].rota.over > made)
        have = totals_by_region(mission.world, at_work)
        over = {*self._env.ends(), *self._env.missed()}
        return tuple(
            task.name
            for k, task in enumerate(mission.tasks)
            if k not in over
            and task.cancelled is None
            and not task.optional
            and not covers(have[mission.world.region(task.at)], task.needs)
        )


def _groups(slots: Array) -> Groups:
    """Gather robots by the slot of their team; `slots` is (robots,)."""
    groups: dict[int, list[int]] = {}
    for robot, slot in enumerate(slots.tolist()):
        if slot != NOBODY:
            groups.setdefault(slot, []).append(robot)
    return {slot: tuple(robots) for slot, robots in groups.items()}


def _exchanges(took: Array) -> tuple[tuple[int, int], ...]:
    """Return pairs of robots, the lower first; `took` (robots,) names each one's other."""
    return tuple(
        (int(robot), int(took[robot])) for robot in np.flatnonzero(took > np.arange(len(took)))
    )


def _splits(
    before: Groups, formed: Groups, has_decided: Array
) -> tuple[tuple[tuple[int, ...], tuple[int, ...]], ...]:
    """Return (robots that stay, robots that leave) for each team that is two now.

    `has_decided` (slots,) says which teams go by a decision of their own; who leaves has none yet.
    """
    splits = []
    slot_of = {robot: slot for slot, robots in formed.items() for robot in robots}
    for robots in before.values():
        slots = {slot_of[robot] for robot in robots}
        parts = [slot for slot in slots if set(formed[slot]) < set(robots)]
        if len(parts) == 2:
            stay, leave = sorted(parts, key=lambda slot: not has_decided[slot])
            splits.append((formed[stay], formed[leave]))
    return tuple(sorted(splits, key=lambda split: min(*split[0], *split[1])))


def _pursued(before: _Snapshot, after: _Snapshot) -> tuple[tuple[int, int], ...]:
    """Return what teams, by slot, pursued in a step and had as assignment neither before nor after.

    News at its end takes assignments back; where some comes in every step, nobody ever has one.
    """
    pursued, now, was = after.teams["pursued"], after.teams["task"], before.teams["task"]
    is_untold = (pursued != NOBODY) & (now == NOBODY) & (was != pursued)
    return tuple((slot, int(pursued[slot])) for slot in sorted(after.groups) if is_untold[slot])


def _served(
    before: _Snapshot, after: _Snapshot, tasks: Array
) -> tuple[tuple[int, tuple[int, ...]], ...]:
    """Return the tasks that others serve since a step, or nobody any more, and who does."""
    rows: list[tuple[int, tuple[int, ...]]] = []
    for task in sorted(before.served.keys() | after.served.keys()):
        was, now = before.served.get(task, ()), after.served.get(task, ())
        is_new = tasks["served"][task] == 0 and not tasks["is_carried"][task]
        is_over = tasks["done_at"][task] == after.tally.steps
        if was and not is_over and (not now or is_new):
            rows.append((task, ()))
        if now and (was != now or is_new):
            rows.append((task, now))
    return tuple(rows)


def _at_chargers(robots: Array, left: Array) -> dict[int, str]:
    """Return what robots did at chargers in a step; `left` (robots,) is what they had before it."""
    has_charged = robots["left"] > left
    queues = np.flatnonzero((robots["queued"] != NOBODY) & ~has_charged).tolist()
    charged = np.flatnonzero(has_charged).tolist()
    return dict.fromkeys(queues, QUEUEING) | dict.fromkeys(charged, CHARGING)


def _charge(before: _Snapshot, after: _Snapshot) -> tuple[tuple[int, str], ...]:
    """Return the robots that do something else at chargers than in the step before."""
    was, now = before.at_chargers, after.at_chargers
    rows = ((robot, now.get(robot, "")) for robot in sorted(was.keys() | now.keys()))
    return tuple(row for row in rows if row[1] != was.get(row[0], ""))


def _unloads(tasks: Array) -> tuple[int, ...]:
    """Return the loads that have got to where they go in the latest step, and are not done."""
    is_there = tasks["is_carried"] & (tasks["served"] == 1)
    return tuple(np.flatnonzero(is_there & (tasks["server"] != NOBODY)).tolist())


def _changed_teams(
    before: _Snapshot, after: _Snapshot, along: Callable[[float], float]
) -> tuple[TeamAt, ...]:
    """Return the teams that are new or elsewhere or head elsewhere; `along` turns coordinates."""
    fields = ("x", "y", "task")
    is_other = np.any([before.teams[name] != after.teams[name] for name in fields], axis=0)
    new = [slot for slot in after.groups if slot not in before.groups or is_other[slot]]
    rows = zip(
        sorted(new), *(after.teams[name][sorted(new)].tolist() for name in fields), strict=True
    )
    return tuple(
        TeamAt(slot, along(x), along(y), None if task == NOBODY else task)
        for slot, x, y, task in rows
    )
