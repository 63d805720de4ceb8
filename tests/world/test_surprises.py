"""What is not known beforehand: when it shows, what is believed until then, who peeks (nobody)."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from coordinations import COORDINATIONS, RandomPlans, method_of
from random_worlds import random_decision, random_world, with_fractions, with_surprises
from small_worlds import make, play, robot, task
from teamformer.base.errors import RecordError
from teamformer.files.drawn.named_settings import world_of
from teamformer.methods.by_name import Method, load_method
from teamformer.mission.checks.rules import FORESIGHTS, LIKELY
from teamformer.mission.model import Absence, Breakdown, Mission
from teamformer.mission.parts.capabilities import describe
from teamformer.mission.truth import draw_truth, truth_until
from teamformer.record.export.csv_tables import write_tables
from teamformer.record.files.reading import read_record, record_from_tree
from teamformer.record.files.writing import record_to_tree, save_record
from teamformer.record.happenings import events
from teamformer.record.record import Record
from teamformer.record.referee import judge
from teamformer.record.task_times import lateness
from teamformer.trials.trial import decide, run_trial
from teamformer.world.env import Decision, TeamFormation
from teamformer.world.rules.constants import NOBODY
from teamformer.world.view import View
from twins import Twin

RULES = [
    (coordination, foresight)
    for coordination in COORDINATIONS
    for foresight in FORESIGHTS
    if coordination == "plan" or foresight != "scouting"  # elsewhere the same as needed
]


def with_truth(mission: Mission, **true: Any) -> Mission:
    """Return what a mission of one task really is."""
    certain = draw_truth(mission, 0)
    return replace(certain, tasks=(replace(certain.tasks[0], **true), *certain.tasks[1:]))


def test_a_service_is_expected_to_end_amid_what_is_left_of_it() -> None:
    """2 to 9 steps: 6 are expected, after 6 the mean of 7, 8, 9, after 8 the last."""
    mission = make([robot("a", 0)], [replace(task("a", 0), lasts=(2, 9))])
    env = TeamFormation([mission], truths=[with_truth(mission, duration=9)])
    rests = []
    for _ in range(10):
        play(env, 1)
        rests.append(int(env.view().rest[0]) if env.is_running[0] else 0)
    assert rests == [6, 5, 4, 3, 2, 1, 2, 1, 1, 0]
    assert env.tally().status == "completed"


def test_a_service_may_end_at_once() -> None:
    mission = make([robot("a", 0)], [replace(task("a", 0), lasts=(0, 9))])
    env = TeamFormation([mission], truths=[with_truth(mission, duration=0)])
    play(env, 1)
    assert env.tally().status == "completed"


@pytest.mark.parametrize(
    ("foresight", "chance", "believed"),
    [
        ("needed", 0.125, [1, 1, 0]),
        ("absent", 0.875, [1, 0, 0]),
        ("scouting", LIKELY, [1, 1, 0]),
        ("scouting", 0.125, [1, 0, 0]),
    ],
)
def test_needs_are_known_when_a_robot_stands_there(
    foresight: str, chance: float, believed: list[int]
) -> None:
    """a . T   where T needs a, c and may need b: nobody knows until a is there, in step 2."""
    work = replace(task("a", 2), may_need={"b": chance})
    robots = [robot("a", 0), robot("b", 9), robot("c", 19)]
    mission = make(robots, [work])
    truth = with_truth(mission, needs={"a": 1, "b": 1})
    env = TeamFormation([mission], truths=[truth], foresight=foresight)
    play(env, 1)
    assert env.view().task_needs[0, 0].tolist() == believed
    assert env.view().task_may_need[0, 0].tolist() == [0, chance, 0]
    play(env, 1)
    assert env.view().task_needs[0, 0].tolist() == [1, 1, 0]
    assert env.view().task_may_need[0, 0].tolist() == [0, 0, 0]
    assert env.worlds.tasks["shown_at"][0].tolist() == [2]


def test_what_turns_out_not_to_be_needed_is_done_at_once() -> None:
    work = replace(task("a", 2), may_need={"b": 0.25})
    mission = make([robot("a", 0), robot("b", 9)], [work])
    env = TeamFormation([mission], truths=[with_truth(mission, needs={"a": 1})])
    play(env, 2)
    assert env.tally().status == "completed"


def test_what_nobody_left_could_bring_is_not_hoped_for() -> None:
    """b is lost in step 1 and back in step 3: meanwhile what may need b is done without it."""
    work = replace(task("a", 9), may_need={"b": 0.5})
    away = replace(robot("b", 19), breaks=Breakdown(0.5, (2, 2)))
    mission = make([robot("a", 0), away], [work])
    truth = with_truth(mission, needs={"a": 1})
    truth = replace(
        truth, robots=(truth.robots[0], replace(truth.robots[1], absences=(Absence(1, 3),)))
    )
    env = TeamFormation([mission], truths=[truth])
    believed = []
    for _ in range(4):
        believed.append(env.worlds.needs[0, 0].tolist())
        play(env, 1)
    assert believed == [[1, 1, 0], [1, 0, 0], [1, 0, 0], [1, 1, 0]]


@pytest.mark.parametrize("is_plane", [False, True], ids=["grid", "plane"])
def test_step_with_surprises_is_what_the_plain_twin_does(is_plane: bool) -> None:
    rng = np.random.default_rng(50 + is_plane)
    shown = overdue = lost = found = 0
    for number in range(60):
        mission = random_world(rng, is_plane=is_plane)
        mission = with_fractions(mission, rng) if number % 3 == 2 else mission
        mission = with_surprises(mission, rng)
        foresight = str(rng.choice(FORESIGHTS))
        coordinator = RandomPlans(number) if number % 3 else None
        truth = draw_truth(mission, number)
        env = TeamFormation([mission], truths=[truth], coordinator=coordinator, foresight=foresight)
        twin = Twin(env)
        while env.is_running[0] and env.tally().steps < 40:
            view = env.view()
            twin.check_rests(view)
            decision = random_decision(view, rng)
            twin.step(view, decision)
        tasks = env.worlds.tasks[0]
        found += int((tasks["found_at"] != NOBODY).sum())
        shown += int((tasks["shown_at"] != NOBODY).sum())
        lost, overdue = lost + len(twin.world.lost_at), overdue + twin.overdue
    assert min(shown, overdue, lost, found) > 15


def play_views(
    mission: Mission, truth: Mission, method: str | Method, steps: int
) -> tuple[TeamFormation, list[tuple[View, Decision]]]:
    """Return what is seen and decided in the first steps."""
    method = load_method(method) if isinstance(method, str) else method
    if method.policy is not None:
        method.policy.begin(None, np.random.default_rng(0))
    env = TeamFormation(
        [mission],
        truths=[truth],
        coordinator=method.coordinator,
        foresight=method.foresight,
    )
    seen: list[tuple[View, Decision]] = []
    while env.is_running[0] and len(seen) < steps:
        view = View(*(part.copy() for part in env.view()))
        decision = decide(env, method, view)
        seen.append((view, Decision(decision.wanted.copy())))
        env.step(decision)
    return env, seen


def is_alike(one: tuple[View, Decision], other: tuple[View, Decision]) -> bool:
    same = all(np.array_equal(a, b) for a, b in zip(one[0], other[0], strict=True))
    return same and np.array_equal(one[1].wanted, other[1].wanted)


def other_truths(mission: Mission, truth: Mission, env: TeamFormation) -> list[Any]:
    """Return (another truth that differs in one thing, the step in which that shows)."""
    found = []
    tasks = env.worlds.tasks[0]
    for k, (known, true) in enumerate(zip(mission.tasks, truth.tasks, strict=True)):
        changes: list[tuple[dict[str, Any], int]] = []
        if known.lasts is not None and true.duration < known.lasts[1]:
            changes.append(({"duration": known.lasts[1]}, int(tasks["done_at"][k])))
        for cap, chance in known.may_need.items():
            if 0 < chance < 1:
                extra = true.needs.get(cap, 0) - known.needs.get(cap, 0)
                count = {cap: known.needs.get(cap, 0) + 1 - extra}
                needs = {c: n for c, n in ({**true.needs} | count).items() if n}
                changes.append(({"needs": needs}, int(tasks["shown_at"][k])))
        for change, step in changes:
            changed = (*truth.tasks[:k], replace(true, **change), *truth.tasks[k + 1 :])
            found.append((replace(truth, tasks=changed), step))
    for r, (known, real) in enumerate(zip(mission.robots, truth.robots, strict=True)):
        if known.breaks is not None:
            absences = () if real.absences else (Absence(17, 30),)
            changed = replace(real, absences=absences)
            robots = (*truth.robots[:r], changed, *truth.robots[r + 1 :])
            found.append((replace(truth, robots=robots), (absences or real.absences)[0].lost))
    return found


def check_nobody_peeks(setting: str, method: Method) -> None:
    mission = world_of(setting, 0)
    truth = draw_truth(mission, 5)
    env, now = play_views(mission, truth, method, 400)
    rng = np.random.default_rng(1)
    others = other_truths(mission, truth, env)
    shows = 0
    for number in rng.permutation(len(others))[:6]:
        other, step = others[number]
        if step == NOBODY:
            step = len(now)
        _, then = play_views(mission, other, method, step + 1)
        assert all(is_alike(now[i], then[i]) for i in range(min(step, len(now), len(then))))
        shows += step < min(len(now), len(then)) and not is_alike(now[step], then[step])
    assert shows >= 2


@pytest.mark.parametrize(("coordination", "foresight"), RULES)
@pytest.mark.thorough
def test_nobody_knows_the_truth_before_it_shows(coordination: str, foresight: str) -> None:
    check_nobody_peeks("4N20T-C4-mixed", method_of(coordination, foresight))


@pytest.mark.parametrize("method", ["heuristic", "teamformer"])
def test_no_policy_knows_the_truth_before_it_shows(method: str) -> None:
    check_nobody_peeks("4N20T-C4-mixed", load_method(method))


@pytest.mark.parametrize(("coordination", "foresight"), RULES)
@pytest.mark.thorough
def test_surprised_missions_end_and_are_legal(
    coordination: str, foresight: str, tmp_path: Path
) -> None:
    for seed in range(2):
        mission = world_of("4N20T-C4-mixed", seed)
        record = run_trial(mission, method_of(coordination, foresight), seed).record
        assert record.end.status == "completed"
        assert judge(record).findings == ()
        truth = draw_truth(mission, seed)
        assert record.truth == truth_until(mission, truth, record.end.steps + 1)
        assert record.truth != truth  # what breaks down later is not in the record
        save_record(record, tmp_path / "record.json")
        assert read_record(tmp_path / "record.json") == record


@pytest.mark.thorough
def test_random_surprised_missions_are_legal_under_every_rule() -> None:
    rng = np.random.default_rng(9)
    done = 0
    for number in range(40):
        mission = random_world(rng, is_plane=number % 4 == 0)
        mission = with_fractions(mission, rng) if number % 3 == 2 else mission
        mission = with_surprises(mission, rng)
        method = method_of(str(rng.choice(COORDINATIONS)), str(rng.choice(FORESIGHTS)))
        record = run_trial(mission, method, number).record
        assert judge(record).findings == ()
        assert record.end.status in ("completed", "infeasible")
        done += record.end.status == "completed"
    assert done > 25


def test_who_is_told_everything_plays_the_truth() -> None:
    mission = world_of("4N4T-C4-mixed", 0)
    trial = run_trial(mission, load_method("central"), seed=3)
    assert trial.record.mission == draw_truth(mission, 3)
    assert trial.record.truth is None


@pytest.mark.parametrize("name", ["join-all", "central"])
def test_what_takes_longer_than_its_window_is_late(name: str, tmp_path: Path) -> None:
    """a T   where T takes none to five steps and is to be done by step 4, with one step to it.

    Three steps are expected, for which there is time; a truth of five is as good as any other. The
    mission of a record of `central`, which is told the truth, holds nothing else.
    """
    mission = make([robot("a", 0)], [replace(task("a", 1), lasts=(0, 5), between=(0, 4))])
    drawn = set()
    for seed in range(30):
        record = run_trial(mission, load_method(name, time_limit=0.0), seed).record
        duration = int(record.true_mission.tasks[0].duration)
        drawn.add(duration)
        assert record.end.makespan == 1 + duration
        late = {"t0": 1 + duration - 4} if duration > 3 else {}
        assert lateness(record) == late
        save_record(record, tmp_path / "record.json")
        verdict = judge(read_record(tmp_path / "record.json"))
        assert (verdict.findings, verdict.late) == ((), late)
    assert drawn == set(range(6))


def test_a_repair_may_end_long_after_the_trial(tmp_path: Path) -> None:
    """Lost in step 1 for a billion steps, so back in one that no file may name."""
    lame = replace(robot("a", 0), breaks=Breakdown(1.0, (10**9, 10**9)))
    mission = make([lame], [task("a", 9)], step_limit=5)
    record = run_trial(mission, load_method("join-all"), 0).record
    assert record.true_mission.robots[0].absences == (Absence(1, 10**9 + 1),)
    assert (record.end.status, record.end.steps) == ("step limit", 5)  # it is due back
    save_record(record, tmp_path / "record.json")
    assert judge(read_record(tmp_path / "record.json")).findings == ()


def test_the_truth_of_a_thing_is_drawn_from_seed_and_number() -> None:
    mission = world_of("4N20T-C4-mixed", 0)
    shorter = replace(mission, tasks=mission.tasks[:7])
    assert draw_truth(shorter, 4).tasks == draw_truth(mission, 4).tasks[:7]
    assert draw_truth(shorter, 4).robots == draw_truth(mission, 4).robots
    assert draw_truth(mission, 4) != draw_truth(mission, 5)
    certain = world_of("4N20T-C4", 0)
    assert draw_truth(certain, 4) is certain


def test_truths_come_as_often_as_the_file_says() -> None:
    """A fifth needs b; each of 2, 3, 4 steps as often as any other; broken at 0.1 a step."""
    work = replace(task("a", 2), may_need={"b": 0.2}, lasts=(2, 4))
    lame = replace(robot("a", 0), breaks=Breakdown(0.1, (3, 5)))
    mission = make([lame, robot("b", 9)], [work])
    truths = [draw_truth(mission, seed) for seed in range(1500)]
    assert np.mean(["b" in t.tasks[0].needs for t in truths]) == pytest.approx(0.2, abs=0.04)
    durations = [t.tasks[0].duration for t in truths]
    shares = [durations.count(steps) / len(truths) for steps in (2, 3, 4)]
    assert shares == pytest.approx([1 / 3] * 3, abs=0.05)
    lost = np.array([t.robots[0].absences[0].lost for t in truths])
    assert lost.min() == 1
    assert lost.mean() == pytest.approx(10, abs=1)
    absences = [t.robots[0].absences[0] for t in truths]
    repairs = {away.back - away.lost for away in absences}  # type: ignore[operator]
    assert repairs == {3, 4, 5}
    again = [truth.robots[0].absences for truth in truths[:50]]
    gaps = [two.lost - (one.back or 0) for times in again for one, two in pairwise(times)]
    assert np.mean(gaps) == pytest.approx(10, abs=0.5)
    assert min(gaps) == 1
    assert all(0 < away.lost <= mission.step_limit for times in again for away in times)
    for_good = replace(mission, robots=(replace(lame, breaks=Breakdown(0.1)), *mission.robots[1:]))
    assert all(len(draw_truth(for_good, seed).robots[0].absences) <= 1 for seed in range(20))


def recorded() -> Record:
    """Return the record of a mission with every surprise."""
    return run_trial(world_of("4N20T-C4-mixed", 1), load_method("plan"), 2).record


def with_true_task(record: Record, number: int, **true: Any) -> Record:
    assert record.truth is not None
    tasks = list(record.truth.tasks)
    tasks[number] = replace(tasks[number], **true)
    return replace(record, truth=replace(record.truth, tasks=tuple(tasks)))


def with_step(record: Record, number: int, **said: Any) -> Record:
    steps = list(record.steps)
    steps[number] = replace(steps[number], **said)
    return replace(record, steps=tuple(steps))


def test_the_referee_finds_truths_that_cannot_be_and_what_is_shown_wrongly() -> None:
    record = recorded()
    assert judge(record).findings == ()
    tasks = record.mission.tasks
    unsure = next(k for k, task in enumerate(tasks) if task.lasts is not None)
    caps = set(record.mission.capabilities)
    hidden, other = next(
        (k, sorted(caps - set(task.worst_needs))[0])
        for k, task in enumerate(tasks)
        if task.may_need and caps - set(task.worst_needs)
    )
    sure = next(k for k, task in enumerate(tasks) if task.lasts is None and not task.may_need)
    shows = next(i for i, step in enumerate(record.steps) if step.shown)
    shown = record.steps[shows].shown
    forged = {
        "cannot really have been": [
            with_true_task(record, unsure, duration=11),
            with_true_task(record, sure, duration=3),
            with_true_task(record, hidden, needs={**tasks[hidden].needs, other: 1}),
            with_true_task(record, hidden, needs={other: 1}),
        ],
        "has not been at work on it for long enough": [with_true_task(record, unsure, duration=10)],
        "and the record does not say so": [with_step(record, shows, shown=shown[1:])],
        "but by the rules it is not so": [
            with_step(record, shows, shown=(*shown, sure)),
            with_step(record, shows - 1, shown=shown),
        ],
        "the rows of shown are not in order": [with_step(record, shows, shown=(*shown, *shown))],
        "there is no plan": [replace(record, plans=record.plans[:1])],
    }
    for words, records in forged.items():
        for forgery in records:
            found = [finding.message for finding in judge(forgery).findings]
            assert any(words in message for message in found), (words, found)


@pytest.mark.parametrize(
    ("damage", "words"),
    [
        (lambda truth: truth.pop("tasks"), "the key 'tasks' is missing"),
        (lambda truth: truth["tasks"].update(zz={}), "the key 'zz' means nothing"),
        (lambda truth: truth["robots"].clear(), "is missing"),
        (
            lambda truth: truth["tasks"].update(dict.fromkeys(truth["tasks"], 3)),
            "a mapping belongs",
        ),
        (
            lambda truth: truth["tasks"].update(
                {name: {"duration": -1} for name in truth["tasks"]}
            ),
            "truth",
        ),
    ],
)
@pytest.mark.thorough
def test_damaged_truths_are_refused(damage: Any, words: str) -> None:
    tree = json.loads(json.dumps(record_to_tree(recorded())))
    damage(tree["truth"])
    with pytest.raises(RecordError, match=words):
        record_from_tree(tree, "record")
    del tree["truth"]
    with pytest.raises(RecordError, match="truth"):
        record_from_tree(tree, "record")


def test_events_tell_what_turned_out(tmp_path: Path) -> None:
    record = recorded()
    told = [event for event in events(record) if event.kind == "needs"]
    assert [(e.at, e.task) for e in told] == [
        (number, task) for number, step in enumerate(record.steps, 1) for task in step.shown
    ]
    first = record.true_mission.tasks[told[0].task or 0]
    assert told[0].text(record.true_mission) == f"{first.name} needs {describe(first.needs)}"
    write_tables(record, tmp_path)
    with (tmp_path / "tasks.csv").open() as file:
        durations = {row["task"]: row["duration"] for row in csv.DictReader(file)}
    assert durations == {task.name: str(task.duration) for task in record.true_mission.tasks}


def test_pettingzoo_shows_beliefs_and_draws_the_truth_anew() -> None:
    parallel_env = pytest.importorskip("teamformer.world.multi_agent.parallel_env")
    env = parallel_env.TeamFormationParallel(world_of("4N4T-C4-mixed", 0))
    states = []
    for seed in (1, 1, 2, 3):
        observations, _ = env.reset(seed=seed)
        for observation in observations.values():
            assert env.observation_space("r1").contains(observation)
        states.append(env.state())
    assert np.array_equal(states[0], states[1])
    assert not all(np.array_equal(states[0], state) for state in states[2:])
    assert observations["r1"]["task_may_need"].max() == 0.5
    certain = parallel_env.TeamFormationParallel(world_of("4N4T-C4", 0))
    assert "task_may_need" not in certain.reset(seed=1)[0]["r1"]
