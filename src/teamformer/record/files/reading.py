"""Reading a record's file, which anybody may have written."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

from teamformer.base.errors import RecordError, TeamformerError
from teamformer.base.file_access import read_text
from teamformer.files.mission_files import mission_from_tree
from teamformer.files.trees.mission import RECORD
from teamformer.mission.arrivals import with_arrivals
from teamformer.mission.checks.rules import FORESIGHTS
from teamformer.mission.coordination import NEWS
from teamformer.mission.model import Mission
from teamformer.mission.parts.plane import Plane
from teamformer.record.files.endings import ending_from_tree
from teamformer.record.files.events import REASONS, events_from_tree
from teamformer.record.files.truths import truth_from_tree
from teamformer.record.files.values import (
    DamageError,
    check_keys,
    count_of,
    inside,
    is_whole,
    list_of,
    metres,
    number_below,
    number_of,
    numbers_below,
    rows_of,
    short,
    text_of,
    time_of,
    whole_number,
)
from teamformer.record.phases import CHARGE
from teamformer.record.record import (
    FLEET,
    HEARD,
    VERSION,
    Record,
    SharedPlanMade,
    Step,
    TaskAt,
    TeamAt,
    Wants,
)
from teamformer.world.continuous.events import WHY_MISSED

LARGEST_FILE = 1_000_000_000  # bytes
"""A thousand robots on the move for three thousand steps take 40 MB."""
RUN_AGAIN = "run the mission again to have it written anew"

STEP_KEYS = tuple(field.name for field in fields(Step))
RECORD_BEFORE = "teamformer_replay"
"""The key of a record's version in formats 1 and 2."""

RECORD_KEYS = (RECORD, *(field.name for field in fields(Record) if field.init))
OPTIONAL_KEYS = ("plans", "scouts", "truth", "foresight", "heeds", "decisions", "told")
OF_STEPS = ("orders", "start", "steps", "plans", "scouts", "decisions")
OF_EVENTS = ("events",)
"""Keys of records in steps alone, and of those in continuous time."""


def read_record(path: Path) -> Record:
    """Read a record file.

    Raises `RecordError` saying what is wrong with the file and what to do, `MissionError` where
    the mission in it is what is wrong.
    """
    if path.is_dir():
        raise RecordError(
            f"{path}: this is a folder", f"name the file in it: {path / 'record.json'}"
        )
    try:
        text = read_text(path, LARGEST_FILE, "`teamformer run MISSION --out DIR` writes one")
    except TeamformerError as error:
        raise RecordError(str(error), error.hint) from None
    return record_from_tree(_parse(text, str(path)), str(path))


def _parse(text: str, source: str) -> Any:
    try:
        return json.loads(text, object_pairs_hook=_without_doubles)
    except DamageError as damage:
        raise RecordError(f"{source}: the record is damaged: {damage}", RUN_AGAIN) from None
    except json.JSONDecodeError as error:
        if any(line.startswith("teamformer:") for line in text.splitlines()):
            hint = "run it with --out FOLDER: that writes its record, record.json"
            raise RecordError(f"{source}: this is a mission, not a record", hint) from None
        is_cut = _is_unfinished(text[error.pos :].strip()) or error.msg.startswith("Unterminated")
        what = "it breaks off" if is_cut else f"this is not JSON: {error.msg}"
        raise RecordError(f"{source}:{error.lineno}: {what}", RUN_AGAIN) from None
    except (ValueError, RecursionError) as error:
        is_deep = isinstance(error, RecursionError)
        what = "lists lie in lists in lists" if is_deep else "a number has thousands of digits"
        raise RecordError(f"{source}: this is no record: {what}", RUN_AGAIN) from None


def _without_doubles(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Build a mapping; of a key that stands twice two readers might read different values."""
    tree = dict(pairs)
    if len(tree) < len(pairs):
        keys = [key for key, _ in pairs]
        twice = next(key for key in keys if keys.count(key) > 1)
        raise DamageError(f"the key {short(twice)} stands twice in one mapping")
    return tree


def _is_unfinished(rest: str) -> bool:
    """Say whether a parser stumbled over the end: nothing, half a word or half a number."""
    return any(word.startswith(rest) for word in ("null", "true", "false", "-", "."))


def record_from_tree(tree: Any, source: str) -> Record:
    """Build a record from the tree of its file; `source` names it in errors.

    Raises what `read_record` raises.
    """
    _check_version(tree, source)
    try:
        check_keys(tree, RECORD_KEYS, ("mission",))
        mission = mission_from_tree(tree["mission"], f"{source}: mission")
        foreign = OF_STEPS if mission.time == "continuous" else OF_EVENTS
        known = [key for key in RECORD_KEYS if key not in foreign]
        check_keys(tree, known, [key for key in known if key not in OPTIONAL_KEYS])
        return _record(tree, mission)
    except DamageError as damage:
        raise RecordError(f"{source}: the record is damaged: {damage}", RUN_AGAIN) from None


def _check_version(tree: Any, source: str) -> None:
    if isinstance(tree, dict) and RECORD_BEFORE in tree:
        what = f"its format is of an earlier teamformer, which called a record '{RECORD_BEFORE}'"
        raise RecordError(f"{source}: {what}", RUN_AGAIN)
    if not isinstance(tree, dict) or RECORD not in tree:
        hint = "name the record.json that `teamformer run` wrote"
        raise RecordError(f"{source}: this is not a record: it has no '{RECORD}'", hint)
    version = tree[RECORD]
    if not is_whole(version) or version < 1:
        what = f"the format version is {short(version)}, not a number from 1 on"
        raise RecordError(f"{source}: {what}", RUN_AGAIN)
    if version < VERSION:
        what = f"format {version} is of an earlier teamformer, which wrote other keys"
        raise RecordError(f"{source}: {what}", RUN_AGAIN)
    if version > VERSION:
        what = f"format {short(version)} is newer than {VERSION}"
        raise RecordError(f"{source}: {what}", "install a newer teamformer")


Coordinate = Callable[[Any], float]
"""Reads a coordinate: whole on a grid."""


def _record(tree: Mapping[str, Any], mission: Mission) -> Record:
    with inside("truth"):
        truth = None
        if mission.has_surprises or "truth" in tree:
            truth = truth_from_tree(mission, tree.get("truth"))
            mission = with_arrivals(mission, truth)
    bound, is_continuous = tree["lower_bound"], mission.time == "continuous"
    measure = time_of if is_continuous else count_of
    with inside("end"):
        end = ending_from_tree(tree["end"], is_continuous)
    return Record(
        mission=mission,
        method=text_of(tree["method"]),
        seed=whole_number(tree["seed"]),
        end=end,
        lower_bound=None if bound is None else measure(bound),
        truth=truth,
        foresight=_foresight(tree),
        heeds=_heeds(tree),
        told=tree.get("told"),
        **(_of_events(tree, mission) if is_continuous else _of_steps(tree, mission)),
    )


def _of_events(tree: Mapping[str, Any], mission: Mission) -> dict[str, Any]:
    """Return what a record in continuous time has instead of steps."""
    with inside("events"):
        return {"events": events_from_tree(tree["events"], mission)}


def _of_steps(tree: Mapping[str, Any], mission: Mission) -> dict[str, Any]:
    """Return what a record in steps has."""
    robots, tasks = len(mission.robots), len(mission.tasks)
    along = metres if isinstance(mission.world, Plane) else number_of
    with inside("orders"):
        orders = tuple(
            (count_of(at), numbers_below(order, tasks)) for at, order in rows_of(tree["orders"], 2)
        )
    with inside("plans"):
        plans = tuple(
            (count_of(at), _plan(made, robots)) for at, made in rows_of(tree.get("plans", []), 2)
        )
    with inside("scouts"):
        scouts = tuple(
            (count_of(at), _pairs(made, robots, tasks))
            for at, made in rows_of(tree.get("scouts", []), 2)
        )
    with inside("start"):
        start = tuple(
            (number_below(slot, robots), numbers_below(members, robots), along(x), along(y))
            for slot, members, x, y in rows_of(tree["start"], 4)
        )
    with inside("decisions"):
        caps = len(mission.capabilities)
        decisions = tuple(
            (count_of(step), tuple(_wants(row, robots, caps) for row in rows_of(rows, 3, 1)))
            for step, rows in rows_of(tree.get("decisions", []), 2)
        )
    steps = tuple(_steps(tree["steps"], robots, tasks, along))
    if tree["method"] != FLEET and any(slot is None for step in steps for _, slot in step.done):
        raise DamageError("a task is done by nobody, which only the record of a fleet may say")
    return {
        "orders": orders,
        "plans": plans,
        "scouts": scouts,
        "start": start,
        "decisions": decisions,
        "steps": steps,
    }


def _foresight(tree: Mapping[str, Any]) -> str:
    found = tree.get("foresight", Record.foresight)
    if found not in FORESIGHTS:
        raise DamageError(f"the foresight is {short(found)}, not one of {FORESIGHTS}")
    return str(found)


def _heeds(tree: Mapping[str, Any]) -> tuple[str, ...]:
    with inside("heeds"):
        found = tuple(text_of(word) for word in list_of(tree.get("heeds", list(Record.heeds))))
    for word in found:
        if word not in NEWS:
            raise DamageError(f"{short(word)} is no news that a coordinator may heed")
    return found


def _plan(row: Any, robots: int) -> SharedPlanMade:
    [[reasons, coalitions]] = rows_of([row], 2)
    for reason in list_of(reasons):
        if reason not in REASONS:
            raise DamageError(f"the reason is {short(reason)}, not one of {REASONS}")
    return SharedPlanMade(
        tuple(reasons), tuple(numbers_below(coalition, robots) for coalition in list_of(coalitions))
    )


def _wants(row: Sequence[Any], robots: int, caps: int) -> Wants:
    slot, counts, task = (*row, None, None)[:3]
    if counts is not None:
        [counts] = rows_of([counts], caps)
        counts = tuple(metres(one) if isinstance(one, float) else number_of(one) for one in counts)
    return Wants(number_below(slot, robots), counts, None if task is None else number_of(task))


def _pairs(rows: Any, firsts: int, seconds: int) -> tuple[tuple[int, int], ...]:
    """Return rows of two numbers: the first ones and the second ones are below so many."""
    pairs = rows_of(rows, 2)
    return tuple((number_below(one, firsts), number_below(two, seconds)) for one, two in pairs)


def _places(rows: Any, tasks: int, along: Coordinate) -> tuple[TaskAt, ...]:
    """Return rows that say where tasks are."""
    return tuple(
        TaskAt(number_below(task, tasks), along(x), along(y)) for task, x, y in rows_of(rows, 3)
    )


def _steps(trees: Any, robots: int, tasks: int, along: Coordinate) -> Iterator[Step]:
    heads_for: dict[int, Any] = {}
    for number, tree in enumerate(list_of(trees), start=1):
        with inside(f"step {number}"):
            yield _step(tree, robots, tasks, along, heads_for)


def _step(tree: Any, robots: int, tasks: int, along: Coordinate, heads_for: dict[int, Any]) -> Step:
    """Read a step; `heads_for` has by slot what teams headed for when a row last said so."""
    check_keys(tree, STEP_KEYS)
    return Step(
        joins=_pairs(tree.get("joins", []), robots, robots),
        splits=tuple(
            (numbers_below(stay, robots), numbers_below(leave, robots))
            for stay, leave in rows_of(tree.get("splits", []), 2)
        ),
        lost=numbers_below(tree.get("lost", []), robots),
        back=numbers_below(tree.get("back", []), robots),
        teams=tuple(
            _team(row, robots, tasks, along, heads_for)
            for row in rows_of(tree.get("teams", []), 4, 3)
        ),
        done=tuple(
            (number_below(task, tasks), None if slot is None else number_below(slot, robots))
            for task, slot in rows_of(tree.get("done", []), 2)
        ),
        named=numbers_below(tree.get("named", []), robots),
        took=_pairs(tree.get("took", []), robots, robots),
        heard=tuple(_heard(row, robots) for row in rows_of(tree.get("heard", []), 3)),
        shown=numbers_below(tree.get("shown", []), tasks),
        found=numbers_below(tree.get("found", []), tasks),
        moved=_places(tree.get("moved", []), tasks, along),
        taken=_pairs(tree.get("taken", []), tasks, robots),
        left=_places(tree.get("left", []), tasks, along),
        pursued=_pairs(tree.get("pursued", []), robots, tasks),
        served=tuple(
            (number_below(task, tasks), numbers_below(members, robots))
            for task, members in rows_of(tree.get("served", []), 2)
        ),
        unloads=numbers_below(tree.get("unloads", []), tasks),
        missed=tuple(
            (number_below(task, tasks), _why_missed(why))
            for task, why in rows_of(tree.get("missed", []), 2)
        ),
        charge=tuple(
            (number_below(robot, robots), _at_charger(doing))
            for robot, doing in rows_of(tree.get("charge", []), 2)
        ),
    )


def _at_charger(doing: Any) -> str:
    if text_of(doing) not in CHARGE:
        raise DamageError(f"what is done at a charger is {short(doing)}, not one of {[*CHARGE]}")
    return text_of(doing)


def _why_missed(why: Any) -> str:
    if text_of(why) not in WHY_MISSED:
        raise DamageError(f"why a task was missed is {short(why)}, not one of {[*WHY_MISSED]}")
    return str(why)


def _team(
    row: Sequence[Any], robots: int, tasks: int, along: Coordinate, heads_for: dict[int, Any]
) -> TeamAt:
    slot, x, y, *said = row
    slot = number_below(slot, robots)
    for task in said:
        heads_for[slot] = None if task is None else number_below(task, tasks)
    return TeamAt(slot, along(x), along(y), heads_for.get(slot))


def _heard(row: Sequence[Any], robots: int) -> tuple[int, int, str]:
    sender, receiver, what = row
    if what not in HEARD:
        raise DamageError(f"what was heard is {short(what)}, not one of {HEARD}")
    return number_below(sender, robots), number_below(receiver, robots), what
