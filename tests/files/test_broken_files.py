"""Mission files that are wrong: each mistake has its line, and says what to do."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest
import yaml

from teamformer.base.errors import MissionError, TeamformerError
from teamformer.files.mission_files import mission_from_tree, read_mission
from teamformer.files.yaml import reader

GOOD = """\
teamformer: 1
name: good
world: {grid: [4, 3]}
capabilities: [lift, scan]
robots:
  - {name: a, at: [0, 0], can: [lift]}
  - {name: b, at: [1, 0], can: [scan], speed: 0.5}
tasks:
  - {name: x, at: [3, 2], needs: [lift, scan]}
sensing_radius: 1
"""

ROBOTS_AND_TASK = GOOD[GOOD.index("  - {name: a") : GOOD.index("sensing")]
OF_ONE_ROBOT = """\
  - {name: a, at: [0, 0], can: [lift, scan]}
  - {name: b, at: [1, 0], can: [lift], speed: 0.5}
time: continuous
tasks:
  - {name: x, at: [3, 2], needs: {lift: 2}}
  - {name: y, at: [0, 0], needs: [scan], starts: {x: [0, 0]}}
"""
FROM_WORLD = GOOD[GOOD.index("world") :]
ON_ROADS = """\
world:
  roads: |
    from, dock, bay
    dock, 0, 4
    bay, 5, 0
time: continuous
capabilities: [lift]
robots:
  - {name: a, at: dock, can: [lift]}
tasks:
  - {name: x, at: bay, needs: [lift]}
"""

CLOSED_IN = "world:\n  rows:\n    - '..@.'\n    - '..@.'\n    - '..@.'"


def problems_of(folder: Path, text: str | bytes, name: str = "case.yaml") -> list[str]:
    """Return the lines of the error that a file causes, without the folder."""
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(MissionError) as caught:
        read_mission(path)
    return [line.removeprefix(f"{folder}{os.sep}") for line in str(caught.value).splitlines()]


NEEDS = "needs: [lift, scan]"
PLACES = GOOD[GOOD.index("{grid") : GOOD.index("at: [3, 2]")]
WORLD_AND_TASKS = GOOD[GOOD.index("world") : GOOD.index("sensing")]
WALLED_IN = WORLD_AND_TASKS.replace("world: {grid: [4, 3]}", CLOSED_IN).replace(
    "at: [3, 2]", "at: [0, 2], to: [3, 2]"
)

CASES = [
    # time, end, precedence and windows
    ("sensing_radius: 1", "time: soon", 10, "time 'soon' is unknown; use steps or continuous"),
    ("sensing_radius: 1", "ends: [9, 9]", 10, "ends at [9, 9], outside the map; move it"),
    ("sensing_radius: 1", "ends: there", 10, "ends 'there' is unknown; use home or a place"),
    ("sensing_radius: 1", "forming: -1", 10, "forming is -1; use 0 to 1e9"),
    (NEEDS, f"{NEEDS}, after: [y]", 9, "task 'x' is after 'y', which is no task; name one"),
    (NEEDS, f"{NEEDS}, after: [x]", 9, "'x', which is after 'x'; break this circle"),
    (NEEDS, f"{NEEDS}, after: x", 9, "after of task 1 is the text 'x'; write a list"),
    (NEEDS, f"{NEEDS}, between: [9, 2]", 9, "is to be done between 9 and 2; use [begin, end]"),
    (NEEDS, f"{NEEDS}, between: [-1, 2]", 9, "is to be done between -1 and 2"),
    (NEEDS, f"{NEEDS}, between: 4", 9, "between of task 1 is 4; write it as [begin, end]"),
    ("scan]}\nsens", "scan], between: [2, 4], duration: 3}\ntime: continuous\nsens", 9,
     "takes 3 but has only 2 between 2 and 4; give it more time"),
    ("scan]}\nsens", "scan]}\n  - {name: y, at: [0, 0], needs: [lift], starts: {x: [4, 3]}}\nsens",
     10, "task 'y' starts 4 to 3 after 'x'; use [least, most], 0 or more and in this order"),
    (ROBOTS_AND_TASK, OF_ONE_ROBOT, 11,
     "'x', 'y' are done by different robots, and some robot is needed by two of them; add robots"),
    (NEEDS, f"{NEEDS}, between: [20, 30]}}\n  - {{name: y, at: [0, 0], needs: [scan], after: [x], "
     "between: [0, 10]", 10,
     "task 'y' is to be done by 10, but ends at 22 at the earliest: it is after 'x', which ends at "
     "21 at the earliest; move one of the windows, or drop 'x' from after"),
    # loads
    (WORLD_AND_TASKS, WALLED_IN, 13,
     "nobody can bring the load of task 'x' from [0, 2] to [3, 2]: no way leads there"),
    (NEEDS, f"{NEEDS}, to: [9, 9]", 9, "the load of task 'x' is brought to [9, 9], outside"),
    (NEEDS, f"{NEEDS}, unload: 2", 9, "task 'x' has unload 2 but nothing to carry; add to: [x, y]"),
    (NEEDS, f"{NEEDS}, to: [4, 2]", 9,
     "the load of task 'x' is brought to [4, 2], outside the map; x goes from 0 to 3"),
    (NEEDS, f"{NEEDS}, to: 4", 9, "to of task 1 is 4; write a cell as [x, y]"),
    (NEEDS, f"{NEEDS}, to: [0, 0], unload: -1", 9, "task 'x' has unload -1; use 0 or more"),
    (NEEDS, f"{NEEDS}, to: [0, 0], unload: 1.5", 9, "unload of task 1 is 1.5; write a whole"),
    ("sensing_radius: 1", "cost: {travl: 1}", 10,
     "cost has no key 'travl'; did you mean 'travel'?"),
    (NEEDS, f"{NEEDS}, duration: 2.5", 9, "duration of task 1 is 2.5; write a whole number"),
    ("can: [lift]}", "can: [lift], count: 0}", 6, "count of robot 1 is 0; write 1 or more"),
    ("can: [lift]}", "can: [lift], count: 2}\n  - {name: a-1, at: [0, 0], can: [lift]}", 7,
     "the name 'a-1' is used twice; rename one"),
    # one of a few words
    ("sensing_radius: 1", f"time: {'a' * 201}", 10,
     f"time '{'a' * 40}...' is unknown; use steps or continuous"),
    ("sensing_radius: 1", "time: ''", 10, "time '' is unknown; use steps or continuous"),
    ("sensing_radius: 1", "time: 3", 10, "time '3' is unknown; use steps or continuous"),
    ("sensing_radius: 1", "time: no", 10, "time 'no' is unknown; use steps or continuous"),
    ("sensing_radius: 1", "time: [steps]", 10, "time 'a list' is unknown; use steps or continuous"),
    ("sensing_radius: 1", "ends: 3", 10, "ends '3' is unknown; use home or a place as [x, y]"),
    # what is not known beforehand
    (NEEDS, f"{NEEDS}, duration: [9, 2]", 9,
     "takes 9 to 2 steps, but the least comes first; swap"),
    (NEEDS, f"{NEEDS}, duration: [-1, 2]", 9,
     "task 'x' takes -1 to 2 steps; use 0 to 1,000,000,000"),
    (NEEDS, f"{NEEDS}, duration: [1]", 9,
     "duration of task 1 lacks one number; write steps, or [least, most]"),
    (NEEDS, f"{NEEDS}, between: [1, 2, 3]", 9,
     "between of task 1 has 3 numbers instead of 2; write it as [begin, end]"),
    ("speed: 0.5", "breaks: {rate: 0.1, repair: [4]}", 7,
     "repair of breaks of robot 2 lacks one number; write it as [least, most]"),
    (NEEDS, f"{NEEDS}, duration: [1, 2.5]", 9,
     "entry 2 of duration of task 1 is 2.5; write a whole"),
    (NEEDS, "needs: [lift], may_need: {scan: 1.5}", 9,
     "may need 'scan' with probability 1.5; use 0 to 1"),
    (NEEDS, "needs: [lift], may_need: {scan: -0.1}", 9, "with probability -0.1; use 0 to 1"),
    (NEEDS, "needs: [lift], may_need: [scan]", 9,
     "may_need of task 1 is a list; write a mapping to"),
    (NEEDS, "needs: [lift], may_need: {weld: 0.4}", 9, "may need 'weld', which is not under capab"),
    (NEEDS, "needs: [lift], may_need: {lift: 0.4}", 9,
     "task 'x' may need 2 x lift but all robots together lack lift; add such a robot or drop it"),
    ("at: [3, 2]", "at: [3, 2], within: -1", 9, "task 'x' is within -1 of [3, 2]; use 0 to 30"),
    (f"{PLACES}at: [3, 2]",
     PLACES.replace("{grid: [4, 3]}", '{rows: ["....", "...@", "..@@"]}') + "at: [3, 2], within: 1",
     9, "task 'x' is within 1 of [3, 2], where no cell is free; move it or widen it"),
    ("sensing_radius: 1", "finding_radius: -1", 10, "finding_radius is -1.0; it must be 0 or more"),
    ("speed: 0.5", "breaks: {rate: 2}", 7,
     "robot 'b' breaks down at a rate of 2 a step; use 0 to 1"),
    ("speed: 0.5", "breaks: {rate: -0.1}", 7, "at a rate of -0.1 a step; use 0 to 1"),
    ("sensing_radius: 1", "arrivals: {rate: 2, until: 9}", 10,
     "tasks appear at a rate of 2 a step; use 0 to 1"),
    ("sensing_radius: 1", "arrivals: {rate: 0.1}", 10, "arrivals lacks 'until'; add it"),
    ("sensing_radius: 1", "arrivals: {rate: 0.1, until: 20000}", 10,
     "tasks appear until step 20000; use 0 to 10,000"),
    ("sensing_radius: 1", "arrivals: {rate: 0.1, until: 9, needs: 0}", 10,
     "needs of arrivals is 0; write 1 or more"),
    ("speed: 0.5", "delays: 1", 7,
     "robot 'b' stands still with probability 1; use 0 to less than 1"),
    ("speed: 0.5", "delays: -0.1", 7, "stands still with probability -0.1; use 0 to less than 1"),
    ("speed: 0.5", "delays: often", 7, "delays of robot 2 is the text 'often'; write a number"),
    ("speed: 0.5", "delays: {chance: 0.1}", 7, "delays of robot 2 lacks 'seed'; add it"),
    ("speed: 0.5", "breaks: {}", 7, "breaks of robot 2 lacks 'rate'; add it"),
    ("speed: 0.5", "breaks: {rate: 0.1, repair: 4}", 7,
     "repair of breaks of robot 2 is 4; write it as"),
    ("speed: 0.5", "breaks: {rate: 0.1, repair: [0, 4]}", 7,
     "is repaired in 0 to 4 steps; use 1 to"),
    ("speed: 0.5", "breaks: {rate: 0.1, repair: [5, 4]}", 7,
     "in 5 to 4 steps, but the least comes first"),
    ("speed: 0.5", "breaks: {rate: 0.1}, lost: 3", 7,
     "has both lost and breaks; keep one"),
    # how a mission is solved, which files said once
    ("sensing_radius: 1", "order: tsp", 10, "'order' says how to solve the mission, not what it "
     "is; delete it, and choose a method with --method"),
    ("sensing_radius: 1", "allocation: crews", 10, "'allocation' says how to solve the mission, "
     "not what it is; delete it, and choose a method with --method"),
    ("sensing_radius: 1", "new_tasks: nearest", 10, "'new_tasks' says how to solve the mission, "
     "not what it is; delete it; suites of bench can set it, under method_settings"),
    ("sensing_radius: 1", "foresight: absent", 10, "'foresight' says how to solve the mission, "
     "not what it is; delete it; suites of bench can set it, under method_settings"),
    ("speed: 0.5", "lost: 1000000001", 7,
     "lost of robot 2 is 1000000001; write a number up to 1,000,000,000, counted from the"),
    ("speed: 0.5", "lost: 9, back: 2000000001", 7,
     "back of robot 2 is 2000000001; write a number up to 2,000,000,000"),
    # unknown, repeated, missing and misplaced keys
    ("name: good", "nmae: good", 2, "no key 'nmae'; did you mean 'name'?"),
    ("speed: 0.5", "colour: red", 7, "robot 2 has no key 'colour'; known are name, at, can"),
    ("sensing_radius: 1", "name: again", 10, "'name' stands here a second time, first on line 2"),
    ("at: [3, 2]", "at: [3, 2], at: [3, 1]", 9, "'at' stands here a second time"),
    ("tasks:", "jobs:", 1, "the file lacks 'tasks'; add it"),
    (", can: [lift]", "", 6, "robot 1 lacks 'can'; add it"),
    ("teamformer: 1\n", "", 1, "the file lacks 'teamformer'"),
    ("teamformer: 1", "teamformer: 2", 1, "this is format 2, and this teamformer knows up to 1"),
    ("teamformer: 1", "teamformer: 0", 1, "teamformer is 0; write 1 or more"),
    ("teamformer: 1", "teamformer: one", 1, "the text 'one'; write a whole number"),
    ("sensing_radius: 1", "<<: {step_limit: 9}", 10, "<< is not followed; write the keys out"),
    # names that YAML takes for something else
    ("name: a", "name: no", 6, "YAML reads no as true or false; put it in quotes"),
    ("name: a", "name: Yes", 6, "YAML reads Yes as true or false"),
    ("name: a", "name: 12:30", 6, "YAML reads 12:30 as a number"),
    ("name: a", "name: 0x1F", 6, "YAML reads 0x1F as a number"),
    ("name: a", "name: 007", 6, "YAML reads 007 as a number"),
    ("name: a", "name: 7", 6, "YAML reads 7 as a number"),
    ("name: a", "name: 1e3", 6, "YAML reads 1000.0 as a number"),
    ("name: a", "name: 2026-01-01", 6, "YAML reads 2026-01-01 as a date"),
    ("name: a", "name: ~", 6, "name of robot 1 is nothing; write a name"),
    ("name: a", "name: ''", 6, "name of robot 1 is empty"),
    ("name: a", 'name: "a\\nb"', 6, "cannot be printed"),
    ("name: a", f"name: {'a' * 201}", 6, "use 200 letters at most"),
    ("name: a", f"name: {'a' * 199}, count: 2", 6, "use 198 letters at most"),  # one is a...a-2
    ("can: [scan]", "can: {no: 1}", 7, "YAML reads no as true or false"),
    ("[lift, scan]\nrobots", "[lift, off]\nrobots", 4, "YAML reads off as true or false"),
    # wrong types and numbers
    ("at: [0, 0]", "at: [0.5, 0]", 6, "entry 1 of at of robot 1 is 0.5; write a whole number"),
    ("at: [0, 0]", "at: [0]", 6, "at of robot 1 lacks one number; write a cell as [x, y]"),
    ("at: [0, 0]", "at: []", 6, "at of robot 1 lacks 2 numbers; write a cell as [x, y]"),
    ("at: [0, 0]", "at: [0, 0, 0]", 6, "at of robot 1 has 3 numbers instead of 2; write a cell"),
    ("sensing_radius: 1", "ends: [0]", 10, "ends lacks one number; write a cell as [x, y]"),
    ("at: [0, 0]", "at: 3", 6, "at of robot 1 is 3; write a cell as [x, y]"),
    ("at: [3, 2]", "at: [3, 2], appears: 1738915200", 9,
     "appears of task 1 is 1738915200; write a number up to 1,000,000,000, counted from the mission"
     "'s start"),
    ("at: [3, 2]", "at: [3, 2], between: [1738915200, 1738918800]", 9,
     "entry 1 of between of task 1 is 1738915200; write a number up to 1,000,000,000, counted from "
     "the mission's start"),
    ("at: [0, 0]", "at: [0, 99999999999]", 6, "write a number up to 1,000,000,000"),
    ("can: [scan]", "can: {scan: 1.0005}", 7, "scan of can of robot 2 is 1.0005; round it to 3"),
    ("can: [scan]", "can: {scan: 100000.5}", 7, "write a number up to 100,000"),
    ("can: [scan]", "can: {scan: .nan}", 7, "scan of can of robot 2 is nan; write a number up to"),
    ("can: [scan]", "can: {scan: two}", 7, "scan of can of robot 2 is the text 'two'; write a n"),
    ("can: [scan]", "can: {scan: yes}", 7, "scan of can of robot 2 is yes (for YAML true or f"),
    ("can: [scan]", "can: {scan: 0}", 7, "robot 'b' can 'scan' 0 times; use more than 0"),
    ("can: [scan]", "can: {scan: -0.5}", 7, "robot 'b' can 'scan' -0.5 times; use more than 0"),
    ("can: [scan]", "can: scan", 7, "write a list of capabilities or a mapping to counts"),
    ("can: [scan]", "can: [scan, scan]", 7, "'scan' stands twice in this list; to mean two write"),
    ("speed: 0.5", "moves: water", 7, "moves of robot 2 is 'water'; write ground or air"),
    ("speed: 0.5", "moves: [air]", 7, "moves of robot 2 is"),
    (NEEDS, "needs: [lift, scan], only: [b]", 9, "task 'x' is only for robots that together lack"),
    (NEEDS, "needs: [lift], only: [a], with: [b]", 9, "task 'x' is with 'b', but only for others"),
    (NEEDS, "needs: [lift], with: [c]", 9, "there is no robot 'c'; write the name of one"),
    (NEEDS, "needs: [lift, scan], weight: 0", 9, "the weight of task 'x' is 0; use 0.001 to 1e+06"),
    ("speed: 0.5", "speed: fast", 7, "speed of robot 2 is the text 'fast'; write a number"),
    ("speed: 0.5", "speed: .nan", 7, "speed of robot 2 is nan; write a number up to"),
    ("speed: 0.5", "speed: .inf", 7, "speed of robot 2 is inf; write a number up to"),
    ("speed: 0.5", "speed: true", 7, "speed of robot 2 is true (for YAML true or false)"),
    ("speed: 0.5", "lost: 2.5", 7, "lost of robot 2 is 2.5; write a whole number"),
    ("sensing_radius: 1", "sensing_radius: .nan", 10, "sensing_radius is nan"),
    ("sensing_radius: 1", "step_limit: 0", 10, "step_limit is 0; write 1 or more"),
    ("sensing_radius: 1", "tasks: none", 10, "'tasks' stands here a second time"),
    ("  - {name: x, at: [3, 2], needs: [lift, scan]}", "  x: 1", 8, "tasks is a mapping; write a"),
    ("- {name: x, at: [3, 2], needs: [lift, scan]}", "- weld it", 9, "task 1 is the text 'weld i"),
    # what cannot be in a mission file
    ("can: [scan], speed: 0.5", "can: &kit [scan], name: *kit", 7, "*kit is not followed"),
    ("name: good", "name: !!python/name:os.system x", 2, "the tag tag:yaml.org,2002:python/name"),
    ("sensing_radius: 1", "---\nname: two", 10, "a second document begins here"),
    ("name: good", "[1]: 2", 2, "a list or mapping stands where a name belongs"),
    ("name: good", "name: [[[[[[[[[[[[[[]]]]]]]]]]]]]]", 2, "nested deeper than 12 levels"),
    ("name: good", "name: @home", 2, "put a text that begins with @ in quotes"),
    ("name: good", "name: good: bad", 2, "this is not YAML: mapping values are not allowed"),
    ("[lift, scan]\nrobots", "[lift, scan\nrobots", 5, "(while parsing a flow sequence, begun on"),
    ("name: good", "name: go\x07od", 2, "the character U+0007 cannot stand in a text file"),
    # worlds
    ("{grid: [4, 3]}", "{}", 3, "the world needs exactly one of grid"),
    ("{grid: [4, 3]}", "{grid: [4, 3], map: x.map}", 3, "the world needs exactly one of grid"),
    ("{grid: [4, 3]}", "{plane: [0, 3]}", 3, "a side of the plane is 0 m; use more than 0"),
    ("{grid: [4, 3]}", "{plane: 3.2}", 3, "the plane is not a pair; write it as [width, height]"),
    ("{grid: [4, 3]}", "{plane: [4, 3], step: 0}", 3, "the step is 0 s; use 0.01 to 1000"),
    ("{grid: [4, 3]}", "{plane: [4, 3], unit: 0}", 3, "the unit is 0 m; use 0.001 or more"),
    ("{grid: [4, 3]}", "{plane: [4, 3], arrival_radius: -1}", 3, "the arrival radius is -1 m"),
    ("{grid: [4, 3]}", "{plane: [4, 3], cell: 1}", 3, "'cell' does not go with 'plane'"),
    ("{grid: [4, 3]}", "{plane: [2.5, 3]}", 9, "outside the map; x goes from 0 to 2.5 and y from"),
    ("{grid: [4, 3]}", "{grid: 4}", 3, "write it as [width, height]"),
    ("{grid: [4, 3]}", "{grid: [0, 3]}", 3, "entry 1 of grid of world is 0; write 1 or more"),
    ("{grid: [4, 3]}", "{grid: [4, 3], cell: 1}", 3, "'cell' does not go with 'grid'; remove it"),
    ("{grid: [4, 3]}", "{grid: [9999, 9999]}", 3, "the map has 99,980,001 cells"),
    ("{grid: [4, 3]}", "{grid: [4, 3], y_axis: left}", 3, "y_axis is the text 'left'; write up or"),
    ("{grid: [4, 3]}", "{rows: []}", 3, "the map has no rows"),
    ("{grid: [4, 3]}", "\n  rows:\n    - '....'\n    - '...'", 6, "row 2 has 3 cells"),
    ("{grid: [4, 3]}", "\n  rows:\n    - '....'\n    - '.x..'", 6, "row 2: 'x' is no cell"),
    ("{grid: [4, 3]}", "{map: none.map}", 3, "none.map: there is no such file"),
    ("{grid: [4, 3]}", "{map: floor.png}", 3, "this is no map; name a .map or a map_server .yaml"),
    # roads
    ("{grid: [4, 3]}", "{roads: none.csv}", 3, "none.csv: there is no such file; name a table"),
    ("{grid: [4, 3]}", "{roads: [a.csv]}", 3, "roads of world is a list; name a file, or write"),
    ("{grid: [4, 3]}", "{roads: {}}", 3, "the roads name no file; name one, or one for each"),
    *(
        (FROM_WORLD, ON_ROADS.replace(old, new), 4, f"roads of world, line {told}")
        for old, new, told in (
            ("from, dock, bay", '" from', "1: this is no table with commas"),
            ("from, dock, bay", "from", "1: the first row names no places"),
            ("from, dock, bay", "from, dock, dock", "1: the place 'dock' stands twice; rename one"),
            ("from, dock, bay", "from, dock,", "1: the name of column 2 is empty or cannot be pri"),
            ("bay, 5, 0", "buy, 5, 0", "3: this row is of 'buy', but column 2 is of 'bay'; name"),
            ("bay, 5, 0", "bay, 5", "3: the table is not square: the row of 'bay' has 1 times; w"),
            ("    bay, 5, 0\n", "", "2: the table is not square: there is no row of 'bay'; add it"),
            ("bay, 5, 0", "bay, 5, 0\n    x, 1, 2", "4: the table is not square: the row of 'x' "),
            ("bay, 5, 0", "bay, -1, 0", "3: the time from 'bay' to 'dock' is -1; write 0 to 1e9"),
            ("bay, 5, 0", "bay, nan, 0", "3: the time from 'bay' to 'dock' is nan; write 0 to"),
            ("bay, 5, 0", "bay, -inf, 0", "3: the time from 'bay' to 'dock' is -inf; write 0 to"),
            ("bay, 5, 0", "bay, far, 0", "3: the time from 'bay' to 'dock' is 'far'; write 0 to"),
        )
    ),
    (
        FROM_WORLD,
        ON_ROADS.replace("dock, 0, 4", "dock, 0, inf"),
        13,
        "task 'x' cannot be reached by robots that bring lift; move it, give such a way a time",
    ),
    (
        FROM_WORLD,
        ON_ROADS.replace("bay, 5", "bay, ").replace("at: dock", "at: bay") + "ends: dock\n",
        11,
        "robot 'a' has no way to where the mission ends; move it, give such a way a time under",
    ),
    (FROM_WORLD, ON_ROADS.replace("at: dock", "at: docc"), 11, "at of robot 1 is 'docc', which"),
    (FROM_WORLD, ON_ROADS.replace("at: dock", "at: [0, 1]"), 11, "is a list; on roads name a"),
    (
        FROM_WORLD,
        ON_ROADS.replace("at: dock", "at: dock, moves: air"),
        11,
        "robot 'a' moves by air, but there are only roads by ground; name a file under roads",
    ),
    (FROM_WORLD, ON_ROADS.replace("continuous", "steps"), 4, "roads are for continuous time: in"),
    ("speed: 0.5", "moves: swim", 7, "moves of robot 2 is 'swim'; write ground or air"),
    # teams
    ("sensing_radius: 1", "teams: [[a, c]]", 10, "there is no robot 'c'; write the name of one"),
    ("sensing_radius: 1", "teams: [a]", 10, "team 1 is the text 'a'; write a list"),
    ("sensing_radius: 1", "teams: [[a, b]]", 10, "must start in the same place"),
    ("sensing_radius: 1", "teams: [[a], [a]]", 10, "robot 'a' is in two starting teams; keep one"),
    ("{grid: [4, 3]}", '{rows: ["....", "....", "...@"]}', 9, "[3, 2], inside an obstacle; the"),
    # what the mission itself cannot be
    ("name: b", "name: a", 7, "the name 'a' is used twice; rename one"),
    ("needs: [lift, scan]", "needs: [lift, weld]", 9, "'weld', which is not under capabilities"),
    ("can: [lift]", "can: [scan]", 9, "task 'x' needs 'lift' but no robot has it; add such"),
    ("needs: [lift, scan]", "needs: {lift: 2}", 9, "all robots together have 1 x lift"),
    ("at: [3, 2]", "at: [4, 2]", 9, "task 'x' is at [4, 2], outside the map; x goes from 0 to 3"),
    ("world: {grid: [4, 3]}", CLOSED_IN, 13, "task 'x' cannot be reached by robots that bring"),
    ("at: [3, 2]", "at: [3, 2], duration: -1", 9, "task 'x' has duration -1; use 0 or more"),
    ("speed: 0.5", "speed: 0", 7, "robot 'b' has speed 0; use 0.001 to 1000"),
    ("speed: 0.5", "speed: 1e-320", 7, "robot 'b' has speed"),
    ("speed: 0.5", "lost: 0", 7, "robot 'b' is lost at step 0; the first step is 1"),
    ("speed: 0.5", "lost: 4, back: 4", 7, "robot 'b' is lost at step 4 and back at step 4; it"),
    (
        "- {name: x,",
        "- {name: x, battery: {lasts: 3},",
        9,
        "task 1 has no key 'battery', which is a key of robots; move it there",
    ),
    (
        "speed: 0.5",
        "shifts: [[9, 5]]",
        7,
        "robot 'b' has a shift from 9 to 5; use [begin, end], 0 or more and in this order, up to "
        "1e9",
    ),
    (
        "speed: 0.5",
        "shifts: [[0, 5], [4, 9]]",
        7,
        "robot 'b' has a shift from 4 on, before the one before it ends at 5; put them in order, "
        "or join the two",
    ),
    (
        "speed: 0.5",
        "shifts: [[0, 8]], every: 6",
        7,
        "the shifts of robot 'b' come again every 6, but take 8 from first to last; use 8",
    ),
    (
        "speed: 0.5}\ntasks:\n  - {name: x,",
        "shifts: [[0, 8]]}\ntasks:\n  - {duration: 9, name: x,",
        9,
        "task 'x' takes 9, but robots that can do it have no shift that long in common; lengthen "
        "their shifts, or shorten the task",
    ),
    (
        "speed: 0.5}\ntasks:\n  - {name: x,",
        "speed: 0.5, shifts: [[0, 8]], every: 9}\ntasks:\n  - {duration: [1, 9], name: x,",
        9,
        "task 'x' may take 9, but robots that can do it have no shift that long in common; "
        "lengthen their shifts, or shorten the task",
    ),
    (
        "speed: 0.5}",
        "speed: 0.5, shifts: [[0, 5]]}",
        9,
        "robots that can do task 'x' do not get there within their shifts; lengthen these, have "
        "them come again (every), or move it",
    ),
    (
        "speed: 0.5}\ntasks:\n  - {name: x,",
        "speed: 0.5, shifts: [[0, 5]], every: 6}\ntasks:\n  - {to: [0, 2], name: x,",
        9,
        "task 'x' takes 6 or more with the way of its load, but robots that can do it have no "
        "shift that long in common; lengthen their shifts, or shorten the way",
    ),
    (
        "speed: 0.5",
        "lost: [4, 6], back: [6]",
        7,
        "robot 'b' is back at step 6 and lost at step 6; it must be lost later",
    ),
    (
        "speed: 0.5",
        "lost: [4, 6]",
        7,
        "robot 'b' is lost at step 6, but was lost in step 4; write under back when it "
        "returns, or drop one of the two",
    ),
    (
        "speed: 0.5",
        "lost: [4], back: [6, 9]",
        7,
        "robot 'b' is back more often than it is lost; add lost or drop back",
    ),
    (
        "speed: 0.5",
        "lost: [4, x]",
        7,
        "entry 2 of lost of robot 2 is the text 'x'; write a whole number",
    ),
    ("speed: 0.5", "back: 4", 7, "robot 'b' is back but never lost; add lost or drop back"),
    ("sensing_radius: 1", "join_radius: 2", 10, "join_radius 2 is larger than sensing_radius 1"),
]  # fmt: skip


@pytest.mark.parametrize("loader", [yaml.SafeLoader, reader.LOADER])
@pytest.mark.parametrize(("old", "new", "line", "message"), CASES)
def test_a_mistake_is_told_with_its_line(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    loader: type[yaml.SafeLoader],
    old: str,
    new: str,
    line: int,
    message: str,
) -> None:
    monkeypatch.setattr(reader, "LOADER", loader)
    assert GOOD.count(old) >= 1
    found = problems_of(tmp_path, GOOD.replace(old, new, 1))
    assert any(told.startswith(f"case.yaml:{line}: ") and message in told for told in found), found


def test_the_file_that_the_mistakes_are_put_into_is_good(tmp_path: Path) -> None:
    path = tmp_path / "case.yaml"
    path.write_text(GOOD)
    assert len(read_mission(path).tasks) == 1


def test_everything_wrong_is_told_at_once_in_the_order_of_the_file(tmp_path: Path) -> None:
    text = GOOD.replace("name: good", "nam: good").replace("speed: 0.5", "sped: 1")
    text = text.replace("at: [3, 2]", "at: [9, 9], duration: -3")
    found = problems_of(tmp_path, text)
    assert [told.split(":")[1] for told in found] == ["2", "7", "9", "9"]
    assert "did you mean 'name'?" in found[0]
    assert "did you mean 'speed'?" in found[1]
    assert "outside the map" in found[2]  # what no other mistake hides is told too
    assert "duration -3" in found[3]


def test_a_mistake_causes_no_other_complaints(tmp_path: Path) -> None:
    for old, new in (
        ("[lift, scan]\nrobots", "[lift, scan, on]\nrobots"),
        ("{grid: [4, 3]}", "{grid: 4}"),
        ("name: good", "[1, {a: b}]: {c: [d]}"),
        ("sensing_radius: 1", "<<: {step_limit: 9}"),
        ("sensing_radius: 1", "sensing_radius: -1"),
    ):
        assert len(problems_of(tmp_path, GOOD.replace(old, new))) == 1


def test_each_key_of_a_method_is_told_once_and_hides_nothing_else(tmp_path: Path) -> None:
    how = "order: tsp\nallocation: plan\nforesight: needed\nnew_tasks: nearest\n"
    found = problems_of(tmp_path, GOOD.replace("speed: 0.5", "sped: 1") + how)
    assert [told.split(":")[1] for told in found] == ["7", "11", "12", "13", "14"]
    assert "did you mean 'speed'?" in found[0]


def test_a_newer_format_is_the_only_complaint(tmp_path: Path) -> None:
    text = GOOD.replace("teamformer: 1", "teamformer: 9").replace("tasks:", "goals:")
    assert problems_of(tmp_path, text) == [
        "case.yaml:1: this is format 9, and this teamformer knows up to 1; install a newer one"
    ]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"good",', '"good"', "case.json:4: this is not JSON: "),
        ('"good",', '"good"', "; check quotes, brackets and commas here and above"),
        ('"good"', "true", "case.json:3: JSON reads true as true or false; put it in quotes"),
        ("0.5", "true", "speed of robot 2 is true (for JSON true or false); write a number"),
        ('"lift"', "7", "case.json:11: JSON reads 7 as a number; put it in quotes"),
    ],
)
def test_a_mistake_in_json_is_not_told_as_one_of_yaml(
    tmp_path: Path, old: str, new: str, message: str
) -> None:
    text = json.dumps(yaml.safe_load(GOOD), indent=1)
    found = problems_of(tmp_path, text.replace(old, new, 1), "case.json")
    assert any(message in told for told in found), found
    assert "YAML" not in "".join(found)


def test_problems_beyond_fifty_are_counted(tmp_path: Path) -> None:
    found = problems_of(tmp_path, GOOD + "".join(f"key{i}: 1\n" for i in range(60)))
    assert len(found) == 51
    assert found[0].startswith("case.yaml:11: ")
    assert found[-1] == "case.yaml: and 10 problems more"


def test_problems_say_where_in_the_tree() -> None:
    with pytest.raises(MissionError) as caught:
        mission_from_tree({"teamformer": 1}, "record.json: mission")
    assert str(caught.value).splitlines()[0] == (
        "record.json: mission: the file lacks 'world'; add it"
    )
    assert {problem.where for problem in caught.value.problems} == {()}


def test_a_tree_in_memory_names_no_map_file() -> None:
    tree = {**yaml.safe_load(GOOD), "world": {"map": "x.map"}}
    with pytest.raises(MissionError, match=r"a map in another file cannot be read here"):
        mission_from_tree(tree)


@pytest.mark.parametrize("text", ["", "\n\n", "# nothing\n"])
def test_an_empty_file(tmp_path: Path, text: str) -> None:
    told = "case.yaml:1: the file is empty; write a mission into it"
    assert problems_of(tmp_path, text) == [told]


@pytest.mark.parametrize(
    ("text", "what"), [("~", "nothing"), ("- a", "a list"), ("word", "the text 'word'"), ("3", "3")]
)
def test_a_file_that_is_no_mapping(tmp_path: Path, text: str, what: str) -> None:
    assert f"the file is {what}; write a mapping of teamformer" in problems_of(tmp_path, text)[0]


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("case.yaml", "case.yaml:1: the file lacks 'image'"),  # a map that is its own mission
        ("folder.map", "folder.map: this is a folder"),
        ("loop.map", "loop.map: cannot be read: Too many"),
        ("endless.yaml", "/dev/zero: this is not a plain file"),
        ("/dev/zero", "/dev/zero: this is no map"),
        ("[red].map", "[red].map: there is no such file"),
        ("'x.yaml', cell: .nan", "cell of world is nan; write a number"),
    ],
)
def test_a_map_that_is_none(tmp_path: Path, name: str, message: str) -> None:
    (tmp_path / "folder.map").mkdir()
    (tmp_path / "loop.map").symlink_to("loop.map")
    about = "resolution: 1\noccupied_thresh: 0.65\nfree_thresh: 0.196\nimage: /dev/zero\n"
    (tmp_path / "endless.yaml").write_text(about)
    shown = name if "cell" in name else f"'{name}'"
    [told] = problems_of(tmp_path, GOOD.replace("{grid: [4, 3]}", f"{{map: {shown}}}"))
    assert told.startswith("case.yaml:3: ")
    assert message in told


def test_what_is_no_readable_file(tmp_path: Path) -> None:
    (tmp_path / "junk.yaml").write_bytes(b"\x80\x81\xff")
    os.mkfifo(tmp_path / "pipe.yaml")
    with (tmp_path / "huge.yaml").open("wb") as file:
        file.truncate(100_000_000)
    told = {
        "none.yaml": "there is no such file",
        "junk.yaml": "this is not text: byte 1 is no UTF-8",
        "pipe.yaml": "this is not a plain file",
        "huge.yaml": "larger than 20 MB",
        "a\0b.yaml": "cannot be read",
        ".": "this is a folder",
    }
    for name, message in told.items():
        with pytest.raises(TeamformerError, match=message):
            read_mission(tmp_path / name)


@pytest.mark.skipif(os.geteuid() == 0, reason="root may read everything")
def test_a_file_that_may_not_be_read(tmp_path: Path) -> None:
    path = tmp_path / "secret.yaml"
    path.write_text(GOOD)
    path.chmod(0)
    with pytest.raises(TeamformerError, match="cannot be read: Permission denied"):
        read_mission(path)
