"""Why a robot did what it did: its story, as the record is told."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace

from teamformer.record.phases import AT_WORK, FORMING, LOST
from teamformer.record.record import Record
from teamformer.record.teams import Teams
from teamformer.record.telling.whole import told_of
from teamformer.record.told.words import FORMS, PARTS


@dataclass(frozen=True)
class StoryPart:
    """What a robot did from the end of one step to the end of another, or by times, and why."""

    begun: float
    ended: float
    what: str
    why: str


def explain(record: Record, robot: int) -> list[StoryPart]:
    """Return the story of a robot, a part for each thing that it did.

    A plan that has it go on with what it does, as the plan before, begins none.
    """
    told, story, reasons = told_of(record), list[StoryPart](), list[tuple[int, ...]]()
    mates = _mates(record, robot)
    for end, chapter in told.chapters_of(robot):
        assert chapter.what is not None, "chapters of a team are told by its lowest robot"
        what, why = told.texts[chapter.what], "; ".join(told.texts[it] for it in chapter.why)
        what = _together(what, mates(chapter.begun))
        if story and (story[-1].what, reasons[-1][:1]) == (what, chapter.why[:1]):
            story[-1] = replace(story[-1], ended=end)
            continue
        story.append(StoryPart(chapter.begun, end, what, why))
        reasons.append(chapter.why)
    return story


def _together(what: str, mates: str) -> str:
    """Return what a robot does, and with whom."""
    if not mates or what == LOST or what.startswith(PARTS):
        return what
    return f"forms with {mates}" if what == FORMS else f"{what}, with {mates}"


def _mates(record: Record, robot: int) -> Callable[[float], str]:
    """Return what gives the names of a robot's mates from the end of a step on, or from a time."""
    robots = record.mission.robots

    def named(team: Iterable[int]) -> str:
        return ", ".join(robots[mate].name for mate in team if mate != robot)

    if record.is_continuous:
        return lambda begun: named(_at_one(record, robot, begun))
    teams, names = Teams(robots, record.start), list[str]()
    for step in record.steps:
        teams.follow(step)
        names.append(named(teams.robots.get(teams.slot[robot], ())))
    return lambda begun: names[int(begun)]


def _at_one(record: Record, robot: int, when: float) -> list[int]:
    """Return the robots that form or are at work together with a robot from a time on."""
    rows = told_of(record).runs
    now = [row[bisect_right(row, when, key=lambda run: run.begun) - 1] for row in rows]
    if now[robot].phase not in (FORMING, *AT_WORK):
        return []
    return [mate for mate, run in enumerate(now) if run[1:] == now[robot][1:]]


def story_lines(record: Record, robot: int) -> Iterator[tuple[str, str, str]]:
    """Yield (steps or times, what, why) of each part as texts."""
    first = 0 if record.is_continuous else 1  # a step ends where the next one begins
    for part in explain(record, robot):
        yield f"{part.begun + first:g}-{part.ended:g}", part.what, part.why
