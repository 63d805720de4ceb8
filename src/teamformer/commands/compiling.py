"""Compiling on a first run: said beforehand, and shared with a second process.

numba compiles on one core. So while this process compiles a planner, which it needs first,
`python -m teamformer.commands.compiling METHOD` compiles what comes after it into the cache; with
`--simulator` only the step, as by a shared plan no policy has to think. With `--everything` it
compiles what any first run needs, for a wheel that brings it along.
"""

from __future__ import annotations

import atexit
import os
import subprocess
import sys
import time
from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING

from teamformer.commands.console import say

if TYPE_CHECKING:
    from teamformer.model import Scenario
    from teamformer.trials.methods import Method


def announce_planner(is_linked: bool = False) -> None:
    """Say that a first run compiles the planner of missions in continuous time, if it does."""
    from teamformer.planning.continuous.rules import is_compiled

    if not is_compiled(is_linked):
        say("compiling the planner, on the first run only (half a minute, more if busy) ...")


def announce_compiling(methods: Iterable[Method] = (), mission: Scenario | None = None) -> None:
    """Say that a first run compiles, so that nobody takes the wait for a fault, and compile.

    What these methods need is then compiled, so that no trial's time has it in; also what they need
    for a mission that is large, if one is given.
    """
    from teamformer.jit import needs_compiling
    from teamformer.planning.arcs.annealing import anneal_arcs
    from teamformer.planning.arcs.start import dispatch
    from teamformer.planning.crews.deal import deal_crews
    from teamformer.planning.steps.arc_search import LARGE
    from teamformer.sim.step import step_worlds

    wanted = {method.name: method for method in methods}
    is_new = needs_compiling(step_worlds)
    needed = is_new
    if is_new:
        say("compiling the simulator, on the first run only (half a minute, more if busy) ...")
    if "plan" in wanted and needs_compiling(anneal_arcs):
        needed = True
        say("compiling the planner, on the first run only (a minute) ...")
        if is_new and (os.cpu_count() or 1) > 1:
            _compile_beside("--simulator")
    if "crews" in wanted and needs_compiling(deal_crews):
        needed = True
        say("compiling the planner of crews, on the first run only (half a minute, too) ...")
    if "central" in wanted:
        from teamformer.planning.relaxation import threshold

        if needs_compiling(anneal_arcs) or not threshold.is_compiled():
            needed = True
            say("compiling the central planner, on the first run only (half a minute) ...")
    if needed and wanted:
        _compile(wanted.values())
    is_large = mission is not None and len(mission.tasks) >= LARGE
    if is_large and {"plan", "central"} & wanted.keys() and needs_compiling(dispatch):
        say("compiling the search of large missions, on the first run only (half a minute) ...")
        _plan_anew()


def _plan_anew() -> None:
    """Plan from nothing, as large missions are."""
    from teamformer.planning.steps.arc_search import TeamArcs
    from teamformer.planning.steps.situation import situation_in_hindsight
    from teamformer.scenarios.smallest import smallest_scenario

    TeamArcs(situation_in_hindsight(smallest_scenario())).plan_anew(rounds=10)


def _compile(methods: Iterable[Method]) -> None:
    """Compile what methods need, by playing the smallest mission, and say how long it took.

    A class of the user's own is not asked about a mission that is not the user's.
    """
    from teamformer.scenarios.smallest import smallest_scenario
    from teamformer.trials.methods import load_method
    from teamformer.trials.trial import run_trial

    begun = time.perf_counter()
    ours = [method for method in methods if ":" not in method.name]
    for method in ours or [load_method("join-all")]:
        run_trial(smallest_scenario(), method)
    say(f"compiled in {time.perf_counter() - begun:.0f} s")


def _compile_beside(what: str) -> None:
    """Let another process compile the simulator or a method too; it ends with this one."""
    nowhere = subprocess.DEVNULL
    helper = subprocess.Popen(
        [sys.executable, "-m", "teamformer.commands.compiling", what],
        stdin=nowhere,
        stdout=nowhere,
        stderr=nowhere,
    )
    atexit.register(helper.kill)


def main() -> None:
    """Compile what a method needs, or everything."""
    from teamformer.scenarios.smallest import smallest_scenario

    smallest = smallest_scenario()
    names = sys.argv[1:]
    if names == ["--everything"]:
        _compile_everything(smallest)
    elif names == ["--simulator"]:
        _make_a_step(smallest)
    else:
        _play([smallest], names)


def _make_a_step(smallest: Scenario) -> None:
    """Make one step by plans that hold nothing."""
    from teamformer.coordinators.on_command import OnCommand
    from teamformer.sim.env import TeamFormation

    env = TeamFormation([smallest], coordinator=OnCommand())
    env.step(env.planned_decision(env.view()))


def _play(worlds: Iterable[Scenario], names: Iterable[str]) -> None:
    """Run methods in worlds, as `run` does."""
    from teamformer.commands.missions.run import watch_trial
    from teamformer.trials.methods import load_method

    for world in worlds:
        for name in names:
            watch_trial(world, load_method(name, time_limit=1.0), seed=0)


def _compile_everything(smallest: Scenario) -> None:
    """Run methods of each kind on grids with and without walls, and on a plane."""
    from teamformer.grid import Grid
    from teamformer.plane import Plane
    from teamformer.trials.listings import our_method_names

    walled, plane = Grid(2, 2, ("..", ".@")), Plane(2.0, 1.0)
    worlds = [replace(smallest, world=world) for world in (smallest.world, walled, plane)]
    _play(worlds, our_method_names())
    _plan_anew()


if __name__ == "__main__":
    main()
