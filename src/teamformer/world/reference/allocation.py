"""Phase 4: which task a team heads for; docs/explanation/order.md has the rules."""

from __future__ import annotations

from collections import defaultdict

from teamformer.mission.parts.grid import Place
from teamformer.world.reference.formation import next_task
from teamformer.world.reference.state import PlainTeam, PlainWorld
from teamformer.world.reference.ways import apart_squared


def allocate_tasks(world: PlainWorld) -> None:
    """Give each team that serves nothing, in slot order, the task that it heads for.

    It is the one that its decision names, the next one by its plan, or, if it is free, one of the
    shared order.
    """
    allocator = None if world.is_coordinated else Allocator(world)
    for slot, team in world.in_slot_order():
        if not team.serving:
            if team.is_commanded:
                _give(team, team.named)
            elif world.is_coordinated:
                _give(team, next_task(world, team))
            elif team.task is None and allocator is not None:
                _give(team, *allocator.choose(slot, team))
            if allocator is not None:
                allocator.note(slot, team)
        team.pursued = team.task


def _give(team: PlainTeam, task: int | None, is_detour: bool = False) -> None:
    team.task, team.is_detour = task, is_detour


class Allocator:
    """Gives free teams tasks of the shared order, as the paper has it."""

    def __init__(self, world: PlainWorld) -> None:
        self._world = world
        self._heading: dict[int, set[int]] = defaultdict(set)  # slots by task
        self._task_of: dict[int, int | None] = {}
        for slot, team in world.teams.items():
            self.note(slot, team)

    def note(self, slot: int, team: PlainTeam) -> None:
        """Write down what a team heads for."""
        before, self._task_of[slot] = self._task_of.get(slot), team.task
        if before is not None:
            self._heading[before].discard(slot)
        if team.task is not None:
            self._heading[team.task].add(slot)

    def choose(self, slot: int, team: PlainTeam) -> tuple[int | None, bool]:
        """Return the task of a free team, and whether it is a detour.

        It is the first task to which the team can contribute and that nearer teams do not cover, or
        a later one that it can do alone on a detour that shortens the tour.
        """
        for position, task in enumerate(self._world.order):
            if self._contributes(team, task) and not self._is_covered(slot, team, task):
                detour = self._best_detour(slot, team, position)
                return (task, False) if detour is None else (detour, True)
        return None, False

    def _contributes(self, team: PlainTeam, task: int) -> bool:
        needs = self._world.needs[task]
        helps = any(h > 0 and n > 0 for h, n in zip(team.has, needs, strict=True))
        return helps and self._world.can_reach(team, task)

    def _is_covered(self, slot: int, team: PlainTeam, task: int) -> bool:
        """Say whether teams in sight that head for a task and are nearer to it need no help.

        Of two that are equally near, the lower slot counts as nearer.
        """
        world, helpers = self._world, []
        for other_slot in self._heading[task]:
            other = world.teams[other_slot]
            if other_slot != slot and self._senses(team, other):
                away = self._way(other, world.at[task]), other_slot
                if away < (self._way(team, world.at[task]), slot):
                    helpers.append(other.has)
        together = tuple(map(sum, zip(*helpers, strict=True)))
        return bool(helpers) and world.covers(together, task)

    def _senses(self, team: PlainTeam, other: PlainTeam) -> bool:
        return apart_squared(team.at, other.at) <= self._world.sensing_radius**2

    def _best_detour(self, slot: int, team: PlainTeam, position: int) -> int | None:
        """Return the later task to do first, alone, that shortens the tour most.

        The tour is the team's way to its next task and on through the order.
        """
        world, best, best_change = self._world, None, 0
        places = [team.at, *(world.at[task] for task in world.order[position:])]
        for i, task in enumerate(world.order[position + 1 :], start=2):
            if world.covers(team.has, task) and world.can_reach(team, task):
                change = self._change(team, places, i)
                if change < best_change and not self._is_covered(slot, team, task):
                    best, best_change = task, change
        return best

    def _change(self, team: PlainTeam, places: list[Place], i: int) -> int:
        """Return how much longer the tour is through places if the one at `i` comes first."""

        def way(one: Place, other: Place) -> int:
            return self._world.ways.length(one, other, team.flies)

        start, first, before, moved = places[0], places[1], places[i - 1], places[i]
        change = way(start, moved) + way(moved, first) - way(start, first) - way(before, moved)
        if i + 1 < len(places):
            change += way(before, places[i + 1]) - way(moved, places[i + 1])
        return change

    def _way(self, team: PlainTeam, goal: Place) -> int:
        return self._world.ways.length(team.at, goal, team.flies)
