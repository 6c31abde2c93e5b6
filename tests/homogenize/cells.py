"""Designs of cells, and states of them that nothing vanishes at."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
import scipy.sparse as sp

from asterism.discrete.model.state import State
from asterism.equilibrium.arrays import Array
from asterism.homogenize.cell.flat_cell import FlatCell, relax_flat_cell
from asterism.homogenize.cell.sample import Sample, solve_cell
from asterism.homogenize.cell.unit_cell import UnitCell
from asterism.pattern.design.design import Design

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


@functools.cache
def sample(length: float, thickness: float, edge: float = EDGE) -> Sample:
    """Responses, solved once."""
    return solve_cell(design(length, thickness), edge)


def shaken(cell: UnitCell, state: State, size: float = 0.1) -> State:
    """The state after a random step of its free dofs."""
    direction = np.random.default_rng(3).normal(size=len(cell.free))
    return cell.path(state, direction)[0](size)


def full(low: sp.csc_matrix) -> Array:
    """Dense symmetric matrix of a lower triangle."""
    dense = low.toarray()
    return np.asarray(dense + np.tril(dense, -1).T)
