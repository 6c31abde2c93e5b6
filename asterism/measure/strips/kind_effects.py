"""Random effects of the kinds of strips: errors that all strips of a kind share, such as that of their thickness.

The mean of a kind deviates by a random effect (Laird and Ware, Biometrics 38, 1982): with fabric by a part of the
curvature from the fabric, `a kappa_fabric`, and peeled by `b`. All readings of a kind have one mean, so that the effect
acts on the fit like larger variances of the readings: the factor is `c = 1 + V sum(1 / variance)` for an effect of
variance V.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints


@dataclass(frozen=True)
class KindEffects:
    """Standard deviations of the random effects of kinds.

    Attributes
    ----------
    with_fabric : effect on strips with fabric, as a part of the curvature from the fabric.
    peeled : 1/mm, effect on peeled strips.
    """

    with_fabric: float = 0.0
    peeled: float = 0.0

    def variance(self, sizes: Floats) -> Floats:
        """(n,) 1/mm^2, variance of the effects in the readings; `sizes` (2, n) from `effects`."""
        return np.asarray((self.with_fabric * sizes[0]) ** 2 + (self.peeled * sizes[1]) ** 2)


def effect_sizes(by_fabric: Floats, peeled: np.ndarray) -> Floats:
    """(2, n) derivatives of the readings by the two effects: curvature from the fabric (n,) in 1/mm, and 1."""
    return np.array([np.where(peeled, 0.0, by_fabric), np.where(peeled, 1.0, 0.0)])


def variance_factor(kind: Ints, variance: Floats, shared: Floats) -> Floats:
    """(n,) factors `c` of the variances (n,) that replace a shared error of variance `shared` (n,)."""
    return 1.0 + shared * np.bincount(kind, 1.0 / variance)[kind]


def fit_kind_effects(
    kind: Ints, residual: Floats, jacobian: Floats, variance: Floats, alike: Floats, sizes: Floats, start: KindEffects
) -> KindEffects:
    """The most likely effects for readings (n,) about a fit of jacobian (n, p).

    Restricted maximum likelihood, as for the noise. An effect is 0 if the kinds do not distinguish it from the
    parameters.

    Parameters
    ----------
    variance : (n,) 1/mm^2, variances of the readings.
    alike : (n,) 1/mm, error of rounding that all readings of a kind share.
    sizes : (2, n) from `effects`.
    """
    _, first, count = np.unique(kind, return_index=True, return_counts=True)
    information = np.bincount(kind, 1.0 / variance)
    middle = np.bincount(kind, residual / variance) / information
    known = 1.0 / information + np.bincount(kind, alike**2) / count
    of_kind, size = jacobian[first], sizes[:, first]
    variances = [start.with_fabric, start.peeled]
    for which in (0, 1):
        mine = size[which] != 0
        rest = np.linalg.matrix_rank(_equal_columns(of_kind[~mine])) if (~mine).any() else 0
        if mine.sum() - (jacobian.shape[1] - rest) < 1:
            variances[which] = 0.0
            continue
        others = known + (variances[1 - which] * size[1 - which]) ** 2
        variances[which] = _most_likely(middle, of_kind, others, size[which])
    return KindEffects(*variances)


def _most_likely(middle: Floats, jacobian: Floats, variance: Floats, size: Floats) -> float:
    """Standard deviation of an effect on kinds (g,), whose means have other errors of these variances."""
    columns = _equal_columns(jacobian)

    def minus_log(effect: Floats) -> Floats:
        """(m,) minus log likelihoods of effects (m,), each with its best parameters."""
        root = 1.0 / np.sqrt(variance + (effect[:, None] * size) ** 2)
        rows, off = root[..., None] * columns, root * middle
        information, slope = np.einsum("mgp,mgq->mpq", rows, rows), np.einsum("mgp,mg->mp", rows, off)
        step = np.linalg.solve(information, slope[..., None])[..., 0]
        squares = np.sum(off**2, axis=1) - np.sum(step * slope, axis=1)
        return np.asarray(squares - 2 * np.sum(np.log(root), axis=1) + np.linalg.slogdet(information)[1])

    mine = size != 0
    most = 10.0 * float(np.max(np.abs(middle[mine] / size[mine])))
    least = 0.01 * float(np.sqrt(np.min(variance[mine] / size[mine] ** 2)))
    if most <= least:
        return 0.0
    logs = np.linspace(np.log(least), np.log(most), 33)
    for _ in range(4):
        values = minus_log(np.exp(logs))
        best = min(max(int(np.argmin(values)), 1), len(logs) - 2)
        last, logs = logs[best - 1 : best + 2], np.linspace(logs[best - 1], logs[best + 1], 17)
    # minimum of the parabola through the last three points
    left, here, right = values[best - 1 : best + 2]
    bend = left - 2 * here + right
    turn = 0.5 * (left - right) / bend if bend > 0 else 0.0
    effect = float(np.exp(last[1] + np.clip(turn, -1.0, 1.0) * (last[1] - last[0])))
    with_it, without = minus_log(np.array([effect, 0.0]))
    return effect if with_it < without else 0.0


def _equal_columns(rows: Floats) -> Floats:
    return np.asarray(rows / np.maximum(np.linalg.norm(rows, axis=0), 1e-300))
