"""Supports are met exactly, plates agree with closed forms, and errors name the support."""

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse.linalg import spsolve

from asterism.equilibrium.arrays import Floats
from asterism.fem.elements.argyris import Argyris, area_load
from asterism.fem.elements.deformation import affine, flat
from asterism.fem.supports.conditions import (
    Condition,
    ConditionError,
    Contradiction,
    EdgeSupport,
    PointSupport,
    edge_curve,
    eliminate,
    impose_conditions,
    vertices_at,
)
from tests.fem.hexagons import RADIUS, hexagon
from tests.fem.maps import by_differences
from tests.fem.meshes import annulus, facets_where, rectangle, turned

STIFF = 1e7
NU = 0.3


def plate_matrix(space, poisson: float) -> sp.csr_matrix:
    """(N, N) matrix of the bending energy of unit stiffness."""
    table = space.tabulate(10)
    law = np.array([[1, poisson, 0], [poisson, 1, 0], [0, 0, 2 * (1 - poisson)]])
    blocks = np.einsum("tq,tqic,cd,tqjd->tij", table.weights, table.hessians, law, table.hessians)
    width = table.dofs.shape[1]
    rows, columns = np.repeat(table.dofs, width, axis=1), np.tile(table.dofs, width)
    return sp.csr_matrix((blocks.ravel(), (rows.ravel(), columns.ravel())), shape=(space.size,) * 2)


def deflection(space, conditions: list[Condition], load: np.ndarray, poisson: float = 0.3) -> np.ndarray:
    """(N,) deflections of a plate whose positions, all three components, meet the conditions.

    In its plane it stays as printed, but for what the conditions say: a stiff spring at every dof sees to it.
    """
    reduction = impose_conditions(space, conditions)
    out, inplane = np.diag([0.0, 0.0, 1.0]), np.diag([STIFF, STIFF, 0.0])
    matrix = sp.kron(plate_matrix(space, poisson), out) + sp.kron(sp.identity(space.size), inplane)
    forces = STIFF * space.interpolate(flat().jets)
    forces[:, 2] = load
    offset = reduction.offset()
    right = reduction.map.T @ (forces.ravel() - matrix @ offset)
    q = spsolve((reduction.map.T @ matrix @ reduction.map).tocsc(), right)
    return reduction.positions(q)[:, 2]


ORDERS = (6, 4)  # of the deflection and of the second derivatives, for polynomials of degree 5


def _bump(x: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """`sin^2(pi x)` and its derivatives of order 1, 2 and 4."""
    cosine, pi = np.cos(2.0 * np.pi * x), np.pi
    return 0.5 * (1.0 - cosine), pi * np.sin(2.0 * pi * x), 2.0 * pi**2 * cosine, -8.0 * pi**4 * cosine


def _load(points: Floats) -> Floats:
    """(n, 3) load `lap(lap w)` of the plate deflection `w = sin^2(pi x) sin^2(pi y)`."""
    (x, _, x2, x4), (y, _, y2, y4) = (_bump(points[:, i]) for i in (0, 1))
    return np.column_stack([0.0 * points, x4 * y + 2.0 * x2 * y2 + x * y4])


def _errors(space) -> list[float]:  # type: ignore[no-untyped-def]
    """Rms errors of deflection and second derivatives."""
    rim = EdgeSupport(space.mesh.boundary_facets(), clamped=True)
    heights = deflection(space, [rim], area_load(space, _load)[:, 2])
    table = space.tabulate(12)
    (x, x1, x2, _), (y, y1, y2, _) = (_bump(table.points[..., i]) for i in (0, 1))
    value = np.einsum("tqm,tm->tq", table.values, heights[table.dofs]) - x * y
    second = np.einsum("tqmc,tm->tqc", table.hessians, heights[table.dofs])
    second -= np.stack([x2 * y, x * y2, x1 * y1], axis=-1)
    squares = [value**2, second**2 @ [1.0, 1.0, 2.0]]
    return [float(np.sqrt((table.weights * square).sum())) for square in squares]


def test_clamped_plate_with_a_smooth_deflection() -> None:
    coarse = rectangle(2, 2, amount=0.2)
    errors = np.array([_errors(Argyris(coarse.refined(n))) for n in (1, 2)])
    assert (np.log2(errors[0] / errors[1]) > np.array(ORDERS) - 0.2).all()


def _ring_rise(inner: float, r: float) -> float:
    """Of a plate under q = D with a free rim r = 1, clamped along its hole: no moment and no shear at the rim.

    `w = r^4/64 + a + b r^2 + c ln r + d r^2 ln r`.
    """
    log = np.log(inner)
    rows = [
        [1.0, inner**2, log, inner**2 * log],  # w at the hole
        [0.0, 2 * inner, 1 / inner, 2 * inner * log + inner],  # its slope
        [0.0, 2 * (1 + NU), NU - 1, 3 + NU],  # w'' + nu w'/r at the rim
        [0.0, 0.0, 0.0, 4.0],  # slope of the Laplacian there
    ]
    factors = np.linalg.solve(rows, [-(inner**4) / 64, -(inner**3) / 16, -(3 + NU) / 16, -0.5])
    return float(r**4 / 64 + factors @ [1.0, r**2, np.log(r), r**2 * np.log(r)])


@pytest.mark.slow
def test_plate_clamped_along_its_hole() -> None:
    """A curved inner edge; the polygons of both circles cause an error of second order."""
    errors = []
    for sectors, rings in ((16, [0.4, 0.6, 0.8, 1.0]), (32, [0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0])):
        mesh = annulus(sectors, rings)
        space = Argyris(mesh)
        hole = facets_where(mesh, lambda x, y: np.hypot(x, y) < 0.6)
        heights = deflection(space, [EdgeSupport(hole, clamped=True)], area_load(space, (0.0, 0.0, 1.0))[:, 2], NU)
        angles = np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)
        circle = 0.9 * np.column_stack([np.cos(angles), np.sin(angles)])
        errors.append((space.locate(circle).value @ heights).mean() / _ring_rise(0.4, 0.9) - 1)
    assert np.log2(abs(errors[0] / errors[1])) > 1.7
    assert abs(errors[1]) < 0.02


@pytest.mark.parametrize("clamped", [False, True], ids=["pinned", "clamped"])
def test_rim_held_at_a_saddle(clamped: bool) -> None:
    """w = x^2 - y^2 is biharmonic: clamped at it everywhere along the rim, the plate takes it; pinned, with nu = 1."""
    saddle = by_differences(lambda p: np.column_stack([p, p[:, 0] ** 2 - p[:, 1] ** 2]), 1e-2)
    space = Argyris(turned(rectangle(3, 3, amount=0.2), 20.0, (0.0, 0.0)))
    rim = EdgeSupport(space.mesh.boundary_facets(), saddle, clamped=clamped)
    heights = deflection(space, [rim], np.zeros(space.size), NU if clamped else 1.0)
    points = turned(rectangle(5, 5), 20.0, (0.0, 0.0)).p.T
    expected = points[:, 0] ** 2 - points[:, 1] ** 2
    assert np.allclose(space.locate(points).value @ heights, expected, rtol=0, atol=2e-5)


@settings(max_examples=15)
@given(st.floats(-180, 180), st.integers(0, 10**6), st.booleans())
def test_edges_are_held_for_all_free_unknowns(degrees: float, seed: int, clamped: bool) -> None:
    """Position, and tangent plane of a clamp, at random points of oblique edges for random free unknowns."""
    rng = np.random.default_rng(seed)
    space = Argyris(turned(rectangle(2, 2, amount=0.2), degrees, (5.0, 3.0)))
    place = affine(rng.normal(size=(3, 2)), rng.normal(size=3))
    held = EdgeSupport(space.mesh.boundary_facets(), place, clamped=clamped)
    reduction = impose_conditions(space, [held])
    positions = reduction.positions(rng.normal(size=reduction.map.shape[1]))
    facets = np.repeat(held.facets, 4)
    a, b = space.mesh.p.T[space.mesh.facets[:, facets]]
    points = a + rng.uniform(0, 1, (len(facets), 1)) * (b - a)
    dofs, jets = space.jets(space.mesh.f2t[0, facets], points)
    found = np.einsum("nma,nmr->nar", jets, positions[dofs])
    assert np.allclose(found[:, 0], place.position(points), atol=1e-7)
    if clamped:
        across = np.einsum("nar,nr->na", found[:, 1:3], place.normal(points))
        assert np.allclose(across, 0.0, atol=1e-6)


def test_sliding_on_an_oblique_plane() -> None:
    space = Argyris(rectangle(2, 2))
    normal = np.array([[0.6, 0.0, 0.8]])
    edge = EdgeSupport(facets_where(space.mesh, lambda x, y: x < 1e-9), flat(), normal)
    point = PointSupport(vertices_at(space.mesh, np.array([[1.0, 1.0]])), np.array([[1.0, 1.0, 0.5]]), normal)
    reduction = impose_conditions(space, [edge, point])
    rng = np.random.default_rng(0)
    positions = reduction.positions(rng.normal(size=reduction.map.shape[1]))
    along = np.column_stack([np.zeros(9), np.linspace(0, 1, 9)])
    assert np.allclose(space.locate(along).value @ positions @ normal[0], 0.0, atol=1e-9)
    assert np.allclose(space.locate(np.array([[1.0, 1.0]])).value @ positions @ normal[0], 1.0)
    assert np.ptp(space.locate(along).value @ positions @ [0.8, 0.0, -0.6]) > 0.1
    # a quintic over two edges, in one component; and the point
    assert space.size * 3 - reduction.map.shape[1] == 10


def test_supports_move_straight_to_their_target() -> None:
    space = Argyris(rectangle(2, 2))
    rim = EdgeSupport(space.mesh.boundary_facets(), flat(0.8, (0.5, 0.5)))
    reduction = impose_conditions(space, [rim])
    corner = space.locate(np.array([[1.0, 0.0]])).value
    for progress, expected in [(0.0, [1.0, 0.0, 0.0]), (0.5, [0.95, 0.05, 0.0]), (1.0, [0.9, 0.1, 0.0])]:
        assert np.allclose(corner @ reduction.positions(np.zeros(reduction.map.shape[1]), progress), expected)
    sheet = rectangle(2, 2).p.T
    q = reduction.project(space.interpolate(flat(0.8, (0.5, 0.5)).jets))
    assert np.allclose(space.locate(sheet).value @ reduction.positions(q), flat(0.8, (0.5, 0.5)).position(sheet))


def test_redundant_equations_are_dropped_and_contradictions_are_named() -> None:
    space = Argyris(rectangle(2, 2))
    rim = EdgeSupport(space.mesh.boundary_facets(), name="rim")
    corner = vertices_at(space.mesh, np.array([[1.0, 0.0]]))
    once, twice = (
        impose_conditions(space, [rim]),
        impose_conditions(space, [rim, PointSupport(corner, np.array([[1.0, 0.0, 0.0]]))]),
    )
    assert once.map.shape == twice.map.shape
    said = r"contradicts other conditions \((corner|rim)\) at \(1, 0\) mm by"
    with pytest.raises(ConditionError, match=said) as error:
        impose_conditions(space, [rim, PointSupport(corner, np.array([[1.0, 0.0, 0.2]]), name="corner")])
    assert "\n" not in str(error.value)


GRID = Argyris(rectangle(2, 2))
EDGE = facets_where(GRID.mesh, lambda x, y: x < 1e-9)


@pytest.mark.parametrize(
    ("condition", "message"),
    [
        (
            EdgeSupport(EDGE, directions=np.array([[1.0, 1.0, 0.0]]), name="left"),
            "left: directions are not independent",
        ),
        (EdgeSupport(EDGE, directions=np.array([[np.nan, 0.0, 1.0]])), "directions must be finite"),
        (EdgeSupport(np.array([999]), name="left"), r"left: facets must be in 0 .. \d+"),
        # a target that collapses to a line or a point has no normal for a clamp
        (EdgeSupport(EDGE, affine(np.zeros((3, 2))), clamped=True), "no normal along this clamped edge"),
        (PointSupport(np.array([0]), np.zeros((2, 3))), r"points: places \(2, 3\) are not \(1, 3\)"),
        (PointSupport(np.array([0]), np.full((1, 3), np.nan)), "points: places must be finite"),
    ],
)
def test_bad_conditions_are_named(condition: Condition, message: str) -> None:
    with pytest.raises(ConditionError, match=message):
        impose_conditions(GRID, [condition])


def test_points_beside_the_vertices_are_named() -> None:
    with pytest.raises(ConditionError, match=r"point support \(0.3, 0.2\) mm: .* 0.283 mm"):
        vertices_at(GRID.mesh, np.array([[0.3, 0.2]]))
    with pytest.raises(ConditionError, match=r"point support \(nan, 0\) mm"):
        vertices_at(GRID.mesh, np.array([[np.nan, 0.0]]))


def test_an_edge_held_in_no_direction_is_free() -> None:
    space = Argyris(rectangle(2, 2))
    found = impose_conditions(space, [EdgeSupport(space.mesh.boundary_facets(), directions=np.empty((0, 3)))])
    assert len(found.free) == 3 * space.size


def test_a_shift_along_edges_stands_for_another_placement() -> None:
    """Straight sides on a parabola, given as a placement and as a shift from the printed plane."""
    space = Argyris(rectangle(3, 3))

    def shift(points, middles, tangents):
        result = np.zeros((len(points), 3, 3))
        x = points[:, 0]
        result[:, 0, 2], result[:, 1, 2], result[:, 2, 2] = x**2, 2 * x * tangents[:, 0], 2 * tangents[:, 0] ** 2
        return result

    parabola = by_differences(lambda p: np.column_stack([p, p[:, 0] ** 2]), 1e-2)
    facets = space.mesh.boundary_facets()
    placed = impose_conditions(space, [EdgeSupport(facets, parabola)])
    shifted = impose_conditions(space, [EdgeSupport(facets, shift=shift)])
    np.testing.assert_allclose(shifted.target, placed.target, atol=1e-9)
    assert np.abs(placed.target - placed.printed).max() > 0.1
    with pytest.raises(ConditionError, match="a clamped edge has no shift"):
        impose_conditions(space, [EdgeSupport(facets, clamped=True, shift=shift)])


@settings(max_examples=40)
@given(st.integers(0, 10**6), st.integers(1, 12), st.integers(0, 5))
def test_the_map_gives_all_solutions_and_only_these(seed: int, equations: int, repeated: int) -> None:
    """Sparse equations, some of them combinations of others, with coefficients of any size."""
    rng = np.random.default_rng(seed)
    matrix = np.where(rng.uniform(size=(equations, 20)) < 0.15, rng.normal(size=(equations, 20)), 0.0)
    matrix = np.vstack([matrix, rng.normal(size=(repeated, equations)) @ matrix])
    right = matrix @ rng.normal(size=(20, 2))
    size = 10.0 ** rng.uniform(-3, 3, (len(matrix), 1))
    found = eliminate(sp.csr_matrix(size * matrix), size * right, 1e-8)
    x = (found.map @ rng.normal(size=len(found.free)))[:, None] + found.constant
    assert np.allclose(matrix @ x, right, atol=1e-7 * max(np.abs(x).max(), 1.0))
    rank = np.linalg.matrix_rank(matrix, tol=1e-9)
    assert len(found.free) == 20 - rank
    assert np.array_equal(found.map[found.free].toarray(), np.eye(len(found.free)))


@pytest.mark.parametrize(
    ("rows", "right", "row", "miss"),
    [
        ([[1.0, 0.0], [1.0, 0.0]], [0.0, 0.5], (0, 1), 0.25),
        ([[1.0, 1.0], [2.0, 2.0], [0.0, 0.0]], [1.0, 2.0, 3.0], (2,), 3.0),
    ],
)
def test_contradictions_are_named(rows, right, row: tuple[int, ...], miss: float) -> None:
    with pytest.raises(Contradiction, match="is off by") as error:
        eliminate(sp.csr_matrix(np.array(rows)), np.array(right)[:, None], 1e-8)
    assert error.value.row in row
    assert error.value.miss == pytest.approx(miss)


def test_resultants_and_moments() -> None:
    """The work of a load on every affine motion: its resultant and its moments."""
    space = Argyris(rectangle(3, 2, 3.0, 2.0, amount=0.2))

    def work(loads: np.ndarray, matrix: object, offset: tuple[float, ...] = (0.0, 0.0, 0.0)) -> float:
        return float(np.sum(loads * space.interpolate(affine(matrix, offset).jets)))

    weight = area_load(space, (0.0, 0.0, -0.5))
    assert work(weight, np.zeros((3, 2)), (1.0, 2.0, 3.0)) == pytest.approx(-0.5 * 6 * 3)
    assert work(weight, [[0.0, 0], [0, 0], [0.7, -0.2]]) == pytest.approx(-0.5 * 6 * (0.7 * 1.5 - 0.2 * 1.0))
    linear = area_load(space, lambda p: np.column_stack([p[:, 0], 0 * p[:, 0], 0 * p[:, 0]]))
    assert work(linear, [[1.0, 0], [0, 0], [0, 0]]) == pytest.approx(9.0 * 2)


def test_both_circles_of_an_annulus() -> None:
    """Tangents and curvatures are exact, on the hole's rim too."""
    mesh = annulus(16, [1.0, 1.5, 2.0])
    curve = edge_curve(mesh, mesh.boundary_facets(), 30.0)
    radius = np.linalg.norm(curve.ends, axis=2)
    assert np.allclose(np.abs(curve.curvatures), 1.0 / radius)
    assert np.allclose(np.sum(curve.tangents * curve.ends, axis=2), 0.0, atol=1e-12)
    left = np.stack([-curve.tangents[..., 1], curve.tangents[..., 0]], axis=-1)
    # gamma'' = k nu points to the centre
    assert np.all(curve.curvatures * np.sum(left * curve.ends, axis=2) < 0.0)


@pytest.mark.parametrize(("corner_deg", "bent"), [(50.0, False), (70.0, True)])
def test_the_corner_angle_decides(corner_deg: float, bent: bool) -> None:
    """The corners of a hexagon turn by 60 degrees."""
    mesh = hexagon(0)
    curve = edge_curve(mesh, mesh.boundary_facets(), corner_deg)
    assert np.allclose(np.abs(curve.curvatures), 1.0 / RADIUS if bent else 0.0)


def test_an_inner_curve_ends_with_its_supported_edges() -> None:
    """An arc of inner edges: its ends have the circle through the nearest three vertices."""
    mesh = annulus(24, [1.0, 1.5, 2.0])
    radius = np.linalg.norm(mesh.p[:, mesh.facets], axis=0)
    ring = np.flatnonzero(np.ptp(radius, axis=0) < 1e-9)
    middle = mesh.p[:, mesh.facets[:, ring]].mean(axis=1)
    arc = ring[(np.abs(np.linalg.norm(middle, axis=0) - 1.5) < 0.05) & (middle[0] > 0.2)]
    curve = edge_curve(mesh, arc, 30.0)
    assert len(arc) > 5
    assert np.allclose(np.abs(curve.curvatures), 1.0 / np.linalg.norm(curve.ends, axis=2))
