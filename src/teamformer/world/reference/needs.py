"""What tasks are believed to need whose needs nobody knows, and when everybody learns them."""

from __future__ import annotations

from teamformer.mission.checks.rules import LEAST_CHANCE
from teamformer.mission.parts.capabilities import exact
from teamformer.world.reference.state import PlainWorld


def expect_needs(world: PlainWorld) -> None:
    """Expect of what may be needed no more than the robots that are left can bring there."""
    left = [robot for robot, slot in enumerate(world.slot_of) if slot is not None]
    least, caps = LEAST_CHANCE[world.foresight], world.mission.capabilities
    for task in world.hidden:
        wanted, region = world.mission.tasks[task], world.task_regions[task]
        have = world.sum_of(robot for robot in left if world.regions[robot] in (None, region))
        needs = dict(wanted.needs)
        for cap, chance in wanted.may_need.items():
            more, i = exact(needs.get(cap, 0) + 1), caps.index(cap)
            if 0 < chance >= least and have[i] >= world.in_units({cap: more})[i]:
                needs[cap] = more
        world.needs[task] = world.in_units(needs)


def show_needs(world: PlainWorld) -> None:
    """Make known what the open tasks need at which teams stand."""
    if not world.hidden:
        return
    here = {task for team in world.teams.values() for task in world.tasks_at(team.at)}
    world.happened.shown = sorted(world.hidden & world.open & here)
    for task in world.happened.shown:
        world.hidden.remove(task)
        world.needs[task] = world.in_units(world.truth.tasks[task].needs)
