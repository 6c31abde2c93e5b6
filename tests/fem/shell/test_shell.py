"""The shell as a problem for Newton's method: energy, gradient and Hessian over the free unknowns.

Strains, energy and their derivatives at states bent by more than 90 degrees, and invariance of the energy.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from skfem import MeshTri

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.errors import BackendError
from asterism.fem.elements.argyris import Argyris, area_load
from asterism.fem.shell.assembly import Assembly
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
    turn = Rotation.from_rotvec([1.7, -0.9, 0.4]).as_matrix()
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


CURVATURE = 2.2  # over a width of 2: bent by 4.4 radians


def bent(noise: float) -> tuple[Assembly, Floats]:
    """A sheet rolled by 252 degrees."""
    mesh = rectangle(3, 3, 2.0, 2.0, amount=0.15)
    element = Argyris(mesh)
    x = element.interpolate(arc(CURVATURE).jets)
    x += noise * np.random.default_rng(0).standard_normal(x.shape)
    return Assembly(element.tabulate(6), element.size), x


def some_density(shape: tuple[int, ...]) -> Density:
    """A density with coupling, nonuniform, with a sixfold and a stiffening term."""
    random = np.random.default_rng(1)
    root = random.standard_normal((*shape, 6, 6))

    def stiffening(e: Floats) -> tuple[Floats, Floats, Floats]:
        square = (e**2).sum(axis=1)
        gradient = square[:, None] * e
        return 0.25 * square**2, gradient, square[:, None, None] * np.eye(6) + 2.0 * e[:, :, None] * e[:, None]

    density = Density(root @ np.swapaxes(root, -1, -2), 0.7, random.uniform(0.0, 6.0, shape), 0.9, stiffening)
    return density.with_gaussian(random.standard_normal(shape), random.standard_normal((*shape, 3)))


def test_derivatives_where_the_sheet_is_rolled_up() -> None:
    """VALIDATION V1."""
    assembly, x = bent(0.02)
    random = np.random.default_rng(2)
    density, rest = some_density(assembly.weights.shape), 0.2 * random.standard_normal((*assembly.weights.shape, 6))

    def energy(y: Floats) -> float:
        return float((assembly.weights * density(assembly.strains(y, rest))[0]).sum())

    def gradient(y: Floats) -> Floats:
        return assembly.forces(y, density(assembly.strains(y, rest))[1])

    _, stress, stiffness = density(assembly.strains(x, rest))
    hessian = assembly.tangent(x, stiffness, stress)
    step = 2e-6
    for _ in range(3):
        move = random.standard_normal(x.shape)
        ahead, behind = x + step * move, x - step * move
        slope = (energy(ahead) - energy(behind)) / (2.0 * step)
        assert slope == pytest.approx(float((gradient(x) * move).sum()), rel=1e-6)
        change = (gradient(ahead) - gradient(behind)) / (2.0 * step)
        exact = assembly.pattern.product(hessian, move.ravel()).reshape(-1, 3)
        assert np.linalg.norm(change - exact) < 1e-6 * np.linalg.norm(exact)
        strain = (assembly.strains(ahead, rest) - assembly.strains(behind, rest)) / (2.0 * step)
        exact = assembly.strain_changes(x, move)
        assert np.linalg.norm(strain - exact) < 1e-6 * np.linalg.norm(exact)


def test_a_cylinder_has_its_strains() -> None:
    """Zero membrane strain and one curvature, positive if the sheet is concave on the side of its normal."""
    mesh = rectangle(16, 2, 2.0, 2.0)
    element = Argyris(mesh)
    assembly, x = Assembly(element.tabulate(6), element.size), element.interpolate(arc(CURVATURE).jets)
    strains = assembly.strains(x, np.zeros((*assembly.weights.shape, 6)))
    exact = np.array([0.5, 0.5, 0.0, CURVATURE, 0.0, 0.0])
    assert np.abs(strains - exact).max() < 1e-4


@given(st.integers(0, 2**31))
@settings(max_examples=12)
def test_motions_and_mirrors(seed: int) -> None:
    """VALIDATION V2: rigid motions leave the strains; a mirror changes the sign of the curvatures."""
    assembly, x = bent(0.02)
    random = np.random.default_rng(seed)
    turn = np.linalg.qr(random.standard_normal((3, 3)))[0]
    shift = random.uniform(-50.0, 50.0, 3)
    element = Argyris(rectangle(3, 3, 2.0, 2.0, amount=0.15))
    ones = element.ones[:, None]
    rest = np.zeros((*assembly.weights.shape, 6))
    before, after = assembly.strains(x, rest), assembly.strains(x @ turn.T + ones * shift, rest)
    before[..., 3:] *= np.sign(np.linalg.det(turn))
    assert np.abs(after - before).max() < 1e-10 * np.abs(before).max()


def test_numbering_of_the_mesh_does_not_matter() -> None:
    mesh = rectangle(3, 2, 2.0, 2.0, amount=0.15)
    order = np.random.default_rng(5).permutation(mesh.nvertices)
    other = MeshTri(mesh.p[:, order], np.argsort(order)[mesh.t][:, ::-1].copy())
    sums = []
    for each in (mesh, other, mesh.oriented()):  # the last one has unsorted triangles
        element = Argyris(each)
        assembly = Assembly(element.tabulate(8), element.size)
        strains = assembly.strains(element.interpolate(arc(CURVATURE).jets), np.zeros((*assembly.weights.shape, 6)))
        sums.append((assembly.weights[..., None] * strains**2).sum(axis=(0, 1)))
    for more in sums[1:]:
        assert np.allclose(sums[0], more, rtol=1e-11, atol=1e-14)


def test_the_roll_axis_has_six_best_directions() -> None:
    density = Density(isotropic(1.0, 1.0, 0.3), 0.5, np.radians(10.0), saturation=4.0)
    angles = np.radians(np.arange(0, 360, 10))
    c, s = np.cos(angles), np.sin(angles)
    curvature = 1.5
    cylinders = curvature * np.stack([0 * c, 0 * c, 0 * c, c**2, s**2, 2.0 * c * s], axis=1)
    energy, _, _ = density(cylinders[None])
    rise = energy[0] - energy[0].mean()
    cut = 1.0 / (1.0 + (0.5 * curvature / 4.0) ** 2)
    assert np.allclose(rise, 0.5 * (0.5 * curvature) ** 3 * cut * np.cos(6.0 * (angles - np.radians(10.0))), atol=1e-13)
    # and leaves the energy bounded
    far = np.array([[0.0, 0.0, 0.0, -1e4, 1e4, 0.0], [0.0, 0.0, 0.0, 1e4, -1e4, 0.0]])
    assert (Density(isotropic(1.0, 1.0, 0.3), 50.0, 0.0, saturation=1.0)(far[None])[0] > 1e7).all()


def test_energy_of_gaussian_curvature() -> None:
    """The energy is larger by `g det b`, for any rest curvature."""
    random = np.random.default_rng(4)
    plain = Density(isotropic(3.0, 2.0, 0.3), 0.4, 0.2, 0.9)
    modulus, rest = random.standard_normal((2, 3)), random.standard_normal((2, 3, 3))
    e = random.standard_normal((2, 3, 6))
    b = e[..., 3:] * [1.0, 1.0, 0.5] + rest
    more = plain.with_gaussian(modulus, rest)(e)[0] - plain(e)[0]
    assert np.allclose(more, modulus * (b[..., 0] * b[..., 1] - b[..., 2] ** 2), atol=1e-13)
    assert np.allclose(plain.with_gaussian(modulus, rest).energies(e), plain(e)[0] + more, atol=1e-13)
