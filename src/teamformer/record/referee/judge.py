"""Judging a record, step by step, by the rules of docs/explanation/step.md.

After something illegal the referee goes on from what the record says, so that one fault is told
once.
"""

from __future__ import annotations

from dataclasses import dataclass

from teamformer.record.record import Record, Step
from teamformer.record.referee.plans.moments import News, judge_moments
from teamformer.record.referee.plans.planned_forming import check_forming
from teamformer.record.referee.plans.planned_tasks import PlannedTasks, check_assignments
from teamformer.record.referee.plans.plans import judge_plans
from teamformer.record.referee.plans.pursuit import (
    check_named,
    check_pursuits,
    expect_pursuits,
    possible_pursuits,
)
from teamformer.record.referee.rules.completion import Tasks
from teamformer.record.referee.rules.delays import DelayDraws
from teamformer.record.referee.rules.finding import PlaceSearch
from teamformer.record.referee.rules.formation import (
    check_reach,
    due_losses,
    join_teams,
    lose_robots,
    return_robots,
    split_teams,
)
from teamformer.record.referee.rules.headway import Move, ShortestWays, check_headway
from teamformer.record.referee.rules.lifecycle import (
    judge_ending,
    judge_orders,
    start_fleet,
    why_over,
)
from teamformer.record.referee.rules.loads import follow_lost
from teamformer.record.referee.rules.rows import check_rows, judge_rows
from teamformer.record.referee.rules.teams import Fleet
from teamformer.record.referee.rules.truth import NeedsKnown, judge_truth
from teamformer.record.referee.rules.verdict import Notes, Verdict
from teamformer.record.referee.rules.walking import move_team


def judge(record: Record) -> Verdict:
    """Return everything in a record that breaks the rules."""
    notes = Notes()
    judge_truth(record, notes)
    judge_rows(record, notes)
    fleet = start_fleet(record, notes)
    tasks = Tasks(record.true_mission, record.mission, record.is_coordinated)
    knowledge, ways = (
        NeedsKnown(record.mission, record.foresight),
        ShortestWays(record.true_mission),
    )
    search = PlaceSearch(record.mission, ways, record.foresight)
    lists = PlannedTasks(record)
    referee = _Referee(fleet, tasks, knowledge, ways, search, lists, notes)
    delays, news, over = DelayDraws(record.true_mission), [News()], ""
    for number, step in enumerate(record.steps, start=1):
        notes.step = number
        if over:
            notes.note(f"{over}, and the record goes on")
            break
        due = due_losses(fleet, number)
        news.append(referee.judge_step(step, number, due, delays.draw()))
        over = why_over(fleet, tasks, number, bool(due))
    notes.step = 0
    judge_orders(record, tasks, notes)
    judge_moments(record, tasks, news, not over, notes)
    judge_plans(record, knowledge, search, news, notes)
    judge_ending(record, fleet, tasks, over, notes)
    findings = tuple(sorted(notes.findings, key=lambda finding: finding.step))
    return Verdict(findings, len(record.steps), len(tasks.done), tasks.cost(), tasks.lateness())


@dataclass(frozen=True)
class _Referee:
    """What is kept of a record while its steps are judged, one after the other."""

    fleet: Fleet
    tasks: Tasks
    knowledge: NeedsKnown
    ways: ShortestWays
    search: PlaceSearch
    lists: PlannedTasks
    notes: Notes

    def judge_step(self, step: Step, number: int, due: set[int], still: set[int]) -> News:
        """Judge a step in which robots are `due` to be lost and others stand `still`."""
        fleet, tasks, notes = self.fleet, self.tasks, self.notes
        slots, goals = set(fleet.teams), dict(self.ways.goals)
        before = {slot: team.task for slot, team in fleet.teams.items()}
        check_rows(step, notes)
        moves = self._form_and_move(step, number, due, still)
        any_cancelled = tasks.call_off(fleet, number)
        lose_robots(fleet, step, due, notes)
        follow_lost(fleet, step, notes)
        any_back = return_robots(fleet, step, number, notes)
        _check_entries(fleet, step, slots, notes)
        if due or any_back:
            robots = {robot for team in fleet.teams.values() for robot in team.robots}
            self.knowledge.expect(robots, number)
        is_elsewhere = self.search.go_on(fleet, tasks, self.lists.looked_at(), step, number, notes)
        any_shown = self.knowledge.show(fleet, tasks, step, number, notes)
        _complete(fleet, tasks, step, number, notes)
        self.ways.goals.update(tasks.loads.new_goals())
        _assign(fleet, tasks, step, number, notes)
        is_news = bool(due) or any_back or any_cancelled or is_elsewhere or any_shown
        check_assignments(fleet, tasks, number, is_news, notes)
        check_pursuits(fleet, tasks, step, before, number, notes)
        pursuits = possible_pursuits(fleet, step, before)
        check_headway(fleet, self.ways, goals, pursuits, moves, notes)
        self.lists.check_exchanges(fleet, step.took, number, notes)
        happened = {
            "robot lost": bool(due),
            "service broken off": tasks.any_broken_off,
            "robot back": any_back,
            "needs known": any_shown,
            "service overdue": tasks.any_overdue,
            "task found": number in self.search.news_after,
            "task cancelled": any_cancelled,
            "task done": bool(step.done),
        }
        reasons = tuple(reason for reason, has_happened in happened.items() if has_happened)
        return News(frozenset(due), reasons, _served(fleet))

    def _form_and_move(self, step: Step, number: int, due: set[int], still: set[int]) -> list[Move]:
        """Let teams part, join and walk, and return how they went."""
        fleet, notes = self.fleet, self.notes
        decided_at = {slot: team.at for slot, team in fleet.teams.items()}
        for team in fleet.teams.values():
            team.has_formed, team.met_at, team.walked_from = False, None, None
        self.lists.begin_step(number - 1)
        check_forming(fleet, self.lists, self.tasks, self.ways.goals, step, number, notes)
        split_teams(fleet, step, notes)
        met = [pair for pair in step.joins if _are_together(fleet, pair)]
        walked = tuple(pair for pair in step.joins if pair not in met)
        join_teams(fleet, tuple(met), notes)
        if fleet.mission.forming_steps > 0:
            join_teams(fleet, walked, notes)
            walked = ()
        check_reach(fleet, walked, notes)
        self.lists.give_tasks(fleet, self.tasks, number - 1)
        expect_pursuits(fleet, step.named)
        unions = self.lists.tasks_of_unions(fleet, walked)
        for team in fleet.teams.values():
            team.is_delayed = bool(team.robots & still)
        stood = {
            robot: (team.at,) if team.met_at is None else (team.at, team.met_at)
            for team in fleet.teams.values()
            for robot in team.robots
        }
        _move(fleet, step, walked, due, notes)
        self.lists.give_unions(fleet, unions)
        check_named(fleet, step.named, notes)
        now = {robot: team for team in fleet.teams.values() for robot in team.robots}
        return [
            Move(
                slot,
                at,
                stood[slot],
                team.at if team.is_way_told else None,
                team.met_at is not None,
            )
            for slot, at in decided_at.items()
            for team in [now[slot]]
        ]


def _served(fleet: Fleet) -> dict[int, frozenset[int]]:
    """Return what is being served, and by which robots."""
    return {task: frozenset(team.robots) for team in fleet.teams.values() for task in team.services}


def _complete(fleet: Fleet, tasks: Tasks, step: Step, number: int, notes: Notes) -> None:
    """Judge which tasks the record says were done."""
    recorded: dict[int, int] = {}
    for task, slot in step.done:
        if slot is None:
            notes.note(f"task {fleet.mission.tasks[task].name} is done by nobody")
            continue
        if task in recorded:
            notes.note(f"task {fleet.mission.tasks[task].name} is done twice")
        recorded[task] = slot
    heading = {entry.slot: entry.task for entry in step.teams}
    for task, slot in recorded.items():  # what is done is nobody's assignment any more
        if tasks.loads.is_load(task):
            heading[slot] = task
    tasks.complete(fleet, recorded, heading, number, notes)
    tasks.loads.compare(step, notes)


def _are_together(fleet: Fleet, pair: tuple[int, int]) -> bool:
    one, other = (fleet.teams.get(slot) for slot in pair)
    return one is not None and other is not None and fleet.is_at(one, other.at)


def _move(
    fleet: Fleet, step: Step, walked: tuple[tuple[int, int], ...], due: set[int], notes: Notes
) -> None:
    """Move all teams to where the record has them; those that meet on the way join then."""
    places = {entry.slot: (entry.x, entry.y) for entry in step.teams}
    walking = [pair for pair in walked if set(pair) <= fleet.teams.keys()]
    apart = fleet.teams.keys() - {slot for pair in walking for slot in pair}
    for slot in sorted(apart):
        team = fleet.teams[slot]
        after = _slot_after(team.robots, due) if due else slot
        team.is_way_told = after >= 0
        if team.is_way_told:
            # no entry: all is as it was in its slot, be it that of the one that it has joined
            stays = team.at if after == slot or team.met_at is None else team.met_at
            move_team(fleet, team, places.get(after, stays), notes)
    for pair in walking:
        teams = [fleet.teams[slot] for slot in pair]
        slot = _slot_after(teams[0].robots | teams[1].robots, due)
        same = slot if slot in pair else min(pair)  # no entry: that one has not moved
        place = places.get(slot, fleet.teams[same].at)
        for team in teams:
            move_team(fleet, team, place, notes, meets=True)
    join_teams(fleet, walked, notes)


def _slot_after(robots: set[int], due: set[int]) -> int:
    """Return the slot of a team of these robots after the step's losses; -1 if none is left."""
    return min(robots - due, default=-1)


def _check_entries(fleet: Fleet, step: Step, slots: set[int], notes: Notes) -> None:
    """Check that the record names every new team, no team twice and none that is not there."""
    seen: set[int] = set()
    for entry in step.teams:
        name = fleet.mission.robots[entry.slot].name
        if entry.slot in seen:
            notes.note(f"the record has the team of robot {name} in two places")
        seen.add(entry.slot)
        if entry.slot not in fleet.teams:
            notes.note(f"the record moves a team of robot {name} as its lowest; there is none")
            fleet.accept(entry.slot)
            if entry.slot in fleet.teams:
                fleet.teams[entry.slot].at = (entry.x, entry.y)
    for slot in sorted(fleet.teams.keys() - slots - seen):
        team = fleet.name(fleet.teams[slot])
        notes.note(f"{team} is new, and the record does not say where it is")


def _assign(fleet: Fleet, tasks: Tasks, step: Step, number: int, notes: Notes) -> None:
    """Take over the assignments that the record gives, and check them."""
    for entry in step.teams:
        if entry.slot in fleet.teams:
            fleet.teams[entry.slot].task = entry.task
    for team in fleet.teams.values():
        if team.task is not None and not tasks.is_open(team.task, number - 1):
            task = fleet.mission.tasks[team.task].name
            notes.note(f"{fleet.name(team)} heads for task {task}, which is not open")
            team.task = None
