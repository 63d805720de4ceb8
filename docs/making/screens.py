"""Looks at every page as people see it: `python docs/making/screens.py [NAMES]`.

Each is made by the commands of the docs and opened at three sizes: of a desk, a tablet, a phone.
The pictures are kept in build/screens as NAME-SIZE.png; what the docs show goes to docs/images too.
It needs the extras `dev` and `live`, and a browser.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from PIL import Image

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / "build" / "screens"
SIZES = {"desk": (1400, 900), "tablet": (820, 1180), "phone": (390, 844)}
SHOWN = ("editor-desk", "loss-desk", "loss-tablet", "compare-desk")
"""What the docs show, in few colours."""

PORT = 8790
OPEN = "document.querySelector('canvas, svg')"
FORESEEN = "document.querySelector('#outlook')?.textContent.includes('all done')"
Page = Any


def teamformer(*words: object) -> None:
    """Run a command to its end."""
    subprocess.run([sys.executable, "-m", "teamformer.cli", *map(str, words)], check=True)


@contextmanager
def served(*words: object) -> Iterator[str]:
    """Run a server while the block runs; its address."""
    words = ("live", *words, "--port", PORT, "--out", FOLDER / "live")
    server = subprocess.Popen(
        [sys.executable, "-m", "teamformer.cli", *map(str, words)],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    assert server.stdout is not None
    try:
        for line in server.stdout:
            if "http://" in line:
                yield line[line.index("http://") :].split()[0]
                break
    finally:
        server.terminate()
        server.wait()


def wait_until(page: Page, condition: str, seconds: float = 60.0) -> None:
    """Wait for what is so in a page, be it loaded again meanwhile."""
    from playwright.sync_api import Error

    def is_so() -> bool:
        try:
            return bool(page.evaluate(f"Boolean({condition})"))
        except Error:
            return False

    end = time.monotonic() + seconds
    while not is_so():
        if time.monotonic() > end:
            raise SystemExit(f"never came true: {condition}")
        page.wait_for_timeout(50)


def at_step(page: Page, step: int) -> None:
    """Make steps of a live mission, one by one, once it has begun."""
    wait_until(page, FORESEEN)
    while (made := page.evaluate("window.teamformer.last")) < step:
        page.keyboard.press("ArrowRight")
        wait_until(page, f"window.teamformer.last > {made}")


def selected(page: Page, tab: str, name: str) -> None:
    """Select a robot or a task in the lists."""
    page.click(f"#tab-{tab}")
    page.click(f".row >> text={name}")


def lost(page: Page) -> None:
    """Lose a robot eleven steps into the mission."""
    at_step(page, 11)
    selected(page, "robots", "bison")
    page.click("text=Lose bison …")
    page.click("text=Yes, lose bison")
    wait_until(page, "document.querySelector('#incidents li')")
    wait_until(page, FORESEEN)


def weighed(page: Page) -> None:
    """Ask what the loss of a robot would cost."""
    at_step(page, 11)
    selected(page, "robots", "bison")
    page.click("text=What would that cost?")
    wait_until(page, "document.querySelector('#answer').textContent.includes('all done')")


def tabled(page: Page) -> None:
    """Show the table of tasks halfway."""
    at_step(page, 20)
    page.click("text=/^Tasks$/ >> nth=0")


def live(prepare: Callable[[Page], None], mission: str = "warehouse") -> Callable[..., None]:
    """Return what shows a live mission after something was done with it, a new one at each size."""

    def show(take: Callable[..., None]) -> None:
        for size in SIZES:
            with served(ROOT / "examples" / f"{mission}.yaml") as address:
                take(address, prepare, sizes=[size])

    return show


def record(where: str, *words: object) -> Callable[..., None]:
    """Return what shows a record; `words` make it, if it is not of the warehouse."""

    def show(take: Callable[..., None]) -> None:
        folder = FOLDER / "record"
        teamformer(*(words or ("run", ROOT / "examples" / "warehouse.yaml")), "--out", folder)
        take(f"file://{folder}/record.html#{where}")

    return show


def editor(take: Callable[..., None]) -> None:
    """Show the editor as it opens."""
    with served() as address:
        take(address)


def compare(take: Callable[..., None]) -> None:
    """Show a comparison."""
    folder, mission = FOLDER / "compare", ROOT / "examples" / "warehouse.yaml"
    teamformer("compare", mission, "--methods", "plan,join-all,heuristic", "--out", folder)
    take(f"file://{folder}/compare.html#step=25")


def continuous(take: Callable[..., None]) -> None:
    """Show a plan in continuous time."""
    mission = FOLDER / "continuous.yaml"
    text = (ROOT / "examples" / "four-robots.yaml").read_text(encoding="utf-8")
    mission.write_text(f"time: continuous\n{text}", encoding="utf-8")
    teamformer("plan", mission, "--time-limit", 2, "--out", FOLDER / "plan")
    take(f"file://{FOLDER}/plan/record.html#view=gantt")


def crowd(robots: int, tasks: int) -> Callable[..., None]:
    """Return what shows many robots halfway."""

    def show(take: Callable[..., None]) -> None:
        mission, folder = FOLDER / f"{robots}.yaml", FOLDER / f"{robots}"
        side = 60 if robots <= 100 else 100
        words = ("--capabilities", 8, "--requirements", 3, "--grid", f"{side}x{side}")
        teamformer("generate", "--out", mission, "--robots", robots, "--tasks", tasks, *words)
        teamformer("run", mission, "--method", "crews", "--out", folder)
        take(f"file://{folder}/record.html#step=40")

    return show


SCREENS: dict[str, Callable[..., None]] = {
    "editor": editor,
    "running": live(lambda page: at_step(page, 16)),
    "loss": live(lost),
    "what-if": live(weighed),
    "table": live(tabled),
    "map": record("step=25"),
    "gantt": record("step=25&view=gantt"),
    "carry": record("view=gantt", "run", ROOT / "examples" / "piano.yaml"),
    "compare": compare,
    "continuous": continuous,
    "robots-100": crowd(100, 300),
    "robots-1000": crowd(1000, 1000),
}


def main(names: list[str]) -> None:
    """Take the screens of these names, all if there are none."""
    from playwright.sync_api import sync_playwright

    FOLDER.mkdir(parents=True, exist_ok=True)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=shutil.which("chromium"), args=["--no-sandbox"]
        )

        def take(
            name: str,
            address: str,
            prepare: Callable[[Page], None] = lambda _: None,
            sizes: list[str] | None = None,
        ) -> None:
            for size in sizes or SIZES:
                width, height = SIZES[size]
                page = browser.new_page(
                    viewport={"width": width, "height": height}, color_scheme="light"
                )
                page.goto(address)
                wait_until(page, OPEN)
                prepare(page)
                page.wait_for_timeout(1000)
                page.screenshot(path=FOLDER / f"{name}-{size}.png")
                page.close()

        for name in names or SCREENS:
            SCREENS[name](lambda *how, name=name, **more: take(name, *how, **more))
            print(name, flush=True)
        browser.close()
    for name in SHOWN:
        if (FOLDER / f"{name}.png").exists():
            image = Image.open(FOLDER / f"{name}.png").quantize(128, dither=Image.Dither.NONE)
            image.save(ROOT / "docs" / "images" / f"{name}.png", optimize=True)


if __name__ == "__main__":
    main(sys.argv[1:])
