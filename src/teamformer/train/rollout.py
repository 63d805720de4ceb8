"""Rollouts: many worlds played to their end, and what is learned from of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from teamformer.nets.critic import Critic
from teamformer.nets.relational import RelationalPolicy, Tokens
from teamformer.policies.choices import wanted_counts
from teamformer.policies.learned import is_open_question
from teamformer.policies.relations import Relations, relate
from teamformer.policies.scripted import JoinAll
from teamformer.sim.arrays import COMPLETED, Array
from teamformer.sim.env import Decision, TeamFormation
from teamformer.sim.view import View
from teamformer.train.advantages import advantages
from teamformer.train.outlook import Outlook, look_out

Chooser = Callable[[View, Relations, Array], tuple[Array, Array]]
"""From a view, the relations and which rows have a choice: those rows' choices and log-probs."""


@dataclass(frozen=True)
class MissionReward:
    """What a world's teams earn together in a step."""

    step: float = -0.1
    done: float = 0.5  # for each task done


@dataclass(frozen=True)
class Rollout:
    """What was played: decisions (a row each, forced ones left out) and world states.

    A state is a running world before a step; `state` says which one each decision was made in.
    """

    tokens: Tokens  # (decisions, ...)
    choice: Tensor  # (decisions,)
    log_prob: Tensor  # (decisions,)
    state: Tensor  # (decisions,)
    outlook: tuple[Tensor, ...]  # (states, ...)
    last_outlook: tuple[Tensor, ...]  # (worlds, ...) after the last step
    is_running: Array  # (steps, worlds)
    rewards: Array  # (steps, worlds)
    has_ended: Array  # (worlds,) all tasks done, rather than cut off


def play(env: TeamFormation, choose: Chooser, reward: MissionReward, steps: int) -> Rollout:
    """Play all worlds of an environment to their end or for `steps` steps."""
    decisions: list[tuple[Array, ...]] = []
    outlooks: list[tuple[Array, ...]] = []
    running: list[Array] = []
    rewards: list[Array] = []
    states = 0
    while env.is_running.any() and len(rewards) < steps:
        is_running, done = env.is_running, env.worlds.count["done"].copy()
        outlooks.append(tuple(part[is_running] for part in look_out(env.worlds)))
        state_of_world = states + np.cumsum(is_running) - 1  # (worlds,)
        states += int(is_running.sum())
        view = env.view()
        relations = relate(view)
        has_choice = is_open_question(view, relations.is_legal)
        choice = np.zeros(len(view.slot), dtype=np.int64)
        choice[has_choice], log_prob = choose(view, relations, has_choice)
        kept = tuple(part[has_choice] for part in relations)
        in_state = state_of_world[view.world[has_choice]]
        decisions.append((*kept, choice[has_choice], log_prob, in_state))
        wanted = wanted_counts(view, choice)
        by_rule = JoinAll().decide(view).wanted
        env.step(Decision(np.where(has_choice[:, None], wanted, by_rule)))
        gained = env.worlds.count["done"] - done
        rewards.append(np.where(is_running, reward.step + reward.done * gained, 0.0))
        running.append(is_running)
    *tokens, choices, log_probs, state = _concatenate(decisions)
    return Rollout(
        tokens=Tokens(*tokens),
        choice=choices,
        log_prob=log_probs,
        state=state,
        outlook=_concatenate(outlooks),
        last_outlook=_tensors(look_out(env.worlds)),
        is_running=np.array(running),
        rewards=np.array(rewards, dtype=np.float32),
        has_ended=env.worlds.count["status"] == COMPLETED,
    )


def sampler(network: RelationalPolicy, generator: torch.Generator) -> Chooser:
    """Return a chooser that samples from a network."""

    def choose(view: View, relations: Relations, has_choice: Array) -> tuple[Array, Array]:
        with torch.no_grad():
            log_probs = torch.log_softmax(network(to_tokens(relations, has_choice)), dim=-1)
            choice = torch.multinomial(log_probs.exp(), 1, generator=generator)
            return choice[:, 0].numpy(), log_probs.gather(1, choice)[:, 0].numpy()

    return choose


def to_tokens(relations: Relations, rows: Array) -> Tokens:
    """Return some rows of relations as tensors."""
    return Tokens(*(torch.from_numpy(part[rows]) for part in relations))


def credit(
    rollout: Rollout, critic: Critic, discount: float, decay: float
) -> tuple[Tensor, Tensor]:
    """Return every state's advantage and the return that the critic should have said (states,)."""
    with torch.no_grad():
        of_states = critic(*rollout.outlook).numpy()
        of_last = critic(*rollout.last_outlook).numpy()
    is_running = rollout.is_running
    values = np.zeros((len(is_running) + 1, is_running.shape[1]), dtype=np.float32)
    values[:-1][is_running] = of_states  # both in step and world order
    values[-1] = np.where(rollout.has_ended, 0.0, of_last)
    gains = advantages(rollout.rewards, values, is_running, discount, decay)[is_running]
    return torch.from_numpy(gains), torch.from_numpy(gains + of_states)


def _concatenate(rows: list[tuple[Array, ...]]) -> tuple[Tensor, ...]:
    return tuple(torch.from_numpy(np.concatenate(parts)) for parts in zip(*rows, strict=True))


def _tensors(outlook: Outlook) -> tuple[Tensor, ...]:
    return tuple(torch.from_numpy(part) for part in outlook)
