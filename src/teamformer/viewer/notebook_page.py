"""A page that a notebook shows in a frame."""

from __future__ import annotations

import html
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Page:
    """A page of a record, a plan or advice; a notebook shows it in a frame.

    >>> page = tf.run(tf.setting("4N4T-C4")).show()
    >>> page.height
    620
    """

    text: str = field(repr=False)  # of the whole page, which needs no network
    height: int = 620  # of the frame, in pixels

    def _repr_html_(self) -> str:
        frame = 'style="width: 100%; border: 0" sandbox="allow-scripts allow-downloads"'
        return f'<iframe height="{self.height}" {frame} srcdoc="{html.escape(self.text)}"></iframe>'
