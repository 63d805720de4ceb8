"""`teamformer fleet`: every robot a process of its own on this machine; `fleet add` adds a task."""

from __future__ import annotations

import math
import secrets
import time
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from teamformer.capabilities import exact, is_exact
from teamformer.commands.console import (
    ended_like_ctrl_c,
    out,
    prepare_folder,
    print_json,
    say,
)
from teamformer.commands.robots.rehearse import check_policy, require_extra, signatures_in
from teamformer.errors import TeamformerError
from teamformer.mission.rules import rules_of_simulated_missions
from teamformer.scenarios.files import read_scenario

if TYPE_CHECKING:
    from teamformer.fleet.messages import TaskFact
    from teamformer.fleet.mission import Mission


MOST_NEEDED = 1000
"""Of one capability, by a task that an operator adds."""


@dataclass(frozen=True)
class Options:
    """What the command line says of a fleet."""

    pace: float
    drop: float
    folder: Path | None
    time_limit: float
    policy: str | None = None
    sign: Path | None = None


@dataclass(frozen=True)
class Added:
    """What the command line says of a task to add."""

    name: str
    at: str
    needs: str
    duration: float
    connect: str | None
    key: Path | None
    tls: Path | None
    pace: float
    patience: float
    sign: Path | None = None


def fleet(path: Path, options: Options, as_json: bool) -> int:
    """Run a fleet until the mission ends; return 0 if all is done."""
    require_extra("zenoh")
    from teamformer.fleet.mission import Mission, seconds_a_step
    from teamformer.fleet.process.fleet import LocalFleet

    scenario = read_scenario(path, rules_of_simulated_missions)
    if options.folder is not None:
        prepare_folder(options.folder)
    check_policy(options.policy, scenario)
    mission = Mission(scenario, seconds_a_step(scenario, options.pace))
    signatures = signatures_in(options.sign, mission, None)
    with TemporaryDirectory(prefix="teamformer-facts-") as temporary:
        folder = options.folder or Path(temporary)
        more = ["--policy", options.policy] if options.policy else []
        more += ["--sign", str(options.sign)] if options.sign else []
        local = LocalFleet(mission, options.pace, options.drop, folder, say, more, signatures)
        with ended_like_ctrl_c():
            result = local.run(options.time_limit)
    makespan = max((done.at for done in result.done), default=None)
    robots = scenario.robots
    done = [
        {
            "task": result.names[each.key],
            "at": round(each.at, 3),
            "by": [robots[robot].name for robot in each.robots],
        }
        for each in result.done
    ]
    row = {
        "completed": result.completed,
        "makespan": None if makespan is None or not result.completed else round(makespan, 3),
        "tasks_done": len(result.done),
        "tasks": result.tasks,
        "robots_alive": result.robots_alive,
        "done": done,
    }
    if as_json:
        print_json(row)
    else:
        end = f"all done after {makespan:.2f} s" if result.completed else "not all done"
        alive = f"{result.robots_alive} of {len(robots)} robots left"
        out.print(
            f"{scenario.name}: {end}; {len(done)} of {result.tasks} tasks, {alive}",
            style="green" if result.completed else "red",
            markup=False,
        )
    return 0 if result.completed else 1


def add(path: Path, added: Added, as_json: bool) -> int:
    """Add a task to a running fleet; return 0 once it is accepted."""
    require_extra("zenoh")
    from teamformer.fleet.messages import OPERATOR, Post
    from teamformer.fleet.mission import Mission, seconds_a_step
    from teamformer.fleet.operator import AGAIN, Operator
    from teamformer.fleet.transports.transport import (
        check_endpoints,
        read_certificates,
        read_secret,
    )
    from teamformer.fleet.transports.zenoh_mesh import ZenohTransport

    scenario = read_scenario(path, rules_of_simulated_missions)
    mission = Mission(scenario, seconds_a_step(scenario, added.pace))
    task = _task(added, mission)
    secret, certificates = read_secret(added.key), read_certificates(added.tls)
    if added.connect is None:
        raise TeamformerError("where is the fleet?", "add --connect ENDPOINT of any agent")
    check_endpoints([added.connect], secret, certificates)
    signatures = signatures_in(added.sign, mission, OPERATOR)
    post = Post(mission.number, mission.robots, secret, signatures)
    transport = ZenohTransport(  # last: a process ends only once it is closed
        mission.number, OPERATOR, None, [added.connect], certificates=certificates
    )
    operator = Operator(task, mission.robots)
    deadline = time.monotonic() + added.patience
    try:
        while not operator.is_accepted and time.monotonic() < deadline:
            notice = operator.offer()
            transport.send(notice.to, post.seal(OPERATOR, notice))
            for data in transport.receive(AGAIN):
                message, _ = post.judge(data)
                if message is not None:
                    operator.hear(message)
    finally:
        transport.close()
    holders = [scenario.robots[robot].name for robot in sorted(operator.holders)]
    if as_json:
        print_json({"task": task.name, "accepted": operator.is_accepted, "held_by": holders})
    elif operator.is_accepted:
        out.print(f"{task.name}: accepted, held by {', '.join(holders)}", markup=False)
    if not operator.is_accepted:
        have = f"only {', '.join(holders)} hold it" if holders else "no robot answered"
        say(f"{task.name}: not accepted, {have}; {operator.needed} must; it may still be done")
        if not holders:
            say("hint: SCENARIO, --pace, --key and --sign have to be the fleet's")
    return 0 if operator.is_accepted else 1


def _task(added: Added, mission: Mission) -> TaskFact:
    """Return the task to add; raises `TeamformerError` for one that no fleet would take."""
    from teamformer.fleet.messages import LONGEST, MOST_NAME, TaskFact

    scenario, name = mission.scenario, added.name.strip()
    if not 0 < len(name) <= MOST_NAME:
        raise TeamformerError(f"--task has {len(name)} letters", f"use 1 to {MOST_NAME}")
    if name in {task.name for task in scenario.tasks}:
        raise TeamformerError(f"the mission has a task '{name}' already", "use another name")
    x, y = _place(added.at)
    if not mission.is_site(x, y):
        raise TeamformerError(f"--at {added.at} is no free place of the map", "name another one")
    needs = _needs(added.needs, scenario.capabilities)
    duration = added.duration * mission.step
    if duration > LONGEST:
        raise TeamformerError(f"--duration {added.duration:g} is too long", "use fewer steps")
    task = TaskFact((1 + secrets.randbits(36)) << 24, name, x, y, needs, duration)
    if not mission.can_do(range(mission.robots), task):
        raise TeamformerError(
            f"all robots together cannot do '{name}'", "lower what it needs, or move it"
        )
    return task


def _place(text: str) -> tuple[float, float]:
    try:
        x, y = (float(part) for part in text.split(","))
    except ValueError:
        raise TeamformerError(f"--at {text} is no place", "write it as in 3,4") from None
    return x, y


def _needs(text: str, capabilities: tuple[str, ...]) -> tuple[float, ...]:
    counts: dict[str, float] = dict.fromkeys(capabilities, 0)
    for part in text.split(","):
        name, _, number = part.strip().partition(":")
        if name not in counts:
            known = ", ".join(capabilities)
            raise TeamformerError(f"--needs: there is no capability '{name}'", f"there are {known}")
        counts[name] = exact(counts[name] + (_count(part.strip(), number) if number else 1))
    return tuple(counts.values())


def _count(part: str, number: str) -> float:
    try:
        count = float(number)
    except ValueError:
        count = math.nan
    if not (0 < count <= MOST_NEEDED and is_exact(count)):
        hint = f"write a number up to {MOST_NEEDED:,}, of three places at most"
        raise TeamformerError(f"--needs {part}: {number} is no count", hint)
    return exact(count)
