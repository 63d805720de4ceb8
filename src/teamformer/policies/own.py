"""A user's own policy: what goes wrong in it is told by file and line, as a user's mistake is."""

from __future__ import annotations

import sysconfig
import traceback
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from teamformer.errors import TeamformerError
from teamformer.model import Scenario
from teamformer.sim.env import Decision, read_decision
from teamformer.sim.view import View


class OwnPolicy:
    """Asks a policy that a user wrote, and refuses what is no decision.

    Raises `TeamformerError` where the policy raises anything or answers with anything else. What
    else the policy offers, such as a planner's `time_limit`, is its own.
    """

    def __init__(self, policy: Any, name: str) -> None:
        """Ask a policy that the user calls by a name."""
        vars(self).update(_policy=policy, _name=name)

    def begin(self, everything: Sequence[Scenario] | None, rng: np.random.Generator) -> None:
        """Get the policy ready for a new batch of trials."""
        with telling_where(f"policy '{self._name}' failed"):
            self._policy.begin(everything, rng)

    def decide(self, view: View) -> Decision:
        """Return what the policy wants, if it is a decision for this view."""
        with telling_where(f"policy '{self._name}' failed"):
            decision = self._policy.decide(view)
        try:
            wanted, task = read_decision(decision, *view.counts.shape)
        except AttributeError:
            what = f"decide() returned {type(decision).__name__}, not a Decision"
            raise TeamformerError(f"policy '{self._name}': {what}", HINT) from None
        except ValueError as error:
            raise TeamformerError(f"policy '{self._name}': decide(): {error}", HINT) from None
        return Decision(wanted, task)

    def __getattr__(self, name: str) -> Any:
        if name == "_policy":  # being copied: there is none yet
            raise AttributeError(name)
        return getattr(self._policy, name)

    def __setattr__(self, name: str, value: Any) -> None:
        setattr(self._policy, name, value)


HINT = "see docs/policies.md for what a decision is"
INSTALLED = (str(Path(__file__).parents[1]), sysconfig.get_path("stdlib"))


@contextmanager
def telling_where(what: str) -> Iterator[None]:
    """Turn whatever a user's code raises into an error that says what, and in which line."""
    try:
        yield
    except TeamformerError:
        raise
    except Exception as error:
        raise TeamformerError(f"{what}{_place_of(error)}: {_spell(error)}") from error


def _place_of(error: Exception) -> str:
    """Return the file and line that raised, by the deepest frame outside of installed packages."""
    if isinstance(error, SyntaxError) and error.filename:
        return f" at {error.filename}:{error.lineno}"
    frames = traceback.extract_tb(error.__traceback__)[1:]  # without telling_where itself
    theirs = [frame for frame in frames if not _is_installed(frame.filename)]
    return f" at {theirs[-1].filename}:{theirs[-1].lineno}" if theirs else ""


def _is_installed(file: str) -> bool:
    return file.startswith(("<", *INSTALLED)) or "site-packages" in file


def _spell(error: Exception) -> str:
    return f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
