"""The paper's network as it runs without torch: equal to torch, and what it refuses."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import onnx
import pytest
import torch

from spelling_views import CAPS, SPELLINGS, illegal_decisions, random_views, tensors, wild_network
from teamformer.base.array_types import Array
from teamformer.base.errors import TeamformerError
from teamformer.files.drawn.generate import Spec, generate
from teamformer.learning.export.autoregressive import export_teamformer
from teamformer.learning.nets.action_mask import changes, grammar_of, legal_symbols, spell
from teamformer.learning.nets.teamformer import Teamformer, Tokens
from teamformer.methods.learned.action_mask import next_symbols
from teamformer.methods.learned.autoregressive import (
    ENCODER_FILE,
    ENCODER_INPUTS,
    STEP_FILE,
    STEP_INPUTS,
    Speller,
    spelled_in,
)
from teamformer.methods.learned.onnx_sessions import OnnxNetwork
from teamformer.methods.learned.token_features import Spelled, SpellingCodec
from teamformer.trials.trial import run_trials
from teamformer.world.env import Decision, TeamFormation

CODEC = SpellingCodec(CAPS)


EXPORTED = [pytest.param(spelling, marks=pytest.mark.slow) for spelling in SPELLINGS]  # 20 s each


@pytest.fixture(scope="module", params=EXPORTED)
def exported(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> tuple[Teamformer, Path]:
    """Return a wild network and the folder that it was exported to."""
    network, folder = wild_network(request.param), tmp_path_factory.mktemp(request.param)
    export_teamformer(network, CAPS, folder)
    return network, folder


def speller(folder: Path, keeps_memories: bool = True) -> Speller:
    files = [(folder / file).read_bytes() for file in (ENCODER_FILE, STEP_FILE)]
    return Speller(*files, str(folder), keeps_memories)


def test_onnx_decides_as_torch_over_a_thousand_views(exported: tuple[Teamformer, Path]) -> None:
    network, folder = exported
    cached, uncached = speller(folder), speller(folder, keeps_memories=False)
    teams = 0
    for number, (view, _) in enumerate(random_views(30, 11, worlds=20)):
        tokens = CODEC.encode(view)
        with torch.no_grad():
            twin = network.act(tensors(tokens), None)[0].numpy()
        assert np.array_equal(cached(tokens), twin)
        if number < 5:  # every step of a decision spelt from its beginning takes long
            assert np.array_equal(uncached(tokens), twin)
        teams += len(twin)
    assert teams > 1000


def test_onnx_scores_every_step_as_torch_scores_all_at_once(
    exported: tuple[Teamformer, Path],
) -> None:
    network, folder = exported
    spelling = network.settings.spelling
    encode = OnnxNetwork((folder / ENCODER_FILE).read_bytes(), "encoder", ENCODER_INPUTS)
    step = OnnxNetwork((folder / STEP_FILE).read_bytes(), "step", STEP_INPUTS)
    generator, compared = torch.Generator().manual_seed(0), 0
    for view, _ in random_views(5, 12, worlds=20):
        tokens = CODEC.encode(view)
        given = Tokens(*tensors(tokens))
        with torch.no_grad():
            action, _ = network.act(given, generator)
            symbol, _ = spell(spelling, given.team_counts[:, 0], action)
            change = torch.cat(
                [torch.zeros(len(symbol), 1, CAPS), changes(spelling, symbol, CAPS)], 1
            )
            spelled = change.cumsum(dim=1)  # (teams, steps + 1, caps)
            twin, _ = network.decode(network.encode(given), change, spelled, None)
        encoded = encode(*tokens[:7])
        before = encoded[2][..., :0, :]
        for t in range(change.shape[1]):
            is_maintain = np.zeros(twin.shape[::2], dtype=np.bool_)
            now = (part[:, t : t + 1].numpy() for part in (change, spelled))
            scores, before = step(*now, is_maintain, *encoded, before)
            assert np.abs(scores - twin[:, t].numpy()).max() < 1e-5
            compared += len(scores)
    assert compared > 500


def test_what_may_come_next_is_the_same_without_torch() -> None:
    rng = np.random.default_rng(13)
    for view, _ in random_views(60, 14, worlds=6):
        tokens = CODEC.encode(view)
        given = Tokens(*tensors(tokens))
        for spelling in SPELLINGS:
            grammar = grammar_of(
                spelling, given.team_counts, given.can_join, given.singles, given.profiles
            )
            spelled = np.zeros((len(view.slot), CAPS), dtype=np.float32)
            for _ in range(6):
                twin = legal_symbols(spelling, grammar, torch.from_numpy(spelled)[:, None])
                found = next_symbols(spelling, tokens, spelled)
                assert np.array_equal(found.is_legal, twin[0][:, 0].numpy())
                assert np.array_equal(found.is_maintain, twin[1][:, 0].numpy())
                _spell_on(spelled, found.is_legal, rng)


def _spell_on(spelled: Array, is_legal: Array, rng: np.random.Generator) -> None:
    """Say a random legal symbol in each row; the end changes nothing."""
    symbol = np.where(is_legal, rng.random(is_legal.shape), -1.0).argmax(axis=1)
    for row in np.flatnonzero(symbol < is_legal.shape[1] - 1):
        spelled[row, symbol[row] % CAPS] += 1.0 if symbol[row] < CAPS else -1.0


def test_random_decisions_are_never_illegal() -> None:
    """Spellings at random: robots of several capabilities among them."""
    rng, teams, changed = np.random.default_rng(15), 0, 0
    for number, (view, env) in enumerate(random_views(20, 16, worlds=40)):
        tokens = CODEC.encode(view)
        spelling = SPELLINGS[number % 2]
        wanted = _wish_at_random(spelling, tokens, rng)
        teams, changed = teams + len(wanted), changed + (wanted != tokens.team_counts[:, 0]).sum()
        before = illegal_decisions(env)
        env.step(Decision(CODEC.decode(view, wanted)))
        assert illegal_decisions(env) == before
    assert teams > 1500
    assert changed > 700


def _wish_at_random(spelling: str, tokens: Spelled, rng: np.random.Generator) -> Array:
    spelled = np.zeros_like(tokens.singles)
    rows = np.arange(len(spelled))
    while len(rows):
        legal = next_symbols(spelling, Spelled(*(part[rows] for part in tokens)), spelled[rows])
        assert legal.is_legal.any(axis=1).all()
        now = spelled[rows]
        _spell_on(now, legal.is_legal, rng)
        goes_on = (now != spelled[rows]).any(axis=1)
        spelled[rows] = now
        rows = rows[goes_on]
    return spelled + tokens.team_counts[:, 0] if spelling == "edit" else spelled


def test_trials_end_with_a_folder_s_policy(exported: tuple[Teamformer, Path]) -> None:
    _, folder = exported
    policy = spelled_in(folder)
    rng = np.random.default_rng(17)
    worlds = [generate(Spec(3, 4, 3), rng) for _ in range(5)]  # fewer capabilities than it knows
    ended = run_trials(worlds, policy)
    assert [tally.status for tally in ended] == ["completed"] * 5
    assert sum(tally.illegal_decisions for tally in ended) == 0


def test_more_capabilities_than_it_knows_are_refused(exported: tuple[Teamformer, Path]) -> None:
    policy = spelled_in(exported[1])
    env = TeamFormation([generate(Spec(5, 2, 5), np.random.default_rng(0))])
    with pytest.raises(TeamformerError, match="knows 4 capabilities, the mission has 5") as refused:
        policy.decide(env.view())
    assert "teamformer" in refused.value.hint


def test_files_of_two_networks_are_refused(exported: tuple[Teamformer, Path]) -> None:
    encoder = (exported[1] / ENCODER_FILE).read_bytes()
    other = onnx.load_from_string((exported[1] / STEP_FILE).read_bytes())
    onnx.helper.set_model_props(other, {"spelling": "edit", "capabilities": "8", "part": "step"})
    with pytest.raises(TeamformerError, match="different networks"):
        Speller(encoder, other.SerializeToString(), "mixed")
    with pytest.raises(TeamformerError, match="takes"):
        Speller(encoder, encoder, "twice the same")
