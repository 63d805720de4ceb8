"""What an operator should know of a mission that runs, looked for as it goes on."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence

from teamformer.live.running.alerts import END, Alert, Alerts, robot_key
from teamformer.live.running.live_mission import LiveMission

OnAlerts = Callable[[Sequence[Alert], Sequence[Alert]], None]
"""Is given the alerts that are new, and those that hold no more."""


class Alarm:
    """Looks for what is wrong with a mission whenever it has changed, and tells what is new."""

    def __init__(self, names: Sequence[str], on_alerts: OnAlerts) -> None:
        self._alerts, self._on_alerts = Alerts(names), on_alerts

    def look(self, mission: LiveMission) -> None:
        """Find what is wrong now, and tell what was not so before, and what is so no longer."""
        new, past = self._alerts.find(list(troubles_of(mission)), time.monotonic())
        if new or past:
            self._on_alerts(new, past)


def troubles_of(mission: LiveMission) -> Iterator[Alert]:
    """Yield what is wrong: robots that are lost, tasks that are late, an end that cannot come."""
    status, now, truth, done = mission.status, mission.now, mission.truth, mission.ends()
    if status == "completed":
        return
    step = "step " if truth.time == "steps" else ""
    for number, robot in enumerate(truth.robots):
        for away in robot.absences:
            if away.lost <= now and (away.back is None or away.back > now):
                why = f"since {step}{away.lost:g}"
                do = "others do its tasks; say that it is back once it is"
                yield Alert(robot_key(number), f"{robot.name} is lost", why, do)
    undone = [
        (number, task)
        for number, task in enumerate(truth.tasks)
        if number not in done and (task.cancelled is None or task.cancelled > now)
    ]
    for number, task in undone:
        if task.between is not None and task.appears <= now and now > task.between[1]:
            why = f"it was due at {step}{task.between[1]:g} and is not done"
            do = "raise its weight, or call off what comes before it"
            yield Alert(f"task {number}", f"{task.name} is late", why, do)
    if status != "running":
        names = ", ".join(task.name for _, task in undone)
        why = f"it ended at {step}{now:g}: {status}"
        yield Alert(END, f"not done: {names}", why, "bring lost robots back, or undo")
