"""How a claim of the paper is judged from rows.

The paper's policies have no deadlock guard, so learned methods are judged without theirs. That a
method is faster, or that something rises or falls, holds only if the 95% interval leaves no doubt.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from teamformer.bench.report.evidence import Evidence
from teamformer.bench.report.tables import interval, number, seconds
from teamformer.bench.statistics import Mean, Slope, mean_of, slope_of, wilson
from teamformer.files.drawn.named_settings import spec_of
from teamformer.methods.by_name import BARE
from teamformer.methods.listings import CARDS

BY_PPO = "-ppo"
ANY_FLEET = "any-fleet"
"""The family whose only method is `teamformer-bare`, whatever the number of capabilities."""

TABLE_1 = (
    "4N20T-C4",
    "20N100T-C4",
    "8N20T-C8",
    "24N100T-C8",
    "100N20T-C100-R10",
    "100N20T-C100-R20",
    "100N20T-C100-R50",
    "100N20T-C100-R90",
)


@dataclass(frozen=True)
class ClaimJudgement:
    """What was measured for a claim, and whether it holds; None if that was not measured."""

    measured: str
    holds: bool | None


Judge = Callable[[Evidence, str], ClaimJudgement]
"""Judges a claim for a family of methods: `teamformer` (the paper's) or `ANY_FLEET`."""

UNKNOWN = ClaimJudgement("not measured", None)


def method_for(family: str, setting: str) -> str:
    """Return the method of a family that serves a setting: `gnn-c4-ppo-bare`, or the name itself.

    The paper's networks learned by PPO from nothing. Where a script has taught the one of that
    name, it is the one that PPO made.
    """
    if family == ANY_FLEET:
        return "teamformer" + BARE
    if family not in ("teamformer", "deepset", "gnn"):
        return family
    name = f"{family}-c{spec_of(setting).capabilities}"
    return (f"{name}{BY_PPO}" if f"{name}{BY_PPO}" in CARDS else name) + BARE


def near_optimum(setting: str, most: float) -> Judge:
    """Judge whether makespans are within so many steps of the proven optimum."""

    def judge(evidence: Evidence, family: str) -> ClaimJudgement:
        method = method_for(family, setting)
        found = evidence.from_optimum(setting, method)
        if found is None:
            return UNKNOWN
        played = evidence.difference(setting, method, "central")
        text = f"{interval(found)} from the optimum with free joins"
        text += f"; {interval(played)} from its play" if played else ""
        return ClaimJudgement(text, found.value - _reach(found) <= most)

    return judge


def faster_than(setting: str, families: tuple[str, ...]) -> Judge:
    """Judge whether makespans are below those of all other families measured."""

    def judge(evidence: Evidence, family: str) -> ClaimJudgement:
        method = method_for(family, setting)
        found = {
            bar: evidence.difference(setting, method, method_for(bar, setting)) for bar in families
        }
        known = {bar: mean for bar, mean in found.items() if mean is not None and mean.count}
        if not known:
            return UNKNOWN
        scripted = evidence.difference(setting, method, "join-all")
        told = [f"{bar} {interval(mean)}" for bar, mean in known.items()]
        told += [f"(join-all {interval(scripted)})"] if scripted else []
        told += [f"({bar} not measured)" for bar in families if bar not in known]
        is_faster = [mean.value + _reach(mean) < 0 for mean in known.values()]
        return ClaimJudgement(", ".join(told), all(is_faster))

    return judge


def saves(setting: str, bar: str, claimed: float) -> Judge:
    """Judge whether a share of another family's makespan is saved, or the interval reaches it."""

    def judge(evidence: Evidence, family: str) -> ClaimJudgement:
        found = evidence.saving(setting, method_for(family, setting), method_for(bar, setting))
        if found is None:
            return UNKNOWN
        low, high = found.value - _reach(found), found.value + _reach(found)
        text = f"{_percent(found.value)} ({_percent(low)} to {_percent(high)})"
        return ClaimJudgement(text, high >= claimed)

    return judge


def no_failure(setting: str, of: str | None = None) -> Judge:
    """Judge whether no trial failed."""

    def judge(evidence: Evidence, family: str) -> ClaimJudgement:
        summary = evidence.summary(setting, method_for(of or family, setting))
        if summary is None:
            return UNKNOWN
        return ClaimJudgement(_failed(summary.failures, summary.trials), summary.failures == 0)

    return judge


def some_failures(setting: str, of: str) -> Judge:
    """Judge whether a family's trials fail at all."""
    spared = no_failure(setting, of)

    def judge(evidence: Evidence, family: str) -> ClaimJudgement:
        found = spared(evidence, family)
        return found if found.holds is None else replace(found, holds=not found.holds)

    return judge


def trend(of: str | None, rises: bool) -> Judge:
    """Judge whether the makespan rises (or falls) with the requirements of 100-robot worlds."""

    def judge(evidence: Evidence, family: str) -> ClaimJudgement:
        found = _by_requirements(lambda s: evidence.makespans(s, method_for(of or family, s)))
        if len(found) < 2:
            return UNKNOWN
        slope = _slope(found, 10)
        means = ", ".join(number(mean_of(makespans).value) for makespans in found.values())
        text = f"{means}; {interval(slope)} for ten requirements more"
        return ClaimJudgement(text, slope.rises if rises else slope.falls)

    return judge


def splits_fall(evidence: Evidence, family: str) -> ClaimJudgement:
    """Judge whether teams split less as tasks require more."""
    found = _by_requirements(lambda s: evidence.splits(s, method_for(family, s)))
    if len(found) < 2:
        return UNKNOWN
    slope = _slope(found, 10 * 1000)
    counts = ", ".join(str(sum(splits)) for splits in found.values())
    trials = ", ".join(str(len(splits)) for splits in found.values())
    text = f"{counts} splits in {trials} trials; "
    text += f"{interval(slope)} in 1000 trials for ten requirements more"
    return ClaimJudgement(text, slope.falls)


def as_quick(setting: str, claimed: float) -> Judge:
    """Judge whether deciding takes no longer than claimed."""

    def judge(evidence: Evidence, family: str) -> ClaimJudgement:
        summary = evidence.summary(setting, method_for(family, setting))
        if summary is None or not summary.inference.count:
            return UNKNOWN
        told = f"{seconds(summary.inference)} s (one CPU thread)"
        return ClaimJudgement(told, summary.inference.value <= claimed)

    return judge


def slowest(evidence: Evidence, family: str) -> ClaimJudgement:
    """Judge whether the method takes longer than deep set and GNN."""
    told, holds = [], []
    for setting in TABLE_1[:4]:
        ours = evidence.summary(setting, method_for(family, setting))
        others = [evidence.summary(setting, method_for(bar, setting)) for bar in ("deepset", "gnn")]
        times = [other.inference.value for other in others if other and other.inference.count]
        if ours and times and ours.inference.count:
            told.append(f"{setting}: {ours.inference.value / max(times):.1f} times the slower one")
            holds.append(ours.inference.value > max(times))
    return ClaimJudgement("; ".join(told), all(holds)) if told else UNKNOWN


def _by_requirements(
    of: Callable[[str], Sequence[float]],
) -> dict[int, Sequence[float]]:
    """Return what each trial of the 100-robot worlds gave, by the requirements of a task."""
    found = {spec_of(setting).requirements or 0: of(setting) for setting in TABLE_1[4:]}
    return {requirements: values for requirements, values in found.items() if values}


def _slope(found: Mapping[int, Sequence[float]], times: float) -> Slope:
    """Return the slope of the least-squares line through all trials, so many times."""
    return slope_of([(x, times * y) for x, values in found.items() for y in values])


def _failed(failures: int, trials: int) -> str:
    low, high = wilson(failures, trials)
    return f"{failures} of {trials} ({low:.1%} to {high:.1%})"


def _reach(mean: Mean) -> float:
    return mean.half_width if mean.count > 1 else 0.0


def _percent(share: float) -> str:
    return f"{round(100 * share)}%"
