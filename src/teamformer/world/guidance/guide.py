"""Asks coordinators for plans when there is news, and has the teams of a batch go by them."""

from __future__ import annotations

import copy
import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.errors import TeamformerError
from teamformer.mission.coordination import NEWS, TAKEN_OVER, Coordinator, Known, Plan, heeded_by
from teamformer.mission.model import Mission
from teamformer.mission.parts.capabilities import Counts, covers, describe, exact, total
from teamformer.mission.parts.charging import who_is_able
from teamformer.mission.parts.reach import can_reach
from teamformer.mission.precedence import keep_precedence, tasks_before
from teamformer.world.guidance.following import follow_plans
from teamformer.world.guidance.known import known_of
from teamformer.world.guidance.parts import Parts
from teamformer.world.phases.ending import give_up_worlds
from teamformer.world.rules.constants import NOBODY
from teamformer.world.state.arrays import APPEARED, FOUND, LOST, RUNNING, START, Worlds

History = list[tuple[int, Plan]]
"""Steps made, and the plan from then on."""


class Guide:
    """The plans of a batch of worlds: when they are made, and what they want of each team.

    `plans` holds the history of each world, with exchanges that were made when a plan was new;
    `seconds` is what coordinators took. Worlds without a coordinator (None) have no plan.
    """

    def __init__(
        self,
        worlds: Worlds,
        missions: Sequence[Mission],
        coordinators: Sequence[Coordinator | None],
    ) -> None:
        self.missions, self.coordinators = tuple(missions), tuple(coordinators)
        self.parts = _make_parts(worlds, missions)
        self.plans: list[History] = [[] for _ in missions]
        self.seconds = 0.0
        self._before = [tasks_before(mission.tasks) for mission in missions]
        self._over = [[robot.rota.over for robot in mission.robots] for mission in missions]
        self._heeds = np.array([_bits_of(coordinator) for coordinator in coordinators], np.int32)

    def fork(self) -> Guide:
        """Return another guide with the same plans that goes its own way."""
        twin = copy.copy(self)
        twin.parts = Parts(*(part.copy() for part in self.parts))
        twin.plans = [list(history) for history in self.plans]
        return twin

    def update(self, worlds: Worlds) -> None:
        """Have plans made where there is news, and write what every team is to do next."""
        for w, before in enumerate(self._before):
            if before and self._leaves_out(worlds, w):
                worlds.count["news"][w] |= APPEARED
            if self._works_no_more(worlds, w):
                worlds.count["news"][w] |= LOST
        news = worlds.count["news"] & self._heeds
        worlds.count["news"][self._heeds > 0] = 0
        news[worlds.count["status"] != RUNNING] = 0
        is_new = np.zeros(len(self.missions), np.bool_)
        for w in np.flatnonzero(news).tolist():
            heard = self._without_what_was_foreseen(worlds, w, int(news[w]))
            if heard:
                is_new[w] = True
                self._install(worlds, w, self._plan_after(worlds, w, heard))
        self._follow(worlds, is_new)
        give_up_worlds(worlds)

    def take_over(self, worlds: Worlds, w: int, plan: Plan) -> None:
        """Have a world's teams go by a plan that somebody else has made, from the next step on.

        Tasks that it does not know yet are planned after it, as when they appear.
        """
        coordinator = self.coordinators[w]
        assert coordinator is not None, "this world follows no plan"
        known = replace(known_of(worlds, w, self.missions[w], 0), news=("task appeared",))
        plan = _of_open_tasks(plan, known)
        if set(known.possible_tasks) - set(plan.order):
            plan = coordinator.update(known, plan)
        self._install(worlds, w, replace(plan, why=(TAKEN_OVER,)))
        is_new = np.arange(len(self.missions)) == w
        self._follow(worlds, is_new)

    def plan(self, worlds: Worlds, w: int) -> Plan:
        """Return the plan that a world goes by now; tasks that are not in it have no coalition."""
        order = worlds.order[w, : worlds.count["open"][w]].tolist()
        scouts = self.parts.scouts[w].tolist()
        robots_of: dict[int, list[int]] = {task: [] for task in order}
        for robot, part in enumerate(self.parts.part[w].tolist()):
            begin, end = self.parts.first[w, part : part + 2]
            for task in self.parts.task[w, begin:end].tolist():
                if task in robots_of:
                    robots_of[task].append(robot)
        return Plan(
            order=tuple(order),
            coalitions=tuple(tuple(robots_of[task]) for task in order),
            scouts=tuple((robot, task) for robot, task in enumerate(scouts) if task != NOBODY),
        )

    def wanted(self, world: Array, slot: Array) -> Array:
        """Return the counts that plans want of teams, as (teams, caps), by world and slot."""
        wanted: Array = self.parts.wanted[world, slot]
        return wanted

    def _plan_after(self, worlds: Worlds, w: int, news: int) -> Plan:
        coordinator, known = self.coordinators[w], known_of(worlds, w, self.missions[w], news)
        assert coordinator is not None
        old = self.plan(worlds, w) if self.plans[w] else None
        begun = time.perf_counter()
        plan = coordinator.update(known, old)
        self.seconds += time.perf_counter() - begun
        refuse_unfit(known, plan)
        return replace(plan, why=known.news)

    def _without_what_was_foreseen(self, worlds: Worlds, w: int, news: int) -> int:
        """Return the news without a task that was found where it was believed to be.

        That is news only if somebody scouts it.
        """
        if news & FOUND:
            tasks, step = worlds.tasks[w], worlds.count["steps"][w]
            is_found = tasks["found_at"] == step
            is_elsewhere = (is_found & (tasks["moved_at"] == step)).any()
            if (
                not is_elsewhere
                and not np.isin(np.flatnonzero(is_found), self.parts.scouts[w]).any()
            ):
                news &= ~FOUND
        return news

    def _works_no_more(self, worlds: Worlds, w: int) -> bool:
        """Say whether the last shift of a robot that is there is over: it counts as lost."""
        step, slots = int(worlds.count["steps"][w]), worlds.robots["team"][w]
        over = (robot for robot, at in enumerate(self._over[w]) if at == step)
        return any(slots[robot] != NOBODY for robot in over)

    def _leaves_out(self, worlds: Worlds, w: int) -> bool:
        """Say whether a task that comes after others may begin now, and nobody is to do it."""
        tasks, step = worlds.tasks[w], worlds.count["steps"][w]
        begins = tasks["is_open"] & (tasks["awaits"] == 0) & (tasks["opens"] == step)
        planned = self.parts.task[w, : self.parts.first[w, -1]]
        left_out = np.setdiff1d(np.flatnonzero(begins), planned).tolist()
        return bool(self.plans[w]) and not self._before[w].keys().isdisjoint(left_out)

    def _install(self, worlds: Worlds, w: int, plan: Plan) -> None:
        """Put a plan into a world; what is being served comes first, with those who serve it.

        Planned tasks are behind those that they come after, be it by way of tasks for nobody, which
        wait at the end.
        """
        tasks, teams = worlds.tasks[w], worlds.robots["team"][w]
        served = np.flatnonzero(tasks["is_open"] & (tasks["server"] != NOBODY)).tolist()
        self.parts.scouts[w] = NOBODY
        for robot, task in plan.scouts:
            self.parts.scouts[w, robot] = task
        robots_of = dict(zip(plan.order, plan.coalitions, strict=True))
        tasks["is_planned"][tasks["is_open"]] = False
        tasks["is_planned"][list(robots_of)] = True
        for task in served:
            servers = np.flatnonzero(teams == tasks["server"][task]).tolist()
            robots_of[task] = tuple({*servers, *robots_of.get(task, ())})
        planned = [task for task in plan.order if task not in served and robots_of[task]]
        waiting = set(np.flatnonzero(tasks["is_open"]).tolist()).difference(served, planned)
        kept = keep_precedence([*planned, *sorted(waiting)], self._before[w])
        rows = [*served, *(task for task in kept if task not in waiting), *sorted(waiting)]
        order: Array = np.array(rows, np.int64)
        worlds.order[w, : len(order)] = order
        tasks["rank"][order] = np.arange(len(order))
        worlds.count["orders"][w] += 1
        self._write_parts(w, [(task, robots_of.get(task, ())) for task in order.tolist()])
        self.plans[w].append((int(worlds.count["steps"][w]), plan))

    def _write_parts(self, w: int, rows: list[tuple[int, Sequence[int]]]) -> None:
        """Write down the tasks of each robot; `rows` has all tasks in order, with their robots."""
        lists: list[list[int]] = [[] for _ in range(self.parts.part.shape[1])]
        for task, robots in rows:
            for robot in robots:
                lists[robot].append(task)
        first = np.cumsum([0, *map(len, lists)])
        if first[-1] > self.parts.task.shape[1]:
            longer = np.full((len(self.parts.task), int(first[-1])), NOBODY, np.int32)
            longer[:, : self.parts.task.shape[1]] = self.parts.task
            self.parts = self.parts._replace(task=longer)
        self.parts.first[w] = first
        self.parts.task[w, : first[-1]] = [task for tasks in lists for task in tasks]
        self.parts.part[w] = np.arange(len(lists))

    def _follow(self, worlds: Worlds, is_new: Array) -> None:
        """Write what teams are to do next; a new plan is kept with the exchanges made at once."""
        follow_plans(worlds, self.parts, is_new)
        for w in np.flatnonzero(is_new).tolist():
            step, plan = self.plans[w][-1]
            made = self.plan(worlds, w)
            self.plans[w][-1] = step, replace(made, ends=(), why=plan.why, made_from=plan.made_from)


def refuse_unfit(known: Known, plan: Plan) -> None:
    """Raise `TeamformerError` for a plan that robots cannot go by, saying what is wrong with it."""
    mission, there = known.mission, set(known.robots)
    made = f"after {known.step} steps" if mission.time == "steps" else f"at {known.now:g}"
    when = f"the plan made {made}"
    if len(plan.order) != len(plan.coalitions):
        _refuse(f"{when} has {len(plan.order)} tasks and {len(plan.coalitions)} coalitions")
    if len(set(plan.order)) != len(plan.order):
        _refuse(f"{when} has a task twice")
    open_tasks = set(known.open_tasks)
    for task, robots in zip(plan.order, plan.coalitions, strict=True):
        if task not in open_tasks:
            if 0 <= task < len(mission.tasks):
                continue  # it is being served: who does that stays
            _refuse(f"{when} has a task {task}, which is none")
        name = mission.tasks[task].name
        if gone := [robot for robot in robots if robot not in there]:
            there_are = f"robots are numbers, from 0 to {len(mission.robots) - 1}"
            what = f"{when} gives task '{name}' to {gone[0]!r}, which is lost or no robot"
            _refuse(f"{what}; {there_are}")
        if len(set(robots)) != len(robots):
            _refuse(f"{when} gives task '{name}' to a robot twice")
        able = (mission.robots[r] for r in who_is_able(mission, robots, task))
        at = mission.tasks[task].at
        have = total(robot.can for robot in able if can_reach(mission.world, robot, at))
        if robots and not covers(have, mission.tasks[task].needs):
            who = ", ".join(mission.robots[robot].name for robot in robots)
            lack = describe(_lacking(have, mission.tasks[task].needs))
            _refuse(f"{when} gives task '{name}' to {who}, who there together lack {lack}")
    for robot, task in plan.scouts:
        if robot not in there or task not in open_tasks:
            _refuse(f"{when} has a scout that is not there, or one for a task that is not open")


def _lacking(have: Counts, needs: Counts) -> dict[str, float]:
    """Return what is missing of each capability."""
    return {cap: exact(max(0, need - have.get(cap, 0))) for cap, need in needs.items()}


def _refuse(what: str) -> None:
    raise TeamformerError(what, "see docs/reference/coordinators.md for what a coordinator returns")


def _of_open_tasks(plan: Plan, known: Known) -> Plan:
    """Return a plan without tasks that are done or being served."""
    pairs = zip(plan.order, plan.coalitions, strict=True)
    rows = [(task, robots) for task, robots in pairs if task in known.open_tasks]
    order, coalitions = tuple(zip(*rows, strict=True)) or ((), ())
    scouts = tuple(pair for pair in plan.scouts if pair[1] in known.open_tasks)
    return replace(plan, order=order, coalitions=coalitions, ends=(), scouts=scouts)


def _bits_of(coordinator: Coordinator | None) -> int:
    """Return the news that a coordinator is asked after, a bit for each."""
    if coordinator is None:
        return 0
    heeded = heeded_by(coordinator)
    return START | sum(1 << bit for bit, word in enumerate(NEWS) if word in heeded)


def _make_parts(worlds: Worlds, missions: Sequence[Mission]) -> Parts:
    """Return the parts of worlds without a plan."""
    count, robots, caps = worlds.has.shape
    tasks = worlds.tasks.shape[1]
    parts = Parts(
        first=np.zeros((count, robots + 1), dtype=np.int32),
        task=np.zeros((count, 0), dtype=np.int32),
        part=np.zeros((count, robots), dtype=np.int32) + np.arange(robots, dtype=np.int32),
        scouts=np.full((count, robots), NOBODY, dtype=np.int32),
        took=np.full((count, robots), NOBODY, dtype=np.int32),
        kind=np.zeros((count, robots), dtype=np.int32),
        is_parting=np.zeros((count, robots), dtype=np.bool_),
        waiting=np.full((count, tasks), NOBODY, dtype=np.int32),
        wanted=np.zeros((count, robots, caps), dtype=np.int32),
    )
    for w, mission in enumerate(missions):
        kinds: dict[tuple[object, ...], int] = {}
        for r, robot in enumerate(mission.robots):
            region = mission.world.region(robot.at)
            moves = (robot.speed, robot.flies, region, robot.rota, robot.battery)
            kind = (*sorted(robot.can.items()), *moves)
            parts.kind[w, r] = kinds.setdefault(kind, r)
    return parts
