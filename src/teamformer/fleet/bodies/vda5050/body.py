"""A vehicle that speaks VDA5050 over MQTT: commands become orders, states become reports.

A leg is an order of two nodes, where the vehicle is and where it is to go, on roads of all nodes on
the way. It is sent again until the vehicle's state shows it, and the order before is cancelled
first. Serving is an instant action. Its part of the task is over when the vehicle has finished
that action.

A load is an order of its own: `pick` where the vehicle is, the way at the pace of its team, and
`drop` where the load is to be brought. Its part is over when the vehicle has dropped it. If it is
told to stop on its way, that order is cancelled and another one has it drop the load there.

What has failed is told again under another name. If it goes on failing, or the vehicle shows
nothing of it, the vehicle is unfit for a while. It also is where nobody knows where it is.
"""

from __future__ import annotations

import itertools
import math
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from teamformer.fleet.bodies.body import Command, Report
from teamformer.fleet.bodies.vda5050.address import read_address
from teamformer.fleet.bodies.vda5050.broker import Broker
from teamformer.fleet.bodies.vda5050.graph import graph_of
from teamformer.fleet.bodies.vda5050.orders import Action, OrderStop, Way, action_of, order_of
from teamformer.fleet.bodies.vda5050.service import DROP, NEAR, SET_DOWN, ServiceTry, begin
from teamformer.fleet.bodies.vda5050.state import FAILED, FINISHED, State
from teamformer.fleet.bodies.vda5050.tries import UNANSWERED, Tries
from teamformer.fleet.bodies.vda5050.watch import VehicleWatch
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import TaskFact
from teamformer.fleet.saying import say
from teamformer.mission.parts.grid import Place

CANCEL = "cancel its order"

START, STOP = "startCharging", "stopCharging"
CHARGING = {START: "begin to charge", STOP: "stop charging"}
"""Instant actions by which it charges, and what they are called where they fail."""

FREE: Mapping[str, float] = {}
"""No limits of the way of an order."""


class Vda5050Body:
    """One vehicle; `url` names its broker and itself, as `read_address` says."""

    def __init__(self, url: str, mission: FleetMission, robot: int) -> None:
        address = read_address(url)
        self._map, self._dialect = address.map, address.dialect
        self._name = mission.source.robots[robot].name
        self._tasks = {task.key: task for task in mission.tasks}
        self._lock = threading.Lock()
        self._graph = graph_of(mission, robot, address.layout)
        self._watch = VehicleWatch(address, self._say, self._graph)
        self._report: Report | None = None
        self._command = Command()
        self._run = f"{robot}-{time.time_ns() // 1_000_000:x}"  # so that no order is an earlier one
        self._numbers = itertools.count(1)
        self._service: ServiceTry | None = None  # that at hand, or the last one
        self._ended = self._served = ""  # the services that were over last, and done last
        self._held: ServiceTry | None = None  # whose load it has
        self._lies: Place | None = None  # where it has set down the load of the task at hand
        self._charges = self._stops = ""  # the actions by which it last began to charge, or stopped
        self._is_charging = False  # by its state, since it was last told to
        self._tries = Tries()
        self._broker = Broker(address, f"teamformer-{self._run}", self._take, self._say)

    def command(self, command: Command) -> None:
        """Take up a command; it is pursued whenever there is news of the vehicle."""
        with self._lock:
            if command.task != self._command.task:
                self._lies = None
            is_new = command.serve and not self._command.serve
            self._command = command
            if is_new:
                self._service = self._try_of(command)
            self._pursue()

    def report(self) -> Report | None:
        """Return what the newest state says; None before the first, or while it is off line."""
        with self._lock:
            at = self._watch.place()
            if at is None:
                return self._absent()
            self._pursue()
            leg = self._command.leg if self._is_on_it() else -1
            taken = self._watch.taken
            report = Report(*self._place(at), leg, number=taken, has_served=self._has_served())
            report = report._replace(charge=self._state.charge)
            if self._load is not None:
                has = self._held is not None and self._is_bringing()
                report = report._replace(carries=has, load=self._lies)
            self._report = report._replace(is_unfit=self._tries.rests(time.monotonic()))
            return self._report

    def _absent(self) -> Report | None:
        """Return the last report, as of an unfit vehicle, once it has been away for long."""
        if self._report is None or not self._watch.is_away:
            return None
        return self._report._replace(is_unfit=True)

    def close(self) -> None:
        """Cancel what the vehicle has to do, and leave the broker."""
        with self._lock:
            if self._state.is_driving:
                self._cancel()
        self._broker.close()

    def _take(self, topic: str, content: Mapping[str, Any]) -> None:
        """Take in a state or a connection."""
        with self._lock:
            at, service = self._watch.take(topic, content), self._service
            if at is not None and self._held is not None:
                self._note_drop(at, self._held)
            elif at is not None and service is not None and self._ended != service.name:
                self._note_service(service)

    def _note_service(self, service: ServiceTry) -> None:
        """Note that the vehicle has served or has picked a load, or that it failed to."""
        status = self._state.status_of(service.begins)
        if status in FAILED and self._command.serve:
            self._fail(service.words, service.begins)
            self._service = self._try_of(self._command)
        elif status == FINISHED:
            self._tries.succeed(service.words)
            if service.load is not None:
                self._held, self._lies = service, None
            else:
                self._ended = self._served = service.name
                self._tries.recover()

    def _note_drop(self, at: Place, held: ServiceTry) -> None:
        """Note that the vehicle has brought its load or has set it down, or that it failed to."""
        dropped = self._state.status_of(held.drop)
        set_down = self._state.status_of(held.set_down)
        if dropped == FINISHED:
            self._held, self._lies = None, None
            self._ended = self._served = held.name
            self._tries.succeed(held.drop_words)
            self._tries.recover()
        elif set_down == FINISHED:
            self._held, self._lies, self._ended = None, at, held.name
            self._tries.succeed(held.set_down_words)
        elif self._is_bringing() and dropped in FAILED:
            self._fail(held.drop_words, held.drop)
            self._held = held._replace(drop=self._another(f"{held.name}-{DROP}"))
        elif not self._is_bringing() and set_down in FAILED:
            self._fail(held.set_down_words, held.set_down)
            self._held = held._replace(set_down=self._another(f"{held.name}-{SET_DOWN}"))

    def _fail(self, what: str, action: str) -> None:
        """Tell that the vehicle has failed, and what it says of that."""
        result, rest = self._state.result_of(action), self._tries.rest
        is_over = self._tries.fail(what, time.monotonic())
        then = f"it is unfit for {rest:g} s" if is_over else "it gets the order again"
        said = f" and says '{result}'" if result else ""
        self._say(f"the vehicle has failed to {what}{said}; {then}")

    def _pursue(self) -> None:
        """Bring the vehicle from what its state shows to what the command wants, one thing each."""
        at, held = self._watch.place(), self._held
        if at is None:
            return
        if not self._state.is_driving:
            self._tries.answer(CANCEL)
        if held is not None and not self._is_bringing():
            self._hand_out(held.set_down, held.put_down(at), held.set_down_words)
        elif not self._is_on_it():
            self._go(at)
        else:
            self._tries.answer(self._way)
            service = self._service
            self._charge()
            if self._command.serve and service is not None and self._ended != service.name:
                self._serve(at, service)

    def _charge(self) -> None:
        """Have the vehicle begin to charge, or stop, unless it was told so and has answered.

        It is told to charge again if that has failed, or if it has stopped by itself.
        """
        is_wanted, stops_by_itself = self._command.charge, self._stops_by_itself()
        if is_wanted and (stops_by_itself or not self._charges):
            self._charges = self._another(f"{self._run}-charge")
        elif not is_wanted and self._charges:
            self._stops = self._another(f"{self._run}-stop")
            self._charges = ""
        name, kind = (self._charges, START) if self._charges else (self._stops, STOP)
        if not name:
            return
        status = self._state.status_of(name)
        if status is None:
            action = action_of(kind, name, {}, self._dialect.blocking)
            self._once(CHARGING[kind], lambda: self._act(action))
        elif status in FAILED:
            self._fail(CHARGING[kind], name)
            again = self._another(name)
            self._charges, self._stops = (again, "") if kind == START else ("", again)
        elif status == FINISHED:
            self._tries.succeed(CHARGING[kind])
        else:
            self._tries.answer(CHARGING[kind])

    def _stops_by_itself(self) -> bool:
        """Say whether the vehicle is to charge, has done so, and says that it does so no more."""
        was, self._is_charging = self._is_charging, bool(self._charges) and self._state.is_charging
        is_full = self._state.charge == 1.0
        return was and bool(self._charges) and not self._is_charging and not is_full

    def _go(self, at: Place) -> None:
        """Send the vehicle to the place of the command, or have it stop."""
        goal = self._command.place
        if goal is None:
            self._once(CANCEL, self._cancel)
        else:
            self._hand_out(self._order, [OrderStop(at), OrderStop(goal)], self._way)

    def _serve(self, at: Place, service: ServiceTry) -> None:
        """Have the vehicle do its part of the task, unless its state shows that it does."""
        if service.load is None:
            if self._state.status_of(service.name) is None:
                serve = service.serve(self._dialect.blocking)
                self._once(service.words, lambda: self._act(serve))
            else:
                self._tries.answer(service.words)
        elif self._held is None:
            self._hand_out(service.name, service.bring(at), service.words, self._pace())
        elif self._held.has_kept_it:
            held = self._held
            self._hand_out(held.drop, held.bring_on(at), held.drop_words, self._pace())

    def _hand_out(
        self, order: str, stops: Sequence[OrderStop], what: str, limits: Mapping[str, float] = FREE
    ) -> None:
        """See to it that the vehicle has an order; the one before is cancelled first."""
        if self._state.order == order:
            self._tries.answer(what)
        elif self._state.is_driving:
            self._once(CANCEL, self._cancel)
        else:
            begins, deviation = self._state.last_node, self._dialect.deviation
            way = Way(self._map, begins, deviation, limits, self._graph)
            content = order_of(order, stops, way)
            self._once(what, lambda: self._broker.publish("order", content))

    def _once(self, what: str, send: Callable[[], None]) -> None:
        """Send something now, or again if it was sent some time ago."""
        now, rest = time.monotonic(), self._tries.rest
        if not self._tries.is_due(what, now):
            return
        send()
        if self._tries.send(what, now):
            times = f"was told {UNANSWERED} times to {what} and shows nothing of it"
            self._say(f"the vehicle {times}; it is unfit for {rest:g} s")

    def _is_on_it(self) -> bool:
        """Say whether the vehicle has taken up the command of this leg."""
        if self._is_bringing():
            return True
        if self._held is not None:
            return False
        if self._command.place is None:
            return not self._state.is_driving
        return self._state.order == self._order

    def _is_bringing(self) -> bool:
        """Say whether it does as it was told with a load, or has done so."""
        service, order = self._service, self._state.order
        if not self._command.serve or service is None or service.load is None:
            return False
        return order == service.name or order.startswith(f"{service.name}-{DROP}")

    def _has_served(self) -> bool:
        is_it = self._service is not None and self._service.name == self._served
        return self._command.serve and is_it

    def _place(self, at: Place) -> Place:
        """Return where it is; who has driven its order and is near the goal is there."""
        goal = self._command.place
        if self._is_bringing() and self._load is not None:
            goal = self._load.to if self._has_served() else None
        is_off = goal is None or self._state.is_driving or not self._is_on_it()
        if self._graph is not None or goal is None or is_off:
            return at
        return goal if math.dist(at, goal) <= NEAR else at

    @property
    def _state(self) -> State:
        return self._watch.state

    @property
    def _order(self) -> str:
        return f"{self._run}-{self._command.leg}"

    @property
    def _way(self) -> str:
        """Return where the vehicle is to go, in words."""
        goal = self._command.place
        if goal is None:
            return "go nowhere"
        return f"go to {self._graph.node(goal) if self._graph else f'{goal[0]:g}, {goal[1]:g}'}"

    @property
    def _load(self) -> TaskFact | None:
        """Return the task at hand if it has a load."""
        task = self._tasks.get(self._command.task)
        return None if task is None or task.to is None else task

    def _another(self, name: str) -> str:
        """Return a name that nothing had before."""
        return f"{name}-{next(self._numbers)}"

    def _try_of(self, command: Command) -> ServiceTry:
        """Return a new try of a command's task."""
        task = self._tasks.get(command.task)
        return begin(self._another(self._order), task, command.task, command.team)

    def _pace(self) -> dict[str, float]:
        return {self._dialect.speed: self._command.pace} if self._command.pace else {}

    def _cancel(self) -> None:
        name = self._another(f"{self._run}-cancel")
        self._act(action_of("cancelOrder", name, {}, self._dialect.blocking))

    def _act(self, action: Action) -> None:
        """Send an instant action."""
        lists = {name: [action] for name in self._dialect.action_lists}
        self._broker.publish("instantActions", lists)

    def _say(self, message: str) -> None:
        say(self._name, message)
