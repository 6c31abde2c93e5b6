"""The bending of a motif's sheet: from its natural tubes, and from its rods where tubes cannot tell."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.cell.motif_responses import MotifResponses
from asterism.homogenize.cell.rod_bending import completed_by_rods
from asterism.homogenize.law.anisotropy import VOIGT_ENTRIES, voigt_matrices

# of the largest bending stiffness, at least
MIN_STIFFNESS_RATIO = 0.01


def bending_of_tubes(responses: MotifResponses) -> tuple[Floats, Floats]:
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
