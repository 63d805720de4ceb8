"""`teamformer import`: other people's instances as mission files."""

from __future__ import annotations

from pathlib import Path

from teamformer.commands.console import prepare_file, prepare_folder, say
from teamformer.scenarios.files import write_scenario
from teamformer.scenarios.imports import import_missions


def import_(form: str, path: Path, out: Path) -> int:
    """Write what a file of others holds; return the exit status.

    One mission becomes the file `out`; several become files in the folder `out`, numbered from 0.
    """
    missions = import_missions(form, path)
    if len(missions) == 1:
        prepare_file(out)
    else:
        prepare_folder(out)
    for number, mission in enumerate(missions):
        file = out if len(missions) == 1 else out / f"{path.stem}-{number}.yaml"
        write_scenario(mission, file)
        robots, tasks = len(mission.robots), len(mission.tasks)
        say(f"{file}: {mission.name} with {robots} robots and {tasks} tasks")
    return 0
