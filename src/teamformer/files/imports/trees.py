"""Reading trees of others: what is missing or of another kind is told by file and place."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
import yaml

from teamformer.base.array_types import Floats
from teamformer.base.errors import TeamformerError
from teamformer.base.file_access import read_text

LARGEST_FILE = 20_000_000  # bytes
HINT = "name a file of this format, whole and as its authors publish it"


class TreePart:
    """A part of a tree that knows the file and the place that it comes from."""

    def __init__(self, value: Any, path: Path, place: str = "") -> None:
        self.value, self.path, self.place = value, path, place

    def __getitem__(self, key: str | int) -> TreePart:
        """Return a part of a mapping or a list; refuses if it is not there."""
        if isinstance(key, int):
            if not isinstance(self.value, list) or key >= len(self.value):
                self.refuse(f"lacks entry {key}")
            return TreePart(self.value[key], self.path, f"{self.place}[{key}]")
        if not isinstance(self.value, dict) or key not in self.value:
            self.refuse(f"lacks '{key}'")
        return TreePart(self.value[key], self.path, f"{self.place}.{key}".lstrip("."))

    def refuse(self, what: str, hint: str = HINT) -> NoReturn:
        """Raise the error that names file and place."""
        raise TeamformerError(f"{self.path}: {self.place or 'the file'} {what}", hint)

    def parts(self) -> list[tuple[str, TreePart]]:
        """Return the parts of a mapping that is not empty, by key, or of a list, by number."""
        if isinstance(self.value, dict) and self.value:
            return [(str(key), self[key]) for key in self.value]
        if isinstance(self.value, list) and self.value:
            return [(str(number), self[number]) for number in range(len(self.value))]
        self.refuse(f"is {_shown(self.value)}; here should be a list or a mapping with entries")

    def number(self, least: float = -math.inf) -> float:
        """Return a finite number."""
        value = self.value
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        if not is_number or not math.isfinite(value) or value < least:
            self.refuse(f"is {_shown(value)}; here should be a number" + _from(least))
        return float(value)

    def whole(self, least: int) -> int:
        """Return a whole number."""
        number = self.number(least)
        if number != int(number):
            self.refuse(f"is {_shown(self.value)}; here should be a whole number" + _from(least))
        return int(number)

    def text(self) -> str:
        """Return a text."""
        if not isinstance(self.value, str) or not self.value:
            self.refuse(f"is {_shown(self.value)}; here should be a name")
        return self.value

    def numbers(self, least: float = -math.inf) -> list[float]:
        """Return a list of numbers."""
        return [part.number(least) for _, part in self.parts()]

    def ways(self, names: Sequence[str]) -> Floats:
        """Return how long the way from each named place to each other one is, (from, to)."""
        ways = self.matrix()
        if len(ways) != len(names):
            self.refuse(f"has {len(ways)} rows; here should be one for each of {len(names)} places")
        if (ways < 0).any():
            i, j = (int(place) for place in divmod(int(ways.argmin()), len(names)))
            way = f"{ways[i, j]:g} from {names[i]} to {names[j]}"
            self.refuse(f"has {way}; here should be 0 or more")
        return ways

    def matrix(self) -> Floats:
        """Return a square matrix of numbers."""
        rows = [row.numbers() for _, row in self.parts()]
        for number, row in enumerate(rows):
            if len(row) != len(rows):
                self.refuse(f"is not square: row {number} has {len(row)} of {len(rows)} numbers")
        return np.array(rows)


def read_json(path: Path) -> TreePart:
    """Return the tree of a JSON file."""
    return _read(path, json.loads, json.JSONDecodeError, "JSON")


def read_yaml(path: Path) -> TreePart:
    """Return the tree of a YAML file."""
    loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    return _read(path, lambda text: yaml.load(text, loader), yaml.YAMLError, "YAML")


def _read(path: Path, parse: Callable[[str], Any], error: type[Exception], kind: str) -> TreePart:
    text = read_text(path, LARGEST_FILE, HINT)
    try:
        return TreePart(parse(text), path)
    except (error, RecursionError, ValueError) as wrong:
        place = getattr(wrong, "lineno", None) or _line_of(wrong)
        where = f"{path}:{place}" if place else str(path)
        raise TeamformerError(f"{where}: this is not whole {kind}; was it cut off?", HINT) from None


def _line_of(error: Exception) -> int | None:
    mark = getattr(error, "problem_mark", None)
    return None if mark is None else int(mark.line) + 1


def _shown(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 40 else text[:37] + "..."


def _from(least: float) -> str:
    return "" if least == -math.inf else f", {least:g} or more"


def refuse_detours(part: TreePart, names: Sequence[str], ways: Floats, tolerance: float) -> None:
    """Refuse ways that are longer than a detour: straight ones never are."""
    detours = np.min(ways[:, :, None] + ways[None, :, :], axis=1)
    worst = np.unravel_index(np.argmax(ways - detours), ways.shape)
    if ways[worst] - detours[worst] > tolerance:
        i, j = (int(place) for place in worst)
        by = int(np.argmin(ways[i] + ways[:, j]))
        part.refuse(
            f"breaks the triangle inequality: from {names[i]} to {names[j]} it is "
            f"{ways[worst]:g}, but by way of {names[by]} {detours[worst]:g}"
        )
