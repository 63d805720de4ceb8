"""Loads: who carries what, where loads lie that were set down, and whether the record says so."""

from __future__ import annotations

from collections.abc import Sequence, Set
from typing import Protocol

from teamformer.mission.model import Mission
from teamformer.mission.parts.grid import Place
from teamformer.record.record import Step, TaskAt
from teamformer.record.referee.rules.teams import Fleet, RecordedTeam
from teamformer.record.referee.rules.verdict import Notes
from teamformer.record.referee.rules.walking import move_team

_Row = tuple[int, int] | TaskAt


class _LoadPlaces(Protocol):
    def move(self, task: int, place: Place) -> None: ...


class Loads:
    """Which loads are carried, and what befell them in the latest step."""

    def __init__(self, mission: Mission) -> None:
        self._tasks = mission.tasks
        self._up: set[int] = set()
        self._taken: list[tuple[int, int]] = []  # in this step: load, slot
        self._left: dict[int, Place] = {}  # in this step: where loads were set down

    def is_load(self, task: int | None) -> bool:
        """Say whether a task is brought somewhere."""
        return task is not None and self._tasks[task].to is not None

    def is_let_go(self, task: int) -> bool:
        """Say whether a load was let go of in this step, so that nobody takes it up yet."""
        return task in self._left

    def forget(self, tasks: Set[int]) -> None:
        """Forget loads that are called off: nobody brings them any more."""
        self._up -= tasks

    def begin_step(self, fleet: Fleet) -> None:
        """Forget the step before; loads lie where all who carried them were lost in this step."""
        self._taken, self._left = [], {}
        held = {team.carries for team in fleet.teams.values()}
        for team in fleet.lost.values():
            if team.carries in self._up - held:
                assert team.carries is not None
                self._left[team.carries] = team.at

    def take_up(self, slot: int, team: RecordedTeam, task: int) -> None:
        """Let a team carry a load, to stay with it where it is brought to for its unloading."""
        self._up.add(task)
        self._taken.append((task, slot))
        team.carries, team.services[task] = task, int(self._tasks[task].unload) + 1

    def let_go(self, team: RecordedTeam, task: int) -> None:
        """Let a team that cannot carry its load any more set it down where it is."""
        self._left[task] = team.at
        team.carries = None
        del team.services[task]

    def is_delivered(self, fleet: Fleet, team: RecordedTeam, task: int) -> bool:
        """Say whether a load has come where it is brought to, and is unloaded; count the steps."""
        to = self._tasks[task].to
        assert to is not None
        if fleet.is_at(team, to):
            team.services[task] -= 1
        if team.services[task] > 0:
            return False
        self._up.remove(task)
        del team.services[task]
        team.carries = None
        return True

    def put_down(self, places: _LoadPlaces) -> None:
        """At the end of a step, let loads lie where they were let go of."""
        for task, place in self._left.items():
            self._up.remove(task)
            places.move(task, place)

    def new_goals(self) -> dict[int, Place]:
        """Return where teams head for from now on that do a task whose load was moved."""
        taken = {task: self._tasks[task].to for task, _ in self._taken if task in self._up}
        return {task: to for task, to in taken.items() if to is not None} | self._left

    def compare(self, step: Step, notes: Notes) -> None:
        """Say where the record takes up or sets down other loads, or elsewhere."""
        left = {TaskAt(task, *place) for task, place in self._left.items()}
        self._compare("takes up", set(self._taken), step.taken, notes)
        self._compare("sets down", left, step.left, notes)

    def _compare(self, does: str, found: Set[_Row], said: Sequence[_Row], notes: Notes) -> None:
        for row in sorted(found - set(said)):
            name = self._tasks[row[0]].name
            notes.note(f"the record does not say who {does} the load of task {name}, or where")
        for row in sorted(set(said) - found):
            name = self._tasks[row[0]].name
            notes.note(f"the record {does} the load of task {name}, which does not happen so")
        if len(set(said)) < len(said):
            notes.note(f"the record {does} a load twice")


def follow_lost(fleet: Fleet, step: Step, notes: Notes) -> None:
    """Let teams of which nobody is left have gone to where the record sets their loads down."""
    for row in step.left:
        for team in fleet.lost.values():
            if team.carries == row.task and not team.is_way_told:
                move_team(fleet, team, (row.x, row.y), notes)
                team.is_way_told = True
