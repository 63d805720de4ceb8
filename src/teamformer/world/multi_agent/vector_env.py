"""Many worlds as one vector environment of Gymnasium, for learners whose robots share a policy."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.errors import TeamformerError
from teamformer.base.extras import how_to_install
from teamformer.files.drawn.generate import Spec, generate
from teamformer.mission.model import Mission
from teamformer.mission.truth import draw_truth
from teamformer.world.env import Decision, TeamFormation
from teamformer.world.multi_agent.action_spaces import wanted_from_actions
from teamformer.world.multi_agent.drawing import RENDER_MODES, check_render_mode, draw
from teamformer.world.multi_agent.observing import Observation, Observer, arrays_of, as_bytes
from teamformer.world.reward import Reward
from teamformer.world.rules.constants import NOBODY
from teamformer.world.state.arrays import RUNNING, STEP_LIMIT

try:
    from gymnasium.vector import AutoresetMode, VectorEnv
    from gymnasium.vector.utils import batch_space

    from teamformer.world.multi_agent.spaces import space_of_actions, space_of_observations
except ImportError as error:
    raise TeamformerError("Gymnasium is not installed", how_to_install("env")) from error


class TeamFormationVector(VectorEnv[Observation, Array, Array]):
    """Worlds in which every robot is an environment: robot `r` of world `w` is `w * robots + r`.

    A robot observes its team's row of the view and gets its team's reward (eq. 1). The lowest robot
    of a team decides for it: `infos["is_deciding"]` (robots,) says which actions count, so that a
    learner leaves the others out. A lost robot keeps its last observation and gets a reward of 0.
    All robots of a world terminate when everything is done or can never be done, and are truncated
    at the step limit; in the next step the world starts again, whatever the actions are.

    `actions` is "counts" or "original", as of `TeamFormationParallel`. With a `Spec` each start
    draws another world of the same sizes; with a `Mission` only its truth is drawn again. The
    arrays of observations and rewards are made once: copy what you keep.
    """

    metadata = {  # noqa: RUF012
        "render_modes": list(RENDER_MODES),
        "autoreset_mode": AutoresetMode.NEXT_STEP,
    }

    def __init__(
        self,
        source: Mission | Spec,
        worlds: int = 1,
        actions: Literal["counts", "original"] = "original",
        reward: Reward | None = None,
        threads: int = 1,
        render_mode: Literal["ansi", "rgb_array"] | None = None,
    ) -> None:
        self.render_mode = check_render_mode(render_mode)
        if actions not in ("counts", "original"):
            raise TeamformerError(f"actions is '{actions}'; use counts or original")
        if worlds < 1:
            raise TeamformerError(f"worlds is {worlds}; use 1 or more")
        if isinstance(source, Mission) and source.arrivals is not None:
            what = "a mission with arrivals has other sizes whenever it starts"
            raise TeamformerError(what, "use TeamFormationParallel for it")
        self._source, self._has_original_actions = source, actions == "original"
        self._rng = np.random.default_rng(0)
        missions, truths = zip(*(self._draw() for _ in range(worlds)), strict=True)
        self._env = TeamFormation(missions, reward, threads, truths)
        self._robots = self._env.worlds.robots.shape[1]
        self._is_over = np.zeros(worlds, dtype=np.bool_)
        self.num_envs = worlds * self._robots
        self._observer = Observer(
            self._env.view(), self.num_envs, self._robots, self._has_original_actions
        )
        seen_by = np.zeros_like(self._observer.rows)  # a row for each robot
        self._seen, self._rows = arrays_of(seen_by), as_bytes(seen_by)
        first = {name: array[0] for name, array in self._seen.items()}
        self.single_observation_space = space_of_observations(first, missions[0])
        self.single_action_space = space_of_actions(self._env, source, self._has_original_actions)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self._is_deciding = np.zeros(self.num_envs, dtype=np.bool_)
        self._observe()

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Start all worlds again; a seed decides these starts and the later ones."""
        if isinstance(seed, list):
            raise TeamformerError("the worlds draw from one seed", "give one number as seed")
        if seed is not None:
            self._rng = np.random.default_rng(seed)
        for w in range(len(self._is_over)):
            self._env.restart(w, *self._draw())
        self._is_over[:] = False
        self._observe()
        return self._seen, self._infos()

    def step(self, actions: Array) -> tuple[Observation, Array, Array, Array, dict[str, Any]]:
        """Make a step in every world with a row of `actions` (robots, ...) for each robot."""
        was_over = np.flatnonzero(self._is_over).tolist()
        self._env.step(self._decision(np.asarray(actions)))
        for w in was_over:
            self._env.restart(w, *self._draw())
        status = self._env.worlds.count["status"]
        self._is_over = status != RUNNING
        self._observe()
        ended, cut = self._is_over & (status != STEP_LIMIT), status == STEP_LIMIT
        slots = self._env.worlds.robots["team"]
        rewards = np.where(
            slots == NOBODY, 0.0, np.take_along_axis(self._env.rewards, slots.clip(0), axis=1)
        )
        both = (np.repeat(ended, self._robots), np.repeat(cut, self._robots))
        return self._seen, rewards.ravel(), *both, self._infos()

    def restart_ended(self) -> Observation:
        """Start ended worlds again now, not in the next step; return what robots see then."""
        for w in np.flatnonzero(self._is_over).tolist():
            self._env.restart(w, *self._draw())
        self._is_over[:] = False
        self._observe()
        return self._seen

    def render(self) -> tuple[Any, ...] | None:
        """Return each world as lines of text (`ansi`) or pixels (`rgb_array`), or None."""
        if self.render_mode is None:
            return None
        worlds = range(len(self._is_over))
        return tuple(draw(self._env, self.render_mode, w) for w in worlds)

    def action_masks(self) -> Array:
        """Return which original actions a robot may choose, as (robots, actions) bool.

        A robot whose action does not count can only maintain, so that nothing is learned from it.
        """
        if not self._has_original_actions:
            raise TeamformerError("counts have no masks", "use actions='original'")
        masks = self._seen["action_mask"].astype(np.bool_)
        masks[~self._is_deciding] = np.arange(masks.shape[1]) == 0
        return masks

    def close_extras(self, **kwargs: Any) -> None:
        """End the threads of the worlds."""
        self._env.close()

    def _draw(self) -> tuple[Mission, Mission]:
        """Return a mission to start and what it really is."""
        source, rng = self._source, self._rng
        mission = generate(source, rng) if isinstance(source, Spec) else source
        if not mission.has_surprises:
            return mission, mission
        return mission, draw_truth(mission, int(rng.integers(2**31)))

    def _look(self) -> None:
        """View all worlds, those that have just ended, too: learners need that state."""
        status = self._env.worlds.count["status"]
        ended_as = status.copy()
        status[:] = RUNNING
        self._view = self._env.view()
        status[:] = ended_as

    def _observe(self) -> None:
        """Give each robot that is in a team what its team sees; the lost keep what they saw."""
        self._look()
        self._observer.look(self._view)
        view, slots = self._view, self._env.worlds.robots["team"]
        row_of = np.full(slots.shape, NOBODY)  # by slot
        row_of[view.world, view.slot] = np.arange(len(view.slot))
        own_row = np.take_along_axis(row_of, slots.clip(0), axis=1)[slots != NOBODY]  # by robot
        there = np.flatnonzero(slots.ravel() != NOBODY)
        self._rows[there] = self._observer.bytes[own_row]
        self._is_deciding = (slots == np.arange(self._robots)).ravel()

    def _infos(self) -> dict[str, Any]:
        return {"is_deciding": self._is_deciding}

    def _decision(self, actions: Array) -> Decision:
        """Return what the lowest robot of each team wants."""
        view = self._view
        rows = actions[view.world * self._robots + view.slot]
        return Decision(
            wanted_from_actions(view.counts, rows) if self._has_original_actions else rows
        )
