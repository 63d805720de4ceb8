"""Learned policies, run by onnxruntime: no torch, one thread."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from teamformer.errors import TeamformerError
from teamformer.model import Scenario
from teamformer.policies.choices import MAINTAIN, sees_doubles, wanted_counts
from teamformer.policies.liveness import Liveness
from teamformer.policies.relations import Relations, relate
from teamformer.policies.scripted import JoinAll
from teamformer.sim.arrays import Array
from teamformer.sim.env import Decision
from teamformer.sim.view import View

Scorer = Callable[[Relations], Array]
"""From the relations of some teams, the scores of their choices, as (teams, choices)."""


class Learned:
    """Takes the choice that a network scores highest, for any fleet.

    The network is asked where a team and those that it sees have some capability twice. Where they
    have not, a team does as join-all does. So does one that the liveness rule finds overdue, until
    a task is done; `overdue` counts such decisions.
    """

    needs_everything = False

    def __init__(self, score: Scorer | None = None, with_liveness: bool = True) -> None:
        self._score = score or OnnxScorer()
        self._liveness = Liveness()
        self._fallback = JoinAll()
        self.with_liveness = with_liveness
        self.overdue = 0

    def begin(self, everything: Sequence[Scenario] | None, rng: np.random.Generator) -> None:
        """Forget earlier trials."""
        self._liveness.begin()
        self.overdue = 0

    def decide(self, view: View) -> Decision:
        """Return the network's choice where it is asked, else what join-all wants."""
        by_rule = self._fallback.decide(view).wanted
        choice, is_asked = self.choose(view)
        if self.with_liveness:
            is_overdue = self._liveness.is_overdue(view)
            self.overdue += int(is_overdue.sum())
            is_asked &= ~is_overdue
        wanted = np.where(is_asked[:, None], wanted_counts(view, choice), by_rule)
        return Decision(wanted)

    def choose(self, view: View) -> tuple[Array, Array]:
        """Return the network's choices and for which teams it was asked, both (teams,)."""
        relations = relate(view)
        choice = np.full(len(view.slot), MAINTAIN)
        is_asked = is_open_question(view, relations.is_legal)
        if is_asked.any():
            scores = self._score(Relations(*(part[is_asked] for part in relations)))
            choice[is_asked] = scores.argmax(axis=1)
        return choice, is_asked


def is_open_question(view: View, is_legal: Array) -> Array:
    """Return which teams the network is asked for: those with a choice that see doubles."""
    is_open: Array = (is_legal.sum(axis=1) > 1) & sees_doubles(view)
    return is_open


class OnnxScorer:
    """A network in an ONNX file; without a file, the one that comes with the package."""

    def __init__(self, file: Path | None = None) -> None:
        if file is None:
            content = files("teamformer").joinpath("weights", "teamformer-any.onnx").read_bytes()
        else:
            content = file.read_bytes()
        self._session = _start(content, str(file or "teamformer-any.onnx"))

    def __call__(self, relations: Relations) -> Array:
        """Return the scores of the teams' choices, as (teams, choices)."""
        scores: Array = self._session.run(None, relations._asdict())[0]
        return scores


def _start(content: bytes, name: str) -> Any:
    import onnxruntime  # type: ignore[import-untyped]  # heavy, and only needed here

    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    options.log_severity_level = 3
    try:
        session = onnxruntime.InferenceSession(content, options, ["CPUExecutionProvider"])
    except Exception as error:  # onnxruntime's errors have no public common class
        raise TeamformerError(f"{name} holds no network that runs: {error}") from None
    _check_inputs(session, name)
    return session


def _check_inputs(session: Any, name: str) -> None:
    found = [given.name for given in session.get_inputs()]
    if found != list(Relations._fields):
        raise TeamformerError(f"{name} takes {found}", f"this version gives {Relations._fields}")
