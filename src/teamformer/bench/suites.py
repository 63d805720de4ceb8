"""Suites: which methods meet which settings under which rules, read from YAML files."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from teamformer.base.errors import TeamformerError
from teamformer.base.file_access import names_of_shipped, read_shipped_or_own
from teamformer.files.drawn.named_settings import size_of
from teamformer.files.mission_files import error_of
from teamformer.files.yaml.reader import parse
from teamformer.files.yaml.tree_reader import Reader
from teamformer.mission.checks.rules import FORESIGHTS, NEW_TASKS

KEYS = (
    "about",
    "settings",
    "axes",
    "parts",
    "methods",
    "without",
    "trials",
    "time_limit",
    "rules",
    "method_settings",
    "figure",
)
RULES = ("forming_steps",)
METHOD_SETTINGS = {"new_tasks": NEW_TASKS, "foresight": FORESIGHTS}
AXES = ("robots", "tasks", "capabilities")
FOLDER = ("bench", "suites")
OTHERS = ("speed", "size", "robotarium", "fleet", "others")
"""Measured by code of their own."""
FIGURES = ("drawn", "none")


@dataclass(frozen=True)
class Suite:
    """A cross product of settings and methods, or several of them (`parts`).

    `methods` of a suite with parts run in each of their settings besides the parts' own, but for
    those that are in `without`. `rules`
    are fields of every mission, `method_settings` what is set of a method. `axes` are the
    settings of each curve, by what grows along it. `trials` and `time_limit` (seconds that a
    planner may take) hold unless the command line says otherwise.
    """

    name: str
    about: str
    settings: tuple[str, ...] = ()
    methods: tuple[str, ...] = ()
    without: tuple[str, ...] = ()
    trials: int = 50
    time_limit: float = 10.0
    rules: Mapping[str, int] = field(default_factory=dict)
    method_settings: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    figure: str = "drawn"
    axes: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    parts: tuple[Suite, ...] = ()

    @property
    def figures(self) -> tuple[Suite, ...]:
        """Return the suites that are drawn: the parts, or this one."""
        drawn = self.parts if self.figure != "none" else ()
        return drawn or ((self,) if self.figure != "none" else ())


def player_of(method: str) -> str:
    """Return the method that plays where a suite has it twice, under other rules.

    So `plan@absent` is `plan`; what is set of it stands under `method_settings`.
    """
    return method.partition("@")[0]


def names_of_suites() -> list[str]:
    """Return the suites that come with the package."""
    return names_of_shipped(*FOLDER)


def load_suite(name: str) -> Suite:
    """Return a suite by its name, or from a file of the user's own that ends in .yaml.

    Raises `TeamformerError` for an unknown name (with the nearest ones) and for what is wrong in
    a file, by line.
    """
    text, source = read_shipped_or_own(
        name, FOLDER, "there is no suite", "your own is a .yaml file", OTHERS
    )
    return _read(text, Path(source).stem, source)


def _read(text: str, name: str, source: str) -> Suite:
    tree = parse(text)
    reader = Reader(tree)
    suite = None
    if not tree.problems:
        suite = _read_suite(reader, tree.value, name)
    if suite is None or tree.problems:
        raise error_of(tree, source)
    return suite


def _read_suite(reader: Reader, value: Any, name: str) -> Suite:
    said = reader.mapping((), value, dict.fromkeys(KEYS, False))
    axes = _axes(reader, said.get("axes", {}))
    parts = _parts(reader, said.get("parts", []))
    settings = _settings(reader, ("settings",), said.get("settings", []))
    settings += tuple(setting for axis in axes.values() for setting in axis)
    if parts and settings:
        reader.refuse((), "a suite has either parts or settings; leave one of them out")
    settings += tuple(setting for part in parts for setting in part.settings)
    suite = Suite(
        name=name,
        about=reader.text(("about",), said.get("about", name)),
        settings=tuple(dict.fromkeys(settings)),
        methods=tuple(reader.names(("methods",), said.get("methods", []))),
        without=_without(reader, said, parts),
        trials=reader.whole(("trials",), said.get("trials", Suite.trials), least=1),
        time_limit=reader.number(("time_limit",), said.get("time_limit", Suite.time_limit)),
        rules=_rules(reader, ("rules",), said.get("rules", {})),
        method_settings=_method_settings(reader, said),
        figure=_one_of(reader, ("figure",), said.get("figure", Suite.figure), FIGURES),
        axes=axes,
        parts=parts,
    )
    if suite.time_limit < 0:
        reader.refuse(("time_limit",), f"time_limit is {suite.time_limit:g}; write 0 or more")
    if not reader.tree.problems and not (suite.settings and (suite.methods or parts)):
        reader.refuse((), "a suite needs settings and methods, or parts; add them")
    return suite


def _without(reader: Reader, said: dict[str, Any], parts: Sequence[Suite]) -> tuple[str, ...]:
    """Return the methods of parts that are left out."""
    names = reader.names(("without",), said.get("without", []))
    known = {method for part in parts for method in part.methods}
    for number, name in enumerate(names):
        if name not in known:
            what = f"no part has the method '{name}'; leave it out of 'without'"
            reader.refuse(("without", number), what)
    return tuple(names)


def _axes(reader: Reader, value: Any) -> dict[str, tuple[str, ...]]:
    axes = reader.mapping(("axes",), value, dict.fromkeys(AXES, False))
    return {axis: _settings(reader, ("axes", axis), part) for axis, part in axes.items()}


def _parts(reader: Reader, value: Any) -> tuple[Suite, ...]:
    names = reader.names(("parts",), value)
    known = names_of_suites()
    for number, name in enumerate(names):
        if name not in known:
            what = f"there is no suite '{name}'; use {', '.join(known)}"
            reader.refuse(("parts", number), what)
    return tuple(load_suite(name) for name in names if name in known)


def _settings(reader: Reader, where: tuple[str, ...], value: Any) -> tuple[str, ...]:
    names = reader.names(where, value)
    for number, name in enumerate(names):
        try:
            size_of(name)
        except TeamformerError as error:
            reader.refuse((*where, number), f"{error}; {error.hint}")
    return tuple(names)


def _rules(reader: Reader, where: tuple[str, ...], value: Any) -> dict[str, int]:
    rules = reader.mapping(where, value, dict.fromkeys(RULES, False))
    return {key: reader.whole((*where, key), part, 0, 1) for key, part in rules.items()}


def _method_settings(reader: Reader, said: dict[str, Any]) -> dict[str, dict[str, str]]:
    known = dict.fromkeys(reader.names(("methods",), said.get("methods", [])), False)
    given = reader.mapping(("method_settings",), said.get("method_settings", {}), known)
    found = {}
    for name, value in given.items():
        where = ("method_settings", name)
        settings = reader.mapping(where, value, dict.fromkeys(METHOD_SETTINGS, False))
        found[name] = {
            key: _one_of(reader, (*where, key), part, METHOD_SETTINGS[key])
            for key, part in settings.items()
        }
    return found


def _one_of(reader: Reader, where: tuple[str, ...], value: Any, known: Sequence[str]) -> str:
    word = reader.text(where, value)
    if word not in known:
        reader.refuse(where, f"{where[-1]} is '{word}'; write {' or '.join(known)}")
    return word


def cells(
    suite: Suite, methods: Sequence[str] = (), settings: Sequence[str] = ()
) -> Iterator[tuple[str, str]]:
    """Yield every (setting, method) of a suite once.

    `methods`, if given, stand in for those of the suite, in each of its settings; `settings`, if
    given, are the only ones wanted.
    """
    listed = [
        (setting, method)
        for part in suite.parts or (suite,)
        for setting in part.settings
        for method in methods or (*suite.methods, *part.methods)
        if methods or method not in suite.without
    ]
    for setting, method in dict.fromkeys(listed):
        if not settings or setting in settings:
            yield setting, method
