"""What learning from earlier missions at a site is worth: the table of docs/how-to/learn.md.

`python docs/making/site_memory.py FAMILY FIRST LAST` prints a line for each world. By quarters of
the map, a site has its own durations (three in a row of 1 to 10), and for each capability what may
be needed is needed with a chance of 10% or of 90%. The file of a mission says 1 to 10 and 50%.
"""

from __future__ import annotations

import json
import sys
from dataclasses import replace

import numpy as np

import teamformer as tf
from teamformer.mission.model import Mission, Task
from teamformer.mission.parts.places import possible_places
from teamformer.mission.truth import draw_truth
from teamformer.record.record import Ending, Record, Step

AFTER = (5, 20, 100)
"""Missions that were played before."""

MIDDLES, LASTS, CHANCES = (2, 4, 7, 9), (1, 10), (0.1, 0.9)
MOVED = 6
"""How far tasks of earlier missions are from some task of the mission at hand, at most."""


class Site:
    """A mission, and what its file does not say of the place."""

    def __init__(self, family: str, seed: int) -> None:
        rng = np.random.default_rng([77, seed])
        plain = tf.setting(family, seed=seed)
        self.seed, self._world = seed, plain.world
        self._middles = rng.permutation(MIDDLES)
        self._often = {
            (quarter, cap): CHANCES[int(rng.integers(2))]
            for quarter in range(len(MIDDLES))
            for cap in plain.capabilities
        }
        tasks = tuple(_open(task, rng) for task in plain.tasks)
        self.mission = replace(plain, tasks=tasks, step_limit=0)

    def as_it_is(self, mission: Mission) -> Mission:
        """Return a mission with what holds at the site instead of what its file says."""
        return replace(mission, tasks=tuple(map(self._known, mission.tasks)), step_limit=0)

    def _known(self, task: Task) -> Task:
        east, north = task.at[0] > self._world.width / 2, task.at[1] > self._world.height / 2
        quarter = 2 * int(east) + int(north)
        middle = int(self._middles[quarter])
        chances = {cap: self._often[quarter, cap] for cap in task.may_need}
        return replace(task, lasts=(middle - 1, middle + 1), may_need=chances)

    def records(self, count: int) -> list[Record]:
        """Return what earlier missions showed in which all was done."""
        return [self._record(number) for number in range(count)]

    def _record(self, number: int) -> Record:
        rng = np.random.default_rng([79, self.seed, number])
        places = [task.at for task in self.mission.tasks]
        moved = []
        for task in self.mission.tasks:
            near = possible_places(self._world, places[rng.integers(len(places))], MOVED)
            needs = dict.fromkeys([*task.needs, *task.may_need], 1)
            plain = replace(task, at=near[rng.integers(len(near))], needs=needs, may_need={})
            moved.append(_open(plain, rng))
        past = replace(self.mission, tasks=tuple(moved), step_limit=0)
        numbers = range(len(moved))
        step = Step(done=tuple((task, 0) for task in numbers), shown=tuple(numbers))
        end = Ending("completed", 1, 1, len(moved), 0, 0, 0)
        truth = draw_truth(self.as_it_is(past), number)
        return Record(past, "none", number, (), (), (step,), end=end, truth=truth)


def _open(task: Task, rng: np.random.Generator) -> Task:
    """Return a task of which only one capability is sure, and the duration is not."""
    sure = str(rng.choice(sorted(task.needs)))
    needs = {cap: max(int(cap == sure), count - 1) for cap, count in task.needs.items()}
    may_need = {cap: 0.5 for cap, count in task.needs.items() if count > needs[cap]}
    needs = {cap: count for cap, count in needs.items() if count > 0}
    return replace(task, needs=needs, may_need=may_need, lasts=LASTS)


def covering(mission: Mission, truth: Mission) -> Mission:
    """Return a mission whose ranges reach to what really was: a run allows nothing else."""
    durations = (int(task.duration) for task in truth.tasks)
    tasks = (
        replace(task, lasts=(min(task.lasts[0], took), max(task.lasts[1], took)))
        for task, took in zip(mission.tasks, durations, strict=True)
        if task.lasts is not None
    )
    return replace(mission, tasks=tuple(tasks), step_limit=0)


def measure(family: str, seed: int) -> dict[str, object]:
    """Return the steps that `plan` takes by the file, by what was learned and by the site."""
    site = Site(family, seed)
    known = site.as_it_is(site.mission)
    truth = draw_truth(known, seed)
    row: dict[str, object] = {"family": family, "seed": seed}
    row["file"] = tf.run(site.mission, "plan", truth=truth).makespan
    records = site.records(max(AFTER))
    for count in AFTER:
        learned = covering(tf.learn(site.mission, records[:count]).mission, truth)
        row[f"after {count}"] = tf.run(learned, "plan", truth=truth).makespan
    row["site"] = tf.run(known, "plan", truth=truth).makespan
    return row


if __name__ == "__main__":
    for seed in range(int(sys.argv[2]), int(sys.argv[3]) + 1):
        print(json.dumps(measure(sys.argv[1], seed)), flush=True)
