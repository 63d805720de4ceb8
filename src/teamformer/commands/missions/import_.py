"""`teamformer import`: other people's instances as scenario files."""

from __future__ import annotations

from pathlib import Path

from teamformer.commands.console import prepare_file, print_json, say
from teamformer.errors import TeamformerError
from teamformer.scenarios.files import write_scenario
from teamformer.scenarios.imports import import_missions


def import_(form: str, path: Path, out: Path, number: int | None, as_json: bool) -> int:
    """Write a mission of a file of others as a scenario; return the exit status."""
    missions = import_missions(form, path)
    if number is None and len(missions) > 1:
        hint = f"name one with --number, 0 to {len(missions) - 1}"
        raise TeamformerError(f"{path}: this holds {len(missions)} missions", hint)
    if not 0 <= (number or 0) < len(missions):
        raise TeamformerError(
            f"{path}: there is no mission {number}", f"use 0 to {len(missions) - 1}"
        )
    mission = missions[number or 0]
    prepare_file(out)
    write_scenario(mission, out)
    if as_json:
        names = {"scenario": mission.name, "file": str(out)}
        print_json(names | {"robots": len(mission.robots), "tasks": len(mission.tasks)})
    else:
        robots, tasks = len(mission.robots), len(mission.tasks)
        say(f"{out}: {mission.name} with {robots} robots and {tasks} tasks")
    return 0
