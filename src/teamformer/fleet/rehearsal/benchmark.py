"""`bench fleet`: how long fleets take beside the simulator, and with messages lost."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from teamformer.files.drawn.named_settings import world_of
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.rehearsal.faults import Faults, losses_of
from teamformer.fleet.rehearsal.outcome import Outcome
from teamformer.fleet.rehearsal.rehearse import play, set_stage
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.trials.trial import run_trials

SETTINGS = (
    *("8N20T-C8", "4N20T-C4", "sparse", "real", "warehouse"),
    *("warehouse-lost", "sparse-lost", "real-lost"),
)
LOSS = 0.3  # of messages
SCHEDULES = 3  # with losses, for each world


def bench_fleet(settings: Sequence[str], seeds: Sequence[int]) -> Iterator[dict[str, Any]]:
    """Yield a row for every world of every setting, by its seed; times are in seconds.

    `simulator` is the shared plan's makespan in steps, in which a loss is known at once; `agents`
    the fleet's over a perfect network; `lossy` the mean of those with 30% of the messages lost,
    None if one of them did not end.
    """
    for setting in settings:
        for seed in seeds:
            source = world_of(setting, seed)
            mission = FleetMission(source, source.seconds_a_step)
            stage, crashes = set_stage(mission), losses_of(mission)
            schedules = [Faults(crashes=crashes)]
            schedules += [Faults(number, LOSS, crashes=crashes) for number in range(SCHEDULES)]
            played = [play(mission, stage.plan, faults) for faults in schedules]
            calm, *lossy = [outcome for _, outcome, _ in played]
            spans = [end for each in lossy if (end := _end_of(each)) is not None]
            told = [outcome.bytes / outcome.robot_seconds for outcome in lossy]
            yield {
                "suite": "fleet",
                "setting": setting,
                "world_seed": seed,
                "simulator": run_trials([source], SharedPlan())[0].steps * mission.step,
                "agents": _end_of(calm),
                "lossy": float(np.mean(spans)) if len(spans) == len(lossy) else None,
                "bytes_per_robot_second": round(float(np.mean(told)), 1),
                "violations": [line for _, _, broken in played for line in broken],
            }


def _end_of(outcome: Outcome) -> float | None:
    return outcome.makespan if outcome.status == "ended" else None


def summarise(rows: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return for each setting the means over the worlds that ended, and the worst world's excess.

    Excesses are in percent: of the agents over the simulator, with losses over the agents.
    """
    summaries = []
    for setting in dict.fromkeys(row["setting"] for row in rows):
        own = [row for row in rows if row["setting"] == setting]
        ended = [row for row in own if row["agents"] is not None and row["lossy"] is not None]
        spans = np.array([[row["simulator"], row["agents"], row["lossy"]] for row in ended])
        summary: dict[str, Any] = {"setting": setting, "worlds": len(own), "ended": len(ended)}
        if ended:
            simulator, agents, lossy = spans.mean(axis=0).tolist()
            worst = 100 * ((spans[:, 1:] / spans[:, :-1]).max(axis=0) - 1)
            summary |= {
                "simulator": f"{simulator:.1f} s",
                "agents": f"{agents:.1f} s",
                "more": f"{100 * (agents / simulator - 1):+.1f}% ({worst[0]:+.1f}%)",
                "30% lost": f"{100 * (lossy / agents - 1):+.1f}% ({worst[1]:+.1f}%)",
            }
        summaries.append(summary | {"broken": sum(len(row["violations"]) for row in own)})
    return summaries
