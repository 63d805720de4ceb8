"""What agents tell at their terminals, beside what really happened in the world."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pytest

from fleets import PLANNER, agents_of, opened, pair, plan_of, standing, trio
from teamformer.files.mission_files import read_mission
from teamformer.fleet.agent.agent import Agent
from teamformer.fleet.bodies.body import Command, Report
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import EVERYBODY, OPERATOR, Message, Notice, Offer, TaskFact
from teamformer.fleet.process.telling import Telling
from teamformer.fleet.rehearsal.faults import Faults
from teamformer.fleet.rehearsal.play import Rehearsal

EXAMPLES = Path(__file__).parents[2] / "examples"


class Terminals(Rehearsal):
    """A rehearsal over a perfect network in which every agent has a terminal."""

    def __init__(self, mission: FleetMission) -> None:
        super().__init__(mission, PLANNER, plan_of(mission), Faults())
        self.lines: dict[str, list[str]] = {robot.name: [] for robot in mission.source.robots}
        for agent in self.agents:
            assert agent is not None
            self._listen_to(agent)

    def _listen_to(self, agent: Agent) -> None:
        telling, tick = Telling(agent), agent.tick
        lines = self.lines[self.mission.source.robots[agent.me].name]

        def ticked(
            now: float, report: Report, inbox: Sequence[Message]
        ) -> tuple[Command, list[Notice]]:
            made = tick(now, report, inbox)
            lines.extend(telling.news())
            return made

        agent.tick = ticked  # type: ignore[method-assign]


def deeds_told(lines: dict[str, list[str]]) -> dict[str, dict[str, set[str]]]:
    """Return by task and by the robot that says that it did it, who it says did it."""
    told: dict[str, dict[str, set[str]]] = {}
    for name, its in lines.items():
        for line in its:
            task, found, mates = line.partition(" done")
            if found:
                others = mates.removeprefix(" with ").split(", ") if mates else []
                told.setdefault(task, {})[name] = {name, *others}
    return told


def of_example(name: str) -> FleetMission:
    mission = read_mission(EXAMPLES / f"{name}.yaml")
    return FleetMission(mission, mission.seconds_a_step)


@pytest.mark.parametrize("name", ["pair", "trio", "warehouse", "late-tasks"])
def test_everybody_tells_what_it_did_and_with_whom(name: str) -> None:
    mission = {"pair": pair, "trio": trio}.get(name, lambda: of_example(name))()
    rehearsal = Terminals(mission)
    rehearsal.run(300.0)
    names = [robot.name for robot in mission.source.robots]
    world = rehearsal.world
    really = {}
    for key, done in world.done.items():
        who = {names[robot] for robot in done.robots}
        really[world.tasks[key].name] = dict.fromkeys(sorted(who), who)
    assert len(really) == len(mission.tasks)
    assert deeds_told(rehearsal.lines) == really
    complete = "mission complete, {0} of {0} tasks".format(len(mission.tasks))
    last = max(world.done.values(), key=lambda done: done.at)  # others may not have heard of it yet
    assert last.robots
    assert all(rehearsal.lines[names[robot]][-1] == complete for robot in last.robots)


def test_where_it_goes_comes_first() -> None:
    rehearsal = Terminals(pair())
    rehearsal.run(300.0)
    ends = ["t0 done with {}", "mission complete, 1 of 1 tasks"]
    begins = ["heads for t0 with {}", "is at t0", "begins t0 with {}"]
    for name, mate in [("r0", "r1"), ("r1", "r0")]:
        assert rehearsal.lines[name] == [line.format(mate) for line in (*begins, *ends)]


def test_losses_new_plans_and_added_tasks_are_told() -> None:
    agent = agents_of(trio())[0]
    telling = Telling(agent)
    leak = TaskFact(1 << 24, "leak", 1.0, 0.0, (1.0, 0.0, 0.0), 0.0)
    told = []
    for tick in range(1, 130):
        offers = [Notice(EVERYBODY, Offer(leak))] if tick == 5 else []
        agent.tick(tick / 10, standing(agent, tick), opened(agent.mission, OPERATOR, offers))
        told += telling.news()
    others = ("heads for ", "is at ", "begins ", "has nothing")
    rest = [line for line in told if not line.startswith(others)]
    assert rest[0] == "an operator has added leak"
    assert {"r1 is lost", "r2 is lost"} <= set(rest)
    assert rest[-1] == "new plan by itself"
