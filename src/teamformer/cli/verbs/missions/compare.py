"""`teamformer compare`: the same mission by several methods, side by side."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from rich.table import Table
from rich.text import Text

from teamformer.base.errors import TeamformerError
from teamformer.cli.terminal.compiling import compile_ahead
from teamformer.cli.terminal.console import out, prepare_folder, print_json, say, wide
from teamformer.cli.terminal.interruption import Interruption
from teamformer.cli.verbs.missions.run import plan_line, watch_trial
from teamformer.files.mission_files import read_mission
from teamformer.methods.by_name import Method, load_method
from teamformer.mission.checks.costs import LATENESS, judged_by
from teamformer.mission.checks.rules import rules_not_run
from teamformer.mission.model import Mission
from teamformer.record.files.writing import record_to_tree, save_record
from teamformer.record.record import Record
from teamformer.record.task_times import cost_of_record, lateness, missed_weight
from teamformer.trials.comparison import (
    IN_CONTINUOUS_TIME,
    Comparison,
    Failure,
    compare_methods,
)
from teamformer.trials.rows import Bars, percent_over, percent_over_least
from teamformer.trials.trial import PlayedTrial
from teamformer.viewer.html import write_comparison

COLUMNS = (
    "method",
    "seed",
    "makespan",
    "to best",
    "to bound",
    "tasks",
    "joins",
    "splits",
    "planning",
    "deciding",
)


def compare(
    path: Path,
    names: Sequence[str],
    seeds: int,
    time_limit: float,
    folder: Path | None,
    as_json: bool,
    is_chosen: bool = True,
) -> int:
    """Run every method with every seed and show them together; return the exit status.

    If nobody has chosen the methods (`is_chosen`), in continuous time only those run that can.
    The folder gets all records and one page that shows them in step. A trial that fails is a row
    that says why. Where all do, the first error is raised.
    """
    mission = read_mission(path, rules_not_run)
    if not is_chosen and mission.time == "continuous":
        names = IN_CONTINUOUS_TIME
    methods = [load_method(name, time_limit) for name in names]
    if folder is not None:
        prepare_folder(folder)
    compile_ahead(methods, mission)
    with Interruption() as interruption:
        compared = compare_methods(mission, methods, seeds, _run_one)
        interruption.hold()  # what was run is told and written first
        if compared.is_interrupted:
            done = len(compared.ran) - (compared.trials[-1].record.end.status == "interrupted")
            say(f"interrupted: {done} of {len(methods) * seeds} trials ran to their end")
        _tell(compared, as_json)
        if folder is not None:
            _write(compared, folder)
    trials = compared.trials
    is_complete = len(trials) == len(methods) * seeds
    return 0 if is_complete and all(t.record.end.status == "completed" for t in trials) else 1


def _tell(compared: Comparison, as_json: bool) -> None:
    """Print what was run."""
    if as_json:
        for row in compared.rows():
            print_json(row)
    else:
        mission = compared.trials[0].record.mission
        out.print(Text(mission.name, style="bold"))
        wide.print(_table(compared, mission))
        for line in _bar_lines(compared.bars, mission):
            out.print(line)
        for trial in compared.trials:
            if trial.plan is not None:
                out.print(plan_line(trial.plan))
        for failure in compared.failures:
            why = f"{failure.method}, seed {failure.seed}: {_reason(failure.error)}"
            out.print(Text(why, style="red"))


def _run_one(mission: Mission, method: Method, seed: int) -> PlayedTrial:
    say(f"{method.name}, seed {seed} ...")
    return watch_trial(mission, method, seed)


def _write(compared: Comparison, folder: Path) -> None:
    """Write the records and the page that shows all of them."""
    for trial in compared.trials:
        name = f"{_file_name(trial.record.method)}-{trial.record.seed}.json"
        save_record(trial.record, folder / name)
    page = folder / "compare.html"
    failed = [
        {"method": failure.method, "seed": failure.seed, "why": _reason(failure.error)}
        for failure in compared.failures
    ]
    write_comparison([record_to_tree(trial.record) for trial in compared.trials], page, failed)
    say(f"page: {page}")


def _file_name(method: str) -> str:
    """Return a method's name without what is no part of a file's name, as in `mine:Soonest`."""
    return re.sub(r"[^\w.-]+", "-", method).strip("-.")


def _reason(error: TeamformerError) -> str:
    """Return an error with its hint, in one line."""
    lines = [*str(error).splitlines(), *([error.hint] if error.hint else [])]
    return "; ".join(lines)


def _bar_lines(bars: Mapping[int, Bars], mission: Mission) -> list[str]:
    """Return the bars as they are shown: those of each seed where they differ."""
    said = {
        seed: f"best known {_number(bar.best)}, lower bound {_number(bar.bound)}"
        + (f", least cost {bar.least:g}" if mission.cost and bar.least is not None else "")
        for seed, bar in bars.items()
    }
    if mission.has_surprises and len(said) > 1:
        return [f"seed {seed}: {line}" for seed, line in said.items()] + _what_is_best(mission)
    return list(said.values())[:1] + _what_is_best(mission)


def _number(value: float | None) -> str:
    return f"{value:g}" if value else "-"


def _what_is_best(mission: Mission) -> list[str]:
    """Return by what a mission with windows and without a cost is judged, which nobody wrote."""
    if mission.cost or judged_by(mission) is None:
        return []
    unit = "step" if mission.time == "steps" else "unit of time"
    late = f"{LATENESS} times its weight for each {unit} that a task is late"
    return [f"`to best` counts the makespan, and {late}"]


def _table(compared: Comparison, mission: Mission) -> Table:
    """Return a row for each trial, with what it costs and how late it is if the mission says so."""
    table = Table(box=None, header_style="dim")
    for column in (*COLUMNS[:3], *_extra_cells(mission, None), *_last_columns(mission)):
        table.add_column(column, justify="left" if column == "method" else "right")
    for trial in compared.ran:
        if isinstance(trial, Failure):
            table.add_row(Text(trial.method), str(trial.seed), "failed")
        else:
            table.add_row(*_cells(trial, compared.bars[trial.record.seed]))
    return table


def _last_columns(mission: Mission) -> list[str]:
    """Return the columns after the makespan; in continuous time nobody decides, joins or splits."""
    in_steps = ("joins", "splits", "deciding")
    return [name for name in COLUMNS[3:] if mission.time == "steps" or name not in in_steps]


def _extra_cells(mission: Mission, record: Record | None) -> dict[str, str]:
    """Return what a record tells only of some missions, by column; no record has empty cells."""
    cells = {}
    if mission.cost:
        cost = None if record is None else cost_of_record(record)
        cells["cost"] = "" if cost is None else f"{cost:g}"
    if any(task.between for task in mission.tasks):
        late = {} if record is None else lateness(record)
        cells["late"] = f"{len(late)} by {sum(late.values()):g}" if late else "-"
    if mission.until is not None:
        cells["missed"] = "" if record is None else f"{missed_weight(record):g}"
    if any(task.starts for task in mission.tasks):
        broken = 0 if record is None else len(record.end.broken_links)
        cells["links not kept"] = str(broken) if broken else "-"
    return cells


def _cells(trial: PlayedTrial, bars: Bars) -> list[Text | str]:
    record, end = trial.record, trial.record.end
    makespan = end.status if end.makespan is None else f"{end.makespan:g}"
    over = [percent_over_least(record, bars), percent_over(end.makespan, record.lower_bound)]
    return [
        Text(record.method),
        str(record.seed),
        makespan,
        *_extra_cells(record.mission, record).values(),
        *("" if gap is None else f"{gap:+.0f}%" for gap in over),
        f"{end.tasks_done}/{len(record.mission.tasks)}",
        *([] if record.is_continuous else [str(end.joins), str(end.splits)]),
        f"{trial.planning_seconds:.2f} s",
        *([] if record.is_continuous else [f"{trial.decision_seconds:.2f} s"]),
    ]
