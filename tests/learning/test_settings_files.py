"""Settings of trainings in files: what is read, and what is refused with its line."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

import pytest

from teamformer.base.errors import TeamformerError
from teamformer.learning.algorithms.ppo import PpoSettings
from teamformer.learning.algorithms.reward_streams import MissionReward, TeamReward
from teamformer.learning.settings_files import load_settings, names_of_settings, settings_of
from teamformer.learning.training_settings import TrainSettings
from teamformer.learning.training_worlds import Mixture, training_worlds
from teamformer.methods.learned.shipped import shipped_cards


def read(folder: Path, text: str) -> TrainSettings:
    (folder / "mine.yaml").write_text(text)
    return load_settings(str(folder / "mine.yaml"))


def test_the_dataclasses_are_the_schema(tmp_path: Path) -> None:
    text = """
network: deepset
capabilities: 4
method: ppo
iterations: null
minutes: 2.5
mixture: {robots: [3, 5], capabilities: [2, 4], crowds: 0, walls: 0.25}
team_reward: {fit: 2}
ppo:
  clip: 0.1
device: cuda
"""
    assert read(tmp_path, text) == TrainSettings(
        network="deepset",
        capabilities=4,
        method="ppo",
        minutes=2.5,
        mixture=Mixture(robots=(3, 5), capabilities=(2, 4), crowds=0.0, walls=0.25),
        mission_reward=None,
        team_reward=TeamReward(fit=2.0),
        ppo=PpoSettings(clip=0.1),
        device="cuda",
    )
    assert read(tmp_path, "mission_reward: {step: -1}").reward == MissionReward(step=-1.0)


@pytest.mark.parametrize("name", names_of_settings())
def test_shipped_settings_are_those_of_the_network(name: str) -> None:
    """A checkpoint gives them back as they were."""
    settings = load_settings(name)
    kept = json.loads(json.dumps(asdict(settings)))
    assert settings_of(kept, "a checkpoint") == settings
    if name.startswith("teamformer-tasks"):
        how = "samples" if name == "teamformer-tasks" else "deviations"
        assert (settings.network, settings.learns_by) == ("tasks", how)
        return
    exact = name.removeprefix("paper-exact-")
    family, _, rest = f"-{exact}".rpartition("-c") if exact != name else name.partition("-c")
    caps, _, how = rest.partition("-")
    network = family + ("-full" if how == "full" else "") if rest else "any"
    if exact != name:
        network, how = family.removeprefix("-") or "teamformer-paper", "ppo"
        assert settings.reward == TeamReward(scale=1.0)
    assert settings.network == network
    assert settings.capabilities == (int(caps) if caps else None)
    learns_by = {"": "imitation" if rest else "rollouts", "ppo": "ppo", "full": "ppo"}
    assert settings.learns_by == learns_by[how]


@pytest.mark.parametrize("name", names_of_settings())
def test_shipped_settings_can_be_repeated(name: str) -> None:
    """No clock ends them or slows learning down: a half is a half of the iterations."""
    settings = load_settings(name)
    assert settings.iterations is not None
    assert settings.minutes is None
    assert settings.share_done(settings.iterations // 2, 1e9) == pytest.approx(0.5, abs=0.02)


def test_every_learned_method_has_its_settings() -> None:
    assert {card.name for card in shipped_cards()} <= set(names_of_settings())


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (
            "worlds: 3\nworldz: 4",
            "mine.yaml:2: the file has no key 'worldz'; did you mean 'worlds'?",
        ),
        ("ppo:\n  clipp: 1", "mine.yaml:2: ppo has no key 'clipp'; did you mean 'clip'?"),
        ("worlds: 0", "mine.yaml:1: worlds is 0; write 1 or more"),
        ("worlds: many", "mine.yaml:1: worlds is the text 'many'; write a whole number"),
        ("minutes: -1", "mine.yaml:1: minutes is -1; write 0 or more"),
        ("seed: -1", "mine.yaml:1: seed is -1; write 0 or more"),
        ("mixture: {robots: 3}", "write [least, most]"),
        ("mixture: {robots: [9, 3]}", "mine.yaml:1: robots of mixture is 9 to 3; write [3, 9]"),
        ("mixture:\n  grid: [5, 4]", "mine.yaml:2: grid of mixture is 5 to 4; write [4, 5]"),
        ("ppo: fast", "mine.yaml:1: ppo is the text 'fast'; write a mapping of clip"),
        ("device: tpu", "mine.yaml:1: device is 'tpu'; write cpu or cuda"),
        ("network: big", "mine.yaml: there is no network 'big'"),
        ("capabilities: 4", "mine.yaml: network 'any' serves any number of capabilities"),
        ("team_reward: {}", "mine.yaml: learning by rollouts knows no reward"),
        ("- worlds", "write a mapping of network"),
    ],
)
def test_mistakes_are_told_by_line(text: str, told: str, tmp_path: Path) -> None:
    with pytest.raises(TeamformerError) as error:
        read(tmp_path, text)
    assert told in str(error.value)


@pytest.mark.parametrize(
    ("mixture", "most"),
    [("{capabilities: [2, 5], crowds: 0}", 5), ("{capabilities: [4, 4]}", 60), ("{}", 60)],
)
def test_worlds_with_more_capabilities_than_the_network_knows_are_refused(
    tmp_path: Path, mixture: str, most: int
) -> None:
    text = f"network: deepset\ncapabilities: 4\nmethod: ppo\nmixture: {mixture}\n"
    with pytest.raises(TeamformerError) as error:
        read(tmp_path, text)
    told = f"mixture has worlds of {most} capabilities, and the network is made for 4"
    assert str(error.value) == f"{tmp_path / 'mine.yaml'}: {told}"
    assert error.value.hint == "write capabilities: [4, 4] and crowds: 0 in mixture"
    tried = text.replace(mixture, "{capabilities: [4, 4], crowds: 0}")
    assert read(tmp_path, tried).worlds_from.most_capabilities == 4


@pytest.mark.parametrize(
    "smallest",
    [
        Mixture(crowds=1.0, crowd_robots=(1, 1)),
        Mixture(
            robots=(1, 1), capabilities=(1, 1), tasks=(1, 1), crowds=0.0, grid=(1, 1), walls=1.0
        ),
    ],
)
def test_the_smallest_worlds_that_settings_allow_can_be_drawn(smallest: Mixture) -> None:
    worlds = training_worlds(smallest, 50, (0,))
    assert {len(world.robots) for world in worlds} == {1}


def test_an_unknown_name_is_told_with_the_nearest() -> None:
    with pytest.raises(TeamformerError, match="there are no settings 'gnn-c5'") as error:
        load_settings("gnn-c5")
    assert "'gnn-c4'" in error.value.hint
