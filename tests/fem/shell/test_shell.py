"""The shell as a problem for Newton's method: energy, gradient and Hessian over the free unknowns."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.errors import BackendError
from asterism.fem.elements.argyris import Argyris, area_load
from asterism.fem.shell.density import Density, isotropic
from asterism.fem.shell.fields import FieldError, Fields, of_stretch
from asterism.fem.shell.hyperelastic import MIN_C, MIN_DET_C, hyperelastic
from asterism.fem.shell.shell import Shell
from asterism.fem.supports.conditions import EdgeSupport, PointSupport, vertices_at
from tests.fem.hexagons import FIELDS, hexagon
from tests.fem.maps import arc
from tests.fem.meshes import facets_where, rectangle


def _rolled(progress: float) -> tuple[Shell, Floats]:
    """A clamped strip with a pinned corner, weight and fields of its own; rolled up by 250 degrees."""
    mesh = rectangle(3, 2, 2.0, 1.0, amount=0.15)
    space = Argyris(mesh)
    ends = [facets_where(mesh, lambda x, y, e=e: abs(x - e) < 1e-9) for e in (0.0, 2.0)]
    corner = PointSupport(vertices_at(mesh, np.array([[2.0, 1.0]])), np.array([[0.3, 0.9, 0.8]]))
    density = Density(isotropic(3.0, 0.2, 0.3), 0.1, np.radians(20.0), 1.5)
    shell = Shell(
        space,
        of_stretch(density, lambda p: 0.9 + 0.1 * p[..., 0], 0.4),
        [EdgeSupport(ends[0], clamped=True), corner],
        area_load(space, (0.1, 0.0, -0.3)),
    )
    shell = shell.at_progress(progress)
    x = space.interpolate(arc(2.2).jets)
    return shell, shell.constrain(x + 0.02 * np.random.default_rng(0).standard_normal(x.shape))


@pytest.mark.parametrize("progress", [1.0, 0.4], ids=["whole", "load step"])
def test_forces_and_hessian_are_derivatives(progress: float) -> None:
    """VALIDATION V1 for all parts together, also at partial progress."""
    shell, x = _rolled(progress)
    assert set(shell.energies(x)) == {"sheet", "loads"}
    random, step = np.random.default_rng(1), 1e-6
    hessian = shell.hessian(x)
    for _ in range(3):
        direction = random.standard_normal(shell.pattern.size)
        ahead, behind = shell.move(x, step * direction), shell.move(x, -step * direction)
        slope = (shell.energy(ahead) - shell.energy(behind)) / (2.0 * step)
        assert shell.gradient(x) @ direction == pytest.approx(slope, rel=1e-6)
        change = (shell.gradient(ahead) - shell.gradient(behind)) / (2.0 * step)
        exact = shell.pattern.product(hessian, direction)
        assert np.linalg.norm(change - exact) < 1e-6 * np.linalg.norm(exact)


def test_rigid_motions_of_a_free_sheet_cost_no_energy() -> None:
    """VALIDATION V2: resultant force and moment are zero in any state."""
    mesh = rectangle(3, 2, 2.0, 1.0, amount=0.15)
    shell = Shell(Argyris(mesh), of_stretch(Density(isotropic(3.0, 0.2, 0.3)), 0.9, 0.4))
    x = shell.space.interpolate(arc(2.2).jets) + 0.02 * np.random.default_rng(0).standard_normal(shell.flat.shape)
    modes, forces = shell.rigid_modes(x), shell.gradient(x)
    assert modes.shape[1] == 6
    assert np.abs(modes.T @ forces).max() < 1e-11 * np.linalg.norm(forces)
    axis = np.array([2.0, -1.0, 0.5]) / np.sqrt(5.25)
    cross = np.cross(axis, np.eye(3)).T
    turn = np.eye(3) + np.sin(2.0) * cross + (1.0 - np.cos(2.0)) * cross @ cross
    moved = shell.translated(x @ turn.T, np.array([30.0, -20.0, 5.0]))
    assert shell.energy(moved) == pytest.approx(shell.energy(x), rel=1e-9)


def test_gaussian_energy_is_the_part_of_its_modulus() -> None:
    """Also on a twisted sheet, where `b12` gives all of it."""
    space = Argyris(hexagon(1))
    plain, more = (Shell(space, replace(FIELDS["rolled"], gaussian=g)) for g in (0.0, 0.3))

    def twist(points: np.ndarray) -> np.ndarray:
        """`z = rate x y` with its derivatives."""
        out, (one, two), rate = np.zeros((len(points), 6, 3)), points.T, 5e-3
        out[:, 0, 2], out[:, 1, 2], out[:, 2, 2], out[:, 5, 2] = rate * one * two, rate * two, rate * one, rate
        return out

    x = plain.flat + space.interpolate(twist)
    assert more.gaussian_energy(x) == pytest.approx(more.energy(x) - plain.energy(x), rel=1e-6)
    assert more.gaussian_energy(x) < -1e-3


def test_multigrid_is_refused() -> None:
    """Multigrid does not prove definiteness, so a saddle could count as a minimum."""
    with pytest.raises(BackendError, match="'amg' does not work with a shell"):
        Shell(Argyris(rectangle(1, 1)), FIELDS["bowl"]).factor("amg")


def test_mass_of_a_supported_sheet() -> None:
    mesh = hexagon(1)
    shell = Shell(Argyris(mesh), FIELDS["dome"], [EdgeSupport(mesh.boundary_facets()[:3])])
    at = shell.space.locate(shell.points.reshape(-1, 2)).value
    scalar = at.T @ sp.diags_array(shell.assembly.weights.ravel()) @ at
    full = shell.reduction.map.T @ sp.kron(scalar, sp.identity(3)) @ shell.reduction.map
    assert abs(shell.mass - full).max() < 1e-12 * abs(full).max()


PLATE = Density(isotropic(20.0, 10.0, 0.3))
POINTS = np.zeros((2, 3, 2))


def test_rest_values_have_the_components_of_the_strains() -> None:
    """Half of the metric, and twice both components 12."""
    rest = Fields(PLATE, (1.1, 0.9, 0.1), (0.01, 0.02, 0.003)).rest(POINTS)
    np.testing.assert_allclose(rest, np.broadcast_to([0.55, 0.45, 0.1, 0.01, 0.02, 0.006], (2, 3, 6)))


def test_curvature_is_that_of_the_contracted_sheet() -> None:
    rest = of_stretch(PLATE, 0.8, 0.02).rest(POINTS)
    np.testing.assert_allclose(rest, np.broadcast_to([0.32, 0.32, 0.0, 0.0128, 0.0128, 0.0], (2, 3, 6)))


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        (of_stretch(PLATE, -0.8), "rest metric at .* is not positive definite"),
        (Fields(PLATE, (-1.0, 1.0, 0.0)), r"rest metric at \(.*\) mm: \(-1, 1, 0\) is not positive definite"),
        *((Fields(PLATE, metric), "is not positive definite")
          for metric in ((-1.0, -1.0, 0.0), (1.0, 1.0, 1.0), (0.0, 0.0, 0.0), (1.0, 1.0, -1.1))),
        (Fields(PLATE, curvature=(np.nan, 0.0, 0.0)), "rest curvature at .* is not finite"),
        (Fields(PLATE, gaussian=np.nan), r"modulus of Gaussian curvature at .* mm: \(nan\) is not finite"),
        (Fields(Density(np.full((6, 6), np.nan))), r"stiffness at .* \(nan\) is not finite"),
        (Fields(Density(PLATE.stiffness + 0.1 * np.eye(6, k=1))), "stiffness at .* is not symmetric"),
        (Fields(Density(PLATE.stiffness, sixfold=np.nan)), "sixfold at .* is not finite"),
        (Fields(Density(PLATE.stiffness, sixfold=1.0, saturation=0.0)), "saturation at .* is not positive"),
    ],
)  # fmt: skip
def test_impossible_fields_are_refused_with_place_and_value(fields: Fields, words: str) -> None:
    with pytest.raises(FieldError, match=words) as caught:
        Shell(Argyris(hexagon(0)), fields)
    assert "\n" not in str(caught.value) and len(str(caught.value)) < 120


@pytest.mark.parametrize("exponents", [(1.0, 1.0), (1.6, 0.58)])
@pytest.mark.parametrize("low", [-0.15, -0.6])
def test_gradient_and_hessian_are_derivatives(low: float, exponents: tuple[float, float]) -> None:
    strains = np.random.default_rng(0).uniform(low, 0.4, (20, 3))
    det = (1.0 + 2.0 * strains[:, 0]) * (1.0 + 2.0 * strains[:, 1]) - strains[:, 2] ** 2
    assert (det < MIN_DET_C).any() == (1.0 + 2.0 * strains[:, :2] < MIN_C).any() == (low < -0.5)
    mu, lam = np.full(20, 1.3), np.full(20, 0.7)
    energy, gradient, hessian = hyperelastic(strains, mu, lam, exponents)
    assert (energy > 0.0).all()
    for k in range(3):
        step = 1e-6 * np.eye(3)[k]
        high, below = (hyperelastic(strains + sign * step, mu, lam, exponents) for sign in (1.0, -1.0))
        assert (high[0] - below[0]) / 2e-6 == pytest.approx(gradient[:, k], abs=1e-6)
        assert (high[1] - below[1]) / 2e-6 == pytest.approx(hessian[:, k], rel=1e-6, abs=1e-5)
