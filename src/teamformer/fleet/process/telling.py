"""What an agent tells those who watch the terminal where it runs: what it does, and with whom."""

from __future__ import annotations

from collections.abc import Iterable

from teamformer.fleet.agent.agent import Agent
from teamformer.fleet.messages import HERE, READY, SERVE
from teamformer.world.rules.constants import NOBODY


class Telling:
    """Looks at an agent after each of its ticks and puts into words what has changed."""

    def __init__(self, agent: Agent) -> None:
        self._agent = agent
        self._names = [robot.name for robot in agent.mission.source.robots]
        self._goal = NOBODY
        self._phase = -1
        self._fellows: dict[int, int] = {}  # by robot of its team at its task, the phase last heard
        self._done = set(agent.knowledge.done)
        self._off = agent.knowledge.called_off - agent.knowledge.done
        self._added = {task.key for task in agent.knowledge.added}
        self._carried = NOBODY
        self._lost: set[int] = set()
        self._plan = agent.keeper.plan.version
        self._is_over = agent.is_over

    def news(self) -> list[str]:
        """Return a line for each thing that has changed since this was last asked."""
        told = [*self._about_others(), *self._deeds(), *self._about_goal()]
        is_over = self._agent.is_over
        if is_over and not self._is_over:
            knowledge = self._agent.knowledge
            count = f"{len(knowledge.done)} of {len(knowledge.tasks)} tasks"
            told.append(f"mission complete, {count}")
        self._is_over = is_over
        return told

    def _about_others(self) -> Iterable[str]:
        """Yield who is lost or back, which tasks an operator added, and whose plan is new."""
        knowledge, keeper = self._agent.knowledge, self._agent.keeper
        lost = {word.robot for word in knowledge.words if word.is_lost} - {knowledge.me}
        yield from (f"{self._names[robot]} is lost" for robot in sorted(lost - self._lost))
        yield from (f"{self._names[robot]} is back" for robot in sorted(self._lost - lost))
        self._lost = lost
        for task in knowledge.added:
            if task.key not in self._added:
                self._added.add(task.key)
                yield f"an operator has added {task.name}"
        off = knowledge.called_off - knowledge.done
        for key in sorted(off - self._off):
            yield f"{knowledge.tasks[key].name} is called off"
        self._off = off
        if keeper.plan.version != self._plan:
            self._plan = keeper.plan.version
            maker = keeper.plan.note.maker
            yield f"new plan by {'itself' if maker == knowledge.me else self._names[maker]}"

    def _deeds(self) -> Iterable[str]:
        """Yield the tasks that are done now; of its own, with whom."""
        knowledge = self._agent.knowledge
        self._look_around()
        for key in sorted(knowledge.done - self._done):
            name = knowledge.tasks[key].name
            is_own = key == self._goal and self._own_phase() >= READY
            mates = [robot for robot, phase in self._fellows.items() if phase >= READY]
            yield f"{name} done{self._with(mates)}" if is_own else f"others did {name}"
        self._done = set(knowledge.done)

    def _look_around(self) -> None:
        """Note how far those of its team are that were at its task when it last looked."""
        for word in self._agent.knowledge.words:
            if word.robot in self._fellows and word.goal == self._goal:
                self._fellows[word.robot] = max(self._fellows[word.robot], word.phase)

    def _own_phase(self) -> int:
        """Return how far it is, or was when it last looked, with the task that it was about."""
        service = self._agent.service
        return max(self._phase, service.phase) if service.goal == self._goal else self._phase

    def _about_goal(self) -> Iterable[str]:
        """Yield what it heads for, that it waits there, and that it begins."""
        service, knowledge = self._agent.service, self._agent.knowledge
        if service.goal != self._goal:
            self._goal, self._phase, self._fellows = service.goal, -1, {}
            if service.goal != NOBODY:
                mates = self._agent.keeper.plan.coalition(service.goal)
                mates = tuple(robot for robot in mates if robot != knowledge.me)
                yield f"heads for {knowledge.tasks[service.goal].name}{self._with(mates)}"
            elif not self._agent.is_over:
                yield "has nothing to do"
        if service.goal == NOBODY:
            return
        before, self._phase = self._phase, service.phase
        self._fellows = {
            word.robot: word.phase
            for word in knowledge.words
            if word.goal == service.goal and word.team == service.team and word.phase >= HERE
            if word.robot != knowledge.me and not word.is_lost
        }
        name = knowledge.tasks[service.goal].name
        if service.phase == HERE and before < HERE:
            yield f"is at {name}"
        if service.phase == SERVE and before != SERVE and knowledge.tasks[service.goal].duration:
            yield f"begins {name}{self._with(self._fellows)}"
        carried = service.goal if self._agent.carries else NOBODY
        if carried not in (NOBODY, self._carried):
            yield f"carries {name}{self._with(self._fellows)}"
        self._carried = carried

    def _with(self, robots: Iterable[int]) -> str:
        names = ", ".join(self._names[robot] for robot in sorted(robots))
        return f" with {names}" if names else ""
