"""Which robots stand still in which steps, by the seeds that the truth has for them."""

from __future__ import annotations

from teamformer.mission.model import Mission

ALL_BITS = 2**64 - 1


class DelayDraws:
    """Draws for every robot in every step, by a plain xorshift generator of 64 bits."""

    def __init__(self, mission: Mission) -> None:
        self._chances = {
            number: robot.delays.chance
            for number, robot in enumerate(mission.robots)
            if robot.delays is not None
        }
        self._states = {
            number: ((robot.delays.seed or 0) * 2654435769 + 88172645463325252) & ALL_BITS
            for number, robot in enumerate(mission.robots)
            if robot.delays is not None
        }

    def draw(self) -> set[int]:
        """Return the robots that stand still in the next step."""
        for robot, state in self._states.items():
            state ^= (state << 13) & ALL_BITS
            state ^= state >> 7
            state ^= (state << 17) & ALL_BITS
            self._states[robot] = state
        return {
            robot
            for robot, state in self._states.items()
            if (state >> 11) / 2**53 < self._chances[robot]
        }
