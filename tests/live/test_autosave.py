"""Missions that are cut off: kept line by line, and gone on with as if nothing had been."""

from __future__ import annotations

import json
import os
import re
import signal
import socket
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from live_server import small_mission
from small_worlds import late_pair
from teamformer.base.errors import TeamformerError
from teamformer.files.mission_files import write_mission
from teamformer.files.trees.writer import task_to_tree
from teamformer.live.drawing.drafts import Draft
from teamformer.live.keeping.autosave import NAME, Autosave, Identity
from teamformer.live.keeping.resuming import (
    drop_half_line,
    find_autosave,
    play_again,
    put_aside,
    read_autosave,
)
from teamformer.live.running.forecasts import forecast
from teamformer.live.running.incidents import (
    CancelledTask,
    Happening,
    LostRobot,
    NewTask,
    NewWeight,
    PlanTakenOver,
    RobotBack,
    search_plan,
)
from teamformer.live.running.messages import read_incident
from teamformer.live.steps.mission_with_past import RunningMission
from teamformer.methods.by_name import load_method
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.mission.coordination import Known, Plan
from teamformer.mission.model import Mission, Task
from teamformer.record.referee import judge

METHODS = ("plan", "crews", "join-fitting")


def start(
    mission: Mission, plans: Sequence[tuple[int, Plan]] = (), method: str = "plan"
) -> RunningMission:
    return RunningMission(mission, lambda: load_method(method), 0, plans)


def kept_while(folder: Path, deeds: Sequence[Happening | int | str], method: str) -> RunningMission:
    """Return a mission to which deeds were done, each kept: incidents, numbers of steps, undo."""
    mission = start(small_mission(), method=method)
    autosave = Autosave(folder / NAME, Identity("its own", Draft({"name": "small"}, "small.yaml")))
    autosave.begin(mission)
    for deed in deeds:
        if deed == "undo":
            mission.undo()
            autosave.undo()
        elif isinstance(deed, int):
            for _ in range(deed):
                mission.step()
                autosave.move(mission)
        else:
            assert not isinstance(deed, str)
            mission.happen(deed)
            autosave.happen(mission)
    autosave.release()
    return mission


DEEDS: Sequence[Happening | int | str] = (
    *(
        2,
        NewTask(Task("extra", (3, 1), {"lift": 1})),
        NewTask(Task("more", (4, 0), {"scan": 1}, 2)),
    ),
    *(1, LostRobot("r2"), 2, CancelledTask("c"), 1, RobotBack("r2"), 2),
    *(LostRobot("r3"), 1, "undo", 1),
)
"""Two tasks at one moment, robots lost and back, a task called off, a loss that is undone."""

WITH_KEYS = {
    **{"at": [3, 1], "needs": {"lift": 1}, "duration": [1, 3], "after": ["a"]},
    **{"between": [4, 90], "weight": 2, "to": [0, 1], "unload": 1, "note": "fragile"},
}


@pytest.mark.parametrize("method", METHODS)
def test_a_new_task_has_every_key_that_was_given(tmp_path: Path, method: str) -> None:
    incident = read_incident({"task": WITH_KEYS}, small_mission())
    before = kept_while(tmp_path, (2, incident, 3), method)
    *_, task = before.source.tasks
    given = task_to_tree(task, before.source.world)
    assert given.pop("appears") == 2
    assert given == {"name": "t4", **WITH_KEYS, "needs": ["lift"]}
    again = play_again(read_autosave(tmp_path / NAME), lambda *given: start(*given, method=method))
    assert again.incidents == before.incidents
    for mission in (before, again):
        play_on(mission)
    assert again.record() == before.record()
    assert before.record().end.status == "completed"
    assert judge(before.record()).findings == ()


def test_a_new_task_appears_now() -> None:
    with pytest.raises(TeamformerError, match="appears now; leave 'appears' out"):
        read_incident({"task": WITH_KEYS | {"appears": 9}}, small_mission())


def play_on(mission: RunningMission) -> None:
    while mission.is_running:
        mission.step()


@pytest.mark.parametrize("method", METHODS)
def test_a_mission_that_was_cut_off_goes_on_as_if_nothing_had_been(
    tmp_path: Path, method: str
) -> None:
    before = kept_while(tmp_path, DEEDS, method)
    kept = read_autosave(tmp_path / NAME)
    assert (kept.steps, kept.method, kept.seed, kept.is_ended) == (9, method, 0, False)
    assert kept.identity == Identity("its own", kept.identity.draft)
    assert kept.identity.draft.file == "small.yaml"
    again = play_again(kept, lambda *given: start(*given, method=method))
    assert again.record() == before.record()
    assert again.incidents == before.incidents
    for mission in (before, again):
        play_on(mission)
    assert again.record() == before.record()
    assert again.record().end.status == "completed"
    for mission in (before, again):
        mission.undo()
        play_on(mission)
    assert again.record() == before.record()


def test_no_plan_is_made_again_that_was_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = kept_while(tmp_path, DEEDS, "plan")
    update = SharedPlan.update

    def refuse(self: SharedPlan, known: Known, plan: Plan | None) -> Plan:
        pytest.fail("planned")

    monkeypatch.setattr(SharedPlan, "update", refuse)
    again = play_again(read_autosave(tmp_path / NAME), start)
    assert again.record() == before.record()
    monkeypatch.setattr(SharedPlan, "update", update)
    assert forecast(again.past()) == forecast(before.past())


def test_plans_of_an_operator_are_kept(tmp_path: Path) -> None:
    mission = start(late_pair((3.0, 1.0), cost={"tardiness": 1}))
    autosave = Autosave(tmp_path / NAME, Identity("", Draft({})))
    autosave.begin(mission)
    found = search_plan(mission.past(), seconds=0.1)
    for happening in (found, NewWeight("right", 99.0)):
        mission.step()
        autosave.move(mission)
        mission.happen(happening)
        autosave.happen(mission)
    autosave.release()
    again = play_again(read_autosave(tmp_path / NAME), start)
    assert again.record() == mission.record()
    (_, taken), (_, weighed) = again.incidents
    assert isinstance(taken, PlanTakenOver)
    assert isinstance(weighed, NewWeight)
    assert taken.text(mission.source) == found.text(mission.source)
    assert weighed.plan == mission.incidents[1][1].plan  # type: ignore[union-attr]


def test_a_line_that_was_being_written_is_left_out(tmp_path: Path) -> None:
    path = tmp_path / NAME
    kept_while(tmp_path, [3], "plan")
    whole = path.read_text()
    path.write_text(whole[:-5])
    kept = read_autosave(path)
    assert kept.steps == 2
    drop_half_line(kept)
    assert path.read_text() == "".join(whole.splitlines(keepends=True)[:-1])
    mission = play_again(kept, start)
    autosave = Autosave(path, kept.identity)
    autosave.go_on()
    mission.step()
    autosave.move(mission)
    assert path.read_text() == whole
    autosave.close()
    assert read_autosave(path).is_ended


def test_what_is_no_autosave_is_refused(tmp_path: Path) -> None:
    path = tmp_path / NAME
    with pytest.raises(TeamformerError, match="cannot be read: No such file"):
        read_autosave(path)
    kept_while(tmp_path, [2], "plan")
    header, first, second = path.read_text().splitlines()
    for text, told in [
        ("", "the file is empty"),
        ("[]\n", "autosave.jsonl:1: this is no line of an autosave"),
        (f"{header}\n{{\n", "autosave.jsonl:2: this is no line of an autosave"),
        ("{}\n", "autosave.jsonl:1: this is no autosave of version 1"),
        ('{"teamformer_live": 1}\n', "the file holds what no autosave has"),
        (f'{header}\n{{"undo": true}}\n', "the file holds what no autosave has"),
    ]:
        path.write_text(text)
        with pytest.raises(TeamformerError, match=told):
            read_autosave(path)
    for entries, told in [
        ([second], "step 1 comes out otherwise than it did"),
        ([first, "{}"], "the file holds what no autosave has"),
        ([first, '{"happen": {"plan": {"width": 3}}}'], "the file holds what no autosave has"),
        ([first, '{"happen": {"lost": "r9"}}'], "there is no robot 'r9'"),
    ]:
        path.write_text("".join(f"{line}\n" for line in (header, *entries)))
        with pytest.raises(TeamformerError, match=told):
            play_again(read_autosave(path), start)


def test_a_full_disk_is_told_once_and_the_mission_goes_on(tmp_path: Path) -> None:
    mission, told = start(small_mission()), list[str]()
    autosave = Autosave(Path("/dev/full"), Identity("", Draft({})))
    autosave.warn = told.append
    autosave.begin(mission)
    mission.step()
    autosave.move(mission)
    autosave.close()
    (text,) = told
    assert text.startswith(
        "/dev/full: cannot be written: No space left on device; the mission goes"
    )


def test_what_was_cut_off_is_put_aside_when_another_mission_begins(tmp_path: Path) -> None:
    assert put_aside(tmp_path) is None
    kept_while(tmp_path, [], "plan")
    assert put_aside(tmp_path) is None  # nothing had been done
    for number in (1, 2):
        kept_while(tmp_path, [number], "plan")
        assert find_autosave(tmp_path) == tmp_path / NAME
        assert put_aside(tmp_path) == tmp_path / f"autosave-{number}.jsonl"
    latest = find_autosave(tmp_path)
    assert (latest.name, read_autosave(latest).steps) == ("autosave-2.jsonl", 2)


client = pytest.importorskip("websockets.sync.client")


class Command:
    """`teamformer live` in a process of its own, and a page's line to it."""

    def __init__(self, folder: Path, *words: object) -> None:
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            self.port = int(probe.getsockname()[1])
        given = (*words, "--port", self.port, "--out", folder)
        command = [sys.executable, "-m", "teamformer.cli", "live", *map(str, given)]
        streams: dict[str, Any] = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT}
        self.process = subprocess.Popen(command, text=True, **streams)
        assert self.process.stdout is not None
        self.said: list[str] = []
        for line in self.process.stdout:
            self.said.append(line.rstrip())
            if line.startswith("live: "):
                break

    def hear(self, kind: str, *asks: dict[str, Any]) -> dict[str, Any]:
        """Ask for something, as a page that comes again if told to; return the answer of a kind."""
        while True:
            with client.connect(f"ws://127.0.0.1:{self.port}/socket") as line:
                for ask in asks:
                    line.send(json.dumps(ask))
                while (message := json.loads(line.recv(timeout=60)))["kind"] != "begun":
                    if message["kind"] == kind:
                        return dict(message)

    def end(self, how: signal.Signals) -> None:
        os.kill(self.process.pid, how)
        self.process.communicate(timeout=60)


@pytest.mark.thorough
def test_a_server_that_is_killed_and_started_again_goes_on(tmp_path: Path) -> None:
    path, out = tmp_path / "small.yaml", tmp_path / "out"
    write_mission(small_mission(), path)
    first = Command(out, path)
    name = first.hear("mission")["id"]
    step, lose = {"do": "step"}, {"do": "happen", "lost": "r2"}
    first.hear("incident", step, step, lose)
    first.end(signal.SIGKILL)
    second = Command(out)  # the editor
    said = "\n".join(second.said)
    told = re.search(r"note: teamformer live (\S+) --resume", said)
    assert told is not None, said
    assert Path(told[1]).name == "autosave-1.jsonl"
    second.end(signal.SIGTERM)
    third = Command(out, "--resume")
    assert "goes on: mission 'small', 2 steps and 1 incident" in third.said
    mission = third.hear("mission")
    assert (len(mission["record"]["steps"]), mission["id"]) == (2, name)
    assert mission["incidents"] == [[3, "robot r2 lost"]]
    assert third.hear("step", step)["step"]["lost"] == [1]
    assert third.hear("mission", {"do": "undo"})["record"]["steps"]
    third.end(signal.SIGTERM)
    assert read_autosave(Path(told[1])).is_ended
    assert (out / "record.json").exists()
