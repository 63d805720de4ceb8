"""Record trees for the page, made by a toy trial in plain Python.

The toy knows mission trees only as far as the page draws them: robots with lists of capabilities
and speed 1, tasks done in the order of the file, teams that join where they wait and that drop
their lowest robot after a task.
"""

from __future__ import annotations

import json
import random
from collections import Counter, deque
from typing import Any

from teamformer.record.files.reading import record_from_tree
from teamformer.record.telling.whole import told_of
from teamformer.record.told.trees import told_to_tree

Tree = dict[str, Any]
Cell = tuple[int, int]


def toy_record(mission: Tree, method: str = "toy", steps: int = 400) -> Tree:
    """Run a trial and return its record tree."""
    trial = ToyTrial(mission)
    start = [[slot, robots, *trial.place[slot]] for slot, robots in sorted(trial.teams.items())]
    changes = []
    while len(changes) < steps and trial.is_open:
        changes.append(trial.step(len(changes) + 1))
    is_completed = not trial.is_open
    tree = {
        "teamformer_record": 3,
        "mission": mission,
        "method": method,
        "foresight": "scouting",
        "seed": 0,
        "orders": [[0, list(range(len(mission["tasks"])))]],
        "start": start,
        "steps": changes,
        "end": {
            "status": "completed" if is_completed else "step limit",
            "makespan": len(changes) if is_completed else None,
            "steps": len(changes),
            "tasks_done": len(mission["tasks"]) - len(trial.is_open),
            "joins": sum(len(change.get("joins", [])) for change in changes),
            "splits": sum(len(change.get("splits", [])) for change in changes),
            "illegal_decisions": 0,
            "blocked_tasks": [],
        },
        "lower_bound": max(1, int(len(changes) * 0.8)),
    }
    return told_too(tree)


def told_too(tree: Tree) -> Tree:
    """Return the tree of a record with what is told of it."""
    mission = tree["mission"]
    robots = [robot | {"can": Counter(robot["can"])} for robot in mission["robots"]]
    tasks = [task | {"needs": Counter(task["needs"])} for task in mission["tasks"]]
    read = tree | {"mission": mission | {"robots": robots, "tasks": tasks}}  # as files say it
    read.pop("told", None)
    text = json.dumps(read)
    return {**tree, "told": told_to_tree(told_of(record_from_tree(json.loads(text), "toy")))}


def toy_states(mission: Tree, steps: int) -> list[dict[int, tuple[Any, ...]]]:
    """Return what is true after each step, the start included: slot -> robots, x, y, task."""
    trial = ToyTrial(mission)
    states = [trial.state()]
    for number in range(1, steps + 1):
        trial.step(number)
        states.append(trial.state())
    return states


class ToyTrial:
    """The state of a toy trial: teams by slot, with place and task, and the open tasks."""

    def __init__(self, mission: Tree) -> None:
        robots, tasks = mission["robots"], mission["tasks"]
        self.rows = mission["world"].get("rows") or [
            "." * mission["world"]["grid"][0] for _ in range(mission["world"]["grid"][1])
        ]
        self.can = [Counter(robot["can"]) for robot in robots]
        self.lost_at = [robot.get("lost") for robot in robots]
        self.needs = [Counter(task["needs"]) for task in tasks]
        self.goal = [tuple(task["at"]) for task in tasks]
        self.duration = [task.get("duration", 0) for task in tasks]
        self.appears = [task.get("appears", 0) for task in tasks]
        self.teams: dict[int, list[int]] = {robot: [robot] for robot in range(len(robots))}
        self.place: dict[int, Cell] = {slot: tuple(robots[slot]["at"]) for slot in self.teams}
        self.task: dict[int, int | None] = dict.fromkeys(self.teams)
        self.is_open = set(range(len(tasks)))
        self.serves: dict[int, tuple[int, int]] = {}  # slot -> task, steps left
        self.has_done: list[int] = []
        self.fields: dict[Cell, dict[Cell, int]] = {}

    def step(self, number: int) -> Tree:
        """Make one step and return what it changed."""
        before = self._listing()
        splits = self._split()
        joins = self._join()
        formed = {min(join) for join in joins} | {min(part) for parts in splits for part in parts}
        self._allocate(number)
        self._walk(formed)
        lost = self._lose(number)
        served = dict(self.serves)
        done = self._complete(number)
        began = [[task, self.teams[s]] for s, (task, _) in self.serves.items() if s not in served]
        after = self._listing()
        change = {"splits": splits, "joins": joins, "lost": lost, "done": done, "served": began}
        teams = [[slot, *after[slot]] for slot in sorted(after) if before.get(slot) != after[slot]]
        return {key: value for key, value in (change | {"teams": teams}).items() if value}

    def state(self) -> dict[int, tuple[Any, ...]]:
        """Return every team: slot -> robots, x, y, task."""
        listing = self._listing()
        return {slot: (list(robots), *listing[slot]) for slot, robots in self.teams.items()}

    def _listing(self) -> dict[int, tuple[int, int, int | None]]:
        return {slot: (*self.place[slot], self.task[slot]) for slot in self.teams}

    def _counts(self, slot: int) -> Counter[str]:
        return sum((self.can[robot] for robot in self.teams[slot]), Counter())

    def _covers(self, slot: int, task: int) -> bool:
        return self._counts(slot) >= self.needs[task]

    def _found(self, robots: list[int], place: Cell, task: int | None) -> None:
        slot = min(robots)
        self.teams[slot], self.place[slot], self.task[slot] = sorted(robots), place, task

    def _split(self) -> list[list[list[int]]]:
        splits = []
        for slot in self.has_done:
            robots = self.teams.get(slot, [])
            if len(robots) > 1 and slot not in self.serves:
                self._found(robots[1:], self.place[slot], None)
                self._found(robots[:1], self.place[slot], None)
                splits.append([robots[:1], robots[1:]])
        self.has_done = []
        return splits

    def _join(self) -> list[list[int]]:
        joins, waiting = [], {}
        for slot in sorted(self.teams):
            task = self.task[slot]
            if task is None or slot in self.serves or self.place[slot] != self.goal[task]:
                continue
            if task in waiting:
                partner = waiting.pop(task)
                robots = self.teams.pop(slot)
                self._found(self.teams[partner] + robots, self.place[partner], task)
                joins.append([slot, partner])
            elif not self._covers(slot, task):
                waiting[task] = slot
        return joins

    def _allocate(self, number: int) -> None:
        for slot in self.teams:
            if self.task[slot] is None:
                have = self._counts(slot)
                self.task[slot] = next(
                    (
                        task
                        for task in sorted(self.is_open)
                        if self.appears[task] < number and have & self.needs[task]
                    ),
                    None,
                )

    def _walk(self, formed: set[int]) -> None:
        for slot in self.teams:
            task = self.task[slot]
            if task is not None and slot not in formed and slot not in self.serves:
                self.place[slot] = self._next_cell(self.place[slot], self.goal[task])

    def _next_cell(self, place: Cell, goal: Cell) -> Cell:
        if goal not in self.fields:
            self.fields[goal] = self._field(goal)
        field = self.fields[goal]
        return min([place, *self._beside(place)], key=lambda cell: field[cell])

    def _field(self, goal: Cell) -> dict[Cell, int]:
        field, queue = {goal: 0}, deque([goal])
        while queue:
            cell = queue.popleft()
            for beside in self._beside(cell):
                if beside not in field:
                    field[beside] = field[cell] + 1
                    queue.append(beside)
        return field

    def _beside(self, cell: Cell) -> list[Cell]:
        x, y = cell
        around = ((x + 1, y), (x, y + 1), (x - 1, y), (x, y - 1))
        return [
            (u, v)
            for u, v in around
            if 0 <= v < len(self.rows) and 0 <= u < len(self.rows[v]) and self.rows[v][u] == "."
        ]

    def _lose(self, number: int) -> list[int]:
        lost = [robot for robot, at in enumerate(self.lost_at) if at == number]
        for robot in lost:
            slot = next(slot for slot, robots in self.teams.items() if robot in robots)
            rest = [other for other in self.teams.pop(slot) if other != robot]
            if rest:
                self._found(rest, self.place[slot], self.task[slot])
        return lost

    def _complete(self, number: int) -> list[list[int]]:
        done = []
        for slot in sorted(self.teams):
            if slot in self.serves:
                task, left = self.serves.pop(slot)
                if left > 1:
                    self.serves[slot] = (task, left - 1)
                else:
                    done.append([task, slot])
                continue
            for task in sorted(self.is_open):
                is_known = self.appears[task] < number and self.place[slot] == self.goal[task]
                if is_known and self._covers(slot, task):
                    if self.duration[task]:
                        self.serves[slot] = (task, self.duration[task])
                        break
                    done.append([task, slot])
        for task, slot in done:
            self.is_open.discard(task)
            self.has_done.append(slot)
            self.task.update({team: None for team in self.teams if self.task[team] == task})
        return done


def small_mission() -> Tree:
    """Four robots, four tasks, walls, a duration, a late task and a robot that is lost."""
    return {
        "teamformer": 1,
        "name": "Dock, early shift",
        "world": {
            "rows": [
                "..................",
                "..................",
                ".....@@@@@........",
                ".....@...@........",
                ".........@....@@@.",
                ".....@...@....@...",
                ".....@@@@@....@...",
                "..............@@@.",
                "..................",
                "..................",
                "..................",
            ],
            "y_axis": "down",
        },
        "capabilities": ["lift", "scan", "weld", "power"],
        "robots": [
            {"name": "r1", "at": [2, 3], "can": ["lift"]},
            {"name": "r2", "at": [2, 4], "can": ["scan", "power"]},
            {"name": "r3", "at": [3, 9], "can": ["weld"]},
            {"name": "r4", "at": [15, 9], "can": ["lift", "scan"], "lost": 36},
        ],
        "tasks": [
            {"name": "crate-7", "at": [7, 4], "needs": ["lift", "scan"]},
            {"name": "pallet", "at": [11, 1], "needs": ["lift", "lift"]},
            {"name": "seam", "at": [16, 5], "needs": ["weld", "power", "lift"], "duration": 5},
            {"name": "late load", "at": [3, 6], "needs": ["weld", "scan"], "appears": 20},
        ],
    }


def random_mission(
    robots: int, tasks: int, capabilities: int, size: int, requirements: int, seed: int = 0
) -> Tree:
    """Robots around one spawn point, tasks anywhere on an open grid."""
    rng = random.Random(seed)
    names = [f"c{number + 1}" for number in range(capabilities)]
    spawn = size // 3
    near = range(spawn - 2, spawn + 3)
    return {
        "teamformer": 1,
        "name": f"{robots} robots, {tasks} tasks",
        "world": {"grid": [size, size]},
        "capabilities": names,
        "robots": [
            {
                "name": f"r{number + 1}",
                "at": [rng.choice(near), rng.choice(near)],
                "can": [names[number % capabilities]],
            }
            for number in range(robots)
        ],
        "tasks": [
            {
                "name": f"t{number + 1}",
                "at": [rng.randrange(size), rng.randrange(size)],
                "needs": rng.sample(names, requirements),
            }
            for number in range(tasks)
        ],
    }
