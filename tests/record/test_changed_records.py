"""Real records are legal; the same with one entry changed are not."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from random_worlds import random_world
from teamformer.files.mission_files import read_mission
from teamformer.methods.scripted.heuristic import Heuristic
from teamformer.methods.scripted.joining import JoinAll
from teamformer.record.record import Record
from teamformer.record.referee import judge
from teamformer.trials.trial import run_trial

EXAMPLES = [
    path
    for path in sorted((Path(__file__).parents[2] / "examples").glob("*.yaml"))
    if read_mission(path).time == "steps"
]


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_the_examples_are_played_legally(path: Path) -> None:
    for policy in (JoinAll(), Heuristic()):
        assert judge(run_trial(read_mission(path), policy).record).findings == ()


Forge = Callable[[Record, np.random.Generator], Record | None]


def change_step(record: Record, key: str, rng: np.random.Generator, change: Any) -> Record | None:
    """Let `change` replace one of the entries under a key of the steps; None if there is none."""
    spots = [
        (number, i)
        for number, step in enumerate(record.steps)
        for i in range(len(getattr(step, key)))
    ]
    if not spots:
        return None
    number, i = spots[int(rng.integers(len(spots)))]
    entries = list(getattr(record.steps[number], key))
    entries[i : i + 1] = change(entries[i])
    steps = list(record.steps)
    steps[number] = replace(steps[number], **{key: tuple(entries)})
    return replace(record, steps=tuple(steps))


def makespan(record: Record, rng: np.random.Generator) -> Record | None:
    if record.end.makespan is None:
        return None
    shifted = record.end.makespan + int(rng.choice([-1, 1]))
    return replace(record, end=replace(record.end, makespan=shifted))


def jump(record: Record, rng: np.random.Generator) -> Record | None:
    return change_step(record, "teams", rng, lambda team: [team._replace(x=team.x + 4)])


def leave_out(key: str) -> Forge:
    return lambda record, rng: change_step(record, key, rng, lambda entry: [])


def twice(key: str) -> Forge:
    return lambda record, rng: change_step(record, key, rng, lambda entry: [entry, entry])


def other_doer(record: Record, rng: np.random.Generator) -> Record | None:
    robots = len(record.mission.robots)
    if robots == 1:
        return None
    return change_step(record, "done", rng, lambda entry: [(entry[0], (entry[1] + 1) % robots)])


def robot_in_two_teams(record: Record, rng: np.random.Generator) -> Record | None:
    if len(record.start) == 1:
        return None
    first, (slot, robots, x, y), *rest = record.start
    mixed = (slot, tuple(sorted((*robots, first[1][0]))), x, y)
    return replace(record, start=(first, mixed, *rest))


FORGERIES: dict[str, Forge] = {
    "makespan": makespan,
    "jump": jump,
    "robot in two teams": robot_in_two_teams,
    "done by another": other_doer,
    **{f"no {key}": leave_out(key) for key in ("joins", "splits", "lost", "done")},
    **{f"twice {key}": twice(key) for key in ("joins", "splits", "lost", "teams", "done")},
}


@pytest.fixture(scope="module")
def real_records() -> list[Record]:
    rng = np.random.default_rng(12)
    worlds = [random_world(rng) for _ in range(100)]
    return [
        run_trial(world, policy).record for world in worlds for policy in (JoinAll(), Heuristic())
    ]


@pytest.mark.parametrize("name", FORGERIES)
@pytest.mark.thorough
def test_every_such_change_of_a_real_record_is_found(name: str, real_records: list[Record]) -> None:
    rng = np.random.default_rng(13)
    forged = [FORGERIES[name](record, rng) for record in real_records]
    verdicts = [judge(record) for record in forged if record is not None]
    assert len(verdicts) >= 20
    assert all(verdict.findings for verdict in verdicts)
    assert max(len(verdict.findings) for verdict in verdicts) < 60  # not the same over and over


def test_shifts_by_a_cell_are_mostly_found(real_records: list[Record]) -> None:
    """Some are legal: a team may stand elsewhere when a trial ends, if nobody needs it there."""
    rng = np.random.default_rng(14)
    shifted = [
        change_step(record, "teams", rng, lambda team: [team._replace(x=team.x + 1)])
        for record in real_records
    ]
    found = [bool(judge(record).findings) for record in shifted if record is not None]
    assert np.mean(found) > 0.85
