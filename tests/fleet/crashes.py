"""What one crash costs a fleet: `python tests/fleet/crashes.py [WORLDS] [SECONDS]`.

Beside a planner that was told of the loss before the mission began (`central`, so many seconds a
world), and the shared plan in the simulator, where a loss is known at once.
"""

from __future__ import annotations

import sys

import numpy as np

from teamformer.coordinators.shared_plan import SharedPlan
from teamformer.fleet.mission import Mission
from teamformer.fleet.rehearsal.faults import Crash, Faults
from teamformer.fleet.rehearsal.rehearse import play, set_stage
from teamformer.policies.central.policy import Central
from teamformer.scenarios.named_settings import world_of
from teamformer.trials.trial import run_trials

SETTINGS = ("warehouse-lost", "sparse-lost", "real-lost")


def main(worlds: int, seconds: float) -> None:
    for setting in SETTINGS:
        rows = []
        for number in range(worlds):
            scenario = world_of(setting, number)
            told = run_trials([scenario], Central(seconds, workers=1))[0].steps
            simulated = run_trials([scenario], SharedPlan())[0].steps
            mission = Mission(scenario)
            [(lost, robot)] = [
                (r.lost_for_good, n) for n, r in enumerate(scenario.robots) if r.absences
            ]
            crash = Crash(robot, (lost - 1) * mission.step)
            stage = set_stage(mission)
            rehearsal, outcome, violations = play(mission, stage.plan, Faults(crashes=(crash,)))
            assert outcome.status == "ended", violations
            since = [agent.keeper.since for agent in rehearsal.agents if agent is not None]
            notice = max(0.0, min(since) - crash.at)  # none where it had nothing left to do
            rows.append((told, simulated, outcome.makespan, notice))
            print(setting, number, rows[-1], flush=True)
        told, simulated, fleet, notice = np.mean(rows, axis=0)
        print(
            f"{setting}: {worlds} worlds: told before {told:.1f}, simulator {simulated:.1f}, "
            f"fleet {fleet:.1f} s, {notice:.1f} s of it to notice; {fleet / told - 1:+.1%}, "
            f"{(fleet - notice) / told - 1:+.1%} without these",
            flush=True,
        )


if __name__ == "__main__":
    arguments = sys.argv[1:]
    main(int(arguments[0]) if arguments else 6, float(arguments[1]) if arguments[1:] else 10.0)
