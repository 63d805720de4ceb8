"""Imports that Ctrl-C does not break off."""

from __future__ import annotations

import sys
from concurrent.futures import ThreadPoolExecutor
from importlib import import_module


def import_apart(name: str) -> None:
    """Import a module in a thread of its own, where signals do not come.

    A library in C++ that is broken off while it begins ends the process, or says ImportError.
    """
    if name not in sys.modules:
        with ThreadPoolExecutor(1) as pool:
            pool.submit(import_module, name).result()
