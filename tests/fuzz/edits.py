"""Edits of good files: something is left out, doubled, nudged, renamed or something else."""

from __future__ import annotations

import copy
from typing import Any

from hypothesis import strategies as st

from drawing import pick
from missions import continuous_missions, missions

VALUES = (
    *(0, 1, -1, 2, 0.5, -0.5, 1e-9, 1.0005, 100_000, 100_001, 10**9, 10**9 + 1, 10**400, 1e308),
    *(float("inf"), float("-inf"), float("nan"), True, None, "", " ", "no", "?", "home", "plan"),
    *("x\ny", "\x07", "\ud800", "a" * 201, ".inf", b"b", (1, 2), {1}),
    *([], [[]], [0, 0], [1], [5, 2], [0.5, 0.5], [0, 10**9], ["a", "a"], {}, {"a": 1}, {1: 2}),
    *({"rate": 2}, {"chance": 0.5, "seed": -1}, {"grid": [1, 1]}, {"plane": [1, 1], "step": 0.01}),
)
"""What may stand in a file by mistake, or lies at the edge of what may."""

NUDGES = (1, -1, 0.001, -0.001, 0.5, 100)
KEYS = ("nmae", "order", "time", "starts", "cost", "ends", "within", "count", "arrivals", "<<", "")
MARKS = (
    *("&a ", "*a", "[", "]", "{", "}", ": ", "- ", "#", '"', "'", "<<: ", "---", "? ", "| ", "> "),
    *(
        "!!int ",
        "~",
        "no",
        "12:30",
        ".nan",
        ".inf",
        "-1",
        "1e400",
        "9" * 20,
        "\t",
        "\n",
        "\r",
        "\0",
    ),
)

Path = tuple[Any, ...]


@st.composite
def edited_trees(draw: st.DrawFn) -> Any:
    """Return the tree of a good file after one edit, or a few."""
    tree = draw(st.one_of(missions(), continuous_missions()))
    for _ in range(pick(draw, (1, 1, 2, 3))):
        tree = edit(draw, tree)
    return tree


def edit(draw: st.DrawFn, tree: Any) -> Any:
    """Return a tree with one thing in it changed."""
    tree = copy.deepcopy(tree)
    paths = list(paths_in(tree))
    if not paths:
        return tree
    *way, last = pick(draw, paths)
    around = tree
    for key in way:
        around = around[key]
    here = around[last]
    match pick(draw, ("value", "nudge", "leave out", "twice", "key", "swap")):
        case "nudge" if isinstance(here, int | float):
            around[last] = here + pick(draw, NUDGES)
        case "leave out":
            del around[last]
        case "twice" if isinstance(around, list):
            around.insert(last, copy.deepcopy(here))
        case "key" if isinstance(around, dict):
            around[pick(draw, KEYS)] = around.pop(last)
        case "swap":
            around[last] = copy.deepcopy(value_at(tree, pick(draw, paths)))
        case _:
            around[last] = pick(draw, VALUES)
    return tree


def paths_in(tree: Any, way: Path = ()) -> list[Path]:
    """Return the ways to all that stands in a tree."""
    keys = tree if isinstance(tree, dict) else range(len(tree)) if isinstance(tree, list) else ()
    return [path for key in keys for path in ((*way, key), *paths_in(tree[key], (*way, key)))]


def value_at(tree: Any, path: Path) -> Any:
    """Return what stands somewhere in a tree."""
    for key in path:
        tree = tree[key]
    return tree


@st.composite
def edited_texts(draw: st.DrawFn, text: st.SearchStrategy[str]) -> bytes:
    """Return a text with some letters changed, cut out or put in."""
    data = bytearray(draw(text).encode())
    for _ in range(pick(draw, (1, 1, 2, 4))):
        at = draw(st.integers(0, 2**20)) % max(1, len(data))
        match pick(draw, ("put in", "cut out", "change")):
            case "put in":
                data[at:at] = pick(draw, MARKS).encode()
            case "cut out":
                del data[at : at + 1 + pick(draw, range(12))]
            case "change":
                data[at : at + 1] = bytes([draw(st.integers(0, 255))])
    return bytes(data)
