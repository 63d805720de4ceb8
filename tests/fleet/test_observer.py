"""A page that watches a fleet: what it makes of words and facts, and what it may do."""

from __future__ import annotations

import asyncio
import json
import signal
import subprocess
import sys
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from browsers import Opened
from fleets import plan_of, trio
from live_server import serving_session
from loops import run_apart
from small_worlds import make, robot, task
from teamformer.files.mission_files import write_mission
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import (
    LIFE,
    LOST,
    OPERATOR,
    SERVE,
    WALK,
    Beat,
    Body,
    CallOff,
    DeedFact,
    FactsNote,
    Message,
    Notice,
    Offer,
    Post,
    Receipt,
    TaskFact,
    Word,
)
from teamformer.fleet.observer.mission_clock import MissionClock
from teamformer.fleet.observer.session import ObserverSession
from teamformer.fleet.observer.silence import Silence
from teamformer.fleet.observer.troubles import troubles
from teamformer.fleet.observer.watch import Watch
from teamformer.fleet.process.fleet import free_ports
from teamformer.fleet.rehearsal.faults import Faults
from teamformer.fleet.rehearsal.rehearse import play
from teamformer.live.running.alerts import Alert, Alerts
from teamformer.record.files.reading import read_record
from teamformer.record.happenings import events
from teamformer.record.record import FLEET, TeamAt
from teamformer.world.rules.constants import NOBODY

SMALL = make([robot("a", 0), robot("a", 1), robot("b", 9)], [task("a", 3), task("ab", 7)])
MISSION = FleetMission(SMALL)
FAST = FleetMission(SMALL, step=0.1)
EXTRA = TaskFact(7 << 24, "extra", 5.0, 0.0, (1, 0, 0))


def message(body: Body, sender: int = 0) -> Message:
    return Message(1, MISSION.number, sender, -1, body)


def word(robot: int, version: int, x: float, team: int, goal: int = NOBODY) -> Word:
    return Word(robot, version, x, 0.0, team, goal)


def test_words_become_steps_of_a_record() -> None:
    """0 walks to 1, they are one team and head for t0; 2 is lost, then back in another life."""
    watch = Watch(MISSION)
    watch.hear(message(Beat(word(0, 2, 1, 0, 0), (word(1, 2, 1, 0, 0),))))
    first = watch.step()
    assert first.joins == ((1, 0),)
    assert first.teams == (TeamAt(0, 1, 0, 0),)  # 2 is where it starts
    watch.hear(message(Beat(word(0, 1, 0, 0))))  # late: an older one
    serving = (Word(0, 3, 1, 0.0, 0, 0, SERVE), Word(1, 3, 1, 0.0, 0, 0, SERVE))
    watch.hear(message(Beat(word(2, LIFE + LOST + 1, 9, 2), serving, news=(0,)), sender=2))
    second = watch.step()
    assert (second.lost, second.done, second.joins) == ((2,), ((0, 0),), ())
    watch.hear(message(Beat(word(2, 2 * LIFE, 8, 2), news=(0,)), sender=2))
    third = watch.step()
    assert (third.back, third.done) == ((2,), ())
    assert TeamAt(2, 8, 0, None) in third.teams
    assert TeamAt(0, 3, 0, None) in second.teams  # what is done is headed for no more


def test_who_did_a_task_is_told_once_those_are_heard_who_have_what_it_needs() -> None:
    """Task 1 needs a and b. The word of 2 comes a step after that of 0, with which all is done."""
    watch = Watch(MISSION)
    watch.hear(message(Beat(Word(0, 1, 7, 0.0, 0, 1, phase=SERVE), news=(1,))))
    assert watch.step().done == ()
    watch.hear(message(Beat(Word(2, 1, 7, 0.0, 0, 1, phase=SERVE)), sender=2))
    step = watch.step()
    assert (step.done, step.joins) == (((1, 0),), ((2, 0),))


def test_who_is_never_heard_is_not_waited_for_long() -> None:
    """Task 1 needs b too, and nobody said that it does task 0: nobody knows by whom they are."""
    watch = Watch(MISSION)
    watch.hear(message(Beat(Word(0, 1, 7, 0.0, 0, 1, phase=SERVE), news=(1,))))
    assert watch.wonders
    assert [watch.step().done for _ in range(3)] == [(), (), ((1, None),)]
    watch.hear(message(Beat(word(0, 2, 7, 0), news=(0,))))
    assert not watch.is_over
    assert [watch.step().done for _ in range(3)] == [(), (), ((0, None),)]
    assert (watch.is_over, watch.wonders) == (True, False)
    told = [event.text(watch.source) for event in events(watch.record()) if event.kind == "done"]
    assert told == [f"t{k} done by then, not known by whom" for k in (1, 0)]


def test_a_record_ends_with_the_step_in_which_all_is_done() -> None:
    """Whoever goes on watching, a mission has taken no longer by that."""
    watch = Watch(MISSION)
    watch.hear(message(Beat(Word(0, 1, 7, 0.0, 0, 1, phase=SERVE), news=(1, 0))))
    for _ in range(3):
        watch.step()
    assert watch.is_over
    ended = watch.record()
    assert (ended.end.status, ended.end.makespan, ended.end.steps) == ("completed", 3, 3)
    watch.step()
    assert watch.record() == ended


def test_facts_tell_what_was_done_before_and_what_operators_added() -> None:
    watch = Watch(MISSION)
    assert not watch.is_told
    assert watch.hear(message(FactsNote((0, EXTRA.key), (EXTRA,)))) == [EXTRA]
    assert watch.hear(message(FactsNote((0, EXTRA.key), (EXTRA,)))) == []
    assert watch.is_told
    assert [{number for number, _ in watch.step().done} for _ in range(3)] == [set(), set(), {0, 2}]
    assert watch.source.tasks[2].needs == {"a": 1}
    watch.hear(message(FactsNote((99,), (TaskFact(8 << 24, "wall", 99.0, 0.0, (1, 0, 0)),))))
    assert len(watch.tasks) == 3  # what makes no sense is left out
    assert watch.record().end.tasks_done == 2


def test_who_comes_late_is_told_who_did_what_and_when() -> None:
    """Robots 0 and 2 tell of t1, each a part; 1 does, alone, of t0. Nobody tells of the extra."""
    watch = Watch(MISSION)
    watch.hear(message(Beat(word(2, 9, 7, 2), (word(0, 9, 4, 0), word(1, 9, 3, 1)), age=50.4)))
    watch.hear(message(FactsNote((0, 1, EXTRA.key), (EXTRA,), 0, (), (DeedFact(1, 20.4, (0,)),))))
    assert not watch.is_told
    watch.hear(message(FactsNote((0, 1), deeds=(DeedFact(1, 20.2, (2,)),)), sender=2))
    watch.hear(message(FactsNote((0,), deeds=(DeedFact(0, 10.0, (1,)),)), sender=1))
    assert watch.is_told
    watch.begin(50.4)
    assert len(watch.steps) == 50
    assert [(n, step.done) for n, step in enumerate(watch.steps, 1) if step.done] == [
        (10, ((0, 1),)),
        (21, ((1, 0),)),
    ]
    assert [watch.step().done for _ in range(3)] == [(), (), ((2, None),)]
    told = [event for event in events(watch.record()) if event.kind == "done"]
    assert [(event.at, event.robots) for event in told] == [(10, (1,)), (21, (0, 2)), (53, ())]
    assert watch.steps[50].teams == (TeamAt(0, 4, 0, None), TeamAt(2, 7, 0, None))


def test_who_did_a_task_by_its_own_word_and_cannot_have_is_not_believed() -> None:
    """Robot 0 lacks the b that t1 needs."""
    watch = Watch(MISSION)
    watch.hear(message(FactsNote((1,), deeds=(DeedFact(1, 2.0, (0,)),))))
    watch.begin(9.0)
    assert [step.done for step in watch.steps] == [()] * 9
    assert [watch.step().done for _ in range(3)] == [(), (), ((1, None),)]


def test_who_comes_after_all_was_done_is_told_who_did_what_and_when() -> None:
    """The agents of a rehearsal that is over tell of every task, and the record says as they do."""
    mission = trio()
    rehearsal, outcome, _ = play(mission, plan_of(mission), Faults())
    watch = Watch(mission)
    for me, agent in enumerate(rehearsal.agents):
        assert agent is not None
        note = agent.knowledge.note_for_onlookers()
        watch.hear(Message(1, mission.number, me, OPERATOR, note))
    watch.begin(outcome.end + 5.0)
    done = rehearsal.world.done
    told = {event.task: event for event in events(watch.record()) if event.kind == "done"}
    assert {key: event.robots for key, event in told.items()} == {
        key: deed.robots for key, deed in done.items()
    }
    assert all(0 <= event.at - done[key].at < 2 for key, event in told.items())


def test_a_mission_goes_on_as_long_as_the_robot_says_that_knows_it_longest() -> None:
    clock = MissionClock(longest=1000.0)
    assert not clock.is_set
    clock.hear(0.0, 5.0)
    clock.hear(30.0, 7.0)
    clock.hear(2.0, 8.0)
    assert (clock.is_set, clock.age(9.0), clock.listened(9.0)) == (True, 32.0, 4.0)
    clock.hear(1e9, 9.0)
    assert clock.age(9.0) == 1000.0


def test_who_does_the_last_task_and_leaves_at_once_has_done_it() -> None:
    """All leave in the step in which it is heard that 0 and 2 did t1; they are lost in the next."""
    watch = Watch(MISSION)
    serving = Word(2, 1, 7, 0.0, 0, 1, phase=SERVE)
    mate = Word(0, 1, 7, 0.0, 0, 1, phase=SERVE)
    watch.hear(message(Beat(serving, (mate, word(1, 1, 1, 1))), sender=2))
    watch.step()
    gone = [word(robot, LOST + 2, 7, robot) for robot in range(3)]
    watch.hear(message(Beat(gone[2], (gone[0], gone[1]), news=(1,)), sender=2))
    last = watch.step()
    assert (last.done, last.lost) == (((1, 0),), (1,))
    watch.hear(message(Beat(word(2, LOST + 3, 7, 2), news=(0,)), sender=2))
    assert (watch.step().lost, watch.steps[-1].done) == ((0, 2), ())  # by nobody that is there
    list(events(watch.record()))


AGE = 2.0
"""Seconds that the mission of the robots behind a loopback has been going on."""


class Loopback:
    """A transport to three robots that hold whatever they are offered, and say so."""

    def __init__(self, holders: int) -> None:
        self._post = Post(FAST.number, FAST.robots)
        self._holders = holders
        self.offered: list[TaskFact] = []
        self._waiting: list[bytes] = []
        self.called_off: set[int] = set()

    def send(self, to: int, data: bytes) -> None:
        said = self._post.open(data)
        assert said is not None
        if isinstance(said.body, CallOff):
            self._hear_off(said.body.key)
            return
        assert isinstance(said.body, Offer)
        self.offered.append(said.body.task)
        for sender in range(self._holders):
            bodies: list[Body] = [Receipt(said.body.task.key)]
            is_own = said.body.task.key < 1 << 24  # known: then they say what else is
            bodies.append(FactsNote((0,)) if is_own else FactsNote((), (said.body.task,)))
            bodies.append(Beat(Word(sender, 1, sender, 0.0, sender), age=AGE))
            sealed = [self._post.seal(sender, Notice(OPERATOR, body)) for body in bodies]
            self._waiting += sealed

    def _hear_off(self, key: int) -> None:
        self.called_off.add(key)
        for sender in range(self._holders):
            for body in (Receipt(key, is_called_off=True), FactsNote((), called_off=(key,))):
                self._waiting.append(self._post.seal(sender, Notice(OPERATOR, body)))

    def listen_to(self, robots: Iterable[int]) -> None:
        assert list(robots) == [0, 1, 2]

    def receive(self, seconds: float) -> Sequence[bytes]:
        came, self._waiting = self._waiting, []
        return [*came, b"no message at all"]

    def close(self) -> None:
        pass


def watching(transport: Loopback, folder: Path) -> ObserverSession:
    post = Post(FAST.number, FAST.robots)
    return ObserverSession(Watch(FAST), transport, post, folder)


def heard_by_a_page(session: ObserverSession, *asked: Any) -> list[dict[str, Any]]:
    """Return what a page is told that asks for something while the session runs."""

    async def talk() -> list[dict[str, Any]]:
        running = asyncio.create_task(session.run())
        watcher = session.join()
        for message in asked:
            await session.act(watcher, message if isinstance(message, str) else json.dumps(message))
        while len(session.watch.steps) <= AGE / FAST.step or not session.watch.is_told:
            await asyncio.sleep(0.01)
        running.cancel()
        told = []
        while not watcher.outbox.empty():
            told.append(json.loads(watcher.outbox.get_nowait() or "{}"))
        return told

    return run_apart(talk())


def test_a_task_that_a_page_adds_is_published_and_told_once_it_is_held(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("teamformer.fleet.observer.session.AGAIN", 0.02)
    transport = Loopback(holders=3)
    session = watching(transport, tmp_path)
    new = {"at": [4, 0], "needs": ["b"], "name": "late"}
    told = heard_by_a_page(session, {"do": "happen", "task": new}, {"do": "save"})
    assert told[0]["kind"] == "mission"
    (incident,) = [message for message in told if message["kind"] == "incident"]
    assert incident["text"].endswith("task late accepted, held by r0, r1, r2")
    assert incident["record"]["mission"]["tasks"][2]["name"] == "late"
    assert incident["is_fleet"]
    assert {task.name for task in transport.offered} == {"late"}
    record = read_record(tmp_path / "record.json")
    assert record.method == "fleet"
    assert [step["kind"] for step in told].count("step") >= 1


def test_a_task_that_a_page_calls_off_is_told_once_that_is_held(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("teamformer.fleet.observer.session.AGAIN", 0.02)
    transport = Loopback(holders=3)
    session = watching(transport, tmp_path)
    name = FAST.source.tasks[1].name
    off = {"do": "happen", "cancelled": name}
    told = heard_by_a_page(session, off, off)
    (incident,) = [message for message in told if message["kind"] == "incident"]
    assert incident["text"].endswith(f"task {name} called off, held by r0, r1, r2")
    (refused,) = [message for message in told if message["kind"] == "refused"]
    assert f"task '{name}' is over, or there is none" in refused["text"]
    assert transport.called_off == {1}
    assert session.watch.record().mission.tasks[1].cancelled is not None
    assert [task.key for _, task in session.watch.open_tasks()] == [0]


def test_who_comes_late_asks_what_has_been_done(tmp_path: Path) -> None:
    transport = Loopback(holders=1)
    session = watching(transport, tmp_path)
    heard_by_a_page(session)
    assert {task.key for task in transport.offered} == {0}
    while not session.watch.steps[-1].done:
        session.watch.step()
    assert session.watch.record().end.tasks_done == 1


def test_others_may_follow_what_is_seen(tmp_path: Path) -> None:
    """Each step is given as the record so far, longer by one each time, from when it came."""
    session = watching(Loopback(holders=1), tmp_path)
    lengths: list[int] = []
    session.on_step = lambda record: lengths.append(len(record.steps))
    heard_by_a_page(session)
    assert lengths == list(range(1 + round(AGE / FAST.step), len(session.watch.steps) + 1))
    assert lengths


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({"do": "pause"}, "the fleet goes its own way; nobody can 'pause' it from here"),
        ({"do": "happen", "lost": "r1"}, "a fleet's robots are lost and back by themselves"),
        ({"do": "happen", "task": {"at": [99, 0], "needs": ["a"]}}, "outside the map"),
        ({"do": "happen", "task": {"at": [4, 0], "needs": {"b": 2}}}, "all robots together"),
        ({"do": "happen", "task": {"at": [4, 0], "needs": ["a"], "name": "t0"}}, "used twice"),
        ({"do": "happen", "task": {"at": [4, 0], "needs": ["a"]}}, "only r0 hold it"),
        ("{", "the message is no JSON"),
    ],
)
def test_what_a_page_may_not_do_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, asked: Any, said: str
) -> None:
    monkeypatch.setattr("teamformer.fleet.observer.session.AGAIN", 0.02)
    monkeypatch.setattr("teamformer.fleet.observer.session.PATIENCE", 0.1)
    session = watching(Loopback(holders=1), tmp_path)
    told = heard_by_a_page(session, asked)
    assert [said in message["text"] for message in told if message["kind"] == "refused"] == [True]


def test_robots_that_are_not_heard_are_named_until_they_are() -> None:
    silence = Silence(("atlas", "bolt"), now=5.0)
    assert silence.alerts(15.0) == []
    [alert] = silence.alerts(15.1)
    assert (alert.key, alert.since) == ("all", 5.0)
    assert alert.text() == (
        "no robot heard: nothing comes here; what is drawn is only where the robots start; "
        "does the fleet run, and are its mission, endpoint and --keys the same here?"
    )
    silence.refuse("another mission")
    assert silence.alerts(15.1)[0].why.startswith("what came was refused: another mission; what")
    silence.hear(0, 16.0)
    [alert] = silence.alerts(16.0)
    assert (alert.key, alert.what, alert.since) == ("robot 1", "bolt not heard", 5.0)
    silence.hear(1, 17.0)
    assert silence.alerts(17.0) == []


DEADLINE = FleetMission(
    replace(SMALL, tasks=(SMALL.tasks[0], replace(SMALL.tasks[1], between=(0, 30)))), step=2.0
)
"""t1, which needs a and b, is due after 30 steps, which are 60 s."""


def told_by(watch: Watch, age: float) -> list[tuple[str, str]]:
    return [(alert.key, alert.text()) for alert in troubles(watch, age)]


def test_lost_and_unfit_robots_late_tasks_and_a_mission_without_an_end_are_alerts() -> None:
    """Robot 2 alone has the b that t1 needs."""
    watch = Watch(DEADLINE)
    watch.hear(message(Beat(word(0, 1, 7, 0, 1), (word(1, 1, 1, 1), word(2, 1, 9, 2)))))
    assert told_by(watch, 60.0) == []
    late = (
        "t1 is late: it was due at 60 s and is not done; look at r0, which head for it or are there"
    )
    assert told_by(watch, 61.0) == [("task 1", late)]
    assert troubles(watch, 61.0)[0].since == 60.0
    end = (
        "the mission cannot end: t1: for t1 the robots that are left lack b; bring r2 back",
        "r2 is unfit: it says so: it wants to move and has not for 5 s, or has heard nobody for "
        "6 s; free its way, or look at its radio",
    )
    watch.hear(message(Beat(Word(2, 2, 9, 0.0, 2, is_fit=False)), sender=2))
    assert told_by(watch, 9.0) == [("robot 2", end[1]), ("end", end[0])]
    watch.hear(message(Beat(word(2, LOST + 3, 9, 2)), sender=2))
    assert [key for key, _ in told_by(watch, 9.0)] == ["robot 2", "end"]
    assert told_by(watch, 9.0)[0][1].startswith("r2 is lost: it has left, or the others have not")
    watch.hear(message(Beat(word(2, LIFE, 9, 2), news=(1,)), sender=2))
    assert told_by(watch, 61.0) == []


def test_a_service_that_takes_ten_seconds_too_long_is_an_alert() -> None:
    """Robot 0 is at work on t0, which takes no time, since step 2, which ends at 4 s."""
    watch = Watch(DEADLINE)
    for version in range(1, 5):
        phase = SERVE if version > 2 else WALK
        watch.hear(message(Beat(Word(0, version, 3.0, 0.0, 0, 0, phase))))
        watch.step()
    assert told_by(watch, 14.0) == []
    [alert] = troubles(watch, 14.5)
    assert (alert.key, alert.what, alert.since) == ("task 0", "t0 takes too long", 14.0)
    assert alert.why == "robots are at work since 4 s, and it should take 0 s"
    assert alert.do == "look at r0, which head for it or are there"


def test_an_alert_holds_since_it_began_and_a_robot_that_is_back_until_it_is_seen() -> None:
    alerts = Alerts(["atlas", "bolt"])
    lost = Alert("robot 1", "bolt is lost", "why", "do")
    assert alerts.find([lost], 5.0) == ([lost._replace(since=5.0)], [])
    assert alerts.find([lost], 6.0) == ([], [])
    alerts.acknowledge("robot 1")
    alerts.acknowledge("nothing")
    assert alerts.acknowledged == {"robot 1"}
    new, past = alerts.find([], 9.0)
    assert [(it.key, it.what, it.since) for it in new] == [("back 1", "bolt is back", 9.0)]
    assert new[0].why == "it was not there, or not fit, for 4 s"
    assert [it.key for it in past] == ["robot 1"]
    assert alerts.find([], 10.0) == ([], [])
    assert (alerts.held, alerts.acknowledged) == (tuple(new), set())
    alerts.acknowledge("back 1")
    assert alerts.find([], 11.0) == ([], new)
    assert alerts.held == ()
    new, _ = alerts.find([lost, lost._replace(what="bolt not heard")], 12.0)
    assert [(it.what, it.since) for it in new] == [("bolt is lost", 12.0)]


def test_page_and_terminal_are_told_which_robots_are_not_heard(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nobody answers here, and only messages come that are none."""
    monkeypatch.setattr("teamformer.fleet.observer.silence.SILENCE", 0.0)
    said: list[str] = []
    sent_on: list[str] = []
    post = Post(FAST.number, FAST.robots)
    session = ObserverSession(
        *(Watch(FAST), Loopback(holders=0), post, tmp_path, said.append),
        on_alerts=lambda new, past: sent_on.extend(it.text() for it in new),
    )

    async def listen() -> dict[str, Any]:
        running, watcher = asyncio.create_task(session.run()), session.join()
        while not said:
            await asyncio.sleep(0.01)
        running.cancel()
        told = [json.loads(watcher.outbox.get_nowait()) for _ in range(watcher.outbox.qsize())]
        return next(message for message in reversed(told) if message["kind"] == "state")

    state = run_apart(listen())
    assert said[0].startswith("no robot heard: what came was refused: bad seal; what is drawn")
    [alert] = state["alerts"]
    assert f"{alert['what']}: {alert['why']}; {alert['do']}" == said[0] == sent_on[0]
    assert (alert["key"], state["is_heard"], state["is_playing"]) == ("all", False, False)
    assert (alert["since"], alert["is_acknowledged"]) == (None, False)
    assert session.watch.steps == []  # no time passes before anybody is heard


@pytest.mark.thorough
def test_ctrl_c_ends_who_watches_a_fleet_and_saves(tmp_path: Path) -> None:
    """Nobody answers; whoever started the tests may have Ctrl-C ignored, the child may not."""
    write_mission(MISSION.source, tmp_path / "small.yaml")
    (port, endpoint) = free_ports(2)
    command = [sys.executable, "-m", "teamformer.cli", "fleet", "watch"]
    command += [str(tmp_path / "small.yaml"), "--connect", f"tcp/127.0.0.1:{endpoint}"]
    command += ["--port", str(port)]
    with subprocess.Popen(
        [*command, "--out", str(tmp_path)],
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    ) as live:
        assert live.stderr is not None
        try:
            lines = [live.stderr.readline() for _ in range(2)]
            live.send_signal(signal.SIGINT)
            _, more = live.communicate(timeout=60)
        finally:
            live.kill()
    assert lines[1] == "Ctrl-C ends it and saves what was done\n"
    assert f"saved: {tmp_path / 'record.json'}\n" in more
    assert live.returncode == 0
    assert read_record(tmp_path / "record.json").method == FLEET


@pytest.mark.parametrize(("width", "height"), [(1400, 900), (820, 1180), (390, 844)])
@pytest.mark.thorough
def test_the_page_of_a_fleet_that_is_not_there_says_so(
    browser: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, width: int, height: int
) -> None:
    """Banner and panel count alike, the pill and the title say it, until it is acknowledged."""
    pytest.importorskip("uvicorn", reason="the extra `live` is not installed")
    monkeypatch.setattr("teamformer.fleet.observer.silence.SILENCE", 1.0)
    with serving_session(watching(Loopback(holders=0), tmp_path)) as server:
        opened = Opened(browser.new_page(viewport={"width": width, "height": height}))
        page = opened.page
        page.goto(f"http://{server.address}/")
        opened.wait_until(f"{TEXT}('#status') === 'No robot heard'", 20)
        seconds = f"Number({TEXT}('#notice')?.match(/^No robot heard for ([0-9]+) s$/)?.[1] ?? 0)"
        opened.wait_until(f"{seconds} > 0", 20)
        opened.wait_until(f"{seconds} > {page.evaluate(seconds)}", 20)
        assert page.is_visible("#notice")
        both = (
            "['#notice', '#alerts'].map((part) => document.querySelector(`${part} [data-begun]`))"
        )
        assert page.evaluate(f"new Set({both}.map((it) => it.dataset.begun)).size") == 1
        assert "Does the fleet run" in page.inner_text("#alerts")
        assert page.title() == "(1) small, live"
        for part in ("#play", "#speed", "#start"):
            assert page.is_hidden(part)
        assert page.evaluate("window.teamformer.last") == 0
        page.click("#alerts >> text=Acknowledge")
        opened.wait_until("document.title === 'small, live'")
        assert page.inner_text("#notice") == "All alerts are acknowledged."
        assert "Acknowledged" in page.inner_text("#alerts")
        page.close()


TEXT = "((part) => document.querySelector(part)?.textContent)"
