"""Instances of others, and what is published, as `bench others` reads and compares them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from home_care import HHCRSP
from orienteering import CHAO
from teamformer.base.errors import TeamformerError
from teamformer.bench.others.instances import read_instances
from teamformer.bench.others.one_robot_worlds import draw_world
from teamformer.bench.others.published import Reported, read_reported
from teamformer.bench.others.report import write_report
from teamformer.bench.others.results import (
    Result,
    anytime_curve,
    compare,
    measure,
    published_means,
    result_of,
)
from test_plan_command import TREE
from typed import teamformer


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    place = tmp_path / "ral"
    place.mkdir()
    for number in (2, 10):
        (place / f"env_{number}.json").write_text(json.dumps(TREE))
    (place / "reference.csv").write_text(
        "env,mine,yours,best_known\n2,12.5,13,12.5\n10,11,nan,11\n"
    )
    (place / "theirs.csv").write_text(",makespan,other\n2,14.25,1\n")
    return place


def result(
    instance: str, method: str, makespan: float, best: float | None, **more: object
) -> Result:
    row = {
        "collection": "ral",
        "instance": f"ral/{instance}",
        "method": method,
        "makespan": makespan,
        "bound": 0.0,
        "proven": False,
        "seconds": 2.0,
        "time_limit": 5.0,
        "curve": [],
        "published": {} if best is None else {"mine": best, "yours": best + 1},
    }
    return result_of(row | more)


def test_instances_come_with_what_tables_say(folder: Path) -> None:
    two, ten = read_instances([folder])
    assert (two.name, ten.name) == ("ral/env_2", "ral/env_10")
    assert two.published == {"mine": 12.5, "yours": 13.0, "theirs": 14.25}
    assert (two.best, ten.published, ten.best) == (12.5, {"mine": 11.0}, 11.0)


def test_prizes_that_are_missed_are_compared_with_the_best_published(tmp_path: Path) -> None:
    """Two paths of 10 collect 12 of 32; a table that says 15 makes that 20% less than the best."""
    (tmp_path / "p1.2.a.txt").write_text(CHAO)
    (tmp_path / "best.csv").write_text("instance,prize\np1.2.a,15\n")
    [instance] = read_instances([tmp_path])
    assert instance.best == 32 - 15
    measured = measure(instance, "plan", 0.0)
    assert measured is not None
    assert (measured.makespan, measured.prizes) == (20, 32)
    assert measured.percent_above_best == pytest.approx(20)


def test_instances_of_home_care_come_with_the_best_costs_published(tmp_path: Path) -> None:
    for name in ("kummer", "italian"):
        (tmp_path / name).mkdir()
    (tmp_path / "kummer" / "a.json").write_text(json.dumps(HHCRSP))
    (tmp_path / "italian" / "b.json").write_text(json.dumps(HHCRSP))
    head = "| instance | distance_traveled | total_cost | solution |\n|:--|--:|--:|:--|\n"
    (tmp_path / "kummer_best.md").write_text(f"{head}| a.json | 30 | 12.5 | sol-a |\n")
    (tmp_path / "italian" / "best.md").write_text(f"{head}| b.json | 30 | 10.333 | sol-b |\n")
    one, two = read_instances([tmp_path / "kummer", tmp_path / "italian"])
    assert (one.name, one.best) == ("kummer/a", 12.5)
    assert (two.name, two.best) == ("italian/b", 10.333)
    made = measure(one, "plan", 1.0)
    tour = 5 + 6 + 5  # c1 goes round by the shorter way, c2 there and back
    assert made.makespan == pytest.approx((tour + 10) / 3)


def test_published_means_are_of_methods_that_have_all_instances() -> None:
    one, two = result("env_2", "plan", 9.0, 8.0), result("env_3", "plan", 9.0, 11.0)
    assert published_means([one, two]) == {"mine": 9.5, "yours": 10.5}
    lone = result("env_3", "plan", 9.0, None, published={"yours": 20.0})
    assert published_means([one, lone]) == {"yours": 14.5}


def test_wins_ties_and_losses_are_against_the_best_published() -> None:
    results = [
        result("env_1", "central", 11.0, 12.0, bound=11.0, proven=True, seconds=1.0),
        result("env_2", "central", 12.0005, 12.0, bound=10.0),
        result("env_3", "central", 13.0, 12.0, bound=11.0),
        result("env_4", "central", 14.0, None, bound=13.0),
        result("env_1", "plan", 11.0, 12.0),
    ]
    told = compare(results, "central")
    assert (told.instances, told.wins, told.ties, told.losses) == (4, 1, 1, 1)
    assert told.makespan == pytest.approx(12.500125)
    assert (told.bound, told.proven, told.seconds) == (11.25, 1, 1.75)
    above = (11 / 12, 12.0005 / 12, 13 / 12)
    assert told.percent_above_best == pytest.approx(100 * (sum(above) / 3 - 1))
    assert told.gap == pytest.approx(100 * (12.500125 / 11.25 - 1))
    shared = compare(results, "plan")
    assert (shared.bound, shared.gap, shared.proven) == (0.0, 0.0, 1)  # proven by central


def test_the_curve_is_the_mean_of_the_best_so_far() -> None:
    one = result("env_1", "central", 12.0, None, curve=[[0.4, 13.0], [3.0, 12.0]])
    two = result("env_2", "central", 11.5, None, curve=[[0.2, 11.5]])
    assert anytime_curve([one, two]) == [(0.5, 12.25), (1.0, 12.25), (2.0, 12.25), (5.0, 11.75)]
    late = result("env_3", "central", 10.0, None, curve=[[1.5, 10.0]])
    assert anytime_curve([one, late])[0] == (2.0, 11.5)
    assert anytime_curve([result("env_1", "plan", 9.0, None)]) == []


def test_the_report_keeps_collections_apart() -> None:
    other = result("env_1", "plan", 30.0, None, collection="dcmrta")
    report = write_report([result("env_1", "plan", 9.0, 8.0), other], {})
    assert "| plan | 1 | 9.000 | 12.5% |" in report
    assert "| plan | 1 | 30.000 |  |" in report
    assert report.index("## ral") < report.index("## dcmrta")
    assert "| env_1 | 8.000 |  | 9.000 |" in report


def test_the_command_writes_rows_and_goes_on(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    words = (str(folder), "--methods", "plan,reactive", "--out", str(out), "--json")
    assert teamformer("bench", "others", *words) == 0
    rows = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [(row["instance"], row["method"]) for row in rows] == [
        ("ral/env_2", "plan"), ("ral/env_2", "reactive"),
        ("ral/env_10", "plan"), ("ral/env_10", "reactive"),
    ]  # fmt: skip
    assert rows[0]["makespan"] == rows[2]["makespan"] > 0
    kept = (out / "rows.jsonl").read_text()
    assert [json.loads(line) for line in kept.splitlines()] == rows
    assert "| env_10 | 11.000 |" in (out / "report.md").read_text()

    (out / "rows.jsonl").write_text("".join(kept.splitlines(keepends=True)[:3]))
    assert teamformer("bench", "others", *words) == 0
    again = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert again[:3] == rows[:3]  # seconds too: these were not measured again
    assert [row["makespan"] for row in again] == [row["makespan"] for row in rows]

    (out / "rows.jsonl").write_text('{"instance": "ral/env_2"}\n')
    assert teamformer("bench", "others", *words) == 2
    assert "rows.jsonl:1: this is no row of `bench others`" in capsys.readouterr().err


@pytest.fixture
def settings(tmp_path: Path) -> Path:
    """Return a folder of two folders, with what is known and reported of them beside these."""
    place = tmp_path / "tables"
    for name in ("small", "large"):
        (place / name).mkdir(parents=True)
        (place / name / "env_0.json").write_text(json.dumps(TREE))
    (place / "best_known.csv").write_text(
        "setting,env,makespan\nsmall,env_0,10\nlarge,env_0,12.5\n"
    )
    (place / "others.csv").write_text(
        "setting,method,cores,seconds,percent_above_best_known\n"
        "small,theirs,1,1,5.5\nlarge,theirs,1,1,7.5\n"
    )
    (place / "unrelated.csv").write_bytes(b"\xff\xfe")
    return place


def test_a_folder_of_folders_has_its_tables_beside_these(settings: Path) -> None:
    large, small = read_instances([settings])
    assert (large.name, large.published) == ("large/env_0", {"best published": 12.5})
    assert (small.name, small.published) == ("small/env_0", {"best published": 10.0})
    assert [one.best for one in read_instances([settings / "small"])] == [10.0]
    assert read_reported(settings / "large") == (Reported("theirs", 1.0, 1.0, 7.5),)


def test_what_others_report_must_be_a_number(settings: Path) -> None:
    with (settings / "others.csv").open("a") as file:
        file.write("small,theirs,1,2,few\n")
    assert len(read_reported(settings / "large")) == 1
    with pytest.raises(TeamformerError, match=r"others\.csv:4: the column 'percent_above_best"):
        read_reported(settings / "small")


def test_folders_are_compared_in_percent_above_the_best_known(
    settings: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    words = (str(settings), "--methods", "plan", "--out", str(out))
    assert teamformer("bench", "others", *words) == 0
    shown = capsys.readouterr().out
    rows = [json.loads(line) for line in (out / "rows.jsonl").read_text().splitlines()]
    reached = rows[0]["makespan"]
    above = [100 * (reached / best - 1) for best in (12.5, 10)]
    report = (out / "report.md").read_text()
    assert "| folder | plan | theirs, 1 x 1 s |" in report
    assert f"| large | {above[0]:.1f}% | 7.5% |" in report
    assert f"| small | {above[1]:.1f}% | 5.5% |" in report
    assert f"| mean | {sum(above) / 2:.1f}% | 6.5% |" in report
    assert "| theirs (reported) |  |  | 7.5% |" in report
    assert f"{sum(above) / 2:.1f}%" in shown
    assert all(row["processor_seconds"] > 0 for row in rows)


def test_worlds_whose_tasks_need_one_robot_are_drawn(
    capsys: pytest.CaptureFixture[str],
) -> None:
    world = draw_world(4, 9, seed=1)
    assert draw_world(4, 9, seed=1) == world != draw_world(4, 9, seed=2)
    assert (len(world.robots), len(world.tasks)) == (4, 9)
    for task in world.tasks:
        assert sum(task.needs.values()) == 1
        assert any(robot.can.keys() >= task.needs.keys() for robot in world.robots)
    words = ("--settings", "one-robot-2-3", "--methods", "plan,auction", "--time-limit", "0.1")
    assert teamformer("bench", "others", *words, "--trials", "1", "--seed", "5", "--json") == 0
    rows = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [row["instance"] for row in rows] == ["one-robot-2-3/env_5"] * 2
    assert 0 < rows[0]["makespan"] <= rows[1]["makespan"]
    assert teamformer("bench", "others", "--settings", "two-robots") == 2
    assert "write one-robot-ROBOTS-TASKS" in capsys.readouterr().err


def test_nothing_to_measure_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(TeamformerError, match="there is no instance to measure"):
        read_instances([tmp_path])
    assert teamformer("bench", "others") == 2
    assert "bench others FOLDER" in capsys.readouterr().err
    assert teamformer("bench", "others", str(tmp_path / "no")) == 2
    assert "this is no folder" in capsys.readouterr().err
    assert teamformer("bench", "others", "--methods", "best") == 2
    assert "--methods best is unknown here" in capsys.readouterr().err


def test_broken_tables_and_folders_of_one_name_are_told(folder: Path, tmp_path: Path) -> None:
    (folder / "theirs.csv").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(TeamformerError, match=r"theirs\.csv: this is no table of commas"):
        read_instances([folder])
    with pytest.raises(TeamformerError, match="two of the folders have one name"):
        read_instances([folder, tmp_path / "other" / "ral"])


def test_gaps_of_sadcher_stand_beside_ours(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Its files are numbered, and what is published is how far policies are above the optimum.

    One robot at 0 with both tasks on its way to 9: the optimum is 9 + 2 + 3 = 14.
    """
    folder = tmp_path / "sadcher"
    folder.mkdir()
    tree = {"Q": [[1]], "R": [[1], [1]], "T_e": [2, 3], "prec": []}
    tree["loc"] = [[0, 0], [3, 0], [6, 0], [9, 0]]
    (folder / "p_000001.json").write_text(json.dumps(tree))
    assert teamformer("bench", "others", str(folder), "--methods", "central,soonest") == 0
    told = " ".join(capsys.readouterr().out.split())
    assert "SADCHER, greedy (reported) 6.8%" in told
    assert "SADCHER, sampled (reported) 3.8%" in told
    assert "central 1 14.000 14.000 0.0% 1" in told
    assert "soonest 1 14.000" in told
