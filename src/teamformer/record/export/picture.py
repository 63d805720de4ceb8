"""Pictures of moments of a record, drawn as the page draws them, with a legend.

Everything is drawn twice as large and made smaller, so that edges are smooth.
"""

from __future__ import annotations

import colorsys
import math
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

from PIL import Image, ImageDraw, ImageFont

from teamformer.mission.model import Task
from teamformer.mission.parts.grid import Grid, Place
from teamformer.record.export.moments import Moment
from teamformer.record.phases import AT_WORK, LOST
from teamformer.record.record import Record
from teamformer.record.task_times import cancelled_steps, done_steps, known_steps
from teamformer.record.telling.whole import told_of
from teamformer.world.rules.constants import NOBODY

WIDEST, HIGHEST = 960, 640
"""Pixels of the map at most."""

LEAST = 360
"""Pixels of a picture's width, so that the caption says when it is and what is done."""

LARGEST_CELL = 48
MARGIN = 12
LEGEND, CAPTION = 30, 28
"""Pixels that the legend of capabilities and the caption take below the map."""

SCALE = 2
"""How much larger everything is drawn at first."""

LETTERS, SMALL = 14, 11
"""Sizes of letters in pixels: of the caption and the legend, and of names."""

NAMED_FROM = 22
"""Pixels of a cell from which tasks have their names, and what they need stands in them."""

LONGEST_NAME = 14
"""Letters of a task's name; of a longer one there are the first ones."""

PAPER, WALL, INK, LINE, GREY = "#ffffff", "#b4bcc8", "#1c2430", "#eceff4", "#8b95a3"

CAPABILITIES = (
    *("#e69f00", "#56b4e9", "#00936b", "#d174a8", "#0a6cb0", "#f0e442", "#d05a00", "#8b93a0"),
)
"""Colours of up to eight capabilities, after Okabe and Ito; the page has the same."""

GOLDEN_ANGLE = 0.381966  # of a turn

Point = tuple[float, float]
Box = tuple[float, float, float, float]


@dataclass(frozen=True)
class Spot:
    """Where a robot is drawn, in pixels of the larger picture: its middle and its radius."""

    x: float
    y: float
    radius: float

    def towards(self, other: Spot, part: float) -> Spot:
        """Return the spot a part of the way to another."""
        x, y = self.x + part * (other.x - self.x), self.y + part * (other.y - self.y)
        return Spot(x, y, self.radius + part * (other.radius - self.radius))


class Sheet:
    """Draws the moments of one record on a map that is drawn once."""

    def __init__(self, record: Record) -> None:
        self._mission = record.true_mission
        world = self._mission.world
        self._layout = told_of(record).layout if record.is_continuous else None
        self._ground_size = (self._layout or world).width, (self._layout or world).height
        self._is_grid = isinstance(world, Grid)
        self._is_up = not isinstance(world, Grid) or world.y_axis == "up"
        wide, high = self._ground_size
        cell = min(WIDEST / wide, HIGHEST / high)
        has_cells = self._is_grid or self._layout is not None
        self._cell = SCALE * (min(cell, LARGEST_CELL) if has_cells else cell)
        below = SCALE * (MARGIN + LEGEND + CAPTION)
        self._size = (
            max(SCALE * LEAST, math.ceil(wide * self._cell) + 2 * SCALE * MARGIN),
            math.ceil(high * self._cell) + SCALE * MARGIN + below,
        )
        self._size = (self._size[0] + self._size[0] % SCALE, self._size[1] + self._size[1] % SCALE)
        self._known, self._done = known_steps(record), done_steps(record)
        self._over = self._done | cancelled_steps(record)
        self._short = short_labels(self._mission.capabilities)
        self._ground = self._draw_ground()

    def spots(self, moment: Moment) -> list[Spot]:
        """Return where the robots of a moment are drawn: those in one place in rows."""
        by_place: dict[Place, list[int]] = defaultdict(list)
        for robot, place in enumerate(moment.place):
            by_place[place].append(robot)
        found = dict[int, Spot]()
        for place, robots in by_place.items():
            across = math.ceil(math.sqrt(len(robots)))
            gap = self._unit * 0.74 / across
            x, y = (along - gap * (across - 1) / 2 for along in self._pixel(place))
            for n, robot in enumerate(robots):
                radius = max(1.5 * SCALE, gap * 0.44)
                found[robot] = Spot(x + gap * (n % across), y + gap * (n // across), radius)
        return [found[robot] for robot in range(len(moment.place))]

    def draw(self, moment: Moment, spots: Sequence[Spot]) -> Image.Image:
        """Return the picture of a moment, with the robots at these spots."""
        image = self._ground.copy()
        pen = ImageDraw.Draw(image)
        self._draw_lines(pen, moment, spots)
        served = {
            task for task, phase in zip(moment.task, moment.phase, strict=True) if phase in AT_WORK
        }
        for number, task in enumerate(self._mission.tasks):
            if self._known[number] <= moment.step:
                self._draw_task(pen, moment, number, task, number in served)
        self._draw_teams(pen, moment, spots)
        for robot, spot in enumerate(spots):
            self._draw_robot(pen, moment, robot, spot)
        image = image.reduce(SCALE)
        corner = (MARGIN, image.height - CAPTION + 4)
        ImageDraw.Draw(image).text(corner, self.caption(moment), INK, _font(LETTERS))
        return image

    def caption(self, moment: Moment) -> str:
        """Return what stands below the picture of a moment."""
        done = sum(step <= moment.step for step in self._done.values())
        length = self._mission.seconds_a_step
        called_off = sum(step <= moment.step for step in self._over.values()) - done
        when = f"step {moment.step}" if self._is_grid else f"{moment.step * length:g} s"
        if self._mission.time == "continuous":
            when = f"at {round(moment.step, 2):g}"
        lost = sum(slot == NOBODY for slot in moment.team)
        more = f", {lost} robot{'s' if lost > 1 else ''} lost" if lost else ""
        gone = f", {called_off} called off" if called_off else ""
        name = self._mission.name[:40]
        return f"{when}, {done} of {len(self._mission.tasks)} tasks done{gone}{more}: {name}"

    def _draw_ground(self) -> Image.Image:
        image = Image.new("RGB", self._size, PAPER)
        pen, world = ImageDraw.Draw(image), self._mission.world
        left = SCALE * MARGIN
        right, bottom = (left + side * self._cell for side in self._ground_size)
        self._draw_roads(pen)
        if self._is_grid and self._cell >= 14 * SCALE:
            for x in range(1, int(world.width)):
                pen.line((left + x * self._cell, left, left + x * self._cell, bottom), LINE, SCALE)
            for y in range(1, int(world.height)):
                pen.line((left, left + y * self._cell, right, left + y * self._cell), LINE, SCALE)
        if isinstance(world, Grid) and world.rows:
            for y in range(world.height):
                for x in range(world.width):
                    if not world.is_free((x, y)):
                        pen.rectangle(_box(self._pixel((x, y)), self._cell / 2), WALL)
        pen.rectangle((left, left, right, bottom), outline=GREY, width=SCALE)
        self._draw_legend(pen, bottom + SCALE * 22)
        return image

    def _draw_roads(self, pen: ImageDraw.ImageDraw) -> None:
        """Draw where roads lead, and the names of their places where there is room."""
        if self._layout is None:
            return
        spots = [self._pixel(place) for place in self._layout.places]
        for one, other in self._layout.roads:
            pen.line((*spots[one], *spots[other]), LINE, max(SCALE, round(self._cell / 6)))
        for spot, name in zip(spots, self._layout.names, strict=True):
            pen.ellipse(_box(spot, self._cell / 5), GREY)
            if self._cell >= SCALE * NAMED_FROM:
                above = (spot[0], spot[1] - self._cell * 0.6)
                pen.text(above, name, GREY, _font(SCALE * SMALL), anchor="mb")

    def _draw_legend(self, pen: ImageDraw.ImageDraw, y: float) -> None:
        """Draw a disc and the name of each capability, as many as there is room for."""
        x, font = SCALE * MARGIN, _font(SCALE * LETTERS)
        for cap, name in enumerate(self._mission.capabilities):
            radius = SCALE * 9
            end = x + 2 * radius + SCALE * 6 + font.getlength(name)
            if end > self._size[0] - SCALE * MARGIN:
                return
            middle = (x + radius, y)
            pen.ellipse(_box(middle, radius), _of_capability(cap), None)
            label = self._short[cap]
            pen.text(middle, label, _ink_on(_of_capability(cap)), _font(SCALE * SMALL), anchor="mm")
            pen.text((x + 2 * radius + SCALE * 6, y), name, INK, font, anchor="lm")
            x = round(end) + SCALE * 16

    def _pixel(self, place: Place) -> Point:
        """Return the pixel of a place: of a cell its middle."""
        half = 0.5 if self._is_grid else 0.0
        x, y, high = place[0] + half, place[1] + half, self._ground_size[1]
        down = high - y if self._is_up else y
        return SCALE * MARGIN + x * self._cell, SCALE * MARGIN + down * self._cell

    @property
    def _unit(self) -> float:
        """Return the pixels of a cell; on a plane, of what a robot takes up."""
        has_cells = self._is_grid or self._layout is not None
        return self._cell if has_cells else min(self._size) / 24

    def _draw_lines(self, pen: ImageDraw.ImageDraw, moment: Moment, spots: Sequence[Spot]) -> None:
        """Draw a line from each team to its task."""
        for slot, task in zip(moment.team, moment.task, strict=True):
            if slot != NOBODY and task != NOBODY:
                way = (spots[slot].x, spots[slot].y, *self._pixel(moment.task_at[task]))
                pen.line(way, _tint(_of_task(task), 0.45), SCALE)

    def _draw_task(
        self, pen: ImageDraw.ImageDraw, moment: Moment, number: int, task: Task, is_served: bool
    ) -> None:
        is_over = self._over.get(number, moment.step + 1) <= moment.step
        is_done = is_over and number in self._done
        middle, colour, half = (
            self._pixel(moment.task_at[number]),
            _of_task(number),
            self._unit * 0.45,
        )
        if is_over:
            colour = _tint(colour, 0.5) if is_done else GREY
        box, thick = _box(middle, half), max(SCALE, round(self._unit / 13))
        fill = _tint(colour, 0.62 if is_served else 0.88)
        pen.rounded_rectangle(box, half * 0.4, fill, colour, thick)
        if is_done:
            (x, y), arm = middle, half * 0.42
            tick = ((x - arm, y), (x - arm * 0.25, y + arm * 0.7), (x + arm, y - arm * 0.7))
            pen.line(tick, colour, thick, joint="curve")
        elif is_over:
            pen.line(box, GREY, thick)
        if self._unit < SCALE * NAMED_FROM:
            return
        if not is_over and not is_served:
            needs = self._needs(task, 2 * half - 3 * thick)
            pen.text(middle, needs, INK, _font(SCALE * SMALL), anchor="mm")
        name = task.name if len(task.name) <= LONGEST_NAME else f"{task.name[:13]}…"
        at = (middle[0], middle[1] + half + SCALE * 3)
        pen.text(
            at,
            name,
            GREY if is_over else INK,
            _font(SCALE * SMALL),
            anchor="mt",
            stroke_width=SCALE,
            stroke_fill=PAPER,
        )

    def _needs(self, task: Task, room: float) -> str:
        """Return what a task needs in short, as in `2L S`; the number of kinds without room."""
        labels = dict(zip(self._mission.capabilities, self._short, strict=True))
        kinds = [
            f"{'' if count == 1 else f'{count:g}'}{labels[cap]}"
            for cap, count in task.needs.items()
        ]
        text = " ".join(kinds)
        return text if _font(SCALE * SMALL).getlength(text) <= room else str(len(kinds))

    def _draw_teams(self, pen: ImageDraw.ImageDraw, moment: Moment, spots: Sequence[Spot]) -> None:
        """Draw a ring around each team, in the colour of the task that it heads for."""
        members = defaultdict[int, list[Spot]](list)
        for robot, slot in enumerate(moment.team):
            if slot != NOBODY:
                members[slot].append(spots[robot])
        for slot, team in members.items():
            x, y = sum(s.x for s in team) / len(team), sum(s.y for s in team) / len(team)
            reach = max(math.hypot(s.x - x, s.y - y) + s.radius for s in team) + 2.5 * SCALE
            task = moment.task[slot]
            if len(team) > 1 or task != NOBODY:
                colour = GREY if task == NOBODY else _of_task(task)
                pen.ellipse(_box((x, y), reach), None, colour, round(1.5 * SCALE))

    def _draw_robot(self, pen: ImageDraw.ImageDraw, moment: Moment, robot: int, spot: Spot) -> None:
        """Draw a robot as a disc of the colours of its capabilities; a lost one as a cross."""
        box = _box((spot.x, spot.y), spot.radius)
        if moment.phase[robot] == LOST or moment.team[robot] == NOBODY:
            pen.line(box, GREY, 2 * SCALE)
            pen.line((box[0], box[3], box[2], box[1]), GREY, 2 * SCALE)
            return
        can = [
            cap
            for cap, name in enumerate(self._mission.capabilities)
            if name in self._mission.robots[robot].can
        ]
        for part, cap in enumerate(can):
            angles = (360 * part / len(can) - 90, 360 * (part + 1) / len(can) - 90)
            pen.pieslice(box, *angles, fill=_of_capability(cap))
        pen.ellipse(box, None, INK, max(1, SCALE // 2))
        if len(can) == 1 and spot.radius >= 7 * SCALE:
            ink = _ink_on(_of_capability(can[0]))
            pen.text((spot.x, spot.y), self._short[can[0]], ink, _font(SCALE * SMALL), anchor="mm")


def short_labels(names: Sequence[str]) -> list[str]:
    """Return one or two letters for each name, all different, or its number."""
    labels = list[str]()
    for number, name in enumerate(names, start=1):
        letters = [letter for letter in name if letter.isalnum()]
        wanted = [letters[0].upper()] if letters else []
        wanted += [letters[0].upper() + letter.lower() for letter in letters[1:]]
        labels.append(next((one for one in wanted if one not in labels), str(number)))
    return labels


def _font(size: int) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    return ImageFont.load_default(size)


def _box(middle: Point, half: float) -> Box:
    x, y = middle
    return x - half, y - half, x + half, y + half


def _of_capability(cap: int) -> str:
    if cap < len(CAPABILITIES):
        return CAPABILITIES[cap]
    return _hex(*colorsys.hls_to_rgb(cap * GOLDEN_ANGLE % 1, 0.68, 0.6))


def _of_task(task: int) -> str:
    """Return a colour for a task, far from those of its neighbours."""
    return _hex(*colorsys.hls_to_rgb((0.04 + task * GOLDEN_ANGLE) % 1, 0.47, 0.68))


def _tint(colour: str, white: float) -> str:
    """Return a colour with a part of white."""
    parts = (int(colour[at : at + 2], 16) / 255 for at in (1, 3, 5))
    return _hex(*(part + (1 - part) * white for part in parts))


def _ink_on(colour: str) -> str:
    """Return black or white, whichever is read better on a colour."""
    red, green, blue = (int(colour[at : at + 2], 16) for at in (1, 3, 5))
    return INK if 0.299 * red + 0.587 * green + 0.114 * blue > 120 else PAPER


def _hex(red: float, green: float, blue: float) -> str:
    return f"#{round(red * 255):02x}{round(green * 255):02x}{round(blue * 255):02x}"
