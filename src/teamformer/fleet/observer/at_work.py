"""Who is heard at work on what: a robot's word that it is holds on for some steps."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from teamformer.fleet.messages import SERVE, Word
from teamformer.world.rules.constants import NOBODY

STAYS = 3
"""Steps for which a robot's word that it is at work holds on, if it says something else since."""


class _Service(NamedTuple):
    """What a robot was at work on by its word, in which team; after how many steps it said so."""

    task: int
    team: int
    since: int
    step: int


class HeardAtWork:
    """What each robot said last that it is at work on; `words` are everybody's newest."""

    def __init__(self, words: Mapping[int, Word]) -> None:
        self._words = words
        self._said: dict[int, _Service] = {}  # by robot

    def hear(self, word: Word, before: Word | None, made: int) -> None:
        """Take in a robot's newest word and the one before, after so many steps."""
        if word.phase == SERVE:
            since = made
            if before is not None and (before.phase, before.goal) == (SERVE, word.goal):
                since = self._said[word.robot].since
            self._said[word.robot] = _Service(word.goal, word.team, since, made)

    def begin(self, past: int) -> None:
        """Let all that was heard be of now, after so many steps that nobody watched."""
        self._said = {r: it._replace(since=past, step=past) for r, it in self._said.items()}

    def since(self, key: int) -> dict[int, int]:
        """Return the robots that say they are at work on a task, and in which step they began."""
        return {robot: it.since for robot, it in self._said.items() if self._says(robot, key)}

    def team(self, key: int, made: int) -> tuple[int, ...]:
        """Return who said last that they are at work on a task, as one team.

        Who has not said so for a while, and says something else now, did not stay to the end.
        """
        latest = made - STAYS
        at_work = {
            robot: it
            for robot, it in self._said.items()
            if it.task == key and (it.step >= latest or self._says(robot, key))
        }
        last = max(at_work.values(), key=lambda it: it.step, default=None)
        team = NOBODY if last is None else last.team
        return tuple(sorted(robot for robot, it in at_work.items() if it.team == team))

    def _says(self, robot: int, key: int) -> bool:
        word = self._words[robot]
        return word.phase == SERVE and word.goal == key
