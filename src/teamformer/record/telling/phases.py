"""What each team did in a step: worked out for those teams only for which something changed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence, Set

from teamformer.mission.model import Mission
from teamformer.mission.parts.grid import Place
from teamformer.record.phases import (
    CARRYING,
    IDLE,
    LOST,
    OFF,
    WAITING,
    WALKING,
    is_same_place,
    phase_of,
)
from teamformer.record.record import Step
from teamformer.record.teams import Teams
from teamformer.world.rules.constants import NOBODY

Deed = tuple[str, int]
"""What somebody did in a step, one of PHASES, and the task that it was about, or NOBODY."""


MAY_BE_OFF = (WALKING, WAITING, IDLE)
"""What a team does that stands still while one of its robots is outside its shifts."""


class TeamsBefore:
    """How the teams stood that a step is about to change; `slot` has the robots of some of them.

    `walking` are teams that only get on towards the task that they walked to before.
    """

    def __init__(self, teams: Teams, step: Step, deeds: Mapping[int, Deed]) -> None:
        self.slot: dict[int, int] = {}
        self.stood: dict[int, tuple[Place, int]] = {}
        parted = (robot for parts in step.splits for part in parts for robot in part)
        slots = {teams.slot[robot] for robot in (*parted, *step.lost)}
        for slot in slots | {slot for pair in step.joins for slot in pair}:
            self.slot |= dict.fromkeys(teams.robots.get(slot, ()), slot)
        self.walking: set[int] = set()
        special = {*self.slot.values(), *(slot for slot, _ in step.pursued)}
        for slot, x, y, task in step.teams:
            is_on_its_way = deeds.get(slot) == (WALKING, task) and slot not in special
            if is_on_its_way and slot in teams.robots and teams.at[slot] != (x, y):
                self.walking.add(slot)
            else:
                special.add(slot)
        for slot in special & teams.robots.keys():
            self.stood[slot] = teams.at[slot], teams.task[slot]
        for robot in step.back:
            self.stood[robot] = teams.place(robot), NOBODY

    def of(self, teams: Teams, robot: int) -> tuple[Place, int]:
        """Return where a robot was, and what it headed for; `teams` are those after the step."""
        slot = teams.slot[robot]
        found = self.stood.get(self.slot.get(robot, slot))
        return found or (teams.at[slot], teams.task[slot])


class Phases:
    """What teams did in the latest step, by slot.

    `apart` has robots that came with other tasks, and those that were off, or others that were not.
    """

    def __init__(self) -> None:
        self.deeds: dict[int, Deed] = {}
        self.apart: dict[int, Deed] = {}

    def of(self, teams: Teams, robot: int) -> Deed:
        """Return what a robot did; before the first step it is idle."""
        slot = teams.slot[robot]
        if slot == NOBODY:
            return LOST, NOBODY
        return self.apart.get(robot) or self.deeds.get(slot, (IDLE, NOBODY))

    def follow(
        self,
        mission: Mission,
        teams: Teams,
        step: Step,
        slots: Iterable[int],
        before: TeamsBefore,
        formed: set[int],
        work: Mapping[int, str],
        goals: Sequence[Place],
        were: Mapping[int, Place],
        off: Set[int],
        at_chargers: Mapping[int, str],
    ) -> list[int]:
        """Take in a step that the teams have made; return which of some do something else.

        `formed` are the teams that have parted or joined, `work` is what teams do for tasks,
        `goals` where each task is believed to be, or is brought to, `were` where those that were
        taken up or done in the step were before, `off` are the robots outside their shifts,
        `at_chargers` what robots do there.
        """
        told, others, self.apart = dict(step.pursued), [], {}
        for slot in sorted(slots):
            was_at, was_for = before.of(teams, slot)
            place, heads_for = teams.at[slot], teams.task[slot]
            task = told.get(slot, was_for if heads_for == NOBODY else heads_for)
            is_there = task != NOBODY and is_same_place(mission, place, goals[task])
            has_moved, does_work = place != was_at, work.get(slot)
            if does_work == CARRYING and is_there and not has_moved:
                does_work = None  # it waits for room to unload
            if task in were:  # it stood there until that was taken up or done
                is_there = is_there or is_same_place(mission, place, were[task])
            phase = phase_of(
                slot in step.back, slot in formed, does_work, has_moved, task, is_there
            )
            if not at_chargers.keys().isdisjoint(teams.robots[slot]):
                does = {r: at_chargers.get(r, WAITING) for r in teams.robots[slot]}
                phase = does[slot]
                self.apart |= {r: (own, task) for r, own in does.items() if own != phase}
            elif phase in MAY_BE_OFF and not off.isdisjoint(teams.robots[slot]):
                stands = IDLE if task == NOBODY else WAITING
                does = {r: OFF if r in off else stands for r in teams.robots[slot]}
                phase = does[slot]
                self.apart |= {r: (own, task) for r, own in does.items() if own != phase}
            if (phase, task) != self.deeds.get(slot):
                self.deeds[slot] = phase, task
                others.append(slot)
            if slot in formed and heads_for == NOBODY and slot not in told:
                came_for = {robot: before.of(teams, robot)[1] for robot in teams.robots[slot]}
                self.apart |= {r: (phase, own) for r, own in came_for.items() if own != task}
        return others
