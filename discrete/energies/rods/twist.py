"""Twist of rods: `W = GJ (m - m0)^2/L`, m the angle between the directors of two edges (Bergou et al. 2008, 2010).

The angle is measured after parallel transport of the first director to the second edge, so states need no history.
See `discrete.energies.rods.bend` for the frame and the symbols.
"""

from __future__ import annotations

import numpy as np

from asterism.discrete.energies.elements import Elements
from asterism.discrete.energies.kernel import combine, cross, dot, formula, multiply, point, sweep
from asterism.discrete.energies.rods.bend import stencil_edges


@formula
def _twist(te, tf, chi, n0, n1):  # type: ignore[no-untyped-def]
    """Twist angle m: from the first director, transported parallel to the second edge, to the second director."""
    transported = combine(1.0, n0, -dot(n0, tf) / chi, combine(1.0, te, 1.0, tf))
    return 2.0 * np.arctan(dot(cross(transported, n1), tf) / (1.0 + dot(transported, n1)))


@formula
def twist_energy(q, p):  # type: ignore[no-untyped-def]
    """`GJ (m - m0)^2/L` in N mm; p = (GJ/L, sign0, sign1, m0)."""
    te, tf, _, _, chi = stencil_edges(q)
    m = _twist(te, tf, chi, point(q, 3), point(q, 4)) - p[3]
    return p[0] * m * m


@formula
def twist_gradient(q, p, g):  # type: ignore[no-untyped-def]
    """`2 GJ/L (m - m0) dm` with `dm = kb/2 . (de/|e| + df/|f|) - dtheta0 + dtheta1` (Bergou et al. 2010)."""
    te, tf, le, lf, chi = stencil_edges(q)
    moment = 2.0 * p[0] * (_twist(te, tf, chi, point(q, 3), point(q, 4)) - p[3])
    kb = multiply(moment / chi, cross(te, tf))
    for i in range(3):
        g[i] = -kb[i] / le
        g[3 + i] = kb[i] / le - kb[i] / lf
        g[6 + i] = kb[i] / lf
    g[9] = -p[1] * moment
    g[10] = p[2] * moment


@formula
def twist_hessian(q, p, blend, h):  # type: ignore[no-untyped-def]
    """`2 GJ/L (dm dm^T + (1 - blend) (m - m0) d2m)`, the symmetric part (Bergou et al. 2010)."""
    te, tf, le, lf, chi = stencil_edges(q)
    m = _twist(te, tf, chi, point(q, 3), point(q, 4)) - p[3]
    kb = multiply(2.0 / chi, cross(te, tf))
    t = combine(1.0 / chi, te, 1.0 / chi, tf)
    d = np.zeros_like(h[0])
    for i in range(3):
        d[i] = -0.5 * kb[i] / le
        d[3 + i] = 0.5 * kb[i] / le - 0.5 * kb[i] / lf
        d[6 + i] = 0.5 * kb[i] / lf
    d[9] = d[9] - p[1]
    d[10] = d[10] + p[2]
    for i in range(11):
        for j in range(i + 1):
            h[i, j] = 2.0 * p[0] * d[i] * d[j]
    scale = 2.0 * (1.0 - blend) * p[0] * m
    at_e, at_f = combine(1.0, te, 1.0, t), combine(1.0, tf, 1.0, t)
    # antisymmetric matrix of the first tangent, [te]x
    spin = ((0.0 * m, -te[2], te[1]), (te[2], 0.0 * m, -te[0]), (-te[1], te[0], 0.0 * m))
    for r in range(3):
        for c in range(3):
            ee = -0.25 * scale / (le * le) * (kb[r] * at_e[c] + at_e[r] * kb[c])
            ff = -0.25 * scale / (lf * lf) * (kb[r] * at_f[c] + at_f[r] * kb[c])
            ef = 0.5 * scale / (le * lf) * (2.0 / chi * spin[r][c] - kb[r] * t[c])
            fe = 0.5 * scale / (le * lf) * (2.0 / chi * spin[c][r] - kb[c] * t[r])
            h[r, c] += ee
            h[3 + r, c] += fe - ee
            h[3 + r, 3 + c] += ee - ef - fe + ff
            h[6 + r, c] -= fe
            h[6 + r, 3 + c] += fe - ff
            h[6 + r, 6 + c] += ff


class RodTwist(Elements):
    """Twist of rod stencils.

    Parameters
    ----------
    inputs : (S, 15) coordinates of three vertices and two directors, see `stencil_inputs`.
    dofs : (S, 11) coordinates of three vertices and two twists.
    params : (S, 4) GJ/L (N mm), the signs of the two edges: -1 if the stencil runs against the edge, and the rest
        twist m0 (rad).

    Examples
    --------
    Two edges in a line, the second director rotated by 0.1 rad, GJ/L = 5 N mm:

    >>> points, directors = [0, 0, 0, 1, 0, 0, 2, 0, 0], [0, 0, 1, 0, -np.sin(0.1), np.cos(0.1)]
    >>> rod = RodTwist(np.arange(15)[None], np.arange(11)[None], np.array([[5.0, 1.0, 1.0, 0.0]]))
    >>> rod.energies(np.array([*points, *directors])).round(6)
    array([0.05])
    """

    formulas = (twist_energy, twist_gradient, twist_hessian)
    sweep = staticmethod(sweep(15, 11, *formulas))
