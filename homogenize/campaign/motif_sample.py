"""The responses of the cell of a motif as plain data, and as the tensors of its sheet."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.cell.effective_stiffness import EffectiveStiffness
from asterism.homogenize.cell.motif_responses import CellComparison, MotifResponses, RolledDirection
from asterism.homogenize.cell.rod_bending import completed_by_rods
from asterism.homogenize.law.anisotropy import VOIGT_ENTRIES, voigt_matrices
from asterism.homogenize.law.tensor_forms import TO_VOIGT, SheetTensors

# of the largest bending stiffness, at least
MIN_STIFFNESS_RATIO = 0.01


def responses_to_data(responses: MotifResponses) -> dict[str, Any]:
    """Plain data for JSON; the inverse of `responses_from_data`."""
    return {name: _plain(value) for name, value in asdict(responses).items()}


def responses_from_data(data: dict[str, Any]) -> MotifResponses:
    """Responses from plain data."""
    linear, comparison = data["linear"], data["comparison"]
    stretches = {name: np.array(comparison[name]) for name in ("stretches", "larger_stretches")}
    return MotifResponses(
        np.array(data["deformation"]),
        EffectiveStiffness(np.array(linear["stiffness"]), np.array(linear["moment"])),
        np.array(data["rods"]),
        tuple(RolledDirection(**each) for each in data["directions"]),
        tuple((float(angle), str(reason)) for angle, reason in data["failed"]),
        CellComparison(**(comparison | stretches)),
        data["spacing_mm"],
        data["vertices"],
    )


def motif_tensors(responses: MotifResponses) -> SheetTensors:
    """The tensors (n = 1) of a sheet: metric and membrane of the flat cell, and the bending of its natural tubes."""
    stiffness = np.zeros((6, 6))
    membrane = responses.linear.stiffness[:3, :3]
    stiffness[:3, :3] = 0.5 * (membrane + membrane.T)
    stiffness[3:, 3:], moment = _bending_of_tubes(responses)
    metric = responses.deformation @ responses.deformation
    # plastic outside: edges go down
    curvature = -np.linalg.solve(stiffness[3:, 3:], moment) / TO_VOIGT
    return SheetTensors(np.array([[metric[0, 0], metric[1, 1], metric[0, 1]]]), stiffness[None], curvature[None])


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, dict):
        return {name: _plain(each) for name, each in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    return value


def _bending_of_tubes(responses: MotifResponses) -> tuple[Floats, Floats]:
    """Q (3, 3) N mm and m (3,) N, in curvatures K of the print: the energy `K . Q K/2 - m . K` nearest to the tubes.

    Tubes leave Q12 open up to Q33 (`homogenize.cell.rod_bending`): the mean of Q12 over all axes is that of the rods.
    The linear cell does not know it either: see `homogenize.cell.effective_stiffness`.
    """
    angle = np.array([tube.direction_rad for tube in responses.directions])
    along = np.stack([np.cos(angle) ** 2, np.sin(angle) ** 2, np.sin(2.0 * angle)], axis=-1)
    hoop = np.array([tube.hoop for tube in responses.directions])
    curvature = np.array([tube.curvature for tube in responses.directions]) * hoop**2
    bending = np.array([tube.bending for tube in responses.directions]) / hoop**4
    pairs = np.array([along[:, i] * along[:, j] * (1.0 if i == j else 2.0) for i, j in VOIGT_ENTRIES]).T
    of_tubes = voigt_matrices(np.linalg.lstsq(pairs, bending, rcond=None)[0])
    sizes, axes = np.linalg.eigh(completed_by_rods(of_tubes, responses.rods))
    q = (axes * np.maximum(sizes, MIN_STIFFNESS_RATIO * sizes.max())) @ axes.T
    moment = np.linalg.lstsq(along, bending * curvature, rcond=None)[0]
    return q, moment
