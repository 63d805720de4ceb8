"""What a record tells of a step, and what it would tell by the rules: here alone is its format."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from teamformer.mission.parts.grid import Place
from teamformer.record.phases import CHARGING, QUEUEING
from teamformer.record.record import Record, TaskAt, TeamAt
from teamformer.world.reference.state import PlainTeam, PlainWorld, Robots

Rows = Mapping[str, tuple[Any, ...]]
"""Rows by their kind, which are the keys of a step of a record."""

KINDS = (
    *("splits", "joins", "named", "lost", "back", "teams", "found", "moved"),
    *("shown", "taken", "left", "served", "unloads", "done", "pursued", "took", "missed"),
    *("charge", "heard"),
)
"""All kinds of rows, what leads to something else first."""


def told_of(record: Record, number: int) -> Rows:
    """Return what a record tells of a step."""
    step = record.steps[number - 1]
    missed = {"missed": tuple(task for task, _ in step.missed)}
    return {kind: getattr(step, kind) for kind in KINDS} | missed


class Earlier:
    """Where teams were before a step, and what they headed for."""

    def __init__(self, world: PlainWorld) -> None:
        self.teams = {slot: _row(slot, team) for slot, team in world.teams.items()}
        self._served = _who_serves(world)
        self._at_chargers = _at_chargers(world)

    def told_by_rules(self, world: PlainWorld) -> Rows:
        """Return what there is to tell of the step that a world has made since.

        What robots took over of the plans of others comes after it.
        """
        happened = world.happened
        now = [_row(slot, team) for slot, team in world.in_slot_order()]
        return {
            "splits": tuple(happened.splits),
            "joins": tuple(sorted((_joined(world, pair) for pair in happened.joins), key=min)),
            "named": tuple(happened.named) if world.is_coordinated else (),
            "lost": tuple(happened.lost),
            "back": tuple(happened.back),
            "teams": tuple(row for row in now if row != self.teams.get(row.slot)),
            "found": tuple(happened.found),
            "moved": _placed(happened.moved),
            "shown": tuple(happened.shown),
            "taken": tuple(sorted(happened.taken.items())),
            "left": _placed(happened.left),
            "served": tuple(self._changed_services(world)),
            "unloads": tuple(sorted(_unloads(world))),
            "done": tuple(happened.done.items()),
            "pursued": tuple(self._pursued(world)),
            "charge": tuple(self._charge(world)),
            "heard": (),
        }

    def _pursued(self, world: PlainWorld) -> list[tuple[int, int]]:
        """Return what teams pursued in the step and had as assignment neither before nor after."""
        return [
            (slot, team.pursued)
            for slot, team in world.in_slot_order()
            if team.pursued is not None and team.task is None
            if slot not in self.teams or self.teams[slot].task != team.pursued
        ]

    def _charge(self, world: PlainWorld) -> Iterator[tuple[int, str]]:
        """Yield the robots that do something else at chargers than in the step before."""
        was, now = self._at_chargers, _at_chargers(world)
        for robot in sorted(was.keys() | now.keys()):
            if was.get(robot) != now.get(robot):
                yield robot, now.get(robot, "")

    def _changed_services(self, world: PlainWorld) -> Iterator[tuple[int, Robots]]:
        """Yield tasks that are no longer served, though not done, and by whom others are now."""
        begun = set(world.happened.begun) - world.carried
        now_serve = _who_serves(world)
        for task in sorted(self._served.keys() | now_serve.keys()):
            was, now = self._served.get(task, ()), now_serve.get(task, ())
            if was and task not in world.happened.done and (not now or task in begun):
                yield task, ()
            if now and (was != now or task in begun):
                yield task, now


def _who_serves(world: PlainWorld) -> dict[int, Robots]:
    return {task: team.robots for team in world.teams.values() for task in team.serving}


def _at_chargers(world: PlainWorld) -> dict[int, str]:
    """Return what robots did at chargers in the latest step."""
    happened = world.happened
    return dict.fromkeys(happened.queued, QUEUEING) | dict.fromkeys(happened.charged, CHARGING)


def _unloads(world: PlainWorld) -> Iterator[int]:
    """Yield the loads that have got to where they go in the latest step, and are not done."""
    for team in world.teams.values():
        for task, left in team.serving.items():
            if task in world.carried and left == world.mission.tasks[task].unload:
                yield task


def _row(slot: int, team: PlainTeam) -> TeamAt:
    return TeamAt(slot, *team.at, team.task)


def _joined(world: PlainWorld, pair: tuple[int, int]) -> tuple[int, int]:
    """Return joiner and partner; where both want to join one another, the lower is the joiner."""
    lower, higher = sorted(pair)
    return (lower, higher) if world.partners.get(lower) == higher else pair


def _placed(places: Mapping[int, Place]) -> tuple[TaskAt, ...]:
    return tuple(TaskAt(task, *place) for task, place in places.items())
