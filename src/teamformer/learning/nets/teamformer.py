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
    one_hot,
    sole_targets,
    spell,
    steps_with_a_choice,
)
from teamformer.learning.nets.actor import REFUSED
from teamformer.learning.nets.blocks import Attention, DecoderLayer, EncoderLayer, Memory
from teamformer.learning.nets.packed_attention import Packing, packed, packing_of, padded

KEY_FEATURES = 7
CHUNK = 2048
"""Of decisions that are spelled at a time."""


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


class Spelling(NamedTuple):
    """How wanted counts are spelled, up to where the rest is certain."""

    symbol: Tensor  # (teams, steps)
    is_there: Tensor  # (teams, steps) False for padding
    is_legal: Tensor  # (teams, steps, symbols) which symbols could come here
    maintain: Tensor  # (teams, steps) the symbol that goes on to maintain, or -1


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
        teams = self._team_tokens(tokens.teams, tokens.team_counts)  # (teams, seen, d)
        tasks = self._task_tokens(tokens.tasks, tokens.task_needs)  # (teams, tasks, d)
        encoded = torch.cat([teams, tasks], dim=1)  # (teams, tokens, d)
        is_there = torch.cat([tokens.is_team, tokens.is_task], dim=1)  # (teams, tokens)
        for layer in self.encoder:
            encoded = layer(encoded, is_there)
        encoded = self.encoded_norm(encoded)
        memories = tuple(layer.cross_attention.memory(encoded) for layer in self.decoder)  # type: ignore[union-attr, operator]
        return Encoded(is_there, self._keys(tokens), memories)

    def decode(
        self, encoded: Encoded, change: Tensor, spelled: Tensor, before: tuple[Memory, ...] | None
    ) -> tuple[Tensor, tuple[Memory, ...]]:
        """Return the scores of the next symbols (teams, steps, symbols) and the steps' memories.

        `change` (teams, steps, caps) is what the symbol before each step changed, nothing at the
        first; `spelled` is the sum of the changes up to there.
        """
        steps, memories = self._steps(change, spelled), list[Memory]()
        for number, layer in enumerate(self.decoder):
            kept = None if before is None else before[number]
            steps, memory = layer(steps, kept, encoded.memories[number], encoded.is_there)
            memories.append(memory)
        steps = self.out_norm(steps)
        return self._scores(self.out(steps), self.end(steps), encoded.keys), tuple(memories)

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

    def prepare(self, tokens: tuple[Tensor, ...], action: Tensor) -> tuple[Tensor, ...]:
        """Return the views, and how the wanted counts are spelled (`Spelling`)."""
        chunks = zip(*(torch.split(part, CHUNK) for part in (*tokens, action)), strict=True)
        spelled = [self._spelling(Tokens(*some), wanted) for *some, wanted in chunks]
        longest = max(said.symbol.shape[1] for said in spelled)
        with_steps = ([_with_steps(part, longest) for part in said] for said in spelled)
        return (*tokens, *(torch.cat(parts) for parts in zip(*with_steps, strict=True)))

    def evaluate(self, prepared: tuple[Tensor, ...]) -> tuple[Tensor, Tensor]:
        """Return log-probability and entropy (teams,) of wanted counts, in one pass.

        The entropy is the sum over the steps of the spelling; those that are certain are left out.
        """
        given, said = Tokens(*prepared[:-4]), Spelling(*prepared[-4:])
        steps = int(said.is_there.any(dim=0).sum())  # nothing is computed beyond the longest
        said = Spelling(*(part[:, :steps] for part in said))
        change = changes(self.settings.spelling, said.symbol, given.team_counts.shape[2])
        change = nn.functional.pad(change[:, :-1], (0, 0, 1, 0))  # (teams, steps, caps)
        if change.is_cuda:
            scores, _ = self.decode(self.encode(given), change, change.cumsum(dim=1), None)
        else:
            scores = self._scores_of_packed(given, change, said.is_there)
        is_maintain = one_hot(said.maintain, scores.shape[-1])
        log_probs = self.log_probs(scores, said.is_legal, is_maintain)  # (teams, steps, symbols)
        log_prob = log_probs.gather(2, said.symbol.unsqueeze(2))[..., 0] * said.is_there
        entropy = -(log_probs.exp() * log_probs).sum(dim=-1) * said.is_there
        return log_prob.sum(dim=1), entropy.sum(dim=1)

    def _spelling(self, tokens: Tokens, action: Tensor) -> Spelling:
        spelling, grammar = self.settings.spelling, self.grammar(tokens)
        steps = steps_with_a_choice(spelling, grammar, action)  # (teams,)
        symbol, is_there = spell(spelling, grammar.own, action, steps)  # (teams, steps)
        change = changes(spelling, symbol, action.shape[1])[:, :-1]  # (teams, steps - 1, caps)
        spelled = nn.functional.pad(change, (0, 0, 1, 0)).cumsum(dim=1)  # (teams, steps, caps)
        is_legal, is_maintain = legal_symbols(spelling, grammar, spelled)
        maintain = torch.where(is_maintain.any(dim=2), is_maintain.long().argmax(dim=2), -1)
        return Spelling(symbol, is_there, is_legal, maintain)

    def _scores_of_packed(self, tokens: Tokens, change: Tensor, is_there: Tensor) -> Tensor:
        """Return what `decode` of `encode` does, with nothing computed for padding.

        The scores of steps that are not there mean nothing.
        """
        encoded, of_tokens = self._encode_packed(tokens)
        of_steps = packing_of(is_there.numpy())
        steps = self._steps(*packed((change, change.cumsum(dim=1)), is_there))
        for layer in self.decoder:
            assert isinstance(layer, DecoderLayer), "a list of modules does not say of which"
            steps = layer.packed(steps, encoded, of_steps, of_tokens)
        steps = self.out_norm(steps)
        said = padded(torch.cat([self.out(steps), self.end(steps)], dim=1), is_there)
        return self._scores(said[..., :-1], said[..., -1:], self._keys(tokens))

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

    def _encode_packed(self, tokens: Tokens) -> tuple[Tensor, Packing]:
        """Return encoded tokens that are there, (packed, d), and how they are packed."""
        packing = packing_of(tokens.is_team.numpy(), tokens.is_task.numpy())
        seen = packed((tokens.teams, tokens.team_counts), tokens.is_team)
        wanted = packed((tokens.tasks, tokens.task_needs), tokens.is_task)
        encoded = torch.cat([self._team_tokens(*seen), self._task_tokens(*wanted)])
        for layer in self.encoder:
            assert isinstance(layer, EncoderLayer), "a list of modules does not say of which"
            encoded = layer.packed(encoded, packing)
        return self.encoded_norm(encoded), packing

    def _team_tokens(self, teams: Tensor, counts: Tensor) -> Tensor:
        embedded: Tensor = self.team_in(teams) + counts @ self.capability
        return embedded

    def _task_tokens(self, tasks: Tensor, needs: Tensor) -> Tensor:
        embedded: Tensor = self.task_in(tasks) + self.needs_in(needs @ self.capability)
        return embedded

    def _keys(self, tokens: Tokens) -> Tensor:
        """Return the keys of the capabilities, as each team sees them, (teams, caps, d)."""
        keys: Tensor = self.capability + self.key_in(key_features(tokens))
        return keys

    def _steps(self, change: Tensor, spelled: Tensor) -> Tensor:
        """Return the tokens of steps (..., d) after the changes and their sums (..., caps)."""
        is_first = (spelled == 0).all(dim=-1, keepdim=True)  # (..., 1)
        steps: Tensor = change @ self.capability + self.so_far(spelled @ self.capability)
        return steps + is_first.to(steps.dtype) * self.first_step

    def _scores(self, asking: Tensor, end: Tensor, keys: Tensor) -> Tensor:
        ways = self.directions
        asking = torch.unflatten(asking, -1, (ways, -1))  # (teams, steps, ways, d)
        of_caps = asking.flatten(1, 2) @ keys.transpose(1, 2)  # (teams, steps * ways, caps)
        of_caps = torch.unflatten(of_caps, 1, (-1, ways))  # (teams, steps, ways, caps)
        return torch.cat([of_caps.flatten(2), end], dim=-1)

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


def _with_steps(part: Tensor, steps: int) -> Tensor:
    """Return (teams, some steps, ...) with zeros, or False, up to so many steps."""
    padding = part.new_zeros(len(part), steps - part.shape[1], *part.shape[2:])
    return torch.cat([part, padding], dim=1)


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
