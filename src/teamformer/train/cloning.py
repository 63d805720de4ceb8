"""A warm start: the network first learns to choose as join-all does, softly."""

from __future__ import annotations

import numpy as np
import torch
from torch import Tensor

from teamformer.policies.choices import choices_for
from teamformer.policies.relations import Relations
from teamformer.policies.scripted import JoinAll
from teamformer.sim.arrays import Array
from teamformer.sim.view import View
from teamformer.train.ppo import Learner
from teamformer.train.rollout import Rollout

SOFTNESS = 0.2
"""Share of the probability that goes to all legal choices alike, so that PPO has what to try."""


def choose_as_join_all(view: View, relations: Relations, has_choice: Array) -> tuple[Array, Array]:
    """Choose as the scripted policy does; the log-probabilities are zero."""
    choice = choices_for(view, JoinAll().decide(view).wanted)[has_choice]
    return choice, np.zeros(len(choice), dtype=np.float32)


def clone(learner: Learner, rollout: Rollout, minibatch: int, generator: torch.Generator) -> float:
    """Move the network towards the choices of a rollout; return the mean loss."""
    losses = []
    order = torch.randperm(len(rollout.choice), generator=generator)
    for rows in order.tensor_split(max(1, round(len(order) / minibatch))):
        tokens = type(rollout.tokens)(*(part[rows] for part in rollout.tokens))
        scores = learner.policy(tokens)
        loss = soft_loss(scores, tokens.is_legal, rollout.choice[rows])
        learner.policy_optimizer.zero_grad()
        loss.backward()  # type: ignore[no-untyped-call]
        learner.policy_optimizer.step()
        losses.append(loss.item())
    return sum(losses) / len(losses)


def soft_loss(scores: Tensor, is_legal: Tensor, choice: Tensor) -> Tensor:
    """Return the cross-entropy to the choices, softened over what is legal."""
    log_probs = torch.log_softmax(scores, dim=-1)
    chosen = log_probs.gather(1, choice.unsqueeze(1)).squeeze(1)
    legal = is_legal.to(scores.dtype)
    everywhere = (log_probs * legal).sum(dim=1) / legal.sum(dim=1)
    return -((1 - SOFTNESS) * chosen + SOFTNESS * everywhere).mean()
