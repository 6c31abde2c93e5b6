"""Whether one cell stands for an endless sheet: a cell of 2 x 2 motifs may relax to a lower energy.

A net of stiff lines may not shrink cell by cell. It then buckles in a pattern that repeats after several cells only. A
honeycomb does: all directions of a single cell keep their length, while four cells together fold. Such a sheet has
several equilibria of similar energy, and no law of one cell describes it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asterism.discrete.model.state import State, moved_state
from asterism.equilibrium.arrays import Array
from asterism.homogenize.cell.flat_cell import FlatCell, relax_flat_cell, released_from
from asterism.homogenize.cell.unit_cell import UnitCell
from asterism.pattern.design.design import Design

# of the energy of one cell, by which four cells may be lower: meshes and starts differ by less
MAX_ENERGY_EXCESS = 0.01
# heights of the start's noise over the spacing: enough to leave a symmetric state, and far below any buckle
NOISE_RATIO = 0.005
# starts of the larger cell, by the seeds of their noise
NOISE_SEEDS = (0, 1)
LARGER_CELL = (2, 2)


@dataclass(frozen=True)
class CellComparison:
    """One cell and four, both flat and relaxed.

    Attributes
    ----------
    energy, larger_energy : N mm per mm^2 of print, of one cell, and the lowest of the starts of the larger one.
    stretches, larger_stretches : (2,) principal stretches of the contracted sheet, the smaller one first.
    """

    energy: float
    larger_energy: float
    stretches: Array
    larger_stretches: Array

    @property
    def excess(self) -> float:
        """Energy of one cell over that of the larger one, minus 1."""
        return (self.energy - self.larger_energy) / abs(self.larger_energy)

    @property
    def has_law(self) -> bool:
        """Whether one cell stands for the sheet."""
        return self.excess <= MAX_ENERGY_EXCESS

    @property
    def reason(self) -> str | None:
        """Why the motif has no law, in one line; None if it has one."""
        if self.has_law:
            return None
        one, four = (" and ".join(f"{value:.3f}" for value in each) for each in (self.stretches, self.larger_stretches))
        less = f"2 x 2 cells relax to {100 * self.excess:.1f} % less energy"
        return f"the motif has no law of one cell: {less} and contract to {four}, one cell to {one}"


def compare_with_larger_cell(design: Design, edge_mm: float) -> CellComparison:
    """One cell and 2 x 2 cells of a design's motif, with the same mesh.

    The larger cell is released from the flat print with a slight noise in height, once for each of `NOISE_SEEDS`.

    Raises
    ------
    ValueError, DesignError, MeshError
        See `UnitCell`.
    ArithmeticError
        A cell has no equilibrium.
    """
    one = UnitCell(design, edge_mm)
    larger = UnitCell(design, edge_mm, LARGER_CELL)
    try:
        flat = relax_flat_cell(one)[0]
        trials = [released_from(larger, _with_noise(larger, seed)) for seed in NOISE_SEEDS]
    finally:
        one.close()
        larger.close()
    lowest = min(trials, key=lambda trial: trial.energy)
    return CellComparison(flat.energy, lowest.energy, _principal(flat), _principal(lowest))


def _with_noise(cell: UnitCell, seed: int) -> State:
    """The flat print with noise in its heights."""
    cell.set_flat()
    state, n = cell.printed_state(), cell.mesh.n_base
    positions = state.positions.copy()
    positions[:n, 2] += NOISE_RATIO * cell.spacing * np.random.default_rng(seed).normal(size=n)
    turn = np.zeros(len(cell.edges))
    moved = moved_state(cell.unfolded(state), cell.edges, cell.images.unfold(positions), turn)
    return State(positions, moved.directors, state.frames)


def _principal(flat: FlatCell) -> Array:
    return np.linalg.eigvalsh(flat.deformation)
