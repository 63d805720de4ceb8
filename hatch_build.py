"""Tags a wheel for one Python and one platform where it carries compiled kernels."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class CompiledKernels(BuildHookInterface):  # type: ignore[type-arg]
    """Runs when a wheel is built."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Look for what `make wheel` has compiled."""
        compiled = Path(self.root) / "src" / "teamformer" / "compiled"
        if version == "standard" and any(compiled.glob("*.nbc")):
            build_data["pure_python"], build_data["infer_tag"] = False, True
