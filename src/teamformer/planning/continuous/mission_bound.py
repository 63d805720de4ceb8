"""What no plan of a mission in continuous time can beat, without a search for plans."""

from __future__ import annotations

from dataclasses import replace

from teamformer.mission.coordination import Known, known_at_start
from teamformer.mission.model import Mission, as_believed
from teamformer.planning.continuous.continuous_mission import pose_present
from teamformer.planning.continuous_bounds.makespan import refuter_of
from teamformer.planning.continuous_bounds.raising import MANY_TASKS
from teamformer.planning.continuous_bounds.relaxations import bound_by_chains_and_work, relax
from teamformer.planning.continuous_bounds.routes import COARSE, raise_by_routes
from teamformer.planning.problem.coalition_problem import NEVER


def bound_in_time(truth: Mission) -> float:
    """Return a time before which no plan is over, whoever knows the truth; 0 if nothing is sure.

    Optional tasks and those that are called off need not be done. Where robots are lost, nobody
    has to be home.
    """
    known = _what_has_to_be_done(truth)
    if not known.possible_tasks:
        return 0.0
    posed = pose_present(known)
    problem = posed.problem
    relaxation = relax(problem)
    bound = bound_by_chains_and_work(problem, relaxation)
    if bound >= NEVER:  # some task is never done
        return 0.0
    if len(posed.tasks) < MANY_TASKS:
        bound = raise_by_routes(problem, relaxation, bound, COARSE)
        bound = refuter_of(problem, relaxation).raised(bound)
    return posed.as_bound(bound)


def _what_has_to_be_done(truth: Mission) -> Known:
    """Return what is known of a mission at its start, with the tasks that have to be done."""
    is_lost = any(robot.absences for robot in truth.robots)
    mission = as_believed(truth, ends=None) if is_lost else truth
    tasks = tuple(k for k, t in enumerate(truth.tasks) if t.cancelled is None and not t.optional)
    return replace(known_at_start(mission), open_tasks=tasks)
