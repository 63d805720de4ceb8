"""The view that a policy gets of what one robot knows: as in the simulator, for one team.

The own team is the robots whose fresh words name this one as their lowest, wherever they are on
the way; other teams are seen by the fresh words of their robots within the sensing radius. Tasks
are numbered as this robot learned of them.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from teamformer.fleet.agent.knowledge import Knowledge
from teamformer.fleet.messages import SERVE, Word
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.plane import Plane
from teamformer.world.rules.constants import NOBODY
from teamformer.world.view import NEAREST_TEAMS, NEXT_TASKS, View, make_view


class Company(NamedTuple):
    """Robots that stand or go together, by their words; `lead` is the lowest of them."""

    lead: int
    robots: tuple[int, ...]
    place: Place
    goal: int
    is_serving: bool


def companies(words: Iterable[Word]) -> list[Company]:
    """Return the teams that words tell of, by their lowest robots that are in sight."""
    teams: dict[int, list[Word]] = {}
    for word in words:
        teams.setdefault(word.team, []).append(word)
    found = []
    for members in teams.values():
        members.sort(key=lambda word: word.robot)
        first = members[0]
        robots = tuple(word.robot for word in members)
        is_serving = any(word.phase == SERVE for word in members)
        found.append(Company(first.robot, robots, (first.x, first.y), first.goal, is_serving))
    return sorted(found)


def view_of(
    knowledge: Knowledge, own: Company, seen: Sequence[Company], order: Sequence[int]
) -> View:
    """Return the view of the team `own`; `seen` are others, `order` the open tasks in order."""
    mission, source = knowledge.mission, knowledge.mission.source
    caps, world = len(source.capabilities), source.world
    number = {key: place for place, key in enumerate(knowledge.tasks)}
    has_loads = any(task.to is not None for task in mission.tasks)
    room = make_view(1, mission.robots, max(1, len(number)), caps, has_loads=has_loads)
    view = View(*(part[:1] for part in room))._replace(
        first_member=np.array([0, len(own.robots)]),
        member=np.array(own.robots, np.int32),
        member_counts=np.array([mission.brings[r] for r in own.robots], np.int32).reshape(-1, caps),
    )
    view.slot[0], view.place[0], view.size[0] = own.lead, own.place, len(own.robots)
    view.counts[0] = view.member_counts.sum(axis=0)
    is_at_task = own.goal in number and mission.is_same_place(
        *own.place, *knowledge.place_of(own.goal)
    )
    view.task[0], view.is_at_task[0] = number.get(own.goal, NOBODY), is_at_task
    view.is_serving[0] = own.is_serving
    view.unit[0] = world.unit if isinstance(world, Plane) else 1.0
    view.arrival_radius[0] = mission.radius
    view.pace[0] = min(mission.paces[robot] for robot in own.robots) * mission.step
    for column, team in enumerate(nearest_first(knowledge, own, seen)[: view.seen_slot.shape[1]]):
        _write_seen(knowledge, view, column, own, team, number)
    view.seen_slot[0, min(len(seen), NEAREST_TEAMS) :] = NOBODY
    view.seen_task[0, min(len(seen), NEAREST_TEAMS) :] = NOBODY
    view.task_number[0] = NOBODY
    shown = [own.goal] if own.goal in order else []
    shown += [key for key in order if key != own.goal]
    for column, key in enumerate(shown[: min(NEXT_TASKS, view.task_number.shape[1])]):
        task = knowledge.tasks[key]
        view.task_number[0, column], view.task_rank[0, column] = number[key], order.index(key)
        view.task_place[0, column] = knowledge.place_of(key)
        view.task_needs[0, column] = mission.in_units(task.needs)
        if has_loads:
            view.task_to_place[0, column] = task.to or knowledge.place_of(key)
    return view


def _write_seen(
    knowledge: Knowledge,
    view: View,
    column: int,
    own: Company,
    team: Company,
    number: dict[int, int],
) -> None:
    mission = knowledge.mission
    view.seen_slot[0, column], view.seen_place[0, column] = team.lead, team.place
    view.seen_counts[0, column] = np.sum([mission.brings[robot] for robot in team.robots], axis=0)
    view.seen_task[0, column] = number.get(team.goal, NOBODY)
    view.is_here[0, column] = mission.is_same_place(*own.place, *team.place)
    is_busy = own.is_serving or team.is_serving
    reach = max(mission.source.join_radius, mission.radius)
    view.can_join[0, column] = not is_busy and math.dist(own.place, team.place) <= reach
    view.can_go_with[0, column] = True  # each robot finds its own way


def nearest_first(knowledge: Knowledge, own: Company, seen: Iterable[Company]) -> list[Company]:
    """Return other teams as views have them: near first, then those that help, by task, by slot."""
    mission, goal = knowledge.mission, knowledge.tasks.get(own.goal)
    have = np.sum([mission.brings[robot] for robot in own.robots], axis=0)
    lacking = have < (have if goal is None else mission.in_units(goal.needs))  # (caps,)

    def key(team: Company) -> tuple[float, int, int]:
        away = math.dist(own.place, team.place)
        if mission.is_same_place(*own.place, *team.place):
            away = -1.0  # all in the same place are equally near
        brings = np.sum([mission.brings[robot] for robot in team.robots], axis=0) > 0
        use = (0 if team.goal == own.goal else 1) if (lacking & brings).any() else 2
        return away, use, 2 * abs(team.lead - own.lead) + (team.lead > own.lead)

    return sorted(seen, key=key)
