"""What makes a training the training it is."""

from __future__ import annotations

from dataclasses import dataclass, field

from teamformer.base.errors import TeamformerError
from teamformer.learning.algorithms.deviations import DeviationSettings
from teamformer.learning.algorithms.imitation import ImitationSettings
from teamformer.learning.algorithms.ppo import PpoSettings
from teamformer.learning.algorithms.reward_streams import MissionReward, TeamReward
from teamformer.learning.algorithms.rollout_improvement import RolloutImprovementSettings
from teamformer.learning.algorithms.sampled_plans import SampleSettings
from teamformer.learning.architectures import Architecture, find_architecture
from teamformer.learning.training_worlds import Mixture, imitation_mixture

ITERATIONS, NO_LIMIT = 60, 10**9
DEVICES = ("cpu", "cuda")


@dataclass(frozen=True)
class TrainSettings:
    """One training; the same settings give the same weights, if no clock ends it."""

    network: str = "any"
    capabilities: int | None = None  # None: any number
    method: str | None = None  # None: the network's own
    seed: int = 0
    iterations: int | None = None  # None: as many as the minutes allow, else 60
    minutes: float | None = None  # ends the training, where that is earlier
    worlds: int = 256  # in each iteration and process
    mixture: Mixture | None = None  # None: the network's own, or that of imitation
    mission_reward: MissionReward | None = field(default_factory=MissionReward)
    team_reward: TeamReward | None = None  # instead, if mission_reward is None
    ppo: PpoSettings | None = None  # None: the network's own
    rollouts: RolloutImprovementSettings = field(default_factory=RolloutImprovementSettings)
    imitation: ImitationSettings = field(default_factory=ImitationSettings)
    deviations: DeviationSettings = field(default_factory=DeviationSettings)
    samples: SampleSettings = field(default_factory=SampleSettings)
    evaluate_every: int = 10
    held_out: int = 48  # worlds of each setting to select on
    begin_from: str = ""  # folder of a checkpoint to take the first weights from
    device: str = "cpu"

    def __post_init__(self) -> None:
        architecture = find_architecture(self.network, self.capabilities)
        if self.method is not None and self.method not in architecture.methods:
            known = " or ".join(architecture.methods)
            raise TeamformerError(
                f"'{self.network}' does not learn by {self.method}", f"use {known}"
            )
        if self.learns_by != "ppo" and self.mission_reward is None:
            hint = "leave the reward out, or use ppo"
            raise TeamformerError(f"learning by {self.learns_by} knows no reward", hint)
        limit = self.capabilities
        if limit is not None and self.mixture and self.mixture.most_capabilities > limit:
            most = self.mixture.most_capabilities
            what = f"mixture has worlds of {most} capabilities, and the network is made for {limit}"
            raise TeamformerError(
                what, f"write capabilities: [{limit}, {limit}] and crowds: 0 in mixture"
            )

    @property
    def learns_by(self) -> str:
        """Return the method: a key of `iteration.METHODS`."""
        return self.method or self.architecture.methods[0]

    @property
    def last_iteration(self) -> int:
        """Return how many iterations there are at most."""
        if self.iterations is not None:
            return self.iterations
        return ITERATIONS if self.minutes is None else NO_LIMIT

    @property
    def architecture(self) -> Architecture:
        """Return the network's kind."""
        return find_architecture(self.network, self.capabilities)

    @property
    def worlds_from(self) -> Mixture:
        """Return where training worlds are drawn from."""
        if self.mixture is None and self.learns_by == "imitation":
            return imitation_mixture(self.capabilities)
        return self.mixture or self.architecture.mixture(self.capabilities)

    @property
    def update(self) -> PpoSettings:
        """Return how rollouts change the weights."""
        return self.ppo or self.architecture.ppo

    @property
    def reward(self) -> MissionReward | TeamReward:
        """Return the one reward that is set."""
        if self.mission_reward is None:
            return self.team_reward or TeamReward()
        return self.mission_reward

    def share_done(self, iteration: int, seconds: float) -> float:
        """Return how much of the training is over, from 0 to 1."""
        of_iterations = iteration / self.last_iteration
        if self.minutes is None:
            return of_iterations
        return min(1.0, max(of_iterations, seconds / (60 * self.minutes)))
