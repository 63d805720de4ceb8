"""Messages open as they were sealed, and nothing else opens."""

from __future__ import annotations

import pytest

from teamformer.fleet.messages import (
    EVERYBODY,
    LARGEST,
    LIFE,
    LOST,
    OPERATOR,
    Beat,
    FactsNote,
    Notice,
    Offer,
    PlanNote,
    Post,
    Receipt,
    TaskFact,
    Word,
)

WORD = Word(1, 2 * LIFE + 7, 3.0, 4.0, 0, 5, 2, True, 2.6, (0, 12))
TASK = TaskFact(1 << 24, "new", 1.0, 2.0, (1, 0), 3.0)
BODIES = [
    Beat(WORD, (Word(0, 12),), (3,), 99, (4, 1, 8), 12.5, 77, 3.0),
    FactsNote((1, 2), (TASK,), 5),
    PlanNote(3, 1, (0, 1), (4, 2), ((0,), (0, 1)), (9,)),
    Receipt(1 << 24),
]


def post(mission: int = 42, secret: bytes = b"") -> Post:
    return Post(mission, robots=3, secret=secret)


@pytest.mark.parametrize("body", BODIES, ids=lambda body: type(body).__name__)
@pytest.mark.parametrize("secret", [b"", b"0123456789abcdef"])
def test_a_message_opens_as_it_was_sealed(body: Beat, secret: bytes) -> None:
    message = post(secret=secret).open(post(secret=secret).seal(1, Notice(EVERYBODY, body)))
    assert message is not None
    assert (message.sender, message.to, message.body) == (1, EVERYBODY, body)


def test_a_version_is_made_of_life_loss_and_count() -> None:
    assert (WORD.life, WORD.is_lost) == (2, False)
    assert Word(0, LIFE + LOST + 3).is_lost
    assert LIFE + LOST + 3 > LIFE + 1_000_000  # who is lost is so whatever it has said before
    assert 2 * LIFE > LIFE + LOST + 3  # but not in its next life


def test_every_damaged_bit_is_noticed() -> None:
    sealed = post().seal(1, Notice(EVERYBODY, BODIES[0]))
    reader = post()
    for place in range(8 * len(sealed)):
        damaged = bytearray(sealed)
        damaged[place // 8] ^= 1 << place % 8
        assert reader.open(bytes(damaged)) is None
    assert reader.dropped == {"bad seal": 8 * len(sealed)}


def test_cut_messages_and_noise_are_noticed() -> None:
    sealed, reader = post().seal(1, Notice(EVERYBODY, BODIES[2])), post()
    for length in range(len(sealed)):
        assert reader.open(sealed[:length]) is None
    assert reader.open(b"\x00" * (LARGEST + 1)) is None
    assert reader.dropped["too large"] == 1


def refused(body: object, sender: int = 1) -> str:
    sealed = post().seal(sender, Notice(EVERYBODY, body))  # type: ignore[arg-type]
    message, fault = post().judge(sealed)
    assert message is None
    return fault


def test_what_makes_no_sense_is_refused() -> None:
    nan = float("nan")
    assert refused(BODIES[0], sender=2) == "speaks for another"
    assert refused(Beat(Word(1, 1, nan))) == "senseless word"
    assert refused(Beat(Word(1, 1), (Word(3, 1),))) == "senseless word"
    assert refused(BODIES[0], sender=3) == "unknown sender"
    assert refused(BODIES[0], sender=OPERATOR) == "unknown sender"
    assert refused(PlanNote(1, 0, (0,), (1, 1), ((0,), (0,)))) == "senseless plan"
    assert refused(PlanNote(1, 0, (0,), (1,), ((7,),))) == "senseless plan"
    assert refused(PlanNote(1, 0, (0,), (1, 2), ((0,),))) == "senseless plan"
    assert refused(FactsNote((), (TaskFact(1 << 24, "x", nan, 0, ()),))) == "senseless task"
    assert refused(Offer(TaskFact(1 << 24, "x", 0, nan, ()))) == "senseless task"
    many = tuple(Word(0, 1) for _ in range(17))
    assert refused(Beat(Word(1, 1), many)) == "not understood"


def test_other_missions_and_keys_are_refused() -> None:
    sealed = post().seal(1, Notice(EVERYBODY, BODIES[0]))
    assert post(mission=43).judge(sealed)[1] == "another mission"
    assert post(secret=b"0123456789abcdef").judge(sealed)[1] == "bad seal"
    assert post(secret=b"another-key-of-it").judge(
        post(secret=b"0123456789abcdef").seal(1, Notice(EVERYBODY, BODIES[0]))
    ) == (None, "bad seal")
