"""A mission in continuous time as it runs: who may begin what, and when a plan is asked for.

What is physically so is for the world. Here is what plans and rules say of it: a task begins when
its whole coalition stands there with nothing else to do first, has formed, and release, precedence
and links allow it.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Iterable, Sequence
from dataclasses import replace

from teamformer.base.kernels.clock import working_seconds
from teamformer.mission.arrivals import with_arrivals
from teamformer.mission.checks.windows import release_of
from teamformer.mission.coordination import IDLE, TAKEN_OVER, Coordinator, Known, Plan, heeded_by
from teamformer.mission.model import Mission
from teamformer.mission.precedence import tasks_before
from teamformer.world.continuous.another_truth import under
from teamformer.world.continuous.events import PlanMade, PlannedTask
from teamformer.world.continuous.following import PlanFollower
from teamformer.world.continuous.foresight import foresee, holds_of
from teamformer.world.continuous.hopeless import blocked_tasks, gives_up, has_failed, misses
from teamformer.world.continuous.known import known_of
from teamformer.world.continuous.links import GapKeeper, followers
from teamformer.world.continuous.moving import Happened
from teamformer.world.continuous.world import PhysicalWorld
from teamformer.world.guidance.guide import refuse_unfit
from teamformer.world.rules.constants import NOBODY

COMPLETED, INFEASIBLE, LIMIT, TOO_LATE = "completed", "infeasible", "step limit", "too late"
RUNNING = "running"


class Course:
    """A mission from its start to its end, moment by moment.

    `seconds` is what the coordinator took; `status` is RUNNING or how the mission ended. If a
    coordinator `is_told_all`, tasks that will appear are known from the start, and wait for that.
    """

    def __init__(
        self, mission: Mission, truth: Mission, coordinator: Coordinator, is_told_all: bool = False
    ) -> None:
        mission = with_arrivals(mission, truth)
        self.mission, self.coordinator = mission, coordinator
        self.world = PhysicalWorld(mission, truth, is_told_all)
        self.follower = PlanFollower(mission)
        self.plans: tuple[tuple[float, Plan], ...] = ()  # all that were made, and when
        self.status, self.blocked = RUNNING, tuple[int, ...]()
        self.seconds = 0.0
        self._heeds = {"start", IDLE, *heeded_by(coordinator)}
        self._before = tasks_before(mission.tasks)
        self._after = followers(mission)
        self.links = GapKeeper(mission)
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
        twin._before, twin._after = tasks_before(twin.mission.tasks), followers(twin.mission)
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
        elif not self.world.is_busy and not self._waits_for_a_time():
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
        looked_at = set(tasks)
        looked_at |= {self._send(robot) for robot in robots} - {NOBODY}
        while looked_at:
            looked_at = self._waiting_for(self._let_begin(looked_at))

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
            if coming.issuperset(self._before.get(task, ())):
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
        cause = world.cause_among([body.since, self._plan_now()])
        if world.charges_first(robot, task, goal, cause):
            return NOBODY
        is_new = task != body.task
        if (
            is_new
            or (goal is None and body.is_walking)
            or (goal and not self._is_bound(robot, goal))
        ):
            world.set_out(robot, goal, task, cause)
        return task

    def _is_bound(self, robot: int, goal: object) -> bool:
        """Say whether a robot is where it is to go, or on its way there."""
        return self.world.bodies[robot].way[-1].place == goal

    def _plan_now(self) -> int:
        """Return the event of the plan if it has come into force at this moment."""
        event = self.follower.event
        is_now = event != NOBODY and self.world.events[event].at == self.world.now
        return event if is_now else NOBODY

    def _team(self, task: int) -> tuple[int, ...]:
        """Return the robots of a task's coalition that are not lost."""
        robots = self.follower.robots_of.get(task, ())
        return tuple(robot for robot in robots if not self.world.bodies[robot].is_lost)

    def _is_complete(self, task: int) -> bool:
        """Say whether a task is open, and its team stands there and brings what it really needs."""
        world = self.world
        if task in world.over or task in world.works or task not in world.appeared:
            return False
        team, place = self._team(task), world.place_of(task)
        if task in world.maybe:
            return False
        is_there = all(
            world.is_at(robot, place) and self.follower.next_task(world, robot) == task
            for robot in team
        )
        is_able = world.covers(team, task) and world.can_carry(team, task)
        return bool(team) and is_there and is_able

    def _let_begin(self, tasks: Iterable[int]) -> list[int]:
        """Let those of some tasks form or begin that may; return those that have begun."""
        complete = [task for task in sorted(tasks) if self._is_complete(task)]
        complete = [task for task in complete if not misses(self.world, task, self._team(task))]
        ready = [task for task in complete if not self._forms(task) and self._is_released(task)]
        began = self.links.free(self.world, ready)
        for task in began:
            self._serve(task)
        return began

    def _forms(self, task: int) -> bool:
        """Let a team form that has not, if that fits into its shifts; say whether it had to."""
        world, team = self.world, self._team(task)
        if not self.mission.forming or len({world.bodies[r].came_from for r in team}) == 1:
            return False
        since = [world.bodies[robot].since for robot in team]
        if world.when_forms(team) == world.now:
            world.form(task, team, world.cause_among([*since, self._plan_now()]))
        return True

    def _is_released(self, task: int) -> bool:
        """Say whether a task may begin, but for links of its start."""
        world = self.world
        is_open = release_of(world.truth.tasks[task]) <= world.now
        is_ready = is_open and world.over.keys() >= set(self._before.get(task, ()))
        return is_ready and world.when_fits(task, self._team(task)) == world.now

    def _serve(self, task: int, is_held: bool = True) -> None:
        """Have a task served by its team; what it has waited for last is the cause.

        If that is none of what is physically so, it `is_held` by a link of its start.
        """
        world, team = self.world, self._team(task)
        causes = [world.bodies[robot].since for robot in team]
        causes += [world.over[other] for other in self._before.get(task, ())]
        causes += [*self._opened(task), self._plan_now()]
        is_held = is_held and task in self.links.linked
        if is_held and world.events[max(causes)].at < world.now:
            cause = self.links.cause(world, task, self.follower.robots_of)
            cause = self.follower.event if cause == NOBODY else cause  # the plan has foreseen it
            causes.append(world.tell("opens", (), task, cause))
        world.serve(task, team, world.cause_among(causes))

    def _opened(self, task: int) -> Iterable[int]:
        """Return the events of this moment that let a task begin or be known."""
        events = self.world.events
        number = len(events) - 1
        while number >= 0 and events[number].at == self.world.now:
            if events[number].task == task and events[number].kind in ("opens", "appear"):
                yield number
            number -= 1

    def _waits_for_a_time(self) -> bool:
        """Say whether a team that is complete waits for a time that will come."""
        now = self.world.now
        return any(
            release_of(self.world.truth.tasks[task]) > now
            or self.links.holds.get(task, now) > now
            or now < self.world.when_fits(task, self._team(task)) < math.inf
            for task in self.follower.order
            if self._is_complete(task)
        )

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
        if self.world.is_busy or self._waits_for_a_time() or not self.is_running:
            return
        if self._gives_up(is_asked=True):
            return
        for task in self.follower.order:
            if self._is_complete(task) and self._is_released(task):
                self._serve(task, is_held=False)  # nobody can keep the link any more
                return
        if self._is_over():
            self._end(COMPLETED)
        elif self.world.next_time > self.mission.step_limit:
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
