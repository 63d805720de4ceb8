"""`teamformer compare`: the same mission by several methods, side by side."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

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


def compare(
    path: Path,
    names: Sequence[str],
    seeds: int,
    step_limit: int | None,
    time_limit: float,
    as_json: bool,
) -> int:
    """Run every method with every seed and show them together; return the exit status."""
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        hint = "name it once; --seeds runs it more often"
        raise TeamformerError(f"method '{twice[0]}' is named twice", hint)
    mission = read_mission(path, step_limit)
    methods = [load_method(name, time_limit) for name in names]
    announce_compiling(methods)
    trials = _run_all(mission, methods, seeds)
    bars = _find_bars(trials, mission.has_surprises)
    trials = [_knowing(trial, bars[trial.replay.seed].bound) for trial in trials]
    if as_json:
        for trial in trials:
            print_json(result_row(trial, bars[trial.replay.seed].best))
    else:
        out.print(Text(mission.name, style="bold"))
        wide.print(_table(trials, bars))
        for line in _bar_lines(bars, mission.has_surprises):
            out.print(line)
        for trial in trials:
            if trial.plan is not None:
                out.print(plan_line(trial.plan))
    is_complete = len(trials) == len(methods) * seeds
    return 0 if is_complete and all(t.replay.end.status == "completed" for t in trials) else 1


def _run_all(mission: Scenario, methods: Sequence[Method], seeds: int) -> list[Trial]:
    """Run every method with every seed; Ctrl-C ends it with what was done so far."""
    trials: list[Trial] = []
    for method in methods:
        for seed in range(seeds):
            say(f"{method.name}, seed {seed} ...")
            trials.append(watch_trial(mission, method, seed))
            if trials[-1].is_interrupted:
                done = sum(trial.replay.end.status != "interrupted" for trial in trials)
                say(f"interrupted: {done} of {len(methods) * seeds} trials ran to their end")
                return trials
    return trials


@dataclass(frozen=True)
class Bars:
    """What trials of one mission are measured by: the fastest of them and the highest bound."""

    best: int | None
    bound: int | None


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


def _knowing(trial: Trial, bound: int | None) -> Trial:
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


def _table(trials: Sequence[Trial], bars: Mapping[int, Bars]) -> Table:
    """Return a row for each trial."""
    table = Table(box=None, header_style="dim")
    columns = (
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
    for column in columns:
        table.add_column(column, justify="left" if column == "method" else "right")
    for trial in trials:
        replay, end = trial.replay, trial.replay.end
        makespan = end.status if end.makespan is None else str(end.makespan)
        own_bars = (bars[replay.seed].best, replay.lower_bound)
        over = [percent_over(end.makespan, bar) for bar in own_bars]
        table.add_row(
            Text(replay.method),
            str(replay.seed),
            makespan,
            *("" if gap is None else f"{gap:+.0f}%" for gap in over),
            f"{end.tasks_done}/{len(replay.scenario.tasks)}",
            str(end.joins),
            str(end.splits),
            f"{trial.planning_seconds:.2f} s",
            f"{trial.decision_seconds:.2f} s",
        )
    return table
