"""A record as a moving picture (GIF): the map, tasks and robots, a frame a step."""

from __future__ import annotations

import colorsys
import math
from collections import defaultdict
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

from teamformer.mission.parts.grid import Grid, Place
from teamformer.record.export.moments import Moment, moments
from teamformer.record.phases import AT_WORK, IDLE, LOST
from teamformer.record.record import Record
from teamformer.record.task_times import cancelled_steps, done_steps, known_steps
from teamformer.world.rules.constants import NOBODY

WIDEST, HIGHEST = 960, 640
"""Pixels of the map at most."""

LEAST = 280
"""Pixels of a picture's width, so that the caption says when it is and what is done."""

LARGEST_CELL = 40
MARGIN = 10
CAPTION = 26
MOST_FRAMES = 500
"""A longer mission is shown in larger strides."""

FRAME_MS, LAST_MS = 120, 2500
GOLDEN_ANGLE = 0.381966  # of a turn
NAMED_FROM = 22
"""Pixels of a cell from which tasks have their names."""

LONGEST_NAME = 12
"""Letters of a task's name; of a longer one there are the first ones."""

PAPER, WALL, INK, FAINT, GREY = "#ffffff", "#5b6472", "#1c2430", "#e3e7ed", "#9aa3af"

Point = tuple[float, float]


def write_gif(record: Record, path: Path) -> None:
    """Write a record as a GIF."""
    seen = [_pursuing(*pair) for pair in pairwise([None, *moments(record)])]
    stride = math.ceil(len(seen) / MOST_FRAMES)
    shown = seen[:-1:stride] + seen[-1:]
    sheet = _Sheet(record)
    frames = [sheet.draw(moment) for moment in shown]
    frames[0].save(
        path,
        save_all=True,
        append_images=frames[1:],
        duration=[FRAME_MS] * (len(frames) - 1) + [LAST_MS],
        loop=0,
        optimize=False,
    )


def _pursuing(before: Moment | None, moment: Moment | None) -> Moment:
    """Return a moment with the tasks that robots were busy with, even if they no longer are."""
    assert moment is not None
    if before is None:
        return moment
    tasks = zip(before.task, moment.task, moment.phase, strict=True)
    busy = tuple(one if two == NOBODY and phase != IDLE else two for one, two, phase in tasks)
    return replace(moment, task=busy)


class _Sheet:
    """Draws the moments of one record on a map that is drawn once."""

    def __init__(self, record: Record) -> None:
        self._record, self._mission = record, record.true_mission
        world = self._mission.world
        self._is_grid = isinstance(world, Grid)
        self._high = world.height
        self._is_up = not isinstance(world, Grid) or world.y_axis == "up"
        self._cell = min(WIDEST / world.width, HIGHEST / world.height)
        if self._is_grid:
            self._cell = min(self._cell, LARGEST_CELL)
        self._size = (
            max(LEAST, math.ceil(world.width * self._cell) + 2 * MARGIN),
            math.ceil(world.height * self._cell) + 2 * MARGIN + CAPTION,
        )
        self._known, self._done = known_steps(record), done_steps(record)
        self._over = self._done | cancelled_steps(record)
        self._font = ImageFont.load_default(11)
        self._ground = self._draw_ground()

    def draw(self, moment: Moment) -> Image.Image:
        """Return the picture of a moment, in the colours of one palette."""
        image = self._ground.copy()
        pen = ImageDraw.Draw(image)
        now = zip(moment.task, moment.phase, strict=True)
        served = {task for task, phase in now if phase in AT_WORK}
        self._draw_tasks(pen, moment, served)
        self._draw_robots(pen, moment)
        pen.text((MARGIN, self._size[1] - CAPTION + 4), self._caption(moment), INK, self._font)
        return image.quantize(64, dither=Image.Dither.NONE)

    def _draw_ground(self) -> Image.Image:
        image = Image.new("RGB", self._size, PAPER)
        pen, world = ImageDraw.Draw(image), self._mission.world
        right = MARGIN + math.ceil(world.width * self._cell)
        corners = (MARGIN, MARGIN, right, self._size[1] - MARGIN - CAPTION)
        pen.rectangle(corners, outline=GREY)
        if isinstance(world, Grid) and world.rows:
            for y in range(world.height):
                for x in range(world.width):
                    if not world.is_free((x, y)):
                        pen.rectangle(self._box(self._pixel((x, y)), self._cell / 2), WALL)
        return image

    def _pixel(self, place: Place) -> Point:
        """Return the pixel of a place: of a cell its middle."""
        half = 0.5 if self._is_grid else 0.0
        x, y = place[0] + half, place[1] + half
        return MARGIN + x * self._cell, MARGIN + (self._high - y if self._is_up else y) * self._cell

    @property
    def _unit(self) -> float:
        """Return the pixels of a cell; on a plane, of what a robot takes up."""
        return self._cell if self._is_grid else min(self._size) / 30

    def _draw_tasks(self, pen: ImageDraw.ImageDraw, moment: Moment, served: set[int]) -> None:
        for number, task in enumerate(self._mission.tasks):
            if self._known[number] > moment.step:
                continue
            is_over = self._over.get(number, moment.step + 1) <= moment.step
            middle, colour = (
                self._pixel(moment.task_at[number]),
                GREY if is_over else _colour(number),
            )
            box = self._box(middle, self._unit * 0.46)
            fill = FAINT if is_over or number in served else None
            pen.rectangle(box, fill, colour, max(1, round(self._unit / 12)))
            if is_over and number not in self._done:
                pen.line(box, GREY, 1)
            if self._unit >= NAMED_FROM:
                at = (middle[0], middle[1] + self._unit * 0.5)
                name = task.name if len(task.name) <= LONGEST_NAME else f"{task.name[:11]}…"
                pen.text(at, name, GREY if is_over else INK, self._font, anchor="mt")

    def _draw_robots(self, pen: ImageDraw.ImageDraw, moment: Moment) -> None:
        """Draw robots as discs in the colour of the task they head for; lost ones as crosses."""
        by_place: dict[Place, list[int]] = defaultdict(list)
        for robot, place in enumerate(moment.place):
            by_place[place].append(robot)
        for place, robots in by_place.items():
            spots, radius = self._spread(self._pixel(place), len(robots))
            for robot, (x, y) in zip(robots, spots, strict=True):
                box = self._box((x, y), radius)
                if moment.phase[robot] == LOST or moment.team[robot] == NOBODY:
                    pen.line(box, GREY, 2)
                    pen.line((box[0], box[3], box[2], box[1]), GREY, 2)
                else:
                    task = moment.task[robot]
                    pen.ellipse(box, GREY if task == NOBODY else _colour(task), INK)

    def _spread(self, middle: Point, count: int) -> tuple[list[Point], float]:
        """Return where so many robots in one place are drawn, in rows, and their radius."""
        across = math.ceil(math.sqrt(count))
        gap = self._unit * 0.8 / across
        first = -gap * (across - 1) / 2
        spots = [
            (middle[0] + first + gap * (n % across), middle[1] + first + gap * (n // across))
            for n in range(count)
        ]
        return spots, max(1.5, gap * 0.42)

    def _box(self, middle: Point, half: float) -> tuple[float, float, float, float]:
        x, y = middle
        return x - half, y - half, x + half, y + half

    def _caption(self, moment: Moment) -> str:
        done = sum(step <= moment.step for step in self._done.values())
        length = self._mission.seconds_a_step
        called_off = sum(step <= moment.step for step in self._over.values()) - done
        when = f"step {moment.step}" if self._is_grid else f"{moment.step * length:g} s"
        lost = sum(slot == NOBODY for slot in moment.team)
        more = f", {lost} robot{'s' if lost > 1 else ''} lost" if lost else ""
        gone = f", {called_off} called off" if called_off else ""
        name = self._mission.name[:40]
        return f"{when}, {done} of {len(self._mission.tasks)} tasks done{gone}{more}: {name}"


def _colour(task: int) -> str:
    """Return a colour for a task, far from those of its neighbours."""
    red, green, blue = colorsys.hls_to_rgb(task * GOLDEN_ANGLE % 1, 0.45, 0.65)
    return f"#{round(red * 255):02x}{round(green * 255):02x}{round(blue * 255):02x}"
