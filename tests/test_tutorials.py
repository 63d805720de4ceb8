"""What the documents tell one to do, done block by block in an empty folder.

A block with a title is a file. A `console` block is run, and what it shows must be told: each line
is one that was printed, whole but for seconds, in the same order; `...` stands for other lines, or
for the rest of a line. A comment before a block may say `figures vary`: its commands are run, and
what they show is not compared; or `not run`, and why. `python` blocks are run, those of how-to and
reference pages by `test_docs.py`. Blocks of `sh` install something, wait for a person or take
hours; the last test here does those of the fleet.
"""

from __future__ import annotations

import re
import shlex
import signal
import socket
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import pytest

from typed import teamformer

ROOT = Path(__file__).parent.parent
TUTORIALS = ROOT / "docs" / "tutorials"
OTHERS = [ROOT / "docs" / folder for folder in ("how-to", "reference")]
SLOW = {"training.md": "it trains for a minute", "fleet.md": "it runs a fleet in real time"}
BLOCK = re.compile(
    r'(?:<!-- (figures vary|not run): [^\n]+ -->\n)?^```(\w*)(?: title="([^"]+)")?\n(.*?)^```',
    re.DOTALL | re.MULTILINE,
)


class Block(NamedTuple):
    mark: str
    language: str
    title: str
    text: str


def blocks_of(page: Path) -> list[Block]:
    return [Block(*found) for found in BLOCK.findall(page.read_text(encoding="utf-8"))]


def pages() -> list[object]:
    tutorials = sorted(TUTORIALS.glob("*.md"))
    assert {page.name for page in tutorials} >= set(SLOW)
    marks = {name: pytest.mark.slow(reason) for name, reason in SLOW.items()}
    return [
        pytest.param(page, id=page.name, marks=marks.get(page.name, ()))
        for page in [ROOT / "README.md", *tutorials]
    ]


@pytest.fixture
def newcomer(own_folder: Path) -> Path:
    """A folder with the examples in it, from which classes are imported."""
    (own_folder / "examples").symlink_to(ROOT / "examples")
    return own_folder


@pytest.mark.parametrize("page", pages())
@pytest.mark.thorough
def test_a_newcomer_can_do_what_a_page_says(
    page: Path, newcomer: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    names: dict[str, object] = {"__name__": page.stem}
    for block in blocks_of(page):
        if block.title:
            (newcomer / block.title).write_text(block.text, encoding="utf-8")
        elif block.language == "python":
            exec(compile(block.text, page.name, "exec"), names)
        elif block.language == "console":
            do(block, capsys)
        else:
            assert block.language in ("sh", "yaml"), block
    assert len(blocks_of(page)) > 2


def is_run(block: Block) -> bool:
    return block.language == "console" and block.mark != "not run"


def other_pages() -> list[Path]:
    found = [page for folder in OTHERS for page in sorted(folder.rglob("*.md"))]
    return [page for page in found if any(is_run(block) for block in blocks_of(page))]


@pytest.mark.parametrize("page", other_pages(), ids=lambda page: page.stem)
@pytest.mark.thorough
def test_commands_of_how_to_and_reference_pages_run(
    page: Path, newcomer: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for block in blocks_of(page):
        if block.title:
            (newcomer / block.title).write_text(block.text, encoding="utf-8")
        elif is_run(block):
            do(block, capsys)


def test_enough_of_them_are_run() -> None:
    names = {page.stem for page in other_pages()}
    assert {"bench", "fleet", "foxglove", "live", "methods", "policies", "record"} <= names


def do(block: Block, capsys: pytest.CaptureFixture[str]) -> None:
    """Run the commands of a block, and compare what they print with what it shows."""
    for command, shown in commands(block.text):
        if command[1] == "live":
            told = told_by_a_server(command)
        else:
            capsys.readouterr()
            expected = 2 if shown[:1] and shown[0].startswith("error:") else 0
            assert teamformer(*command[1:]) == expected, command
            out, err = capsys.readouterr()
            told = err + out
        assert block.mark == "figures vary" or missing(shown, told) == [], (command, told)


def commands(text: str) -> list[tuple[list[str], list[str]]]:
    """Return each command of a console with the lines that it shows."""
    found: list[tuple[list[str], list[str]]] = []
    for line in text.splitlines():
        if line.startswith("$ "):
            found.append((shlex.split(line[2:], comments=True), []))
        else:
            found[-1][1].append(line)
    assert all(command[0] == "teamformer" for command, _ in found)
    return found


def missing(shown: list[str], told: str) -> list[str]:
    """Return the lines that are shown but were not told, or not in this order."""
    lines = iter([plain(line) for line in told.splitlines()])
    wanted = [line for line in shown if line.strip() and line != "..."]
    return [line for line in wanted if not any(is_told(line, one) for one in lines)]


def is_told(line: str, told: str) -> bool:
    """Say whether a line is the one that was told, or ends in `...` and is its beginning."""
    shown = plain(line)
    return told.startswith(shown[:-3].rstrip()) if shown.endswith("...") else told == shown


def plain(line: str) -> str:
    """Return a line without what a clock had a part in, and with single spaces."""
    return " ".join(re.sub(r"\d+\.\d+ s\b", "SECONDS", line).split())


def told_by_a_server(command: list[str]) -> str:
    """Start what serves pages at a free port, and end it by Ctrl-C once it has told where."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    words = [sys.executable, "-m", "teamformer.cli", *command[1:], "--port", str(port)]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as it:
        assert it.stdout is not None
        first = next(line for line in it.stdout if line.startswith("live:"))
        it.send_signal(signal.SIGINT)
        rest = it.stdout.read()
    return (first + rest).replace(f":{port}/", ":8765/")


def test_lines_that_are_shown_are_looked_for_in_order() -> None:
    told = "one 1.25 s\n two   words here\nthree\n"
    assert missing(["one 0.5 s", "...", "two words here", "three"], told) == []
    assert missing(["two words here", "one 0.5 s"], told) == ["one 0.5 s"]
    assert missing(["two other words"], told) == ["two other words"]
    assert missing(["two words"], told) == ["two words"]  # a column is missing
    assert missing(["two words ..."], told) == []


@pytest.mark.slow("it runs a fleet in real time")
def test_the_fleet_is_disturbed_as_the_tutorial_says(newcomer: Path) -> None:
    """A task is added, an agent frozen and woken again, and everything gets done."""
    freeze, add = (
        block.text
        for block in blocks_of(TUTORIALS / "fleet.md")
        if "PID" in block.text or "fleet add" in block.text
    )
    words = [sys.executable, "-m", "teamformer.cli", "fleet", "start", "examples/four-robots.yaml"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as it:
        assert it.stdout is not None
        lines = []
        for line in it.stdout:
            lines.append(line)
            if line.startswith("time begins"):
                break
        told = "".join(lines)
        [endpoint] = re.findall(r"world at (\S+)", told)
        [pid] = re.findall(r"agent r1 pid (\d+)", told)
        adding = re.sub(r"tcp/\S+", endpoint, add.strip()).split()
        added = subprocess.run(
            [sys.executable, "-m", "teamformer.cli", *adding[1:]], capture_output=True, text=True
        )
        assert "leak: accepted" in added.stdout
        subprocess.run(["bash", "-c", freeze.replace("PID", pid)], check=True)
        rest = it.stdout.read()
    assert it.returncode == 0
    assert "5 of 5 tasks, 4 of 4 robots left" in rest
