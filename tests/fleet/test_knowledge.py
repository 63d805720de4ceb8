"""Knowledge merges by taking the larger: in any order, any number of times."""

from __future__ import annotations

import random

from fleets import trio
from teamformer.fleet.agent.knowledge import MOST_ADDED, Knowledge, Remembered
from teamformer.fleet.messages import FactsNote, TaskFact, Word

ADDED = [TaskFact((number + 1) << 24, f"n{number}", 3.0, 0.0, (1, 0, 0)) for number in range(4)]


def fresh(remembered: Remembered | None = None) -> Knowledge:
    return Knowledge(trio(), 0, remembered or Remembered())


def test_facts_merge_in_any_order() -> None:
    rng = random.Random(1)
    notes = [FactsNote((0,)), FactsNote((2, ADDED[1].key), (ADDED[1],)), FactsNote((), (ADDED[0],))]
    digests = set()
    for _ in range(20):
        knowledge = fresh()
        said = rng.choices(notes, k=5) + rng.sample(notes, 3)
        rng.shuffle(said)
        for note in said:
            knowledge.merge(note, 0.0)
        assert knowledge.done == {0, 2, ADDED[1].key}
        assert knowledge.undone == {1, 3, 4, ADDED[0].key}
        digests.add(knowledge.digest)
    assert len(digests) == 1


def test_words_merge_by_version_and_nobody_speaks_for_me() -> None:
    knowledge = fresh()
    assert knowledge.hear_word(Word(1, 5, 3.0)) is not None
    assert knowledge.hear_word(Word(1, 5, 9.0)) is None
    assert knowledge.hear_word(Word(1, 4, 9.0)) is None
    assert knowledge.words[1].x == 3.0
    assert knowledge.hear_word(Word(0, 99)) is None


def test_a_task_that_nobody_knows_is_never_done() -> None:
    knowledge = fresh()
    assert not knowledge.mark_done(5, 0.0)
    assert not knowledge.mark_done(ADDED[0].key, 0.0)
    assert knowledge.refused == 2
    assert knowledge.done == set()


def test_senseless_tasks_are_refused() -> None:
    knowledge = fresh()
    key = 1 << 24
    for bad in (
        TaskFact(7, "number of the mission's", 3.0, 0.0, (1, 0, 0)),
        TaskFact(key, "off the map", 30.0, 0.0, (1, 0, 0)),
        TaskFact(key, "between two cells", 3.5, 0.0, (1, 0, 0)),
        TaskFact(key, "too few capabilities", 3.0, 0.0, (1, 0)),
    ):
        assert not knowledge.add_task(bad)
    assert knowledge.refused == 4


def test_nobody_can_fill_the_memory() -> None:
    knowledge = fresh()
    for number in range(MOST_ADDED + 10):
        knowledge.add_task(TaskFact((number + 1) << 24, "t", 3.0, 0.0, (1, 0, 0)))
    assert len(knowledge.added) == MOST_ADDED


def test_news_is_told_for_a_while() -> None:
    knowledge = fresh()
    knowledge.mark_done(2, 10.0)
    assert knowledge.news(13.9) == (2,)
    assert knowledge.news(14.1) == ()


def test_what_is_remembered_is_known_again() -> None:
    knowledge = fresh(Remembered(3, (1, ADDED[2].key), (ADDED[2],)))
    assert knowledge.done == {1, ADDED[2].key}
    assert knowledge.added == (ADDED[2],)
