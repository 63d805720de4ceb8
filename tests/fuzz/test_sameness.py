"""The same seed gives the same record, whoever plays it; names, padding and order mean nothing."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import strategies as st

from methods import DEFAULT, METHODS, SCRIPTED, method_of, play
from missions import SEEDS, missions
from teamformer.files.mission_files import mission_from_tree
from teamformer.mission.model import Mission
from teamformer.mission.parts.grid import BLOCKED, FREE, Grid
from teamformer.mission.truth import draw_truth
from teamformer.planning.bounds.makespan import lower_bound
from teamformer.record.files.reading import record_from_tree
from teamformer.record.files.writing import record_to_tree
from teamformer.record.record import Record
from teamformer.record.task_times import cost_of_record
from teamformer.trials.trial import run_trials
from watching import fuzzed, is_everyday

RUN = "run FILE --method {method} --seed {seed}"
WITHOUT_NETWORKS = st.sampled_from([DEFAULT, DEFAULT, *SCRIPTED])
"""Batches and padding change the last digits of what networks say."""


def record_of(mission: Any, method: str, seed: int) -> dict[str, Any]:
    return record_to_tree(play(mission_from_tree(mission), method, seed).record)


@pytest.fixture(scope="module")
def elsewhere() -> Iterator[Callable[..., Any]]:
    """Return what plays in a process of its own, where strings have other hashes.

    Every day in this one: a process begins for seconds.
    """
    if is_everyday():
        yield record_of
        return
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
        yield lambda *mission: pool.submit(record_of, *mission).result()


@fuzzed(12, RUN, mission=missions(), method=METHODS, seed=SEEDS)
def test_the_same_seed_gives_the_same_record(
    mission: Any, method: str, seed: int, elsewhere: Callable[..., Any]
) -> None:
    first = record_of(mission, method, seed)
    assert elsewhere(mission, method, seed) == first
    assert record_to_tree(record_from_tree(first, "record")) == first


@fuzzed(
    8,
    "run FILE --method {method} --seed {seed}",
    mission=st.lists(missions(), min_size=2, max_size=4),
    method=WITHOUT_NETWORKS,
    seed=SEEDS,
)
def test_in_a_batch_all_end_as_alone(mission: Any, method: str, seed: int) -> None:
    sources = [mission_from_tree(one) for one in mission]
    records = [play(source, method, seed).record for source in sources]
    alone = [{**vars(it.end), "cost": cost_of_record(it)} for it in records]
    for threads in (1, 2):
        tallies = run_trials(sources, method_of(method), seed, threads)
        for end, tally in zip(alone, tallies, strict=True):
            for key, value in vars(tally).items():
                assert end[key] == value, (key, threads)


@fuzzed(15, RUN, mission=missions(), method=METHODS, seed=SEEDS)
def test_names_mean_nothing(mission: Any, method: str, seed: int) -> None:
    source = mission_from_tree(mission)
    one, other = (play(which, method, seed).record for which in (source, renamed(source)))
    assert what_happens(one) == what_happens(other)


def renamed(mission: Mission) -> Mission:
    """Return a mission in which robots, tasks and capabilities have plain names."""
    caps = {name: f"c{number}" for number, name in enumerate(mission.capabilities)}
    tasks = {task.name: f"t{number}" for number, task in enumerate(mission.tasks)}
    return replace(
        mission,
        capabilities=tuple(caps.values()),
        robots=tuple(
            replace(robot, name=f"r{number}", can={caps[c]: n for c, n in robot.can.items()})
            for number, robot in enumerate(mission.robots)
        ),
        tasks=tuple(
            replace(
                task,
                name=tasks[task.name],
                needs={caps[c]: n for c, n in task.needs.items()},
                may_need={caps[c]: n for c, n in task.may_need.items()},
                after=tuple(tasks[name] for name in task.after),
            )
            for task in mission.tasks
        ),
    )


@fuzzed(15, RUN, mission=missions(), method=WITHOUT_NETWORKS, seed=SEEDS)
def test_what_nobody_needs_means_nothing(mission: Any, method: str, seed: int) -> None:
    """One more capability, and walls around a map; what appears is drawn by the size of the map.

    No walls where robots fly: in a map with walls these are of another kind, and searches go on
    otherwise.
    """
    source = replace(mission_from_tree(mission), arrivals=None)
    one, other = (play(which, method, seed).record for which in (source, padded(source)))
    assert what_happens(one) == what_happens(other)


@fuzzed(15, RUN, mission=missions(), method=WITHOUT_NETWORKS, seed=SEEDS)
def test_the_order_of_capabilities_means_nothing(mission: Any, method: str, seed: int) -> None:
    """But for tasks that appear, whose needs are drawn in that order."""
    source = replace(mission_from_tree(mission), arrivals=None)
    turned = replace(source, capabilities=source.capabilities[::-1])
    one, other = (play(which, method, seed).record for which in (source, turned))
    assert what_happens(one) == what_happens(other)
    truths = [draw_truth(which, seed) for which in (source, turned)]
    assert lower_bound(truths[0]) == lower_bound(truths[1])


def padded(mission: Mission) -> Mission:
    """Return a mission with a capability that nobody has, and walls at the edges of its map."""
    caps = (*mission.capabilities, "nobody has this")
    world = mission.world
    if isinstance(world, Grid) and not any(robot.flies for robot in mission.robots):
        rows = world.rows or (FREE * world.width,) * world.height
        walled = (*(row + BLOCKED * 2 for row in rows), BLOCKED * (world.width + 2))
        world = replace(world, width=world.width + 2, height=world.height + 1, rows=walled)
    return replace(mission, capabilities=caps, world=world)


def what_happens(record: Record) -> Any:
    """Return a record without its names."""
    end = replace(record.end, blocked_tasks=())
    return (
        record.orders,
        record.start,
        record.steps,
        end,
        record.plans,
        record.scouts,
    )
