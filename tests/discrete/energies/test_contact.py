"""Contact: derivatives of the whole energy, a fold that stays open, a sheet that rolls up by more than a full turn."""

from __future__ import annotations

import sys
from typing import TypeVar

import numpy as np
import pytest

from asterism.discrete.energies.contact import ContactBarrier, ipc_toolkit
from asterism.discrete.model.contact_model import ContactModel, ExtendedPattern
from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State, moved_state
from asterism.discrete.model.system import System
from asterism.discrete.release.continuation import solve_on_mesh
from asterism.discrete.release.levels import Ladder, SharedSearch, solve_on_meshes
from asterism.equilibrium.arrays import Array
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.build import layout
from asterism.pattern.mesh.meshing import mesh_layout
from asterism.shape.surface import self_intersections

ipctk = pytest.importorskip("ipctk")


def design(rings: int = 1, thickness: float = 0.2, edge: float = 4.3, **more: object) -> Design:
    data = {
        "stars": {"length_mm": 10.0, "thickness_mm": thickness},
        "border": {"rings": rings},
        "mesh": {"edge_mm": edge},
        "fabric": {"bending": "paper"},
    }
    return Design.from_dict(data | more)


Kind = TypeVar("Kind", bound=DiscreteModel)


def model(kind: type[Kind], *args: object, **more: object) -> Kind:
    plan = design(*args, **more)  # type: ignore[arg-type]
    printed = layout(plan)
    return kind(plan, printed, mesh_layout(printed, plan.mesh.edge_mm, plan.mesh.kind, plan.mesh.seed))


def contact_search(sheet: DiscreteModel) -> SharedSearch:
    """All meshes of a sheet that does not pass through itself."""
    design = Design.from_dict(sheet.design.to_dict() | {"solver": {"contact": True}})
    return SharedSearch(Ladder(design, sheet.layout))


def folded(sheet: DiscreteModel, gap: float, noise: float = 0.01) -> State:
    """The released sheet folded along x = 0 over a half circle of diameter `gap`, with noise."""
    x, y = sheet.mesh.points.T / sheet.design.fabric.stretch_xy[0]
    radius = 0.5 * gap
    half = 0.5 * np.pi * radius
    angle = np.clip(x, -half, half) / radius
    straight = x - np.clip(x, -half, half)
    positions = np.column_stack([radius * np.cos(angle) - np.abs(straight), y, radius * np.sin(angle)])
    positions += noise * np.random.default_rng(1).normal(size=positions.shape)
    flat = sheet.flat_state()
    return moved_state(flat, sheet.edges, positions, np.zeros(len(sheet.edges)))


def folded_model(**more: object) -> tuple[ContactModel, State]:
    sheet = model(ContactModel, edge=3.0, **more)
    state = folded(sheet, 0.7)
    pairs, least = sheet.contact.pairs_and_gap(state.positions)
    assert pairs > 100 and 0.4 < least < 0.8
    return sheet, state


def dense(sheet: ContactModel, state: State, blend: float) -> Array:
    data = sheet.hessian(state, blend)  # sets the pattern
    return sheet.pattern.full(data).toarray()


@pytest.mark.parametrize("pins", [[], [{"where": "corners"}]], ids=["free", "pinned"])
def test_derivatives_of_the_whole_energy(pins: list[object]) -> None:
    """Central differences along random directions, rods and twists included."""
    sheet, state = folded_model(pins=pins)
    gradient, hessian = sheet.gradient(state), dense(sheet, state, 0.0)
    assert isinstance(sheet.pattern, ExtendedPattern)
    rng = np.random.default_rng(0)
    for _ in range(3):
        direction = rng.normal(size=len(sheet.free))
        move, turn, _ = sheet.motions(direction)

        def at(a: float, move: Array = move, turn: Array = turn) -> State:
            return moved_state(state, sheet.edges, state.positions + a * move, a * turn)

        # a short step, since the Hessian jumps when the nearest point moves from the edge of a triangle into it
        step = 1e-6
        ahead, behind = at(step), at(-step)
        slope = (sheet.contact.energy(ahead.positions) - sheet.contact.energy(behind.positions)) / (2 * step)
        assert slope == pytest.approx(sheet.contact.gradient(state.positions) @ move.ravel(), rel=1e-5)
        whole = (sheet.energy(ahead) - sheet.energy(behind)) / (2 * step)
        assert whole == pytest.approx(gradient @ direction, rel=1e-5, abs=1e-5 * np.linalg.norm(gradient))
        change = (sheet.full_gradient(ahead) - sheet.full_gradient(behind))[sheet.free] / (2 * step)
        np.testing.assert_allclose(hessian @ direction @ direction, change @ direction, rtol=1e-5)


def test_full_blend_is_positive_semidefinite() -> None:
    sheet, state = folded_model()
    size = 3 * sheet.n_vertices
    parts = []
    for blend in (0.0, 0.25, 1.0):
        rows, columns, values = sheet.contact.hessian(state.positions, blend)
        full = np.zeros((size, size))
        full[rows, columns] = values
        parts.append(full)
    exact, quarter, convex = parts
    np.testing.assert_allclose(quarter, 0.75 * exact + 0.25 * convex, atol=1e-9 * np.abs(exact).max())
    assert np.linalg.eigvalsh(convex)[0] > -1e-9 * np.abs(convex).max()
    assert np.linalg.eigvalsh(exact)[0] < -1e-6 * np.abs(exact).max()


def test_one_pattern_holds_all_hessians_of_a_state() -> None:
    """Parallel layers have zero entries, different ones in the projected and in the exact Hessian."""
    sheet = model(ContactModel, edge=4.0, thickness=0.3)
    state = folded(sheet, 0.6, noise=0.0)
    assert sheet.contact.pairs_and_gap(state.positions)[0] > 100
    exact, half, convex = (sheet.hessian(state, blend) for blend in (0.0, 0.5, 1.0))
    np.testing.assert_allclose(half, 0.5 * (exact + convex), rtol=1e-9, atol=1e-9 * np.abs(exact).max())


def test_without_contact_nothing_changes() -> None:
    sheet, plain = model(ContactModel), model(DiscreteModel)
    state = plain.flat_state()
    assert sheet.energies(state) == plain.energies(state) | {"contact": 0.0}
    np.testing.assert_array_equal(sheet.gradient(state), plain.gradient(state))
    np.testing.assert_array_equal(sheet.hessian(state, 0.0), plain.hessian(state, 0.0))


def test_paths_are_free_of_intersections() -> None:
    """The direction moves each half of the fold 20 mm through the other; no state of the path intersects itself."""
    sheet, state = folded_model()
    move = np.zeros_like(state.positions)
    move[:, 2] = -20.0 * np.sign(state.positions[:, 2])
    direction = np.concatenate([move.ravel(), np.zeros(len(sheet.edges))])[sheet.free]
    plain, _ = System.path(sheet, state, direction)
    assert sheet.contact.collision_free_fraction(state.positions, plain(1.0).positions) < 0.1
    path, longest = sheet.path(state, direction)
    for a in (longest, 0.3 * longest, 0.01 * longest):
        assert sheet.reachable_state(state, path(a)) is path(a)
        assert sheet.contact.is_intersection_free(path(a).positions)


def test_rigid_motions_cause_no_contact() -> None:
    sheet, state = folded_model()
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    there = State(state.positions @ turn.T + 100.0, state.directors @ turn.T)
    assert sheet.reachable_state(state, there) is there


def test_barrier_of_two_flaps() -> None:
    """Two square flaps of one mesh, pressed together from above: between half a thickness and a thickness apart."""
    side = np.linspace(0.0, 10.0, 6)
    square = np.array([(x, y) for y in side for x in side])
    cells = np.array([i + 6 * j for j in range(5) for i in range(5)])
    one = np.concatenate([cells[:, None] + [0, 1, 7], cells[:, None] + [0, 7, 6]])

    class Flaps:
        points = np.concatenate([square, square + np.array([30.0, 0.0])])
        triangles = np.concatenate([one, one + 36])

    contact = ContactBarrier(Flaps, 0.8, 1.35, 7.0)  # type: ignore[arg-type]
    lower = np.column_stack([square, np.zeros(36)])

    def over(gap: float) -> Array:
        return np.concatenate([lower, lower + np.array([1.3, 0.7, gap])])

    gaps, energies, forces = np.array([0.85, 0.79, 0.7, 0.6, 0.5, 0.42]), [], []
    for gap in gaps:
        positions = over(gap)
        energies.append(contact.energy(positions))
        forces.append(contact.gradient(positions)[3 * 36 + 2 :: 3].sum())
    assert energies[0] == 0.0 and forces[0] == 0.0
    assert (np.diff(energies) > 0.0).all() and (np.diff(forces) < 0.0).all()
    assert np.isinf(contact.energy(over(0.39)))
    above, below = over(2.0), over(-2.0)
    assert contact.is_intersection_free(above) and contact.is_intersection_free(below)
    # 1.6 of 4 mm are free, and the search stops before the last tenth
    assert contact.collision_free_fraction(above, below) == pytest.approx(0.36, abs=0.02)


def _along_axes(positions: Array) -> Array:
    """(V, 3) mm, in the principal axes of the sheet."""
    centred = positions - positions.mean(axis=0)
    return np.asarray(centred @ np.linalg.svd(centred, full_matrices=False)[2].T)


@pytest.mark.slow
def test_sheet_that_rolls_up_by_more_than_a_full_turn() -> None:
    """19 stars with thin arms: without contact the sheet intersects itself, with contact it is a minimum without."""
    plain = solve_on_mesh(model(DiscreteModel, 2))
    sheet = model(ContactModel, 2)
    found = solve_on_mesh(sheet)
    triangles = sheet.mesh.triangles
    assert plain.is_minimum and self_intersections(plain.state.positions, triangles) > 100
    assert found.is_minimum and self_intersections(found.state.positions, triangles) == 0
    pairs, least = sheet.contact.pairs_and_gap(found.state.positions)
    assert pairs > 0 and sheet.contact.min_distance < least < sheet.contact.distance
    assert found.energy > plain.energy
    through, apart = (np.ptp(_along_axes(each.state.positions), axis=0) for each in (plain, found))
    assert apart[0] == pytest.approx(through[0], rel=0.03)  # along the axis of the roll, which is thicker
    assert apart[1:].max() > through[1:].max() + 1.0
    # the certificate is that of the whole Hessian
    modes = sheet.rigid_modes(found.state)
    full = dense(sheet, found.state, 0.0)
    values = np.linalg.eigvalsh(full + 1e3 * modes @ modes.T)
    assert found.smallest_eigenvalue == pytest.approx(values[0], abs=2 * found.eigenvalue_error + 1e-8)


@pytest.mark.slow
def test_finer_meshes_have_no_intersections() -> None:
    sheet = model(ContactModel, 2, edge=1.5)
    found, levels = solve_on_meshes(contact_search(sheet))
    assert len(levels) == 3 and found.is_minimum
    assert self_intersections(found.state.positions, sheet.mesh.triangles) == 0


def test_pins_that_push_the_sheet_through_itself_are_refused() -> None:
    sheet, state = folded_model(pins=[{"where": "corners"}])
    held = sheet.constraints.held[:, 2]
    moved = np.array(state.positions)
    moved[held, 2] = np.where(state.positions[held, 2] > 0.0, 30.0, -30.0)
    there = moved_state(state, sheet.edges, moved, np.zeros(len(sheet.edges)))
    with pytest.raises(DesignError, match="pins"):
        _ = sheet.apply_supports(there)


def test_a_missing_package_gives_a_one_line_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "ipctk", None)
    with pytest.raises(DesignError, match=r"^solver\.contact: needs the package ipctk: pip install ipctk$"):
        ipc_toolkit()


def test_intersections_agree_with_the_toolkit() -> None:
    """Random triangles: as many pairs as those with an edge of one through the other, by the toolkit."""
    rng = np.random.default_rng(2)
    triangles = np.arange(90).reshape(30, 3)
    positions = np.repeat(rng.uniform(0, 4, (30, 3)), 3, axis=0) + rng.normal(size=(90, 3))
    expected = sum(_through(positions[triangles[i]], positions[triangles[j]]) for i in range(30) for j in range(i))
    assert expected > 10
    assert self_intersections(positions, triangles) == expected


def _through(first: Array, second: Array) -> bool:
    pairs = ((a, b) for a, b in ((first, second), (second, first)))
    return any(ipctk.is_edge_intersecting_triangle(a[k], a[(k + 1) % 3], *b) for a, b in pairs for k in range(3))


def crossed(points: Array) -> Array:
    """Printed points (n, 2) on a sheet folded over along x = 0, whose halves pass through each other."""
    x, y = points.T
    return np.column_stack([np.abs(x), y, np.sign(x) * np.sin(0.5 * y)])


@pytest.mark.slow
def test_a_start_that_intersects_itself_is_not_used() -> None:
    sheet = model(ContactModel)
    flat = sheet.flat_state()
    with pytest.raises(ValueError, match="passes through itself"):
        solve_on_mesh(sheet, moved_state(flat, sheet.edges, crossed(sheet.mesh.points), np.zeros(len(sheet.edges))))
    searches = [contact_search(sheet) for _ in range(2)]
    near, alone = (solve_on_meshes(each, near=start)[0] for each, start in zip(searches, (crossed, None), strict=True))
    assert near.is_minimum and near.energy == pytest.approx(alone.energy, rel=1e-9)
