"""Whether robots charge when and where they have to, and run dry only when they have nothing left.

What is left in batteries is worked out from what robots did; no event says it.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from teamformer.mission.parts.charging import ROUNDING, Battery, longest_carry
from teamformer.mission.parts.grid import Place
from teamformer.record.event_rules.from_outside import stand_still
from teamformer.record.event_rules.lengths import is_near
from teamformer.record.event_rules.names import BrokenRuleError, need
from teamformer.record.event_rules.standing import CARRIES, FORMS, QUEUES, Standing, expect, one
from teamformer.world.continuous.events import Event
from teamformer.world.rules.charging.stops import ChargeRules
from teamformer.world.rules.constants import NOBODY

DRY = 2 * ROUNDING
"""By such a share of a full battery a robot may lack what it spends."""


class Charges:
    """What robots have left, who charges where until when, and who queues since when."""

    def __init__(self, now: Standing) -> None:
        robots, mission = now.truth.robots, now.mission
        self.left = {
            n: r.battery.starts * r.battery.lasts for n, r in enumerate(robots) if r.battery
        }
        self.goes_to = now.at_chargers  # the charger that a robot goes to, queues or charges at
        self.goes_for: dict[int, int] = {}  # the task before which it does
        self.queued: dict[int, float] = {}
        self.waits: set[int] = set()  # of these, who is said to wait for room
        self.full: dict[int, tuple[float, int]] = {}  # of who charges: when it is full, and by what
        self.rules = ChargeRules(
            [robot.battery for robot in mission.robots],
            [charger.at for charger in mission.chargers],
            [charger.room for charger in mission.chargers],
            lambda robot, here, there: now.takes(robot, _place(here), _place(there)),
        )


def _place(place: Any) -> Place:
    return float(place[0]), float(place[1])


def battery_of(now: Standing, robot: int) -> Battery:
    """Return the battery of a robot that has one."""
    battery = now.truth.robots[robot].battery
    assert battery is not None, "it is among those that have one"
    return battery


def pass_time(now: Standing, charges: Charges, later: float) -> None:
    """Let robots spend what they do until a later moment; nobody may lack it."""
    for robot in charges.left:
        battery, spent = battery_of(now, robot), _spent(now, charges, robot, later)
        charges.left[robot] -= spent
        if spent > 0 and charges.left[robot] < -2 * DRY * battery.lasts:
            raise BrokenRuleError(f"{now.names.robot(robot)} has run dry, and the record goes on")


def _spent(now: Standing, charges: Charges, robot: int, later: float) -> float:
    """Return what a robot spends until a later moment, but for what it charges.

    Outside its shifts, and held up on its way, it spends nothing.
    """
    it, battery = now.robots[robot], battery_of(now, robot)
    if it.is_lost or robot in charges.full:
        return 0.0
    works = now.truth.robots[robot].rota.worked(now.now, later)
    if it.work != NOBODY:
        work = now.works[it.work]
        if work.part == CARRIES:
            return now.lengths.walked(work.robots, now.now, later)
        return works * (battery.waiting if work.part in (FORMS, QUEUES) else battery.serving)
    if it.is_walking:
        return now.lengths.walked((robot,), now.now, later)
    is_waiting = it.task in now.unseen or (it.task != NOBODY and now.next_task(robot) == it.task)
    return works * battery.waiting if is_waiting else 0.0


def charger_for(now: Standing, charges: Charges, robot: int) -> int:
    """Return the charger that a robot has to go to before its next task or home; NOBODY if none."""
    if robot not in charges.left:
        return NOBODY
    task = now.next_task(robot)
    goal = now.home_of(robot) if task == NOBODY else now.place_of(task)
    if goal is None:
        return NOBODY
    battery, turn = battery_of(now, robot), now.turns_at(robot)[-1]
    left = charges.left[robot] - (turn.at - now.now)
    rules, wanted = charges.rules, 0.0
    if task != NOBODY:
        it = now.mission.tasks[task]
        carried = longest_carry(now.mission, it, goal, now.takes)
        wanted = rules.wanted(robot, battery.spent_on(it, carried), _place(it.to or goal))
    return rules.stop(robot, _place(turn.place), left, _place(goal), wanted)


def set_out(now: Standing, charges: Charges, robot: int, event: Event) -> None:
    """Check that a robot that sets out goes to a charger if it has to, and there if it does.

    Who only goes on to the next place, to stop there, does not set out yet.
    """
    charger = charger_for(now, charges, robot)
    forget(charges, robot)
    if charger == NOBODY:
        return
    place, goal = now.mission.chargers[charger].at, event.way[-1].place
    name = now.names.robot(robot)
    if event.task == NOBODY and goal == now.turns_at(robot)[-1].place != place:
        return
    is_so = goal == place and event.task == NOBODY
    need(is_so, f"{name} has to charge at {now.names.place(place)} first, and goes elsewhere")
    charges.goes_to[robot], charges.goes_for[robot] = charger, now.next_task(robot)


def notice(now: Standing, charges: Charges, event: Event) -> None:
    """Note who sets out to a charger, and who is there, before an event is taken in."""
    for robot in event.robots if event.kind in ("walk", "arrive", "lost", "empty") else ():
        if event.kind in ("lost", "empty"):
            _break_off(now, charges, robot)
        elif event.kind == "walk":
            set_out(now, charges, robot, event)
        elif robot in charges.goes_to and event.cause == now.robots[robot].walk:
            charges.queued[robot] = now.now
        else:
            forget(charges, robot)


def _break_off(now: Standing, charges: Charges, robot: int) -> None:
    """Let a robot that is lost charge no more; what it has charged it keeps."""
    if robot in charges.full:
        until, _ = charges.full[robot]
        battery = battery_of(now, robot)
        lacks = (until - now.now) / battery.fills if battery.fills else 0.0
        charges.left[robot] = battery.lasts * (1 - lacks)
    forget(charges, robot)


def forget(charges: Charges, robot: int) -> None:
    """Note that a robot goes to no charger, and charges at none."""
    for kept in (charges.goes_to, charges.goes_for, charges.queued, charges.full):
        kept.pop(robot, None)
    charges.waits.discard(robot)


def is_charging_first(now: Standing, charges: Charges, robot: int) -> bool:
    """Say whether a robot charges, or is where it has to, before it goes on."""
    if robot in charges.full:
        return True
    if charges.goes_for.get(robot, NOBODY - 1) == now.next_task(robot):
        return True
    charger, it = charger_for(now, charges, robot), now.robots[robot]
    if charger != NOBODY and charges.goes_to.get(robot) == charger:
        charges.goes_for[robot] = now.next_task(robot)
        return True
    forget(charges, robot)
    if charger == NOBODY:
        return False
    place = now.mission.chargers[charger].at
    if it.is_walking or it.way[0].place != place:
        return not it.is_walking and now.never_gets(robot, place)
    _queue_here(now, charges, robot, charger)
    return True


def _queue_here(now: Standing, charges: Charges, robot: int, charger: int) -> None:
    """Note that a robot queues where it stands."""
    charges.goes_to[robot], charges.goes_for[robot] = charger, now.next_task(robot)
    charges.queued.setdefault(robot, now.now)


def _at_charger(now: Standing, event: Event) -> int:
    """Return the charger that a robot charges at, or waits for; check that it has to."""
    robot, charges = one(event), charges_of(now)
    name, it = now.names.robot(robot), now.robots[robot]
    need(robot in charges.left, f"{name} has no battery")
    need(not it.is_lost and it.work == NOBODY and not it.is_walking, f"{name} cannot charge now")
    if robot not in charges.goes_to:
        charger = charger_for(now, charges, robot)
        need(charger != NOBODY, f"{name} charges, and need not")
        _queue_here(now, charges, robot, charger)
    charger = charges.goes_to[robot]
    place = now.mission.chargers[charger].at
    need(event.place == place == it.way[0].place, f"{name} charges at {now.names.place(place)}")
    return charger


def queue(now: Standing, event: Event) -> None:
    """Take in that a robot waits for room at a charger."""
    robot, charges, charger = one(event), charges_of(now), _at_charger(now, event)
    name = now.names.robot(robot)
    need(robot in charges.queued and robot not in charges.waits, f"{name} waits already")
    need(not _is_room(now, charges, charger), f"{name} waits, and there is room")
    charges.waits.add(robot)


def charge(now: Standing, event: Event) -> None:
    """Take in that a robot begins to charge."""
    robot, charges, charger = one(event), charges_of(now), _at_charger(now, event)
    name, place = now.names.robot(robot), now.mission.chargers[charger].at
    need(_is_room(now, charges, charger), f"there is no room at {now.names.place(place)}")
    since = charges.queued[robot]
    first = min((at, other) for other, at in charges.queued.items()
                if charges.goes_to[other] == charger)  # fmt: skip
    need(first == (since, robot), f"{now.names.robot(first[1])} was there before {name}")
    until = now.now + battery_of(now, robot).time_to_full(charges.left[robot])
    expect(event, until)
    del charges.queued[robot]
    charges.waits.discard(robot)
    charges.full[robot] = (until, now.count)


def _is_room(now: Standing, charges: Charges, charger: int) -> bool:
    taken = sum(charges.goes_to[robot] == charger for robot in charges.full)
    return taken < now.mission.chargers[charger].room


def charged(now: Standing, event: Event) -> None:
    """Take in that a robot is full."""
    robot, charges = one(event), charges_of(now)
    name = now.names.robot(robot)
    need(robot in charges.full, f"{name} does not charge")
    until, _ = charges.full[robot]
    need(is_near(until, event.at), f"{name} is full at {until:.9g}")
    place = now.robots[robot].way[0].place
    need(event.place == place, f"{name} charges at {now.names.place(place)}")
    forget(charges, robot)
    charges.left[robot] = battery_of(now, robot).lasts


def empty(now: Standing, event: Event) -> None:
    """Take in that a robot has run dry."""
    robot, charges = one(event), charges_of(now)
    left = charges.left.get(robot)
    is_so = left is not None and left <= ROUNDING * battery_of(now, robot).lasts
    need(is_so, f"{now.names.robot(robot)} has not run dry")
    now.dry.add(robot)
    stand_still(now, robot, event)


def settle_charges(now: Standing, later: float) -> None:
    """Check that who could charge does, and that who is full before a later moment is done."""
    charges = charges_of(now)
    for robot, charger in charges.goes_to.items():
        if robot in charges.queued and _is_room(now, charges, charger):
            raise BrokenRuleError(f"{now.names.robot(robot)} can charge, and does not")
        if robot in charges.queued and robot not in charges.waits:
            raise BrokenRuleError(f"{now.names.robot(robot)} waits to charge, and nothing says so")
    for robot, (until, _) in charges.full.items():
        if until < later and not is_near(until, later):
            raise BrokenRuleError(
                f"{now.names.robot(robot)} is full at {until:.9g}, and the record goes on"
            )


def charges_of(now: Standing) -> Charges:
    """Return the charges of a mission with batteries."""
    if now.charges is None:
        raise BrokenRuleError("somebody charges, and nobody has a battery")
    assert isinstance(now.charges, Charges)
    return now.charges


def begun_by(now: Standing, event: Event) -> int:
    """Return the event with which a robot began to charge."""
    return charges_of(now).full.get(one(event), (0.0, NOBODY))[1]


def freed(now: Standing, event: Event) -> Iterator[int]:
    """Return the events of this moment that leave room where a robot begins to charge."""
    number = now.count - 1
    while number >= 0 and now.events[number].at == event.at:
        other = now.events[number]
        if other.kind in ("charged", "lost", "empty") and other.place == event.place:
            yield number
        number -= 1
