"""Tasks whose place is not known: who looks where, when they are found, what is believed until."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from coordinations import COORDINATIONS, method_of
from random_worlds import random_world, with_surprises
from small_worlds import done_at, make, play, robot, task
from teamformer.files.drawn.named_settings import world_of
from teamformer.mission.model import Mission
from teamformer.mission.parts.grid import Grid, Place
from teamformer.mission.parts.places import possible_places
from teamformer.mission.truth import draw_truth
from teamformer.record.files.reading import read_record
from teamformer.record.files.writing import save_record
from teamformer.record.happenings import events
from teamformer.record.record import Record, TaskAt
from teamformer.record.referee import judge
from teamformer.trials.trial import run_trial
from teamformer.world.env import TeamFormation
from teamformer.world.rules.constants import NOBODY
from test_surprises import is_alike, play_views, with_step, with_true_task


def really_at(mission: Mission, place: Place, foresight: str = "needed") -> TeamFormation:
    """Return a world whose first task is really in a place."""
    truth = draw_truth(mission, 0)
    tasks = (replace(truth.tasks[0], at=place), *truth.tasks[1:])
    return TeamFormation([mission], truths=[replace(truth, tasks=tasks)], foresight=foresight)


def corridor(**rules: Any) -> Mission:
    """One robot, and a task at 2 to 8.

    a . ? ? ? T ? ? ?
    0         5     8
    """
    hidden = replace(task("a", 5), within=3)
    return make([robot("a", 0)], [hidden], **rules)


def believed(env: TeamFormation) -> tuple[float, float]:
    """Return where the first task is believed to be and how far it may be from there."""
    view = env.view()
    return float(view.task_place[0, 0, 0]), float(view.task_within[0, 0])


def test_who_finds_nothing_looks_in_the_nearest_place_left() -> None:
    """What is next to the robot is seen: at 4 it sees that the task is not at 5."""
    env = really_at(corridor(), (8, 0))
    seen = []
    for _ in range(8):
        seen.append(believed(env))
        play(env)
    assert seen == [(5, 3), (5, 3), (5, 3), (5, 3), (6, 3), (7, 3), (8, 3), (8, 0)]
    assert done_at(env) == [8]
    assert env.worlds.tasks["found_at"][0].tolist() == [7]


def test_who_scouts_thinks_again_whenever_a_place_is_ruled_out() -> None:
    """All ways lead past all places, so the nearest one left is as good as any."""
    env = really_at(corridor(), (8, 0), "scouting")
    seen = []
    for _ in range(8):
        seen.append(believed(env)[0])
        play(env)
    assert seen == [5, 3, 4, 5, 6, 7, 8, 8]
    assert done_at(env) == [8]


@pytest.mark.parametrize(("foresight", "steps"), [("needed", 386), ("scouting", 366)])
def test_who_scouts_looks_where_the_task_is_reached_soonest_on_average(
    foresight: str, steps: int
) -> None:
    """The sum over all places within 3 cells of the middle, from 8 cells to the left of it.

    Both are what forty lines of plain Python say that the rules take.
    """
    mission = make([robot("a", 0, 6)], [replace(task("a", 8, 6), within=3)], Grid(13, 13))
    places = possible_places(mission.world, (8, 6), 3)
    assert len(places) == 29
    taken = 0
    for place in places:
        env = really_at(mission, place, foresight)
        while env.is_running[0]:
            play(env)
        taken += done_at(env)[0]
    assert taken == steps


def test_what_is_passed_is_found_on_the_way() -> None:
    env = really_at(corridor(), (2, 0))
    play(env)
    assert believed(env) == (2, 0)
    assert env.worlds.tasks["found_at"][0, 0] == 1
    play(env)
    assert done_at(env) == [2]


@pytest.mark.parametrize(("radius", "steps"), [(0.0, [8, 8]), (3.0, [5, 8]), (np.inf, [1, 8])])
def test_the_finding_radius_says_how_near_one_must_come(radius: float, steps: list[int]) -> None:
    env = really_at(corridor(finding_radius=radius), (8, 0))
    play(env, 8)
    assert [env.worlds.tasks["found_at"][0, 0], env.tally().steps] == steps
    assert env.tally().status == "completed"


def test_anybody_finds_for_everybody() -> None:
    """b stands where the task is, though it is of no help with it."""
    mission = make([robot("a", 0), robot("b", 8)], corridor().tasks)
    env = really_at(mission, (8, 0))
    play(env)
    assert believed(env) == (8, 0)


def test_ways_lead_to_where_a_task_is_believed_to_be() -> None:
    """Past the wall: the robot at (0, 1) sees (0, 2), then walks round to (2, 2).

    a @ .
    . @ ?
    T . ?
    """
    rows = (".@.", ".@.", "...")
    hidden = replace(task("a", 0, 2), within=2.3)
    mission = make([robot("a", 0)], [hidden], Grid(3, 3, rows))
    env = really_at(mission, (2, 1))
    twin = env.fork()
    for world in (env, twin):
        play(world, 5)
        assert world.tally().status == "completed"
    env.reset()
    again = []
    while env.is_running[0]:
        again.append(believed(env)[0])
        play(env)
    assert again == [0, 1, 2, 2, 2]


def test_what_appears_later_is_not_looked_for_before() -> None:
    hidden = replace(task("a", 1, appears=3), within=1)
    env = really_at(make([robot("a", 0), robot("a", 1)], [hidden, task("b", 9)][:1]), (2, 0))
    play(env, 3)
    assert env.worlds.tasks["found_at"][0, 0] == NOBODY
    play(env)
    assert env.worlds.tasks["found_at"][0, 0] == 4


def recorded(coordination: str = "plan", seed: int = 1) -> Record:
    return run_trial(world_of("4N20T-C4-places", seed), method_of(coordination), seed).record


@pytest.mark.parametrize("coordination", COORDINATIONS)
def test_missions_with_hidden_places_end_and_are_legal(coordination: str, tmp_path: Path) -> None:
    record = recorded(coordination)
    assert record.end.status == "completed"
    assert judge(record).findings == ()
    assert sum(len(step.found) for step in record.steps) == 20
    save_record(record, tmp_path / "record.json")
    assert read_record(tmp_path / "record.json") == record
    found = [event for event in events(record) if event.kind == "found"]
    assert len(found) == 20
    x, y = record.true_mission.tasks[found[0].task or 0].at
    assert found[0].text(record.true_mission).endswith(f"found at [{x}, {y}]")


@pytest.mark.parametrize("coordination", COORDINATIONS)
@pytest.mark.thorough
def test_nobody_knows_where_a_task_is_before_it_is_found(coordination: str) -> None:
    mission, method = world_of("4N20T-C4-places", 0), method_of(coordination)
    truth = draw_truth(mission, 5)
    env, now = play_views(mission, truth, method, 400)
    first = env.worlds.tasks["found_at"][0]
    shows = 0
    for number in range(4):
        other = draw_truth(mission, 6).tasks[number].at
        tasks = list(truth.tasks)
        tasks[number] = replace(tasks[number], at=other)
        changed, then = play_views(mission, replace(truth, tasks=tuple(tasks)), method, 400)
        step = min(int(first[number]), int(changed.worlds.tasks["found_at"][0, number]))
        assert all(is_alike(now[i], then[i]) for i in range(step))
        shows += step < min(len(now), len(then)) and not is_alike(now[step], then[step])
    assert shows >= 2


def test_the_referee_finds_what_is_found_or_believed_wrongly() -> None:
    record = recorded()
    finds = next(i for i, step in enumerate(record.steps) if step.found)
    moves = next(i for i, step in enumerate(record.steps) if step.moved)
    found, moved = record.steps[finds].found, record.steps[moves].moved
    other = next(k for k in range(20) if k not in found)
    away = TaskAt(moved[0].task, moved[0].x + 1, moved[0].y)
    x, y = record.mission.tasks[0].at
    far = ((x + 5) % 10, y)
    forged = {
        "does not find it": with_step(record, finds, found=found[1:]),
        "where nobody can know that": with_step(record, finds, found=(*found, other)),
        "does not believe": with_step(record, moves, moved=moved[1:]),
        "without reason": with_step(record, moves, moved=(*moved[1:], away)),
        "moves a task twice": with_step(record, moves, moved=(*moved, moved[0])),
        "cannot really have been": with_true_task(record, 0, at=far),
    }
    for words, forgery in forged.items():
        messages = [finding.message for finding in judge(forgery).findings]
        assert any(words in message for message in messages), (words, messages)
    elsewhere = with_true_task(record, 0, at=record.mission.tasks[0].at)
    assert judge(elsewhere).findings


@pytest.mark.slow
@pytest.mark.parametrize("part", range(4))
def test_hundreds_of_random_missions_end_and_are_legal(part: int) -> None:
    rng = np.random.default_rng(part)
    done = 0
    for number in range(150):
        mission = with_surprises(random_world(rng, is_plane=number % 3 == 0), rng)
        method = method_of(str(rng.choice(COORDINATIONS)))
        record = run_trial(mission, method, number).record
        assert judge(record).findings == ()
        assert record.end.status in ("completed", "infeasible")
        done += record.end.status == "completed"
    assert done > 90
