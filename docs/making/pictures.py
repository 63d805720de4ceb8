"""Draws the pictures of docs/images that explain words: `python docs/making/pictures.py`.

The SVGs need nothing. The pictures of pages need the extra `dev` and a browser; they are of runs of
the examples, made here.
"""

from __future__ import annotations

import shutil
from collections.abc import Iterable
from pathlib import Path

ROOT = Path(__file__).parents[2]
IMAGES = ROOT / "docs" / "images"
INK, PALE, WALL = "#1f2937", "#cbd5e1", "#475569"
LIFT, WELD, SCAN = "#2563eb", "#d97706", "#059669"


class Drawing:
    """An SVG that grows shape by shape; places are in pixels, y goes down."""

    def __init__(self, width: int, height: int, title: str) -> None:
        """Begin a white picture with a title for those who cannot see it."""
        self.size = width, height
        self.parts = [f"<title>{title}</title>", f'<rect {_box(0, 0, width, height)} fill="#fff"/>']

    def cells(self, x: int, y: int, columns: int, rows: int, side: int) -> None:
        """Draw a grid of cells."""
        for column in range(columns):
            for row in range(rows):
                self.box(x + column * side, y + row * side, side, side, "none", PALE)

    def box(
        self, x: float, y: float, width: float, height: float, fill: str, line: str = "none"
    ) -> None:
        """Draw a rectangle."""
        self.parts.append(f'<rect {_box(x, y, width, height)} fill="{fill}" stroke="{line}"/>')

    def disc(self, x: float, y: float, radius: float, fill: str, line: str = "none") -> None:
        """Draw a circle; a line goes round it in two pixels."""
        style = f'fill="{fill}" stroke="{line}" stroke-width="2"'
        self.parts.append(f'<circle cx="{x}" cy="{y}" r="{radius}" {style}/>')

    def dotted_disc(self, x: float, y: float, radius: float, line: str) -> None:
        """Draw a dotted circle."""
        style = f'fill="none" stroke="{line}" stroke-width="2" stroke-dasharray="4 4"'
        self.parts.append(f'<circle cx="{x}" cy="{y}" r="{radius}" {style}/>')

    def arrow(self, x: float, y: float, to_x: float, to_y: float, line: str = INK) -> None:
        """Draw an arrow along an axis."""
        self.parts.append(
            f'<path d="M{x} {y} L{to_x} {to_y}" stroke="{line}" stroke-width="1.5" fill="none" '
            'marker-end="url(#head)"/>'
        )

    def text(
        self, x: float, y: float, words: str, size: int = 14, fill: str = INK, anchor: str = "start"
    ) -> None:
        """Write words; `anchor` is start, middle or end."""
        style = f'font-size="{size}" fill="{fill}" text-anchor="{anchor}"'
        self.parts.append(f'<text x="{x}" y="{y}" {style}>{words}</text>')

    def save(self, name: str) -> None:
        """Write the picture to docs/images."""
        width, height = self.size
        head = (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" '
            f'width="{width}" height="{height}" font-family="sans-serif">\n'
            '<defs><marker id="head" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" '
            f'markerHeight="7" orient="auto"><path d="M0 0 L8 4 L0 8 z" fill="{INK}"/>'
            "</marker></defs>\n"
        )
        (IMAGES / name).write_text(head + "\n".join(self.parts) + "\n</svg>\n", encoding="utf-8")


def _box(x: float, y: float, width: float, height: float) -> str:
    return f'x="{x}" y="{y}" width="{width}" height="{height}"'


def robot(on: Drawing, x: float, y: float, colours: Iterable[str], name: str = "") -> None:
    """Draw a robot: a disc for each unit that it brings."""
    colours = list(colours)
    for place, colour in enumerate(colours):
        on.disc(x + 11 * place - 5.5 * (len(colours) - 1), y, 10, colour, "#fff")
    if name:
        on.text(x, y + 26, name, 12, INK, "middle")


def coverage() -> None:
    """Counts of a team beside those that a task needs."""
    on = Drawing(640, 220, "Which teams cover a task that needs two of lift and one of weld")
    on.text(16, 28, "beam needs lift: 2, weld: 1")
    for place, colour in enumerate((LIFT, LIFT, WELD)):
        on.box(240 + 26 * place, 12, 22, 22, "#fff", colour)
    teams = (
        ("ann, bob", (LIFT, LIFT), "no: weld is missing"),
        ("ann, cleo", (LIFT, WELD), "no: one lift is missing"),
        ("ann, bob, cleo", (LIFT, LIFT, WELD), "yes"),
        ("ann, bob, cleo, eve", (LIFT, LIFT, WELD, SCAN), "yes: more than needed is no harm"),
    )
    for row, (names, brings, verdict) in enumerate(teams):
        y = 76 + 38 * row
        on.text(16, y + 5, names)
        for place, colour in enumerate(brings):
            on.disc(251 + 26 * place, y, 10, colour)
        on.text(370, y + 5, verdict, fill="#047857" if verdict.startswith("yes") else "#b91c1c")
    on.save("coverage.svg")


def forming() -> None:
    """Two robots meet at a task, form a team, serve, and part."""
    on = Drawing(800, 200, "Two robots walk to a task, form a team there, serve it and part")
    said = (
        ("step 4", "both walk to the task"),
        ("step 5", "they stand there: two teams"),
        ("step 6", "they form: one team"),
        ("steps 7 to 8", "the team serves"),
        ("step 9", "done; it splits"),
    )
    for panel, (when, what) in enumerate(said):
        x = 16 + 156 * panel
        on.cells(x, 44, 3, 2, 46)
        on.box(x + 52, 50, 34, 34, "#eef2ff" if panel < 4 else PALE, INK)
        on.text(x, 20, when, 13)
        on.text(x, 160, what, 11)
        if panel == 0:
            robot(on, x + 23, 67, [LIFT])
            robot(on, x + 115, 67, [WELD])
            on.arrow(x + 34, 67, x + 50, 67)
            on.arrow(x + 104, 67, x + 88, 67)
        else:
            robot(on, x + 60, 67, [LIFT])
            robot(on, x + 78, 67, [WELD])
        if panel in (2, 3):
            on.disc(x + 69, 67, 22, "none", "#7c3aed")
    on.text(16, 186, "A ring is one team. With forming_steps: 0 the step of forming is free.", 12)
    on.save("forming.svg")


def within() -> None:
    """A task that is somewhere near: where it may be, and what a search rules out."""
    on = Drawing(640, 300, "A task within 3 cells of a place, and cells that a robot has ruled out")
    side, left, top = 30, 16, 16
    for column in range(9):
        for row in range(9):
            away = (column - 4) ** 2 + (row - 4) ** 2
            seen = min((column - c) ** 2 + (row - 1) ** 2 for c in (1, 2, 3)) <= 1
            fill = "#fff"
            if away <= 9:
                fill = "#e5e7eb" if seen else "#bfdbfe"
            on.box(left + side * column, top + side * row, side, side, fill, PALE)
    on.dotted_disc(left + 4.5 * side, top + 4.5 * side, 3.3 * side, LIFT)
    robot(on, left + 3.5 * side, top + 1.5 * side, [SCAN])
    on.text(left + 4.5 * side, top + 4.5 * side + 5, "at", 13, INK, "middle")
    legend = (
        ("#bfdbfe", "the mast may be here: at: [4, 4], within: 3"),
        ("#e5e7eb", "ruled out: a team has been near enough"),
        ("#fff", "the mast cannot be here"),
    )
    for row, (fill, words) in enumerate(legend):
        on.box(310, 40 + 40 * row, 20, 20, fill, PALE)
        on.text(340, 55 + 40 * row, words, 13)
    robot(on, 320, 172, [SCAN])
    on.text(340, 177, "a robot that went three cells along; finding_radius: 1", 13)
    on.text(310, 222, "Robots head for the place that they believe in.", 13)
    on.text(310, 242, "When it is ruled out, they believe in another.", 13)
    on.save("within.svg")


def phases() -> None:
    """The phases of a step, and those of a service in a fleet."""
    on = Drawing(800, 110, "The seven phases of a step")
    names = ("decisions", "splits", "joins", "allocation", "motion", "losses", "completion")
    for place, name in enumerate(names):
        x = 8 + 113 * place
        on.box(x, 24, 96, 40, "#eef2ff", INK)
        on.text(x + 48, 49, f"{place + 1} {name}", 12, INK, "middle")
        if place:
            on.arrow(x - 17, 44, x - 1, 44)
    on.text(8, 92, "Every phase is made for all teams before the next one begins.", 13)
    on.save("step.svg")

    on = Drawing(800, 170, "The four phases of a service in a fleet of processes")
    words = (
        ("WALK", "on its way", "to the task"),
        ("HERE", "at the task, joined", "the team there"),
        ("READY", "promises to stay", "for 2.6 s"),
        ("SERVE", "the body works", "until it is done"),
    )
    reasons = ("arrives", "enough are here", "promises suffice")
    for place, (name, first, second) in enumerate(words):
        x = 8 + 208 * place
        on.box(x, 30, 140, 72, "#eef2ff", INK)
        on.text(x + 70, 52, name, 15, INK, "middle")
        on.text(x + 70, 74, first, 12, INK, "middle")
        on.text(x + 70, 91, second, 12, INK, "middle")
        if place:
            on.arrow(x - 68, 66, x - 1, 66)
            on.text(x - 34, 124, reasons[place - 1], 12, INK, "middle")
    on.text(8, 158, "A robot says its phase to the others in every heartbeat.", 13)
    on.save("service.svg")


def pages() -> None:
    """Pictures of the page of a record, and the moving one of the README."""
    from playwright.sync_api import sync_playwright

    import teamformer as tf
    from teamformer.record.export.gif_file import write_gif

    folder = ROOT / "build" / "pictures"
    trial = tf.run(tf.load(ROOT / "examples" / "warehouse.yaml"))
    trial.save(folder)
    write_gif(trial.record, IMAGES / "mission.gif")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=shutil.which("chromium"), args=["--no-sandbox"]
        )
        page = browser.new_page(viewport={"width": 1200, "height": 720}, color_scheme="light")
        for name, where in (("page-map", "step=28"), ("page-gantt", "step=28&view=gantt")):
            page.goto(f"file://{folder}/record.html#{where}")
            page.reload()
            page.wait_for_timeout(800)
            page.screenshot(path=IMAGES / f"{name}.png")
        browser.close()


if __name__ == "__main__":
    coverage()
    forming()
    within()
    phases()
    pages()
