"""The page's reading and packing, run in a browser and held against plain Python."""

from __future__ import annotations

import itertools
import math
import random
from collections.abc import Iterator
from typing import Any

import pytest
from toy_records import Tree, random_mission, small_mission, toy_record, toy_states

from teamformer.mission.checks.rules import LIKELY
from teamformer.viewer.modules import joined


@pytest.fixture(scope="module")
def scripts(browser: Any) -> Iterator[Any]:
    """An empty page with the scripts that draw nothing."""
    page = browser.new_page()
    page.add_script_tag(content=joined("record/words", "record/ways", "draw/packing"))
    yield page
    page.close()


STATES = """(tree) => {
  const history = frames(tree);
  const list = ({teams, state}) => [...teams.values()].map(
    ({slot, robots, x, y}) => [slot, robots, x, y, state.task[slot] < 0 ? null : state.task[slot]]);
  return tree.asked.map((step) => list(sceneAt(history, step)));
}"""


@pytest.mark.parametrize(
    "mission",
    [small_mission(), random_mission(30, 10, 6, 14, 4), random_mission(100, 12, 100, 20, 30)],
    ids=["walls, lost, late", "30 robots", "100 robots"],
)
def test_every_moment_is_rebuilt_in_any_order(scripts: Any, mission: Tree) -> None:
    tree = toy_record(mission)
    states = toy_states(mission, len(tree["steps"]))
    asked = [*range(len(states)), *random.Random(1).choices(range(len(states)), k=200)]
    shown = scripts.evaluate(STATES, {**tree, "asked": asked})
    for step, teams in zip(asked, shown, strict=True):
        assert {slot: tuple(rest) for slot, *rest in teams} == states[step]


def test_a_team_that_loses_its_lowest_robot_is_known_by_the_next(scripts: Any) -> None:
    tree = two_robots([{"joins": [[1, 0]]}, {"lost": [0], "teams": [[1, 3, 3, 0]]}])
    assert scripts.evaluate(STATES, {**tree, "asked": [1, 2]}) == [
        [[0, [0, 1], 3, 3, None]],
        [[1, [1], 3, 3, 0]],
    ]


def test_robots_that_leave_have_no_assignment_until_listed(scripts: Any) -> None:
    steps = [{"joins": [[1, 0]], "teams": [[0, 3, 3, 0]]}, {"splits": [[[1], [0]]]}]
    tree = two_robots(steps)
    assert scripts.evaluate(STATES, {**tree, "asked": [2]}) == [
        [[0, [0], 3, 3, 0], [1, [1], 3, 3, None]]
    ]


def two_robots(steps: list[Tree], needs: Any = ("lift",), told: Tree | None = None) -> Tree:
    """Two lifters at (3, 3), where the only task is."""
    robots = [{"name": name, "at": [3, 3], "can": ["lift"]} for name in "ab"]
    task = {"name": "t", "at": [3, 3], "needs": needs}
    return {
        "mission": {
            "world": {"grid": [6, 6]},
            "capabilities": ["lift"],
            "robots": robots,
            "tasks": [task],
        },
        "start": [[0, [0], 3, 3], [1, [1], 3, 3]],
        "steps": steps,
        "end": {"status": "step limit", "makespan": None, "blocked_tasks": []},
        "told": told or {},
    }


def test_a_robot_is_lost_and_back_again_and_again(scripts: Any) -> None:
    steps = [{"lost": [0]}, {"back": [0], "teams": [[0, 4, 3, None]]}, {}, {"lost": [0]}, {}]
    ask = """(tree) => { const history = frames(tree);
      const away = (step) => absenceAt(history, 0, step);
      return [0, 1, 2, 3, 4, 5].map((step) =>
        [robotsLostAt(history, step), away(step)?.from ?? null, away(step)?.place ?? null]); }"""
    here, lost, again = [[], None, None], [[0], 1, [3, 3]], [[0], 4, [4, 3]]
    assert scripts.evaluate(ask, two_robots(steps)) == [here, lost, here, here, again, again]


STANDINGS = """(tree) => {
  const history = frames(tree);
  const standing = (step) => describeStanding(history, 0, sceneAt(history, step));
  const appeared = history.events.filter(({kind}) => kind === "appears");
  return [[0, 1, 4].map(standing), appeared.map(({step, task}) => [step, task])];
}"""


def test_tasks_after_others_are_open_when_those_are_done_and_may_be_late(scripts: Any) -> None:
    told = {"phases": [[[0, 0, 0]], [[0, 7, None]]]}
    tree = two_robots([{"done": [[1, 0]]}, {}, {}, {"done": [[0, 0]]}], told=told)
    first = {"name": "first", "at": [3, 3], "needs": ["lift"]}
    [last] = tree["mission"]["tasks"]
    tree["mission"]["tasks"] = [last | {"after": ["first"], "between": [0, 3]}, first]
    standings, appeared = scripts.evaluate(STANDINGS, tree)
    assert standings == [
        "comes after first, teams are told next",
        "open, nobody assigned",
        "done in step 4, late by 1 step",
    ]
    assert appeared == []


def test_who_is_at_a_task_that_may_not_begin_is_told_why(scripts: Any) -> None:
    tree = two_robots([{"teams": [[0, 3, 3, 0]]}, {}])
    first = {"name": "first", "at": [9, 3], "needs": ["lift"]}
    [last] = tree["mission"]["tasks"]
    tree["mission"]["tasks"] = [
        last | {"at": [3, 3], "needs": ["lift"], "after": ["first"]},
        first,
    ]
    ask = """(tree) => { const history = frames(tree);
      return describeDoing(history, sceneAt(history, 1).teams.get(0), 1); }"""
    name = last["name"]
    assert scripts.evaluate(ask, tree) == f"is at {name} with all it needs; that comes after first"
    tree["mission"]["tasks"][0].pop("after")
    tree["mission"]["tasks"][0]["between"] = [7, 9]
    told = f"is at {name} with all it needs; that may begin after step 7"
    assert scripts.evaluate(ask, tree) == told


def test_a_task_is_called_off_with_the_next_step_if_there_is_one(scripts: Any) -> None:
    tree = two_robots([{}, {}])
    [task] = tree["mission"]["tasks"]
    tree["mission"]["tasks"] = [task | {"cancelled": 3}]
    ask = """(tree) => { const history = frames(tree);
      return describeStanding(history, 0, sceneAt(history, 2)); }"""
    assert scripts.evaluate(ask, tree) == "open, nobody assigned"
    tree["end"]["status"] = "running"
    assert scripts.evaluate(ask, tree) == "called off with the next step"


def test_teams_are_told_with_the_first_step(scripts: Any) -> None:
    told = {"phases": [[[0, 0, 0]], [[0, 7, None]]]}
    tree = two_robots([{"teams": [[0, 4, 3, 0]]}, {}], told=told)
    ask = """(tree) => { const history = frames(tree);
      return [0, 1].map((step) => describeStanding(history, 0, sceneAt(history, step))); }"""
    assert scripts.evaluate(ask, tree) == ["open, teams are told next", "open, 1 team assigned"]


BELIEFS = """(tree) => {
  const history = frames(tree);
  const {mission} = history;
  const believed = (step) => describeCounts(mission, needsAt(history, 0, step));
  const lacking = (step) => describeCounts(mission, sceneAt(history, step).teams.get(0).missing);
  const standing = (step) => describeStanding(history, 0, sceneAt(history, step));
  const shown = history.events.filter(({kind}) => kind === "shown");
  return {
    believed: [0, 1, 2].map(believed),
    lacking: [1, 2].map(lacking),
    needs: [1, 2].map((step) => describeNeeds(history, 0, step)),
    lasts: describeDuration(mission.world, mission.tasks[0]),
    under_way: standing(3),
    shown: shown.map((event) => [event.step, describeEvent(history, event)]),
  };
}"""


@pytest.mark.parametrize(
    ("foresight", "chance", "is_expected"),
    [
        ("needed", 0.01, True),
        ("absent", 0.4, False),
        ("scouting", LIKELY, True),
        ("scouting", LIKELY - 0.01, False),
    ],
)
def test_what_is_believed_is_told_until_the_truth_shows(
    scripts: Any, foresight: str, chance: float, is_expected: bool
) -> None:
    """Task t at (3, 3) needs a lifter, and two as it turns out in step 2; it takes 4 steps."""
    steps = [{"teams": [[0, 3, 3, 0]]}, {"shown": [0], "joins": [[1, 0]]}, {}, {}, {}]
    told = {"services": [[0, "serving", 2, 6, [0, 1], [0, 1]]]}
    tree = two_robots([*steps, {"done": [[0, 0]]}], told=told)
    [task] = tree["mission"]["tasks"]
    task |= {"may_need": {"lift": chance}, "duration": [2, 9]}
    tree["foresight"] = foresight
    tree["truth"] = {"tasks": {"t": {"needs": {"lift": 2}, "duration": 4}}, "robots": {}}
    told = scripts.evaluate(BELIEFS, tree)
    first = "2 x lift" if is_expected else "lift"
    assert told["believed"] == [first, first, "2 x lift"]
    assert told["lacking"] == ["lift" if is_expected else "", ""]
    assert told["needs"] == [f"lift, may need lift ({round(100 * chance)}%)", "2 x lift"]
    assert told["lasts"] == "2 to 9 steps"
    assert told["under_way"] == "under way, 1 of 2 to 9 steps made"
    assert told["shown"] == [[2, "t needs 2 x lift, as it turns out"]]


@pytest.mark.parametrize("y_axis", ["up", "down"])
def test_distances_go_around_walls(scripts: Any, y_axis: str) -> None:
    world = {"rows": [".@.", ".@.", "..."], "y_axis": y_axis}
    ask = """(world) => [[0, 0], [2, 0], [1, 2]].map(
      (at) => walkingDistance(readWorld(world), at, [0, 0]))"""
    assert scripts.evaluate(ask, world) == [0, 6, 3]


@pytest.mark.parametrize("count", [1, 2, 3, 4, 5, 6, 7, 8, 20, 100, 1000])
def test_robots_of_a_team_do_not_overlap_and_stay_in_its_circle(scripts: Any, count: int) -> None:
    sites = scripts.evaluate("(count) => robotSites(count)", count)
    radius = scripts.evaluate("(count) => teamRadius(count)", count)
    assert len(sites) == count
    spots = [(site["x"], site["y"]) for site in sites]
    assert all(math.hypot(x, y) + 1 <= radius for x, y in spots)
    assert min((math.dist(*pair) for pair in itertools.combinations(spots, 2)), default=9) >= 2.1
    assert radius <= 1.45 * math.sqrt(count) + 1.5  # a disc, not a line


def test_teams_in_one_place_do_not_overlap(scripts: Any) -> None:
    rng = random.Random(0)
    for _ in range(30):
        sizes = sorted(rng.choice([1, 1, 2, 3, 8, 40]) for _ in range(rng.randint(1, 25)))[::-1]
        circles = scripts.evaluate("(sizes) => packTeams(sizes).circles", ",".join(map(str, sizes)))
        for one, other in itertools.combinations(circles, 2):
            apart = math.dist((one["x"], one["y"]), (other["x"], other["y"]))
            assert apart >= one["r"] + other["r"] - 1e-6


def test_ways_lead_around_walls_as_teams_walk(scripts: Any) -> None:
    """Of two shortest first steps the one along the longer side is taken, as in `downhill`."""
    world = {"rows": [".....", ".@@@.", "....."], "y_axis": "down"}
    ways = scripts.evaluate(
        "(world) => [[0, 2], [2, 2], [4, 0]].map((at) => wayTo(readWorld(world), at, [4, 0]))",
        world,
    )
    assert ways == [
        [[0, 2], [4, 2], [4, 0]],
        [[2, 2], [4, 2], [4, 0]],
        [[4, 0], [4, 0]],
    ]


FINDING = """(tree) => {
  const history = frames(tree);
  const {mission} = history;
  const steps = [0, 1, 2, 3];
  const found = history.events.filter(({kind}) => kind === "found");
  const teamAt = (step) => sceneAt(history, step).teams.get(0);
  return {
    at: steps.map((step) => sitesAt(history, step)[0].at),
    mates: steps.map((step) => sitesAt(history, step)[0].mates),
    found: found.map((event) => [event.step, describeEvent(history, event)]),
    doing: [1, 2, 3].map((step) => describeDoing(history, teamAt(step), step)),
  };
}"""


def test_tasks_are_where_they_are_believed_to_be(scripts: Any) -> None:
    """Task t may be in 5 cells around (3, 3), which is blocked; from step 2 on it is at (3, 4)."""
    steps = [{"teams": [[0, 3, 1, 0]]}, {"moved": [[0, 3, 4]], "found": [0]}, {}]
    tree = two_robots([*steps])
    [task] = tree["mission"]["tasks"]
    task |= {"within": 1}
    width, height = tree["mission"]["world"]["grid"]
    rows = [["."] * width for _ in range(height)]
    rows[3][3] = "@"
    tree["mission"]["world"] = {"rows": ["".join(row) for row in rows]}
    tree["truth"] = {"tasks": {"t": {"at": [3, 4]}}, "robots": {}}
    told = scripts.evaluate(FINDING, tree)
    assert told["at"] == [[3, 2], [3, 2], [3, 4], [3, 4]]
    assert told["mates"] == [[0]] * 4
    assert told["found"] == [[2, "t found at [3, 4]"]]
    assert [text.split(", ")[1].split(";")[0] for text in told["doing"]] == [
        "1 cell to go",
        "5 cells to go",
        "5 cells to go",
    ]


def test_counts_are_exact_to_three_places(scripts: Any) -> None:
    """0.1 and 0.2 are 0.3; what is measured is drawn in one piece, what is counted in one each."""
    sums = "() => [...addCounts([[[0, 0.1], [1, 33.333]], [[0, 0.2], [1, 66.666]]])]"
    assert scripts.evaluate(sums) == [[0, 0.3], [1, 99.999]]
    assert scripts.evaluate("() => missing(new Map([[0, 99.999]]), [[0, 100]])") == [[0, 0.001]]
    assert scripts.evaluate("() => [3, 24, 25, 0.5, 12.5].map(piecesOf)") == [3, 24, 1, 1, 1]


def test_a_task_of_a_fleet_that_nobody_knows_who_did_is_told_so(scripts: Any) -> None:
    """Robot b is lost, and has not done it."""
    tree = two_robots([{"lost": [1]}, {"done": [[0, None]]}])
    ask = """(tree) => { const history = frames(tree);
      const done = history.events.find(({kind}) => kind === "done");
      return [describeEvent(history, done), history.doers[0],
        describeStanding(history, 0, sceneAt(history, 2)), sceneAt(history, 2).teams.get(0).activity]; }"""  # noqa: E501
    assert scripts.evaluate(ask, tree) == [
        "t done by then, not known by whom",
        [],
        "done by step 2, not known by whom",
        "idle",
    ]
