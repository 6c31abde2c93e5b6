"""`asterism.solve_for`: a design whose preview has a wanted height or radius."""

from __future__ import annotations

from typing import Any, Literal, get_args

import numpy as np
from scipy.optimize import brentq

from asterism.equilibrium.arrays import Floats
from asterism.fitting.errors import ReachError
from asterism.fitting.star_menu import MIN_FITTED_ARM_MM
from asterism.homogenize.law.axes import AXES
from asterism.homogenize.law.star_law import StarLaw
from asterism.pattern.design.arguments import check_type
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.painted_stars import SIZE_KEYS, with_painted_stars
from asterism.previews.law_choice import serving_law
from asterism.previews.run import preview
from asterism.process.listeners import Say, ignore_line

Wanted = Literal["height_mm", "roll_radius_mm"]
Changed = Literal["length_mm", "thickness_mm", "width_mm"]
# factors of the sizes that are tried to enclose the value, over the whole range of the law
TRIED_FACTORS = 9
# relative precision of the wanted value, and of the factor
WANTED_TOLERANCE, FACTOR_TOLERANCE = 2e-3, 1e-5
# decimals of mm of the sizes
SOLVED_DECIMALS = 4


def solve_for(
    design: Design,
    wanted: Wanted,
    value: float,
    change: Changed = "length_mm",
    law: StarLaw | None = None,
    say: Say | None = None,
) -> Design:
    """Scale one size of all stars so that the preview has a wanted height or radius.

    Every trial is a fresh preview. Of several solutions, the one with the smallest change of the sizes is returned.
    `solve_for_point` moves a needle instead, so that the sheet comes to a wanted point.

    Parameters
    ----------
    design : from `load_design`, `new` or `Design.from_dict`.
    wanted : `height_mm`, the extent along z (of a free sheet: across its mean plane), or `roll_radius_mm`, the radius
        of a sheet that rolls up.
    value : of the wanted quantity, in mm.
    change : the size that is scaled; within the range of the law.
    law : of the material; by default the one that the design names, or else that of the paper's material.
    say : called with a line of text for each trial.

    Returns
    -------
    The design, with one `stars.override` a star.

    Raises
    ------
    ReachError
        No scale of the sizes gives the value; the message names the values that occur.
    DesignError, MeshError, LawError
        As for `Preview`.
    ValueError
        `wanted`, `value` or `change` is not one of those named above.

    Examples
    --------
    >>> from asterism.previews.run import preview
    >>> from asterism.pattern import gallery
    >>> tube = solve_for(gallery.load("tube"), "roll_radius_mm", 25.0)
    >>> round(preview(tube).summary.roll_radius_mm)
    25
    """
    check_type(design, Design, "load_design reads one from a file")
    for name, given, allowed in (("wanted", wanted, get_args(Wanted)), ("change", change, get_args(Changed))):
        if given not in allowed:
            raise ValueError(f"{name} = {given!r}: must be {' or '.join(allowed)}")
    if not (isinstance(value, int | float) and np.isfinite(value) and value > 0.0):
        raise ValueError(f"value = {value!r}: must be a number of mm above 0")
    search = _Search(design, wanted, float(value), change, law or serving_law(design), say)
    return search.design(search.solve())


class _Search:
    """The search for one factor of the sizes."""

    def __init__(
        self, design: Design, wanted: Wanted, value: float, change: Changed, law: StarLaw, say: Say | None
    ) -> None:
        self._base, self._wanted, self._value, self._law = design, wanted, value, law
        self._change, self._tell = change, say or ignore_line
        self._plan = layout(design)
        self._column = SIZE_KEYS.index(change)
        self._sizes = self._plan.star_sizes_mm[:, self._column]
        low, high = law.size_ranges(law.check(design).stretch)[AXES[self._column].key]
        self._range = (max(low, MIN_FITTED_ARM_MM) if change == "length_mm" else low), high
        self._measured: dict[float, float] = {}

    def design(self, factor: float) -> Design:
        """The design with sizes scaled, within the law's range."""
        sizes: Floats = np.full((len(self._sizes), len(SIZE_KEYS)), np.nan)
        sizes[:, self._column] = np.clip(factor * self._sizes, *self._range).round(SOLVED_DECIMALS)
        return with_painted_stars(self._base, self._plan.sites, sizes)

    def measure(self, factor: float) -> float:
        """The wanted quantity of a fresh preview; nan for a sheet that is not rolled."""
        if factor not in self._measured:
            shape = preview(self.design(factor), self._law)
            measured: Any = shape.height_mm if self._wanted == "height_mm" else shape.summary["roll_radius_mm"]
            self._measured[factor] = np.nan if measured is None else float(measured)
            self._tell(f"{self._change} times {factor:.4f}: {self._wanted} = {self._measured[factor]:.3f}")
        return self._measured[factor]

    def solve(self) -> float:
        """The factor that is nearest to 1 among those that give the value."""
        low, high = self._range
        ends = low / self._sizes.max(), high / self._sizes.min()
        tried = sorted({1.0, *np.geomspace(min(ends[0], 1.0), max(ends[1], 1.0), TRIED_FACTORS).tolist()})
        values = [self.measure(factor) for factor in tried]
        enclosing = [
            (a, b)
            for a, b, at_a, at_b in zip(tried, tried[1:], values, values[1:], strict=False)
            if (at_a - self._value) * (at_b - self._value) <= 0.0
        ]
        for a, b in sorted(enclosing, key=lambda ends: min(abs(np.log(ends[0])), abs(np.log(ends[1])))):
            try:
                factor = float(brentq(self._miss, a, b, xtol=FACTOR_TOLERANCE, rtol=FACTOR_TOLERANCE))
            except ValueError:  # a trial between is not rolled
                continue
            if abs(self._miss(factor)) <= WANTED_TOLERANCE * self._value:
                return factor
        known = [value for value in values if np.isfinite(value)]
        if not known:
            raise ReachError(f"{self._wanted} = {self._value:g}: the sheet does not roll up for any {self._change}")
        jumps = ", where the sheet jumps from one form to another" if enclosing else ""
        raise ReachError(
            f"{self._wanted} = {self._value:g}: is not reached by scaling {self._change}{jumps}; "
            f"it is {min(known):.3g} to {max(known):.3g} mm over the range of the law"
        )

    def _miss(self, factor: float) -> float:
        measured = self.measure(factor)
        if not np.isfinite(measured):
            raise ValueError("not rolled")
        return measured - self._value
