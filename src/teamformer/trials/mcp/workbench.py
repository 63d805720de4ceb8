"""The tools: plain functions of a folder, each with a small result; what is long is in files."""

from __future__ import annotations

import difflib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from teamformer.base.errors import MissionError, TeamformerError
from teamformer.base.whole_files import write_whole
from teamformer.files.mission_files import read_content, read_mission, write_mission
from teamformer.files.yaml import writer
from teamformer.methods.listings import method_names
from teamformer.mission.checks.rules import rules_not_planned, rules_not_run
from teamformer.mission.model import Mission
from teamformer.record.critical_path.words import why_so_late
from teamformer.record.export.reasons import story_lines
from teamformer.record.files.reading import read_record
from teamformer.record.files.writing import record_to_tree
from teamformer.record.record import Record
from teamformer.record.referee import judge
from teamformer.record.telling.whole import path_of_record
from teamformer.trials.advice.advise import advise_on
from teamformer.trials.advice.changes import changes_of
from teamformer.trials.api import trials
from teamformer.trials.mcp.telling import (
    Told,
    advice_in_short,
    cut,
    mistakes,
    outcome,
    routes,
    summary,
)
from teamformer.trials.mcp.work_folder import WorkFolder
from teamformer.trials.outputs import WRITTEN, write_record
from teamformer.viewer.advice_page import write_advice
from teamformer.viewer.html import write_comparison, write_page

MISSIONS = (".yaml", ".yml", ".json")
PAGES = (".html",)
LONGEST = 600.0
"""Seconds that one call may search for."""

ROW = ("method", "seed", "status", "makespan", "cost", "percent_over_best", "error", "hint")


@dataclass(frozen=True)
class Workbench:
    """What a program may do with missions in a folder; `workers` processes give advice."""

    folder: WorkFolder
    workers: int = 1

    def list_files(self) -> Told:
        """List the missions, records and pages in the folder."""
        names = list(self.folder.files((*MISSIONS, *PAGES)))
        return {"files": cut(names, "name the one you mean")}

    def write_mission(
        self, file: str, mission: str | dict[str, Any], replace: bool = False
    ) -> Told:
        """Draw up a mission: check it, and write it to FILE (.yaml or .json) if it is right.

        MISSION is the text of the file as YAML, or its content as an object; the resource
        teamformer://mission-file says what may stand in it. Nothing is written while there are
        mistakes: each is told with its place and what to do about it. REPLACE overwrites a file.
        """
        path = self.folder.new_file(file, MISSIONS, replace)
        try:
            made = self.folder.read(file, lambda path: read_content(mission, path))
        except MissionError as error:
            return {"written": False, "mistakes": mistakes(error.problems)}
        write_whole(path, _text(mission, path))
        return {"written": True, "file": file} | self._state(made)

    def check_mission(self, file: str) -> Told:
        """Say everything that is wrong with a mission, each mistake with its place and a remedy."""
        try:
            mission = self._mission(file)
        except MissionError as error:
            return {"right": False, "mistakes": mistakes(error.problems)}
        return {"right": True} | self._state(mission)

    def plan_mission(
        self, file: str, method: str = "central", seconds: float = 10.0, out: str = "plan"
    ) -> Told:
        """Plan a mission: who goes where, when, and why it takes so long if all goes as foreseen.

        METHOD is central; in continuous time also plan or reactive. SECONDS is how long central
        may search. The folder OUT gets record.json and its page record.html, as of a run.
        """
        mission, limit = self._mission(file), _seconds(seconds)
        made = trials.plan(mission, limit, method)
        if made is None:
            raise TeamformerError("no plan was found in this time", "try again with more seconds")
        into, row = self.folder.new_folder(out, *WRITTEN), made.row
        kept, page = write_record(made.record, into)
        return {
            **{key: row[key] for key in ("makespan", "bound", "proven", "cost") if key in row},
            "late": cut((f"{task} by {by:g}" for task, by in row["late"].items()), "see the page"),
            **({"left_out": cut(row["missed"], "see the page")} if "missed" in row else {}),
            "routes": routes(row),
            "why_so_late": made.why_so_late,
            "record": self.folder.name(kept),
            "page": self.folder.name(page),
        }

    def run_mission(
        self,
        file: str,
        method: str = "",
        seed: int = 0,
        seconds: float = 10.0,
        out: str = "out",
    ) -> Told:
        """Run a mission once in the simulator, have the referee judge it, and say what came of it.

        METHOD is a name of teamformer://methods, by default the one that suits the mission. SEED
        decides what uncertain things turn out to be. SECONDS is how long central may search. The
        folder OUT gets record.json and its page record.html.
        """
        chosen = _method(method) if method else None
        record = trials.run(self._mission(file), chosen, seed, _seconds(seconds)).record
        into = self.folder.new_folder(out, *WRITTEN)
        kept, page = write_record(record, into)
        verdict = judge(record)
        return outcome(record) | {
            "legal": verdict.is_legal,
            "why_so_late": why_so_late(record.true_mission, path_of_record(record)),
            "record": self.folder.name(kept),
            "page": self.folder.name(page),
        }

    def compare_methods(
        self,
        file: str,
        methods: Sequence[str] = (),
        seeds: int = 1,
        seconds: float = 10.0,
    ) -> Told:
        """Run a mission by several methods, with each seed from 0 to SEEDS - 1, side by side.

        METHODS are names of teamformer://methods, by default those that suit the mission's time.
        SECONDS is how long central may search.
        """
        names = [_method(name) for name in methods] or None
        rows = trials.compare(self._mission(file), names, seeds, _seconds(seconds))
        short = [{key: row[key] for key in ROW if row.get(key) is not None} for row in rows]
        bounds = (row.get("lower_bound") for row in rows)
        bound = max((steps for steps in bounds if steps is not None), default=None)
        return {"trials": cut(short, "ask for fewer seeds"), "lower_bound": bound}

    def explain(self, record: str, robot: str = "") -> Told:
        """Say why a recorded mission took so long; with a ROBOT, what that did, when and why.

        RECORD is the record.json that run_mission wrote.
        """
        read = self._record(record)
        told: Told = {"why_so_late": why_so_late(read.true_mission, path_of_record(read))}
        names = [one.name for one in read.mission.robots]
        if not robot:
            return told | {"robots": cut(names, "the page has all")}
        number = _number(robot, names, "robot")
        story = (
            f"{steps} {what}: {why}" if why else f"{steps} {what}"
            for steps, what, why in story_lines(read, number)
        )
        return told | {"robot": robot, "story": cut(story, "the page has all")}

    def check_record(self, record: str) -> Told:
        """Have the referee judge a record.json by the rules alone."""
        verdict = judge(self._record(record))
        findings = (str(finding) for finding in verdict.findings)
        return {"legal": verdict.is_legal, "findings": cut(findings, "mend these first")}

    def advise(self, file: str, seconds: float = 30.0, page: str = "advice.html") -> Told:
        """Say what would help a mission most and who could be spared, by planning it again.

        One thing is changed at a time: a robot more or less, faster, abler; a task left out. It
        takes SECONDS. PAGE is the picture of it to write. change_mission makes one of the changes.
        """
        mission = self._mission(file)
        if mission.time != "continuous":
            trials.refuse_unplayed(mission, "advise")
        target = self.folder.new_file(page, PAGES, replaces=True)
        found = advise_on(mission, _seconds(seconds), self.workers)
        write_advice(found.row, target)
        return advice_in_short(found) | {"page": page}

    def change_mission(self, file: str, change: str, new_file: str, replace: bool = False) -> Told:
        """Write a mission with one of the changes that advise names, such as 'without task t3'."""
        target = self.folder.new_file(new_file, MISSIONS, replace)
        known = {it.what: it for it in changes_of(self._mission(file))}
        chosen = list(known.values())[_number(change, list(known), "change")].mission
        if chosen is None:
            hint = "choose another; a task's needs must be brought by the robots"
            raise TeamformerError(f"{change}: the mission could not be done then", hint)
        write_mission(chosen, target)
        return {"file": new_file} | self._state(chosen)

    def show(self, records: Sequence[str], page: str = "") -> Told:
        """Write the page of a record.json, or of several side by side, and return its path.

        PAGE is the .html to write, by default beside the first record.
        """
        if not records:
            raise TeamformerError("no record is named", "name a record.json of run_mission")
        trees = [record_to_tree(self._record(record)) for record in records]
        name = page or Path(records[0]).with_suffix(".html").as_posix()
        target = self.folder.new_file(name, PAGES, replaces=True)
        if len(trees) == 1:
            write_page(trees[0], target)
        else:
            write_comparison(trees, target)
        return {"page": name}

    def _mission(self, file: str) -> Mission:
        return self.folder.read(file, read_mission)

    def _record(self, file: str) -> Record:
        return self.folder.read(file, read_record)

    def _state(self, mission: Mission) -> Told:
        """Return what a mission is, and what it is not fit for."""
        not_run = mistakes(list(rules_not_run(mission)))
        not_planned = mistakes(list(rules_not_planned(mission)))
        return (
            summary(mission)
            | ({"cannot_be_run": not_run} if not_run else {})
            | ({"cannot_be_planned": not_planned} if not_planned else {})
        )


TOOLS = (
    *("list_files", "write_mission", "check_mission", "plan_mission", "run_mission"),
    *("compare_methods", "explain", "check_record", "advise", "change_mission", "show"),
)
"""The tools, by the names of their functions."""

READING = ("list_files", "check_mission", "compare_methods", "explain", "check_record")
"""Those that write nothing, which a client need not ask its user about."""


def _text(mission: str | Mapping[str, Any], path: Path) -> str:
    """Return what is written of a mission that is right: its text as it is."""
    if isinstance(mission, str):
        return mission if mission.endswith("\n") else f"{mission}\n"
    if path.suffix.lower() == ".json":
        return json.dumps(mission, indent=1, ensure_ascii=False) + "\n"
    return writer.to_text(mission)


def _method(name: str) -> str:
    """Return the name of a method that is known; a user's own code is no file of the folder."""
    return list(method_names())[_number(name, list(method_names()), "method")]


def _number(name: str, names: Sequence[str], what: str) -> int:
    """Return the place of a name; TeamformerError with the nearest if it is not there."""
    if name in names:
        return names.index(name)
    near = difflib.get_close_matches(name, names, 3, 0.4) or names[:5]
    hint = f"did you mean {' or '.join(repr(one) for one in near)}?"
    raise TeamformerError(f"there is no {what} '{name}'", hint)


def _seconds(seconds: float) -> float:
    """Return for how long something may be searched for."""
    if 0 <= seconds <= LONGEST:
        return seconds
    raise TeamformerError(f"seconds is {seconds:g}", f"write a number from 0 to {LONGEST:g}")
