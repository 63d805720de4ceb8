"""Writes the record of a fleet: a step is a snapshot of where robots say they are and with whom."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from teamformer.mission.model import Mission
from teamformer.mission.parts.grid import Place
from teamformer.record.record import FLEET, Ending, Record, Step, TaskAt, TeamAt
from teamformer.record.snapshots.deeds import Deed
from teamformer.record.snapshots.services_seen import AtWork, ServicesSeen
from teamformer.record.snapshots.teams_seen import (
    Teams,
    doers_goals,
    team_changes,
    teams_shown,
    who_did,
)
from teamformer.record.why_missed import why_missed


@dataclass(frozen=True)
class Sighting:
    """What was seen of a fleet in a step; robots and tasks are numbers.

    `said` has each robot's team by its word, and its place, of those that are there; `aims` what
    each heads for. `at_work` has what is served. `done` are tasks that were done, `taken` loads
    that were taken up, and `missed` tasks are not done any more.
    """

    said: Mapping[int, tuple[int, Place]]
    aims: Mapping[int, int | None]
    at_work: AtWork = field(default_factory=dict)
    done: Sequence[Deed] = ()
    taken: Sequence[Deed] = ()
    left: tuple[TaskAt, ...] = ()  # loads that were set down
    lost: tuple[int, ...] = ()
    back: tuple[int, ...] = ()
    heard: tuple[tuple[int, int, str], ...] = ()
    shown: tuple[int, ...] = ()  # tasks whose needs have become known
    found: tuple[int, ...] = ()  # tasks whose place has become known
    moved: tuple[TaskAt, ...] = ()  # tasks that are believed elsewhere
    missed: tuple[int, ...] = ()
    charge: Mapping[int, str] = field(default_factory=dict)  # what robots do at chargers


class SnapshotWriter:
    """Writes down what each snapshot changes; `steps` are those so far."""

    def __init__(self, mission: Mission) -> None:
        self.steps: list[Step] = []
        self._seen = ServicesSeen(mission)
        self._teams: Teams = {robot: (robot,) for robot in range(len(mission.robots))}
        self._at_chargers: Mapping[int, str] = {}
        self._shown = {r: TeamAt(r, *one.at, None) for r, one in enumerate(mission.robots)}

    def pause(self, mission: Mission) -> None:
        """Write down a step of which nobody knows anything."""
        self._seen.add(self.steps, Step(), mission, self._seen.served)

    def add(self, mission: Mission, seen: Sighting) -> Step:
        """Write down a step, and return it; the mission may have got more tasks.

        Who was lost comes last of what parts and joins teams; who is back is alone at first.
        """
        known = [deed for deed in seen.done if deed.robots]
        places, teams, doers = teams_shown(seen.said, known, seen.taken)
        before = self._teams | {robot: (robot,) for robot in seen.back}
        splits, joins = team_changes(before, teams, seen.lost)
        slot_of = {robot: slot for slot, robots in teams.items() for robot in robots}
        taken = {
            load.task: slot_of[load.robots[0]] for load in seen.taken if load.robots[0] in slot_of
        }
        goals = doers_goals(doers, taken)
        shown = {
            slot: TeamAt(slot, *places[slot], goals.get(slot, seen.aims.get(slot)))
            for slot in sorted(teams)
        }
        rows = tuple(at for slot, at in shown.items() if self._shown.get(slot) != at)
        self._teams, self._shown = teams, shown
        served, aims = self._seen.served, {at.task for at in shown.values() if at.task is not None}
        made = Step(
            joins=joins,
            splits=splits,
            lost=seen.lost,
            back=seen.back,
            teams=rows,
            done=tuple((it.task, self._doer(it, slot_of)) for it in seen.done),
            heard=seen.heard,
            taken=tuple(taken.items()),
            left=seen.left,
            shown=seen.shown,
            found=seen.found,
            moved=seen.moved,
            charge=tuple(self._charge(seen, places)),
            missed=tuple((k, why_missed(mission, k, served, aims)) for k in seen.missed),
        )
        return self._seen.add(self.steps, made, mission, seen.at_work)

    def _charge(self, seen: Sighting, places: Mapping[int, Place]) -> Iterator[tuple[int, str]]:
        """Yield the robots that do something else at chargers than in the step before.

        Who is shown where it did a task is not at a charger yet.
        """
        doing = {r: what for r, what in seen.charge.items() if seen.said[r][1] == places[r]}
        before, self._at_chargers = self._at_chargers, doing
        for robot in sorted(before.keys() | doing.keys()):
            if (now := doing.get(robot, "")) != before.get(robot, ""):
                yield robot, now

    def _doer(self, deed: Deed, slot_of: Mapping[int, int]) -> int | None:
        """Return the team to show as the one that did a task; None if none of it is there."""
        return None if slot_of.keys().isdisjoint(deed.robots) else who_did(deed, self._teams)


def fleet_record(
    mission: Mission,
    steps: Sequence[Step],
    status: str,
    seed: int = 0,
    blocked_tasks: tuple[str, ...] = (),
    truth: Mission | None = None,
) -> Record:
    """Return the record of what was seen of a fleet; one that is over ends with its last task.

    `truth` is what an uncertain mission really was, where that is known.
    """
    missed = sorted(task for step in steps for task, _ in step.missed)
    if status in ("completed", "too late"):
        ends = [n for n, step in enumerate(steps, start=1) if step.done or step.missed]
        off = (task.cancelled for task in mission.tasks if task.cancelled is not None)
        steps = steps[: max([*ends, *(math.ceil(at) for at in off)], default=0)]
    made = len(steps)
    return Record(
        mission=replace(mission, teams=()),
        method=FLEET,
        seed=seed,
        orders=((0, tuple(k for k, task in enumerate(mission.tasks) if task.appears == 0)),),
        start=tuple((robot, (robot,), *at.at) for robot, at in enumerate(mission.robots)),
        steps=tuple(steps),
        truth=truth,
        end=Ending(
            status=status,
            makespan=made if status == "completed" else None,
            steps=made,
            tasks_done=sum(len(step.done) for step in steps),
            joins=sum(len(step.joins) for step in steps),
            splits=sum(len(step.splits) for step in steps),
            illegal_decisions=0,
            blocked_tasks=blocked_tasks,
            missed=tuple(mission.tasks[task].name for task in missed),
        ),
    )
