"""What pages are told of a mission, as the trees of their messages."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from teamformer.live.running.forecasts import Forecast
from teamformer.live.running.incidents import Happening, LostRobot
from teamformer.live.running.live_mission import LiveMission
from teamformer.mission.model import Mission
from teamformer.record.files.writing import record_to_tree, step_to_tree
from teamformer.record.record import Record
from teamformer.record.telling.latest import LatestTold
from teamformer.record.telling.whole import path_of_record, told_of
from teamformer.record.told.trees import added_to_tree, news_to_tree, path_to_tree

Tree = dict[str, Any]


def news_of_move(mission: LiveMission, latest: LatestTold) -> tuple[str, Tree]:
    """Return the kind of message that tells pages of the latest move, and what it says.

    In steps that is what a step changed, in continuous time how late it is and what events there
    were; and what is told of it.
    """
    record = mission.record()
    if record.is_continuous:
        return "moment", _news_of_moment(mission, record)
    told = news_to_tree(latest.of(record))
    made = len(record.steps)
    news: Tree = {"at": made, "step": step_to_tree(record.steps[-1]), "told": told}
    for key in ("orders", "plans"):
        if plans := [plan for plan in getattr(record, key) if plan[0] == made]:
            news[key] = plans
    if not mission.is_running:
        news["end"] = vars(record.end)
        told["path"] = path_to_tree(path_of_record(record))
    return "step", news


def _news_of_moment(mission: LiveMission, record: Record) -> Tree:
    """Return how late it is, the latest events, and what these add to what is told."""
    news = mission.latest
    before = len(record.events) - len(news["events"])
    if not mission.is_running:
        news["end"] = vars(record.end)
    elif record.events[-1].kind == "over":  # which it is not: the record is of a mission broken off
        before -= 1
    if news["events"]:
        known = replace(record, events=record.events[:before])
        news["told"] = added_to_tree(told_of(known), told_of(record))
    return news | {"from": before}


def what_happened(mission: LiveMission, happening: Happening | None) -> Tree:
    """Return what has happened to a mission, where undoing goes back to, and who is leaving.

    These are the robots that are lost since the latest step, and count for nothing any more. That
    is so already while the others plan for what is `happening`. In continuous time nobody is: what
    happens is felt at once.
    """
    incidents, is_in_steps = mission.incidents, mission.source.time == "steps"
    latest = [incident for at, incident in incidents if at == mission.now]
    latest += [] if happening is None else [happening]
    lost = (it.robot for it in latest if isinstance(it, LostRobot) and is_in_steps)
    return {
        "incidents": [
            [felt_at(mission.source, at, it), it.text(mission.source)] for at, it in incidents
        ],
        "undo_to": incidents[-1][0] if incidents else None,
        "leaving": list(dict.fromkeys(lost)),
    }


def felt_at(mission: Mission, at: float, happening: Happening) -> float:
    """Return when something is felt that happens at a time: in steps perhaps in the next one."""
    return at + happening.steps_later if mission.time == "steps" else at


def moment_text(mission: Mission, at: float) -> str:
    """Return a time of a mission as words."""
    return f"step {at:g}" if mission.time == "steps" else f"time {at:g}"


def happening_text(mission: LiveMission, at: float, happening: Happening) -> str:
    """Return what happens at a time, with when it is felt, as words."""
    when = moment_text(mission.source, felt_at(mission.source, at, happening))
    return f"{when}: {happening.text(mission.source)}"


def record_so_far(record: Record, is_running: bool) -> Tree:
    """Return a record as a page reads it, also while its mission runs."""
    tree = record_to_tree(record)
    if is_running:
        tree["end"]["status"] = "running"
        if record.is_continuous:
            tree["events"].pop()  # that it is over
    return finite(tree)


def forecast_to_tree(found: Forecast) -> Tree:
    """Return how a mission ends; with a band, and in how many futures, where there are several."""
    other = found.otherwise
    if not found.ends:
        assert other is not None
        return {"status": other.status, "steps": other.end}
    tree: Tree = {"status": "completed", "steps": found.ends[0]}
    if found.futures > 1:
        several = {"band": found.band, "done": len(found.ends), "futures": found.futures}
        tree |= several | {"steps": round(found.mean, 1)}
    return tree


def done_at_to_tree(found: Forecast) -> list[float | None]:
    """Return by task the step in which it is to be done; None if it is not."""
    return [None if step is None else round(step, 1) for step in found.done_at]


def finite(record: Tree) -> Tree:
    """Replace infinite radii, which JSON cannot say, by null; the page knows what it means."""
    mission = record["mission"].items()
    return record | {"mission": {k: None if value == math.inf else value for k, value in mission}}
