"""`teamformer mcp`: missions for programs that talk, over stdio."""

from __future__ import annotations

from pathlib import Path

from teamformer.base.errors import TeamformerError
from teamformer.base.extras import require
from teamformer.base.kernels.jit import needs_compiling
from teamformer.cli.terminal.compiling import compile_beside
from teamformer.cli.terminal.console import processors, say


def mcp(folder: Path) -> int:
    """Serve a folder's missions over stdin and stdout until these are closed; return the status."""
    require("mcp", "mcp")
    if not folder.is_dir():
        raise TeamformerError(f"{folder}: there is no such folder", "name one that is there")
    from teamformer.planning.search.annealing import anneal
    from teamformer.trials.mcp.server import make_server
    from teamformer.trials.mcp.work_folder import WorkFolder
    from teamformer.trials.mcp.workbench import Workbench

    if needs_compiling(anneal):
        compile_beside("plan")
    say(f"serving {folder.resolve()} over stdio; it ends when its client closes stdin")
    make_server(Workbench(WorkFolder(folder.resolve()), processors())).run("stdio")
    return 0
