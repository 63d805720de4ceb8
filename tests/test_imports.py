"""Imports point one way, no two folders need one another, and each heavy library has one home."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

import teamformer

ROOT = Path(teamformer.__file__).parent

ROOMS = (
    "base",
    "mission",
    "files",
    "world",
    "planning",
    "methods",
    "record",
    "viewer",
    "trials",
    "live",
    "fleet",
    "testing",
    "robotarium",
    "learning",
    "bench",
    "cli",
)
"""The rooms on the first floor. Each may import those before it, unless it is named below."""

NARROW = {
    "planning": ("base", "mission", "world.rules"),
    "record.referee": ("base", "mission", "files", "record", "world.reference"),
    "record.export": ("base", "mission", "files", "record", "world.rules.constants"),
    "viewer": ("base", "mission.keys"),
    "learning.nets": ("base",),
    "robotarium": ("base", "mission", "files", "world", "methods", "trials"),
    "learning": ("base", "mission", "files", "world", "planning", "methods", "trials"),
}
"""What may import less than its room's place allows; besides itself, what is in these."""

HOMES = {
    "ortools": ("planning/", "bench/peers/"),
    "pyvrp": ("bench/peers/by_pyvrp.py",),
    "vroom": ("bench/peers/by_vroom.py",),
    "torch": ("learning/",),
    "safetensors": ("learning/",),
    "onnxruntime": ("methods/learned/onnx_sessions.py",),
    "gymnasium": ("world/multi_agent/",),
    "pettingzoo": ("world/multi_agent/parallel_env.py",),
    "stable_baselines3": ("world/multi_agent/sb3.py",),
    "typer": ("cli/",),
    "click": ("cli/",),
    "rich": ("cli/", "bench/"),
    "yaml": ("files/",),
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
            "sensor_msgs",
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
    "onnx": ("learning/export/", "robotarium/deployment/onnx_files.py"),
    "mcp": ("trials/mcp/server.py",),
    "anyio": ("trials/mcp/server.py",),
    "starlette": ("live/serving/",),
    "uvicorn": ("live/serving/",),
    "ruamel": ("live/drawing/comments.py",),
    "foxglove": (
        "record/export/foxglove_channels.py",
        "record/export/foxglove_server.py",
        "record/export/mcap_file.py",
    ),
    "PIL": (
        "record/export/gif_file.py",
        "record/export/picture.py",
        "robotarium/draw.py",
        "files/maps/images.py",
    ),
}
NOWHERE = ("pandas", "networkx")

FILES = sorted(ROOT.rglob("*.py"))
MODULES = {
    ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): path
    for path in FILES
}


def imports_of(path: Path) -> Iterator[tuple[str, bool]]:
    """Yield what a file imports, wherever in it, and whether that happens on import."""
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


def needs(path: Path) -> set[str]:
    """Return the modules of ours that a file needs as it runs, wherever it imports them."""
    tree = ast.parse(path.read_text())
    for_types = {
        id(node) for part in ast.walk(tree) if is_for_types_only(part) for node in ast.walk(part)
    }
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and id(node) not in for_types:
            whole = [f"{node.module}.{alias.name}" for alias in node.names]
            found |= {module for name in whole if (module := module_of(name))}
    return found


def module_of(name: str) -> str | None:
    """Return the module of ours that a full name is in, if it is ours."""
    inside = name.removeprefix("teamformer.")
    while inside != name and inside not in MODULES and "." in inside:
        inside = inside.rpartition(".")[0]
    return inside if inside in MODULES and inside != name else None


def folder_of(module: str) -> str:
    return MODULES[module].parent.relative_to(ROOT).as_posix()


def allowed(module: str) -> tuple[str, ...]:
    """Return what a module may import; a name stands for all that is in it."""
    narrow = [part for part in NARROW if f"{module}.".startswith(f"{part}.")]
    if narrow:
        part = max(narrow, key=len)
        return (*NARROW[part], part)
    room = module.split(".")[0]
    return ROOMS[: ROOMS.index(room) + 1]


def is_allowed(module: str, name: str) -> bool:
    """Say whether a module of the package may import something of the package, by full name."""
    inside = name.removeprefix("teamformer.")
    return any(f"{inside}.".startswith(f"{seen}.") for seen in allowed(module))


def test_there_are_at_most_sixteen_rooms() -> None:
    """Each is a folder in the list above, and nothing but the package itself lies beside them."""
    data = {"weights", "compiled"}
    assert {module.split(".")[0] for module in MODULES if module != "__init__"} == set(ROOMS)
    folders = {path.name for path in ROOT.iterdir() if path.is_dir()}
    assert folders - {*data, "__pycache__"} == set(ROOMS)
    assert len(ROOMS) <= 16


@pytest.mark.parametrize("module", MODULES)
def test_imports_point_one_way(module: str) -> None:
    if module == "__init__":
        ours = [name for name, is_at_once in imports_of(MODULES[module]) if is_at_once]
        assert [name for name in ours if name.startswith("teamformer")] == []
        return
    ours = [name for name, _ in imports_of(MODULES[module]) if name.startswith("teamformer.")]
    assert [name for name in ours if not is_allowed(module, name)] == []


def test_no_circle_of_files() -> None:
    """Not even by imports that stand inside functions."""
    try:
        TopologicalSorter({module: needs(path) for module, path in MODULES.items()}).prepare()
    except CycleError as error:
        pytest.fail(" -> ".join(error.args[1]))


def test_no_two_folders_import_one_another() -> None:
    """A folder and one inside it count as two."""
    pairs = {
        (folder_of(module), folder_of(other))
        for module, path in MODULES.items()
        for other in needs(path)
        if folder_of(module) != folder_of(other)
    }
    assert {pair for pair in pairs if pair[::-1] in pairs} == set()


def test_a_class_name_has_one_owner() -> None:
    names = Counter(
        node.name
        for path in FILES
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.ClassDef)
    )
    assert [name for name, count in names.items() if count > 1] == []


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
        "    from teamformer.world import view\n"
        "def g():\n    from teamformer.world import env\n"
    )
    found = {"a.b": True, "c.d": True, "f": False}
    found |= {"teamformer.world.view": False, "teamformer.world.env": False}
    assert dict(imports_of(path)) == found
    assert needs(path) == {"world.env"}
    assert not is_allowed("planning.race", "teamformer.world.env")
    assert is_allowed("planning.race", "teamformer.world.rules.chance.draw")
    assert not is_allowed("record.referee.judge", "teamformer.world.env")
    assert is_allowed("record.referee.judge", "teamformer.record.record.Step")
    assert not is_allowed("files.mission_files", "teamformer.world.env")
    assert not is_allowed("mission.model", "teamformer.missions.names")
    assert module_of("teamformer.world.env.TeamFormation") == "world.env"
    assert module_of("numpy.random") is None
    assert len(needs(MODULES["world.env"])) > 10


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
