"""A mission in continuous time and its record, worked out by hand.

ann . . . . . bob .        ann lifts, a cell a unit; bob welds, half a cell a unit
 0  1 2 3 4 5  6  7        the beam is at 2; the crate is at 3 and goes to 6
"""

from __future__ import annotations

from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.record.record import Ending, Record
from teamformer.world.continuous.events import Event, Passed, PlanMade, PlannedTask

BEAM_AND_CRATE = Mission(
    name="beam and crate",
    world=Grid(8, 1),
    capabilities=("lift", "weld"),
    robots=(
        Robot("ann", (0, 0), {"lift": 1}),
        Robot("bob", (6, 0), {"weld": 1}, speed=0.5),
    ),
    tasks=(
        Task("beam", (2, 0), {"lift": 1, "weld": 1}, duration=1.5),
        Task("crate", (3, 0), {"lift": 1}, duration=0.25, to=(6, 0), unload=0.5),
    ),
    time="continuous",
    forming=0.5,
)

ANN, BOB = 0, 1
BEAM, CRATE = 0, 1


def way(begin: float, pace: float, *cells: int) -> tuple[Passed, ...]:
    """Return a way along cells of the one row, each so long after the one before."""
    return tuple(Passed(begin + pace * number, (cell, 0)) for number, cell in enumerate(cells))


EVENTS = (
    Event(
        0,
        "plan",
        plan=PlanMade(
            ("start",), (PlannedTask(BEAM, (ANN, BOB), 10), PlannedTask(CRATE, (ANN,), 14.75))
        ),
    ),
    Event(0, "walk", (ANN,), BEAM, until=2, way=way(0, 1, 0, 1, 2), cause=0),
    Event(0, "walk", (BOB,), BEAM, until=8, way=way(0, 2, 6, 5, 4, 3, 2), cause=0),
    Event(2, "arrive", (ANN,), BEAM, (2, 0), cause=1),
    Event(8, "arrive", (BOB,), BEAM, (2, 0), cause=2),
    Event(8, "form", (ANN, BOB), BEAM, (2, 0), until=8.5, cause=4),
    Event(8.5, "formed", (ANN, BOB), BEAM, (2, 0), cause=5),
    Event(8.5, "serve", (ANN, BOB), BEAM, (2, 0), until=10, cause=6),
    Event(10, "done", (ANN, BOB), BEAM, (2, 0), cause=7),
    Event(10, "walk", (ANN,), CRATE, until=11, way=way(10, 1, 2, 3), cause=8),
    Event(11, "arrive", (ANN,), CRATE, (3, 0), cause=9),
    Event(11, "serve", (ANN,), CRATE, (3, 0), until=14.75, cause=10),
    Event(
        11.25, "lift", (ANN,), CRATE, (3, 0), until=14.25, way=way(11.25, 1, 3, 4, 5, 6), cause=11
    ),
    Event(14.25, "unload", (ANN,), CRATE, (6, 0), until=14.75, cause=12),
    Event(14.75, "done", (ANN,), CRATE, (6, 0), cause=13),
    Event(14.75, "over", cause=14, status="completed"),
)

RECORD = Record(
    BEAM_AND_CRATE,
    "plan",
    0,
    end=Ending("completed", 14.75, tasks_done=2),
    events=EVENTS,
    lower_bound=14.5,
    heeds=("robot lost",),
)
