"""The gallery holds the paper's figures, each of which can be laid out and printed."""

import re
import subprocess
import sys

import numpy as np
import pytest

from asterism.pattern import gallery
from asterism.pattern.design.design import save_design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.build import layout, load_design
from asterism.pattern.mesh.meshing import mesh_layout

FRAME_MM = 260


def test_figures_are_there():
    wanted = {"star", "roof", "tube", "tunnel", "u-shape", "doubly-curved", "dome", "bell", "cone"}
    wanted |= {f"fig5-{x}" for x in ("full", "no-fabric-bending", "no-rest-curvature")}
    wanted |= {f"fig8-{q}-{way}" for q in "hl" for way in ("decreasing", "uniform", "increasing")}
    assert wanted <= set(gallery.names())


@pytest.mark.slow
@pytest.mark.parametrize("name", gallery.names())
def test_design(name, tmp_path):
    design = gallery.load(name)
    assert design.name == name and design.mesh.edge_mm is None
    assert gallery.path(name).read_text(encoding="utf-8").startswith("# ")
    sheet = layout(design)
    assert np.ptp(sheet.outline, axis=0).max() <= FRAME_MM
    for suffix in ("toml", "json"):
        save_design(design, tmp_path / f"again.{suffix}")
        again = load_design(tmp_path / f"again.{suffix}")
        assert again == design and again.to_dict() == design.to_dict()
        for key, value in vars(layout(again)).items():
            if isinstance(value, np.ndarray):
                np.testing.assert_array_equal(value, getattr(sheet, key))


def test_values_of_figure_8():
    sheet = layout(gallery.load("fig8-h-decreasing"))
    assert sheet.arm_thickness.max() == 0.6 and sheet.arm_thickness.min() == pytest.approx(0.2)
    sheet = layout(gallery.load("fig8-l-increasing"))
    assert sheet.arm_length.min() == pytest.approx(4) and sheet.arm_length.max() == pytest.approx(10, abs=1e-5)


def test_unknown_name():
    with pytest.raises(DesignError, match="tube"):
        gallery.load("tub")


@pytest.mark.slow
def test_reading_a_design_imports_nothing_slow():
    check = (
        "import sys; from asterism.pattern import gallery; gallery.load('dome'); "
        "assert not {'scipy', 'numba', 'matplotlib', 'PIL'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", check], check=True)


def test_drawn_patterns_are_there():
    wanted = {"ring-saddle", "wavy-loop", "leaf", "parallel-lines", "skew-grid", "honeycomb", "diamond-auxetic"}
    assert wanted | {"stress-line-shell"} == set(gallery.pattern_names())
    assert not set(gallery.pattern_names()) & {*gallery.names(), *gallery.template_names()}


@pytest.mark.slow
@pytest.mark.parametrize("name", gallery.pattern_names())
def test_drawn_pattern(name, tmp_path):
    design = gallery.load(name)
    text = gallery.path(name).read_text(encoding="utf-8")
    comment = " ".join(line.lstrip("# ") for line in text.splitlines() if line.startswith("#"))
    assert design.name == name and "Chosen:" in comment and re.search(r"\b20[12]\d\b|Varinlioglu", comment)
    sheet = layout(design)
    assert np.ptp(sheet.outline, axis=0).max() <= FRAME_MM and sheet.drawn is not None
    assert len(mesh_layout(sheet, 2.0).points) < 2500
    save_design(design, tmp_path / "again.toml")
    assert load_design(tmp_path / "again.toml") == design
