"""Summaries, savings and verdicts from rows made by hand."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Sequence
from dataclasses import replace

import pytest

from hand_rows import rows_of
from teamformer.bench.report.claim_checks import (
    ANY_FLEET,
    TABLE_1,
    as_quick,
    faster_than,
    method_for,
    near_optimum,
    no_failure,
    saves,
    slowest,
    some_failures,
    splits_fall,
    trend,
)
from teamformer.bench.report.claims import FAILURES, INFERENCE, claims
from teamformer.bench.report.evidence import Evidence
from teamformer.bench.report.tables import cells_of, summary_csv, summary_table
from teamformer.bench.rows import Row, row_of
from teamformer.bench.summary import on_shared_worlds, summarise

SMALL = "4N4T-C4"


def test_means_with_and_without_failures() -> None:
    [summary] = summarise(rows_of(SMALL, "gnn-c4", [10, 20, None, 30]))
    assert (summary.trials, summary.failures) == (4, 1)
    assert summary.makespan.value == 20.0
    assert summary.makespan.error == pytest.approx(10 / math.sqrt(3))
    assert summary.steps.value == 40.0  # (10 + 20 + 100 + 30) / 4


def test_differences_are_paired_over_worlds_that_both_completed() -> None:
    rows = [
        *rows_of(SMALL, "heuristic", [30, 40, 50, None, 70]),
        *rows_of(SMALL, "gnn-c4", [28, 36, None, 10, 64]),
    ]
    difference = summarise(rows)[1].against["heuristic"]
    assert difference.count == 3  # worlds 0, 1 and 4: -2, -4, -6
    assert difference.value == -4.0
    assert difference.half_width == pytest.approx(4.303 * 2 / math.sqrt(3), abs=1e-3)
    assert "heuristic" not in summarise(rows)[0].against


def test_the_room_won_is_what_is_gained_of_what_the_truth_is_worth() -> None:
    """Rooms of 10, 20, 30 steps, 20 on average; won are 0, 10 and 15, a half of it less a bit."""
    rows = [
        *rows_of(SMALL, "central", [40, 40, 40, 40]),
        *rows_of(SMALL, "plan@needed", [50, 60, 70, None]),
        *rows_of(SMALL, "plan@absent", [50, 50, 55, 41]),
        *rows_of(SMALL, "heuristic", [70, 80, 90, 90]),
    ]
    rooms = {summary.method: summary.room for summary in summarise(rows)}
    assert rooms["plan@absent"].count == 3
    assert rooms["plan@absent"].value == pytest.approx((0 + 10 + 15) / 60)
    deviation = math.sqrt((25**2 + 5**2 + 20**2) / 9 / 2) / 20  # of 0, 10, 15 around 25 / 3
    half_width = 4.303 * deviation / math.sqrt(3)
    assert rooms["plan@absent"].half_width == pytest.approx(half_width, abs=1e-3)
    assert rooms["central"].value == pytest.approx(1)
    assert rooms["plan@needed"].value == 0
    assert rooms["heuristic"].value == pytest.approx(-1)
    assert "+41.7%" in summary_table(summarise(rows))
    assert summarise(rows[:8])[0].room.count == 3
    assert summarise(rows[:4])[0].room.count == 0


def test_what_the_planner_is_ahead_is_a_part_of_its_mean() -> None:
    rows = [
        *rows_of(SMALL, "central", [10, 20, 30, 90]),
        *rows_of(SMALL, "plan", [12, 20, 34, None]),
    ]
    ours = summarise(rows)[1].to_central
    assert ours.count == 3
    assert ours.value == pytest.approx(0.1)  # 2, 0 and 4 steps of 20 on average
    assert ours.half_width == pytest.approx(4.303 * 0.1 / math.sqrt(3), abs=1e-4)
    table = summary_table(summarise(rows))
    assert "| to central |" in table
    assert "+10.0% (-14.8 to +34.8)" in table


def test_costs_stand_beside_makespans_where_missions_have_them() -> None:
    """Costs of 5, 7 and 6 by central, 6, 7 and 9 by the plan, which fails in the last world."""
    rows = [
        *rows_of("deadlines", "central", [10, 20, 30, 90]),
        *rows_of("deadlines", "plan", [12, 20, 34, None]),
    ]
    costs = (5.0, 7.0, 6.0, 80.0, 6.0, 7.0, 9.0, None)
    rows = [replace(row, cost=cost) for row, cost in zip(rows, costs, strict=True)]
    ours = summarise(rows)[1]
    assert ours.cost.value == pytest.approx(22 / 3)
    assert ours.cost_to_central.value == pytest.approx(4 / 18)
    table = summary_table(summarise(rows))
    assert "| makespan | cost | failures |" in table
    assert "| cost to central |" in table
    assert " 7.3 ± 0.9 " in table
    [_, line] = csv.DictReader(summary_csv(summarise(rows)).splitlines())
    assert (line["cost_mean"], line["cost_to_central"]) == ("7.333333", "0.222222")
    assert "cost" not in summary_table(summarise(rows_of(SMALL, "plan", [12])))


def test_what_is_missed_stands_beside_makespans_where_missions_have_an_end() -> None:
    """The plan misses 1, 3 and 8, the last in a trial in which a task that must be done was."""
    rows = [
        replace(row, missed=missed)
        for row, missed in zip(
            rows_of("optional", "plan", [12, 20, None]), (1.0, 3.0, 8.0), strict=True
        )
    ]
    [summary] = summarise(rows)
    assert (summary.missed.value, summary.missed.count) == (4.0, 3)
    assert "| makespan | missed | failures |" in summary_table([summary])
    [line] = csv.DictReader(summary_csv([summary]).splitlines())
    assert line["missed_mean"] == "4.0"
    assert "| missed |" not in summary_table(summarise(rows_of(SMALL, "plan", [12])))


def test_rows_of_earlier_versions_have_no_cost() -> None:
    [row] = rows_of(SMALL, "plan", [12])
    tree = json.loads(row.to_line())
    assert tree.pop("cost") is None
    assert row_of(json.dumps(tree)) == row


def test_gaps_are_means_of_ratios() -> None:
    rows = [
        replace(row, best_known=10, lower_bound=8, list_schedule=9)
        for row in rows_of(SMALL, "gnn-c4", [10, 15])
    ]
    [summary] = summarise(rows)
    assert summary.to_best.value == pytest.approx(0.25)
    assert summary.to_bound.value == pytest.approx((0.25 + 0.875) / 2)
    assert summary.to_list.value == pytest.approx(3.5)


def test_shared_worlds_are_those_of_all_policies_of_their_setting() -> None:
    few = rows_of(SMALL, "central", [10, None])  # a failure is a trial too
    many = rows_of(SMALL, "join-all", [12, 13, 14])
    elsewhere = rows_of("4N20T-C4", "join-all", [50])
    assert on_shared_worlds([*few, *many, *elsewhere]) == [*few, *many[:2], *elsewhere]


def test_gaps_to_the_best_are_over_planned_worlds() -> None:
    """World 1 was not planned: what is best there nobody knows."""
    rows = [
        *rows_of(SMALL, "join-all", [12, 50]),
        *(replace(row, relaxed=9) for row in rows_of(SMALL, "central", [10])),
    ]
    summaries = summarise([replace(row, best_known=10) for row in rows])
    assert [summary.to_best.count for summary in summaries] == [1, 1]
    assert summaries[0].to_best.value == pytest.approx(0.2)


def test_inference_is_of_trials_that_ran_alone() -> None:
    alone = replace(rows_of(SMALL, "gnn-c4", [10])[0], decision_cpu_seconds=2.0)
    shared = [
        replace(row, decision_cpu_seconds=0.1, side_by_side=2, world_seed=7 + row.world_seed)
        for row in rows_of(SMALL, "gnn-c4", [10, 10])
    ]
    [summary] = summarise([alone, *shared])
    assert summary.inference.count == 1
    assert summary.inference.value == 2.0


def test_inference_is_what_completing_a_trial_takes() -> None:
    """The trial that waited until the step limit says nothing of that."""
    rows = rows_of(SMALL, "gnn-c4-ppo-bare", [10, 20, None])
    times = (1.0, 3.0, 90.0)
    rows = [replace(row, decision_cpu_seconds=time) for row, time in zip(rows, times, strict=True)]
    [summary] = summarise(rows)
    assert (summary.inference.value, summary.inference.count) == (2.0, 2)


def test_the_slowest_is_found_among_bare_methods() -> None:
    timed = {"teamformer-c4-ppo-bare": 3.0, "deepset-c4-ppo-bare": 1.0, "gnn-c4-ppo-bare": 2.0}
    rows = [
        replace(row, decision_cpu_seconds=time)
        for method, time in {**timed, "gnn-c4-ppo": 9.0}.items()
        for row in rows_of("4N20T-C4", method, [10])
    ]
    told = slowest(Evidence(rows), "teamformer")
    assert told.measured == "4N20T-C4: 1.5 times the slower one"
    assert told.holds is True


def test_tables_say_the_same() -> None:
    rows = [
        *rows_of(SMALL, "heuristic", [30, 40, 50]),
        *rows_of(SMALL, "gnn-c4", [28, 36, None]),
    ]
    summaries = summarise(rows)
    assert cells_of(summaries[1])[:7] == [
        SMALL,
        "gnn-c4",
        "3",
        "32.0 ± 4.0",
        "1 (6.1-79.2%)",
        "54.7",
        "-3.0 (-15.7 to +9.7)",
    ]
    table = summary_table(summaries).splitlines()
    assert table[3].startswith("| 4N4T-C4 | gnn-c4 | 3 | 32.0 ± 4.0 |")
    lines = list(csv.DictReader(summary_csv(summaries).splitlines()))
    assert [line["failures"] for line in lines] == ["0", "1"]
    assert lines[1]["heuristic_difference"] == "-3.0"
    assert lines[0]["inference_cpu_seconds_mean"] == ""


def test_a_saving_is_a_share_of_the_other_mean() -> None:
    rows = [
        *rows_of("4N20T-C4", "heuristic", [100, 80, 120, None]),
        *rows_of("4N20T-C4", "teamformer-c4-ppo-bare", [70, 60, 80, 50]),
    ]
    saving = Evidence(rows).saving("4N20T-C4", "teamformer-c4-ppo-bare", "heuristic")
    assert saving is not None
    assert saving.value == pytest.approx(0.3)  # (300 - 210) / 300
    assert saving.half_width == pytest.approx(4.303 * 10 / math.sqrt(3) / 100, abs=1e-4)
    told = saves("4N20T-C4", "heuristic", 0.32)(Evidence(rows), "teamformer")
    assert told.holds is True  # the interval reaches it
    assert told.measured.startswith("30% (5% to 55%)")
    assert saves("4N20T-C4", "heuristic", 0.6)(Evidence(rows), "teamformer").holds is False


def test_the_optimum_is_what_was_proven() -> None:
    planned = [
        replace(row, relaxed=value, relaxed_bound=bound)
        for row, (value, bound) in zip(
            rows_of(SMALL, "central", [12, 13, 14]), [(10, 10), (11, 9), (12, 12)], strict=True
        )
    ]
    evidence = Evidence([*planned, *rows_of(SMALL, "join-all", [11, 99, 14])])
    found = evidence.from_optimum(SMALL, "join-all")
    assert found is not None
    assert (found.value, found.count) == (1.5, 2)  # world 1 is not proven
    assert near_optimum(SMALL, 1.5)(evidence, "join-all").holds is True


def test_verdicts() -> None:
    evidence = Evidence(
        [
            *rows_of(SMALL, "teamformer-c4-ppo-bare", [20, 22]),
            *rows_of(SMALL, "teamformer-c4-bare", [90, None]),  # what a script taught is not judged
            *rows_of(SMALL, "gnn-c4-ppo-bare", [24, 26]),
            *rows_of(SMALL, "heuristic", [21, 20]),
        ]
    )
    assert faster_than(SMALL, ("gnn",))(evidence, "teamformer").holds is True
    beaten = faster_than(SMALL, ("gnn", "heuristic", "deepset"))(evidence, "teamformer")
    assert beaten.holds is False
    assert "(deepset not measured)" in beaten.measured
    assert faster_than(SMALL, ("deepset",))(evidence, "teamformer").holds is None
    assert no_failure(SMALL)(evidence, "teamformer").measured == "0 of 2 (0.0% to 65.8%)"
    assert no_failure(SMALL)(evidence, ANY_FLEET).holds is None
    assert as_quick(SMALL, 1.0)(evidence, "teamformer").holds is None  # nothing was timed


def test_faster_is_what_the_whole_interval_says() -> None:
    """The mean is below in both cases: by 2 (±1.3), and by 1 (±3.6)."""
    rows = [
        *rows_of(SMALL, "teamformer-c4-ppo-bare", [20, 20, 20, 20]),
        *rows_of(SMALL, "gnn-c4-ppo-bare", [21, 22, 22, 23]),
        *rows_of(SMALL, "heuristic", [18, 21, 21, 24]),
    ]
    told = faster_than(SMALL, ("gnn",))(Evidence(rows), "teamformer")
    assert told.measured.startswith("gnn -2.0 (-3.3 to -0.7)")
    assert told.holds is True
    told = faster_than(SMALL, ("heuristic",))(Evidence(rows), "teamformer")
    assert told.measured.startswith("heuristic -1.0 (-4.9 to +2.9)")
    assert told.holds is False


def test_failures_are_those_without_the_deadlock_guard() -> None:
    """Of the paper's network as of those that it is compared with."""
    crowd = "100N20T-C100-R10"
    rows = [
        *rows_of(crowd, "teamformer-c100-ppo", [10, 20]),
        *rows_of(crowd, "teamformer-c100-ppo-bare", [10, None]),
        *rows_of("8N20T-C8", "gnn-c8-ppo", [10, 20]),
        *rows_of("8N20T-C8", "gnn-c8-ppo-bare", [10, None]),
    ]
    told = no_failure(crowd)(Evidence(rows), "teamformer")
    assert (told.holds, told.measured) == (False, "1 of 2 (9.5% to 90.5%)")
    told = some_failures("8N20T-C8", "gnn")(Evidence(rows), "teamformer")
    assert (told.holds, told.measured) == (True, "1 of 2 (9.5% to 90.5%)")
    guarded = [row for row in rows if not row.method.endswith("-bare")]
    assert no_failure(crowd)(Evidence(guarded), "teamformer").holds is None
    assert some_failures("8N20T-C8", "gnn")(Evidence(guarded), "teamformer").holds is None


def by_requirements(method: str, values: Sequence[Sequence[int]]) -> list[Row]:
    """Trials with 10, 20, 50 and 90 requirements for each task."""
    return [
        row
        for setting, makespans in zip(TABLE_1[4:], values, strict=True)
        for row in rows_of(setting, method, makespans)
    ]


def test_trends_go_by_the_line_through_all_trials() -> None:
    """Requirements are 42.5 on average, so 3875 in squares, and the sum of products is -537.5."""
    rows = by_requirements("heuristic", [[104, 106], [119, 121], [109, 111], [99, 101]])
    falling = trend("heuristic", rises=False)(Evidence(rows), "teamformer")
    assert falling.measured.startswith("105.0, 120.0, 110.0, 100.0; -1.4 (")
    assert falling.holds is False  # the interval reaches above zero, though the last is the least
    steady = by_requirements("heuristic", [[100, 101], [104, 105], [115, 116], [130, 131]])
    rising = trend("heuristic", rises=True)(Evidence(steady), "teamformer")
    assert rising.measured.startswith("100.5, 104.5, 115.5, 130.5; +3.7 (")
    assert rising.holds is True
    assert trend("heuristic", rises=True)(Evidence(steady[:2]), "teamformer").holds is None


def test_the_same_splits_are_judged_alike() -> None:
    """Where no network splits, nothing falls: for neither of the two."""
    rows = [
        *by_requirements("teamformer-c100-ppo-bare", [[100, 101]] * 4),
        *by_requirements("teamformer-bare", [[100, 101]] * 4),
    ]
    told = [splits_fall(Evidence(rows), family) for family in ("teamformer", ANY_FLEET)]
    assert told[0] == told[1]
    assert told[0].holds is False
    assert told[0].measured.startswith(
        "0, 0, 0, 0 splits in 2, 2, 2, 2 trials; +0.0 (+0.0 to +0.0)"
    )
    splits = {10: 9, 20: 8, 50: 5, 90: 1}
    fewer = [
        replace(row, splits=splits[int(row.setting.partition("-R")[2])])
        for row in by_requirements("teamformer-bare", [[100, 101]] * 4)
    ]
    assert splits_fall(Evidence(fewer), ANY_FLEET).holds is True


def test_the_method_of_a_family_fits_the_setting() -> None:
    assert method_for("gnn", "24N100T-C8") == "gnn-c8-ppo-bare"
    assert method_for("gnn", "20N100T-C4") == "gnn-c4-ppo-bare"
    assert method_for("teamformer", "100N20T-C100-R20") == "teamformer-c100-ppo-bare"
    assert method_for(ANY_FLEET, "24N100T-C8") == "teamformer-bare"
    assert method_for("heuristic", "24N100T-C8") == "heuristic"


def test_every_claim_can_be_judged_of_nothing() -> None:
    known = list(claims())
    assert {claim.figure for claim in known} == {
        *("Fig. 3", "Fig. 4a", "Fig. 4b", "Fig. 5a", "Fig. 5b", "Fig. 6", "Fig. 9a", "Fig. 9b"),
        "Table I",
    }
    for claim in known:
        assert claim.judge(Evidence([]), "teamformer").holds is None


def test_the_paper_s_table_has_eight_columns_and_four_for_the_others() -> None:
    lengths = {name: len(times) for name, times in INFERENCE.items()}
    assert lengths == {"teamformer": 8, "heuristic": 8, "deepset": 4, "gnn": 4}
    assert FAILURES["deepset"] == (1, 1, 26, 12)
    assert FAILURES["gnn"] == (1, 3, 21, 42)
