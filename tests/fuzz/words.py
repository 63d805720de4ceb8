"""Names that are hard to write, read and print."""

from __future__ import annotations

from hypothesis import strategies as st

from drawing import pick

HOSTILE = (
    *("no", "12:30", "~", "null", "0", "1e3", "0x1F", "007", "2026-01-01", ".inf", "true", "<<"),
    *("a b", " a", "a ", "-", "- a", "? a", "a: b", "a #b", "'", '"', "`", "|", ">", "&a", "*a"),
    *("!t", "%", "@", "{a}", "[a]", "[red]", "[/]", "a, b", "\\", "\\n", "$HOME", "../a", "a/b"),
    *("=1+1", "+1", "<b>", "</script>", "&lt;", "{{a}}", "%s", "{0}", "r1", "t1", "call-1", "a-1"),
    *("ü", "é", "日本", "🤖", "עברית", "ß", "K", "a" * 200),
)
"""Words that YAML, JSON, CSV, HTML, a terminal or our own numbering may take for something else."""

LETTERS = st.text("aZ0 -_.:#'\"\\{}[]é", max_size=5)


def draw_names(draw: st.DrawFn, number: int) -> list[str]:
    """Return so many names of which none is another: plain ones, or hostile ones among them."""
    names: list[str] = []
    is_hostile = pick(draw, (False, True))
    for _ in range(number):
        name = f"n{len(names)}"
        if is_hostile:
            name = pick(draw, (*HOSTILE, ""))
            name = name or f"{draw(LETTERS)}x"
        names.append(name if name not in names else f"{name[:190]}/{len(names)}")
    return names
