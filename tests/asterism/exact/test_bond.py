"""Line forces between plastic and fabric: closed forms, scale, and convergence with the mesh."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State
from asterism.exact.simulation import exact_shape, line_forces
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.mesh.meshing import mesh_layout
from asterism.reports.write_results import write_results
from asterism.shape.shape import Shape


def star_shape(edge_mm: float, **fabric: float) -> Shape:
    """A single star of the paper's sizes."""
    data = {"border": {"rings": 0}, "stars": {"length_mm": 10.0, "thickness_mm": 0.3}, "mesh": {"edge_mm": edge_mm}}
    shape = exact_shape(Design.from_dict({**data, "fabric": fabric}))
    assert shape.summary["is_minimum"]
    return shape


def rod_along_x() -> tuple[DiscreteModel, np.ndarray]:
    """A straight rod of 40 mm on an even mesh, and the printed positions of its sheet."""
    design = Design.from_dict(
        {
            "border": {"rectangle_mm": [60.0, 20.0]},
            "rods": {"draw": [{"line_mm": [[-20, 0], [20, 0]]}], "thickness_mm": 0.4},
            "fabric": {"bending": "paper"},
        }
    )
    plan = layout(design)
    model = DiscreteModel(design, plan, mesh_layout(plan, 1.0, "delaunay"))
    return model, model.printed_state().positions


def test_a_rod_in_a_given_shape_needs_the_forces_of_beam_theory() -> None:
    """A deflection `a x^4` needs the line load `24 a EI` upwards, a displacement `b x^2` the load `-2 b EA`."""
    model, at = rod_along_x()
    x, modulus = at[:, 0], model.design.fabric.modulus * model.design.plastic.modulus_ratio
    width, thickness = 1.2, 0.4
    rod = model.mesh.rods[0]
    inner = np.abs(x[rod][1:] + x[rod][:-1]) < 28.0  # away from the ends, where the rest curvature acts
    for a, b in ((2e-8, 0.0), (-2e-8, 0.0), (0.0, 1e-6)):
        # the second term along x keeps the length of the bent rod
        moved = at + np.column_stack([b * x**2 - 8.0 * a**2 * x**7 / 7.0, 0 * x, a * x**4])
        slope = np.diff(moved[rod, 2]) / np.diff(moved[rod, 0])
        up = np.column_stack([-slope, 0 * slope, np.ones(len(slope))])
        state = State(moved, up / np.linalg.norm(up, axis=1, keepdims=True))
        forces = line_forces(model, state)
        bending = modulus * width * thickness**3 / 12.0
        peel, shear = -24.0 * a * bending, 2.0 * b * modulus * width * thickness
        error = 0.01 * max(abs(peel), shear)
        assert forces["peel_n_per_mm"][inner] == pytest.approx(peel, abs=error)
        assert forces["shear_n_per_mm"][inner] == pytest.approx(shear, abs=error)


@pytest.mark.slow
def test_forces_are_proportional_to_the_moduli_and_converge_with_the_mesh() -> None:
    half, coarse, fine = (star_shape(edge, modulus_mpa=e).summary for edge, e in ((2.4, 1.0), (2.4, 2.0), (1.2, 2.0)))
    assert coarse["peel_star"] == 0
    for name in ("peel_n_per_mm", "shear_n_per_mm"):
        assert coarse[name] == pytest.approx(2.0 * half[name], rel=1e-5)
        assert coarse[name] == pytest.approx(fine[name], rel=0.05)


@pytest.mark.slow
def test_the_bond_is_drawn_where_its_forces_are_known(tmp_path: Path) -> None:
    known, unknown = star_shape(3.0, modulus_mpa=2.0), star_shape(3.0)
    assert "bond.png" in write_results(known, tmp_path / "known")
    red, _, blue = np.moveaxis(np.asarray(Image.open(tmp_path / "known" / "bond.png").convert("RGB"), dtype=int), 2, 0)
    assert np.count_nonzero(red > blue + 60) > 200
    assert "bond.png" not in write_results(unknown, tmp_path / "unknown")
    assert unknown.summary["peel_n_per_mm"] is None and "peel_n_per_mm" not in unknown.rod_fields
    assert "fabric" not in unknown.summary.table()
