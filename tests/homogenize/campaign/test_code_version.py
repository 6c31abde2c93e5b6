"""The name of the code stands for all of it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from asterism.homogenize.campaign.kept_samples import SAMPLE_SOURCES
from tests.test_rooms import package_of

# of pattern: what solves a cell imports these too, and takes no number from them
ASIDE = (
    # designs and their files: what they say is among the inputs that a sample is named by
    *("design.design", "design.errors", "design.files", "design.section", "design.stars"),
    *("design.material_files", "design.spread"),
    # sizes that vary, outlines, pins and drawings: a cell has none
    *("design.border", "design.pins", "design.rods", "design.drawings"),
    *("drawing.dxf", "drawing.read", "drawing.records", "drawing.rhino", "drawing.svg"),
    *("design.sizing.expression", "design.sizing.grey_image", "design.sizing.profiles"),
)


@pytest.mark.slow
def test_every_module_that_decides_answers_is_in_it() -> None:
    script = (
        "import sys, asterism.homogenize.cell.sample, asterism.homogenize.cell.motif_responses;"
        "print(*(name for name, module in sys.modules.items() if not hasattr(module, '__path__')))"
    )
    loaded = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout.split()
    needed = {name for name in loaded if package_of(name) in {"discrete", "equilibrium", "homogenize", "pattern"}}
    listed = {
        ".".join([package.__name__, *file.relative_to(package.__path__[0]).with_suffix("").parts]).removesuffix(
            ".__init__"
        )
        for package, names in SAMPLE_SOURCES.items()
        for pattern in names
        for file in Path(package.__path__[0]).glob(pattern)
    }
    aside = {f"asterism.pattern.{name}" for name in ASIDE}
    assert needed - aside <= listed
    assert aside <= needed and not aside & listed
