"""`teamformer compare`: the same mission by several methods, side by side."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from rich.table import Table
from rich.text import Text

from teamformer.commands.compiling import announce_compiling
from teamformer.commands.console import out, print_json, say, wide
from teamformer.commands.missions.run import (
    best_known,
    percent_over,
    plan_line,
    read_mission,
    result_row,
    watch_trial,
)
from teamformer.errors import TeamformerError
from teamformer.model import Scenario
from teamformer.trials.methods import Method, load_method
from teamformer.trials.trial import Trial

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


@dataclass(frozen=True)
class Failure:
    """A trial that came to nothing: of which mission, by which method, and what went wrong."""

    mission: Scenario
    method: str
    seed: int
    error: TeamformerError


@dataclass(frozen=True)
class Bars:
    """What trials of one mission are measured by: the fastest of them and the highest bound."""

    best: int | None
    bound: int | None


def compare(
    path: Path,
    names: Sequence[str],
    seeds: int,
    step_limit: int | None,
    time_limit: float,
    as_json: bool,
) -> int:
    """Run every method with every seed and show them together; return the exit status.

    A trial that fails is a row that says why. Where all do, the first error is raised.
    """
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        hint = "name it once; --seeds runs it more often"
        raise TeamformerError(f"method '{twice[0]}' is named twice", hint)
    mission = read_mission(path, step_limit)
    methods = [load_method(name, time_limit) for name in names]
    announce_compiling(methods)
    ran = _run_all(mission, methods, seeds)
    trials = [trial for trial in ran if isinstance(trial, Trial)]
    failures = [trial for trial in ran if isinstance(trial, Failure)]
    if not trials:
        raise failures[0].error
    bars = _find_bars(trials, mission.has_surprises)
    ran = [_knowing(trial, bars) if isinstance(trial, Trial) else trial for trial in ran]
    if as_json:
        for trial in ran:
            print_json(_row(trial, bars))
    else:
        out.print(Text(mission.name, style="bold"))
        wide.print(_table(ran, bars))
        for line in _bar_lines(bars, mission.has_surprises):
            out.print(line)
        for trial in trials:
            if trial.plan is not None:
                out.print(plan_line(trial.plan))
        for failure in failures:
            why = f"{failure.method}, seed {failure.seed}: {_reason(failure.error)}"
            out.print(Text(why, style="red"))
    is_complete = len(trials) == len(methods) * seeds
    return 0 if is_complete and all(t.replay.end.status == "completed" for t in trials) else 1


def _run_all(mission: Scenario, methods: Sequence[Method], seeds: int) -> list[Trial | Failure]:
    """Run every method with every seed; Ctrl-C ends it with what was done so far."""
    ran: list[Trial | Failure] = []
    for method in methods:
        for seed in range(seeds):
            say(f"{method.name}, seed {seed} ...")
            trial = _try(mission, method, seed)
            ran.append(trial)
            if isinstance(trial, Trial) and trial.is_interrupted:
                done = sum(not _is_interrupted(trial) for trial in ran)
                say(f"interrupted: {done} of {len(methods) * seeds} trials ran to their end")
                return ran
    return ran


def _try(mission: Scenario, method: Method, seed: int) -> Trial | Failure:
    """Run a trial; what goes wrong in it is not to cost what the others have done."""
    try:
        return watch_trial(mission, method, seed)
    except TeamformerError as error:
        return Failure(mission, method.name, seed, error)


def _is_interrupted(trial: Trial | Failure) -> bool:
    return isinstance(trial, Trial) and trial.replay.end.status == "interrupted"


def _reason(error: TeamformerError) -> str:
    """Return an error with its hint, in one line."""
    lines = [*str(error).splitlines(), *([error.hint] if error.hint else [])]
    return "; ".join(lines)


def _find_bars(trials: Sequence[Trial], is_uncertain: bool) -> dict[int, Bars]:
    """Return the bars of each seed, which are the same for all where nothing is uncertain.

    Else each seed is a mission of its own.
    """
    bars = {}
    for seed in dict.fromkeys(trial.replay.seed for trial in trials):
        alike = [trial for trial in trials if trial.replay.seed == seed or not is_uncertain]
        bounds = (trial.replay.lower_bound for trial in alike)
        bound = max((bound for bound in bounds if bound is not None), default=None)
        bars[seed] = Bars(best_known(alike), bound)
    return bars


def _knowing(trial: Trial, bars: Mapping[int, Bars]) -> Trial:
    """Return a trial that knows the bound of its seed."""
    bound = bars[trial.replay.seed].bound
    return replace(trial, replay=replace(trial.replay, lower_bound=bound))


def _bar_lines(bars: Mapping[int, Bars], is_uncertain: bool) -> list[str]:
    """Return the bars as they are shown: those of each seed where they differ."""
    said = {
        seed: f"best known {bar.best or '-'}, lower bound {bar.bound or '-'}"
        for seed, bar in bars.items()
    }
    if is_uncertain and len(said) > 1:
        return [f"seed {seed}: {line}" for seed, line in said.items()]
    return list(said.values())[:1]


def _row(trial: Trial | Failure, bars: Mapping[int, Bars]) -> dict[str, Any]:
    """Return what `--json` prints of a trial; of one that came to nothing, why."""
    if isinstance(trial, Trial):
        return result_row(trial, bars[trial.replay.seed].best)
    return {
        "scenario": trial.mission.name,
        "method": trial.method,
        "seed": trial.seed,
        "completed": False,
        "status": "failed",
        "makespan": None,
        "error": str(trial.error),
        "hint": trial.error.hint,
    }


def _table(ran: Sequence[Trial | Failure], bars: Mapping[int, Bars]) -> Table:
    """Return a row for each trial."""
    table = Table(box=None, header_style="dim")
    for column in COLUMNS:
        table.add_column(column, justify="left" if column == "method" else "right")
    for trial in ran:
        if isinstance(trial, Failure):
            table.add_row(Text(trial.method), str(trial.seed), "failed")
        else:
            table.add_row(*_cells(trial, bars[trial.replay.seed].best))
    return table


def _cells(trial: Trial, best: int | None) -> list[Text | str]:
    replay, end = trial.replay, trial.replay.end
    makespan = end.status if end.makespan is None else str(end.makespan)
    over = [percent_over(end.makespan, bar) for bar in (best, replay.lower_bound)]
    return [
        Text(replay.method),
        str(replay.seed),
        makespan,
        *("" if gap is None else f"{gap:+.0f}%" for gap in over),
        f"{end.tasks_done}/{len(replay.scenario.tasks)}",
        str(end.joins),
        str(end.splits),
        f"{trial.planning_seconds:.2f} s",
        f"{trial.decision_seconds:.2f} s",
    ]
