"""Signals to a command at work, sent to this very process."""

from __future__ import annotations

import signal
import sys
from collections.abc import Iterator

import pytest

from teamformer.base.import_apart import import_apart
from teamformer.cli.terminal.interruption import Interruption


@pytest.fixture(autouse=True)
def handlers() -> Iterator[None]:
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


def work(number: int, is_held: bool, done: list[str]) -> None:
    """Be interrupted twice: at work, and while clearing away."""
    with Interruption() as interruption:
        if is_held:
            interruption.hold()
        try:
            signal.raise_signal(number)
            done.append("work")
        finally:
            signal.raise_signal(number)
            done.append("cleared away")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize(
    ("is_held", "expected"), [(False, ["cleared away"]), (True, ["work", "cleared away"])]
)
def test_the_first_ends_what_is_done_and_the_second_does_nothing(
    number: int, is_held: bool, expected: list[str]
) -> None:
    done: list[str] = []
    with pytest.raises(KeyboardInterrupt):
        work(number, is_held, done)
    assert done == expected


def test_what_was_ended_before_the_hold_is_not_ended_again() -> None:
    with Interruption() as interruption:
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGTERM)
        interruption.hold()


def test_without_one_all_is_as_before() -> None:
    before = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)]
    with Interruption() as interruption:
        interruption.hold()
    assert [signal.getsignal(n) for n in (signal.SIGINT, signal.SIGTERM)] == before


def test_a_process_that_ignores_ctrl_c_goes_on_to() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with Interruption():
        signal.raise_signal(signal.SIGINT)
    assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN


class Cleared:
    """Is interrupted while it is cleared away, where Python lets no error out."""

    def __del__(self) -> None:
        signal.raise_signal(signal.SIGINT)


def clear_and_wait() -> None:
    with Interruption():
        Cleared()
        signal.pause()  # until it comes again


def test_what_gets_lost_while_an_object_is_cleared_away_comes_again() -> None:
    with pytest.raises(KeyboardInterrupt):
        clear_and_wait()


def test_what_is_imported_apart_is_not_broken_off() -> None:
    name = "this"  # it prints a poem
    sys.modules.pop(name, None)
    import_apart(name)
    assert sys.modules[name].__name__ == name
    import_apart(name)
