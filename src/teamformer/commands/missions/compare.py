"""`teamformer compare`: the same scenario under several policies, side by side."""

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
    Changes,
    best_known,
    percent_over,
    plan_line,
    ready_policy,
    result_row,
    watch_trial,
)
from teamformer.errors import TeamformerError
from teamformer.mission.rules import rules_not_played
from teamformer.model import Scenario
from teamformer.policies.protocol import Policy
from teamformer.scenarios.files import read_scenario
from teamformer.trials.trial import Trial

COLUMNS = (
    "policy",
    "seed",
    "makespan",
    "to best",
    "to bound",
    "tasks",
    "joins",
    "splits",
    "deciding",
)


@dataclass(frozen=True)
class Failure:
    """A trial that came to nothing: who was to decide in which world, and what went wrong."""

    world: Scenario
    policy: str
    seed: int
    error: TeamformerError


def compare(
    path: Path,
    policy_names: Sequence[str],
    seeds: int,
    changes: Changes,
    time_limit: float,
    as_json: bool,
) -> int:
    """Run every policy with every seed and show them together; return the exit status.

    A trial that fails is a row that says why. Where all do, the first error is raised.
    """
    twice = sorted({name for name in policy_names if policy_names.count(name) > 1})
    if twice:
        hint = "name it once; --seeds runs it more often"
        raise TeamformerError(f"policy '{twice[0]}' is named twice", hint)
    scenario = changes.apply(read_scenario(path, rules_not_played))
    policies = {name: ready_policy(name, time_limit) for name in policy_names}
    worlds = {name: changes.suit(scenario, policy, name) for name, policy in policies.items()}
    played = worlds.values()
    has_shared_plan = any(world.allocation == "plan" for world in played)
    announce_compiling(policy_names, any(w.is_planned for w in played), has_shared_plan)
    ran = _run_all(worlds, policies, seeds)
    trials = [trial for trial in ran if isinstance(trial, Trial)]
    failures = [trial for trial in ran if isinstance(trial, Failure)]
    if not trials:
        raise failures[0].error
    bars = _find_bars(trials, scenario.has_surprises)
    ran = [_knowing(trial, bars) for trial in ran]
    trials = [trial for trial in ran if isinstance(trial, Trial)]
    if as_json:
        for trial in ran:
            print_json(_json_row(trial, bars))
    else:
        out.print(Text(scenario.name, style="bold"))
        wide.print(_table(ran, bars, scenario.allocation))
        for line in _bar_lines(bars, scenario.has_surprises):
            out.print(line)
        for trial in trials:
            if trial.plan is not None:
                out.print(plan_line(trial.plan))
        for failure in failures:
            why = f"{failure.policy}, seed {failure.seed}: {_reason(failure.error)}"
            out.print(Text(why, style="red"))
    is_complete = len(trials) == len(policies) * seeds
    return 0 if is_complete and all(t.replay.end.status == "completed" for t in trials) else 1


def _run_all(
    worlds: Mapping[str, Scenario], policies: Mapping[str, Policy], seeds: int
) -> list[Trial | Failure]:
    """Run every policy in its world with every seed; Ctrl-C ends it with what was done so far."""
    ran: list[Trial | Failure] = []
    for name, policy in policies.items():
        for seed in range(seeds):
            say(f"{name}, seed {seed} ...")
            trial = _try(worlds[name], policy, name, seed)
            ran.append(trial)
            if isinstance(trial, Trial) and trial.is_interrupted:
                done = sum(not _is_interrupted(trial) for trial in ran)
                say(f"interrupted: {done} of {len(policies) * seeds} trials ran to their end")
                return ran
    return ran


def _try(world: Scenario, policy: Policy, name: str, seed: int) -> Trial | Failure:
    """Run a trial; what goes wrong in it is not to cost what the others have done."""
    try:
        return watch_trial(world, policy, name, seed)
    except TeamformerError as error:
        return Failure(world, name, seed, error)


def _is_interrupted(trial: Trial | Failure) -> bool:
    return isinstance(trial, Trial) and trial.replay.end.status == "interrupted"


def _reason(error: TeamformerError) -> str:
    """Return an error with its hint, in one line."""
    lines = [*str(error).splitlines(), *([error.hint] if error.hint else [])]
    return "; ".join(lines)


@dataclass(frozen=True)
class Bars:
    """What trials of one mission are measured by: the fastest of them and the highest bound."""

    best: int | None
    bound: int | None


def _find_bars(trials: Sequence[Trial], is_uncertain: bool) -> dict[int, Bars]:
    """Return the bars of each seed, which are the same for all where nothing is uncertain.

    Else each seed is a mission of its own. The scenarios of a seed differ at most in the
    allocation, which no bound depends on.
    """
    bars = {}
    for seed in dict.fromkeys(trial.replay.seed for trial in trials):
        alike = [trial for trial in trials if trial.replay.seed == seed or not is_uncertain]
        bounds = (trial.replay.lower_bound for trial in alike)
        bound = max((bound for bound in bounds if bound is not None), default=None)
        bars[seed] = Bars(best_known(alike), bound)
    return bars


def _knowing(trial: Trial | Failure, bars: Mapping[int, Bars]) -> Trial | Failure:
    """Have a trial know the highest bound of its mission."""
    if isinstance(trial, Failure):
        return trial
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


def _json_row(trial: Trial | Failure, bars: Mapping[int, Bars]) -> dict[str, Any]:
    """Return what `--json` prints of a trial, be it one that came to nothing."""
    if isinstance(trial, Failure):
        return _failed_row(trial)
    return result_row(trial, bars[trial.replay.seed].best)


def _failed_row(failure: Failure) -> dict[str, Any]:
    """Return what `--json` prints of a trial that came to nothing."""
    return {
        "scenario": failure.world.name,
        "policy": failure.policy,
        "seed": failure.seed,
        "completed": False,
        "status": "failed",
        "makespan": None,
        "allocation": failure.world.allocation,
        "error": str(failure.error),
        "hint": failure.error.hint,
    }


def _table(ran: Sequence[Trial | Failure], bars: Mapping[int, Bars], allocation: str) -> Table:
    """Return a row for each trial; who ran under another allocation is said to."""
    table = Table(box=None, header_style="dim")
    for column in COLUMNS:
        table.add_column(column, justify="left" if column == "policy" else "right")
    for trial in ran:
        if isinstance(trial, Failure):
            table.add_row(Text(trial.policy), str(trial.seed), "failed")
        else:
            table.add_row(*_cells(trial, bars[trial.replay.seed].best, allocation))
    return table


def _cells(trial: Trial, best: int | None, allocation: str) -> list[Text | str]:
    replay, end = trial.replay, trial.replay.end
    makespan = end.status if end.makespan is None else str(end.makespan)
    over = [percent_over(end.makespan, bar) for bar in (best, replay.lower_bound)]
    own = replay.scenario.allocation
    label = replay.policy if own == allocation else f"{replay.policy}, {own}"
    return [
        Text(label),
        str(replay.seed),
        makespan,
        *("" if gap is None else f"{gap:+.0f}%" for gap in over),
        f"{end.tasks_done}/{len(replay.scenario.tasks)}",
        str(end.joins),
        str(end.splits),
        f"{trial.decision_seconds:.3f} s",
    ]
