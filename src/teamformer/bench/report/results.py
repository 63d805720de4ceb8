"""The documents of results, written from rows: the paper's claims, and all tables."""

from __future__ import annotations

import os
import platform
import shutil
from collections.abc import Iterable, Iterator, Mapping, Sequence
from importlib.resources import files
from pathlib import Path
from string import Template
from typing import TypeVar

from teamformer.base.whole_files import write_whole
from teamformer.bench.report.beside import beside_the_authors, beside_the_plan, steps_of
from teamformer.bench.report.claim_checks import ANY_FLEET, TABLE_1, ClaimJudgement, method_for
from teamformer.bench.report.claims import FAILURES, INFERENCE, Claim, claims
from teamformer.bench.report.evidence import Evidence
from teamformer.bench.report.kept import KEPT, kept_tables
from teamformer.bench.report.tables import EXPLANATION, markdown, number, seconds, summary_table
from teamformer.bench.rows import Row
from teamformer.bench.statistics import Mean, wilson
from teamformer.bench.store import read_folder
from teamformer.methods.by_name import BARE

FAMILIES = {
    "teamformer": "the paper's network, trained here",
    ANY_FLEET: "`teamformer-bare`",
}
T = TypeVar("T")

VERDICTS = {True: "holds", False: "**does not hold**", None: ""}


def write_results(file: Path, command: str, folders: Sequence[Path]) -> None:
    """Write the document from the folders of finished benchmarks, the paper's first.

    The tables of all suites go to a document of their own beside it, and figures are copied into
    `images/`. What stands in the documents already and has no rows here is kept, and said to be.
    """
    suites = {about.suite: rows for about, rows in map(read_folder, folders)}
    evidence = Evidence(next(iter(suites.values())))
    tables = tables_file(file)
    kept, kept_suites = kept_tables(file), kept_tables(tables)

    def measured(heading: str, table: str, suite: str) -> str:
        """Return a table, or else what was measured before, or else by which suite it would be."""
        missing = f"Not measured: `teamformer bench {suite}` does.\n"
        return table or kept.get(heading, missing)

    text = template("results").substitute(
        **_origin(command, evidence),
        **_claims(evidence),
        **_weight(evidence),
        authors=measured(
            "On the authors' own worlds",
            beside_the_authors(suites.get("authors", ())),
            "authors FILE",
        ),
        missions=measured("Missions", beside_the_plan(suites.get("missions", ())), "missions"),
        large=measured("Large missions", beside_the_plan(suites.get("large", ())), "large"),
        figures=_figures(file, folders),
        table_1=_table_1(evidence),
        room=measured("How much room there is", _room(evidence), "paper --methods central"),
        tables=tables.name,
    )
    everything = template("tables").substitute(
        results=file.name,
        versions=_versions(row for rows in suites.values() for row in rows),
        codes=_codes(row for rows in suites.values() for row in rows),
        everything=_everything(suites, kept_suites),
    )
    write_whole(tables, everything)
    write_whole(file, text)


def tables_file(file: Path) -> Path:
    """Return where the tables stand beside a document of results: `results-tables.md`."""
    return file.with_name(f"{file.stem}-tables.md")


def template(name: str) -> Template:
    """Return the text of a document with blanks: all that is in it but what was measured."""
    found = files("teamformer").joinpath("bench", "report", f"{name}_template.md")
    return Template(found.read_text(encoding="utf-8"))


def _origin(command: str, evidence: Evidence) -> dict[str, str]:
    counts = sorted({summary.trials for summary in evidence.summaries})
    seeds = sorted({row.world_seed for row in evidence.rows})
    return {
        "command": command,
        "trials": f"{len(evidence.rows):,}",
        "each": f"{counts[0]}" if len(counts) == 1 else f"{counts[0]} to {counts[-1]}",
        "first_seed": f"{seeds[0]}",
        "last_seed": f"{seeds[-1]}",
        "versions": _versions(evidence.rows),
        "codes": _codes(evidence.rows),
        "machine": f"{platform.system()} on {platform.machine()} with {os.cpu_count()} cores",
        "python": platform.python_version(),
    }


def _versions(rows: Iterable[Row]) -> str:
    """Say which versions of this package made rows; those before 0.1.0 left no trace of theirs."""
    found = sorted({row.version for row in rows})
    return " and ".join(version or "before 0.1.0" for version in found)


def _codes(rows: Iterable[Row]) -> str:
    return ", ".join(sorted({row.code for row in rows}))


def _claims(evidence: Evidence) -> dict[str, str]:
    """Return the table of claims, and a note for each that does not hold."""
    notes: list[str] = []
    rows = [_claim_row(claim, evidence, notes) for claim in claims()]
    told = [f"{number}. {note}" for number, note in enumerate(notes, start=1)]
    return {
        "claims": markdown(["where", "claim", "paper", *FAMILIES.values()], rows, words=5),
        "notes": "".join(f"{note}\n" for note in told or ["Nothing to explain."]),
    }


def _claim_row(claim: Claim, evidence: Evidence, notes: list[str]) -> list[str]:
    found = [claim.judge(evidence, family) for family in FAMILIES]
    mark = ""
    if claim.why_not and any(judgement.holds is False for judgement in found):
        if claim.why_not not in notes:
            notes.append(claim.why_not)
        mark = f" [{notes.index(claim.why_not) + 1}]"
    return [claim.figure, claim.text + mark, claim.paper, *map(_verdict, found)]


def _verdict(judgement: ClaimJudgement) -> str:
    verdict = VERDICTS[judgement.holds]
    return f"{verdict}: {judgement.measured}" if verdict else judgement.measured


def _figures(file: Path, folders: Sequence[Path]) -> str:
    """Copy the figures beside the document and return what shows them.

    They are all of the first folder, and of the others those of the suite as a whole; then those
    that stood there before.
    """
    images = file.parent / "images"
    images.mkdir(exist_ok=True)
    before = set(images.glob("results-*.png"))
    wholes = [folder / f"{read_folder(folder)[0].suite}.png" for folder in folders[1:]]
    pictures = [*sorted(folders[0].glob("*.png")), *filter(Path.exists, wholes)]
    copies = [images / f"results-{picture.name}" for picture in pictures]
    for picture, copy in zip(pictures, copies, strict=True):
        shutil.copyfile(picture, copy)
    shown = [_shown(copy) for copy in copies]
    older = [_shown(picture) for picture in sorted(before.difference(copies))]
    return "\n".join([*shown, *([f"{KEPT}:\n", *older] if older else [])])


def _shown(copy: Path) -> str:
    name = copy.stem.removeprefix("results-")
    return f"![{name}](images/{copy.name})\n"


def _table_1(evidence: Evidence) -> str:
    """Return Table I, with the paper's numbers in brackets."""
    learned = ("teamformer", "deepset", "gnn", ANY_FLEET)
    rows = [
        ["failures", _label(family), *(_failures(evidence, family, s) for s in TABLE_1)]
        for family in (*learned, "join-all", "heuristic")
    ]
    rows += [
        ["failures, guarded", _label(family), *(_guarded(evidence, family, s) for s in TABLE_1)]
        for family in learned
    ]
    rows += [
        ["inference, s", _label(family), *(_inference(evidence, family, s) for s in TABLE_1)]
        for family in (*INFERENCE, ANY_FLEET, "join-all", "central")
    ]
    return markdown(["", "method", *TABLE_1], rows)


def _label(family: str) -> str:
    if family == ANY_FLEET:
        return "teamformer"
    return f"{family}-cN" if family in FAILURES else family


def _failures(evidence: Evidence, family: str, setting: str) -> str:
    theirs = _of_paper(FAILURES, family, setting)
    told = _failed(evidence, method_for(family, setting), setting)
    return told if theirs is None else f"{told} ({theirs})"


def _guarded(evidence: Evidence, family: str, setting: str) -> str:
    """Return the failures with the deadlock guard, which the paper's policies do not have."""
    return _failed(evidence, method_for(family, setting).removesuffix(BARE), setting)


def _failed(evidence: Evidence, method: str, setting: str) -> str:
    summary = evidence.summary(setting, method)
    return "-" if summary is None else f"{summary.failures} of {summary.trials}"


def _inference(evidence: Evidence, family: str, setting: str) -> str:
    summary = evidence.summary(setting, method_for(family, setting))
    theirs = _of_paper(INFERENCE, family, setting)
    spent = None
    if summary is not None:
        spent = summary.waiting if family == "central" else summary.inference
    told = (seconds(spent) if spent else "") or "-"
    return told if theirs is None else f"{told} ({theirs[0]:g})"


def _of_paper(table: Mapping[str, Sequence[T]], family: str, setting: str) -> T | None:
    values = table.get(family, ())
    place = TABLE_1.index(setting)
    return values[place] if place < len(values) else None


def _everything(suites: Mapping[str, Sequence[Row]], kept: Mapping[str, str]) -> str:
    """Return the tables of suites, then those of suites that are kept."""
    tables = {name: summary_table(Evidence(rows).summaries) for name, rows in suites.items()}
    tables |= {name: table for name, table in kept.items() if name not in tables}
    return "\n".join([EXPLANATION, *(f"## {name}\n\n{table}" for name, table in tables.items())])


def _room(evidence: Evidence) -> str:
    """Return how much better any method could be, for each setting; nothing without `central`."""
    rows = [
        row
        for setting in dict.fromkeys(summary.setting for summary in evidence.summaries)
        if (row := _room_row(evidence, setting))
    ]
    headers = [
        "setting",
        "lower bound",
        "planner's schedule",
        "proven",
        "list schedule",
        "best known",
        "`central`, played",
        "`join-all`",
        "`teamformer`",
    ]
    return markdown(headers, rows, words=1) if rows else ""


def _room_row(evidence: Evidence, setting: str) -> list[str]:
    planned = {r.world_seed for r in evidence.rows if r.setting == setting and r.relaxed}
    rows = [r for r in evidence.rows if r.setting == setting and r.world_seed in planned]
    if not rows:
        return []
    inner = Evidence(rows)
    central = inner.summary(setting, "central")
    if central is None:
        return []
    played = [inner.summary(setting, name) for name in ("join-all", "teamformer")]
    return [
        setting,
        number(central.lower_bound.value),
        number(central.relaxed.value),
        f"{central.proven} of {central.trials}",
        number(central.list_schedule.value),
        number(central.best_known.value),
        steps_of(central),
        *map(steps_of, played),
    ]


def _weight(evidence: Evidence) -> dict[str, str]:
    """Return the numbers in what a reader has to know to weigh all others."""
    return {
        "timed": f"{evidence.least_timed()}",
        "savings": ", ".join(_savings(evidence)),
        "open_50": f"{wilson(0, 50)[1]:.1%}",
        "open_1000": f"{wilson(0, 1000)[1]:.2%}",
        "power": _power(evidence),
    }


def _savings(evidence: Evidence) -> Iterator[str]:
    for setting in dict.fromkeys(summary.setting for summary in evidence.summaries):
        found = evidence.saving(setting, "join-all", "heuristic")
        if found:
            yield f"{found.value:.0%} on {setting}"


def _power(evidence: Evidence) -> str:
    """Say how far apart two means over 50 trials must be, on one setting as an example."""
    setting = "4N20T-C4"
    summary = evidence.summary(setting, "join-all")
    paired = evidence.difference(setting, "heuristic", "join-all")
    if not summary or not paired or summary.makespan.count < 2:
        return ""
    alone = Mean(0.0, summary.makespan.deviation * 2**0.5, 50).half_width
    together = Mean(0.0, paired.deviation, 50).half_width
    return (
        f"On {setting} the makespan of one method varies by {summary.makespan.deviation:.1f} steps "
        f"between worlds, so two means over 50 different worlds must be {alone:.1f} steps apart to "
        f"tell them; that of `heuristic` to `join-all` on the same worlds, {together:.1f}."
    )
