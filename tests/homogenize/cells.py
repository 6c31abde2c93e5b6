"""Designs of cells, and states of them that nothing vanishes at."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np

from asterism.discrete.model.state import State
from asterism.homogenize.cell.flat_cell import FlatCell, relax_flat_cell
from asterism.homogenize.cell.rolling import rolled_state, unrolled_flat_cell
from asterism.homogenize.cell.sample import Sample, solve_cell
from asterism.homogenize.cell.unit_cell import UnitCell
from asterism.pattern.design.design import Design
from tests.homogenize.motifs import diamonds, grid, honeycomb, motif_design, waves

MOTIFS = {"grid": grid(), "diamonds": diamonds(), "honeycomb": honeycomb(6.0), "waves": waves()}
TURN = 0.3  # rad, of tubes
EDGE = 2.9  # six edges between stars


def design(length: float = 10.0, thickness: float = 0.4, **more: Any) -> Design:
    """Equal stars of the paper's material, with its hinges."""
    sheet = {"stars": {"length_mm": length, "thickness_mm": thickness}, "border": {"rings": 1}}
    return Design.from_dict({**sheet, "fabric": {"bending": "paper"}, **more})


@functools.cache
def relaxed(length: float, thickness: float, edge: float = EDGE, turn: float = 0.0) -> tuple[UnitCell, FlatCell]:
    """A flat relaxed cell; a test that rolls it must not expect it flat afterwards."""
    cell = UnitCell(design(length, thickness, lattice={"orientation_deg": turn}), edge)
    return cell, relax_flat_cell(cell)


def cell_of(name: str, repeat: tuple[int, int] = (1, 1), **more: Any) -> UnitCell:
    """Of three arms on the aligned mesh, of five on a free one, or of a motif."""
    if name in MOTIFS:
        return UnitCell(motif_design(MOTIFS[name], **more), 3.0, repeat)
    star = design(10.0, 0.4, **more) if name == "three" else design(7.0, 0.4, lattice={"arms": 5}, **more)
    return UnitCell(star, EDGE, repeat)


@functools.cache
def relaxed_cell(name: str) -> tuple[UnitCell, FlatCell]:
    """As `relaxed`, of `cell_of`."""
    cell = cell_of(name)
    return cell, relax_flat_cell(cell)


def state_away(name: str, tube: bool) -> tuple[UnitCell, State]:
    """A cell, flat or a tube, and a state of it away from equilibrium: images differ, and all joints turn."""
    cell, flat = relaxed_cell(name)
    cell.set_flat()
    state = rolled_state(cell, unrolled_flat_cell(flat, TURN), 0.03, TURN) if tube else flat.state
    return cell, shaken(cell, state, 0.05)


@functools.cache
def sample(length: float, thickness: float, edge: float = EDGE) -> Sample:
    """Responses, solved once."""
    return solve_cell(design(length, thickness), edge)


def shaken(cell: UnitCell, state: State, size: float = 0.1) -> State:
    """The state after a random step of its free dofs."""
    direction = np.random.default_rng(3).normal(size=len(cell.free))
    return cell.path(state, direction)[0](size)
