"""One row each of what a mission came to: told in a few words and hashed in full."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator
from dataclasses import fields, is_dataclass
from hashlib import sha256
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

import teamformer as tf
from teamformer.files.drawn.named_settings import world_of
from teamformer.files.trees.writer import mission_to_tree
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.rehearsal.rehearse import judge, set_stage
from teamformer.methods.by_name import load_method
from teamformer.planning.bounds.makespan import lower_bound
from teamformer.record.export.csv_tables import write_tables
from teamformer.record.export.moments import moments

Mission = Callable[[], tf.Mission]

CLOCKED = ("_seconds", "curve")
"""What ends so in a row hangs on the clock."""


def run_row(mission: Mission, seed: int, method: str) -> str:
    """Run a mission: how it ended; places, teams and tables; plans; the critical path in words."""
    try:
        trial = tf.run(mission(), method=method, seed=seed)
    except tf.TeamformerError as error:
        return refusal(error)
    row = {key: value for key, value in trial.row.items() if not key.endswith(CLOCKED)}
    happened = [vars_of(moment) for moment in moments(trial.record)]
    told = [row, happened, tables(trial), plans(trial), trial.why_so_late]
    cost = f", cost {row['cost']}" if "cost" in row else ""
    return f"{row['status']} after {row['steps']}{cost} {short(told)}"


def tables(trial: tf.Trial) -> list[str]:
    """Return the tables of a trial, as files of commas."""
    with TemporaryDirectory() as folder:
        files = write_tables(trial.record, type(trial.save(folder))(folder))
        return [file.read_text(encoding="utf-8") for file in files]


def plans(trial: tf.Trial) -> list[Any]:
    """Return the orders of tasks and the plans that a trial was played by, with their steps."""
    record = trial.record
    made = [(step, *vars_of(plan)) for step, plan in record.plans]
    return [record.orders, made, record.scouts]


def plan_row(mission: Mission, method: str) -> str:
    """Plan a mission in continuous time: makespan and cost; every stop; the path in words."""
    try:
        made = tf.plan(mission(), method=method)
    except tf.TeamformerError as error:
        return refusal(error)
    if made is None:
        return "no plan"
    row = {key: value for key, value in made.row.items() if key != "curve"}
    cost = "" if made.cost is None else f", cost {made.cost:.6g}"
    told = [row, made.order, made.coalitions, made.why_so_late]
    return f"makespan {made.makespan:.6g}{cost}, bound {made.bound:.6g} {short(told)}"


def bound_row(mission: Mission) -> str:
    """Return the bound that `run` prints."""
    return f"{lower_bound(mission())}"


def check_row(mission: Mission) -> str:
    """Judge a record: what the referee finds in it, and in the same with a task done too soon."""
    verdict = tf.run(mission(), method="crews").check()
    return f"legal {verdict.is_legal} {short([str(finding) for finding in verdict.findings])}"


def drawn_row(setting: str) -> str:
    """Draw three missions of a setting."""
    return short([mission_to_tree(world_of(setting, seed)) for seed in range(3)])


def view_row(mission: Mission) -> str:
    """Ask for the views of eight steps in which robots join whom it helps to join."""
    policy = load_method("join-all").policy
    assert policy is not None
    told = []
    with tf.TeamFormation([mission()]) as env:
        for _ in range(8):
            view = env.view()
            told.append([array_of(part) for part in view])
            env.step(policy.decide(view))
    return short(told)


def rehearsal_row(mission: Mission, seed: int) -> str:
    """Rehearse four schedules of faults: how each ended, and what was not kept."""
    stage = set_stage(FleetMission(mission()))
    verdicts = [judge(stage, seed, schedule) for schedule in range(4)]
    ends = " ".join(verdict.outcome.status for verdict in verdicts)
    return f"{ends} {short([vars_of(verdict) for verdict in verdicts])}"


def refusal(error: Exception) -> str:
    """Return what is refused, told by its first line."""
    return f"refused {str(error).splitlines()[0][:60]!r} {short(str(error))}"


def short(told: Any) -> str:
    """Return a hash of anything told in numbers, texts, sequences and mappings."""
    return sha256(json.dumps(told, sort_keys=True, default=spell).encode()).hexdigest()[:12]


def spell(value: Any) -> Any:
    """Write what JSON does not know: arrays, numbers of numpy, sets, dataclasses."""
    if isinstance(value, np.ndarray):
        return array_of(value)
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, set | frozenset):
        return sorted(value)
    return vars_of(value) if is_dataclass(value) else str(value)


def array_of(array: Any) -> Any:
    """Return an array as its type, shape and a hash of its bytes."""
    array = np.asarray(array)
    return [str(array.dtype), array.shape, sha256(array.tobytes()).hexdigest()]


def vars_of(value: Any) -> Any:
    """Return a dataclass as a list of its values, without the names that code may change."""
    if not is_dataclass(value):
        return value
    return list(_values(getattr(value, field.name) for field in fields(value)))


def _values(values: Iterable[Any]) -> Iterator[Any]:
    for value in values:
        yield vars_of(value)
