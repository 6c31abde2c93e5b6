"""What all strips of a kind have in common, beyond the formula: a thickness that is not what the table says.

The mean of a kind is off by a random effect (Laird and Ware, Biometrics 38, 1982): with its fabric by a part of the
curvature that the fabric gives, `a kappa_fabric`, and peeled by `b`. As readings of a kind have one mean, the effect
does to the fit what larger variances of its readings would: `c = 1 + V sum(1 / variance)` times as large for an effect
of the variance V.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pattern.geometry.arrays import Floats, Ints


@dataclass(frozen=True)
class KindEffects:
    """Standard deviations of what kinds have in common.

    Attributes
    ----------
    with_fabric : a part of the curvature by the fabric.
    peeled : 1/mm.
    """

    with_fabric: float = 0.0
    peeled: float = 0.0

    def variance(self, sizes: Floats) -> Floats:
        """(n,) 1/mm^2 of readings; `sizes` (2, n) from `effects`."""
        return np.asarray((self.with_fabric * sizes[0]) ** 2 + (self.peeled * sizes[1]) ** 2)


def effect_sizes(by_fabric: Floats, peeled: np.ndarray) -> Floats:
    """(2, n) what the two effects do to a reading: 1/mm by the fabric (n,), and one."""
    return np.array([np.where(peeled, 0.0, by_fabric), np.where(peeled, 1.0, 0.0)])


def variance_factor(kind: Ints, variance: Floats, shared: Floats) -> Floats:
    """(n,) factor `c` by which variances (n,) stand for a shared error of variance `shared` (n,), too."""
    return 1.0 + shared * np.bincount(kind, 1.0 / variance)[kind]


def fit_kind_effects(
    kind: Ints, residual: Floats, jacobian: Floats, variance: Floats, alike: Floats, sizes: Floats, start: KindEffects
) -> KindEffects:
    """The most likely effects for readings (n,) about a fit of jacobian (n, p).

    Restricted maximum likelihood, as for the noise. An effect that the others' kinds do not tell from the parameters is
    taken for 0.

    Parameters
    ----------
    variance : of the readings, 1/mm^2.
    alike : 1/mm, by which a ruler's marks may move a whole kind.
    sizes : (2, n) from `effects`.
    """
    _, first, count = np.unique(kind, return_index=True, return_counts=True)
    information = np.bincount(kind, 1.0 / variance)
    middle = np.bincount(kind, residual / variance) / information
    known = 1.0 / information + np.bincount(kind, alike**2) / count
    of_kind, size = jacobian[first], sizes[:, first]
    found = [start.with_fabric, start.peeled]
    for which in (0, 1):
        mine = size[which] != 0
        rest = np.linalg.matrix_rank(_equal_columns(of_kind[~mine])) if (~mine).any() else 0
        if mine.sum() - (jacobian.shape[1] - rest) < 1:
            found[which] = 0.0
            continue
        others = known + (found[1 - which] * size[1 - which]) ** 2
        found[which] = _most_likely(middle, of_kind, others, size[which])
    return KindEffects(*found)


def _most_likely(middle: Floats, jacobian: Floats, variance: Floats, size: Floats) -> float:
    """Standard deviation of an effect on kinds (g,), whose means have other errors of this variance."""
    columns = _equal_columns(jacobian)

    def minus_log(effect: Floats) -> Floats:
        """(m,) for as many effects; the parameters go along."""
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
    # the lowest point of the parabola through the last three
    left, here, right = values[best - 1 : best + 2]
    bend = left - 2 * here + right
    turn = 0.5 * (left - right) / bend if bend > 0 else 0.0
    effect = float(np.exp(last[1] + np.clip(turn, -1.0, 1.0) * (last[1] - last[0])))
    with_it, without = minus_log(np.array([effect, 0.0]))
    return effect if with_it < without else 0.0


def _equal_columns(rows: Floats) -> Floats:
    return np.asarray(rows / np.maximum(np.linalg.norm(rows, axis=0), 1e-300))
