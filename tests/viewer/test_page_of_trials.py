"""The page's reading of records, held against the simulator that wrote them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from teamformer.files.mission_files import read_mission
from teamformer.methods.scripted.heuristic import Heuristic
from teamformer.methods.scripted.joining import JoinAll
from teamformer.record.files.writing import record_to_tree
from teamformer.trials.recorder import Recorder
from teamformer.viewer.modules import joined
from teamformer.world.env import TeamFormation

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture(scope="module")
def scripts(browser: Any) -> Iterator[Any]:
    page = browser.new_page()
    page.add_script_tag(content=joined("record/scene"))
    yield page
    page.close()


@pytest.mark.parametrize("policy", [Heuristic, JoinAll])
@pytest.mark.parametrize("name", ["warehouse", "breakdown", "late-tasks", "plane"])
def test_the_page_rebuilds_what_the_simulator_had(scripts: Any, name: str, policy: Any) -> None:
    env = TeamFormation([read_mission(EXAMPLES / f"{name}.yaml")])
    recorder, chooser = Recorder(env), policy()
    chooser.begin(None, np.random.default_rng(0))
    had = [moment(env)]
    while env.is_running[0]:
        env.step(chooser.decide(env.view()))
        recorder.step()
        had.append(moment(env))
    tree = record_to_tree(recorder.finish(name, 0, None))
    assert scripts.evaluate(MOMENTS, tree) == had


def moment(env: TeamFormation) -> list[list[Any]]:
    """Return the slot of each robot's team (-1: lost), and each team's place, task, service."""
    teams, tasks = env.worlds.teams[0], env.worlds.tasks[0]
    slots = env.worlds.robots["team"][0].tolist()
    servers = tasks["server"].tolist()
    return [
        slots,
        [
            [float(teams[slot][key]) for key in ("x", "y", "task")] + [slot in servers]
            for slot in sorted(set(slots) - {-1})
        ],
    ]


MOMENTS = """(tree) => {
  const history = frames(tree);
  const { square = 1 } = history.mission.world;
  const metres = (along) => Math.round(along * square * 1e6) / 1e6;
  const list = ({ state, teams }) => [
    [...state.team],
    [...teams.values()].sort((one, other) => one.slot - other.slot)
      .map(({ slot, x, y, service }) => [metres(x), metres(y), state.task[slot], service !== null]),
  ];
  return Array.from({ length: history.last + 1 }, (_, step) => list(sceneAt(history, step)));
}"""
