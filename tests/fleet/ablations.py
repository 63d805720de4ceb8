"""What breaks without each rule of the fleet's protocol: `python tests/fleet/ablations.py [N]`.

Turns one rule off at a time and plays the same N schedules on small random missions.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any
from unittest.mock import patch

import numpy as np

from teamformer.fleet.agent import membership
from teamformer.fleet.agent.agent import Agent
from teamformer.fleet.agent.membership import Membership
from teamformer.fleet.agent.service import Service
from teamformer.fleet.agent.voice import Voice
from teamformer.fleet.messages import SERVE, Word
from teamformer.fleet.mission import Mission
from teamformer.fleet.rehearsal.faults import Knobs
from teamformer.fleet.rehearsal.rehearse import judge, set_stage
from teamformer.scenarios.generate import Spec, generate


def deaf_to_claims(self: Membership, word: Word, now: float) -> Word | None:
    if word.robot == self._knowledge.me:
        return None
    return HEAR(self, word, now)


def fit_always(self: Membership, now: float, x: float, y: float, wants: bool) -> None:
    JUDGE(self, now, x, y, wants)
    self.is_fit, self.is_stuck = True, False


def tell_nothing(self: Voice, sender: int, plan: bool, facts: bool, *rest: Any) -> None:
    return TELL(self, sender, plan, False, *rest)


def tell_no_plan(self: Voice, sender: int, plan: bool, facts: bool, *rest: Any) -> None:
    return TELL(self, sender, False, facts, *rest)


def break_off_at_once(self: Service, now: float, fellows: list[Word], is_busy: bool) -> int:
    if self.phase == SERVE:
        at_work = [word for word in fellows if word.phase >= 2]
        return NEXT_PHASE(self, now, at_work, is_busy)
    return NEXT_PHASE(self, now, fellows, is_busy)


HEAR, JUDGE, TELL = Membership.hear, Membership.judge_myself, Voice.tell
NEXT_PHASE = Service._next_phase
RULES: dict[str, Callable[[], Any]] = {
    "all rules": lambda: patch.object(membership, "PART", membership.PART),
    "who is called lost, or shown a former life, begins another": lambda: patch.object(
        Membership, "hear", deaf_to_claims
    ),
    "silence is a claim of loss": lambda: patch.object(Membership, "call_lost", lambda *_: None),
    "others' words are relayed": lambda: patch.object(Voice, "_others", lambda *_: ()),
    "facts are told to who lacks them": lambda: patch.object(Voice, "tell", tell_nothing),
    "plans are told to who lacks them": lambda: patch.object(Voice, "tell", tell_no_plan),
    "timers stretch with losses": lambda: patch.object(membership, "MOST_STRETCH", 1.0),
    "who cannot move or hears nobody says so": lambda: patch.object(
        Membership, "judge_myself", fit_always
    ),
    "own pauses are not held against others": lambda: patch.object(
        membership, "LONG_PAUSE", float("inf")
    ),
    "who has nothing to do and misses somebody goes to the base": lambda: patch.object(
        Agent, "_misses_somebody", lambda *_: False
    ),
    "service goes on while enough are there": lambda: patch.object(
        Service, "_next_phase", break_off_at_once
    ),
    "service begins on promises that still hold": lambda: patch.object(
        Service, "_holds", lambda *_: True
    ),
}


@contextmanager
def without(rule: str) -> Iterator[None]:
    with RULES[rule]():
        yield


def main(schedules: int) -> None:
    rng = np.random.default_rng(3)
    sizes = [(4, 6), (5, 8), (6, 10), (8, 8)]
    missions = [
        Mission(generate(Spec(robots=robots, tasks=tasks, capabilities=3), rng))
        for robots, tasks in sizes
    ]
    stages = [set_stage(mission) for mission in missions]
    for rule in RULES:
        blocked = broken = 0
        spans = []
        with without(rule):
            for number in range(schedules):
                verdict = judge(stages[number % len(stages)], 77, Knobs(), number)
                blocked += verdict.outcome.status == "blocked"
                broken += bool(verdict.violations) and verdict.outcome.status != "blocked"
                spans.append(verdict.outcome.makespan or 0.0)
        print(f"{rule}: {blocked} blocked, {broken} broke a promise, mean {np.mean(spans):.1f} s")
        sys.stdout.flush()


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 100)
