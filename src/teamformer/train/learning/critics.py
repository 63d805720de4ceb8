"""Critics: small networks that are taught what choices gain, and tested on other worlds."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import torch
from torch import nn

from teamformer.sim.arrays import Array

WIDTH, EPOCHS, MINIBATCH = 32, 60, 64
LEARNING_RATE, DECAY = 1e-3, 1e-2
LARGEST_GAIN = 10.0
"""Steps; gains are clipped here for learning, so that one mission outweighs nothing else."""


class Taught(NamedTuple):
    """What critics promise for choices in worlds that they never saw, and how they learned."""

    promised: Array  # (rows,) steps
    learned: Array  # (epochs,) mean square error on what is learned from, of that of the mean
    unseen: Array  # (epochs,) the same on other worlds


def teach_critics(features: Array, gain: Array, fold: Array, seed: int = 0) -> Taught:
    """Teach one network for each part of the worlds, from the choices in all others.

    `features` (rows, numbers) are what is known of a choice, `gain` (rows,) the steps that it won,
    `fold` (rows,) the part of the worlds that it was made in; there are two or more.
    Squared errors are fitted by AdamW (Loshchilov and Hutter 2019); features are standardised by
    what is learned from. An error of 1 is that of who always says the mean.
    """
    features = features.astype(np.float32)
    gain = gain.astype(np.float32).clip(-LARGEST_GAIN, LARGEST_GAIN)
    promised = np.zeros(len(gain))
    curves = []
    for part in np.unique(fold).tolist():
        is_other = fold != part
        said, *curve = _teach(features, gain, is_other, seed + part)
        promised[~is_other] = said[~is_other]
        curves.append(curve)
    learned, unseen = np.mean(curves, axis=0)
    return Taught(promised, learned, unseen)


def _teach(
    features: Array, gain: Array, is_taught: Array, seed: int
) -> tuple[Array, list[float], list[float]]:
    """Return what a network says about all rows, and its errors after each epoch."""
    generator = torch.Generator().manual_seed(seed)
    mean, spread = features[is_taught].mean(axis=0), features[is_taught].std(axis=0) + 1e-6
    inputs = torch.from_numpy((features - mean) / spread)
    targets = torch.from_numpy(gain - gain[is_taught].mean())
    rows, others = (torch.from_numpy(np.flatnonzero(part)) for part in (is_taught, ~is_taught))
    network = _network(features.shape[1], generator)
    optimiser = torch.optim.AdamW(network.parameters(), LEARNING_RATE, weight_decay=DECAY)
    errors: tuple[list[float], list[float]] = ([], [])
    for _ in range(EPOCHS):
        for batch in torch.split(rows[torch.randperm(len(rows), generator=generator)], MINIBATCH):
            loss = (network(inputs[batch])[:, 0] - targets[batch]).square().mean()
            optimiser.zero_grad()
            loss.backward()
            optimiser.step()
        with torch.no_grad():
            wrong_by = (network(inputs)[:, 0] - targets).square()
            for part, curve in zip((rows, others), errors, strict=True):
                curve.append(float(wrong_by[part].mean() / targets[part].square().mean()))
    with torch.no_grad():
        said = network(inputs)[:, 0].numpy() + gain[is_taught].mean()
    return said, *errors


def _network(inputs: int, generator: torch.Generator) -> nn.Module:
    network = nn.Sequential(
        nn.Linear(inputs, WIDTH), nn.ReLU(), nn.Linear(WIDTH, WIDTH), nn.ReLU(), nn.Linear(WIDTH, 1)
    )
    for weights in network.parameters():
        if weights.ndim == 2:
            nn.init.kaiming_uniform_(weights, generator=generator)
        else:
            nn.init.zeros_(weights)
    return network
