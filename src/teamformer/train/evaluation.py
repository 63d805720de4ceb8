"""How well a policy does on held-out worlds, against a scripted one on the same worlds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch

from teamformer.model import Scenario
from teamformer.nets.relational import RelationalPolicy, Tokens
from teamformer.policies.learned import Learned
from teamformer.policies.protocol import Policy
from teamformer.policies.relations import Relations
from teamformer.policies.scripted import JoinAll
from teamformer.policies.trial import run_trials
from teamformer.sim.arrays import Array


@dataclass(frozen=True)
class Score:
    """What a policy reached; lower ratios are better."""

    ratios: tuple[float, ...]  # of mean steps to join-all's, for each setting
    failures: int  # trials that did not complete
    splits: float  # for each trial

    @property
    def ratio(self) -> float:
        """Return the mean over the settings, which a checkpoint is selected by."""
        return sum(self.ratios) / len(self.ratios)


def evaluate(network: RelationalPolicy, settings: Sequence[Sequence[Scenario]]) -> Score:
    """Play held-out worlds greedily, without the liveness rule."""
    policy = Learned(torch_scorer(network), with_liveness=False)
    ratios, failures, splits = [], 0, []
    for worlds in settings:
        tallies = run_trials(worlds, policy)
        bar = steps_of(worlds, JoinAll())
        ratios.append(float(np.mean([tally.steps for tally in tallies]) / bar.mean()))
        failures += sum(tally.status != "completed" for tally in tallies)
        splits += [tally.splits for tally in tallies]
    return Score(tuple(ratios), failures, float(np.mean(splits)))


def steps_of(worlds: Sequence[Scenario], policy: Policy) -> Array:
    """Return the steps of one trial of each world, as (worlds,)."""
    return np.array([tally.steps for tally in run_trials(worlds, policy)])


def torch_scorer(network: RelationalPolicy):  # type: ignore[no-untyped-def]
    """Return what `Learned` needs to run a network that is still being trained."""

    def score(relations: Relations) -> Array:
        with torch.no_grad():
            scores: Array = network(Tokens(*map(torch.from_numpy, relations))).numpy()
            return scores

    return score
