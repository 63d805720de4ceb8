"""Run a command for the first time, and fail if that takes more than 5 s of processor time.

`python tests/first_run.py COMMAND ...`: `make wheel` runs a mission so, with compiled code that the
wheel brings. Processor time, because a machine that is busy otherwise should not fail it.
"""

from __future__ import annotations

import resource
import subprocess
import sys
import time

MOST = 5.0  # seconds


def main(command: list[str]) -> int:
    """Return the exit status: that of the command, or 1 if it took too long."""
    begun = time.perf_counter()
    status = subprocess.run(command).returncode
    waited = time.perf_counter() - begun
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = used.ru_utime + used.ru_stime
    told = f"first run: {spent:.1f} s of the processor, {waited:.1f} s by the clock"
    print(told, file=sys.stderr)
    if status == 0 and spent > MOST:
        print(f"error: that is more than {MOST:g} s", file=sys.stderr)
        return 1
    return status


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
