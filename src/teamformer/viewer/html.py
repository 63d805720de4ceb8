"""The record page: one HTML file that holds the record, its styles and its scripts."""

from __future__ import annotations

import base64
import hashlib
import html
import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from string import Template

from teamformer.base.whole_files import own_number, write_whole
from teamformer.viewer.modules import joined, page_file
from teamformer.viewer.page_keys import keys_script

STYLES = ("base", "frame", "stage", "side", "live", "help", "narrow", "compared")
"""The styles of a page; what comes later counts where two say something of one thing."""


def plain_page(title: str, style: str, body: str) -> str:
    """Return a page that needs nothing else, has no scripts and loads nothing."""
    return _small_page(title, style, body, f"style-src {_fingerprint(style)}")


def script_page(title: str, style: str, body: str, opener: str, allowed: str = "") -> str:
    """Return a small page that the module `opener` works on, with whatever else is `allowed`."""
    script = joined(opener)
    run = f'<script type="module">{script}</script>'
    policy = f"{allowed}style-src {_fingerprint(style)}; script-src {_fingerprint(script)}"
    return _small_page(title, style, f"{body}{run}", policy)


def _small_page(title: str, style: str, body: str, policy: str) -> str:
    return (
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        f'<meta http-equiv="Content-Security-Policy" content="default-src \'none\'; {policy}">'
        '<meta name="viewport" content="width=device-width">'
        f"<title>{title}</title><style>{style}</style></head><body>{body}</body></html>\n"
    )


def record_page(tree: Mapping[str, object]) -> str:
    """Return the page of a record: the JSON tree that `docs/reference/record.md` describes.

    The page needs nothing else: it loads nothing, and its own policy forbids it to.
    """
    return _page(_title(tree), "main", tree, "")


def comparison_page(
    trees: Sequence[Mapping[str, object]], failed: Sequence[Mapping[str, object]] = ()
) -> str:
    """Return one page of several records in step, the first of them in front.

    `failed` has the `method`, the `seed` and the reason, `why`, of each trial that left no record.
    """
    methods = ", ".join(dict.fromkeys(str(tree["method"]) for tree in trees))
    title = f"{_name(trees[0])}, {methods}"
    shown = {"compared": [_without_infinity(tree) for tree in trees], "failed": list(failed)}
    return _page(title, "main", shown, "")


def live_page(name: str) -> str:
    """Return the page of a live mission, which asks the server that it came from for the rest."""
    return _page(f"{name}, live", "live/main", None, "connect-src 'self'; ")


def _page(title: str, opener: str, tree: object, allowed: str) -> str:
    """Return a page that the module `opener` opens."""
    style = "".join(page_file(f"styles/{name}.css") for name in STYLES)
    script = f"{keys_script()}\n{joined(opener)}"
    return Template(page_file("page.html")).substitute(
        title=html.escape(title),
        policy=allowed + _content_policy(style, script),
        style=style,
        script=script,
        record=_json_for_html(tree),
    )


def write_page(tree: Mapping[str, object], path: Path) -> None:
    """Write the page of a record to a file."""
    write_whole(path, record_page(tree))


def write_comparison(
    trees: Sequence[Mapping[str, object]],
    path: Path,
    failed: Sequence[Mapping[str, object]] = (),
) -> None:
    """Write one page of several records to a file."""
    write_whole(path, comparison_page(trees, failed))


def _title(tree: Mapping[str, object]) -> str:
    return f"{_name(tree)}, {tree['method']}"


def _name(tree: Mapping[str, object]) -> str:
    mission = tree["mission"]
    name = mission.get("name") if isinstance(mission, Mapping) else None
    return str(name or "unnamed mission")


def _content_policy(style: str, script: str) -> str:
    """Return the Content-Security-Policy that allows this style and this script, nothing else."""
    return (
        f"default-src 'none'; img-src data:; base-uri 'none'; form-action 'none'; "
        f"style-src {_fingerprint(style)}; script-src {_fingerprint(script)}"
    )


def _fingerprint(text: str) -> str:
    digest = hashlib.sha256(text.encode("utf-8")).digest()
    return f"'sha256-{base64.b64encode(digest).decode('ascii')}'"


def _json_for_html(tree: object) -> str:
    """Write JSON that no HTML reader takes for markup: `<` and friends only as escapes."""
    text = json.dumps(
        _without_infinity(tree), separators=(",", ":"), allow_nan=False, default=own_number
    )
    return text.replace("&", r"\u0026").replace("<", r"\u003c").replace(">", r"\u003e")


def _without_infinity(tree: object) -> object:
    """Replace infinite radii, which JSON cannot say, by null; the page knows what it means."""
    if not isinstance(tree, Mapping):
        return tree
    return {key: None if value == math.inf else value for key, value in tree.items()} | {
        key: _without_infinity(value) for key, value in tree.items() if key == "mission"
    }
