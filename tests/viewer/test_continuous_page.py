"""The page of a record in continuous time: its ticks, its words, its charts, and roads."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import pytest

import teamformer as tf
from browsers import Opened, Opener
from charging_missions import charged_mission
from hand_logs import RECORD
from teamformer.files.drawn.named_settings import world_of
from teamformer.record.events.standing import StandingAt
from teamformer.record.files.writing import record_to_tree
from teamformer.record.telling.whole import told_of
from teamformer.viewer.html import comparison_page
from teamformer.viewer.modules import joined
from test_forged_events import eventful
from test_telling_events import clinic


@pytest.fixture(scope="module")
def scripts(browser: Any) -> Iterator[Any]:
    page = browser.new_page()
    page.add_script_tag(content=joined("record/words"))
    yield page
    page.close()


READ = """(tree) => {
  const history = frames(tree);
  const tick = history.mission.world.stepSeconds;
  const steps = Array.from({ length: history.last + 1 }, (_, step) => step);
  const states = steps.map((step) => history.at(step));
  return {
    tick, last: history.last,
    places: states.map(({ x, y }) => [...x].map((value, robot) => [value, y[robot]])),
    teams: states.map(({ team }) => [...team]),
    tasks: steps.map((step) => sitesAt(history, step).map(({ at, isUp }) => (isUp ? null : at))),
    done: history.doneAt.map((at) => at * tick),
    events: history.events.filter(({ kind }) => kind !== "heads")
      .map((event) => [event.when * tick, describeEvent(history, event)]),
  };
}"""


def records() -> dict[str, Any]:
    played = {mission.name: tf.run(mission, "plan").record for mission in (eventful(), clinic())}
    return {"by hand": RECORD, **played}


def test_chargers_stand_where_robots_charge(scripts: Any) -> None:
    """In squares of the page, as the places of robots are."""
    mission = charged_mission(1, tasks=8)
    record = tf.run(mission).record
    tree = record_to_tree(record)
    shown = scripts.evaluate("(tree) => frames(tree).mission.chargers.map(({ at }) => at)", tree)
    robots = scripts.evaluate("(tree) => frames(tree).mission.robots.map(({ at }) => at)", tree)
    scale = robots[0][0] / mission.robots[0].at[0]
    placed = [tuple(scale * along for along in charger.at) for charger in mission.chargers]
    assert len(placed) >= 1
    assert [tuple(at) for at in shown] == [pytest.approx(at) for at in placed]


def test_zones_have_their_tasks_and_room(scripts: Any) -> None:
    mission = world_of("zones", 3)
    tree = record_to_tree(tf.run(mission).record)
    shown = scripts.evaluate("(tree) => frames(tree).mission.zones", tree)
    assert len(shown) == len(mission.zones) > 0
    for zone, it in zip(mission.zones, shown, strict=True):
        assert (it["name"], it["room"]) == (zone.name, zone.room)
        assert it["tasks"] == zone.tasks_in(mission.tasks)


def test_how_full_batteries_are_is_read_between_the_moments_that_are_told(scripts: Any) -> None:
    record = tf.run(charged_mission(1, tasks=8)).record
    levels = told_of(record).levels
    robot = next(robot for robot, row in enumerate(levels) if len(row) > 1)
    read = scripts.evaluate(
        """([tree, robot]) => {
          const history = frames(tree);
          const tick = history.mission.world.stepSeconds;
          const steps = Array.from({ length: history.last }, (_, step) => step + 0.5);
          return steps.map((step) => [step * tick, chargeAt(history, robot, step)]);
        }""",
        [record_to_tree(record), robot],
    )
    for when, full in read:
        begun, was, rate = [level for level in levels[robot] if level.begun <= when][-1]
        assert full == pytest.approx(min(1, max(0, was + rate * (when - begun))), abs=1e-6)
    others = [n for n, row in enumerate(levels) if not row]
    assert all(
        scripts.evaluate("([tree, n]) => chargeAt(frames(tree), n, 1)", [record_to_tree(record), n])
        is None
        for n in others
    )


@pytest.mark.parametrize("name", ["by hand", "beam and crate", "clinic"])
def test_at_every_tick_robots_are_where_the_record_has_them(scripts: Any, name: str) -> None:
    record = records()[name]
    read = scripts.evaluate(READ, record_to_tree(record))
    standing = StandingAt(record, told_of(record).layout)
    assert (read["last"] - 1) * read["tick"] < record.length <= read["last"] * read["tick"] + 1e-9
    for step, (places, teams) in enumerate(zip(read["places"], read["teams"], strict=True)):
        when = step * read["tick"]
        due = standing.places_at(when)
        assert places == [pytest.approx(place, abs=1e-6) for place in due], when
        if all(abs(event.at - when) > 1e-6 for event in record.events):
            assert teams == standing.teams_at(when), when
            where = standing.task_places_at(when)
            for at, place in zip(read["tasks"][step], where, strict=True):
                assert at is None or at == pytest.approx(place, abs=1e-6)


def test_what_happened_is_told_with_its_times(scripts: Any) -> None:
    read = scripts.evaluate(READ, record_to_tree(RECORD))
    assert read["tick"] == 0.05
    assert read["done"] == pytest.approx([10, 14.75])
    assert [text for _, text in read["events"]] == [
        "ann, bob form a team for beam",
        "team ann begins beam",
        "beam done by team ann",
        "ann begins crate",
        "ann has taken up crate",
        "crate done by ann",
        "completed, makespan 14.75",
    ]
    assert [when for when, _ in read["events"]] == pytest.approx(
        [8, 8.5, 10, 11, 11.25, 14.75, 14.75]
    )


def test_the_clock_goes_in_units_of_time(open_page: Opener) -> None:
    opened = open_page(record_to_tree(RECORD), "#time=9&robot=ann")
    assert opened.page.inner_text("#counter") == "Time 9 of 14.75"
    assert "does beam, 0.5 of 1.5 made" in opened.page.inner_text("#details").lower()
    assert opened.page.inner_text("#figures").split("\n")[:4] == [
        *("Tasks done", "0 of 2", "Makespan", "14.75 1.02 x the bound"),
    ]
    rates = opened.page.eval_on_selector_all("#speed option", "all => all.map((it) => it.text)")
    assert rates[-1] == "10 units/s"
    assert "1 units/s" in rates
    opened.page.click("#view-gantt")
    bars = opened.page.evaluate("window.teamformer.bars(0).bars")
    assert [bar["phase"] for bar in bars][:4] == ["walking", "waiting", "forming", "serving"]
    assert bars[3]["to"] * 0.05 == pytest.approx(10)
    opened.page.wait_for_function("location.hash.includes('time=9')")
    assert opened.errors == []


@pytest.mark.parametrize("size", [(1280, 800), (820, 900), (390, 780)])
def test_roads_are_drawn_at_every_size(open_page: Opener, size: tuple[int, int]) -> None:
    record = tf.run(clinic(), "plan").record
    opened = open_page(record_to_tree(record), "#time=4")
    opened.page.set_viewport_size({"width": size[0], "height": size[1]})
    opened.page.wait_for_timeout(200)
    layout = told_of(record).layout
    assert layout is not None
    named = {it["text"] for it in opened.page.evaluate("window.teamformer.names()")}
    assert named & set(layout.names)
    assert not names_over_tasks(opened, set(layout.names), len(record.mission.tasks))
    for view in ("gantt", "tasks", "robots", "plots", "map"):
        opened.page.click(f"#view-{view}")
        opened.page.wait_for_timeout(60)
    assert opened.errors == []


def test_a_large_plane_is_all_there_on_a_phone(open_page: Opener) -> None:
    """A pixel and a half for each square of 0.2 m would be wider than the screen."""
    mission = tf.Mission(
        "yard",
        tf.Plane(60, 40),
        ("a",),
        (tf.Robot("r", (0.0, 0.0), {"a": 1}),),
        (tf.Task("low", (60.0, 0.0), {"a": 1}), tf.Task("high", (0.0, 40.0), {"a": 1})),
        time="continuous",
    )
    opened = open_page(record_to_tree(tf.run(mission, "soonest").record))
    opened.page.set_viewport_size({"width": 390, "height": 780})
    opened.page.wait_for_timeout(200)
    for _ in range(2):
        low, high = (opened.page.evaluate(f"window.teamformer.taskBox({n})") for n in (0, 1))
        sides = opened.page.eval_on_selector("canvas", "it => [it.clientWidth, it.clientHeight]")
        assert low["x"] + low["half"] <= sides[0]
        assert low["y"] + low["half"] <= sides[1]
        assert min(high["x"] - high["half"], high["y"] - high["half"]) >= 0
        opened.page.keyboard.press("-")  # what is shown is not drawn larger by that
    assert opened.errors == []


def names_over_tasks(opened: Opened, places: set[str], tasks: int) -> list[str]:
    """Return the names of places that lie over the square of a task."""
    names = opened.page.evaluate("window.teamformer.names()")
    boxes = [opened.page.evaluate(f"window.teamformer.taskBox({task})") for task in range(tasks)]
    return [
        name["text"]
        for name in names
        for box in boxes
        if name["text"] in places
        and abs(name["x"] - box["x"]) < name["half"] - 2 + box["half"]
        and abs(name["y"] - box["y"]) < box["half"] + 6
    ]


def test_a_robot_that_walks_home_walks_to_no_task(open_page: Opener) -> None:
    record = tf.run(replace(clinic(), ends="home"), "plan").record
    end = record.end.makespan
    assert end is not None
    opened = open_page(record_to_tree(record), f"#time={end - 0.1}&view=robots")
    doing = {row["Doing"] for row in opened.page.evaluate("window.teamformer.tables().robots")}
    assert "walks to where it stops" in doing
    assert "walks to " not in doing


def test_without_what_is_told_roads_lie_in_a_circle(scripts: Any) -> None:
    tree = copy.deepcopy(record_to_tree(tf.run(clinic(), "plan").record))
    del tree["told"]
    places = scripts.evaluate("(tree) => frames(tree).mission.world.roads.places", tree)
    assert len({tuple(place) for place in places}) == 4


def test_records_side_by_side_share_a_clock(open_page: Opener) -> None:
    trees = [record_to_tree(RECORD), record_to_tree(tf.run(RECORD.mission, "plan").record)]
    opened = open_page(trees, "#time=5", written=comparison_page)
    assert opened.page.inner_text("#counter").startswith("Time 5 of ")
    assert opened.errors == []
