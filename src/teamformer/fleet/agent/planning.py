"""The plan that a robot follows, when it makes a new one, and what is next on it."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from teamformer.fleet.agent.knowledge import NEVER, Knowledge
from teamformer.fleet.agent.membership import Membership
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.in_shifts import can_still_do, who_can
from teamformer.fleet.messages import SERVE, PlanNote, TaskFact, Terms
from teamformer.fleet.planner import FleetPlanner, FleetSituation, Stop
from teamformer.mission.precedence import keep_precedence
from teamformer.world.rules.constants import NOBODY

IN_TIME = 0.5
"""Seconds by which a shift has to be longer than a task in it, as robots begin late.

If it is not, the task is for others."""


@dataclass(frozen=True)
class FleetPlan:
    """Who does which task with whom, in what order; passed on as a value, never worked out twice.

    Any order whose coalitions are able cannot block: the coalition of the first open task is
    always on its way there.
    """

    note: PlanNote
    routes: dict[int, list[int]] = field(init=False)  # the tasks of each robot, in order
    version: tuple[int, int, int] = field(init=False)
    live: frozenset[int] = field(init=False)  # the robots that it counts on
    idle: frozenset[int] = field(init=False)  # the tasks that it does not mean to have done
    listed: frozenset[int] = field(init=False)  # all tasks that it thought of

    def __post_init__(self) -> None:
        note = self.note
        routes: dict[int, list[int]] = {}
        for key, coalition in zip(note.order, note.coalitions, strict=True):
            for robot in coalition:
                routes.setdefault(robot, []).append(key)
        idle = (note.left_out, note.given_up)
        text = repr((note.live, note.order, note.coalitions, *idle)).encode()
        digest = int.from_bytes(hashlib.blake2b(text, digest_size=8).digest(), "big") >> 2
        keep = object.__setattr__
        keep(self, "routes", routes)
        keep(self, "version", (note.epoch, note.maker, digest))
        keep(self, "live", frozenset(note.live))
        keep(self, "idle", frozenset((*note.left_out, *note.given_up)))
        keep(self, "listed", self.idle.union(note.order))

    @property
    def stops(self) -> tuple[tuple[int, tuple[int, ...]], ...]:
        """Return its tasks in order, each with who does it."""
        return tuple(zip(self.note.order, self.note.coalitions, strict=True))

    def coalition(self, key: int) -> tuple[int, ...]:
        """Return who does a task together; nobody if the plan has it not."""
        try:
            return self.note.coalitions[self.note.order.index(key)]
        except ValueError:
            return ()


def first_plan(mission: FleetMission, planner: FleetPlanner) -> FleetPlan:
    """Return plan 0, which every robot makes of the mission by itself before it starts."""
    tasks = tuple(task for task in mission.tasks if task.appears == 0)
    places = {robot: at.at for robot, at in enumerate(mission.source.robots)}
    return FleetPlan(make_plan(mission, planner, FleetSituation(places, tasks), 0, 0))


def make_plan(
    mission: FleetMission, planner: FleetPlanner, situation: FleetSituation, epoch: int, maker: int
) -> PlanNote:
    """Plan what can be done; tasks that the robots cannot do are left out and said so.

    So are those that come after such tasks, or after one that nobody knows yet. Tasks that may be
    missed are given up where others are worth more. A task that others come after may have been
    done by robots that are lost: somebody looks, after all else.
    """
    robots = tuple(sorted(situation.places))
    places = situation.places
    able = [task for task in situation.tasks if mission.can_do(robots, task, places)]
    able = [task for task in able if can_still_do(mission, task, places, situation.age)]
    able = _without_waiting(mission, able, situation.over)
    left_out = tuple(task.key for task in situation.tasks if task not in able)
    stops: Sequence[Stop] = ()
    if able:
        stops = planner.plan(mission, situation._replace(tasks=tuple(able)))
        stops = _by_who_is_able(mission, situation, stops)
        stops = _by_who_has_time(mission, situation, stops)
    planned = {key for key, _ in stops}
    given_up = tuple(task.key for task in able if task.key not in planned)
    who = dict([*stops, *_looks(mission, situation)])
    order = tuple(keep_precedence(list(who), mission.before))
    coalitions = tuple(who[key] for key in order)
    return PlanNote(epoch, maker, robots, order, coalitions, left_out, given_up)


def _by_who_is_able(
    mission: FleetMission, situation: FleetSituation, stops: Sequence[Stop]
) -> list[Stop]:
    """Return stops with others for those whose batteries do not last for a task, if any do.

    Missions promise that those of all do, but not where operators add tasks, or loads lie by now.
    """
    charging, places = mission.charging, situation.places
    if charging is None:
        return list(stops)
    tasks, found = {task.key: task for task in situation.tasks}, list[Stop]()
    for key, who in stops:
        able = [r for r in who if charging.is_able(r, tasks[key], mission.step)]
        if not mission.covers(able, tasks[key].needs):
            there = (r for r in places if mission.reach(r, tasks[key], places[r]))
            able = [r for r in there if charging.is_able(r, tasks[key], mission.step)]
        found.append((key, tuple(sorted(able))))
    return found


def _by_who_has_time(
    mission: FleetMission, situation: FleetSituation, stops: Sequence[Stop]
) -> list[Stop]:
    """Return stops with others for those whose shifts leave no time for a task, if there are any.

    Who is at work on it goes on until its shift is over.
    """
    if not mission.has_shifts:
        return list(stops)
    tasks, places, age = {it.key: it for it in situation.tasks}, situation.places, situation.age
    found = list[Stop]()
    for key, who in stops:
        is_at_work = situation.serving.get(key) == who
        is_at_work = is_at_work and all(mission.is_at_work(robot, age) for robot in who)
        has_time = is_at_work or mission.fits(tasks[key], who, age, IN_TIME) < NEVER
        others = () if has_time else who_can(mission, tasks[key], places, age, IN_TIME)
        found.append((key, others or who))
    return found


def _looks(mission: FleetMission, situation: FleetSituation) -> Iterable[Stop]:
    """Yield the tasks that robots cannot do and others come after, each with who is to look."""
    places = situation.places
    known = {task.key for task in situation.tasks}
    awaited = frozenset[int]().union(*(mission.before.get(key, ()) for key in known))
    for task in situation.tasks:
        if task.key in awaited and not mission.can_do(places, task, places):
            able = [robot for robot in sorted(places) if mission.reach(robot, task, places[robot])]
            away = {robot: mission.apart(places[robot], (task.x, task.y)) for robot in able}
            if able:
                yield task.key, (min(able, key=away.__getitem__),)


def _without_waiting(
    mission: FleetMission, tasks: Sequence[TaskFact], over: frozenset[int]
) -> list[TaskFact]:
    """Return the tasks that are after none but those that are over, or among them."""
    left = {task.key for task in tasks}
    while waiting := {key for key in left if mission.before.get(key, over) - over - left}:
        left -= waiting
    return [task for task in tasks if task.key in left]


class PlanKeeper:
    """Holds the newest plan, notices when it has to be made anew, and says what is next."""

    def __init__(self, knowledge: Knowledge, plan: FleetPlan, planner: FleetPlanner) -> None:
        self.plan = plan
        self.since = float("-inf")  # when the plan was made or taken
        self.dropped_at = float("-inf")  # when it last took one that counts on fewer robots
        self.made = 0
        self._knowledge = knowledge
        self._planner = planner
        self._reason_since: float | None = None
        self.changes = 0  # grows with every plan that is followed
        self._looked_at = -1, frozenset[int]()  # after what it last looked for a reason
        self._next = 0
        self._late = frozenset[int]()  # planned tasks that cannot begin any more, as it was planned
        self._is_short = False  # it has less in its battery than was believed
        self._looked = set[int]()  # tasks at which it has looked whether they are done

    def take(self, note: PlanNote, now: float) -> None:
        """Take a plan if it is larger than the own."""
        if (note.epoch, note.maker) < self.plan.version[:2]:
            return
        plan = FleetPlan(note)
        if plan.version > self.plan.version:
            self._follow(plan, now)

    def _follow(self, plan: FleetPlan, now: float) -> None:
        if self.plan.live - plan.live:
            self.dropped_at = now
        self.plan, self.since, self._next = plan, now, 0
        self._looked.clear()
        self._is_short = False
        self._late = self._too_late()
        self.changes += 1

    def _too_late(self) -> frozenset[int]:
        """Return the planned tasks whose robots' shifts leave no time for them any more.

        What robots are at work on has begun in time.
        """
        knowledge = self._knowledge
        if not knowledge.mission.has_shifts:
            return frozenset()
        begun = {word.goal for word in knowledge.words if word.phase == SERVE and not word.is_lost}
        left = knowledge.undone - begun
        open_stops = ((key, who) for key, who in self.plan.stops if key in left)
        return frozenset(key for key, who in open_stops if knowledge.begins(who, key) == NEVER)

    def note_shortage(self) -> None:
        """Note that this robot has less in its battery than was believed: it makes a new plan."""
        self._is_short = True
        self.changes += 1

    def note_look(self, key: int) -> None:
        """Note that this robot sees that a task is not done to which it only went to look."""
        if key in self.plan.note.left_out and key not in self._looked:
            self._looked.add(key)
            self.changes += 1

    def next_task(self, robot: int) -> int:
        """Return a robot's first task that is known here and not over, or NOBODY.

        Nor is it one at which this robot has looked in vain: then it is free to meet others. Nor
        one that would not end before the mission is over, or its robots' shifts are.
        """
        over, tasks = self._knowledge.over, self._knowledge.tasks
        route = self.plan.routes.get(robot, ())
        if robot == self._knowledge.me:
            while self._next < len(route) and route[self._next] in over:
                self._next += 1
        begin = self._next if robot == self._knowledge.me else 0
        for place in range(begin, len(route)):
            key = route[place]
            has_looked = robot == self._knowledge.me and key in self._looked
            if key not in tasks or key in over or has_looked:
                continue
            if self._knowledge.begins(self.plan.coalition(key), key) < NEVER:
                return key
        return NOBODY

    def plan_at(self, now: float, membership: Membership) -> float:
        """Return when this robot makes a new plan, if nobody else has made one; inf for never.

        Robots with lower numbers go first; a new plan holds for a while in any case.
        """
        self._look(now, membership)
        if self._reason_since is None:
            return float("inf")
        timers, me = membership.timers, self._knowledge.me
        ahead = sum(r < me and membership.is_near(r, now) for r in membership.live())
        begin = max(self._reason_since, self.since + timers.rest)
        return begin + (timers.settle + timers.turn * ahead) * membership.stretch

    def make(
        self, membership: Membership, place: tuple[float, float], now: float, age: float
    ) -> None:
        """Make a new plan for those that are live, from where they are; `age` is the mission's."""
        knowledge, words = self._knowledge, self._knowledge.words
        live = membership.live()
        places = {robot: (words[robot].x, words[robot].y) for robot in sorted(live)}
        if knowledge.me in places:
            places[knowledge.me] = place
        serving: dict[int, list[int]] = {}
        for robot in places:
            if words[robot].phase == SERVE and words[robot].goal in knowledge.undone:
                serving.setdefault(words[robot].goal, []).append(robot)
        tasks = tuple(knowledge.open_tasks())
        at_work = {key: tuple(robots) for key, robots in serving.items()}
        situation = FleetSituation(places, tasks, at_work, self.plan.stops, age)
        terms = {robot: words[robot].terms or Terms() for robot in places}
        situation = situation._replace(
            over=frozenset(knowledge.over), seen=frozenset(knowledge.seen), terms=terms
        )
        epoch = self.plan.note.epoch + 1
        note = make_plan(knowledge.mission, self._planner, situation, epoch, knowledge.me)
        self._follow(FleetPlan(note), now)
        self.made += 1
        self._reason_since = None

    def _look(self, now: float, membership: Membership) -> None:
        """Look for a reason to plan, where anything has changed since the last look."""
        knowledge = self._knowledge
        grown = knowledge.changes + membership.changes + self.changes
        looked = grown, self._too_late()
        if looked == self._looked_at:
            return
        self._looked_at = looked
        if not self._has_reason(membership.live()):
            self._reason_since = None
        elif self._reason_since is None:
            self._reason_since = now

    def _has_reason(self, live: frozenset[int]) -> bool:
        """Say whether the plan misses a task, counts on others than are there, or on too few."""
        undone = self._knowledge.undone
        if undone and (live != self.plan.live or not undone <= self.plan.listed):
            return True
        if self._too_late() - self._late or (self._is_short and undone):
            return True
        left_out = self.plan.note.left_out
        return any(self._needs_more(key) for key in self._knowledge.seen if key in undone) or any(
            self._is_free(key, live) for key in left_out if key in undone
        )

    def _is_free(self, key: int, live: frozenset[int]) -> bool:
        """Say whether a task that was left out can be done, since what it waited for is over."""
        mission, known = self._knowledge.mission, self._knowledge
        before = mission.before.get(key)
        is_free = before is not None and before <= known.over
        places = {robot: (known.words[robot].x, known.words[robot].y) for robot in live}
        return is_free and mission.can_do(live, known.tasks[key], places)

    def _needs_more(self, key: int) -> bool:
        """Say whether a task has turned out to need more than its coalition brings."""
        coalition = () if key in self.plan.note.left_out else self.plan.coalition(key)
        return bool(coalition) and not self._knowledge.covers(coalition, key)
