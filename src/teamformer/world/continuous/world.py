"""The physical world in continuous time: robots walk, form, serve and carry; things befall them.

It knows what is physically so, and the truth; who may begin what is for those who command.
Whatever happens is an event with its cause. Nothing happens between the entries of its agenda, and
these are data, so a world is forked by copying it.
"""

from __future__ import annotations

import copy
import heapq
from collections.abc import Iterator

from teamformer.mission.checks.optional import is_in_time
from teamformer.mission.checks.windows import release_of
from teamformer.mission.model import Mission
from teamformer.world.continuous.body import turning
from teamformer.world.continuous.charging import ChargingWorld
from teamformer.world.continuous.moving import (
    APPEAR,
    ARRIVE,
    BRING_BACK,
    CALL_OFF,
    CLOSE,
    EXPECT,
    FINISH,
    FULL,
    LOOK,
    LOSE,
    OPEN,
    REST,
    WAKE,
    WORK,
    Entry,
    Happened,
)
from teamformer.world.continuous.reasons import why_left_out
from teamformer.world.rules.constants import NOBODY

COPIED = (
    "over",
    "done",
    "missed",
    "started",
    "served_by",
    "appeared",
    "lies",
    "unseen",
    "believed",
    "maybe",
)
"""What each world has a copy of."""


class PhysicalWorld(ChargingWorld):
    """All robots, tasks and loads; `advance` goes to the next moment at which something is due."""

    def __init__(self, mission: Mission, truth: Mission, is_all_known: bool = False) -> None:
        super().__init__(mission, truth, is_all_known)
        self._reached = 0.0  # all has happened that was due until then
        self.put_what_is_to_come()

    def fork(self) -> PhysicalWorld:
        """Return a world in which the same has happened, and which goes its own way."""
        twin = copy.copy(self)
        twin.events, twin.agenda = list(self.events), list(self.agenda)
        twin.bodies = [copy.copy(body) for body in self.bodies]
        twin.works = {task: copy.copy(work) for task, work in self.works.items()}
        for part in COPIED:
            setattr(twin, part, copy.copy(getattr(self, part)))
        twin.still = self.still.fork()
        twin.happened = copy.deepcopy(self.happened)
        return twin

    def advance(self) -> Happened:
        """Go to the next moment and let all happen that is due then."""
        self.be_at(self.next_time)
        self._reached = self.now
        while self.next_due <= self.now:
            if self.agenda[0][1] == CLOSE and self.happened:
                break  # what follows from the rest of the moment is done before
            _, what, which, stamp = heapq.heappop(self.agenda)
            self._let_happen(what, which, stamp)
        self.run_dry()
        return self.take_happened()

    def put_what_is_to_come(self) -> None:
        """Put on the agenda what comes from outside and has not happened."""
        self.agenda += [entry for entry in self._from_outside() if entry[0] > self._reached]
        heapq.heapify(self.agenda)
        for robot in range(len(self.bodies)):
            self._put_next_border(robot, self._reached)

    def _put_next_border(self, robot: int, after: float) -> None:
        """Put on the agenda when the next shift of a robot begins or ends."""
        border = self.truth.robots[robot].rota.next_border(after)
        if border is not None:
            self.put(border[0], WORK if border[1] else REST, robot, NOBODY)

    def _from_outside(self) -> Iterator[Entry]:
        if self.mission.until is not None:
            yield self.mission.until, CLOSE, NOBODY, NOBODY
        for number, robot in enumerate(self.truth.robots):
            for away in robot.absences:
                yield away.lost, LOSE, number, NOBODY
                if away.back is not None:
                    yield away.back, BRING_BACK, number, NOBODY
        for number, task in enumerate(self.truth.tasks):
            if task.appears > 0:
                yield task.appears, APPEAR, number, NOBODY
            if task.cancelled is not None:
                yield task.cancelled, CALL_OFF, number, NOBODY
            if release_of(task) > task.appears:
                yield release_of(task), OPEN, number, NOBODY

    def is_due(self, entry: Entry) -> bool:
        """Say whether an entry of the agenda still holds."""
        _, what, which, stamp = entry
        if what in (ARRIVE, LOOK):
            body = self.bodies[which]
            return body.is_walking and body.set_out == stamp and not body.is_lost
        if what == FULL:
            return self.bodies[which].is_charging and self.bodies[which].charge == stamp
        if what in (FINISH, EXPECT):
            return which in self.works and self.works[which].event == stamp
        return which not in self.over if what in (CALL_OFF, OPEN, WAKE) else True

    def _let_happen(self, what: int, which: int, stamp: int) -> None:
        if what == LOSE:
            self.stand_still(which, "lost")
        elif what == BRING_BACK:
            self._bring_back(which)
        elif what == CALL_OFF:
            self._call_off(which)
        elif what == APPEAR:
            self.appeared.add(which)
            self.tell("appear", (), which, NOBODY)
            self.note("task appeared", tasks=(which,))
            for robot in range(len(self.bodies)):
                self.sense(robot)
        elif what == OPEN:
            self.tell("opens", (), which, NOBODY)
            self.note(tasks=(which,))
        elif what == ARRIVE:
            self.arrive(which)
        elif what == FINISH:
            self.finish_part(which)
        elif what == EXPECT:
            self.expect_anew(which)
        elif what == LOOK:
            self.look_around(which)
        elif what == FULL:
            self.be_full(which)
        elif what == CLOSE:
            self._close()
        elif what in (REST, WORK):
            self._pass_border(which, begins=what == WORK)
        else:
            self.note(tasks=(which,))

    def _pass_border(self, robot: int, begins: bool) -> None:
        """Let a shift of a robot begin or end, and the next one at once if they touch."""
        (self.begin_shift if begins else self.knock_off)(robot)
        if not begins and self.truth.robots[robot].rota.is_at_work(self.now):
            self.begin_shift(robot)
        self._put_next_border(robot, self.now)

    def stand_still(self, robot: int, kind: str) -> None:
        """Let a robot be lost, or have run dry, as a kind of event says."""
        body = self.bodies[robot]
        if body.is_lost:
            return
        stub = turning(body.way, self.now, self.is_plane)
        if body.work == NOBODY:
            self.stop_walking(robot)
        rota = self.truth.robots[robot].rota
        body.way, body.rest = stub, rota.worked(self.now, stub[-1].at)
        body.walked = rota.worked(stub[0].at, self.now)
        body.is_lost, body.task = True, NOBODY
        self.leave_charger(robot)
        number = self.tell(kind, (robot,), NOBODY, NOBODY, place=stub[-1].place)
        body.since = number
        self.note("robot lost", robots=(robot,))
        task, body.work = body.work, NOBODY
        if task != NOBODY:
            self.leave_work(task, robot, number)

    def _bring_back(self, robot: int) -> None:
        body = self.bodies[robot]
        if self.is_dry(robot):
            return
        body.is_lost = False
        place = body.way[-1].place
        number = body.since = self.tell("back", (robot,), NOBODY, NOBODY, place=place)
        if body.is_walking:
            before, after = body.way
            arrives = self.truth.robots[robot].rota.ends_leg(self.now, body.rest)
            leg = before._replace(at=self.now - body.walked), after._replace(at=arrives)
            self.stand(robot, leg, number)
        self.note("robot back", robots=(robot,))

    def _call_off(self, task: int) -> None:
        number = self.over[task] = self.tell("cancel", (), task, NOBODY)
        if task in self.works:
            self.break_off(task, number)
        self.note("task cancelled", tasks=(task,))

    def _close(self) -> None:
        """Let all be missed that is not done, but for what ends at this very moment."""
        for task in range(len(self.truth.tasks)):
            work = self.works.get(task)
            ends_now = work is not None and work.is_service and is_in_time(work.all_done, self.now)
            if task not in self.over and not ends_now:
                is_begun = task in self.works
                why = "under way" if is_begun else why_left_out(self.truth, self.ways, task)
                self.miss(task, why)

    def miss(self, task: int, why: str) -> None:
        """Let a task be missed: it is not done any more. Why is a word of `WHY_MISSED`."""
        number = self.over[task] = self.tell("missed", (), task, NOBODY, why=why)
        self.missed.append(task)
        if task in self.works:
            self.break_off(task, number)
        self.note(tasks=(task,))
