"""`teamformer bench`: measurements, never tests."""

from __future__ import annotations

import difflib

from rich.table import Table

from teamformer.commands.console import announce_compiling, err, out, print_json
from teamformer.errors import TeamformerError

SUITES = ("speed",)


def bench(suite: str, as_json: bool) -> int:
    """Measure and show; return the exit status."""
    if suite not in SUITES:
        near = difflib.get_close_matches(suite, SUITES, 1)
        hint = f"did you mean '{near[0]}'?" if near else f"there are {', '.join(SUITES)}"
        raise TeamformerError(f"there is no suite '{suite}'", hint)
    from teamformer.bench.speed import measure_speed

    announce_compiling()
    table = Table("what", "figure", "unit", box=None, header_style="dim")
    for row in measure_speed():
        if as_json:
            print_json({"suite": suite, **vars(row)})
        else:
            err.print(f"{row.setting} ...", markup=False)
            table.add_row(row.setting, f"{row.value:,.4g}", row.unit)
    if not as_json:
        out.print(table)
    return 0
