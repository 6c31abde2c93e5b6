"""Cells keep the symmetry of star and lattice, for all arms and kinds of lattices; which directions a law needs."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.campaign.fit_law import sample_quantities
from asterism.homogenize.cell.aligned_cell_mesh import aligned_cell_mesh
from asterism.homogenize.cell.flat_cell import relax_flat_cell
from asterism.homogenize.cell.periodic_mesh import PeriodicMesh
from asterism.homogenize.cell.point_group import (
    ALL_ANGLES_RAD,
    THREEFOLD_ANGLES_RAD,
    aligned_lines,
    averaged_directions,
    keeps_grid_lines,
    point_group,
    tube_angles,
)
from asterism.homogenize.cell.sample import SCALAR_KEYS, solve_cell, symmetric_responses
from asterism.homogenize.cell.unit_cell import UnitCell, cell_mesh
from asterism.homogenize.law.anisotropy import predicted_curvatures
from asterism.homogenize.law.star_law import QUANTITY_NAMES
from asterism.pattern.design.lattice import Lattice
from asterism.pattern.design.materials import Fabric
from asterism.pattern.geometry.plane_lattice import GRID_DIRECTIONS
from tests.homogenize.cells import EDGE, design

KINDS: dict[str, dict[str, Any]] = {
    "triangular": {},
    "square": {"kind": "square"},
    "rectangular": {"kind": "custom", "vectors_mm": [[17.0, 0.0], [0.0, 22.0]]},
    "rhombic": {"kind": "custom", "vectors_mm": [[16.0, 0.0], [8.0, 18.0]]},
    "oblique": {"kind": "custom", "vectors_mm": [[16.0, 0.0], [5.0, 19.0]]},
}
FOUR = {"arms": 4, "kind": "square"}


def moved_misfit(mesh: PeriodicMesh, symmetry: Floats) -> tuple[int, int]:
    """Numbers of edges of triangles and of arms whose images under a symmetry are none of the mesh."""
    rods = np.concatenate([np.column_stack([rod[:-1], rod[1:]]) for rod in mesh.rods])
    misfits = []
    for ends in (mesh.hinges[:, :2], rods):
        middles = mesh.points[ends].mean(axis=1)
        known, asked = (each @ np.linalg.inv(mesh.cell_vectors) % 1.0 % 1.0 for each in (middles, middles @ symmetry.T))
        distance = cKDTree(known, boxsize=1.0).query(asked)[0]
        misfits.append(int((distance > 1e-6).sum()))
    return misfits[0], misfits[1]


def test_the_group_is_that_of_star_and_lattice() -> None:
    """Counted by hand: orders with an arm along a lattice line, and with arms off all lines."""
    counts = {
        kind: [len(point_group(Lattice(arms=arms, orientation_deg=turn, **lattice))) for arms in range(3, 9)]
        for kind, lattice, turn in (
            ("triangular", KINDS["triangular"], 0.0),
            ("triangular, turned", KINDS["triangular"], 7.0),
            ("square", KINDS["square"], 0.0),
            ("oblique", KINDS["oblique"], 0.0),
        )
    }
    assert counts == {
        "triangular": [6, 4, 2, 12, 2, 4],
        "triangular, turned": [3, 2, 1, 6, 1, 2],
        "square": [2, 8, 2, 4, 2, 8],
        "oblique": [1, 2, 1, 2, 1, 2],
    }


@pytest.mark.slow
@pytest.mark.parametrize("turn", [0.0, 7.0])
@pytest.mark.parametrize("arms", [4, 5, 6])
@pytest.mark.parametrize("kind", KINDS)
def test_the_mesh_has_the_symmetry(kind: str, arms: int, turn: float) -> None:
    star = design(5.0, lattice={"arms": arms, "orientation_deg": turn, **KINDS[kind]})
    mesh = cell_mesh(star, EDGE)
    for symmetry in point_group(star.lattice):
        assert moved_misfit(mesh, symmetry) == (0, 0)


@pytest.mark.parametrize("arms", [3, 6])
def test_the_papers_stars_keep_the_grid(arms: int) -> None:
    """The mesh of the paper's law is the aligned one, digit by digit."""
    star = design(7.0, lattice={"arms": arms})
    assert keeps_grid_lines(star.lattice)
    lines = aligned_lines(star.lattice)
    assert lines is not None
    along = GRID_DIRECTIONS[lines] @ np.asarray(star.lattice.vectors)
    np.testing.assert_allclose(along / np.linalg.norm(along, axis=1)[:, None], star.lattice.arm_directions, atol=1e-12)
    grid = aligned_cell_mesh(np.asarray(star.lattice.vectors), lines, np.full(arms, 7.0), EDGE)
    np.testing.assert_array_equal(cell_mesh(star, EDGE).points, grid.points)
    np.testing.assert_array_equal(cell_mesh(star, EDGE).triangles, grid.triangles)


@pytest.mark.slow
def test_four_arms_on_a_square_lattice_curl_alike_after_a_quarter_turn(monkeypatch: pytest.MonkeyPatch) -> None:
    """And in a mirror; the rest metric has no shear. All of it before responses are made equal."""
    angles = tuple(np.radians([0.0, 30.0, 60.0, 90.0, 120.0]))
    monkeypatch.setattr("asterism.homogenize.cell.sample.symmetric_responses", lambda responses, *_: responses)
    sample = solve_cell(design(7.0, lattice=FOUR), EDGE, angles)
    kappa = sample.natural_curvature
    assert kappa[3] == pytest.approx(kappa[0], rel=1e-4)
    np.testing.assert_allclose(kappa[[2, 4]], kappa[1], rtol=1e-4)
    assert abs(kappa[1] - kappa[0]) > 0.01 * kappa[0]


@pytest.mark.slow
def test_a_flat_cell_that_bends_to_a_saddle_gets_the_symmetry_back() -> None:
    """On this mesh arms of 6 mm break the symmetry by themselves."""
    star = design(6.0, lattice=FOUR)
    flat = relax_flat_cell(UnitCell(star, EDGE))
    assert abs(flat.deformation[0, 1]) > 1e-3
    sample = solve_cell(star, EDGE, tuple(np.radians([0.0, 30.0, 60.0, 90.0])))
    metric = sample.rest_metric
    assert metric is not None
    np.testing.assert_allclose(metric, metric[0, 0] * np.eye(2), atol=1e-12)


def test_equal_directions_get_the_responses_of_lowest_energy() -> None:
    """Those at 120 and 150 degrees here, as a star that broke the symmetry would have them."""
    kappa = np.array([0.1, -0.02, -0.02, 0.1, 0.09, 0.08])
    energy = np.array([-3.0, -1.0, -1.0, -3.1, -2.0, -2.5])
    membrane = np.random.default_rng(1).normal(size=(6, 3, 3))
    membrane += membrane.transpose(0, 2, 1)
    known: dict[str, Any] = {name: np.arange(6.0) for name in SCALAR_KEYS}
    known |= {"angles_rad": np.radians(30.0 * np.arange(6)), "natural_curvature": kappa, "natural_energy": energy}
    known |= {"natural_membrane": membrane, "rest_metric": np.array([[0.7, 0.02], [0.02, 0.6]])}
    found = symmetric_responses(known, point_group(Lattice(**FOUR)), Fabric())
    np.testing.assert_array_equal(found["natural_curvature"], [0.1, 0.08, 0.08, 0.1, 0.08, 0.08])
    np.testing.assert_array_equal(found["natural_energy"], [-3.1, -2.5, -2.5, -3.1, -2.5, -2.5])
    np.testing.assert_allclose(found["rest_metric"], 0.65 * np.eye(2), atol=1e-15)
    # the stretch along any direction costs the same energy in the direction that is equal by symmetry
    for angle in np.linspace(0.0, np.pi, 7):
        strains = [_stretch_along(angle), _stretch_along(np.pi - angle), _stretch_along(angle + 0.5 * np.pi)]
        of_150, of_30, of_60 = (
            strain @ found["natural_membrane"][k] @ strain for k, strain in zip((5, 1, 2), strains, strict=True)
        )
        assert of_30 == pytest.approx(of_150) and of_60 == pytest.approx(of_150)
    uneven = symmetric_responses(known, point_group(Lattice(**FOUR)), Fabric(stretch=(1.35, 1.2)))
    grained = symmetric_responses(known, point_group(Lattice(**FOUR)), Fabric(modulus_mpa=(2.0, 1.0)))
    for one in (uneven, grained):
        np.testing.assert_array_equal(one["natural_curvature"], [0.1, 0.08, 0.09, 0.1, 0.09, 0.08])


def _stretch_along(angle: float) -> Floats:
    """(3,) Voigt strain of a stretch along a direction, rad from x."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * c, s * s, 2.0 * c * s])


TURNED = [[17.0 * np.cos(a), 17.0 * np.sin(a)] for a in np.radians((10.0, 70.0))]


@pytest.mark.parametrize(
    ("lattice", "fabric", "alike"),
    [
        ({}, {}, True),
        ({"arms": 6}, {}, True),
        ({"orientation_deg": 20}, {}, True),
        ({"kind": "custom", "vectors_mm": TURNED}, {"modulus_mpa": [2.0, 2.0]}, True),
        ({"arms": 5}, {}, False),
        ({"arms": 4, "kind": "square"}, {}, False),
        ({"arms": 3, "kind": "square"}, {}, False),
        ({}, {"modulus_mpa": [2.0, 1.0]}, False),
        ({}, {"stretch": [1.2, 1.3]}, False),
    ],
)
def test_what_a_sheet_needs(lattice: dict[str, Any], fabric: dict[str, Any], alike: bool) -> None:
    found = tube_angles(design(5.0, lattice=lattice, fabric=fabric))
    assert found == (THREEFOLD_ANGLES_RAD if alike else ALL_ANGLES_RAD)


def test_six_directions_have_the_mean_of_all() -> None:
    def curl(angle: np.ndarray) -> np.ndarray:
        return 0.05 + 0.01 * np.cos(2 * angle - 1.0) + 0.004 * np.sin(4 * angle) + 0.003 * np.cos(6 * angle)

    values = curl(np.array(ALL_ANGLES_RAD))
    assert values[averaged_directions(values)].mean() == pytest.approx(0.05, rel=1e-12)
    three = 0.05 + 0.003 * np.cos(6 * np.array(THREEFOLD_ANGLES_RAD))
    assert averaged_directions(three) == [0, -1]


@pytest.mark.slow
def test_a_law_of_five_arms_follows_its_directions() -> None:
    """The same star seen from the next direction, turned with its lattice, has the same row, the mean over directions.

    Star and lattice are their own mirror images, the state of the cell is not: which of the two it comes to is a matter
    of rounding.
    """
    lattice = np.asarray(Lattice(kind="square").vectors)
    cos, sin = np.cos(np.pi / 6), np.sin(np.pi / 6)
    turned = lattice @ np.array([[cos, sin], [-sin, cos]])
    custom = {"kind": "custom", "arms": 5}
    stars = [{"vectors_mm": lattice.tolist()}, {"vectors_mm": turned.tolist(), "orientation_deg": 30.0}]
    rows = [solve_cell(design(6.0, 0.5, lattice={**custom, **star}), EDGE).to_dict() for star in stars]
    assert [len(one["angles_rad"]) for one in rows] == [6, 6]
    curvature = [np.array(one["natural_curvature"]) for one in rows]
    same = np.roll(curvature[0], 1)
    images = [same, same[(2 - np.arange(6)) % 6]]
    assert any(np.allclose(image, curvature[1], rtol=1e-4) for image in images)
    assert np.ptp(curvature[0]) > 1e-3 * abs(curvature[0].mean())
    for found in rows:
        kappa = np.array(found["natural_curvature"])
        assert np.abs(predicted_curvatures(found) - kappa).max() < 0.5 * np.ptp(kappa)
    one, other = (sample_quantities(found, 1.35) for found in rows)
    assert one[QUANTITY_NAMES.index("c3")] == other[QUANTITY_NAMES.index("c3")] == 0.0
    np.testing.assert_allclose(other, one, rtol=1e-3)
