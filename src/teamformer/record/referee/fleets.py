"""Judging the record of a fleet: what snapshots, one a step, can show of what robots did.

Robots walk, join and part at any time in between, by their own word, so the rules of steps do not
hold. Whoever did what, they must have been able to: to be there by then, and to do it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise

from teamformer.mission.parts.capabilities import describe, missing, total
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.roads import Roads
from teamformer.record.phases import CHARGING, is_same_place
from teamformer.record.record import Record, Step, TeamAt
from teamformer.record.referee.differences import Wording
from teamformer.record.referee.verdict import Notes
from teamformer.record.referee.walking import LeastWalks
from teamformer.record.snapshots.fleet_rules import (
    is_in_shift,
    is_too_late,
    may_miss,
    told_within,
    wrong_status,
)
from teamformer.record.snapshots.services_seen import AtWork, ServicesSeen
from teamformer.record.task_times import over_steps
from teamformer.record.teams import Teams

NEVER_WRITTEN = ("named", "took", "pursued")
"""Kinds of rows that only steps have which are played by rules."""


class FleetSeen:
    """Goes through the snapshots of a record; `go_on` says what cannot be in the next."""

    def __init__(self, record: Record) -> None:
        self.done: dict[int, int] = {}  # task -> step
        self.missed: set[int] = set()
        self._at_chargers: dict[int, str] = {}
        self._mission, self._length = record.true_mission, len(record.steps)
        self._unseen_places = {k for k, task in enumerate(record.mission.tasks) if task.within}
        self._unseen_needs = {k for k, task in enumerate(record.mission.tasks) if task.may_need}
        self._teams = Teams(record.mission.robots, record.start)
        self._walks = LeastWalks(record.mission)
        self._words = Wording(record.mission)
        self._lies = [task.at for task in record.true_mission.tasks]
        self._up: set[int] = set()
        self._steps = 0

    def go_on(self, step: Step) -> Iterator[str]:
        """Go on to the end of a step, and say what cannot be; no more after what parts or joins."""
        self._steps += 1
        before = dict(self._teams.robots)
        if wrong := next(self._formed(step), None):
            yield wrong
            return
        yield from self._placed(step, before)
        yield from self._loads(step)
        yield from self._learned(step)
        for task, slot in step.done:
            yield from self._did(task, slot, step)
        yield from self._given_up(step)
        yield from self._charging(step)
        for kind in NEVER_WRITTEN:
            if getattr(step, kind):
                yield f"has rows of {kind}, which no fleet tells"
        if any(one >= other for one, other in pairwise(step.heard)):
            yield "the rows of heard are not in order, each of them once"

    def _formed(self, step: Step) -> Iterator[str]:
        """Part and join teams; yield what cannot be, and stop there."""
        teams, words = self._teams, self._words
        for stay, leave in step.splits:
            both = tuple(sorted((*stay, *leave)))
            if not stay or not leave or teams.robots.get(both[0]) != both:
                yield f"{words.robots(both)} part, and are no team"
            teams.split(stay, leave)
        for one, other in step.joins:
            if one == other or not {one, other} <= teams.robots.keys():
                yield f"{words.led_by(one)} joins {words.led_by(other)}, and there are no two such"
            teams.join(one, other)
        for robot in step.lost:
            if robot in teams.lost():
                yield f"robot {words.robot(robot)} is lost, and was so before"
            teams.lose(robot)
        for robot in step.back:
            if robot not in teams.lost():
                yield f"robot {words.robot(robot)} is back, and was not lost"
            teams.bring_back(robot)

    def _placed(self, step: Step, before: dict[int, tuple[int, ...]]) -> Iterator[str]:
        """Say what is wrong with where teams are and what they head for, and put them there."""
        teams, rows = self._teams, step.teams
        if any(one.slot >= other.slot for one, other in pairwise(rows)):
            yield "the rows of teams are not in order of their slots, one for each"
        new = teams.robots.keys() - before.keys() - {row.slot for row in rows}
        if new:
            yield f"{self._words.led_by(min(new))} is new, and the record does not say where it is"
        for row in rows:
            if row.slot not in teams.robots:
                yield f"says where {self._words.led_by(row.slot)} is, and there is no such team"
                continue
            yield from self._wrong_place(row, is_new=row.slot not in before)
            teams.put([row])

    def _wrong_place(self, row: TeamAt, is_new: bool) -> Iterator[str]:
        teams, words, at = self._teams, self._words, (row.x, row.y)
        if not is_new and row == teams.row(row.slot):
            yield f"says again where {words.led_by(row.slot)} is, which has not changed"
        if row.task is not None and self._mission.tasks[row.task].appears > self._steps:
            yield f"{words.led_by(row.slot)} heads for {words.task(row.task)} before that appears"
        robots = [self._mission.robots[robot] for robot in teams.robots[row.slot]]
        can_be = self._mission.world.is_free(at)
        if all(robot.flies for robot in robots):
            can_be = self._mission.world.is_inside(at)
        if not can_be:
            yield f"{words.led_by(row.slot)} is at {words.place(at)}, where nobody can be"
            return
        for robot in teams.robots[row.slot]:
            yield from self._too_soon(robot, [at], 0.0)

    def _too_soon(self, robot: int, places: Sequence[Place], lasts: float) -> Iterator[str]:
        """Say so if a robot cannot have been in some places by now, and at work for some time."""
        least = self._walks.least(robot, places) + lasts
        if least > self._steps:
            yield (
                f"robot {self._words.robot(robot)} is at {self._words.place(places[-1])}, which "
                f"takes it {least:.6g} steps at least"
            )

    def _loads(self, step: Step) -> Iterator[str]:
        """Say what is wrong with loads that are set down and taken up, and put them there."""
        words, tasks = self._words, self._mission.tasks
        for task, x, y in step.left:
            at = (x, y)
            if tasks[task].to is None or task in self.done:
                yield f"task {words.task(task)} is set down, and there is no such load"
            elif not self._mission.world.is_free(at):
                yield f"the load of {words.task(task)} is set down where nobody can be"
            elif self._walks.fastest(self._lies[task], at) > self._steps:
                yield f"the load of {words.task(task)} cannot be at {words.place(at)} by then"
            self._lies[task] = at
            self._up.discard(task)
        for task, slot in step.taken:
            if tasks[task].to is None or task in self.done or task in self._up:
                yield f"task {words.task(task)} is taken up, and no such load lies there"
            elif slot not in self._teams.robots:
                yield f"{words.led_by(slot)} takes up {words.task(task)}, and there is no such team"
            elif not is_same_place(self._mission, self._teams.at[slot], self._lies[task]):
                where = words.place(self._lies[task])
                yield f"{words.led_by(slot)} takes up {words.task(task)}, which lies at {where}"
            else:
                yield from self._unable(task, slot)
            self._up.add(task)

    def _learned(self, step: Step) -> Iterator[str]:
        """Say what becomes known that was known before."""
        for task in (*(row.task for row in step.moved), *step.found):
            if task not in self._unseen_places:
                yield f"where task {self._words.task(task)} is was known before"
        for task in step.shown:
            if task not in self._unseen_needs:
                yield f"what task {self._words.task(task)} needs was known before"
        self._unseen_places -= set(step.found)
        self._unseen_needs -= set(step.shown)

    def _did(self, task: int, slot: int | None, step: Step) -> Iterator[str]:
        """Say what is wrong with a task that was done, and note it."""
        words, wanted, over = self._words, self._mission.tasks[task], self.done.get(task)
        self.done.setdefault(task, self._steps)
        if task in self.missed:
            yield f"task {words.task(task)} is done, and was missed before"
        if over is not None:
            yield f"task {words.task(task)} is done again, after step {over}"
            return
        if wanted.appears + wanted.duration + wanted.unload > self._steps + 1:
            yield f"task {words.task(task)} is done sooner than it can be"
        done_by = max(0.0, self._steps - told_within(self._mission))
        if is_too_late(self._mission, done_by):
            yield f"task {words.task(task)} is done when the mission is over"
        if slot is None:
            return
        if slot not in self._teams.robots:
            yield f"task {words.task(task)} is done by {words.led_by(slot)}, and there is none"
            return
        yield from self._unable(task, slot)
        ends = [self._end_of(other) for other, doer in step.done if doer == slot]
        if not any(is_same_place(self._mission, self._teams.at[slot], end) for end in ends):
            where = words.place(self._end_of(task))
            yield f"task {words.task(task)} at {where} is done by {words.led_by(slot)} elsewhere"
        for robot in self._teams.robots[slot]:
            rota, lasts = self._mission.robots[robot].rota, wanted.duration
            if wanted.to is None and not is_in_shift(rota, self._steps - lasts, done_by):
                who = f"robot {words.robot(robot)}"
                yield f"{who} does task {words.task(task)}, and no shift of it is so long"
            places = self._walks.note(robot, self._end_of(task))
            yield from self._too_soon(robot, places, wanted.duration + wanted.unload)

    def _given_up(self, step: Step) -> Iterator[str]:
        """Say which tasks cannot be missed that are, and note them."""
        for task, _ in step.missed:
            is_over = task in self.done or task in self.missed
            if is_over or not may_miss(
                self._mission, task, self._steps, self._steps == self._length
            ):
                yield f"task {self._words.task(task)} can still be done, or is over"
            self.missed.add(task)

    def _charging(self, step: Step) -> Iterator[str]:
        """Say who cannot be at a charger that is said to, and where too many charge."""
        self._at_chargers |= dict(step.charge)
        self._at_chargers = {robot: what for robot, what in self._at_chargers.items() if what}
        chargers, taken = self._mission.chargers, list[Place]()
        for robot, what in self._at_chargers.items():
            who, here = self._words.robot(robot), self._teams.place(robot)
            is_able = self._mission.robots[robot].battery and robot not in self._teams.lost()
            room = sum(it.room for it in chargers if is_same_place(self._mission, here, it.at))
            if not is_able or not room:
                yield f"robot {who} is said to charge, and is at no charger or has no battery"
                continue
            taken += [here] if what == CHARGING else []
            if sum(is_same_place(self._mission, here, other) for other in taken) > room:
                yield f"robot {who} charges where there is no room to"

    def _end_of(self, task: int) -> Place:
        """Return where a task is done: a load, where it is brought."""
        wanted = self._mission.tasks[task]
        return wanted.at if wanted.to is None else wanted.to

    def _unable(self, task: int, slot: int) -> Iterator[str]:
        """Say what a team lacks for a task, be it that some of it are lost since."""
        robots = self._mission.robots
        maybe = (*self._teams.robots[slot], *self._teams.lost())
        have = total(robots[robot].can for robot in maybe)
        if lacks := missing(have, self._mission.tasks[task].needs):
            yield (
                f"{self._words.led_by(slot)} lacks {describe(lacks)} for {self._words.task(task)}"
            )


def judge_fleet(record: Record, notes: Notes) -> int:
    """Check what the record of a fleet tells; return how many tasks were done."""
    _judge_form(record, notes)
    if notes.findings:
        return 0
    seen = FleetSeen(record)
    for notes.step, step in enumerate(record.steps, start=1):
        for wrong in seen.go_on(step):
            notes.note(wrong)
        if notes.findings:  # what comes after that moment is not judged
            return len(seen.done)
    _judge_services(record, notes)
    notes.step = 0
    _judge_ending(record, seen, notes)
    return len(seen.done)


def _judge_form(record: Record, notes: Notes) -> None:
    """Check that a record has what those of fleets have, and nothing else."""
    mission = record.mission
    if isinstance(mission.world, Roads):
        notes.note("the mission is on roads, which no fleet of processes takes")
    known = tuple(k for k, task in enumerate(mission.tasks) if task.appears == 0)
    if record.start != tuple((r, (r,), *at.at) for r, at in enumerate(mission.robots)):
        notes.note("the starting teams are not those of a fleet: each robot alone, in order")
    if record.orders != ((0, known),):
        notes.note("the order is not that of the tasks which are known from the start")
    for key in ("plans", "scouts", "heeds", "decisions", "lower_bound"):
        if getattr(record, key):
            notes.note(f"has {key}, which no fleet tells")


def _judge_services(record: Record, notes: Notes) -> None:
    """Check who serves what: that follows from the rest, once it is said what is served."""
    seen, due = ServicesSeen(record.true_mission), list[Step]()
    at_work: AtWork = {}
    for step in record.steps:
        serving = {**at_work, **dict(step.served)}
        at_work = {task: robots for task, robots in serving.items() if robots}
        bare = replace(step, served=(), unloads=())
        seen.add(due, bare, record.true_mission, at_work)
    words = Wording(record.mission)
    for notes.step, (said, found) in enumerate(zip(record.steps, due, strict=True), start=1):
        for kind in ("served", "unloads"):
            rows, right = getattr(said, kind), getattr(found, kind)
            if rows != right:
                phrase, odd = words.phrases[kind], [row for row in right if row not in rows]
                more = [row for row in rows if row not in right]
                what = phrase((odd or more or rows)[0])
                verb = "" if odd else "not "
                notes.note(f"by what was seen it is {verb}so that {what}")


def _judge_ending(record: Record, seen: FleetSeen, notes: Notes) -> None:
    end, steps = record.end, record.steps
    over = over_steps(record)
    undone = [task.name for k, task in enumerate(record.mission.tasks) if k not in over]
    is_complete = end.status == "completed"
    last = math.ceil(max(over.values(), default=0))
    facts = {
        "makespan": (
            end.makespan,
            last if is_complete else None,
        ),
        "steps": (end.steps, len(steps)),
        "tasks_done": (end.tasks_done, len(seen.done)),
        "joins": (end.joins, sum(len(step.joins) for step in steps)),
        "splits": (end.splits, sum(len(step.splits) for step in steps)),
        "illegal_decisions": (end.illegal_decisions, 0),
        "missed": (end.missed, tuple(record.mission.tasks[k].name for k in sorted(seen.missed))),
    }
    for name, (said, found) in facts.items():
        if said != found:
            notes.note(f"the record says {name} {said}; it is {found}")
    if is_complete and end.makespan != len(steps):
        notes.note("the record goes on after all was done")
    for wrong in wrong_status(record.mission, end, undone, seen.missed):
        notes.note(wrong)
