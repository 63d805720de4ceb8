"""Maps that others have made: MovingAI benchmarks and ROS map_server."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import yaml

from teamformer.errors import TeamformerError
from teamformer.model import BLOCKED, FREE, Grid

LARGEST_MAP = 4_000_000  # cells
LARGEST_IMAGE = 100_000_000  # pixels

MOVINGAI_FREE = ".GS"

Image = npt.NDArray[np.float64]


def read_map(path: Path, cell: float | None = None) -> Grid:
    """Read a map by its file name: MovingAI for `.map`, else ROS map_server YAML."""
    return read_movingai(path) if path.suffix == ".map" else read_ros_map(path, cell)


def read_movingai(path: Path) -> Grid:
    """Read a MovingAI `.map`; the first row of the file is y = 0, as in its scenarios.

    Ground, grass and swamp are free. Raises `TeamformerError` where the file is broken.
    """
    lines = _read_bytes(path).decode("ascii", errors="replace").splitlines()
    head: dict[str, str] = {}
    begin = 0
    for begin, line in enumerate(lines, start=1):  # noqa: B007
        if line.strip() == "map":
            break
        key, _, value = line.strip().partition(" ")
        head[key] = value.strip()
    width, height = (_size(path, head, key) for key in ("width", "height"))
    rows = lines[begin : begin + height]
    _check_size(path, width * height)
    if len(rows) < height:
        raise TeamformerError(f"{path}: {height} rows are announced and {len(rows)} are there")
    for number, row in enumerate(rows, start=begin + 1):
        if len(row) != width:
            raise TeamformerError(f"{path}:{number}: this row has {len(row)} cells, not {width}")
    cells = ("".join(FREE if c in MOVINGAI_FREE else BLOCKED for c in row) for row in rows)
    return Grid(width, height, tuple(cells), "down")


def _size(path: Path, head: Mapping[str, str], key: str) -> int:
    text = head.get(key, "")
    if not re.fullmatch(r"[1-9]\d{0,6}", text):
        raise TeamformerError(f"{path}: this is no MovingAI map: it has no '{key}' above 'map'")
    return int(text)


def read_ros_map(path: Path, cell: float | None = None) -> Grid:
    """Read a map_server YAML and its PGM image, in cells of `cell` metres (default: one a pixel).

    A cell is blocked if any pixel in it is occupied or unknown, by the map's thresholds (trinary
    mode). The bottom row of the image is y = 0. Raises `TeamformerError` where a file is broken.
    """
    about = _read_description(path)
    resolution = about["resolution"]
    pixels_a_cell = 1 if cell is None else round(cell / resolution)
    is_multiple = cell is None or math.isclose(cell, pixels_a_cell * resolution)
    if pixels_a_cell < 1 or not is_multiple:
        raise TeamformerError(
            f"{path}: a cell of {cell} m is no multiple of the map's {resolution:g} m; "
            f"use {max(1, pixels_a_cell) * resolution:g}"
        )
    shade = _read_pgm(path.parent / about["image"])  # (height, width), 0 is black
    occupancy = shade if about["negate"] else 1 - shade
    is_free = np.flipud(occupancy < about["free_thresh"])
    return _grid_of(path, _downsampled(is_free, pixels_a_cell))


def _read_description(path: Path) -> dict[str, Any]:
    try:
        about = yaml.safe_load(_read_bytes(path))
    except (yaml.YAMLError, UnicodeDecodeError, ValueError, RecursionError):
        raise TeamformerError(f"{path}: this is not a map_server YAML file") from None
    if not isinstance(about, dict) or not isinstance(about.get("image"), str):
        raise TeamformerError(f"{path}: this is no map: it does not say 'image: FILE.pgm'")
    if about.get("mode", "trinary") != "trinary":
        raise TeamformerError(f"{path}: the mode is {about['mode']!r}; only trinary is understood")
    about.setdefault("negate", 0)
    about.setdefault("free_thresh", 0.196)
    about.setdefault("occupied_thresh", 0.65)
    for key in ("resolution", "negate", "free_thresh", "occupied_thresh"):
        value = about.get(key)
        if not isinstance(value, int | float) or not math.isfinite(value):
            raise TeamformerError(f"{path}: '{key}' is {value!r}; it must be a number")
    if about["resolution"] <= 0:
        raise TeamformerError(f"{path}: 'resolution' is {about['resolution']}; it must be positive")
    return about


def _read_pgm(path: Path) -> Image:
    """Read a PGM image, plain (P2) or raw (P5), as shades from 0 to 1, (height, width)."""
    data = _read_bytes(path)
    head = re.match(rb"(P[25])" + rb"(?:\s+|\s*#[^\n]*\n\s*)+(\d+)" * 3 + rb"\s", data)
    if head is None:
        raise TeamformerError(f"{path}: this is not a PGM image (P2 or P5)")
    width, height, white = (int(head.group(i)) for i in (2, 3, 4))
    if not 0 < white < 65536 or width < 1 or height < 1 or width * height > LARGEST_IMAGE:
        raise TeamformerError(f"{path}: {width} x {height} pixels up to {white} is not possible")
    body = data[head.end() :]
    if head.group(1) == b"P5":
        kind = "u1" if white < 256 else ">u2"
        size = width * height * (1 if white < 256 else 2)
        pixels = np.frombuffer(body[:size], dtype=kind).astype(np.float64)
    else:
        words = re.sub(rb"#[^\n]*", b"", body).split()[: width * height]
        pixels = np.array([int(word) for word in words if word.isdigit()], dtype=np.float64)
    if len(pixels) != width * height:
        raise TeamformerError(f"{path}: {width * height} pixels are announced, {len(pixels)} there")
    return np.asarray(pixels.reshape(height, width) / white)


def _downsampled(is_free: npt.NDArray[np.bool_], factor: int) -> npt.NDArray[np.bool_]:
    """Merge squares of pixels; a cell is free only if all its pixels are, as (height, width)."""
    height, width = is_free.shape
    padded = np.pad(is_free, ((0, -height % factor), (0, -width % factor)), constant_values=True)
    squares = padded.reshape(padded.shape[0] // factor, factor, -1, factor)
    return np.asarray(squares.all(axis=(1, 3)))


def _grid_of(path: Path, is_free: npt.NDArray[np.bool_]) -> Grid:
    height, width = is_free.shape
    _check_size(path, width * height)
    rows = tuple("".join(FREE if cell else BLOCKED for cell in row) for row in is_free)
    return Grid(width, height, rows, "up")


def _check_size(path: Path, cells: int) -> None:
    if cells > LARGEST_MAP:
        raise TeamformerError(
            f"{path}: {cells} cells; {LARGEST_MAP} are possible, use larger cells"
        )


def _read_bytes(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except FileNotFoundError:
        raise TeamformerError(f"{path}: there is no such file") from None
    except IsADirectoryError:
        raise TeamformerError(f"{path}: this is a folder") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise TeamformerError(f"{path}: cannot be read: {reason}") from None
