"""Which robots of a fleet an onlooker has not heard for a while."""

from __future__ import annotations

from teamformer.live.running.alerts import ALL, Alert, robot_key

SILENCE = 10.0
"""Seconds without any word of a robot after which it counts as not heard."""

QUESTION = "does the fleet run, and are its mission, endpoint and --keys the same here?"


class Silence:
    """When each robot was heard last; no clock: every moment is said, in seconds."""

    def __init__(self, names: tuple[str, ...], now: float) -> None:
        self._names = names
        self._heard_at = [now] * len(names)
        self._fault = ""
        self.was_any_heard = False

    def hear(self, robot: int, now: float) -> None:
        """Note that a message of a robot has come."""
        self._heard_at[robot] = now
        self.was_any_heard = True

    def refuse(self, fault: str) -> None:
        """Note that a message has come that is none of the fleet's, and why."""
        self._fault = fault

    def alerts(self, now: float) -> list[Alert]:
        """Return which robots are not heard: each, or all in one."""
        silent = [robot for robot, at in enumerate(self._heard_at) if now - at > SILENCE]
        if silent and len(silent) == len(self._names):
            why = f"what came was refused: {self._fault}" if self._fault else "nothing comes here"
            if not self.was_any_heard:
                why += "; what is drawn is only where the robots start"
            return [Alert(ALL, "no robot heard", why, QUESTION, max(self._heard_at))]
        return [
            Alert(
                robot_key(robot),
                f"{self._names[robot]} not heard",
                "no message of its own has come here",
                "look at its agent and at its radio",
                self._heard_at[robot],
            )
            for robot in silent
        ]
