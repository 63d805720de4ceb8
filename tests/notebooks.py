"""Run the notebooks of `examples/notebooks` and keep what they print, but for pages.

`python tests/notebooks.py` runs all; with a part of a name, those that it is in.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).parents[1] / "examples" / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
SECONDS = 600
"""That a cell may take."""


def run_notebook(path: Path) -> Any:
    """Return a notebook with what it shows now; raises CellExecutionError where a cell fails."""
    import nbformat
    from nbclient import NotebookClient

    notebook = nbformat.read(path, as_version=4)
    where = {"metadata": {"path": str(path.parent)}}
    return NotebookClient(notebook, timeout=SECONDS, resources=where).execute()


def without_pages(notebook: Any) -> Any:
    """Take out what is far too large to keep, and when cells were run."""
    for cell in notebook.cells:
        cell.metadata.pop("execution", None)
        if cell.metadata.get("page"):
            cell.outputs = []
    return notebook


def main(part: str = "") -> None:
    """Run notebooks and write them."""
    import nbformat

    for path in NOTEBOOKS:
        if part in path.name:
            nbformat.write(without_pages(run_notebook(path)), path)
            print(path.name)


if __name__ == "__main__":
    main(*sys.argv[1:])
