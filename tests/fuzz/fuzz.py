"""`make fuzz`: tries other examples round after round, and keeps what it finds as files.

`python tests/fuzz/fuzz.py MINUTES [TESTS]` tries all properties, or those of some files.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
from itertools import count
from pathlib import Path

from watching import FOLDER, KNOWN, RUNNING, UNTIL

OUT = Path(__file__).parents[2] / "out" / "fuzz"

LOG = "latest.txt"
"""What the round that is being played has printed so far."""

PATIENCE = 300.0
"""Seconds after which an example counts as one that never ends."""


def main(minutes: float, tests: list[str]) -> int:
    """Fuzz for some minutes; return 1 if anything was found."""
    folder = next(path for n in count(1) if not (path := OUT / f"run-{n}").exists())
    folder.mkdir(parents=True)
    until = time.time() + 60 * minutes
    for number in count(1):
        if time.time() >= until:
            break
        is_good, text = _play_round(folder, until, tests)
        print(f"round {number}: {_last_line(text)}", flush=True)
        if not is_good:
            (folder / f"round-{number}.txt").write_text(text)
    for name in (RUNNING, LOG):
        (folder / name).unlink(missing_ok=True)
    for name in _found(folder):
        print(f"{folder / name}: {(folder / name).read_text().splitlines()[0]}")
    print(f"{len(_found(folder))} findings in {minutes:g} minutes")
    if any(folder.iterdir()):
        return 1
    folder.rmdir()
    return 0


def _play_round(folder: Path, until: float, tests: list[str]) -> tuple[bool, str]:
    """Try some examples of every property in a process of its own.

    Return whether all was well, and what it printed.
    """
    known = {FOLDER: str(folder), KNOWN: " ".join(_found(folder)), UNTIL: str(until)}
    words = [sys.executable, "-m", "pytest", "-q", "-n", "0", "-p", "no:cacheprovider"]
    words += ["--tb=short", "--hypothesis-profile=fuzz", *(tests or [str(Path(__file__).parent)])]
    with open(folder / LOG, "w+") as log:
        process = subprocess.Popen(words, env={**os.environ, **known}, stdout=log, stderr=log)
        while process.poll() is None:
            time.sleep(0.2)
            if time.time() - _last_begun(folder) > PATIENCE:
                process.kill()
        if process.returncode not in (0, 1) and (folder / RUNNING).exists():
            where = next(p for n in count(1) if not (p := folder / f"ended-{n}.yaml").exists())
            shutil.move(folder / RUNNING, where)
        log.seek(0)
        return process.returncode == 0, log.read()


def _last_begun(folder: Path) -> float:
    try:
        return (folder / RUNNING).stat().st_mtime
    except FileNotFoundError:  # none is, or it has just ended
        return time.time()


def _found(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.glob("*.yaml") if path.name != RUNNING)


def _last_line(text: str) -> str:
    return " / ".join(text.strip().splitlines()[-2:]) or "nothing was printed"


if __name__ == "__main__":
    sys.exit(main(float(sys.argv[1]), sys.argv[2:]))
