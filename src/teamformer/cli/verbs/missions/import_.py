"""`teamformer import`: other people's instances as mission files."""

from __future__ import annotations

from pathlib import Path

from teamformer.cli.terminal.console import prepare_file, prepare_folder, say
from teamformer.files.imports import import_missions
from teamformer.files.imports.site import Site, site_to_tree
from teamformer.files.mission_files import write_mission, write_tree


def import_(form: str, path: Path, out: Path) -> int:
    """Write what a file of others holds; return the exit status.

    One mission becomes the file `out`; several become files in the folder `out`, numbered from 0.
    A site becomes a file to which robots and tasks are to be added.
    """
    missions = import_missions(form, path)
    if len(missions) == 1:
        prepare_file(out)
    else:
        prepare_folder(out)
    for number, mission in enumerate(missions):
        file = out if len(missions) == 1 else out / f"{path.stem}-{number}.yaml"
        robots, tasks = len(mission.robots), len(mission.tasks)
        if isinstance(mission, Site):
            write_tree(site_to_tree(mission), file)
            holds = {"places": len(mission.world.places), "robots": robots, "tasks": tasks}
            told = ", ".join(f"{what}: {count}" for what, count in holds.items())
            lacking = " and ".join(what for what, count in holds.items() if not count)
            say(f"{file}: {mission.name}, {told}; add {lacking}")
        else:
            write_mission(mission, file)
            say(f"{file}: {mission.name} with {robots} robots and {tasks} tasks")
    return 0
