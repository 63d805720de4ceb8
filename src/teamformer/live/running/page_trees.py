"""What pages are told of a mission, as the trees of their messages."""

from __future__ import annotations

import math
from typing import Any

from teamformer.live.running.forecasts import Forecast
from teamformer.live.running.incidents import Happening, LostRobot
from teamformer.live.running.mission_with_past import RunningMission
from teamformer.record.files.writing import record_to_tree, step_to_tree
from teamformer.record.record import Record
from teamformer.record.telling.latest import LatestTold
from teamformer.record.telling.whole import path_of_record
from teamformer.record.told.trees import news_to_tree, path_to_tree

Tree = dict[str, Any]


def news_of_step(mission: RunningMission, latest: LatestTold) -> Tree:
    """Return what the latest step of a mission changed, and what is told of it, for pages."""
    record = mission.record()
    made, told = len(record.steps), news_to_tree(latest.of(record))
    news: Tree = {"at": made, "step": step_to_tree(record.steps[-1]), "told": told}
    for key in ("orders", "plans"):
        if plans := [plan for plan in getattr(record, key) if plan[0] == made]:
            news[key] = plans
    if not mission.is_running:
        news["end"] = vars(record.end)
        told["path"] = path_to_tree(path_of_record(record))
    return news


def what_happened(mission: RunningMission, happening: Happening | None) -> Tree:
    """Return what has happened to a mission, where undoing goes back to, and who is leaving.

    These are the robots that are lost since the latest step, and count for nothing any more. That
    is so already while the others plan for what is `happening`.
    """
    incidents = mission.incidents
    latest = [incident for step, incident in incidents if step == mission.steps]
    latest += [] if happening is None else [happening]
    leaving = dict.fromkeys(it.robot for it in latest if isinstance(it, LostRobot))
    return {
        "incidents": [[steps + it.steps_later, it.text()] for steps, it in incidents],
        "undo_to": incidents[-1][0] if incidents else None,
        "leaving": list(leaving),
    }


def record_so_far(record: Record, is_running: bool) -> Tree:
    """Return a record as a page reads it, also while its mission runs."""
    tree = record_to_tree(record)
    if is_running:
        tree["end"]["status"] = "running"
    return finite(tree)


def forecast_to_tree(found: Forecast) -> Tree:
    """Return how a mission ends; with a band, and in how many futures, where there are several."""
    other = found.otherwise
    if not found.ends:
        assert other is not None
        return {"status": other.status, "steps": other.steps}
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
