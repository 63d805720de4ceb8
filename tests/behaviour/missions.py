"""The missions whose behaviour is written down: every family and kind, examples, and clocks."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import teamformer as tf
from teamformer.files.drawn.families import FAMILIES as KINDS
from teamformer.files.drawn.named_settings import world_of

ROOT = Path(__file__).parents[2]

FAMILIES = tuple(
    f"{family}{incident}"
    for family in KINDS
    for incident in ("", "-lost", "-arrivals", "-ordered", "-mixed")
)
PAPER = ("4N4T-C4", "4N20T-C4", "8N20T-C8", "4N20+20T-C4-tsp", "4N20+20T-C4-nn")
SURPRISING = ("8N20T-C4-30x30", "20N20T-C4", "12N30T-C4-R2")
UNCERTAIN = tuple(
    f"8N20T-C4-{kind}"
    for kind in ("durations", "needs", "places", "delays", "calls", "breakdowns", "all")
)
EXAMPLES = tuple(
    sorted(
        file.stem
        for file in (ROOT / "examples").glob("*.yaml")
        if "robotarium" not in file.name and "time: continuous" not in file.read_text()
    )
)
REHEARSED = ("four-robots", "plane", "piano", "warehouse")

CLOCKED = ("real", "sparse", "warehouse", "moving", "carry", "air-ground", "deadlines")
TIMED = (
    *(f"{family} {seed}" for family in CLOCKED for seed in range(2)),
    "plane",
    "roads",
    "visits",
    "hospital-night",
)


def world(setting: str, seed: int) -> tf.Mission:
    """Return a drawn mission of a setting."""
    return world_of(setting, seed)


def read(name: str) -> tf.Mission:
    """Return the mission of an example."""
    return tf.load(ROOT / "examples" / f"{name}.yaml")


def timed(setting: str) -> tf.Mission:
    """Return a mission in continuous time."""
    if setting in ("roads", "visits"):
        return tf.load(Path(__file__).parent / f"{setting}.yaml")
    if setting == "hospital-night":
        return read(setting)
    if setting == "plane":
        return replace(read("plane"), time="continuous")
    family, seed = setting.split()
    return replace(world_of(family, int(seed)), time="continuous")
