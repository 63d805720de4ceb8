"""How often a vehicle is told the same, and how long it rests."""

from __future__ import annotations

from teamformer.fleet.bodies.vda5050.tries import FAILURES, REST, UNANSWERED, Tries


def test_rests_grow_until_a_task_is_served() -> None:
    tries, now, rests = Tries(), 0.0, []
    for _ in range(3):
        for failure in range(FAILURES):
            assert not tries.rests(now)
            assert tries.fail("serve one", now) == (failure == FAILURES - 1)
        begun = now
        while tries.rests(now):
            assert not tries.is_due("serve one", now)
            now += 1.0
        rests.append(now - begun)
    assert rests == [REST, 2 * REST, 4 * REST]
    tries.recover()
    assert tries.rest == REST


def test_what_nothing_is_shown_of_goes_on_being_sent() -> None:
    tries = Tries()
    sent = [tries.send("go to 2, 3", 2.0 * number) for number in range(100)]
    assert sent == [number == UNANSWERED - 1 for number in range(100)]
    assert tries.is_due("go to 2, 3", 200.0)
    assert tries.rests(198.0 + REST - 1.0)
    assert not tries.rests(198.0 + REST)
    tries.answer("go to 2, 3")
    assert not tries.rests(199.0)
