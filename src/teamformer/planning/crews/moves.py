"""Changes to lists of tasks that a search tries: where they come from and what they give."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import kernel
from teamformer.planning.crews.routes import slowest_of
from teamformer.world.rules.chance import draw_below
from teamformer.world.rules.constants import NOBODY

if TYPE_CHECKING:
    from teamformer.planning.crews.local_search import CrewSearch
    from teamformer.planning.crews.routes import CrewRoutes

LONGEST_STRETCH = 3
"""How many tasks in a row are moved at once at most."""


@kernel
def change_lists(search: CrewSearch) -> Any:
    """Draw a change; write the lists that it gives to `room.first` and `room.second`.

    Return the two crews, the same twice if only one list changes, and the lengths of the new
    lists; a first crew NOBODY if nothing came of it.
    """
    lists, near, random = search.lists, search.near, search.room.random
    if draw_below(random, 2) == 0:
        slowest = slowest_of(lists)
        task = lists.tasks[slowest, draw_below(random, lists.length[slowest])]
    else:
        task = draw_below(random, len(lists.crew))
    beside = near[task, draw_below(random, near.shape[1])]
    kind = draw_below(random, 8)
    if kind < 4 or beside == NOBODY:
        return _move(search, task, beside)
    if kind < 6:
        return _turn(search, task, beside)
    return _swap(search, task, beside)


@kernel
def _move(search: CrewSearch, task: int, beside: int) -> Any:
    """Move a stretch that begins with a task beside another one, or now and then anywhere."""
    lists, room, random = search.lists, search.room, search.room.random
    one, begin = lists.crew[task], lists.position[task]
    if beside == NOBODY or draw_below(random, 8) == 0:
        other = draw_below(random, len(lists.length))
        gap = draw_below(random, lists.length[other] + 1)
    else:
        other = lists.crew[beside]
        gap = lists.position[beside] + draw_below(random, 2)
    length = min(1 + draw_below(random, LONGEST_STRETCH), lists.length[one] - begin)
    end, is_turned = begin + length, draw_below(random, 2) == 0
    if one == other and begin <= gap <= end:
        return NOBODY, other, 0, 0
    if one != other and not _can_do(search, other, one, begin, end):
        return NOBODY, other, 0, 0
    target = room.first if one == other else room.second
    count = 0
    for position in range(lists.length[other] + 1):
        if position == gap:
            for place in range(length):
                moved = end - 1 - place if is_turned else begin + place
                target[count] = lists.tasks[one, moved]
                count += 1
        is_gone = one == other and begin <= position < end
        if position < lists.length[other] and not is_gone:
            target[count] = lists.tasks[other, position]
            count += 1
    if one == other:
        return one, one, count, count
    left = 0
    for position in range(lists.length[one]):
        if not begin <= position < end:
            room.first[left] = lists.tasks[one, position]
            left += 1
    return one, other, left, count


@kernel
def _can_do(search: CrewSearch, number: int, owner: int, begin: int, end: int) -> bool:
    """Say whether a crew can do a stretch of another one's list."""
    for position in range(begin, end):
        if not search.is_able[number, search.lists.tasks[owner, position]]:
            return False
    return True


@kernel
def _turn(search: CrewSearch, task: int, beside: int) -> tuple[Any, Any, Any, Any]:
    """Reverse the stretch between two tasks (2-opt), or let two lists cross over there."""
    lists, room = search.lists, search.room
    one, other = lists.crew[task], lists.crew[beside]
    begin, end = lists.position[task], lists.position[beside]
    if one != other:
        return _cross_over(search, one, begin + 1, other, end)
    begin, end = min(begin, end), max(begin, end)
    for position in range(lists.length[one]):
        is_turned = begin <= position <= end
        source = begin + end - position if is_turned else position
        room.first[position] = lists.tasks[one, source]
    return one, one, lists.length[one], lists.length[one]


@kernel
def _cross_over(search: CrewSearch, one: int, cut: int, other: int, other_cut: int) -> Any:
    """Exchange what comes from a cut on in each of two lists."""
    lists, room = search.lists, search.room
    if not _can_do(search, other, one, cut, lists.length[one]):
        return NOBODY, other, 0, 0
    if not _can_do(search, one, other, other_cut, lists.length[other]):
        return NOBODY, other, 0, 0
    count = _splice(lists, one, cut, other, other_cut, room.first)
    return one, other, count, _splice(lists, other, other_cut, one, cut, room.second)


@kernel
def _splice(
    lists: CrewRoutes, one: int, cut: int, other: int, other_cut: int, target: Array
) -> Any:
    """Write the beginning of one list and the end of another; return how long that is."""
    count = 0
    for position in range(cut):
        target[count] = lists.tasks[one, position]
        count += 1
    for position in range(other_cut, lists.length[other]):
        target[count] = lists.tasks[other, position]
        count += 1
    return count


@kernel
def _swap(search: CrewSearch, task: int, beside: int) -> Any:
    """Swap a task with the one after another, so that it comes beside that."""
    lists, is_able, room = search.lists, search.is_able, search.room
    one, other = lists.crew[task], lists.crew[beside]
    begin, end = lists.position[task], lists.position[beside] + 1
    if end == lists.length[other]:
        end -= 2
    if end < 0 or (one == other and begin == end):
        return NOBODY, other, 0, 0
    partner = lists.tasks[other, end]
    if not (is_able[other, task] and is_able[one, partner]):
        return NOBODY, other, 0, 0
    for position in range(lists.length[one]):
        room.first[position] = lists.tasks[one, position]
    for position in range(lists.length[other]):
        room.second[position] = lists.tasks[other, position]
    room.first[begin] = partner
    if one == other:
        room.first[end] = task
    else:
        room.second[end] = task
    return one, other, lists.length[one], lists.length[other]
