"""The name of the code stands for all of it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from homogenize.code_version import SOURCES

# of pattern: what solves a cell imports these too, and takes no number from them
ASIDE = (
    # designs and their files: what they say is among the inputs that a sample is named by
    *("arguments", "design", "errors", "files", "section", "stars"),
    # sizes that vary, outlines and pins: a cell has none
    *("border", "build", "fields", "formula", "image", "pin_agreement", "pins"),
)


def test_every_module_that_decides_answers_is_in_it() -> None:
    script = "import sys, homogenize.sample; print(*sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout.split()
    ours = {path.name for path in Path(__file__).parents[2].iterdir() if (path / "__init__.py").exists()}
    needed = {name for name in loaded if "." in name and name.split(".")[0] in ours}
    listed = {
        f"{package.__name__}.{file.stem}"
        for package, names in SOURCES.items()
        for pattern in names
        for file in Path(package.__path__[0]).glob(pattern)
    }
    aside = {f"pattern.{name}" for name in ASIDE}
    assert needed - aside <= listed
    assert aside <= needed and not aside & listed
