"""Missions that once failed, one file each: what is asked of every one of them now."""

from __future__ import annotations

import cProfile
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import teamformer as tf
from typed import teamformer

FILES = Path(__file__).parent


def path_of(name: str) -> str:
    return str(FILES / f"{name}.yaml")


def printed(capsys: pytest.CaptureFixture[str], *words: str) -> list[Any]:
    """Return the JSON objects that a command prints; it has to succeed."""
    assert teamformer(*words, "--json") == 0
    return [json.loads(line) for line in capsys.readouterr().out.splitlines()]


def test_every_file_has_its_test() -> None:
    names = {path.stem for path in FILES.glob("*.yaml")}
    tested = Path(__file__).read_text()
    assert len(names) == 25
    assert [name for name in sorted(names) if f'"{name}"' not in tested] == []


def test_what_is_drawn_from_a_range_may_be_late_but_is_no_error(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Of [0, 5] a fifth of all draws takes 5 steps: one step of walking, and 6 is after 4."""
    words = ("compare", path_of("range-in-window"), "--methods", "plan", "--seeds", "60")
    rows = printed(capsys, *words)
    assert [row["completed"] for row in rows] == [True] * 60
    assert {row["makespan"] for row in rows} == {1, 2, 3, 4, 5, 6}
    for row in rows:
        assert row["late"] == ({"t1": row["makespan"] - 4} if row["makespan"] > 4 else {})


@pytest.mark.thorough
def test_nothing_is_exchanged_once_all_is_done() -> None:
    """Two robots exchange their parts in the last step but one, and not again in the last."""
    record = tf.run(tf.load(path_of("exchange-at-the-end")), seed=9).record
    assert [step.took for step in record.steps[-2:]] == [((1, 2),), ()]
    assert tf.check(record).findings == ()


def test_central_and_compare_take_after_with_delays(capsys: pytest.CaptureFixture[str]) -> None:
    rows = printed(capsys, "compare", path_of("central-after-delays"), "--time-limit", "0.2")
    assert {row["method"] for row in rows} >= {"plan", "crews", "central", "heuristic"}
    assert [row["status"] for row in rows] == ["completed"] * len(rows)


def test_tasks_of_no_duration_that_follow_one_another_are_planned(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Robot 2 does u1 after 3 and with the other u0, and walks 11 from there to `last`."""
    (found,) = printed(capsys, "plan", path_of("plan-keyerror"), "--time-limit", "1")
    assert found["makespan"] == 19
    words = ("run", path_of("run-keyerror"), "--method", "central", "--time-limit", "1")
    (row,) = printed(capsys, *words)
    assert row["status"] == "completed"


def test_a_small_weight_of_the_cost_counts(capsys: pytest.CaptureFixture[str]) -> None:
    """Nobody can be late, so that only the three cells of travel are left to save."""
    (found,) = printed(capsys, "plan", path_of("cost-weight-ignored"), "--time-limit", "1")
    tasks = {it["robot"]: [stop["task"] for stop in it["stops"]] for it in found["routes"]}
    assert tasks == {"r1": ["t1", "t3"], "r2": ["t2"]}
    assert found["cost"] == pytest.approx(3 / 3001, abs=5e-4)


@pytest.mark.parametrize(
    ("name", "seed"),
    [("central-infeasible", 1), ("central-slower-uncertain", 0), ("central-slower-sure", 0)],
)
@pytest.mark.thorough
def test_central_is_not_worse_than_plan(name: str, seed: int) -> None:
    mission = tf.load(path_of(name))
    central, plan = (tf.run(mission, method, seed, 0.3) for method in ("central", "plan"))
    ranks = [(not it.completed, it.record.end.steps) for it in (central, plan)]
    assert ranks[0] <= ranks[1]


def test_robots_in_one_place_need_not_form_a_team(capsys: pytest.CaptureFixture[str]) -> None:
    """t1 takes no time, so that both are in one place from the start, and walk 3 together."""
    (found,) = printed(capsys, "plan", path_of("forming-same-place"), "--time-limit", "1")
    assert found["makespan"] == 3


def test_the_truths_of_several_seeds_have_a_bound_each(capsys: pytest.CaptureFixture[str]) -> None:
    words = ("compare", path_of("compare-seeds-bound"), "--seeds", "4", "--time-limit", "0.1")
    rows = printed(capsys, *words)
    bounds = {row["seed"]: row["lower_bound"] for row in rows}
    assert len(set(bounds.values())) > 1
    for row in rows:
        assert row["lower_bound"] <= row["best_known"] <= row["makespan"]


def test_the_default_makes_no_illegal_decision() -> None:
    trial = tf.run(tf.load(path_of("illegal")), seed=3)
    assert trial.completed
    assert trial.record.end.illegal_decisions == 0
    assert trial.check().is_legal


@pytest.mark.parametrize("words", [("export", "{record}", "{out}"), ("check", "{record}")])
@pytest.mark.thorough
def test_twice_the_steps_take_twice_the_calls(words: tuple[str, ...], tmp_path: Path) -> None:
    """Calls are counted, not seconds; with what is quadratic they would be fourfold.

    The first one imports what the others use.
    """
    made = []
    for steps in (20, 300, 600, 1200):
        mission = replace(tf.load(path_of("mcap-quadratic")), step_limit=steps)
        folder = tf.run(mission).save(tmp_path / str(steps))
        named = {"record": str(folder / "record.json"), "out": str(folder / "it.mcap")}
        profile = cProfile.Profile()
        assert profile.runcall(teamformer, *(word.format(**named) for word in words)) == 0
        made.append(sum(it.callcount for it in profile.getstats()))
    _, little, more, most = made
    assert most - more < 3 * (more - little)


def test_the_order_of_capabilities_means_nothing_where_they_are_equally_scarce() -> None:
    """Four robots have the one and four the other."""
    mission = tf.load(path_of("order-of-capabilities"))
    turned = replace(mission, capabilities=mission.capabilities[::-1])
    one, other = (tf.run(which).record for which in (mission, turned))
    assert (one.plans, one.steps) == (other.plans, other.steps)


def test_the_order_of_needs_means_nothing() -> None:
    mission = tf.load(path_of("order-of-keys"))
    assert mission.capabilities == ("n0", "n1", "n0 of r1, r2", "n1 of r1, r2")


def test_an_unknown_need_of_a_pinned_task_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    assert teamformer("run", path_of("unknown-need-with-a-pin")) == 2
    assert ":9: task 't1' needs 'n1', which is not under cap" in capsys.readouterr().err


def test_a_name_that_looks_like_a_tag_is_told_as_it_is(capsys: pytest.CaptureFixture[str]) -> None:
    """Its robot is lost in step 1, before it can do it."""
    assert teamformer("run", path_of("name-as-markup")) == 1
    assert "given up at step 1: [/] can never be done" in capsys.readouterr().out


def test_nothing_takes_less_than_no_time(capsys: pytest.CaptureFixture[str]) -> None:
    """A way of 0.01 to a load that is unloaded where it lies, for 1, after a task that takes 1."""
    assert teamformer("plan", path_of("load-that-stays"), "--method", "plan") == 0
    shown = capsys.readouterr().out
    assert "why so late: 2.01 are 0.01 walking, 1 serving, 1 unloading\n" in shown


def test_a_slow_carrier_makes_no_linked_start_too_late(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """t2 is there at 1.25, and t3 starts 6 later: nothing on the way there takes longer."""
    assert teamformer("plan", path_of("slow-carrier"), "--method", "plan") == 0
    shown = capsys.readouterr().out
    assert "why so late: 7.25 are 1.25 carrying, 6 between linked starts\n" in shown


def test_an_error_shows_no_letter_that_cannot_be_printed(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert teamformer("plan", path_of("road-table-tab")) == 2
    told = capsys.readouterr().err
    assert "line 3: this row is of 'p?1', but column 2 is of 'p1'" in told
    assert all(letter.isprintable() or letter == "\n" for letter in told)


def test_who_stands_where_a_task_is_believed_waits_there_though_it_is_never_found(
    tmp_path: Path,
) -> None:
    folder = tf.run(tf.load(path_of("called-off-unfound"))).save(tmp_path)
    assert teamformer("export", str(folder / "record.json"), str(folder)) == 0
    rows = (folder / "gantt.csv").read_text().split()
    assert rows[1:] == ["r1,waiting,t1,0,1", "r2,idle,,0,1"]


def test_a_robot_of_the_longest_name_may_be_asked_for(tmp_path: Path) -> None:
    folder = tf.run(tf.load(path_of("with-a-long-name"))).save(tmp_path)
    assert teamformer("check", str(folder / "record.json")) == 0
    (name,) = set(tf.load(path_of("with-a-long-name")).capabilities) - {"n0"}
    assert name == f"robot 2, {'a' * 150}"


def test_a_long_capability_that_stands_twice_is_named_once(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert teamformer("run", path_of("long-capability-twice")) == 2
    told = capsys.readouterr().err
    assert "stands twice in this list; to mean two write {aaa" in told
    assert max(map(len, told.splitlines())) < 400


@pytest.mark.thorough
def test_the_search_ends_though_a_task_takes_longer_than_anything() -> None:
    """What came after it was taken to begin before it ends, so that a graph of arcs had a circle.

    n1, n2 and n4 form a team in two steps, walk to the other two tasks and do both at once.
    """
    end = tf.run(tf.load(path_of("far-and-farther")), seed=26).record.end
    assert (end.status, end.steps) == ("step limit", 7)
    assert end.tasks_done == 2


def test_what_came_after_a_task_that_is_called_off_comes_after_nothing(tmp_path: Path) -> None:
    """The second task is called off in step 1, so the third need not wait for the first."""
    assert teamformer("run", path_of("after-called-off"), "--out", str(tmp_path)) == 0
    assert teamformer("check", str(tmp_path / "record.json")) == 0
