"""What is around the code: one version, a citation and workflows that others' tools accept."""

from __future__ import annotations

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import yaml

import teamformer

ROOT = Path(__file__).parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))
SAME_CODE = {"PYTHONPATH": str(Path(teamformer.__file__).parent.parent)}
AS_INSTALLED = "import sys; sys.argv[0] = 'teamformer'\nfrom teamformer.cli import main; main()"


def make_targets() -> set[str]:
    return set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE))


def test_the_version_is_the_same_everywhere() -> None:
    """`pyproject.toml` has it; the citation and the newest entry of the changelog repeat it."""
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    newest = re.search(r"^## \[(\d.*?)\]", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)
    assert newest is not None
    assert {citation["version"], newest[1]} == {PROJECT["version"]}


def test_the_version_is_that_which_is_installed() -> None:
    shown = subprocess.run(
        [sys.executable, "-m", "teamformer.cli", "--version"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert shown.stdout == f"teamformer {teamformer.__version__}\n"


def test_every_python_that_is_allowed_is_named_and_tested() -> None:
    """The bounds of `requires-python`, the classifiers and the workflow say the same."""
    low, high = re.fullmatch(r">=3\.(\d+),<3\.(\d+)", PROJECT["requires-python"]).groups()  # type: ignore[union-attr]
    allowed = [f"3.{minor}" for minor in range(int(low), int(high))]
    named = [entry.rpartition(" ")[2] for entry in PROJECT["classifiers"] if ":: 3.1" in entry]
    test = yaml.safe_load((ROOT / ".github/workflows/test.yml").read_text())
    assert named == allowed
    assert test["jobs"]["test"]["strategy"]["matrix"]["python"] == allowed


def check_schema(schema: str, *files: Path) -> subprocess.CompletedProcess[str]:
    pytest.importorskip("check_jsonschema", reason="check-jsonschema is not installed")
    command = [sys.executable, "-m", "check_jsonschema", "--builtin-schema", schema]
    return subprocess.run([*command, *map(str, files)], capture_output=True, text=True)


def test_workflows_are_what_github_reads() -> None:
    assert [path.stem for path in WORKFLOWS] == ["docs", "test", "weekly", "wheels"]
    checked = check_schema("vendor.github-workflows", *WORKFLOWS)
    assert checked.returncode == 0, checked.stdout


def test_a_workflow_with_a_mistake_is_found(tmp_path: Path) -> None:
    """So that the test above cannot pass by checking nothing."""
    broken = tmp_path / "test.yml"
    broken.write_text(WORKFLOWS[0].read_text().replace("runs-on", "run-on"))
    assert check_schema("vendor.github-workflows", broken).returncode == 1


def test_every_test_runs_once_a_week() -> None:
    weekly = yaml.safe_load((ROOT / ".github/workflows/weekly.yml").read_text())
    assert weekly[True]["schedule"] == [{"cron": "17 3 * * 0"}]  # YAML reads `on` as true
    assert "make test-all PYTHON=python" in str(weekly["jobs"])


def test_it_is_described_in_the_same_words_everywhere() -> None:
    said = PROJECT["description"]
    readme = " ".join((ROOT / "README.md").read_text(encoding="utf-8").split())
    assert f"Teamformer {said[0].lower()}{said[1:]}" in readme
    assert f"site_description: {said}\n" in (ROOT / "mkdocs.yml").read_text()


def test_the_citation_is_one() -> None:
    checked = check_schema("vendor.citation-file-format", ROOT / "CITATION.cff")
    assert checked.returncode == 0, checked.stdout


@pytest.mark.parametrize("path", [*WORKFLOWS, ROOT / "Dockerfile"], ids=lambda path: path.name)
def test_what_is_made_there_can_be_made(path: Path) -> None:
    asked = set(re.findall(r"\bmake ([a-z-]+)", path.read_text()))
    assert asked <= make_targets()
    assert asked


@pytest.mark.thorough
def test_a_first_run_that_takes_too_long_fails() -> None:
    """As `make wheel` measures it, in seconds of the processor: waiting does not count."""

    def timed(code: str) -> subprocess.CompletedProcess[str]:
        words = [sys.executable, str(ROOT / "tests" / "first_run.py"), sys.executable, "-c", code]
        return subprocess.run(words, capture_output=True, text=True)

    quick = timed("import time; time.sleep(0.1); print('done')")
    assert (quick.returncode, quick.stdout) == (0, "done\n")
    assert re.search(r"^first run: 0\.\d s of the processor, ", quick.stderr)
    slow = timed("import time\nwhile time.process_time() < 5.1: pass")
    assert slow.returncode == 1
    assert "error: that is more than 5 s" in slow.stderr
    assert timed("raise SystemExit(3)").returncode == 3
    assert "tests/first_run.py" in (ROOT / "Makefile").read_text()


def test_the_image_is_built_of_what_is_sent_to_it() -> None:
    """`.dockerignore` refuses everything but files that are there, and the build needs those."""
    sent = [
        line[1:] for line in (ROOT / ".dockerignore").read_text().split() if line.startswith("!")
    ]
    assert all((ROOT / name).exists() for name in sent)
    needed = {"pyproject.toml", "Makefile", "src", "hatch_build.py", PROJECT["readme"], "LICENSE"}
    with (ROOT / "pyproject.toml").open("rb") as file:
        wheel = tomllib.load(file)["tool"]["hatch"]["build"]["targets"]["wheel"]
    assert needed | set(wheel["force-include"]) <= set(sent)
    assert "examples/warehouse.yaml" in (ROOT / "Makefile").read_text()
    assert {"examples", "tests/first_run.py"} <= set(sent)


def test_completion_knows_verbs_and_flags() -> None:
    """As a shell asks for it after `teamformer --install-completion`."""

    def completed(words: str) -> list[str]:
        count = len(words.split()) - 1
        asked = {"COMP_WORDS": words, "COMP_CWORD": str(count)}
        done = subprocess.run(
            [sys.executable, "-c", AS_INSTALLED],
            env={"_TEAMFORMER_COMPLETE": "complete_bash", "PATH": "", **asked, **SAME_CODE},
            capture_output=True,
            text=True,
        )
        return done.stdout.split()

    assert completed("teamformer fleet re") == ["rehearse"]
    assert completed("teamformer run --me") == ["--method"]


def test_types_are_marked_for_users() -> None:
    assert (Path(teamformer.__file__).parent / "py.typed").is_file()


def test_make_run_installs_first_what_kernels_need_of_what_the_package_needs() -> None:
    makefile = (ROOT / "Makefile").read_text()
    (listing,) = re.findall(r"^LIBRARIES := (.*)$", makefile, re.MULTILINE)
    listed = subprocess.run(listing, shell=True, cwd=ROOT, capture_output=True, text=True)
    needed = PROJECT["dependencies"]
    assert listed.stdout.split() == [f'"{one}"' for one in needed]
    later = [one for one in needed if one.startswith("o")]
    assert [re.split(r"[<>=]", one)[0] for one in later] == ["onnxruntime", "ortools"]
