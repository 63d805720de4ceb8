"""How well a policy does on held-out worlds, against scripted ones on the same worlds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import torch

from teamformer.base.array_types import Array
from teamformer.learning.nets.actor import Actor
from teamformer.methods.learned.codec import Codec
from teamformer.methods.learned.policy import Brain, Learned
from teamformer.methods.scripted.heuristic import Heuristic
from teamformer.methods.scripted.joining import JoinAll
from teamformer.methods.seam.protocol import Policy
from teamformer.mission.model import Mission
from teamformer.world.env import Tally, TeamFormation


@dataclass(frozen=True)
class Exam:
    """Held-out worlds, in settings, and the mean steps of the scripted policies on each."""

    settings: tuple[TeamFormation, ...]  # at their start; trials are played in forks of them
    bars: Mapping[str, tuple[float, ...]]  # by policy


@dataclass(frozen=True)
class Score:
    """What a policy reached in an exam; all steps are means of each setting."""

    steps: tuple[float, ...]  # the step limit where a trial failed
    bars: Mapping[str, tuple[float, ...]]  # what scripted policies take; the first is the bar
    failures: int  # trials that did not complete
    trials: int
    splits: float  # for each trial

    @property
    def ratios(self) -> tuple[float, ...]:
        """Return the steps as shares of the bar's; lower is better."""
        bar = next(iter(self.bars.values()))
        return tuple(mean / low for mean, low in zip(self.steps, bar, strict=True))

    @property
    def ratio(self) -> float:
        """Return the mean over the settings."""
        return sum(self.ratios) / len(self.ratios)

    @property
    def cost(self) -> float:
        """Return what a checkpoint is selected by: the mean, and what the worst setting loses."""
        return self.ratio + max(0.0, max(self.ratios) - 1.0)


def prepare_exam(settings: Sequence[Sequence[Mission]]) -> Exam:
    """Play the scripted policies on held-out worlds."""
    starts = tuple(TeamFormation(worlds) for worlds in settings)
    return Exam(
        settings=starts,
        bars={
            "join-all": tuple(_mean_steps(start, JoinAll()) for start in starts),
            "heuristic": tuple(_mean_steps(start, Heuristic()) for start in starts),
        },
    )


def examine(network: Actor, codec: Codec, exam: Exam, device: str = "cpu") -> Score:
    """Play held-out worlds greedily, without the deadlock guard."""
    policy = Learned(codec, torch_brain(network, device), is_guarded=False)
    steps, failures, splits = [], 0, []
    for start in exam.settings:
        tallies = _play(start, policy)
        steps.append(float(np.mean([tally.steps for tally in tallies])))
        failures += sum(tally.status != "completed" for tally in tallies)
        splits += [tally.splits for tally in tallies]
    return Score(
        steps=tuple(steps),
        bars=exam.bars,
        failures=failures,
        trials=len(splits),
        splits=float(np.mean(splits)),
    )


def _mean_steps(start: TeamFormation, policy: Policy) -> float:
    return float(np.mean([tally.steps for tally in _play(start, policy)]))


def _play(start: TeamFormation, policy: Policy) -> list[Tally]:
    """Play all worlds from their start, where tasks are shared out already, to their end."""
    env = start.fork()
    policy.begin(None, np.random.default_rng(0))
    while env.is_running.any():
        env.step(policy.decide(env.view()))
    return [env.tally(w) for w in range(len(env.missions))]


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
