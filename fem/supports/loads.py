"""Dead loads: forces that keep size and direction while the sheet moves.

Forces F (N, 3) in N act on the dofs of a space, `F_i = int f phi_i`. The potential at positions x is `-sum(F * x)`, and
its Hessian is zero. Densities are per printed area, so the total force is constant.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from asterism.equilibrium.arrays import Floats
from asterism.fem.elements.argyris import Argyris
from asterism.fem.elements.monomials import DEGREE


def area_load(space: Argyris, force: ArrayLike | Callable[[Floats], Floats]) -> Floats:
    """(N, 3) N, dead load of a force per printed area.

    Parameters
    ----------
    force : N/mm^2, (3,) or a function of printed points (n, 2) mm to (n, 3). Gravity is (0, 0, -weight per area).

    Examples
    --------
    A plate of 1 mm^2 that weighs 2 N; the sum over the dofs that are positions is the weight:

    >>> from skfem import MeshTri
    >>> space = Argyris(MeshTri())
    >>> area_load(space, (0.0, 0.0, -2.0))[space.vertex_dofs[:, 0]].sum(axis=0).round(6) + 0.0
    array([ 0.,  0., -2.])
    """
    table = space.tabulate(2 * DEGREE)
    values = np.asarray(force(table.points.reshape(-1, 2)) if callable(force) else force, dtype=float)
    at = np.broadcast_to(values, (table.weights.size, 3)).reshape(*table.weights.shape, 3)
    loads = np.zeros((space.size, 3))
    np.add.at(loads, table.dofs, np.einsum("tq,tqm,tqr->tmr", table.weights, table.values, at))
    return loads
