"""Files that are damaged, at random or on purpose: they are refused without a traceback."""

from __future__ import annotations

import random
from pathlib import Path

import pytest
import yaml

from teamformer.base.errors import MissionError, TeamformerError
from teamformer.files.mission_files import mission_from_tree, mission_to_tree, read_mission

GOOD = """\
teamformer: 1
name: good
world: {rows: ["....", ".##.", "...."], y_axis: up}
capabilities: [lift, scan]
robots:
  - {name: a, at: [0, 0], can: [lift]}
  - {name: b, at: [0, 0], can: {scan: 1, lift: 2}, speed: 0.5, lost: 40}
tasks:
  - {name: x, at: [3, 2], needs: [lift, scan]}
  - {name: y, at: [3, 0], needs: {lift: 2}, duration: 3, appears: 9}
teams: [[a, b]]
sensing_radius: .inf
"""

BOMBS = {
    "brackets": "[" * 1_000_000,
    "dashes": "- " * 1_000_000,
    "aliases": "a: &a [x, x]\n" + "b: &b [*a, *a]\n" + "c: &c [*b, *b, *c]\n" * 50,
    "keys": "".join(f"k{i}: 1\n" for i in range(100_000)),
    "repeated": "k: 1\n" * 100_000,
    "digits": "teamformer: " + "9" * 1_000_000,
    "long key": "? " + "k" * 1_000_000 + "\n: 1\n",
    "open quote": 'a: "' + "x" * 1_000_000,
    "empty robots": "teamformer: 1\nrobots: [" + "[]," * 100_000 + "]",
}


@pytest.mark.parametrize("name", BOMBS)
def test_what_is_meant_to_hurt_does_not(tmp_path: Path, name: str) -> None:
    path = tmp_path / "case.yaml"
    path.write_text(BOMBS[name])
    with pytest.raises(MissionError) as caught:
        read_mission(path)
    lines = str(caught.value).splitlines()
    assert len(lines) <= 51
    assert max(map(len, lines)) < 400


FRAGMENTS = [
    *("&a", "*a", "[", "]", "{", "}", ": ", "- ", "#", '"', "'", "<<", "---", "? ", "|", ">", "@"),
    *("!!int", "!!set", "~", "null", "no", "12:30", "2026-01-01", ".nan", ".inf", "-1", "1.5"),
    *("1e400", "1e-320", "99999999999999999999", "name", "at", "can", "rows", "map", "teams"),
]
TEXTS = ["", "lift", "\ud800", "x\ny", "a" * 999]
NUMBERS = [True, 0, -1, 1.5, float("nan"), float("inf"), 10**400, 10**5000]
OTHERS = [None, b"b", (1, 2), {1}, [], {}, [[]], {"a": 1}, {1: 2}, {"lift": None}]


def damaged(text: str, rng: random.Random) -> bytes:
    """Return a file with a few bytes changed, cut out or put in."""
    data = bytearray(text.encode())
    for _ in range(rng.choice([1, 1, 1, 3, 6])):
        at = rng.randrange(len(data))
        if rng.random() < 0.4:
            data[at:at] = rng.choice(FRAGMENTS).encode()
        elif rng.random() < 0.5:
            data[at] = rng.randrange(rng.choice([127, 256]))
        else:
            del data[at : at + rng.randint(1, 12)]
    return bytes(data)


def swapped(tree: object, rng: random.Random) -> object:
    """Return a tree with one value somewhere in it replaced."""
    if isinstance(tree, dict) and tree and rng.random() < 0.9:
        chosen = rng.choice(list(tree))
        return {key: swapped(v, rng) if key == chosen else v for key, v in tree.items()}
    if isinstance(tree, list) and tree and rng.random() < 0.9:
        index = rng.randrange(len(tree))
        return [swapped(part, rng) if i == index else part for i, part in enumerate(tree)]
    return rng.choice(TEXTS + NUMBERS + OTHERS)


def test_damaged_files_never_end_in_a_traceback(tmp_path: Path) -> None:
    rng = random.Random(1)
    outcomes = {"read": 0, "refused": 0}
    for number in range(1500):
        path = tmp_path / ("case.json" if number % 4 == 0 else "case.yaml")
        path.write_bytes(damaged(GOOD, rng))
        try:
            read_mission(path)
            outcomes["read"] += 1
        except TeamformerError as error:
            outcomes["refused"] += str(error).startswith(str(path))
    assert sum(outcomes.values()) == 1500
    assert min(outcomes.values()) > 20, outcomes  # both happen, or the test shows nothing


def test_damaged_trees_never_end_in_a_traceback() -> None:
    rng = random.Random(2)
    good = mission_to_tree(mission_from_tree(yaml.safe_load(GOOD)))
    outcomes = {"read": 0, "refused": 0}
    for _ in range(1500):
        try:
            mission_from_tree(swapped(good, rng))
            outcomes["read"] += 1
        except TeamformerError as error:
            outcomes["refused"] += str(error).startswith("mission: ")
    assert sum(outcomes.values()) == 1500
    assert min(outcomes.values()) > 20, outcomes
