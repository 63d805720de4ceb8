"""Why a robot did what it did: its story, as the record is told."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

from teamformer.record.phases import (
    CARRYING,
    FORMING,
    IDLE,
    LOADING,
    LOST,
    SERVING,
    UNLOADING,
    WAITING,
)
from teamformer.record.record import Record, Step
from teamformer.record.teams import Teams
from teamformer.record.telling.reasons import listed
from teamformer.record.telling.told import Run
from teamformer.record.telling.whole import told_of
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
    """What a robot did from the end of one step to the end of another, and why."""

    begun: int
    ended: int
    what: str
    why: str


class _Company(NamedTuple):
    """With whom a robot was in a step, and from whom it parted, by name."""

    mates: str
    left: str


def explain(record: Record, robot: int) -> list[StoryPart]:
    """Return the story of a robot, a part for each thing that it did.

    A plan that has it go on with what it does, as the plan before, begins none.
    """
    told, story, reasons = told_of(record), list[StoryPart](), list[tuple[int, ...]]()
    company = _company(record, robot)
    for begun, end, run in _deeds(told.reasoned_runs_of(robot), company):
        what, why = _what(record, run, company[begun]), "; ".join(told.texts[it] for it in run.why)
        if story and (story[-1].what, reasons[-1][:1]) == (what, run.why[:1]):
            story[-1] = replace(story[-1], ended=end)
            continue
        story.append(StoryPart(begun, end, what, why))
        reasons.append(run.why)
    return story


def _deeds(
    runs: Iterator[tuple[int, Run]], company: list[_Company]
) -> Iterator[tuple[int, int, Run]]:
    """Yield begin and end of runs; those of forming anew where the robot parts from somebody."""
    for end, run in runs:
        cuts = [n for n in range(run.begun + 1, end) if company[n].left != company[n - 1].left]
        begins = [run.begun, *(cuts if run.phase == FORMING else ())]
        for begun, until in zip(begins, [*begins[1:], end], strict=True):
            yield begun, until, run


def _what(record: Record, run: Run, company: _Company) -> str:
    """Return what a robot does, and with whom."""
    mates, left = company
    if run.phase == LOST:
        return LOST
    if run.phase == FORMING:
        return f"parts from {left}" if left else f"forms with {mates}"
    name = "" if run.task == NOBODY else record.mission.tasks[run.task].name
    what = IDLE if run.phase == IDLE else f"{VERBS.get(run.phase or '', 'walks to')} {name}"
    what = what if name or run.phase == IDLE else "walks, while plans are made anew"
    return f"{what}, with {mates}" if mates else what


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
    """Yield (steps, what, why) of each part as texts."""
    for part in explain(record, robot):
        yield f"{part.begun + 1}-{part.ended}", part.what, part.why
