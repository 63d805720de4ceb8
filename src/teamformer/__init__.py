"""Teamformer: decentralised team formation for heterogeneous multi-robot teams.

>>> import teamformer as tf
>>> mission = tf.load("examples/warehouse.yaml")
>>> trial = tf.run(mission, method="plan", seed=0)
>>> trial.completed
True

What is asked for is imported when it is, so that `import teamformer` is quick.
"""

from importlib import import_module
from types import FunctionType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from teamformer.base.errors import TeamformerError as TeamformerError
    from teamformer.methods.by_name import Method as Method
    from teamformer.methods.seam.protocol import Policy as Policy
    from teamformer.mission.coordination import Coordinator as Coordinator
    from teamformer.mission.coordination import Known as Known
    from teamformer.mission.coordination import Plan as Plan
    from teamformer.mission.model import Mission as Mission
    from teamformer.mission.model import Robot as Robot
    from teamformer.mission.model import Task as Task
    from teamformer.mission.parts.grid import Grid as Grid
    from teamformer.mission.parts.plane import Plane as Plane
    from teamformer.mission.parts.roads import Roads as Roads
    from teamformer.trials.advice.experience import Experience as Experience
    from teamformer.trials.advice.suggestions import Advice as Advice
    from teamformer.trials.api.advice import advise as advise
    from teamformer.trials.api.advice import learn as learn
    from teamformer.trials.api.missions import generate as generate
    from teamformer.trials.api.missions import load as load
    from teamformer.trials.api.missions import save as save
    from teamformer.trials.api.missions import setting as setting
    from teamformer.trials.api.trials import Trial as Trial
    from teamformer.trials.api.trials import check as check
    from teamformer.trials.api.trials import compare as compare
    from teamformer.trials.api.trials import plan as plan
    from teamformer.trials.api.trials import run as run
    from teamformer.viewer.notebook_page import Page as Page
    from teamformer.world.env import Decision as Decision
    from teamformer.world.env import TeamFormation as TeamFormation
    from teamformer.world.multi_agent.parallel_env import (
        TeamFormationParallel as TeamFormationParallel,
    )
    from teamformer.world.view import View as View

_HOMES = {
    "Advice": "trials.advice.suggestions:Advice",
    "Experience": "trials.advice.experience:Experience",
    "Page": "viewer.notebook_page:Page",
    "Trial": "trials.api.trials:Trial",
    "advise": "trials.api.advice:advise",
    "check": "trials.api.trials:check",
    "compare": "trials.api.trials:compare",
    "generate": "trials.api.missions:generate",
    "learn": "trials.api.advice:learn",
    "load": "trials.api.missions:load",
    "plan": "trials.api.trials:plan",
    "run": "trials.api.trials:run",
    "save": "trials.api.missions:save",
    "setting": "trials.api.missions:setting",
    "Coordinator": "mission.coordination:Coordinator",
    "Decision": "world.env:Decision",
    "Grid": "mission.parts.grid:Grid",
    "Known": "mission.coordination:Known",
    "Method": "methods.by_name:Method",
    "Mission": "mission.model:Mission",
    "Plan": "mission.coordination:Plan",
    "Plane": "mission.parts.plane:Plane",
    "Policy": "methods.seam.protocol:Policy",
    "Roads": "mission.parts.roads:Roads",
    "Robot": "mission.model:Robot",
    "Task": "mission.model:Task",
    "TeamFormation": "world.env:TeamFormation",
    "TeamFormationParallel": "world.multi_agent.parallel_env:TeamFormationParallel",
    "TeamformerError": "base.errors:TeamformerError",
    "View": "world.view:View",
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
    if isinstance(found, FunctionType):  # the command line has its own way to tell of progress
        found = import_module("teamformer.base.kernels.announcing").says_if_long(found)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
