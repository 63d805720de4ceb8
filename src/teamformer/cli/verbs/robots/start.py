"""`teamformer fleet start`: every robot a process of its own on this machine."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from teamformer.cli.terminal.console import out, print_json, say
from teamformer.cli.terminal.interruption import Interruption
from teamformer.cli.verbs.robots.mesh import check_method, read_fleet_mission

if TYPE_CHECKING:
    from teamformer.fleet.fleet_mission import FleetMission
    from teamformer.fleet.process.fleet import FleetResult


@dataclass(frozen=True)
class StartOptions:
    """What the command line says of a fleet; `time_limit` is in seconds."""

    time_limit: float
    method: str = "plan"
    keys: Path | None = None


def start(path: Path, options: StartOptions, as_json: bool) -> int:
    """Run a fleet until the mission ends; return 0 if all is done."""
    mission = read_fleet_mission(path, "zenoh")
    from teamformer.fleet.process.fleet import LocalFleet

    check_method(options.method, mission)
    fleet = LocalFleet(mission, say, options.method, options.keys)
    with Interruption():
        result = fleet.run(options.time_limit)
    row = _row(mission, result)
    if as_json:
        print_json(row)
    else:
        _show(mission, row)
    return 0 if result.completed else 1


def _row(mission: FleetMission, result: FleetResult) -> dict[str, Any]:
    """Return what `--json` prints."""
    robots = mission.source.robots
    makespan = max((done.at for done in result.done), default=None)
    done = [
        {
            "task": result.names[each.key],
            "at": round(each.at, 3),
            "by": [robots[robot].name for robot in each.robots],
        }
        for each in result.done
    ]
    return {
        "completed": result.completed,
        "makespan": None if makespan is None or not result.completed else round(makespan, 3),
        "tasks_done": len(result.done),
        "tasks": result.tasks,
        "robots_alive": result.robots_alive,
        "done": done,
    }


def _show(mission: FleetMission, row: dict[str, Any]) -> None:
    end = f"all done after {row['makespan']:.2f} s" if row["completed"] else "not all done"
    alive = f"{row['robots_alive']} of {mission.robots} robots left"
    out.print(
        f"{mission.source.name}: {end}; {row['tasks_done']} of {row['tasks']} tasks, {alive}",
        style="green" if row["completed"] else "red",
        markup=False,
    )
