"""When a rehearsed mission is over: what is left to do, and what of it nobody can do any more."""

from __future__ import annotations

import math
from collections.abc import Sequence, Set

from msgspec.structs import replace

from teamformer.fleet.agent.agent import Agent
from teamformer.fleet.bodies.world import FleetWorld
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.in_shifts import can_still_do
from teamformer.fleet.messages import TaskFact
from teamformer.fleet.operator import Operator
from teamformer.fleet.rehearsal.faults import Faults


class EndingWatch:
    """Looks at what is true, which no robot knows: who is lost for good, what is done."""

    def __init__(
        self,
        mission: FleetMission,
        faults: Faults,
        world: FleetWorld,
        operators: Sequence[Operator],
    ) -> None:
        self._mission, self._faults, self._world = mission, faults, world
        self._operators = operators
        self._stuck = {spell.robot for spell in faults.stuck if spell.end is None}

    def status(self, now: float, held: Set[int], agents: Sequence[Agent | None]) -> str | None:
        """Return how the mission has ended; None while it goes on.

        `held` are the operators' tasks, and those called off, that somebody knows still. Robots
        that know that all is over have to be home, if the mission ends there.
        """
        able = self._able()
        waiting = [operator for operator in self._operators if not operator.is_accepted]
        if any(len(able) >= operator.needed for operator in waiting):
            return None
        unheard = {operator.task.key for operator in waiting}
        is_closed = now >= self._mission.until
        left = self._left(now).keys() - unheard
        must = {key for key in left if not self._mission.may_miss(key)}
        if not is_closed:
            impossible = {task.key for task in self.impossible(now, held)}
            if not left <= impossible | ((left - must) & self._idle(agents)):
                return None
        is_given_up = bool(left) and not is_closed
        knowing = (r for r in able if (it := agents[r]) and (it.is_over or is_given_up))
        is_home = all(map(self._is_home, knowing))
        if not is_home and (is_closed or not must):
            return None
        return ("too late" if is_closed else "infeasible") if must else "ended"

    def _idle(self, agents: Sequence[Agent | None]) -> set[int]:
        """Return the tasks that are not over and that no running robot means to do."""
        running = [agent for agent in agents if agent is not None]
        idle = self._world.tasks.keys() - self._world.over if running else set[int]()
        for agent in running:
            idle &= agent.keeper.plan.idle - {agent.service.goal}
        return idle

    def _is_home(self, robot: int) -> bool:
        """Say whether a robot is where it has to be in the end, or cannot get there."""
        home, here = self._mission.home_of(robot), self._world.place(robot)
        if home is None or not self._mission.leads(robot, here, home):
            return True
        if self._mission.comes(robot, here, home, self._world.now) == math.inf:  # no shift is left
            return True
        return self._mission.is_same_place(*here, *home)

    def impossible(self, now: float, held: Set[int]) -> list[TaskFact]:
        """Return the tasks that are not done, and that the robots left cannot do or know.

        So are those after such a task, or after one that they cannot do and was called off, if all
        who knew that have lost their memory.
        """
        able, lost, left = self._able(), self._lost_orders(now, held), self._left(now)
        forgotten = self._withdrawn(now) - held - self._world.done.keys()
        tasks = left | {key: self._world.tasks[key] for key in forgotten}
        is_served = self._world.is_served
        can_do, places = self._mission.can_do, {robot: self._world.place(robot) for robot in able}
        idle = {key: self._as_it_lies(it) for key, it in tasks.items() if not is_served(key)}
        cannot = {key for key, it in idle.items() if not can_do(able, it, places)} | lost
        if self._mission.has_shifts:
            longest = ((key, self._as_long_as_believed(it)) for key, it in idle.items())
            fits = ((key, can_still_do(self._mission, it, places, now)) for key, it in longest)
            cannot |= {key for key, is_possible in fits if not is_possible}
        before = self._mission.before
        while more := {key for key in left if before.get(key, set()) & cannot} - cannot:
            cannot |= more
        return [task for key, task in left.items() if key in cannot]

    def _as_long_as_believed(self, task: TaskFact) -> TaskFact:
        """Return a task that takes as long as it really does, or as robots believe if longer."""
        own = self._mission.tasks
        believed = own[task.key].duration if task.key < len(own) else 0.0
        return replace(task, duration=max(task.duration, believed))

    def _as_it_lies(self, task: TaskFact) -> TaskFact:
        """Return a task with its load where that lies."""
        x, y = self._world.place_of(task.key)
        return replace(task, x=x, y=y)

    def makespan(self, alive: Sequence[int]) -> float | None:
        """Return when the last task was done, or when robots were home if the mission ends there.

        None if nothing was done.
        """
        times = [done.at for done in self._world.done.values()]
        if self._mission.ends and times:
            ways = (self._world.robots[robot].journey.way for robot in alive)
            times += [way[-1].at for way in ways if len(way) > 1]
        return max(times, default=None)

    def undone(self, now: float, held: Set[int]) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """Return the names of tasks that can be done and are not, and of those that cannot be."""
        impossible = {task.key for task in self.impossible(now, held)}
        names = {key: task.name for key, task in self._left(now).items()}
        must = [key for key in names if not self._mission.may_miss(key)]
        undone = tuple(names[key] for key in must if key not in impossible)
        return undone, tuple(names[key] for key in must if key in impossible)

    def _left(self, now: float) -> dict[int, TaskFact]:
        """Return the tasks that are neither done nor called off."""
        over = self._world.done.keys() | self.called_off(min(now, self._mission.until))
        return {key: task for key, task in self._world.tasks.items() if key not in over}

    def called_off(self, now: float) -> set[int]:
        """Return the tasks that are called off by now, which may be done all the same."""
        return self._withdrawn(now) | {key for key, at in self._mission.off_at.items() if at <= now}

    def _withdrawn(self, now: float) -> set[int]:
        return {off.task for off in self._faults.withdrawals if off.at <= now}

    def _able(self) -> list[int]:
        """Return the robots that are, or will be, able to work."""
        robots = enumerate(self._world.robots)
        able = [r for r, body in robots if not (body.is_dead or body.is_dry)]
        return [robot for robot in able if robot not in self._stuck]

    def _lost_orders(self, now: float, held: Set[int]) -> set[int]:
        """Return the accepted tasks that all who held them have lost with their memory.

        Where somebody was told since, such a task has to be done all the same.
        """
        forgetful = {
            crash.robot: crash.at
            for crash in self._faults.crashes
            if crash.at <= now and (crash.back is None or not crash.keeps_facts)
        }
        return {
            operator.task.key
            for operator, order in zip(self._operators, self._faults.orders, strict=False)
            if operator.is_accepted
            and operator.task.key not in held
            and all(forgetful.get(robot, -1.0) >= order.at for robot in operator.holders)
        }
