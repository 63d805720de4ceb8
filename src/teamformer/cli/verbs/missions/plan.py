"""`teamformer plan`: who goes where when, if nothing unforeseen happens."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rich.table import Table
from rich.text import Text

from teamformer.cli.terminal.compiling import compile_ahead
from teamformer.cli.terminal.console import out, prepare_folder, print_json, say
from teamformer.cli.terminal.recorded import write_and_say
from teamformer.files.mission_files import read_mission
from teamformer.methods.by_name import load_method
from teamformer.mission.checks.rules import rules_not_planned
from teamformer.mission.model import Mission
from teamformer.trials.planned import PlannedMission, plan_mission, refuse_unplannable
from teamformer.trials.start_plan import read_start_plan

LONGEST_TABLE = 40  # robots


def plan(
    path: Path,
    method: str,
    time_limit: float,
    start: Path | None,
    folder: Path | None,
    as_json: bool,
) -> int:
    """Plan a mission and show the plan; return the exit status.

    A folder gets the record of the plan and its page.

    `start` is a file with a plan to begin with.
    """
    mission = read_mission(path, rules_not_planned)
    refuse_unplannable(mission, method)
    begin = None if start is None else read_start_plan(start, mission)
    if folder is not None:
        prepare_folder(folder)
    if mission.time != "continuous":
        _prepare(mission, method)
    made = plan_mission(mission, method, time_limit, begin)
    if made is None:
        say(f"no plan was found for {mission.name}; a longer --time-limit may find one")
        return 1
    if as_json:
        print_json(made.row)
    else:
        _show(made, made.row)
    if folder is not None:
        write_and_say(made.record, folder)
    return 0


def _prepare(mission: Mission, method: str) -> None:
    """Compile what planning in steps needs, and say what is planned."""
    compile_ahead([load_method(method)])
    if mission.has_surprises:
        say("some values are uncertain: planned with expected values")


def _show(made: PlannedMission, row: Mapping[str, Any]) -> None:
    """Print a plan, given as `--json` prints it: every output rounds the same way."""
    cost = f", at a cost of {row['cost']:g}" if "cost" in row else ""
    over = f"{row['mission']}: over at {row['makespan']:g}{cost}{_known(row)}"
    out.print(over, markup=False)
    for task, by in row["late"].items():
        out.print(f"late: {task} by {by:g}", markup=False)
    if row.get("missed"):
        out.print(f"left out: {', '.join(row['missed'])}", markup=False)
    ends_home = made.mission.ends is not None
    table = Table("robot", "tasks: start to end", *(["back"] if ends_home else []), box=None)
    routes = row["routes"]
    for route in routes[:LONGEST_TABLE]:
        stops = (f"{stop['task']} {stop['start']:g}-{stop['end']:g}" for stop in route["stops"])
        words = (route["robot"], ", ".join(stops) or "-")
        table.add_row(*map(Text, words), *([f"{route['back']:g}"] if ends_home else []))
    out.print(table)
    if len(routes) > LONGEST_TABLE:
        say(f"and {len(routes) - LONGEST_TABLE} robots more; --json tells all")
    for line in made.why_so_late:
        out.print(line, markup=False)


def _known(row: Mapping[str, Any]) -> str:
    """Say what no plan is better than, by its cost if that is known and else by its makespan."""
    if row["proven"]:
        return "; no plan is better"
    if row.get("least_cost", 0.0) > 0:
        gap = 100 * (row["cost"] / row["least_cost"] - 1)
        return f"; no plan can cost less than {row['least_cost']:g} (+{gap:.1f}%)"
    if row["bound"] <= 0:
        return ""
    gap = 100 * (row["makespan"] / row["bound"] - 1)
    above = "" if "cost" in row else f" (+{gap:.1f}%)"
    return f"; no plan can take less than {row['bound']:g}{above}"
