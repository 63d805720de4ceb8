"""A mission in continuous time as it runs: when a plan is asked for, and who goes where by it.

What is physically so is for the world, which tasks begin is for `TaskStarts`.
"""

from __future__ import annotations

import copy
from collections.abc import Iterable, Sequence
from dataclasses import replace

from teamformer.base.kernels.clock import working_seconds
from teamformer.mission.arrivals import with_arrivals
from teamformer.mission.coordination import IDLE, TAKEN_OVER, Coordinator, Known, Plan, heeded_by
from teamformer.mission.model import Mission
from teamformer.mission.parts.zones import rooms_of
from teamformer.mission.precedence import tasks_before
from teamformer.world.continuous.another_truth import under
from teamformer.world.continuous.events import PlanMade, PlannedTask
from teamformer.world.continuous.foresight import foresee, holds_of
from teamformer.world.continuous.hopeless import blocked_tasks, gives_up, has_failed
from teamformer.world.continuous.known import known_of
from teamformer.world.continuous.links import followers
from teamformer.world.continuous.moving import Happened
from teamformer.world.continuous.starting import TaskStarts
from teamformer.world.guidance.guide import refuse_unfit
from teamformer.world.rules.constants import NOBODY

COMPLETED, INFEASIBLE, LIMIT, TOO_LATE = "completed", "infeasible", "step limit", "too late"
RUNNING = "running"


class Course(TaskStarts):
    """A mission from its start to its end, moment by moment.

    `seconds` is what the coordinator took; `status` is RUNNING or how the mission ended. If a
    coordinator `is_told_all`, tasks that will appear are known from the start, and wait for that.
    """

    def __init__(
        self, mission: Mission, truth: Mission, coordinator: Coordinator, is_told_all: bool = False
    ) -> None:
        super().__init__(with_arrivals(mission, truth), truth, is_told_all)
        self.coordinator = coordinator
        self.plans: tuple[tuple[float, Plan], ...] = ()  # all that were made, and when
        self.status, self.blocked = RUNNING, tuple[int, ...]()
        self.seconds = 0.0
        self._heeds = {"start", IDLE, *heeded_by(coordinator)}
        self._after = followers(self.mission)
        self._asked_idle = NOBODY

    def fork(self) -> Course:
        """Return another course with the same past that goes its own way."""
        twin = copy.copy(self)
        twin.world, twin.follower = self.world.fork(), self.follower.fork()
        twin.links = self.links.fork()
        return twin

    def under(self, mission: Mission, truth: Mission) -> Course:
        """Return a fork to which from now on happens what another truth says, as the world has it.

        So something befalls a mission that runs, and so it goes on in one of several futures.
        """
        twin = self.fork()
        twin.mission = with_arrivals(mission, truth)
        twin.world = under(self.world, twin.mission, truth)
        twin.follower = self.follower.fork(twin.mission)
        twin.before, twin._after = tasks_before(twin.mission.tasks), followers(twin.mission)
        twin.has_rooms = bool(rooms_of(twin.mission))
        return twin

    @property
    def is_running(self) -> bool:
        """Say whether the mission is not over."""
        return self.status == RUNNING

    def begin(self) -> None:
        """Let the first plan be made, and do what follows at once."""
        for robot in range(len(self.mission.robots)):
            self.world.sense(robot)
        happened = self.world.take_happened()
        happened.news = {"start": None}  # what is seen at once is known to the first plan
        self._act(happened)

    def go_on(self) -> None:
        """Go to the next moment and do what follows."""
        if self.world.next_time > self.mission.step_limit:
            self.world.be_at(max(self.world.now, float(self.mission.step_limit)))
            self._end(LIMIT)
            return
        self._act(self.world.advance())

    def go_until(self, when: float) -> None:
        """Let time pass, for as long as the mission runs."""
        while self.is_running and min(self.world.next_time, self.mission.step_limit) <= when:
            self.go_on()
        if self.is_running:
            self.world.be_at(when)

    def take_over(self, plan: Plan) -> None:
        """Go by a plan that an operator has chosen."""
        known = self.known((TAKEN_OVER,))
        self._follow(plan, known)
        self._command(range(len(self.mission.robots)), ())

    def break_off(self, status: str) -> None:
        """End the mission as it stands."""
        if self.is_running:
            self._end(status)

    def rest(self) -> Plan:
        """Return what is left of the plan in force."""
        return self.follower.rest(self.world)

    def known(self, news: tuple[str, ...] = ()) -> Known:
        """Return what everybody knows now."""
        return known_of(self.world, news)

    def _act(self, happened: Happened) -> None:
        """Do what follows from what has happened at this moment."""
        if "robot lost" in happened.news and self._is_blocked():
            return
        while happened:
            self._tend(happened)
            happened = self.world.take_happened()  # what it has brought about at this moment
        self.world.fill_chargers()
        if has_failed(self.world):
            self._end(TOO_LATE)
        elif self._is_over():
            self._end(COMPLETED)
        elif not self.world.is_busy and not self.waits_for_a_time():
            self._idle()

    def _tend(self, happened: Happened) -> None:
        """Have a plan made where there is news, send robots, and let tasks begin."""
        heard = tuple(word for word in happened.news if self._is_heeded(word, happened))
        if heard:
            self._plan(heard)
        elif self.links.gaps and (happened.news or self.links.is_off(self.world, happened.tasks)):
            self._hold_links()
        is_for_all = heard or happened.tasks & self.world.over.keys()
        robots = range(len(self.mission.robots)) if is_for_all else sorted(happened.robots)
        self._command(robots, happened.tasks | self._waiting_for(happened.tasks))

    def _command(self, robots: Iterable[int], tasks: Iterable[int]) -> None:
        """Send robots where they are to go, and let tasks begin that may."""
        looked_at = set(tasks) | self._waiting_for(self.let_unload())
        looked_at |= {self._send(robot) for robot in robots} - {NOBODY}
        while looked_at:
            looked_at = self._waiting_for(self.let_begin(looked_at))

    def _waiting_for(self, tasks: Iterable[int]) -> set[int]:
        """Return the tasks that may wait for the start or the end of some."""
        return {other for task in tasks for other in self._after.get(task, ())}

    def _is_heeded(self, word: str, happened: Happened) -> bool:
        """Say whether the coordinator is asked after some news.

        That a service is overdue is news only if somebody waits for its end.
        """
        if word not in self._heeds:
            return False
        if word != "service overdue":
            return True
        return any(self._is_waited_for(task) for task in happened.tasks & self.world.works.keys())

    def _is_waited_for(self, task: int) -> bool:
        """Say whether tasks come after one, or its robots have others to do."""
        follower, over = self.follower, self.world.over
        if self._after.get(task, set()) - over.keys():
            return True
        doers = set(self.world.works[task].robots)
        left = (other for other in follower.order if other not in over and other != task)
        return any(doers.intersection(follower.robots_of[other]) for other in left)

    def _plan(self, news: tuple[str, ...]) -> None:
        """Ask for a plan and go by it."""
        known = self.known(news)
        old = None if self.follower.plan is None else self.rest()
        asked = working_seconds()
        plan = self.coordinator.update(known, old)
        self.seconds += working_seconds() - asked
        self._follow(plan, known)

    def _follow(self, plan: Plan, known: Known) -> None:
        """Go by a plan that was made because of the news of a moment."""
        refuse_unfit(known, plan)
        coalitions = tuple(tuple(sorted(robots)) for robots in plan.coalitions)
        plan, world = replace(plan, why=known.news, coalitions=coalitions), self.world
        ends = plan.ends or (None,) * len(plan.order)
        rows = map(PlannedTask, plan.order, plan.coalitions, ends)
        cause = NOBODY if not world.events else world.cause_among([])
        made = PlanMade(known.news, tuple(rows))
        self.follower.take(plan, world.tell("plan", (), NOBODY, cause, plan=made))
        self.plans = (*self.plans, (world.now, plan))
        if self.links.gaps:
            self._hold_links(known)

    def _hold_links(self, known: Known | None = None) -> None:
        """Work out from when on linked tasks may begin."""
        known = self.known() if known is None else known
        open_tasks, there = set(known.open_tasks), set(known.robots)
        order = [task for task in self.follower.order if task in open_tasks]
        robots_of = {
            task: [robot for robot in self.follower.robots_of[task] if robot in there]
            for task in order
        }
        order = self._in_turn([task for task in order if robots_of[task]], known)
        timed = foresee(known, self.world.ways, order, robots_of)
        before = self.links.holds
        self.links.foresee(timed, holds_of(known, timed))
        for task, at in self.links.holds.items():
            if at > self.world.now and at != before.get(task):
                self.world.wake(at, task)

    def _in_turn(self, order: Sequence[int], known: Known) -> list[int]:
        """Return the tasks of an order without those that come after one that nobody is to do."""
        coming = {*known.over, *(task for task, _ in known.under_way)}
        kept = []
        for task in order:
            if coming.issuperset(self.before.get(task, ())):
                coming.add(task)
                kept.append(task)
        return kept

    def _send(self, robot: int) -> int:
        """Send a robot to its next task; return that task."""
        world, follower, body = self.world, self.follower, self.world.bodies[robot]
        if body.is_lost or body.work != NOBODY or body.is_charging:
            return NOBODY
        task = follower.next_task(world, robot)
        goal = follower.goal(world, robot, task)
        cause = world.cause_among([body.since, self.plan_now()])
        if world.charges_first(robot, task, goal, cause):
            return NOBODY
        is_elsewhere = body.is_walking if goal is None else not self._is_bound(robot, goal)
        if task != body.task or is_elsewhere:
            world.set_out(robot, goal, task, cause)
        return task

    def _is_bound(self, robot: int, goal: object) -> bool:
        """Say whether a robot is where it is to go, or on its way there."""
        return self.world.bodies[robot].way[-1].place == goal

    def _idle(self) -> None:
        """Do something about it that nobody has anything to do: ask for a plan, else drop links.

        Optional tasks that no plan wants are given up.
        """
        if self._gives_up(is_asked=False):
            return
        events = len(self.world.events)
        if self._asked_idle != events:
            self._plan((IDLE,))
            self._asked_idle = len(self.world.events)
            self._tend(Happened(robots=set(range(len(self.mission.robots)))))
            self._asked_idle = len(self.world.events)
        if self.world.is_busy or self.waits_for_a_time() or not self.is_running:
            return
        if self._gives_up(is_asked=True):
            return
        for task in self.follower.order:
            has_formed = self.is_complete(task) and not self.has_to_form(task)
            if has_formed and self.is_released(task):
                self.serve(task, is_held=False)  # nobody can keep the link any more
                return
        if self._is_over():
            self._end(COMPLETED)
        elif self.world.next_but_shifts > self.mission.step_limit:
            tasks = range(len(self.world.truth.tasks))
            self.blocked = tuple(task for task in tasks if task not in self.world.over)
            if self.blocked:  # else somebody does not get home
                self._end(INFEASIBLE)

    def _gives_up(self, is_asked: bool) -> bool:
        """Let what is left be missed if it is optional and nobody will do it; say whether it was.

        If the coordinator has not been asked, only what the plan in force leaves out.
        """
        planned = set(self.follower.order) - self.world.over.keys()
        if (not is_asked and (planned or self.mission.has_surprises)) or not gives_up(self.world):
            return False
        self._tend(self.world.take_happened())
        if self._is_over():
            self._end(COMPLETED)
        return True

    def _is_over(self) -> bool:
        """Say whether all tasks are over, and all robots where the mission ends."""
        world = self.world
        if len(world.over) < len(world.truth.tasks):
            return False
        return all(self.follower.is_home(world, robot) for robot in range(len(world.bodies)))

    def _is_blocked(self) -> bool:
        """Say whether robots are lost without whom some task is never done; then all is over."""
        self.blocked = blocked_tasks(self.world)
        if self.blocked:
            self._end(INFEASIBLE)
        return bool(self.blocked)

    def _end(self, status: str) -> None:
        self.status = status
        cause = self.world.cause_among([body.since for body in self.world.bodies])
        self.world.tell("over", (), NOBODY, cause, status=status)
