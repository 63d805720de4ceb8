"""`teamformer compare`: the same mission by several methods, side by side."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from rich.table import Table
from rich.text import Text

from teamformer.commands.compiling import compile_ahead
from teamformer.commands.console import out, prepare_folder, print_json, say, wide
from teamformer.commands.interruption import Interruption
from teamformer.commands.missions.run import plan_line, watch_trial
from teamformer.errors import TeamformerError
from teamformer.mission.rules import rules_not_played
from teamformer.model import Scenario
from teamformer.scenarios.files import read_scenario
from teamformer.sim.replay.task_times import cost_of_record
from teamformer.sim.replay.writing import replay_to_tree, write_replay
from teamformer.trials.comparison import Bars, Comparison, Failure, compare_methods
from teamformer.trials.methods import Method, load_method
from teamformer.trials.rows import percent_over
from teamformer.trials.trial import Trial
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
) -> int:
    """Run every method with every seed and show them together; return the exit status.

    The folder gets all records and one page that shows them in step. A trial that fails is a row
    that says why. Where all do, the first error is raised.
    """
    mission = read_scenario(path, rules_not_played)
    methods = [load_method(name, time_limit) for name in names]
    if folder is not None:
        prepare_folder(folder)
    compile_ahead(methods, mission)
    with Interruption() as interruption:
        compared = compare_methods(mission, methods, seeds, _run_one)
        interruption.hold()  # what was run is told and written first
        if compared.is_interrupted:
            done = len(compared.ran) - (compared.trials[-1].replay.end.status == "interrupted")
            say(f"interrupted: {done} of {len(methods) * seeds} trials ran to their end")
        _tell(compared, as_json)
        if folder is not None:
            _write(compared, folder)
    trials = compared.trials
    is_complete = len(trials) == len(methods) * seeds
    return 0 if is_complete and all(t.replay.end.status == "completed" for t in trials) else 1


def _tell(compared: Comparison, as_json: bool) -> None:
    """Print what was run."""
    if as_json:
        for row in compared.rows():
            print_json(row)
    else:
        mission = compared.trials[0].replay.scenario
        out.print(Text(mission.name, style="bold"))
        wide.print(_table(compared))
        for line in _bar_lines(compared.bars, mission.has_surprises):
            out.print(line)
        for trial in compared.trials:
            if trial.plan is not None:
                out.print(plan_line(trial.plan))
        for failure in compared.failures:
            why = f"{failure.method}, seed {failure.seed}: {_reason(failure.error)}"
            out.print(Text(why, style="red"))


def _run_one(mission: Scenario, method: Method, seed: int) -> Trial:
    say(f"{method.name}, seed {seed} ...")
    return watch_trial(mission, method, seed)


def _write(compared: Comparison, folder: Path) -> None:
    """Write the records and the page that shows all of them."""
    for trial in compared.trials:
        name = f"{_file_name(trial.replay.method)}-{trial.replay.seed}.json"
        write_replay(trial.replay, folder / name)
    page = folder / "compare.html"
    failed = [
        {"method": failure.method, "seed": failure.seed, "why": _reason(failure.error)}
        for failure in compared.failures
    ]
    write_comparison([replay_to_tree(trial.replay) for trial in compared.trials], page, failed)
    say(f"page: {page}")


def _file_name(method: str) -> str:
    """Return a method's name without what is no part of a file's name, as in `mine:Soonest`."""
    return re.sub(r"[^\w.-]+", "-", method).strip("-.")


def _reason(error: TeamformerError) -> str:
    """Return an error with its hint, in one line."""
    lines = [*str(error).splitlines(), *([error.hint] if error.hint else [])]
    return "; ".join(lines)


def _bar_lines(bars: Mapping[int, Bars], is_uncertain: bool) -> list[str]:
    """Return the bars as they are shown: those of each seed where they differ."""
    said = {
        seed: f"best known {bar.best or '-'}, lower bound {bar.bound or '-'}"
        + ("" if bar.least_cost is None else f", least cost {bar.least_cost:g}")
        for seed, bar in bars.items()
    }
    if is_uncertain and len(said) > 1:
        return [f"seed {seed}: {line}" for seed, line in said.items()]
    return list(said.values())[:1]


def _table(compared: Comparison) -> Table:
    """Return a row for each trial; of a mission with a cost also that, and the best costs least."""
    table = Table(box=None, header_style="dim")
    is_priced = any(trial.replay.scenario.cost for trial in compared.trials)
    for column in COLUMNS:
        table.add_column(column, justify="left" if column == "method" else "right")
        if column == "makespan" and is_priced:
            table.add_column("cost", justify="right")
    for trial in compared.ran:
        if isinstance(trial, Failure):
            table.add_row(Text(trial.method), str(trial.seed), "failed")
        else:
            table.add_row(*_cells(trial, compared.bars[trial.replay.seed], is_priced))
    return table


def _cells(trial: Trial, bars: Bars, is_priced: bool) -> list[Text | str]:
    replay, end, cost = trial.replay, trial.replay.end, cost_of_record(trial.replay)
    makespan = end.status if end.makespan is None else str(end.makespan)
    judged = (cost, bars.least_cost) if is_priced else (end.makespan, bars.best)
    over = [percent_over(*judged), percent_over(end.makespan, replay.lower_bound)]
    return [
        Text(replay.method),
        str(replay.seed),
        makespan,
        *(["" if cost is None else f"{cost:g}"] if is_priced else []),
        *("" if gap is None else f"{gap:+.0f}%" for gap in over),
        f"{end.tasks_done}/{len(replay.scenario.tasks)}",
        str(end.joins),
        str(end.splits),
        f"{trial.planning_seconds:.2f} s",
        f"{trial.decision_seconds:.2f} s",
    ]
