"""What Foxglove is told of a record, in files and live: frames, a scene, the map and a log.

A cell of a grid is a metre and a step a second; planes keep their own metres and seconds.
"""

from __future__ import annotations

import colorsys
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

import foxglove
from foxglove.channels import (
    FrameTransformsChannel,
    GridChannel,
    LogChannel,
    SceneUpdateChannel,
)
from foxglove.messages import (
    Color,
    CubePrimitive,
    CylinderPrimitive,
    FrameTransform,
    FrameTransforms,
    Grid,
    KeyValuePair,
    LinePrimitive,
    LinePrimitiveLineType,
    Log,
    LogLevel,
    PackedElementField,
    PackedElementFieldNumericType,
    Point3,
    Pose,
    Quaternion,
    SceneEntity,
    SceneUpdate,
    TextPrimitive,
    Timestamp,
    Vector2,
    Vector3,
)

from teamformer.mission.model import Mission
from teamformer.mission.parts.capabilities import describe
from teamformer.mission.parts.grid import Grid as GridWorld
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.layout import Layout
from teamformer.record.export.moments import Moment, moments
from teamformer.record.happenings import LogEntry, events
from teamformer.record.record import Record
from teamformer.record.task_times import known_steps, over_steps
from teamformer.record.telling.whole import told_of
from teamformer.world.rules.constants import NOBODY

FRAME = "map"
UPRIGHT = Quaternion(x=0.0, y=0.0, z=0.0, w=1.0)
NANOSECONDS = 1_000_000_000
GOLDEN_ANGLE = 0.381966  # of a turn
BLOCKED = 255


Span = tuple[float, float]
"""When a task became known, and when it was done or called off, in steps or units of time."""


class Told(NamedTuple):
    """A moment of a record with all that is told of it; `spans` has one entry a task."""

    moment: Moment
    time: int  # nanoseconds from the start
    spans: Sequence[Span]
    events: Sequence[LogEntry]
    layout: Layout | None = None  # of roads


def telling(record: Record) -> Iterator[Told]:
    """Yield what is told of a record, moment by moment, the start first."""
    length = record.mission.seconds_a_step
    log: defaultdict[float, list[LogEntry]] = defaultdict(list)
    for event in events(record):
        log[event.at].append(event)
    layout = told_of(record).layout if record.is_continuous else None
    spans = list(zip(known_steps(record), _ends(record), strict=True))
    for moment in moments(record):
        time = round(moment.step * length * NANOSECONDS)
        yield Told(moment, time, spans, log.get(moment.step, ()), layout)


def _ends(record: Record) -> list[float]:
    """Return when each task was over, or one step or unit after the end."""
    over = over_steps(record)
    return [over.get(task, record.length + 1) for task in range(len(record.mission.tasks))]


class Channels:
    """The four topics that Foxglove is told, and how many messages they got."""

    def __init__(self, context: foxglove.Context) -> None:
        self._frames = FrameTransformsChannel("/tf", context=context)
        self._scene = SceneUpdateChannel("/mission", context=context)
        self._map = GridChannel("/map", context=context)
        self._log = LogChannel("/log", context=context)

    def tell(self, mission: Mission, told: Told) -> None:
        """Log a moment; `mission` is what it really was."""
        self.show(mission, told)
        for event in told.events:
            self._say(event.text(mission), event.kind in ("lost", "dry"), told.time)

    def show(self, mission: Mission, told: Told) -> None:
        """Log where everybody is at a moment, and not what happened."""
        self._show_frames(mission, told.moment, told.time)
        self._show_scene(mission, told)

    def map(self, mission: Mission, time: int = 0) -> None:
        """Log the map: 255 is blocked, 0 free."""
        world = mission.world
        if not isinstance(world, GridWorld) or not world.rows:
            return
        cells = bytes(
            0 if world.is_free((x, y)) else BLOCKED
            for y in range(world.height)
            for x in range(world.width)
        )
        kind = PackedElementFieldNumericType.Uint8
        grid = Grid(
            timestamp=_timestamp(time),
            frame_id=FRAME,
            pose=_pose((-0.5, -0.5)),  # places are the middles of cells
            column_count=world.width,
            cell_size=Vector2(x=1.0, y=1.0),
            row_stride=world.width,
            cell_stride=1,
            fields=[PackedElementField(name="blocked", offset=0, type=kind)],
            data=cells,
        )
        self._map.log(grid, log_time=time)

    def _show_frames(self, mission: Mission, moment: Moment, time: int) -> None:
        """Log where each robot is that is not lost."""
        transforms = [
            FrameTransform(
                timestamp=_timestamp(time),
                parent_frame_id=FRAME,
                child_frame_id=f"robot/{mission.robots[robot].name}",
                translation=Vector3(x=float(x), y=float(y), z=0.0),
                rotation=UPRIGHT,
            )
            for robot, (x, y) in enumerate(moment.place)
            if moment.team[robot] != NOBODY
        ]
        self._frames.log(FrameTransforms(transforms=transforms), log_time=time)

    def _show_scene(self, mission: Mission, told: Told) -> None:
        """Log tasks and robots as things to see."""
        moment, time = told.moment, told.time
        entities = [*_tasks(mission, moment, told.spans, time), *_robots(mission, moment, time)]
        entities += [] if told.layout is None else [_roads(told.layout, time)]
        self._scene.log(SceneUpdate(entities=entities), log_time=time)

    def _say(self, text: str, is_bad: bool, time: int) -> None:
        """Log what happened."""
        level = LogLevel.Warning if is_bad else LogLevel.Info
        entry = Log(timestamp=_timestamp(time), level=level, message=text, name="teamformer")
        self._log.log(entry, log_time=time)


def _tasks(
    mission: Mission, moment: Moment, spans: Sequence[Span], time: int
) -> Iterator[SceneEntity]:
    size = _unit(mission)
    for number, (task, (opens, ends)) in enumerate(zip(mission.tasks, spans, strict=True)):
        if opens > moment.step:
            continue
        is_over = ends <= moment.step
        box = CubePrimitive(
            pose=_pose(moment.task_at[number]),
            size=Vector3(x=0.8 * size, y=0.8 * size, z=0.05 * size),
            color=_colour(number, 0.25 if is_over else 0.9),
        )
        texts = [_text(task.name, moment.task_at[number], size)]
        facts = {"needs": describe(task.needs)}
        yield _entity(f"task/{task.name}", time, cubes=[box], texts=texts, facts=facts)


def _robots(mission: Mission, moment: Moment, time: int) -> Iterator[SceneEntity]:
    """Yield each robot in its team's colour, with a line to the task that it heads for."""
    size = _unit(mission)
    for robot, place in enumerate(moment.place):
        slot, task = moment.team[robot], moment.task[robot]
        colour = Color(r=0.5, g=0.5, b=0.5, a=0.6) if slot == NOBODY else _colour(slot, 1.0)
        disc = CylinderPrimitive(
            pose=_pose(place, 0.15 * size),
            size=Vector3(x=0.5 * size, y=0.5 * size, z=0.3 * size),
            bottom_scale=1.0,
            top_scale=1.0,
            color=colour,
        )
        name = mission.robots[robot].name
        lines = [] if task == NOBODY else [_line(place, moment.task_at[task], size, colour)]
        texts = [_text(name if slot != NOBODY else f"{name}, lost", place, size)]
        told = {"phase": moment.phase[robot]}
        yield _entity(f"robot/{name}", time, [], [disc], lines, texts, told)


def _roads(layout: Layout, time: int) -> SceneEntity:
    """Return the roads as lines, with the names of their places."""
    grey = Color(r=0.6, g=0.6, b=0.6, a=0.8)
    spots = layout.places
    lines = [_line(spots[one], spots[other], 1.0, grey) for one, other in layout.roads]
    texts = [_text(name, spot, 1.0) for name, spot in zip(layout.names, spots, strict=True)]
    return _entity("roads", time, lines=lines, texts=texts)


def _entity(
    name: str,
    time: int,
    cubes: Sequence[CubePrimitive] = (),
    cylinders: Sequence[CylinderPrimitive] = (),
    lines: Sequence[LinePrimitive] = (),
    texts: Sequence[TextPrimitive] = (),
    facts: Mapping[str, str] = MappingProxyType({}),
) -> SceneEntity:
    return SceneEntity(
        timestamp=_timestamp(time),
        frame_id=FRAME,
        id=name,
        cubes=list(cubes),
        cylinders=list(cylinders),
        lines=list(lines),
        texts=list(texts),
        metadata=[KeyValuePair(key=key, value=value) for key, value in facts.items()],
    )


def _line(one: Place, other: Place, size: float, colour: Color) -> LinePrimitive:
    return LinePrimitive(
        type=LinePrimitiveLineType.LineStrip,
        pose=_pose((0.0, 0.0)),
        thickness=0.04 * size,
        points=[Point3(x=float(x), y=float(y), z=0.1 * size) for x, y in (one, other)],
        color=colour,
    )


def _text(text: str, place: Place, size: float) -> TextPrimitive:
    dark = Color(r=0.1, g=0.1, b=0.1, a=1.0)
    pose = _pose(place, 0.5 * size)
    return TextPrimitive(pose=pose, billboard=True, font_size=0.3 * size, color=dark, text=text)


def _unit(mission: Mission) -> float:
    """Return the length that a robot is drawn in: a cell, or a plane's unit."""
    return 1.0 if isinstance(mission.world, GridWorld) else mission.world.unit


def _pose(place: Place, up: float = 0.0) -> Pose:
    position = Vector3(x=float(place[0]), y=float(place[1]), z=up)
    return Pose(position=position, orientation=UPRIGHT)


def _colour(number: int, alpha: float) -> Color:
    r, g, b = colorsys.hls_to_rgb(number * GOLDEN_ANGLE % 1.0, 0.5, 0.7)
    return Color(r=r, g=g, b=b, a=alpha)


def _timestamp(nanoseconds: int) -> Timestamp:
    return Timestamp(*divmod(nanoseconds, NANOSECONDS))
