"""Every verb where only the package itself is installed: it works, or names the extra it needs."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from dataclasses import replace
from importlib.metadata import PackageNotFoundError, packages_distributions, requires
from pathlib import Path

import pytest

from teamformer.files.drawn.smallest import smallest_mission
from teamformer.files.mission_files import write_mission
from test_command_line import VERBS

MISSION, ARENA = "smallest.yaml", str(Path(__file__).parents[1] / "examples/robotarium-4.yaml")
ADDRESS = ("--connect", "tcp/127.0.0.1:7447")

CALLS: dict[str, tuple[tuple[str, ...], str]] = {
    "run": (("run", MISSION, "--method", "join-all", "--out", "out"), ""),
    "run --foxglove": (("run", MISSION, "--foxglove", "8766"), "mcap"),
    "compare": (("compare", MISSION, "--methods", "join-all", "--seeds", "1"), ""),
    "generate": (("generate", "--robots", "2", "--tasks", "2", "--out", "drawn.yaml"), ""),
    "import": (("import", "hetero-mrta", "their.json", "--out", "theirs.yaml"), ""),
    "plan": (("plan", MISSION), ""),
    "advise": (("advise", MISSION), ""),
    "live": (("live", MISSION), "live"),
    "methods": (("methods",), ""),
    "schema": (("schema",), ""),
    "mcp": (("mcp",), "mcp"),
    "bench": (("bench", "table1", "--trials", "1", "--methods", "join-all"), ""),
    "bench robotarium": (("bench", "robotarium", "--trials", "1"), "robotarium"),
    "bench fleet": (("bench", "fleet", "--trials", "1"), "fleet"),
    "train": (("train", "gnn-c4"), "train"),
    "check": (("check", "out/record.json"), ""),
    "view": (("view", "out/record.json"), ""),
    "learn": (("learn", MISSION, "out/record.json", "learned.yaml"), ""),
    "export": (("export", "out/record.json", "tables"), ""),
    "export .mcap": (("export", "out/record.json", "out/record.mcap"), "mcap"),
    "export .gif": (("export", "out/record.json", "out/record.gif"), "gif"),
    "fleet start": (("fleet", "start", MISSION), "fleet"),
    "fleet add": (("fleet", "add", MISSION, "t", "--at", "0,0", "--needs", "a", *ADDRESS), "fleet"),
    "fleet cancel": (("fleet", "cancel", MISSION, "t", *ADDRESS), "fleet"),
    "fleet agent": (("fleet", "agent", MISSION, "r1"), "fleet"),
    "fleet rehearse": (("fleet", "rehearse", MISSION), "fleet"),
    "fleet watch": (("fleet", "watch", MISSION, *ADDRESS), "live"),
    "robotarium fly": (("robotarium", "fly", ARENA), "robotarium"),
    "robotarium deploy": (("robotarium", "deploy", ARENA, "folder"), "robotarium"),
}
"""By verb, and by what else needs an extra: what is called, and the extra that it asks for."""

CALL_ALL = """
import contextlib, io, json, sys
blocked, calls = json.loads(sys.argv[1])
sys.modules.update(dict.fromkeys(blocked))
from teamformer.cli import main
told = {}
for name, words in calls.items():
    sys.argv, said = ["teamformer", *words], io.StringIO()
    with contextlib.redirect_stderr(said), contextlib.redirect_stdout(io.StringIO()):
        try:
            main()
        except SystemExit as stop:
            told[name] = stop.code, said.getvalue()
        except BaseException as error:
            told[name] = repr(error), said.getvalue()
print(json.dumps(told))
"""


THEIRS = {
    "setup": {"robots": 1, "tasks": 1, "num_skills": 1},
    "tasks": {"0": {"pos": {"x": 0.5, "y": 0.25}, "skillset": {"0": 1}, "duration": 1.5}},
    "robots": {"0": {"pose": {"x": 0.1, "y": 0.2}, "skillset": {"0": 1}}},
}


def spelled(name: str) -> str:
    """Return the name of a distribution as all its spellings have it in common."""
    return re.sub("[-_.]+", "-", name).lower()


def installed_with(name: str) -> set[str]:
    """Return the distributions that come with one that is installed without extras."""
    found, waiting = set[str](), [name]
    while waiting:
        one = spelled(waiting.pop())
        if one not in found:
            found.add(one)
            try:
                wanted = requires(one) or []
            except PackageNotFoundError:  # for another system
                continue
            waiting += [re.split(r"[^\w.-]", line)[0] for line in wanted if "extra ==" not in line]
    return found


def modules_of_extras() -> list[str]:
    """Return what can be imported here, and could not where only the package is installed."""
    bare = installed_with("teamformer")
    of = packages_distributions()
    return [module for module, by in of.items() if not bare & {spelled(one) for one in by}]


@pytest.fixture(scope="module")
def told(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[object, str]]:
    """By call, its exit status, or the exception that came through, and what it said."""
    folder = tmp_path_factory.mktemp("bare")
    first, *others = smallest_mission().tasks
    unsure = replace(first, duration=1, lasts=(1, 2))
    write_mission(replace(smallest_mission(), tasks=(unsure, *others)), folder / MISSION)
    (folder / "their.json").write_text(json.dumps(THEIRS))
    calls = {name: words for name, (words, _) in CALLS.items()}
    given = json.dumps([modules_of_extras(), calls])
    done = subprocess.run(
        [sys.executable, "-c", CALL_ALL, given], cwd=folder, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return {name: tuple(said) for name, said in json.loads(done.stdout.splitlines()[-1]).items()}


def test_every_verb_is_called() -> None:
    assert set(VERBS) <= set(CALLS)


def test_what_extras_bring_is_not_there() -> None:
    modules = set(modules_of_extras())
    assert {"scipy", "daqp", "msgspec", "starlette"} <= modules
    assert not {"numpy", "numba", "onnxruntime", "ortools", "rich", "yaml"} & modules


@pytest.mark.parametrize("name", CALLS)
@pytest.mark.thorough
def test_it_works_or_names_the_extra_that_it_needs(
    name: str, told: dict[str, tuple[object, str]]
) -> None:
    status, said = told[name]
    extra = CALLS[name][1]
    if extra:
        assert (status, f"[{extra}]" in said) == (2, True), said
    else:
        assert status == 0, said
