"""What is wrong with a fleet by the words of its robots: who is out, what is late, the end."""

from __future__ import annotations

from collections.abc import Iterator

from teamformer.base.naming import listed
from teamformer.fleet.messages import TaskFact
from teamformer.fleet.observer.watch import Watch
from teamformer.live.running.alerts import END, Alert, robot_key
from teamformer.mission.parts.capabilities import describe, missing, total

SLACK = 10.0
"""Seconds by which a service may take longer than its task says."""


def troubles(watch: Watch, age: float) -> list[Alert]:
    """Return what is wrong at an age of the mission, in seconds.

    Where an alert says since when, that is an age too.
    """
    return [*_robots(watch), *_late_tasks(watch, age), *_end(watch)]


def _robots(watch: Watch) -> Iterator[Alert]:
    timers = watch.mission.timers
    for robot, word in sorted(watch.words.items()):
        name, key = watch.source.robots[robot].name, robot_key(robot)
        if word.is_lost:
            why = "it has left, or the others have not heard it for long"
            yield Alert(key, f"{name} is lost", why, "start its agent again; others do its tasks")
        elif not word.is_fit:
            why = (
                f"it says so: it wants to move and has not for {timers.stuck:g} s, or has heard "
                f"nobody for {timers.deaf:g} s"
            )
            yield Alert(key, f"{name} is unfit", why, "free its way, or look at its radio")


def _late_tasks(watch: Watch, age: float) -> Iterator[Alert]:
    step = watch.mission.step
    for number, task in watch.open_tasks():
        between = watch.source.tasks[number].between
        due = float("inf") if between is None else between[1] * step
        begun = min(watch.at_work.since(task.key).values(), default=float("inf")) * step
        longest = max(task.duration, watch.source.tasks[number].longest * step)
        ends = begun + longest + SLACK if task.to is None else float("inf")
        do = _who_does(watch, task)
        if age > due:
            why = f"it was due at {due:g} s and is not done"
            yield Alert(f"task {number}", f"{task.name} is late", why, do, due)
        elif age > ends:
            why = f"robots are at work since {begun:g} s, and it should take {longest:g} s"
            yield Alert(f"task {number}", f"{task.name} takes too long", why, do, ends)


def _who_does(watch: Watch, task: TaskFact) -> str:
    """Return where to look for who is to do a task."""
    robots = [r for r, word in sorted(watch.words.items()) if word.goal == task.key]
    names = listed(watch.source.robots[robot].name for robot in robots)
    return f"look at {names}, which head for it or are there" if robots else "nobody heads for it"


def _end(watch: Watch) -> Iterator[Alert]:
    """Say if tasks cannot be done by the robots that are there and fit, and who could."""
    out = {r for r, word in watch.words.items() if word.is_lost or not word.is_fit}
    able = [robot for robot in range(watch.mission.robots) if robot not in out]
    must = (task for _, task in watch.open_tasks() if not watch.mission.may_miss(task.key))
    stuck = [task for task in must if not watch.mission.can_do(able, task)]
    if not stuck:
        return
    robots, [first, *_] = watch.source.robots, stuck
    needs = dict(zip(watch.source.capabilities, first.needs, strict=True))
    there = [robot for robot in able if watch.mission.reach(robot, first)]
    lack = missing(total(robots[robot].can for robot in there), needs)
    useful = (robots[r].name for r in sorted(out) if lack.keys() & robots[r].can)
    helpers = listed(useful)
    do = f"bring {helpers} back" if helpers else "add a robot; no lost robot has it"
    why = f"for {first.name} the robots that are left lack {describe(lack)}"
    names = listed(task.name for task in stuck)
    yield Alert(END, f"the mission cannot end: {names}", why, do)
