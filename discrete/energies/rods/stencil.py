"""Two rod edges that meet: the stencil of bending and twist (discrete elastic rods, Bergou et al. 2008, 2010).

A rod edge carries one director, the plastic normal `n` (+z as printed); its width direction is `b = n x t`, so
(t, b, n) is right-handed and turning the edge around (t -> -t) leaves n as it is. The configuration holds
positions and directors, and a dof `theta` turns an edge's director about its tangent. Derivatives by positions
carry the directors along by parallel transport (time-parallel frames).

A stencil is two edges that meet: (x0, x1, x2). Its curvatures are the integrated ones,
`k_b = kb . (b0 + b1)/2` about the width (positive: tips down, away from the plastic side) and `k_n` in the plane of
the sheet, with `kb = 2 t0 x t1/(1 + t0 . t1)`. `L = l0 + l1` is the sum of the printed edge lengths.
"""

from __future__ import annotations

import numpy as np

from discrete.energies.kernel import dot, formula, multiply, point, sub


@formula
def stencil_edges(q):  # type: ignore[no-untyped-def]
    """Tangents and lengths of a stencil's two edges and 1 + t0 . t1."""
    e, f = sub(point(q, 1), point(q, 0)), sub(point(q, 2), point(q, 1))
    le, lf = np.sqrt(dot(e, e)), np.sqrt(dot(f, f))
    te, tf = multiply(1.0 / le, e), multiply(1.0 / lf, f)
    return te, tf, le, lf, 1.0 + dot(te, tf)
