"""`teamformer fleet rehearse`: the fleet's own agents under many random schedules of faults."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from statistics import fmean
from typing import Any

from teamformer.base.errors import TeamformerError
from teamformer.cli.terminal.console import (
    Counting,
    out,
    prepare_folder,
    print_json,
    processors,
    say,
)
from teamformer.cli.terminal.foxglove import check_foxglove, play_in_foxglove
from teamformer.cli.terminal.interruption import Interruption
from teamformer.cli.terminal.recorded import write_and_say
from teamformer.cli.verbs.robots.mesh import check_method, read_fleet_mission
from teamformer.mission.checks.rules import rules_of_rehearsals

MOST_SHOWN = 10
"""Failing schedules that are told one by one."""


@dataclass(frozen=True)
class RehearseOptions:
    """What the command line says."""

    schedules: int
    seed: int
    schedule: int | None
    folder: Path | None
    method: str = "plan"
    foxglove: int | None = None


def rehearse(path: Path, options: RehearseOptions, as_json: bool) -> int:
    """Rehearse, judge and sum up; return 0 if every promise was kept and nothing blocked."""
    mission = read_fleet_mission(path, refuse=rules_of_rehearsals)
    from teamformer.fleet.rehearsal.rehearse import set_stage

    if options.folder is not None:
        if options.schedule is None:
            raise TeamformerError("--out is for one schedule", "say which with --schedule K")
        prepare_folder(options.folder)
    if options.foxglove is not None:
        if options.schedule is None:
            raise TeamformerError("--foxglove is for one schedule", "say which with --schedule K")
        check_foxglove(options.foxglove)
    check_method(options.method, mission)
    stage = set_stage(mission, options.method)
    if stage.undisturbed.status == "blocked":
        names = ", ".join(stage.undisturbed.blocked_tasks)
        raise TeamformerError(f"undisturbed, the fleet never does {names}", "report this mission")
    if options.schedule is not None:
        return _play_again(stage, options, options.schedule, as_json)
    return _play_many(stage, options, as_json)


def _play_many(stage: Any, options: RehearseOptions, as_json: bool) -> int:
    from teamformer.fleet.rehearsal.rehearse import ScheduleVerdict, judge_many

    verdicts: list[ScheduleVerdict] = []
    with Interruption(), Counting("schedules") as progress:
        schedules = range(options.schedules)
        for verdict in judge_many(stage, options.seed, schedules, processors()):
            verdicts.append(verdict)
            progress.update(len(verdicts), options.schedules)
    bad = [verdict for verdict in verdicts if not verdict.is_good]
    row = _summary(stage, verdicts)
    if as_json:
        print_json(row)
    else:
        _show(row, bad, options)
    if bad:
        _shrink(stage, options, bad[0].schedule)
    return 1 if bad else 0


def _summary(stage: Any, verdicts: list[Any]) -> dict[str, Any]:
    """Return what `--json` prints of many schedules."""
    outcomes = [verdict.outcome for verdict in verdicts]
    spans = [outcome.makespan for outcome in outcomes if outcome.status == "ended"]
    seconds = sum(outcome.robot_seconds for outcome in outcomes)
    counts = Counter(outcome.status for outcome in outcomes)
    kinds = Counter(kind for verdict in verdicts for kind in verdict.kinds)
    return {
        "schedules": len(verdicts),
        "ended": counts["ended"],
        "infeasible": counts["infeasible"],
        "too_late": counts["too late"],
        "blocked": counts["blocked"],
        "violations": [
            {"schedule": verdict.schedule, "message": message}
            for verdict in verdicts
            for message in verdict.violations
        ],
        "makespan_mean": round(fmean(spans), 3) if spans else None,
        "undisturbed": round(stage.undisturbed.makespan or stage.undisturbed.end, 3),
        "messages_per_robot_second": round(sum(o.messages for o in outcomes) / seconds, 3),
        "bytes_per_robot_second": round(sum(o.bytes for o in outcomes) / seconds, 1),
        "plans_mean": round(fmean(outcome.plans for outcome in outcomes), 3),
        "messages_refused": sum(outcome.dropped for outcome in outcomes),
        "faults": dict(sorted(kinds.items())),
    }


def _show(row: dict[str, Any], bad: list[Any], options: RehearseOptions) -> None:
    for verdict in bad[:MOST_SHOWN]:
        status = verdict.outcome.status
        out.print(f"schedule {verdict.schedule}: {status}", style="red")
        for message in verdict.violations[:MOST_SHOWN]:
            out.print(f"  {message}", markup=False)
    late = f"{row['too_late']} were too late, " if row["too_late"] else ""
    out.print(
        f"{row['schedules']} schedules, seed {options.seed}: {row['ended']} ended, "
        f"{row['infeasible']} could not (they lost robots that tasks need), "
        f"{late}{row['blocked']} blocked; {len(row['violations'])} promises broken",
        style="red" if bad else "green",
    )
    mean = row["makespan_mean"]
    out.print(
        f"makespan {'none' if mean is None else f'{mean:.1f} s'} on average, undisturbed "
        f"{row['undisturbed']:.1f} s; {row['plans_mean']:.1f} new plans a mission"
    )
    out.print(
        f"each robot sent {row['messages_per_robot_second']:.1f} messages, "
        f"{row['bytes_per_robot_second']:.0f} bytes a second; "
        f"{row['messages_refused']} messages refused"
    )
    faults = ", ".join(f"{kind} {count}" for kind, count in row["faults"].items())
    out.print(f"schedules with each fault: {faults}", markup=False)


def _play_again(stage: Any, options: RehearseOptions, schedule: int, as_json: bool) -> int:
    """Play one schedule again, and write its record and page where asked."""
    from teamformer.fleet.rehearsal.checking.trace import Trace
    from teamformer.fleet.rehearsal.records.of_rehearsal import record_of
    from teamformer.fleet.rehearsal.rehearse import faults_of, play

    faults = faults_of(stage, options.seed, schedule)
    is_recorded = options.folder is not None or options.foxglove is not None
    trace = Trace(with_messages=is_recorded)
    rehearsal, outcome, violations = play(stage.mission, stage.plan, faults, trace, stage.method)
    record = record_of(rehearsal, outcome, trace.events, options.seed) if is_recorded else None
    if options.folder is not None and record is not None:
        write_and_say(record, options.folder)
    if as_json:
        row = {"schedule": schedule, "faults": list(faults.kinds), "violations": violations}
        print_json({**row, **vars(outcome)})
    else:
        for line in faults.lines(stage.mission):
            out.print(line, markup=False)
        for message in violations:
            out.print(message, markup=False, style="red")
        last = "nothing was done"
        if outcome.makespan is not None:
            last = f"the last of {outcome.tasks_done} tasks done after {outcome.makespan:.2f} s"
        out.print(f"schedule {schedule}: {outcome.status}; {last}", markup=False)
    if options.foxglove is not None and record is not None:
        play_in_foxglove(record, options.foxglove)
    return 1 if violations or outcome.status == "blocked" else 0


def _shrink(stage: Any, options: RehearseOptions, schedule: int) -> None:
    """Tell the smallest schedule that still fails."""
    from teamformer.fleet.rehearsal.rehearse import fails, faults_of
    from teamformer.fleet.rehearsal.shrink import shrink

    say(f"looking for a smaller one than schedule {schedule} ...")
    faults = faults_of(stage, options.seed, schedule)
    fails_so = partial(fails, method=stage.method)
    mission, faults = shrink(stage.mission, faults, fails_so)
    names = ", ".join(task.name for task in mission.tasks)
    say(f"the smallest that fails has the tasks {names} and these faults:")
    for line in faults.lines(mission):
        say(f"  {line}")
