"""The referee on planes: who went too far, joined from too far, or did what is too far away."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from teamformer.methods.scripted.joining import JoinAll
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.plane import Plane
from teamformer.record.record import Record, TeamAt
from teamformer.record.referee import judge
from teamformer.trials.trial import run_trial

FIELD = Mission(
    name="field",
    world=Plane(4.0, 2.0, step=0.5),
    capabilities=("a", "b"),
    robots=(
        Robot("ann", (1.0, 1.0), {"a": 1}, speed=0.4),
        Robot("bob", (1.0, 1.04), {"b": 1}, speed=0.8),
    ),
    tasks=(Task("joint", (1.5, 1.0), {"a": 1, "b": 1}),),
    step_limit=50,
)
"""Two robots in touching places, half a metre from a task that needs both."""

LEGAL = run_trial(FIELD, JoinAll(), 0).record


def test_the_legal_record() -> None:
    """They join at bob's place, then walk 0.2 m a step: ann is the slower one."""
    assert judge(LEGAL).findings == ()
    assert LEGAL.steps[0].joins == ((0, 1),)
    assert LEGAL.steps[0].teams == (TeamAt(0, 1.0, 1.04, 0),)
    assert [step.teams[0].x for step in LEGAL.steps[1:]] == pytest.approx(
        [1.199363, 1.398726, 1.5], abs=1e-6
    )
    assert LEGAL.end.makespan == 4


def with_team(number: int, x: float, y: float) -> Callable[[Record], Record]:
    def forge(record: Record) -> Record:
        steps = list(record.steps)
        step = steps[number - 1]
        steps[number - 1] = replace(step, teams=(step.teams[0]._replace(x=x, y=y),))
        return replace(record, steps=tuple(steps))

    return forge


def with_start(x: float, y: float) -> Callable[[Record], Record]:
    """Let bob start elsewhere, in the mission too."""

    def forge(record: Record) -> Record:
        ann, bob = FIELD.robots
        mission = replace(FIELD, robots=(ann, replace(bob, at=(x, y))))
        return replace(record, mission=mission, start=(record.start[0], (1, (1,), x, y)))

    return forge


@pytest.mark.parametrize(
    ("forge", "message"),
    [
        (
            with_team(2, 1.3, 1.04),
            "step 2: team [ann, bob] is at (1.199363, 1.024051) by the rules "
            "and at (1.3, 1.04) in the record",
        ),
        (
            with_team(1, 1.0, 1.0),
            "step 1: team [ann, bob] is at (1, 1.04) by the rules and at (1, 1) in the record",
        ),
        (
            with_team(4, 1.500001, 1.0),
            "step 4: team [ann, bob] is at (1.5, 1) by the rules "
            "and at (1.500001, 1) in the record",
        ),
        (
            with_start(1.0, 1.06),
            "step 1: the record says that the team of robot ann joins the team of robot bob, "
            "but by the rules it is not so",
        ),
    ],
)
def test_a_forgery_is_found(forge: Callable[[Record], Record], message: str) -> None:
    assert message in [finding.message for finding in judge(forge(LEGAL)).findings]
