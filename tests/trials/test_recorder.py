"""The record: by hand, and enough to bring every state back."""

from __future__ import annotations

import numpy as np

from random_worlds import random_decision, random_world
from small_worlds import late_task, make, play, robot, task, two_robots_one_task
from teamformer.record.record import Record, Step, TeamAt
from teamformer.trials.recorder import Recorder, _splits
from teamformer.world.env import TeamFormation
from teamformer.world.rules.constants import NOBODY

State = dict[int, tuple[tuple[int, ...], TeamAt]]
"""The robots of each team, and how it stands, by slot."""


def test_a_join_and_a_walk() -> None:
    env = TeamFormation([two_robots_one_task()])
    recorder = Recorder(env)
    play(env, joins={1: 0})
    recorder.step()
    for _ in range(3):
        play(env)
        recorder.step()
    record = recorder.finish("by hand", 3, None)
    assert record.start == ((0, (0,), 0, 0), (1, (1,), 0, 0))
    assert record.orders == ((0, (0,)),)
    assert record.steps == (
        Step(joins=((1, 0),), teams=(TeamAt(0, 0, 0, 0),)),
        Step(teams=(TeamAt(0, 1, 0, 0),)),
        Step(teams=(TeamAt(0, 2, 0, 0),)),
        Step(teams=(TeamAt(0, 3, 0, None),), done=((0, 0),)),
    )
    assert (record.end.makespan, record.end.joins) == (4, 1)


def test_a_split_says_who_stays() -> None:
    robots = [robot("a", 0), robot("b", 0), robot("c", 0)]
    env = TeamFormation([make(robots, [task("abc", 5)], teams=((0, 1, 2),))])
    recorder = Recorder(env)
    play(env, splits={0: [1]})
    recorder.step()
    [step] = recorder.finish("by hand", 0, None).steps
    assert step.splits == (((1,), (0, 2)),)
    assert step.teams == (TeamAt(0, 0, 0, 0), TeamAt(1, 0, 0, 0))


def test_a_loss_changes_the_slot_after_the_formation() -> None:
    """0 joins 1 and is lost in the same step."""
    robots = [robot("a", 0, lost=1), robot("b", 0)]
    env = TeamFormation([make(robots, [task("b", 5)])])
    recorder = Recorder(env)
    play(env, joins={0: 1})
    recorder.step()
    [step] = recorder.finish("by hand", 0, None).steps
    assert step.joins == ((0, 1),)
    assert step.lost == (0,)
    assert step.teams == ()  # slot 1 stands where it stood, without assignment


def test_each_order_is_written_when_tasks_appear() -> None:
    env = TeamFormation([late_task()])
    recorder = Recorder(env)
    for _ in range(3):
        play(env)
        recorder.step()
    assert recorder.finish("by hand", 0, None).orders == ((0, (0,)), (2, (1, 0)))


def states_of(record: Record) -> list[State]:
    """Bring back each state from what the record says has changed."""
    groups = {slot: robots for slot, robots, _, _ in record.start}
    stand = {slot: TeamAt(slot, x, y, None) for slot, _, x, y in record.start}
    states = []
    for step in record.steps:
        for joiner, partner in step.joins:
            robots = tuple(sorted(groups.pop(joiner) + groups.pop(partner)))
            groups[robots[0]] = robots
        for split in step.splits:
            del groups[min(*split[0], *split[1])]
            groups.update({robots[0]: robots for robots in split})
        left = (tuple(r for r in robots if r not in step.lost) for robots in groups.values())
        groups = {robots[0]: robots for robots in left if robots}
        groups |= {robot: (robot,) for robot in step.back}
        stand.update({team.slot: team for team in step.teams})
        states.append({slot: (robots, stand[slot]) for slot, robots in groups.items()})
    return states


def state_of(env: TeamFormation) -> State:
    state = {}
    for slot in np.flatnonzero(env.worlds.teams["size"][0]).tolist():
        robots = tuple(np.flatnonzero(env.worlds.robots["team"][0] == slot).tolist())
        team = env.worlds.teams[0, slot]
        task = None if team["task"] == NOBODY else int(team["task"])
        state[slot] = (robots, TeamAt(slot, int(team["x"]), int(team["y"]), task))
    return state


def test_the_record_brings_every_state_back() -> None:
    rng = np.random.default_rng(21)
    joins = splits = lost = 0
    for _ in range(60):
        env = TeamFormation([random_world(rng)])
        recorder, states = Recorder(env), []
        while env.is_running[0] and len(states) < 40:
            env.step(random_decision(env.view(), rng))
            recorder.step()
            states.append(state_of(env))
        record = recorder.finish("dice", 0, None)
        assert states_of(record) == states
        assert sum(len(step.joins) for step in record.steps) == record.end.joins
        assert sum(len(step.splits) for step in record.steps) == record.end.splits
        done = {task: s for s, step in enumerate(record.steps, 1) for task, _ in step.done}
        done_at = env.worlds.tasks["done_at"][0].tolist()
        assert done == {k: at for k, at in enumerate(done_at) if at != NOBODY}
        joins += record.end.joins
        splits += record.end.splits
        lost += sum(len(step.lost) for step in record.steps)
    assert min(joins, splits, lost) > 10


def test_who_stays_is_the_part_that_goes_by_the_decision() -> None:
    for stays, expected in ((0, ((0,), (1, 2))), (1, ((1, 2), (0,)))):
        has_decided = np.arange(3) == stays
        assert _splits({0: (0, 1, 2)}, {0: (0,), 1: (1, 2)}, has_decided) == (expected,)
