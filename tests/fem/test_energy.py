"""Strains, energy and their derivatives at states bent by more than 90 degrees, and invariance of the energy."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from skfem import MeshTri

from asterism.equilibrium.arrays import Floats
from asterism.fem.elements.argyris import Argyris
from asterism.fem.shell.assembly import Assembly
from asterism.fem.shell.density import Density, isotropic
from tests.fem.maps import arc
from tests.fem.meshes import rectangle

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
