"""Compiling on a first run before anything is timed, and shared with a second process.

numba compiles on one core. So while this process compiles a planner, which it needs first,
`python -m teamformer.cli.terminal.compiling METHOD` compiles what comes after it into the cache;
with `--simulator` only the step and the bound, as by a shared plan no policy has to think. With
`--planner` it compiles the shared plan, as `make run` has it do while pip brings what that does not
need. With `--everything` it compiles what any first run needs, for a wheel that brings it.
"""

from __future__ import annotations

import atexit
import subprocess
import sys
import time
from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING

from teamformer.cli.terminal.console import Waiting, processors, say

if TYPE_CHECKING:
    from teamformer.methods.by_name import Method
    from teamformer.mission.model import Mission


def compile_ahead(methods: Iterable[Method], mission: Mission | None = None) -> None:
    """Compile what methods need, so that no trial's time has it in; that it does is said.

    If a mission is given that is large, that is also what they need for large ones.
    """
    from teamformer.base.kernels.jit import needs_compiling
    from teamformer.planning.continuous.rules import warm_up
    from teamformer.planning.crews.deal import deal_crews
    from teamformer.planning.dispatch.futures import play_out
    from teamformer.planning.relaxation import threshold
    from teamformer.planning.search.annealing import anneal
    from teamformer.planning.steps.arc_search import LARGE
    from teamformer.world.step import step_worlds

    if mission is not None and mission.time == "continuous":
        warm_up(mission)
        return
    wanted = {method.name: method for method in methods}
    has_new_planner = "plan" in wanted and needs_compiling(anneal)
    is_new = needs_compiling(step_worlds)
    if has_new_planner and is_new and processors() > 1:
        compile_beside("--simulator")
    if (
        is_new
        or has_new_planner
        or ("crews" in wanted and needs_compiling(deal_crews))
        or ("central" in wanted and (needs_compiling(anneal) or not threshold.is_compiled()))
    ):
        _compile(wanted.values())
    is_large = mission is not None and len(mission.tasks) >= LARGE
    if is_large and {"plan", "central"} & wanted.keys() and needs_compiling(play_out):
        _plan_anew()


def _plan_anew() -> None:
    """Plan from nothing, as large missions are."""
    from teamformer.files.drawn.smallest import smallest_mission
    from teamformer.planning.steps.arc_search import TeamArcs
    from teamformer.planning.steps.situation import situation_in_hindsight

    TeamArcs(situation_in_hindsight(smallest_mission())).plan_anew(rounds=10)


def _compile(methods: Iterable[Method]) -> None:
    """Compile what methods need, by playing the smallest mission, and say how long it took.

    A class of the user's own is not asked about a mission that is not the user's.
    """
    from teamformer.files.drawn.smallest import smallest_mission
    from teamformer.methods.by_name import load_method
    from teamformer.trials.trial import run_trial

    begun = time.perf_counter()
    ours = [method for method in methods if ":" not in method.name]
    with Waiting("compiling"):
        for method in ours or [load_method("join-all")]:
            run_trial(smallest_mission(), method)
    say(f"compiled in {time.perf_counter() - begun:.0f} s")


def compile_beside(what: str) -> None:
    """Let another process compile the simulator or a method too; it ends with this one."""
    nowhere = subprocess.DEVNULL
    helper = subprocess.Popen(
        [sys.executable, "-m", "teamformer.cli.terminal.compiling", what],
        stdin=nowhere,
        stdout=nowhere,
        stderr=nowhere,
    )
    atexit.register(helper.kill)


def main() -> None:
    """Compile what a method needs, or everything."""
    from teamformer.files.drawn.smallest import smallest_mission

    smallest = smallest_mission()
    names = sys.argv[1:]
    if names == ["--everything"]:
        _compile_everything(smallest)
    elif names == ["--simulator"]:
        _make_a_step(smallest)
    elif names == ["--planner"]:
        _make_a_plan(smallest)
    else:
        _play([smallest], names)


def _make_a_step(smallest: Mission) -> None:
    """Make one step by plans that hold nothing, and work out what no plan beats."""
    from teamformer.methods.coordinators.on_command import OnCommand
    from teamformer.planning.bounds.makespan import lower_bound
    from teamformer.world.env import TeamFormation

    env = TeamFormation([smallest], coordinator=OnCommand())
    env.step(env.planned_decision(env.view()))
    lower_bound(smallest)


def _make_a_plan(smallest: Mission) -> None:
    """Make the first plan of robots that share one."""
    from teamformer.methods.coordinators.shared_plan import SharedPlan
    from teamformer.world.env import TeamFormation

    TeamFormation([smallest], coordinator=SharedPlan()).view()


def _play(worlds: Iterable[Mission], names: Iterable[str]) -> None:
    """Run methods in worlds, as `run` does."""
    from teamformer.methods.by_name import load_method
    from teamformer.planning.bounds.makespan import lower_bound
    from teamformer.trials.trial import run_trial

    for world in worlds:
        for name in names:
            run_trial(world, load_method(name, time_limit=1.0), 0, lower_bound(world))


def _compile_everything(smallest: Mission) -> None:
    """Run methods of each kind on grids with and without walls, and on a plane."""
    from teamformer.methods.listings import our_method_names
    from teamformer.mission.parts.grid import Grid
    from teamformer.mission.parts.plane import Plane
    from teamformer.planning.continuous.rules import warm_up

    walled, plane = Grid(2, 2, ("..", ".@")), Plane(2.0, 1.0)
    worlds = [replace(smallest, world=world) for world in (smallest.world, walled, plane)]
    _play(worlds, our_method_names())
    _plan_anew()
    warm_up(replace(smallest, world=plane, time="continuous", until=9.0))


if __name__ == "__main__":
    main()
