"""Kernels become machine code where an entry links them in, and nowhere else."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numba as nb
import numpy as np
import pytest

from teamformer.base.kernels.jit import allocating_kernel, entry, kernel
from teamformer.world.rules.sorting import sort_indices


@pytest.fixture(autouse=True)
def _kept_elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(nb.config, "CACHE_DIR", str(tmp_path))


@kernel
def cube(number: int) -> int:
    if number < 0:
        raise ValueError("a length is not negative")
    return number * number * number


@allocating_kernel
def first_numbers(count: int) -> Any:
    numbers = np.empty(count, np.int64)
    for index in range(count):
        numbers[index] = index
    return numbers


def write_last(numbers: Any, row: int) -> None:
    numbers[row, -1] = -7


def sum_of_cubes(count: int) -> int:
    total = 0
    for number in first_numbers(count):
        total += cube(number)
    return total


def test_an_entry_calls_what_calls_others() -> None:
    assert entry(sum_of_cubes)(4) == 0 + 1 + 8 + 27


def test_only_indices_written_as_numbers_count_from_the_end() -> None:
    numbers = np.arange(12).reshape(3, 4)
    assert entry(lambda array: array[-1, -2])(numbers) == 10
    assert entry(lambda array, row: array[row, -1])(numbers, 2) == 11
    assert entry(lambda array: array[1:][-1, 0])(numbers) == 8
    assert entry(lambda array, row: array[row, :].sum())(numbers, -1) == 8 + 9 + 10 + 11
    entry(write_last)(numbers, 1)
    assert numbers[1].tolist() == [4, 5, 6, -7]
    rest = np.arange(5)[2:]
    assert entry(lambda array, index: array[index])(rest, -1) == 1  # what lies before it


def test_an_error_in_a_kernel_reaches_python() -> None:
    at_once = entry(lambda number: cube(number))
    assert at_once(2) == 8
    with pytest.raises(ValueError, match="a length is not negative"):
        at_once(-1)


def test_an_entry_that_another_calls_is_linked_in_not_made_machine_code_of() -> None:
    inner = entry(sum_of_cubes)
    outer = entry(lambda count: inner(count) + 1)
    assert outer(3) == 10
    assert not inner.overloads
    assert len(inner.inner.overloads) == 1
    assert inner(3) == 9  # Python may call it all the same
    assert len(inner.overloads) == 1


def test_what_an_entry_links_in_is_its_own() -> None:
    """So arguments that nobody reads are left out, and what is called once is taken apart."""
    outer = entry(sum_of_cubes)
    assert outer(3) == 9
    (compiled,) = outer.overloads.values()
    told = {function.linkage.name for function in compiled.library.get_defined_functions()}
    assert told <= {"external", "internal"}


def test_there_is_one_version_for_whole_numbers_of_all_sizes() -> None:
    twice = kernel(lambda number: 2 * number)
    outer = entry(lambda short, long: twice(short[0]) + twice(long[0]) + twice(3))
    assert outer(np.array([1], np.int32), np.array([2], np.int64)) == 12
    assert [tuple(map(str, kinds)) for kinds in twice.overloads] == [("int64",)]
    assert entry(lambda half: twice(half))(0.5) == 1.0  # fractions stay what they are


def test_a_kept_kernel_is_linked_in_without_being_compiled_again(tmp_path: Path) -> None:
    def add_one(number: int) -> int:
        return number + 1

    first, again = kernel(add_one), kernel(add_one)
    assert entry(lambda number: first(number))(1) == 2
    assert list(tmp_path.rglob("inner.*.nbc"))
    assert entry(lambda number: 10 * again(number))(1) == 20
    assert sum(again._cache_hits.values()) == 1
    assert sum(again._cache_misses.values()) == 0


@pytest.mark.parametrize("seed", range(5))
def test_indices_are_sorted_as_numpy_sorts_them_stably(seed: int) -> None:
    rng = np.random.default_rng(seed)
    sort = entry(lambda keys, order, spare: sort_indices(keys, order, spare))
    for count in (0, 1, 2, 3, 8, 9, 100):
        keys = rng.integers(0, 1 + count // 2, count)  # many are equal
        order, spare = np.empty(count, np.int64), np.empty(count, np.int64)
        sort(keys, order, spare)
        assert order.tolist() == np.argsort(keys, kind="stable").tolist()
