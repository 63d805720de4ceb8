"""The benchmark on real small runs: every trial once, alike wherever and however it is run."""

from __future__ import annotations

import itertools
import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from hand_rows import rows_of
from teamformer.base.errors import TeamformerError
from teamformer.bench.executors import Batches, run_here, run_in_processes
from teamformer.bench.jobs import Job, known_row, list_schedule, run_job
from teamformer.bench.report.tables import summary_table
from teamformer.bench.rows import LATER, Key, Row, row_of
from teamformer.bench.runner import TIMED, Request, fits, fitting_cells, own_stamp, run_benchmark
from teamformer.bench.store import Store
from teamformer.bench.suites import Suite, cells, load_suite
from teamformer.bench.summary import summarise
from teamformer.files.drawn.named_settings import world_of
from teamformer.methods.by_name import Method, load_method
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.methods.scripted.joining import JoinAll
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.planning.bounds.makespan import lower_bound
from teamformer.record.task_times import cost_of_record
from teamformer.trials.trial import run_trial

SMALL = Suite(
    "small",
    "two settings, two methods",
    settings=("4N4T-C4", "3N2T-C2"),
    methods=("heuristic", "join-all"),
)


def measured(
    folder: Path,
    request: Request,
    engine: Callable[[Sequence[Job], int], Batches] = run_here,
    say: Callable[[str], None] = print,
) -> dict[Key, Row]:
    with Store(folder, request.about, say) as store:
        run_benchmark(request, store, engine, say)
        return dict(store.rows)


def outcome(row: Row) -> Row:
    """A row without what clocks said."""
    return replace(row, decision_seconds=0, decision_cpu_seconds=0, total_seconds=0)


def test_every_setting_meets_every_policy_on_every_seed(tmp_path: Path) -> None:
    rows = measured(tmp_path, Request(SMALL, trials=3, first_seed=10))
    wanted = itertools.product(SMALL.settings, SMALL.methods, (10, 11, 12))
    assert list(rows) == list(wanted)
    assert {row.suite for row in rows.values()} == {"small"}


def test_missions_with_a_cost_are_told_by_it(tmp_path: Path) -> None:
    """The cost of a row is that of its record; the table has it beside the makespan."""
    suite = replace(load_suite("missions"), settings=("deadlines",), methods=("plan", "heuristic"))
    rows = measured(tmp_path, Request(suite, trials=2))
    for (_, method, seed), row in rows.items():
        record = run_trial(world_of("deadlines", seed), load_method(method), seed=seed).record
        assert row.cost == pytest.approx(cost_of_record(record), abs=1e-6)
    mean = sum(rows["deadlines", "plan", seed].cost or 0 for seed in (0, 1)) / 2
    table = summary_table(summarise(rows.values()))
    assert "| makespan | cost |" in table
    assert f"| {mean:.1f} ± " in table
    assert "cost" not in summary_table(summarise(rows_of("4N4T-C4", "plan", [20, 21])))


def test_missions_in_continuous_time_are_told_in_their_unit(tmp_path: Path) -> None:
    """Rows are what a run tells; a method that counts in steps is left out, and why is said."""
    suite, said = load_suite("clock"), list[str]()
    request = Request(suite, 2, methods=("plan", "soonest", "heuristic"), settings=("clock-lost",))
    rows = measured(tmp_path, request, say=said.append)
    assert {method for _, method, _ in rows} == {"plan", "soonest"}
    assert any("decides step by step" in line for line in said)
    for (_, method, seed), row in rows.items():
        end = run_trial(world_of("clock-lost", seed), load_method(method), seed).record.end
        assert (row.makespan, row.cost, row.tasks_done) == (end.makespan, end.cost, end.tasks_done)
        assert row_of(row.to_line()) == row
        assert row.makespan is not None
        assert row.lower_bound is not None
        assert 0 < row.lower_bound <= row.makespan
        assert row.decisions is not None
        assert row.decisions > 1  # after the loss, too


def test_rows_of_older_versions_are_read() -> None:
    job = Job("hand", "4N4T-C4", "plan", (), 1.0, "abc")
    row = known_row(job, 0, world_of("4N4T-C4", 0), 20)
    tree = {key: value for key, value in vars(row).items() if key not in LATER}
    assert row_of(json.dumps(tree)) == replace(row, version="", cost=None, missed=None)
    assert row_of(json.dumps(tree | {"colour": "red"})) is None


def test_a_row_says_what_the_trial_alone_says(tmp_path: Path) -> None:
    rows = measured(tmp_path, Request(SMALL, trials=2))
    row = rows["4N4T-C4", "join-all", 1]
    mission = world_of("4N4T-C4", 1)
    end = run_trial(mission, JoinAll(), seed=1).record.end
    assert (row.makespan, row.steps, row.joins) == (end.makespan, end.steps, end.joins)
    assert (row.tasks_done, row.tasks, row.robots, row.capabilities) == (4, 4, 4, 4)
    assert row.lower_bound == lower_bound(mission)
    others = [rows["4N4T-C4", policy, 1].makespan or 0 for policy in SMALL.methods]
    assert row.best_known == min(others)
    assert row.decision_seconds is not None
    assert 0 < row.decision_seconds < (row.total_seconds or 0)
    assert row.rerun == (
        "teamformer bench small --settings 4N4T-C4 --methods join-all --seed 1 --trials 1 --json"
    )


def test_a_row_of_a_mission_with_a_cost_has_it() -> None:
    row = run_job(Job("hand", "deadlines-arrivals", "heuristic", (0, 1), 1.0, "abc"))[1]
    alone = run_trial(world_of("deadlines-arrivals", 1), load_method("heuristic"), 1)
    assert row.cost == cost_of_record(alone.record) is not None
    assert row.cost > 0


def test_going_on_runs_only_what_is_missing(tmp_path: Path) -> None:
    before = measured(tmp_path, Request(SMALL, trials=2, methods=("join-all",)))
    asked: list[Job] = []

    def watching(jobs: Sequence[Job], workers: int) -> Batches:
        asked.extend(jobs)
        yield from run_here(jobs)

    said: list[str] = []
    rows = measured(tmp_path, Request(SMALL, trials=3), watching, said.append)
    assert len(rows) == 2 * 2 * 3
    run = [(job.setting, job.method, seed) for job in asked for seed in job.seeds]
    assert sorted([*run, *before]) == sorted(rows)
    assert "4 of 12 trials are there already" in said
    kept = {key: rows[key].total_seconds for key in before}
    assert kept == {key: row.total_seconds for key, row in before.items()}


def test_an_interrupted_benchmark_ends_like_any_other(tmp_path: Path) -> None:
    def breaking(jobs: Sequence[Job], workers: int) -> Batches:
        yield from itertools.islice(run_here(jobs), 2)
        raise KeyboardInterrupt

    request = Request(SMALL, trials=7)
    (tmp_path / "whole").mkdir()
    (tmp_path / "parts").mkdir()
    with pytest.raises(KeyboardInterrupt):
        measured(tmp_path / "parts", request, breaking)
    assert (tmp_path / "parts" / "rows.jsonl").read_text().count("\n") == 7  # jobs of 5 and 2
    parts = measured(tmp_path / "parts", request)
    whole = measured(tmp_path / "whole", request)
    assert list(map(outcome, parts.values())) == list(map(outcome, whole.values()))


def test_processes_give_the_same_rows(tmp_path: Path) -> None:
    request = Request(SMALL, trials=6, workers=2)
    (tmp_path / "here").mkdir()
    (tmp_path / "there").mkdir()
    here = measured(tmp_path / "here", request, run_here)
    there = measured(tmp_path / "there", request, run_in_processes)
    assert list(map(outcome, here.values())) == list(map(outcome, there.values()))


@pytest.mark.parametrize("policy", ["heuristic", "join-all", "teamformer"])
def test_side_by_side_or_alone_a_trial_is_the_same(policy: str) -> None:
    job = Job("small", "8N9T-C4", policy, tuple(range(12)), 1.0, "code")
    alone, together = run_job(job), run_job(replace(job, is_timed=False))
    assert {row.side_by_side for row in alone} == {1}
    assert {row.side_by_side for row in together} == {12}
    assert [replace(outcome(row), side_by_side=0) for row in alone] == [
        replace(outcome(row), side_by_side=0) for row in together
    ]


def test_what_deciding_took_is_shared_out_whole() -> None:
    job = Job("small", "8N9T-C4", "join-all", tuple(range(5)), 1.0, "code", is_timed=False)
    rows = run_job(job)
    deciding = sum(row.decision_seconds or 0 for row in rows)
    assert 0 < deciding < sum(row.total_seconds or 0 for row in rows)
    assert all((row.decisions or 0) >= (row.steps or 0) for row in rows)  # a team a step at least


def test_only_the_first_trials_are_timed(tmp_path: Path) -> None:
    request = Request(SMALL, trials=TIMED + 3, settings=("3N2T-C2",), methods=("join-all",))
    rows = measured(tmp_path, request)
    assert [row.side_by_side for row in rows.values()] == [1] * TIMED + [3] * 3


def test_a_policy_of_one_s_own_runs_alone(tmp_path: Path) -> None:
    mine = "teamformer.methods.scripted.joining:JoinAll"
    request = Request(SMALL, trials=2, settings=("3N2T-C2",), methods=(mine,))
    rows = measured(tmp_path, request)
    assert {row.side_by_side for row in rows.values()} == {1}
    assert [row.completed for row in rows.values()] == [True, True]


def test_what_does_not_fit_is_said_and_left_out(tmp_path: Path) -> None:
    suite = replace(SMALL, settings=("4N4T-C4", "8N4T-C8"), methods=("gnn-c4", "join-all"))
    said: list[str] = []
    rows = measured(tmp_path, Request(suite, trials=1), say=said.append)
    assert {policy for _, policy, _ in rows} >= {"join-all"}
    assert ("8N4T-C8", "gnn-c4") not in {(setting, policy) for setting, policy, _ in rows}
    assert any(line.startswith("gnn-c4: ") and line.endswith("skipped") for line in said)


def test_all_that_a_shipped_suite_has_is_run_without_the_deadlock_guard_too() -> None:
    said: list[str] = []
    suite = load_suite("taught")
    assert ("8N20T-C8", "gnn-c8-ppo-bare") in cells(suite)
    assert list(fitting_cells(Request(suite, trials=1), said.append)) == list(cells(suite))
    assert said == []


def test_fitting_goes_by_the_name() -> None:
    assert fits("gnn-c4", "4N4T-C4")
    assert fits("teamformer-c100", "4N4T-C4")
    assert not fits("teamformer-c4", "8N20T-C8")
    assert not fits("teamformer-c8-full", "100N20T-C100-R10")
    assert fits("gnn-c8-bare", "8N20T-C8")
    assert not fits("gnn-c4-bare", "8N20T-C8")
    assert fits("join-all", "100N20T-C100-R90")


def test_an_unknown_policy_ends_it_at_once(tmp_path: Path) -> None:
    with pytest.raises(TeamformerError, match="there is no method 'join-al'"):
        measured(tmp_path, Request(SMALL, trials=1, methods=("join-al",)))
    assert (tmp_path / "rows.jsonl").read_text() == ""


def test_a_planner_says_what_it_found(tmp_path: Path) -> None:
    request = Request(SMALL, trials=2, time_limit=1.0, settings=("3N2T-C2",), methods=("central",))
    for row in measured(tmp_path, request).values():
        assert row.time_limit == 1.0
        assert row.relaxed == row.relaxed_bound <= row.lower_bound  # proven
        assert (row.relaxed or 0) <= (row.makespan or 0)
        assert " --time-limit 1 " in row.rerun


def test_plans_made_in_more_time_are_not_mixed_with_others(tmp_path: Path) -> None:
    request = Request(SMALL, trials=1, time_limit=1.0, settings=("3N2T-C2",), methods=("central",))
    measured(tmp_path, request)
    others = replace(request, time_limit=2.0, methods=("join-all",))
    assert len(measured(tmp_path, others)) == 2  # nobody plans, so the limit is nobody's
    with pytest.raises(TeamformerError, match="central had 1 s here, not 2 s"):
        measured(tmp_path, replace(request, time_limit=2.0))


def test_the_list_schedule_of_two_tasks_in_a_row() -> None:
    """Robot at 0, tasks at 2 and 5: done in steps 2 and 5, whatever forming costs."""
    mission = Mission(
        "row",
        Grid(9, 1),
        ("a",),
        (Robot("r", (0, 0), {"a": 1}),),
        (Task("far", (5, 0), {"a": 1}), Task("near", (2, 0), {"a": 1})),
    )
    assert list_schedule(mission) == 5
    late = replace(mission, tasks=(mission.tasks[0], replace(mission.tasks[1], appears=3)))
    assert list_schedule(late) is None


OWN = """
from teamformer.methods.scripted.joining import JoinAll


class Mine(JoinAll):
    pace = {pace}
"""


def test_trials_of_a_policy_whose_code_has_changed_are_run_again(own_folder: Path) -> None:
    """Only its own: rows of the policies that are listed stay."""
    suite = replace(SMALL, settings=("3N2T-C2",), methods=("join-all", "my_changing:Mine"))
    told: list[str] = []
    ran: list[str] = []

    def engine(jobs: Sequence[Job], workers: int) -> Batches:
        ran.extend(f"{job.method} {len(job.seeds)}" for job in jobs)
        return run_here(jobs, workers)

    for pace, expected in (
        (1, ["join-all 2", "my_changing:Mine 1", "my_changing:Mine 1"]),
        (1, []),
        (2, ["my_changing:Mine 1", "my_changing:Mine 1"]),
    ):
        (own_folder / "my_changing.py").write_text(OWN.format(pace=pace))
        own_stamp.cache_clear()
        ran.clear()
        request = Request(suite, trials=2, methods=suite.methods)
        rows = measured(own_folder, request, engine, told.append)
        assert sorted(ran) == expected
        assert len(rows) == 4
    assert "my_changing:Mine has changed since; its 2 trials are run again" in told
    stamps = {row.method: row.code for row in rows.values()}
    assert stamps["my_changing:Mine"].startswith(f"{stamps['join-all']}+")


def test_each_method_of_a_suite_plays_by_its_own_coordination(tmp_path: Path) -> None:
    suite = replace(SMALL, settings=("4N9T-C4",), methods=("heuristic", "crews", "plan"))
    rows = measured(tmp_path, Request(suite, trials=2))
    for setting, method, seed in rows:
        alone = run_trial(world_of(setting, seed), load_method(method), seed).record.end
        row = rows[setting, method, seed]
        assert (row.makespan, row.joins, row.splits) == (alone.makespan, alone.joins, alone.splits)


def test_what_a_suite_sets_of_a_method_counts(tmp_path: Path) -> None:
    suite = replace(
        SMALL,
        settings=("4N8T-C4-needs",),
        methods=("plan@needed", "plan@absent"),
        method_settings={name: {"foresight": name[5:]} for name in ("plan@needed", "plan@absent")},
    )
    rows = measured(tmp_path, Request(suite, trials=3))
    for foresight in ("needed", "absent"):
        for seed in range(3):
            method = Method("plan", coordinator=SharedPlan(scouts=False), foresight=foresight)
            alone = run_trial(world_of("4N8T-C4-needs", seed), method, seed).record.end
            assert rows["4N8T-C4-needs", f"plan@{foresight}", seed].makespan == alone.makespan


def test_late_tasks_are_inserted_as_the_setting_of_fig_9_says(tmp_path: Path) -> None:
    """The same worlds twice; inserting after the nearest takes another time than a new tour."""
    settings = ("4N20+20T-C4-tsp", "4N20+20T-C4-nn")
    suite = replace(SMALL, settings=settings, methods=("heuristic",))
    rows = measured(tmp_path, Request(suite, trials=4))
    tour, nearest = (
        [rows[setting, "heuristic", seed].makespan for seed in range(4)] for setting in settings
    )
    assert tour != nearest
