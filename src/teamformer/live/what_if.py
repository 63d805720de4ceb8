"""What an incident would make of a mission if it happened now."""

from __future__ import annotations

from collections.abc import Callable

from teamformer.live.forecasts import forecast
from teamformer.live.incidents import Incident
from teamformer.live.mission_with_past import Mission
from teamformer.live.page_trees import Tree, forecast_to_tree


def what_if(now: Mission, incident: Incident, is_over: Callable[[], bool]) -> Tree:
    """Return how a mission would end with an incident, and without it, as pages are told.

    `is_over` says that nobody wants to know any more.
    """
    without = forecast(now.past(), is_over)
    found = forecast(now.past_with(incident), is_over)
    ends = forecast_to_tree(found) | {"without": forecast_to_tree(without)}
    return ends | {"text": incident.text()}
