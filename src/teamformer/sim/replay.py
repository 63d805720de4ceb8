"""The record of a trial, and its file (docs/replay.md)."""

from __future__ import annotations

import json
import reprlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, NamedTuple

from teamformer.errors import ReplayError, TeamformerError
from teamformer.model import LARGEST_NUMBER, Scenario
from teamformer.plane import Plane
from teamformer.rules.constants import PLAN_REASONS
from teamformer.scenarios.file_access import read_text
from teamformer.scenarios.files import scenario_from_tree, scenario_to_tree
from teamformer.whole_files import write_whole

VERSION = 1
STATUSES = ("completed", "step limit", "infeasible", "interrupted")

LARGEST_COUNT = 2**53
"""Which every reader of JSON keeps exact, the page's too."""

LARGEST_FILE = 1_000_000_000  # bytes
"""A thousand robots on the move for three thousand steps take 40 MB."""
RUN_AGAIN = "run the scenario again to have it written anew"


class TeamAt(NamedTuple):
    """Where a team is after a step and what it heads for."""

    slot: int
    x: float  # a whole number on a grid
    y: float
    task: int | None


class Crew(NamedTuple):
    """A part of the fleet, and the open tasks that are its to do, in order."""

    robots: tuple[int, ...]
    tasks: tuple[int, ...]


class SharedPlanMade(NamedTuple):
    """A shared plan: why it was made, and who does each open task, in the order then."""

    reasons: tuple[str, ...]
    coalitions: tuple[tuple[int, ...], ...]


@dataclass(frozen=True)
class Step:
    """What one step changed; robots, tasks and slots are numbers."""

    joins: tuple[tuple[int, int], ...] = ()  # joiner, partner
    splits: tuple[tuple[tuple[int, ...], tuple[int, ...]], ...] = ()  # who stays, who leaves
    lost: tuple[int, ...] = ()
    teams: tuple[TeamAt, ...] = ()  # whose slot, place or assignment changed
    done: tuple[tuple[int, int], ...] = ()  # task, team that did it
    named: tuple[int, ...] = ()  # teams whose decision named their task, where tasks are shared out
    took: tuple[tuple[int, int], ...] = ()  # like robots that exchanged their parts of the plan


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
    start: tuple[tuple[int, tuple[int, ...], float, float], ...]  # slot, robots, x, y
    steps: tuple[Step, ...]
    end: Ending
    lower_bound: int | None = None
    crews: tuple[tuple[int, tuple[Crew, ...]], ...] = ()  # steps made, crews from then on
    plans: tuple[tuple[int, SharedPlanMade], ...] = ()  # steps made, the shared plan from then on


STEP_KEYS = tuple(field.name for field in fields(Step))
ENDING_KEYS = tuple(field.name for field in fields(Ending))
ENDING_COUNTS = ("steps", "tasks_done", "joins", "splits", "illegal_decisions")
REPLAY_KEYS = ("teamformer_replay", *(field.name for field in fields(Replay)))
NEEDED_KEYS = tuple(key for key in REPLAY_KEYS if key not in ("crews", "plans"))


def replay_to_tree(replay: Replay) -> dict[str, Any]:
    """Return the replay as the tree of its file."""
    tree = {
        "teamformer_replay": VERSION,
        "scenario": scenario_to_tree(replay.scenario),
        "policy": replay.policy,
        "seed": replay.seed,
        "orders": _lists(replay.orders),
        "start": _lists(replay.start),
        "steps": [step_to_tree(step) for step in replay.steps],
        "end": {key: _lists(value) for key, value in vars(replay.end).items()},
        "lower_bound": replay.lower_bound,
    }
    if replay.crews:
        tree["crews"] = _lists(replay.crews)
    if replay.plans:
        tree["plans"] = _lists(replay.plans)
    return tree


def step_to_tree(step: Step) -> dict[str, Any]:
    """Return what a step changed as it stands in the file; what has nothing to say is left out."""
    return {key: _lists(value) for key, value in vars(step).items() if value}


def _lists(value: Any) -> Any:
    """Turn tuples, nested ones too, into lists."""
    return [_lists(part) for part in value] if isinstance(value, tuple) else value


def write_replay(replay: Replay, path: Path) -> None:
    """Write a replay, one step a line, whole or not at all.

    Raises OSError where the folder cannot be written.
    """
    write_whole(path, "".join(_lines(replay_to_tree(replay))))


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
    # ASCII: a name given to a policy on the command line need not be text that UTF-8 can hold.
    return json.dumps(value, separators=(",", ":"), allow_nan=False)


def read_replay(path: Path) -> Replay:
    """Read a replay file.

    Raises `ReplayError` saying what is wrong with the file and what to do, `ScenarioError` where
    the scenario in it is what is wrong.
    """
    if path.is_dir():
        raise ReplayError(
            f"{path}: this is a folder", f"name the file in it: {path / 'replay.json'}"
        )
    try:
        text = read_text(path, LARGEST_FILE, "`teamformer run SCENARIO --out DIR` writes one")
    except TeamformerError as error:
        raise ReplayError(str(error), error.hint) from None
    return replay_from_tree(_parse(text, str(path)), str(path))


def _parse(text: str, source: str) -> Any:
    try:
        return json.loads(text, object_pairs_hook=_without_doubles)
    except _DamageError as damage:
        raise ReplayError(f"{source}: the record is damaged: {damage}", RUN_AGAIN) from None
    except json.JSONDecodeError as error:
        is_cut = _is_unfinished(text[error.pos :].strip()) or error.msg.startswith("Unterminated")
        what = "it breaks off" if is_cut else f"this is not JSON: {error.msg}"
        raise ReplayError(f"{source}:{error.lineno}: {what}", RUN_AGAIN) from None
    except (ValueError, RecursionError) as error:
        is_deep = isinstance(error, RecursionError)
        what = "lists lie in lists in lists" if is_deep else "a number has thousands of digits"
        raise ReplayError(f"{source}: this is no replay: {what}", RUN_AGAIN) from None


def _without_doubles(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Build a mapping; of a key that stands twice two readers might read different values."""
    tree = dict(pairs)
    if len(tree) < len(pairs):
        keys = [key for key, _ in pairs]
        twice = next(key for key in keys if keys.count(key) > 1)
        raise _DamageError(f"the key {_short(twice)} stands twice in one mapping")
    return tree


def _is_unfinished(rest: str) -> bool:
    """Say whether a parser stumbled over the end: nothing, half a word or half a number."""
    return any(word.startswith(rest) for word in ("null", "true", "false", "-", "."))


def replay_from_tree(tree: Any, source: str) -> Replay:
    """Build a replay from the tree of its file; `source` names it in errors.

    Raises what `read_replay` raises.
    """
    _check_version(tree, source)
    try:
        _check_keys(tree, REPLAY_KEYS, NEEDED_KEYS)
        scenario = scenario_from_tree(tree["scenario"], f"{source}: scenario")
        return _replay(tree, scenario)
    except _DamageError as damage:
        raise ReplayError(f"{source}: the record is damaged: {damage}", RUN_AGAIN) from None


def _check_version(tree: Any, source: str) -> None:
    if not isinstance(tree, dict) or "teamformer_replay" not in tree:
        hint = "name the replay.json that `teamformer run` wrote"
        raise ReplayError(f"{source}: this is not a replay: it has no 'teamformer_replay'", hint)
    version = tree["teamformer_replay"]
    if not _is_number(version) or version < 1:
        what = f"the format version is {_short(version)}, not a number from 1 on"
        raise ReplayError(f"{source}: {what}", RUN_AGAIN)
    if version > VERSION:
        what = f"format {_short(version)} is newer than {VERSION}"
        raise ReplayError(f"{source}: {what}", "install a newer teamformer")


class _DamageError(Exception):
    """Something in a record that is not what it should be."""


@contextmanager
def _inside(where: str) -> Iterator[None]:
    """Say where in the record the damage is."""
    try:
        yield
    except _DamageError as damage:
        raise _DamageError(f"{where}: {damage}") from None


Coordinate = Callable[[Any], float]
"""Reads a coordinate: whole on a grid."""


def _replay(tree: Mapping[str, Any], scenario: Scenario) -> Replay:
    robots, tasks = len(scenario.robots), len(scenario.tasks)
    bound = tree["lower_bound"]
    along = _metres if isinstance(scenario.world, Plane) else _number
    with _inside("orders"):
        orders = tuple(
            (_count(at), _numbers(order, tasks)) for at, order in _rows(tree["orders"], 2)
        )
    with _inside("crews"):
        crews = tuple(
            (_count(at), tuple(_crew(crew, robots, tasks) for crew in _list(made)))
            for at, made in _rows(tree.get("crews", []), 2)
        )
    with _inside("plans"):
        plans = tuple(
            (_count(at), _plan(made, robots)) for at, made in _rows(tree.get("plans", []), 2)
        )
    with _inside("start"):
        start = tuple(
            (_below(slot, robots), _numbers(members, robots), along(x), along(y))
            for slot, members, x, y in _rows(tree["start"], 4)
        )
    with _inside("end"):
        end = _ending(tree["end"])
    return Replay(
        scenario=scenario,
        policy=_text(tree["policy"]),
        seed=_whole(tree["seed"]),
        orders=orders,
        start=start,
        steps=tuple(_steps(tree["steps"], robots, tasks, along)),
        end=end,
        lower_bound=None if bound is None else _count(bound),
        crews=crews,
        plans=plans,
    )


def _crew(row: Any, robots: int, tasks: int) -> Crew:
    [[members, listed]] = _rows([row], 2)
    return Crew(_numbers(members, robots), _numbers(listed, tasks))


def _plan(row: Any, robots: int) -> SharedPlanMade:
    [[reasons, coalitions]] = _rows([row], 2)
    for reason in _list(reasons):
        if reason not in PLAN_REASONS:
            raise _DamageError(f"the reason is {_short(reason)}, not one of {PLAN_REASONS}")
    return SharedPlanMade(
        tuple(reasons), tuple(_numbers(coalition, robots) for coalition in _list(coalitions))
    )


def _ending(tree: Any) -> Ending:
    _check_keys(tree, ENDING_KEYS, ENDING_KEYS)
    if tree["status"] not in STATUSES:
        raise _DamageError(f"the status is {_short(tree['status'])}, not one of {STATUSES}")
    blocked = tuple(_text(name) for name in _list(tree["blocked_tasks"]))
    makespan = None if tree["makespan"] is None else _count(tree["makespan"])
    counts = {key: _count(tree[key]) for key in ENDING_COUNTS}
    return Ending(status=tree["status"], makespan=makespan, blocked_tasks=blocked, **counts)


def _steps(trees: Any, robots: int, tasks: int, along: Coordinate) -> Iterator[Step]:
    for number, tree in enumerate(_list(trees), start=1):
        with _inside(f"step {number}"):
            yield _step(tree, robots, tasks, along)


def _step(tree: Any, robots: int, tasks: int, along: Coordinate) -> Step:
    _check_keys(tree, STEP_KEYS)
    joins, splits = _rows(tree.get("joins", []), 2), _rows(tree.get("splits", []), 2)
    teams, done = _rows(tree.get("teams", []), 4), _rows(tree.get("done", []), 2)
    took = _rows(tree.get("took", []), 2)
    return Step(
        joins=tuple((_below(one, robots), _below(other, robots)) for one, other in joins),
        splits=tuple((_numbers(stay, robots), _numbers(leave, robots)) for stay, leave in splits),
        lost=_numbers(tree.get("lost", []), robots),
        teams=tuple(
            TeamAt(
                _below(slot, robots),
                along(x),
                along(y),
                None if task is None else _below(task, tasks),
            )
            for slot, x, y, task in teams
        ),
        done=tuple((_below(task, tasks), _below(slot, robots)) for task, slot in done),
        named=_numbers(tree.get("named", []), robots),
        took=tuple((_below(one, robots), _below(other, robots)) for one, other in took),
    )


def _check_keys(tree: Any, known: Sequence[str], needed: Sequence[str] = ()) -> None:
    if not isinstance(tree, dict):
        raise _DamageError(f"{_short(tree)} stands where a mapping belongs")
    for key in tree:
        if key not in known:
            raise _DamageError(f"the key {_short(key)} means nothing; known are {', '.join(known)}")
    for key in needed:
        if key not in tree:
            raise _DamageError(f"the key '{key}' is missing")


def _rows(values: Any, width: int) -> Iterator[list[Any]]:
    for row in _list(values):
        if not isinstance(row, list) or len(row) != width:
            raise _DamageError(f"{_short(row)} stands where a list of {width} belongs")
        yield row


def _list(values: Any) -> list[Any]:
    if not isinstance(values, list):
        raise _DamageError(f"{_short(values)} stands where a list belongs")
    return values


def _numbers(values: Any, limit: int) -> tuple[int, ...]:
    return tuple(_below(value, limit) for value in _list(values))


def _below(value: Any, limit: int) -> int:
    if not 0 <= _number(value) < limit:
        raise _DamageError(f"{_short(value)} stands where a number from 0 to {limit - 1} belongs")
    return int(value)


def _count(value: Any) -> int:
    if _number(value) < 0:
        raise _DamageError(f"{_short(value)} stands where 0 or more belongs")
    return int(value)


def _number(value: Any) -> int:
    """Return a whole number that counts something or says where something is."""
    if not abs(_whole(value)) <= LARGEST_COUNT:
        raise _DamageError(f"{_short(value)} is more than a record can count")
    return int(value)


def _whole(value: Any) -> int:
    if not _is_number(value):
        raise _DamageError(f"{_short(value)} stands where a whole number belongs")
    return int(value)


def _metres(value: Any) -> float:
    """Return a coordinate in a plane."""
    if type(value) not in (int, float) or not abs(value) <= LARGEST_NUMBER:  # NaN too
        raise _DamageError(f"{_short(value)} stands where a number belongs")
    return float(value)


def _is_number(value: Any) -> bool:
    return type(value) is int  # not True, which is an int to Python


def _text(value: Any) -> str:
    if not isinstance(value, str):
        raise _DamageError(f"{_short(value)} stands where a text belongs")
    return value


def _short(value: Any) -> str:
    return reprlib.repr(value)
