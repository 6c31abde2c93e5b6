"""The stencil of bending and twist: two rod edges that meet (discrete elastic rods, Bergou et al. 2008, 2010).

Frame. A rod edge has a tangent t and one director n, the normal on the plastic side (+z as printed). The direction of
the width is `b = n x t`, so (t, b, n) is right-handed, and reversing the edge (t -> -t) keeps n. A state holds
positions and directors. The dof `theta` of an edge rotates its director about the tangent. Derivatives by positions
carry the directors along by parallel transport (time-parallel frames, Bergou et al. 2010).

Curvatures. A stencil has vertices (x0, x1, x2) and the curvature binormal `kb = 2 t0 x t1/(1 + t0 . t1)`. Its
integrated curvatures are `k_b = kb . (b0 + b1)/2` about the width (positive: the tips bend down, away from the plastic
side) and `k_n = kb . (n0 + n1)/2` in the plane of the sheet. `L = l0 + l1` is the printed length of both edges.

In the formulas, te, tf are the tangents of the first and second edge, le, lf their lengths, and `chi = 1 + te . tf`.
"""

from __future__ import annotations

import numpy as np

from asterism.discrete.energies.kernel import dot, formula, multiply, point, sub


@formula
def stencil_edges(q):  # type: ignore[no-untyped-def]
    """Tangents and lengths of the two edges of a stencil, and `chi = 1 + te . tf`."""
    e, f = sub(point(q, 1), point(q, 0)), sub(point(q, 2), point(q, 1))
    le, lf = np.sqrt(dot(e, e)), np.sqrt(dot(f, f))
    te, tf = multiply(1.0 / le, e), multiply(1.0 / lf, f)
    return te, tf, le, lf, 1.0 + dot(te, tf)
