"""What one deviation from the shared plan gains: by hand, by forks, and who can tell."""

from __future__ import annotations

import json
import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.test_bench_command import bench
from small_worlds import far_from_what_may_be_needed, robot
from teamformer.bench.measurements.deviations.edits import (
    FEATURES,
    KINDS,
    Deviation,
    draw_deviation,
    features_of,
)
from teamformer.bench.measurements.deviations.moments import Moment, moment_in
from teamformer.bench.measurements.deviations.report import can_teach, table_of, verdict_on
from teamformer.bench.measurements.deviations.trying import Tried, end_with, try_deviations
from teamformer.bench.report.figures import draw_learning
from teamformer.bench.store import lock_folder
from teamformer.model import Scenario
from teamformer.policies.scripted.follow_plan import FollowPlan
from teamformer.sim.env import TeamFormation
from teamformer.train.learning.critics import teach_critics
from teamformer.truth import draw_truth


def env_where(scenario: Scenario, needs: str) -> TeamFormation:
    """Return a mission whose first task turns out to need each letter of `needs`."""
    truths = (draw_truth(scenario, seed) for seed in range(100))
    truth = next(truth for truth in truths if truth.tasks[0].needs.keys() == set(needs))
    return TeamFormation([scenario], truths=[truth])


def begin(foresight: str = "needed", needs: str = "a") -> tuple[TeamFormation, Moment]:
    scenario = far_from_what_may_be_needed(foresight)
    env = env_where(scenario, needs)
    moment = moment_in(env, scenario)
    assert moment is not None
    return env, moment


def test_a_moment_says_what_the_plan_leaves_to_spare() -> None:
    _, moment = begin()
    assert dict(zip(moment.plan.order, moment.plan.coalitions, strict=True)) == {
        0: (0, 1),
        1: (0,),
        2: (1,),
    }
    assert moment.ends == {0: 6, 1: 19, 2: 22}  # 5 to T, a join, a parting; 4 + 8, and 15
    assert moment.spare == {0: 1, 1: 3, 2: 0}  # b seems to wait at V: to part is not counted
    assert moment.unseen == {0}
    assert [moment.tasks_of(number) for number in range(3)] == [[0, 1], [0, 2], []]


@pytest.mark.parametrize(
    ("kind", "foresight", "expected"),
    [
        ("look first", "needed", [((2,), 0)]),  # c, before a and b, who come to do it
        ("look first", "scouting", [((2,), 0)]),
        ("do not look", "needed", []),
        ("do not look", "scouting", [((2,), 0)]),
        ("other task first", "needed", [((0,), 0), ((1,), 0)]),
        ("take along", "needed", []),  # c has nothing that any task may need
        ("leave out", "needed", [((1,), 0)]),  # without a it cannot be done
    ],
)
def test_deviations_are_all_that_there_are(
    kind: str, foresight: str, expected: list[tuple[tuple[int, ...], int]]
) -> None:
    _, moment = begin(foresight)
    found = list(KINDS[kind](moment))
    assert [(deviation.robots, deviation.task) for deviation in found] == expected
    drawn = draw_deviation(moment, kind, np.random.default_rng(0))
    assert (drawn in found) if expected else drawn is None


def test_whoever_has_what_may_be_needed_can_be_taken_along() -> None:
    scenario = far_from_what_may_be_needed("needed")
    scenario = replace(scenario, robots=(*scenario.robots[:2], robot("ab", 2)))
    env = env_where(scenario, "a")
    moment = moment_in(env, scenario)
    assert moment is not None
    for deviation in KINDS["take along"](moment):
        row = deviation.plan.order.index(deviation.task)
        team = deviation.plan.coalitions[row]
        assert set(team) == {*moment.plan.coalitions[row], *deviation.robots}
        assert deviation.plan.order == moment.plan.order
    assert any(it.robots == (2,) or it.robots == (0,) for it in KINDS["take along"](moment))


def only(moment: Moment, kind: str, number: int = 0) -> Deviation:
    return list(KINDS[kind](moment))[number]


@pytest.mark.parametrize(
    ("kind", "needs", "steps"),
    [
        ("look first", "a", 17),  # as `scouting` does: 20 otherwise
        ("look first", "ab", 22),
        ("leave out", "a", 17),  # a: 5 to T, done on arrival; 4 to U, 8 there
        ("other task first", "a", 20),  # b shows at T what it needs, and all plan anew
    ],
)
def test_a_deviation_is_played_to_the_end(kind: str, needs: str, steps: int) -> None:
    env, moment = begin(needs=needs)
    assert end_with(env, only(moment, kind)).steps == steps


@pytest.mark.parametrize("foresight", ["needed", "scouting"])
def test_a_plan_without_a_change_ends_like_the_mission(foresight: str) -> None:
    env, moment = begin(foresight)
    same = Deviation("none", moment.plan, (0,), 0)
    with_it = end_with(env.fork(), same)
    while env.is_running[0]:
        env.step(FollowPlan().decide(env.view()))
    assert with_it == env.tally()


def test_features_are_numbers_around_one() -> None:
    _, moment = begin("scouting")
    for kind in KINDS:
        for deviation in KINDS[kind](moment):
            said = dict(zip(FEATURES, features_of(moment, deviation), strict=True))
            assert said[kind] == 1
            assert sum(said[other] for other in KINDS) == 1
            assert max(map(abs, said.values())) <= 3
    said = dict(zip(FEATURES, features_of(moment, only(moment, "look first")), strict=True))
    assert said["steps to the task"] == 2 / 20
    assert said["steps there before the service"] == (moment.begin_of(0) - 2) / 20
    assert said["has nothing to do"] == 1
    assert said["needs that there may be"] == 0.5


def test_trying_is_repeatable_and_compares_with_the_same_truth() -> None:
    once, again = (try_deviations("4N4T-C4-needs", 3, 4) for _ in range(2))
    assert once == again
    assert 1 <= len(once) <= 4
    assert {row.world for row in once} == {3}


def test_critics_find_what_can_be_known_in_worlds_that_they_never_saw() -> None:
    rng = np.random.default_rng(0)
    features = rng.normal(size=(200, 4))
    gain = np.rint(3 * features[:, 0] + rng.normal(size=200))
    taught = teach_critics(features, gain, np.arange(200) % 5)
    assert np.corrcoef(taught.promised, gain)[0, 1] > 0.9
    assert taught.unseen[-1] < 0.3


def test_critics_find_nothing_where_there_is_nothing() -> None:
    rng = np.random.default_rng(0)
    features, gain = rng.normal(size=(100, 4)), np.rint(3 * rng.normal(size=100))
    taught = teach_critics(features, gain, np.arange(100) % 5)
    assert taught.unseen[-1] > 1.0  # worse than who always says the mean
    assert taught.learned[-1] < 0.9  # though they learn it by heart


def test_the_table_counts_and_the_verdict_chooses() -> None:
    gains = [2, 0, -1, 3]
    rows = [Tried(f"s{n % 2}", n, 1, "look first", gain, (0.0,)) for n, gain in enumerate(gains)]
    assert table_of(rows) == [
        ("look first", "s0", "2", "50%", "50%", "+0.50 ± 19.06"),
        ("look first", "s1", "2", "50%", "0%", "+1.50 ± 19.06"),
        ("look first", "all", "4", "50%", "25%", "+1.00 ± 2.91"),
    ]
    assert not can_teach(rows)
    varied = [
        replace(row, world=number % 10, gain=number % 3) for number, row in enumerate(rows * 20)
    ]
    assert can_teach(varied)
    assert not can_teach(varied[:49])
    assert not can_teach([replace(row, world=3) for row in varied])
    assert not can_teach([replace(row, gain=0) if row.world % 5 == 2 else row for row in varied])
    promised = np.array([1.2, 0.6, 0.1, -1.0])
    said = verdict_on(rows, promised, np.array([0.9, 0.5]), np.array([0.8, 1.1]))
    assert "0.50 of that of the mean" in said[0]
    assert "1.10 on other worlds, 0.80 at best" in said[0]
    assert said[1].endswith("more than 0 steps for: 3 of 4, steps won: +0.33 ± 3.79")
    assert said[2].endswith("more than 0.5 steps for: 2 of 4, steps won: +1.00 ± 12.71")
    assert said[3].endswith("more than 1 steps for: 1 of 4, steps won: +2.00")


def test_the_curves_are_drawn(tmp_path: Path) -> None:
    draw_learning(np.array([1.0, 0.8]), np.array([1.0, 1.1]), tmp_path / "curves.png")
    assert (tmp_path / "curves.png").read_bytes().startswith(b"\x89PNG")


def test_the_command_goes_on_where_it_was(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    flags = ("--settings", "4N4T-C4-needs", "--workers", "1", "--out", str(tmp_path))
    assert bench("deviations", "--trials", "1", *flags) == 0
    assert "4N4T-C4-needs" in capsys.readouterr().out
    rows = (tmp_path / "tried.jsonl").read_text().splitlines()
    assert [json.loads(row)["world"] for row in rows] == [0]
    assert bench("deviations", "--trials", "2", *flags) == 0
    assert (tmp_path / "tried.jsonl").read_text().splitlines()[:1] == rows
    assert "too little was tried" in capsys.readouterr().err
    (tmp_path / "tried.jsonl").write_text(f"{{}}\n{rows[0]}\n\n{rows[0][:40]}")
    assert bench("deviations", "--trials", "1", *flags) == 0
    assert "tried.jsonl: lines 1, 4 cannot be read; set aside" in capsys.readouterr().err
    assert (tmp_path / "tried.jsonl").read_text().splitlines() == rows
    assert (tmp_path / "broken-rows.txt").read_text() == (
        f"tried.jsonl:1: {{}}\ntried.jsonl:4: {rows[0][:40]}\n"
    )
    lock = lock_folder(tmp_path)
    assert bench("deviations", "--trials", "1", *flags) == 2
    assert f"{tmp_path}: another bench is at work here" in capsys.readouterr().err
    os.close(lock)
    assert bench("deviations", "--policies", "heuristic", "--order", "tsp") == 2
    assert "the suite 'deviations' has no use for --policies, --order" in capsys.readouterr().err
    assert bench("deviations", "--settings", "4N4T-C4") == 2
    assert "in '4N4T-C4' nothing is uncertain" in capsys.readouterr().err
