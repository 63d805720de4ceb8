"""What to type where a library is missing: a command that works from where one stands."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

from teamformer.base import extras
from teamformer.base.errors import TeamformerError

ROOT = Path(__file__).parent.parent


def test_in_a_clone_it_is_an_editable_install_by_this_python(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(sys, "executable", str(tmp_path / ".venv" / "bin" / "python"))
    (tmp_path / "pyproject.toml").touch()
    monkeypatch.setattr(
        extras, "__file__", str(tmp_path / "src" / "teamformer" / "base" / "extras.py")
    )
    monkeypatch.chdir(tmp_path)
    assert extras.how_to_install("live") == ".venv/bin/pip install -e '.[live]'"
    (tmp_path / "out").mkdir()
    monkeypatch.chdir(tmp_path / "out")
    pip = tmp_path / ".venv" / "bin" / "pip"
    assert extras.how_to_install("live", "gif") == f"{pip} install -e '..[live,gif]'"


@pytest.mark.parametrize(
    ("url", "what"),
    [
        ("file:///home/ann/my%20tools/teamformer", "/home/ann/my tools/teamformer"),
        ("file:///tmp/teamformer-0.1.0-py3-none-any.whl", "/tmp/teamformer-0.1.0-py3-none-any.whl"),
        (None, "teamformer"),  # from an index
    ],
)
def test_installed_it_names_where_the_package_came_from(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, url: str | None, what: str
) -> None:
    """As pip notes it down beside the package: no index has it."""
    package, note = tmp_path / "lib" / "teamformer", tmp_path / "lib" / "teamformer-0.1.0.dist-info"
    note.mkdir(parents=True)
    (note / "METADATA").write_text("Metadata-Version: 2.1\nName: teamformer\nVersion: 0.1.0\n")
    if url:
        (note / "direct_url.json").write_text(json.dumps({"url": url}))
    monkeypatch.syspath_prepend(str(package.parent))
    monkeypatch.setattr(extras, "__file__", str(package / "base" / "extras.py"))
    assert extras.how_to_install("live") == f"pip install '{what}[live]'"


def test_a_library_that_is_missing_is_named() -> None:
    extras.require("live", "json", "sys")
    with pytest.raises(TeamformerError, match="not installed: nobody_has_this") as error:
        extras.require("live", "json", "nobody_has_this")
    assert error.value.hint == extras.how_to_install("live")


def test_the_hint_is_written_in_one_place() -> None:
    texts = {path: path.read_text() for path in (ROOT / "src").rglob("*.py")}
    assert [path.name for path, text in texts.items() if "pip install" in text] == ["extras.py"]
