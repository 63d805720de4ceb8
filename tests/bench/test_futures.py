"""Futures: drawn by what is known and nothing else, and what is chosen by them."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.test_bench_command import bench
from bench.test_deviations import begin
from teamformer.bench.measurements.deviations.choosing import (
    Chosen,
    best_by_futures,
    choose_in,
    gains_in_futures,
    offers_in,
)
from teamformer.bench.measurements.deviations.report import table_of_choices
from teamformer.bench.measurements.deviations.trying import end_of, follow
from teamformer.mission.rules import BEST_ALLOCATION
from teamformer.scenarios.named_settings import world_of
from teamformer.sim.env import TeamFormation
from teamformer.truth import draw_truth


def after(setting: str, steps: int, seed: int = 3) -> TeamFormation:
    mission = replace(world_of(setting, seed), allocation=BEST_ALLOCATION)
    env = TeamFormation([mission], truths=[draw_truth(mission, seed)])
    for _ in range(steps):
        follow(env)
    return env


def test_needs_are_drawn_by_their_probability_where_nobody_has_seen_them() -> None:
    env = after("4N4T-C4-needs", 3)
    before, (hidden,) = env.worlds.true_needs.copy(), env.worlds.tasks["hides_needs"]
    assert 0 < hidden.sum() < 4
    futures = [env.imagine(rng).worlds for rng in np.random.default_rng(0).spawn(400)]
    needs = np.array([worlds.true_needs[0] for worlds in futures])
    assert (needs[:, ~hidden] == before[0, ~hidden]).all()
    assert np.array_equal(env.worlds.true_needs, before)
    unsure = hidden[:, None] & (env.worlds.may_need[0] > 0)
    assert (needs[:, hidden[:, None] & ~unsure] == before[0, hidden[:, None] & ~unsure]).all()
    assert (np.abs(needs[:, unsure].mean(axis=0) - 0.5) < 0.1).all()  # four standard errors


def test_a_task_is_drawn_into_any_place_that_is_left() -> None:
    env = after("4N4T-C4-places", 4)
    (hidden,) = env.worlds.tasks["hides_place"]
    (left,) = env.worlds.spots["is_possible"]
    (at_first,) = after("4N4T-C4-places", 0).worlds.spots["is_possible"]
    assert (left[hidden] != at_first[hidden]).any()  # some places are ruled out
    futures = [env.imagine(rng).worlds for rng in np.random.default_rng(0).spawn(400)]
    for task in range(4):
        lies_in = {int(worlds.tasks["lies_in"][0, task]) for worlds in futures}
        if hidden[task]:
            assert lies_in == set(np.flatnonzero(left[task]))
        else:
            assert lies_in == {env.worlds.tasks["lies_in"][0, task]}


def test_the_truth_is_in_no_future() -> None:
    one, other = (begin(needs=needs)[0] for needs in ("a", "ab"))
    assert not np.array_equal(one.worlds.true_needs, other.worlds.true_needs)
    for number in range(6):
        ends = [end_of(env.imagine(np.random.default_rng(number))) for env in (one, other)]
        assert ends[0] == ends[1]


def test_what_cannot_be_drawn_anew_is_refused() -> None:
    with pytest.raises(ValueError, match="more than needs and places is uncertain"):
        after("4N4T-C4-mixed", 0).imagine(np.random.default_rng(0))


def test_what_is_chosen_is_what_pays_on_average() -> None:
    env, moment = begin()
    offers = offers_in(moment, np.random.default_rng(0))
    assert [(it.kind, it.robots) for it in offers] == [
        ("look first", (2,)),
        ("other task first", (0,)),
        ("other task first", (1,)),
        ("leave out", (1,)),
    ]
    gains = gains_in_futures(env, dict(enumerate(offers)), np.random.default_rng(2).spawn(6))
    unneeded = [gain == 3 for gain in gains[0]]  # 17 steps for 20: b never sets out for T
    assert set(unneeded) == {True, False}
    assert gains[0] == [3 * it for it in unneeded]
    assert gains[1] == [0] * 6
    assert gains[3] == [3 if it else -4 for it in unneeded]  # b is back too late: 26 for 22
    best = best_by_futures(env, offers, np.random.default_rng(1))
    assert best is not None
    assert best.deviation == offers[0]
    assert best.promised == 3 * 5 / 12  # b was needed in 7 of 12 futures
    assert best_by_futures(env, offers[1:2], np.random.default_rng(1)) is None


def test_choosing_is_repeatable_and_told_by_moment() -> None:
    once, again = (choose_in("4N4T-C4-places", 1, 1) for _ in range(2))
    assert once == again
    assert len(once) == 1
    assert all(row.plans >= 2 and (row.kind or row.gain == 0) for row in once)


def test_the_table_tells_what_came_of_promises() -> None:
    nothing = Chosen("s", 0, 1, 10, 4, "", 0.0, 0.0)
    chosen = replace(nothing, plans=20, kind="look first", promised=2.0, gain=0.5)
    assert table_of_choices([nothing, chosen]) == [
        ("s", "2", "1", "+2.00", "+0.50", "+0.25 ± 3.18", "+3.75 ± 47.65")
    ]
    assert table_of_choices([nothing])[0][2:5] == ("0", "", "")


def test_the_command_goes_on_where_it_was(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    flags = ("--settings", "4N4T-C4-needs", "--workers", "1", "--out", str(tmp_path))
    assert bench("futures", "--trials", "1", *flags) == 0
    rows = (tmp_path / "chosen.jsonl").read_text().splitlines()
    assert [json.loads(row)["world"] for row in rows] == [0]
    assert bench("futures", "--trials", "1", *flags) == 0
    assert (tmp_path / "chosen.jsonl").read_text().splitlines() == rows
    capsys.readouterr()
    assert bench("futures", "--settings", "4N4T-C4-mixed") == 2
    assert "more than needs and places is uncertain" in capsys.readouterr().err
    assert bench("futures", "--settings", "4N4T-C4") == 2
    assert "in '4N4T-C4' nothing is uncertain" in capsys.readouterr().err
