"""The minutes of a training, by a clock that goes on as it is told to."""

from __future__ import annotations

import time

import pytest

from teamformer.learning.budget import GUESSES, Budget


class Clock:
    """Shows the seconds that have been let pass."""

    def __init__(self) -> None:
        self.now = 1000.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    made = Clock()
    monkeypatch.setattr(time, "perf_counter", made)
    return made


def test_what_is_to_come_counts_as_the_longest_so_far(clock: Clock) -> None:
    """Of 60 s, 8 go before it starts; iterations take up to 10 s, the export 7 s."""
    budget = Budget(1.0, "cpu", begun=992.0)
    assert budget.seconds == 8.0
    for seconds in (10.0, 4.0):
        with budget.spent_on("iteration"):
            clock.now += seconds
    assert budget.seconds == 22.0
    clock.now += 60 - 22 - 10 - GUESSES["export"] - 1
    assert not budget.is_spent("iteration", "export")
    clock.now += 1
    assert budget.is_spent("iteration", "export")
    with budget.spent_on("export"):
        clock.now += 7
    assert budget.seconds == 37.0
    assert not budget.is_spent("iteration", "export")  # 37 + 10 + 7 = 54
    clock.now += 6
    assert budget.is_spent("iteration", "export")
    assert not budget.is_spent("iteration")
    assert not budget.is_spent()
    clock.now += 17
    assert budget.is_spent()


def test_earlier_sessions_count(clock: Clock) -> None:
    budget = Budget(1.0, "cpu")
    budget.before = 59.0
    assert not budget.is_spent()
    clock.now += 1
    assert budget.is_spent()


def test_without_minutes_there_is_no_end(clock: Clock) -> None:
    budget = Budget(None, "cpu")
    clock.now += 1e9
    assert not budget.is_spent("iteration", "exam", "export")
