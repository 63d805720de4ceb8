"""How long fleets take beside the simulator: `python tests/fleet/makespans.py [WORLDS] [FIRST]`.

The agents without faults, and with 30% of the messages lost (three schedules a world), beside the
shared plan in the simulator, on random worlds from number FIRST on and on the example.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from teamformer.coordinators.shared_plan import SharedPlan
from teamformer.fleet.mission import Mission, seconds_a_step
from teamformer.fleet.rehearsal.faults import Faults
from teamformer.fleet.rehearsal.rehearse import play, set_stage
from teamformer.model import Scenario
from teamformer.scenarios.files import read_scenario
from teamformer.scenarios.named_settings import world_of
from teamformer.trials.trial import run_trials

SETTINGS = ("8N20T-C8", "4N20T-C4", "sparse", "real", "warehouse")
EXAMPLE = Path(__file__).parents[2] / "examples" / "warehouse.yaml"
LOSS = 0.3
SCHEDULES = 3


def measure(scenario: Scenario) -> tuple[float, float, float, float]:
    """Return the makespans of simulator, agents and agents with losses, and bytes a second."""
    mission = Mission(scenario, seconds_a_step(scenario))
    simulated = run_trials([scenario], SharedPlan())[0].steps * mission.step
    stage = set_stage(mission)
    lossy = []
    for seed in range(SCHEDULES):
        _, outcome, violations = play(mission, stage.plan, Faults(seed=seed, loss=LOSS))
        assert (outcome.status, violations) == ("ended", []), scenario.name
        lossy.append((outcome.makespan, outcome.bytes / outcome.robot_seconds))
    assert stage.undisturbed.makespan is not None
    return simulated, stage.undisturbed.makespan, *np.mean(lossy, axis=0).tolist()


def settings(worlds: int, first: int) -> Iterator[tuple[str, list[Scenario]]]:
    """Yield the settings' names with their worlds."""
    for name in SETTINGS:
        yield name, [world_of(name, number) for number in range(first, first + worlds)]
    yield "the example", [read_scenario(EXAMPLE)]


def main(worlds: int, first: int) -> None:
    for name, scenarios in settings(worlds, first):
        rows = np.array([measure(scenario) for scenario in scenarios])
        simulated, agents, lossy, said = rows.mean(axis=0)
        worst = (rows[:, 1] / rows[:, 0]).max() - 1, (rows[:, 2] / rows[:, 1]).max() - 1
        print(
            f"{name}: {len(rows)} worlds: simulator {simulated:.1f}, agents {agents:.1f} s "
            f"({agents / simulated - 1:+.1%}, at worst {worst[0]:+.1%}), with {LOSS:.0%} lost "
            f"{lossy:.1f} s ({lossy / agents - 1:+.1%}, at worst {worst[1]:+.1%}), each robot "
            f"saying {said:.0f} bytes a second",
            flush=True,
        )


if __name__ == "__main__":
    numbers = [int(argument) for argument in sys.argv[1:]]
    main(numbers[0] if numbers else 6, numbers[1] if numbers[1:] else 5000)
