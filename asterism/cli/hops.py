"""`asterism hops`: sheets inside Grasshopper."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from asterism.cli.common.run import Mistake, Run, command


@command
def hops(
    run: Run,
    port: Annotated[int, typer.Option(min=0, max=65535, help="Port of the server; 0 chooses a free port.")] = 5017,
    folder: Annotated[Path, typer.Option(help="Folder below which prints are written.")] = Path("."),
    key: Annotated[
        str | None, typer.Option(envvar="ASTERISM_HOPS_KEY", help="Key that Hops must send, as in its settings.")
    ] = None,
    patience: Annotated[
        float, typer.Option(min=1, max=86400, help="Longest estimated time of an exact shape in seconds.")
    ] = 100.0,
) -> None:
    """Serve components for Grasshopper to this machine: sites, sheet, rods, exact, fit, print."""
    if not folder.is_dir():
        raise Mistake(f"--folder {folder}: is no folder")

    from asterism.hops.server import run_hops

    def say(line: str) -> None:
        run.hand_over()
        run.lines([line])

    run_hops(folder.absolute(), port=port, key=key or None, patience_s=patience, say=say)
