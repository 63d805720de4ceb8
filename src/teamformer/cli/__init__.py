"""The command line: verbs and flags; what a verb needs is imported inside it.

Flags stand in files of their own, so that help and completion import nothing of what verbs do:
`run --help` takes 0.2 s of a processor, and would take 0.8 s with what `run` imports.
"""

from __future__ import annotations

import io
import os
import signal
import sys
from types import FrameType

from teamformer.base.errors import ReaderGoneError, TeamformerError, UndoableError
from teamformer.cli import fleet, missions, policies, records, robotarium  # noqa: F401  (registers verbs)
from teamformer.cli.app import app

INTERRUPTED = 130
"""The exit status that Typer gives a verb that Ctrl-C has ended."""


def _open_what_is_closed() -> None:
    """Have something to write to where the shell was told to close an output (`>&-`)."""
    sys.stdout = sys.stdout or open(os.devnull, "w")  # noqa: SIM115  (until the process ends)
    sys.stderr = sys.stderr or open(os.devnull, "w")  # noqa: SIM115


def main() -> None:
    """Run the command line: exit 0 is good, 1 failed, 2 misused."""
    _open_what_is_closed()
    before = signal.getsignal(signal.SIGINT)
    if before is signal.default_int_handler:
        signal.signal(signal.SIGINT, _interrupt_once)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # names need not be text that it can hold
            stream.reconfigure(errors="backslashreplace")
    status = _run_verb()
    was_pressed = signal.getsignal(signal.SIGINT) not in (before, _interrupt_once)
    signal.signal(signal.SIGINT, signal.SIG_IGN if was_pressed else before)
    try:
        sys.stdout.flush()
    except BrokenPipeError:  # Python would flush once more at exit, and complain
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    sys.exit(status)


def _interrupt_once(number: int, frame: FrameType | None) -> None:
    """End what is done at the first Ctrl-C; a second would end it in the midst of clearing away."""
    signal.signal(signal.SIGINT, lambda *_: None)
    raise KeyboardInterrupt


def _run_verb() -> int:
    """Run what the command line says, and return its exit status."""
    try:
        app()
    except SystemExit as stop:
        if stop.code == INTERRUPTED:  # Typer has caught what Ctrl-C raises
            print("interrupted", file=sys.stderr)
            return 1
        return stop.code if isinstance(stop.code, int) else 0
    except TeamformerError as error:
        print(f"error: {error}", file=sys.stderr)
        if error.hint:
            print(f"hint: {error.hint}", file=sys.stderr)
        return 1 if isinstance(error, UndoableError) else 2
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return 1
    except ReaderGoneError:
        return 0
    except MemoryError:
        print("error: the memory ran out", file=sys.stderr)
        hint = "fewer robots or tasks take less; `run` takes less with --method crews"
        print(f"hint: {hint}", file=sys.stderr)
        return 1
    except OSError as error:  # a disk that fills up while we write, say
        where = error.filename or "the output cannot be written"
        print(f"error: {where}: {error.strerror or error}", file=sys.stderr)
        return 1
    return 0
