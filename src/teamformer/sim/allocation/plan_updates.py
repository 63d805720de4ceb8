"""When the shared plan is made while a trial runs, from what facts, and where it is kept."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from teamformer.grid import Grid
from teamformer.jit import entry
from teamformer.model import Scenario
from teamformer.planning.free_looks import Unseen, with_free_looks
from teamformer.planning.teams.facts import Facts, SharedPlan, possible_tasks
from teamformer.planning.teams.shared_plan import plan_mission
from teamformer.rules.constants import NOBODY, PLAN_REASONS
from teamformer.sim.allocation.plan_moves import follow_shared_plans
from teamformer.sim.arrays import PLAN, RUNNING, Array, Worlds, world_at
from teamformer.truth import believed_mission, expected_mission

START, APPEARED, LOST, BROKEN_OFF = 1, 2, 4, 8
BACK, SHOWN, OVERDUE, FOUND, TAKEN_OVER = 16, 32, 64, 128, 256
"""Why a plan is made, in bits, in the order of `PLAN_REASONS`."""


def reasons_in(bits: int) -> tuple[str, ...]:
    """Return the words for why a plan was made."""
    return tuple(word for bit, word in enumerate(PLAN_REASONS) if bits & 1 << bit)


def update_shared_plans(worlds: Worlds, scenarios: Sequence[Scenario]) -> None:
    """Make a plan in every world where something has happened; say what teams are to do next."""
    reasons = np.zeros(len(scenarios), np.int32)
    _find_reasons(worlds, reasons)
    for w in np.flatnonzero(reasons).tolist():
        facts = facts_of(worlds, w, scenarios[w])
        if reasons[w] & START:
            plan = _first_plan(_Same(scenarios[w]), facts, _unseen_in(worlds, w))
        else:
            believed, unseen = _believed(worlds, w, scenarios[w]), _unseen_in(worlds, w)
            old = _read_plan(worlds, w)
            plan = _make_plan(scenarios[w], believed, facts, unseen, old)
        _write_plan(worlds, w, plan)
    follow_shared_plans(worlds, reasons != 0)


def take_over_plan(worlds: Worlds, w: int, scenario: Scenario, plan: SharedPlan) -> None:
    """Put a plan that somebody else has made into a world; teams go by it from the next step on.

    Tasks that it does not know yet are planned after it, as when they appear.
    """
    believed, facts, _ = plan_in(worlds, w, scenario)
    plan = _of_open_tasks(plan, facts)
    if set(possible_tasks(believed, facts)) - set(plan.order):
        plan = plan_mission(believed, facts, plan)
    _write_plan(worlds, w, plan)
    worlds.count["reason"][w] = TAKEN_OVER
    is_new = np.arange(len(worlds.rules)) == w
    follow_shared_plans(worlds, is_new.astype(np.bool_))


def _of_open_tasks(plan: SharedPlan, facts: Facts) -> SharedPlan:
    """Return a plan without tasks that are done or being served."""
    pairs = zip(plan.order, plan.coalitions, strict=True)
    rows = [(task, robots) for task, robots in pairs if task in facts.open_tasks]
    order, coalitions = tuple(zip(*rows, strict=True)) or ((), ())
    scouts = tuple(pair for pair in plan.scouts if pair[1] in facts.open_tasks)
    return SharedPlan(order, coalitions, (), plan.start, scouts)


def plan_in(worlds: Worlds, w: int, scenario: Scenario) -> tuple[Scenario, Facts, SharedPlan]:
    """Return the mission as it is believed to be in a world, the present, and the plan it has."""
    return _believed(worlds, w, scenario), facts_of(worlds, w, scenario), _read_plan(worlds, w)


class _Same:
    """A scenario that equals itself only, so that what was planned for it can be kept."""

    def __init__(self, scenario: Scenario) -> None:
        self.scenario = scenario

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Same) and other.scenario is self.scenario

    def __hash__(self) -> int:
        return id(self.scenario)


@lru_cache(maxsize=16)
def _first_plan(same: _Same, facts: Facts, unseen: Unseen) -> SharedPlan:
    """Return the plan at a start, kept for who plays the scenario again, as planners do."""
    return _make_plan(same.scenario, expected_mission(same.scenario), facts, unseen, None)


def _make_plan(
    scenario: Scenario, believed: Scenario, facts: Facts, unseen: Unseen,
    old: SharedPlan | None,
) -> SharedPlan:  # fmt: skip
    """Return the plan for what is believed; who has time to spare scouts, if that is wanted."""
    plan = plan_mission(believed, facts, old)
    if scenario.foresight != "scouting":
        return plan
    return with_free_looks(believed, facts, plan, unseen)


def _unseen_in(worlds: Worlds, w: int) -> Unseen:
    """Return the tasks of a world of which nobody knows what they need, or where they are."""
    needs, places = (
        frozenset(np.flatnonzero(worlds.tasks[hides][w]).tolist())
        for hides in ("hides_needs", "hides_place")
    )
    return Unseen(needs, places)


def _believed(worlds: Worlds, w: int, scenario: Scenario) -> Scenario:
    """Return a mission with what everybody believes that its tasks need, and where they are."""
    caps, tasks = scenario.capabilities, range(len(scenario.tasks))
    needs: dict[int, dict[str, float]] = {}
    if worlds.rules["hides_needs"][w]:
        for task, counts in zip(tasks, worlds.needs[w].tolist(), strict=False):
            believed = {c: n for c, n in zip(caps, counts, strict=False) if n}
            needs[task] = scenario.out_of_units(believed)
    along = int if isinstance(scenario.world, Grid) else float
    at = worlds.tasks[["x", "y"]][w]
    unsure = [task for task in tasks if scenario.tasks[task].within]
    places = {task: (along(at["x"][task]), along(at["y"][task])) for task in unsure}
    return believed_mission(scenario, needs, places)


@entry
def _find_reasons(worlds: Worlds, reasons: Array) -> None:
    """Write why the plan of each world is to be made, 0 where it is not; take note of it."""
    for w in range(len(worlds.rules)):
        world = world_at(worlds, w)
        if world.count.status != RUNNING or world.rules.allocation != PLAN:
            continue
        if world.count.arrived > 0:
            reasons[w] |= START if world.count.plans == 0 else APPEARED
        if world.count.lost > world.count.planned_lost:
            reasons[w] |= LOST
        if world.count.broken_off > world.count.planned_broken_off:
            reasons[w] |= BROKEN_OFF
        if world.count.back > world.count.planned_back:
            reasons[w] |= BACK
        if world.count.shown > world.count.planned_shown:
            reasons[w] |= SHOWN
        if world.count.overdue > world.count.planned_overdue:
            reasons[w] |= OVERDUE
        if world.count.found > world.count.planned_found:
            reasons[w] |= FOUND
        if reasons[w] != 0:
            world.count.reason = reasons[w]
        world.count.arrived = 0
        world.count.planned_lost = world.count.lost
        world.count.planned_back = world.count.back
        world.count.planned_broken_off = world.count.broken_off
        world.count.planned_shown = world.count.shown
        world.count.planned_overdue = world.count.overdue
        world.count.planned_found = world.count.found


def facts_of(worlds: Worlds, w: int, scenario: Scenario) -> Facts:
    """Return what everybody knows of a world: robots say where and with whom they are, and busy."""
    robots, tasks, teams = worlds.robots[w], worlds.tasks[w], worlds.teams[w]
    step = int(worlds.count["steps"][w])
    free_at = np.full(len(teams), step)  # (slots,)
    for task in np.flatnonzero(tasks["server"] != NOBODY).tolist():
        server, rest = int(tasks["server"][task]), tasks["expected"][task] - tasks["served"][task]
        until = step + int(rest)
        free_at[server] = max(int(free_at[server]), until)
    slots = robots["team"][: len(scenario.robots)]
    along = int if isinstance(scenario.world, Grid) else float
    members = {slot: np.flatnonzero(slots == slot) for slot in np.unique(slots[slots != NOBODY])}
    return Facts(
        step=step,
        open_tasks=tuple(np.flatnonzero(tasks["is_open"] & (tasks["server"] == NOBODY)).tolist()),
        places=tuple((along(teams["x"][slot]), along(teams["y"][slot])) for slot in slots),
        teams=tuple(tuple(members[slot].tolist()) for slot in sorted(members)),
        free_at=tuple(free_at[slots].tolist()),
    )


def _read_plan(worlds: Worlds, w: int) -> SharedPlan:
    """Return the plan that a world holds; tasks that are not in it yet have no coalition."""
    order = worlds.order[w, : worlds.count["open"][w]]
    coalitions = tuple(tuple(np.flatnonzero(worlds.coalition[w, task]).tolist()) for task in order)
    scouted = worlds.robots["scouts"][w].tolist()
    scouts = tuple((robot, task) for robot, task in enumerate(scouted) if task != NOBODY)
    return SharedPlan(tuple(order.tolist()), coalitions, (), "", scouts)


def _write_plan(worlds: Worlds, w: int, plan: SharedPlan) -> None:
    """Put a plan into a world; what is being served comes first, with those who serve it.

    Tasks that are not in it wait at the end for a robot to come back.
    """
    coalition, tasks = worlds.coalition[w], worlds.tasks[w]
    served = np.flatnonzero(tasks["is_open"] & (tasks["server"] != NOBODY)).tolist()
    coalition[:] = False
    worlds.robots["scouts"][w] = NOBODY
    for robot, task in plan.scouts:
        worlds.robots["scouts"][w, robot] = task
    for task in served:
        coalition[task] = worlds.robots["team"][w] == tasks["server"][task]
    for task, robots in zip(plan.order, plan.coalitions, strict=True):
        coalition[task, list(robots)] = True
    planned = [*served, *plan.order]
    waiting = sorted(set(np.flatnonzero(tasks["is_open"]).tolist()) - set(planned))
    order: Array = np.array(planned + waiting, np.int64)
    worlds.order[w, : len(order)] = order
    tasks["rank"][order] = np.arange(len(order))
    worlds.count["plans"][w] += 1
