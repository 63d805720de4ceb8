"""Compiling on a first run: said beforehand, and shared with a second process.

numba compiles on one core. So while this process compiles a planner, which it needs first,
`python -m teamformer.commands.compiling POLICY` compiles what comes after it into the cache; with
`--simulator` only the step, as by a shared plan no policy has to think. With `--everything` it
compiles what any first run needs, for a wheel that brings it along.
"""

from __future__ import annotations

import atexit
import os
import subprocess
import sys
from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING

from teamformer.commands.console import say

if TYPE_CHECKING:
    from teamformer.model import Scenario


def announce_compiling(
    policy_names: Iterable[str] = (), is_planned: bool = False, has_shared_plan: bool = False
) -> None:
    """Say that a first run compiles, so that nobody takes the wait for a fault.

    `is_planned` says that crews, a schedule or a shared plan will be planned, as `central` always
    does; `has_shared_plan` that it is the last.
    """
    from teamformer.jit import needs_compiling
    from teamformer.planning.teams import threshold_search
    from teamformer.sim.allocation.task_order import plan_worlds
    from teamformer.sim.step import step_worlds

    names = list(policy_names)
    is_new = needs_compiling(step_worlds)
    if is_new:
        say("compiling the simulator, on the first run only (half a minute, more if busy) ...")
    if has_shared_plan and needs_compiling(threshold_search.search):
        say("compiling the planner, on the first run only (a minute) ...")
        if is_new and (os.cpu_count() or 1) > 1:
            _compile_beside("--simulator")
    has_crews = is_planned and not has_shared_plan
    if (has_crews or "central" in names) and needs_compiling(plan_worlds):
        say("compiling the planner of crews, on the first run only (half a minute, too) ...")
        if is_new and (os.cpu_count() or 1) > 1:
            _compile_beside(next((name for name in names if name != "central"), "join-all"))
    if "central" in names:
        from teamformer.planning.relaxation import threshold

        if needs_compiling(threshold_search.search) or not threshold.is_compiled():
            say("compiling the central planner, on the first run only (half a minute) ...")


def _compile_beside(what: str) -> None:
    """Let another process compile the simulator or a policy too; it ends with this one."""
    nowhere = subprocess.DEVNULL
    helper = subprocess.Popen(
        [sys.executable, "-m", "teamformer.commands.compiling", what],
        stdin=nowhere,
        stdout=nowhere,
        stderr=nowhere,
    )
    atexit.register(helper.kill)


def main() -> None:
    """Compile what a policy needs, or everything."""
    from teamformer.scenarios.smallest import smallest_scenario

    smallest = replace(smallest_scenario(), allocation="paper")
    names = sys.argv[1:]
    if names == ["--everything"]:
        _compile_everything(smallest)
    elif names == ["--simulator"]:
        _make_a_step(smallest)
    else:
        _play([smallest], names)


def _make_a_step(smallest: Scenario) -> None:
    """Make one step by a shared plan that holds nothing: its task is not known yet."""
    from teamformer.sim.env import Decision, TeamFormation

    later = tuple(replace(task, appears=9) for task in smallest.tasks)
    env = TeamFormation([replace(smallest, allocation="plan", tasks=later)])
    env.step(Decision(env.view().counts))


def _play(worlds: Iterable[Scenario], names: Iterable[str]) -> None:
    """Run policies in worlds, as `run` does."""
    from teamformer.commands.missions.run import ready_policy, watch_trial

    for world in worlds:
        for name in names:
            watch_trial(world, ready_policy(name, time_limit=1.0), name, seed=0)


def _compile_everything(smallest: Scenario) -> None:
    """Run policies of each kind under all allocations, on grids with and without walls, a plane."""
    from teamformer.grid import Grid
    from teamformer.mission.rules import ALLOCATIONS
    from teamformer.plane import Plane
    from teamformer.policies import POLICIES

    walled, plane = Grid(2, 2, ("..", ".@")), Plane(2.0, 1.0)
    worlds = [replace(smallest, world=world) for world in (smallest.world, walled, plane)]
    _play(worlds, [listing.name for listing in POLICIES])
    scripted = ("teamformer", "join-crew", "central")
    for allocation in ALLOCATIONS:
        _play((replace(world, allocation=allocation) for world in worlds), scripted)
    _play([replace(smallest, order="schedule")], ("join-all",))


if __name__ == "__main__":
    main()
