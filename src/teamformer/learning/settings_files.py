"""Settings of trainings in YAML files; `TrainSettings` and the classes in it are the schema."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, is_dataclass
from typing import Any, get_args, get_type_hints

from teamformer.base.errors import TeamformerError
from teamformer.base.file_access import names_of_shipped, read_shipped_or_own
from teamformer.files.mission_files import error_of
from teamformer.files.yaml.reader import Tree, Where, from_value, parse
from teamformer.files.yaml.tree_reader import Reader, name_of
from teamformer.files.yaml.words import describe
from teamformer.learning.training_settings import DEVICES, TrainSettings

FOLDER = ("learning", "settings")


def names_of_settings() -> list[str]:
    """Return the settings that come with the package, by which the shipped networks learned."""
    return names_of_shipped(*FOLDER)


def load_settings(name: str) -> TrainSettings:
    """Return settings by their name, or from a file of the user's own that ends in .yaml.

    Raises `TeamformerError` for an unknown name (with the nearest ones) and for what is wrong in
    a file, by line.
    """
    own = "your own are a .yaml file; the folder of a training goes on with it"
    text, source = read_shipped_or_own(name, FOLDER, "there are no settings", own)
    return _read(parse(text), source)


def settings_of(value: Any, source: str) -> TrainSettings:
    """Return the settings that a checkpoint was made with; `source` names it in errors."""
    return _read(from_value(value), source)


def _read(tree: Tree, source: str) -> TrainSettings:
    reader = Reader(tree)
    said: dict[str, Any] = {}
    if not tree.problems:
        said = _values(reader, (), tree.value, TrainSettings)
        if said.get("team_reward") is not None and "mission_reward" not in said:
            said["mission_reward"] = None  # there is one reward only
        if said.get("device", DEVICES[0]) not in DEVICES:
            what = f"device is '{said['device']}'; write {' or '.join(DEVICES)}"
            reader.refuse(("device",), what)
    if tree.problems:
        raise error_of(tree, source)
    try:
        return TrainSettings(**said)
    except TeamformerError as error:
        raise TeamformerError(f"{source}: {error}", error.hint) from None


def _values(reader: Reader, where: Where, value: Any, kind: type) -> dict[str, Any]:
    """Return what a mapping says of the fields of a dataclass."""
    types = get_type_hints(kind)
    said = reader.mapping(where, value, dict.fromkeys((each.name for each in fields(kind)), False))
    return {key: _value(reader, (*where, key), part, types[key]) for key, part in said.items()}


def _value(reader: Reader, where: Where, value: Any, kind: Any) -> Any:
    """Return the value of one field, of which `kind` is the type."""
    options = [option for option in get_args(kind) if option is not type(None)]
    if type(None) in get_args(kind):
        return None if value is None else _value(reader, where, value, options[0])
    if is_dataclass(kind):
        assert isinstance(kind, type)
        return kind(**_values(reader, where, value, kind))
    if options:
        return _range(reader, where, value)
    return READ[kind](reader, where, value)


def _range(reader: Reader, where: Where, value: Any) -> tuple[int, int]:
    pair = reader.pair(where, value, "write [least, most]") or [1, 1]
    least, most = (reader.whole((*where, end), part, 1) for end, part in enumerate(pair))
    if least > most:
        reader.refuse(where, f"{name_of(where)} is {least} to {most}; write [{most}, {least}]")
    return least, most


def _whole(reader: Reader, where: Where, value: Any) -> int:
    return reader.whole(where, value, least=0 if where == ("seed",) else 1)


def _number(reader: Reader, where: Where, value: Any) -> float:
    number = reader.number(where, value)
    if number < 0 and where[-1] != "step":  # steps may cost
        reader.refuse(where, f"{name_of(where)} is {describe(value)}; write 0 or more")
    return number


READ: dict[type, Callable[[Reader, Where, Any], Any]] = {
    int: _whole,
    float: _number,
    str: lambda reader, where, value: reader.text(where, value) if value else "",
}
"""How the value of a field is read, by its type."""
