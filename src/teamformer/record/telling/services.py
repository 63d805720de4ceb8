"""Services of a record, as its steps say who serves which task and who carries which load."""

from __future__ import annotations

from collections.abc import Container, Iterable

from teamformer.mission.model import Mission
from teamformer.mission.parts.zones import AtWork
from teamformer.record.phases import CARRYING, LOADING, SERVING, UNLOADING
from teamformer.record.record import Step
from teamformer.record.teams import Teams
from teamformer.record.told.told_record import Robots, ToldService
from teamformer.world.rules.constants import NOBODY


class Services:
    """The services up to some step; `changed` are those that the latest began or ended.

    `touched` are the robots that began or ended something then, `under_way` the tasks that went on
    in it, and `turned` those that the step before began or ended.
    """

    def __init__(self) -> None:
        self.rows: list[ToldService] = []
        self.changed: list[int] = []
        self.touched: set[int] = set()
        self.under_way: set[int] = set()
        self.turned: set[int] = set()
        self._open: dict[int, int] = {}  # task -> its row that goes on
        self._with: dict[int, Robots] = {}  # task -> who serves it now
        self._doing: dict[int, str] = {}  # what was done for tasks before the latest step ended

    def by_slot(self, teams: Teams) -> dict[int, str]:
        """Return what teams do for tasks; of several tasks, what they do for a load."""
        work: dict[int, str] = {}
        rows = (self.rows[row] for row in self._open.values())
        for row in sorted(rows, key=lambda it: (it.doing != SERVING, it.task)):
            slots = {teams.slot[robot] for robot in self._with[row.task]}
            work |= dict.fromkeys(slots - {NOBODY}, row.doing)
        return work

    def at_work(self, waiting: Container[int]) -> AtWork:
        """Return what took room in zones in the latest step; `waiting` has loads that wait for it.

        They wait where they are brought to.
        """
        doing = self._doing
        return AtWork(
            [task for task, what in doing.items() if what in (SERVING, LOADING)],
            [task for task, what in doing.items() if what == UNLOADING],
            [task for task, what in doing.items() if what == CARRYING and task in waiting],
        )

    def is_up(self, task: int) -> bool:
        """Say whether a task is a load that is carried or unloaded."""
        row = self._open.get(task)
        return row is not None and self.rows[row].doing in (CARRYING, UNLOADING)

    def loads_up(self) -> list[int]:
        """Return the loads that are carried or unloaded."""
        return [task for task in self._open if self.is_up(task)]

    def who_serves(self, task: int) -> Robots:
        """Return the robots that serve a task now; nobody if it is not served."""
        return self._with.get(task, ())

    def go_on(
        self,
        mission: Mission,
        teams: Teams,
        step: Step,
        number: int,
        ended: Iterable[int],
        taken: Iterable[tuple[int, int]],
    ) -> None:
        """Go on to the end of a step; `teams` are those of its end.

        `ended` are tasks that were called off and loads that were set down, `taken` loads that were
        taken up, by which team.
        """
        self._doing = {task: self.rows[row].doing for task, row in self._open.items()}
        self.under_way, self.turned = set(self._open), {self.rows[k].task for k in self.changed}
        self.changed, self.touched = [], set()
        for task in sorted(ended):
            self._end(task, number)
        for task, robots in step.served:
            if not robots:
                self._end(task, number)
            elif task in self._open:
                self._serve(task, robots)
            else:
                is_load = mission.tasks[task].to is not None
                self._begin(task, LOADING if is_load else SERVING, number, robots, teams)
        for task, slot in taken:
            robots = teams.robots[slot]
            if task not in self._open:
                self._begin(task, LOADING, number, robots, teams)
            self._go_over(task, CARRYING, number, robots, teams)
        for task in step.unloads:
            self._go_over(task, UNLOADING, number, self._with.get(task, ()), teams)
        for task, doer in step.done:
            robots = teams.doers(doer)
            if task not in self._open:
                self._begin(task, SERVING, number, robots, teams)
            self._serve(task, robots or self._with[task])
            self._end(task, number)

    def _begin(self, task: int, doing: str, number: int, robots: Robots, teams: Teams) -> None:
        self._open[task] = len(self.rows)
        self.changed.append(len(self.rows))
        slot = robots[0] if robots and teams.robots.get(robots[0]) == robots else None
        self.rows.append(ToldService(task, doing, number, None, robots, (), slot))
        self._serve(task, robots)

    def _serve(self, task: int, robots: Robots) -> None:
        """Let a service go on with some robots."""
        self.touched.update(self._with.get(task, ()), robots)
        self._with[task] = robots

    def _go_over(self, task: int, doing: str, number: int, robots: Robots, teams: Teams) -> None:
        """Let a load be carried that was loaded, or unloaded that was carried."""
        self._serve(task, robots)
        self._end(task, number)
        self._begin(task, doing, number, robots, teams)

    def _end(self, task: int, number: int) -> None:
        """End a service, if there is one."""
        if task not in self._open:
            return
        row = self._open.pop(task)
        if row not in self.changed:
            self.changed.append(row)
        self.rows[row] = self.rows[row]._replace(ended=number, robots=self._with[task])
        self._serve(task, ())
        del self._with[task]
