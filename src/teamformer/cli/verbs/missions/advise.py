"""`teamformer advise`: what would help most, and who could be spared."""

from __future__ import annotations

from pathlib import Path

from rich.table import Table
from rich.text import Text

from teamformer.base.errors import TeamformerError
from teamformer.cli.terminal.compiling import compile_ahead
from teamformer.cli.terminal.console import TimeBar, out, prepare_file, print_json, processors, say
from teamformer.cli.terminal.interruption import Interruption
from teamformer.files.mission_files import read_mission
from teamformer.methods.by_name import default_for, load_method
from teamformer.mission.checks.rules import rules_not_advised
from teamformer.mission.model import Mission
from teamformer.trials.advice.advise import advise_on
from teamformer.trials.advice.changes import FEWER
from teamformer.trials.advice.suggestions import Advice
from teamformer.viewer.advice_page import write_advice

MOST_LINES = 15


def advise(path: Path, page: Path | None, time_limit: float, as_json: bool) -> int:
    """Measure what would help a mission and show it; return the exit status."""
    mission = read_mission(path, rules_not_advised)
    if page is not None:
        if page.suffix.lower() not in (".html", ".htm"):
            raise TeamformerError(f"{page}: the advice is a page", "name a file that ends in .html")
        prepare_file(page)
    if mission.time != "continuous":
        _prepare(mission)
    with Interruption(), TimeBar("searches", time_limit) as timing:
        advice = advise_on(mission, time_limit, processors(), timing.update)
    if page is not None:
        write_advice(advice.row, page)
        say(f"page: {page}")
    if as_json:
        print_json(advice.row)
    else:
        _show(advice)
    if advice.unmeasured:
        count = len(advice.unmeasured)
        say(f"there was no time for {count} changes; a longer --time-limit measures more")
    return 0


def _prepare(mission: Mission) -> None:
    """Compile what planning in steps needs, and say what is measured."""
    compile_ahead([load_method(default_for(mission))], mission)
    if mission.has_surprises:
        say("some values are uncertain: measured with expected values")


def _show(advice: Advice) -> None:
    mission = advice.mission
    what = "takes" if mission.cost is None else "costs"
    unit = " steps" if mission.time != "continuous" and mission.cost is None else ""
    out.print(
        f"{mission.name}: {what} {advice.makespan:g}{unit} by {advice.method}, the median of "
        f"{advice.searches} searches ({advice.least:g} to {advice.most:g}); "
        f"as it is written {advice.written:g}",
        markup=False,
    )
    helpful = advice.helpful
    table = Table("what would help", what, "gain", "noise", box=None, header_style="dim")
    for it in helpful[:MOST_LINES]:
        numbers = (_told(it.makespan), _told(it.gain), f"{it.noise:.3g}")
        table.add_row(Text(it.change), *numbers)
    out.print(table if helpful else "no change gains more than chance may")
    if len(helpful) > MOST_LINES:
        out.print(f"and {len(helpful) - MOST_LINES} more; --json tells all")
    for line in _lines_on_sparing(advice):
        out.print(line, markup=False)


def _told(value: float) -> str:
    return f"{round(value, 2):g}"


def _lines_on_sparing(advice: Advice) -> list[str]:
    """Return who could be spared, and who could not."""
    what = "takes" if advice.mission.cost is None else "costs"
    spare = [f"{it.change} (then it {what} {_told(it.makespan)})" for it in advice.spare]
    needed = [change.what for change in advice.impossible if change.kind == FEWER]
    lines = [f"could be spared: {', '.join(spare) or 'nobody'}"]
    return lines + ([f"impossible: {', '.join(needed)}"] if needed else [])
