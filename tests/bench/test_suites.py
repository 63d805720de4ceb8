"""Suites as data: what ships, what a user's own may say, what is refused."""

from __future__ import annotations

from pathlib import Path

import pytest

from teamformer.base.errors import TeamformerError
from teamformer.bench.report.claim_checks import ANY_FLEET, TABLE_1, method_for
from teamformer.bench.suites import cells, load_suite, names_of_suites, player_of
from teamformer.files.drawn.named_settings import size_of
from teamformer.methods.by_name import load_method

SHIPPED = [
    "authors",
    "charging",
    "clock",
    "fig3",
    "fig4a",
    "fig4b",
    "fig5a",
    "fig5b",
    "fig6",
    "fig9",
    "large",
    "learned",
    "methods",
    "missions",
    "optional",
    "paper",
    "roads",
    "scale",
    "shifts",
    "table1",
    "taught",
    "taught-c100",
    "taught-c4",
    "taught-c8",
    "uncertain",
    "zones",
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


def test_missions_with_loads_flights_and_due_dates_are_measured_undisturbed_and_disturbed() -> None:
    settings = load_suite("missions").settings
    for family in ("carry", "air-ground", "deadlines"):
        kinds = ("", "-lost", "-arrivals", "-ordered")
        assert {f"{family}{kind}" for kind in kinds} <= set(settings)


def test_the_suites_of_the_paper_measure_what_its_claims_are_judged_by() -> None:
    """Every method that a claim is judged by is bare, if it has learned, and in the suite."""
    measured = set(cells(load_suite("paper")))
    for setting in TABLE_1:
        capabilities = size_of(setting).capabilities
        compared = ("deepset", "gnn") if capabilities <= 8 else ()
        for family in ("teamformer", ANY_FLEET, "heuristic", *compared):
            assert (setting, method_for(family, setting)) in measured


def test_a_learned_method_plays_all_families_of_missions() -> None:
    suite = load_suite("missions")
    assert {(setting, "teamformer") for setting in suite.settings} <= set(cells(suite))


def test_the_paper_is_its_figures() -> None:
    suite = load_suite("paper")
    assert list(suite.settings) == PAPER_SETTINGS
    assert [part.name for part in suite.figures] == [
        name for name in SHIPPED if name.startswith("fig")
    ]
    assert ("8N20T-C8", "gnn-c8-ppo") in cells(suite)
    assert ("8N20T-C8", "gnn-c8-ppo-bare") in cells(suite)  # as the paper's: it has no guard
    assert ("4N20T-C4", "gnn-c4-ppo") in cells(suite)
    assert ("8N20T-C8", "gnn-c4-ppo") not in cells(suite)
    assert ("4N20+20T-C4-nn", "central") not in cells(suite)  # nobody can plan for what appears


def test_what_a_suite_leaves_out_can_be_asked_for(tmp_path: Path) -> None:
    suite = load_suite("paper")
    assert "central" in {method for _, method in cells(load_suite("fig3"))}
    assert "central" not in {method for _, method in cells(suite)}
    assert ("4N4T-C4", "central") in cells(suite, ["central"])
    (tmp_path / "mine.yaml").write_text("parts: [fig3]\nwithout: [gnn-c4-ppo, centrall]")
    with pytest.raises(TeamformerError, match="no part has the method 'centrall'"):
        load_suite(str(tmp_path / "mine.yaml"))


def test_the_paper_s_suites_keep_the_paper_s_rules() -> None:
    in_time = {"charging", "clock", "optional", "roads", "shifts", "zones"}
    ours = in_time | {"large", "learned", "methods", "missions", "uncertain"}
    for name in set(SHIPPED) - ours:
        suite = load_suite(name)
        assert (suite.rules, suite.method_settings) == ({}, {})
        methods = {method for _, method in cells(suite)} - {"central", "authors-heuristic"}
        assert [method for method in methods if load_method(method).coordinator] == []


def test_methods_and_settings_can_be_chosen() -> None:
    suite = load_suite("fig6")
    assert list(cells(suite, ["join-all"], ["100N20T-C100-R20", "100N20T-C100-R50"])) == [
        ("100N20T-C100-R20", "join-all"),
        ("100N20T-C100-R50", "join-all"),
    ]
    assert len(list(cells(suite))) == 4 * 7


def test_an_unknown_name_is_told_the_nearest() -> None:
    with pytest.raises(TeamformerError) as refused:
        load_suite("fig4")
    assert "fig4a" in refused.value.hint
    assert "fig4b" in refused.value.hint


def test_a_suite_of_one_s_own(tmp_path: Path) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text("settings: [6N5T-C3, 6N5T-C3-R2]\nmethods: [join-all]\ntrials: 7\n")
    suite = load_suite(str(path))
    assert suite.name == "mine"
    assert suite.trials == 7
    assert list(cells(suite)) == [("6N5T-C3", "join-all"), ("6N5T-C3-R2", "join-all")]


def test_a_method_may_play_with_several_settings() -> None:
    uncertain = load_suite("uncertain")
    for foresight in ("needed", "absent", "scouting"):
        assert uncertain.method_settings[f"plan@{foresight}"] == {"foresight": foresight}
        assert player_of(f"plan@{foresight}") == "plan"
    assert "heuristic" not in uncertain.method_settings
    assert player_of("heuristic") == "heuristic"


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("settings: [4N4T-C4]\npolices: [a]\n", "mine.yaml:2: the file has no key 'polices'"),
        ("settings: [4N]\nmethods: [a]\n", "mine.yaml:1: '4N' is no setting"),
        ("settings: [4N4T-C4-R5]\nmethods: [a]\n", "mine.yaml:1: requirements is 5"),
        ("settings: [4N4T-C4]\nmethods: [a]\ntrials: 0\n", "mine.yaml:3: trials is 0"),
        ("settings: [4N4T-C4]\nmethods: [a]\nfigure: pie\n", "mine.yaml:3: figure is 'pie'"),
        ("settings: [4N4T-C4]\nmethods: [a]\ntime_limit: -1\n", "mine.yaml:3: time_limit is -1"),
        ("settings: [4N4T-C4]\nmethods: [a]\nrules: {order: tsp}\n", "rules has no key 'order'"),
        ("settings: [4N4T-C4]\nmethods: [a]\nrules: {forming_steps: 2}\n", "up to 1"),
        (
            "settings: [4N4T-C4]\nmethods: [a]\nmethod_settings: {a: {foresight: abc}}\n",
            "mine.yaml:3: foresight is 'abc'; write needed",
        ),
        (
            "settings: [4N4T-C4]\nmethods: [a]\nmethod_settings: {a: {allocation: plan}}\n",
            "a of method_settings has no key 'allocation'",
        ),
        (
            "settings: [4N4T-C4]\nmethods: [a]\nmethod_settings: {b: {foresight: needed}}\n",
            "method_settings has no key 'b'",
        ),
        ("settings: [real-late]\nmethods: [a]\n", "'real-late' is no setting"),
        ("axes: [4N4T-C4]\nmethods: [a]\n", "mine.yaml:1: axes is a list"),
        ("axes: {speed: [4N4T-C4]}\nmethods: [a]\n", "axes has no key 'speed'"),
        ("parts: [fig3, mine.yaml]\n", "mine.yaml:1: there is no suite 'mine.yaml'"),
        ("parts: [fig3]\nsettings: [4N4T-C4]\n", "either parts or settings"),
        ("about: nothing\n", "needs settings and methods"),
        ("[]\n", "the file is a list"),
    ],
)
def test_what_is_wrong_is_told_by_line(tmp_path: Path, text: str, told: str) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(text)
    with pytest.raises(TeamformerError) as refused:
        load_suite(str(path))
    assert told in str(refused.value)
