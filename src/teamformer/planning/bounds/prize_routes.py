"""The route of one robot that collects the most in time, each stop worth its prize.

Such routes may come back to a stop, unless it lies near all stops in between: they are the
ng-routes of Baldacci, Mingozzi and Roberti, "New route relaxation and pricing strategies for the
vehicle routing problem" (Operations Research 2011), worked out backwards in time. So what they
collect is no less than what the best route without a second visit does.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import allocating_kernel, entry

NOTHING = -1
"""The worth of what cannot be done in time."""

END = -1
"""After the last stop."""

LONG = 2**40
"""More than any leg."""


class Stops(NamedTuple):
    """Where robots of one kind can stop, and when; times are in any unit."""

    legs: Array  # (stops, stops) time from the end of one stop to the arrival at the next
    ready: Array  # (stops,) no stop begins before
    stay: Array  # (stops,) time
    home: Array  # (stops,) time that is left after the end of a last stop
    bit: Array  # (stops, stops) of the second's place in the memory of the first, or -1
    carried: Array  # (stops, stops, memories) memory at the second of what the first remembers


class Outlook(NamedTuple):
    """What can still be collected, by time, stop and memory (a set of stops as bits)."""

    worth: Array  # (times, stops, memories) prizes from this stop on, NOTHING if it is too late
    then: Array  # (times, stops, memories) next stop and its memory as one number, or END


def make_stops(
    legs: Array, ready: Array, stay: Array, home: Array, place: Array, memory: int
) -> Stops:
    """Return stops each of which remembers so many other places, the nearest.

    `place` (stops,) numbers the places; stops in one place, of different lengths, exclude one
    another.
    """
    count, places = len(legs), np.unique(place)
    memory = min(memory, len(places) - 1)
    is_in = place == places[:, None]  # (places, stops)
    legs = legs.astype(np.int64)
    apart = np.where(is_in, np.minimum(legs, legs.T)[:, None], LONG)
    apart = apart.min(axis=2)  # (stops, places)
    apart[is_in.T] = LONG
    near = places[np.argsort(apart, axis=1, kind="stable")[:, :memory]]  # (stops, memory)
    bit = np.full((count, count), -1, np.int64)
    for at in range(memory):
        bit[place == near[:, [at]]] = at
    carried = np.zeros((count, count, 1 << memory), np.int16)
    _carry(place, near, bit, carried)
    ready, stay, home = (times.astype(np.int64) for times in (ready, stay, home))
    return Stops(legs, ready, stay, home, bit, carried)


@entry
def _carry(place: Array, near: Array, bit: Array, carried: Array) -> None:
    """Work out what each stop remembers of another's memory, that other one's place included."""
    count, memory = near.shape
    onward = np.zeros(memory, np.int64)
    for stop in range(count):
        for following in range(count):
            own = np.int64(0) if bit[following, stop] < 0 else np.int64(1) << bit[following, stop]
            for at in range(memory):
                other = np.argmax(place == near[stop, at])
                is_kept = bit[following, other] >= 0
                onward[at] = np.int64(1) << bit[following, other] if is_kept else np.int64(0)
            for memories in range(1 << memory):
                kept = own
                for at in range(memory):
                    if memories >> at & 1:
                        kept |= onward[at]
                carried[stop, following, memories] = kept


def empty_outlook(stops: Stops, deadline: int) -> Outlook:
    """Return room for all that can be collected by a deadline."""
    shape = (deadline + 2, len(stops.ready), stops.carried.shape[2])
    return Outlook(np.empty(shape, np.int64), np.empty(shape, np.int32))


@entry
def look_ahead(stops: Stops, prizes: Array, deadline: int, outlook: Outlook) -> None:
    """Work out what can be collected from each time and stop on until the deadline.

    `prizes` (stops,) are whole numbers, so that sums are exact. Time runs backwards: what is
    known of a stop is handed to all that may come before it, unless a smaller memory is worth as
    much or the same could be had later. Where stops and legs take no time a route makes several
    stops at one moment, so these are gone through until nothing is worth more, at most as often as
    there are stops.
    """
    worth, then = outlook
    count = worth.shape[1]
    in_turn = _stops_at_once(stops)
    worth[: deadline + 2] = NOTHING
    for time in range(deadline, -1, -1):
        for _ in range(in_turn):
            is_more_before = False
            for stop in range(count):
                if time >= stops.ready[stop]:
                    is_more_before |= _hand_back(stops, prizes, time, stop, deadline, worth, then)
            if not is_more_before:
                break


@allocating_kernel
def _stops_at_once(stops: Stops) -> int:
    """Return how many stops a route may make at one moment: 1, or all if some take no time."""
    count = len(stops.ready)
    for stop in range(count):
        for following in range(count):
            if stop != following and stops.stay[stop] + stops.legs[stop, following] == 0:
                return count
    return 1


@allocating_kernel
def _hand_back(
    stops: Stops,
    prizes: Array,
    time: int,
    stop: int,
    deadline: int,
    worth: Array,
    then: Array,
) -> bool:
    """Hand what is known of a stop at a time to all that may come before it.

    Returns whether some of these are at the same time, and are worth more now.
    """
    legs, ready, stay, home, bit, carried = stops
    count, memories = worth.shape[1:]
    is_more = False
    for memory in range(memories):
        if worth[time + 1, stop, memory] > worth[time, stop, memory]:
            worth[time, stop, memory] = worth[time + 1, stop, memory]
            then[time, stop, memory] = then[time + 1, stop, memory]
    is_last = time + stay[stop] + home[stop] == deadline
    if is_last and prizes[stop] > worth[time, stop, 0]:
        worth[time, stop, 0] = prizes[stop]
        then[time, stop, 0] = END
    for memory in range(memories):
        value = worth[time, stop, memory]
        if value == NOTHING or value == worth[time + 1, stop, memory]:
            continue
        if _is_dominated(worth[time, stop], memory, value):
            continue
        for before in range(count):
            at = time - legs[before, stop] - stay[before]
            if before == stop or at < ready[before]:
                continue
            if bit[stop, before] >= 0 and memory >> bit[stop, before] & 1:
                continue
            onward = carried[stop, before, memory]
            if value + prizes[before] > worth[at, before, onward]:
                worth[at, before, onward] = value + prizes[before]
                then[at, before, onward] = stop * memories + memory
                is_more |= at == time
    return is_more


@allocating_kernel
def _is_dominated(worth: Array, memory: int, value: int) -> bool:
    """Say whether a part of a memory is worth as much; `worth` is by memory."""
    part = (memory - 1) & memory
    while memory > 0:
        if worth[part] >= value:
            return True
        if part == 0:
            return False
        part = (part - 1) & memory
    return False


@entry
def collect(stops: Stops, outlook: Outlook, arrive: Array, deadline: int, visits: Array) -> int:
    """Return the most that a robot can collect; count its visits on the way.

    `arrive` (stops,) is when it can be at each stop first; `visits` (stops,) is overwritten.
    """
    worth, then = outlook
    memories = worth.shape[2]
    visits[:] = 0
    most, stop, memory, time = 0, END, 0, 0
    for first in range(len(arrive)):
        begin = max(arrive[first], stops.ready[first])
        for set_ in range(memories if begin <= deadline else 0):
            if worth[begin, first, set_] > most:
                most = worth[begin, first, set_]
                stop, memory, time = first, set_, begin
    at_once, before = 0, NOTHING
    while stop != END and at_once <= len(arrive):  # else it goes round in no time
        visits[stop] += 1
        onward = then[time, stop, memory]
        if onward == END:
            break
        following, memory = onward // memories, onward % memories
        before = time
        time += stops.stay[stop] + stops.legs[stop, following]
        time = max(time, stops.ready[following])
        at_once = at_once + 1 if time == before else 0
        stop = following
    return most
