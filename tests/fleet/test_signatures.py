"""Signatures: nobody speaks for another, relayed words are those that were said, bad keys told."""

from __future__ import annotations

from pathlib import Path

import pytest
from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey
from cryptography.hazmat.primitives.asymmetric.x25519 import X25519PrivateKey
from cryptography.hazmat.primitives.serialization import (
    Encoding,
    NoEncryption,
    PrivateFormat,
    PublicFormat,
)

from fleets import trio
from teamformer.base.errors import TeamformerError
from teamformer.fleet.messages import (
    EVERYBODY,
    LOST,
    OPERATOR,
    Beat,
    Body,
    FactsNote,
    Notice,
    Offer,
    Post,
    TaskFact,
    Word,
)
from teamformer.fleet.signatures import read_signatures

MISSION = trio()
NAMES = (*(robot.name for robot in MISSION.source.robots), "operator")


def write_private(path: Path, key: Ed25519PrivateKey | X25519PrivateKey) -> None:
    path.write_bytes(key.private_bytes(Encoding.PEM, PrivateFormat.PKCS8, NoEncryption()))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder with the keys of everybody; a robot's own would have one private key only."""
    for name in NAMES:
        key = Ed25519PrivateKey.generate()
        write_private(tmp_path / f"{name}.key", key)
        public = key.public_key().public_bytes(Encoding.PEM, PublicFormat.SubjectPublicKeyInfo)
        (tmp_path / f"{name}.pub").write_bytes(public)
    return tmp_path


def post_of(folder: Path, who: int | None, mission: int = MISSION.number) -> Post:
    signatures = read_signatures(folder, MISSION.source, mission, who)
    return Post(mission, MISSION.robots, signatures=signatures)


def said(post: Post, sender: int, body: Body) -> bytes:
    return post.seal(sender, Notice(EVERYBODY, body))


def test_what_a_robot_says_itself_is_heard(folder: Path) -> None:
    first, other = post_of(folder, 0), post_of(folder, 1)
    message = other.open(said(first, 0, Beat(Word(0, 3, goal=2), news=(1,))))
    assert message is not None
    assert (message.sender, message.body) == (0, Beat(Word(0, 3, goal=2), news=(1,)))
    assert other.open(said(first, 0, FactsNote(done=(1,)))) is not None
    assert not other.dropped


def test_a_robot_of_the_mission_cannot_speak_for_another(folder: Path) -> None:
    mad, other = post_of(folder, 1), post_of(folder, 2)
    assert other.open(said(mad, 0, Beat(Word(0, 9)))) is None
    assert other.open(said(mad, 0, FactsNote(done=(0, 1)))) is None
    assert (
        other.open(said(mad, OPERATOR, Offer(TaskFact(9 << 24, "x", 5.0, 0.0, (1, 0, 0))))) is None
    )
    assert other.dropped == {"bad signature": 3}


def test_words_are_relayed_with_their_speakers_signatures(folder: Path) -> None:
    """Robot 2 hears robot 0 from robot 1 only, and passes it on to robot 1's face as well."""
    posts = [post_of(folder, robot) for robot in range(3)]
    word = Word(0, 5, x=2.0, goal=1, phase=2, hold=2.6)
    assert posts[1].open(said(posts[0], 0, Beat(word))) is not None
    message = posts[2].open(said(posts[1], 1, Beat(Word(1, 1), (word,))))
    assert message is not None
    assert message.body == Beat(Word(1, 1), (word,))
    assert posts[0].open(said(posts[2], 2, Beat(Word(2, 1), (word,)))) is not None
    lost = Word(0, 5 | LOST, x=2.0, goal=1, phase=2, hold=2.6)  # anybody may claim that
    message = posts[2].open(said(posts[1], 1, Beat(Word(1, 2), (lost,))))
    assert message is not None
    assert message.body == Beat(Word(1, 2), (lost,))


def test_what_nobody_said_is_not_relayed(folder: Path) -> None:
    """The own post leaves it out, and others see through one that does not."""
    mad, other = post_of(folder, 1), post_of(folder, 2)
    true, false = Word(0, 5, goal=1), Word(0, 6, goal=2)
    assert mad.open(said(post_of(folder, 0), 0, Beat(true))) is not None
    message = other.open(said(mad, 1, Beat(Word(1, 1), (false,))))
    assert message is not None
    assert message.body == Beat(Word(1, 1), ())
    keys = mad.signatures
    assert keys is not None
    text, seal = keys._said[0]
    for forged in (false, Word(0, 5 | LOST, goal=2)):
        keys._said[0] = (keys._text(forged), seal)
        assert other.open(said(mad, 1, Beat(Word(1, 2), (forged,)))) is None
    assert other.dropped == {"forged word": 2}
    keys._said[0] = (text, seal)
    assert other.open(said(mad, 1, Beat(Word(1, 3), (true,)))) is not None


def test_a_word_of_another_mission_is_not_taken_for_one_of_this(folder: Path) -> None:
    elsewhere = post_of(folder, 1, MISSION.number ^ 1)
    word = Word(0, 7)
    assert elsewhere.open(said(post_of(folder, 0, MISSION.number ^ 1), 0, Beat(word))) is not None
    mad = post_of(folder, 1)
    assert mad.signatures is not None
    assert elsewhere.signatures is not None
    text = mad.signatures._text(word)
    mad.signatures._said[0] = (text, elsewhere.signatures._said[0][1])
    other = post_of(folder, 2)
    assert other.open(said(mad, 1, Beat(Word(1, 1), (word,)))) is None
    assert other.dropped == {"forged word": 1}


def test_who_never_spoke_may_be_called_lost(folder: Path) -> None:
    message = post_of(folder, 2).open(
        said(post_of(folder, 1), 1, Beat(Word(1, 1), (Word(0, LOST),)))
    )
    assert message is not None
    assert message.body == Beat(Word(1, 1), (Word(0, LOST),))


def test_signed_and_unsigned_do_not_mix(folder: Path) -> None:
    signed, plain = post_of(folder, 0), Post(MISSION.number, MISSION.robots)
    assert signed.open(said(plain, 1, Beat(Word(1, 1)))) is None
    assert plain.open(said(signed, 0, Beat(Word(0, 1)))) is None
    assert (signed.dropped, plain.dropped) == ({"not signed": 1}, {"not understood": 1})


def test_an_operator_signs_its_tasks(folder: Path) -> None:
    task = TaskFact(9 << 24, "x", 5.0, 0.0, (1, 0, 0))
    data = said(post_of(folder, OPERATOR), OPERATOR, Offer(task))
    assert post_of(folder, 1).open(data) is not None
    assert post_of(folder, None).open(data) is not None  # who only listens


def test_bad_keys_are_told(folder: Path) -> None:
    b_key, b_pub = folder / "r1.key", folder / "r1.pub"
    assert b_key.exists()
    sound = b_pub.read_bytes()
    b_pub.unlink()
    with pytest.raises(TeamformerError, match=r"r1\.pub: cannot be read") as told:
        post_of(folder, 0)
    assert "openssl genpkey -algorithm ed25519 -out r1.key" in (told.value.hint or "")
    b_pub.write_bytes(b"no key")
    with pytest.raises(TeamformerError, match=r"r1\.pub: this is no Ed25519 key"):
        post_of(folder, 0)
    b_pub.write_bytes((folder / "r0.pub").read_bytes())
    with pytest.raises(TeamformerError, match=r"does not belong to r1\.pub"):
        post_of(folder, 1)
    b_pub.write_bytes(sound)
    write_private(b_key, X25519PrivateKey.generate())
    with pytest.raises(TeamformerError, match=r"r1\.key: this is no Ed25519 key"):
        post_of(folder, 1)
