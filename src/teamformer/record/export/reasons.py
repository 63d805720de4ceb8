"""Why a robot did what it did: its story, as the record is told."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from teamformer.record.phases import LOST
from teamformer.record.record import Record
from teamformer.record.teams import Teams
from teamformer.record.telling.reasons import FORMS, PARTS
from teamformer.record.telling.whole import told_of


@dataclass(frozen=True)
class StoryPart:
    """What a robot did from the end of one step to the end of another, and why."""

    begun: int
    ended: int
    what: str
    why: str


def explain(record: Record, robot: int) -> list[StoryPart]:
    """Return the story of a robot, a part for each thing that it did."""
    told, story = told_of(record), list[StoryPart]()
    mates = _mates(record, robot)
    for end, chapter in told.chapters_of(robot):
        assert chapter.what is not None, "chapters of a team are told by its lowest robot"
        what, why = told.texts[chapter.what], "; ".join(told.texts[it] for it in chapter.why)
        story.append(StoryPart(chapter.begun, end, _together(what, mates[chapter.begun]), why))
    return story


def _together(what: str, mates: str) -> str:
    """Return what a robot does, and with whom."""
    if not mates or what == LOST or what.startswith(PARTS):
        return what
    return f"forms with {mates}" if what == FORMS else f"{what}, with {mates}"


def _mates(record: Record, robot: int) -> list[str]:
    """Return the names of a robot's mates in each step, the first at 0."""
    teams, names = Teams(record.mission.robots, record.start), list[str]()
    for step in record.steps:
        teams.follow(step)
        team = teams.robots.get(teams.slot[robot], ())
        names.append(", ".join(record.mission.robots[r].name for r in team if r != robot))
    return names


def story_lines(record: Record, robot: int) -> Iterator[tuple[str, str, str]]:
    """Yield (steps, what, why) of each part as texts."""
    for part in explain(record, robot):
        yield f"{part.begun + 1}-{part.ended}", part.what, part.why
