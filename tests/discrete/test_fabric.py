"""V3 and V4: the fabric as a membrane, and the bending stiffness of the paper's hinges."""

from __future__ import annotations

from typing import Literal

import numpy as np
import pytest
from scipy.spatial import Delaunay

from asterism.discrete.energies.bending.fabric_bending import interior_edges
from asterism.discrete.energies.bending.hinges import Hinges, fold_coefficients, hinge_coefficients
from asterism.discrete.energies.membrane import Membrane
from asterism.discrete.model.state import State
from asterism.discrete.model.system import System
from asterism.equilibrium.arrays import Array
from asterism.equilibrium.linear.backends import make_factor
from asterism.equilibrium.newton.minimise import minimise
from asterism.pattern.design.materials import Fabric
from tests.discrete.models import seven_stars

THICKNESS, MODULUS, POISSON = 0.8, 7.1875, 0.3
HINGES = Fabric(thickness_mm=THICKNESS, modulus_mpa=MODULUS, poisson=POISSON).bending_tensor
KNIT = Fabric(thickness_mm=THICKNESS, modulus_mpa=(9.0, 4.0), grain_deg=30.0)
SIDE = 20.0


def counterclockwise(points: Array, triangles: Array) -> Array:
    return np.where(area(points, triangles)[:, None] < 0.0, triangles[:, ::-1], triangles)


def right_triangles(edge: float) -> tuple[Array, Array]:
    """Squares, all divided along the same diagonal."""
    n = round(SIDE / edge)
    grid = np.linspace(0.0, SIDE, n + 1)
    points = np.stack(np.meshgrid(grid, grid, indexing="ij"), axis=-1).reshape(-1, 2)
    corner = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    lower = np.column_stack([corner, corner + n + 1, corner + n + 2])
    upper = np.column_stack([corner, corner + n + 2, corner + 1])
    return points, np.concatenate([lower, upper])


def equilateral(edge: float) -> tuple[Array, Array]:
    rows, columns = round(SIDE / (edge * np.sqrt(0.75))), round(SIDE / edge)
    i, j = np.meshgrid(np.arange(rows + 1), np.arange(columns + 1), indexing="ij")
    points = edge * np.stack([j + 0.5 * (i % 2), np.sqrt(0.75) * i], axis=-1).reshape(-1, 2)
    triangles = Delaunay(points).simplices
    # keep the triangles at the slanted sides well shaped
    longest = np.linalg.norm(points[triangles] - points[np.roll(triangles, 1, axis=1)], axis=2).max(axis=1)
    return points, counterclockwise(points, triangles[longest < 1.5 * edge])


def jittered(edge: float) -> tuple[Array, Array]:
    points, triangles = equilateral(edge)
    moved = points + 0.15 * edge * np.random.default_rng(0).uniform(-1.0, 1.0, points.shape)
    return moved, triangles


def random_delaunay(edge: float) -> tuple[Array, Array]:
    rng = np.random.default_rng(0)
    side = np.linspace(0.0, SIDE, round(SIDE / edge) + 1)[:-1]
    border = [np.column_stack(p) for p in ((side, 0 * side), (SIDE - side, 0 * side + SIDE))]
    border += [np.column_stack(p) for p in ((0 * side + SIDE, side), (0 * side, SIDE - side))]
    inside = rng.uniform(0.3 * edge, SIDE - 0.3 * edge, (round(1.15 * (SIDE / edge) ** 2), 2))
    points = np.concatenate([*border, inside])
    return points, counterclockwise(points, Delaunay(points).simplices)


MESHES = {"right": right_triangles, "equilateral": equilateral, "jittered": jittered, "random": random_delaunay}


def area(points: Array, triangles: Array) -> Array:
    e1, e2 = (points[triangles[:, i]] - points[triangles[:, 0]] for i in (1, 2))
    return 0.5 * (e1[:, 0] * e2[:, 1] - e1[:, 1] * e2[:, 0])


def sheet(incompressible: bool = False) -> Fabric:
    model: Literal["neo-hookean", "incompressible"] = "incompressible" if incompressible else "neo-hookean"
    return Fabric(thickness_mm=THICKNESS, modulus_mpa=MODULUS, poisson=POISSON, model=model)


def fabric(points: Array, triangles: Array, material: Fabric) -> System:
    """A system of the fabric alone, printed at its rest shape."""
    edges = interior_edges(triangles)
    hinges = Hinges(edges, hinge_coefficients(edges, points, HINGES.d11))
    parts = {"membrane": Membrane(triangles, points, material), "hinges": hinges}
    return System(parts, len(points), np.zeros((0, 2), dtype=int), np.zeros(3 * len(points), dtype=bool))


def flat(points: Array) -> State:
    return State(np.column_stack([points, np.zeros(len(points))]), np.zeros((0, 3)))


# V3


@pytest.mark.parametrize("mesh", MESHES)
@pytest.mark.parametrize("material", [sheet(), sheet(True), KNIT], ids=["one modulus", "incompressible", "a grain"])
def test_patch_test(mesh, material):
    """x = F X is an equilibrium of the interior, in any plane of space."""
    points, triangles = MESHES[mesh](2.5)
    system = fabric(points, triangles, material)
    f = np.array([[1.3, 0.2], [-0.1, 0.8], [0.4, 0.5]])
    gradient = system.full_gradient(State(points @ f.T, np.zeros((0, 3)))).reshape(-1, 3)
    edges = np.sort(np.concatenate([triangles[:, [i, (i + 1) % 3]] for i in range(3)]), axis=1)
    unique, count = np.unique(edges, axis=0, return_counts=True)
    border = np.unique(unique[count == 1])
    inside = np.setdiff1d(np.arange(len(points)), border)
    assert len(inside) > 30
    assert np.abs(gradient[inside]).max() < 1e-12 * np.abs(gradient[border]).max()


@pytest.mark.parametrize("incompressible", [False, True])
def test_released_free_fabric_takes_its_rest_size(incompressible):
    """Printed at stretch 1.35 and released, it has 1/1.35 of the printed size and zero energy."""
    stretch = 1.35
    printed, triangles = jittered(2.5)
    system = fabric(printed / stretch, triangles, sheet(incompressible))
    start = flat(printed)
    start.positions[:, 2] += 0.01 * np.random.default_rng(1).normal(size=len(printed))
    factor = make_factor(system.pattern)
    result = minimise(system, start, factor, 1e-9)
    factor.close()
    assert result.converged
    assert abs(result.energy) < 1e-15 * system.energy(start) * len(triangles)
    i, j = triangles[:, 0], triangles[:, 1]
    found = np.linalg.norm(result.state.positions[i] - result.state.positions[j], axis=1)
    np.testing.assert_allclose(found, np.linalg.norm(printed[i] - printed[j], axis=1) / stretch, rtol=1e-7)


@pytest.mark.parametrize("incompressible", [False, True])
@pytest.mark.parametrize(("a", "b"), [(1.35, 1.35), (1.5, 1.1), (0.9, 1.6), (2.0, 2.0)])
def test_biaxial_tension(a, b, incompressible):
    """Energy density, and the force on a side from it, of a square held at the stretches a and b.

    Neo-Hookean: `dW/da = mu (a - 1/a) + lam ln(ab)/a`. Incompressible: `dW/da = mu (a - 1/(a^3 b^2))`, the classic
    engineering stress of a thin sheet whose thickness follows from its volume.
    """
    points, triangles = jittered(4.0)
    points = points - points.mean(axis=0)
    system = fabric(points, triangles, sheet(incompressible))
    state = flat(points * [a, b])
    mu, lam = MODULUS / (2.0 * (1.0 + POISSON)), MODULUS * POISSON / (1.0 - POISSON**2)
    if incompressible:
        mu = MODULUS / 3.0
        density = 0.5 * mu * (a**2 + b**2 + 1.0 / (a * b) ** 2 - 3.0)
        stress = mu * (a - 1.0 / (a**3 * b**2)), mu * (b - 1.0 / (b**3 * a**2))
    else:
        log = np.log(a * b)
        density = 0.5 * mu * (a**2 + b**2 - 2.0 - 2.0 * log) + 0.5 * lam * log**2
        stress = mu * (a - 1.0 / a) + lam * log / a, mu * (b - 1.0 / b) + lam * log / b
    volume = THICKNESS * area(points, triangles).sum()
    assert system.energy(state) == pytest.approx(density * volume, rel=1e-12)
    # virtual work of the boundary forces in a uniform strain
    forces = system.full_gradient(state).reshape(-1, 3)
    assert forces[:, 0] @ points[:, 0] == pytest.approx(stress[0] * volume, rel=1e-12)
    assert forces[:, 1] @ points[:, 1] == pytest.approx(stress[1] * volume, rel=1e-12)


@pytest.mark.parametrize("incompressible", [False, True])
def test_small_strain_is_linear_elasticity(incompressible):
    """The first derivatives of the stress at rest are the plane-stress moduli E and nu (1/2 if incompressible)."""
    nu = 0.5 if incompressible else POISSON
    points, triangles = right_triangles(5.0)
    system = fabric(points, triangles, sheet(incompressible))
    volume = THICKNESS * area(points, triangles).sum()
    step = 1e-5
    for strain in (np.diag([1.0, 0.0]), np.diag([1.0, 1.0]), np.array([[0.0, 0.5], [0.5, 0.0]])):
        trace, square = np.trace(strain), (strain**2).sum()
        expected = 0.5 * MODULUS / (1.0 - nu**2) * (nu * trace**2 + (1.0 - nu) * square)
        energy = sum(system.energy(flat(points @ (np.eye(2) + side * step * strain))) for side in (1, -1))
        assert energy / (2.0 * step**2 * volume) == pytest.approx(expected, rel=1e-4)


def test_collapse_is_a_barrier():
    """The energy is infinite at a collapsed triangle, so no triangle can be inverted in its plane."""
    points, triangles = right_triangles(10.0)
    for material in (sheet(), sheet(True), KNIT):
        system = fabric(points, triangles, material)
        squeezed = [system.energy(flat(points * [x, 1.0])) for x in (1e-1, 1e-2, 1e-4, 1e-8)]
        assert (np.diff(squeezed) > 0.0).all()
        assert not np.isfinite(system.energy(flat(points * [0.0, 1.0])))


# V4 for the paper's hinges

SHAPES = {
    "cylinder": (0.5, lambda x, y, k: 0.5 * k * x**2),
    "turned cylinder": (0.5, lambda x, y, k: 0.25 * k * (x + y) ** 2),
    "saddle": (1.0 - POISSON, lambda x, y, k: 0.5 * k * (x**2 - y**2)),
    "sphere": (1.0 + POISSON, lambda x, y, k: 0.5 * k * (x**2 + y**2)),
}


def bending_factor(mesh: str, shape: str, edge: float) -> float:
    """Hinge energy over plate energy of a shallow graph of curvature k, on the triangles well inside.

    Each triangle has half of its three hinges.
    """
    points, triangles = MESHES[mesh](edge)
    plate, height = SHAPES[shape]
    k = 1e-4
    z = height(*(points - 0.5 * SIDE).T, k)
    hinges = interior_edges(triangles)
    elements = Hinges(hinges, hinge_coefficients(hinges, points, HINGES.d11))
    half = 0.5 * elements.energies(np.column_stack([points, z]).ravel())
    owners: dict[frozenset[int], int] = {frozenset(t): i for i, t in enumerate(triangles.tolist())}
    energy = np.zeros(len(triangles))
    for side in (2, 3):
        own = [owners[frozenset(t)] for t in hinges[:, [0, 1, side]].tolist()]
        np.add.at(energy, own, half)
    centre = points[triangles].mean(axis=1)
    inside = (np.abs(centre - 0.5 * SIDE) < 0.5 * SIDE - 1.5 * edge).all(axis=1)
    stiffness = MODULUS * THICKNESS**3 / (12.0 * (1.0 - POISSON**2))
    return energy[inside].sum() / (plate * stiffness * k**2 * area(points, triangles)[inside].sum())


@pytest.mark.parametrize("edge", [2.0, 1.0, 0.5])
@pytest.mark.parametrize(
    ("mesh", "factors"),
    [("equilateral", (3.0, 3.0, 40.0 / 7.0, 20.0 / 13.0)), ("right", (3.0, 9.0, 30.0 / 7.0, 30.0 / 13.0))],
)
def test_paper_bending_on_regular_meshes(mesh, factors, edge):
    """The stiffness factor does not depend on the resolution: 3 for any cylinder on equilateral triangles.

    Those are isotropic, a plate of stiffness 3 D and Poisson's ratio -1/3 whatever nu is; right triangles are three
    times stiffer along one diagonal than along their sides.
    """
    for shape, factor in zip(SHAPES, factors, strict=True):
        assert bending_factor(mesh, shape, edge) == pytest.approx(factor, rel=1e-5), shape


@pytest.mark.parametrize(("bending", "part", "column"), [("paper", "hinges", 0), ("consistent", "folds", 1)])
def test_hinges_follow_the_shape_of_the_fabric_at_rest(bending, part, column):
    """With different stretches in x and y the rest shape is not similar to the print, and changes with the release."""
    model = seven_stars(stretch=[1.8, 1.0], bending=bending)
    rule = hinge_coefficients if bending == "paper" else fold_coefficients
    stiffness = model.design.fabric.bending_tensor.d11
    hinges = model.parts[part]
    for release, x in ((1.0, 1.8), (0.5, 1.4), (0.0, 1.0)):
        model.set_release(release)
        rest = model.mesh.points / (x, 1.0)
        np.testing.assert_allclose(hinges.params[:, column], rule(hinges.vertices, rest, stiffness), rtol=1e-12)
    np.testing.assert_array_equal(hinges.vertices, interior_edges(model.mesh.triangles))


def test_sheet_bent_round_a_circle():
    """Large angles: a prism with undeformed faces has the energy c (2 tan(theta/2))^2 at each of its folds."""
    points, triangles = equilateral(2.0)
    edges = interior_edges(triangles)
    elements = Hinges(edges, hinge_coefficients(edges, points, HINGES.d11))
    for radius in (40.0, 20.0, 10.0):
        # a prism: rows of vertices on a circle, edges and triangles keep their size
        row = np.round(points[:, 1] / (2.0 * np.sqrt(0.75)))
        turn = 2.0 * np.arcsin(np.sqrt(0.75) / radius)
        angle = row * turn
        positions = np.column_stack([points[:, 0], radius * np.sin(angle), radius * (1.0 - np.cos(angle))])
        energies = elements.energies(positions.ravel())
        along = points[edges[:, 0], 1] == points[edges[:, 1], 1]
        np.testing.assert_allclose(energies[along], elements.params[along, 0] * (2.0 * np.tan(turn / 2.0)) ** 2)
        # slanted edges lie in the faces of the prism
        assert energies[~along].max() < 1e-20
