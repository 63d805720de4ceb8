"""What robots say to one another: versioned, bounded, in MessagePack under a checksum.

Everything that is merged here merges by taking the larger, so that messages may be lost, doubled,
late and in any order.
"""

from __future__ import annotations

import hashlib
import hmac
import math
import zlib
from collections import Counter
from typing import TYPE_CHECKING, Annotated

from msgspec import DecodeError, Meta, Struct, ValidationError, field
from msgspec.msgpack import Decoder, Encoder

from teamformer.mission.parts.capabilities import is_exact
from teamformer.world.rules.constants import NOBODY

if TYPE_CHECKING:
    from teamformer.fleet.signatures import Signatures

PROTOCOL = 2
"""The version of the messages; others are dropped and counted."""

EVERYBODY = -1
OPERATOR = -2
"""Who a message is from or to, where it is no robot's number."""

LARGEST = 65_536  # bytes
MOST_RELAYED = 16
MOST_NEWS = 32
MOST_TASKS = 10_000
MOST_DEEDS = 256
MOST_NAME = 200
MOST_MOVES = 1_000_000
LONGEST = 1e9  # seconds
MOST = 100_000  # of a capability

WALK, HERE, READY, SERVE = range(4)
"""Phases of a service: on the way; there; there and bound to stay a while; at work."""

LOST = 1 << 32
LIFE = 1 << 33
"""A version of a word is `life * LIFE + lost * LOST + count`, so that the larger is the newer."""

Number = Annotated[int, Meta(ge=-2, le=1_000_000)]
Whole = Annotated[int, Meta(ge=0, le=2**62)]
Key = Annotated[int, Meta(ge=-1, le=2**62)]
Amount = Annotated[int, Meta(ge=0, le=MOST)] | Annotated[float, Meta(ge=0, le=MOST)]
"""How much of a capability, to three places."""


class Terms(Struct, frozen=True, array_like=True, gc=False):
    """What a robot also says of itself where there are zones or batteries."""

    plan: Whole = 0  # the digest of the plan that it follows
    charge: Annotated[float, Meta(ge=0, le=1)] = 1.0  # of a full battery
    charger: Number = NOBODY  # that it goes to, or is at
    since: Annotated[float, Meta(ge=0, le=LONGEST)] = LONGEST  # the mission's age when it was there


class Word(Struct, frozen=True, array_like=True, gc=False):
    """What a robot says about itself; only its lost bit may be set by others."""

    robot: Number
    version: Whole
    x: float = 0.0
    y: float = 0.0
    team: Number = NOBODY  # the lowest robot of the team it is in
    goal: Key = NOBODY  # the task it heads for or stands at
    phase: Annotated[int, Meta(ge=WALK, le=SERVE)] = WALK
    is_fit: bool = True
    hold: Annotated[float, Meta(ge=0, le=3600)] = 0.0  # seconds it stays from now, if READY
    echoes: Annotated[tuple[int, ...], Meta(max_length=128)] = ()  # robot, version heard, robot...
    has_served: bool = False  # its own part of the task that it serves is over
    terms: Terms | None = None

    @property
    def waits_at(self) -> int:
        """Return the charger at which the robot is to charge, or charges; NOBODY for none."""
        is_there = self.terms is not None and self.terms.since < LONGEST
        return self.terms.charger if self.terms is not None and is_there else NOBODY

    @property
    def life(self) -> int:
        """Return which life of the robot this is of."""
        return self.version // LIFE

    @property
    def is_lost(self) -> bool:
        """Say whether somebody, itself included, has called the robot lost in this life."""
        return bool(self.version & LOST)


class TaskFact(Struct, frozen=True, array_like=True):
    """A task that is known; a mission's have keys from 0, an operator's `origin << 24 | number`."""

    key: Whole
    name: Annotated[str, Meta(max_length=MOST_NAME)]
    x: float
    y: float
    needs: Annotated[tuple[Amount, ...], Meta(max_length=1000)]
    duration: Annotated[float, Meta(ge=0, le=LONGEST)] = 0.0  # seconds
    appears: Annotated[float, Meta(ge=0, le=LONGEST)] = 0.0  # seconds of the mission
    to: tuple[float, float] | None = None  # where its load is to be brought
    unload: Annotated[float, Meta(ge=0, le=LONGEST)] = 0.0  # seconds


class LoadFact(Struct, frozen=True, array_like=True, order=True):
    """Where the load of a task lies; of two such facts the one with the larger version holds."""

    key: Whole
    version: Annotated[int, Meta(ge=0, le=MOST_MOVES)]
    x: float
    y: float


class DeedFact(Struct, frozen=True, array_like=True):
    """A task that was done, as one of those saw it who did it."""

    key: Whole
    at: Annotated[float, Meta(ge=0, le=LONGEST)]  # seconds of the mission
    robots: Annotated[tuple[Number, ...], Meta(max_length=MOST_TASKS)]


PlanVersion = tuple[Whole, Whole, Whole]
"""(epoch, maker, digest): the largest holds."""


class Beat(Struct, frozen=True, array_like=True, tag=1):
    """A heartbeat: the own word, others' newest words, what was done lately, what is known."""

    word: Word
    others: Annotated[tuple[Word, ...], Meta(max_length=MOST_RELAYED)] = ()
    news: Annotated[tuple[Key, ...], Meta(max_length=MOST_NEWS)] = ()  # tasks done lately
    digest: Whole = 0  # of all facts
    plan: PlanVersion = (0, 0, 0)
    age: Annotated[float, Meta(ge=0, le=LONGEST)] = 0.0  # seconds of the mission
    nonce: Whole = 0  # which process speaks
    uptime: Annotated[float, Meta(ge=0, le=LONGEST)] = 0.0  # seconds since that process began


class NeedsFact(Struct, frozen=True, array_like=True):
    """What an uncertain task really needs, as somebody saw who stood there."""

    key: Whole
    needs: Annotated[tuple[Amount, ...], Meta(max_length=1000)]


class FactsNote(Struct, frozen=True, array_like=True, tag=2):
    """All that is known besides words and the plan, for who knows other facts.

    That is the tasks done and called off, those that operators added, loads that were moved, and
    needs that were seen.
    """

    done: Annotated[tuple[Key, ...], Meta(max_length=MOST_TASKS)]
    added: Annotated[tuple[TaskFact, ...], Meta(max_length=MOST_TASKS)] = ()
    digest: Whole = 0
    loads: Annotated[tuple[LoadFact, ...], Meta(max_length=MOST_TASKS)] = ()
    deeds: Annotated[tuple[DeedFact, ...], Meta(max_length=MOST_DEEDS)] = ()  # for onlookers
    called_off: Annotated[tuple[Key, ...], Meta(max_length=MOST_TASKS)] = ()
    needs: Annotated[tuple[NeedsFact, ...], Meta(max_length=MOST_TASKS)] = ()


class PlanNote(Struct, frozen=True, array_like=True, tag=3):
    """A plan: tasks in order, each with its coalition; the tasks that nobody can do.

    Those that it gives up may be left out, and others are worth more.
    """

    epoch: Whole
    maker: Whole
    live: Annotated[tuple[Number, ...], Meta(max_length=MOST_TASKS)]
    order: Annotated[tuple[Key, ...], Meta(max_length=MOST_TASKS)]
    coalitions: Annotated[tuple[tuple[Number, ...], ...], Meta(max_length=MOST_TASKS)]
    left_out: Annotated[tuple[Key, ...], Meta(max_length=MOST_TASKS)] = ()
    given_up: Annotated[tuple[Key, ...], Meta(max_length=MOST_TASKS)] = ()


class Offer(Struct, frozen=True, array_like=True, tag=4):
    """An operator's task, said until enough robots hold it."""

    task: TaskFact


class Receipt(Struct, frozen=True, array_like=True, tag=5):
    """A robot holds an operator's task, or that a task is called off."""

    key: Key
    is_called_off: bool = False


class LeadNote(Struct, frozen=True, array_like=True, tag=6):
    """What a policy wants of others: a team is to join the sender's, robots are to leave it."""

    calls: Number = NOBODY
    sends_off: Annotated[tuple[Number, ...], Meta(max_length=MOST_TASKS)] = ()


class CallOff(Struct, frozen=True, array_like=True, tag=7):
    """An operator calls a task off, and says so until enough robots hold it."""

    key: Key


Body = Beat | FactsNote | PlanNote | Offer | Receipt | LeadNote | CallOff


class Message(Struct, frozen=True, array_like=True):
    """What is sent: for which mission, from whom, to whom."""

    protocol: int
    mission: int
    sender: Number
    to: Number
    body: Body


class Notice(Struct, frozen=True):
    """What an agent wants sent: to everybody near, or to one."""

    to: int
    body: Body


class Post(Struct):
    """Seals and opens the messages of one mission; what does not open is counted and dropped.

    With a `secret` the seal is a keyed hash, so that only who has the secret can speak; without
    one it is a checksum against damage. With `signatures` every message is signed by its sender.
    """

    mission: int
    robots: int
    secret: bytes = b""
    signatures: Signatures | None = None
    dropped: Counter[str] = field(default_factory=Counter)

    def seal(self, sender: int, notice: Notice) -> bytes:
        """Return a message as bytes."""
        message = Message(PROTOCOL, self.mission, sender, notice.to, notice.body)
        if self.signatures is None:
            payload = _ENCODER.encode(message)
        else:
            payload = self.signatures.wrap(message, _ENCODER)
        return self._mark(payload) + payload

    def open(self, data: bytes) -> Message | None:
        """Return a message; None, counted in `dropped`, if it is none of this mission's."""
        message, fault = self.judge(data)
        if fault:
            self.dropped[fault] += 1
        return message

    def judge(self, data: bytes) -> tuple[Message | None, str]:
        """Return a message, or None and what is wrong with it."""
        if len(data) > LARGEST:
            return None, "too large"
        size = 16 if self.secret else 4
        payload = data[size:]
        if not hmac.compare_digest(data[:size], self._mark(payload)):
            return None, "bad seal"
        signed = None
        if self.signatures is not None:
            signed = self.signatures.unwrap(payload)
            if signed is None:
                return None, "not signed"
            payload = signed.payload
        try:
            message = _DECODER.decode(payload)
        except (ValidationError, DecodeError, RecursionError):
            return None, "not understood"
        if message.protocol != PROTOCOL:
            return None, "another protocol"
        if message.mission != self.mission:
            return None, "another mission"
        is_from_robot = 0 <= message.sender < self.robots
        is_from_operator = message.sender == OPERATOR and type(message.body) in (Offer, CallOff)
        if not is_from_robot and not is_from_operator:
            return None, "unknown sender"
        fault = _fault_of(message, self.robots)
        if not fault and self.signatures is not None and signed is not None:
            fault = self.signatures.fault_of(message, signed)
        return (None, fault) if fault else (message, "")

    def _mark(self, payload: bytes) -> bytes:
        if self.secret:
            return hmac.digest(self.secret, payload, hashlib.sha256)[:16]
        return zlib.crc32(payload).to_bytes(4, "big")


_ENCODER = Encoder()
_DECODER = Decoder(Message)


def _fault_of(message: Message, robots: int) -> str:
    """Return what makes a well-formed message senseless, or nothing."""
    body = message.body
    if type(body) is Beat:
        if body.word.robot != message.sender:
            return "speaks for another"
        for word in (body.word, *body.others):
            if not _is_sane(word, robots):
                return "senseless word"
    elif type(body) is PlanNote:
        members = [robot for coalition in body.coalitions for robot in coalition]
        if len(body.order) != len(body.coalitions) or len(set(body.order)) != len(body.order):
            return "senseless plan"
        if not all(0 <= robot < robots for robot in (*members, *body.live, body.maker)):
            return "senseless plan"
    elif type(body) is FactsNote:
        if not all(_is_task(task) for task in body.added):
            return "senseless task"
        if not all(is_exact(need) for seen in body.needs for need in seen.needs):
            return "senseless needs"
        if not all(math.isfinite(load.x + load.y) for load in body.loads):
            return "senseless load"
        if not all(0 <= robot < robots for deed in body.deeds for robot in deed.robots):
            return "senseless deed"
    elif type(body) is Offer and not _is_task(body.task):
        return "senseless task"
    return ""


def _is_sane(word: Word, robots: int) -> bool:
    return (
        0 <= word.robot < robots
        and word.team < robots
        and math.isfinite(word.x + word.y)
        and len(word.echoes) % 2 == 0
        and word.hold == word.hold
    )


def _is_task(task: TaskFact) -> bool:
    places = (task.x, task.y, *(task.to or ()))
    return all(map(math.isfinite, places)) and all(map(is_exact, task.needs))
