"""Who does each task by the plans of a record, and that every team goes by it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from teamformer.record.record import Record
from teamformer.record.referee.rules.completion import Tasks
from teamformer.record.referee.rules.teams import Fleet
from teamformer.record.referee.rules.verdict import Notes


class PlannedTasks:
    """Who does each task, and in which order, by the plans that the record has step by step."""

    def __init__(self, record: Record) -> None:
        self.mission = record.true_mission
        self.decide = _is_followed(record)
        self._plans = dict(record.plans)
        self._scouts = {steps: dict(scouts) for steps, scouts in record.scouts}
        self._looks: dict[int, int] = {}  # the task that a robot looks at first
        self._took = [step.took for step in record.steps]
        self._routes: dict[int, list[int]] = {}  # each robot's tasks in the plan's order
        self._orders = dict(record.orders)
        self._rank: dict[int, int] = {}

    def looked_at(self) -> set[int]:
        """Return the tasks that scouts look at."""
        return set(self._looks.values())

    def begin_step(self, steps_made: int) -> None:
        """Take over the plan that holds in the next step, and what robots have exchanged of it."""
        if steps_made in self._plans:
            order = self._orders.get(steps_made, ())
            self._rank = {task: i for i, task in enumerate(order)}
            made = self._plans[steps_made].coalitions
            self._routes = {}
            for task, coalition in dict(zip(order, made, strict=False)).items():
                for robot in coalition:
                    self._routes.setdefault(robot, []).append(task)
            self._looks = dict(self._scouts.get(steps_made, {}))
        elif steps_made > 0:
            self._exchange_parts(self._took[steps_made - 1])

    def give_tasks(self, fleet: Fleet, tasks: Tasks, steps_made: int) -> None:
        """Write each team's `due`, before teams form in a step and again before they walk.

        It is the earliest of its robots' next tasks.
        """
        if not fleet.is_coordinated:
            return
        next_of = self.next_tasks(fleet, tasks, steps_made)
        for team in fleet.teams.values():
            robots = () if team.services else team.robots
            found = (task for robot in robots if (task := next_of[robot]) is not None)
            team.due = next(iter(self.in_order(found)), None)

    def next_tasks(self, fleet: Fleet, tasks: Tasks, steps_made: int) -> dict[int, int | None]:
        """Return each robot's next task: what it looks at first, or the first open one it has."""
        return {
            robot: self._next_task(robot, tasks, steps_made)
            for team in fleet.teams.values()
            for robot in team.robots
        }

    def _next_task(self, robot: int, tasks: Tasks, steps_made: int) -> int | None:
        looks = (self._looks[robot],) if robot in self._looks else ()
        route = (*looks, *self._routes.get(robot, ()))
        return next((task for task in route if tasks.is_open(task, steps_made)), None)

    def in_order(self, tasks: Iterable[int]) -> list[int]:
        """Return tasks once each, in the plan's order."""
        return sorted(set(tasks), key=lambda task: self._rank.get(task, 0))

    def tasks_of_unions(
        self, fleet: Fleet, pairs: Sequence[tuple[int, int]]
    ) -> dict[frozenset[int], int | None]:
        """Return the tasks of teams that join on their way: the earlier, if both have one."""
        unions = {}
        for pair in pairs:
            teams = [fleet.teams[slot] for slot in pair if slot in fleet.teams]
            dues = [team.due for team in teams if team.due is not None]
            robots = frozenset(robot for team in teams for robot in team.robots)
            earliest = min(dues, key=lambda task: self._rank.get(task, 0), default=None)
            unions[robots] = earliest if len(dues) == 2 else None
        return unions

    def give_unions(self, fleet: Fleet, unions: dict[frozenset[int], int | None]) -> None:
        """Write down what teams are due to do that have joined on their way."""
        for team in fleet.teams.values():
            team.due = unions.get(frozenset(team.robots), team.due)

    def _exchange_parts(self, took: Sequence[tuple[int, int]]) -> None:
        for pair in took:
            one, other = pair
            routes = self._routes.pop(one, []), self._routes.pop(other, [])
            self._routes[other], self._routes[one] = routes
            looks = {one: self._looks.pop(other, None), other: self._looks.pop(one, None)}
            self._looks |= {robot: task for robot, task in looks.items() if task is not None}

    def check_exchanges(
        self, fleet: Fleet, took: Sequence[tuple[int, int]], number: int, notes: Notes
    ) -> None:
        """Check after a step that like robots of one team exchanged parts of a plan that holds on.

        Whether they had to is not judged: if not, or if others had to, teams split otherwise.
        """
        made_anew = number in self._plans
        robots = [robot for pair in took for robot in pair]
        is_in_order = list(took) == sorted(took) and len(set(robots)) == len(robots)
        if took and (made_anew or not fleet.is_coordinated or not is_in_order):
            notes.note("robots exchange parts of no plan, or twice, or not in order")
        for one, other in took:
            of, to = (self.mission.robots[robot] for robot in (one, other))
            teams = [team for team in fleet.teams.values() if {one, other} <= team.robots]
            is_like = (of.can, of.speed, of.flies) == (to.can, to.speed, to.flies) and one < other
            if not is_like or not teams or teams[0].services:
                notes.note(
                    f"robots {of.name} and {to.name} exchange parts of the plan, and may not"
                )


def _is_followed(record: Record) -> bool:
    """Say whether teams decide by plans: some robots have a task, and no decision names one."""
    has_coalitions = any(any(plan.coalitions) for _, plan in record.plans)
    return has_coalitions and not any(step.named for step in record.steps)


def check_assignments(
    fleet: Fleet, tasks: Tasks, steps_made: int, is_news: bool, notes: Notes
) -> None:
    """Check after a step that each team heads for the task that it is due to do, or named.

    Everybody is free after news (a loss, a return, needs that became known, a task that is
    elsewhere) and when tasks appear, except from a task being served.
    """
    if not fleet.is_coordinated:
        return
    is_news = is_news or steps_made in tasks.arrivals()
    for _, team in sorted(fleet.teams.items()):
        due = None if team.due is not None and tasks.over_in(team.due) else team.due
        if is_news and due not in team.services:
            due = None
        if not team.is_named and not team.was_serving and team.task != due:
            goes, should = (_name(fleet, task) for task in (team.task, due))
            notes.note(f"{fleet.name(team)} heads for {goes}; by the plan it is {should}")


def _name(fleet: Fleet, task: int | None) -> str:
    return "nothing" if task is None else f"task {fleet.mission.tasks[task].name}"
