"""Results of tools in few words: what is long is cut, and said to be in a file."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from teamformer.base.errors import MissionError, Problem, TeamformerError
from teamformer.mission.model import Mission
from teamformer.mission.parts.capabilities import describe
from teamformer.record.record import Record
from teamformer.record.task_times import cost_of_record, lateness, missed_tasks
from teamformer.record.teams import completions
from teamformer.trials.advice.changes import LEFT_OUT
from teamformer.trials.advice.suggestions import Advice, Suggestion

MOST_LINES = 40
"""Of a list in a result; a model reads all of it at each turn of a conversation."""

TOOL_OF = {
    "run": "run_mission",
    "plan": "plan_mission",
    "compare": "compare_methods",
    "check": "check_record",
    "view": "show",
}
"""The tool that does what a verb of the command line does."""

Told = dict[str, Any]


def cut(lines: Iterable[Any], more: str) -> list[Any]:
    """Return the first lines of many, and how many are left out; `more` says where these are."""
    told = list(lines)
    if len(told) <= MOST_LINES:
        return told
    return [*told[:MOST_LINES], f"and {len(told) - MOST_LINES} more; {more}"]


def of_tools(text: str) -> str:
    """Return a message that names tools where it named verbs, such as `teamformer run FILE`."""
    named = r"`(?:teamformer )?([a-z]+)(?: [^`]*)?`"
    return re.sub(named, lambda found: TOOL_OF.get(found[1], found[0]), text)


def mistakes(problems: Sequence[Problem]) -> list[Any]:
    """Return what is wrong with a mission: where in the document, in which line, and the remedy."""
    rows = [
        {"where": it.path or "mission"}
        | ({} if it.line is None else {"line": it.line})
        | {"message": of_tools(it.message)}
        for it in problems
    ]
    return cut(rows, "mend these first")


def in_words(error: TeamformerError) -> str:
    """Return an error as a tool answers it: each mistake of a mission with its place, a remedy."""
    if isinstance(error, MissionError):
        places = (f"{it.path or 'mission'}: {it.message}" for it in error.problems)
        numbered = str(error).splitlines() if error.problems[0].line is not None else places
        return of_tools("\n".join(cut(numbered, "mend these first")))
    return of_tools(f"{error}\n{error.hint}" if error.hint else str(error))


def summary(mission: Mission) -> Told:
    """Return what a mission is, in numbers."""
    world = mission.world
    return {
        "name": mission.name,
        "world": type(world).__name__.lower(),
        "time": mission.time,
        "robots": len(mission.robots),
        "tasks": len(mission.tasks),
        "capabilities": cut(mission.capabilities, "the file has all"),
        "needs": cut((f"{it.name}: {describe(it.needs)}" for it in mission.tasks), "see the file"),
    }


def outcome(record: Record) -> Told:
    """Return what came of a trial: when it ended, who did what, what was late."""
    end, mission = record.end, record.true_mission
    late = (f"{task} by {steps:g}" for task, steps in lateness(record).items())
    missed = (f"{mission.tasks[k].name}: {why}" for k, (_, why) in missed_tasks(record).items())
    done = (
        f"step {step}: {mission.tasks[task].name} by "
        f"{', '.join(mission.robots[robot].name for robot in robots)}"
        for step, task, robots in completions(record)
    )
    return {
        "status": end.status,
        "makespan": end.makespan,
        "lower_bound": record.lower_bound,
        **({} if mission.cost is None else {"cost": cost_of_record(record)}),
        "method": record.method,
        "seed": record.seed,
        "tasks_done": f"{end.tasks_done} of {len(mission.tasks)}",
        "never_possible": list(end.blocked_tasks),
        "late": cut(late, "the page has all"),
        **({} if mission.until is None else {"missed": cut(missed, "the page has all")}),
        "done": cut(done, "the page has all"),
    }


def routes(row: Mapping[str, Any]) -> list[Any]:
    """Return who goes where and when in a plan, a line for each robot."""
    lines = (
        f"{route['robot']}: "
        + (", ".join(f"{it['task']} {it['start']:g}-{it['end']:g}" for it in route["stops"]) or "-")
        for route in row["routes"]
    )
    return cut(lines, "the page has all")


def advice_in_short(advice: Advice) -> Told:
    """Return what would help, what tasks cost, and who could be spared; largest gains first."""
    rows = [(it.kind, _suggested(it)) for it in advice.helpful]
    robots = [row for kind, row in rows if kind != LEFT_OUT]
    tasks = [row for kind, row in rows if kind == LEFT_OUT]
    return {
        "measure": "makespan" if advice.mission.cost is None else "cost",
        "now": round(advice.makespan, 2),
        "method": advice.method,
        "would_help": cut(robots, "the page has all"),
        "tasks_left_out": cut(tasks, "the page has all"),
        "could_be_spared": cut((it.change for it in advice.spare), "the page has all"),
        "not_measured": len(advice.unmeasured),
    }


def _suggested(it: Suggestion) -> Told:
    return {"change": it.change, "gain": round(it.gain, 2), "then": round(it.makespan, 2)}
