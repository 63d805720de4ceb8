"""Team orienteering (Chao, Golden and Wasil 1996): paths that collect as much as they can in time.

A file begins with `n N`, `m P` and `tmax T`: so many points, paths, and how long each path may be.
Then each line has a point: x, y and its score. Paths go from the first point to the last, straight
and at speed 1.
A path is a robot here and a point an optional task, whose weight is its score. That a robot ends at
the last point is a task that only this robot can do and that begins when the mission ends.
"""

from __future__ import annotations

import math
from pathlib import Path

from teamformer.base.errors import TeamformerError
from teamformer.base.file_access import read_text
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.plane import Plane

HEADS = ("n", "m", "tmax")
LARGEST = 10_000_000  # bytes


def read(path: Path) -> list[Mission]:
    """Return the mission of an instance, a text file."""
    lines = [(n, words) for n, line in _numbered(path) if (words := line.split())]
    points, paths, limit = (_head(path, lines, place) for place in range(len(HEADS)))
    rows = [_point(path, line, words) for line, words in lines[len(HEADS) :]]
    if len(rows) != points or points < 2:
        raise TeamformerError(f"{path}: n says {points:g} points, and there are {len(rows)}")
    if paths < 1 or paths != int(paths):
        raise TeamformerError(f"{path}: m is {paths:g}; there should be one path or more")
    left, low = (min(row[axis] for row in rows) for axis in (0, 1))
    places = [(x - left, y - low) for x, y, _ in rows]
    robots = [f"r{n}" for n in range(int(paths))]
    visits = [
        Task(f"t{n}", places[n], {"visit": 1}, weight=score, optional=True)
        for n, (_, _, score) in enumerate(rows)
        if score > 0
    ]
    ends = [
        Task(f"end-{robot}", places[-1], {f"end {robot}": 1}, between=(limit, 2 * limit + 1))
        for robot in robots
    ]
    return [
        Mission(
            name=path.stem,
            world=Plane(*(max(1.0, *(place[axis] for place in places)) for axis in (0, 1))),
            capabilities=("visit", *(f"end {robot}" for robot in robots)),
            robots=tuple(Robot(name, places[0], {"visit": 1, f"end {name}": 1}) for name in robots),
            tasks=(*visits, *ends),
            time="continuous",
            until=limit,
        )
    ]


def _numbered(path: Path) -> list[tuple[int, str]]:
    return list(enumerate(read_text(path, LARGEST).splitlines(), 1))


def _head(path: Path, lines: list[tuple[int, list[str]]], place: int) -> float:
    """Return the number behind the word of a line at the beginning."""
    line, words = lines[place] if place < len(lines) else (place + 1, [])
    if len(words) != 2 or words[0] != HEADS[place]:
        raise TeamformerError(
            f"{path}:{line}: here should be '{HEADS[place]} NUMBER'",
            "a file of team orienteering begins with n, m and tmax, a line each",
        )
    return _number(path, line, words[1])


def _point(path: Path, line: int, words: list[str]) -> tuple[float, float, float]:
    if len(words) != 3:
        raise TeamformerError(f"{path}:{line}: here should be a point: x, y and its score")
    x, y, score = (_number(path, line, word) for word in words)
    if score < 0:
        raise TeamformerError(f"{path}:{line}: the score is {score:g}; use 0 or more")
    return x, y, score


def _number(path: Path, line: int, word: str) -> float:
    try:
        number = float(word)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise TeamformerError(f"{path}:{line}: '{word}' is no number")
    return number
