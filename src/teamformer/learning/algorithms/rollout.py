"""Rollouts: many worlds played to their end, and what is learned from of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import torch
from torch import Tensor

from teamformer.base.array_types import Array
from teamformer.learning.algorithms.global_state import GlobalState, global_state_of
from teamformer.learning.algorithms.reward_streams import TrainingReward
from teamformer.learning.nets.actor import Actor
from teamformer.methods.learned.codec import Codec
from teamformer.methods.learned.policy import rows_of
from teamformer.methods.scripted.joining import JoinAll
from teamformer.world.env import Decision, TeamFormation
from teamformer.world.state.arrays import RUNNING, STEP_LIMIT

Chooser = Callable[[tuple[Array, ...]], tuple[Array, Array]]
"""From the tokens of the teams that have a choice, their actions and log-probabilities."""


@dataclass(frozen=True)
class Rollout:
    """What was played: decisions (a row each, forced ones left out) and world states.

    A state is a running world before a step; `state` says which one each decision was made in.
    What streams are is said in `train.learning.reward_streams`.
    """

    tokens: tuple[Tensor, ...]  # each (decisions, ...)
    action: Tensor  # (decisions, ...)
    log_prob: Tensor  # (decisions,)
    state: Tensor  # (decisions,)
    share: Tensor  # (decisions, streams) of the streams that a decision is credited with
    global_state: tuple[Tensor, ...]  # each (states, ...)
    value_of: Tensor  # (states, streams) which of the critic's values, or -1
    last_global_state: tuple[Tensor, ...]  # each (worlds, ...) after the last step
    last_value_of: Tensor  # (worlds, streams)
    is_running: Array  # (steps, worlds)
    rewards: Array  # (steps, worlds, streams)
    has_ended: Array  # (worlds,) nothing more can be earned, rather than cut off


@dataclass
class _Record:
    """The same, as it grows step by step."""

    decisions: list[tuple[Array, ...]] = field(default_factory=list)
    actions: list[Array] = field(default_factory=list)
    states: list[tuple[Array, ...]] = field(default_factory=list)
    is_running: list[Array] = field(default_factory=list)
    rewards: list[Array] = field(default_factory=list)


def play(
    env: TeamFormation, codec: Codec, choose: Chooser, reward: TrainingReward, steps: int
) -> Rollout:
    """Play all worlds of an environment to their end or for `steps` steps."""
    record, first_state = _Record(), 0
    while env.is_running.any() and len(record.rewards) < steps:
        is_running, done = env.is_running, env.worlds.count["done"].copy()
        seen = (*global_state_of(env.worlds), reward.values_of(env))
        record.states.append(tuple(part[is_running] for part in seen))
        state_of_world = first_state + np.cumsum(is_running) - 1  # (worlds,)
        first_state += int(is_running.sum())
        _decide(env, codec, choose, reward, record, state_of_world)
        earned = np.where(is_running[:, None], reward.earned(env, done), 0.0)
        record.rewards.append(earned)
        record.is_running.append(is_running)
    return _rollout(env, record, reward)


def _decide(
    env: TeamFormation,
    codec: Codec,
    choose: Chooser,
    reward: TrainingReward,
    record: _Record,
    state_of_world: Array,
) -> None:
    """Make one step, as `Learned` does; note the decisions of teams that have a choice."""
    view = env.view()
    tokens = codec.encode(view)
    rows = np.flatnonzero(codec.has_choice(view, tokens))
    wanted = JoinAll().decide(view).wanted
    if len(rows):
        kept = tuple(part[rows] for part in tokens)
        action, log_prob = choose(kept)
        wanted[rows] = codec.decode(rows_of(view, rows), action)
        share = reward.share_of(view, rows, env.worlds.robots.shape[1])
        record.decisions.append((*kept, log_prob, state_of_world[view.world[rows]], share))
        record.actions.append(action)
    env.step(Decision(wanted))


def _rollout(env: TeamFormation, record: _Record, reward: TrainingReward) -> Rollout:
    *tokens, log_prob, state, share = _concatenate(record.decisions)
    *global_state, value_of = _concatenate(record.states)
    return Rollout(
        tokens=tuple(tokens),
        action=torch.from_numpy(np.concatenate(record.actions)),
        log_prob=log_prob,
        state=state,
        share=share,
        global_state=tuple(global_state),
        value_of=value_of,
        last_global_state=_tensors(global_state_of(env.worlds)),
        last_value_of=torch.from_numpy(reward.values_of(env)),
        is_running=np.array(record.is_running),
        rewards=np.array(record.rewards, dtype=np.float32),
        has_ended=~np.isin(env.worlds.count["status"], (RUNNING, STEP_LIMIT)),
    )


def sampler(network: Actor, generator: torch.Generator | None, device: str = "cpu") -> Chooser:
    """Return a chooser that samples from a network; without a generator, the likeliest."""

    def choose(tokens: tuple[Array, ...]) -> tuple[Array, Array]:
        with torch.inference_mode():
            given = tuple(torch.from_numpy(part).to(device) for part in tokens)
            action, log_prob = network.act(given, generator)
        return action.cpu().numpy(), log_prob.cpu().numpy()

    return choose


def _concatenate(rows: list[tuple[Array, ...]]) -> tuple[Tensor, ...]:
    return tuple(torch.from_numpy(np.concatenate(parts)) for parts in zip(*rows, strict=True))


def _tensors(global_state: GlobalState) -> tuple[Tensor, ...]:
    return tuple(torch.from_numpy(part) for part in global_state)
