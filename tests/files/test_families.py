"""Families of missions: what their worlds hold, and what happens in them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from teamformer.base.errors import TeamformerError
from teamformer.files.drawn.continuous_incidents import INCIDENTS, WHEN, robots_to_spare
from teamformer.files.drawn.continuous_missions import (
    CONTINUOUS_FAMILIES,
    EVERY,
    ROBOTS,
    ROTAS,
    TASKS,
)
from teamformer.files.drawn.families import FAMILIES
from teamformer.files.drawn.family_missions import INCIDENT_STEPS, about_half_of
from teamformer.files.drawn.named_settings import size_of, world_of
from teamformer.files.drawn.surprises import BREAKDOWN, CALLS, DELAYS, LASTS, SURPRISES, WITHIN
from teamformer.files.mission_files import mission_from_tree, mission_to_tree
from teamformer.methods.by_name import load_method
from teamformer.mission.checks.rules import rules_not_played
from teamformer.mission.model import Mission
from teamformer.mission.parts.grid import Grid
from teamformer.mission.parts.roads import Roads
from teamformer.trials.trial import run_trial

WORLDS = 60
DISTURBED = [(name, incident) for name in CONTINUOUS_FAMILIES for incident in INCIDENTS]


def worlds(setting: str) -> list[Mission]:
    return [world_of(setting, seed) for seed in range(WORLDS)]


@pytest.mark.parametrize("name", FAMILIES)
def test_worlds_hold_what_their_family_says(name: str) -> None:
    family = FAMILIES[name]
    for world in worlds(name):
        assert family.robots[0] <= len(world.robots) <= family.robots[1]
        assert family.tasks[0] <= len(world.tasks) <= family.tasks[1]
        assert {len(robot.can) for robot in world.robots} <= set(
            range(1, len(family.abilities) + 1)
        )
        assert {task.duration for task in world.tasks} <= {0, *range(1, family.duration[1] + 1)}
        assert all(not robot.absences for robot in world.robots)
        assert all(task.appears == 0 for task in world.tasks)
        assert isinstance(world.world, Grid)
    assert size_of(name) == (family.robots[1], len(family.capabilities))


def test_shares_are_met_on_average() -> None:
    """60 worlds of about 12 robots and 45 tasks; each bound is some five standard errors wide."""
    real = worlds("real")
    robots = [robot for world in real for robot in world.robots]
    tasks = [task for world in real for task in world.tasks]
    slow = sum(robot.speed == 0.5 for robot in robots) / len(robots)
    assert slow == pytest.approx(1 / 3, abs=0.09)
    assert sum(task.duration > 0 for task in tasks) / len(tasks) == pytest.approx(0.6, abs=0.05)
    assert sum(len(task.needs) == 1 for task in tasks) / len(tasks) == pytest.approx(0.4, abs=0.05)
    grids = [world.world for world in real]
    cells = "".join(row for grid in grids if isinstance(grid, Grid) for row in grid.rows)
    assert cells.count("@") / len(cells) == pytest.approx(0.1, abs=0.01)


@pytest.mark.parametrize("name", FAMILIES)
@pytest.mark.thorough
def test_the_others_can_do_without_who_is_lost(name: str) -> None:
    for plain, world in zip(worlds(name), worlds(f"{name}-lost"), strict=True):
        lost = [robot for robot in world.robots if robot.absences]
        assert len(lost) == 1
        (away,) = lost[0].absences
        assert away.back is None
        assert INCIDENT_STEPS[0] <= away.lost <= about_half_of(plain)
        for task in world.tasks:
            for cap, needed in task.needs.items():
                left = sum(r.can.get(cap, 0) for r in world.robots if r is not lost[0])
                assert left >= needed
        robots = tuple(replace(robot, absences=()) for robot in world.robots)
        assert replace(world, robots=robots, name=plain.name) == plain


@pytest.mark.parametrize("name", FAMILIES)
@pytest.mark.thorough
def test_a_robot_is_lost_in_the_first_half_of_what_the_shared_plan_takes(name: str) -> None:
    for seed in range(2):
        steps = run_trial(world_of(name, seed), load_method("plan"), 0, None).record.end.makespan
        assert steps is not None
        [lost] = [
            robot.absences for robot in world_of(f"{name}-lost", seed).robots if robot.absences
        ]
        assert lost[0].lost <= steps / 2


@pytest.mark.parametrize("name", FAMILIES)
@pytest.mark.thorough
def test_a_fifth_of_the_tasks_appears_later(name: str) -> None:
    for plain, world in zip(worlds(name), worlds(f"{name}-arrivals"), strict=True):
        late = [task.appears for task in world.tasks if task.appears > 0]
        assert len(late) == len(world.tasks) // 5
        assert all(INCIDENT_STEPS[0] <= step <= INCIDENT_STEPS[1] for step in late)
        tasks = tuple(replace(task, appears=0) for task in world.tasks)
        assert replace(world, tasks=tasks, name=plain.name) == plain


@pytest.mark.parametrize("name", FAMILIES)
@pytest.mark.thorough
def test_two_tasks_of_five_come_after_others(name: str) -> None:
    after = [task.after for world in worlds(f"{name}-ordered") for task in world.tasks]
    assert 0.25 < sum(map(bool, after)) / len(after) < 0.55
    assert set(map(len, after)) == {0, 1, 2}
    for plain, world in zip(worlds(name), worlds(f"{name}-ordered"), strict=True):
        tasks = tuple(replace(task, after=()) for task in world.tasks)
        assert replace(world, tasks=tasks, name=plain.name) == plain


@pytest.mark.parametrize("name", [*FAMILIES, "4N20T-C4", "4N20+20T-C4-nn"])
def test_what_is_uncertain_is_all_that_is_new(name: str) -> None:
    for seed in range(2):
        plain = world_of(name, seed)
        for kind in SURPRISES:
            world = world_of(f"{name}-{kind}", seed)
            assert world.has_surprises
            for task, known in zip(world.tasks, plain.tasks, strict=True):
                assert task.worst_needs == known.needs
                assert task.lasts in (None, LASTS)
                assert sum(task.needs.values()) >= 1
                assert task.within in (0, WITHIN)
                assert task.once_known(task.at, known.needs, known.duration) == known
            robots = tuple(replace(robot, breaks=None, delays=None) for robot in world.robots)
            assert robots == plain.robots
            assert world.arrivals == (CALLS if kind in ("calls", "all") else None)
            assert {robot.delays for robot in world.robots} <= {None, DELAYS}


def test_kinds_of_surprises_are_what_they_are_called() -> None:
    durations, needs, breakdowns, mixed = (
        [world_of(f"real-{kind}", seed) for seed in range(12)]
        for kind in ("durations", "needs30", "breakdowns", "mixed")
    )
    assert all(task.lasts == LASTS for world in durations for task in world.tasks)
    for world in needs:
        for task in world.tasks:
            assert set(task.may_need.values()) <= {0.3}
            assert sum(cap not in task.may_need for cap in task.worst_needs) <= 1
            assert all(type(count) is int and count > 0 for count in task.needs.values())
    assert all(robot.breaks == BREAKDOWN for world in breakdowns for robot in world.robots)
    mixed_places = [task.within for seed in range(6) for task in world_of("real-all", seed).tasks]
    assert np.mean([within > 0 for within in mixed_places]) == pytest.approx(0.5, abs=0.11)
    hidden = [task.within for seed in range(3) for task in world_of("real-places", seed).tasks]
    assert set(hidden) == {WITHIN}
    tasks = [task for world in mixed for task in world.tasks]
    assert sum(task.lasts is not None for task in tasks) / len(tasks) == pytest.approx(
        0.5, abs=0.11
    )
    sure = [world_of("real", seed) for seed in range(12)]
    more = sum(sum(task.needs.values()) > 1 for world in sure for task in world.tasks)
    assert sum(bool(task.may_need) for task in tasks) / more == pytest.approx(0.5, abs=0.11)


def test_shelves_stand_in_rows_with_aisles_between() -> None:
    for world in worlds("warehouse"):
        grid = world.world
        assert isinstance(grid, Grid)
        assert grid.rows[0] == grid.rows[1] == "." * grid.width
        assert grid.rows[2].startswith("..@@@@..@@@@..@@")
        assert [row.startswith("..@@@@") for row in grid.rows[:9]] == [
            *[False, False, True, True] * 2,
            False,
        ]


def test_movers_lift_kilograms() -> None:
    """60 worlds of about 7 who lift and 22 loads; each bound is some five standard errors wide.

    A load is alike anywhere in the logarithm of 10 to 400, so log(400 / 120) / log(400 / 10) of
    them, or 33%, are more than any one robot lifts. The fleet's own limit bites in few.
    """
    moving = worlds("moving")
    lifted = [r.can["lift"] for world in moving for r in world.robots if "lift" in r.can]
    loads = [t.needs["lift"] for world in moving for t in world.tasks if "lift" in t.needs]
    assert 20 <= min(lifted) < 22
    assert 118 < max(lifted) <= 120
    assert np.mean(lifted) == pytest.approx(70, abs=7)
    assert 10 <= min(loads) < 11
    assert 380 < max(loads) <= 400
    assert np.mean(np.array(loads) > 120) == pytest.approx(0.33, abs=0.07)
    assert all((2 * amount) % 1 == 0 for amount in [*lifted, *loads])
    assert np.mean([amount % 1 == 0.5 for amount in lifted]) == pytest.approx(0.5, abs=0.13)
    assert {r.can.get("steer", 1) for world in moving for r in world.robots} == {1}
    assert {t.needs.get("steer", 1) for world in moving for t in world.tasks} == {1}


def test_an_unknown_incident_is_refused() -> None:
    with pytest.raises(TeamformerError, match="'real-stolen' is no setting") as refused:
        size_of("real-stolen")
    assert "real-lost, real-arrivals" in refused.value.hint


@pytest.mark.parametrize("name", CONTINUOUS_FAMILIES)
def test_families_in_continuous_time_hold_what_they_say(name: str) -> None:
    for seed, world in enumerate(worlds(name)):
        assert world == world_of(name, seed)
        assert world.time == "continuous"
        assert ROBOTS[0] <= len(world.robots) <= ROBOTS[1]
        assert TASKS[0] <= len(world.tasks) <= TASKS[1]
        assert mission_from_tree(mission_to_tree(world)) == world
    assert size_of(name) == (ROBOTS[1], 4)


def test_whoever_moves_gets_everywhere_on_roads_and_some_lanes_lead_one_way() -> None:
    movers = set()
    for mission in worlds("roads"):
        roads = mission.world
        assert isinstance(roads, Roads)
        assert all(time < np.inf for rows in roads.ways.values() for row in rows for time in row)
        walks, carts = (np.array(roads.times[mover]) for mover in ("ground", "cart"))
        leads = np.isfinite(walks)
        assert (leads & ~leads.T).any()  # one way
        assert (leads & ~np.isfinite(carts)).any()  # narrow
        assert not (np.isfinite(carts) & ~leads).any()
        movers |= {robot.moves for robot in mission.robots}
    assert movers == {"ground", "cart"}


def test_in_zones_there_is_room_for_few_services() -> None:
    drawn = [*worlds("real-zones"), *worlds("carry-zones")]
    assert {zone.room for mission in drawn for zone in mission.zones} == {1, 2, 3}
    assert {len(mission.zones) for mission in drawn} == {1, 2}
    for mission in drawn:
        yard = mission.zones[-1].tasks_in(mission.tasks)
        assert yard
        assert not any(mission.tasks[number].to for number in yard)
        assert not any(rules_not_played(mission))


def test_in_shifts_robots_have_four_rotas() -> None:
    robots = [robot for mission in worlds("shifts") for robot in mission.robots]
    share = {rota: sum(it.shifts == rota for it in robots) / len(robots) for rota in ROTAS}
    assert all(0.15 < part < 0.35 for part in share.values())
    assert {robot.every for robot in robots if robot.shifts} == {EVERY}


def test_zones_have_areas_with_little_room_and_perhaps_tasks_by_name() -> None:
    drawn = [mission.zones for mission in worlds("zones")]
    assert {len(zones) for zones in drawn} == {1, 2}
    assert {zones[-1].room for zones in drawn} == {1, 2, 3}
    assert all(zones[-1].area for zones in drawn)
    assert all(tool.tasks and tool.room == 1 for zones in drawn for tool in zones[:-1])


def test_by_the_clock_every_key_is_drawn() -> None:
    tasks = [task for mission in worlds("clock") for task in mission.tasks]
    for key in ("after", "between", "starts", "to", "appears"):
        assert 0.05 < sum(bool(getattr(task, key)) for task in tasks) / len(tasks) < 0.5
    for key in ("forming", "ends", "cost"):
        assert sum(bool(getattr(mission, key)) for mission in worlds("clock")) > 10


def test_on_roads_some_tasks_have_loads_windows_and_others_before_them() -> None:
    tasks = [task for mission in worlds("roads") for task in mission.tasks]
    for key in ("after", "between", "to"):
        assert 0.05 < sum(bool(getattr(task, key)) for task in tasks) / len(tasks) < 0.5


@pytest.mark.parametrize(("name", "incident"), DISTURBED)
def test_incidents_in_continuous_time_change_nothing_else(name: str, incident: str) -> None:
    for seed in range(5):
        calm, changed = world_of(name, seed), world_of(f"{name}-{incident}", seed)
        assert [task.at for task in changed.tasks] == [task.at for task in calm.tasks]
        assert [robot.can for robot in changed.robots] == [robot.can for robot in calm.robots]
        assert changed.world == calm.world
        assert mission_from_tree(mission_to_tree(changed)) == changed
    assert size_of(f"{name}-{incident}") == size_of(name)


@pytest.mark.parametrize("name", CONTINUOUS_FAMILIES)
def test_who_is_lost_can_be_spared_and_a_fifth_appears_or_is_called_off(name: str) -> None:
    for seed in range(20):
        lost = world_of(f"{name}-lost", seed)
        [gone] = [n for n, robot in enumerate(lost.robots) if robot.absences]
        [away] = lost.robots[gone].absences
        assert WHEN[0] <= away.lost <= WHEN[1]
        assert away.back is None
        assert gone in robots_to_spare(world_of(name, seed))
        off = [t for t in world_of(f"{name}-cancelled", seed).tasks if t.cancelled is not None]
        assert len(off) == len(lost.tasks) // 5
        assert all(task.cancelled > task.appears for task in off)  # type: ignore[operator]
        late = sum(t.appears > 0 for t in world_of(f"{name}-arrivals", seed).tasks)
        assert late >= len(lost.tasks) // 5


def test_an_unknown_incident_in_continuous_time_is_refused() -> None:
    with pytest.raises(TeamformerError, match="'clock-stolen' is no setting") as refused:
        size_of("clock-stolen")
    assert "clock-lost, clock-arrivals, clock-cancelled" in refused.value.hint


@pytest.mark.parametrize("seed", [16, 1049])
def test_what_must_be_done_in_optional_worlds_is_in_reach(seed: int) -> None:
    """Of these the drawn end was sooner than the slowest robot that is needed could be there."""
    end = run_trial(world_of("optional", seed), load_method("plan"), seed).record.end
    assert end.status == "completed"
