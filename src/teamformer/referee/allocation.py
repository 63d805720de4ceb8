"""Plans: that each task is for robots that can do it, and that every team goes by them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from teamformer.capabilities import Counts, covers, total
from teamformer.model import Scenario
from teamformer.referee.completion import Tasks
from teamformer.referee.finding import Search
from teamformer.referee.teams import Fleet, RecordedTeam
from teamformer.referee.truth import Knowledge
from teamformer.referee.verdict import Notes
from teamformer.sim.replay.record import Replay, SharedPlanMade


class PlannedTasks:
    """Who does each task, and in which order, by the plans that the record has step by step."""

    def __init__(self, replay: Replay) -> None:
        self.scenario = replay.mission
        self.is_coordinated = replay.is_coordinated
        self._plans = dict(replay.plans)
        self._scouts = {steps: dict(scouts) for steps, scouts in replay.scouts}
        self._looks: dict[int, int] = {}  # the task that a robot looks at first
        self._took = [step.took for step in replay.steps]
        self._coalition: dict[int, set[int]] = {}
        self._orders = dict(replay.orders)
        self._rank: dict[int, int] = {}

    def looked_at(self) -> set[int]:
        """Return the tasks that scouts look at."""
        return set(self._looks.values())

    def give_tasks(self, fleet: Fleet, tasks: Tasks, steps_made: int) -> None:
        """Write each team's `due`, once all have formed in a step and before they walk.

        It is the first open task that has one of its robots in its coalition; or what one of them
        looks at first.
        """
        if not self.is_coordinated:
            return
        if steps_made in self._plans:
            order = self._orders.get(steps_made, ())
            self._rank = {task: i for i, task in enumerate(order)}
            made = self._plans[steps_made].coalitions
            self._coalition = {task: set(c) for task, c in zip(order, made, strict=False)}
            self._looks = dict(self._scouts.get(steps_made, {}))
        elif steps_made > 0:
            self._exchange_parts(self._took[steps_made - 1])
        for team in fleet.teams.values():
            team.was_serving = bool(team.services)
            found = [] if team.services else list(self._next_tasks(team, tasks, steps_made))
            team.due = min(found, key=lambda task: self._rank.get(task, 0), default=None)

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
            for coalition in self._coalition.values():
                coalition ^= set(pair) if len(coalition & set(pair)) == 1 else set()
            one, other = pair
            looks = {one: self._looks.pop(other, None), other: self._looks.pop(one, None)}
            self._looks |= {robot: task for robot, task in looks.items() if task is not None}

    def _next_tasks(self, team: RecordedTeam, tasks: Tasks, steps_made: int) -> Iterator[int]:
        open_now = [task for task in self._coalition if tasks.is_open(task, steps_made)]
        for robot in team.robots:
            if robot in self._looks:
                yield self._looks[robot]
                continue
            yield from [task for task in open_now if robot in self._coalition[task]][:1]


def check_assignments(
    fleet: Fleet,
    tasks: Tasks,
    lists: PlannedTasks,
    named: Sequence[int],
    steps_made: int,
    is_news: bool,
    notes: Notes,
) -> None:
    """Check after a step that each team heads for the task that it is due to do, or named.

    Everybody is free after news (a loss, a return, needs that became known, a task that is
    elsewhere) and when tasks appear, except from a task being served.
    """
    if not lists.is_coordinated:
        return
    is_news = is_news or steps_made in tasks.openings()
    for slot, team in sorted(fleet.teams.items()):
        due = None if team.due in tasks.done else team.due
        if is_news and due not in team.services:
            due = None
        if slot not in named and not team.was_serving and team.task != due:
            goes, should = (_name(fleet, task) for task in (team.task, due))
            notes.note(f"{fleet.name(team)} heads for {goes}; by the plan it is {should}")


def _name(fleet: Fleet, task: int | None) -> str:
    return "nothing" if task is None else f"task {fleet.scenario.tasks[task].name}"


def judge_plans(
    replay: Replay, tasks: Tasks, knowledge: Knowledge, search: Search, notes: Notes
) -> None:
    """Check that plans are made when they must be, for robots that can do what they are to do."""
    shown = knowledge.shown_after | search.news_after
    orders = dict(replay.orders)
    if replay.is_coordinated:
        _check_moments(replay, tasks, {steps for steps, _ in replay.plans}, shown, notes)
    for steps, plan in replay.plans:
        _check_plan(replay, knowledge, steps, plan, orders.get(steps, ()), notes)
    for steps, scouts in replay.scouts:
        _check_scouts(replay, knowledge, search, steps, scouts, orders.get(steps, ()), notes)


def _robots_left(scenario: Scenario, steps: int) -> set[int]:
    return {
        number
        for number, robot in enumerate(scenario.robots)
        if not any(
            away.lost <= steps < (steps + 1 if away.back is None else away.back)
            for away in robot.absences
        )
    }


def _check_moments(
    replay: Replay, tasks: Tasks, made: set[int], shown: set[int], notes: Notes
) -> None:
    """Check that plans are made at the start, for new tasks and needs, losses, returns."""
    scenario, last = replay.mission, len(replay.steps) - 1
    changes = ((away.lost, away.back) for robot in scenario.robots for away in robot.absences)
    news = {steps for pair in changes for steps in pair if steps is not None}
    for steps in sorted({0, *tasks.openings(), *news, *shown} - made):
        if steps <= last and tasks.open_after(steps):
            notes.note(f"there is no plan from after {steps} steps")


def _check_plan(
    replay: Replay,
    knowledge: Knowledge,
    steps: int,
    plan: SharedPlanMade,
    order: Sequence[int],
    notes: Notes,
) -> None:
    when, left = f"the plan made after {steps} steps", _robots_left(replay.mission, steps)
    if len(plan.coalitions) != len(order):
        notes.note(f"{when} has {len(plan.coalitions)} coalitions for {len(order)} open tasks")
    for task, coalition in zip(order, plan.coalitions, strict=False):
        name, needs = replay.scenario.tasks[task].name, knowledge.needs(task, steps)
        if len(set(coalition)) != len(coalition) or not set(coalition) <= left:
            notes.note(f"{when} has a robot twice or one that is lost in the coalition of {name}")
        if coalition and not _can_do(replay, coalition, task, needs):
            notes.note(f"{when} has a coalition for task {name} that cannot do it")


def _check_scouts(
    replay: Replay,
    knowledge: Knowledge,
    search: Search,
    steps: int,
    scouts: Sequence[tuple[int, int]],
    order: Sequence[int],
    notes: Notes,
) -> None:
    """Check that robots that are left look, each at an open task that is not all known."""
    when, left = f"the plan made after {steps} steps", _robots_left(replay.mission, steps)
    robots = [robot for robot, _ in scouts]
    if steps not in dict(replay.plans):
        notes.note(f"the record has scouts from after {steps} steps, when no plan was made")
    if len(set(robots)) != len(robots) or not set(robots) <= left:
        notes.note(f"{when} has a scout twice or one that is lost")
    for _, task in scouts:
        is_known = knowledge.is_shown(task, steps) and search.is_found(task, steps)
        if task not in order or is_known:
            name = replay.scenario.tasks[task].name
            notes.note(f"{when} has somebody look at task {name}, of which all is known")


def _can_do(replay: Replay, numbers: Iterable[int], task: int, needs: Counts) -> bool:
    world, at = replay.mission.world, replay.mission.tasks[task].at
    robots = (replay.scenario.robots[robot] for robot in numbers)
    near = (robot.can for robot in robots if world.region(robot.at) == world.region(at))
    return covers(total(near), needs)
