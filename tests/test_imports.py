"""Imports point downwards, and each heavy library has one home."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import teamformer

ROOT = Path(teamformer.__file__).parent

CORE = {
    "errors",
    "mission",
    "model",
    "truth",
    "grid",
    "capabilities",
    "plane",
    "roads",
    "regions",
    "frame",
}
CORE |= {"arrays", "coordination", "entry_points", "extras", "import_apart", "jit", "kernels"}
CORE |= {"own_code", "whole_files"}
BELOW_POLICIES = {*CORE, "rules", "scenarios", "planning", "sim", "coordinators"}
BELOW_COMMANDS = {
    *BELOW_POLICIES,
    *(
        "policies",
        "critical_path",
        "trials",
        "advice",
        "referee",
        "viewer",
        "export",
        "live",
        "bench",
    ),
}
SEES = {
    "core": CORE,
    "rules": CORE,
    "scenarios": CORE,
    "planning": {*CORE, "rules"},
    "sim": {*CORE, "rules", "scenarios"},
    "coordinators": {*CORE, "rules", "planning"},
    "policies": BELOW_POLICIES,
    "critical_path": {*CORE, "rules.constants", "planning.continuous", "sim.replay"},
    "trials": {*BELOW_POLICIES, "policies", "critical_path", "viewer"},
    "referee": {*CORE, "scenarios", "sim.replay"},
    "advice": {*BELOW_POLICIES, "policies", "critical_path", "trials", "viewer"},
    "viewer": {"errors", "whole_files", "mission.keys"},
    "export": {*CORE, "rules.constants", "scenarios", "sim.replay"},
    "live": {*BELOW_POLICIES, "policies", "trials", "viewer", "export"},  # for its downloads
    "nets": set(),
    "train": {*BELOW_POLICIES, "policies", "trials", "nets"},
    "bench": {*BELOW_POLICIES, "policies", "trials", "referee"},
    "robotarium": {*BELOW_POLICIES, "policies", "trials"},
    "fleet": {*BELOW_POLICIES, "policies", "trials", "live"},  # whose pages may watch it
    "api": {*BELOW_POLICIES, "policies", "critical_path", "trials", "referee", "viewer", "advice"},
    "testing": {*BELOW_POLICIES, "policies", "trials", "referee", "fleet"},
    "commands": {*BELOW_COMMANDS, "train", "robotarium", "fleet"},
    "cli": {*BELOW_COMMANDS, "commands"},
}
"""What each part may import besides itself; a name stands for all that is in it."""

HOMES = {
    "ortools": ("planning/", "bench/peers/"),
    "pyvrp": ("bench/peers/by_pyvrp.py",),
    "vroom": ("bench/peers/by_vroom.py",),
    "torch": ("nets/", "train/"),
    "safetensors": ("train/",),
    "onnxruntime": ("methods/learned/onnx_sessions.py",),
    "gymnasium": ("world/multi_agent/parallel_env.py",),
    "pettingzoo": ("world/multi_agent/parallel_env.py",),
    "typer": ("cli/", "commands/"),
    "click": ("cli/", "commands/"),
    "rich": ("cli/", "commands/", "bench/"),
    "yaml": ("scenarios/",),
    "msgspec": ("fleet/",),
    "paho": ("fleet/bodies/vda5050/broker.py",),
    "zenoh": ("fleet/transports/zenoh_mesh.py",),
    **dict.fromkeys(
        (
            "rclpy",
            "action_msgs",
            "builtin_interfaces",
            "geometry_msgs",
            "nav_msgs",
            "nav2_msgs",
            "std_msgs",
        ),
        ("fleet/bodies/ros2/",),
    ),
    "visualization_msgs": ("fleet/bodies/ros2/markers.py",),
    "matplotlib": (
        "bench/report/figures.py",
        "robotarium/draw.py",
        "robotarium/robots/rps_robots.py",
    ),
    "ray": ("bench/executors.py",),
    "daqp": ("robotarium/control/qp_solvers.py",),
    "cvxopt": ("robotarium/control/qp_solvers.py",),
    "rps": ("robotarium/robots/rps_robots.py",),
    "scipy": ("robotarium/control/assignment.py",),
    "onnx": ("train/export/",),
    "starlette": ("live/serving/doors.py", "live/serving/server.py"),
    "uvicorn": ("live/serving/doors.py", "live/serving/server.py"),
    "ruamel": ("live/drawing/comments.py",),
    "foxglove": (
        "record/export/foxglove_channels.py",
        "record/export/foxglove_server.py",
        "record/export/mcap_file.py",
    ),
    "PIL": ("record/export/gif_file.py", "robotarium/draw.py", "files/maps/images.py"),
}
NOWHERE = ("pandas", "networkx")

FILES = sorted(ROOT.rglob("*.py"))


def imports_of(path: Path) -> Iterator[tuple[str, bool]]:
    """Return what a file imports, wherever in it, and whether that happens on import."""
    tree = ast.parse(path.read_text())
    inner = {
        id(node)
        for part in ast.walk(tree)
        if isinstance(part, ast.FunctionDef) or is_for_types_only(part)
        for node in ast.walk(part)
    }
    for node in ast.walk(tree):
        names: list[str] = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            names = [f"{node.module}.{alias.name}" for alias in node.names]
        for name in names:
            yield name, id(node) not in inner


def is_for_types_only(node: ast.AST) -> bool:
    return isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"


def part_of(path: Path) -> str:
    name = path.relative_to(ROOT).parts[0].removesuffix(".py")
    return "core" if name in CORE else name


def is_allowed(part: str, name: str) -> bool:
    """Say whether a part of the package may import something of the package, by full name."""
    inside = name.removeprefix("teamformer.")
    return any(f"{inside}.".startswith(f"{seen}.") for seen in {*SEES[part], part})


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_imports_point_downwards(path: Path) -> None:
    part = part_of(path)
    if part == "__init__":
        ours = [name for name, is_at_once in imports_of(path) if is_at_once]
        assert [name for name in ours if name.startswith("teamformer")] == []
        return
    ours = [name for name, _ in imports_of(path) if name.startswith("teamformer")]
    assert [name for name in ours if not is_allowed(part, name)] == []


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_heavy_libraries_stay_at_home(path: Path) -> None:
    where = path.relative_to(ROOT).as_posix()
    for name, is_at_once in imports_of(path):
        library = name.split(".")[0]
        assert library not in NOWHERE
        if library in HOMES:
            assert where.startswith(HOMES[library]), f"{where} imports {library}"
        assert not (library == "ortools" and is_at_once), f"{where} imports {library} at once"


def test_the_reader_of_imports_finds_them(tmp_path: Path) -> None:
    """So that the tests above cannot pass by finding nothing."""
    path = tmp_path / "some.py"
    path.write_text(
        "import a.b\nfrom c import d as e\nif TYPE_CHECKING:\n    import f\n"
        "def g():\n    from teamformer.world import env\n"
    )
    found = {"a.b": True, "c.d": True, "f": False, "teamformer.world.env": False}
    assert dict(imports_of(path)) == found
    assert not is_allowed("planning", "teamformer.world.env")
    assert not is_allowed("referee", "teamformer.world.env")
    assert is_allowed("referee", "teamformer.record.record.Step")
    assert not is_allowed("scenarios", "teamformer.simulated")
    assert {part_of(path) for path in FILES} - {"__init__"} <= set(SEES)


@pytest.mark.parametrize(
    ("verb", "unwanted"),
    [
        ("--help", {"ortools", "numba", "numpy", "torch", "matplotlib", "gymnasium"}),
        ("methods", {"ortools", "torch", "matplotlib", "gymnasium", "pettingzoo"}),
    ],
)
@pytest.mark.thorough
def test_a_verb_loads_only_what_it_needs(verb: str, unwanted: set[str]) -> None:
    code = (
        "import sys; from teamformer.cli import main; sys.argv = ['teamformer', sys.argv[1]]\n"
        "try: main()\n"
        "finally: print(*sorted({name.split('.')[0] for name in sys.modules}), file=sys.stderr)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, verb], capture_output=True, text=True, check=True
    )
    loaded = set(done.stderr.split())
    assert "typer" in loaded
    assert loaded & unwanted == set()
    assert done.stdout
