"""Completion: every task that is recorded as done was done, and every one that was is recorded."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Mapping

from teamformer.mission.model import Mission
from teamformer.mission.parts.capabilities import describe, missing
from teamformer.mission.parts.grid import Grid, Place
from teamformer.record.referee.rules.loads import Loads
from teamformer.record.referee.rules.teams import Fleet, RecordedTeam, are_together
from teamformer.record.referee.rules.verdict import Notes

SMALLEST_SQUARE = 1e-3  # metres


class _Places:
    """Finds the tasks in a place, by cell; on a plane by squares as wide as the arrival radius."""

    def __init__(self, mission: Mission) -> None:
        self._mission = mission
        world = mission.world
        self._reach = 0 if isinstance(world, Grid) else 1  # squares around
        self._side = 1.0 if isinstance(world, Grid) else max(world.arrival_radius, SMALLEST_SQUARE)
        self._tasks: dict[tuple[int, int], list[int]] = defaultdict(list)
        self._at = [task.at for task in mission.tasks]
        for number, place in enumerate(self._at):
            self._tasks[self._square(place)].append(number)

    def at(self, task: int) -> Place:
        """Return where a task is; of a load that is carried, where it was taken up."""
        return self._at[task]

    def move(self, task: int, place: Place) -> None:
        """Let a task be elsewhere."""
        self._tasks[self._square(self._at[task])].remove(task)
        self._at[task] = place
        self._tasks[self._square(place)].append(task)

    def tasks_at(self, place: Place) -> list[int]:
        """Return the tasks that a team in a place stands at."""
        column, row = self._square(place)
        around = range(-self._reach, self._reach + 1)
        near = (self._tasks.get((column + i, row + j), ()) for i in around for j in around)
        world = self._mission.world
        return sorted(k for part in near for k in part if are_together(world, place, self._at[k]))

    def _square(self, place: Place) -> tuple[int, int]:
        return int(place[0] / self._side), int(place[1] / self._side)


class Tasks:
    """Which tasks are known, done and called off, and who serves them.

    `any_broken_off` and `any_overdue` say whether a service of the latest step was; it is overdue
    where it took longer than was `believed`.
    """

    def __init__(
        self,
        mission: Mission,
        believed: Mission | None = None,
        is_coordinated: bool = False,
    ) -> None:
        self.mission = mission
        self._is_coordinated = is_coordinated
        self.done: dict[int, int] = {}  # task -> step
        self.cancelled: dict[int, int] = {}  # task -> step in which it was called off, undone
        self.any_broken_off = self.any_overdue = False
        self._believed = (believed or mission).tasks
        self._expected: dict[int, int] = {}  # task -> steps that its service is to take
        self._number = {task.name: number for number, task in enumerate(mission.tasks)}
        self.places = _Places(mission)
        self.loads = Loads(mission)

    def opens_after(self, task: int) -> int | None:
        """Return how many steps are made when a task may begin; None if it never may.

        That is when it is known, its window begins, and all that it comes after is over.
        """
        wanted, known = self.mission.tasks[task], self.known_after(task)
        before = [self.over_in(self._number[name]) for name in wanted.after]
        if known is None or None in before:
            return None
        begins = 0 if wanted.between is None else math.ceil(wanted.between[0])
        opens = max([known, begins, *(step for step in before if step is not None)])
        return self._unless_called_off(task, opens)

    def known_after(self, task: int) -> int | None:
        """Return how many steps are made when a task becomes known; None if it never does."""
        return self._unless_called_off(task, self.mission.tasks[task].appears)

    def _unless_called_off(self, task: int, steps: int) -> int | None:
        """Return `steps`, or None if the task is called off within that many steps."""
        cancelled = self.mission.tasks[task].cancelled
        return None if cancelled is not None and cancelled <= steps else steps

    def shared_out_after(self, task: int) -> int | None:
        """Return how many steps are made when a task is shared out; None if it never is.

        Plans have the tasks that are known, the paper's order those that may begin.
        """
        return self.known_after(task) if self._is_coordinated else self.opens_after(task)

    def over_in(self, task: int) -> int | None:
        """Return the step in which a task was done or called off; None if it was not yet."""
        return self.done.get(task, self.cancelled.get(task))

    @property
    def are_over(self) -> bool:
        """Say whether every task is done or called off."""
        return len(self.done) + len(self.cancelled) == len(self.mission.tasks)

    @property
    def last(self) -> int:
        """Return the latest step in which a task was done or called off."""
        return max([0, *self.done.values(), *self.cancelled.values()])

    def is_open(self, task: int, steps_made: int) -> bool:
        """Say whether a task is known and not over after so many steps."""
        known = self.known_after(task)
        return self.over_in(task) is None and known is not None and known <= steps_made

    def may_begin(self, task: int, step: int) -> bool:
        """Say whether a task may begin in a step."""
        opens = self.opens_after(task)
        return self.over_in(task) is None and opens is not None and opens < step

    def to_share_out(self, steps_made: int) -> set[int]:
        """Return the tasks that plans or the paper's order have after `steps_made` steps."""
        return {
            task
            for task in range(len(self.mission.tasks))
            if (since := self.shared_out_after(task)) is not None
            and since <= steps_made
            and ((over := self.over_in(task)) is None or steps_made < over)
        }

    def call_off(self, fleet: Fleet, step: int) -> bool:
        """Call off the undone tasks that are cancelled in a step; say whether any is."""
        gone = {
            number
            for number, task in enumerate(self.mission.tasks)
            if task.cancelled == step and number not in self.done
        }
        self.cancelled |= dict.fromkeys(gone, step)
        for team in fleet.teams.values():
            for task in gone & team.services.keys():
                del team.services[task]
            team.carries = None if team.carries in gone else team.carries
            team.task = None if team.task in gone else team.task
        self.loads.forget(gone)
        return bool(gone)

    def cost(self) -> float | None:
        """Return the mean by weight of what the mission's cost names; None if it has none."""
        weights, tasks = self.mission.cost, self.mission.tasks
        if weights is None or not self.are_over:
            return None
        told = {"makespan": float(self.last), "max_tardiness": 0.0}
        told |= {"tardiness": 0.0, "completion": 0.0}
        for number, step in self.done.items():
            task = tasks[number]
            late = 0.0 if task.between is None else max(0.0, step - task.between[1])
            told["tardiness"] += task.weight * late
            told["completion"] += task.weight * step
            told["max_tardiness"] = max(told["max_tardiness"], late)
        return sum(told[name] * weight for name, weight in weights.items()) / sum(weights.values())

    def lateness(self) -> dict[str, float]:
        """Return by how many steps tasks were done after their window, for those that were."""
        late = {}
        for task, step in self.done.items():
            wanted = self.mission.tasks[task]
            if wanted.between is not None and step > wanted.between[1]:
                late[wanted.name] = step - wanted.between[1]
        return late

    def arrivals(self) -> set[int]:
        """Return after how many steps there are new tasks to share out."""
        steps = (self.shared_out_after(task) for task in range(len(self.mission.tasks)))
        return {step for step in steps if step is not None}

    def complete(
        self,
        fleet: Fleet,
        recorded: dict[int, int],
        heading: Mapping[int, int | None],
        step: int,
        notes: Notes,
    ) -> None:
        """Work out what is done in a step and compare it with the record, task -> slot.

        `heading` says what the record has teams head for whose assignment has changed.
        """
        found: dict[int, int] = {}
        self.any_broken_off = self.any_overdue = False
        self.loads.begin_step(fleet)
        for slot, team in sorted(fleet.teams.items()):
            for task in sorted(team.services):
                self._serve(fleet, slot, team, task, found)
        for slot, team in sorted(fleet.teams.items()):
            if self._is_with_load(fleet, slot, team, heading.get(slot, team.task), step, found):
                continue
            for task in self.places.tasks_at(team.at):
                is_plain = task not in found and not self.loads.is_load(task)
                if is_plain and self._can_begin(fleet, team, task, step):
                    self._begin(fleet, slot, team, task, found)
        self.loads.put_down(self.places)
        for task in sorted(found.keys() | recorded.keys()):
            self._compare(fleet, task, found.get(task), recorded.get(task), step, notes)
        over = found.keys() | recorded.keys()
        self.done |= {task: self.done.get(task, step) for task in over}
        for team in fleet.teams.values():
            for task in over & team.services.keys():
                del team.services[task]
            team.carries = None if team.carries in over else team.carries

    def _is_with_load(
        self,
        fleet: Fleet,
        slot: int,
        team: RecordedTeam,
        heads_for: int | None,
        step: int,
        found: dict[int, int],
    ) -> bool:
        """Let a team begin with the load that it has come for; say whether it is at one."""
        if heads_for is None or not self.loads.is_load(heads_for) or heads_for in found:
            return False
        is_here = not team.services and fleet.is_at(team, self.places.at(heads_for))
        if is_here and self._can_begin(fleet, team, heads_for, step):
            self._begin(fleet, slot, team, heads_for, found)
            return True
        return heads_for in team.services

    def _can_begin(self, fleet: Fleet, team: RecordedTeam, task: int, step: int) -> bool:
        if not self.may_begin(task, step) or self.loads.is_let_go(task):
            return False
        is_served = any(task in other.services for other in fleet.teams.values())
        return not is_served and fleet.covers(team, task)

    def _serve(
        self, fleet: Fleet, slot: int, team: RecordedTeam, task: int, found: dict[int, int]
    ) -> None:
        if team.carries == task:
            self._carry(fleet, slot, team, task, found)
            return
        team.services[task] -= 1
        if not fleet.covers(team, task):
            del team.services[task]
            self.any_broken_off = True
        elif team.services[task] == 0 and self.loads.is_load(task):
            self._take_up(fleet, slot, team, task, found)
        elif team.services[task] == 0:
            del team.services[task]
            found[task] = slot
        else:
            self._expect_end(task, team.services[task])

    def _expect_end(self, task: int, rest: int) -> None:
        """Expect a service that ought to be over to end amid what is left of the longest."""
        served = int(self.mission.tasks[task].duration) - rest
        if served >= self._expected[task]:
            self._expected[task] = (served + 1 + int(self._believed[task].longest) + 1) // 2
            self.any_overdue = True

    def _take_up(
        self, fleet: Fleet, slot: int, team: RecordedTeam, task: int, found: dict[int, int]
    ) -> None:
        self.loads.take_up(slot, team, task)
        self._carry(fleet, slot, team, task, found)

    def _carry(
        self, fleet: Fleet, slot: int, team: RecordedTeam, task: int, found: dict[int, int]
    ) -> None:
        """Let a team be with its load at the end of a step."""
        if not fleet.covers(team, task):
            self.loads.let_go(team, task)
            self.any_broken_off = True
        elif self.loads.is_delivered(fleet, team, task):
            found[task] = slot

    def _begin(
        self, fleet: Fleet, slot: int, team: RecordedTeam, task: int, found: dict[int, int]
    ) -> None:
        duration = int(self.mission.tasks[task].duration)  # whole where there are steps
        if duration:
            team.services[task] = duration
            self._expected[task] = max(1, int(self._believed[task].duration))
            team.credit = 0.0
        elif self.loads.is_load(task):
            team.credit = 0.0
            self._take_up(fleet, slot, team, task, found)
        else:
            found[task] = slot

    def _compare(
        self,
        fleet: Fleet,
        task: int,
        found: int | None,
        recorded: int | None,
        step: int,
        notes: Notes,
    ) -> None:
        if found == recorded:
            return
        name = self.mission.tasks[task].name
        if recorded is None:
            assert found is not None
            team = fleet.name(fleet.teams[found])
            notes.note(f"{team} does task {name}, and the record leaves it out")
        elif task in self.done:
            notes.note(f"task {name} is done again; it was done in step {self.done[task]}")
        else:
            notes.note(f"task {name} cannot be done: {self._why_not(fleet, task, recorded, step)}")

    def _why_not(self, fleet: Fleet, task: int, slot: int, step: int) -> str:
        wanted = self.mission.tasks[task]
        if task in self.cancelled:
            return f"it was called off in step {self.cancelled[task]}"
        if not self.may_begin(task, step):
            opens = self.opens_after(task)
            if opens is None:
                before = [n for n in wanted.after if self.over_in(self._number[n]) is None]
                return f"it comes after {', '.join(before)}" if before else "it is called off first"
            what = "appears" if opens == self.known_after(task) else "may begin"
            return f"it {what} after {opens} steps"
        team = fleet.teams.get(slot)
        if team is None:
            return f"there is no team of robot {self.mission.robots[slot].name} as its lowest"
        place = self.places.at(task) if wanted.to is None else wanted.to
        if not fleet.is_at(team, place):
            what = "the task" if wanted.to is None else "where its load is brought"
            return f"{fleet.name(team)} is at {list(team.at)}, {what} at {list(place)}"
        if not fleet.covers(team, task):
            short = describe(missing(team.counts, wanted.needs))
            return f"{fleet.name(team)} lacks {short}"
        if wanted.to is not None:
            return f"{fleet.name(team)} has not brought its load there and unloaded it"
        if wanted.duration:
            return f"{fleet.name(team)} has not served it for {wanted.duration} steps"
        return f"another team than {fleet.name(team)} is first"
