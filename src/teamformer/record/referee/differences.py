"""Where a record tells otherwise of a step than the rules: the first difference, in words."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from teamformer.mission.model import Mission
from teamformer.mission.parts.capabilities import describe, missing, total
from teamformer.mission.parts.grid import Place
from teamformer.record.phases import CHARGING, QUEUEING
from teamformer.record.record import TeamAt
from teamformer.record.referee.told import KINDS, Earlier, Rows
from teamformer.world.reference.state import PlainWorld


def first_difference(world: PlainWorld, before: Earlier, rules: Rows, told: Rows) -> str | None:
    """Return the first difference between what rules and record tell of a step; None if none is.

    What leads to something else comes first: splits before places, these before what is done, and
    that before what teams head for afterwards.
    """
    kinds = [kind for kind in KINDS if kind in rules and rules[kind] != told[kind]]
    if not kinds:
        return None
    is_first = kinds == ["teams"] or _are_elsewhere(world, before, rules, told)
    kind = kinds[0] if is_first or kinds[0] != "teams" else kinds[1]
    if kind == "teams":
        return _difference_of_teams(world, before, rules[kind], told[kind])
    return _difference_of_rows(world, kind, rules[kind], told[kind])


def _are_elsewhere(world: PlainWorld, before: Earlier, rules: Rows, told: Rows) -> bool:
    """Say whether the record has a team elsewhere than the rules."""
    by_rules, said = (
        before.teams | {row.slot: row for row in rows.get("teams", ())} for rows in (rules, told)
    )
    both = by_rules.keys() & said.keys() & world.teams.keys()
    return any(by_rules[slot][1:3] != said[slot][1:3] for slot in both)


def _difference_of_rows(
    world: PlainWorld, kind: str, rules: tuple[Any, ...], told: tuple[Any, ...]
) -> str:
    phrase = Wording(world.mission).phrases[kind]
    missing = [row for row in rules if row not in told]
    more = [row for row in told if row not in rules]
    if not missing and not more:
        return f"the rows of {kind} are not in order, each of them once"
    if missing and more and _about(missing[0]) == _about(more[0]):
        return f"by the rules {phrase(missing[0])}; in the record {phrase(more[0])}"
    if missing:
        return f"by the rules {phrase(missing[0])}, and the record does not say so"
    why = _why_not_done(world, *more[0]) if kind == "done" else "by the rules it is not so"
    return f"the record says that {phrase(more[0])}, but {why}"


def _why_not_done(world: PlainWorld, task: int, slot: int | None) -> str:
    """Say why the team of a slot cannot have done a task in the latest step."""
    team, wanted, over = (
        None if slot is None else world.teams.get(slot),
        world.truth.tasks[task],
        world.over_in(task),
    )
    if over is not None:
        return f"it was over in step {over}"
    if task not in world.known:
        return f"it appears after {wanted.appears} steps"
    if task not in world.may_begin:
        return "it may not begin yet"
    if team is None:
        return "there is no such team"
    have = total(world.mission.robots[robot].can for robot in team.robots)
    if lacks := missing(have, wanted.needs):
        return f"that team lacks {describe(lacks)}"
    place = world.at[task] if wanted.to is None else wanted.to
    if not world.is_same(team.at, place):
        at, there = (Wording(world.mission).place(one) for one in (team.at, place))
        return f"that team is at {at}, the task at {there}"
    return "that team has not been at work on it for long enough"


def _about(row: Any) -> Any:
    """Return what a row is about: of a split its team, else what it names first."""
    if isinstance(row, tuple) and isinstance(row[0], tuple):
        return sorted(robot for part in row for robot in part)
    return row[0] if isinstance(row, tuple) else row


def _difference_of_teams(
    world: PlainWorld,
    before: Earlier,
    rules: tuple[TeamAt, ...],
    told: tuple[TeamAt, ...],
) -> str:
    """Say of the first team that the record has elsewhere or heading elsewhere, both places."""
    names = Wording(world.mission)
    by_rules, in_record = ({row.slot: row for row in rows} for rows in (rules, told))
    for slot in sorted(by_rules.keys() | in_record.keys()):
        if slot not in world.teams:
            return f"the record has a team of robot {names.robot(slot)} as its lowest; none is"
        team, was = names.team(world.teams[slot].robots), before.teams.get(slot)
        due, said = by_rules.get(slot, was), in_record.get(slot, was)
        if said is None:
            return f"{team} is new, and the record does not say where it is"
        assert due is not None
        if due[1:3] != said[1:3]:
            at, there = (names.place(row[1:3]) for row in (due, said))
            return f"{team} is at {at} by the rules and at {there} in the record"
        if due.task != said.task:
            goal, other = (names.heads_for(row.task) for row in (due, said))
            return f"{team} heads for {goal} by the rules and for {other} in the record"
        if slot not in by_rules:
            return f"the record says again where {team} is, which has not changed"
    return "the rows of teams are not in order of their slots, one for each"


AT_CHARGER = {CHARGING: "charges", QUEUEING: "waits for a charger", "": "is done at a charger"}
"""What robots do there, in words."""


class Wording:
    """Robots, teams, tasks, places and rows of a mission in words."""

    def __init__(self, mission: Mission) -> None:
        self._mission = mission
        robot, task = self.robot, self.task
        self.phrases: dict[str, Callable[[Any], str]] = {
            "splits": lambda row: f"{self.robots(row[0])} stay and {self.robots(row[1])} leave",
            "joins": lambda row: f"{self.led_by(row[0])} joins {self.led_by(row[1])}",
            "named": lambda slot: f"the decision of {self.led_by(slot)} names its task",
            "lost": lambda number: f"robot {robot(number)} is lost",
            "back": lambda number: f"robot {robot(number)} is back",
            "found": lambda number: f"task {task(number)} is found",
            "moved": lambda row: f"task {task(row[0])} is believed to be at {self.place(row[1:])}",
            "shown": lambda number: f"it becomes known what task {task(number)} needs",
            "taken": lambda row: f"{self.led_by(row[1])} takes up the load of {task(row[0])}",
            "left": lambda row: f"the load of {task(row[0])} is set down at {self.place(row[1:])}",
            "served": lambda row: self.served(*row),
            "unloads": lambda number: f"unloading of {task(number)} begins",
            "done": lambda row: f"task {task(row[0])} is done by {self.doer(row[1])}",
            "pursued": lambda row: f"{self.led_by(row[0])} pursued task {task(row[1])}",
            "took": lambda row: f"{self.robots(row)} exchange their parts of the plan",
            "missed": lambda number: f"task {task(number)} is missed",
            "charge": lambda row: f"robot {robot(row[0])} {AT_CHARGER[row[1]]}",
            "heard": lambda row: f"robot {robot(row[1])} hears robot {robot(row[0])}",
        }

    def robot(self, number: int) -> str:
        """Name a robot."""
        return self._mission.robots[number].name

    def task(self, number: int) -> str:
        """Name a task."""
        return self._mission.tasks[number].name

    def heads_for(self, task: int | None) -> str:
        """Name what a team heads for."""
        return "nothing" if task is None else f"task {self.task(task)}"

    def led_by(self, slot: int) -> str:
        """Name a team by its lowest robot."""
        return f"the team of robot {self.robot(slot)}"

    def doer(self, slot: int | None) -> str:
        """Name who did a task."""
        return "nobody" if slot is None else self.led_by(slot)

    def served(self, task: int, robots: tuple[int, ...]) -> str:
        """Say who serves a task from a step on, or that nobody does any more."""
        if not robots:
            return f"the service of task {self.task(task)} breaks off"
        return f"task {self.task(task)} is served by {self.robots(robots)}"

    def robots(self, numbers: Iterable[int]) -> str:
        """Return robots by name, in brackets."""
        names = [self.robot(number) for number in numbers]
        shown = names if len(names) <= 6 else [*names[:5], f"and {len(names) - 5} more"]
        return f"[{', '.join(shown)}]"

    def team(self, robots: Iterable[int]) -> str:
        """Name a team by its robots."""
        return f"team {self.robots(robots)}"

    def place(self, at: Place) -> str:
        """Write a place."""
        return f"({at[0]:.12g}, {at[1]:.12g})"
