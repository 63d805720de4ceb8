"""The verbs of `fleet`, as a user meets them."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from fleets import trio
from teamformer.files.mission_files import write_mission
from typed import teamformer


@pytest.fixture
def mission(tmp_path: Path) -> str:
    write_mission(trio().source, tmp_path / "trio.yaml")
    return str(tmp_path / "trio.yaml")


@pytest.mark.thorough
def test_rehearse_sums_up(mission: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert teamformer("fleet", "rehearse", mission, "--schedules", "4", "--json") == 0
    row = json.loads(capsys.readouterr().out)
    assert (row["schedules"], row["blocked"], row["violations"]) == (4, 0, [])
    assert row["ended"] + row["infeasible"] == 4
    assert row["messages_per_robot_second"] > 0.5
    assert row["bytes_per_robot_second"] > 50
    assert row["undisturbed"] > 10


def test_one_schedule_becomes_a_page(
    mission: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert teamformer("fleet", "rehearse", mission, "--schedule", "3", "--out", str(out)) == 0
    told = capsys.readouterr()
    assert "50% of messages are lost" in told.out
    assert f"page:   {out / 'record.html'}" in told.err.replace("\n", "")
    assert (out / "record.html").stat().st_size > 10_000


def test_check_judges_what_was_seen_of_a_fleet(
    mission: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert teamformer("fleet", "rehearse", mission, "--schedule", "2", "--out", str(out)) == 0
    capsys.readouterr()
    assert teamformer("check", str(out / "record.json")) == 0
    told = " ".join(capsys.readouterr().out.split())
    assert told.startswith("legal: ")
    assert "checked what was seen of a fleet once a step: who can do what" in told


ADD = ("fleet", "add", "MISSION")
SITE = ("--at", "1,0", "--needs")
NEAR, FAR = (("--connect", f"tcp/{host}:1") for host in ("127.0.0.1", "10.0.0.1"))
AGENT = ("fleet", "agent", "MISSION")


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("rehearse", "MISSION"), "No such command 'rehearse'"),
        (("fleet", "rehearse", "MISSION", "--out", "x"), "say which with --schedule K"),
        ((*AGENT, "nobody", "--listen", "tcp/127.0.0.1:1"), "r0, r1, r2"),
        ((*AGENT, "r0"), "has no way to the others"),
        ((*AGENT, "r0", "--listen", "tcp/10.0.0.1:1"), "has shared.key with --keys FOLDER"),
        ((*AGENT, "r0", "--listen", "tls/10.0.0.1:1"), "key.pem with --keys FOLDER"),
        (("fleet", "rehearse", "MISSION", "--method", "central"), "no robot does"),
        (("fleet", "rehearse", "MISSION", "--method", "nobody:Nobody"), "nobody"),
        (("fleet", "start", "MISSION", "--keys", "no-folder"), "no-folder: cannot be read"),
        ((*ADD, "t"), "Missing option '--at'"),
        (ADD, "Missing argument 'NAME'"),
        ((*ADD, "t", *SITE, "a"), "Missing option '--connect'"),
        ((*ADD, "t", *SITE, "a", *FAR), "has shared.key with --keys FOLDER"),
        ((*ADD, "t0", *SITE, "a", *NEAR), "has a task 't0' already"),
        ((*ADD, "t" * 201, *SITE, "a", *NEAR), "the task's name has 201 letters"),
        ((*ADD, " ", *SITE, "a", *NEAR), "the task's name has 0 letters"),
        ((*ADD, "t", "--at", "x", "--needs", "a", *NEAR), "is no place"),
        ((*ADD, "t", "--at", "20,0", "--needs", "a", *NEAR), "--at 20,0 is no free place"),
        ((*ADD, "t", "--at", "1.5,0", "--needs", "a", *NEAR), "--at 1.5,0 is no free place"),
        ((*ADD, "t", "--at", "nan,0", "--needs", "a", *NEAR), "--at nan,0 is no free place"),
        ((*ADD, "t", *SITE, "q", *NEAR), "there is no capability 'q'"),
        ((*ADD, "t", *SITE, "a:0", *NEAR), "0 is no count"),
        ((*ADD, "t", *SITE, "a:\u00b3", *NEAR), "is no count"),
        ((*ADD, "t", *SITE, "a:2", *NEAR), "all robots together cannot do 't'"),
        ((*ADD, "t", *SITE, "a", "--duration", "2e9", *NEAR), "is too long"),
    ],
    ids=lambda value: value if isinstance(value, str) else value[0],
)
def test_misuse_is_told(
    arguments: tuple[str, ...], told: str, mission: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert teamformer(*(mission if word == "MISSION" else word for word in arguments)) == 2
    assert told in capsys.readouterr().err


@pytest.mark.slow
def test_a_fleet_of_processes_survives_a_kill(tmp_path: Path) -> None:
    """Two of each kind, so that the mission can end without the one that is killed."""
    mission = trio().source
    path = tmp_path / "mission.yaml"
    robots = [*mission.robots, *mission.robots]
    named = tuple(replace(robot, name=f"r{number}") for number, robot in enumerate(robots))
    write_mission(replace(mission, robots=named), path)
    command = [sys.executable, "-m", "teamformer.cli", "fleet", "start", str(path), "--json"]
    with subprocess.Popen(
        [*command, "--time-limit", "240"], stdout=-1, stderr=-1, text=True
    ) as fleet:
        assert fleet.stdout is not None
        assert fleet.stderr is not None
        told: list[str] = []
        for line in fleet.stderr:
            told.append(line)
            if line.startswith("agent r4 pid "):
                pid = int(line.split()[-1])
            if " done by " in line:
                os.kill(pid, signal.SIGKILL)
                break
        out, _ = fleet.communicate(timeout=280)
    row = json.loads(out)
    assert row["completed"]
    assert (row["tasks_done"], row["robots_alive"]) == (5, 5)
    assert told[0] == "making the first plan ...\n"
    counts = [line.rpartition(", ")[2] for line in told if " ready after " in line]
    assert counts == [f"{number} of 6\n" for number in range(1, 7)]
    assert told[-2].startswith("time begins, ")
