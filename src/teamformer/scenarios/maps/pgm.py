"""PGM images, plain (P2) and raw (P5)."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from teamformer.errors import TeamformerError
from teamformer.scenarios.file_access import read_bytes

LARGEST_FILE = 64_000_000  # bytes

_GAP = rb"(?:\s|#[^\n]*+\n)++"
HEAD = re.compile(
    rb"(P[25])" + _GAP + rb"(\d{1,6})" + _GAP + rb"(\d{1,6})" + _GAP + rb"(\d{1,5})\s"
)


@dataclass(frozen=True)
class Image:
    """A grey image: the shades of its pixels from 0, black, to `white`."""

    shades: npt.NDArray[np.unsignedinteger[Any]]  # (height, width), row 0 at the top
    white: int


def read_pgm(path: Path) -> Image:
    """Read an image; raises `TeamformerError` where the file is broken."""
    data = read_bytes(path, LARGEST_FILE, "write 'image:' as it is seen from the folder of the map")
    head = HEAD.match(data)
    if head is None:
        raise TeamformerError(f"{path}: this is not a PGM image (P2 or P5)", "convert it to PGM")
    width, height, white = (int(head.group(i)) for i in (2, 3, 4))
    if not (0 < white < 65536 and width and height):
        raise TeamformerError(f"{path}: no image has {width} x {height} pixels up to {white}")
    body = data[head.end() :]
    shades = _raw(body, width * height, white) if head.group(1) == b"P5" else _plain(path, body)
    if len(shades) < width * height:
        raise TeamformerError(
            f"{path}: {width * height} pixels are announced and {len(shades)} are there"
        )
    shades = shades[: width * height]
    if shades.max() > white:
        raise TeamformerError(f"{path}: a pixel is {shades.max()}, brighter than white, {white}")
    return Image(shades.reshape(height, width), white)


def _raw(body: bytes, pixels: int, white: int) -> npt.NDArray[np.unsignedinteger[Any]]:
    kind = np.dtype("u1" if white < 256 else ">u2")
    whole = min(pixels, len(body) // kind.itemsize)
    return np.frombuffer(body, kind, whole)


def _plain(path: Path, body: bytes) -> npt.NDArray[np.unsignedinteger[Any]]:
    try:
        return np.array(re.sub(rb"#[^\n]*", b"", body).split(), dtype=np.uint16)
    except (ValueError, OverflowError):
        raise TeamformerError(f"{path}: a pixel is no number from 0 to 65535") from None
