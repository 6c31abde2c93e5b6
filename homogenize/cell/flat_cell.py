"""The flat unit cell at rest.

The fabric is released in steps, so that the star follows the branch on which it starts.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from asterism.discrete.model.discrete_model import bump_heights
from asterism.discrete.model.state import State, edge_tangents, moved_state, orthonormal_to_tangents
from asterism.equilibrium.arrays import Array
from asterism.equilibrium.newton.minimise import Minimum, minimise
from asterism.homogenize.cell.periodic_mesh import CELLS_AROUND
from asterism.homogenize.cell.unit_cell import ANCHOR, UnitCell
from asterism.pattern.design.lattice import DEFAULT_SPACING_MM

# part of the stretch that is released
RELEASE_STEPS = (0.03, 0.1, 0.2, 0.3, 0.4, 0.5, 0.62, 0.75, 0.88, 1.0)
# gradient over the force scale, at the last step of the release
FINAL_GRADIENT_RATIO = 1e-8


@dataclass(frozen=True)
class FlatCell:
    """A flat cell in equilibrium, turned so that its deformation has no rotation."""

    # the centre of the first star, or the first node of a motif, is at the origin. The images of the cell vectors are
    # in the plane z = 0.
    state: State
    energy: float  # N mm per mm^2 of print
    deformation: Array  # (2, 2) symmetric F, with the images `a_m = F A_m` of the cell vectors
    # (S,) mm, height of each star's centre over its tips; positive on the plastic side. None for a motif: (0,).
    bump: Array
    gradient_norm: float  # N
    iterations: int  # of Newton's method

    @property
    def stretch(self) -> float:
        """lambda = sqrt(det F), contracted over printed length."""
        return float(np.sqrt(np.linalg.det(self.deformation)))


def cell_gradient_tolerance(cell: UnitCell, part: float = FINAL_GRADIENT_RATIO) -> float:
    """Gradient norm of a converged cell, N: a part of the force scale; rounding is a hundredth of the default."""
    fabric = cell.design.fabric
    small = min(1.0, cell.area / abs(float(np.linalg.det(cell.design.lattice.vectors))))  # a cell of bare fabric
    return part * small * fabric.modulus * fabric.thickness_mm * cell.spacing


def relax_flat_cell(cell: UnitCell) -> FlatCell:
    """The flat cell with its star up, or down if that is its only equilibrium.

    A star that is only slightly buckled has a single equilibrium, on either side. Its branch with the star up begins at
    a finite curvature. Raises `ArithmeticError` if a step did not converge.
    """
    cell.set_flat()
    state = cell.printed_state()
    if len(cell.mesh.star_vertices):
        state = with_bumps(cell, state, 1.0 / DEFAULT_SPACING_MM * cell.spacing)
    flat = released_from(cell, state)
    return (_other_side(cell, flat) or flat) if flat.bump.any() and flat.bump[0] < 0.0 else flat


def released_from(cell: UnitCell, state: State) -> FlatCell:
    """The flat cell that a state of the print becomes while the fabric is released.

    Raises `ArithmeticError` if a step did not converge.
    """
    iterations, known = 0, list[tuple[float, State]]()
    for release in RELEASE_STEPS:
        cell.set_release(release)
        last = release == RELEASE_STEPS[-1]
        if len(known) > 1:
            (before, one), (after, other) = known[-2:]
            state = with_orthogonal_directors(cell, between(one, other, (release - before) / (after - before)))
        minimum = minimise(
            cell,
            state,
            cell.factor(),
            cell_gradient_tolerance(cell, FINAL_GRADIENT_RATIO if last else 1e-5),
            check_definite=False,
        )
        iterations += minimum.iterations
        if not minimum.converged:
            raise ArithmeticError(f"flat cell: no equilibrium at {100 * release:g} % release")
        state = minimum.state
        known.append((release, state))
    return flat_cell_from_minimum(cell, polished(cell, minimum), iterations)


def polished(cell: UnitCell, minimum: Minimum) -> Minimum:
    """The minimum after one more step, which Newton's method makes exact: moments of slight curvatures need it."""
    tolerance = cell_gradient_tolerance(cell, 1e-10)
    if not minimum.converged or minimum.gradient_norm <= tolerance:
        return minimum
    exact = minimise(cell, minimum.state, cell.factor(), tolerance, max_iterations=1, check_definite=False)
    if exact.gradient_norm > minimum.gradient_norm:
        return minimum
    return replace(exact, tolerance=minimum.tolerance, iterations=minimum.iterations + exact.iterations)


def _other_side(cell: UnitCell, flat: FlatCell) -> FlatCell | None:
    """The flat cell with its stars on the other side, from the mirrored state; None if that is no equilibrium."""
    cell.set_flat()
    start = with_orthogonal_directors(cell, _mirrored(flat.state))
    minimum = minimise(cell, start, cell.factor(), cell_gradient_tolerance(cell), check_definite=False)
    if not minimum.converged:
        return None
    other = flat_cell_from_minimum(cell, minimum, minimum.iterations)
    return other if (np.sign(other.bump) == -np.sign(flat.bump)).all() else None


def _mirrored(state: State) -> State:
    """The state mirrored in the plane z = 0. The plastic stays on its side: normals turn round."""
    mirror = np.array([1.0, 1.0, -1.0])
    frames = state.frames * mirror
    frames[:, 2] *= -1.0
    return State(state.positions * mirror, -state.directors * mirror, frames)


def flat_cell_from_minimum(cell: UnitCell, minimum: Minimum, iterations: int) -> FlatCell:
    """The flat cell of a minimum, without rotation, with the numbers that are kept."""
    state, deformation = without_rotation(cell, minimum.state)
    bump = bump_heights(cell.model, cell.unfolded(state))
    energy = minimum.energy / cell.area
    return FlatCell(state, energy, deformation, bump, minimum.gradient_norm, iterations)


def with_bumps(cell: UnitCell, state: State, height: float) -> State:
    """The flat print with a smooth bump of this height (mm) at every star."""
    base, stars = cell.printed[: cell.mesh.n_base], cell.printed[cell.mesh.star_vertices]
    steps = CELLS_AROUND @ cell.cell_vectors
    centres = (stars[:, None] + steps).reshape(-1, 2)
    distance = np.linalg.norm(base[:, None] - centres, axis=2).min(axis=1)
    positions = state.positions.copy()
    positions[: len(base), 2] += height * (np.exp(-((distance / (0.35 * cell.spacing)) ** 2)) - 1.0)
    whole = moved_state(cell.unfolded(state), cell.edges, cell.images.unfold(positions), np.zeros(len(cell.edges)))
    return State(positions, whole.directors, state.frames)


def without_rotation(cell: UnitCell, state: State) -> tuple[State, Array]:
    """The state, turned so that `a_m = F A_m` with a symmetric F (2, 2); and F."""
    n = cell.mesh.n_base
    images = state.positions[n:]
    slope = np.linalg.solve(cell.cell_vectors, images).T  # (3, 2)
    left, sizes, right = np.linalg.svd(slope, full_matrices=False)
    rotation = np.empty((3, 3))
    rotation[:, :2] = left @ right
    rotation[:, 2] = np.cross(rotation[:, 0], rotation[:, 1])
    base = (state.positions[:n] - state.positions[ANCHOR]) @ rotation
    turned = State(np.vstack([base, images @ rotation]), state.directors @ rotation, state.frames @ rotation)
    return with_orthogonal_directors(cell, turned), right.T @ np.diag(sizes) @ right


def between(one: State, other: State, part: float) -> State:
    """The state at a part of the straight way from one state to another, or beyond; frames stay those of rotations."""
    near, far = np.array(one.frames), np.array(other.frames)
    left, _, right = np.linalg.svd(near + part * (far - near))
    positions, directors = (
        a + part * (b - a) for a, b in ((one.positions, other.positions), (one.directors, other.directors))
    )
    return State(positions, directors, left @ right)


def with_orthogonal_directors(cell: UnitCell, state: State) -> State:
    """The state with directors orthogonal to their edges, which rounding or other images disturb."""
    along = edge_tangents(cell.images.unfold(state.positions), cell.edges)
    return State(state.positions, orthonormal_to_tangents(state.directors, along), state.frames)


def mean_height(cell: UnitCell, state: State) -> float:
    """mm, height of a flat cell's points over the held point, weighted by printed area."""
    z = state.positions[: cell.mesh.n_base, 2]
    return float(cell.weights @ z - z[ANCHOR])
