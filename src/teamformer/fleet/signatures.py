"""A signature for each robot (Ed25519), so that no robot of the mission can speak for another.

A message is signed by who sends it. The words of others that a heartbeat relays carry the
signatures of who said them; the lost bit, which anybody may set, is not part of what is signed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from cryptography.exceptions import InvalidSignature, UnsupportedAlgorithm
from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey, Ed25519PublicKey
from cryptography.hazmat.primitives.serialization import load_pem_private_key, load_pem_public_key
from msgspec import DecodeError, Struct, ValidationError
from msgspec.msgpack import Decoder, Encoder
from msgspec.structs import replace

from teamformer.base.errors import TeamformerError
from teamformer.fleet.messages import LOST, MOST_RELAYED, OPERATOR, Beat, Message, Word
from teamformer.mission.model import Mission

OPERATORS_NAME = "operator"
"""Whose keys sign what operators say."""


class Signed(Struct, frozen=True, array_like=True):
    """A message with its sender's signature, and those of the words that it relays."""

    payload: bytes
    signature: bytes
    seals: tuple[bytes, ...] = ()


_ENCODE = Encoder().encode
_DECODER = Decoder(Signed)


class Signatures:
    """The keys of a mission's robots, and the own one; remembers which words were signed.

    `own` is None for who only listens. `public` has the keys by robot, OPERATOR for operators.
    """

    def __init__(
        self, mission: int, own: Ed25519PrivateKey | None, public: Mapping[int, Ed25519PublicKey]
    ) -> None:
        self._mission = mission.to_bytes(8, "big")
        self._own, self._public = own, public
        self._said: dict[int, tuple[bytes, bytes]] = {}  # each robot's newest word, its signature

    def wrap(self, message: Message, encode: Encoder) -> bytes:
        """Return a message as signed bytes; words that nobody has signed are not relayed."""
        assert self._own is not None, "who only listens says nothing"
        seals: list[bytes] = []
        body = message.body
        if type(body) is Beat:
            said = [(word, self._seal_of(word)) for word in body.others]
            kept = [(word, seal) for word, seal in said if seal is not None or never_spoke(word)]
            own = self._own.sign(self._text(body.word))
            seals = [own, *(seal or b"" for _, seal in kept)]
            body = replace(body, others=tuple(word for word, _ in kept))
            message = replace(message, body=body)
        payload = encode.encode(message)
        return _ENCODE(Signed(payload, self._own.sign(payload), tuple(seals)))

    def unwrap(self, data: bytes) -> Signed | None:
        """Return what signed bytes hold, not looked at yet; None if they hold nothing such."""
        try:
            signed = _DECODER.decode(data)
        except (DecodeError, ValidationError):
            return None
        return signed if len(signed.seals) <= MOST_RELAYED + 1 else None

    def fault_of(self, message: Message, signed: Signed) -> str:
        """Return what is wrong with the signatures of a message, or nothing."""
        if not self._is_by(message.sender, signed.payload, signed.signature):
            return "bad signature"
        body = message.body
        if type(body) is not Beat:
            return ""
        words = (body.word, *body.others)
        if len(words) != len(signed.seals):
            return "forged word"
        is_good = all(map(self._is_said, words, signed.seals))
        return "" if is_good else "forged word"

    def _is_said(self, word: Word, seal: bytes) -> bool:
        """Say whether a robot said a word; nobody has to have said that it never spoke."""
        if never_spoke(word):
            return True
        text = self._text(word)
        if self._said.get(word.robot) == (text, seal):
            return True
        if not self._is_by(word.robot, text, seal):
            return False
        if text >= self._said.get(word.robot, (b"", b""))[0]:  # the version comes first in it
            self._said[word.robot] = (text, seal)
        return True

    def _seal_of(self, word: Word) -> bytes | None:
        text, seal = self._said.get(word.robot, (b"", b""))
        return seal if text == self._text(word) else None

    def _is_by(self, robot: int, text: bytes, signature: bytes) -> bool:
        key = self._public.get(robot)
        if key is None:
            return False
        try:
            key.verify(signature, text)
        except InvalidSignature:
            return False
        return True

    def _text(self, word: Word) -> bytes:
        """Return what a robot signs of its word: its version first, without the lost bit."""
        version = word.version & ~LOST
        said = _ENCODE(replace(word, version=version) if version != word.version else word)
        return version.to_bytes(8, "big") + self._mission + said


def never_spoke(word: Word) -> bool:
    """Say whether a word is the one that is known of everybody before anything is said."""
    return word.version & ~LOST == 0


def read_signatures(folder: Path, source: Mission, mission: int, who: int | None) -> Signatures:
    """Return the keys in a folder: NAME.pub of every robot and of `operator`, and NAME.key of one.

    `who` is a robot's number, OPERATOR, or None for who only listens. Raises `TeamformerError` with
    the file that is missing or no key.
    """
    names = {number: robot.name for number, robot in enumerate(source.robots)}
    names[OPERATOR] = OPERATORS_NAME
    public = {}
    for number, name in names.items():
        key = _read(folder / f"{name}.pub", name, load_pem_public_key)
        if not isinstance(key, Ed25519PublicKey):
            raise _no_key(folder / f"{name}.pub", name)
        public[number] = key
    if who is None:
        return Signatures(mission, None, public)
    path = folder / f"{names[who]}.key"
    own = _read(path, names[who], lambda data: load_pem_private_key(data, None))
    if not isinstance(own, Ed25519PrivateKey):
        raise _no_key(path, names[who])
    if own.public_key().public_bytes_raw() != public[who].public_bytes_raw():
        raise TeamformerError(
            f"{path} does not belong to {names[who]}.pub",
            f"openssl pkey -in {names[who]}.key -pubout -out {names[who]}.pub",
        )
    return Signatures(mission, own, public)


def _read(path: Path, name: str, load: Callable[[bytes], object]) -> object:
    try:
        return load(path.read_bytes())
    except OSError as error:
        raise TeamformerError(
            f"{path}: cannot be read: {error.strerror}", _how_to_make(name)
        ) from None
    except (ValueError, TypeError, UnsupportedAlgorithm):
        raise _no_key(path, name) from None


def _no_key(path: Path, name: str) -> TeamformerError:
    return TeamformerError(f"{path}: this is no Ed25519 key in PEM", _how_to_make(name))


def _how_to_make(name: str) -> str:
    return (
        f"openssl genpkey -algorithm ed25519 -out {name}.key; "
        f"openssl pkey -in {name}.key -pubout -out {name}.pub"
    )
