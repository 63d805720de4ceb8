"""Robots that stand still now and then, in steps that the truth says and nobody knows."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from small_worlds import make, places, play, robot, task
from teamformer.files.drawn.named_settings import world_of
from teamformer.files.mission_files import mission_from_tree, mission_to_tree
from teamformer.methods.by_name import load_method
from teamformer.mission.model import Delays, Mission
from teamformer.mission.truth import draw_truth, expected_mission
from teamformer.record.files.reading import read_record
from teamformer.record.files.writing import save_record
from teamformer.record.record import TeamAt
from teamformer.record.referee import judge
from teamformer.trials.trial import run_trial
from teamformer.world.env import TeamFormation
from test_surprises import play_views, with_step


def delayed(chance: float, seed: int | None = None, speed: float = 1.0) -> Mission:
    """One robot on its way.

    a . . . . . . . . . T
    """
    walker = replace(robot("a", 0, speed=speed), delays=Delays(chance, seed))
    return make([walker], [task("a", 10)])


def walk(mission: Mission, steps: int) -> list[int]:
    """Return where the first robot is after each step."""
    env = TeamFormation([mission], truths=[draw_truth(mission, 0)])
    seen = []
    for _ in range(steps):
        play(env)
        seen.append(places(env)[0])
    return seen


def test_who_is_never_delayed_walks_on() -> None:
    assert walk(delayed(0.0, 3), 9) == list(range(1, 10))


def test_a_robot_walks_as_often_as_the_file_says() -> None:
    """Over 200 seeds of 9 steps each, three in ten stand still; the same seed gives the same."""
    gone = [walk(delayed(0.3, seed), 9)[-1] for seed in range(200)]
    assert np.mean(gone) == pytest.approx(9 * 0.7, abs=0.25)
    assert walk(delayed(0.3, 5), 9) == walk(delayed(0.3, 5), 9)
    assert len(set(gone)) > 4


def test_who_stands_still_keeps_what_it_has_saved() -> None:
    """At half a cell a step, every second step that is none of standing still gets on a cell."""
    fast, slow = walk(delayed(0.3, 7), 9), walk(delayed(0.3, 7, speed=0.5), 9)
    assert slow == [cells // 2 for cells in fast]


def test_a_team_walks_when_none_of_its_robots_stands_still() -> None:
    one, other = (delayed(0.3, seed).robots[0] for seed in (1, 2))
    alone = [[0, *walk(make([single], [task("a", 19)]), 12)] for single in (one, other)]
    moves = [np.diff(way) for way in alone]
    together = walk(make([one, other], [task("a", 19)], teams=((0, 1),)), 12)
    assert np.diff([0, *together]).tolist() == (moves[0] & moves[1]).tolist()


def test_views_hold_the_chance_and_plans_the_expected_speed() -> None:
    one, other = delayed(0.5).robots[0], delayed(0.2).robots[0]
    mission = make([one, other], [task("a", 19)], teams=((0, 1),))
    assert TeamFormation([mission]).view().delay.tolist() == pytest.approx([0.6])
    assert [r.speed for r in expected_mission(mission).robots] == [0.5, 0.8]
    slow, fast = mission.robots
    slowest = replace(mission, robots=(replace(slow, speed=0.001), fast))
    assert expected_mission(slowest).robots[0].speed == 0.001


def test_files_keep_delays() -> None:
    for delays in (Delays(0.25), Delays(0.25, 8)):
        mission = delayed(delays.chance, delays.seed)
        assert mission_from_tree(mission_to_tree(mission), "x") == mission
    assert delayed(0.25).has_surprises
    assert not delayed(0.25, 8).has_surprises


@pytest.mark.parametrize("method", ["join-fitting", "plan"])
def test_delayed_missions_end_and_are_legal(method: str, tmp_path: Path) -> None:
    mission = world_of("4N20T-C4-delays", 0)
    record = run_trial(mission, load_method(method), 4).record
    assert record.end.status == "completed"
    assert judge(record).findings == ()
    save_record(record, tmp_path / "record.json")
    assert read_record(tmp_path / "record.json") == record


def test_nobody_knows_when_robots_stand_still() -> None:
    mission = world_of("4N20T-C4-delays", 0)
    truths = [draw_truth(mission, seed) for seed in (1, 2)]
    seen = [play_views(mission, truth, "join-fitting", 40)[1] for truth in truths]
    for (one, decision), (other, same) in zip(*seen, strict=True):
        if not np.array_equal(one.place, other.place):
            break
        assert np.array_equal(decision.wanted, same.wanted)
        assert all(np.array_equal(a, b) for a, b in zip(one, other, strict=True))
    else:
        pytest.fail("both were delayed in the same steps")


def test_the_referee_sees_who_walks_while_it_stands_still() -> None:
    mission = delayed(0.3, None)
    record = run_trial(mission, load_method("join-all"), 4).record
    assert judge(record).findings == ()
    still = next(i for i, step in enumerate(record.steps) if not step.teams)
    at = max(team.x for step in record.steps[:still] for team in step.teams)
    forged = with_step(record, still, teams=(TeamAt(0, at + 1, 0, 0),))
    messages = [finding.message for finding in judge(forged).findings]
    assert any("one of its robots stands still" in message for message in messages)
    truth = replace(
        record.true_mission, robots=(replace(record.true_mission.robots[0], delays=None),)
    )
    messages = [finding.message for finding in judge(replace(record, truth=truth)).findings]
    assert any("must get 1 cell nearer" in message for message in messages)
    assert any("cannot really have been like that" in message for message in messages)
