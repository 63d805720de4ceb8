"""Trials: how they begin, what they count, and how they are cut short."""

from __future__ import annotations

import itertools
import sys
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from types import FrameType

import numpy as np
import pytest

from coordinations import method_of
from random_worlds import random_decision, random_world
from small_worlds import two_robots_one_task, two_tasks_two_pairs, walker
from teamformer.methods.by_name import Method, load_method
from teamformer.methods.scripted.joining import JoinAll
from teamformer.mission.model import Mission
from teamformer.record.referee import judge
from teamformer.trials.trial import PlayedTrial, run_trial, run_trials
from teamformer.world.env import Decision, Tally
from teamformer.world.view import View


class Dice:
    """Decides at random, by the generator it is given."""

    needs_everything = False
    given: Sequence[Mission] | None = ()

    def begin(self, everything: Sequence[Mission] | None, rng: np.random.Generator) -> None:
        self.given, self.rng = everything, rng

    def decide(self, view: View) -> Decision:
        return random_decision(view, self.rng)


class AllKnowing(Dice):
    needs_everything = True


class Impatient(JoinAll):
    """Presses Ctrl-C when asked for the third time."""

    asked = 0

    def decide(self, view: View) -> Decision:
        self.asked += 1
        if self.asked == 3:
            raise KeyboardInterrupt
        return super().decide(view)


def test_a_trial_is_recorded_to_its_end() -> None:
    record = run_trial(two_robots_one_task(), JoinAll(), 5, lower_bound=3).record
    assert (record.method, record.seed, record.lower_bound) == ("JoinAll", 5, 3)
    assert (record.end.status, record.end.makespan, record.end.steps) == ("completed", 4, 4)
    assert (record.end.tasks_done, record.end.joins, record.end.splits) == (1, 1, 0)
    assert len(record.steps) == 4


def test_a_trial_that_hits_its_limit_has_no_makespan() -> None:
    record = run_trial(two_robots_one_task(step_limit=3), JoinAll()).record
    assert (record.end.status, record.end.makespan, record.end.steps) == ("step limit", None, 3)


def test_only_a_policy_that_needs_everything_is_given_it() -> None:
    mission = walker(1.0)
    dice, all_knowing = Dice(), AllKnowing()
    run_trial(mission, dice)
    run_trial(mission, all_knowing)
    assert dice.given is None
    assert all_knowing.given == [mission]


def test_the_seed_decides() -> None:
    mission = two_tasks_two_pairs(step_limit=20)
    trials = [run_trial(mission, Dice(), seed).record for seed in (1, 1, 2)]
    assert trials[0] == trials[1]
    assert trials[0].steps != trials[2].steps


def test_ctrl_c_keeps_what_was_done() -> None:
    with pytest.raises(KeyboardInterrupt):
        run_trial(two_robots_one_task(), Impatient())
    record = run_trial(two_robots_one_task(), Impatient(), keeps_interrupted=True).record
    assert (record.end.status, record.end.steps, record.end.makespan) == ("interrupted", 2, None)
    assert len(record.steps) == 2
    assert record.steps[0].joins == ((0, 1),)


class Interrupter:
    """Presses Ctrl-C before one line, counted from 1, of what runs and records a trial."""

    FILES = ("trial.py", "recorder.py", "env.py")

    def __init__(self, line: int) -> None:
        self.lines_left = line

    def __call__(self, frame: FrameType, event: str, _: object) -> Interrupter | None:
        if not frame.f_code.co_filename.endswith(self.FILES):
            return None
        if event == "line":
            self.lines_left -= 1
            if self.lines_left == 0:
                raise KeyboardInterrupt
        return self

    def run(self, mission: Mission, method: Method) -> PlayedTrial | None:
        """Return the trial, None if nothing could be recorded."""
        before = sys.gettrace()
        sys.settrace(self)
        try:
            return run_trial(mission, method, keeps_interrupted=True)
        except KeyboardInterrupt:
            return None
        finally:
            sys.settrace(before)


@pytest.mark.parametrize(
    "coordination",
    ["paper", *(pytest.param(name, marks=pytest.mark.slow) for name in ("crews", "plan"))],
)
@pytest.mark.thorough
def test_ctrl_c_at_any_line_leaves_a_legal_record(coordination: str) -> None:
    """Where there are plans, a task appears, so that one is made on the way too."""
    mission = two_tasks_two_pairs(step_limit=6)
    if coordination != "paper":
        late = replace(mission.tasks[1], appears=2)
        mission = replace(mission, tasks=(mission.tasks[0], late))
    endings: Counter[tuple[str, int]] = Counter()
    unrecorded = 0
    for line in itertools.count(1):
        interrupter = Interrupter(line)
        trial = interrupter.run(mission, method_of(coordination))
        if trial is None:
            unrecorded += 1
            continue
        assert judge(trial.record).findings == ()
        assert trial.is_interrupted == (interrupter.lines_left <= 0)
        if not trial.is_interrupted:
            break
        endings[trial.record.end.status, trial.record.end.steps] += 1
    last = trial.record.end.steps
    assert set(endings) == {("completed", last), *(("interrupted", n) for n in range(last))}
    assert sum(endings.values()) > unrecorded  # while the trial is set up or handed over


def test_each_step_is_reported() -> None:
    seen: list[Tally] = []
    run_trial(walker(1.0, goal=3), JoinAll(), on_step=seen.append)
    assert [tally.steps for tally in seen] == [1, 2, 3]
    assert [tally.tasks_done for tally in seen] == [0, 0, 1]


def test_the_clock_tells_planning_deciding_and_simulating_apart() -> None:
    trial = run_trial(walker(1.0), JoinAll())
    parts = (trial.planning_seconds, trial.decision_seconds, trial.simulating_seconds)
    assert min(parts) > 0
    assert sum(parts) + trial.compiling_seconds == pytest.approx(trial.total_seconds)


def test_a_coordinator_makes_plans_and_a_policy_none() -> None:
    mission = two_robots_one_task()
    for name in ("plan", "crews"):
        record = run_trial(mission, load_method(name)).record
        assert (record.method, record.mission, len(record.plans)) == (name, mission, 1)
    record = run_trial(mission, JoinAll()).record
    assert (record.method, record.mission, record.plans) == ("JoinAll", mission, ())


@pytest.mark.parametrize("threads", [1, 3])
def test_trials_side_by_side_end_as_they_do_alone(threads: int) -> None:
    rng = np.random.default_rng(15)
    missions = [random_world(rng) for _ in range(20)]
    for mission, tally in zip(missions, run_trials(missions, JoinAll(), 0, threads), strict=True):
        end = run_trial(mission, JoinAll()).record.end
        assert (end.status, end.steps, end.tasks_done) == (
            tally.status,
            tally.steps,
            tally.tasks_done,
        )
        assert (end.joins, end.splits) == (tally.joins, tally.splits)
