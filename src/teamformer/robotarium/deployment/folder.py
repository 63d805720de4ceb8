"""Makes the flat folder that Robotarium's testbed takes: the same code, with its libraries alone.

The modules that a mission needs are copied as they are; the testbed finds them by `testbed.txt`. It
has no numba, so kernels run as plain Python there; no ONNX Runtime, so networks run in NumPy; no
daqp, so the safety filter asks cvxopt. It takes flat files of Python and NumPy, so no zip.
"""

from __future__ import annotations

import io
import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np

from teamformer.base.errors import TeamformerError
from teamformer.base.whole_files import write_all
from teamformer.methods.learned.onnx_sessions import shipped
from teamformer.mission.model import Mission
from teamformer.robotarium.deployment.networks import networks_text, weights_of
from teamformer.robotarium.deployment.onnx_files import read_graph
from teamformer.robotarium.deployment.policies import maker_of
from teamformer.robotarium.experiment import start_poses
from teamformer.robotarium.mission_checks import check_mission

ROOT = Path(__file__).parents[2]
SHIMS = Path(__file__).parent / "testbed"
IMPORT = re.compile(r"from teamformer\.([\w.]+) import ")
TYPES_ONLY = r"^if TYPE_CHECKING:\n(?: +from [\w.]+ import (?:\([^)]*\)|[^\n(]*)\n)+"
FOR_TYPES = re.compile(TYPES_ONLY, re.MULTILINE)
"""Imports for readers and type checkers only; the testbed needs no modules for them."""

MAIN, WEIGHTS = "main.py", "weights.npy"
OURS = re.compile(r"tf_\w+\.py")
"""What all other files that are written match."""
REPLACED = {"base.kernels.jit": "jit.txt", "methods.learned.onnx_sessions": "sessions.txt"}
"""Modules that are something else on the testbed, and the files that hold that."""

FOR_MISSIONS = (
    "mission.model",
    "mission.parts.plane",
    "robotarium.flight",
    "robotarium.robots.rps_robots",
    "robotarium.control.qp_solvers",
    "world.env",
)


def deploy(mission: Mission, name: str, seed: int, folder: Path) -> list[Path]:
    """Write the folder for a mission and a method; return its files, the main one first.

    What an earlier deployment has left in the folder is replaced. Raises `TeamformerError` for a
    method that has no form for the testbed, and for a folder that holds anything else.
    """
    check_mission(mission)
    maker = maker_of(name)
    texts = {f"{_flat(name)}.py": _source(name) for name in sorted(_needed(maker.module))}
    texts["tf_testbed.py"] = _shim("testbed.txt")
    texts["tf_experiment.py"] = _mission_text(mission, start_poses(mission, seed), seed)
    main = _shim("main.txt").replace("POLICY_MODULE", maker.module)
    main = main.replace("MAKER", maker.function)
    texts[MAIN] = main.replace("ARGUMENTS", ", ".join(map(repr, maker.arguments)))
    contents: dict[str, str | bytes] = {**texts}
    graphs = {file: read_graph(shipped(file)) for file in maker.networks}
    if graphs:
        contents["tf_networks.py"] = networks_text(graphs)
        contents[WEIGHTS] = _as_npy(weights_of(graphs))
    for old in _earlier_files(folder):
        if old.name not in contents:
            old.unlink()
    write_all({folder / name: content for name, content in contents.items()})
    return [folder / MAIN, *(folder / name for name in sorted(contents) if name != MAIN)]


def _earlier_files(folder: Path) -> list[Path]:
    """Return what a deployment has left; raises `TeamformerError` if something else is there."""
    found = sorted(path for path in folder.glob("*") if path.name != "__pycache__")
    is_ours = folder.joinpath("tf_experiment.py").exists()
    for path in found:
        if not (is_ours and (path.name in (MAIN, WEIGHTS) or OURS.fullmatch(path.name))):
            what = f"{folder}: holds files that are not of a deployment, {path.name} for example"
            raise TeamformerError(what, "name an empty folder")
    return found


def _as_npy(array: np.ndarray) -> bytes:
    file = io.BytesIO()
    np.save(file, array)
    return file.getvalue()


def verify(folder: Path) -> dict[str, object]:
    """Run a folder without this package, on the official simulator, and return what it prints.

    Raises `TeamformerError` with what it said if it fails. It needs what the testbed has: NumPy,
    SciPy, cvxopt, matplotlib and the simulator.
    """
    command = [sys.executable, "-P", "-c", "import runpy, sys; sys.path.insert(0, '.'); " + FENCE]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    if done.returncode:
        said = done.stderr.strip().splitlines()[-1:] or ["no word"]
        hint = "it needs numpy, scipy, cvxopt, matplotlib and robotarium-python-simulator"
        raise TeamformerError(f"the deployed folder failed: {said[0]}", hint)
    result: dict[str, object] = json.loads(done.stdout.strip().splitlines()[-1])
    return result


FENCE = (
    "blocked = ('numba', 'onnxruntime', 'daqp', 'ortools', 'torch'); "
    "sys.modules.update(dict.fromkeys(blocked)); runpy.run_path('main.py', run_name='__main__')"
)
"""What is not on the testbed, or not needed, cannot be imported; None in sys.modules does that."""


def _needed(policy_module: str) -> set[str]:
    """Return the modules of the package that a mission needs, by dotted name."""
    found, waiting = set[str](), [*FOR_MISSIONS, policy_module]
    while waiting:
        name = waiting.pop()
        if name not in found:
            found.add(name)
            waiting += IMPORT.findall(FOR_TYPES.sub("", _source(name)))
    return found


def _source(name: str) -> str:
    """Return a module's text as the testbed gets it."""
    if name in REPLACED:
        return _shim(REPLACED[name])
    return ROOT.joinpath(*name.split(".")).with_suffix(".py").read_text()


def _flat(name: str) -> str:
    return "tf_" + name.replace(".", "_")


def _shim(name: str) -> str:
    return (SHIMS / name).read_text()


def _mission_text(mission: Mission, poses: np.ndarray, seed: int) -> str:
    return (
        '"""The mission, where its robots start, and the seed."""\n\n'
        "from math import inf\n\n"  # which a radius may be
        "import tf_testbed  # by which the package's modules are found\n"
        "from teamformer.mission.model import Mission, Robot, Task\n"
        "from teamformer.mission.parts.grid import Grid\n"
        "from teamformer.mission.parts.plane import Plane\n\n"
        f"MISSION = {mission!r}\nPOSES = {poses.tolist()!r}\nSEED = {seed}\n"
    )
