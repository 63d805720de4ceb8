"""The paper's network without torch: spells what teams want, step by step, all teams at once."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.errors import TeamformerError
from teamformer.methods.learned.action_mask import EDIT, FULL, Next, complete, next_symbols
from teamformer.methods.learned.onnx_sessions import OnnxNetwork, read_network, shipped
from teamformer.methods.learned.policy import Learned
from teamformer.methods.learned.token_features import Spelled, SpellingCodec

ENCODER_FILE, STEP_FILE = "network.onnx", "step.onnx"
ENCODER_INPUTS = Spelled._fields[:7]
ENCODER_OUTPUTS = ("is_there", "keys", "memories")
STEP_INPUTS = ("change", "spelled", "is_maintain", *ENCODER_OUTPUTS, "before")
STEP_OUTPUTS = ("scores", "after")

REFUSED = -1e9


class Speller:
    """Takes the symbol that the network scores highest, until every team has said the end.

    Views are encoded once; keys and values of encoded tokens and of the symbols so far are kept.
    Teams that have ended, or can only go on in one way, take no part in further steps. With
    `keeps_memories=False` each step encodes the views and all symbols anew, to compare with.
    """

    def __init__(self, encoder: bytes, step: bytes, name: str, keeps_memories: bool = True) -> None:
        self._encoder = OnnxNetwork(encoder, name, ENCODER_INPUTS)
        self._step = OnnxNetwork(step, name, STEP_INPUTS)
        about = self._encoder.about
        if about != {**self._step.about, "part": about.get("part")}:
            raise TeamformerError(f"the two files of {name} are of different networks")
        self.spelling = about.get("spelling", "")
        if self.spelling not in (EDIT, FULL):
            raise TeamformerError(f"{name} does not say how it spells", "export it again")
        self.capabilities = int(about["capabilities"])
        self.keeps_memories = keeps_memories

    def __call__(self, tokens: tuple[Array, ...]) -> Array:
        """Return the counts that teams want, (teams, caps), from their tokens."""
        given = Spelled(*tokens)
        spelled = np.zeros_like(given.singles)  # (teams, caps)
        rows = np.arange(len(spelled))  # of the teams still spelling
        now = change = np.zeros_like(spelled)[:, None]  # (teams, steps, caps)
        coming = next_symbols(self.spelling, given, spelled)
        encoded = self._encoder(*given[:7])
        before = _no_memory(encoded[2])
        while len(rows):
            scores, after = self._step(change, now, coming.is_maintain, *encoded, before)
            symbol = np.where(coming.is_legal, scores, REFUSED).argmax(axis=1)  # (teams,)
            made = self._change(symbol)  # (teams, caps)
            reached = spelled[rows] + made
            is_complete = complete(self.spelling, given, reached)
            spelled[rows] = reached
            coming = next_symbols(self.spelling, given, reached)
            goes_on = (symbol < scores.shape[1] - 1) & coming.is_legal[:, :-1].any(axis=1)
            goes_on &= ~is_complete
            if not goes_on.all():
                rows, made, change, now, before, after = _only(
                    (rows, made, change, now, before, after), goes_on
                )
                coming, given = Next(*_only(coming, goes_on)), Spelled(*_only(given, goes_on))
                encoded = _only(encoded, goes_on)
            newest, sum_now = made[:, None], spelled[rows, None]  # (teams, 1, caps)
            if self.keeps_memories:
                change, now, before = newest, sum_now, after
            elif len(rows):
                change = np.concatenate([change, newest], axis=1)
                now = np.concatenate([now, sum_now], axis=1)
                encoded = self._encoder(*given[:7])
        own = tokens[1][:, 0]  # (teams, caps)
        wanted: Array = np.rint(spelled + own if self.spelling == EDIT else spelled)
        return wanted

    def _change(self, symbol: Array) -> Array:
        """Return what symbols add to the counts, as (teams, caps); the end adds nothing."""
        caps = self.capabilities
        change = np.zeros((len(symbol), 2 * caps + 1), dtype=np.float32)
        change[np.arange(len(symbol)), symbol] = 1.0
        if self.spelling == FULL:
            return change[:, :caps]
        return change[:, :caps] - change[:, caps : 2 * caps]


def _only(parts: tuple[Array, ...] | list[Array], kept: Array) -> list[Array]:
    """Return the kept rows of each part."""
    return [part[kept] for part in parts]


def _no_memory(memories: Array) -> Array:
    """Return the memory of no symbols, shaped as that of tokens: (..., heads, 0, d / heads)."""
    return memories[..., :0, :]


def policy_of(speller: Speller) -> Learned:
    """Return the policy of a network."""
    return Learned(SpellingCodec(speller.capabilities), speller)


def shipped_spelling(name: str) -> Learned:
    """Return the policy of a network that comes with the package."""
    return policy_of(shipped_speller(name))


def spelled_in(folder: Path) -> Learned:
    """Return the policy that `export_teamformer` wrote into a folder."""
    encoder, step = (read_network(folder / file) for file in (ENCODER_FILE, STEP_FILE))
    return policy_of(Speller(encoder, step, str(folder)))


def shipped_speller(name: str, keeps_memories: bool = True) -> Speller:
    """Return a network that comes with the package: `NAME.onnx` and `NAME-step.onnx`."""
    encoder, step = shipped(f"{name}.onnx"), shipped(f"{name}-step.onnx")
    return Speller(encoder, step, name, keeps_memories)
