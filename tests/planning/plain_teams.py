"""When everything in a plan of teams is done, worked out with sets of robots: a slow twin."""

from __future__ import annotations

from teamformer.mission.model import Mission
from teamformer.planning.problem.coalition_plan import CoalitionPlan
from teamformer.planning.problem.relaxed_problem import Relaxed


def slow_ends(mission: Mission, problem: Relaxed, plan: CoalitionPlan) -> list[int]:
    """Time a plan with sets: each group is its robots, where they are, and since when."""
    tasks, names = len(mission.tasks), [task.name for task in mission.tasks]
    together = [
        {"robots": set(team), "at": tasks + min(team), "free": 0, "splits": 0}
        for team in mission.starting_teams
    ]
    end = [0] * tasks
    for position in plan.order.tolist():
        crew = set(plan.coalition[position, : plan.size[position]].tolist())
        arrivals = []
        for group in together:
            ours = group["robots"] & crew
            if not ours:
                continue
            group["robots"] -= crew
            group["splits"] += bool(group["robots"])
            pace = min(problem.pace[robot] for robot in ours)
            way = int(problem.steps[pace, problem.cells[position, group["at"]]])
            arrivals.append(group["free"] + group["splits"] * mission.forming_steps + way)
        step, teams = 0, 0
        while teams != 1 or any(arrival > step for arrival in arrivals):
            if teams > 1:
                step, teams = step + 1, (teams + 1) // 2
            else:
                step = min(a for a in arrivals if a > step or teams == 0)
            come = [a for a in arrivals if a <= step]
            teams += len(come)
            arrivals = [a for a in arrivals if a > step]
        before = [end[names.index(name)] for name in mission.tasks[position].after]
        end[position] = max([step, int(problem.appears[position]) + 1, *(n + 1 for n in before)])
        end[position] += int(problem.duration[position])
        together.append({"robots": crew, "at": position, "free": end[position], "splits": 0})
    return end
