"""A slow twin of the simulator: the step rules in plain Python, without any of its kernels."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass, field
from decimal import Decimal
from functools import cache
from itertools import pairwise

from teamformer.mission.arrivals import with_arrivals
from teamformer.mission.checks.rules import LIKELY
from teamformer.mission.model import Mission, Robot
from teamformer.mission.parts.grid import Grid, Place
from teamformer.mission.parts.places import believed_place, possible_places
from teamformer.mission.parts.plane import Plane

NEVER = 10**9


def walk(grid: Grid, goal: Place) -> dict[Place, int]:
    """Return the distance of every cell that reaches the goal."""
    away, frontier = {goal: 0}, deque([goal])
    while frontier:
        cell = frontier.popleft()
        for beside in grid.neighbours(cell):
            if beside not in away:
                away[beside] = away[cell] + 1
                frontier.append(beside)
    return away


def sides(place: Place) -> list[Place]:
    x, y = place
    return [(x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1)]


def apart_squared(one: Place, other: Place) -> float:
    away_x, away_y = one[0] - other[0], one[1] - other[1]
    return away_x * away_x + away_y * away_y


def cells(one: tuple[int, int], other: tuple[int, int]) -> int:
    return abs(one[0] - other[0]) + abs(one[1] - other[1])


@cache
def thousandths(count: float) -> int:
    """Return a count as it is written, without the point."""
    return int(Decimal(str(count)).scaleb(3))


@dataclass
class PlainTeam:
    robots: list[int]
    at: Place
    task: int | None = None
    is_detour: bool = False
    credit: float = 0.0
    serving: dict[int, int] = field(default_factory=dict)  # task -> steps left
    formed: bool = False


class PlainWorld:
    """Teams by slot, and one method for each phase."""

    def __init__(
        self,
        mission: Mission,
        truth: Mission | None = None,
        is_coordinated: bool = False,
        foresight: str = "scouting",
    ) -> None:
        self.is_coordinated, self.foresight = is_coordinated, foresight
        mission = with_arrivals(mission, truth or mission)
        self.s, self.truth = mission, truth or mission
        self.steps = 0
        self.hidden = {k for k, task in enumerate(mission.tasks) if task.may_need}
        self.hopes: dict[int, dict[str, int]] = {}  # what hidden tasks are believed to need
        self.at = [believed_place(mission.world, task) for task in mission.tasks]
        self.maybe = {  # where tasks may be that are not found, in the order of preference
            k: list(possible_places(mission.world, task.at, task.within))
            for k, task in enumerate(mission.tasks)
            if task.within
        }
        self.found: dict[int, int] = {}  # task -> step
        self.due: dict[int, int] = {}  # of services, how many steps they are expected to take
        self.overdue = self.lost = 0
        self.done: dict[int, int] = {}
        self.cancelled: dict[int, int] = {}
        self.known: set[int] = set()
        self.open: list[int] = []
        self.release()
        world = mission.world
        self.here = world.arrival_radius if isinstance(world, Plane) else 0.0
        self.teams = {
            team[0]: PlainTeam(list(team), mission.robots[team[0]].at)
            for team in mission.starting_teams
        }
        self.order: list[int] = []
        self.coalitions: dict[int, set[int]] = {}  # by task; plans are given, as the order is
        self.scouts: dict[int, int] = {}  # by robot; these too
        self.joins = self.splits = self.illegal = 0
        self.luck = {
            number: (robot.delays.seed * 2654435769 + 88172645463325252) % 2**64
            for number, robot in enumerate(self.truth.robots)
            if robot.delays is not None
        }
        self.lost_at: dict[int, Place] = {}
        self.carried: set[int] = set()  # loads under way; `serving` has steps at their goals left
        self.let_go: dict[int, Place] = {}  # loads set down in a step, and where
        self.hope()

    def has(self, team: PlainTeam) -> list[int]:
        return self.sum_of(team.robots)

    def sum_of(self, robots: list[int]) -> list[int]:
        can = [self.s.robots[r].can for r in robots]
        return [sum(thousandths(one.get(c, 0)) for one in can) for c in self.s.capabilities]

    def needs(self, task: int) -> list[int]:
        needs = self.hopes[task] if task in self.hidden else self.truth.tasks[task].needs
        return [thousandths(needs.get(c, 0)) for c in self.s.capabilities]

    def hope(self) -> None:
        """Believe what may be needed, as far as the robots that are left can bring it."""
        left = [robot for team in self.teams.values() for robot in team.robots]
        for task in self.hidden:
            wanted = self.s.tasks[task]
            needs = dict(wanted.needs)
            for cap, chance in wanted.may_need.items():
                robots = [r for r in left if self.is_way(self.s.robots[r], self.at[task])]
                have = sum(thousandths(self.s.robots[r].can.get(cap, 0)) for r in robots)
                more = thousandths(needs.get(cap, 0)) + 1000
                least = {"needed": 1e-300, "scouting": LIKELY}.get(self.foresight, 2.0)
                if chance >= least and have >= more:
                    needs[cap] = more / 1000
            self.hopes[task] = needs

    def is_way(self, robot: Robot, to: Place) -> bool:
        return robot.flies or self.s.world.region(robot.at) == self.s.world.region(to)

    def show(self) -> bool:
        found = {
            task
            for task in self.hidden & set(self.open)
            if any(self.is_at(team, task) for team in self.teams.values())
        }
        self.hidden -= found
        return bool(found)

    def find(self) -> bool:
        """Rule out what teams are near to; say whether a task is elsewhere than believed."""
        radius, any_news = max(self.s.finding_radius, self.here), False
        for task in sorted(self.maybe.keys() & set(self.open)):
            left = [
                place
                for place in self.maybe[task]
                if all(math.dist(t.at, place) > radius + 1e-9 for t in self.teams.values())
            ]
            before, self.maybe[task], believed = self.maybe[task], left, self.at[task]
            true = self.truth.tasks[task].at
            if true not in left:
                del self.maybe[task]
                self.found[task] = self.steps + 1
                any_news |= believed != true
                self.believe(task, true)
            if true not in left or not self.teams:
                continue
            seeker = min(
                self.teams.items(), key=lambda s: (self.micrometres(s[1].at, believed), s[0])
            )[1]
            if self.foresight == "scouting" and len(left) <= 100:
                if left != before:
                    self.believe(task, self.soonest(seeker.at, left, task))
            elif believed not in left:
                self.believe(task, min(left, key=lambda p: self.way(seeker, p)))
        return any_news

    def soonest(self, at: Place, left: list[Place], task: int) -> Place:
        """Return where to look next so that the task is reached soonest on average."""
        unit = self.s.world.unit if isinstance(self.s.world, Plane) else 1
        origin = possible_places(self.s.world, self.s.tasks[task].at, self.s.tasks[task].within)[0]
        start, *places = (
            (round((x - origin[0]) / unit), round((y - origin[1]) / unit)) for x, y in (at, *left)
        )
        radius = (max(self.s.finding_radius, self.here) + 1e-9) / unit

        def reached(first: tuple[int, int]) -> int:
            (x, y), target, unseen, total, steps = start, first, places, 0, 0
            while unseen:
                if target not in unseen:
                    target = min(unseen, key=lambda p: cells(p, (x, y)))
                if abs(target[0] - x) >= abs(target[1] - y):
                    x += 1 if target[0] > x else -1
                else:
                    y += 1 if target[1] > y else -1
                steps += 1
                seen = [p for p in unseen if math.hypot(p[0] - x, p[1] - y) <= radius]
                total += sum(steps + cells(p, (x, y)) for p in seen)
                unseen = [p for p in unseen if p not in seen]
            return total

        nearest = sorted(places, key=lambda p: cells(p, start))[:8]
        return left[places.index(min(nearest, key=reached))]

    def believe(self, task: int, place: Place) -> None:
        self.at[task] = place

    def way(self, team: PlainTeam, to: Place) -> int:
        if isinstance(self.s.world, Plane):
            return self.micrometres(team.at, to)
        return self.ways_to(to, team).get(team.at, NEVER)

    def travel(self, team: PlainTeam, task: int) -> int:
        return self.way(team, self.at[task])

    def micrometres(self, one: Place, other: Place) -> int:
        return round(math.dist(one, other) * 1e6)

    def is_same(self, one: Place, other: Place) -> bool:
        return apart_squared(one, other) <= self.here**2

    def release(self) -> None:
        """Make known what appears now."""
        news = [
            k
            for k, task in enumerate(self.s.tasks)
            if k not in self.known and k not in self.cancelled and self.steps >= task.appears
        ]
        self.known.update(news)
        self.open += news

    def has_opened(self, task: int) -> bool:
        """Say whether the window of a task has begun, and all before it was over a step ago."""
        between, after = self.s.tasks[task].between, self.s.tasks[task].after
        has_begun = between is None or self.steps >= between[0]
        over = {self.s.tasks[k].name: n for k, n in (self.done | self.cancelled).items()}
        return has_begun and all(over.get(name, self.steps + 1) <= self.steps for name in after)

    def shared_out(self) -> set[int]:
        """Return the tasks that plans have, all known ones, or the order: those that may begin."""
        return {task for task in self.open if self.is_coordinated or self.has_opened(task)}

    # One step. `wanted` has counts in thousandths for each slot; `order` is the shared order.

    def step(self, wanted: dict[int, list[int]], order: list[int]) -> None:
        for team in self.teams.values():
            team.formed = False
        split, join = self.read(wanted)
        for slot in sorted(split):
            self.split(slot, split[slot])
        walkers = self.join(join)
        for slot in sorted(self.teams):
            self.allocate(slot, order)
        self.move(walkers)
        any_cancelled = self.call_off()
        any_lost = self.lose()
        any_back = self.come_back()
        if any_lost or any_back:
            self.hope()
        any_found = self.find()
        any_shown = self.show()
        self.complete()
        shared_out = self.shared_out()
        self.steps += 1
        self.release()
        news = self.shared_out() - shared_out
        if news or any_lost or any_back or any_cancelled or any_found or any_shown:
            for team in self.teams.values():
                if team.task not in team.serving:
                    team.task, team.is_detour = None, False

    def read(self, wanted: dict[int, list[int]]) -> tuple[dict[int, list[int]], dict[int, int]]:
        split: dict[int, list[int]] = {}
        join: dict[int, int] = {}
        for slot, team in sorted(self.teams.items()):
            want, have = wanted[slot], self.has(team)
            if want == have:
                continue
            less = all(w <= h for w, h in zip(want, have, strict=True))
            more = all(w >= h for w, h in zip(want, have, strict=True))
            partner = self.partner(slot, want) if more else None
            if team.serving or not (less or more):
                self.illegal += 1
            elif less and self.stayers(team, want):
                split[slot] = self.stayers(team, want)
            elif partner is not None:
                join[slot] = partner
            else:
                self.illegal += 1
        return split, join

    def stayers(self, team: PlainTeam, want: list[int]) -> list[int]:
        staying: list[int] = []
        for robot in sorted(team.robots):
            together = self.sum_of([*staying, robot])
            if all(t <= w for t, w in zip(together, want, strict=True)):
                staying.append(robot)
        return staying

    def partner(self, slot: int, want: list[int]) -> int | None:
        team = self.teams[slot]
        found = []
        for other_slot, other in self.teams.items():
            away = apart_squared(team.at, other.at)
            reach = max(self.s.join_radius, self.here)
            if other_slot == slot or other.serving or away > reach**2:
                continue
            if self.sum_of(team.robots + other.robots) == want:
                shares = team.task is not None and team.task == other.task
                found.append((not self.are_mates(team, other), away, not shares, other_slot))
        return min(found)[3] if found else None

    def are_mates(self, team: PlainTeam, other: PlainTeam) -> bool:
        if not self.is_coordinated:
            return True
        tasks = [self.task_by_plan(part) for part in (team, other)]
        return tasks[0] is not None and tasks[0] == tasks[1]

    def split(self, slot: int, stay: list[int]) -> None:
        team = self.teams.pop(slot)
        rest = [r for r in team.robots if r not in stay]
        for robots in (stay, rest):
            self.teams[min(robots)] = PlainTeam(sorted(robots), team.at, formed=True)
        self.splits += 1

    def join(self, join: dict[int, int]) -> dict[int, int]:
        """Make the joins of teams that are together; return who walks to whom instead."""
        walkers = {}
        gone: set[int] = set()
        for slot, partner in sorted(join.items()):
            if slot in gone or self.teams[slot].formed:
                continue
            if partner in gone or self.teams[partner].formed:
                continue
            if self.is_same(self.teams[slot].at, self.teams[partner].at):
                gone.add(max(slot, partner))
                self.unite(slot, partner, order_rank=self.rank)
            else:
                walkers[slot] = partner
        apart = {slot: p for slot, p in walkers.items() if slot not in gone}
        return {slot: p for slot, p in apart.items() if not self.teams[slot].formed}

    def unite(self, slot: int, partner: int, order_rank: dict[int, int]) -> None:
        one, other = self.teams.pop(slot), self.teams.pop(partner)
        task = None
        any_free = one.task is None or other.task is None
        if not (any_free or one.is_detour or other.is_detour):
            task = min(one.task, other.task, key=lambda k: order_rank[k])
        robots = sorted(one.robots + other.robots)
        at = other.at
        if task is not None:
            goal = self.at[task]
            at = min(other.at, one.at, key=lambda place: apart_squared(place, goal))
        self.teams[robots[0]] = PlainTeam(robots, at, task, formed=True)
        self.joins += 1

    @property
    def rank(self) -> dict[int, int]:
        return {task: i for i, task in enumerate(self.order)}

    def allocate(self, slot: int, order: list[int]) -> None:
        self.order = order
        team = self.teams[slot]
        if self.is_coordinated and not team.serving:
            team.task, team.is_detour = self.task_by_plan(team), False
        if self.is_coordinated or team.task is not None or team.serving:
            return
        for i, task in enumerate(order):
            if self.contributes(team, task) and not self.is_covered(slot, task):
                detour = self.detour(slot, order, i)
                team.task = task if detour is None else detour
                team.is_detour = detour is not None
                return

    def task_by_plan(self, team: PlainTeam) -> int | None:
        """Return the earliest of what its robots scout or, else, have to do first."""
        mine = []
        for robot in team.robots:
            doing = [task for task in self.order if robot in self.coalitions[task]]
            mine += [self.scouts[robot]] if robot in self.scouts else doing[:1]
        return min(mine, key=self.order.index, default=None)

    def contributes(self, team: PlainTeam, task: int) -> bool:
        can_reach = self.travel(team, task) < NEVER
        pairs = zip(self.has(team), self.needs(task), strict=True)
        return can_reach and any(h > 0 and n > 0 for h, n in pairs)

    def covers(self, have: list[int], task: int) -> bool:
        return all(h >= n for h, n in zip(have, self.needs(task), strict=True))

    def is_covered(self, slot: int, task: int) -> bool:
        team = self.teams[slot]
        helpers: list[int] = []
        for other_slot, other in self.teams.items():
            sensing = max(self.s.sensing_radius, self.here)
            senses = apart_squared(team.at, other.at) <= sensing**2
            if other_slot != slot and senses and other.task == task:
                mine = (self.travel(team, task), slot)
                if (self.travel(other, task), other_slot) < mine:
                    helpers += other.robots
        return bool(helpers) and self.covers(self.sum_of(helpers), task)

    def detour(self, slot: int, order: list[int], i: int) -> int | None:
        team = self.teams[slot]
        best, best_change = None, 0
        for j in range(i + 1, len(order)):
            task = order[j]
            if not self.covers(self.has(team), task) or self.travel(team, task) >= NEVER:
                continue
            now = [team.at, *(self.at[k] for k in order[i:])]
            then = [now[0], now[j - i + 1], *now[1 : j - i + 1], *now[j - i + 2 :]]
            change = self.tour(then, team) - self.tour(now, team)
            if change < best_change and not self.is_covered(slot, task):
                best, best_change = task, change
        return best

    def tour(self, places: list[Place], team: PlainTeam) -> int:
        length = 0
        for here, there in pairwise(places):
            if isinstance(self.s.world, Plane):
                length += self.micrometres(here, there)
            else:
                length += self.ways_to(there, team).get(here, 2**30)
        return length

    def draw_delays(self) -> set[int]:
        """Return the robots that stand still in this step."""
        still = set()
        for robot, state in self.luck.items():
            for shift in (13, -7, 17):
                state ^= (state << shift if shift > 0 else state >> -shift) % 2**64
            self.luck[robot] = state
            if (state >> 11) / 2**53 < self.truth.robots[robot].delays.chance:
                still.add(robot)
        return still

    def move(self, walkers: dict[int, int]) -> None:
        waits = self.s.forming_steps == 1
        still = self.draw_delays()
        delayed = [slot for slot, team in self.teams.items() if still & set(team.robots)]
        for slot, team in sorted(self.teams.items()):
            is_busy = team.serving and not self.carried & set(team.serving)
            if slot in walkers or is_busy or (team.formed and waits) or slot in delayed:
                continue
            if team.task is None:
                team.credit = 0.0
            else:
                self.walk_towards(team, self.at[team.task])
        for slot, partner in sorted(walkers.items()):
            team = self.teams.get(slot)
            if team is None or team.formed or slot in delayed:
                continue  # it was joined on the way
            other_slot = next(s for s, t in self.teams.items() if partner in t.robots)
            other = self.teams[other_slot]
            self.walk_towards(team, other.at)
            if not waits and not other.formed and self.is_same(team.at, other.at):
                self.unite(slot, other_slot, self.rank)

    def walk_towards(self, team: PlainTeam, goal: Place) -> None:
        if isinstance(self.s.world, Plane):
            pace = self.s.world.step * min(self.s.robots[r].speed for r in team.robots)
            away, (x, y) = math.dist(team.at, goal), team.at
            to = goal
            if away > pace + 1e-9:
                to = (x + (goal[0] - x) * pace / away, y + (goal[1] - y) * pace / away)
                to = (round(to[0] * 1e6) / 1e6, round(to[1] * 1e6) / 1e6)
            team.at = to
            return
        away = self.ways_to(goal, team)
        if team.at not in away or away[team.at] == 0:
            team.credit = 0.0
            return
        team.credit += min(self.s.robots[r].speed for r in team.robots)
        cells = math.floor(team.credit + 1e-9)
        team.credit -= cells
        for _ in range(min(cells, away[team.at])):
            gap = (abs(goal[0] - team.at[0]), abs(goal[1] - team.at[1]))
            nearer = [c for c in sides(team.at) if away.get(c, NEVER) == away[team.at] - 1]
            x_first = gap[0] >= gap[1]
            nearer.sort(key=lambda cell: (cell[1] == team.at[1]) != x_first)
            team.at = nearer[0]
        if team.at == goal:
            team.credit = 0.0

    def flies(self, team: PlainTeam) -> bool:
        return all(self.s.robots[robot].flies for robot in team.robots)

    def ways_to(self, goal: Place, team: PlainTeam) -> dict[Place, int]:
        """Return the distances of cells from where a team can go to a goal."""
        world = self.s.world
        if self.flies(team):
            return walk(Grid(world.width, world.height), goal)
        return walk(world, goal) if world.is_free(goal) else {}

    def call_off(self) -> bool:
        gone = [
            k
            for k, task in enumerate(self.s.tasks)
            if task.cancelled == self.steps + 1 and k not in self.done
        ]
        for task in gone:
            self.cancelled[task] = self.steps + 1
            self.open = [k for k in self.open if k != task]
            self.carried.discard(task)
            for team in self.teams.values():
                team.serving.pop(task, None)
                if team.task == task:
                    team.task, team.is_detour = None, False
        return bool(gone)

    def lose(self) -> bool:
        lost = [
            r
            for team in self.teams.values()
            for r in team.robots
            if any(a.lost == self.steps + 1 for a in self.truth.robots[r].absences)
        ]
        for robot in lost:
            slot = next(s for s, t in self.teams.items() if robot in t.robots)
            team = self.teams.pop(slot)
            team.robots.remove(robot)
            self.lost_at[robot] = team.at
            if team.robots:
                self.teams[team.robots[0]] = team
            else:
                self.let_go |= dict.fromkeys(self.carried & set(team.serving), team.at)
        self.lost += len(lost)
        return bool(lost)

    def come_back(self) -> bool:
        absences = {r: self.truth.robots[r].absences for r in self.lost_at}
        back = [r for r in absences if any(a.back == self.steps + 1 for a in absences[r])]
        for robot in back:
            self.teams[robot] = PlainTeam([robot], self.lost_at.pop(robot))
        return bool(back)

    def complete(self) -> None:
        step = self.steps + 1
        for _, team in sorted(self.teams.items()):
            for task in sorted(team.serving):
                self.serve(team, task, step)
        for _, team in sorted(self.teams.items()):
            if self.is_with_load(team, step):
                continue
            for task in sorted(self.open):
                is_load = self.s.tasks[task].to is not None
                if not is_load and self.is_ready(team, task):
                    self.begin(team, task, step)
        for task, place in self.let_go.items():
            self.carried.remove(task)
            self.believe(task, place)
        self.let_go = {}

    def serve(self, team: PlainTeam, task: int, step: int) -> None:
        if task in self.carried:
            self.carry(team, task, step)
            return
        team.serving[task] -= 1
        if not (self.covers(self.has(team), task) and self.is_at(team, task)):
            del team.serving[task]
        elif team.serving[task] > 0:
            self.expect(task, team)
        elif self.s.tasks[task].to is None:
            del team.serving[task]
            self.finish(task, step)
        else:
            self.take_up(team, task, step)

    def take_up(self, team: PlainTeam, task: int, step: int) -> None:
        self.carried.add(task)
        team.serving[task] = self.s.tasks[task].unload + 1
        self.carry(team, task, step)
        if task in self.carried:
            self.believe(task, self.s.tasks[task].to)

    def carry(self, team: PlainTeam, task: int, step: int) -> None:
        if not self.covers(self.has(team), task):
            del team.serving[task]
            self.let_go[task] = team.at
        elif self.is_same(team.at, self.s.tasks[task].to):
            team.serving[task] -= 1
            if team.serving[task] == 0:
                self.carried.remove(task)
                del team.serving[task]
                self.finish(task, step)

    def is_with_load(self, team: PlainTeam, step: int) -> bool:
        """Let a team begin with the load that it has come for; say whether it is at one."""
        task = team.task
        if task is None or self.s.tasks[task].to is None:
            return False
        if not team.serving and self.is_ready(team, task):
            self.begin(team, task, step)
            return True
        return task in team.serving

    def is_ready(self, team: PlainTeam, task: int) -> bool:
        """Say whether a team stands at a task that it can do and nobody does."""
        is_served = any(task in t.serving for t in self.teams.values()) or task in self.let_go
        is_free = task in self.open and self.has_opened(task) and not is_served
        return is_free and self.is_at(team, task) and self.covers(self.has(team), task)

    def begin(self, team: PlainTeam, task: int, step: int) -> None:
        duration, is_load = self.truth.tasks[task].duration, self.s.tasks[task].to is not None
        if duration == 0 and not is_load:
            self.finish(task, step)
            return
        team.serving[task] = duration
        self.due[task] = max(1, self.s.tasks[task].duration)
        team.credit = 0.0
        if duration == 0:
            self.take_up(team, task, step)

    def expect(self, task: int, team: PlainTeam) -> None:
        """Expect the end of a service that is overdue amid the durations that are left."""
        served = self.truth.tasks[task].duration - team.serving[task]
        if served >= self.due[task]:
            left = range(served + 1, self.s.tasks[task].longest + 1)
            self.due[task] = math.ceil(sum(left) / len(left))
            self.overdue += 1

    def rest(self, team: PlainTeam) -> int:
        """Return for how long a team is expected to serve."""
        return max((self.rest_of(team, task) for task in team.serving), default=0)

    def rest_of(self, team: PlainTeam, task: int) -> int:
        left, goal = team.serving[task], self.s.tasks[task].to
        if task not in self.carried:
            loading = self.due[task] - (self.truth.tasks[task].duration - left)
            if goal is None:
                return loading
            return loading + self.steps_to(team, goal) + self.s.tasks[task].unload
        if self.is_same(team.at, goal):
            return left
        return self.steps_to(team, goal) + left - 1

    def steps_to(self, team: PlainTeam, goal: Place) -> int:
        if self.is_same(team.at, goal):
            return 0
        pace = min(self.s.robots[r].speed for r in team.robots)
        if isinstance(self.s.world, Plane):
            way = math.dist(team.at, goal) - self.here
            return math.ceil(way / (pace * self.s.world.step) - 1e-9)
        return math.ceil((self.way(team, goal) - team.credit) / pace - 1e-9)

    def is_at(self, team: PlainTeam, task: int) -> bool:
        return self.is_same(team.at, self.at[task])

    def finish(self, task: int, step: int) -> None:
        self.done[task] = step
        self.open.remove(task)
        for team in self.teams.values():
            if team.task == task:
                team.task, team.is_detour = None, False
