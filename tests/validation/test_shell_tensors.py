"""Fields and stiffnesses that are no multiples of the identity, against closed forms."""

import numpy as np
import pytest
from scipy.linalg import sqrtm
from scipy.optimize import minimize

from asterism.equilibrium.arrays import Floats
from asterism.fem.elements.argyris import Argyris
from asterism.fem.elements.deformation import affine
from asterism.fem.search.relax import relax
from asterism.fem.shell.density import Density
from asterism.fem.shell.fields import Fields
from asterism.fem.shell.shell import Shell
from asterism.fem.supports.conditions import EdgeSupport
from tests.fem.loads import edge_load
from tests.fem.meshes import facets_where, rectangle
from tests.validation.shells import at, material, stepped

METRIC = np.array([[0.8, 0.15], [0.15, 0.6]])


def _some_stiffness(points: Floats) -> Density:
    """Membrane, bending and their coupling, no two entries alike, stiffer to the right."""
    root = np.eye(6) + 0.3 * np.random.default_rng(3).standard_normal((6, 6))
    root[3:] *= 0.1
    return Density((1.0 + 0.1 * points[..., 0])[..., None, None] * (root @ root.T))


@pytest.mark.parametrize("curvature", [0.0, 0.25], ids=["flat", "rolled"])
def test_fields_that_fit_each_other_cost_nothing(curvature: float) -> None:
    """A metric A and `b = k v v` about an oblique axis are a plane, sheared, then a cylinder: whatever the stiffness.

    With `Y = sqrt(A) X` flat, the cylinder has the curvature `k |u|^2` along `u = sqrt(A)^-1 v`: chords follow.
    """
    v = np.array([np.cos(0.4), np.sin(0.4)])
    bend = curvature * np.array([v[0] ** 2, v[1] ** 2, v[0] * v[1]])
    mesh = rectangle(4, 4, 6.0, 4.0, amount=0.15)
    shell = Shell(Argyris(mesh), Fields(_some_stiffness, (METRIC[0, 0], METRIC[1, 1], METRIC[0, 1]), bend))
    found = relax(shell)
    assert found.is_minimum
    root = np.real(sqrtm(METRIC))
    u = np.linalg.solve(root, v)
    along = u / np.linalg.norm(u)
    k = curvature * (u @ u)
    printed = np.array([[0.0, 0.0], [6.0, 0.0], [6.0, 4.0], [0.0, 4.0], [2.5, 1.5]])
    steps = (printed[1:] - printed[0]) @ root
    around, across = steps @ along, steps @ [-along[1], along[0]]
    chords = np.hypot(np.sinc(0.5 * k * around / np.pi) * around, across)
    places = at(shell, found.x, *map(tuple, printed))
    accuracy = 1e-4 if curvature else 1e-7
    assert np.linalg.norm(places[1:] - places[0], axis=1) == pytest.approx(chords, rel=accuracy)


def _stiffening(e: Floats) -> tuple[Floats, Floats, Floats]:
    """`|E|^4` of the membrane strains."""
    part = np.concatenate([np.ones(3), np.zeros(3)]) * e
    square = (part**2).sum(axis=1)[:, None, None]
    gradient = 4.0 * square[:, 0] * part
    eye = np.diag([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    return square[:, 0, 0] ** 2, gradient, 4.0 * square * eye + 8.0 * part[:, :, None] * part[:, None]


@pytest.mark.parametrize("term", [None, _stiffening], ids=["linear", "stiffening"])
def test_an_anisotropic_sheet_pulled_at_two_sides(term) -> None:
    """Free but for dead loads on two sides: `x = F X` of least `W(F) - P F_11`, narrowed and sheared."""
    mesh, pull = rectangle(2, 2, 3.0, 2.0, amount=0.2), 0.8
    stiffness = np.zeros((6, 6))
    stiffness[:3, :3] = [[5.0, 1.2, 0.9], [1.2, 3.0, -0.4], [0.9, -0.4, 1.5]]
    stiffness[3:, 3:] = material(1.0, 1.0, 0.3)[3:, 3:]
    density, space = Density(stiffness, term=term), Argyris(mesh)
    left, right = (facets_where(mesh, lambda x, y, e=e: abs(x - e) < 1e-9) for e in (0.0, 3.0))
    loads = edge_load(space, right, (pull, 0.0, 0.0)) + edge_load(space, left, (-pull, 0.0, 0.0))
    shell = Shell(space, Fields(density), loads=loads)
    *_, x = stepped(shell, shell.flat, [1.0])

    def cost(entries: Floats) -> float:
        f = entries.reshape(2, 2)
        metric = f.T @ f
        strain = np.array([0.5 * (metric[0, 0] - 1.0), 0.5 * (metric[1, 1] - 1.0), metric[0, 1], 0.0, 0.0, 0.0])
        return float(density(strain[None, None])[0][0, 0]) - pull * f[0, 0]

    best = minimize(cost, np.eye(2).ravel(), method="BFGS", options={"gtol": 1e-9}).x.reshape(2, 2)
    assert best[1, 1] < 0.97 and abs(best[0, 1]) > 0.05
    assert shell.energy(x) == pytest.approx(6.0 * cost(best.ravel()), rel=1e-9)
    corners = at(shell, x, (0.0, 0.0), (3.0, 0.0), (3.0, 2.0), (0.0, 2.0))
    sides = np.array([[3.0, 0.0], [0.0, 2.0]]) @ best.T
    assert (corners - corners[0])[[1, 3], 0] == pytest.approx(sides[:, 0], abs=1e-6)
    assert np.linalg.norm((corners - corners[0])[[1, 3], 1:], axis=1) == pytest.approx(np.abs(sides[:, 1]), abs=1e-6)


def test_a_coupled_sheet_lifts_when_it_is_pulled() -> None:
    """Pinned at both ends and stretched by e: `D w'' + C e = 0` there, `D w'''' = N w''` between, `N = A e`.

    So the middle rises by `C/A (1 - 1/cosh(l L/2))` with `l^2 = N/D`, for a small coupling C.
    """
    length, stretch, coupling = 10.0, 1.001, 1e-4
    stiffness = material(1.0, 0.1, 0.0)
    stiffness[0, 3] = stiffness[3, 0] = coupling
    mesh = rectangle(8, 1, length, 1.0)
    left, right = (facets_where(mesh, lambda x, y, e=e: abs(x - e) < 1e-9) for e in (0.0, length))
    pull = affine([[stretch, 0.0], [0.0, 1.0], [0.0, 0.0]])
    shell = Shell(Argyris(mesh), Fields(Density(stiffness)), [EdgeSupport(left, pull), EdgeSupport(right, pull)])
    *_, x = stepped(shell, shell.constrain(shell.flat), [1.0])
    force = stiffness[0, 0] * 0.5 * (stretch**2 - 1.0)
    rise = coupling / stiffness[0, 0] * (1.0 - 1.0 / np.cosh(0.5 * length * np.sqrt(force / stiffness[3, 3])))
    assert at(shell, x, (0.5 * length, 0.5))[0, 2] == pytest.approx(rise, rel=5e-3)
