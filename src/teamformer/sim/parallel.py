"""The Team Formation Environment as a PettingZoo parallel environment: robots are the agents."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

import numpy as np

from teamformer.errors import TeamformerError
from teamformer.model import Scenario
from teamformer.scenarios.generate import Spec, generate
from teamformer.sim.actions import count_actions, legal_actions, wanted_from_action
from teamformer.sim.arrays import NOBODY, Array
from teamformer.sim.env import Decision, TeamFormation
from teamformer.sim.reward import Reward
from teamformer.sim.view import View

try:
    from gymnasium import spaces
    from pettingzoo import ParallelEnv
except ImportError as error:  # pragma: no cover - both are there wherever this is tested
    hint = "pip install 'teamformer[env]'"
    raise TeamformerError("PettingZoo and Gymnasium are not installed", hint) from error

SHARED = ("place", "counts", "is_at_task", "is_serving")
AROUND = ("seen_place", "seen_counts", "is_here", "can_join", "task_place", "task_needs")


class TeamFormationParallel(ParallelEnv[str, dict[str, Array], Any]):  # type: ignore[misc]
    """One world in which every robot is an agent, named as in the scenario.

    The lowest robot of a team decides for it; what its other members answer is ignored. All of
    them see their team's view and get its reward (eq. 1). A lost robot terminates and none is
    ever revived; everybody terminates when all is done or can never be, and is truncated at the
    step limit.

    `actions` is "counts" (the counts the team wants, which the scalable space spells) or
    "original" (2^(|C|+1) actions; observations then hold an `action_mask`). With a `Spec` each
    seeded reset draws a new world; with a `Scenario` the world is always the same.
    """

    metadata: ClassVar[dict[str, Any]] = {"name": "team_formation_v1", "render_modes": []}

    def __init__(
        self,
        source: Scenario | Spec,
        actions: Literal["counts", "original"] = "counts",
        reward: Reward | None = None,
    ) -> None:
        self._source = source
        self._reward = reward
        self._has_original_actions = actions == "original"
        self.render_mode = None
        self._rng = np.random.default_rng(0)
        self._make_world()
        self.possible_agents = [robot.name for robot in self._scenario.robots]
        self.agents: list[str] = []
        self._observation_space = self._make_observation_space()
        self._action_space = self._make_action_space()

    def observation_space(self, agent: str) -> spaces.Space[Any]:
        """Return what an agent sees: the arrays of its team's view, padded."""
        return self._observation_space

    def action_space(self, agent: str) -> spaces.Space[Any]:
        """Return what an agent may answer."""
        return self._action_space

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, dict[str, Array]], dict[str, dict[str, Any]]]:
        """Begin anew; a seed also decides the world that a `Spec` draws."""
        if seed is not None:
            self._rng = np.random.default_rng(seed)
        self._make_world()
        self.agents = list(self.possible_agents)
        self._look()
        return self._observations(), {agent: {} for agent in self.agents}

    def step(
        self, actions: dict[str, Any]
    ) -> tuple[
        dict[str, dict[str, Array]],
        dict[str, float],
        dict[str, bool],
        dict[str, bool],
        dict[str, dict[str, Any]],
    ]:
        """Make one step with the answers of the agents that are left."""
        self._env.step(self._decision(actions))
        slots = self._env.worlds.robots["team"][0]
        status = self._env.tally().status
        is_over = status in ("completed", "infeasible")
        lost = {agent for agent in self.agents if slots[self._number(agent)] == NOBODY}
        observed = self._observations()  # of the world before, for those who leave
        self._look()
        observed.update(self._observations())
        rewards = {
            agent: 0.0 if agent in lost else float(self._env.rewards[0, slots[self._number(agent)]])
            for agent in self.agents
        }
        terminations = {agent: is_over or agent in lost for agent in self.agents}
        truncations = {agent: status == "step limit" and agent not in lost for agent in self.agents}
        infos: dict[str, dict[str, Any]] = {agent: {} for agent in self.agents}
        observations = {agent: observed[agent] for agent in self.agents}
        self.agents = [a for a in self.agents if not (terminations[a] or truncations[a])]
        return observations, rewards, terminations, truncations, infos

    def _make_world(self) -> None:
        source = self._source
        self._scenario = generate(source, self._rng) if isinstance(source, Spec) else source
        self._env = TeamFormation([self._scenario], self._reward)
        self._look()

    def _look(self) -> None:
        view = self._env.view()
        self._view = View(*(array.copy() for array in view))
        self._row_of_slot = {int(slot): row for row, slot in enumerate(self._view.slot)}

    def _number(self, agent: str) -> int:
        return self.possible_agents.index(agent)

    def _decision(self, actions: dict[str, Any]) -> Decision:
        """Take each team's decision from its lowest robot; without an answer it maintains."""
        wanted = self._view.counts.copy()
        for slot, row in self._row_of_slot.items():
            answer = actions.get(self.possible_agents[slot])
            if answer is None:
                continue
            if self._has_original_actions:
                wanted[row] = wanted_from_action(self._view.counts[row], int(answer))
            else:
                wanted[row] = answer
        return Decision(wanted)

    def _observations(self) -> dict[str, dict[str, Array]]:
        """Return what each agent in a team of the latest view sees."""
        seen = {}
        for row in range(len(self._view.slot)):
            observation = self._observation(row)
            first, end = self._view.first_member[row], self._view.first_member[row + 1]
            for robot in self._view.member[first:end]:
                agent = self.possible_agents[robot]
                if agent in self.agents:
                    seen[agent] = observation
        return seen

    def _observation(self, row: int) -> dict[str, Array]:
        view = self._view
        observation = {
            name: np.asarray(getattr(view, name)[row], dtype=np.float32)
            for name in (*SHARED, *AROUND)
        }
        observation["seen_same_task"] = self._same(view.seen_task[row], view.task[row])
        observation["is_own_task"] = self._same(view.task_number[row], view.task[row])
        observation["is_team"] = np.asarray(view.seen_slot[row] != NOBODY, dtype=np.float32)
        observation["is_task"] = np.asarray(view.task_number[row] != NOBODY, dtype=np.float32)
        if self._has_original_actions:
            observation["action_mask"] = legal_actions(view, row).astype(np.int8)
        return observation

    def _same(self, tasks: Array, own: int) -> Array:
        return np.asarray((tasks == own) & (own != NOBODY), dtype=np.float32)

    def _make_observation_space(self) -> spaces.Dict:
        high = max(self._scenario.world.width, self._scenario.world.height, 30_000)
        boxes: dict[str, spaces.Space[Any]] = {}
        for name, array in self._observation(0).items():
            if name == "action_mask":
                boxes[name] = spaces.MultiBinary(len(array))
            else:
                boxes[name] = spaces.Box(0.0, float(high), array.shape, np.float32)
        return spaces.Dict(boxes)

    def _make_action_space(self) -> spaces.Space[Any]:
        brings = self._env.worlds.brings[0]
        if self._has_original_actions:
            return spaces.Discrete(count_actions(brings.shape[1]))
        return spaces.MultiDiscrete(brings.sum(axis=0, dtype=np.int64) + 1)
