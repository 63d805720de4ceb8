"""The record of a trial, and its file (docs/replay.md)."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from teamformer.errors import ReplayError
from teamformer.model import Scenario
from teamformer.scenarios.files import scenario_from_tree, scenario_to_tree

VERSION = 1
STATUSES = ("completed", "step limit", "infeasible", "interrupted")


class TeamAt(NamedTuple):
    """Where a team is after a step and what it heads for."""

    slot: int
    x: int
    y: int
    task: int | None


@dataclass(frozen=True)
class Step:
    """What one step changed; robots, tasks and slots are numbers."""

    joins: tuple[tuple[int, int], ...] = ()  # joiner, partner
    splits: tuple[tuple[tuple[int, ...], tuple[int, ...]], ...] = ()  # who stays, who leaves
    lost: tuple[int, ...] = ()
    teams: tuple[TeamAt, ...] = ()  # whose slot, place or assignment changed
    done: tuple[tuple[int, int], ...] = ()  # task, team that did it


@dataclass(frozen=True)
class Ending:
    """How a trial ended."""

    status: str
    makespan: int | None
    steps: int
    tasks_done: int
    joins: int
    splits: int
    illegal_decisions: int
    blocked_tasks: tuple[str, ...] = ()


@dataclass(frozen=True)
class Replay:
    """A whole trial; scenario, policy and seed determine the rest."""

    scenario: Scenario
    policy: str
    seed: int
    orders: tuple[tuple[int, tuple[int, ...]], ...]  # steps made, open tasks in order
    start: tuple[tuple[int, tuple[int, ...], int, int], ...]  # slot, robots, x, y
    steps: tuple[Step, ...]
    end: Ending
    lower_bound: int | None = None


def replay_to_tree(replay: Replay) -> dict[str, Any]:
    """Return the replay as the tree of its file."""
    return {
        "teamformer_replay": VERSION,
        "scenario": scenario_to_tree(replay.scenario),
        "policy": replay.policy,
        "seed": replay.seed,
        "orders": _lists(replay.orders),
        "start": _lists(replay.start),
        "steps": [_step_to_tree(step) for step in replay.steps],
        "end": {key: _lists(value) for key, value in vars(replay.end).items()},
        "lower_bound": replay.lower_bound,
    }


def _step_to_tree(step: Step) -> dict[str, Any]:
    return {key: _lists(value) for key, value in vars(step).items() if value}


def _lists(value: Any) -> Any:
    """Turn tuples, nested ones too, into lists."""
    return [_lists(part) for part in value] if isinstance(value, tuple) else value


def write_replay(replay: Replay, path: Path) -> None:
    """Write a replay, one step a line; a file that is there is replaced only when all is written.

    Raises OSError where the folder cannot be written.
    """
    part = path.with_name(path.name + ".part")
    part.write_text("".join(_lines(replay_to_tree(replay))), encoding="utf-8")
    os.replace(part, path)


def _lines(tree: Mapping[str, Any]) -> Iterator[str]:
    yield "{\n"
    last = list(tree)[-1]
    for key, value in tree.items():
        comma = "\n" if key == last else ",\n"
        if key == "steps":
            steps = ",\n".join(_compact(step) for step in value)
            yield f'"steps": [\n{steps}\n]{comma}'
        else:
            yield f"{_compact(key)}: {_compact(value)}{comma}"
    yield "}\n"


def _compact(value: Any) -> str:
    return json.dumps(value, separators=(",", ":"), ensure_ascii=False, allow_nan=True)


def read_replay(path: Path) -> Replay:
    """Read a replay; raises `ReplayError` saying what is wrong with the file and what to do."""
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise ReplayError(f"{path}: there is no such file") from None
    except IsADirectoryError:
        hint = f"name the file in it: {path / 'replay.json'}"
        raise ReplayError(f"{path}: this is a folder", hint) from None
    except OSError as error:
        raise ReplayError(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise ReplayError(f"{path}: this is not text, so not a replay") from None
    try:
        tree = json.loads(text)
    except (ValueError, RecursionError) as error:
        hint = "it may have been cut off; run the scenario again"
        raise ReplayError(f"{path}: this is not JSON: {error}", hint) from None
    return replay_from_tree(tree, str(path))


def replay_from_tree(tree: Any, source: str) -> Replay:
    """Build a replay from the tree of its file; `source` names it in errors."""
    if not isinstance(tree, dict) or "teamformer_replay" not in tree:
        raise ReplayError(f"{source}: this is not a replay: it has no 'teamformer_replay'")
    version = tree["teamformer_replay"]
    if not _is_number(version) or version < 1:
        raise ReplayError(f"{source}: the format version is {version!r}, not a number from 1 on")
    if version > VERSION:
        hint = "install a newer teamformer"
        raise ReplayError(f"{source}: format {version} is newer than {VERSION}", hint)
    scenario = scenario_from_tree(tree.get("scenario"), f"{source}: scenario")
    try:
        return _build(tree, scenario)
    except (KeyError, TypeError, ValueError) as error:
        what = f"'{error.args[0]}' is missing" if isinstance(error, KeyError) else str(error)
        raise ReplayError(f"{source}: this record is damaged: {what}") from None


def _build(tree: Mapping[str, Any], scenario: Scenario) -> Replay:
    robots, tasks = len(scenario.robots), len(scenario.tasks)
    end = dict(tree["end"])
    end["blocked_tasks"] = tuple(_text(name) for name in _sequence(end["blocked_tasks"]))
    if end["status"] not in STATUSES:
        raise ValueError(f"the status {end['status']!r} is unknown")
    for key, value in end.items():
        if key not in ("status", "blocked_tasks") and not (key == "makespan" and value is None):
            _number(value)
    bound = tree["lower_bound"]
    return Replay(
        scenario=scenario,
        policy=_text(tree["policy"]),
        seed=_number(tree["seed"]),
        orders=tuple((_number(at), _numbers(order, tasks)) for at, order in tree["orders"]),
        start=tuple(
            (_below(slot, robots), _numbers(members, robots), _number(x), _number(y))
            for slot, members, x, y in tree["start"]
        ),
        steps=tuple(_step_from_tree(step, robots, tasks) for step in _sequence(tree["steps"])),
        end=Ending(**end),
        lower_bound=None if bound is None else _number(bound),
    )


def _step_from_tree(step: Mapping[str, Any], robots: int, tasks: int) -> Step:
    if not isinstance(step, dict):
        raise ValueError(f"a step is {step!r}, not a mapping")
    unknown = set(step) - set(Step.__dataclass_fields__)
    if unknown:
        raise ValueError(f"a step says '{min(unknown)}', which means nothing")
    return Step(
        joins=tuple(
            (_below(joiner, robots), _below(partner, robots))
            for joiner, partner in step.get("joins", ())
        ),
        splits=tuple(
            (_numbers(stay, robots), _numbers(leave, robots))
            for stay, leave in step.get("splits", ())
        ),
        lost=_numbers(step.get("lost", []), robots),
        teams=tuple(
            TeamAt(
                _below(slot, robots),
                _number(x),
                _number(y),
                None if task is None else _below(task, tasks),
            )
            for slot, x, y, task in step.get("teams", ())
        ),
        done=tuple(
            (_below(task, tasks), _below(slot, robots)) for task, slot in step.get("done", ())
        ),
    )


def _is_number(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def _number(value: Any) -> int:
    if not _is_number(value):
        raise ValueError(f"{value!r} stands where a whole number belongs")
    return int(value)


def _below(value: Any, limit: int) -> int:
    if not 0 <= _number(value) < limit:
        raise ValueError(f"the number {value} is not among 0 to {limit - 1}")
    return int(value)


def _numbers(values: Any, limit: int) -> tuple[int, ...]:
    return tuple(_below(value, limit) for value in _sequence(values))


def _sequence(values: Any) -> Sequence[Any]:
    if not isinstance(values, list):
        raise ValueError(f"{values!r} stands where a list belongs")
    return values


def _text(value: Any) -> str:
    if not isinstance(value, str):
        raise ValueError(f"{value!r} stands where a text belongs")
    return value
