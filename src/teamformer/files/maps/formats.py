"""Maps that others have made: MovingAI benchmarks and ROS map_server."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from teamformer.base.errors import TeamformerError
from teamformer.base.file_access import read_bytes, read_text
from teamformer.files.maps.images import Image, read_image
from teamformer.files.yaml.reader import Where, parse
from teamformer.files.yaml.tree_reader import Reader, misshapen
from teamformer.files.yaml.words import Misread, describe
from teamformer.mission.parts.frame import Frame
from teamformer.mission.parts.grid import BLOCKED, FREE, LARGEST_MAP, Grid

LARGEST_MOVINGAI = 10_000_000  # bytes
LARGEST_DESCRIPTION = 100_000  # bytes

MOVINGAI_FREE = ".GS"  # ground, grass and swamp; trees, water and walls are not
MOST_CELLS = 100  # a side
HINT = "write the name as it is seen from the folder of the mission"


ROS_MAP = re.compile(r"^(image|resolution):", re.MULTILINE)
"""What only the description of a ROS map has at its left edge."""


def is_map(name: str, text: str) -> bool:
    """Say whether a file of this name and text is a map, and not a mission."""
    return name.lower().endswith(".map") or ROS_MAP.search(text) is not None


def read_map(path: Path, cell: float | None = None) -> Grid:
    """Read a map by its file name: MovingAI for `.map`, ROS map_server for `.yaml`."""
    if path.suffix in (".yaml", ".yml"):
        return read_ros_map(path, cell)
    if path.suffix != ".map":
        raise TeamformerError(f"{path}: this is no map; name a .map or a map_server .yaml file")
    if cell is not None:
        raise TeamformerError(f"{path}: a .map file has its cells already; remove 'cell'")
    return read_movingai(path)


def read_coarse_map(path: Path) -> Grid:
    """Read a map as `read_map` does, but one of ROS in cells so large that a page can show them.

    That is at most 100 cells a side.
    """
    grid = read_map(path)
    longest = max(grid.width, grid.height)
    if grid.frame is None or longest <= MOST_CELLS:
        return grid
    return read_map(path, grid.frame.cell * math.ceil(longest / MOST_CELLS))


def read_movingai(path: Path) -> Grid:
    """Read a MovingAI `.map`; the first row of the file is y = 0, as in its missions.

    Raises `TeamformerError` where the file is broken.
    """
    text = read_bytes(path, LARGEST_MOVINGAI, HINT).decode("ascii", errors="replace")
    lines = [line.rstrip() for line in text.split("\n")]
    if "map" not in lines:
        raise TeamformerError(f"{path}: this is no MovingAI map: it has no line 'map'")
    begin = lines.index("map") + 1
    width, height = (_announced(path, lines[:begin], key) for key in ("width", "height"))
    _check_size(path, width * height)
    rows = lines[begin : begin + height]
    if len(rows) < height:
        raise TeamformerError(f"{path}: {height} rows are announced and {len(rows)} are there")
    for number, row in enumerate(rows, start=begin + 1):
        if len(row) != width:
            raise TeamformerError(f"{path}:{number}: this row has {len(row)} cells, not {width}")
    cells = ("".join(FREE if c in MOVINGAI_FREE else BLOCKED for c in row) for row in rows)
    return Grid(width, height, tuple(cells), "down")


def _announced(path: Path, head: list[str], key: str) -> int:
    for line in head:
        if found := re.fullmatch(rf"\s*{key}\s+([1-9]\d{{0,6}})", line):
            return int(found.group(1))
    raise TeamformerError(f"{path}: this is no MovingAI map: it has no '{key} N' above 'map'")


def read_ros_map(path: Path, cell: float | None = None) -> Grid:
    """Read a map_server YAML and its image, in cells of `cell` metres (default: one a pixel).

    A cell is blocked if any pixel in it is occupied or unknown (trinary mode). The bottom row of
    the image is y = 0. Raises `TeamformerError` where a file is broken.
    """
    about = _read_about(path)
    factor = 1 if cell is None else _pixels_a_cell(path, cell, about.resolution)
    image = read_image(path.parent / about.image)
    height, width = (math.ceil(pixels / factor) for pixels in image.shades.shape)
    _check_size(path, width * height)
    is_blocked = ~about.is_free(image)[::-1]  # (height, width) in pixels, row 0 at the bottom
    for axis, pixels in enumerate(image.shades.shape):
        is_blocked = np.logical_or.reduceat(is_blocked, np.arange(0, pixels, factor), axis=axis)
    cells = np.where(is_blocked, ord(BLOCKED), ord(FREE)).astype(np.uint8)
    frame = Frame(factor * about.resolution, *about.origin)
    return Grid(width, height, tuple(row.tobytes().decode() for row in cells), "up", frame)


@dataclass(frozen=True)
class MapDescription:
    """What a map_server file says about its image."""

    image: str
    resolution: float  # metres a pixel
    origin: tuple[float, float, float]  # of the lower left pixel's corner: metres, radians
    is_negated: bool  # white is occupied
    occupied_thresh: float
    free_thresh: float

    def is_free(self, image: Image) -> npt.NDArray[np.bool_]:
        """Say which pixels are free, by map_server's trinary rule; unknown ones are not.

        Pixels through which one sees are unknown.
        """
        dark = (image.white - np.arange(image.white + 1)) / image.white  # (shades,)
        occupancy = dark[::-1] if self.is_negated else dark
        is_free = (occupancy <= self.occupied_thresh) & (occupancy < self.free_thresh)
        return np.asarray(is_free[image.shades] & image.is_opaque)


def _read_about(path: Path) -> MapDescription:
    tree = parse(read_text(path, LARGEST_DESCRIPTION, HINT))
    reader = Reader(tree)
    known = tree.value
    if isinstance(tree.value, dict):  # what else it says does not matter here
        known = {key: part for key, part in tree.value.items() if key in ABOUT_KEYS}
    keys = {} if tree.problems else reader.mapping((), known, ABOUT_KEYS)
    about = MapDescription(
        image=reader.text(("image",), keys.get("image", "?")),
        resolution=reader.number(("resolution",), keys.get("resolution", 1)),
        origin=read_origin(reader, ("origin",), keys.get("origin", [0, 0, 0])),
        is_negated=_read_negate(reader, keys.get("negate", 0)),
        occupied_thresh=_read_share(reader, "occupied_thresh", keys),
        free_thresh=_read_share(reader, "free_thresh", keys),
    )
    if not about.resolution >= FINEST:
        reader.refuse(("resolution",), f"resolution is {about.resolution}; write {FINEST} or more")
    if str(keys.get("mode", "trinary")).lower() not in ("trinary", "scale"):
        mode = describe(keys["mode"])
        reader.refuse(("mode",), f"the mode is {mode}; only trinary and scale are read")
    if tree.problems:
        found = sorted((line, problem.message) for line, problem in tree.problems)
        raise TeamformerError(
            "; ".join(f"{path}:{line}: {message}" for line, message in found[:10])
        )
    return about


ABOUT_KEYS = {
    "image": True,  # required
    "resolution": True,
    "origin": False,
    "negate": False,
    "occupied_thresh": True,
    "free_thresh": True,
    "mode": False,
}
FINEST = 1e-6  # metres
PERCENT = 100


def read_origin(reader: Reader, where: Where, value: Any) -> tuple[float, float, float]:
    """Return x and y in metres and a yaw in radians, which may be left out."""
    if not isinstance(value, list) or len(value) not in (2, 3):
        wanted = 3 if isinstance(value, list) and len(value) > 3 else 2
        reader.refuse(where, f"the origin {misshapen(value, wanted)}; write it as [x, y, yaw]")
        return 0.0, 0.0, 0.0
    x, y, yaw = (reader.number((*where, i), part) for i, part in enumerate([*value, 0.0][:3]))
    return x, y, yaw


def _read_share(reader: Reader, key: str, keys: Mapping[str, Any]) -> float:
    share = reader.number((key,), keys.get(key, 0))
    if not 0 <= share <= 1:
        remedy = "write a share from 0 to 1"
        if 1 < share <= PERCENT:
            remedy = f"write it as a share, {share / PERCENT:g}"
        reader.refuse((key,), f"{key} is {share:g}; {remedy}")
    return share


def _read_negate(reader: Reader, value: Any) -> bool:
    word = value.text.lower() if isinstance(value, Misread) else value
    if word not in (0, 1, "true", "false"):
        reader.refuse(("negate",), f"negate is {describe(value)}; write 0 or 1")
    return word in (1, "true")


def _pixels_a_cell(path: Path, cell: float, resolution: float) -> int:
    factor = round(cell / resolution)
    if factor < 1 or not math.isclose(cell, factor * resolution):
        raise TeamformerError(
            f"{path}: a cell of {cell:g} m is no multiple of the map's {resolution:g} m; "
            f"use {max(1, factor) * resolution:g}"
        )
    return factor


def _check_size(path: Path, cells: int) -> None:
    if cells > LARGEST_MAP:
        raise TeamformerError(
            f"{path}: {cells:,} cells; {LARGEST_MAP:,} are possible, so use larger cells"
        )
