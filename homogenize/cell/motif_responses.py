"""The responses of the unit cell of a motif: rest metric, stiffness, and how far the sheet rolls in each direction.

One cell stands for an endless sheet only if a cell of 2 x 2 motifs does not relax to a lower energy. Where stiff lines
keep a single cell from shrinking, the sheet buckles in a pattern that repeats after several cells. A honeycomb is such
a sheet: a single cell keeps its length in all directions, while four cells together fold. It has several equilibria of
similar energy, and no law of one cell describes it.
"""

from __future__ import annotations

from contextlib import closing
from dataclasses import asdict, dataclass
from typing import Any, cast

import numpy as np

from asterism.discrete.energies.rods.network import torsion_constant
from asterism.discrete.model.state import State, moved_state
from asterism.equilibrium.arrays import Array, Floats
from asterism.homogenize.cell.flat_cell import FlatCell, relax_flat_cell, released_from
from asterism.homogenize.cell.linear_response import flat_membrane_stiffness
from asterism.homogenize.cell.natural_curvature import MAX_SEARCHED_CURL, trace_tubes
from asterism.homogenize.cell.point_group import ALL_ANGLES_RAD
from asterism.homogenize.cell.unit_cell import UnitCell
from asterism.homogenize.law.anisotropy import isotropic_constants
from asterism.pattern.design.design import Design
from asterism.pattern.design.files import plain
from asterism.pattern.rods.motif_graph import motif_graph

# starts of the larger cell, by the seeds of their noise
NOISE_SEEDS = (0, 1)


@dataclass(frozen=True)
class CellComparison:
    """One cell and four, both flat and relaxed."""

    # energy, larger_energy: N mm per mm^2 of print, of one cell, and the lowest of the starts of the larger one.
    energy: float
    larger_energy: float
    # stretches, larger_stretches: (2,) principal stretches of the contracted sheet, the smaller one first.
    stretches: Array
    larger_stretches: Array

    @property
    def excess(self) -> float:
        """Energy of one cell over that of the larger one, minus 1."""
        return (self.energy - self.larger_energy) / abs(self.larger_energy)

    @property
    def reason(self) -> str | None:
        """Why the motif has no law, in one line; None if it has one."""
        if self.excess <= 0.01:  # meshes and starts differ by less
            return None
        one, four = (" and ".join(f"{value:.3f}" for value in each) for each in (self.stretches, self.larger_stretches))
        less = f"2 x 2 cells relax to {100 * self.excess:.1f} % less energy"
        return f"the motif has no law of one cell: {less} and contract to {four}, one cell to {one}"


def compare_with_larger_cell(design: Design, edge_mm: float, flat: FlatCell) -> CellComparison:
    """One flat cell and 2 x 2 cells of a design's motif, with the same mesh.

    The larger cell is released from the flat print with a slight noise in height, once for each of `NOISE_SEEDS`.
    Raises `ValueError`, `DesignError` or `MeshError` as `UnitCell` does. Raises `ArithmeticError` if a cell has no
    equilibrium.
    """
    with closing(UnitCell(design, edge_mm, (2, 2))) as larger:
        trials = [released_from(larger, _with_noise(larger, seed)) for seed in NOISE_SEEDS]
    lowest = min(trials, key=lambda trial: trial.energy)
    stretches = (np.linalg.eigvalsh(each.deformation) for each in (flat, lowest))
    return CellComparison(flat.energy, lowest.energy, *stretches)


def _with_noise(cell: UnitCell, seed: int) -> State:
    """The flat print with noise in its heights: enough to leave a symmetric state, and far below any buckle."""
    cell.set_flat()
    state, n = cell.printed_state(), cell.mesh.n_base
    positions = state.positions.copy()
    positions[:n, 2] += 0.005 * cell.spacing * np.random.default_rng(seed).normal(size=n)
    turn = np.zeros(len(cell.edges))
    moved = moved_state(cell.unfolded(state), cell.edges, cell.images.unfold(positions), turn)
    return State(positions, moved.directors, state.frames)


@dataclass(frozen=True)
class RolledDirection:
    """The natural tube of one direction."""

    direction_rad: float  # of the printed direction around the tube, from x
    curvature: float  # 1/mm, one over the mean radius; positive with the plastic outside
    # hoop, axial: stretches around and along the tube. If the sheet hardly curls, those of a tube of small curvature.
    hoop: float
    axial: float
    bending: float  # N mm, secant stiffness from the flat cell to the tube, in curvatures of the contracted sheet


@dataclass(frozen=True)
class MotifResponses:
    """One cell of an endless sheet."""

    deformation: Array  # (2, 2) F, symmetric, of the flat relaxed cell; the rest metric is F F
    membrane: Array  # (3, 3) N/mm, stiffness of the flat cell
    rods: Array  # (3, 3) N mm, bending stiffness of the rods alone
    directions: tuple[RolledDirection, ...]  # natural tubes
    failed_directions: tuple[tuple[float, str], ...]  # rad from x, those without an equilibrium, and why
    comparison: CellComparison  # with 2 x 2 cells
    spacing_mm: float  # length of the shorter lattice vector

    def to_dict(self) -> dict[str, Any]:
        """Plain data for JSON, with the `doubts`."""
        return cast("dict[str, Any]", plain({**asdict(self), "doubts": self.doubts}))

    @property
    def doubts(self) -> list[str]:
        """Why a sheet may differ from its cell, one line each."""
        doubts = [] if self.comparison.reason is None else [self.comparison.reason]
        curl = max((abs(tube.curvature) * self.spacing_mm for tube in self.directions), default=0.0)
        if curl > MAX_SEARCHED_CURL:
            doubts.append(f"the sheet curls by {curl:.2g} rad within one cell: it is not separated in scale")
        return doubts + [f"direction {np.degrees(angle):.0f} deg: {reason}" for angle, reason in self.failed_directions]


def motif_responses(design: Design, edge_mm: float) -> MotifResponses:
    """Solve the unit cell of a design's motif, flat and rolled in several directions, and compare it with 2 x 2 cells.

    The mesh has edges of `edge_mm`. Raises `ValueError`, `DesignError` or `MeshError` as `UnitCell` does. Raises
    `ArithmeticError` if the flat cell has no equilibrium.
    """
    directions: list[RolledDirection] = []
    failed: list[tuple[float, str]] = []
    with closing(UnitCell(design, edge_mm)) as cell:
        flat = relax_flat_cell(cell)
        membrane = flat_membrane_stiffness(cell, flat)
        for angle in ALL_ANGLES_RAD:  # from y to the printed direction around the tube
            around = (angle + 0.5 * np.pi) % np.pi
            try:
                branch = trace_tubes(cell, flat, angle)
            except ArithmeticError as error:
                failed.append((around, str(error)))
                continue
            if branch.natural is None:
                tube = branch.tubes[0]
                curvature, bending = branch.slight / tube.hoop, branch.stiffness * tube.hoop**2
            else:
                tube = branch.natural
                curvature = tube.contracted_curvature
                bending = 2.0 * (flat.energy - tube.energy) / curvature**2
            directions.append(RolledDirection(around, curvature, tube.hoop, tube.axial, bending))
    comparison = compare_with_larger_cell(design, edge_mm, flat)
    ordered = tuple(sorted(directions, key=lambda tube: tube.direction_rad))
    rods = rod_bending(design, flat.deformation)
    return MotifResponses(flat.deformation, membrane, rods, ordered, tuple(failed), comparison, cell.spacing)


# second derivative of det K
GAUSSIAN: Floats = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -0.5]])


def completed_by_rods(stiffness: Floats, rods: Floats) -> Floats:
    """(3, 3) N mm, a stiffness known up to a multiple of det K, with the mean of Q12 over all axes of the rods.

    >>> rods = np.diag([14.7, 14.7, 8.9])
    >>> completed_by_rods(rods - 39.0 * GAUSSIAN, rods).round(6) + 0.0
    array([[14.7,  0. ,  0. ],
           [ 0. , 14.7,  0. ],
           [ 0. ,  0. ,  8.9]])
    """
    known, wanted = (isotropic_constants(each)[1] for each in (stiffness, rods))
    return np.asarray(stiffness + (wanted - known) * GAUSSIAN)


def rod_bending(design: Design, deformation: Floats) -> Floats:
    """(3, 3) N mm, bending stiffness of a motif's rods per printed area, for curvatures 11, 22 and 2 x 12 of the print.

    The tubes of the cell leave one number of its stiffness open. Their energy has no term of the Gaussian curvature det
    K, so they give the stiffness up to a multiple of det K: Q12 may grow by c while Q33 falls by c/2. In a sheet of
    rods on a surface of the curvature b, a rod of direction t bends by `t . b t` and twists by `t . b n`. Rods bonded
    at points, in fabric too soft to count, take the stiffness `B (t . b t)^2 + T (t . b n)^2` per length each, which
    has all entries. With F, the (2, 2) deformation of the flat sheet, the print's curvature K is `F^T b F`. Raises
    `DesignError` as `motif_graph` does.

    A square grid of rods has B/d in both directions, T/(2 d) for the twist 2 K12, and no coupling:

    >>> motif = [{"line_mm": [(0, 0), (10, 0)]}, {"line_mm": [(0, 0), (0, 10)]}]
    >>> grid = Design.from_dict({
    ...     "rods": {"motif": motif, "thickness_mm": 0.4}, "lattice": {"kind": "square", "spacing_mm": 10.0},
    ...     "border": {"rectangle_mm": (60, 60)},
    ... })
    >>> rod_bending(grid, np.eye(2)).round(1) + 0.0
    array([[14.7,  0. ,  0. ],
           [ 0. , 14.7,  0. ],
           [ 0. ,  0. ,  8.9]])
    """
    rods = design.rods
    assert rods is not None, "a motif has rods"
    motif = motif_graph(rods, design.lattice)
    modulus = design.fabric.modulus * design.plastic.modulus_ratio
    shear_modulus = modulus / (2.0 * (1.0 + design.plastic.poisson))
    inverse = np.linalg.inv(deformation)
    stiffness = np.zeros((3, 3))
    for rod in motif.rods:
        width, height = (0.5 * (sizes[1:] + sizes[:-1]) for sizes in (rod.width, rod.thickness))
        bending = modulus * width * height**3 / 12.0
        torsion = shear_modulus * torsion_constant(width, height)
        edges = np.diff(rod.points, axis=0)
        along = edges @ deformation.T
        along /= np.linalg.norm(along, axis=1)[:, None]
        (ux, uy), (vx, vy) = (along @ inverse.T).T, (np.stack([-along[:, 1], along[:, 0]], axis=1) @ inverse.T).T
        bend = np.stack([ux * ux, uy * uy, ux * uy])
        twist = np.stack([ux * vx, uy * vy, 0.5 * (ux * vy + uy * vx)])
        lengths = np.linalg.norm(edges, axis=1)
        stiffness += (bending * bend * lengths) @ bend.T + (torsion * twist * lengths) @ twist.T
    return stiffness / abs(float(np.linalg.det(motif.vectors)))
