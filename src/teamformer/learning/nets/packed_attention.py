"""Attention among packed tokens: what `blocks.Attention` does, with nothing computed for padding.

Half of a batch of views is padding, and one product of small matrices after the other costs more
than what is computed in them. So here a kernel goes from team to team. It is for the processor.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import torch
from torch import Tensor

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import entry


class Packing(NamedTuple):
    """Where the tokens of each team stand among packed ones, (packed, d)."""

    first: Array  # (teams + 1,) where each team's begin in `place`
    place: Array  # (packed,) the rows of tokens, team by team


def packing_of(*is_there: Array) -> Packing:
    """Return how tokens are packed that are there, True in arrays (teams, tokens) of several kinds.

    Packed, all of the first kind come before all of the second; each team has both.
    """
    together = np.concatenate(is_there, axis=1)  # (teams, all tokens)
    row, number, column = np.zeros(together.shape, dtype=np.int64), 0, 0
    for kind in is_there:
        count = int(np.count_nonzero(kind))
        row[:, column : column + kind.shape[1]][kind] = np.arange(number, number + count)
        number, column = number + count, column + kind.shape[1]
    first = np.zeros(len(together) + 1, dtype=np.int64)
    np.cumsum(together.sum(axis=1), out=first[1:])
    return Packing(first, row[together])


def packed(parts: tuple[Tensor, ...], is_there: Tensor) -> tuple[Tensor, ...]:
    """Return the tokens that are there, (packed, ...), of parts (teams, tokens, ...)."""
    place = is_there.flatten().nonzero()[:, 0]
    return tuple(part.flatten(0, 1).index_select(0, place) for part in parts)


def padded(tokens: Tensor, is_there: Tensor) -> Tensor:
    """Return packed tokens (packed, d) at their places, (teams, tokens, d), and zeros elsewhere."""
    place = is_there.flatten().nonzero()[:, 0]
    nothing = tokens.new_zeros(is_there.numel(), tokens.shape[1])
    return nothing.index_copy(0, place, tokens).view(*is_there.shape, -1)


def attend(
    query: Tensor, key_value: Tensor, asking: Packing, told: Packing, heads: int, is_causal: bool
) -> Tensor:
    """Return what tokens (asking, d) find in the keys and values (told, 2 d) of their team.

    If `is_causal`, a team's tokens are told of those before them and of themselves.
    """
    found: Tensor = _Attend.apply(query, key_value, asking, told, heads, is_causal)  # type: ignore[no-untyped-call]
    return found


class _Attend(torch.autograd.Function):
    """The kernels below as a step that gradients go through."""

    @staticmethod
    def forward(
        ctx: Any,
        query: Tensor,
        key_value: Tensor,
        asking: Packing,
        told: Packing,
        heads: int,
        is_causal: bool,
    ) -> Tensor:
        pairs = int((np.diff(asking.first) * np.diff(told.first)).sum())
        share, found = torch.empty(pairs * heads), torch.zeros_like(query)
        arrays = [part.detach().numpy() for part in (query, key_value, share, found)]
        _attend(*arrays, *asking, *told, heads, is_causal)
        ctx.save_for_backward(query, key_value, share, found)
        ctx.about = (*asking, *told, heads, is_causal)
        return found

    @staticmethod
    @torch.autograd.function.once_differentiable
    def backward(ctx: Any, gradient: Tensor) -> tuple[Tensor | None, ...]:
        query, key_value, share, found = ctx.saved_tensors
        of_query, of_key_value = torch.zeros_like(query), torch.zeros_like(key_value)
        parts = (query, key_value, share, found, gradient.contiguous(), of_query, of_key_value)
        _attend_back(*(part.detach().numpy() for part in parts), *ctx.about)
        return of_query, of_key_value, None, None, None, None


@entry
def _attend(
    query: Array,
    key_value: Array,
    share: Array,
    found: Array,
    first: Array,
    place: Array,
    told_first: Array,
    told_place: Array,
    heads: int,
    is_causal: bool,
) -> None:
    """Write what is found, and the shares of each token's head that it is found by, in turn."""
    d = query.shape[1]
    width = d // heads
    scale, pair = np.float32(1.0 / np.sqrt(width)), 0
    for team in range(len(first) - 1):
        for number in range(first[team + 1] - first[team]):
            at = place[first[team] + number]
            begin = told_first[team]
            count = number + 1 if is_causal else told_first[team + 1] - begin
            for head in range(heads):
                low = head * width
                most = np.float32(-np.inf)
                for j in range(count):
                    to, alike = told_place[begin + j], np.float32(0.0)
                    for c in range(low, low + width):
                        alike += query[at, c] * key_value[to, c]
                    share[pair + j] = alike * scale
                    most = max(most, share[pair + j])
                total = np.float32(0.0)
                for j in range(count):
                    share[pair + j] = np.exp(share[pair + j] - most)
                    total += share[pair + j]
                for j in range(count):
                    share[pair + j] /= total
                    to = told_place[begin + j]
                    for c in range(low, low + width):
                        found[at, c] += share[pair + j] * key_value[to, d + c]
                pair += count


@entry
def _attend_back(
    query: Array,
    key_value: Array,
    share: Array,
    found: Array,
    gradient: Array,
    of_query: Array,
    of_key_value: Array,
    first: Array,
    place: Array,
    told_first: Array,
    told_place: Array,
    heads: int,
    is_causal: bool,
) -> None:
    """Add the gradients of queries, keys and values, given those of what was found."""
    d = query.shape[1]
    width = d // heads
    scale, pair = np.float32(1.0 / np.sqrt(width)), 0
    for team in range(len(first) - 1):
        for number in range(first[team + 1] - first[team]):
            at = place[first[team] + number]
            begin = told_first[team]
            count = number + 1 if is_causal else told_first[team + 1] - begin
            for head in range(heads):
                low = head * width
                mean = np.float32(0.0)
                for c in range(low, low + width):
                    mean += gradient[at, c] * found[at, c]
                for j in range(count):
                    to, of_share = told_place[begin + j], np.float32(0.0)
                    for c in range(low, low + width):
                        of_share += gradient[at, c] * key_value[to, d + c]
                    of_alike = share[pair + j] * (of_share - mean) * scale
                    for c in range(low, low + width):
                        of_query[at, c] += of_alike * key_value[to, c]
                        of_key_value[to, c] += of_alike * query[at, c]
                        of_key_value[to, d + c] += share[pair + j] * gradient[at, c]
                pair += count
