"""Around a held point the shell gives way as the exact model's fabric does.

A wedge of bare fabric is held along its arc, where it is as long as it wants to be, and its tip is pulled out a little.
c, d, d - c and g are those of `asterism/previews/point_pins.py`, with its K.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import spsolve
from skfem import MeshTri

from asterism.discrete.energies.membrane import Membrane
from asterism.exact.simulation import exact_shape
from asterism.fem.elements.argyris import Argyris
from asterism.fem.shell.density import Density, isotropic
from asterism.fem.shell.fields import Fields
from asterism.fem.shell.hyperelastic import MIN_DET_C
from asterism.fem.shell.shell import QUADRATURE_ORDER, Shell
from asterism.fem.supports.conditions import vertices_at
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.design.materials import Fabric
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.pattern.mesh.meshing import mesh_layout
from asterism.pattern.mesh.sheet_mesh import sheet_mesh
from asterism.previews.point_pins import ANGLES_DEG, GAIN, LACK, amounts_of, around, softened, spot, stretched_fabric
from asterism.previews.print_sheet import conditions
from asterism.previews.session import Preview
from asterism.shape.comparison import compare_shapes

RADIUS, STRETCH = 60.0, 1.35
EXACT_MM, TURNED_DEG, SHELL_MM = (2.0, 1.6, 1.2), (0.0, 11.0, 30.0, 90.0), (20.0, 30.0)
FABRIC = Design.from_dict({"stars": {"length_mm": 1.0, "thickness_mm": 0.3}, "border": {"rings": 1}}).fabric


def measured(angle: float) -> tuple[float, float]:
    """d - c and g for one angle in degrees, means over several meshes."""
    meshes = [(edge, turned) for edge in EXACT_MM for turned in TURNED_DEG]
    c = np.mean([ease(exact_stiffness(angle, *mesh), angle) - np.log(RADIUS / mesh[0]) for mesh in meshes])
    d, gain = [], []
    for size in SHELL_MM:
        (hard, edge), (soft, _) = (shell_stiffness(angle, size, amount) for amount in (0.0, 1.0))
        d.append(ease(hard, angle) - np.log(RADIUS / edge))
        gain.append(ease(soft, angle) - ease(hard, angle))
    return float(np.mean(d) - c), float(np.mean(gain))


def ease(stiffness: float, angle: float) -> float:
    """`u K / F`, from F / u in N/mm."""
    a = np.radians(angle)
    return float(FABRIC.modulus_mpa * FABRIC.thickness_mm * 0.5 * (a + np.sin(a)) / stiffness)


def wedge(angle: float, edge_mm: float, turned: float = 0.0) -> Design:
    """A sheet that is held along its arc and at the origin; its stars are there only because a sheet has some.

    It opens along x, or along a direction turned from there, in degrees.
    """
    count = max(3, round(angle / 6.0))
    turn = np.radians(turned + angle * (np.arange(count + 1) / count - 0.5))
    border = np.concatenate([np.zeros((1, 2)), RADIUS * np.column_stack([np.cos(turn), np.sin(turn)])])
    length = {"profile": "radial", "from": 0.0, "to": 1.2, "over_mm": 0.5 * RADIUS}
    return Design.from_dict(
        {
            "stars": {"length_mm": length, "thickness_mm": 0.3},
            "border": {"polygon_mm": border.tolist()},
            "mesh": {"edge_mm": edge_mm},
            # the first side leads from the tip to the arc
            "pins": [{"edges": list(range(1, count + 1))}, {"points_mm": [[0.0, 0.0]]}],
        }
    )


def exact_stiffness(angle: float, edge_mm: float, turned: float) -> float:
    """N/mm, of constant strain triangles."""
    design = wedge(angle, edge_mm, turned)
    mesh = mesh_layout(layout(design), edge_mm, design.mesh.kind, design.mesh.seed)
    rest = mesh.points / STRETCH
    fabric = Membrane(mesh.triangles, rest, FABRIC)
    flat = np.column_stack([rest, np.zeros(len(rest))]).ravel()
    both = np.zeros((len(fabric), 9, 9))
    i, j = np.tril_indices(9)
    both[:, i, j] = both[:, j, i] = fabric.hessians(flat)
    rows, columns = np.broadcast_arrays(fabric.dofs[:, :, None], fabric.dofs[:, None])
    whole = sp.csc_matrix((both.ravel(), (rows.ravel(), columns.ravel())), shape=(flat.size, flat.size))
    (arc, (point,)), free = mesh.pin_vertices, np.ones((len(rest), 3), dtype=bool)
    free[arc] = free[:, 2] = False
    inner = np.flatnonzero(free)
    x, y = np.cos(np.radians(turned)), np.sin(np.radians(turned))
    pull = x * (inner == 3 * point) + y * (inner == 3 * point + 1)
    return float(1.0 / (pull @ spsolve(whole[inner][:, inner], pull)))


def shell_stiffness(angle: float, edge_mm: float, amount: float) -> tuple[float, float]:
    """N/mm, of a shell with a softness at the point; and the mean edge there, mm."""
    plan, point = layout(wedge(angle, EXACT_MM[0])), np.zeros((1, 2))
    mesh = sheet_mesh(plan.outline, edge_mm, point, plan.supported_edge_groups)
    edge = float(around(mesh, point)[0][0])
    space = Argyris(MeshTri(np.ascontiguousarray(mesh.points.T), np.ascontiguousarray(mesh.triangles.T)))
    at = space.tabulate(QUADRATURE_ORDER).points
    plain = isotropic(FABRIC.modulus_mpa * FABRIC.thickness_mm / (1.0 - FABRIC.poisson**2), 1.0, FABRIC.poisson)
    whole = Fields(Density(np.broadcast_to(plain, (*at.shape[:2], 6, 6))))
    arc = conditions(replace(plan, pins=plan.pins[:1]), mesh, space.mesh, 0)
    shell = Shell(space, softened(whole, amount * spot(point[0], edge, at)), arc)
    factor = shell.factor()
    assert factor.factorise(shell.flat_stiffness)
    tip = int(space.vertex_dofs[vertices_at(space.mesh, point)[0], 0])
    pull = (shell.reduction.free == 3 * tip).astype(float)
    return float(1.0 / (pull @ factor.solve(pull))), edge


def pinned(edge_mm: float = 2.0, **pins: object) -> Design:
    """A rectangle of 15 stars."""
    data = {
        "stars": {"length_mm": 9.0, "thickness_mm": 0.4},
        "border": {"rectangle_mm": [80.0, 80.0]},
        "mesh": {"edge_mm": edge_mm},
        "pins": [{"where": "corners", "scale": 0.85} | pins] if "edges" not in pins else [pins],
    }
    return Design.from_dict(data)


@pytest.mark.slow
def test_the_numbers_are_those_of_the_model() -> None:
    at = ANGLES_DEG.index(120.0)
    lack, gain = measured(120.0)
    assert lack == pytest.approx(LACK[at], abs=0.01)
    assert gain == pytest.approx(GAIN[at], abs=0.01)


def test_a_finer_exact_mesh_gives_way_more() -> None:
    edges, angles = np.full(3, 20.0), np.array([90.0, 120.0, 200.0])
    fine, coarse, stiffer = (amounts_of(edges, angles, edge) for edge in (0.5, 1.0, 20.0))
    assert (fine > coarse).all() and (coarse > 0.0).all() and (stiffer < 0.0).all()
    assert (stiffer > -1.0).all()


def test_softer_sheets_stretch_more_easily_and_bend_as_before() -> None:
    whole = isotropic(np.full(4, 5.0), np.full(4, 2.0), np.full(4, 0.4), 0.05)
    part = np.array([1.0, 0.7, 0.2, 0.01])
    soft = softened(Fields(Density(whole)), 1.0 / part - 1.0).density.stiffness  # type: ignore[union-attr]
    assert soft[:, :3, :3] == pytest.approx(part[:, None, None] * whole[:, :3, :3])
    assert soft[:, 3:] == pytest.approx(whole[:, 3:])


@pytest.mark.slow
def test_heights_depend_on_the_exact_models_mesh_and_not_on_the_shells_triangles() -> None:
    heights = {
        (edge, count): float(np.ptp(Preview(pinned(edge), triangles=count).shape().positions[:, 2]))
        for edge in (1.2, 2.0)
        for count in (None, 150)
    }
    for edge in (1.2, 2.0):
        assert heights[edge, None] == pytest.approx(heights[edge, 150], rel=0.04)
    assert heights[1.2, None] > 1.05 * heights[2.0, None]


@pytest.mark.slow
def test_a_sheet_on_its_corners_is_near_the_exact_one() -> None:
    design = Design.from_dict({**pinned().to_dict(), "mesh": {}})
    plan, shown = layout(design), Preview(design).shape()
    exact = exact_shape(design, near=shown)
    comparison = compare_shapes(exact, shown, plan, symmetries(design, plan))
    assert abs(comparison.record.mean_height_error_percent) < 12.0
    assert comparison.rms_percent < 0.3


def test_only_points_that_are_held_along_the_print_count() -> None:
    assert len(layout(pinned()).in_plane_pin_points) == 4
    assert len(layout(pinned(slide="z")).in_plane_pin_points) == 4
    assert len(layout(pinned(slide="plane")).in_plane_pin_points) == 0
    assert len(layout(pinned(edges=[0, 1], scale=0.85)).in_plane_pin_points) == 0


def test_a_sheet_without_them_has_the_fields_of_its_law() -> None:
    for name in ("dome", "tube"):
        assert Preview(gallery.load(name)).shell.density.term is None
    assert Preview(pinned()).shell.density.term is not None


THICKNESS, MODULUS, POISSON, LAM = 0.8, 7.0, 0.3, 0.74
# per printed area and strain in printed coordinates
STIFFNESS = isotropic(THICKNESS * MODULUS / (1.0 - POISSON**2) / LAM**2, 0.5, POISSON)
FIELDS = Fields(Density(STIFFNESS), (LAM**2, LAM**2, 0.0))


def density(bare: float = 1.0, count: int = 1) -> Density:
    stiffness = np.broadcast_to(STIFFNESS, (1, count, 6, 6))
    fields = Fields(FIELDS.density, np.broadcast_to([LAM**2, LAM**2, 0.0], (1, count, 3)))
    return Density(stiffness, term=stretched_fabric(fields, stiffness, np.full((1, count), bare)))


@pytest.mark.parametrize("stretch", [(0.6, 0.7), (0.74, 0.74), (1.0, 0.6), (3.0, 0.5), (2.0, 2.0)])
def test_the_energy_is_that_of_the_exact_models_triangles(stretch: tuple[float, float]) -> None:
    turn = np.radians(25.0)
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    shape = rotation @ np.diag(stretch) @ rotation.T
    printed = np.array([[0.0, 0.0], [1.0, 0.0], [0.3, 0.8]])
    triangle = Membrane(np.array([[0, 1, 2]]), LAM * printed, Fabric(thickness_mm=THICKNESS, modulus_mpa=MODULUS))
    flat = np.column_stack([printed @ shape.T, np.zeros(3)])
    exact = float(triangle.energies(flat.ravel())[0]) / 0.4  # its printed area
    metric = shape.T @ shape - LAM**2 * np.eye(2)
    strain = np.array([0.5 * metric[0, 0], 0.5 * metric[1, 1], metric[0, 1], 0.0, 0.0, 0.0])
    assert density()(strain[None, None])[0][0, 0] == pytest.approx(exact, rel=1e-9, abs=1e-12)


@pytest.mark.slow
def test_small_strains_are_the_laws() -> None:
    e = 1e-4 * np.random.default_rng(0).normal(size=(1, 20, 6))
    plain = Density(STIFFNESS)
    assert density(count=20)(e)[0] == pytest.approx(plain(e)[0], rel=2e-3)
    assert density(count=20)(e)[2] == pytest.approx(plain(e)[2], rel=5e-3, abs=1e-2)
    assert density(0.0, 20)(1e3 * e)[0] == pytest.approx(plain(1e3 * e)[0], rel=1e-12)


def test_stresses_and_stiffnesses_are_derivatives_also_where_no_surface_is() -> None:
    e = 0.15 * np.random.default_rng(3).normal(size=(1, 60, 6))
    law, step = density(0.6, e.shape[1]), 1e-5
    det = (1.0 + 2.0 * e[..., 0] / LAM**2) * (1.0 + 2.0 * e[..., 1] / LAM**2) - (e[..., 2] / LAM**2) ** 2
    assert (det < MIN_DET_C).any() and (det > MIN_DET_C).any()
    _, stress, stiffness = law(e)
    for k in range(6):
        by = np.zeros(6)
        by[k] = step
        up, down = law(e + by), law(e - by)
        assert (up[0] - down[0]) / (2.0 * step) == pytest.approx(stress[..., k], rel=1e-5, abs=1e-5)
        assert (up[1] - down[1]) / (2.0 * step) == pytest.approx(stiffness[..., k], rel=1e-4, abs=1e-4)
