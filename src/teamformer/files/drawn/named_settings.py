"""Test settings by name: `20N100T-C4` is 20 robots, 100 tasks and 4 capabilities.

`-R10` fixes the requirements of each task, `4N20+20T` has 20 tasks more that appear together,
`-tsp` or `-nn` says how these come into the order (a new tour, or after the nearest task), and
`-30x30` sets the grid. Without it the grid is the paper's: 10 x 10, from 100 robots or tasks on
20 x 20 (Boehme and Hollinger, ICRA 2026, section V).

`real`, `sparse`, `warehouse`, `moving`, `carry`, `air-ground` and `deadlines` are families of
missions that people have. `real-half` and `real-double` have half and twice the robots and tasks;
in `real-sense5` robots sense 5 cells, in `real-senseall` everybody. `real-lost` loses one robot
that can be spared, in `real-arrivals` a fifth of the tasks appears later.
`roads`, `clock`, `shifts`, `optional`, `charging` and `zones` are families in continuous time; they
have `-lost`, `-arrivals` and `-cancelled`.
`-durations`, `-needs` (with a probability of 50%; `-needs10`, `-needs30`, `-needs70`), `-places`,
`-delays`, `-calls`, `-breakdowns`, `-mixed` (some of these) and `-all` leave open what their name
says, in any setting: `4N20T-C4-needs`, `real-mixed`.
"""

from __future__ import annotations

import re
from typing import NamedTuple

import numpy as np

from teamformer.base.errors import TeamformerError
from teamformer.files.drawn.continuous_incidents import let_happen
from teamformer.files.drawn.continuous_missions import CONTINUOUS_FAMILIES, split_continuous
from teamformer.files.drawn.families import FAMILIES, family_in, split_name
from teamformer.files.drawn.family_missions import draw_mission
from teamformer.files.drawn.generate import Spec, generate
from teamformer.files.drawn.surprises import SURPRISES, make_uncertain
from teamformer.mission.model import Mission
from teamformer.mission.parts.grid import Grid

NAME = re.compile(
    r"(?P<robots>\d+)N(?P<tasks>\d+)(\+(?P<late_tasks>\d+))?T-C(?P<capabilities>\d+)"
    r"(-R(?P<requirements>\d+))?(-(?P<width>\d+)x(?P<height>\d+))?(-(?P<insertion>tsp|nn))?"
    rf"(-(?P<surprise>{'|'.join(SURPRISES)}))?"
)
INSERTIONS = {"tsp": "resolve", "nn": "nearest"}
MANY = 100
"""So many robots or tasks take the larger grid."""

TEST = 3
"""First number of the seeds of test worlds; training uses the lower ones."""


class Size(NamedTuple):
    """How large worlds of a setting are at most."""

    robots: int
    capabilities: int


def size_of(setting: str) -> Size:
    """Return how large worlds of a setting are; an unknown name raises `TeamformerError`."""
    if (timed := split_continuous(setting)) is not None:
        drawn = CONTINUOUS_FAMILIES[timed[0]]
        return Size(drawn.robots, drawn.capabilities)
    found = split_name(setting)
    if found is not None:
        return Size(found[0].robots[1], len(found[0].capabilities))
    spec = spec_of(setting)
    return Size(spec.robots, spec.capabilities)


def is_in_time(setting: str) -> bool:
    """Say whether worlds of a setting are in continuous time."""
    return split_continuous(setting) is not None


def spec_of(setting: str) -> Spec:
    """Return what a setting generates; an impossible name raises `TeamformerError`."""
    match = NAME.fullmatch(setting)
    if match is None:
        families = ", ".join((*FAMILIES, *CONTINUOUS_FAMILIES))
        hint = f"write for example 4N20T-C4, 100N20T-C100-R10, 4N20+20T-C4-nn; or {families}"
        raise TeamformerError(f"'{setting}' is no setting", hint)
    said = {key: int(text) for key, text in match.groupdict("0").items() if text.isdigit()}
    side = 20 if max(said["robots"], said["tasks"]) >= MANY else 10
    return Spec(
        robots=said["robots"],
        tasks=said["tasks"],
        capabilities=said["capabilities"],
        requirements=said["requirements"] or None,
        world=Grid(said["width"] or side, said["height"] or side),
        late_tasks=said["late_tasks"],
    )


def new_tasks_of(setting: str) -> str:
    """Return what the paper's order does with tasks that appear, as a setting's name says it."""
    match = NAME.fullmatch(setting)
    return INSERTIONS[(match and match["insertion"]) or "tsp"]


def world_of(setting: str, world_seed: int) -> Mission:
    """Return a test world of a setting; the same seed gives the same one everywhere.

    Settings that differ only in how late tasks are inserted or in what is uncertain have the same
    worlds, and so have those of a family but for what happens in them.
    """
    if (timed := split_continuous(setting)) is not None:
        name, what = timed
        rng = np.random.default_rng([TEST, world_seed, *name.encode()])
        mission = CONTINUOUS_FAMILIES[name].draw(rng, f"{setting}, world {world_seed}")
        return mission if what is None else let_happen(mission, what, rng)
    found = split_name(setting)
    if found is not None:
        family, incident = found
        rng = np.random.default_rng([TEST, world_seed, *str(family_in(setting)).encode()])
        return draw_mission(family, rng, f"{setting}, world {world_seed}", incident)
    spec, kind = spec_of(setting), NAME.fullmatch(setting)["surprise"]  # type: ignore[index]
    name = re.sub(f"(-(tsp|nn))?(-({'|'.join(SURPRISES)}))?$", "", setting)
    rng = np.random.default_rng([TEST, world_seed, *name.encode()])
    mission = generate(spec, rng, f"{setting}, world {world_seed}")
    return mission if kind is None else make_uncertain(mission, kind, rng)
