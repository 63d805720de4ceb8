"""Follows the events of a record by the rules, and stops at the first that they do not allow."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

from teamformer.mission.coordination import TAKEN_OVER
from teamformer.mission.parts.capabilities import describe, missing, total
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.roads import Roads
from teamformer.record.event_rules.lengths import is_near
from teamformer.record.event_rules.outside import Due, what_is_to_come
from teamformer.record.event_rules.standing import (
    CARRIES,
    FORMS,
    SERVES,
    UNLOADS,
    Standing,
    WorkNow,
    turning,
)
from teamformer.record.record import Record
from teamformer.world.continuous.events import Event, Passed
from teamformer.world.rules.constants import NOBODY

SHORTEST_HOPE = 10
"""A service that is overdue is expected to take a tenth of the longest more, at least."""

FROM_OUTSIDE = ("lost", "back", "appear", "cancel")
SAME_MOMENT = ("walk", "form", "serve", "know", "broken", "over", "plan")
"""Events without a cause, and those whose cause happens at the same moment."""

BEGUN_BY = {
    "formed": ("form",),
    "lift": ("serve", "lift"),
    "unload": ("lift",),
    "done": ("serve", "unload"),
    "overdue": ("serve",),
}
"""Events that hang on what has begun before, for the same task."""

IN_THE_NEWS = {
    "appear": "task appeared",
    "lost": "robot lost",
    "back": "robot back",
    "know": "needs known",
    "overdue": "service overdue",
    "cancel": "task cancelled",
    "done": "task done",
}


class BrokenRuleError(Exception):
    """What the rules do not allow."""


class Following:
    """A record as it is followed; `take` raises `BrokenRuleError`."""

    def __init__(self, record: Record) -> None:
        self.record, self.events = record, record.events
        self.now = Standing(record)
        self._to_come = what_is_to_come(self.now.truth)
        self._news: dict[str, None] = {"start": None}
        self._breaks: dict[int, int] = {}  # tasks whose service breaks off now, with the event why
        self._plans = 0  # made at this moment
        self._count = 0
        self._take: dict[str, Callable[[Event], None]] = {
            kind: getattr(self, f"_{kind}")
            for kind in (
                *("plan", "walk", "arrive", "form", "formed", "opens", "serve", "lift", "unload"),
                *("done", "broken", "lost", "back", "appear", "cancel", "know", "overdue"),
            )
        }

    def take(self, event: Event) -> None:
        """Take in the next event."""
        if event.at > self.now.now:
            self.settle(event.at)
            self.now.now, self._news, self._plans = event.at, {}, 0
        self._judge_cause(event)
        if event.kind == "over":
            return
        if event.kind not in self._take:
            raise BrokenRuleError(f"nothing like '{event.kind}' happens in continuous time")
        self._take[event.kind](event)
        news = IN_THE_NEWS.get(event.kind)
        if news is not None and self._is_news(event):
            self._news[news] = None
        self._count += 1

    def _is_news(self, event: Event) -> bool:
        """Say whether it is news; what is known as the mission starts is none."""
        return not (event.kind == "know" and "start" in self._news)

    def _need(self, is_so: bool, message: str) -> None:
        if not is_so:
            raise BrokenRuleError(message)

    # What must have happened before a later moment

    def settle(self, later: float) -> None:
        """Check that all has happened that had to before a later moment."""
        for task in self._breaks:
            raise BrokenRuleError(
                f"the service of {self._task(task)} breaks off, and nothing says so"
            )
        self._need(self._plans > 0 or not self._heard(), self._no_plan())
        self._settle_robots()
        self._settle_tasks()
        self._settle_works(later)
        for at, kind, which in self._to_come:
            if at >= later:
                break
            if self._is_due(kind, which):
                raise BrokenRuleError(
                    f"by the mission {self._outside((at, kind, which))} at {at:g}"
                )

    def _no_plan(self) -> str:
        return f"there is no plan, though: {', '.join(self._heard())}"

    def _heard(self) -> list[str]:
        """Return the news that a plan has to be made after at this moment."""
        asks = ("start", *(word for word in self.record.heeds if word != "service overdue"))
        return [word for word in self._news if word in asks]

    def _settle_robots(self) -> None:
        """Check that whoever is free is where it is to be, or on its way there."""
        now = self.now
        if now.plan is None:
            return
        for robot, it in enumerate(now.robots):
            if it.is_lost or it.work != NOBODY or self._scouts(robot):
                continue
            task = now.next_task(robot)
            goal = now.home_of(robot) if task == NOBODY else now.place_of(task)
            if goal is None or it.way[-1].place == goal:
                continue
            if math.isinf(now.lengths.between(it.way[-1].place, goal, robot)):
                continue
            what = "home" if task == NOBODY else f"to {self._task(task)}"
            raise BrokenRuleError(f"robot {self._robot(robot)} is to go {what}, and does not")

    def _scouts(self, robot: int) -> bool:
        """Say whether a robot goes to look at a task that nobody has seen."""
        return self.now.robots[robot].task in self.now.unseen

    def _settle_tasks(self) -> None:
        """Check that tasks have begun that could."""
        now = self.now
        for task in now.order:
            if task in now.linked or not now.is_open(task) or task in now.works:
                continue
            team, place = now.team_of(task), now.place_of(task)
            is_there = bool(team) and all(
                now.is_at(robot, place) and now.next_task(robot) == task for robot in team
            )
            if not is_there or not now.brings(team, task):
                continue
            if self._has_to_form(team):
                raise BrokenRuleError(f"the team of {self._task(task)} is there and does not form")
            if now.is_released(task):
                raise BrokenRuleError(
                    f"{self._task(task)} can begin, for all are there, and does not"
                )

    def _settle_works(self, later: float) -> None:
        """Check that what had to end before a later moment has ended."""
        for task, work in self.now.works.items():
            if work.ends < later and not is_near(work.ends, later):
                part = ("the forming for", "the service of", "the carrying of", "the unloading of")
                what = f"{part[work.part]} {self._task(task)}"
                raise BrokenRuleError(f"{what} ends at {work.ends:.9g}, and the record goes on")
        for robot, it in enumerate(self.now.robots):
            is_walking = it.is_walking and not it.is_lost and it.work == NOBODY
            if is_walking and it.way[-1].at < later and not is_near(it.way[-1].at, later):
                at = it.way[-1].at
                raise BrokenRuleError(
                    f"robot {self._robot(robot)} arrives at {at:.9g}, and does not"
                )

    # Causes

    def _judge_cause(self, event: Event) -> None:
        """Check that an event hangs on one that can have led to it, and on nothing later."""
        cause = None if event.cause == NOBODY else self.events[event.cause]
        number = self._count
        if event.kind in FROM_OUTSIDE:
            self._need(cause is None, f"{event.kind} comes from outside, and has a cause")
            return
        if event.kind == "opens":
            return
        if cause is None:
            self._need(number == 0 and event.kind in ("plan", "know"), f"{event.kind} has no cause")
            return
        self._need(event.cause < number, f"{event.kind} has a cause that comes later")
        if event.kind == "arrive":
            is_walk = cause.kind == "walk" and cause.robots == event.robots
            is_there = is_near(cause.at, event.at)
            self._need(is_walk or is_there, "arrive has a cause that is not its robot's way")
        elif event.kind in BEGUN_BY:
            is_so = cause.kind in BEGUN_BY[event.kind] and cause.task == event.task
            self._need(is_so, f"{event.kind} has {cause.kind} as its cause")
            work = self.now.works.get(event.task)
            is_part = work is not None and work.event == event.cause
            self._need(is_part, f"{event.kind} has an earlier cause than its latest part")
        elif event.kind in SAME_MOMENT:
            what = f"{event.kind} hangs on what happened at {cause.at:.9g}"
            self._need(cause.at == event.at or event.kind == "over", what)

    # Plans

    def _plan(self, event: Event) -> None:
        now, plan = self.now, event.plan
        assert plan is not None, "it has been read"
        own = [why for why in plan.reasons if why != TAKEN_OVER]
        known = {*self._news, *(["idle"] if "idle" in plan.reasons else [])}
        self._need(bool(plan.reasons) and known.issuperset(own), self._wrong_reasons(own))
        if "idle" not in own:
            self._need(set(self._heard()) <= set(own), self._wrong_reasons(own))
        tasks = [row.task for row in plan.tasks]
        self._need(len(set(tasks)) == len(tasks), "the plan has a task twice")
        for task, robots, end in plan.tasks:
            name = self._task(task)
            self._need(task not in now.over, f"the plan has {name}, which is over")
            self._need(now.is_open(task) or self.record.method == "central",
                       f"the plan has {name}, which is not open")  # fmt: skip
            self._need(
                list(robots) == sorted(set(robots)), f"the robots of {name} are not in order"
            )
            for robot in robots:
                it = now.robots[robot]
                self._need(
                    not it.is_lost, f"the plan has {self._robot(robot)} do {name}: it is lost"
                )
            sure = now.mission.tasks[task].needs
            have = total(now.mission.robots[robot].can for robot in robots)
            lacks = missing(have, sure)
            self._need(
                not robots or not lacks, f"the plan's team of {name} lacks {describe(lacks)}"
            )
            self._need(end is None or end >= now.now or is_near(end, now.now),
                       f"the plan expects {name} to end at {end:g}")  # fmt: skip
        now.go_by(plan)
        self._news = {}
        self._plans += 1

    def _wrong_reasons(self, own: Sequence[str]) -> str:
        said, news = ", ".join(own) or "none", ", ".join(self._news) or "none"
        return f"the plan says as its reason: {said}; the news is: {news}"

    # Ways

    def _walk(self, event: Event) -> None:
        now = self.now
        robot = self._one(event)
        it, task = now.robots[robot], event.task
        name = self._robot(robot)
        self._need(not it.is_lost, f"robot {name} sets out, and is lost")
        self._need(it.work == NOBODY, f"robot {name} sets out, and is at work")
        goal = event.way[-1].place
        if task != NOBODY:
            self._judge_goal(robot, task, goal)
        self._judge_way((robot,), event, now.turns_at(robot), goal)
        self._stop_walking(robot)
        it.way, it.task, it.walk = event.way, task, self._count

    def _judge_goal(self, robot: int, task: int, goal: Place) -> None:
        now, name = self.now, self._robot(robot)
        due = now.next_task(robot)
        is_look = task in now.unseen and now.is_open(task)
        if task != due and not is_look:
            to = "nothing" if due == NOBODY else self._task(due)
            raise BrokenRuleError(
                f"robot {name} heads for {self._task(task)}, and the plan has it do {to}"
            )
        place = now.place_of(task)
        if goal != place:
            at, there = self._place(place), self._place(goal)
            raise BrokenRuleError(f"{self._task(task)} is at {at}, and the way leads to {there}")

    def _judge_way(
        self, robots: tuple[int, ...], event: Event, stub: tuple[Passed, ...], goal: Place
    ) -> None:
        """Check that a way begins where robots are, is as short as can be, and takes so long."""
        now, way = self.now, event.way
        if not _is_same_way(way[: len(stub)], stub):
            said, due = (self._passed(part[0]) for part in (way, stub))
            raise BrokenRuleError(f"the way begins at {said} in the record, by the rules at {due}")
        slowest = max(robots, key=lambda robot: now.takes(robot, stub[-1].place, goal))
        speed, spent, here = now.truth.robots[slowest].speed, 0.0, stub[-1].place
        for at, place in way[len(stub) :]:
            spent += now.lengths.between(here, place, slowest)
            due_at = now.lengths.when(robots, stub[-1].at, spent / speed)
            if not is_near(at, due_at):
                what = f"{self._place(place)} is passed at {due_at:.9g} by the rules"
                raise BrokenRuleError(f"{what} and at {at:.9g} in the record")
            here = place
        length = now.lengths.between(stub[-1].place, goal, slowest)
        if not is_near(spent, length):
            raise BrokenRuleError(
                f"the way is {spent:.9g} long, and a way of {length:.9g} leads there"
            )
        until = way[-1].at
        self._need(event.until is not None and is_near(event.until, until),
                   f"it is there at {until:.9g}, and the record says {event.until}")  # fmt: skip

    def _arrive(self, event: Event) -> None:
        robot = self._one(event)
        it, name = self.now.robots[robot], self._robot(robot)
        self._need(not it.is_lost and it.work == NOBODY, f"robot {name} cannot arrive")
        stub = self.now.turns_at(robot)
        if it.is_walking and is_near(it.way[-1].at, event.at):
            stub = it.way[-1:]
            self._need(event.cause == it.walk, f"robot {name} arrives by another way than its own")
            self._need(event.task == it.task, f"robot {name} arrives for another task than its own")
        elif event.task != NOBODY:
            self._judge_goal(robot, event.task, stub[-1].place)
        last = stub[-1]
        self._need(len(stub) == 1, f"robot {name} is between two places, and arrives")
        place = self._place(last.place)
        self._need(event.place == last.place, f"robot {name} is at {place}, and arrives elsewhere")
        self._stop_walking(robot)
        it.way, it.task = (Passed(event.at, last.place),), event.task

    def _stop_walking(self, robot: int) -> None:
        it = self.now.robots[robot]
        if it.is_walking:
            self.now.travel += self.now.now - self.events[it.walk].at

    # Work

    def _has_to_form(self, team: Sequence[int]) -> bool:
        came_from = {self.now.robots[robot].came_from for robot in team}
        return self.now.mission.forming > 0 and len(came_from) > 1

    def _form(self, event: Event) -> None:
        self._judge_team(event)
        self._need(self._has_to_form(event.robots), "the team forms, and need not")
        ends = self.now.now + self.now.mission.forming
        self._expect(event, ends)
        self._begin(event, WorkNow(event.robots, FORMS, self.now.now, ends, self._count))

    def _formed(self, event: Event) -> None:
        self._end_part(event, FORMS)
        del self.now.works[event.task]
        self._free(event.robots, event.place, event.task)

    def _opens(self, event: Event) -> None:
        if event.cause == NOBODY:
            self._from_outside((event.at, "opens", event.task))
            return
        self._need(
            event.task in self.now.linked, f"{self._task(event.task)} has no links to hold it"
        )

    def _serve(self, event: Event) -> None:
        now, task = self.now, event.task
        self._judge_team(event)
        name, real, wanted = self._task(task), now.truth.tasks[task], now.mission.tasks[task]
        have = total(now.truth.robots[robot].can for robot in event.robots)
        lacks = missing(have, real.needs)
        self._need(not lacks, f"the team of {name} lacks {describe(lacks)}")
        self._need(now.is_released(task), f"{name} may not begin yet")
        self._need(not self._has_to_form(event.robots), f"the team of {name} has not formed")
        carried = now.carried(task, event.robots)
        self._expect(event, now.now + (wanted.duration + carried + wanted.unload))
        ends = now.now + real.duration
        overdue = now.now + wanted.duration if wanted.duration < real.duration else None
        now.started[task] = now.now
        self._begin(
            event, WorkNow(event.robots, SERVES, now.now, ends, self._count, overdue=overdue)
        )

    def _judge_team(self, event: Event) -> None:
        """Check that a whole team stands at a task, with nothing else to do."""
        now, task = self.now, event.task
        name = self._task(task)
        self._need(task in now.appeared, f"{name} is not known yet")
        self._need(task not in now.over, f"{name} is over")
        self._need(task not in now.works, f"{name} is being served, or its team forms")
        place, team = now.place_of(task), now.team_of(task)
        there = self._place(place)
        self._need(event.place == place, f"{name} is at {there}, and is done elsewhere")
        for robot in event.robots:
            who = f"robot {self._robot(robot)}"
            self._need(now.is_at(robot, place), f"{who} is not free at {there}, where {name} is")
        self._need(event.robots == team, f"the plan has {self._robots(team)} do {name}")
        for robot in team:
            due = now.next_task(robot)
            self._need(due == task, f"robot {self._robot(robot)} has something else to do first")

    def _lift(self, event: Event) -> None:
        now, task = self.now, event.task
        work = self._work(event)
        real = now.truth.tasks[task]
        self._need(real.to is not None, f"{self._task(task)} is no load")
        if work.part == SERVES:
            self._end_part(event, SERVES)
            stub: tuple[Passed, ...] = (Passed(now.now, now.place_of(task)),)
        else:
            self._need(work.part == CARRIES, f"{self._task(task)} is not carried")
            self._need("robot lost" in self._news, f"{self._task(task)} is carried already")
            stub = turning(work.way, now.now, now.is_plane)
        self._need(event.robots == work.robots, f"{self._robots(work.robots)} carry it")
        self._need(event.place == stub[0].place, f"it is lifted at {self._place(stub[0].place)}")
        assert real.to is not None
        self._judge_way(event.robots, event, stub, real.to)
        again = replace(work, part=CARRIES, ends=event.way[-1].at, event=self._count, way=event.way)
        now.works[task] = again
        for robot in event.robots:
            now.robots[robot].way = event.way

    def _unload(self, event: Event) -> None:
        now, task = self.now, event.task
        self._end_part(event, CARRIES)
        to = now.truth.tasks[task].to
        self._need(event.place == to, "it is unloaded elsewhere than it goes")
        ends = now.now + now.truth.tasks[task].unload
        self._expect(event, ends)
        work = now.works[task]
        now.works[task] = replace(work, part=UNLOADS, ends=ends, event=self._count, way=())
        assert to is not None
        now.lies[task] = to
        for robot in event.robots:
            now.robots[robot].way = (Passed(now.now, to),)

    def _done(self, event: Event) -> None:
        now, task = self.now, event.task
        real = now.truth.tasks[task]
        self._end_part(event, SERVES if real.to is None else UNLOADS)
        del now.works[task]
        place = now.place_of(task) if real.to is None else real.to
        self._need(event.place == place, f"{self._task(task)} is done at {self._place(place)}")
        now.over[task] = now.now
        now.done.add(task)
        self._free(event.robots, event.place, NOBODY)

    def _broken(self, event: Event) -> None:
        now, task = self.now, event.task
        work = self._work(event)
        why = self._breaks.pop(task, None)
        self._need(why is not None, f"{self._task(task)} does not break off")
        self._need(event.robots == work.robots, f"{self._robots(work.robots)} are left of its team")
        stub = turning(work.way, now.now, now.is_plane) if work.way else ()
        if work.part == CARRIES:
            now.lies[task] = stub[0].place
        lies = now.place_of(task) if work.part in (CARRIES, UNLOADS) else None
        self._need(
            event.place == lies,
            f"its load lies at {'no place' if lies is None else self._place(lies)}",
        )
        del now.works[task]
        if work.part != FORMS:
            now.started.pop(task, None)
            self._news["service broken off"] = None
        for robot in work.robots:
            it = now.robots[robot]
            it.work, it.task = NOBODY, NOBODY
            if work.part == CARRIES:
                it.way, it.walk = stub, self._count

    def _begin(self, event: Event, work: WorkNow) -> None:
        self.now.works[event.task] = work
        for robot in work.robots:
            self.now.robots[robot].work = event.task

    def _work(self, event: Event) -> WorkNow:
        work = self.now.works.get(event.task)
        if work is None:
            raise BrokenRuleError(f"nobody is at work on {self._task(event.task)}")
        return work

    def _end_part(self, event: Event, part: int) -> None:
        """Check that a part of work ends when, where and by whom it has to."""
        work, name = self._work(event), self._task(event.task)
        self._need(work.part == part, f"{event.kind} of {name} is not what comes next")
        self._need(is_near(work.ends, event.at),
                   f"{event.kind} of {name} is due at {work.ends:.9g}")  # fmt: skip
        self._need(event.robots == work.robots, f"{self._robots(work.robots)} are at {name}")

    def _free(self, robots: Sequence[int], place: Place | None, task: int) -> None:
        assert place is not None, "it has been read"
        for robot in robots:
            it = self.now.robots[robot]
            it.work, it.task, it.came_from = NOBODY, task, place
            it.way = (Passed(self.now.now, place),)

    def _expect(self, event: Event, until: float) -> None:
        is_so = event.until is not None and is_near(event.until, until)
        self._need(
            is_so, f"{event.kind} is to end at {until:.9g}, and the record says {event.until}"
        )

    # From outside

    def _from_outside(self, due: Due) -> None:
        """Check that the mission has something happen now."""
        match = next(
            (it for it in self._to_come if it[1:] == due[1:] and is_near(it[0], due[0])), None
        )
        if match is None:
            raise BrokenRuleError(f"by the mission it is not so that {self._outside(due)} now")
        self._to_come.remove(match)

    def _is_due(self, kind: str, which: int) -> bool:
        return kind not in ("cancel", "opens") or which not in self.now.over

    def _lost(self, event: Event) -> None:
        now, robot = self.now, self._one(event)
        self._from_outside((event.at, "lost", robot))
        it = now.robots[robot]
        stub = now.turns_at(robot)
        self._need(event.place == stub[-1].place, f"it is lost at {self._place(stub[-1].place)}")
        if it.work == NOBODY:
            self._stop_walking(robot)
        it.way, it.rest, it.is_lost = stub, stub[-1].at - now.now, True
        task, it.work, it.task = it.work, NOBODY, NOBODY
        if task == NOBODY:
            return
        work = now.works[task]
        work.robots = tuple(other for other in work.robots if other != robot)
        if work.part == FORMS or not now.brings(work.robots, task):
            self._breaks[task] = self._count

    def _back(self, event: Event) -> None:
        now, robot = self.now, self._one(event)
        self._from_outside((event.at, "back", robot))
        it = now.robots[robot]
        self._need(
            event.place == it.way[-1].place, f"it is back at {self._place(it.way[-1].place)}"
        )
        it.is_lost = False
        shift = now.now + it.rest - it.way[-1].at
        if it.is_walking:
            it.way = tuple(Passed(at + shift, place) for at, place in it.way)
            it.walk = self._count

    def _appear(self, event: Event) -> None:
        self._from_outside((event.at, "appear", event.task))
        self.now.appeared.add(event.task)

    def _cancel(self, event: Event) -> None:
        task = event.task
        self._from_outside((event.at, "cancel", task))
        self._need(task not in self.now.over, f"{self._task(task)} is over already")
        self.now.over[task] = event.at
        if task in self.now.works:
            self._breaks[task] = self._count

    def _know(self, event: Event) -> None:
        now, task, robot = self.now, event.task, self._one(event)
        name = self._task(task)
        self._need(task in now.unseen, f"what {name} needs is known already")
        self._need(task in now.appeared and task not in now.over, f"{name} cannot be seen")
        place = now.robots[robot].way[0].place
        self._need(place == now.place_of(task), f"robot {self._robot(robot)} is not at {name}")
        needs = now.truth.tasks[task].needs
        self._need(event.needs == dict(needs), f"{name} needs {describe(needs)}")
        now.unseen.discard(task)

    def _overdue(self, event: Event) -> None:
        now, task = self.now, event.task
        work, wanted = self._work(event), now.mission.tasks[task]
        is_due = work.overdue is not None and is_near(work.overdue, event.at)
        self._need(is_due, f"{self._task(task)} is not overdue now")
        latest = work.begun + wanted.longest
        more = max((latest - now.now) / 2, wanted.longest / SHORTEST_HOPE)
        ends = min(latest, now.now + more)
        self._expect(event, ends + now.carried(task, work.robots) + wanted.unload)
        work.overdue = ends if ends < work.begun + now.truth.tasks[task].duration else None

    # Words

    def _one(self, event: Event) -> int:
        if len(event.robots) != 1:
            raise BrokenRuleError(f"{event.kind} is of one robot, not of {len(event.robots)}")
        return event.robots[0]

    def _task(self, task: int) -> str:
        return f"task {self.now.truth.tasks[task].name}"

    def _robot(self, robot: int) -> str:
        return self.now.truth.robots[robot].name

    def _robots(self, robots: Sequence[int]) -> str:
        return f"[{', '.join(map(self._robot, robots))}]"

    def _place(self, place: Place) -> str:
        world = self.now.truth.world
        if isinstance(world, Roads):
            return world.name_of(place)
        return f"({place[0]:.9g}, {place[1]:.9g})"

    def _passed(self, passed: Passed) -> str:
        return f"{self._place(passed.place)} at {passed.at:.9g}"

    def _outside(self, due: Due) -> str:
        _, kind, which = due
        if kind in ("lost", "back"):
            return f"robot {self._robot(which)} is {kind}"
        return f"{self._task(which)} {kind if kind == 'opens' else kind + 's'}"


def _is_same_way(one: Sequence[Passed], other: Sequence[Passed]) -> bool:
    """Say whether two ways pass the same places at the same times."""
    if len(one) != len(other):
        return False
    return all(
        is_near(a.at, b.at) and all(map(is_near, a.place, b.place))
        for a, b in zip(one, other, strict=True)
    )
