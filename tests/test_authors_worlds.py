"""On the worlds of the paper's authors: what the policies take, beside their own heuristic.

The worlds and the makespans of the authors' heuristic were made by their public environment
(njayboehme/Teamformer). They are not part of this project; without them the tests are skipped.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from teamformer.files.imports.authors import read_worlds
from teamformer.methods.scripted.heuristic import Heuristic
from teamformer.methods.scripted.joining import JoinAll
from teamformer.mission.model import Mission
from teamformer.trials.trial import run_trials

AUTHORS = Path(__file__).parents[2] / "shared" / "data" / "authors"

pytestmark = pytest.mark.skipif(not AUTHORS.is_dir(), reason=f"{AUTHORS} is not there")


def load(setting: str) -> tuple[list[Mission], list[int | None]]:
    worlds = read_worlds(AUTHORS / f"{setting}.jsonl")
    return [world.mission for world in worlds], [world.heuristic for world in worlds]


def test_on_four_robots_and_four_tasks() -> None:
    missions, authors = load("4N4T-C4")
    heuristic = [tally.steps for tally in run_trials(missions, Heuristic())]
    join_all = [tally.steps for tally in run_trials(missions, JoinAll())]
    assert np.mean([steps for steps in authors if steps]) == pytest.approx(25.96)
    assert np.mean(heuristic) == pytest.approx(25.04)
    assert np.mean(join_all) == pytest.approx(19.76)


@pytest.mark.parametrize("path", sorted(p.stem for p in AUTHORS.glob("*.jsonl")))
def test_nothing_fails_and_joining_all_beats_the_heuristic(path: str) -> None:
    missions, _ = load(path)
    mean = {}
    for policy in (Heuristic(), JoinAll()):
        tallies = run_trials(missions, policy)
        assert {tally.status for tally in tallies} == {"completed"}
        assert sum(tally.illegal_decisions for tally in tallies) == 0
        mean[type(policy)] = np.mean([tally.steps for tally in tallies])
    assert mean[JoinAll] < mean[Heuristic]
