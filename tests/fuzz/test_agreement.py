"""Page, record, tables, MCAP, GIF and terminal agree on who did what and when."""

from __future__ import annotations

import asyncio
import json
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import redirect_stdout
from dataclasses import dataclass, replace
from io import StringIO
from pathlib import Path
from queue import Queue
from typing import Any

import numpy as np
import pytest
from hypothesis import strategies as st

from browsers import Opened
from fleets import Watched
from live_server import serving
from methods import METHODS
from missions import SEEDS, continuous_missions, missions
from schedules import schedules
from small_worlds import make, robot
from small_worlds import task as task_at
from teamformer.cli.terminal.console import out
from teamformer.files.drawn.generate import Spec, generate
from teamformer.files.drawn.named_settings import world_of
from teamformer.files.mission_files import mission_from_tree, write_mission
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.rehearsal.checking.trace import Trace
from teamformer.fleet.rehearsal.faults import Crash, Faults
from teamformer.fleet.rehearsal.records.of_rehearsal import record_of
from teamformer.fleet.rehearsal.rehearse import play, set_stage
from teamformer.live.running.incidents import LostRobot
from teamformer.mission.model import Mission
from teamformer.mission.parts.grid import Grid
from teamformer.record.files.writing import save_record
from teamformer.viewer.modules import joined
from test_verbs import typed
from texts import text_of
from told import (
    TOLD_BY_PAGE,
    Bar,
    Line,
    bars_of,
    captions_agree,
    embedded,
    end_of,
    harmless,
    in_tables,
    lines_of_plan,
    logged,
    losses_of,
    needs_in,
    needs_told_by_record,
    sentence,
    sorted_needs,
    table_of,
    told_by_events,
    told_by_mcap,
    told_by_record,
    told_by_tables,
    told_by_terminal,
)
from watching import fuzzed, noted

DONE, NOT_DONE = 0, 1


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("agreement")


@pytest.fixture(scope="module")
def page(browser: Any) -> Any:
    """An empty page with the scripts that read a record."""
    page = browser.new_page()
    page.add_script_tag(content=joined("look", "record/story"))
    return page


@dataclass(frozen=True)
class Outputs:
    """What there is of a mission in a folder; `terminal` is what `run` printed, if it ran."""

    folder: Path
    terminal: str = ""
    with_gif: bool = True


def assert_all_agree(page: Any, outputs: Outputs) -> list[Line]:
    """Write every output of the record in a folder, and compare what they tell; return that."""
    folder, record = outputs.folder, outputs.folder / "record.json"
    files = [folder, folder / "record.mcap"]
    files += [folder / "record.gif"] if outputs.with_gif else []
    assert typed("export", record, *files) == DONE
    assert typed("view", record, folder / "record.html") == DONE
    tree = json.loads(record.read_text(encoding="utf-8"))
    lines = told_by_record(tree)
    steps, ended = len(tree["steps"]), (tree["end"]["status"], tree["end"]["makespan"])

    assert told_by_events(folder) == in_tables(lines)
    assert told_by_tables(folder, steps) == in_tables(lines)
    assert end_of(folder) == ended[0]
    _compare_page(page, tree, lines, folder)
    _compare_mcap(tree, lines, folder)
    if outputs.with_gif:
        assert captions_agree(folder / "record.gif", tree, lines)
    if outputs.terminal:
        _compare_terminal(tree, lines, outputs.terminal)
    return lines


def _compare_page(page: Any, tree: Any, lines: list[Line], folder: Path) -> None:
    held = embedded(folder / "record.html")
    assert held == tree
    told = page.evaluate(TOLD_BY_PAGE, held)
    done = [line for line in lines if line.kind == "done"]
    assert sorted(Line(*line) for line in told["lines"]) == lines
    assert told["end"] == [tree["end"]["status"], tree["end"]["makespan"], len(done)]
    bars = bars_of(folder)
    assert sorted(Bar(*map(_in_table, bar)) for bar in told["bars"]) == sorted(bars)
    assert told["marks"] == told["stories"]  # what is marked on a robot's row, and its history
    assert Counter(text.split(" done by ")[0] for text in told["said"]) == Counter(
        line.task for line in done
    )
    _compare_tables_in_page(told, done, bars_of(folder))
    needs = sorted_needs(needs_told_by_record(tree))
    assert sorted_needs(dict(told["needs"])) == sorted_needs(needs_in(folder)) == needs


def _compare_tables_in_page(told: Any, done: list[Line], bars: list[Bar]) -> None:
    """Compare the page's tables, halfway, and its plots with who did what, and who was idle."""
    half, ends = told["halfway"]["step"], {line.task: line.step for line in done}
    assert told["halfway"]["tasks"] == [
        [name, ends.get(name, 0), ends.get(name, half + 1) <= half]
        for name, _, _ in told["halfway"]["tasks"]
    ]
    idle = [bar for bar in bars if bar.phase == "idle"]
    spent = Counter[str]()
    for bar in idle:
        spent[bar.robot] += max(0, min(bar.ended, half) - min(bar.begun, half))
    assert {_in_table(name): steps for name, steps in told["halfway"]["idle"]} == {
        _in_table(name): spent[_in_table(name)] for name, _ in told["halfway"]["idle"]
    }
    assert sum(told["curves"]["idle"]) == sum(bar.ended - bar.begun for bar in idle)
    left = len(told["halfway"]["tasks"]) - len(done)
    assert told["curves"]["open"][-1] <= left  # the others are still to come
    assert told["curves"]["way"] == sorted(told["curves"]["way"])


def _in_table(value: Any) -> Any:
    return harmless(value) if isinstance(value, str) else value


def _compare_mcap(tree: Any, lines: list[Line], folder: Path) -> None:
    plane = tree["mission"]["world"]
    length = plane.get("step", 1) if "plane" in plane else 1
    seen = told_by_mcap(folder / "record.mcap")
    told = Counter((round(line.step * length * 1e9), sentence(line)) for line in lines)
    assert told <= seen.log
    assert Counter((at, harmless(text)) for at, text in seen.log.elements()) == logged(folder)
    names, lost = {robot["name"] for robot in tree["mission"]["robots"]}, set[str]()
    for step in range(len(tree["steps"]) + 1):
        lost |= {it.robots for it in lines if (it.step, it.kind) == (step, "lost")}
        lost -= {it.robots for it in lines if (it.step, it.kind) == (step, "back")}
        assert seen.there[round(step * length * 1e9)] == names - lost
    assert sorted_needs(seen.needs).items() <= sorted_needs(needs_in(folder)).items()


def _compare_terminal(tree: Any, lines: list[Line], text: str) -> None:
    table, verdict, lost = told_by_terminal(text)
    if table:  # of more than forty tasks there is none
        assert sorted(table) == table_of(lines, needs_told_by_record(tree))
    assert lost == losses_of(tree)
    end, is_called_off = tree["end"], any(line.kind == "cancelled" for line in lines)
    done = "all done or called off" if is_called_off else "all done"
    done += " or missed" if end.get("missed") else ""
    assert {
        "too late": f"too late at step {end['steps']}",
        "completed": f"{done} after {end['makespan']} steps",
        "infeasible": f"given up at step {end['steps']}",
        "step limit": f"not done within the limit of {end['steps']} steps",
    }[end["status"]] in verdict


def outputs_of_run(file: Path, folder: Path, method: str, seed: int, with_gif: bool) -> Outputs:
    """Run a mission as a person does; return what came of it."""
    with out.capture() as printed:
        status = typed("run", file, "--method", method, "--seed", seed, "--out", folder)
    assert status in (DONE, NOT_DONE)
    return Outputs(folder, printed.get(), with_gif)


@fuzzed(
    24,
    "run FILE --method {method} --seed {seed} --html --out O, and export every kind",
    mission=missions(),
    method=METHODS,
    seed=SEEDS,
)
def test_outputs_of_simulated_missions_agree(
    mission: Any, method: str, seed: int, folder: Path, page: Any
) -> None:
    file = folder / "mission.yaml"
    file.write_text(text_of(mission), encoding="utf-8")
    assert_all_agree(page, outputs_of_run(file, folder, method, seed, with_gif=seed % 4 == 0))


@pytest.mark.parametrize(
    ("setting", "method"),
    [("warehouse-lost", "plan"), ("moving-arrivals", "crews"), ("real-all", "heuristic")],
)
def test_outputs_of_missions_that_people_have_agree(
    setting: str, method: str, tmp_path: Path, page: Any
) -> None:
    write_mission(world_of(setting, 1), tmp_path / "mission.yaml")
    with_gif = setting == "warehouse-lost"  # the others are long
    outputs = outputs_of_run(tmp_path / "mission.yaml", tmp_path, method, 0, with_gif)
    lines = assert_all_agree(page, outputs)
    assert len([line for line in lines if line.kind == "done"]) >= 14
    assert {line.kind for line in lines} > {"done"}


@fuzzed(
    7,
    "fleet rehearse FILE, with the faults below",
    mission=missions(is_for_fleets=True),
    data=st.data(),
)
def test_outputs_of_rehearsals_agree(
    mission: Any, data: st.DataObject, folder: Path, page: Any
) -> None:
    """And with what the bodies of the robots really did."""
    source = mission_from_tree(mission)
    fleet = FleetMission(source, source.seconds_a_step)
    stage = set_stage(fleet)
    noted["faults"] = faults = data.draw(schedules(fleet))
    trace = Trace(with_messages=True)
    rehearsal, outcome, _ = play(fleet, stage.plan, faults, trace)
    record = record_of(rehearsal, outcome, trace.events, faults.seed)
    save_record(record, folder / "record.json")
    assert typed("check", folder / "record.json") == DONE
    lines = assert_all_agree(page, Outputs(folder, with_gif=False))
    names = [robot.name for robot in record.mission.robots]
    really = sorted(
        (rehearsal.world.tasks[key].name, tuple(names[robot] for robot in done.robots))
        for key, done in rehearsal.world.done.items()
    )
    told = sorted((line.task, line.robots) for line in lines if line.kind == "done")
    assert told == [(task, ", ".join(who)) for task, who in really]


def test_outputs_of_a_load_that_a_part_of_its_team_takes_further_agree(
    tmp_path: Path, page: Any
) -> None:
    """Robot 0 crashes while the three carry a load; it takes only two."""
    robots = [robot("a", 0) for _ in range(3)]
    load = replace(task_at("aa", 4), to=(0, 0))
    mission = make(robots, [task_at("aaa", 0), load])
    bars = _bars_of_rehearsal(page, tmp_path, mission, Crash(0, 8.0, 9.0))
    told = {bar.robot: bar.phase for bar in bars if bar.begun == 9}
    assert told == {"r0": "walking", "r1": "carrying", "r2": "carrying"}


def test_outputs_of_a_load_that_is_left_for_another_beside_it_agree(
    tmp_path: Path, page: Any
) -> None:
    """The robot comes for load t0, and takes up t1, which takes no time, when it is back there."""
    loads = (
        replace(task_at("a", 0, duration=1, appears=1), to=(0, 0)),
        replace(task_at("a", 0), to=(2, 0)),
    )
    bars = _bars_of_rehearsal(page, tmp_path, make([robot("a", 2)], loads), Crash(0, 3.0, 4.0))
    assert [(bar.phase, bar.task, bar.ended) for bar in bars[2:4]] == [
        ("waiting", "t1", 5),
        ("carrying", "t1", 7),
    ]


def test_outputs_of_a_load_that_is_brought_in_the_step_in_which_it_is_taken_up_agree(
    tmp_path: Path, page: Any
) -> None:
    """Robot 0 crashes as it loads, and is not where that is once robot 1 has brought it on."""
    robots = [robot("a", 6), robot("a", 0, speed=2.0)]
    tasks = [replace(task_at("a", 6, duration=1), to=(7, 0)), task_at("a", 19)]
    bars = _bars_of_rehearsal(page, tmp_path, make(robots, tasks), Crash(0, 0.5, 40.0))
    assert Bar("r0", "waiting", "t0", 0, 19) in bars
    assert Bar("r1", "loading", "t0", 18, 19) in bars
    assert max(bar.ended for bar in bars) == 19  # with the last task, not with the rehearsal


def test_outputs_of_a_load_that_is_called_off_on_its_way_agree(tmp_path: Path, page: Any) -> None:
    """One robot carries it, another has come to where it is brought to, and waits there."""
    load = replace(task_at("a", 1), to=(4, 0), cancelled=5, after=("t0",))
    robots = [robot("a", 4), robot("a", 0), robot("a", 0)]
    mission = make(robots, [task_at("a", 0), load, task_at("a", 0)], Grid(5, 1))
    write_mission(mission, tmp_path / "mission.yaml")
    assert_all_agree(
        page, outputs_of_run(tmp_path / "mission.yaml", tmp_path, "join-all", 0, with_gif=False)
    )
    last = {bar.robot: bar.phase for bar in bars_of(tmp_path) if bar.ended == 5}
    assert last == {"r0": "waiting", "r1": "carrying", "r2": "walking"}


def _bars_of_rehearsal(page: Any, folder: Path, mission: Mission, crash: Crash) -> list[Bar]:
    """Rehearse a mission in which a robot crashes; compare all outputs, and return its bars."""
    fleet, trace = FleetMission(mission), Trace(with_messages=True)
    rehearsal, outcome, _ = play(fleet, set_stage(fleet).plan, Faults(crashes=(crash,)), trace)
    save_record(record_of(rehearsal, outcome, trace.events, 0), folder / "record.json")
    assert_all_agree(page, Outputs(folder, with_gif=False))
    return bars_of(folder)


@pytest.mark.parametrize("since", [0.0, 2.0, 5.0])
def test_outputs_of_a_fleet_that_carries_watched_from_the_middle_agree(
    tmp_path: Path, page: Any, since: float
) -> None:
    """Two carry t0 from 3 to 9, from second 3 on, which takes six."""
    robots = [robot("a", 3), robot("a", 3), robot("a", 17)]
    load = replace(task_at("aa", 3, duration=2), to=(9, 0), unload=1)
    mission = make(robots, [load, task_at("a", 12), task_at("aa", 15)])
    rehearsal = Watched(FleetMission(mission), since)
    rehearsal.run(300.0)
    for _ in range(4):
        rehearsal.watch.step()
    save_record(rehearsal.watch.record(), tmp_path / "record.json")
    lines = assert_all_agree(page, Outputs(tmp_path, with_gif=False))
    done = {line.task: line.robots for line in lines if line.kind == "done"}
    names = [one.name for one in mission.robots]
    assert done == {
        rehearsal.world.tasks[key].name: ", ".join(names[it] for it in deed.robots)
        for key, deed in rehearsal.world.done.items()
    }
    bars = [bar for bar in bars_of(tmp_path) if bar.phase == "carrying"]
    assert {(bar.robot, bar.task) for bar in bars} == {("r0", "t0"), ("r1", "t0")}
    assert typed("check", tmp_path / "record.json") == DONE


@fuzzed(6, "plan FILE --method plan --out FOLDER, and with --json", mission=continuous_missions())
def test_outputs_of_continuous_plans_agree(mission: Any, folder: Path) -> None:
    file, words = folder / "mission.yaml", ("--method", "plan", "--time-limit", 5)
    file.write_text(text_of(mission), encoding="utf-8")
    with out.capture() as printed:
        status = typed("plan", file, *words, "--out", folder)
    if status == 2:  # its starts are linked: that only `central` plans
        return
    with redirect_stdout(StringIO()) as text:
        assert typed("plan", file, *words, "--json") == status == DONE
    row = json.loads(text.getvalue())
    shown = [" ".join(line.split()) for line in printed.get().splitlines()]
    assert shown[0].startswith(" ".join(f"{row['mission']}: over at {row['makespan']:g}".split()))
    ends_home = mission.get("ends") is not None
    begin = shown.index(f"robot tasks: start to end{' back' if ends_home else ''}") + 1
    assert shown[begin : begin + len(row["routes"])] == lines_of_plan(row, ends_home)
    assert typed("check", folder / "record.json") == DONE
    tree = json.loads((folder / "record.json").read_text(encoding="utf-8"))
    assert (round(tree["end"]["makespan"], 6), tree["method"]) == (row["makespan"], "plan")


FEW, MANY = range(3), range(3, 20)
"""Live sessions that are tried every day, and the others."""


@pytest.mark.parametrize(
    "number", [*FEW, *(pytest.param(number, marks=pytest.mark.slow) for number in MANY)]
)
def test_outputs_of_live_sessions_agree(
    number: int, browser: Any, page: Any, tmp_path: Path
) -> None:
    """And with what the page of the mission shows that has been open all the time."""
    pytest.importorskip("uvicorn", reason="the extra `live` is not installed")
    from websockets.sync.client import connect

    rng = np.random.default_rng(number)
    grid = Grid(9, 7)
    mission = generate(Spec(5, 7, 3, requirements=2, world=grid), rng)
    method = ("plan", "join-fitting", "crews")[number % 3]
    with serving(mission, tmp_path, speed=200.0, method=method) as server:
        watching = Opened(browser.new_page())
        watching.page.goto(f"http://{server.address}/")
        watching.wait_until("window.teamformer !== undefined")
        uri = f"ws://{server.address}/socket"
        with connect(uri, origin=f"http://{server.address}") as line:  # type: ignore[arg-type]
            for message in _script(rng, mission):
                if message["do"] in ("step", "play") and not server.session.mission.is_running:
                    continue
                line.send(json.dumps(message))
                _wait_for_answer(line, message["do"])
                if message["do"] in ("happen", "undo", "step"):
                    _compare_page_of_the_moment(watching, server.session.mission)
        watching.wait_until("document.querySelector('#status').textContent !== 'Running'")
        watching.wait_until(f"window.teamformer.last === {server.session.mission.steps}")
        shown = sorted(Line(*told) for told in watching.page.evaluate("window.teamformer.told()"))
        incidents = [it for _, it in server.session.mission.incidents]
        told_of = server.session._state()["incidents"]
        watching.page.close()
    lines = assert_all_agree(page, Outputs(tmp_path, with_gif=False))
    assert shown == lines
    lost = Counter(line.kind for line in lines)["lost"]
    assert lost == sum(isinstance(it, LostRobot) for it in incidents)
    assert len(incidents) >= 2
    losses = {(step, f"robot {robots} {kind}") for step, kind, robots, _ in lines}
    assert {(step, text) for step, text in told_of if text.startswith("robot")} <= losses


def _compare_page_of_the_moment(watching: Opened, mission: Any) -> None:
    """Compare tables, map and header with who is there, also before the step after an incident."""
    texts = [it.text(mission.source) for _, it in mission.incidents]
    watching.wait_until(f"window.teamformer.last === {mission.steps}")
    watching.wait_until(f"window.teamformer.incidents().length === {len(texts)}")
    watching.wait_until("window.teamformer.step === window.teamformer.last")
    steps = mission.steps
    lost = {
        robot.name
        for robot in mission.source.robots
        if any(
            away.lost <= steps + 1 and (away.back is None or away.back > steps)
            for away in robot.absences
        )
    }
    robots = [robot.name for robot in mission.source.robots]
    tables = watching.page.evaluate("window.teamformer.tables()")
    assert {row["Robot"] for row in tables["robots"] if row["Doing"] == "lost"} == lost
    assert {row["Next"] for row in tables["robots"] if row["Robot"] in lost} <= {"-"}
    heading = {row["Task"]: row["Who"] for row in tables["tasks"] if row["State"] != "done"}
    assert not any(lost & set(who.split(", ")) for who in heading.values())
    there = watching.page.evaluate("window.teamformer.teams().flatMap(({ robots }) => robots)")
    assert {robots[robot] for robot in there} == set(robots) - lost
    goals = watching.page.evaluate("window.teamformer.teams()")
    pursued = {mission.source.tasks[it["task"]].name for it in goals if it["task"] is not None}
    about = {row["Task"] for row in tables["tasks"] if row["State"] in ("on the way", "waiting")}
    assert about <= pursued
    done = mission.ends()
    cancelled = {
        task.name
        for number, task in enumerate(mission.source.tasks)
        if task.cancelled is not None and task.cancelled <= steps and number not in done
    }
    assert {row["Task"] for row in tables["tasks"] if row["State"] == "called off"} == cancelled
    watching.shown_step()
    watching.wait_for_a_frame()
    told = watching.page.inner_text("#figures").split("\n")
    assert ("Lost" in told) == bool(lost)


def _script(rng: np.random.Generator, mission: Mission) -> Iterator[dict[str, Any]]:
    """Return what a page asks for, and in the end to play on.

    Steps, tasks, a robot lost and back, a task called off; to undo some of it, at once or steps
    later, and to restart.
    """
    lost = str(rng.choice([robot.name for robot in mission.robots]))
    grid = mission.world
    deeds = ("task", "restart", "task", "lost", "undo", "lost", "task", "undo", "back", "cancelled")
    for what in (*deeds, "task"):
        for _ in range(int(rng.integers(0 if what == "undo" else 1, 4))):
            yield {"do": "step"}
        if what in ("undo", "restart"):
            yield {"do": what}
            continue
        if what == "task":
            at = [int(rng.integers(grid.width)), int(rng.integers(grid.height))]
            yield {"do": "happen", "task": {"at": at, "needs": {f"c{rng.integers(1, 4)}": 1}}}
        elif what == "cancelled":
            yield {"do": "happen", what: mission.tasks[-1].name}
        else:
            yield {"do": "happen", what: lost}
    yield {"do": "play"}
    yield {"do": "save"}


def _wait_for_answer(line: Any, asked: str) -> None:
    """Wait until the server has done what it was asked for, or has refused."""
    kinds = {"step": "step", "happen": "incident", "play": "step", "save": "saved"}
    kinds |= {"undo": "mission", "restart": "mission"}
    while True:
        heard = json.loads(line.recv(timeout=30))
        if heard["kind"] == "refused":
            return
        if heard["kind"] == kinds[asked] and (asked != "play" or "end" in heard):
            return


@pytest.mark.slow
@pytest.mark.parametrize("number", range(5))
def test_outputs_of_fleets_agree(number: int, page: Any, tmp_path: Path) -> None:
    """What an onlooker heard of processes, and what the fleet itself told of who did what."""
    pytest.importorskip("zenoh", reason="the extra `fleet` is not installed")
    from teamformer.fleet.messages import OPERATOR, Post
    from teamformer.fleet.observer.session import ObserverSession
    from teamformer.fleet.observer.watch import Watch
    from teamformer.fleet.process.fleet import LocalFleet
    from teamformer.fleet.transports.zenoh_mesh import ZenohTransport

    spec = Spec(3, 5, 2, requirements=2, world=Grid(7, 7))
    mission = generate(spec, np.random.default_rng(number))
    fleet = FleetMission(mission, mission.seconds_a_step)
    told: Queue[str] = Queue()
    local = LocalFleet(fleet, told.put)
    with ThreadPoolExecutor(2) as threads:
        result = threads.submit(local.run, 240.0)
        lines_told = iter(lambda: told.get(timeout=60), None)
        endpoint = next(line for line in lines_told if line.startswith("world at ")).split()[-1]
        transport = ZenohTransport(fleet.number, OPERATOR, None, [endpoint])
        session = ObserverSession(
            Watch(fleet), transport, Post(fleet.number, fleet.robots), tmp_path
        )
        try:
            threads.submit(asyncio.run, _watch_to_the_end(session, result)).result(240)
        finally:
            session.close()
    assert result.result().completed
    session.save()
    lines = assert_all_agree(page, Outputs(tmp_path, with_gif=False))
    names = [robot.name for robot in mission.robots]
    really = {
        result.result().names[done.key]: ", ".join(names[robot] for robot in sorted(done.robots))
        for done in result.result().done
    }
    seen = {line.task: line.robots for line in lines if line.kind == "done"}
    ends = {result.result().names[done.key]: done.at / fleet.step for done in result.result().done}
    assert seen == {task: who for task, who in really.items() if task in seen}
    for task in really.keys() - seen.keys():  # done before its doers were heard for the first time
        doers = set(really[task].split(", "))
        of_the_same = [other for other in seen if doers & set(really[other].split(", "))]
        assert all(ends[task] < ends[other] for other in of_the_same)
    said = [text.split(" s: ")[1] for text in list(told.queue) if " done by " in text]
    assert Counter(said) == Counter(f"{task} done by {who}" for task, who in really.items())
    late = [line.step - ends[line.task] for line in lines if line.kind == "done"]
    assert max(late) - min(late) <= 2  # its clock is another; words take their time


async def _watch_to_the_end(session: Any, result: Any) -> None:
    from teamformer.fleet.observer.at_work import STAYS

    running = asyncio.create_task(session.run())
    while not result.done() and not session.watch.is_over:
        await asyncio.sleep(0.05)
    for _ in range(2 * STAYS):  # by then it has told of what was done last, whoever did it
        await asyncio.sleep(session.watch.mission.step)
        if session.watch.is_over:
            break
    running.cancel()
