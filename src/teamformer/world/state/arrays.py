"""The arrays that the kernels work on: a batch of worlds, and one world in it.

Everything about one robot, team, task or cell is one record, so that a kernel reads
`world.teams[team].task`. Worlds of different sizes share a batch by padding: a padded robot is in
no team, a padded task is never open.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.rows import row_taker
from teamformer.world.rules.constants import NEVER

LATEST = NEVER - 1
"""The latest step that arrays know; it is later than any step limit."""

RUNNING, COMPLETED, STEP_LIMIT, INFEASIBLE, TOO_LATE = range(5)
STATUS_NAMES = ("running", "completed", "step limit", "infeasible", "too late")

RESOLVE, NEAREST = 0, 1
"""What happens to the order when tasks appear: a new tour, or each after its nearest."""

SCOUTING = 2
"""By this one of `mission.rules.FORESIGHTS` searches for tasks look ahead."""

START, APPEARED, LOST, BROKEN_OFF, BACK = 1, 2, 4, 8, 16
SHOWN, OVERDUE, FOUND, CANCELLED, DONE = 32, 64, 128, 256, 512
"""News, in bits, in the order of `coordination.NEWS`."""

ANYWHERE = -1
"""The region of robots that fly over walls: they get to every one."""

RULES = np.dtype(
    [
        ("robots", np.int32),  # how many there are
        ("tasks", np.int32),
        ("width", np.int32),  # cells; on a plane they only serve to look around
        ("height", np.int32),
        ("forming_steps", np.int32),
        ("step_limit", np.int32),
        ("new_tasks", np.int32),  # RESOLVE or NEAREST
        ("is_coordinated", np.bool_),  # a coordinator plans; else the paper's order and allocator
        ("foresight", np.int32),  # which of `mission.rules.FORESIGHTS`
        ("hides_needs", np.bool_),  # what some tasks need is not known
        ("hides_places", np.bool_),  # where some tasks are is not known
        ("has_delays", np.bool_),  # robots stand still now and then, in shifts as well
        ("has_loads", np.bool_),  # some tasks are carried
        ("has_walls", np.bool_),
        ("is_plane", np.bool_),
        ("sensing_radius", np.float64),  # cells, on a plane metres
        ("join_radius", np.float64),
        ("finding_radius", np.float64),
        ("start_x", np.float64),  # the place at the robots' centroid, where the first tour begins
        ("start_y", np.float64),
        ("arrival_radius", np.float64),  # teams so near to each other are in the same place
        ("unit", np.float64),  # the length that counts as one cell for a learned policy
        ("cells_per_length", np.float64),  # 1 on a grid
        ("until", np.int32),  # the step after which the mission is over, or NEVER
        ("has_shifts", np.bool_),  # some robots work in shifts only
        ("has_batteries", np.bool_),  # some robots have to charge
        ("chargers", np.int32),
    ],
    align=True,
)
COUNT = np.dtype(
    [
        ("steps", np.int32),
        ("open", np.int32),  # tasks in the order: to be shared out, neither done nor called off
        ("arrived", np.int32),  # of these, tasks that the order does not know yet
        ("done", np.int32),
        ("cancelled", np.int32),
        ("orders", np.int32),  # how often the order was made
        ("news", np.int32),  # what has happened that no coordinator was told yet, in bits
        ("joins", np.int32),
        ("splits", np.int32),
        ("illegal", np.int32),
        ("status", np.int32),
        ("missed", np.int32),
    ],
    align=True,
)
ROBOT = np.dtype(
    [
        ("team", np.int32),  # slot of its team, or NOBODY while lost
        ("formed", np.int32),  # the same after this step's formations, before its losses
        ("region", np.int32),  # connected part of the map; ANYWHERE for one that flies over walls
        ("lost", np.int32),  # the step it counts for nothing from, now or next, or NEVER
        ("back", np.int32),  # the step it is there again from after that, or NEVER
        ("x", np.float64),  # where it was lost
        ("y", np.float64),
        ("delay", np.float64),  # with what probability it stands still in a step
        ("luck", np.uint64),  # state of the random numbers that say in which
        ("stays", np.bool_),  # in the split being made
        ("next", np.int32),  # the task that it is to do next by its coordinator's plan, or NOBODY
        ("pace", np.float64),  # cells a step, on a plane metres a step
        ("every", np.int32),  # steps after which its shifts come again, or 0
        ("over", np.int32),  # steps made when its last shift ends, or NEVER
        ("lasts", np.float64),  # what its battery holds, in steps that it walks alone; 0: has none
        ("left", np.float64),  # what it has left
        ("filled", np.float64),  # what it charges in a step
        ("serving", np.float64),  # what a step of service takes
        ("waiting", np.float64),  # what a step of waiting at a task takes
        ("queued", np.int32),  # steps made when it came to its charger, or NOBODY
        ("charges", np.bool_),  # it has a place at its charger
    ],
    align=True,
)
TEAM = np.dtype(
    [
        ("x", np.float64),
        ("y", np.float64),
        ("pace", np.float64),  # of the slowest member
        ("credit", np.float64),  # fraction of a cell walked
        ("size", np.int32),  # robots; 0 where the slot has no team
        ("region", np.int32),  # of its robots on the ground; ANYWHERE if all fly over walls
        ("task", np.int32),  # assignment, or NOBODY
        ("serves", np.int32),  # how many tasks it is serving
        ("charger", np.int32),  # where it charges before it goes on, or NOBODY
        ("charges_for", np.int32),  # the task before which it has asked whether to, or NOBODY
        ("is_detour", np.bool_),  # the assignment was taken out of order
        # What follows lasts for one step.
        ("is_delayed", np.bool_),  # one of its robots stands still
        ("has_walked", np.bool_),
        ("has_formed", np.bool_),
        ("is_commanded", np.bool_),  # its decision names tasks: the allocator leaves it alone
        ("intent", np.int32),  # MAINTAIN, SPLIT or JOIN
        ("partner", np.int32),  # whom it wants to join
        ("row", np.int32),  # of its decision
        ("pursued", np.int32),  # assignment during the step
        ("next_here", np.int32),  # the next team in the same cell
        ("next", np.int32),  # the earliest of its robots' next tasks
    ],
    align=True,
)
TASK = np.dtype(
    [
        ("x", np.float64),
        ("y", np.float64),
        ("duration", np.int32),  # steps that it is expected to take
        ("longest", np.int32),  # steps that it takes at most
        ("takes", np.int32),  # steps that it really takes
        ("appears", np.int32),  # steps made when it becomes known
        ("opens", np.int32),  # steps made when its window begins: it may begin in the next
        ("ordered_at", np.int32),  # steps made when it got its place in the order, or 0
        ("cancelled", np.int32),  # the step in which it is called off if it is not done, or NEVER
        ("awaits", np.int32),  # how many tasks that it comes after are not over
        ("region", np.int32),
        ("next_here", np.int32),  # the next task in the same cell
        ("rank", np.int32),  # place in the order while open
        ("server", np.int32),  # team that serves it, or NOBODY
        ("served", np.int32),  # steps of its service so far
        ("expected", np.int32),  # of how many its service is expected to be
        ("hides_needs", np.bool_),  # what it needs is not known
        ("shown_at", np.int32),  # the step in which it became known, or NOBODY
        ("hides_place", np.bool_),  # where it is is not known
        ("within", np.float64),  # how far it may be from where the mission has it
        ("reach", np.float64),  # how far from the first of the places that it may be in
        ("lies_in", np.int32),  # the place that it really is in, among those it may be in
        ("believed_in", np.int32),  # the place that it is believed to be in
        ("moved_at", np.int32),  # the step in which it was last believed elsewhere, or NOBODY
        ("found_at", np.int32),  # the step in which its place became known, or NOBODY
        ("is_load", np.bool_),  # it is taken up here, and brought to another place
        ("is_carried", np.bool_),  # it is under way, or being unloaded
        ("to_x", np.float64),  # where it is brought to
        ("to_y", np.float64),
        ("lies_x", np.float64),  # where it was set down
        ("lies_y", np.float64),
        ("unload", np.int32),  # steps
        ("ahead", np.int32),  # of how many its way and unloading are expected to be
        ("taken_at", np.int32),  # the step in which it was last taken up, or NOBODY
        ("left_at", np.int32),  # the step in which it was last set down elsewhere, or NOBODY
        ("done_at", np.int32),  # step, or NOBODY
        ("done_by", np.int32),  # slot
        ("is_open", np.bool_),  # known, and neither done, called off nor missed
        ("is_optional", np.bool_),  # it may be left out
        ("is_planned", np.bool_),  # its plan has it, be it for nobody yet, or does not know it
        ("missed_at", np.int32),  # the step after which it was not done any more, or NOBODY
        ("begun_at", np.int32),  # the step in which its service began
        ("is_in_zone", np.bool_),  # only so many of a zone that it is in are served at once
        ("is_brought_to_zone", np.bool_),  # only so many are served or unloaded where it goes
        ("is_unloading", np.bool_),  # it takes room there
        ("came_at", np.int32),  # the step since which it waits for room there, or NOBODY
        ("is_awaited", np.bool_),  # its plan has somebody do it who is there; only asked in zones
    ],
    align=True,
)
CELL = np.dtype([("first_task", np.int32), ("first_team", np.int32)], align=True)
ZONE = np.dtype(
    [
        ("room", np.int32),  # how many services go on in it at once
        ("taken", np.int32),  # of these by what is under way or has its turn, in this step
    ],
    align=True,
)
AREA = np.dtype(
    [
        ("zone", np.int32),  # whose area or place it is, or NOBODY
        ("left", np.float64),
        ("low", np.float64),
        ("right", np.float64),
        ("high", np.float64),
    ],
    align=True,
)
INSIDE, UNLOADS, NAMED = 1, 2, 4
"""How a task is in a zone: it takes room as it begins, or while its load is unloaded; by name."""

SPOT = np.dtype(
    [
        ("x", np.float64),
        ("y", np.float64),
        ("is_possible", np.bool_),  # the task may be here; False for padding too
    ],
    align=True,
)
CHARGER = np.dtype(
    [
        ("x", np.float64),
        ("y", np.float64),
        ("room", np.int32),  # robots that charge at once
        ("onward", np.float64),  # how far it is from here to where a team is going, by others
    ],
    align=True,
)


class Worlds(NamedTuple):
    """A batch of worlds: what they are and how they stand.

    A team is kept at its slot, the lowest robot number in it.
    """

    rules: Array  # (worlds,) RULES
    count: Array  # type: ignore[assignment]  # (worlds,) COUNT
    robots: Array  # (worlds, robots) ROBOT
    teams: Array  # (worlds, robots) TEAM
    tasks: Array  # (worlds, tasks) TASK
    cells: Array  # (worlds, cells) CELL
    spots: Array  # (worlds, tasks, places) SPOT where tasks may be, or (worlds, 0, 0)
    absences: Array  # (worlds, robots, times, 2) when it is lost and back; none if no one is twice
    brings: Array  # (worlds, robots, caps) counts of each robot, in units as all counts
    has: Array  # (worlds, robots, caps) counts of each team
    needs: Array  # (worlds, tasks, caps) as everybody believes
    sure_needs: Array  # (worlds, tasks, caps), or (worlds, 0, 0) if all needs are
    true_needs: Array  # the same: what they really are
    expected_needs: Array  # the same: what is believed while nobody knows, if robots can bring it
    may_need: Array  # the same: with what probability one more is needed
    precedes: Array  # (worlds, tasks, tasks) which are done before which, or (worlds, 0, 0)
    demand: Array  # (worlds, caps) open tasks that need each capability
    order: Array  # (worlds, tasks) tasks to be shared out, the first count.open of them
    blocked: Array  # (worlds, height, width), or (worlds, 0, 0) if no world has walls
    fields: Array  # (worlds, tasks, height, width) distances to tasks, or (worlds, 0, 0, 0);
    # with loads twice as many rows: then come the distances to where each is brought
    near: Array  # (worlds, robots) teams found nearby
    near_key: Array  # (worlds, robots) what these are sorted by
    room: Array  # (worlds, caps) what still fits into a split
    here: Array  # (worlds, tasks) tasks found where a team is
    shifts: Array  # (worlds, robots, most, 2) when each shift begins and ends, then NEVER; or
    # (worlds, robots, 0, 2) if everybody always works
    chargers: Array  # (worlds, chargers) CHARGER
    wanted: Array  # (worlds, robots, tasks) what each has to have left there, or (worlds, 0, 0)
    to_charger: Array  # (worlds, chargers, height, width) distances, or (worlds, 0, 0, 0)
    zones: Array  # (worlds, zones) ZONE, none if no world has any
    inside: Array  # (worlds, zones, tasks) INSIDE, UNLOADS and NAMED: which are in which zone
    areas: Array  # (worlds, areas) AREA


if TYPE_CHECKING:
    World = Any
else:
    World = Worlds
"""The same fields for one world, without the leading axis: `world.teams[team].task`.

What kernels read out of records has no type but numba's.
"""

world_at = row_taker(Worlds)
"""Return one world of a batch; writing to it writes to the batch."""
