"""The sample of one unit cell: all responses of an endless sheet of equal stars.

The mesh of a cell has the symmetry, but its equilibrium may break it: a star with four arms may bend to a saddle, with
one pair of arms up. Its images under the point group are equilibria of the same energy, and tubes that are equal by
symmetry then differ. A sheet takes the form of lower energy. So each of several equal directions gets the responses of
the one with the lowest natural energy, and tensors of the flat cell are means over the group.
"""

from __future__ import annotations

import math
from contextlib import closing
from dataclasses import asdict, dataclass
from typing import Any, cast

import numpy as np

from asterism.equilibrium.arrays import Array, Floats, Ints
from asterism.homogenize.cell.corrugation_waves import CorrugationWaves
from asterism.homogenize.cell.flat_cell import FlatCell, mean_height, relax_flat_cell
from asterism.homogenize.cell.linear_response import tube_membrane_stiffness, voigt_turn
from asterism.homogenize.cell.natural_curvature import TubeBranch, trace_tubes
from asterism.homogenize.cell.point_group import (
    ALL_ANGLES_RAD,
    averaged_directions,
    differs_by_direction,
    is_threefold,
    point_group,
    tube_angles,
)
from asterism.homogenize.cell.rolling import Tube, heights_over_mean_surface
from asterism.homogenize.cell.unit_cell import ANCHOR, UnitCell, star_size
from asterism.pattern.design.design import Design
from asterism.pattern.design.files import plain
from asterism.pattern.design.materials import Fabric

# of a response: responses that differ by less are equal up to the tolerance of Newton's method, and keep their digits
RESPONSE_TOLERANCE = 1e-6
# responses with one value for each direction; a sheet that is turned keeps them
SCALAR_KEYS = (
    "natural_curvature",
    "natural_energy",
    "natural_hoop",
    "natural_axial",
    "natural_bump_mm",
    "natural_centre_offset_mm",
    "bending",
)


@dataclass(frozen=True)
class Sample:
    """Responses of the cell of one star.

    Energies are per area of the print, relative to the flat relaxed cell. "Natural" means the tube with zero moment. If
    its curvature is below `natural_curvature.MIN_NATURAL_CURL`, then stretches, corrugation and membrane are those of a
    tube of small curvature. The mean surface is that of all points of the fabric, weighted by printed area. Signs and
    angles are those of the room (`homogenize.cell`).

    D is the number of directions, and W that of the waves of the corrugation.
    """

    length_mm: float  # mm, of the star's arms
    spacing_mm: float  # mm, distance of the star centres
    rest_metric: Array  # (2, 2) `F^T F` of the flat relaxed cell in print coordinates
    lam: float  # sqrt(det F), its contraction
    angles_rad: Array  # (D,) rad, directions of the tubes on the print
    natural_curvature: Array  # (D,) 1/mm of the contracted sheet: one over the radius of the mean surface
    natural_energy: Array  # (D,) N/mm
    # natural_hoop, natural_axial: (D,) stretches of the mean surface on the natural tube.
    natural_hoop: Array
    natural_axial: Array
    natural_membrane: Array  # (D, 3, 3) N/mm, tangent on the natural tube, see `linear_response`
    # (2, W) amplitudes of the corrugation, see `corrugation_waves`: in mm on the flat cell, and in mm^2 the change per
    # curvature of the contracted sheet up to the natural tubes (mean over the directions).
    relief: Array
    bending: Array  # (D,) N mm, `D = 2 (psi_0 - psi_c)/kappa_c^2`; the tangent for a slight natural curvature
    # N mm^2, `c3 = 4 (psi_0 - psi_30)/kappa_c^3`, from the natural energies at 0 and 30 degrees and their mean
    # curvature, or from the means of every second of the six directions; 0 without natural curvature and without
    # threefold symmetry of star and lattice.
    sixfold: float
    centre_offset_mm: float  # mm, star's centre over the mean surface of the flat cell
    natural_centre_offset_mm: Array  # (D,) mm, the same on the natural tubes
    # mm, star's centre over its tips on the flat cell; it may be negative, and the side of the star is that of
    # `natural_bump_mm`.
    bump_mm: float
    natural_bump_mm: Array  # (D,) mm, the same on the natural tubes
    iterations: int  # iterations of Newton's method in all solves

    def to_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return cast("dict[str, Any]", plain(asdict(self)))


def solve_cell(design: Design, edge_mm: float, angles: tuple[float, ...] | None = None) -> Sample:
    """Solve the unit cell of the design's star.

    Raises `ArithmeticError` if a part has no equilibrium. Raises `ValueError` if the stars differ, gravity is on, or
    `edge_mm` or `angles` are out of range. Raises `DesignError` or `MeshError` if arms overlap, or no mesh follows
    them.

    Parameters
    ----------
    design : its stars are equal; their sizes are numbers.
    edge_mm : of the mesh.
    angles : of the tubes, rad; by default those that a law uses (`tube_angles`).
    """
    if not 0.0 < edge_mm < math.inf:
        raise ValueError(f"edge_mm = {edge_mm}: must be above 0")
    if angles is not None and not (len(angles) and np.isfinite(angles).all()):
        raise ValueError(f"angles = {angles}: must be finite numbers, at least one")
    angles = tube_angles(design) if angles is None else angles
    responses: dict[str, Any] = {"angles_rad": np.array(angles), "iterations": 0}
    with closing(UnitCell(design, edge_mm)) as cell:
        _measure(cell, angles, responses)
    responses = symmetric_responses(responses, point_group(design.lattice), design.fabric)
    return Sample(length_mm=star_size(design, "length_mm"), spacing_mm=cell.spacing, **responses)


def _measure(cell: UnitCell, angles: tuple[float, ...], response: dict[str, Any]) -> None:
    flat = relax_flat_cell(cell)
    response["rest_metric"] = flat.deformation @ flat.deformation
    response["lam"] = flat.stretch
    response["bump_mm"] = float(flat.bump[0])
    response["centre_offset_mm"] = -mean_height(cell, flat.state)
    response["iterations"] = flat.iterations
    curves: list[TubeBranch] = []
    # else the next direction's natural tube may be another form
    alike = not differs_by_direction(cell.design)
    for angle in angles:
        curves.append(trace_tubes(cell, flat, angle, curves[-1] if alike and curves else None))
        response["iterations"] += sum(tube.iterations for tube in curves[-1].tubes)
    response |= _bending(flat, angles, curves, is_threefold(cell.design.lattice))
    ends = [curve.natural or curve.tubes[0] for curve in curves]
    offsets = np.array([heights_over_mean_surface(cell, tube)[ANCHOR] for tube in ends])
    part = np.array([curve.slight / curve.tubes[0].curvature for curve in curves])
    between = response["centre_offset_mm"] + part * (offsets - response["centre_offset_mm"])
    response["natural_centre_offset_mm"] = np.where([curve.natural is None for curve in curves], between, offsets)
    response["natural_membrane"] = np.array([tube_membrane_stiffness(cell, tube) for tube in ends])
    response["relief"] = _relief(cell, flat, ends)


def _relief(cell: UnitCell, flat: FlatCell, tubes: list[Tube]) -> Array:
    """(2, W) mm and mm^2: amplitudes on the flat cell, and their change per curvature."""
    waves = CorrugationWaves.of(cell.design.lattice)
    n = cell.mesh.n_base
    offsets = cell.printed[:n] - cell.printed[ANCHOR]
    lying = waves.amplitudes(offsets, flat.state.positions[:n, 2], cell.weights)
    rolled = waves.amplitudes(
        offsets, np.mean([heights_over_mean_surface(cell, tube) for tube in tubes], axis=0), cell.weights
    )
    return np.array([lying, (rolled - lying) / np.mean([tube.contracted_curvature for tube in tubes])])


def _bending(flat: FlatCell, angles: tuple[float, ...], curves: list[TubeBranch], threefold: bool) -> dict[str, Any]:
    """Responses of the tubes."""
    ends = [curve.natural or curve.tubes[0] for curve in curves]
    hoop = np.array([tube.hoop for tube in ends])
    printed = np.array([curve.natural.curvature if curve.natural else curve.slight for curve in curves])
    curvature = printed / hoop
    energy = np.array(
        [
            curve.natural.energy - flat.energy if curve.natural else -0.5 * curve.stiffness * curve.slight**2
            for curve in curves
        ]
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        secant = -2.0 * energy / curvature**2
    tangent = np.array([curve.stiffness for curve in curves]) * hoop**2
    bending = np.where([curve.natural is None for curve in curves], tangent, secant)
    chosen = averaged_directions(curves) if angles == ALL_ANGLES_RAD else [0, -1]
    mean, (even, odd) = curvature[chosen].mean(), (energy[chosen[part::2]].mean() for part in (0, 1))
    sixfold = float(4.0 * (even - odd) / mean**3) if threefold and mean else 0.0
    return {
        "natural_curvature": curvature,
        "natural_energy": energy,
        "natural_hoop": hoop,
        "natural_axial": np.array([tube.axial for tube in ends]),
        "natural_bump_mm": np.array([tube.bump[0] for tube in ends]),
        "bending": bending,
        "sixfold": sixfold,
    }


def symmetric_responses(responses: dict[str, Any], group: Floats, fabric: Fabric) -> dict[str, Any]:
    """Responses of `homogenize.cell.sample.Sample` with the symmetry of the point group (G, 2, 2).

    Elements that the fabric does not share are left out.
    """
    group = group[fabric.keeps(group)]
    out = dict(responses)
    turns = np.array([voigt_turn(element.T) for element in group])
    metric = (group @ responses["rest_metric"] @ group.transpose(0, 2, 1)).mean(axis=0)
    if np.abs(metric - responses["rest_metric"]).max() > RESPONSE_TOLERANCE * np.abs(metric).max():
        out["rest_metric"] = metric
    source, element = _lowest_of_equals(responses["angles_rad"], responses["natural_energy"], group)
    for name in SCALAR_KEYS:
        out[name] = np.asarray(responses[name])[source]
    turned = turns[element]
    out["natural_membrane"] = turned.transpose(0, 2, 1) @ np.asarray(responses["natural_membrane"])[source] @ turned
    return out


def _lowest_of_equals(angles: Array, energy: Array, group: Floats) -> tuple[Ints, Ints]:
    """(D,) direction of lowest energy among those equal to each direction, and element that takes it back to that.

    A direction without equal ones is its own source, by the identity.
    """
    directions = np.column_stack([-np.sin(angles), np.cos(angles)])
    source, element = np.arange(len(angles)), np.zeros(len(angles), dtype=np.int64)
    moved = np.einsum("gij,dj->gdi", group, directions)
    for target, direction in enumerate(directions):
        parallel = np.abs(moved[..., 0] * direction[1] - moved[..., 1] * direction[0]) < 1e-6  # rad
        elements, equals = np.nonzero(parallel)
        best = equals[np.argmin(energy[equals])]
        if energy[best] < energy[target] - RESPONSE_TOLERANCE * abs(energy[target]):
            source[target], element[target] = best, elements[equals == best][0]
    return source, element
