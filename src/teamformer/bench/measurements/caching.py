"""What the paper's network saves by keeping keys and values: the same decisions both ways."""

from __future__ import annotations

import itertools
import time
from dataclasses import dataclass

import numpy as np

from teamformer.base.array_types import Array
from teamformer.files.drawn.generate import Spec, generate
from teamformer.methods.learned.autoregressive import Speller, shipped_speller
from teamformer.methods.learned.token_features import SpellingCodec
from teamformer.methods.scripted.joining import JoinAll
from teamformer.mission.parts.grid import Grid
from teamformer.world.env import TeamFormation

NETWORK = "teamformer-c100-full"
ROBOTS, TASKS, NEEDS, SIDE = 100, 20, 50, 20  # 100N20T-C100-R50
EVERY = 10  # steps between views that are measured


@dataclass(frozen=True)
class Caching:
    """Processor seconds on the same views, and whether all decisions were the same."""

    cached: float
    uncached: float
    views: int
    are_same: bool

    @property
    def speedup(self) -> float:
        """Return how many times faster decisions are with keys and values kept."""
        return self.uncached / self.cached


def measure_caching(trials: int = 10) -> Caching:
    """Spell all counts of 100 robots with 100 capabilities, with and without kept memories.

    The views are those of trials, side by side, in which teams join all on the way: from a hundred
    teams of one to a team of a hundred.
    """
    cached, uncached = shipped_speller(NETWORK), shipped_speller(NETWORK, keeps_memories=False)
    views = _views_of_trials(cached.capabilities, trials)
    seconds, wanted = _time(cached, views)
    more_seconds, again = _time(uncached, views)
    are_same = all(np.array_equal(a, b) for a, b in zip(wanted, again, strict=True))
    return Caching(seconds, more_seconds, sum(len(view[0]) for view in views), are_same)


def _views_of_trials(capabilities: int, trials: int) -> list[tuple[Array, ...]]:
    """Return the tokens of teams that have a choice, every so many steps."""
    spec = Spec(ROBOTS, TASKS, capabilities, requirements=NEEDS, world=Grid(SIDE, SIDE))
    rng = np.random.default_rng(0)
    env = TeamFormation([generate(spec, rng) for _ in range(trials)])
    method, codec, views = JoinAll(), SpellingCodec(capabilities), []
    for step in itertools.count():
        if not env.is_running.any():
            break
        view = env.view()
        if step % EVERY == 0:
            tokens = codec.encode(view)
            rows = codec.has_choice(view, tokens)
            if rows.any():
                views.append(tuple(part[rows] for part in tokens))
        env.step(method.decide(view))
    return views


def _time(speller: Speller, views: list[tuple[Array, ...]]) -> tuple[float, list[Array]]:
    """Return the processor seconds of all decisions, and the decisions."""
    speller(views[0])  # what is done once only
    begun = time.process_time()
    wanted = [speller(tokens) for tokens in views]
    return time.process_time() - begun, wanted
