"""Processes that work for another leave when all is done, and are ended when it is given up."""

from __future__ import annotations

import os
import signal
import time
from contextlib import closing
from pathlib import Path

import pytest

from teamformer.base.worker_processes import WorkerDiedError, work_in_processes


def square_in_turn(job: tuple[int, Path]) -> int:
    """Square a number; the job of 0 lasts until that of 40 is done, which leaves a file."""
    number, file = job
    if number == 40:
        file.touch()
    for _ in range(3000 if number == 0 else 0):
        if file.exists():
            break
        time.sleep(0.01)
    return number * number


def test_each_result_comes_with_the_number_of_its_job(tmp_path: Path) -> None:
    jobs = ((number, tmp_path / "done") for number in (0, 1, 2, 30, 40))
    done = list(work_in_processes(square_in_turn, jobs, 2))
    assert sorted(done) == [(0, 0), (1, 1), (2, 4), (3, 900), (4, 1600)]
    assert done[0][0] == 1  # the slowest does not hold up the others


def refuse_two(number: int) -> int:
    if number == 2:
        raise ValueError("two")
    return number


def test_an_error_of_a_job_is_raised_here_and_tells_where_it_was() -> None:
    with pytest.raises(ValueError, match="two") as raised:
        list(work_in_processes(refuse_two, range(5), 2))
    assert "in refuse_two" in "".join(raised.value.__notes__)


def die(number: int) -> int:
    os.kill(os.getpid(), signal.SIGKILL)
    return number


def test_the_death_of_a_worker_is_told() -> None:
    with pytest.raises(WorkerDiedError, match="a worker process died"):
        list(work_in_processes(die, range(5), 2))


def say_who(folder: Path) -> int:
    (folder / "pid").write_text(str(os.getpid()))
    return os.getpid()


def is_there(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    return True


def test_workers_leave_when_all_is_done(tmp_path: Path) -> None:
    ((_, process),) = work_in_processes(say_who, [tmp_path], 1)
    assert process != os.getpid()
    assert not is_there(process)


def say_who_and_sleep(folder: Path) -> int:
    process = say_who(folder)
    time.sleep(600)
    return process


def test_workers_are_ended_when_it_is_interrupted(tmp_path: Path) -> None:
    told = tmp_path / "pid"
    told.touch()
    with pytest.raises(KeyboardInterrupt):
        list(work_in_processes(say_who_and_sleep, [tmp_path], 1, told.read_text))
    assert not is_there(int(told.read_text()))


def test_workers_are_ended_when_nobody_wants_the_rest(tmp_path: Path) -> None:
    with closing(work_in_processes(say_who, [tmp_path] * 1000, 1)) as results:
        _, process = next(results)
    assert not is_there(process)
