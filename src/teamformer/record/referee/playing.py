"""Plays a record's decisions again, by the reference step, and compares all that it tells."""

from __future__ import annotations

from teamformer.mission.coordination import TAKEN_OVER
from teamformer.record.decisions import Standing, rows_of, standing_after
from teamformer.record.record import Record, SharedPlanMade, Wants
from teamformer.record.referee.differences import Wording, first_difference
from teamformer.record.referee.plans import faults_of_plan
from teamformer.record.referee.reasons import is_order_due, why_plan
from teamformer.record.referee.told import Earlier, told_of
from teamformer.record.referee.verdict import Notes
from teamformer.world.reference.completion import give_up, may_give_up, status_of
from teamformer.world.reference.following import PlainPlan, follow_plan
from teamformer.world.reference.state import Units, Wish
from teamformer.world.reference.step import begin, make_step


class Play:
    """A record that is played again, as far as it keeps to the rules.

    `status` says how the mission stands: `running`, or why it is over.
    """

    def __init__(self, record: Record, notes: Notes) -> None:
        self._record, self._notes = record, notes
        self.world = begin(
            record.mission, record.true_mission, record.is_coordinated, record.foresight
        )
        self.status = status_of(self.world)
        self._orders, self._plans = dict(record.orders), dict(record.plans)
        self._scouts, self._decisions = dict(record.scouts), dict(record.decisions)
        self._standing: Standing = {}
        self._plan: PlainPlan | None = None
        self._wants: dict[int, Units] = {}  # what the plan wants of teams, by slot
        self._follows = _goes_by_plans(record)

    def begin(self) -> bool:
        """Take over the order and the plan that are made before the first step; say if it can."""
        return self._go_on() is not None

    def step(self, number: int) -> bool:
        """Play a step; say whether all is as the record tells, so that it can be played on."""
        self._notes.step = number
        world, before = self.world, Earlier(self.world)
        make_step(world, self._decide(number))
        self.status = status_of(world)
        told = told_of(self._record, number)
        difference = first_difference(world, before, before.told_by_rules(world), told)
        took = None if difference else self._go_on()
        if took is not None:
            self._give_up(told["missed"])
            after = {"took": tuple(took), "missed": tuple(world.happened.missed)}
            difference = first_difference(world, before, after, told)
        if difference:
            self._notes.note(difference)
        return took is not None and difference is None

    def _give_up(self, missed: tuple[int, ...]) -> None:
        """Let what is left be missed where the record says so, and that may be."""
        is_more = not set(missed).issubset(self.world.happened.missed)
        if is_more and self.status == "running" and may_give_up(self.world):
            give_up(self.world)
            self.status = status_of(self.world)

    def _decide(self, number: int) -> dict[int, Wish]:
        """Return what teams want in a step, and check that it is told in its form, and planned."""
        slots, rows = self.world.teams.keys(), self._decisions.get(number, ())
        standing = standing_after(self._standing, [r for r in rows if r.slot in slots], slots)
        wishes = {slot: Wish(self._units(row), row.task) for slot, row in standing.items()}
        is_exact = all(row.counts == self._counts(wishes[slot]) for slot, row in standing.items())
        if rows != rows_of(self._standing, standing, slots) or not is_exact:
            self._notes.note("what teams decide is not told once and in order, or no team can")
        self._standing = standing
        if self._follows:
            self._compare_with_plan(wishes)
        return wishes

    def _units(self, row: Wants) -> Units | None:
        if row.counts is None:
            return None
        caps = self.world.mission.capabilities
        return self.world.in_units(dict(zip(caps, row.counts, strict=True)))

    def _counts(self, wish: Wish) -> tuple[float, ...] | None:
        if wish.counts is None:
            return None
        mission = self.world.mission
        units = dict(zip(mission.capabilities, wish.counts, strict=True))
        return tuple(mission.out_of_units(units).values())

    def _compare_with_plan(self, wishes: dict[int, Wish]) -> None:
        """Check that teams want what the plan wants of them."""
        said = {slot: wish.counts for slot, wish in wishes.items()}
        slots = [slot for slot in said | self._wants if said.get(slot) != self._wants.get(slot)]
        for slot in sorted(slots)[:1]:
            team = Wording(self.world.mission).team(self.world.teams[slot].robots)
            wants, has = (self._words(wish.get(slot)) for wish in (self._wants, said))
            self._notes.note(f"by the plan {team} wants to {wants}; in the record, to {has}")

    def _words(self, counts: Units | None) -> str:
        if counts is None:
            return "stay as it is"
        mission = self.world.mission
        written = mission.out_of_units(dict(zip(mission.capabilities, counts, strict=True)))
        return f"have {', '.join(f'{count:g} x {cap}' for cap, count in written.items())}"

    def _go_on(self) -> list[tuple[int, int]] | None:
        """Take over the order and the plan that are made after a step, and check them.

        Returns the robots that exchanged their parts of the plan; None if there is no going on.
        """
        world, notes = self.world, self._notes
        made, plan = self._orders.get(world.steps), self._plans.get(world.steps)
        is_legal = self._check_moment(made, plan)
        took: list[tuple[int, int]] = []
        is_running = self.status == "running"
        if made is not None:
            if sorted(made) != sorted(world.shared_out()):
                notes.note(f"the order made after {world.steps} steps is not one of the open tasks")
                return None
            world.order = list(made)
        if self._plan is not None and is_running and (plan is None or _is_only_taken_over(plan)):
            self._wants, took = follow_plan(world, self._plan, is_new=False)
        if plan is not None and made is not None:
            self._take_over(made, plan)
        return took if is_legal else None

    def _take_over(self, order: tuple[int, ...], plan: SharedPlanMade) -> None:
        """Let teams go by a new plan, and check it."""
        world, scouts = self.world, self._scouts.get(self.world.steps)
        for fault in faults_of_plan(world, order, plan, scouts):
            self._notes.note(f"the plan made after {world.steps} steps {fault}")
        self._plan = PlainPlan(order, plan.coalitions, scouts or ())
        if self.status == "running":
            self._wants, _ = follow_plan(world, self._plan, is_new=True)

    def _check_moment(self, order: tuple[int, ...] | None, plan: SharedPlanMade | None) -> bool:
        """Check that an order and a plan are made after a step if, and only if, they are due."""
        world, record, found = self.world, self._record, list[str]()
        when = f"made after {world.steps} steps"
        if order is None and (is_order_due(world) or plan is not None):
            found.append(f"there is no order {when}, when tasks appeared or a plan was made")
        if order is not None and not is_order_due(world) and plan is None:
            found.append(f"there is an order {when}, when no task appeared")
        is_running = self.status == "running"
        due = why_plan(world, self._plan, record.heeds) if is_running else ()
        if record.is_coordinated and due and plan is None:
            found.append(f"there is no plan {when}, though: {', '.join(due)}")
        if plan is not None:
            own = tuple(why for why in plan.reasons if why != TAKEN_OVER)
            is_taken_over = plan.reasons == (*own, TAKEN_OVER) and is_running
            if plan.reasons != due and not (is_taken_over and own == due):
                said = ", ".join(plan.reasons)
                found.append(
                    f"the plan {when} says as its reason: {said}; it is: {', '.join(due) or 'none'}"
                )
        scouts = self._scouts.get(world.steps)
        if scouts is not None and (plan is None or not scouts or record.foresight != "scouting"):
            found.append(f"there are scouts of no plan {when}")
        for message in found:
            self._notes.note(message)
        return not found


def _is_only_taken_over(plan: SharedPlanMade) -> bool:
    """Say whether the plan before held until an operator took over another one."""
    return plan.reasons == (TAKEN_OVER,)


def _goes_by_plans(record: Record) -> bool:
    """Say whether teams decide by plans: some robots have a task, and no decision names one."""
    has_coalitions = any(any(plan.coalitions) for _, plan in record.plans)
    names = any(row.task is not None for _, rows in record.decisions for row in rows)
    return has_coalitions and not names
