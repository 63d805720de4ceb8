"""A critical path in words: a few lines that say why a mission takes so long."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

from teamformer.mission.model import Mission
from teamformer.record.critical_path.stretches import CLOSED, DOINGS, LINKED, NEWS, UNKNOWN, Stretch
from teamformer.record.phases import (
    CARRYING,
    CHARGING,
    FORMING,
    IDLE,
    LOADING,
    LOST,
    OFF,
    PHASES,
    QUEUEING,
    SERVING,
    UNLOADING,
    WAITING,
    WALKING,
)
from teamformer.world.rules.constants import NOBODY

MOST_LINES = 8
"""Of a longer path the last ones are told; `--json` tells all."""

VERBS = {
    WALKING: "walks",
    WAITING: "waits",
    FORMING: "forms a team",
    SERVING: "serves",
    LOADING: "loads",
    CARRYING: "carries",
    UNLOADING: "unloads",
    IDLE: "is idle",
    LOST: "is lost",
    OFF: "waits for its shift",
    CHARGING: "charges",
    QUEUEING: "waits for a charger",
    UNKNOWN: "is not known yet",
    CLOSED: "may not begin yet",
    LINKED: "its start is linked",
    NEWS: "goes by older news",
}
SHARES = {
    **{phase: phase for phase in PHASES},
    OFF: "waiting for shifts",
    QUEUEING: "waiting for chargers",
    UNKNOWN: "before tasks are known",
    CLOSED: "before tasks may begin",
    LINKED: "between linked starts",
    NEWS: "before the news that decided",
}


def why_so_late(mission: Mission, path: Sequence[Stretch]) -> list[str]:
    """Return what is said of a critical path, line by line; nothing of an empty one.

    The first line says how much of the time each thing takes, the others go from task to task: from
    when to when, who does what for how long. Numbers are steps, in continuous time the mission's
    unit of time.
    """
    if not path:
        return []
    length = path[-1].end
    spent = {doing: sum(s.end - s.begin for s in path if s.doing == doing) for doing in DOINGS}
    shares = (f"{time:g} {SHARES[doing]}" for doing, time in spent.items() if time)
    unit = " steps" if mission.time == "steps" else ""
    lines = [_line(mission, list(part)) for _, part in groupby(path, key=lambda s: s.task)]
    told = lines[-MOST_LINES:] if len(lines) > MOST_LINES + 1 else lines
    left_out = len(lines) - len(told)
    before = [f"  {left_out} earlier lines are left out; --json tells all"] if left_out else []
    return [f"why so late: {length:g}{unit} are {', '.join(shares)}", *before, *told]


def _line(mission: Mission, part: Sequence[Stretch]) -> str:
    """Return what is done on the path for one task, by whom for how long."""
    task, said = part[0].task, []
    for robot, stretches in groupby(part, key=lambda s: s.robot):
        who = "" if robot == NOBODY else f"{mission.robots[robot].name} "
        deeds = ", ".join(_deed(mission, stretch) for stretch in stretches)
        said.append(f"{who}{deeds}")
    about = "" if task == NOBODY else f"{mission.tasks[task].name}: "
    return f"  {part[0].begin:g}-{part[-1].end:g}: {about}{', then '.join(said)}"


def _deed(mission: Mission, stretch: Stretch) -> str:
    """Return what is done in a stretch for how long; before that, which zone had no room."""
    deed = f"{VERBS[stretch.doing]} {stretch.end - stretch.begin:g}"
    if stretch.zone == NOBODY:
        return deed
    return f"has waited for room in {mission.zones[stretch.zone].name}, {deed}"
