"""`asterism.solve_for`: a design whose preview has a wanted height or radius."""

from __future__ import annotations

from functools import cache
from itertools import pairwise
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
from asterism.previews.session import preview
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
    >>> from asterism.previews.session import preview
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
    law, tell, plan = law or serving_law(design), say or ignore_line, layout(design)
    column = SIZE_KEYS.index(change)
    sizes = plan.star_sizes_mm[:, column]
    low, high = law.size_ranges(law.check(design).stretch)[AXES[column].key]
    low = max(low, MIN_FITTED_ARM_MM) if change == "length_mm" else low

    def scaled(factor: float) -> Design:
        """The design with sizes scaled, within the law's range."""
        changed: Floats = np.full((len(sizes), len(SIZE_KEYS)), np.nan)
        changed[:, column] = np.clip(factor * sizes, low, high).round(SOLVED_DECIMALS)
        return with_painted_stars(design, plan.sites, changed)

    @cache
    def measured(factor: float) -> float:
        """The wanted quantity of a fresh preview; nan for a sheet that is not rolled."""
        shape = preview(scaled(factor), law)
        found: Any = shape.height_mm if wanted == "height_mm" else shape.summary["roll_radius_mm"]
        found = np.nan if found is None else float(found)
        tell(f"{change} times {factor:.4f}: {wanted} = {found:.3f}")
        return float(found)

    def miss(factor: float) -> float:
        if not np.isfinite(measured(factor)):
            raise ValueError("not rolled")
        return measured(factor) - value

    ends = min(low / sizes.max(), 1.0), max(high / sizes.min(), 1.0)
    tried = sorted({1.0, *np.geomspace(*ends, TRIED_FACTORS).tolist()})
    values = [measured(factor) for factor in tried]
    pairs = zip(pairwise(tried), pairwise(values), strict=True)
    enclosing = [ends for ends, (first, last) in pairs if (first - value) * (last - value) <= 0.0]
    # of several solutions the one whose factor is nearest to 1
    for a, b in sorted(enclosing, key=lambda ends: min(abs(np.log(ends[0])), abs(np.log(ends[1])))):
        try:
            factor = float(brentq(miss, a, b, xtol=FACTOR_TOLERANCE, rtol=FACTOR_TOLERANCE))
        except ValueError:  # a trial between is not rolled
            continue
        if abs(miss(factor)) <= WANTED_TOLERANCE * value:
            return scaled(factor)
    known = [found for found in values if np.isfinite(found)]
    if not known:
        raise ReachError(f"{wanted} = {value:g}: the sheet does not roll up for any {change}")
    jumps = ", where the sheet jumps from one form to another" if enclosing else ""
    raise ReachError(
        f"{wanted} = {value:g}: is not reached by scaling {change}{jumps}; "
        f"it is {min(known):.3g} to {max(known):.3g} mm over the range of the law"
    )
