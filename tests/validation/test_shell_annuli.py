"""VALIDATION V16 and V17: a slit annulus lifted at its slit, and an annulus with the metric of a sphere."""

import numpy as np
import pytest
from skfem import MeshTri

from asterism.fem.elements.argyris import Argyris
from asterism.fem.search.relax import follow, relax
from asterism.fem.search.simple_shapes import SimpleShape
from asterism.fem.shell.density import Density
from asterism.fem.shell.fields import Fields
from asterism.fem.shell.shell import Shell
from asterism.fem.supports.conditions import EdgeSupport
from tests.fem.loads import edge_load
from tests.fem.maps import by_differences
from tests.fem.meshes import annulus, facets_where, rectangle
from tests.validation.shells import at, material, of_metric, parts, rate, stepped

# --- V16

SLIT = material(21e6, 0.03, 0.0)
# Sze, Liu and Lo (2004): W at the inner and the outer corner, at a tenth, half and all of the load
TABLE = {0.1: (4.277, 5.876), 0.5: (10.468, 13.768), 1.0: (13.891, 17.528)}
SHARES = np.arange(1, 11) / 10


def _arc(p: np.ndarray) -> np.ndarray:
    return np.column_stack([p[:, 1] * np.cos(p[:, 0]), p[:, 1] * np.sin(p[:, 0]), 0.0 * p[:, 0]])


ANNULUS = by_differences(_arc, 1e-3)


def _slit_annulus(around: int, across: int, polar: bool) -> dict[float, np.ndarray]:
    """Heights of the corners A and B by share of the load, on the annulus or on the rectangle (angle, radius)."""
    mesh = rectangle(around, across, 2.0 * np.pi, 4.0)
    mesh = MeshTri(mesh.p + np.array([[0.0], [6.0]]), mesh.t)
    start, end = (facets_where(mesh, lambda t, r, e=e: abs(t - e) < 1e-9) for e in (0.0, 2.0 * np.pi))
    corners = mesh.p.T[np.unique(mesh.facets[:, end])]
    corners = corners[np.argsort(corners[:, 1])][[0, -1]]
    if polar:
        space = Argyris(mesh)
        fields = of_metric(SLIT, lambda p: np.stack([p[..., 1] ** 2, 1.0 + 0 * p[..., 0], 0 * p[..., 0]], axis=-1))
        held = EdgeSupport(start, ANNULUS, clamped=True)
    else:
        # both sides of the slit are at angle 0: look a little before it
        corners = _arc(corners - [1e-7, 0.0])[:, :2]
        mesh = MeshTri(_arc(mesh.p.T)[:, :2].T, mesh.t)
        space, fields, held = Argyris(mesh), Fields(Density(SLIT)), EdgeSupport(start, clamped=True)
    shell = Shell(space, fields, [held], edge_load(space, end, (0.0, 0.0, 0.8)), order=8)
    x = space.interpolate(ANNULUS.jets) if polar else shell.flat
    states = zip(SHARES, stepped(shell, x, SHARES), strict=True)
    return {share: at(shell, x, *corners)[:, 2] for share, x in states if share in TABLE}


@pytest.mark.parametrize("polar", [False, True], ids=["annulus", "polar"])
def test_slit_annulus(polar: bool) -> None:
    """V16: within a percent of the table; at full load a Kirchhoff-Love shell converges to 13.84 and 17.48."""
    found = _slit_annulus(32, 2, polar)
    for share, expected in TABLE.items():
        assert np.allclose(found[share], expected, rtol=0.01), share
    assert np.allclose(found[1.0], [13.84, 17.48], rtol=0.0055)


@pytest.mark.slow
def test_slit_annulus_converges_with_its_polygon() -> None:
    """Straight edges for round ones: second order towards the rectangle's answer, which has no such edges."""
    exact = _slit_annulus(32, 3, True)[1.0]
    errors = [np.abs(_slit_annulus(n, 2, False)[1.0] - exact).max() for n in (16, 32)]
    assert rate(*errors) > 1.8


# --- V17

RINGS = [0.1, 0.16, 0.25, 0.4, 0.7, 0.9, 1.0, 1.1]
# thickness: energies of stretching and of bending, rise; of a shell of revolution
BUCKLED = {
    0.01: (9.2846e-9, 3.5850e-7, 0.54117),
    0.1: (3.45096e-5, 2.48198e-4, 0.52903),
    0.3: (2.845601e-3, 1.467953e-3, 0.27080),
}


def _sphere(p: np.ndarray) -> np.ndarray:
    """The metric `dr^2 + sin^2 r dphi^2` in the plane's coordinates."""
    r = np.linalg.norm(p, axis=-1)
    (u, v), f = np.moveaxis(p / r[..., None], -1, 0), (np.sin(r) / r) ** 2
    return np.stack([u * u + f * v * v, v * v + f * u * u, (1.0 - f) * u * v], axis=-1)


def _spherical(thickness: float, sectors: int = 24, rings: list[float] = RINGS) -> Shell:
    space = Argyris(annulus(sectors, rings))
    return Shell(space, of_metric(material(1.0, thickness, 0.3), _sphere), order=8)


def _cap(shell: Shell) -> np.ndarray:
    return SimpleShape("cap", 1.0).positions(shell.space, np.zeros(2), 1.0)


def _rise(shell: Shell, x: np.ndarray) -> float:
    angles = 2.0 * np.pi * (np.arange(48) + 0.3) / 48
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    inner, outer = (at(shell, x, *(r * circle)) for r in (0.1, 1.1))
    return float(np.linalg.norm(outer.mean(axis=0) - inner.mean(axis=0)))


@pytest.mark.parametrize("thickness", BUCKLED)
def test_spherical_annulus_buckles(thickness: float) -> None:
    shell = _spherical(thickness)
    found = follow(shell, _cap(shell), shell.factor())
    assert found.is_minimum
    stretching, bending, rise = BUCKLED[thickness]
    assert parts(shell, found.x) == pytest.approx([stretching, bending], rel=0.01)
    assert _rise(shell, found.x) == pytest.approx(rise, rel=0.01)
    # no shape without stretching is cheaper to bend than this
    assert found.energy < 0.404972 * thickness**3


def test_thick_spherical_annulus_stays_flat() -> None:
    thickness = 0.4
    shell = _spherical(thickness)
    found = follow(shell, _cap(shell), shell.factor())
    assert found.is_minimum
    assert _rise(shell, found.x) < 1e-6
    assert parts(shell, found.x) == pytest.approx([1.495040e-2 * thickness, 0.0], rel=0.002, abs=1e-10)


def test_spherical_annulus_is_found_from_its_metric_alone() -> None:
    shell = _spherical(0.1)
    found = relax(shell)
    assert found.is_minimum
    assert parts(shell, found.x) == pytest.approx(BUCKLED[0.1][:2], rel=0.01)


def test_spherical_annulus_converges() -> None:
    """Second order: that of the polygons that stand for its two circles."""
    errors = []
    for sectors in (12, 24):
        shell = _spherical(0.1, sectors)
        found = follow(shell, _cap(shell), shell.factor())
        errors.append(parts(shell, found.x)[1] / BUCKLED[0.1][1] - 1.0)
    assert rate(*errors) > 1.7
