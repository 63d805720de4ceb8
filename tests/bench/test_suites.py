"""Suites as data: what ships, what a user's own may say, what is refused."""

from __future__ import annotations

from pathlib import Path

import pytest

from teamformer.bench.suites import cells, load_suite, names_of_suites, player_of
from teamformer.errors import TeamformerError

SHIPPED = [
    "authors",
    "fig3",
    "fig4a",
    "fig4b",
    "fig5a",
    "fig5b",
    "fig6",
    "fig9",
    "fleet",
    "missions",
    "paper",
    "scale",
    "table1",
    "taught",
    "taught-c100",
    "taught-c4",
    "taught-c8",
    "uncertain",
]

PAPER_SETTINGS = [
    "4N4T-C4",
    "4N20T-C4",
    "20N100T-C4",
    "8N20T-C8",
    "24N100T-C8",
    "100N20T-C100-R10",
    "100N20T-C100-R20",
    "100N20T-C100-R50",
    "100N20T-C100-R90",
    "4N20+20T-C4-tsp",
    "4N20+20T-C4-nn",
]


def test_every_suite_that_ships_can_be_read() -> None:
    assert names_of_suites() == SHIPPED
    for name in SHIPPED:
        suite = load_suite(name)
        assert suite.settings
        assert list(cells(suite))


def test_the_paper_is_its_figures() -> None:
    suite = load_suite("paper")
    assert list(suite.settings) == PAPER_SETTINGS
    assert [part.name for part in suite.figures] == SHIPPED[1:8]
    assert ("8N20T-C8", "gnn-c8-ppo") in cells(suite)
    assert ("4N20T-C4", "gnn-c4-ppo") in cells(suite)
    assert ("8N20T-C8", "gnn-c4-ppo") not in cells(suite)
    assert ("4N20+20T-C4-nn", "central") not in cells(suite)  # nobody can plan for what appears


def test_the_paper_s_suites_keep_the_paper_s_rules() -> None:
    for name in set(SHIPPED) - {"fleet", "missions", "uncertain"}:
        assert load_suite(name).rules == {"order": "tsp", "allocation": "paper"}
    assert load_suite("fleet").rules == {"order": "schedule", "allocation": "crews"}


def test_policies_and_settings_can_be_chosen() -> None:
    suite = load_suite("fig6")
    assert list(cells(suite, ["join-all"], ["100N20T-C100-R20", "100N20T-C100-R50"])) == [
        ("100N20T-C100-R20", "join-all"),
        ("100N20T-C100-R50", "join-all"),
    ]
    assert len(list(cells(suite))) == 4 * 5


def test_an_unknown_name_is_told_the_nearest() -> None:
    with pytest.raises(TeamformerError) as refused:
        load_suite("fig4")
    assert "fig4a" in refused.value.hint
    assert "fig4b" in refused.value.hint


def test_a_suite_of_one_s_own(tmp_path: Path) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text("settings: [6N5T-C3, 6N5T-C3-R2]\npolicies: [join-all]\ntrials: 7\n")
    suite = load_suite(str(path))
    assert suite.name == "mine"
    assert suite.trials == 7
    assert list(cells(suite)) == [("6N5T-C3", "join-all"), ("6N5T-C3-R2", "join-all")]


def test_policies_meet_rules_of_their_own() -> None:
    missions = load_suite("missions")
    assert missions.rules_for("plan") == {"order": "tsp", "allocation": "plan"}
    assert missions.rules_for("central") == {"order": "tsp", "allocation": "plan"}
    assert missions.rules_for("crews") == {"order": "tsp", "allocation": "crews"}
    assert missions.rules_for("heuristic") == {"order": "tsp", "allocation": "paper"}


def test_a_policy_may_play_under_several_rules() -> None:
    uncertain = load_suite("uncertain")
    for foresight in ("needed", "absent", "scouting"):
        rules = {"order": "tsp", "allocation": "plan", "foresight": foresight}
        assert uncertain.rules_for(f"plan@{foresight}") == rules
        assert player_of(f"plan@{foresight}") == "plan"
    assert player_of("heuristic") == "heuristic"


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("settings: [4N4T-C4]\npolices: [a]\n", "mine.yaml:2: the file has no key 'polices'"),
        ("settings: [4N]\npolicies: [a]\n", "mine.yaml:1: '4N' is no setting"),
        ("settings: [4N4T-C4-R5]\npolicies: [a]\n", "mine.yaml:1: requirements is 5"),
        ("settings: [4N4T-C4]\npolicies: [a]\ntrials: 0\n", "mine.yaml:3: trials is 0"),
        ("settings: [4N4T-C4]\npolicies: [a]\nfigure: pie\n", "mine.yaml:3: figure is 'pie'"),
        ("settings: [4N4T-C4]\npolicies: [a]\ntime_limit: -1\n", "mine.yaml:3: time_limit is -1"),
        ("settings: [4N4T-C4]\npolicies: [a]\nrules: {order: abc}\n", "order is 'abc'; write tsp"),
        ("settings: [4N4T-C4]\npolicies: [a]\nrules: {forming_steps: 2}\n", "up to 1"),
        (
            "settings: [4N4T-C4]\npolicies: [a]\npolicy_rules: {a: {order: abc}}\n",
            "mine.yaml:3: order is 'abc'; write tsp",
        ),
        (
            "settings: [4N4T-C4]\npolicies: [a]\npolicy_rules: {b: {order: tsp}}\n",
            "policy_rules has no key 'b'",
        ),
        ("settings: [real-late]\npolicies: [a]\n", "'real-late' is no setting"),
        ("axes: [4N4T-C4]\npolicies: [a]\n", "mine.yaml:1: axes is a list"),
        ("axes: {speed: [4N4T-C4]}\npolicies: [a]\n", "axes has no key 'speed'"),
        ("parts: [fig3, mine.yaml]\n", "mine.yaml:1: there is no suite 'mine.yaml'"),
        ("parts: [fig3]\nsettings: [4N4T-C4]\n", "either parts or settings"),
        ("about: nothing\n", "needs settings and policies"),
        ("[]\n", "the file is a list"),
    ],
)
def test_what_is_wrong_is_told_by_line(tmp_path: Path, text: str, told: str) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(text)
    with pytest.raises(TeamformerError) as refused:
        load_suite(str(path))
    assert told in str(refused.value)
