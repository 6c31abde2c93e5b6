"""A cell rolled to a tube of given curvature.

The axis of the tube is x; the printed direction t, which is y turned by an angle, runs around it. The curvature k is
the angle around the tube per printed length. A tube of mean radius r has the hoop stretch `k r`, and the contracted
sheet has the curvature `1/r = k/hoop`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asterism.discrete.model.discrete_model import bump_heights
from asterism.discrete.model.state import State
from asterism.equilibrium.arrays import Array
from asterism.equilibrium.newton.minimise import minimise
from asterism.homogenize.cell.flat_cell import (
    FlatCell,
    between,
    cell_gradient_tolerance,
    polished,
    with_orthogonal_directors,
)
from asterism.homogenize.cell.unit_cell import ANCHOR, UnitCell


@dataclass(frozen=True)
class Tube:
    """A cell in equilibrium as a tube."""

    curvature: float  # k, 1/mm of the print
    angle: float  # of the printed direction around the tube, from y
    state: State  # of the cell with the images of the tube
    energy: float  # N mm per mm^2 of print
    moment: float  # N, derivative of the energy by k
    radius: float  # mm, mean over the surface, weighted by printed area
    # hoop, axial: stretches of the mean surface around and along the tube.
    hoop: float
    axial: float
    bump: Array  # (S,) mm, height of each star's centre over its tips, positive outwards
    # gradient_norm, iterations: of the equilibrium, see `FlatCell`.
    gradient_norm: float
    iterations: int

    @property
    def contracted_curvature(self) -> float:
        """1/mm of the contracted sheet: one over the mean radius."""
        return 1.0 / self.radius


@dataclass(frozen=True)
class UnrolledCell:
    """A state in the axes of a tube: along the axis, around it (as length on the mean surface), and outwards."""

    state: State  # of the sheet
    hoop: float  # stretch around the tube


def unrolled_flat_cell(flat: FlatCell, angle: float) -> UnrolledCell:
    """A flat cell in the axes of a tube."""
    return _along(flat.state, flat.deformation, angle)


def unrolled_in_direction(cell: UnitCell, tube: Tube, angle: float) -> UnrolledCell:
    """A tube, unrolled and in the axes of a tube in another direction."""
    sheet = unroll(cell, tube).state
    deformation = np.linalg.solve(cell.cell_vectors, sheet.positions[cell.mesh.n_base :, :2]).T
    return _along(sheet, deformation, angle)


def part_way(one: UnrolledCell, other: UnrolledCell, part: float) -> UnrolledCell:
    """A part of the straight way from one unrolled cell to another, or beyond."""
    return UnrolledCell(between(one.state, other.state, part), one.hoop + part * (other.hoop - one.hoop))


def _along(state: State, deformation: Array, angle: float) -> UnrolledCell:
    """A flat state, turned so that points at equal angle on the tube have equal y."""
    across = np.linalg.solve(deformation.T, np.array([-np.sin(angle), np.cos(angle)]))
    hoop = 1.0 / float(np.linalg.norm(across))
    (x, y) = hoop * across
    turn = np.array([[y, -x, 0.0], [x, y, 0.0], [0.0, 0.0, 1.0]])
    return UnrolledCell(state.rotated(turn, np.zeros(3)), hoop)


def unroll(cell: UnitCell, tube: Tube) -> UnrolledCell:
    """A tube, cut open and unrolled: arc lengths at the mean radius, heights above it.

    The cell takes on the images of the tube.
    """
    cell.set_tube(tube.curvature, tube.angle)
    n, k = cell.mesh.n_base, tube.curvature
    x = tube.state.positions
    angle = _angles(cell, x[:n], k)
    radial = np.sign(k) * np.hypot(x[:n, 1], x[:n, 2])
    flat = np.column_stack([x[:n, 0], tube.hoop / k * angle, radial - tube.radius])
    macro = x[n:].copy()
    macro[:, 1] = tube.hoop * (cell.cell_vectors @ cell.turn[1])
    middle = _middles(cell, cell.images.unfold(x), k)
    at_joints = np.repeat(angle[cell.joint_vertices], 3)
    frames = _turned(tube.state.frames.reshape(-1, 3), -at_joints).reshape(-1, 3, 3)
    return UnrolledCell(State(np.vstack([flat, macro]), _turned(tube.state.directors, -middle), frames), tube.hoop)


def rolled_state(cell: UnitCell, sheet: UnrolledCell, curvature: float, angle: float) -> State:
    """An unrolled cell, rolled to a tube of this curvature (1/mm of the print).

    The cell takes on the images of that tube.
    """
    cell.set_tube(curvature, angle)
    n, flat = cell.mesh.n_base, sheet.state
    base, radius = flat.positions[:n], sheet.hoop / curvature
    turn = base[:, 1] / radius
    out = radius + base[:, 2]
    positions = np.zeros_like(flat.positions)
    positions[:n] = np.column_stack([base[:, 0], out * np.sin(turn), out * np.cos(turn)])
    positions[n:, 0] = flat.positions[n:, 0]
    middle = _middles(cell, cell.images.unfold(positions), curvature)
    at_joints = np.repeat(turn[cell.joint_vertices], 3)
    frames = _turned(flat.frames.reshape(-1, 3), at_joints).reshape(-1, 3, 3)
    return with_orthogonal_directors(cell, State(positions, _turned(flat.directors, middle), frames))


def roll_cell(cell: UnitCell, sheet: UnrolledCell, curvature: float, angle: float, blend: float = 0.0) -> Tube:
    """Roll the cell and find its equilibrium. Raises `ArithmeticError` if Newton's method did not converge."""
    start = rolled_state(cell, sheet, curvature, angle)
    minimum = polished(
        cell, minimise(cell, start, cell.factor(), cell_gradient_tolerance(cell), blend=blend, check_definite=False)
    )
    if not minimum.converged:
        raise ArithmeticError(f"tube: no equilibrium at curvature {curvature:.4g}/mm")
    k = curvature
    n = cell.mesh.n_base
    x = minimum.state.positions
    radius = float(np.sign(k) * cell.weights @ np.hypot(x[:n, 1], x[:n, 2]))
    axial = float(np.linalg.solve(cell.cell_vectors, x[n:, 0]) @ cell.turn[0])
    return Tube(
        curvature=k,
        angle=cell.angle,
        state=minimum.state,
        energy=minimum.energy / cell.area,
        moment=cell.moment(minimum.state),
        radius=radius,
        hoop=k * radius,
        axial=axial,
        bump=bump_heights(cell.model, cell.unfolded(minimum.state)),
        gradient_norm=minimum.gradient_norm,
        iterations=minimum.iterations,
    )


def heights_over_mean_surface(cell: UnitCell, tube: Tube) -> Array:
    """(V,) mm, heights of the base points over the tube's mean surface, positive outwards."""
    y, z = tube.state.positions[: cell.mesh.n_base, 1:].T
    return np.asarray(np.sign(tube.curvature) * np.hypot(y, z) - tube.radius)


def _angles(cell: UnitCell, points: Array, curvature: float) -> Array:
    """(V,) rad about the axis, on the same turn as the printed points."""
    sign = np.sign(curvature)
    printed = curvature * ((cell.printed[: len(points)] - cell.printed[ANCHOR]) @ cell.turn[1])
    off = np.arctan2(sign * points[:, 1], sign * points[:, 2]) - printed
    return np.asarray(printed + off - 2.0 * np.pi * np.round(off / (2.0 * np.pi)))


def _middles(cell: UnitCell, points: Array, curvature: float) -> Array:
    """(R,) rad, angle of the middle of every rod edge."""
    middle = points[cell.edges].mean(axis=1)
    sign = np.sign(curvature)
    return np.asarray(np.arctan2(sign * middle[:, 1], sign * middle[:, 2]))


def _turned(vectors: Array, angle: Array) -> Array:
    """Vectors (R, 3) turned outwards by angles (R,) about the axis."""
    cos, sin = np.cos(angle), np.sin(angle)
    y, z = vectors[:, 1], vectors[:, 2]
    return np.column_stack([vectors[:, 0], y * cos + z * sin, z * cos - y * sin])
