"""`teamformer check` and `teamformer view`: what to do with the record of a trial."""

from __future__ import annotations

from pathlib import Path

from teamformer.commands.console import out, prepare_file, print_json, say
from teamformer.referee import judge
from teamformer.sim.replay import read_replay, replay_to_tree
from teamformer.viewer.html import write_page


def check(path: Path, as_json: bool) -> int:
    """Judge a record; return 0 if every step was legal and every task really done."""
    replay = read_replay(path)
    verdict = judge(replay)
    if as_json:
        findings = [{"step": f.step, "message": f.message} for f in verdict.findings]
        print_json({"legal": not findings, "status": replay.end.status, "findings": findings})
    else:
        for finding in verdict.findings:
            out.print(finding.message, markup=False)
        steps, tasks = len(replay.steps), replay.end.tasks_done
        if not verdict.findings:
            ending = f"{tasks} tasks done, {replay.end.status}"
            out.print(f"legal: {steps} steps, {ending}", markup=False, style="green")
        else:
            out.print(f"not legal: {len(verdict.findings)} findings in {steps} steps", style="red")
    return 1 if verdict.findings else 0


def view(path: Path, page: Path | None, as_json: bool) -> int:
    """Write the page of a record beside it, or where asked; return the exit status."""
    page = page or path.with_suffix(".html")
    prepare_file(page)
    write_page(replay_to_tree(read_replay(path)), page)
    if as_json:
        print_json({"page": str(page)})
    else:
        say(f"page: {page}")
    return 0
