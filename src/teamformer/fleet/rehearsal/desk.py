"""The operators of a rehearsal: what they add and call off, and what of it is accepted."""

from __future__ import annotations

from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import Message
from teamformer.fleet.operator import Operator
from teamformer.fleet.rehearsal.checking.trace import Accepted, Trace
from teamformer.fleet.rehearsal.faults import Faults


class Desk:
    """All operators of one schedule, by number: those that add a task, then those that call off."""

    def __init__(self, mission: FleetMission, faults: Faults) -> None:
        orders = [Operator(order.task, mission.robots) for order in faults.orders]
        tasks = (mission.tasks[off.task] for off in faults.withdrawals)
        self.operators = orders + [Operator(it, mission.robots, calls_off=True) for it in tasks]
        self.times = [order.at for order in faults.orders]
        self.times += [off.at for off in faults.withdrawals]

    def accepted(self) -> set[int]:
        """Return the added tasks that operators were told are accepted."""
        return {it.task.key for it in self.operators if it.is_accepted and not it.calls_off}

    def hear(self, message: Message, now: float, trace: Trace) -> bool:
        """Let all hear a message; say whether something is accepted since."""
        is_news = False
        for operator in self.operators:
            was = operator.is_accepted
            operator.hear(message)
            if operator.is_accepted and not was:
                is_news = True
                if not operator.calls_off:
                    holders = tuple(sorted(operator.holders))
                    trace.events.append(Accepted(now, operator.task.key, holders))
        return is_news
