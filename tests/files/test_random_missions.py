"""Random missions: what the paper says about its worlds holds, and seeds mean what they say."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from small_worlds import reachable
from teamformer.base.errors import TeamformerError
from teamformer.files.drawn.generate import SPAWN_RADIUS, Spec, generate
from teamformer.mission.model import Mission
from teamformer.mission.parts.grid import Grid


def many(spec: Spec, count: int = 200, seed: int = 1) -> list[Mission]:
    rng = np.random.default_rng(seed)
    return [generate(spec, rng) for _ in range(count)]


def spread(numbers: list[int]) -> int:
    return max(numbers) - min(numbers)


def test_the_same_seed_gives_the_same_mission() -> None:
    spec = Spec(8, 20, 8, late_tasks=3, starts_in_teams=True)
    one, same, other = (generate(spec, np.random.default_rng(seed)) for seed in (7, 7, 8))
    assert one == same
    assert one != other


def test_sizes_and_names() -> None:
    mission = generate(Spec(3, 2, 5, world=Grid(6, 4)), np.random.default_rng(0), "mine")
    assert mission.name == "mine"
    assert mission.capabilities == ("c1", "c2", "c3", "c4", "c5")
    assert [robot.name for robot in mission.robots] == ["r1", "r2", "r3"]
    assert [task.name for task in mission.tasks] == ["t1", "t2"]
    assert (mission.world.width, mission.world.height) == (6, 4)
    assert (mission.sensing_radius, mission.join_radius, mission.teams) == (1.0, 0.0, ())


def test_robots_start_within_reach_of_one_point() -> None:
    seen = 0
    for mission in many(Spec(robots=30, world=Grid(40, 40)), 50):
        for axis in (0, 1):
            width = spread([robot.at[axis] for robot in mission.robots])
            assert width <= 2 * SPAWN_RADIUS
            seen = max(seen, width)
    assert seen == 2 * SPAWN_RADIUS  # both sides of the point are used


def test_places_are_uniform_over_the_grid() -> None:
    places = Counter(
        task.at for mission in many(Spec(tasks=50, world=Grid(4, 3))) for task in mission.tasks
    )
    assert len(places) == 12
    assert all(abs(count - 10_000 / 12) < 150 for count in places.values())  # five deviations


@pytest.mark.parametrize(("robots", "capabilities"), [(4, 4), (20, 4), (10, 4), (3, 8), (1, 1)])
def test_capabilities_are_dealt_out_evenly(robots: int, capabilities: int) -> None:
    first = set()
    for mission in many(Spec(robots, 3, capabilities), 60):
        assert all(list(robot.can.values()) == [1] for robot in mission.robots)
        dealt = Counter(name for robot in mission.robots for name in robot.can)
        assert len(dealt) == min(robots, capabilities)
        assert spread(list(dealt.values())) <= 1
        first |= set(mission.robots[0].can)
    assert first == set(mission.capabilities)  # shuffled before they are dealt


def test_requirements_are_uniform_in_number() -> None:
    sizes = Counter(len(s.tasks[0].needs) for s in many(Spec(8, 4, 8), 2000))
    assert sorted(sizes) == list(range(1, 9))
    assert all(abs(count - 250) < 75 for count in sizes.values())  # five deviations


def test_together_the_tasks_require_every_capability_present() -> None:
    exact = 0
    for mission in many(Spec(4, 3, 6), 300):
        present = {name for robot in mission.robots for name in robot.can}
        *others, last = (set(task.needs) for task in mission.tasks)
        left_over = present.difference(*others)
        assert present == last.union(*others)
        if left_over:
            assert last == left_over
            exact += 1
    assert exact > 30


def test_a_fixed_number_of_requirements_is_drawn_from_what_nobody_requires_yet() -> None:
    for mission in many(Spec(20, 9, 20, requirements=6), 30):
        needs = [set(task.needs) for task in mission.tasks]
        assert [len(need) for need in needs] == [6] * 9
        assert len(set.union(*needs[:3])) == 18  # the first three share nothing
        assert len(set.union(*needs[:4])) == 20  # the fourth takes the two that are left


def test_late_tasks_appear_together_between_steps_10_and_25() -> None:
    steps = set()
    for mission in many(Spec(4, 5, 4, late_tasks=3), 400):
        early, late = mission.tasks[:5], mission.tasks[5:]
        assert {task.appears for task in early} == {0}
        assert len(late) == 3
        [step] = {task.appears for task in late}
        steps.add(step)
        assert {name for task in early for name in task.needs} == set(mission.capabilities)
    assert steps == set(range(10, 26))


ISLANDS = Grid(9, 5, ("....@....", "....@.@@@", "..@.@....", "..@.@@@@@", "..@@@...."))


def test_on_maps_everything_lies_in_the_largest_part() -> None:
    largest = reachable(ISLANDS, (0, 0))
    assert len(largest) == 16
    seen = set()
    for mission in many(Spec(5, 5, world=ISLANDS), 100):
        homes = {robot.at for robot in mission.robots}
        seen |= homes | {task.at for task in mission.tasks}
        assert max_walk(homes) <= 2 * SPAWN_RADIUS
    assert seen == largest


def max_walk(places: set[tuple[int, int]]) -> int:
    """Return the longest walk between two places of the map with islands, step by step."""
    longest = 0
    for place in places:
        reached, steps = {place}, 0
        while not places <= reached:
            reached |= {beside for cell in reached for beside in ISLANDS.neighbours(cell)}
            steps += 1
        longest = max(longest, steps)
    return longest


def test_a_map_without_a_free_cell_is_an_error() -> None:
    with pytest.raises(TeamformerError, match="the map has no free cell"):
        generate(Spec(world=Grid(2, 1, ("@@",))), np.random.default_rng(0))


def test_the_papers_training_worlds_start_in_teams_of_any_size() -> None:
    spec = Spec(robots=4, capabilities=8, step_limit=128, starts_in_teams=True)
    rng = np.random.default_rng(4)
    team_sizes = set()
    for _ in range(300):
        mission = generate(spec, rng)
        assert (mission.world.width, mission.world.height, mission.step_limit) == (10, 10, 128)
        assert len({name for robot in mission.robots for name in robot.can}) == 4
        for team in mission.starting_teams:
            team_sizes.add(len(team))
            assert len({mission.robots[r].at for r in team}) == 1
    assert team_sizes == {1, 2, 3, 4}


@pytest.mark.parametrize(
    ("wrong", "edge"),
    [
        ({"robots": 0}, {"robots": 1}),
        ({"tasks": 0}, {"tasks": 1}),
        ({"capabilities": 0}, {"capabilities": 1}),
        ({"late_tasks": -1}, {"late_tasks": 0}),
        ({"requirements": 0}, {"requirements": 1}),
        ({"requirements": 5}, {"requirements": 4}),
        ({"robots": 2, "requirements": 3}, {"robots": 2, "requirements": 2}),
        ({"late_between": (5, 4)}, {"late_between": (5, 5)}),
        ({"late_between": (-1, 4)}, {"late_between": (0, 4)}),
    ],
)
def test_what_cannot_be_generated_is_refused_at_the_edge(wrong: dict, edge: dict) -> None:
    with pytest.raises(TeamformerError, match=list(wrong)[-1]):
        Spec(**wrong)
    generate(Spec(**edge), np.random.default_rng(0))
