"""Programs that go on until Ctrl-C: `asterism studio` and `asterism hops`."""

from __future__ import annotations

import signal
from pathlib import Path
from typing import Annotated

import typer

from asterism.cli.run import Mistake, Run, command


@command
def studio(
    run: Run,
    design: Annotated[
        Path | None, typer.Argument(help="Design file (.toml or .json). Without a file, the page shows the gallery.")
    ] = None,
    port: Annotated[int, typer.Option(min=0, max=65535, help="Port of the page; 0 chooses a free port.")] = 0,
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="Open the page in the browser.")] = True,
    listen: Annotated[
        str,
        typer.Option(
            help="Address of this machine. With another address than 127.0.0.1, other machines can open the page."
        ),
    ] = "127.0.0.1",
) -> None:
    """Draw stars on a page in the browser, and see the shape of the sheet at once."""
    from asterism.studio.child import ENGINE, Child

    # the engine takes longest to load, so it starts first
    engine = Child(ENGINE)

    def say(line: str) -> None:
        run.hand_over()
        run.lines([line])

    # a terminal that goes away ends the studio as `kill` does: unsaved work is kept
    if hasattr(signal, "SIGHUP") and signal.getsignal(signal.SIGHUP) is not signal.SIG_IGN:
        signal.signal(signal.SIGHUP, lambda *_: signal.raise_signal(signal.SIGTERM))
    try:
        from asterism.studio.server import run_studio

        run_studio(design, port=port, listen=listen, opens_browser=browser, say=say, engine=engine)
    finally:
        engine.process.kill()


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
