"""The paper's network: encodes teams and tasks, then spells the capabilities that a team wants.

After Boehme and Hollinger's Teamformer (ICRA 2026, section IV): capabilities have learned
embeddings, an encoder attends among the tokens of teams and tasks, and a decoder generates the
wanted capabilities one at a time. `nets.action_mask` says what may come next.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import torch
from torch import Tensor, nn

from teamformer.learning.nets.action_mask import (
    EDIT,
    FULL,
    Grammar,
    changes,
    grammar_of,
    legal_symbols,
    sole_targets,
    spell,
    steps_with_a_choice,
)
from teamformer.learning.nets.actor import REFUSED
from teamformer.learning.nets.blocks import Attention, DecoderLayer, EncoderLayer, Memory

KEY_FEATURES = 7


class Tokens(NamedTuple):
    """What the network sees of each deciding team: itself first among the teams.

    Padding is False in `is_team` and `is_task`. `singles` and `profiles` are those of `Grammar`.
    """

    teams: Tensor  # (teams, seen, team features)
    team_counts: Tensor  # (teams, seen, caps)
    tasks: Tensor  # (teams, tasks, task features)
    task_needs: Tensor  # (teams, tasks, caps)
    is_team: Tensor  # (teams, seen) bool
    is_task: Tensor  # (teams, tasks) bool
    can_join: Tensor  # (teams, seen) bool
    singles: Tensor  # (teams, caps)
    profiles: Tensor  # (teams, profiles, caps)


@dataclass(frozen=True)
class TeamformerSettings:
    """Sizes of the network; the features are those of `policies.spelling`."""

    capabilities: int
    team_features: int
    task_features: int
    spelling: str = EDIT  # the paper spells in full
    width: int = 32  # d_model of the authors' code
    hidden: int = 64  # feed-forward; 2048 in the authors' code
    heads: int = 4
    encoder_layers: int = 1
    decoder_layers: int = 1
    maintain_bias: float = 3.0  # what the symbols that go on to maintain begin with


class Encoded(NamedTuple):
    """What the decoder needs of an encoded view."""

    is_there: Tensor  # (teams, tokens) bool
    keys: Tensor  # (teams, caps, d) of the capabilities, as this team sees them
    memories: tuple[Memory, ...]  # for each decoder layer, of the encoded tokens


class _Spellers(NamedTuple):
    """The teams that are still spelling."""

    rows: Tensor  # (teams,) in the batch
    change: Tensor  # (teams, 1, caps) made by the last symbol
    is_legal: Tensor  # (teams, 1, symbols)
    is_maintain: Tensor  # (teams, 1, symbols)
    grammar: Grammar
    encoded: Encoded
    before: tuple[Memory, ...] | None  # of the steps so far, for each layer


class Teamformer(nn.Module):
    """Spells the capabilities that teams want; an action is the counts wanted, (teams, caps)."""

    def __init__(self, settings: TeamformerSettings) -> None:
        super().__init__()
        assert settings.spelling in (EDIT, FULL)
        d, caps = settings.width, settings.capabilities
        layer = (d, settings.heads, settings.hidden)
        self.settings = settings
        self.capability = nn.Parameter(torch.randn(caps, d) / caps**0.5)
        self.team_in = nn.Linear(settings.team_features, d)
        self.task_in = nn.Linear(settings.task_features, d)
        self.needs_in = nn.Linear(d, d, bias=False)
        self.encoder = nn.ModuleList(EncoderLayer(*layer) for _ in range(settings.encoder_layers))
        self.encoded_norm = nn.LayerNorm(d)
        self.key_in = nn.Linear(KEY_FEATURES, d, bias=False)
        self.first_step = nn.Parameter(torch.zeros(d))
        self.so_far = nn.Linear(d, d)
        self.decoder = nn.ModuleList(DecoderLayer(*layer) for _ in range(settings.decoder_layers))
        self.out_norm = nn.LayerNorm(d)
        self.directions = 1 if settings.spelling == FULL else 2  # add and drop
        self.out = nn.Linear(d, self.directions * d)
        self.end = nn.Linear(d, 1)
        self.maintain_bias = nn.Parameter(torch.tensor(settings.maintain_bias))
        for head in (self.out, self.end):
            nn.init.normal_(head.weight, std=0.01)
            nn.init.zeros_(head.bias)

    def begin_by_copying(self) -> None:
        """Set the weights so that the decoder asks to add what the tokens it attends to have.

        What is left to learn is whom to attend to. From small weights a network that is to name
        one of several teams, and has a hundred capabilities in thirty-two numbers, has to learn
        both at once, of which neither pays alone.
        """
        d = self.settings.width
        with torch.no_grad():
            nn.init.normal_(self.capability, std=d**-0.5)  # of length one
            for layer in self.decoder:
                attention = layer.cross_attention
                assert isinstance(attention, Attention)
                attention.key_value.weight[d:] = torch.eye(d)
                attention.key_value.bias[d:] = 0.0
                attention.out.weight.copy_(torch.eye(d))
                attention.out.bias.zero_()
            self.out.weight[:d] = torch.eye(d)

    def encode(self, tokens: Tokens) -> Encoded:
        """Return what the decoder needs, made once for all its steps."""
        have = tokens.team_counts @ self.capability  # (teams, seen, d)
        needs = self.needs_in(tokens.task_needs @ self.capability)  # (teams, tasks, d)
        encoded = torch.cat(
            [self.team_in(tokens.teams) + have, self.task_in(tokens.tasks) + needs], dim=1
        )  # (teams, tokens, d)
        is_there = torch.cat([tokens.is_team, tokens.is_task], dim=1)  # (teams, tokens)
        for layer in self.encoder:
            encoded = layer(encoded, is_there)
        encoded = self.encoded_norm(encoded)
        keys = self.capability + self.key_in(key_features(tokens))  # (teams, caps, d)
        memories = tuple(layer.cross_attention.memory(encoded) for layer in self.decoder)  # type: ignore[union-attr, operator]
        return Encoded(is_there, keys, memories)

    def decode(
        self, encoded: Encoded, change: Tensor, spelled: Tensor, before: tuple[Memory, ...] | None
    ) -> tuple[Tensor, tuple[Memory, ...]]:
        """Return the scores of the next symbols (teams, steps, symbols) and the steps' memories.

        `change` (teams, steps, caps) is what the symbol before each step changed, nothing at the
        first; `spelled` is the sum of the changes up to there.
        """
        is_first = (spelled == 0).all(dim=-1, keepdim=True)  # (teams, steps, 1)
        steps = change @ self.capability + self.so_far(spelled @ self.capability)
        steps = steps + is_first.to(steps.dtype) * self.first_step  # (teams, steps, d)
        memories = []
        for number, layer in enumerate(self.decoder):
            kept = None if before is None else before[number]
            steps, memory = layer(steps, kept, encoded.memories[number], encoded.is_there)
            memories.append(memory)
        return self._scores(self.out_norm(steps), encoded.keys), tuple(memories)

    def act(
        self, tokens: tuple[Tensor, ...], generator: torch.Generator | None
    ) -> tuple[Tensor, Tensor]:
        """Return wanted counts (teams, caps) int64 and their log-probabilities (teams,).

        Teams that can only end, or only reach one target, take no part in further steps: what
        would follow is certain.
        """
        given = Tokens(*tokens)
        own = given.team_counts[:, 0]
        spelled, log_prob = torch.zeros_like(own), own.new_zeros(len(own))
        spellers = self._begin(given)
        while len(spellers.rows):
            rows, now = spellers.rows, spelled[spellers.rows].unsqueeze(1)  # (teams, 1, caps)
            scores, memories = self.decode(spellers.encoded, spellers.change, now, spellers.before)
            said = self.log_probs(scores, spellers.is_legal, spellers.is_maintain)[:, 0]
            symbol = _pick(said, generator)  # (teams, 1)
            log_prob[rows] += said.gather(1, symbol)[:, 0]
            change = changes(self.settings.spelling, symbol, own.shape[1])  # (teams, 1, caps)
            spelled[rows] += change[:, 0]
            is_sole, target = sole_targets(
                self.settings.spelling, spellers.grammar, now + change
            )  # (teams,), (teams, caps)
            spelled[rows] = torch.where(is_sole[:, None], target, spelled[rows])
            has_ended = is_sole | (symbol[:, 0] == said.shape[1] - 1)
            spellers = self._go_on(spellers, now + change, change, memories, has_ended)
        return self._wanted(given, spelled), log_prob

    def evaluate(self, tokens: tuple[Tensor, ...], action: Tensor) -> tuple[Tensor, Tensor]:
        """Return log-probability and entropy (teams,) of wanted counts, in one pass.

        The entropy is the sum over the steps of the spelling; those that are certain are left out.
        """
        given = Tokens(*tokens)
        spelling, caps = self.settings.spelling, action.shape[1]
        grammar = self.grammar(given)
        steps = steps_with_a_choice(spelling, grammar, action)  # (teams,)
        symbol, is_there = spell(spelling, grammar.own, action, steps)  # (teams, steps)
        change = changes(spelling, symbol, caps)[:, :-1]  # (teams, steps - 1, caps)
        change = nn.functional.pad(change, (0, 0, 1, 0))  # (teams, steps, caps)
        spelled = change.cumsum(dim=1)
        is_legal, is_maintain = legal_symbols(spelling, grammar, spelled)
        scores, _ = self.decode(self.encode(given), change, spelled, None)
        said = self.log_probs(scores, is_legal, is_maintain)  # (teams, steps, symbols)
        log_prob = said.gather(2, symbol.unsqueeze(2))[..., 0] * is_there
        entropy = -(said.exp() * said).sum(dim=-1) * is_there
        return log_prob.sum(dim=1), entropy.sum(dim=1)

    def grammar(self, tokens: Tokens) -> Grammar:
        """Return what the teams may want."""
        return grammar_of(
            self.settings.spelling,
            tokens.team_counts,
            tokens.can_join,
            tokens.singles,
            tokens.profiles,
        )

    def log_probs(self, scores: Tensor, is_legal: Tensor, is_maintain: Tensor) -> Tensor:
        """Return the log-probabilities of the legal symbols; those of others are below -1e8."""
        scores = scores + self.maintain_bias * is_maintain.to(scores.dtype)
        return scores.masked_fill(~is_legal, REFUSED).log_softmax(dim=-1)

    def _begin(self, tokens: Tokens) -> _Spellers:
        grammar = self.grammar(tokens)
        nothing = torch.zeros_like(grammar.own).unsqueeze(1)  # (teams, 1, caps)
        legal = legal_symbols(self.settings.spelling, grammar, nothing)
        rows = torch.arange(len(nothing), device=nothing.device)
        return _Spellers(rows, nothing, *legal, grammar, self.encode(tokens), None)

    def _go_on(
        self,
        spellers: _Spellers,
        spelled: Tensor,
        change: Tensor,
        memories: tuple[Memory, ...],
        has_ended: Tensor,
    ) -> _Spellers:
        """Return the teams that have more to say than the end."""
        legal = legal_symbols(self.settings.spelling, spellers.grammar, spelled)
        spellers = spellers._replace(
            change=change, is_legal=legal[0], is_maintain=legal[1], before=memories
        )
        has_ended = has_ended | ~legal[0][:, 0, :-1].any(dim=-1)
        return _only(spellers, ~has_ended) if has_ended.any() else spellers

    def _scores(self, steps: Tensor, keys: Tensor) -> Tensor:
        asking = self.out(steps).unflatten(-1, (self.directions, -1))  # (teams, steps, ways, d)
        of_caps = (asking.flatten(1, 2) @ keys.transpose(1, 2)).unflatten(
            1, (-1, self.directions)
        )  # (teams, steps, ways, caps)
        return torch.cat([of_caps.flatten(2), self.end(steps)], dim=-1)

    def _wanted(self, tokens: Tokens, spelled: Tensor) -> Tensor:
        if self.settings.spelling == EDIT:
            spelled = spelled + tokens.team_counts[:, 0]
        return spelled.round().long()


def key_features(tokens: Tokens) -> Tensor:
    """Return what a team's view says of each capability, as (teams, caps, KEY_FEATURES)."""
    own = tokens.team_counts[:, 0]  # (teams, caps)
    joinable = tokens.team_counts * tokens.can_join.unsqueeze(-1)  # (teams, seen, caps)
    needs = tokens.task_needs * tokens.is_task.unsqueeze(-1)  # (teams, tasks, caps)
    lacks = needs > own.unsqueeze(1)
    open_tasks = tokens.is_task.sum(dim=1, keepdim=True).clamp(min=1)  # (teams, 1)
    first_needs = needs[:, 0]
    features = [
        own.clamp(max=4.0) / 4,
        joinable.sum(dim=1).clamp(max=4.0) / 4,
        (first_needs > own).float(),
        ((first_needs < own) & (own > 0)).float(),
        lacks.any(dim=1).float(),
        (needs > 0).sum(dim=1) / open_tasks,
        lacks.sum(dim=1) / open_tasks,
    ]
    return torch.stack(features, dim=-1)


def _pick(said: Tensor, generator: torch.Generator | None) -> Tensor:
    """Return a symbol for each row of log-probabilities, as (teams, 1)."""
    if generator is None:
        return said.argmax(dim=-1, keepdim=True)
    return torch.multinomial(said.exp(), 1, generator=generator)


def _only(part: Any, kept: Tensor) -> Any:
    """Return the kept rows of a tensor or of all tensors in nested tuples."""
    if part is None or isinstance(part, Tensor):
        return part if part is None else part[kept]
    inner = (_only(inside, kept) for inside in part)
    return type(part)(*inner) if hasattr(part, "_fields") else tuple(inner)
