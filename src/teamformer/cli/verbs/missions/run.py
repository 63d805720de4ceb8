"""`teamformer run`: one mission, one method, one trial."""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from rich.table import Table
from rich.text import Text

from teamformer.base.errors import ReaderGoneError, TeamformerError
from teamformer.base.naming import listed
from teamformer.cli.terminal.compiling import compile_ahead
from teamformer.cli.terminal.console import StepProgress, out, prepare_folder, print_json, say
from teamformer.cli.terminal.foxglove import check_foxglove, play_in_foxglove
from teamformer.cli.terminal.interruption import Interruption
from teamformer.cli.terminal.recorded import write_and_say
from teamformer.files.mission_files import read_mission
from teamformer.methods.by_name import Method, default_for, load_method
from teamformer.methods.central.plays import CentralPlan
from teamformer.methods.listings import DEFAULT
from teamformer.mission.checks.rules import rules_not_run
from teamformer.mission.model import Mission
from teamformer.mission.parts.capabilities import describe
from teamformer.mission.truth import draw_truth
from teamformer.record.critical_path.stretches import path_rows
from teamformer.record.critical_path.words import why_so_late
from teamformer.record.export.reasons import story_lines
from teamformer.record.happenings import events
from teamformer.record.record import Record
from teamformer.record.task_times import cancelled_steps, cost_of_record, lateness, missed_tasks
from teamformer.record.teams import completions
from teamformer.record.telling.whole import path_of_record
from teamformer.trials.memory import refuse_too_large
from teamformer.trials.rows import bars_of, result_row, seconds_of
from teamformer.trials.trial import PlayedTrial, bound_of, run_trial
from teamformer.world.continuous.events import WHY_MISSED
from teamformer.world.env import Tally

LONGEST_TABLE = 40  # tasks
MOST_NAMES = 12


def chosen_method(name: str | None, mission: Mission, time_limit: float) -> Method:
    """Return the method of a name; without one the plan, or crews for a mission too large for it.

    That it is crews is said. Raises `TeamformerError` for a name that is unknown, and for a mission
    that is too large for the memory.
    """
    if name is None:
        name = default_for(mission)
        if name != DEFAULT:
            size = f"{len(mission.robots)} robots and {len(mission.tasks)} tasks"
            say(f"{size} are too many for the method plan: {name} instead; or --method {DEFAULT}")
    method = load_method(name, time_limit)
    refuse_too_large(mission, method)
    return method


def run(
    path: Path,
    method_name: str | None,
    seed: int,
    time_limit: float,
    folder: Path | None,
    as_json: bool,
    explained: str | None = None,
    foxglove: int | None = None,
) -> int:
    """Run a trial, write its record and show what came of it; return the exit status.

    `explained` is the name of a robot whose story is told too. `foxglove` is a port on which the
    record is played for Foxglove in the end.
    """
    mission = read_mission(path, rules_not_run)
    robot = None if explained is None else _robot_number(mission, explained)
    method = chosen_method(method_name, mission, time_limit)
    if foxglove is not None:
        check_foxglove(foxglove)
    if folder is not None:
        prepare_folder(folder)
    compile_ahead([method], mission)
    with Interruption() as interruption:
        trial = watch_trial(mission, method, seed, interruption)
        interruption.hold()  # what was played is told and written first
        try:
            with suppress(ReaderGoneError):
                _tell(trial, robot, as_json)
        finally:
            if folder is not None:
                write_and_say(trial.record, folder)
    if foxglove is not None and trial.record.end.status != "interrupted":
        play_in_foxglove(trial.record, foxglove)
    return 0 if trial.record.end.status == "completed" else 1


def _tell(trial: PlayedTrial, robot: int | None, as_json: bool) -> None:
    """Print what came of a trial, and a robot's story if one is asked for."""
    story = [] if robot is None else list(story_lines(trial.record, robot))
    if as_json:
        row = result_row(trial, bars_of([trial]))
        chain = path_rows(trial.record.true_mission, path_of_record(trial.record))
        told = {"critical_path": chain} | ({} if robot is None else {"story": story})
        print_json(row | told)
    else:
        _show(trial)
        if robot is not None:
            out.print(_story_table(story, "times" if trial.record.is_continuous else "steps"))


def _robot_number(mission: Mission, name: str) -> int:
    """Return a robot's number; TeamformerError if there is none of this name."""
    names = [robot.name for robot in mission.robots]
    if name not in names:
        near = difflib.get_close_matches(name, names, 1)
        hint = f"did you mean '{near[0]}'?" if near else f"the first is {names[0]}"
        raise TeamformerError(f"there is no robot '{name}' to explain", hint)
    return names.index(name)


def _story_table(story: Sequence[tuple[str, str, str]], when: str) -> Table:
    table = Table(box=None, header_style="dim")
    for header in (when, "what it does", "why"):
        table.add_column(header, overflow="fold")
    for row in story:
        table.add_row(*(Text(part) for part in row))
    return table


def watch_trial(
    mission: Mission, method: Method, seed: int, interruption: Interruption | None = None
) -> PlayedTrial:
    """Run a trial with its lower bound, and a display of progress if it takes long.

    `interruption` is held from the moment in which the trial has ended.
    """
    bound = bound_of(draw_truth(mission, seed))
    with StepProgress(len(mission.tasks)) as progress:

        def on_step(tally: Tally) -> None:
            if interruption is not None and tally.status != "running":
                interruption.hold()
            progress.update(tally.steps, tally.tasks_done)

        return run_trial(mission, method, seed, bound, on_step, keeps_interrupted=True)


def plan_line(plan: CentralPlan) -> str:
    """Return what is shown of the central planner's work."""
    solution = plan.solution
    return (
        f"schedule with free joining: {solution.value or 'none'} ({solution.status}, "
        f"bound {solution.bound}); played: {plan.played_by}"
    )


def _improvements(plan: CentralPlan) -> str:
    """Return what the planner found, and when."""
    found = ", ".join(f"{steps} ({seconds:.2f} s)" for seconds, steps in plan.curve) or "none"
    first = "; a longer --time-limit finds a better plan" if plan.is_first else ""
    return f"plans found: {found}{first}"


def _show(trial: PlayedTrial) -> None:
    record, end = trial.record, trial.record.end
    mission = record.mission
    out.print(Text(f"{mission.name}: {record.method}, seed {record.seed}", style="bold"))
    if len(mission.tasks) <= LONGEST_TABLE:
        out.print(_task_table(record))
    style = "green" if end.status == "completed" else "red"
    out.print(_verdict(record), markup=False, style=style)
    if (cost := cost_of_record(record)) is not None:
        out.print(f"at a cost of {cost:g}", markup=False)
    unit = "" if record.is_continuous else " steps"
    for task, by in lateness(record).items():
        out.print(f"late: {task} by {by:g}{unit}", markup=False, style="red")
    for task, other in end.broken_links:
        out.print(f"not kept: the link of {task} to {other}", markup=False, style="red")
    for what, kind in (("lost", "lost"), ("has run dry", "dry")):
        if lost := _losses(record, kind):
            out.print(f"{what}: {lost}", markup=False, style="red")
    for line in why_so_late(record.true_mission, path_of_record(record)):
        out.print(line, markup=False)
    if trial.plan is not None:
        out.print(_improvements(trial.plan))
        out.print(plan_line(trial.plan))
    called_off = len(cancelled_steps(record))
    gone = f", {called_off} called off" if called_off else ""
    gone += f", {len(end.missed)} missed" if end.missed else ""
    what = f"{end.tasks_done} of {len(mission.tasks)} tasks{gone}"
    out.print(f"{what}, {_counted(record)}")
    compiled = trial.compiling_seconds
    compiling = f", compiling {compiled:.2f} s" if compiled else ""
    out.print(
        f"planning {trial.planning_seconds:.2f} s, deciding {trial.decision_seconds:.2f} s, "
        f"simulating {trial.simulating_seconds:.2f} s{compiling}"
    )


def _counted(record: Record) -> str:
    """Return what was counted besides tasks: in continuous time how many plans were made."""
    end = record.end
    if record.is_continuous:
        plans = sum(event.kind == "plan" for event in record.events)
        return f"{plans} plans" if plans != 1 else "1 plan"
    return f"{end.joins} joins, {end.splits} splits, {end.illegal_decisions} illegal decisions"


def _verdict(record: Record) -> str:
    """Return how a trial ended: after how many steps or, in continuous time, at what time."""
    end, bound, is_in_steps = record.end, record.lower_bound, not record.is_continuous
    length = f"{end.steps} steps" if is_in_steps else f"{record.length:g}"
    at = f"step {end.steps}" if is_in_steps else length
    if end.makespan is not None:
        ways = ["all done", *(["called off"] if cancelled_steps(record) else [])]
        ways += ["missed"] if end.missed else []
        done = f"{' or '.join(ways)} after {length}"
        seconds = seconds_of(record.mission, end.makespan)
        if seconds is not None and is_in_steps:
            done = f"{done}, {seconds:g} s"
        if not bound:
            return done
        ratio = 100 * (end.makespan / bound - 1)
        shown = bound if is_in_steps else f"{bound:g}"
        return f"{done}; no plan can take less than {shown} (+{ratio:.0f}%)"
    if end.status == "infeasible":
        return f"given up at {at}: {', '.join(end.blocked_tasks)} can never be done"
    if end.status == "interrupted":
        return f"interrupted at {at}"
    if end.status == "too late":
        return f"too late at {at}: {', '.join(_failed(record))} must be done"
    return f"not done within the limit of {length}"


def _failed(record: Record) -> list[str]:
    """Return the tasks that must be done and were missed."""
    tasks = record.true_mission.tasks
    return [tasks[task].name for task in missed_tasks(record) if not tasks[task].optional]


def _task_table(record: Record) -> Table:
    """Return who did what when, in the order it was done."""
    mission = record.true_mission
    table = Table(box=None, header_style="dim")
    when = "time" if record.is_continuous else "step"
    for header in (when, "task", "needs", "done by"):
        table.add_column(header, overflow="fold")
    undone = set(range(len(mission.tasks)))
    for step, task, robots in completions(record):
        undone.discard(task)
        needs = describe(mission.tasks[task].needs)
        names = _names(mission, robots)
        table.add_row(f"{step:g}", Text(mission.tasks[task].name), Text(needs), Text(names))
    cancelled, missed = cancelled_steps(record), missed_tasks(record)
    for task in sorted(undone):
        needs = describe(mission.tasks[task].needs)
        at = "at" if record.is_continuous else "in step"
        why = f"called off {at} {cancelled[task]:g}" if task in cancelled else ""
        if task in missed:
            why = f"missed: {WHY_MISSED[missed[task][1]]}"
        table.add_row("-", Text(mission.tasks[task].name), Text(needs), why)
    return table


def _losses(record: Record, kind: str) -> str:
    """Name the robots that were lost, or are dry, with their steps; the first ones of many."""
    lost: list[str] = []
    latest: dict[int, int] = {}  # the entry in the list of each robot that is lost
    at, in_ = ("at", "at") if record.is_continuous else ("in step", "in")
    for entry in events(record):
        for robot in entry.robots if entry.kind in (kind, "back") else ():
            if entry.kind == kind:
                latest[robot] = len(lost)
                lost.append(f"{record.mission.robots[robot].name} {at} {entry.at:g}")
            elif robot in latest:
                lost[latest[robot]] += f" (back {in_} {entry.at:g})"
    more = [f"{len(lost) - MOST_NAMES} more"] if len(lost) > MOST_NAMES else []
    return ", ".join(lost[:MOST_NAMES] + more)


def _names(mission: Mission, robots: Sequence[int]) -> str:
    """Return the robots' names, the first ones of many."""
    most = MOST_NAMES if len(robots) <= MOST_NAMES else MOST_NAMES - 1
    return listed((mission.robots[robot].name for robot in robots), most)
