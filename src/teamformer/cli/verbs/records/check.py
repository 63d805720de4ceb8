"""`teamformer check`: judge the record of a trial by the rules alone."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path
from typing import Any

from teamformer.cli.terminal.console import out, print_json
from teamformer.files.mission_files import read_mission
from teamformer.mission.arrivals import without_arrivals
from teamformer.mission.model import Mission
from teamformer.record.critical_path.stretches import path_rows
from teamformer.record.critical_path.words import why_so_late
from teamformer.record.files.reading import read_record
from teamformer.record.record import FLEET, Record
from teamformer.record.referee import judge
from teamformer.record.referee.verdict import Verdict
from teamformer.record.telling.whole import path_of_record

GUARANTEE = "by playing every decision again: all places, teams, tasks and totals"
OF_FLEETS = (
    "what was seen of a fleet once a step: who can do what, and be where by then; loads; the end"
)
GUARANTEE_OF_EVENTS = "by rules of their own: all events and causes, ways, teams, tasks and totals"


def check(path: Path, mission: Path | None, as_json: bool) -> int:
    """Judge a record; return 0 if every step or event was legal and every task really done.

    With a mission's file, the record must be one of that mission, too.
    """
    record = read_record(path)
    verdict = judge(record)
    moment = "at" if record.is_continuous else "step"
    findings = [{moment: f.step, "message": f.message} for f in verdict.findings]
    if mission is not None:
        findings += [
            {moment: 0, "message": f"the record is of another mission than {mission}: {how}"}
            for how in _differences(without_arrivals(record.mission), read_mission(mission))
        ]
    claimed = _claims(record)
    chain = () if verdict.findings else path_of_record(record)  # of what really happened
    if as_json:
        print_json(
            {
                "legal": not findings,
                "status": record.end.status,
                "findings": findings,
                **({} if verdict.cost is None else {"cost": round(verdict.cost, 6)}),
                "late": verdict.late,
                "mission_compared": mission is not None,
                "claimed": claimed,
                "critical_path": path_rows(record.true_mission, chain),
            }
        )
    else:
        against = "" if mission is None else f"; the mission is that of {mission}"
        _tell(record, verdict, [str(finding["message"]) for finding in findings])
        for line in why_so_late(record.true_mission, chain):
            out.print(line, markup=False)
        out.print(f"checked {_guarantee(record)}{against}", markup=False, style="dim")
        said = {name: value for name, value in claimed.items() if value is not None}
        words = ", ".join(f"{name.replace('_', ' ')} {value}" for name, value in said.items())
        out.print(f"only claimed by the record: {words}", markup=False, style="dim")
    return 1 if findings else 0


def _tell(record: Record, verdict: Verdict, findings: list[str]) -> None:
    """Print what was found, and how the trial ended."""
    for finding in findings:
        out.print(finding, markup=False)
    unit = "" if record.is_continuous else " steps"
    for task, by in verdict.late.items():
        out.print(f"late: {task} by {by:g}{unit}, which is allowed", markup=False)
    for task, other in record.end.broken_links:
        out.print(f"not kept: the link of {task} to {other}, which is allowed", markup=False)
    length = f"{verdict.steps} {'events' if record.is_continuous else 'steps'}"
    if findings:
        out.print(f"not legal: {len(findings)} findings in {length}", style="red")
    else:
        ending = f"{record.end.tasks_done} tasks done, {record.end.status}"
        out.print(f"legal: {length}, {ending}", markup=False, style="green")
    if verdict.cost is not None:
        out.print(f"at a cost of {verdict.cost:g}", markup=False)


def _guarantee(record: Record) -> str:
    """Return what the referee can judge of such a record, and how."""
    if record.is_continuous:
        return GUARANTEE_OF_EVENTS
    return OF_FLEETS if record.method == FLEET else GUARANTEE


def _claims(record: Record) -> dict[str, Any]:
    """Return what a record says of itself that its steps cannot show."""
    return {
        "method": record.method,
        "seed": record.seed,
        "lower_bound": record.lower_bound,
    }


def _differences(recorded: Mission, given: Mission) -> list[str]:
    """Say where two missions differ, but for their names, which mean nothing."""
    names = [field.name for field in fields(Mission) if field.name != "name"]
    pairs = {name: (getattr(recorded, name), getattr(given, name)) for name in names}
    return [_difference(name, *pair) for name, pair in pairs.items() if pair[0] != pair[1]]


def _difference(name: str, recorded: Any, given: Any) -> str:
    if isinstance(recorded, str | int | float):
        return f"{name} is {recorded}, there {given}"
    if name in ("robots", "tasks") and len(recorded) == len(given):
        one = next(a.name for a, b in zip(recorded, given, strict=True) if a != b)
        return f"{name} differ, {one} for example"
    return f"{name} differ" if name.endswith("s") else f"the {name} differs"
