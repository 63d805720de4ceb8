"""Which symbols may come next while a team spells the capabilities that it wants.

Capabilities are spelled in ascending order, each as often as it is counted, and then the end. In
`full` spelling these are all the wanted counts; in `edit` spelling only what is added or what is
dropped. Whatever has been spelled can be completed to something that the environment carries out.
"""

from __future__ import annotations

from typing import NamedTuple

import torch
from torch import Tensor

EDIT, FULL = "edit", "full"


class Grammar(NamedTuple):
    """What a team may want: counts that it can name, and what its robots need to stay in it.

    `targets` are counts to reach (in `edit` spelling: to add): the first is to maintain, the others
    are joins. A robot of one capability stays if the team keeps `singles` of it (the least number,
    0 where there is no such robot); one of several capabilities is in `profiles`.
    """

    own: Tensor  # (teams, caps)
    targets: Tensor  # (teams, targets, caps)
    is_target: Tensor  # (teams, targets) bool
    singles: Tensor  # (teams, caps)
    profiles: Tensor  # (teams, profiles, caps), padding is beyond all counts


def symbols(spelling: str, caps: int) -> int:
    """Return how many symbols there are; the last is the end."""
    return caps + 1 if spelling == FULL else 2 * caps + 1


def grammar_of(
    spelling: str, team_counts: Tensor, can_join: Tensor, singles: Tensor, profiles: Tensor
) -> Grammar:
    """Return the grammar of teams whose counts come first in `team_counts` (teams, seen, caps)."""
    own = team_counts[:, 0]
    is_target = can_join & (team_counts > 0).any(dim=-1)  # (teams, seen)
    first = torch.arange(is_target.shape[1], device=own.device) == 0
    targets = team_counts.masked_fill(first[:, None], 0.0)
    if spelling == FULL:
        targets = targets + own.unsqueeze(1)
    return Grammar(own, targets, is_target | first, singles, profiles)


def spell(
    spelling: str, own: Tensor, wanted: Tensor, steps: Tensor | None = None
) -> tuple[Tensor, Tensor]:
    """Return the symbols of wanted counts (teams, steps) and which of them are there.

    A spelling ends with its end symbol, or after so many `steps` (teams,); what follows is not
    there.
    """
    change = wanted if spelling == FULL else wanted - own  # (teams, caps)
    caps = change.shape[1]
    so_far = change.abs().cumsum(dim=1)  # (teams, caps)
    length = so_far[:, -1] + 1 if steps is None else steps  # (teams,)
    places = torch.arange(int(length.max()), device=own.device).expand(len(own), -1)
    symbol = torch.searchsorted(so_far, places.contiguous(), right=True)  # (teams, steps)
    if spelling == EDIT:
        drops = (change < 0).any(dim=1, keepdim=True)
        symbol = torch.where(symbol == caps, 2 * caps, symbol + caps * drops)
    return symbol, places < length.unsqueeze(1)


def steps_with_a_choice(spelling: str, grammar: Grammar, wanted: Tensor) -> Tensor:
    """Return after how many symbols of the wanted counts the rest is certain, as (teams,).

    In `edit` spelling what adds can only reach targets: it is certain once it differs from all
    others. Elsewhere the steps are all that there are, up to the end.
    """
    change = wanted if spelling == FULL else wanted - grammar.own  # (teams, caps)
    length = change.abs().sum(dim=1).long()  # (teams,)
    if spelling == FULL:
        return length + 1
    meant, others = change.unsqueeze(1), grammar.targets  # (teams, 1 or targets, caps)
    differs = (meant != others) & grammar.is_target.unsqueeze(2)  # (teams, targets, caps)
    is_before = differs.cumsum(dim=2) == 0
    is_first = (differs.cumsum(dim=2) == 1) & differs
    alike = (meant * is_before + torch.minimum(meant, others) * is_first).sum(dim=2)  # symbols
    until_it_differs = torch.where(differs.any(dim=2), alike + 1, 0).amax(dim=1).long()
    is_join = (change >= 0).all(dim=1)
    return torch.where(is_join, until_it_differs.clamp(min=1), length + 1)


def sole_targets(spelling: str, grammar: Grammar, spelled: Tensor) -> tuple[Tensor, Tensor]:
    """Return which teams can only reach one target any more, and its counts.

    `spelled` (teams, 1, caps) are the counts so far; the results are (teams,) bool and
    (teams, caps), in what is spelled.
    """
    is_alive = _follow_targets(grammar, spelled.clamp(min=0))[0][:, 0]  # (teams, targets)
    first = is_alive.long().argmax(dim=1)
    target = grammar.targets[torch.arange(len(first), device=first.device), first]  # (teams, caps)
    is_it = (grammar.targets == target.unsqueeze(1)).all(dim=2)  # (teams, targets)
    adds = (spelled[:, 0] > 0).any(dim=1)
    return adds & (is_it | ~is_alive).all(dim=1) & (spelling == EDIT), target


def changes(spelling: str, symbol: Tensor, caps: int) -> Tensor:
    """Return what each symbol adds to the counts spelled so far, as (..., caps); the end nothing.

    In `edit` spelling what is dropped counts negative.
    """
    hot = one_hot(symbol, symbols(spelling, caps))[..., :-1]  # (..., symbols - 1)
    return hot if spelling == FULL else hot[..., :caps] - hot[..., caps:]


def one_hot(index: Tensor, size: int) -> Tensor:
    """Return floats that are one at the index, as (..., size)."""
    return (index.unsqueeze(-1) == torch.arange(size, device=index.device)).float()


def legal_symbols(spelling: str, grammar: Grammar, spelled: Tensor) -> tuple[Tensor, Tensor]:
    """Return which symbols may come next and which of them goes on to maintain.

    `spelled` (teams, steps, caps) are the counts so far at some steps; both results are
    (teams, steps, symbols) bool.
    """
    if spelling == FULL:
        to_targets, to_maintain = _towards_targets(grammar, spelled)
        return to_targets | _towards_splits(grammar, spelled), to_maintain
    dropped = (-spelled).clamp(min=0)
    has_dropped = (dropped > 0).any(dim=-1, keepdim=True)  # (teams, steps, 1)
    has_added = (spelled > 0).any(dim=-1, keepdim=True)
    adds, to_maintain = _towards_targets(grammar, spelled.clamp(min=0))
    drops = _droppable(grammar, dropped) & ~has_added
    adds, end = adds[..., :-1] & ~has_dropped, adds[..., -1:] | has_dropped
    is_legal = torch.cat([adds, drops, end], dim=-1)
    maintain = torch.zeros_like(is_legal)
    maintain[..., -1] = to_maintain[..., -1] & ~has_dropped[..., 0]
    return is_legal, maintain


def _towards_targets(grammar: Grammar, spelled: Tensor) -> tuple[Tensor, Tensor]:
    """Return the symbols that go on to a target, and to the first, each (teams, steps, caps + 1).

    A target's next symbol is the first capability that it still lacks, or the end.
    """
    caps = spelled.shape[-1]
    is_alive, following = _follow_targets(grammar, spelled)
    is_next = (following.unsqueeze(-1) == torch.arange(caps + 1, device=spelled.device)) & (
        is_alive.unsqueeze(-1)
    )  # (teams, steps, targets, caps + 1)
    return is_next.any(dim=2), is_next[:, :, 0]


def _follow_targets(grammar: Grammar, spelled: Tensor) -> tuple[Tensor, Tensor]:
    """Return which targets are spelled alike up to the last symbol, and what each lacks first.

    Both are (teams, steps, targets); what lacks nothing has the number of capabilities.
    """
    caps = spelled.shape[-1]
    places = torch.arange(caps, device=spelled.device)
    lacks = grammar.targets.unsqueeze(1) - spelled.unsqueeze(2)  # (teams, steps, targets, caps)
    following = torch.where(lacks > 0, places, caps).amin(dim=-1)
    is_alive = (lacks >= 0).all(dim=-1) & grammar.is_target.unsqueeze(1)
    return is_alive & (following >= _last(spelled)), following


def _towards_splits(grammar: Grammar, spelled: Tensor) -> Tensor:
    """Return the symbols that go on to a split or to maintain, as (teams, steps, caps + 1)."""
    own = grammar.own.unsqueeze(1)  # (teams, 1, caps)
    places = torch.arange(spelled.shape[-1], device=spelled.device)
    singles = grammar.singles.unsqueeze(1)  # (teams, 1, caps)
    stays = ((singles > 0) & (spelled >= singles)).any(dim=-1, keepdim=True)  # (teams, steps, 1)
    last_single = torch.where(singles > 0, places, -1).amax(dim=-1, keepdim=True)
    fits = stays | (places <= last_single)  # (teams, steps, caps) some robot can still stay
    exceeds = grammar.profiles.unsqueeze(1) > spelled.unsqueeze(2)  # (teams, steps, profiles, caps)
    exceeds_before = exceeds.cumsum(dim=-1) - exceeds.long()
    fits = fits | (exceeds_before == 0).any(dim=2) if exceeds.shape[2] else fits
    is_within = (spelled <= own).all(dim=-1, keepdim=True)  # (teams, steps, 1)
    more = fits & is_within & (spelled < own) & (places >= _last(spelled))
    stays = stays | (~exceeds.any(dim=-1)).any(dim=-1, keepdim=True)
    return torch.cat([more, stays & is_within], dim=-1)


def _droppable(grammar: Grammar, dropped: Tensor) -> Tensor:
    """Return which capabilities may be dropped next, so that some robot can stay, and not all do.

    The result is (teams, steps, caps).
    """
    kept = grammar.own.unsqueeze(1) - dropped  # (teams, steps, caps)
    singles = grammar.singles.unsqueeze(1)  # (teams, 1, caps)
    fits = (singles > 0) & (kept >= singles)  # (teams, steps, caps)
    parts = fits & (kept - 1 < singles)  # the single would go with the next drop
    some_stay = fits.sum(dim=-1, keepdim=True) - parts.long() > 0
    room = kept.unsqueeze(2) - grammar.profiles.unsqueeze(1)  # (teams, steps, profiles, caps)
    stays = (room >= 0).all(dim=-1, keepdim=True) & (room >= 1)
    some_stay = some_stay | stays.any(dim=2)
    places = torch.arange(kept.shape[-1], device=kept.device)
    return some_stay & (kept >= 1) & (places >= _last(dropped))


def _last(spelled: Tensor) -> Tensor:
    """Return the last capability spelled, 0 before the first, as (teams, steps, 1)."""
    places = torch.arange(spelled.shape[-1], device=spelled.device)
    return torch.where(spelled > 0, places, 0).amax(dim=-1, keepdim=True)
