"""What an incident would make of a mission if it happened now, and how much of that is luck.

Plans are searched for, and no search finds the best one for sure. What follows an incident is
planned anew, so that a mission may end sooner though a robot is lost. Searches in other orders of
robots and tasks, with the incident and without, say how much ends differ by such luck.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

from teamformer.live.running.forecasts import Forecast, IsOver, forecast
from teamformer.live.running.incidents import Incident
from teamformer.live.running.live_mission import LiveMission
from teamformer.live.running.page_trees import Tree, forecast_to_tree
from teamformer.trials.noise import Noise

ORDERS = 6
"""So many other searches, with the incident and without, if there is time."""

SECONDS = 20.0
"""For all of these together."""


@dataclass(frozen=True)
class WhatIf:
    """How a mission would end with an incident, and without it."""

    now: LiveMission
    incident: Incident
    found: Forecast
    without: Forecast

    def to_tree(self) -> Tree:
        """Return it as pages are told; `is_planned` says that they are told of luck later."""
        ends = forecast_to_tree(self.found) | {"without": forecast_to_tree(self.without)}
        about = {"text": self.incident.text(self.now.source), "at": self.now.now}
        return ends | about | {"is_planned": self.now.is_planned}

    @property
    def is_luck(self) -> bool:
        """Say whether the incident moves the end as only luck of the search can."""
        if not (self.found.ends and self.without.ends):
            return False
        more = self.found.mean - self.without.mean
        incident = self.incident
        return (more < 0 and incident.can_only_delay) or (more > 0 and incident.can_only_hasten)


def what_if(now: LiveMission, incident: Incident, is_over: IsOver) -> WhatIf:
    """Return how a mission would end with an incident, and without it."""
    without = forecast(now.past(), is_over)
    return WhatIf(now, incident, forecast(now.past_with(incident), is_over), without)


def luck_of(weighed: WhatIf, is_over: IsOver) -> float | None:
    """Return by how many steps ends differ by luck of the search; None if some end never comes.

    It is what the difference of two searches, one with the incident and one without, hardly ever
    exceeds if the incident changes nothing, as `advise` counts it.
    """
    now, until = weighed.now, time.monotonic() + SECONDS
    without, found = [weighed.without], [weighed.found]
    for order in range(1, ORDERS + 1):
        without.append(forecast(now.past_planned_anew(order), is_over))
        found.append(forecast(now.past_with(weighed.incident, order), is_over))
        if is_over() or time.monotonic() > until:
            break
    if any(not it.ends for it in (*without, *found)):
        return None
    means = [[it.mean for it in those] for those in (without, found)]
    return Noise(means).of_gain(1, 1, 1)
