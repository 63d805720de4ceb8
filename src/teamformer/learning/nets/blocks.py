"""Parts of a pre-norm transformer, with keys and values that can be kept between calls."""

from __future__ import annotations

import torch
from torch import Tensor, nn

from teamformer.learning.nets.actor import REFUSED
from teamformer.learning.nets.packed_attention import Packing, attend

Memory = tuple[Tensor, Tensor]
"""Keys and values, each (teams, heads, tokens, d / heads)."""


class Attention(nn.Module):
    """Multi-head attention; keys and values are made apart, so that a caller can keep them."""

    def __init__(self, d: int, heads: int) -> None:
        super().__init__()
        self.heads = heads
        self.scale = (d // heads) ** -0.5
        self.query = nn.Linear(d, d)
        self.key_value = nn.Linear(d, 2 * d)
        self.out = nn.Linear(d, d)

    def memory(self, tokens: Tensor) -> Memory:
        """Return the keys and values of tokens (teams, tokens, d)."""
        keys, values = self.key_value(tokens).chunk(2, dim=-1)
        return self._by_head(keys), self._by_head(values)

    def forward(self, asking: Tensor, memory: Memory, is_seen: Tensor | None) -> Tensor:
        """Return what `asking` (teams, steps, d) finds in the memory, of the same shape.

        `is_seen` (teams or 1, 1, steps or 1, tokens) says what may be looked at; None is all.
        """
        query = self._by_head(self.query(asking))  # (teams, heads, steps, d / heads)
        keys, values = memory
        alike = keys @ (query * self.scale).transpose(2, 3)  # (teams, heads, tokens, steps)
        if is_seen is not None:
            alike = alike.masked_fill(~is_seen.transpose(2, 3), REFUSED)
        share = alike.softmax(dim=2).transpose(2, 3)  # over another axis than the last it is faster
        found = share @ values  # plain, since exported it runs faster so
        out: Tensor = self.out(found.transpose(1, 2).flatten(2))
        return out

    def packed(
        self,
        asking: Tensor,
        tokens: Tensor,
        of_asking: Packing,
        of_tokens: Packing,
        is_causal: bool,
    ) -> Tensor:
        """Return what packed tokens (asking, d) find in others of their team (tokens, d)."""
        query, key_value = self.query(asking), self.key_value(tokens)
        out: Tensor = self.out(
            attend(query, key_value, of_asking, of_tokens, self.heads, is_causal)
        )
        return out

    def _by_head(self, tokens: Tensor) -> Tensor:
        by_head = tokens.view(*tokens.shape[:2], self.heads, -1)
        return by_head.transpose(1, 2)


class EncoderLayer(nn.Module):
    """Self-attention among tokens, and a layer on each."""

    def __init__(self, d: int, heads: int, hidden: int) -> None:
        super().__init__()
        self.norm = nn.LayerNorm(d)
        self.attention = Attention(d, heads)
        self.feed = _feed_forward(d, hidden)

    def forward(self, tokens: Tensor, is_there: Tensor) -> Tensor:
        """Return tokens (teams, tokens, d) that know of the others that are there."""
        normed = self.norm(tokens)
        memory = self.attention.memory(normed)
        tokens = tokens + self.attention(normed, memory, is_there[:, None, None])
        out: Tensor = tokens + self.feed(tokens)
        return out

    def packed(self, tokens: Tensor, packing: Packing) -> Tensor:
        """Return the same of packed tokens (packed, d)."""
        normed = self.norm(tokens)
        tokens = tokens + self.attention.packed(normed, normed, packing, packing, is_causal=False)
        out: Tensor = tokens + self.feed(tokens)
        return out


class DecoderLayer(nn.Module):
    """Attention to the symbols so far, then to the encoded tokens, and a layer on each symbol."""

    def __init__(self, d: int, heads: int, hidden: int) -> None:
        super().__init__()
        self.norm = nn.LayerNorm(d)
        self.attention = Attention(d, heads)
        self.cross_norm = nn.LayerNorm(d)
        self.cross_attention = Attention(d, heads)
        self.feed = _feed_forward(d, hidden)

    def forward(
        self, steps: Tensor, before: Memory | None, tokens: Memory, is_there: Tensor
    ) -> tuple[Tensor, Memory]:
        """Return the new steps (teams, steps, d) and the memory of all steps so far.

        Each new step sees those of which there is a memory, those before it, and itself.
        """
        normed = self.norm(steps)
        memory = self.attention.memory(normed)
        if before is not None:
            memory = (torch.cat([before[0], memory[0]], 2), torch.cat([before[1], memory[1]], 2))
        is_seen = _is_not_later(steps.shape[1], memory[0].shape[2], steps.device)
        steps = steps + self.attention(normed, memory, is_seen)
        across = self.cross_attention(self.cross_norm(steps), tokens, is_there[:, None, None])
        steps = steps + across
        return steps + self.feed(steps), memory

    def packed(
        self, steps: Tensor, tokens: Tensor, of_steps: Packing, of_tokens: Packing
    ) -> Tensor:
        """Return the same of packed steps (steps, d), all of a team at once."""
        normed = self.norm(steps)
        steps = steps + self.attention.packed(normed, normed, of_steps, of_steps, is_causal=True)
        asking = self.cross_norm(steps)
        across = self.cross_attention.packed(asking, tokens, of_steps, of_tokens, is_causal=False)
        steps = steps + across
        out: Tensor = steps + self.feed(steps)
        return out


def _feed_forward(d: int, hidden: int) -> nn.Sequential:
    return nn.Sequential(nn.LayerNorm(d), nn.Linear(d, hidden), nn.ReLU(), nn.Linear(hidden, d))


def _is_not_later(new: int, steps: int, device: torch.device) -> Tensor:
    """Return which of all steps are not later than each of the last `new` ones.

    The result is (1, 1, new, steps).
    """
    places = torch.arange(steps, device=device)
    last = torch.arange(new, device=device).unsqueeze(1) + (steps - new)  # (new, 1)
    return (places <= last)[None, None]
