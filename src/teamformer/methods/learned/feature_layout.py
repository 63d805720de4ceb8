"""What each number of a token says, by name: the layout of all features that networks read.

Shares are from 0 to 1, distances in cells (on planes in units) clipped and scaled, the rest is true
or false. `docs/explanation/networks.md` and `docs/explanation/learning.md` say what they are for.
"""

from __future__ import annotations

from enum import IntEnum


class OwnRelation(IntEnum):
    """Features of the deciding team, in relations."""

    IS_ALONE = 0
    SIZE = 1
    COUNTS = 2
    HAS_NO_TASK = 3
    IS_AT_TASK = 4
    SEEN = 5  # teams in sight
    HERE = 6  # of these, in the same place
    JOINABLE = 7
    HAS_ODD_RANK_HERE = 8  # an odd number of lower slots in the same place
    RANK_HERE = 9
    OPEN_TASKS = 10  # in view
    TASKS_ALONE = 11  # share of them that it can do alone
    FIRST_COVERED = 12  # share of the first task in view that it covers
    FIRST_DISTANCE = 13
    CAN_HALVE = 14
    CAN_SHED = 15
    REST_AFTER_HALVING = 16  # share of the tasks in view that those who go could do alone
    REST_AFTER_SHEDDING = 17
    HAS_CREWS = 18  # always 0: of a way to coordinate that shipped weights still know
    PACE = 19
    SCRIPT_FORMS = 20  # maintaining is something else than what the script wants
    SCRIPT_JOINS = 21  # somebody in view


class TeamRelation(IntEnum):
    """Features of a team in sight, in relations."""

    DISTANCE = 0
    IS_HERE = 1
    CAN_JOIN = 2
    HAS_LOWER_SLOT = 3
    HAS_NO_TASK = 4
    SHARES_TASK = 5
    HAS_OF_MINE = 6  # share of my counts that it has too
    HAVE_OF_THEIRS = 7  # share of its counts that I have too
    ADDS_TO_MINE = 8  # share of my task that it adds
    COMPLETES_MINE = 9
    COVERS_MINE = 10  # share of my task that it covers alone
    GAINS_FROM_ME = 11  # share of its task that I add
    IS_COMPLETED_BY_ME = 12
    DOES_ITS_OWN = 13  # alone
    HAS_EARLIER_TASK = 14
    TASKS_GAINED = 15  # that both can do together and neither alone
    TASKS_SHARED = 16  # that either can do alone
    ADDS_ANYTHING = 17
    IS_PAIRED = 18  # the one to pair off with
    NEARNESS = 19
    IS_MATE = 20  # always 1, likewise
    SCRIPT_JOINS = 21  # it is whom the script would join
    WAY_TO_ITS_TASK = 22
    NEARNESS_OF_ITS_TASK = 23
    WAY_BETWEEN_TASKS = 24


class TaskRelation(IntEnum):
    """Features of a task in view, in relations."""

    IS_MINE = 0
    RANK = 1
    DISTANCE = 2
    IS_HERE = 3
    COVERED = 4  # share of the needs that the team covers
    IS_COVERED = 5
    HELPS = 6  # the team has anything of it
    SURPLUS = 7  # share of the team's counts that it does not need
    FROM_FIRST = 8  # distance from the first task in view
    NEEDS = 9
    HELPERS = 10  # teams in sight that head there
    HELPERS_HERE = 11
    COVERED_BY_HELPERS = 12
    COVERED_WITH_ME = 13
    IS_COVERED_WITH_ME = 14
    REST_DOES_ALONE = 15  # tasks that those who are not needed here could do alone
    REST_HELPS = 16  # tasks of which they have anything
    CAN_SPLIT_FOR = 17
    NEARNESS = 18
    WAY_SAVED = 19  # by those who go straight to the next task that needs them
    WAY_SAVED_NEAR = 20
    NEXT_IS_DONE_BY_REST = 21
    NEXT_NEEDS_STAYERS = 22
    NEXT_DISTANCE = 23


class PlaceToken(IntEnum):
    """The first features of each token of the paper's networks: where it is."""

    AWAY_X = 0
    AWAY_Y = 1
    AWAY = 2
    IS_HERE = 3
    IS_ONE_AWAY = 4
    IS_TWO_AWAY = 5
    IN_BOX_X = 6  # relative to the box around all that is in view
    IN_BOX_Y = 7


class OwnToken(IntEnum):
    """Features of the deciding team, after its place."""

    IS_SELF = 8
    HAS_NO_TASK = 9
    IS_AT_TASK = 10
    HERE = 11  # teams in the same place
    HAS_ODD_RANK_HERE = 12
    RANK_HERE = 13
    COUNTS = 14
    IS_ALONE = 15


class SeenToken(IntEnum):
    """Features of a team in sight, after its place; the network tells it apart by `IS_SELF`."""

    HAS_NO_TASK = 9
    SHARES_TASK = 10
    CAN_JOIN = 11
    HAS_LOWER_SLOT = 12
    COUNTS = 14
    ADDS_TO_FIRST = 15  # to the first task in view
    COMPLETES_FIRST = 16
    TASKS_HELPED = 17
    TASKS_COMPLETED = 18
    IS_PAIRED = 19


class TaskToken(IntEnum):
    """Features of a task in view, after its place."""

    IS_MINE = 8
    RANK = 9
    IS_FIRST_IN_ORDER = 10
    IS_FIRST_IN_VIEW = 11
    COVERED = 12
    IS_COVERED = 13
    HELPS = 14
    HAS_SURPLUS = 15
    HELPERS = 16
    COVERED_TOGETHER = 17  # with those seen heading there
    NEEDS = 18
