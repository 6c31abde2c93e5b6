"""One period of an endless ribbon of equal stars with two free sides, in equilibrium under an unknown screw motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from asterism.discrete.model.rotations import rotate_vectors
from asterism.discrete.model.state import State, edge_tangents, moved_state
from asterism.discrete.model.system import System
from asterism.equilibrium.arrays import Array
from asterism.equilibrium.linear.rigid_support import independent_dofs
from asterism.equilibrium.newton.minimise import minimise
from asterism.homogenize.cell.flat_cell import (
    BUMP_HEIGHT_RATIO,
    BUMP_WIDTH_RATIO,
    FINAL_GRADIENT_RATIO,
    INTERMEDIATE_GRADIENT_RATIO,
    RELEASE_STEPS,
)
from asterism.homogenize.cell.ribbon_mesh import RibbonShape, ribbon_mesh
from asterism.homogenize.cell.screw_images import ScrewElements, ScrewImages
from asterism.homogenize.cell.unfolded_model import unfolded_model
from asterism.pattern.design.design import Design

# release at which the flat ribbon is rolled a little along its length, to choose the side it rolls to
ROLL_RELEASE = 0.2
ROLL_TURN_RAD = 0.2  # per spacing


@dataclass(frozen=True)
class Ribbon:
    """A ribbon in equilibrium.

    Attributes
    ----------
    state : of the cell; its frame is the screw's rotation, the last row of its positions the screw's shift.
    energy : N mm per mm of printed length.
    curvature : rad per mm of printed length, angle of the screw.
    pitch : mm, shift of the screw along its axis in one period.
    gradient_norm, definite, iterations : see `homogenize.cell.flat_cell.FlatCell`.
    """

    state: State
    energy: float
    curvature: float
    pitch: float
    gradient_norm: float
    definite: bool
    iterations: int


class RibbonCell(System):
    """The exact model's energies on one period of a ribbon.

    Positions are the V base points and the shift t of the screw; the only frame is its rotation Q, by rows as in
    `State`.

    Parameters
    ----------
    design : materials, lattice, and the stars, whose arms must have the length of the mesh's.
    shape : the ribbon on the grid.

    Raises
    ------
    ValueError
        The stars differ, gravity is on, the arms do not lie on lattice lines, or the fabric's bending needs neighbours.
    """

    def __init__(self, design: Design, shape: RibbonShape) -> None:
        self.design, self.shape = design, shape
        self.mesh = mesh = ribbon_mesh(design.lattice, shape)
        self.model = unfolded_model(design, self.mesh, None)
        if self.model.bending.needs_neighbours:
            raise ValueError("a ribbon cell needs a bending energy of hinges")
        self.images = ScrewImages(mesh.base, mesh.image[:, 0], mesh.n_base, len(self.model.edges))
        rows = mesh.n_base + 1
        held = np.zeros(3 * rows + len(self.model.edges) + 3, dtype=bool)
        parts = {name: ScrewElements(part, self.images) for name, part in self.model.parts.items()}
        super().__init__(parts, rows, self.model.edges, held, joint_vertices=np.array([mesh.n_base]))  # type: ignore[arg-type]

    @property
    def length(self) -> float:
        """mm, printed length of one period."""
        return float(np.linalg.norm(self.mesh.cell_vectors[0]))

    def tolerance(self, part: float = FINAL_GRADIENT_RATIO) -> float:
        """N, gradient norm of a converged cell."""
        fabric = self.design.fabric
        return part * fabric.modulus_mpa * fabric.thickness_mm * self.design.lattice.spacing_mm

    def unfolded(self, state: State) -> State:
        """The same state on the unfolded mesh."""
        return State(self.images.unfold(state.positions, state.frames[0].T), state.directors)

    def path(self, state: State, direction: Array, straight: bool = True) -> tuple[Callable[[float], State], float]:
        """Straight steps of the positions and a turn of the screw; directors follow the unfolded rod edges."""
        (move, turn), spin = self.displacements_and_twists(direction), self.spins(direction)
        whole = self.unfolded(state)

        def at(a: float) -> State:
            positions, frames = state.positions + a * move, rotate_vectors(a * spin, state.frames)
            moved = moved_state(whole, self.edges, self.images.unfold(positions, frames[0].T), a * turn)
            return State(positions, moved.directors, frames)

        fastest = float(np.sqrt((move**2).sum(axis=1).max()))
        return at, 0.1 * self.design.lattice.spacing_mm / max(fastest, 1e-30)

    def rigid_motions(self, state: State) -> Array:
        """(free, 6) motions without energy: the ribbon moves, and its screw with it."""
        points, shift, rotation = self.images.split(state.packed)
        along = edge_tangents(self.images.unfold(state.positions, rotation), self.edges)
        none, still = np.zeros(3), np.zeros(len(self.edges))
        size = np.abs(points).max()
        out = []
        for axis in np.eye(3):
            out.append(np.concatenate([np.tile(axis, len(points)), axis - rotation @ axis, still, none]))
            turned = np.vstack([points, shift])
            spin = axis - rotation @ axis
            out.append(np.concatenate([np.cross(axis, turned).ravel(), along @ axis, spin]) / size)
        return np.array(out).T

    def rigid_modes(self, state: State) -> Array:
        """(free, 6) orthonormal basis of `rigid_motions`."""
        return np.linalg.qr(self.rigid_motions(state))[0]

    def support(self, state: State) -> Array:
        """(6,) free degrees of freedom that prevent all rigid motions if they are held."""
        return independent_dofs(self.rigid_motions(state))

    def printed_state(self) -> State:
        """The print: flat, shifted by one period."""
        points = np.vstack([self.mesh.points[: self.mesh.n_base], self.mesh.cell_vectors[0]])
        directors = np.tile([0.0, 0.0, 1.0], (len(self.edges), 1))
        return State(np.pad(points, ((0, 0), (0, 1))), directors, np.eye(3)[None])

    def moved(self, state: State, positions: Array, rotation: Array) -> State:
        """The state at other positions (V + 1, 3) and with another rotation; directors follow the rods."""
        points = self.images.unfold(positions, rotation)
        whole = moved_state(self.unfolded(state), self.edges, points, np.zeros(len(self.edges)))
        return State(positions, whole.directors, rotation.T[None])

    def printed_across(self) -> Array:
        """(V,) mm, printed distance of the base points from the first line of stars, towards the last one."""
        grid = np.linalg.solve(np.asarray(self.design.lattice.vectors).T, self.mesh.points[: self.mesh.n_base].T).T
        (i, j), spacing = grid.T, self.design.lattice.spacing_mm
        return np.asarray((i + 0.5 * j) * spacing if self.shape.across else j * np.sqrt(0.75) * spacing)


def relax_ribbon(cell: RibbonCell) -> Ribbon:
    """The ribbon at rest: released in steps, with bumps from the start, and rolled a little along its length.

    Raises
    ------
    ArithmeticError
        The last step did not converge.
    """
    state, iterations, factor = _with_bumps(cell), 0, cell.factor()
    for release in RELEASE_STEPS:
        cell.model.set_release(release)
        last = release == RELEASE_STEPS[-1]
        if release == ROLL_RELEASE:
            state = _rolled(cell, state, ROLL_TURN_RAD / cell.design.lattice.spacing_mm)
        tolerance = cell.tolerance() if last else cell.tolerance(INTERMEDIATE_GRADIENT_RATIO)
        found = minimise(cell, state, factor, tolerance, check_definite=last)
        state, iterations = found.state, iterations + found.iterations
    factor.close()
    if not found.converged:
        raise ArithmeticError("ribbon: no equilibrium")
    _, _, angle, pitch = cylinder_coordinates(cell, state)
    energy = found.energy / cell.length
    return Ribbon(state, energy, angle / cell.length, pitch, found.gradient_norm, found.definite, iterations)


def cylinder_coordinates(cell: RibbonCell, state: State) -> tuple[Array, Array, float, float]:
    """Radius (V,) mm of the base points about the screw's axis, place (V,) mm along it, angle and pitch of the screw.

    The place along the axis grows with the distance across the print.
    """
    points, shift, rotation = cell.images.split(state.packed)
    angle = float(np.arccos(np.clip(0.5 * (np.trace(rotation) - 1.0), -1.0, 1.0)))
    axis = np.array([rotation[2, 1] - rotation[1, 2], rotation[0, 2] - rotation[2, 0], rotation[1, 0] - rotation[0, 1]])
    axis /= np.linalg.norm(axis)
    pitch = float(shift @ axis)
    centre = np.linalg.lstsq(np.eye(3) - rotation, shift - pitch * axis, rcond=None)[0]
    along = (points - centre) @ axis
    across = cell.printed_across()
    along *= np.sign((along - along.mean()) @ (across - across.mean()))
    return np.linalg.norm(np.cross(points - centre, axis), axis=1), along, angle, pitch


def _with_bumps(cell: RibbonCell) -> State:
    """The print with a smooth bump at every star."""
    printed, spacing = cell.printed_state(), cell.design.lattice.spacing_mm
    stars = cell.mesh.points[cell.mesh.star_vertices]
    centres = np.vstack([stars + p * cell.mesh.cell_vectors[0] for p in (-2, -1, 0, 1, 2)])
    distance = np.linalg.norm(cell.mesh.points[: cell.mesh.n_base, None] - centres, axis=2).min(axis=1)
    positions = printed.positions.copy()
    positions[:-1, 2] += BUMP_HEIGHT_RATIO * spacing * (np.exp(-((distance / (BUMP_WIDTH_RATIO * spacing)) ** 2)) - 1.0)
    return cell.moved(printed, positions, np.eye(3))


def _rolled(cell: RibbonCell, state: State, curvature: float) -> State:
    """A ribbon, rolled along its length with the plastic outside; heights stay normal to the tube."""
    points, shift, up = state.positions[:-1], state.positions[-1], np.array([0.0, 0.0, 1.0])
    along = np.array([*shift[:2], 0.0]) / np.linalg.norm(shift[:2])
    side = np.cross(up, along)
    off = points - points.mean(axis=0)
    turn, radius = curvature * (off @ along), 1.0 / curvature + off @ up
    rolled = np.outer(radius * np.sin(turn), along) + np.outer(off @ side, side)
    rolled += np.outer(radius * np.cos(turn) - 1.0 / curvature, up)
    angle = curvature * float(np.linalg.norm(shift[:2]))
    rotation = np.outer(side, side) + np.cos(angle) * (np.outer(along, along) + np.outer(up, up))
    rotation += np.sin(angle) * (np.outer(along, up) - np.outer(up, along))
    centre = -up / curvature
    return cell.moved(state, np.vstack([rolled, centre - rotation @ centre]), rotation)
