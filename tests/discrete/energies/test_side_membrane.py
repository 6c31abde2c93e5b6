"""The membrane smoothed over sides: exactness, folds, stiffness in its plane, and where it is used.

Fabric with a grain: its linear limit, stability at finite stretch, and equal moduli.
"""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from scipy.optimize import minimize

from asterism.discrete.energies.bending.fabric_bending import interior_edges
from asterism.discrete.energies.elements import Elements
from asterism.discrete.energies.membrane import Membrane, SideMembrane, flat_share
from asterism.equilibrium.arrays import Array
from asterism.homogenize.cell.unit_cell import UnitCell
from asterism.pattern.design.design import Design
from asterism.pattern.design.materials import Fabric
from tests.discrete.models import seven_stars
from tests.discrete.plain import full
from tests.discrete.samples import rotation
from tests.discrete.test_fabric import KNIT, MESHES, SIDE, area

SHEET = Fabric()
FABRICS = {"one modulus": SHEET, "incompressible": Fabric(model="incompressible"), "a grain": KNIT}
PLATE = {"bending": "consistent", "modulus_mpa": 7.1875}


def smooth(triangles: Array, rest: Array, sheet: Fabric = SHEET) -> list[Elements]:
    """The membrane of a plate on an open mesh."""
    return [
        Membrane(triangles, rest, sheet, flat_share(triangles, False)),
        SideMembrane(interior_edges(triangles), rest, sheet),
    ]


def forces(parts: list[Elements], positions: Array) -> Array:
    """(V, 3) N."""
    total = np.zeros(positions.size)
    for part in parts:
        total += np.bincount(part.dofs.ravel(), part.gradients(positions.ravel()).ravel(), positions.size)
    return total.reshape(-1, 3)


@pytest.mark.parametrize("mesh", MESHES)
@pytest.mark.parametrize("sheet", FABRICS.values(), ids=FABRICS)
def test_homogeneous_finite_strain_is_exact(mesh, sheet):
    """The energy and all forces are those of flat triangles, at the border too; the flat sheet is turned in space."""
    points, triangles = MESHES[mesh](2.0)
    strain = np.array([[1.2, 0.3], [-0.1, 0.8]])
    flat = np.column_stack([points @ strain.T, np.zeros(len(points))]) @ rotation(np.random.default_rng(1)).T
    paper, parts = Membrane(triangles, points, sheet), smooth(triangles, points, sheet)
    expected = paper.energies(flat.ravel()).sum()
    assert sum(part.energies(flat.ravel()).sum() for part in parts) == pytest.approx(expected, rel=1e-12)
    scale = np.abs(paper.gradients(flat.ravel())).max()
    np.testing.assert_allclose(forces(parts, flat), forces([paper], flat), atol=1e-11 * scale)


def test_folds_cost_no_energy():
    points = np.array([[0.0, 0.0], [1.0, 0.0], [0.4, 0.9], [0.5, -0.8]])
    sides = SideMembrane(np.array([[0, 1, 2, 3]]), points, SHEET)
    angle = 2.0
    folded = np.column_stack([points, np.zeros(4)])
    folded[3] = [0.5, -0.8 * np.cos(angle), 0.8 * np.sin(angle)]
    assert abs(sides.energies(folded.ravel())[0]) < 1e-14


def in_plane_bending_error(parts: list[Elements], points: Array, triangles: Array) -> float:
    """Energy of a sheet with the strain `k y` along x, over the exact one, minus 1; no Poisson's ratio."""
    k = 1e-4
    x, y = (points - points.mean(axis=0)).T
    bent = np.column_stack([x + k * x * y, y - 0.5 * k * x**2, 0.0 * x])
    corner = y[triangles]
    second_moment = area(points, triangles) / 12.0 * ((corner**2).sum(axis=1) + corner.sum(axis=1) ** 2)
    energy = sum(float(part.energies(bent.ravel()).sum()) for part in parts)
    return energy / float(3.5 * k**2 * second_moment.sum()) - 1.0


def test_sheets_bend_in_their_plane_with_less_parasitic_strain():
    points, triangles = MESHES["jittered"](2.0)
    sheet = Fabric(thickness_mm=1.0, modulus_mpa=7.0, poisson=0.0)
    flat = in_plane_bending_error([Membrane(triangles, points, sheet)], points, triangles)
    sides = in_plane_bending_error(smooth(triangles, points, sheet), points, triangles)
    assert flat > 0.01
    assert abs(sides) < 0.4 * flat


def test_flat_sheets_have_no_modes_without_energy():
    """A stretched sheet that is held at its border is stiff against every motion, checkerboards and wrinkles too."""
    points, triangles = MESHES["random"](4.0)
    positions = np.column_stack([1.2 * points, np.zeros(len(points))]).ravel()
    held = np.isclose(points, 0.0).any(axis=1) | np.isclose(points, SIDE).any(axis=1)
    free, n = np.repeat(~held, 3), len(positions)
    smallest = []
    for parts in ([Membrane(triangles, points, SHEET)], smooth(triangles, points)):
        whole = np.zeros((n, n))
        for part in parts:
            for dofs, block in zip(part.dofs, full(part.hessians(positions)), strict=True):
                whole[np.ix_(dofs, dofs)] += block
        smallest.append(np.linalg.eigvalsh(whole[np.ix_(free, free)])[0])
    assert smallest[1] > 0.7 * smallest[0] > 0.0


def test_a_plate_has_smooth_strains_and_hinges_have_flat_triangles():
    """Models and cells; the paper's membrane keeps all of its energy."""
    for fabric, smoothed in ((PLATE, True), ({"bending": "paper"}, False)):
        model = seven_stars(**fabric)
        for parts in (model.parts, UnitCell(model.design, 4.0).model.parts):
            flat = parts["membrane"]
            assert isinstance(flat, Membrane)
            assert ("membrane_sides" in parts) is smoothed is not np.array_equal(flat.params, flat.whole)


@pytest.mark.parametrize("release", [0.0, 0.4, 1.0])
def test_the_release_sets_the_rest_shape(release):
    """The parts of a model equal elements built on the released sheet."""
    model = seven_stars(**PLATE, stretch=[1.4, 1.2])
    model.set_release(release)
    rest = model.mesh.points / (1.0 + release * (np.array([1.4, 1.2]) - 1.0))
    for part, name in zip(smooth(model.mesh.triangles, rest), ("membrane", "membrane_sides"), strict=True):
        np.testing.assert_allclose(model.parts[name].params, part.params, rtol=1e-12)


def test_reconstruction_counts_the_whole_fabric():
    """What reads the flat triangles is the same for plates and hinges."""
    plate, hinges = seven_stars(**PLATE), seven_stars()
    free = np.arange(len(plate.mesh.points))
    for one, other in zip(
        plate.reconstruction.laplacian(free)[1:], hinges.reconstruction.laplacian(free)[1:], strict=True
    ):
        np.testing.assert_allclose(one, other, rtol=1e-12)


def test_homogeneous_strain_of_a_cell_leaves_no_force():
    """On the points of a graded cell, across its borders too."""
    graded = {"mesh": {"graded": True, "edge_mm": 2.4}, "fabric": PLATE}
    cell = UnitCell(Design.from_dict({"stars": {"length_mm": 8.0}, "border": {"rings": 1}} | graded), 2.4)
    packed = 1.1 * cell.printed_state().packed
    force = np.zeros(cell.n_dofs)
    for name, part in cell.parts.items():
        if name.startswith("membrane"):
            force += np.bincount(part.dofs.ravel(), part.gradients(packed).ravel(), cell.n_dofs)
    assert np.abs(force[: 3 * cell.mesh.n_base]).max() < 1e-11 * np.abs(force).max()


SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
HALVES = np.array([[0, 1, 2], [0, 2, 3]])
KNITS = [
    Fabric(modulus_mpa=(9.0, 4.0)),
    Fabric(modulus_mpa=(4.0, 12.4), poisson=0.2),
    Fabric(modulus_mpa=(12.0, 4.0), shear_modulus_mpa=1.0),
    Fabric(modulus_mpa=(16.0, 4.0)),
]


def plane_stiffness(fabric: Fabric) -> Array:
    """(3, 3) MPa, of the strains along, across and shear, from the compliance of both moduli."""
    (along, across), mean = fabric.moduli, fabric.modulus
    both = -fabric.poisson / mean
    return np.linalg.inv([[1 / along, both, 0], [both, 1 / across, 0], [0, 0, 1 / fabric.shear_modulus]])


def energy(fabric: Fabric, deformation: Array) -> float:
    """N/mm^2, energy per volume of a square with this deformation gradient (2, 2)."""
    flat = np.column_stack([SQUARE @ deformation.T, np.zeros(4)])
    return float(Membrane(HALVES, SQUARE, fabric).energies(flat.ravel()).sum() / fabric.thickness_mm)


@pytest.mark.parametrize("fabric", KNITS)
@pytest.mark.parametrize("angle", [0.0, 45.0, 90.0, 25.0])
def test_a_strip_that_is_pulled(fabric: Fabric, angle: float) -> None:
    """Its modulus at this angle to the grain, its contraction across, and its shear where it is off the grain."""
    turned = fabric.model_copy(update={"grain_deg": -angle})
    membrane, strain = Membrane(HALVES, SQUARE, turned), 1e-4

    def of(free: Array) -> tuple[float, Array]:
        """The energy and its derivatives by the strain across and the shear."""
        deformation = np.array([[1.0 + strain, free[1]], [0.0, 1.0 + free[0]]])
        flat = np.column_stack([SQUARE @ deformation.T, np.zeros(4)]).ravel()
        force = np.zeros(12)
        np.add.at(force, membrane.dofs, membrane.gradients(flat))
        force = force.reshape(4, 3)
        return 1e6 * membrane.energies(flat).sum(), 1e6 * np.array(
            [force[:, 1] @ SQUARE[:, 1], force[:, 0] @ SQUARE[:, 1]]
        )

    relaxed = minimize(of, np.zeros(2), jac=True, method="BFGS", options={"gtol": 1e-9})
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    compliance = np.linalg.inv(plane_stiffness(fabric))
    # strains along the grain of a stress of 1 along the strip, then along the strip
    grain = compliance @ [c * c, s * s, s * c]
    along = grain @ [c * c, s * s, s * c]
    across, shear = grain @ [s * s, c * c, -s * c], grain @ [-2 * s * c, 2 * s * c, c * c - s * s]
    assert relaxed.fun / 1e6 / fabric.thickness_mm == pytest.approx(0.5 * strain**2 / along, rel=1e-3)
    np.testing.assert_allclose(relaxed.x / strain, [across / along, shear / along], atol=2e-3)


@pytest.mark.parametrize("fabric", KNITS)
def test_it_is_stable_from_half_to_double_length(fabric: Fabric) -> None:
    """Strong ellipticity: every wave a x b in the plane has energy, at any stretch and angle to the grain."""
    membrane, least = Membrane(HALVES[:1], SQUARE, fabric), np.inf
    waves = np.array([(np.cos(t), np.sin(t)) for t in np.linspace(0.0, np.pi, 25)[:-1]])
    moved = np.zeros((len(waves), len(waves), 3, 3))
    moved[..., :2] = np.einsum("vj,bj,ac->abvc", SQUARE[:3], waves, waves)
    moved = moved.reshape(-1, 9)
    for first, second, angle in product((0.5, 0.8, 1.35, 2.0), (0.5, 0.8, 1.35, 2.0), np.linspace(0.0, np.pi, 13)[:-1]):
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        deformed = SQUARE @ (turn @ np.diag([first, second]) @ turn.T)
        hessian = full(membrane.hessians(np.column_stack([deformed, np.zeros(4)]).ravel()))[0]
        least = min(least, np.einsum("wi,ij,wj->w", moved, hessian, moved).min())
    assert least > 1e-3 * fabric.thickness_mm * fabric.shear_modulus / 2


def test_equal_moduli_with_a_grain_are_neo_hookean() -> None:
    """Turned axes only round differently."""
    rng = np.random.default_rng(3)
    one, two = (Fabric(modulus_mpa=moduli, grain_deg=g) for moduli, g in ((7.0, 0.0), ((7.0, 7.0), 33.0)))
    for _ in range(10):
        deformation = np.eye(2) + 0.3 * rng.normal(size=(2, 2))
        if np.linalg.det(deformation) > 0.1:
            assert energy(two, deformation) == pytest.approx(energy(one, deformation), rel=1e-12)
