"""Bodies of a user's own: what goes wrong in them is told, and the mind never gets nonsense."""

from __future__ import annotations

import signal
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fleets import pair, plan_of
from teamformer.base.errors import TeamformerError
from teamformer.fleet.bodies.body import Command, Report, charge_of
from teamformer.fleet.process.bodies_by_name import body_maker
from teamformer.fleet.process.loop import AgentProcess

HERE = "test_own_body"


class Still:
    """Stands where it starts, whatever it is told."""

    def __init__(self, mission: Any, robot: int) -> None:
        self.x, self.y = mission.source.robots[robot].at
        self.commands: list[Command] = []

    def command(self, command: Command) -> None:
        self.commands.append(command)

    def report(self) -> Any:
        return Report(np.float32(self.x), self.y, number=np.int64(7), is_unfit=np.bool_(True))

    def close(self) -> None:
        self.commands.append(Command(place=None))


class Telling(Still):
    """Reports what it is not to."""

    def report(self) -> Any:
        return "here"


class Lettered(Still):
    def report(self) -> Any:
        place: Any = "a"
        return Report(place, 0)


class Broken(Still):
    def report(self) -> Any:
        raise RuntimeError("wheel fell off")


class Bodiless:
    """Can be made, and nothing else."""

    def __init__(self, mission: Any, robot: int) -> None:
        self.robot = robot


def made(name: str, robot: int = 0) -> Any:
    nobody: Any = None  # the line to what is simulated elsewhere
    return body_maker(name)(pair(), robot, nobody)


def test_reports_become_plain_numbers() -> None:
    body = made(f"{HERE}:Still", 1)
    body.command(Command(3))
    report = body.report()
    assert report == Report(4.0, 0.0, number=7, is_unfit=True)
    assert [type(part) for part in report[:7]] == [float, float, int, bool, bool, int, bool]
    assert report[7:] == (None, False, True, False, None, None)


def test_a_battery_that_is_nearly_full_is_full_and_none_is_more_than_that() -> None:
    shares = [(0.5, 0.5), (0.985, 1.0), (1.2, 1.0), (-0.1, 0.0), (float("nan"), 0.0)]
    for told, taken in shares:
        assert charge_of(told) == taken


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("no_such_module:Still", "cannot be imported.*No module named"),
        (f"{HERE}:Nobody", "has no class 'Nobody'"),
        (f"{HERE}:", "there is no body"),
        ("sims", "there is no body 'sims'"),
        ("os:getcwd", "os:getcwd cannot be made.*takes no arguments"),
        (f"{HERE}:Bodiless", "is no body: it has no 'command'"),
    ],
)
def test_what_is_no_body_is_told(name: str, told: str) -> None:
    with pytest.raises(TeamformerError, match=told):
        made(name)


def test_a_body_is_found_in_the_folder_that_the_user_works_in(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The class is that of docs/how-to/robots.md."""
    text = (Path(__file__).parents[2] / "docs" / "how-to" / "robots.md").read_text()
    code = text.split("```python\n")[1].split("```")[0]
    (tmp_path / "body_in_this_folder.py").write_text(code)
    monkeypatch.setattr(sys, "path", [part for part in sys.path if part])
    monkeypatch.chdir(tmp_path)
    body = made("body_in_this_folder:MyBody", 1)
    body.command(Command(1, (6, 0), 0, 1, True))
    assert body.report() == Report(6.0, 0.0, 1, number=1, has_served=True)


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("Telling", "returned str, not a Report"),
        ("Lettered", "could not convert string to float"),
        ("Broken", r"failed at .*test_own_body.py:\d+: RuntimeError: wheel fell off"),
    ],
)
def test_what_a_body_does_wrong_is_told(name: str, told: str) -> None:
    body = made(f"{HERE}:{name}")
    with pytest.raises(TeamformerError, match=told):
        body.report()


class Wandering:
    """Reports one place after another, the last again and again."""

    def __init__(self, *places: tuple[float, float]) -> None:
        self.places = list(places)

    def command(self, command: Command) -> None:
        pass

    def report(self) -> Report:
        x, y = self.places.pop(0) if len(self.places) > 1 else self.places[0]
        return Report(x, y)

    def close(self) -> None:
        pass


class Nowhere:
    """A network that nobody is on; its `agent` is told to end once it has spoken twice."""

    def __init__(self) -> None:
        self.sent: list[bytes] = []
        self.agent: AgentProcess | None = None

    def send(self, to: int, data: bytes) -> None:
        self.sent.append(data)

    def listen_to(self, robots: Any) -> None:
        pass

    def receive(self, seconds: float) -> list[bytes]:
        if len(self.sent) >= 2 and self.agent is not None:
            self.agent.is_ending = True
        return []

    def close(self) -> None:
        pass


def test_places_where_nobody_can_be_are_left_aside(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """First off the map, then at 3, then nowhere: it says that it is at 3, and tells once."""
    monkeypatch.setattr(signal, "signal", lambda *_: None)  # pytest's own stay
    mission, line = pair(), Nowhere()
    body = Wandering((-1.0, 0.0), (3.0, 0.0), (float("nan"), 0.0))
    line.agent = AgentProcess(mission, 0, plan_of(mission), line, body)
    assert line.agent.run() == 0
    told = capsys.readouterr().err
    assert told == "r0: the body reports that it is at -1, 0, where nobody can be; left aside\n"
    words = [line.agent.post.open(data).body.word for data in line.sent]
    assert {(word.x, word.y) for word in words} == {(3.0, 0.0)}
