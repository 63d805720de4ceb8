"""Grey images: PGM, plain (P2) and raw (P5), and PNG, JPEG and BMP where Pillow is installed."""

from __future__ import annotations

import re
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from teamformer.base.errors import TeamformerError
from teamformer.base.extras import how_to_install
from teamformer.base.file_access import read_bytes

LARGEST_FILE = 64_000_000  # bytes
MOST_PIXELS = 80_000_000
BEGINNINGS = {"PNG": b"\x89PNG\r\n\x1a\n", "JPEG": b"\xff\xd8\xff", "BMP": b"BM"}
"""What files begin with that Pillow decodes."""
OPAQUE = 255

_GAP = rb"(?:\s|#[^\n]*+\n)++"
HEAD = re.compile(
    rb"(P[25])" + _GAP + rb"(\d{1,6})" + _GAP + rb"(\d{1,6})" + _GAP + rb"(\d{1,5})\s"
)


@dataclass(frozen=True)
class Image:
    """A grey image: the shades of its pixels from 0, black, to `white`.

    A pixel that is not opaque has no shade of its own.
    """

    shades: npt.NDArray[np.unsignedinteger[Any]]  # (height, width), row 0 at the top
    white: int
    is_opaque: npt.NDArray[np.bool_] | bool = True  # (height, width)


def read_image(path: Path) -> Image:
    """Read an image; raises `TeamformerError` where the file is broken."""
    data = read_bytes(path, LARGEST_FILE, "write 'image:' as it is seen from the folder of the map")
    for kind, beginning in BEGINNINGS.items():
        if data.startswith(beginning):
            return _decode(path, data, kind)
    return _read_pgm(path, data)


def _decode(path: Path, data: bytes, kind: str) -> Image:
    """Decode an image by Pillow; the shade of a coloured pixel is the sum of its colours."""
    try:
        from PIL import Image as Decoder
    except ModuleNotFoundError:
        hint = f"{how_to_install('maps')}, or convert it to PGM"
        raise TeamformerError(f"{path}: a {kind} image needs Pillow", hint) from None
    try:
        with Decoder.open(BytesIO(data), formats=(kind,)) as image:
            if image.width * image.height > MOST_PIXELS:
                raise ValueError(f"{image.width} x {image.height} pixels")
            if image.mode.startswith("I"):  # 16 bits
                shades = np.asarray(image, dtype=np.uint16)
                return Image(shades, 65535, shades != image.info.get("transparency", -1))
            pixels = np.asarray(image.convert("RGBA"))  # (height, width, 4)
    except (OSError, SyntaxError, ValueError, Decoder.DecompressionBombError) as error:
        raise TeamformerError(f"{path}: this {kind} cannot be read: {error}") from None
    shades = pixels[..., :3].sum(axis=2, dtype=np.uint16)
    return Image(shades, 3 * 255, pixels[..., 3] == OPAQUE)


def _read_pgm(path: Path, data: bytes) -> Image:
    head = HEAD.match(data)
    if head is None:
        what = f"{path}: this is no PGM (P2 or P5), PNG, JPEG or BMP image"
        raise TeamformerError(what, "convert it to PGM")
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
