"""How well a policy does on held-out worlds, against scripted ones on the same worlds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch

from teamformer.model import Scenario
from teamformer.nets.actor import Actor
from teamformer.policies.codec import Codec
from teamformer.policies.heuristic import Heuristic
from teamformer.policies.learned import Brain, Learned
from teamformer.policies.protocol import Policy
from teamformer.policies.scripted import JoinAll
from teamformer.policies.trial import run_trials
from teamformer.sim.arrays import Array


@dataclass(frozen=True)
class Exam:
    """Held-out worlds, in settings, and the mean steps of the scripted policies on each."""

    settings: tuple[tuple[Scenario, ...], ...]
    join_all: tuple[float, ...]
    heuristic: tuple[float, ...]


@dataclass(frozen=True)
class Score:
    """What a policy reached in an exam."""

    steps: tuple[float, ...]  # mean of each setting; the step limit where a trial failed
    ratios: tuple[float, ...]  # of these to join-all's; lower is better
    failures: int  # trials that did not complete
    trials: int
    splits: float  # for each trial

    @property
    def ratio(self) -> float:
        """Return the mean over the settings, which a checkpoint is selected by."""
        return sum(self.ratios) / len(self.ratios)


def prepare_exam(settings: Sequence[Sequence[Scenario]]) -> Exam:
    """Play the scripted policies on held-out worlds."""
    return Exam(
        settings=tuple(tuple(worlds) for worlds in settings),
        join_all=tuple(float(steps_of(worlds, JoinAll()).mean()) for worlds in settings),
        heuristic=tuple(float(steps_of(worlds, Heuristic()).mean()) for worlds in settings),
    )


def examine(network: Actor, codec: Codec, exam: Exam, device: str = "cpu") -> Score:
    """Play held-out worlds greedily, without the liveness rule."""
    policy = Learned(codec, torch_brain(network, device), with_liveness=False)
    steps, failures, splits = [], 0, []
    for worlds in exam.settings:
        tallies = run_trials(worlds, policy)
        steps.append(float(np.mean([tally.steps for tally in tallies])))
        failures += sum(tally.status != "completed" for tally in tallies)
        splits += [tally.splits for tally in tallies]
    ratios = tuple(mean / bar for mean, bar in zip(steps, exam.join_all, strict=True))
    return Score(tuple(steps), ratios, failures, len(splits), float(np.mean(splits)))


def steps_of(worlds: Sequence[Scenario], policy: Policy) -> Array:
    """Return the steps of one trial of each world, as (worlds,)."""
    return np.array([tally.steps for tally in run_trials(worlds, policy)])


def torch_brain(
    network: Actor, device: str = "cpu", generator: torch.Generator | None = None
) -> Brain:
    """Return what `Learned` needs to run a network in torch, greedily without a generator."""

    def act(tokens: tuple[Array, ...]) -> Array:
        with torch.no_grad():
            given = tuple(torch.from_numpy(part).to(device) for part in tokens)
            action: Array = network.act(given, generator)[0].cpu().numpy()
            return action

    return act
