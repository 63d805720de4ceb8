"""Other people's instances as missions."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from teamformer.base.entry_points import find_brought, names_of
from teamformer.base.errors import MissionError, TeamformerError
from teamformer.files.imports.site import Site
from teamformer.mission.model import Mission


def import_missions(form: str, path: Path) -> Sequence[Mission | Site]:
    """Return the missions in a file or folder of others, by the importer of a format's name.

    What lacks robots or tasks is a `Site`. Raises `TeamformerError` with file and place.
    """
    importer = find_brought("importer", form)
    if importer is None:
        hint = f"use {', '.join(names_of('importer'))}"
        raise TeamformerError(f"format '{form}' is unknown", hint)
    try:
        missions = importer.call(path)
    except MissionError as error:
        lines = [f"{path}: {problem.message}" for problem in error.problems]
        raise TeamformerError("\n".join(lines), "mend the file, or take its original") from None
    if not (
        isinstance(missions, Sequence) and all(isinstance(it, Mission | Site) for it in missions)
    ):
        raise TeamformerError(f"{importer} returned something else than a list of Mission")
    return missions
