"""The Team Formation Environment as a PettingZoo parallel environment: robots are the agents."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.errors import TeamformerError
from teamformer.base.extras import how_to_install
from teamformer.files.drawn.generate import Spec, generate
from teamformer.mission.arrivals import most_tasks
from teamformer.mission.model import Mission
from teamformer.mission.truth import draw_truth
from teamformer.world.env import Decision, TeamFormation
from teamformer.world.multi_agent.action_spaces import wanted_from_actions
from teamformer.world.multi_agent.drawing import RENDER_MODES, check_render_mode, draw
from teamformer.world.multi_agent.observing import Observation, Observer
from teamformer.world.reward import Reward
from teamformer.world.rules.constants import NEVER, NOBODY
from teamformer.world.state.arrays import RUNNING, STEP_LIMIT

try:
    from gymnasium import spaces
    from pettingzoo import ParallelEnv

    from teamformer.world.multi_agent.spaces import space_of_actions, space_of_observations
except ImportError as error:
    hint = how_to_install("env")
    raise TeamformerError("PettingZoo and Gymnasium are not installed", hint) from error

Everyone = dict[str, dict[str, Any]]


class TeamFormationParallel(ParallelEnv[str, Observation, Any]):  # type: ignore[misc]
    """One world in which every robot is an agent, named as in the mission.

    The lowest robot of a team decides for it; actions of its other members are ignored. All of
    them observe their team's view and get its reward (eq. 1). A lost robot terminates with a reward
    of 0 and its last observation, and never comes back as an agent. All agents terminate when
    everything is done or can never be done, and are truncated at the step limit.

    `actions` is "counts" (the counts that the team wants, as in the scalable space) or
    "original" (2^(|C|+1) actions; observations then have an `action_mask`). With a `Spec` every
    reset draws a new world of the same sizes. With a `Mission` the world is always the same, but
    every reset draws its uncertain values again.
    """

    metadata: ClassVar[dict[str, Any]] = {
        "name": "team_formation_v1",
        "render_modes": list(RENDER_MODES),
    }

    def __init__(
        self,
        source: Mission | Spec,
        actions: Literal["counts", "original"] = "counts",
        reward: Reward | None = None,
        render_mode: Literal["ansi", "rgb_array"] | None = None,
    ) -> None:
        if actions not in ("counts", "original"):
            raise TeamformerError(f"actions is '{actions}'; use counts or original")
        self._source = source
        self._reward = reward
        self._has_original_actions = actions == "original"
        self.render_mode = check_render_mode(render_mode)
        self._rng = np.random.default_rng(0)
        self._env = self._make_env()
        self.possible_agents = [robot.name for robot in self._env.missions[0].robots]
        self._look()
        self.agents: list[str] = []
        self._observations: dict[str, Observation] = {}
        robots = len(self.possible_agents)
        self._number = {name: robot for robot, name in enumerate(self.possible_agents)}
        self._observer = Observer(self._view, robots, robots, self._has_original_actions)
        self._observation_space = space_of_observations(
            self._observe_rows()[0], self._env.missions[0]
        )
        self._action_space = space_of_actions(self._env, source, self._has_original_actions)
        self.state_space = spaces.Box(NOBODY, np.inf, self.state().shape, np.float32)

    def observation_space(self, agent: str) -> spaces.Dict:
        """Return the space of observations: the arrays of a team's row in a `View`, padded."""
        return self._observation_space

    def action_space(self, agent: str) -> spaces.Space[Any]:
        """Return the space of actions."""
        return self._action_space

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Observation], Everyone]:
        """Start again. The seed decides this world and those of later resets without a seed."""
        if seed is not None:
            self._rng = np.random.default_rng(seed)
        if isinstance(self._source, Spec) or self._source.has_surprises:
            self._env = self._make_env()
        else:
            self._env.reset()
        self._look()
        self.agents = list(self.possible_agents)
        self._observations = {}
        self._observe()
        return dict(self._observations), {agent: {} for agent in self.agents}

    def step(
        self, actions: dict[str, Any]
    ) -> tuple[
        dict[str, Observation], dict[str, float], dict[str, bool], dict[str, bool], Everyone
    ]:
        """Make one step with the actions of the agents that are left."""
        self._env.step(self._decision(actions))
        self._look()
        slots = self._observe()
        status, is_gone = int(self._env.worlds.count["status"][0]), self._are_gone()
        is_ended, is_cut = status not in (RUNNING, STEP_LIMIT), status == STEP_LIMIT
        paid = self._env.rewards[0].tolist()
        observations, rewards, terminations, truncations = {}, {}, {}, {}
        infos: Everyone = {}
        for agent in self.agents:
            robot = self._number[agent]
            observations[agent], infos[agent] = self._observations[agent], {}
            rewards[agent] = 0.0 if slots[robot] == NOBODY else paid[slots[robot]]
            terminations[agent] = is_ended or is_gone[robot]
            truncations[agent] = is_cut and not is_gone[robot]
        self.agents = [a for a in self.agents if not (terminations[a] or truncations[a])]
        return observations, rewards, terminations, truncations, infos

    def _are_gone(self) -> list[bool]:
        """Return which robots are lost and will not be back."""
        robots, steps = self._env.worlds.robots[0], self._env.worlds.count["steps"][0]
        is_lost = robots["team"] == NOBODY
        if not is_lost.any():
            return [False] * len(robots)
        is_coming = (robots["back"] > steps) & (robots["back"] < NEVER)
        gone: list[bool] = (is_lost & ~is_coming).tolist()
        return gone

    def render(self) -> str | Array | None:
        """Return the world as lines of text (`ansi`) or pixels (`rgb_array`); None without mode."""
        return None if self.render_mode is None else draw(self._env, self.render_mode)

    def state(self) -> Array:
        """Return the whole world as one float32 vector, for a critic that sees everything.

        It has the actual values of everything uncertain. For each robot: its team's slot, place
        (x, y) and task, then what it brings (caps); all are -1 once it is lost. For each task,
        future ones included: whether it is open, whether it is done, its place, the steps of
        service left, and what it needs (caps). If tasks appear at random, the rows of those that
        do not appear are -1.
        """
        worlds = self._env.worlds
        robots, tasks = worlds.robots[0], worlds.tasks[0]
        team = worlds.teams[0, robots["team"]]  # (robots,)
        fleet = np.column_stack((robots["team"], team["x"], team["y"], team["task"]))
        fleet = np.hstack((fleet, worlds.brings[0]))  # (robots, 4 + caps)
        fleet[robots["team"] == NOBODY] = NOBODY
        left = np.where(tasks["server"] == NOBODY, 0, tasks["takes"] - tasks["served"])
        is_done = tasks["done_at"] != NOBODY
        places = np.array([task.at for task in self._env.truths[0].tasks], dtype=np.float64)
        work = np.column_stack((tasks["is_open"], is_done, places, left))
        needs = worlds.true_needs[0] if worlds.rules["hides_needs"][0] else worlds.needs[0]
        work = np.hstack((work, needs))  # (tasks, 5 + caps)
        more = most_tasks(self._source) - len(work) if isinstance(self._source, Mission) else 0
        work = np.vstack((work, np.full((more, work.shape[1]), NOBODY)))
        return np.concatenate((fleet, work), axis=None, dtype=np.float32)

    def _make_env(self) -> TeamFormation:
        source = self._source
        mission = generate(source, self._rng) if isinstance(source, Spec) else source
        truth = mission
        if mission.has_surprises:
            truth = draw_truth(mission, int(self._rng.integers(2**31)))
        return TeamFormation([mission], self._reward, truths=[truth])

    def _look(self) -> None:
        """View the world, one that has just ended too: a learner needs the last state's value."""
        status = self._env.worlds.count["status"]
        ended_as = int(status[0])
        status[0] = RUNNING
        self._view = self._env.view()
        status[0] = ended_as

    def _decision(self, actions: dict[str, Any]) -> Decision:
        """Take each team's decision from its lowest robot; without an answer it maintains."""
        counts = self._view.counts
        answers = [actions.get(self.possible_agents[slot]) for slot in self._view.slot.tolist()]
        if self._has_original_actions:
            numbers = [0 if answer is None else int(answer) for answer in answers]
            return Decision(wanted_from_actions(counts, np.array(numbers, np.int64)))
        both = zip(counts, answers, strict=True)
        wanted = [own if answer is None else answer for own, answer in both]
        return Decision(np.array(wanted).reshape(counts.shape))

    def _observe(self) -> list[int]:
        """Note what each robot sees that is in a team; return the slots of their teams.

        Members share the arrays; the lost keep what they saw last.
        """
        rows = dict(zip(self._view.slot.tolist(), self._observe_rows(), strict=True))
        slots: list[int] = self._env.worlds.robots["team"][0].tolist()
        for agent, slot in zip(self.possible_agents, slots, strict=True):
            if slot != NOBODY:
                self._observations[agent] = rows[slot]
        return slots

    def _observe_rows(self) -> list[Observation]:
        """Return what each team sees, in the order of the view."""
        self._observer.look(self._view)
        return self._observer.observations(len(self._view.slot))
