"""The gallery holds the paper's figures, each of which can be laid out and printed."""

import re
import subprocess
import sys

import numpy as np
import pytest

from asterism.pattern import gallery
from asterism.pattern.design.design import save_design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.geometry.planar import triangle_angles
from asterism.pattern.layout.build import layout, load_design
from asterism.pattern.mesh.meshing import mesh_layout

FRAME_MM = 260


def test_what_is_there():
    wanted = {"star", "roof", "tube", "tunnel", "u-shape", "doubly-curved", "dome", "bell", "cone"}
    wanted |= {f"fig5-{x}" for x in ("full", "no-fabric-bending", "no-rest-curvature")}
    wanted |= {f"fig8-{q}-{way}" for q in "hl" for way in ("decreasing", "uniform", "increasing")}
    assert wanted <= set(gallery.names())
    assert not set(gallery.pattern_names()) & {*gallery.names(), *gallery.template_names()}
    with pytest.raises(DesignError, match="tube"):
        gallery.load("tub")


@pytest.mark.slow
@pytest.mark.parametrize("name", [*gallery.names(), *gallery.pattern_names()])
def test_design(name, tmp_path):
    design, text = gallery.load(name), gallery.path(name).read_text(encoding="utf-8")
    assert design.name == name and text.startswith("# ")
    sheet = layout(design)
    assert np.ptp(sheet.outline, axis=0).max() <= FRAME_MM
    save_design(design, tmp_path / "again.toml")
    assert load_design(tmp_path / "again.toml") == design
    if sheet.drawn is None:
        assert design.mesh.edge_mm is None
    else:
        comment = " ".join(line.lstrip("# ") for line in text.splitlines() if line.startswith("#"))
        assert "Chosen:" in comment and re.search(r"\b20[12]\d\b|Varinlioglu", comment)
        mesh = mesh_layout(sheet, 2.0)
        assert len(mesh.points) < 2500 and triangle_angles(mesh.points, mesh.triangles).min() >= 20.0


def test_values_of_figure_8():
    sheet = layout(gallery.load("fig8-h-decreasing"))
    assert sheet.arm_thickness.max() == 0.6 and sheet.arm_thickness.min() == pytest.approx(0.2)
    sheet = layout(gallery.load("fig8-l-increasing"))
    assert sheet.arm_length.min() == pytest.approx(4) and sheet.arm_length.max() == pytest.approx(10, abs=1e-5)


@pytest.mark.slow
def test_reading_a_design_imports_nothing_slow():
    check = (
        "import sys; from asterism.pattern import gallery; gallery.load('dome'); "
        "assert not {'scipy', 'numba', 'matplotlib', 'PIL'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", check], check=True)
