"""Teamformer: decentralised team formation for heterogeneous multi-robot teams.

>>> import teamformer as tf
>>> mission = tf.load("examples/warehouse.yaml")
>>> trial = tf.run(mission, method="plan", seed=0)
>>> trial.completed
True

What is asked for is imported when it is, so that `import teamformer` is quick.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from typing import TypeAlias

    from teamformer.advice.experience import Experience as Experience
    from teamformer.advice.suggestions import Advice as Advice
    from teamformer.api.advice import advise as advise
    from teamformer.api.advice import learn as learn
    from teamformer.api.missions import generate as generate
    from teamformer.api.missions import load as load
    from teamformer.api.missions import save as save
    from teamformer.api.missions import setting as setting
    from teamformer.api.trials import Trial as Trial
    from teamformer.api.trials import check as check
    from teamformer.api.trials import compare as compare
    from teamformer.api.trials import plan as plan
    from teamformer.api.trials import run as run
    from teamformer.coordination import Coordinator as Coordinator
    from teamformer.coordination import Known as Known
    from teamformer.coordination import Plan as Plan
    from teamformer.errors import TeamformerError as TeamformerError
    from teamformer.grid import Grid as Grid
    from teamformer.model import Robot as Robot
    from teamformer.model import Scenario
    from teamformer.model import Task as Task
    from teamformer.plane import Plane as Plane
    from teamformer.policies.protocol import Policy as Policy
    from teamformer.roads import Roads as Roads
    from teamformer.sim.env import Decision as Decision
    from teamformer.sim.env import TeamFormation as TeamFormation
    from teamformer.sim.multi_agent.parallel_env import (
        TeamFormationParallel as TeamFormationParallel,
    )
    from teamformer.sim.view import View as View
    from teamformer.trials.methods import Method as Method
    from teamformer.viewer.notebook_page import Page as Page

    Mission: TypeAlias = Scenario

_HOMES = {
    "Advice": "advice.suggestions:Advice",
    "Experience": "advice.experience:Experience",
    "Page": "viewer.notebook_page:Page",
    "Trial": "api.trials:Trial",
    "advise": "api.advice:advise",
    "check": "api.trials:check",
    "compare": "api.trials:compare",
    "generate": "api.missions:generate",
    "learn": "api.advice:learn",
    "load": "api.missions:load",
    "plan": "api.trials:plan",
    "run": "api.trials:run",
    "save": "api.missions:save",
    "setting": "api.missions:setting",
    "Coordinator": "coordination:Coordinator",
    "Decision": "sim.env:Decision",
    "Grid": "grid:Grid",
    "Known": "coordination:Known",
    "Method": "trials.methods:Method",
    "Mission": "model:Scenario",
    "Plan": "coordination:Plan",
    "Plane": "plane:Plane",
    "Policy": "policies.protocol:Policy",
    "Roads": "roads:Roads",
    "Robot": "model:Robot",
    "Task": "model:Task",
    "TeamFormation": "sim.env:TeamFormation",
    "TeamFormationParallel": "sim.multi_agent.parallel_env:TeamFormationParallel",
    "TeamformerError": "errors:TeamformerError",
    "View": "sim.view:View",
}
"""Where each name lives, below this package."""

__all__ = sorted(_HOMES)


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version

        return version("teamformer")
    if name not in _HOMES:
        raise AttributeError(f"module 'teamformer' has no attribute {name!r}")
    module, _, inside = _HOMES[name].partition(":")
    found = getattr(import_module(f"teamformer.{module}"), inside)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
