"""Axial stretch of rod edges: `W = EA/2 l (|e|/l - 1)^2`, with edge vector e and printed length l.

Each edge counts once, also where the stencils of a junction share it (Bergou et al. 2010).
"""

from __future__ import annotations

import numpy as np

from asterism.discrete.energies.elements import Elements
from asterism.discrete.energies.kernel import dot, formula, multiply, point, sub, sweep


@formula
def stretch_energy(q, p):  # type: ignore[no-untyped-def]
    """`EA/2 l (|e|/l - 1)^2` in N mm; q = (x0, x1), p = (EA, l)."""
    e = sub(point(q, 1), point(q, 0))
    strain = np.sqrt(dot(e, e)) / p[1] - 1.0
    return 0.5 * p[0] * p[1] * strain * strain


@formula
def stretch_gradient(q, p, g):  # type: ignore[no-untyped-def]
    """Axial force `EA (|e|/l - 1)` along the edge."""
    e = sub(point(q, 1), point(q, 0))
    length = np.sqrt(dot(e, e))
    force = p[0] * (length / p[1] - 1.0) / length
    for k in range(3):
        g[k] = -force * e[k]
        g[3 + k] = force * e[k]


@formula
def stretch_hessian(q, p, blend, h):  # type: ignore[no-untyped-def]
    """Axial stiffness `EA/l` along the edge and geometric stiffness `force/|e|` across it.

    The geometric stiffness is negative in compression; `blend` reduces its negative part to zero.
    """
    e = sub(point(q, 1), point(q, 0))
    length = np.sqrt(dot(e, e))
    t = multiply(1.0 / length, e)
    across = p[0] * (1.0 / p[1] - 1.0 / length)
    across = across - blend * np.minimum(across, 0.0)
    along = p[0] / p[1] - across
    for r in range(3):
        for c in range(3):
            value = along * t[r] * t[c]
            if r == c:
                value = value + across
            h[r, c] = value
            h[3 + r, 3 + c] = value
            h[3 + r, c] = -value


class RodStretch(Elements):
    """Axial stretch of rod edges.

    Parameters
    ----------
    inputs, dofs : (R, 6) coordinates of the two vertices.
    params : (R, 2) axial stiffness EA (N) and printed length l (mm).

    Examples
    --------
    An edge of 10 mm with EA = 100 N, stretched by 1 %, stores `EA/2 l strain^2`:

    >>> edge = np.arange(6)[None]
    >>> rod = RodStretch(edge, edge, np.array([[100.0, 10.0]]))
    >>> rod.energies(np.array([0, 0, 0, 10.1, 0, 0])).round(6)
    array([0.05])
    >>> round(float(rod.gradients(np.array([0, 0, 0, 10.1, 0, 0]))[0, 3]), 6)  # axial force, N
    1.0
    """

    formulas = (stretch_energy, stretch_gradient, stretch_hessian)
    sweep = staticmethod(sweep(6, 6, *formulas))
