"""The page's modules: all are used, none names a thing twice, and their types are right."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from teamformer.viewer import modules

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "src/teamformer/viewer/page"
OPENERS = ("main", "live/main", "folder/folder")


def test_types_are_right() -> None:
    if shutil.which("node") is None or not (ROOT / "node_modules/.bin/tsc").exists():
        pytest.skip("there is no TypeScript on this machine: `make page-types` installs it")
    told = subprocess.run(["node_modules/.bin/tsc"], cwd=ROOT, capture_output=True, text=True)
    assert told.stdout == ""


@pytest.mark.parametrize("opener", OPENERS)
def test_a_page_has_each_module_once_and_after_what_it_imports(opener: str) -> None:
    script = modules.joined(opener)
    assert "import {" not in script
    heads = [script.index(_head(path)) for path in _modules_of(opener)]
    assert heads == sorted(heads)
    assert script.count("function byId(") == 1


def test_every_module_is_in_a_page() -> None:
    used = {path for opener in OPENERS for path in _modules_of(opener)}
    assert used == set(PAGE.rglob("*.js"))


@pytest.mark.parametrize(
    ("texts", "said"),
    [
        (
            {"a": 'import { b } from "./b.js";\n', "b": 'import { a } from "./a.js";\n'},
            "one another",
        ),
        ({"a": 'import { b } from "./b.js";\nlet one = 1;\n', "b": "let one = 2;\n"}, "several"),
    ],
)
def test_circles_and_names_that_stand_twice_are_refused(
    monkeypatch: pytest.MonkeyPatch, texts: dict[str, str], said: str
) -> None:
    monkeypatch.setattr(modules, "page_file", lambda name: texts[name.removesuffix(".js")])
    modules.joined.cache_clear()
    with pytest.raises(AssertionError, match=said):
        modules.joined("a")


def _modules_of(opener: str) -> list[Path]:
    return [PAGE / f"{name}.js" for name in modules.names_in_order(opener)]


def _head(path: Path) -> str:
    return path.read_text(encoding="utf-8").split("\n")[0]
