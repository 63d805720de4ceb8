"""What a live mission is to those who show, keep and steer it, be it in steps or continuous."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

from teamformer.live.running.forecasts import Past
from teamformer.live.running.incidents import Happening, Incident
from teamformer.mission.coordination import Plan
from teamformer.mission.model import Mission
from teamformer.record.record import Record

Tree = dict[str, Any]


class LiveMission(Protocol):
    """A mission that runs by one method, to which things happen.

    Times are steps made or, in continuous time, in the mission's unit.
    """

    source: Mission
    """The mission with all that has happened to it."""
    drawn: Mission
    """The mission before anything happened."""
    seed: int
    method_name: str
    incidents: list[tuple[float, Happening]]
    """What has happened so far, with the times."""

    @property
    def now(self) -> float:
        """Return how many steps have been made, or the time."""

    @property
    def status(self) -> str:
        """Return `running`, or how the mission has ended."""

    @property
    def is_running(self) -> bool:
        """Say whether the mission goes on."""

    @property
    def is_planned(self) -> bool:
        """Say whether robots go by plans of a coordinator, which searches for them."""

    @property
    def has_shown_more(self) -> bool:
        """Say whether what has just happened tells something of an uncertain mission."""

    @property
    def truth(self) -> Mission:
        """Return what the mission really is, with all that has happened to it."""

    @property
    def latest_plans(self) -> list[tuple[float, Plan]]:
        """Return the plans of the latest move, or of an incident since, and when they were made."""

    @property
    def latest(self) -> Tree:
        """Return what the latest step, or the time that has passed last, has brought."""

    def ends(self) -> Mapping[int, float]:
        """Return when each task was done that was, by number."""

    def usual_speed(self, speed: float) -> float:
        """Return the speed to begin with, in steps or units of time a second.

        In steps that is what it is given. Units of continuous time differ from mission to mission.
        """

    def beat(self, speed: float) -> tuple[float, float]:
        """Return how many seconds there are between two moves, and how far each goes.

        `speed` is in steps, or units of time, a second.
        """

    def move(self, units: float | None = None) -> None:
        """Make a step, or let so much time pass; by default until something happens."""

    def again(self, latest: Tree) -> Tree:
        """Move as far as is told of an earlier move; return what this one has brought."""

    def happen(self, incident: Happening) -> None:
        """Let something happen now; TeamformerError says why it cannot, and nothing changes."""

    def undo(self) -> Happening:
        """Go back to just before the latest incident, and return it."""

    def anew(self) -> LiveMission:
        """Return the same mission at its start, to which nothing has happened."""

    def mission_with(self, happening: Happening) -> Mission:
        """Return the mission if something happened now; TeamformerError says why it cannot."""

    def work_out_bound(self) -> float | None:
        """Return what no plan can beat, as `run` tells it; the record has it then."""

    def record(self) -> Record:
        """Return the record so far; that of a mission that still runs is of an interrupted one."""

    def as_it_stands(self) -> LiveMission:
        """Return the mission as it is now, to be asked about while it goes on itself."""

    def past(self) -> Past:
        """Return the present and how it came about, to play it ahead."""

    def past_planned_anew(self, order: int) -> Past:
        """Return the present with a plan that is made now, in another order of robots and tasks."""

    def past_with(self, incident: Incident, order: int = 0) -> Past:
        """Return the present as it would be if an incident happened now."""
