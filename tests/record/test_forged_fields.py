"""Records of every kind of mission are legal as they are, and not once a field of them is forged.

What a forgery cannot be told from is a legal record of other decisions, or of another plan
(docs/reference/check.md); such changes are left out, each where it
says so.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from coordinations import RandomPlans
from random_worlds import random_decision, random_world, with_surprises
from teamformer.base.errors import MissionError
from teamformer.methods.by_name import Player, as_method
from teamformer.methods.coordinators.crews import Crews
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.methods.scripted.heuristic import Heuristic
from teamformer.methods.scripted.joining import JoinAll
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.mission.parts.plane import Plane
from teamformer.mission.truth import draw_truth
from teamformer.record.record import Record, SharedPlanMade, Step, TeamAt
from teamformer.record.referee import judge
from teamformer.trials.recorder import Recorder
from teamformer.trials.trial import run_trial
from teamformer.world.env import Decision, TeamFormation


@dataclass(frozen=True)
class Family:
    """A kind of missions, and who plays them."""

    player: Player
    is_plane: bool = False
    is_uncertain: bool = False
    are_like: bool = False


COUNT = 4
"""How many missions of each kind are played, by a policy and at random; more by the long tests."""

FAMILIES = {
    "grid": Family(JoinAll()),
    "plane": Family(JoinAll(), is_plane=True),
    "uncertain": Family(JoinAll(), is_uncertain=True),
    "uncertain plane": Family(Heuristic(), is_plane=True, is_uncertain=True),
    "crews": Family(Crews(), is_uncertain=True),
    "crews on a plane": Family(Crews(), is_plane=True),
    "plan": Family(SharedPlan()),
    "uncertain plan": Family(SharedPlan(), is_uncertain=True),
    "plan of like robots": Family(SharedPlan(), are_like=True),
    "uncertain plan on a plane": Family(SharedPlan(), is_plane=True, is_uncertain=True),
    "any plan": Family(RandomPlans(1), is_uncertain=True),
}


def mission_of(family: Family, rng: np.random.Generator) -> Mission:
    if family.are_like:
        return mission_of_twins(rng)
    while True:
        try:
            world = random_world(rng, is_plane=family.is_plane)
            return with_surprises(world, rng) if family.is_uncertain else world
        except MissionError:  # a surprise too hard: draw another
            continue


def mission_of_twins(rng: np.random.Generator) -> Mission:
    """Return a mission of three robots of each of two kinds, that all start as one team."""
    cans = [{"a": 1}, {"b": 1}]
    robots = [
        Robot(f"r{r}", (4, 4), cans[int(kind)]) for r, kind in enumerate(rng.permutation(6) % 2)
    ]
    needs = [*cans, {"a": 1, "b": 1}, {"a": 2}]
    tasks = [
        Task(f"t{k}", (int(x), int(y)), needs[int(which)], int(rng.integers(4)))
        for k, (x, y, which) in enumerate(rng.integers((9, 9, 4), size=(8, 3)))
    ]
    together = (tuple(range(6)),)
    return Mission("twins", Grid(9, 9), ("a", "b"), tuple(robots), tuple(tasks), together)


def wild_record(mission: Mission, player: Player, seed: int, rng: np.random.Generator) -> Record:
    """Play at random for at most 40 steps, and name tasks: at first, then now and then.

    Where no decision names a task, teams decide by the plan if there is one.
    """
    coordinator = as_method(player).coordinator
    env = TeamFormation([mission], truths=[draw_truth(mission, seed)], coordinator=coordinator)
    recorder, chance = Recorder(env), 1.0
    while env.is_running[0] and env.tally().steps < 40:
        view = env.view()
        named = np.where(rng.random(len(view.slot)) < chance, view.task_number[:, 0], -1)
        env.step(Decision(random_decision(view, rng).wanted, named))
        recorder.step()
        chance = 0.1 if recorder.latest.named else chance
    return recorder.finish("wild", seed, None)


def play(seed: int, count: int) -> Iterator[list[Record]]:
    """Yield records of each family: missions played by its policy, and by random decisions."""
    rng = np.random.default_rng(seed)
    for family in FAMILIES.values():
        missions = list(enumerate(mission_of(family, rng) for _ in range(count)))
        played = [run_trial(mission, family.player, n).record for n, mission in missions]
        yield [*played, *(wild_record(mission, family.player, n, rng) for n, mission in missions)]


@pytest.fixture(scope="module")
def records() -> list[Record]:
    """Return records of all families, one of each after the other."""
    return [record for records in zip(*play(24, COUNT), strict=True) for record in records]


@pytest.mark.thorough
def test_honest_records_are_legal(records: list[Record]) -> None:
    assert [judge(record).findings for record in records] == [()] * len(records)


Forge = Callable[[Record], Iterator[Record]]
"""Yields the forgeries of a record, one for each place where it can be forged so."""


def in_step(record: Record, number: int, **fields: Any) -> Record:
    """Return a record with other fields in the step of a number, from 1 on."""
    steps = list(record.steps)
    steps[number - 1] = replace(steps[number - 1], **fields)
    return replace(record, steps=tuple(steps))


def steps_of(record: Record) -> Iterator[tuple[int, Step, dict[int, TeamAt]]]:
    """Yield each step with its number, and where all slots were before."""
    at = {slot: TeamAt(slot, x, y, None) for slot, _, x, y in record.start}
    for number, step in enumerate(record.steps, start=1):
        yield number, step, dict(at)
        at |= {team.slot: team for team in step.teams}


def with_row(step: Step, key: str, old: Any, *new: Any) -> dict[str, Any]:
    rows = list(getattr(step, key))
    i = rows.index(old)
    rows[i : i + 1] = new
    return {key: tuple(rows)}


def a_free_team_walks(record: Record) -> Iterator[Record]:
    """A team that stands somewhere without a task stands a cell or a hand's width aside."""
    for number, step, before in steps_of(record):
        for slot, was in before.items():
            aside = 0.1 if isinstance(record.mission.world, Plane) else 1
            row = TeamAt(slot, was.x + aside, was.y, None)
            if was.task is None and row not in step.teams:
                rows = [team for team in step.teams if team.slot != slot]
                yield in_step(record, number, teams=tuple(sorted([*rows, row], key=slot_of)))


def slot_of(row: TeamAt) -> int:
    return row.slot


def a_micrometre(record: Record) -> Iterator[Record]:
    """A team is elsewhere by a micrometre."""
    if isinstance(record.mission.world, Plane):
        for number, step, _ in steps_of(record):
            for team in step.teams:
                aside = team._replace(x=round(team.x + 1e-6, 6))
                yield in_step(record, number, **with_row(step, "teams", team, aside))


def pursued_changed(record: Record) -> Iterator[Record]:
    """A team pursued another task."""
    for number, step, _ in steps_of(record):
        for row in step.pursued:
            for task in range(len(record.true_mission.tasks)):
                if task != row[1]:
                    yield in_step(record, number, **with_row(step, "pursued", row, (row[0], task)))


def pursued_added(record: Record) -> Iterator[Record]:
    """Somebody who has a task is said to pursue it, or another, besides."""
    for number, step, _ in steps_of(record):
        for team in step.teams:
            if team.task is not None:
                row = (team.slot, team.task)
                yield in_step(record, number, pursued=tuple(sorted([*step.pursued, row])))


def with_rows(record: Record, key: str, rows: tuple[Any, ...]) -> Record:
    fields: dict[str, Any] = {key: rows}
    return replace(record, **fields)


def twice(key: str) -> Forge:
    def forge(record: Record) -> Iterator[Record]:
        for number, step in enumerate(record.steps, start=1):
            for row in getattr(step, key):
                yield in_step(record, number, **with_row(step, key, row, row, row))

    return forge


def turned(key: str) -> Forge:
    def forge(record: Record) -> Iterator[Record]:
        for number, step in enumerate(record.steps, start=1):
            rows = getattr(step, key)
            if len(rows) > 1:
                yield in_step(record, number, **{key: rows[::-1]})

    return forge


def row_twice(key: str) -> Forge:
    def forge(record: Record) -> Iterator[Record]:
        rows = getattr(record, key)
        for i in range(len(rows)):
            yield with_rows(record, key, (*rows[: i + 1], *rows[i:]))

    return forge


def rows_turned(key: str) -> Forge:
    def forge(record: Record) -> Iterator[Record]:
        rows = getattr(record, key)
        for i in range(len(rows) - 1):
            yield with_rows(record, key, (*rows[:i], rows[i + 1], rows[i], *rows[i + 2 :]))

    return forge


def row_left_out(key: str) -> Forge:
    def forge(record: Record) -> Iterator[Record]:
        rows = getattr(record, key)
        for i in range(len(rows)):
            yield with_rows(record, key, (*rows[:i], *rows[i + 1 :]))

    return forge


def row_later(key: str) -> Forge:
    """What was made after some steps was made a step later, with the order that belongs to it."""

    def forge(record: Record) -> Iterator[Record]:
        rows, orders = getattr(record, key), dict(record.orders)
        taken = {steps for steps, _ in (*rows, *record.orders)}
        for i, (steps, made) in enumerate(rows):
            if steps + 1 not in taken and steps < len(record.steps):
                moved = with_rows(record, key, (*rows[:i], (steps + 1, made), *rows[i + 1 :]))
                order = orders.pop(steps)
                later = tuple(sorted({**orders, steps + 1: order}.items()))
                yield moved if key == "orders" else replace(moved, orders=later)
                orders[steps] = order

    return forge


def order_of_others(record: Record) -> Iterator[Record]:
    """An order lacks a task that is open."""
    for i, (steps, order) in enumerate(record.orders):
        if order:
            rows = (*record.orders[:i], (steps, order[1:]), *record.orders[i + 1 :])
            yield replace(record, orders=rows)


def with_plan(record: Record, i: int, **fields: Any) -> Record:
    steps, plan = record.plans[i]
    changed = plan._replace(**fields)
    return replace(record, plans=(*record.plans[:i], (steps, changed), *record.plans[i + 1 :]))


def reasons_changed(record: Record) -> Iterator[Record]:
    """Told apart but for `taken over`, as nobody can know that no better plan was offered."""
    for i, (_, plan) in enumerate(record.plans):
        for reason in ("start", "task appeared", "robot lost", "service overdue", "needs known"):
            others = tuple(word for word in plan.reasons if word != reason)
            if len(others) == len(plan.reasons):
                yield with_plan(record, i, reasons=(reason,))
                yield with_plan(record, i, reasons=(*plan.reasons, reason))
            else:
                yield with_plan(record, i, reasons=others)


def coalition_unable(record: Record) -> Iterator[Record]:
    """A coalition has a robot twice."""
    for i, (_, plan) in enumerate(record.plans):
        for k, robots in enumerate(plan.coalitions):
            if robots:
                twice = (*robots, robots[-1])
                yield with_plan(record, i, coalitions=with_entry(plan, k, twice))


def with_entry(
    plan: SharedPlanMade, k: int, robots: tuple[int, ...]
) -> tuple[tuple[int, ...], ...]:
    return (*plan.coalitions[:k], robots, *plan.coalitions[k + 1 :])


def coalition_changed(record: Record) -> Iterator[Record]:
    """A robot of a coalition that sets out at once is in it no more, or its place is another's.

    Told apart where a robot that is alone heads for the task in the next step, by the plan.
    """
    orders, scouts = dict(record.orders), dict(record.scouts)
    alone = dict(lone_robots(record))
    for i, (steps, plan) in enumerate(record.plans):
        if steps >= len(record.steps):
            continue
        busy = {robot for robot, _ in scouts.get(steps, ())}
        following = record.steps[steps]
        formed = {robot for pair in following.joins for robot in pair} | set(following.lost)
        for robot in alone[steps] - busy - formed - set(following.named):
            firsts = [k for k, robots in enumerate(plan.coalitions) if robot in robots]
            if firsts and is_on_its_way(record, steps + 1, robot, orders[steps][firsts[0]]):
                k = firsts[0]
                for other in range(len(record.mission.robots)):
                    robots = {*plan.coalitions[k], other} - {robot}
                    yield with_plan(
                        record, i, coalitions=with_entry(plan, k, tuple(sorted(robots)))
                    )


def is_on_its_way(record: Record, number: int, slot: int, task: int) -> bool:
    """Say whether the record has a team head for a task in a step, by an entry of its own."""
    step = record.steps[number - 1]
    heads = {team.slot: team.task for team in step.teams}
    return heads.get(slot) == task or (slot, task) in step.pursued


def lone_robots(record: Record) -> Iterator[tuple[int, set[int]]]:
    """Yield after how many steps which robots are teams of their own."""
    teams = {frozenset(robots) for _, robots, *_ in record.start}
    yield 0, {min(team) for team in teams if len(team) == 1}
    for number, step in enumerate(record.steps, start=1):
        for stay, leave in step.splits:
            teams -= {frozenset((*stay, *leave))}
            teams |= {frozenset(stay), frozenset(leave)}
        for pair in step.joins:
            both = [team for team in teams if min(team) in pair]
            teams = (teams - set(both)) | {frozenset().union(*both)}
        teams = {team - set(step.lost) for team in teams} - {frozenset()}
        teams |= {frozenset([robot]) for robot in step.back}
        yield number, {min(team) for team in teams if len(team) == 1}


def exchange_added(record: Record) -> Iterator[Record]:
    """Robots exchange their parts that are of two teams, or under no plan."""
    alone = dict(lone_robots(record))
    for number, step in enumerate(record.steps, start=1):
        robots = sorted(alone[number])
        if len(robots) > 1:
            pair = (robots[0], robots[1])
            taken = {robot for other in step.took for robot in other}
            if not taken & set(pair):
                yield in_step(record, number, took=tuple(sorted([*step.took, pair])))


def named_added(record: Record) -> Iterator[Record]:
    """A team is said to name its task that does not."""
    for number, step, before in steps_of(record):
        for slot in before.keys() - set(step.named):
            yield in_step(record, number, named=tuple(sorted([*step.named, slot])))


def left_out(key: str) -> Forge:
    def forge(record: Record) -> Iterator[Record]:
        for number, step in enumerate(record.steps, start=1):
            for row in getattr(step, key):
                yield in_step(record, number, **with_row(step, key, row))

    return forge


def decisions_changed(record: Record) -> Iterator[Record]:
    """A decision is told twice, or again as it was, or with what nobody can bring, or not."""
    for i, (step, rows) in enumerate(record.decisions):
        before, after = record.decisions[:i], record.decisions[i + 1 :]
        yield replace(record, decisions=(*before, (step, (rows[0], *rows)), *after))
        yield replace(record, decisions=(*before, (step, ()), *after))
        if record.is_coordinated and are_followed(record):
            yield replace(record, decisions=(*before, *after))
        if rows[0].counts is not None:
            counts = tuple(count + 0.0004 for count in rows[0].counts)
            row = rows[0]._replace(counts=counts)
            yield replace(record, decisions=(*before, (step, (row, *rows[1:])), *after))


def illegal_decisions_changed(record: Record) -> Iterator[Record]:
    for more in (1, 2):
        count = record.end.illegal_decisions + more
        yield replace(record, end=replace(record.end, illegal_decisions=count))


def heeds_changed(record: Record) -> Iterator[Record]:
    if record.heeds:
        yield replace(record, heeds=(*record.heeds, record.heeds[0]))


def heard_added(record: Record) -> Iterator[Record]:
    for number in range(1, len(record.steps) + 1):
        yield in_step(record, number, heard=((0, 0, "beat"),))


def are_followed(record: Record) -> bool:
    """Say whether teams decide by plans; else another decision would be as legal as the forged."""
    has_coalitions = any(any(plan.coalitions) for _, plan in record.plans)
    wants = (row for _, rows in record.decisions for row in rows)
    return has_coalitions and all(row.task is None for row in wants)


def called_interrupted(record: Record) -> Iterator[Record]:
    if record.end.status != "interrupted" and record.steps:
        end = replace(record.end, status="interrupted", blocked_tasks=())
        yield replace(record, end=end)


def exchanged(key: str) -> Forge:
    """The joiner was the partner, or those left who stayed."""

    def forge(record: Record) -> Iterator[Record]:
        for number, step in enumerate(record.steps, start=1):
            for one, other in getattr(step, key):
                yield in_step(record, number, **with_row(step, key, (one, other), (other, one)))

    return forge


def with_empty_step(record: Record, made: int) -> Record:
    """Return a record with a step after the first `made` ones in which nothing changes."""

    def later(rows: Any) -> Any:
        return tuple((steps + (steps > made), row) for steps, row in rows)

    end, steps = record.end, record.steps
    makespan = None if end.makespan is None else end.makespan + 1
    return replace(
        record,
        steps=(*steps[:made], Step(), *steps[made:]),
        end=replace(end, steps=end.steps + 1, makespan=makespan),
        decisions=tuple((step + (step > made), rows) for step, rows in record.decisions),
        **{key: later(getattr(record, key)) for key in ("orders", "plans", "scouts")},
    )


def empty_step_added(record: Record) -> Iterator[Record]:
    if are_followed(record) and record.end.status == "completed":
        yield from (with_empty_step(record, made) for made in range(len(record.steps)))


def formed_later(record: Record) -> Iterator[Record]:
    """All that happens from a step on in which teams part or join happens a step later."""
    if are_followed(record):
        for made, step in enumerate(record.steps):
            if step.splits or step.joins:
                yield with_empty_step(record, made)


STEP_ROWS = ["joins", "splits", "lost", "back", "teams", "done", "named", "took"]
STEP_ROWS += ["shown", "found", "moved", "pursued", "served"]
MADE = ("orders", "plans")

FORGERIES: dict[str, Forge] = {
    "a free team walks": a_free_team_walks,
    "a micrometre": a_micrometre,
    **{f"{key} left out": left_out(key) for key in STEP_ROWS},
    "decisions changed": decisions_changed,
    "illegal decisions changed": illegal_decisions_changed,
    "heeds changed": heeds_changed,
    "pursued changed": pursued_changed,
    "pursued added": pursued_added,
    **{f"{key} twice": twice(key) for key in STEP_ROWS},
    **{f"{key} turned": turned(key) for key in STEP_ROWS if key not in ("splits", "back", "took")},
    **{f"a row of {key} twice": row_twice(key) for key in MADE},
    **{f"rows of {key} turned": rows_turned(key) for key in MADE},
    **{f"a row of {key} left out": row_left_out(key) for key in MADE},
    **{f"a row of {key} later": row_later(key) for key in MADE},
    "an order lacks a task": order_of_others,
    "reasons changed": reasons_changed,
    "a coalition that cannot": coalition_unable,
    "a coalition changed": coalition_changed,
    "an exchange added": exchange_added,
    "a name added": named_added,
    "somebody heard": heard_added,
    "called interrupted": called_interrupted,
    "joiner and partner exchanged": exchanged("joins"),
    "who stays and who leaves exchanged": exchanged("splits"),
    "formed a step later": formed_later,
    "an empty step": empty_step_added,
}


def misses(forge: Forge, records: list[Record], most: int) -> tuple[int, list[int]]:
    """Return how many records were forged, each at a random place, and which passed."""
    rng, tried, missed = np.random.default_rng(26), 0, []
    for number, record in enumerate(records):
        forged = list(forge(record)) if tried < most else []
        if forged:
            tried += 1
            if not judge(forged[int(rng.integers(len(forged)))]).findings:
                missed.append(number)
    return tried, missed


@pytest.mark.parametrize("name", FORGERIES)
@pytest.mark.thorough
def test_a_forged_field_is_found(name: str, records: list[Record]) -> None:
    tried, missed = misses(FORGERIES[name], records, most=20)
    assert missed == []
    assert tried >= LEAST.get(name, 10)


LEAST = {"took twice": 1, "took left out": 1, "joins turned": 1, "lost turned": 0}
LEAST |= {"shown turned": 1, "found turned": 4}
LEAST |= {"joiner and partner exchanged": 5}
"""In how many records a field can be forged at least, where these are few."""


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_any_forged_field_of_many_records_is_found(seed: int) -> None:
    records = [record for records in play(1000 + seed, 12) for record in records]
    assert [judge(record).findings for record in records] == [()] * len(records)
    found = {name: misses(forge, records, most=60)[1] for name, forge in FORGERIES.items()}
    assert found == {name: [] for name in FORGERIES}
