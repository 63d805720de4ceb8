"""What an onlooker makes of what robots say: a record that grows by a step each so many seconds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

from teamformer.fleet.fleet_mission import Mission
from teamformer.fleet.messages import SERVE, Beat, FactsNote, LoadFact, Message, TaskFact, Word
from teamformer.fleet.rehearsal.record import (
    Deed,
    Teams,
    deed_of,
    doers_goals,
    team_changes,
    teams_shown,
    who_did,
)
from teamformer.grid import Grid, Place
from teamformer.model import Task
from teamformer.plane import DECIMALS
from teamformer.rules.constants import NOBODY
from teamformer.sim.replay.record import FLEET, Ending, Replay, Step, TaskAt, TeamAt

STAYS = 3
"""Steps for which a robot's word that it is at work holds on, if it says something else since.

By then it is also told who did a task, be not all heard who are needed for it.
"""


class _Service(NamedTuple):
    """What a robot was at work on by its word, in which team, after how many steps."""

    task: int
    team: int
    step: int


class Watch:
    """Keeps everybody's newest word, the tasks and which are done; `step` writes down what changed.

    A robot is lost while its newest word says so. Robots in one place that say they are one team
    are shown as one, and so are, in the step in which it is heard of, those that did a task: they
    said that they serve it, and not much later what they do next.
    """

    def __init__(self, mission: Mission) -> None:
        self.mission = mission
        self.scenario = mission.scenario
        self.words: dict[int, Word] = {}
        self.tasks: dict[int, TaskFact] = {task.key: task for task in mission.tasks}
        self.steps: list[Step] = []
        self.has_facts = False  # whether it has been told what was done before it came
        self._number = {task.key: number for number, task in enumerate(mission.tasks)}
        self._done: dict[int, int] = {}  # task -> step in which that was heard of
        self._news: list[int] = []
        self._served: dict[int, _Service] = {}  # by robot: the last that it said it is at work on
        self._loads: dict[int, LoadFact] = {}  # that were moved, by task
        self._left: dict[int, TaskAt] = {}  # those that have been set down since the last step
        self._carried: set[int] = set()
        self._lost: set[int] = set()
        self._teams: Teams = {robot: (robot,) for robot in range(mission.robots)}
        self._shown: dict[int, TeamAt] = {}

    @property
    def is_over(self) -> bool:
        """Say whether all tasks that it knows are done, and told."""
        return len(self._done) == len(self.tasks) and not self._news

    def hear(self, message: Message) -> list[TaskFact]:
        """Take in a message; return the operators' tasks in it that were not known."""
        body = message.body
        if type(body) is Beat:
            for word in (body.word, *body.others):
                self._take(word)
            for key in body.news:
                self._note_done(key)
        elif type(body) is FactsNote:
            self.has_facts = True
            new = [task for task in body.added if self.learn(task)]
            for key in body.done:
                self._note_done(key)
            for load in body.loads:
                self._note_load(load)
            return new
        return []

    def learn(self, task: TaskFact) -> bool:
        """Take in an operator's task; say whether it was not known."""
        if task.key in self.tasks or len(task.needs) != len(self.scenario.capabilities):
            return False
        if not self.scenario.world.is_free((task.x, task.y)):
            return False
        self._number[task.key] = len(self.tasks)
        self.tasks[task.key] = task
        added = self._as_task(task, len(self.steps))
        self.scenario = replace(self.scenario, tasks=(*self.scenario.tasks, added))
        return True

    def step(self) -> Step:
        """Write down what has changed since the last step, and return it.

        Losses come first in a step: who has done something in it is lost in the next. What was done
        is told once there is anybody who may have done it.
        """
        ripe = [key for key in self._news if self._is_ripe(key)]
        deeds = [self._deed(key) for key in ripe]
        busy = {robot for deed in deeds for robot in deed.robots} - self._lost
        gone = {robot for robot, word in self.words.items() if word.is_lost} - busy
        if len(gone) == self.mission.robots:
            deeds = []
        lost, back = sorted(gone - self._lost), sorted(self._lost - gone)
        self._lost = gone
        lifted = {robot: lay for robot, lay in self._lifted().items() if robot not in gone}
        said = {
            robot: (NOBODY - robot if robot in back else self._team_of(robot), self._place(robot))
            for robot in range(self.mission.robots)
            if robot not in gone  # who is back is alone at first
        }
        doing, taking = [deed for deed in deeds if deed.robots], self._taking(lifted)
        places, teams, doers = teams_shown(said, doing, taking)
        before = self._teams | {robot: (robot,) for robot in back}
        splits, joins = team_changes(before, teams, lost)
        self._teams = teams
        self._carried |= {lay.key for lay in lifted.values()}
        taken = {
            self._number[lifted[robot].key]: slot
            for slot, robots in teams.items()
            for robot in robots
            if robot in lifted
        }
        goals = doers_goals(doers, taken)
        shown = {
            slot: TeamAt(slot, *places[slot], goals.get(slot, self._goal_of(slot)))
            for slot in sorted(teams)
        }
        rows = tuple(at for slot, at in shown.items() if self._shown.get(slot) != at)
        self._shown = shown
        done = tuple((deed.task, self._who(deed, teams)) for deed in deeds)
        self._news = [key for key in self._news if not teams or key not in ripe]
        left, self._left = tuple(self._left.values()), {}
        made = Step(joins, splits, tuple(lost), tuple(back), rows, done)
        made = replace(made, taken=tuple(taken.items()), left=left)
        self.steps.append(made)
        return made

    def record(self) -> Replay:
        """Return what has been seen so far."""
        tasks, steps = self.scenario.tasks, len(self.steps)
        done = sum(len(step.done) for step in self.steps)
        return Replay(
            scenario=replace(self.scenario, teams=()),
            method=FLEET,
            seed=0,
            orders=((0, tuple(k for k, task in enumerate(tasks) if task.appears == 0)),),
            start=tuple((r, (r,), *at.at) for r, at in enumerate(self.scenario.robots)),
            steps=tuple(self.steps),
            end=Ending(
                status="completed" if done == len(tasks) else "interrupted",
                makespan=steps if done == len(tasks) else None,
                steps=steps,
                tasks_done=done,
                joins=sum(len(step.joins) for step in self.steps),
                splits=sum(len(step.splits) for step in self.steps),
                illegal_decisions=0,
            ),
        )

    def _take(self, word: Word) -> None:
        known = self.words.get(word.robot)
        if known is None or word.version > known.version:
            self.words[word.robot] = word
            if word.phase == SERVE:
                self._served[word.robot] = _Service(word.goal, word.team, len(self.steps))

    def _note_load(self, load: LoadFact) -> None:
        """Note that a load was set down."""
        task, known = self.tasks.get(load.key), self._loads.get(load.key)
        is_news = task is not None and task.to is not None and (known is None or load > known)
        if is_news and self.scenario.world.is_free((load.x, load.y)):
            self._loads[load.key] = load
            self._carried.discard(load.key)
            number = self._number[load.key]
            self._left[number] = TaskAt(number, *self._as_place(load.x, load.y))

    def _lifted(self) -> dict[int, TaskFact | LoadFact]:
        """Return who says that it is at work on a load which it has carried away since; and that.

        The load is given where it lay.
        """
        found: dict[int, TaskFact | LoadFact] = {}
        for robot, word in self.words.items():
            task = self.tasks.get(word.goal)
            is_load = task is not None and task.to is not None and task.key not in self._done
            if task is None or not is_load or task.key in self._carried or word.phase != SERVE:
                continue
            lay = self._loads.get(task.key, task)
            if not self.mission.is_same_place(word.x, word.y, lay.x, lay.y):
                found[robot] = lay
        return found

    def _taking(self, lifted: Mapping[int, TaskFact | LoadFact]) -> list[Deed]:
        """Return each load that robots say they have taken up, where it lay, with all of them."""
        loads = {lay.key: self._as_place(lay.x, lay.y) for lay in lifted.values()}
        robots = {key: tuple(r for r, lay in lifted.items() if lay.key == key) for key in loads}
        return [Deed(self._number[key], at, robots[key]) for key, at in loads.items()]

    def _note_done(self, key: int) -> None:
        if key in self.tasks and key not in self._done:
            self._done[key] = len(self.steps) + 1
            self._news.append(key)

    def _place(self, robot: int) -> Place:
        word = self.words.get(robot)
        if word is None:
            return self.scenario.robots[robot].at
        return self._as_place(word.x, word.y)

    def _as_place(self, x: float, y: float) -> Place:
        if isinstance(self.scenario.world, Grid):
            return round(x), round(y)
        return round(x, DECIMALS), round(y, DECIMALS)

    def _team_of(self, robot: int) -> int:
        word = self.words.get(robot)
        return robot if word is None or word.team == NOBODY else word.team

    def _goal_of(self, robot: int) -> int | None:
        word = self.words.get(robot)
        number = None if word is None else self._number.get(word.goal)
        return None if number is None or word is None or word.goal in self._done else number

    def _is_ripe(self, key: int) -> bool:
        """Say whether those who were heard to do a task can have done it, or were waited for.

        The words of some may come after those of another that it is done; not for ever, and nobody
        waits while those who did it leave.
        """
        robots, seen = self._deed(key).robots, len(self.steps) + 2 - self._done[key]
        if any(self.words[robot].is_lost for robot in robots) or seen >= STAYS:
            return True
        return not robots or self.mission.covers(robots, self.tasks[key].needs)

    def _deed(self, key: int) -> Deed:
        """Return who did a task: who said last that they are at work on it, as one team.

        Who has not said so for a while, and says something else now, did not stay to the end.
        """
        latest = len(self.steps) - STAYS
        at_work = {
            robot: service
            for robot, service in self._served.items()
            if service.task == key and (service.step >= latest or self._is_serving(robot, key))
        }
        last = max(at_work.values(), key=lambda service: service.step, default=None)
        team = NOBODY if last is None else last.team
        robots = tuple(sorted(robot for robot, each in at_work.items() if each.team == team))
        return deed_of(self._number[key], self.scenario.tasks, robots)

    def _is_serving(self, robot: int, key: int) -> bool:
        word = self.words[robot]
        return word.phase == SERVE and word.goal == key

    def _who(self, deed: Deed, teams: Teams) -> int:
        """Return the team to show as the one that did a task; of unheard ones the nearest to it."""
        if deed.robots:
            return who_did(deed, teams)
        (x, y) = deed.at

        def away(slot: int) -> float:
            at = self._shown[slot]
            return (at.x - x) ** 2 + (at.y - y) ** 2

        return min(sorted(self._shown), key=away, default=0)

    def _as_task(self, task: TaskFact, steps: int) -> Task:
        names = {other.name for other in self.scenario.tasks}
        name = task.name if task.name not in names else f"{task.name} ({len(names) + 1})"
        at = (task.x, task.y)
        if isinstance(self.scenario.world, Grid):
            at = (int(task.x), int(task.y))
        caps = dict(zip(self.scenario.capabilities, task.needs, strict=True))
        needs = {cap: count for cap, count in caps.items() if count}
        return Task(name, at, needs, round(task.duration / self.mission.step), steps)
