"""What breaks without each rule of the fleet's protocol: `python tests/fleet/ablations.py [N]`.

Turns one rule off at a time and plays the same N schedules on small random missions.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from statistics import fmean
from typing import Any
from unittest.mock import patch

import numpy as np

from teamformer.fleet import operator
from teamformer.fleet.agent import membership
from teamformer.fleet.agent.agent import Agent
from teamformer.fleet.agent.membership import Membership
from teamformer.fleet.agent.service import Service
from teamformer.fleet.agent.voice import Voice
from teamformer.fleet.messages import SERVE, Word
from teamformer.fleet.mission import Mission, Timers
from teamformer.fleet.rehearsal.faults import Knobs
from teamformer.fleet.rehearsal.rehearse import Verdict, judge, set_stage
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
        at_work = [word for word in fellows if word.phase == SERVE]
        return NEXT_PHASE(self, now, at_work, is_busy)
    return NEXT_PHASE(self, now, fellows, is_busy)


def join_the_lowest(self: Service, going: list[Word], here: list[Word]) -> int:
    return min({word.robot for word in here} | {self._knowledge.me})


HEAR, JUDGE, TELL = Membership.hear, Membership.judge_myself, Voice.tell
NEXT_PHASE = Service._next_phase
RULES: dict[str, Callable[[], Any]] = {
    "whoever is called lost, or shown a former life, begins another": lambda: patch.object(
        Membership, "hear", deaf_to_claims
    ),
    "silence is a claim of loss": lambda: patch.object(Membership, "call_lost", lambda *_: None),
    "others' words are relayed": lambda: patch.object(Voice, "_others", lambda *_: ()),
    "who begins another life is told of everybody": lambda: patch.object(
        Voice, "relay_all_again", lambda *_: None
    ),
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
    "who comes joins the team that is ready or at work": lambda: patch.object(
        Service, "_choose_team", join_the_lowest
    ),
    "service goes on while enough are there": lambda: patch.object(
        Service, "_next_phase", break_off_at_once
    ),
    "service begins on promises that still hold": lambda: patch.object(
        Service, "_holds", lambda *_: True
    ),
    "an operator's task is accepted at three copies, not one": lambda: patch.object(
        operator, "COPIES", 1
    ),
}
TIMERS = {
    "robots plan in turn": Timers(turn=0.0),
    "a new plan holds for a while": Timers(rest=0.0),
}
"""Rules that are numbers."""


def main(schedules: int) -> None:
    """Print a line for each rule."""
    whole = play(schedules, Timers())
    tell("all rules", whole, whole)
    for rule, turn_off in RULES.items():
        with turn_off():
            tell(f"without: {rule}", play(schedules, Timers()), whole)
    for rule, timers in TIMERS.items():
        tell(f"without: {rule}", play(schedules, timers), whole)


def play(schedules: int, timers: Timers) -> list[Verdict]:
    """Play the schedules on four missions in turn."""
    rng = np.random.default_rng(3)
    stages = [
        set_stage(
            Mission(generate(Spec(robots=robots, tasks=tasks, capabilities=3), rng), timers=timers)
        )
        for robots, tasks in ((4, 6), (5, 8), (6, 10), (8, 8))
    ]
    return [judge(stages[k % len(stages)], 77, Knobs(), k) for k in range(schedules)]


def tell(rule: str, verdicts: Sequence[Verdict], whole: Sequence[Verdict]) -> None:
    """Say how many blocked, how many broke a promise besides, and how long the others took.

    Times are beside those with all rules, over the schedules that end with and without.
    """
    blocked = sum(verdict.outcome.status == "blocked" for verdict in verdicts)
    broken = sum(bool(v.violations) and v.outcome.status != "blocked" for v in verdicts)
    pairs = [
        (one.outcome.makespan, other.outcome.makespan)
        for one, other in zip(verdicts, whole, strict=True)
        if one.outcome.status == other.outcome.status == "ended"
    ]
    spans, before = np.sum(pairs, axis=0) if pairs else (np.nan, np.nan)
    plans = fmean(verdict.outcome.plans for verdict in verdicts)
    print(
        f"{rule}: {blocked} blocked, {broken} broke a promise, "
        f"{spans / before - 1:+.0%} ({len(pairs)} schedules), {plans:.1f} plans",
        flush=True,
    )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 100)
