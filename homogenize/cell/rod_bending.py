"""Bending of the rods of a motif alone, in closed form: what tubes of the cell cannot tell.

The energy of a tube has no term of the Gaussian curvature det K. So tubes give the entries of the bending stiffness up
to a multiple of det K: Q12 may grow by c while Q33 falls by c/2. In a sheet of rods on a surface of the curvature b, a
rod of direction t bends by `t . b t` and twists by `t . b n`. Rods bonded at points, in fabric too soft to count, take
the stiffness `B (t . b t)^2 + T (t . b n)^2` per length each, which has all entries.
"""

from __future__ import annotations

import numpy as np

from asterism.discrete.energies.rods.network import torsion_constant
from asterism.equilibrium.arrays import Floats
from asterism.homogenize.law.anisotropy import mean_q12
from asterism.pattern.design.design import Design
from asterism.pattern.rods.motif_graph import motif_graph

# second derivative of det K
GAUSSIAN: Floats = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -0.5]])


def completed_by_rods(stiffness: Floats, rods: Floats) -> Floats:
    """(3, 3) N mm, a stiffness that is known up to a multiple of det K, with the mean of Q12 over all axes of the rods.

    Examples
    --------
    >>> rods = np.diag([14.7, 14.7, 8.9])
    >>> completed_by_rods(rods - 39.0 * GAUSSIAN, rods).round(6) + 0.0
    array([[14.7,  0. ,  0. ],
           [ 0. , 14.7,  0. ],
           [ 0. ,  0. ,  8.9]])
    """
    return np.asarray(stiffness + (mean_q12(rods) - mean_q12(stiffness)) * GAUSSIAN)


def rod_bending(design: Design, deformation: Floats) -> Floats:
    """(3, 3) N mm, bending stiffness of a motif's rods per printed area, for curvatures 11, 22 and 2 x 12 of the print.

    Parameters
    ----------
    design : with a motif alone.
    deformation : (2, 2) F of the flat sheet: the print's curvature K is `F^T b F`.

    Raises
    ------
    DesignError
        See `motif_graph`.

    Examples
    --------
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
