"""What functions are called with: missions, seeds, names of files, and what is wrong with them."""

from __future__ import annotations

import operator
from os import PathLike

from teamformer.base.errors import TeamformerError
from teamformer.mission.model import Mission

PathOrName = str | PathLike[str]


def refuse_no_mission(mission: object, verb: str) -> None:
    """Raise `TeamformerError` for what is no mission, such as the path of one."""
    if not isinstance(mission, Mission):
        what = f"{verb} takes a mission, not {type(mission).__name__}"
        raise TeamformerError(what, f"write tf.{verb}(tf.load('mission.yaml'))")


def whole_seed(seed: int) -> int:
    """Return a seed as Python's own whole number; TeamformerError for anything else."""
    try:
        whole = operator.index(seed)
    except TypeError:
        whole = -1
    if whole < 0 or isinstance(seed, bool):
        raise TeamformerError(f"seed is {seed!r}", "write a whole number from 0 on")
    return whole


def known_seconds(seconds: float) -> float:
    """Return for how long something may take; TeamformerError for what is no such time."""
    try:
        if float(seconds) >= 0:  # not so for NaN
            return float(seconds)
    except (TypeError, ValueError):
        pass
    raise TeamformerError(f"seconds is {seconds!r}", "write a number of seconds, 0 or more")
