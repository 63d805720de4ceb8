"""Tasks that appear at random: part of the truth, known to nobody before they appear."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from small_worlds import make, play, robot, task
from teamformer.files.drawn.named_settings import world_of
from teamformer.files.mission_files import mission_from_tree, mission_to_tree
from teamformer.methods.by_name import load_method
from teamformer.mission.arrivals import most_tasks, once_appeared, without_arrivals
from teamformer.mission.model import Arrivals, Mission
from teamformer.mission.parts.grid import Grid
from teamformer.mission.truth import draw_truth, expected_mission
from teamformer.record.files.reading import read_record
from teamformer.record.files.writing import save_record
from teamformer.record.referee import judge
from teamformer.trials.trial import run_trial
from teamformer.world.env import TeamFormation
from test_surprises import is_alike, play_views


def corridor(rate: float, until: int, most_needs: int = 0, duration: int = 0) -> Mission:
    """Two robots and a task between walls; the cell behind the wall is not for them.

    a b . . T @ .
    """
    grid = Grid(7, 1, (".....@.",))
    arrivals = Arrivals(rate, until, most_needs, duration)
    return make([robot("a", 0), robot("b", 1)], [task("a", 4)], grid, arrivals=arrivals)


def test_as_many_appear_as_the_rate_says_where_robots_can_do_them() -> None:
    mission = corridor(0.25, 40)
    truths = [draw_truth(mission, seed).tasks[1:] for seed in range(150)]
    assert np.mean([len(tasks) for tasks in truths]) == pytest.approx(10, abs=0.7)
    arrived = [task for tasks in truths for task in tasks]
    assert {one.at for one in arrived} == {(x, 0) for x in range(5)}
    assert {tuple(one.needs) for one in arrived} == {("a",), ("b",), ("a", "b")}
    share = sum(len(one.needs) == 2 for one in arrived) / len(arrived)
    assert share == pytest.approx(0.5, abs=0.05)
    assert {one.appears for one in arrived} == set(range(1, 41))
    assert [one.name for one in truths[0]][:2] == ["call-1", "call-2"]


def test_every_step_brings_one_at_a_rate_of_one() -> None:
    truth = draw_truth(corridor(1.0, 3, most_needs=1, duration=2), 0)
    assert [one.appears for one in truth.tasks] == [0, 1, 2, 3]
    assert {sum(one.needs.values()) for one in truth.tasks} == {1}
    assert [one.duration for one in truth.tasks] == [0, 2, 2, 2]
    assert truth.arrivals is None
    assert not draw_truth(corridor(0.0, 3), 0).tasks[1:]


def test_what_has_appeared_may_be_known_and_the_rest_stays_as_it_was() -> None:
    mission = corridor(0.5, 30)
    truth = draw_truth(mission, 3)
    known = once_appeared(mission, truth, 12)
    arrived = [one for one in truth.tasks[1:] if one.appears <= 12]
    assert 0 < len(arrived) < len(truth.tasks) - 1
    assert known.tasks == (truth.tasks[0], *(replace(one, has_arrived=False) for one in arrived))
    assert draw_truth(known, 3).tasks == (*known.tasks, *truth.tasks[len(known.tasks) :])
    assert most_tasks(known) == len(known.tasks) + 18
    assert mission_from_tree(mission_to_tree(known), "x") == known


def test_names_that_are_taken_are_left_out() -> None:
    mission = corridor(1.0, 2)
    mission = replace(mission, tasks=(replace(mission.tasks[0], name="call-1"),))
    assert [one.name for one in draw_truth(mission, 0).tasks] == ["call-1", "call-2", "call-3"]


def test_views_are_as_wide_however_many_appear() -> None:
    """Two tasks appear: nobody sees one, or how many there will be, before it does."""
    env = TeamFormation([corridor(1.0, 2)])
    known = []
    for _ in range(3):
        assert env.view().task_number.shape == (len(env.view().slot), 16)
        known.append(sorted(set(env.view().task_number.ravel().tolist()) - {-1}))
        play(env)
    assert known == [[0], [0, 1], [0, 1, 2]]
    assert len(expected_mission(corridor(1.0, 2)).tasks) == 1
    assert most_tasks(corridor(0.1, 40)) == 41


def test_files_keep_arrivals() -> None:
    for mission in (corridor(0.1, 9), corridor(0.1, 9, 2, 3)):
        assert mission_from_tree(mission_to_tree(mission), "x") == mission
        assert mission.has_surprises
        truth = draw_truth(mission, 1)
        assert mission_from_tree(mission_to_tree(truth), "x") == truth
        assert not truth.has_surprises


@pytest.mark.parametrize("method", ["join-fitting", "plan"])
def test_missions_with_arrivals_end_and_are_legal(method: str, tmp_path: Path) -> None:
    mission = world_of("4N20T-C4-calls", 0)
    record = run_trial(mission, load_method(method), 4).record
    assert record.end.status == "completed"
    assert record.end.tasks_done == len(record.true_mission.tasks) > 22
    assert judge(record).findings == ()
    save_record(record, tmp_path / "record.json")
    again = read_record(tmp_path / "record.json")
    assert again == record
    assert again.mission.tasks[20].has_arrived
    assert without_arrivals(again.mission) == mission


def test_nobody_knows_what_will_appear() -> None:
    mission = world_of("4N20T-C4-calls", 0)
    truths = [draw_truth(mission, seed) for seed in (1, 2)]
    first = min(task.appears for truth in truths for task in truth.tasks[20:])
    one, other = (play_views(mission, truth, "join-fitting", first + 1)[1] for truth in truths)
    assert all(is_alike(a, b) for a, b in zip(one[:first], other[:first], strict=True))
    assert not is_alike(one[first], other[first])


def test_the_referee_refuses_what_cannot_appear() -> None:
    source = corridor(0.5, 9, most_needs=1, duration=2)
    record = run_trial(source, load_method("join-all"), 1).record
    assert judge(record).findings == ()
    assert len(record.true_mission.tasks) > 2
    changes = [{"appears": 10}, {"duration": 3}, {"needs": {"a": 1, "b": 1}}, {"needs": {"a": 2}}]
    for change in changes:
        tasks = [*record.mission.tasks[:-1], replace(record.mission.tasks[-1], **change)]
        robots = tuple(replace(one, can={"a": 2, "b": 2}) for one in record.mission.robots)
        forged = [
            replace(mission, tasks=tuple(tasks), robots=robots)
            for mission in (record.mission, record.true_mission)
        ]
        forgery = replace(record, mission=forged[0], truth=forged[1])
        messages = [finding.message for finding in judge(forgery).findings]
        assert any("cannot have appeared" in message for message in messages), change


def test_pettingzoo_has_room_for_all_that_may_appear() -> None:
    parallel_env = pytest.importorskip("teamformer.world.multi_agent.parallel_env")
    env = parallel_env.TeamFormationParallel(corridor(0.5, 9))
    rows = set()
    for seed in range(4):
        observations, _ = env.reset(seed=seed)
        assert env.state().shape == env.state_space.shape
        assert env.observation_space("r0").contains(observations["r0"])
        rows.add(int((env.state()[14:].reshape(10, 8)[:, 0] == -1).sum()))
    assert len(rows) > 1
