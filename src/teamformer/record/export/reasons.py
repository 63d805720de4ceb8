"""Why a robot did what it did: its story, as the record is told."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

from teamformer.base.naming import listed
from teamformer.mission.keys.mission_keys import HOME
from teamformer.record.phases import (
    AT_WORK,
    CARRYING,
    FORMING,
    IDLE,
    LOADING,
    LOST,
    OFF,
    SERVING,
    UNLOADING,
    WAITING,
)
from teamformer.record.record import Record, Step
from teamformer.record.teams import Teams
from teamformer.record.telling.whole import told_of
from teamformer.record.told.told_record import Run, ToldRecord
from teamformer.world.rules.constants import NOBODY

VERBS = {
    WAITING: "waits at",
    SERVING: "serves",
    LOADING: "loads",
    CARRYING: "carries",
    UNLOADING: "unloads",
}


@dataclass(frozen=True)
class StoryPart:
    """What a robot did from the end of one step to the end of another, or by times, and why."""

    begun: float
    ended: float
    what: str
    why: str


class _Company(NamedTuple):
    """With whom a robot was in a step, and from whom it parted, by name."""

    mates: str
    left: str


_Deed = tuple[float, float, Run, _Company]
"""Begin and end of something that a robot did, what it did, and with whom."""


def explain(record: Record, robot: int) -> list[StoryPart]:
    """Return the story of a robot, a part for each thing that it did.

    A plan that has it go on with what it does, as the plan before, begins none.
    """
    told, story, reasons = told_of(record), list[StoryPart](), list[tuple[int, ...]]()
    deeds = _deeds_in_time if record.is_continuous else _deeds_in_steps
    for begun, end, run, company in deeds(record, told, robot):
        what, why = _what(record, run, company), "; ".join(told.texts[it] for it in run.why)
        if story and (story[-1].what, reasons[-1][:1]) == (what, run.why[:1]):
            story[-1] = replace(story[-1], ended=end)
            continue
        story.append(StoryPart(begun, end, what, why))
        reasons.append(run.why)
    return story


def _deeds_in_steps(record: Record, told: ToldRecord, robot: int) -> Iterator[_Deed]:
    """Yield begin and end of runs; those of forming anew where the robot parts from somebody."""
    company = _company(record, robot)
    for last, run in told.reasoned_runs_of(robot):
        begun, end = int(run.begun), int(last)
        cuts = [n for n in range(begun + 1, end) if company[n].left != company[n - 1].left]
        begins = [begun, *(cuts if run.phase == FORMING else ())]
        for first, until in zip(begins, [*begins[1:], end], strict=True):
            yield first, until, run, company[first]


def _deeds_in_time(record: Record, told: ToldRecord, robot: int) -> Iterator[_Deed]:
    """Yield begin and end of runs, with those who form or are at work with the robot."""
    names = [one.name for one in record.mission.robots]
    for end, run in told.reasoned_runs_of(robot):
        now = [row[bisect_right(row, run.begun, key=lambda it: it.begun) - 1] for row in told.runs]
        is_joint = run.phase in (FORMING, *AT_WORK)
        mates = [n for n, other in enumerate(now) if is_joint and other[1:3] == run[1:3]]
        together = ", ".join(names[mate] for mate in mates if mate != robot)
        yield run.begun, end, run, _Company(together, "")


def _what(record: Record, run: Run, company: _Company) -> str:
    """Return what a robot does, and with whom."""
    mates, left = company
    if run.phase in (LOST, IDLE, OFF):
        what = run.phase
    elif run.phase == FORMING:
        return f"parts from {left}" if left else f"forms with {mates}"
    elif run.task == NOBODY:
        what = _walks_away(record)
    else:
        name = record.true_mission.tasks[run.task].name
        what = f"{VERBS.get(run.phase or '', 'walks to')} {name}"
    return f"{what}, with {mates}" if mates and run.phase != LOST else what


def _walks_away(record: Record) -> str:
    """Return what a robot does that walks to no task."""
    if not record.is_continuous:
        return "walks, while plans are made anew"
    return "walks home" if record.mission.ends == HOME else "walks to where it stops"


def _company(record: Record, robot: int) -> list[_Company]:
    """Return with whom a robot was in each step, the first at 0."""
    teams, company = Teams(record.mission.robots, record.start), list[_Company]()
    names = [one.name for one in record.mission.robots]
    for step in record.steps:
        teams.follow(step)
        mates = [r for r in teams.robots.get(teams.slot[robot], ()) if r != robot]
        left = [names[r] for r in _parted(step, robot) if r != robot and r not in mates]
        company.append(_Company(", ".join(names[r] for r in mates), listed(left)))
    return company


def _parted(step: Step, robot: int) -> list[int]:
    """Return the robots of a team that parts in a step, if it is a robot's; else nobody."""
    parted = ((*stay, *leave) for stay, leave in step.splits)
    return sorted(next((robots for robots in parted if robot in robots), ()))


def story_lines(record: Record, robot: int) -> Iterator[tuple[str, str, str]]:
    """Yield (steps or times, what, why) of each part as texts."""
    first = 0 if record.is_continuous else 1  # a step ends where the next one begins
    for part in explain(record, robot):
        yield f"{part.begun + first:g}-{part.ended:g}", part.what, part.why
