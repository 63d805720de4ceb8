"""The notebooks run from top to bottom, and are kept with what they print."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from notebooks import FOLDER, NOTEBOOKS, run_notebook

QUICK = "1-missions.ipynb"


@pytest.mark.parametrize(
    "path",
    [
        pytest.param(path, id=path.stem, marks=() if path.name == QUICK else pytest.mark.slow)
        for path in NOTEBOOKS
    ],
)
@pytest.mark.filterwarnings("ignore")  # of the libraries that run notebooks
@pytest.mark.thorough
def test_a_notebook_runs(path: Path) -> None:
    pytest.importorskip("nbclient", reason="nbclient is not installed")
    pytest.importorskip("ipykernel", reason="ipykernel is not installed")
    notebook = run_notebook(path)
    shown = [output for cell in notebook.cells for output in cell.get("outputs", ())]
    assert shown
    pages = [cell for cell in notebook.cells if cell.metadata.get("page")]
    for cell in pages:
        assert "<iframe" in cell.outputs[0].data["text/html"]


def test_they_are_kept_with_what_they_print_and_no_failure() -> None:
    assert len(NOTEBOOKS) == 5
    for path in NOTEBOOKS:
        assert path.stat().st_size < 100_000, path  # without pages
        cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
        outputs = [output for cell in cells for output in cell.get("outputs", ())]
        assert any(output["output_type"] == "stream" for output in outputs), path
        assert all(output["output_type"] != "error" for output in outputs), path


def test_the_documents_list_them_all() -> None:
    text = (FOLDER.parents[1] / "docs" / "reference" / "python.md").read_text(encoding="utf-8")
    for path in NOTEBOOKS:
        assert f"(../../examples/notebooks/{path.name})" in text
