"""How fast the page is: `python tests/viewer/speed_of_page.py`, on a quiet machine.

It prints how soon the page of 1000 robots is there, how many frames a second its map shows
while they move, and how long after a click the page shows it, with 100 robots and 300 tasks.
A frame is counted when the browser has drawn it; a click when the second frame after it has begun,
so that the first is on the screen.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from typing import Any

sys.path.append(str(Path(__file__).parents[1]))

import teamformer as tf
from browsers import Opened, chromium

SECONDS = 5
CLICKS = 7  # of each kind

FRAMES = """(seconds) => new Promise((done) => {
  const begun = performance.now();
  let frames = 0;
  const count = (now) => {
    if (now - begun > 1000 * seconds) done(frames / seconds);
    else { frames++; requestAnimationFrame(count); }
  };
  requestAnimationFrame(count);
})"""

FIRST_FRAME = """() => new Promise((done) => {
  const ask = () => window.teamformer?.framesDrawn() ? done(performance.now()) : requestAnimationFrame(ask);
  ask();
})"""  # noqa: E501

CLICK = """(selector) => new Promise((done) => {
  const begun = performance.now();
  document.querySelector(selector).click();
  requestAnimationFrame(() => requestAnimationFrame(() => done(performance.now() - begun)));
})"""

KEY = """(key) => new Promise((done) => {
  const begun = performance.now();
  document.body.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
  requestAnimationFrame(() => requestAnimationFrame(() => done(performance.now() - begun)));
})"""

VIEWS = {"Gantt": "gantt", "Tasks": "tasks", "Robots": "robots", "Plots": "plots", "Map": "map"}


def page_of(robots: int, tasks: int, folder: Path) -> str:
    """Run a random mission by crews; the address of its page."""
    side = 60 if robots <= 100 else 100
    mission = tf.generate(
        robots=robots,
        tasks=tasks,
        capabilities=8,
        requirements=3,
        world=tf.Grid(side, side),
        seed=1,
    )
    tf.run(mission, method="crews").save(folder)
    return f"file://{folder}/record.html"


def opened(browser: Any, address: str) -> Opened:
    """Open a page at a desk; print when its first frame was on the screen."""
    page = browser.new_page(viewport={"width": 1400, "height": 900})
    page.goto(address)
    print(f"it opens in {page.evaluate(FIRST_FRAME):.0f} ms")
    found = Opened(page)
    found.wait_until("window.teamformer !== undefined")
    return found


def tell(what: str, times: list[float]) -> None:
    """Print the median of some milliseconds, and the longest."""
    print(f"{what}: {median(times):.0f} ms, at most {max(times):.0f}")


def main() -> None:
    """Measure and print."""
    with TemporaryDirectory() as folder, chromium() as browser:
        crowd = opened(browser, page_of(1000, 1000, Path(folder, "1000")))
        print(f"nothing moves: {crowd.page.evaluate(FRAMES, SECONDS):.0f} frames a second")
        crowd.page.keyboard.press(" ")
        print(f"1000 robots: {crowd.page.evaluate(FRAMES, SECONDS):.0f} frames a second")
        crowd.page.close()
        busy = opened(browser, page_of(100, 300, Path(folder, "100")))
        for name in ("events", "tasks", "teams", "robots", "capabilities"):
            tell(
                f"list of {name}",
                [busy.page.evaluate(CLICK, f"#tab-{name}") for _ in range(CLICKS)],
            )
        times: list[float] = []
        for number in range(CLICKS):
            busy.page.evaluate(CLICK, "#tab-robots")
            times.append(
                busy.page.evaluate(CLICK, f"#rows .sizer > :nth-child({number + 1}) button")
            )
        tell("a robot in the list", times)
        tell("a step", [busy.page.evaluate(KEY, "ArrowRight") for _ in range(CLICKS)])
        busy.page.evaluate(CLICK, "#view-gantt")
        busy.page.keyboard.press(" ")
        print(f"Gantt chart: {busy.page.evaluate(FRAMES, SECONDS):.0f} frames a second")
        busy.page.keyboard.press(" ")
        for title, name in VIEWS.items():
            _measure_view(busy, title, name, tell)


def _measure_view(
    busy: Opened, title: str, name: str, tell: Callable[[str, list[float]], None]
) -> None:
    """Measure how soon a view is there after its button, and how soon it shows the next step."""
    button = f"#view-{name}"
    tell(f"view {title}", [busy.page.evaluate(CLICK, button)])
    tell(f"a step in {title}", [busy.page.evaluate(KEY, "ArrowRight") for _ in range(CLICKS)])


if __name__ == "__main__":
    main()
