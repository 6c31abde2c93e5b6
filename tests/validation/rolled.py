"""An endless sheet that rolls up, as a curve: the reference for the middle of a long one.

Every section across the sheet is the same, turned about an axis. With the radius r(y), the place z(y) along the axis
and the turn w per length, `a = ((w r)^2, r'^2 + z'^2)` and `b = (w^2 r z', z'' r' - r'' z') / |(r', z')|`. The energy
of a Koiter shell is a sum of squares in them: B-splines and least squares find its minimum.
"""

import numpy as np
from scipy.interpolate import BSpline
from scipy.optimize import least_squares

DEGREE = 5


def turn(thickness: float, poisson: float, curvature: float, width: float, spans: int = 24) -> float:
    """Turn per length of an endless free sheet with an isotropic rest curvature; its modulus does not matter."""
    breaks = 0.5 * width * (1.0 - (1.0 - np.linspace(0.0, 1.0, spans + 1)) ** 2)
    knots = np.r_[[breaks[0]] * DEGREE, breaks, [breaks[-1]] * DEGREE]
    count = len(knots) - DEGREE - 1
    spline = BSpline(knots, np.eye(count), DEGREE)
    roots, shares = np.polynomial.legendre.leggauss(7)
    y = (breaks[:-1, None] + 0.5 * np.diff(breaks)[:, None] * (roots + 1.0)).ravel()
    weight = np.sqrt(0.5 * np.diff(breaks)[:, None] * shares).ravel()
    zeroth, first, second = spline(y), spline.derivative(1)(y), spline.derivative(2)(y)
    middle = spline.derivative(1)(0.0), spline(0.0)
    law = np.linalg.cholesky(np.array([[1.0, poisson], [poisson, 1.0]])).T

    def residuals(q: np.ndarray) -> np.ndarray:
        w, r, z = q[0], q[1 : count + 1], q[count + 1 :]
        radius, r1, r2, z1, z2 = zeroth @ r, first @ r, second @ r, first @ z, second @ z
        length = np.hypot(r1, z1)
        strain = 0.5 * np.stack([(w * radius) ** 2 - 1.0, length**2 - 1.0])
        bend = np.stack([w**2 * radius * z1, z2 * r1 - r2 * z1]) / length - curvature
        # symmetric about its middle, which stays where it is
        held = [middle[0] @ r, middle[1] @ z]
        return np.concatenate(
            [(weight * (law @ strain)).ravel(), thickness / np.sqrt(12) * (weight * (law @ bend)).ravel(), held]
        )

    start = curvature * (1.0 + poisson)
    greville = np.array([knots[i + 1 : i + DEGREE + 1].mean() for i in range(count)])
    q = np.r_[start, np.full(count, 1.0 / start), greville]
    found = least_squares(residuals, q, xtol=1e-14, ftol=1e-14, gtol=1e-14)
    return float(found.x[0])
