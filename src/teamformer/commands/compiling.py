"""Compiling on a first run: said beforehand, and shared with a second process.

numba compiles on one core. So while this process compiles the planner of crews, which it needs
first, `python -m teamformer.commands.compiling POLICY` compiles what comes after it into the cache.
"""

from __future__ import annotations

import atexit
import os
import subprocess
import sys
from collections.abc import Iterable
from dataclasses import replace

from teamformer.commands.console import say


def announce_compiling(policy_names: Iterable[str] = (), is_planned: bool = False) -> None:
    """Say that a first run compiles, so that nobody takes the wait for a fault.

    `is_planned` says that crews or a schedule will be planned, as `central` always does.
    """
    from teamformer.jit import needs_compiling
    from teamformer.sim.allocation.task_order import plan_worlds
    from teamformer.sim.step import step_worlds

    names = list(policy_names)
    is_new = needs_compiling(step_worlds)
    if is_new:
        say("compiling the simulator, on the first run only (half a minute, more if busy) ...")
    if (is_planned or "central" in names) and needs_compiling(plan_worlds):
        say("compiling the planner of crews, on the first run only (half a minute, too) ...")
        if is_new and (os.cpu_count() or 1) > 1:
            _compile_beside(next((name for name in names if name != "central"), "join-all"))
    if "central" in names:
        from teamformer.planning.relaxation import ruin_recreate
        from teamformer.planning.teams import annealing

        if not (ruin_recreate.is_compiled() and annealing.is_compiled()):
            say("compiling the central planner, on the first run only (half a minute) ...")


def _compile_beside(policy: str) -> None:
    """Let another process compile the simulator and a policy; it ends with this one."""
    nowhere = subprocess.DEVNULL
    helper = subprocess.Popen(
        [sys.executable, "-m", "teamformer.commands.compiling", policy],
        stdin=nowhere,
        stdout=nowhere,
        stderr=nowhere,
    )
    atexit.register(helper.kill)


def main() -> None:
    """Run a policy in the smallest world, so that all it needs is compiled."""
    from teamformer.policies import POLICIES
    from teamformer.scenarios.smallest import smallest_scenario
    from teamformer.trials.registry import load_policy
    from teamformer.trials.trial import run_trial

    name = sys.argv[1]
    smallest = replace(smallest_scenario(), allocation="paper")
    run_trial(smallest, load_policy(name, POLICIES), name)


if __name__ == "__main__":
    main()
