"""Stills and a film of a mission: who can do what, who is with whom, which tasks are met.

As in the paper's figures 7 and 8: a robot's inner ring has the colour of its capability, its outer
ring that of its team, and that of the team's task once the team has what the task needs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from teamformer.base.errors import TeamformerError
from teamformer.base.extras import how_to_install
from teamformer.mission.model import Mission
from teamformer.mission.parts.capabilities import covers, describe, total
from teamformer.robotarium.flight import Snapshot
from teamformer.robotarium.robots.arena import DIAMETER, HEIGHT, MIDDLE, TICK, WIDTH

FRAME_TICKS = 15  # between two pictures of the film
FRAME_MS = 100
DOTS = 80  # an inch: the film is 800 dots wide
MOST_STILLS = 12
TEAM_COLOURS = ("#7a7a7a", "#b0b0b0", "#404040", "#949494")
"""Greys: colours are for capabilities and tasks; a lone robot has a thin ring."""


@dataclass(frozen=True)
class Palette:
    """The colours of a mission's capabilities and tasks."""

    capabilities: dict[str, Any]
    tasks: list[Any]


class Film:
    """Keeps the moments worth drawing; give its `watch` to a mission."""

    def __init__(self) -> None:
        self._frames: list[Snapshot] = []
        self._stills: list[Snapshot] = []
        self._state: object = None

    def watch(self, moment: Snapshot) -> None:
        """Keep every so many ticks a frame, and a still whenever teams or tasks have changed."""
        if moment.tick % FRAME_TICKS == 0:
            self._frames.append(moment)
        state = ([team.robots for team in moment.teams], moment.is_done.tolist())
        if state != self._state:
            self._stills.append(moment)
            self._state = state
        self._last = moment

    def write(self, mission: Mission, folder: Path) -> list[Path]:
        """Write `mission.gif` and numbered stills; return the files."""
        plt = _load_pyplot()
        palette = _palette(mission, plt)
        written = []
        stills = self._phases()
        for number, moment in enumerate(stills):
            path = folder / f"phase-{number:02d}-at-{moment.tick * TICK:05.1f}-s.png"
            figure = _draw(plt, mission, palette, moment)
            figure.savefig(path, dpi=2 * DOTS)
            plt.close(figure)
            written.append(path)
        return [*written, self._write_film(plt, mission, palette, folder / "mission.gif")]

    def _phases(self) -> list[Snapshot]:
        """Return the first still, the last, and as many of those between as there is room for."""
        stills = list(self._stills)
        if stills[-1].tick != self._last.tick:
            stills.append(self._last)
        kept = np.unique(np.linspace(0, len(stills) - 1, MOST_STILLS).round().astype(int))
        return [stills[i] for i in kept]

    def _write_film(self, plt: Any, mission: Mission, palette: Palette, path: Path) -> Path:
        from PIL import Image

        pictures = []
        for moment in self._frames:
            figure = _draw(plt, mission, palette, moment)
            figure.set_dpi(DOTS)
            figure.canvas.draw()
            picture = Image.fromarray(np.asarray(figure.canvas.buffer_rgba())).convert("RGB")
            pictures.append(picture.quantize(64))
            plt.close(figure)
        first, *rest = pictures
        first.save(path, save_all=True, append_images=rest, duration=FRAME_MS, loop=0)
        return path


def _load_pyplot() -> Any:
    try:
        import matplotlib

        matplotlib.use("Agg")
        from matplotlib import pyplot
    except ImportError:
        hint = how_to_install("plots")
        raise TeamformerError("pictures need matplotlib", hint) from None
    return pyplot


def _palette(mission: Mission, plt: Any) -> Palette:
    """Return strong colours for tasks, and a circle of hues for capabilities."""
    hues = np.linspace(0, 1, len(mission.capabilities), endpoint=False)
    soft = plt.get_cmap("hsv")(hues)[:, :3] * 0.75 + 0.10
    strong = plt.get_cmap("tab10")(np.arange(len(mission.tasks)) % 10)[:, :3]
    return Palette(dict(zip(mission.capabilities, soft, strict=True)), list(strong))


def _draw(plt: Any, mission: Mission, palette: Palette, moment: Snapshot) -> Any:
    figure, axes = plt.subplots(figsize=(10, 6.6), layout="constrained")
    axes.set(xlim=(0, WIDTH), ylim=(0, HEIGHT), aspect="equal", xticks=[], yticks=[])
    done = int(moment.is_done.sum())
    title = f"{moment.tick * TICK:.1f} s: {len(moment.teams)} teams, {done} of "
    axes.set_title(f"{mission.name}, {title}{len(mission.tasks)} tasks done", fontsize=13)
    _draw_tasks(axes, mission, palette, moment)
    for number, team in enumerate(moment.teams):
        _draw_team(plt, axes, mission, palette, moment, number, team.robots, team.task)
    _draw_legend(plt, axes, palette)
    return figure


def _draw_tasks(axes: Any, mission: Mission, palette: Palette, moment: Snapshot) -> None:
    for number, task in enumerate(mission.tasks):
        colour, is_done = palette.tasks[number], bool(moment.is_done[number])
        marker = "x" if is_done else "s"
        axes.plot(*task.at, marker, color=colour, markersize=13, markeredgewidth=3, zorder=1)
        late = "" if is_done or moment.is_open[number] else ", later"
        text = f"{task.name}: {'done' if is_done else describe(task.needs)}{late}"
        below = task.at[1] > HEIGHT - 0.4
        axes.annotate(
            text,
            task.at,
            xytext=(0, -62 if below else 62),
            textcoords="offset points",
            ha="center",
            va="center",
            fontsize=9,
            color=colour,
            weight="bold",
            zorder=6,
            bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 1},
        )


def _draw_team(
    plt: Any,
    axes: Any,
    mission: Mission,
    palette: Palette,
    moment: Snapshot,
    number: int,
    robots: Sequence[int],
    task: int | None,
) -> None:
    """Draw the robots of a team, and thin lines that say that they belong together."""
    brought = total(mission.robots[robot].can for robot in robots)
    is_met = task is not None and covers(brought, mission.tasks[task].needs)
    colour = palette.tasks[task] if task is not None and is_met else TEAM_COLOURS[number % 4]
    places = moment.poses[list(robots), :2] + MIDDLE
    middle = places.mean(axis=0)
    for robot, (x, y) in zip(robots, places, strict=True):
        axes.plot([x, middle[0]], [y, middle[1]], color=colour, linewidth=1, alpha=0.5, zorder=2)
        heading = moment.poses[robot, 2]
        width = 4 if is_met else 3 if len(robots) > 1 else 1.5
        circle = plt.Circle
        axes.add_patch(circle((x, y), DIAMETER / 2, color="white", zorder=3))
        axes.add_patch(
            circle((x, y), 0.075, fill=False, edgecolor=colour, linewidth=width, zorder=4)
        )
        inner = _colour_of(mission, palette, robot)
        axes.add_patch(circle((x, y), 0.045, fill=False, edgecolor=inner, linewidth=5, zorder=4))
        nose = np.array([np.cos(heading), np.sin(heading)]) * DIAMETER / 2
        axes.plot([x, x + nose[0]], [y, y + nose[1]], color="black", linewidth=1.5, zorder=5)


def _colour_of(mission: Mission, palette: Palette, robot: int) -> Any:
    """Return the colour of a robot's first capability."""
    return palette.capabilities[next(iter(mission.robots[robot].can))]


def _draw_legend(plt: Any, axes: Any, palette: Palette) -> None:
    handles = [
        plt.Line2D([], [], marker="o", linestyle="", markerfacecolor="none", markersize=9,
                   markeredgewidth=3, color=colour, label=name)
        for name, colour in palette.capabilities.items()
    ]  # fmt: skip
    axes.legend(
        handles=handles,
        title="inner ring: what a robot can do; outer ring: its team, "
        "in the colour of its task once the team has all that the task needs",
        loc="upper center",
        bbox_to_anchor=(0.5, -0.01),
        ncols=10,
        fontsize=8,
        title_fontsize=8,
        frameon=False,
    )
