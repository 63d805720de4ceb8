"""How a mission stands after some steps of its record: teams, services, and what robots do."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence

from teamformer.mission.checks.windows import window_opens
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.places import believed_place
from teamformer.mission.parts.zones import AtWork, all_rooms_of
from teamformer.mission.precedence import tasks_before
from teamformer.record.phases import WAITING
from teamformer.record.record import Record, Step
from teamformer.record.task_times import appears_after
from teamformer.record.teams import Teams
from teamformer.record.telling.phases import Phases, TeamsBefore
from teamformer.record.telling.plans_in_force import PlansInForce
from teamformer.record.telling.services import Services
from teamformer.world.rules.constants import NOBODY


class Unrolled:
    """Goes on step by step; tasks that a fleet has learned of meanwhile may come to the mission.

    `steps` are made, `latest` is the last one, `others` are the teams that did something else in
    it than before, `over` the tasks that are over, `opened` those that may begin from then on as
    the last one before them is over, `is_planned` says that a plan or an order was made before it.
    """

    def __init__(self, record: Record) -> None:
        self.steps = 0
        self.latest = Step()
        self.teams = Teams(record.mission.robots, record.start)
        self.services = Services()
        self.phases = Phases()
        self.plans = PlansInForce()
        self.others: list[int] = []
        self.over: set[int] = set()
        self.opened: list[int] = []
        self.news: list[int] = []  # tasks that appeared in the latest step
        self.called_off: list[int] = []
        self.missed: list[int] = []
        self.done: set[int] = set()
        self.is_planned = False
        self.goals: list[Place] = []  # where each task is believed to be, or is brought to
        self.lies: list[Place] = []  # where each is; a load that is up, where it was taken up
        self.known: list[int] = []  # after how many steps each becomes known
        self.formed: set[int] = set()  # teams with other robots than before the latest step
        self._changed = set(self.teams.robots)  # teams for which the step before changed something
        self._heading: dict[int, list[int]] | None = None
        self.at_chargers: dict[int, str] = {}  # what robots do there in the latest step
        self.off: set[int] = set()  # robots outside their shifts in the latest step
        rotas = enumerate(robot.rota for robot in record.mission.robots)
        self._rotas = [(robot, rota) for robot, rota in rotas if rota]
        self._read(record)

    def _read(self, record: Record) -> None:
        """Read the mission, which may have more tasks than it had."""
        self.record, self.mission, self.source = record, record.true_mission, record.mission
        tasks = self.source.tasks
        if len(tasks) == len(self.known):
            return
        world, true_tasks = record.mission.world, self.mission.tasks
        held = len(self.goals)
        self.goals += [believed_place(world, task) for task in tasks[held:]]
        self.lies += [task.at for task in true_tasks[held:]]
        self.known = [appears_after(task) for task in tasks]
        self.before = tasks_before(tasks)
        self.rooms = all_rooms_of(self.source)
        self._after: defaultdict[int, list[int]] = defaultdict(list)
        for task, others in self.before.items():
            for other in others:
                self._after[other].append(task)
        self._appear: defaultdict[int, list[int]] = defaultdict(list)
        self._cancelled: defaultdict[int, list[int]] = defaultdict(list)
        for number, wanted in enumerate(tasks):
            self._appear[self.known[number]].append(number)
            if wanted.cancelled is not None:
                self._cancelled[int(wanted.cancelled)].append(number)

    def go_on(self, record: Record) -> None:
        """Go on to the next step of a record."""
        if record is not self.record:
            self._read(record)
        for pair in self.latest.took:
            self.plans.exchange(*pair)
        self.is_planned = self.plans.go_on(record, self.steps)
        self.plans.pass_over(self.over if self.is_planned else self.done)
        self.latest = step = record.steps[self.steps]
        self.steps += 1
        self._heading = None
        before = TeamsBefore(self.teams, step, self.phases.deeds)
        formed = self._slots_of(self.teams.follow(step))
        self.formed = formed | self._slots_of(r for r in before.slot if r not in step.lost)
        changed = self.formed | self._slots_of(step.back) | set(self._who_heads_elsewhere(step))
        changed |= {row.slot for row in step.teams} | {slot for slot, _ in step.pursued}
        off = self._who_is_off()
        changed |= self._slots_of(
            off | self.off | self.at_chargers.keys() | dict(step.charge).keys()
        )
        self.off = off
        at_chargers = {**self.at_chargers, **dict(step.charge)}
        self.at_chargers = {robot: doing for robot, doing in at_chargers.items() if doing}
        work = self.services.by_slot(self.teams)
        walking = before.walking - self.formed - work.keys() - set(step.back)
        slots = ((changed | self._changed) & self.teams.robots.keys()) - walking
        were = {task: self.goals[task] for task, _ in (*step.taken, *step.done)}
        self._complete(step)
        self.others = self.phases.follow(
            self.mission,
            self.teams,
            step,
            slots,
            before,
            formed,
            work,
            self.goals,
            were,
            off,
            self.at_chargers,
        )
        self._changed = changed | self._slots_of(self.services.touched)

    def _who_is_off(self) -> set[int]:
        """Return who is outside its shifts in the latest step."""
        made = self.steps - 1
        return {robot for robot, rota in self._rotas if rota.fits(made, 1) != made}

    def _slots_of(self, robots: Iterable[int]) -> set[int]:
        return {self.teams.slot[robot] for robot in robots} - {NOBODY}

    def _who_heads_elsewhere(self, step: Step) -> Iterator[int]:
        """Yield the teams that head for tasks that turn out to be elsewhere, or go there."""
        elsewhere = {row.task for row in (*step.moved, *step.left)}
        elsewhere.update(task for task, _ in (*step.taken, *step.done, *step.served))
        elsewhere.update(self._cancelled.get(self.steps, ()))
        elsewhere.update(task for task, _ in step.missed)
        if elsewhere:
            yield from (slot for slot, task in self.teams.task.items() if task in elsewhere)

    def _complete(self, step: Step) -> None:
        """Take in what was done and called off, and where tasks are since."""
        self.done = done = {task for task, _ in step.done}
        due = self._cancelled.get(self.steps, ())
        self.called_off = [k for k in due if k not in self.over and k not in done]
        self.news = [k for k in self._appear.get(self.steps, ()) if k not in self.over]
        self.missed = [task for task, _ in step.missed]
        gone = (*self.called_off, *self.missed)
        let_go = (*gone, *(task for task, robots in step.served if not robots))
        for task in (k for k in let_go if self.services.is_up(k)):
            self.lies[task] = self.goals[task] = self._place_of(self.services.who_serves(task))
        for task in done:
            self.lies[task] = self.goals[task] = self.mission.tasks[task].to or self.lies[task]
        for task, *at in step.moved:
            self.goals[task] = (at[0], at[1])
        for task, *at in step.left:
            self.lies[task] = self.goals[task] = (at[0], at[1])
        taken = [(task, slot) for task, slot in step.taken if task not in self.over]
        for task in (k for k, _ in taken if k not in done):
            self.goals[task] = self.mission.tasks[task].to or self.lies[task]
        self.plans.pass_over(gone)
        ended = {*gone, *(row.task for row in step.left)}
        self.services.go_on(self.mission, self.teams, step, self.steps, ended, taken)
        self.over |= done.union(gone)
        self.opened = [
            task
            for other in (*done, *gone)
            for task in self._after.get(other, ())
            if self.over.issuperset(self.before[task])
        ]

    def _place_of(self, robots: Sequence[int]) -> Place:
        """Return where the first of some robots is that is there, or else where it was lost."""
        return self.teams.place(min(robots, key=lambda r: (self.teams.slot[r] == NOBODY, r)))

    def task_places(self) -> tuple[Place, ...]:
        """Return where every task is; a load that is carried is with its team."""
        places = list(self.lies)
        for task in self.services.loads_up():
            places[task] = self._place_of(self.services.who_serves(task))
        return tuple(places)

    @property
    def at_work(self) -> AtWork:
        """Return what takes room in zones, or waits for it with a load."""
        doing = self.phases.deeds.values()
        return self.services.at_work({task for phase, task in doing if phase == WAITING})

    def opens(self, task: int) -> int:
        """Return after which step a task may begin, if all tasks that it comes after are over."""
        return max(self.known[task], window_opens(self.source.tasks[task]))

    def heading_for(self, task: int) -> list[int]:
        """Return the robots whose teams head for a task, in order."""
        if self._heading is None:
            heading: defaultdict[int, list[int]] = defaultdict(list)
            for slot, goal in self.teams.task.items():
                heading[goal].extend(self.teams.robots[slot])
            self._heading = {goal: sorted(robots) for goal, robots in heading.items()}
        return self._heading.get(task, [])

    def open_tasks(self) -> list[int]:
        """Return the tasks that were known and not over before the latest step ended."""
        return [
            task
            for task, known in enumerate(self.known)
            if known < self.steps and task not in self.over
        ]
