"""A record as a moving picture (GIF) that looks like the page: robots glide from step to step."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
from PIL import Image

from teamformer.base.array_types import Array
from teamformer.record.export.moments import Moment, evenly, moments, moments_at
from teamformer.record.export.picture import Sheet
from teamformer.record.phases import IDLE
from teamformer.record.record import Record
from teamformer.world.rules.constants import NOBODY

MOST_FRAMES = 500
"""A longer mission is shown in larger strides."""

SMOOTH = 3
"""Frames from one step to the next, where that makes no more than `MOST_FRAMES`."""

TIMES = MOST_FRAMES // SMOOTH - 1
"""Moments of a record in continuous time that are shown, with frames between."""

STEP_MS, LAST_MS = 150, 2500
COLOURS = 96

CLEAR = 255
"""The number of the colour that lets the frame before be seen."""


def write_gif(record: Record, path: Path) -> None:
    """Write a record as a GIF."""
    seen = [_pursuing(*pair) for pair in pairwise([None, *_shown_of(record)])]
    stride = math.ceil(len(seen) / MOST_FRAMES)
    shown = seen[:-1:stride] + seen[-1:]
    smooth = SMOOTH if SMOOTH * (len(shown) - 1) < MOST_FRAMES else 1
    sheet = Sheet(record)
    palette = _palette(sheet, shown)
    frames = _changes(
        frame.quantize(palette=palette, dither=Image.Dither.NONE)
        for frame in _frames(sheet, shown, smooth)
    )
    first, *others = frames
    first.save(
        path,
        save_all=True,
        append_images=others,
        duration=[STEP_MS // smooth] * len(others) + [LAST_MS],
        loop=0,
        optimize=False,
        transparency=CLEAR,
        disposal=1,  # a frame is drawn over the one before
    )


def _shown_of(record: Record) -> Iterable[Moment]:
    """Return the moments that are shown: after each step, or at so many times."""
    if record.is_continuous:
        return moments_at(record, evenly(record, TIMES))
    return moments(record)


def _changes(frames: Iterable[Image.Image]) -> Iterator[Image.Image]:
    """Yield frames in which whatever is as in the frame before is clear: a third of the bytes."""
    before: Array | None = None
    for frame in frames:
        now = np.array(frame)
        if before is None:
            yield frame
        else:
            change = Image.fromarray(np.where(now == before, CLEAR, now).astype(np.uint8), "P")
            change.putpalette(frame.getpalette() or [])
            yield change
        before = now


def _frames(sheet: Sheet, shown: Sequence[Moment], smooth: int) -> Iterator[Image.Image]:
    """Yield the pictures of moments, and between two of them some of robots on their way."""
    spots = sheet.spots(shown[0])
    yield sheet.draw(shown[0], spots)
    for before, moment in pairwise(shown):
        after = sheet.spots(moment)
        for part in range(1, smooth):
            gliding = [
                one.towards(two, part / smooth) for one, two in zip(spots, after, strict=True)
            ]
            yield sheet.draw(before, gliding)
        yield sheet.draw(moment, after)
        spots = after


def _palette(sheet: Sheet, shown: Sequence[Moment]) -> Image.Image:
    """Return one palette for all frames, from some of them side by side."""
    some = [shown[0], shown[len(shown) // 3], shown[2 * len(shown) // 3], shown[-1]]
    pictures = [sheet.draw(moment, sheet.spots(moment)) for moment in some]
    wide, high = pictures[0].size
    strip = Image.new("RGB", (wide, high * len(pictures)))
    for number, picture in enumerate(pictures):
        strip.paste(picture, (0, high * number))
    return strip.quantize(COLOURS, dither=Image.Dither.NONE)


def _pursuing(before: Moment | None, moment: Moment | None) -> Moment:
    """Return a moment with the tasks that robots were busy with, even if they no longer are."""
    assert moment is not None
    if before is None:
        return moment
    tasks = zip(before.task, moment.task, moment.phase, strict=True)
    busy = tuple(one if two == NOBODY and phase != IDLE else two for one, two, phase in tasks)
    return replace(moment, task=busy)
