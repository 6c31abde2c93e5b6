"""VALIDATION V19, and every condition on the nonlinear shell against a closed form."""

import numpy as np
import pytest
from scipy.special import ellipe, ellipk

from asterism.fem.elements.argyris import Argyris, area_load
from asterism.fem.elements.deformation import affine, flat
from asterism.fem.search.relax import follow, relax
from asterism.fem.shell.density import Density, isotropic
from asterism.fem.shell.fields import Fields, of_stretch
from asterism.fem.shell.shell import Shell
from asterism.fem.supports.conditions import EdgeSupport, PointSupport, vertices_at
from tests.fem.maps import by_differences
from tests.fem.meshes import facets_where, rectangle, turned
from tests.validation.shells import at, material, stepped


@pytest.mark.parametrize("held", ["free", "sliding edges", "sliding corner points", "border held at the rest length"])
def test_homothety(held: str) -> None:
    """V19: `a_r = lambda^2 I` and no rest curvature: the sheet shrinks as a whole, without energy."""
    mesh = rectangle(3, 3, 30.0, 30.0, amount=0.2)
    left, low = facets_where(mesh, lambda x, y: x < 1e-9), facets_where(mesh, lambda x, y: y < 1e-9)
    ends = vertices_at(mesh, np.array([[0, 0], [30, 0], [0, 30]]))
    places = np.column_stack([mesh.p.T[ends], np.zeros(3)])
    rows = np.eye(3)
    conditions = {
        "free": [],
        "sliding edges": [EdgeSupport(left, directions=rows[[0, 2]]), EdgeSupport(low, directions=rows[[1, 2]])],
        "sliding corner points": [
            PointSupport(ends[[0]], places[[0]]),
            PointSupport(ends[[1]], places[[1]], rows[[1, 2]]),
            PointSupport(ends[[2]], places[[2]], rows[[2]]),
        ],
        "border held at the rest length": [EdgeSupport(mesh.boundary_facets(), flat(0.8))],
    }[held]
    shell = Shell(Argyris(mesh), of_stretch(Density(material(1.0, 0.8, 0.3)), 0.8), conditions)
    found = relax(shell)
    assert found.is_minimum
    assert found.energy < 1e-12 * shell.energy(shell.constrain(shell.flat)) + 1e-14
    corners = at(shell, found.x, (0.0, 0.0), (30.0, 0.0), (30.0, 30.0), (0.0, 30.0))
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1)
    assert np.allclose(sides, 24.0, rtol=1e-7)
    if held != "free":
        assert np.allclose(corners, 0.8 * np.array([[0, 0, 0], [30, 0, 0], [30, 30, 0], [0, 30, 0]]), atol=1e-5)


def test_border_held_short_of_its_rest_length_is_under_tension() -> None:
    """Biaxial: `E = (s^2 - lambda^2)/2 I`, the energy `(1 + nu) M E^2` per area; a square turned by 40 degrees."""
    mesh = turned(rectangle(2, 2, 20.0, 20.0, amount=0.2), 40.0, (3.0, -2.0))
    density = Density(isotropic(5.0, 0.4, 0.3))
    shell = Shell(Argyris(mesh), of_stretch(density, 0.8), [EdgeSupport(mesh.boundary_facets(), flat(0.9))])
    found = relax(shell)
    assert found.is_minimum
    assert found.energies["sheet"] == pytest.approx(400.0 * 1.3 * 5.0 * (0.5 * (0.81 - 0.64)) ** 2, rel=1e-9)
    assert np.allclose(found.x, 0.9 * shell.flat, atol=1e-7)


@pytest.mark.parametrize(("clamped", "expected"), [(False, 0.00406235), (True, 0.00126532)], ids=["pinned", "clamped"])
def test_square_plate_under_a_small_load(clamped: bool, expected: float) -> None:
    """V19: held along an oblique square, its deflection a thousandth of the thickness: `w D/(q L^4)`, nu = .3."""
    mesh = turned(rectangle(8, 8, 100.0, 100.0), 30.0, (50.0, 20.0))
    space, plate = Argyris(mesh), material(2.0, 1.0, 0.3)
    load = 1e-3 * plate[3, 3] / (expected * 100.0**4)
    rim = EdgeSupport(mesh.boundary_facets(), clamped=clamped)
    shell = Shell(space, Fields(Density(plate)), [rim], area_load(space, (0.0, 0.0, load)))
    *_, x = stepped(shell, shell.flat, [1.0])
    middle = at(shell, x, tuple(mesh.p.mean(axis=1)))[0, 2]
    assert middle * plate[3, 3] / (load * 100.0**4) == pytest.approx(expected, rel=1e-4)


def _elastica(modulus: float) -> tuple[float, float]:
    """Chord and height over length of Euler's elastica, its ends hinged; elliptic modulus k (Love, section 263)."""
    quarter = ellipk(modulus**2)
    return 2.0 * ellipe(modulus**2) / quarter - 1.0, modulus / quarter


@pytest.mark.parametrize(("ends", "modulus"), [("pinned", 0.4), ("clamped", 0.75), ("guided and pinned", 0.75)])
def test_buckled_strip(ends: str, modulus: float) -> None:
    """Oblique edges moved towards each other: Euler's elastica, of which a clamped strip holds four quarters.

    Guided: half of the pinned strip, whose middle slides up and down with its normal held.
    """
    length, angle = 20.0, 35.0
    chord, height = _elastica(modulus)
    mesh = turned(rectangle(8, 1, length, 1.0), angle, (0.0, 0.0))
    along = np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
    left, right = (facets_where(mesh, lambda x, y, e=e: abs(along @ [x, y] - e) < 1e-6) for e in (0.0, length))
    pushed = affine(np.eye(3)[:, :2], [*((chord - 1.0) * length * along), 0.0])
    clamp = ends == "clamped"
    first = EdgeSupport(left, clamped=clamp)
    if ends == "guided and pinned":
        first = EdgeSupport(left, directions=np.array([[*along, 0.0], [-along[1], along[0], 0.0]]), clamped=True)
    shell = Shell(
        Argyris(mesh), Fields(Density(material(1.0, 0.02, 0.0))), [first, EdgeSupport(right, pushed, clamped=clamp)]
    )
    share = 2.0 if ends == "guided and pinned" else 1.0
    start = _wave(shell, along, length, chord, height, ends)
    found = follow(shell, start, shell.factor())
    assert found.is_minimum
    where = 0.0 if ends == "guided and pinned" else 0.5
    top = at(shell, found.x, tuple(where * length * along + 0.5 * np.array([-along[1], along[0]])))[0]
    assert abs(top[2]) == pytest.approx(share * height * length, rel=2e-3)


def _wave(shell: Shell, along: np.ndarray, length: float, chord: float, height: float, ends: str) -> np.ndarray:
    """A state that meets the conditions, of about the right height."""

    def rise(p: np.ndarray) -> np.ndarray:
        u = p @ along / length
        if ends == "clamped":
            return 0.5 * height * length * (1.0 - np.cos(2.0 * np.pi * u))
        return height * length * (np.sin(np.pi * u) if ends == "pinned" else 2.0 * np.cos(0.5 * np.pi * u))

    def place(p: np.ndarray) -> np.ndarray:
        return np.column_stack([p - (1.0 - chord) * np.outer(p @ along, along), rise(p)])

    return shell.constrain(shell.space.interpolate(by_differences(place, 1e-3 * length).jets))


def test_heavy_cantilever() -> None:
    """Gravity on a clamped strip, `G = q L^3/EI` (VALIDATION V6)."""
    weight, width, drop = 10.0, 0.656354, 0.700200
    length, plate = 10.0, material(1.0, 0.02, 0.0)
    mesh = rectangle(8, 1, length, 1.0)
    space = Argyris(mesh)
    gravity = area_load(space, (0.0, 0.0, -weight * plate[3, 3] / length**3))
    held = EdgeSupport(facets_where(mesh, lambda x, y: x < 1e-9), clamped=True)
    shell = Shell(space, Fields(Density(plate)), [held], gravity)
    *_, x = stepped(shell, shell.flat, [0.5, 1.0])
    tip = at(shell, x, (length, 0.5))[0] / length
    assert tip[[0, 2]] == pytest.approx([width, -drop], rel=2e-3)
