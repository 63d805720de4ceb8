"""Plans for crews: dealing, sharing out and the search, by hand and against a slow twin."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import entry
from teamformer.files.drawn.generate import Spec, generate
from teamformer.mission.coordination import Known
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.planning.bounds.earliest import earliest_formed
from teamformer.planning.bounds.makespan import bound_makespan
from teamformer.planning.crews.deal import _quick_tour, deal_crews
from teamformer.planning.crews.evaluation import empty_room, walk_list
from teamformer.planning.crews.routes import Shared, bits_of, empty_parties, gather_parties
from teamformer.planning.problem.relaxed_problem import relax
from teamformer.planning.steps.shared_plan import shared_plan_of
from teamformer.planning.steps.situation import situation_of
from teamformer.planning.steps.starts import plan_from_crews
from teamformer.planning.steps.timed_plan import time_team_plan
from teamformer.world.rules.distances import travel_matrix

NOBODY = -1


def table(counts: list[dict[str, int]], caps: tuple[str, ...]) -> np.ndarray:
    return np.array([[count.get(cap, 0) for cap in caps] for count in counts], dtype=np.int64)


def shared_of(mission: Mission, is_one_team: bool = False) -> Shared:
    """Return what is known at the start, each robot alone, or all together."""
    robots, tasks, world = mission.robots, mission.tasks, mission.world
    places = [task.at for task in tasks] + [robot.at for robot in robots]
    needs = table([dict(task.needs) for task in tasks], mission.capabilities)
    return Shared(
        now=np.int64(0),
        opens=np.zeros(len(tasks), dtype=np.int64),
        table=travel_matrix(world, places, [task.at for task in tasks]).T.copy(),
        spots=np.zeros((0, 2), np.int32),
        goals=np.zeros((0, 2), np.int32),
        slowness=np.array([1 / robot.speed for robot in robots]),
        counts=table([dict(robot.can) for robot in robots], mission.capabilities),
        needs=needs,
        wants=bits_of(needs),
        duration=np.array([task.duration for task in tasks], dtype=np.int64),
        carry=np.zeros(len(tasks), dtype=np.int64),
        robot_region=np.array([world.region(robot.at) for robot in robots]),
        task_region=np.array([world.region(task.at) for task in tasks]),
        place=np.arange(len(robots)) + len(tasks),
        ready=np.zeros(len(robots), dtype=np.int64),
        company=np.zeros(len(robots), np.int64) if is_one_team else np.arange(len(robots)),
    )


def plan(
    mission: Mission, rounds: int = 5000, is_one_team: bool = False
) -> tuple[list[int], list[int], list[int]]:
    """Return each robot's crew, each task's, and all tasks in order."""
    crew = np.full(len(mission.robots), NOBODY)
    task_crew = np.full(len(mission.tasks), NOBODY)
    sequence = deal_crews(shared_of(mission, is_one_team), crew, task_crew, rounds)
    return crew.tolist(), task_crew.tolist(), sequence.tolist()


@entry
def _walk(shared, crew, number, tasks):  # type: ignore[no-untyped-def]
    parties = empty_parties(shared, crew)
    gather_parties(shared, parties, crew, number)
    room = empty_room(shared, parties)
    walk_list(shared, parties, number, tasks, len(tasks), room)
    return room.ends


def ends_of(mission: Mission, crew: list[int], number: int, tasks: list[int]) -> list[int]:
    listed = np.array(tasks, dtype=np.int32)
    return _walk(shared_of(mission), np.array(crew), number, listed)[: len(tasks)].tolist()


def plain_ends(
    mission: Mission, members: list[int], tasks: list[int], is_one_team: bool = False
) -> list[int]:
    """Play a list step by step: parties walk to their next task and pair off there."""
    parties = [{"robots": {r}, "at": mission.robots[r].at, "free": 0} for r in members]
    if is_one_team:
        parties = [{"robots": set(members), "at": mission.robots[members[0]].at, "free": 0}]
    ends = []
    for task in tasks:
        wanted = mission.tasks[task]
        can = [{c for r in p["robots"] for c in mission.robots[r].can} for p in parties]
        helpers = [p for p, has in zip(parties, can, strict=True) if has & wanted.needs.keys()]
        arrivals = []
        for party in helpers:
            (x, y), (to_x, to_y) = party["at"], wanted.at
            pace = min(mission.robots[r].speed for r in party["robots"])
            steps = int(np.ceil((abs(x - to_x) + abs(y - to_y)) / pace - 1e-9))
            arrivals.append(max(1, party["free"] + (max(1, steps) if len(helpers) > 1 else steps)))
        step, there = 0, 0
        while there != 1 or any(arrival > step for arrival in arrivals):
            there = (there + 1) // 2  # those there at the end of the step before have joined
            step += 1
            there += arrivals.count(step)
        end = step + wanted.duration
        robots = set().union(*(party["robots"] for party in helpers))
        parties = [party for party in parties if party not in helpers]
        parties.append({"robots": robots, "at": wanted.at, "free": end})
        ends.append(end)
    return ends


def random_world(rng: np.random.Generator, robots: int, tasks: int) -> Mission:
    caps = ("a", "b", "c")

    def counts(most: int) -> dict[str, int]:
        chosen = rng.choice(caps, rng.integers(1, most + 1), replace=False)
        return {str(cap): 1 for cap in chosen}

    everything = Robot("all", (0, 0), dict.fromkeys(caps, 1))
    return Mission(
        "random",
        Grid(9, 9),
        caps,
        (
            everything,
            *(
                Robot(f"r{r}", tuple(rng.integers(0, 9, 2).tolist()), counts(2), speed)
                for r, speed in enumerate(rng.choice([1.0, 0.5, 0.3, 2.0], robots - 1))
            ),
        ),
        tuple(
            Task(f"t{k}", tuple(rng.integers(0, 9, 2).tolist()), counts(3), int(rng.integers(0, 3)))
            for k in range(tasks)
        ),
    )


def test_one_alone_does_what_lies_where_it_stands_in_the_next_step() -> None:
    """Not at once: nothing is done in the step that is over."""
    here, far = Task("t", (2, 0), {"a": 1}), Task("u", (5, 0), {"a": 1})
    lone = Mission("lone", Grid(9, 1), ("a",), (Robot("r", (2, 0), {"a": 1}),), (here, far))
    assert ends_of(lone, [0], 0, [0, 1]) == plain_ends(lone, [0], [0, 1]) == [1, 4]


def test_a_list_takes_what_its_plain_twin_says() -> None:
    rng = np.random.default_rng(1)
    for _ in range(200):
        world = random_world(rng, robots=int(rng.integers(1, 7)), tasks=6)
        everybody = list(range(len(world.robots)))
        tasks = rng.permutation(6).tolist()
        assert ends_of(world, [0] * len(everybody), 0, tasks) == plain_ends(world, everybody, tasks)


def test_the_search_finds_the_best_of_all_lists() -> None:
    rng = np.random.default_rng(2)
    for _ in range(15):
        world = random_world(rng, robots=3, tasks=5)
        lists = map(list, permutations(range(5)))
        best = min(max(plain_ends(world, [0, 1, 2], tasks, True)) for tasks in lists)
        _, _, sequence = plan(world, is_one_team=True)
        assert max(plain_ends(world, [0, 1, 2], sequence, True)) == best


def test_as_many_crews_as_can_do_everything_and_a_rest() -> None:
    """Three a, two b and one c make one crew of a, b, c, one of a, b and one of a."""
    robots = [Robot(f"r{i}", (0, 0), {cap: 1}) for i, cap in enumerate("aaabbc")]
    tasks = (Task("t", (3, 0), {"a": 1, "b": 1, "c": 1}), Task("u", (5, 0), {"a": 1, "b": 1}))
    crew, task_crew, _ = plan(Mission("w", Grid(9, 1), ("a", "b", "c"), tuple(robots), tasks))
    cans = [sorted(cap for c, cap in zip(crew, "aaabbc", strict=True) if c == n) for n in range(3)]
    assert cans == [["a", "b", "c"], ["a", "b"], ["a"]]
    assert task_crew == [0, 1]  # side by side: 3 + 2 and 5 + 1 steps; one after the other 3 + 2 + 2


def test_counts_are_filled_up() -> None:
    robots = [Robot(f"r{i}", (0, 0), {"a": 1}) for i in range(5)]
    tasks = (Task("t", (3, 0), {"a": 2}),)
    crew, _, _ = plan(Mission("w", Grid(9, 1), ("a",), tuple(robots), tasks))
    assert crew == [0, 0, 1, 1, 2]


def test_crews_lie_in_one_part_of_the_map() -> None:
    """a b @ a b: nobody gets through, so two crews, and each does its side's task."""
    robots = [Robot(n, (x, 0), {n[0]: 1}) for n, x in (("a1", 0), ("b2", 1), ("b1", 4), ("a2", 3))]
    tasks = tuple(Task(f"t{x}", (x, 0), {"a": 1, "b": 1}) for x in (4, 0))
    world = Mission("w", Grid(5, 1, ("..@..",)), ("a", "b"), tuple(robots), tasks)
    crew, task_crew, _ = plan(world)
    assert crew[0] == crew[1] != crew[2] == crew[3]
    assert task_crew == [crew[2], crew[0]]


@pytest.mark.parametrize(("robots", "tasks", "caps"), [(8, 30, 4), (20, 60, 4), (6, 40, 6)])
def test_every_task_is_on_one_list_of_a_crew_that_can_do_it(
    robots: int, tasks: int, caps: int
) -> None:
    rng = np.random.default_rng(3)
    for _ in range(5):
        world = generate(Spec(robots, tasks, caps, world=Grid(15, 15)), rng)
        crew, task_crew, sequence = plan(world)
        assert sorted(sequence) == list(range(tasks))
        for number, task in enumerate(world.tasks):
            members = [r for r, c in enumerate(crew) if c == task_crew[number]]
            assert task.needs.keys() <= {cap for r in members for cap in world.robots[r].can}


def test_everybody_finds_the_same() -> None:
    world = generate(Spec(20, 60, 4, world=Grid(20, 20)), np.random.default_rng(4))
    assert plan(world) == plan(world)


def test_more_changes_help() -> None:
    rng = np.random.default_rng(5)
    worlds = [generate(Spec(12, 60, 4, world=Grid(20, 20)), rng) for _ in range(5)]
    lasts = []
    for rounds in (0, 2000, 60_000):
        lasts.append(0)
        for world in worlds:
            crew, task_crew, sequence = plan(world, rounds)
            lists = [[k for k in sequence if task_crew[k] == c] for c in range(max(crew) + 1)]
            lasts[-1] += max(ends_of(world, crew, c, tasks)[-1] for c, tasks in enumerate(lists))
    assert lasts[0] > 1.2 * lasts[2]
    assert lasts[1] > lasts[2]


def test_ways_that_are_worked_out_give_the_plans_that_a_table_gives() -> None:
    rng = np.random.default_rng(6)
    for _ in range(5):
        world = generate(Spec(12, 40, 4, world=Grid(20, 20)), rng)
        known = Known(
            mission=world,
            now=0,
            open_tasks=tuple(range(40)),
            places=tuple(robot.at for robot in world.robots),
            teams=world.starting_teams,
            free_at=(0,) * 12,
        )
        plans = []
        for in_table, shape in ((True, (40, 52)), (False, (0, 0))):
            situation = situation_of(known, in_table)
            assert situation.problem.cells.shape == shape
            dealt = plan_from_crews(situation.problem, situation.company, 2000)
            assert dealt.coalition.shape == (40, max(dealt.size))
            plans.append(shared_plan_of(situation, "crews", time_team_plan(situation, dealt)))
        assert plans[0] == plans[1]
        bounds = [
            bound_makespan(problem, earliest_formed(world, problem))
            for problem in (relax(world), relax(world, in_table=False))
        ]
        assert bounds[0] == bounds[1] > 0


@entry
def _tour(shared: Shared, start: Array) -> Array:
    return _quick_tour(shared, start)


def test_through_very_many_tasks_the_tour_goes_to_the_nearest_each_time() -> None:
    """One robot at 4, tasks at 3, 7, 0 and 8: the nearest of those left is 3, then 0, 7 and 8."""
    tasks = tuple(Task(f"t{x}", (x, 0), {"a": 1}) for x in (3, 7, 0, 8))
    world = Mission("line", Grid(9, 1), ("a",), (Robot("r", (4, 0), {"a": 1}),), tasks)
    assert _tour(shared_of(world), np.array([1, 3, 4, 4])).tolist() == [0, 2, 1, 3]
