"""The JSON Schema and the reader agree: what the reader accepts the schema accepts."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import yaml
from jsonschema import Draft202012Validator

from teamformer.cli import main
from teamformer.files.drawn.families import FAMILIES
from teamformer.files.drawn.named_settings import world_of
from teamformer.files.mission_files import mission_to_tree, read_mission
from teamformer.files.schema import mission_schema, schema_text

ROOT = Path(__file__).parents[2]
SCHEMA = mission_schema()
VALIDATOR = Draft202012Validator(SCHEMA)


def faults(tree: object) -> list[str]:
    return [error.message for error in VALIDATOR.iter_errors(tree)]


def test_the_schema_is_one() -> None:
    Draft202012Validator.check_schema(SCHEMA)


@pytest.mark.parametrize("path", sorted((ROOT / "examples").glob("*.yaml")), ids=lambda p: p.stem)
def test_examples_are_good(path: Path) -> None:
    assert faults(yaml.safe_load(path.read_text())) == []


@pytest.mark.parametrize("family", FAMILIES)
def test_drawn_missions_are_good(family: str) -> None:
    for incident in ("", "-lost", "-arrivals", "-ordered", "-mixed"):
        mission = world_of(f"{family}{incident}", 1)
        assert faults(mission_to_tree(mission)) == []


@pytest.mark.parametrize(
    ("thing", "change", "where", "told"),
    [
        ("robots", {"speed": 0}, "speed", "0 is less than the minimum of 0.001"),
        ("robots", {"colour": "red"}, "", "'colour' was unexpected"),
        ("robots", {"delays": 1}, "delays", "is not valid under any"),
        ("robots", {"moves": 3}, "moves", "3 is not of type 'string'"),
        ("tasks", {"between": [3]}, "between", "[3] is too short"),
        ("tasks", {"needs": []}, "needs", "is not valid under any"),
        ("tasks", {"cancelled": 0}, "cancelled", "0 is less than or equal to the minimum of 0"),
    ],
)
def test_mistakes_are_found_where_they_are(
    thing: str, change: dict[str, object], where: str, told: str
) -> None:
    tree = yaml.safe_load((ROOT / "examples" / "warehouse.yaml").read_text())
    tree[thing][0] |= change
    [error] = VALIDATOR.iter_errors(tree)
    assert list(error.absolute_path) == [thing, 0, *([where] if where else [])]
    assert told in error.message


def test_editors_are_told_what_a_key_means() -> None:
    speed = SCHEMA["properties"]["robots"]["items"]["properties"]["speed"]
    assert speed["description"].startswith("cells per step, 0.001 to 1000; on a plane")
    assert (speed["minimum"], speed["maximum"], speed["default"]) == (0.001, 1000, 1.0)
    lost = SCHEMA["properties"]["robots"]["items"]["properties"]["lost"]
    assert lost["description"].endswith(". If left out: never")
    assert "](" not in schema_text()


def schema_named_by(path: Path) -> Path:
    """Return the schema that the first line of a file has editors look for."""
    named = re.match(r"# yaml-language-server: \$schema=(\S+)\n", path.read_text())
    assert named, path
    return (path.parent / named.group(1)).resolve()


def test_examples_name_the_schema_that_there_is() -> None:
    examples = sorted((ROOT / "examples").glob("*.yaml"))
    assert len(examples) > 5
    assert {schema_named_by(path) for path in examples} == {ROOT / "mission.schema.json"}


def test_what_generate_writes_names_the_schema_beside_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.argv", ["teamformer", "generate", "-o", str(tmp_path / "m.yaml")])
    with pytest.raises(SystemExit):
        main()
    assert schema_named_by(tmp_path / "m.yaml") == tmp_path / "mission.schema.json"
    assert len(read_mission(tmp_path / "m.yaml").tasks) == 4
    assert not (tmp_path / "mission.schema.json").exists()  # nothing that nobody asked for
