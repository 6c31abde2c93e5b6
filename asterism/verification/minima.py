"""The shapes of a design: which exact one is the result, whether two are one minimum, and whether of one form."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from asterism.discrete.release.forms import SAME_FORM_PERCENT
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.symmetries import Symmetry
from asterism.results.records.verification import DifferenceRecord
from asterism.shape.cell_mean import CellMean
from asterism.shape.comparison import Comparison, compare_shapes
from asterism.shape.shape import Shape

# another mesh may exchange the order of two minima whose energies differ by at most this part of the elastic energy
MIN_CERTAIN_GAP = 0.005


def same_energy(one: float, other: float) -> bool:
    """Whether the energies (N mm) of two minima are equal up to the accuracy of the solver.

    Examples
    --------
    >>> same_energy(1808.98, 1808.9801), same_energy(1808.98, 1809.98)
    (True, False)
    """
    # two minima are equal if their energies differ by at most this part
    return abs(one - other) <= 1e-6 * abs(one)


def gap(one: Mapping[str, Any], other: Mapping[str, Any]) -> float:
    """Difference of the energies of two summaries over the elastic energy of the first: gravity has any zero."""
    elastic = one["energy_n_mm"] - one.get("gravity", 0.0)
    return float(abs(other["energy_n_mm"] - one["energy_n_mm"]) / elastic) if elastic else math.inf


def right_shape(exact: Mapping[str, Shape]) -> str:
    """The name of the certified shape; among several, the one of lowest energy, and among equal energies the first.

    A shape whose stars are all on the side that the design asks for comes before shapes with stars on the other side.
    """

    def rank(name: str) -> tuple[bool, bool]:
        return not exact[name].summary["is_minimum"], bool(exact[name].summary["stars_off_branch"])

    def energy(name: str) -> float:
        return float(exact[name].summary["energy_n_mm"])

    best = [name for name in exact if rank(name) == min(map(rank, exact))]
    lowest = min(map(energy, best))
    return next(name for name in best if same_energy(lowest, energy(name)))


def same_minimum(
    first: Shape,
    second: Shape,
    plan: Layout,
    symmetries: Sequence[Symmetry],
    gravity: Sequence[float] | None = None,
    mean: CellMean | None = None,
) -> tuple[bool, Comparison]:
    """Whether both are certified and are one minimum, and the second laid on the first as held.

    They are one minimum if their surfaces are nearer than `SAME_FORM_PERCENT` and the same stars are inverted. An image
    of a minimum may have another energy, as the mesh may be less symmetric than the design. Parameters are those of
    `asterism.shape.comparison.compare_shapes`.
    """
    between = compare_shapes(first, second, plan, symmetries, gravity, mean)
    certain = bool(first.summary["is_minimum"] and second.summary["is_minimum"])
    agree = certain and between.rms_percent < SAME_FORM_PERCENT and _same_stars_down(first, second, plan, symmetries)
    if agree and not same_energy(first.summary["energy_n_mm"], second.summary["energy_n_mm"]):
        as_it_is = compare_shapes(first, second, plan, symmetries[:1], gravity, between.mean)
        agree = as_it_is.rms_percent >= SAME_FORM_PERCENT
    return agree, between


def _same_stars_down(first: Shape, second: Shape, plan: Layout, symmetries: Sequence[Symmetry]) -> bool:
    """Whether two shapes have the same inverted stars, up to a symmetry; the cell means do not show these."""
    down = [np.isin(plan.star_number, shape.summary["stars_down"]) for shape in (first, second)]
    return any(np.array_equal(down[0], down[1][symmetry.star]) for symmetry in symmetries)


# two shapes have different forms if one of these limits is exceeded: the rms distance, in % of the diameter
MAX_LIKE_DISTANCE_PERCENT = 10.0
# the angle between their roll axes
MAX_LIKE_AXIS_DEG = 20.0
# the rms angle between their normals. In 236 previews it is below 22 deg, or the form is another one
MAX_LIKE_NORMALS_DEG = 30.0
# two exact minima have the same form if their rms distance, in % of the diameter, is below this
MAX_FORM_DISTANCE_PERCENT = 2.5


def alike(found: DifferenceRecord) -> bool:
    """Whether two shapes have the same form: small distance, similar normals, and the same roll axis if rolled.

    The normals distinguish a pleated sheet from a smooth one, which may be near to it.
    """
    one, other = found.roll_axes_deg
    is_far = found.rms_percent > MAX_LIKE_DISTANCE_PERCENT or found.normals_rms_deg > MAX_LIKE_NORMALS_DEG
    if is_far or one is None or other is None:
        return not is_far and one is other
    apart = abs(one - other) % 180.0
    return min(apart, 180.0 - apart) < MAX_LIKE_AXIS_DEG


def same_branch(found: DifferenceRecord, with_other: DifferenceRecord | None, apart_percent: float = 0.0) -> bool:
    """Whether a shape has the form of the exact result, and not that of another exact minimum.

    The minima are `apart_percent` of the diameter apart; without a second one, `with_other` is None.
    """
    nearer = with_other is None or found.rms_percent <= with_other.rms_percent
    return bool((nearer or apart_percent < MAX_FORM_DISTANCE_PERCENT) and alike(found))
