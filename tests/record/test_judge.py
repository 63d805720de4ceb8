"""The referee: real records are legal, and what is forged in them is found and named."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from random_worlds import random_decision, random_world, with_fractions
from teamformer.methods.scripted.heuristic import Heuristic
from teamformer.methods.scripted.joining import JoinAll
from teamformer.methods.seam.protocol import Policy
from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.record.record import Ending, Record, Step, TeamAt, Wants
from teamformer.record.referee import judge
from teamformer.trials.trial import run_trial
from teamformer.world.env import Decision
from teamformer.world.view import View

CORRIDOR = Mission(
    name="corridor",
    world=Grid(6, 2, ("......", ".@@@@.")),
    capabilities=("a", "b"),
    robots=(
        Robot("ann", (0, 0), {"a": 1}),
        Robot("bob", (0, 0), {"b": 1}),
        Robot("cat", (5, 1), {"a": 1}, speed=0.5, absences=(Absence(6),)),
    ),
    tasks=(
        Task("joint", (2, 0), {"a": 1, "b": 1}),
        Task("long", (4, 0), {"a": 1}, duration=2),
        Task("late", (0, 1), {"b": 1}, appears=7),
    ),
    sensing_radius=10,
    step_limit=50,
)
"""
ann and bob start together left, slow cat right below; joint is in the middle.

    A . J . L .
    l @ @ @ @ C
"""

LEGAL = Record(
    mission=CORRIDOR,
    method="by hand",
    seed=0,
    orders=((0, (0, 1)), (7, (1, 2))),
    start=((0, (0,), 0, 0), (1, (1,), 0, 0), (2, (2,), 5, 1)),
    steps=(
        Step(joins=((0, 1),), teams=(TeamAt(0, 0, 0, 0), TeamAt(2, 5, 1, 1))),
        Step(teams=(TeamAt(0, 1, 0, 0), TeamAt(2, 5, 0, 1))),
        Step(teams=(TeamAt(0, 2, 0, None),), done=((0, 0),)),
        # cat needs two steps for the next cell; there the service of `long` begins
        Step(
            splits=(((0,), (1,)),),
            teams=(TeamAt(1, 2, 0, None), TeamAt(2, 4, 0, 1)),
            served=((1, (2,)),),
        ),
        Step(teams=(TeamAt(0, 3, 0, 1),)),
        # cat is lost in its second step of service, so that ann begins anew
        Step(lost=(2,), teams=(TeamAt(0, 4, 0, 1),), served=((1, ()), (1, (0,)))),
        Step(),
        Step(teams=(TeamAt(0, 4, 0, None), TeamAt(1, 1, 0, 2)), done=((1, 0),)),
        Step(teams=(TeamAt(1, 0, 0, 2),)),
        Step(teams=(TeamAt(1, 0, 1, None),), done=((2, 1),)),
    ),
    end=Ending("completed", 10, 10, 3, 1, 1, 0),
    lower_bound=9,
    decisions=(
        (1, (Wants(0, (1, 1)),)),
        (2, (Wants(0),)),
        (4, (Wants(0, (1, 0)),)),
        (5, (Wants(0, None, 1),)),  # by herself ann would leave `long` to cat
        (9, (Wants(0),)),
    ),
)


def with_step(number: int, **changes: object) -> Callable[[Record], Record]:
    """Return what changes one step, counted from 1."""

    def change(record: Record) -> Record:
        steps = list(record.steps)
        steps[number - 1] = replace(steps[number - 1], **changes)  # type: ignore[arg-type]
        return replace(record, steps=tuple(steps))

    return change


def with_decision(number: int, *rows: Wants) -> Callable[[Record], Record]:
    """Return what changes the decisions of a step."""
    return lambda record: replace(
        record, decisions=tuple(sorted({**dict(record.decisions), number: rows}.items()))
    )


def with_end(**changes: object) -> Callable[[Record], Record]:
    return lambda record: replace(record, end=replace(record.end, **changes))  # type: ignore[arg-type]


def test_the_legal_record_is_legal() -> None:
    verdict = judge(LEGAL)
    assert verdict.findings == ()
    assert verdict.is_legal
    assert (verdict.steps, verdict.tasks_done) == (10, 3)


@pytest.mark.parametrize(
    ("forge", "message"),
    [
        (
            with_step(2, teams=(TeamAt(0, 2, 0, 0), TeamAt(2, 5, 0, 1))),
            "step 2: team [ann, bob] is at (1, 0) by the rules and at (2, 0) in the record",
        ),
        (
            with_step(2, teams=(TeamAt(0, 1, 1, 0), TeamAt(2, 5, 0, 1))),
            "step 2: team [ann, bob] is at (1, 0) by the rules and at (1, 1) in the record",
        ),
        (
            with_step(1, teams=(TeamAt(0, 1, 0, 0), TeamAt(2, 5, 1, 1))),
            "step 1: team [ann, bob] is at (0, 0) by the rules and at (1, 0) in the record",
        ),
        (
            with_step(1, joins=((0, 2),)),
            "step 1: by the rules the team of robot ann joins the team of robot bob; "
            "in the record the team of robot ann joins the team of robot cat",
        ),
        (
            with_step(1, joins=((0, 1), (0, 2))),
            "step 1: the record says that the team of robot ann joins the team of robot cat, "
            "but by the rules it is not so",
        ),
        (
            with_step(3, splits=(((0,), (2,)),)),
            "step 3: the record says that [ann] stay and [cat] leave, "
            "but by the rules it is not so",
        ),
        (
            with_step(3, done=((0, 0), (2, 0))),
            "step 3: the record says that task late is done by the team of robot ann, "
            "but it appears after 7 steps",
        ),
        (
            with_step(3, done=()),
            "step 3: by the rules task joint is done by the team of robot ann, "
            "and the record does not say so",
        ),
        (
            with_step(2, done=((0, 0),)),
            "step 2: the record says that task joint is done by the team of robot ann, "
            "but that team is at (1, 0), the task at (2, 0)",
        ),
        (
            with_step(5, done=((1, 2),)),
            "step 5: the record says that task long is done by the team of robot cat, "
            "but that team has not been at work on it for long enough",
        ),
        (
            with_step(5, teams=(TeamAt(0, 3, 0, 1), TeamAt(2, 3, 0, 1))),
            "step 5: team [cat] is at (4, 0) by the rules and at (3, 0) in the record",
        ),
        (
            with_step(6, lost=()),
            "step 6: by the rules robot cat is lost, and the record does not say so",
        ),
        (
            with_step(7, lost=(1,)),
            "step 7: the record says that robot bob is lost, but by the rules it is not so",
        ),
        (
            with_step(10, done=((0, 1), (2, 1))),
            "step 10: the record says that task joint is done by the team of robot bob, "
            "but it was over in step 3",
        ),
        (
            with_step(9, teams=(TeamAt(1, 0, 0, 0),)),
            "step 9: team [bob] heads for task late by the rules and for task joint in the record",
        ),
        (
            with_step(5, teams=(TeamAt(0, 3, 0, 1), TeamAt(2, 4, 0, 1), TeamAt(1, 2, 0, 2))),
            "step 5: team [bob] heads for nothing by the rules and for task late in the record",
        ),
        (
            with_decision(4, Wants(0, (0, 1))),
            "step 4: by the rules [bob] stay and [ann] leave; "
            "in the record [ann] stay and [bob] leave",
        ),
        (
            with_decision(5, Wants(0)),
            "step 5: team [ann] is at (2, 0) by the rules and at (3, 0) in the record",
        ),
        (with_end(illegal_decisions=1), "the record says illegal_decisions 1; it is 0"),
        (with_end(makespan=9), "the record says makespan 9; it is 10"),
        (with_end(steps=11), "the record says steps 11; it is 10"),
        (with_end(joins=0), "the record says joins 0; it is 1"),
        (with_end(splits=2), "the record says splits 2; it is 1"),
        (with_end(tasks_done=2), "the record says tasks_done 2; it is 3"),
        (with_end(status="step limit"), "the record says status step limit; it is completed"),
        (
            with_end(blocked_tasks=("late",)),
            "the record says blocked_tasks late; it is none",
        ),
        (
            lambda record: replace(record, lower_bound=11),
            "the lower bound 11 is above the makespan 10",
        ),
        (
            lambda record: replace(record, orders=((0, (0, 1)), (7, (0, 2)))),
            "step 7: the order made after 7 steps is not one of the open tasks",
        ),
        (
            lambda record: replace(record, start=((0, (0, 1), 0, 0), (2, (2,), 5, 1))),
            "the starting teams are not those of the mission, in order",
        ),
        (
            lambda record: replace(record, steps=(*record.steps, Step())),
            "step 11: everything was done before, and the record goes on",
        ),
    ],
)
def test_a_forgery_is_found(forge: Callable[[Record], Record], message: str) -> None:
    verdict = judge(forge(LEGAL))
    assert [finding.message for finding in verdict.findings] == [message]


class Restless:
    """Decides at random for a while, then joins."""

    needs_everything = False

    def begin(self, everything: object, rng: np.random.Generator) -> None:
        self.rng, self.left = rng, 40

    def decide(self, view: View) -> Decision:
        self.left -= 1
        return random_decision(view, self.rng) if self.left > 0 else JoinAll().decide(view)


@pytest.mark.parametrize(
    "policy", [JoinAll(), Heuristic(), Restless()], ids=["join-all", "heuristic", "restless"]
)
@pytest.mark.thorough
def test_real_records_are_legal(policy: Policy) -> None:
    rng = np.random.default_rng(5)
    for seed in range(200):
        mission = random_world(rng, is_plane=seed % 2 == 1)
        mission = with_fractions(mission, rng) if seed % 4 > 1 else mission
        record = run_trial(mission, policy, seed).record
        assert judge(record).findings == ()


def forgeries(record: Record, rng: np.random.Generator) -> list[Record]:
    """Return records with one fact changed: a place, a completion, a total, a loss."""
    forged = [with_end(**{key: getattr(record.end, key) + 1})(record) for key in ("steps", "joins")]
    busy = [n for n, step in enumerate(record.steps, start=1) if step.done]
    number = int(rng.choice(busy))
    step = record.steps[number - 1]
    forged.append(with_step(number, done=step.done[1:])(record))
    forged.append(with_step(number, lost=(*step.lost, step.done[0][1]))(record))
    if number > 1:
        forged.append(with_step(number - 1, done=step.done)(with_step(number, done=())(record)))
    if not any(step.teams for step in record.steps):
        return forged  # nobody had to go anywhere
    moved = [(n, i) for n, s in enumerate(record.steps, start=1) for i in range(len(s.teams))]
    number, i = moved[int(rng.integers(len(moved)))]
    teams = list(record.steps[number - 1].teams)
    teams[i] = teams[i]._replace(x=teams[i].x + 4)
    forged.append(with_step(number, teams=tuple(teams))(record))
    return forged


def test_changes_of_single_facts_are_found() -> None:
    rng = np.random.default_rng(6)
    for seed in range(100):
        mission = random_world(rng, with_losses=False, is_plane=seed % 2 == 1)
        record = run_trial(mission, JoinAll(), seed).record
        for forged in forgeries(record, rng):
            assert judge(forged).findings
