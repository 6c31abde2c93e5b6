"""Slopes at the nodes of a table, from its values: rules that are local, and exact for straight lines.

scipy has interpolators with these slopes (`PchipInterpolator`, `Akima1DInterpolator`), but their import takes half a
second, which every preview would pay. The tests compare the slopes with scipy's.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from equilibrium.arrays import Floats

SlopeRule = Literal["monotone", "smooth"]
# relative weights of both sides below this are rounding errors: the values around the node lie on a line
MIN_RELATIVE_WEIGHT = 1e-9


def node_slopes(nodes: Floats, values: Floats, axis: int, rule: SlopeRule) -> Floats:
    """Slopes of functions at their nodes along one axis.

    Parameters
    ----------
    nodes : (n,) increasing, at least two.
    values : values of the functions, n along the axis.
    axis : the axis along which the nodes lie.
    rule : "monotone" takes the slopes of Fritsch and Butland (1984) with the ends of Moler (Numerical Computing with
        MATLAB, 2004, section 3.6): the cubics between the nodes are monotone where the values are. "smooth" takes
        those of the modified Akima spline (Akima 1970; Moler and Ionita 2019).

    Returns
    -------
    Array of the shape of `values`.

    Examples
    --------
    >>> node_slopes(np.array([0.0, 1.0, 2.0]), np.array([0.0, 1.0, 4.0]), 0, "smooth")
    array([0., 2., 4.])
    """
    values = np.moveaxis(values, axis, 0)
    steps = np.diff(nodes).reshape(-1, *[1] * (values.ndim - 1))
    secants = np.diff(values, axis=0) / steps
    if len(secants) == 1:
        slopes = np.concatenate([secants, secants])
    elif rule == "monotone":
        slopes = _monotone(steps, secants)
    elif len(secants) == 2:  # the parabola through the three nodes
        slopes = np.asarray(np.gradient(values, nodes, axis=0, edge_order=2))
    else:
        slopes = _smooth(secants)
    return np.moveaxis(slopes, 0, axis)


def _monotone(steps: Floats, secants: Floats) -> Floats:
    """Inside, the weighted harmonic mean of both secants, and 0 where they have no common sign."""
    before, after = 2 * steps[1:] + steps[:-1], steps[1:] + 2 * steps[:-1]
    agree = secants[1:] * secants[:-1] > 0
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        mean = (before + after) / (before / secants[:-1] + after / secants[1:])
    inside = np.where(agree, mean, 0.0)
    first = _at_end(steps[0], steps[1], secants[0], secants[1])
    last = _at_end(steps[-1], steps[-2], secants[-1], secants[-2])
    return np.concatenate([first[None], inside, last[None]])


def _at_end(step: Floats, next_step: Floats, secant: Floats, next_secant: Floats) -> Floats:
    """The parabola through three nodes, bounded so that the first cubic keeps the shape of the values."""
    slope = ((2 * step + next_step) * secant - step * next_secant) / (step + next_step)
    turns = np.sign(secant) != np.sign(next_secant)
    slope = np.where(turns & (np.abs(slope) > 3 * np.abs(secant)), 3 * secant, slope)
    return np.where(np.sign(slope) != np.sign(secant), 0.0, slope)


def _smooth(secants: Floats) -> Floats:
    """Mean of both secants at a node: the side on which the slope changes less weighs more."""
    left, right = 2 * secants[0] - secants[1], 2 * secants[-1] - secants[-2]
    left, right = [2 * left - secants[0], left], [right, 2 * right - secants[-1]]
    m = np.concatenate([left, secants, right])
    change = np.abs(np.diff(m, axis=0)) + np.abs(m[1:] + m[:-1]) / 2
    before, after = change[2:], change[:-2]  # weights of the secants before and after a node
    total = before + after
    known = total > MIN_RELATIVE_WEIGHT * total.max()
    share = np.where(known, after, 0.0) / np.where(known, total, 1.0)
    return np.where(known, m[1:-2] + share * (m[2:-1] - m[1:-2]), (m[3:] + m[:-3]) / 2)
