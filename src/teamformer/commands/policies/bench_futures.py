"""`teamformer bench futures`: what deviations win that are chosen by playing them in futures."""

from __future__ import annotations

from functools import partial

from rich.table import Table

from teamformer.bench.measurements.deviations.choosing import Chosen, choose_in
from teamformer.bench.measurements.deviations.report import COLUMNS_OF_CHOICES, table_of_choices
from teamformer.commands.console import out, say
from teamformer.commands.policies.rows_by_world import Asked, Measurement, measure_worlds
from teamformer.errors import TeamformerError
from teamformer.scenarios.named_settings import world_of
from teamformer.sim.surprises.futures import hides_no_more

MOMENTS = 3
"""Plans of each mission that something is chosen after."""

ROWS = "chosen.jsonl"

FUTURES = Measurement("futures", ROWS, Chosen, partial(choose_in, moments=MOMENTS))


def bench_futures(asked: Asked, as_json: bool) -> int:
    """Measure and show; return the exit status."""
    for setting in asked.settings:
        if not hides_no_more(world_of(setting, asked.first)):
            hint = "use settings in which needs or places are uncertain, such as sparse-needs"
            raise TeamformerError(f"in '{setting}' more than needs and places is uncertain", hint)
    chosen = measure_worlds(asked, FUTURES, as_json)
    if chosen is None:
        return 1
    if not as_json:
        table = Table(*COLUMNS_OF_CHOICES, box=None, header_style="dim")
        for row in table_of_choices(chosen):
            table.add_row(*row)
        out.print(table)
    if asked.folder is not None:
        say(f"written: {asked.folder / ROWS}")
    return 0
