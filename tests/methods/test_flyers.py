"""Robots that fly over walls, with others: who may be one team, and that every mission ends."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from random_worlds import random_decision
from teamformer.files.drawn.families import FAMILIES
from teamformer.files.drawn.family_missions import draw_mission
from teamformer.methods.by_name import load_method
from teamformer.methods.listings import our_method_names
from teamformer.methods.scripted.heuristic import Heuristic
from teamformer.methods.scripted.join_fitting import JoinFitting
from teamformer.methods.scripted.joining import JoinAll
from teamformer.methods.seam.protocol import Policy
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.trials.trial import run_trials
from teamformer.world.env import TeamFormation
from teamformer.world.rules.constants import NOBODY

LARGE = FAMILIES["air-ground"]
SMALL = replace(LARGE, robots=(4, 6), tasks=(8, 14), width=(12, 16), height=(8, 12))
RULES = (JoinAll(), JoinFitting(), Heuristic())
PLANNED = [name for name in our_method_names() if name != "central"]
"""The central planner is never worse than any of these, and takes its time."""


def drawn(family: object, count: int) -> list[Mission]:
    return [draw_mission(family, np.random.default_rng([7, n]), "drawn") for n in range(count)]


def island(*robots: Robot, tasks: tuple[Task, ...]) -> Mission:
    """Return a corridor with a wall at 5: `.....@..`."""
    return Mission("island", Grid(8, 1, (".....@..",)), ("a", "b"), robots, tasks)


def flyer(x: int, **can: int) -> Robot:
    return Robot("flyer", (x, 0), can, moves="air")


def has_to_part(env: TeamFormation, team: list[int], other: list[int] | None = None) -> bool:
    """Say by the words of docs/explanation/nothing-blocks.md whether two teams, or one, would."""
    robots, teams, tasks = (
        part[0] for part in (env.worlds.robots, env.worlds.teams, env.worlds.tasks)
    )
    union = team + (other or [])
    flying = [r for r in union if robots["region"][r] < 0]
    driving = [r for r in union if r not in flying]
    if not flying or not driving:
        return False
    before = env.worlds.order[0][: env.worlds.count["open"][0]].tolist()
    slots = [group[0] for group in (team, other or team)]
    [own, theirs] = teams["task"][slots].tolist()
    at = [(teams["x"][slot], teams["y"][slot]) for slot in slots]
    if own == theirs != NOBODY and all(spot == (tasks["x"][own], tasks["y"][own]) for spot in at):
        before = before[: before.index(own)]
    brings, needs = env.worlds.brings[0], env.worlds.needs[0]
    return any(
        tasks["region"][k] != robots["region"][driving[0]]
        and any((np.minimum(brings[r], needs[k]) > 0).any() for r in flying)
        for k in before
    )


def test_views_say_who_has_to_part_and_who_can_go_with_whom() -> None:
    rng, told = np.random.default_rng(3), set[tuple[str, bool]]()
    for mission in drawn(SMALL, 6):
        env = TeamFormation([mission])
        for _ in range(40):
            if not env.is_running[0]:
                break
            view = env.view()
            members = np.split(view.member, view.first_member[1:-1])
            team_of = dict(zip(view.slot.tolist(), [m.tolist() for m in members], strict=True))
            for row, slot in enumerate(view.slot.tolist()):
                parts = not view.is_serving[row] and has_to_part(env, team_of[slot])
                assert view.has_to_part[row] == parts
                told.add(("parts", bool(parts)))
                for column in np.flatnonzero(view.is_here[row] & view.can_join[row]).tolist():
                    other = team_of[int(view.seen_slot[row, column])]
                    goes = not has_to_part(env, team_of[slot], other)
                    assert view.can_go_with[row, column] == goes
                    told.add(("goes", goes))
            env.step(random_decision(view, rng))
    assert len(told) == 4


@pytest.mark.parametrize("policy", RULES)
def test_who_is_needed_beyond_a_wall_goes_there_alone(policy: Policy) -> None:
    """D and F start at 0; the task at 2 needs both, that at 7 F alone, beyond a wall.

    Once both have done theirs, at 2, F parts from D and flies: that no team with D could.
    """
    tasks = (Task("both", (2, 0), {"a": 1, "b": 1}), Task("beyond", (7, 0), {"b": 1}))
    mission = island(Robot("driver", (0, 0), {"a": 1}), flyer(0, b=1), tasks=tasks)
    [tally] = run_trials([mission], policy)
    assert tally.status == "completed"
    assert (tally.joins, tally.splits) == (1, 1)


@pytest.mark.parametrize("policy", RULES)
def test_a_team_that_cannot_get_there_parts(policy: Policy) -> None:
    """They begin as one team, at a task that waits for somebody who waits for the flyer."""
    tasks = (Task("beyond", (7, 0), {"b": 1}), Task("here", (0, 0), {"a": 2}))
    robots = (Robot("driver", (0, 0), {"a": 1}), flyer(0, b=1), Robot("late", (4, 0), {"a": 1}))
    mission = replace(island(*robots, tasks=tasks), teams=((0, 1),))
    [tally] = run_trials([mission], policy)
    assert tally.status == "completed"


def test_nobody_is_joined_by_mistake_who_brings_the_same() -> None:
    """Two that drive and one that flies bring the same; who joins cannot say whom it means."""
    tasks = (Task("beyond", (7, 0), {"a": 1}), Task("here", (4, 0), {"a": 2}))
    robots = (flyer(0, a=1), Robot("one", (0, 0), {"a": 1}), Robot("two", (0, 0), {"a": 1}))
    env = TeamFormation([island(*robots, tasks=tasks)])
    view = env.view()
    wanted = JoinAll().decide(view).wanted
    assert (wanted == view.counts).all()


@pytest.mark.parametrize("name", ["join-all", "join-fitting", "heuristic", "teamformer"])
def test_small_missions_end(name: str) -> None:
    tallies = run_trials(drawn(SMALL, 20), load_method(name))
    assert [tally.status for tally in tallies] == ["completed"] * 20


@pytest.mark.slow
@pytest.mark.parametrize("name", PLANNED)
def test_missions_of_two_sizes_end_by_every_method(name: str) -> None:
    tallies = run_trials([*drawn(SMALL, 20), *drawn(LARGE, 20)], load_method(name))
    assert [tally.status for tally in tallies] == ["completed"] * 40
