"""What an agent says and does when it is called lost, shown a former life, or is doubled."""

from __future__ import annotations

from itertools import pairwise

import pytest

from fleets import agents_of, opened, pair, standing, trio
from small_worlds import make, robot, task
from teamformer.fleet.agent.agent import Agent
from teamformer.fleet.agent.voice import NAMESAKES
from teamformer.fleet.bodies.body import Report
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import (
    EVERYBODY,
    LIFE,
    LOST,
    OPERATOR,
    READY,
    SERVE,
    Beat,
    Message,
    Notice,
    Offer,
    PlanNote,
    Receipt,
    TaskFact,
    Word,
)
from teamformer.world.rules.constants import NOBODY


def beat_from(agent: Agent, sender: int, word: Word, others: tuple[Word, ...] = ()) -> Message:
    body = Beat(word, others, plan=agent.keeper.plan.version, digest=agent.knowledge.digest)
    return opened(agent.mission, sender, [Notice(EVERYBODY, body)])[0]


def said(notices: list[Notice]) -> Word:
    [beat] = [notice.body for notice in notices if isinstance(notice.body, Beat)]
    return beat.word


def test_who_is_called_lost_begins_another_life() -> None:
    agent = agents_of(trio())[0]
    agent.tick(0.0, standing(agent, 1), [])
    claim = beat_from(agent, 1, Word(1, 1), (Word(0, LOST + 1),))
    _, notices = agent.tick(0.1, standing(agent, 2), [claim])
    assert said(notices).version >= LIFE
    assert not said(notices).is_lost


def test_who_is_shown_a_former_life_begins_a_later_one() -> None:
    agent = agents_of(trio())[0]
    former = beat_from(agent, 1, Word(1, 1), (Word(0, 4 * LIFE + 17),))
    _, notices = agent.tick(0.1, standing(agent, 1), [former])
    assert said(notices).life == 5


def test_who_has_heard_nobody_says_that_it_is_fit_as_soon_as_it_hears_somebody() -> None:
    """Its word would else tell for up to a second that nobody is to count on it."""
    agent = agents_of(trio())[0]
    for tick in range(1, 70):
        agent.tick(tick / 10, standing(agent, tick), [])
    assert not agent.membership.is_fit
    _, notices = agent.tick(6.91, standing(agent, 70), [beat_from(agent, 1, Word(1, 1))])
    assert said(notices).is_fit


def test_who_hears_that_a_robot_has_heard_nobody_answers_at_once() -> None:
    agent = agents_of(trio())[0]
    agent.tick(0.0, standing(agent, 1), [])
    agent.tick(0.1, standing(agent, 2), [])
    _, notices = agent.tick(0.2, standing(agent, 2), [beat_from(agent, 1, Word(1, 1))])
    assert notices == []  # nothing to tell before the second is over
    unfit = beat_from(agent, 1, Word(1, 2, is_fit=False))
    _, notices = agent.tick(0.3, standing(agent, 2), [unfit])
    assert said(notices).robot == 0


def test_a_silent_robot_is_called_lost_and_a_plan_is_made_without_it() -> None:
    agent = agents_of(trio())[0]
    for tick in range(1, 130):
        now = tick / 10
        inbox = [beat_from(agent, 1, Word(1, tick))]
        agent.tick(now, standing(agent, tick), inbox)
    assert agent.knowledge.words[2].is_lost
    assert agent.membership.live() == {0, 1}
    plan = agent.keeper.plan
    assert (plan.version[0], plan.live) == (1, frozenset({0, 1}))
    assert set(plan.note.order) == {0, 4}  # what a and b can do
    assert set(plan.note.left_out) == {1, 2, 3}


def test_who_begins_another_life_is_told_once_more_who_is_lost() -> None:
    agent = agents_of(trio())[0]
    told = []
    for tick in range(1, 160):
        life = LIFE if tick > 140 else 0
        inbox = [beat_from(agent, 1, Word(1, life + tick))]
        _, notices = agent.tick(tick / 10, standing(agent, tick), inbox)
        beats = [notice.body for notice in notices if isinstance(notice.body, Beat)]
        told += [tick for beat in beats for word in beat.others if word.robot == 2 and word.is_lost]
    before, again = told
    assert before < 130
    assert 140 < again <= 152


def test_a_new_plan_holds_for_a_while() -> None:
    """Robot 2 is silent from 0 s on and robot 1 from 1 s: plans are `rest` seconds apart."""
    agent = agents_of(trio())[0]
    made = []
    for tick in range(1, 200):
        inbox = [beat_from(agent, 1, Word(1, tick))] if tick <= 10 else []
        agent.tick(tick / 10, standing(agent, tick), inbox)
        made.append(agent.keeper.made)
    assert made[-1] >= 2
    ticks = [made.index(number) for number in range(1, made[-1] + 1)]
    gaps = [later - sooner for sooner, later in pairwise(ticks)]
    assert min(gaps) >= 10 * agent.mission.timers.rest


def test_who_is_stuck_goes_on_trying_where_it_did_not_get() -> None:
    """It stands where a plan has it do a task, and then none has it do anything any more.

    If it were content there, it would never find out that it can move again.
    """
    agent = agents_of(trio())[0]
    there, here = (2.0, 0.0), (5.0, 0.0)  # where tasks 0 and 2 are; it stands at the latter
    for phase, (does, live, place) in enumerate(
        [((0,), (0, 1, 2), there), ((2,), (1, 2), here), ((), (1, 2), there)]
    ):
        coalitions = tuple((0,) for _ in does)
        others = tuple(key for key in range(5) if key not in does)
        note = PlanNote(10 * phase + 10, 1, live, does, coalitions, others)
        for tick in range(80 * phase + 1, 80 * phase + 81):
            inbox = [beat_from(agent, mate, Word(mate, tick)) for mate in (1, 2)]
            inbox += opened(agent.mission, 1, [Notice(EVERYBODY, note)])
            agent.tick(tick / 10, standing(agent, tick), inbox)
        assert (agent.command.place, agent.membership.is_stuck) == (place, True)


def test_who_is_unfit_by_its_body_is_not_counted_on_until_it_is_fit_again() -> None:
    """Robot 0 serves the only task, and robot 1 comes for it when the other one cannot."""
    mission = FleetMission(make([robot("a", 2), robot("a", 9)], [task("a", 2, duration=60)]))
    agents = agents_of(mission)
    places: list[tuple[float, float]] = [(2.0, 0.0), (9.0, 0.0)]
    inbox: list[list[Message]] = [[], []]
    serving = []
    for tick in range(1, 200):
        heard, inbox = inbox, [[], []]
        for me, agent in enumerate(agents):
            report = Report(*places[me], agent.command.leg, number=tick)
            is_unfit = me == 0 and 50 < tick <= 150
            command, notices = agent.tick(tick / 10, report._replace(is_unfit=is_unfit), heard[me])
            places[me] = command.place or places[me]
            inbox[1 - me] += opened(mission, me, notices)
        serving.append(tuple(agent.command.serve for agent in agents))
        if tick == 150:
            assert [agent.membership.live() for agent in agents] == [{1}, {1}]
    assert [serving[tick - 1] for tick in (50, 51, 150)] == [
        (True, False),
        (False, False),
        (False, True),
    ]
    assert [agent.membership.live() for agent in agents] == [{0, 1}, {0, 1}]


def test_a_lone_robot_that_is_unfit_leaves_its_task_until_it_is_fit_again() -> None:
    [agent] = agents_of(FleetMission(make([robot("a", 2)], [task("a", 2, duration=60)])))
    served = []
    for tick in range(1, 200):
        report = standing(agent, tick)._replace(is_unfit=50 < tick <= 100)
        agent.tick(tick / 10, report, [])
        served.append((agent.command.serve, agent.service.goal))
    assert served[48] == (True, 0)
    assert set(served[50:100]) == {(False, 0), (False, NOBODY)}
    assert served[99] == (False, NOBODY)
    assert served[-1] == (True, 0)


def test_who_was_away_itself_blames_nobody() -> None:
    agent = agents_of(trio())[0]
    for tick in range(1, 10):
        agent.tick(tick / 10, standing(agent, tick), [beat_from(agent, 1, Word(1, tick))])
    agent.tick(60.0, standing(agent, 10), [])
    assert agent.membership.live() == {0, 1, 2}
    assert agent.membership.is_fit


def test_the_younger_of_two_with_one_name_gives_way() -> None:
    older, younger = agents_of(pair(), now=0.0)[0], agents_of(pair(), now=50.0)[0]
    for tick in range(NAMESAKES + 1):
        now = 60.0 + tick
        words = [
            Beat(Word(0, tick + 1), nonce=9, uptime=50.0),
            Beat(Word(0, tick + 1), nonce=8, uptime=now - 60.0),
        ]
        for agent, word in zip((younger, older), words, strict=True):
            message = opened(agent.mission, 0, [Notice(EVERYBODY, word)])
            agent.tick(now, standing(agent, tick + 1), message)
    assert younger.is_refused
    assert not older.is_refused


def test_an_operators_task_is_held_and_said_so() -> None:
    agent = agents_of(trio())[0]
    task = TaskFact(5 << 24, "new", 3.0, 0.0, (1, 0, 0))
    offer = opened(agent.mission, OPERATOR, [Notice(EVERYBODY, Offer(task))])
    before = agent.memory_version
    _, notices = agent.tick(0.1, standing(agent, 1), offer)
    assert Notice(OPERATOR, Receipt(task.key)) in notices
    assert agent.memory_version != before  # it is written down before it is said
    assert agent.remember(1.0).added == (task,)


def test_who_leaves_says_so() -> None:
    agent = agents_of(trio())[2]
    agent.tick(0.0, standing(agent, 1), [])
    assert said(agent.leave(0.2)).is_lost


@pytest.mark.parametrize(("echoed", "phase"), [(True, SERVE), (False, READY)])
def test_service_begins_only_on_a_promise_made_after_the_own_word(echoed: bool, phase: int) -> None:
    agent = agents_of(pair())[0]
    goal = agent.mission.tasks[0]
    clock = 0.0

    def stand(inbox: list[Message]) -> Word:
        nonlocal clock
        clock += 1.5
        there = standing(agent, int(clock * 10))._replace(x=int(goal.x))
        agent.due = clock
        _, notices = agent.tick(clock, there, inbox)
        return said(notices)

    stand([])
    own = stand([beat_from(agent, 1, Word(1, 1, goal.x, 0.0, 0, 0, READY, True, 2.6))])
    echo = (0, own.version if echoed else own.version - 1_000)
    ready = Word(1, 2, goal.x, 0.0, 0, 0, READY, True, 2.6, echo)
    assert stand([beat_from(agent, 1, ready)]).phase == phase
