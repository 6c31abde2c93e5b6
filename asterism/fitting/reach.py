"""Whether stars can make a target: contraction and curvature that it needs, against what is available."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.fitting.errors import ReachError, place_text
from asterism.fitting.star_menu import StarMenu
from asterism.fitting.target_map import TargetMap
from asterism.homogenize.law.star_law import MAX_SEPARATED_CURL
from asterism.pattern.geometry.planar import polygon_area
from asterism.pattern.layout.star_cells import MAX_STARS_OF_DESIGN

# a needed ratio up to this multiple of the available one is tried, with a warning: the sheet strains a little
MAX_RATIO_EXCESS = 1.06
# fewest stars of a fit: of smaller sheets most is rim, which the stars do not shape
MIN_FITTED_STARS = 19
# share of the stars that may curve to the other side without a warning
MAX_WRONG_SIDE_SHARE = 0.05
# a place curves to the other side if the sum of its curvatures is below minus this part of the largest curvature
MIN_WRONG_SIDE_CURVATURE = 0.1


@dataclass(frozen=True)
class Reach:
    """What a target needs, and what stars can do.

    Attributes
    ----------
    needed_ratio, available_ratio : largest contraction over the smallest one.
    largest_curvature_per_mm, available_curvature_per_mm : largest absolute principal curvature of the target over a
        cell, and the largest one that stars can follow.
    wrong_side_share : share of the stars whose place curves to the other side than stars can.
    warnings : one line for each limit that the target comes near to or exceeds.
    """

    needed_ratio: float
    available_ratio: float
    largest_curvature_per_mm: float
    available_curvature_per_mm: float
    wrong_side_share: float
    warnings: tuple[str, ...] = ()


def choose_stretch(needed_ratio: float, menus: Sequence[StarMenu]) -> StarMenu:
    """The menu of the smallest stretch that gives the ratio of contractions; that of the largest ratio otherwise."""
    fitting = [menu for menu in menus if menu.ratio >= needed_ratio]
    return min(fitting, key=lambda menu: menu.stretch) if fitting else max(menus, key=lambda menu: menu.ratio)


def check_size(name: str, target_map: TargetMap, menu: StarMenu, menus: Sequence[StarMenu], cell_mm2: float) -> None:
    """Raise ReachError for a target that needs more stars than a design can have, before they are placed.

    A target that contracts too differently needs a large print; others are large themselves. `menu` and `menus` are of
    the chosen stretch, and of all stretches of the law; `cell_mm2` is the printed area of a star.
    """
    stars = abs(polygon_area(target_map.printed[target_map.flat.disk.border])) / cell_mm2
    if stars <= MAX_STARS_OF_DESIGN:
        return
    if _needed_ratio(target_map) > MAX_RATIO_EXCESS * menu.ratio:
        raise ReachError(f"{name}: {_too_much(target_map, menus)}")
    raise ReachError(
        f"{name}: needs about {stars:.0f} stars {menu.spacing_mm:.1f} mm apart, a design has at most "
        f"{MAX_STARS_OF_DESIGN}: make the target {np.ceil(10 * np.sqrt(stars / MAX_STARS_OF_DESIGN)) / 10:.1f} times "
        "smaller, or cut it into parts"
    )


def target_reach(
    name: str,
    target_map: TargetMap,
    stars: Floats,
    curvatures: Floats,
    menu: StarMenu,
    menus: Sequence[StarMenu],
    has_needles: bool,
    nearest: bool,
) -> Reach:
    """The reach of a placed target.

    A ReachError says that the sheet has room for too few stars, or, unless the `nearest` sheet is wanted, that it
    curves too tightly, or needs too different contractions.

    Parameters
    ----------
    stars : (S, 2) mm, printed centres.
    curvatures : (S, 2) 1/mm, principal curvatures of the target there.
    menu, menus : of the chosen stretch, and of all stretches of the law, for messages.
    """
    warnings: list[str] = []
    if len(stars) < MIN_FITTED_STARS:
        factor = np.sqrt(MIN_FITTED_STARS / max(len(stars), 1))
        raise ReachError(
            f"{name}: has room for {len(stars)} stars {menu.spacing_mm:.1f} mm apart, at least {MIN_FITTED_STARS} are "
            f"needed: make the target about {np.ceil(10 * factor) / 10:.1f} times larger"
        )
    places = target_map.places(stars)
    limit = MAX_SEPARATED_CURL / menu.spacing_mm
    size = np.abs(curvatures).max(axis=1)
    sharpest = int(size.argmax())
    if size[sharpest] > limit:
        line = (
            f"at {place_text(places[sharpest], 0)} the target curves by 1/{1.0 / size[sharpest]:.1f} mm; stars "
            f"{menu.spacing_mm:.1f} mm apart reach 1/{1.0 / limit:.1f} mm: make the target "
            f"{np.ceil(10 * size[sharpest] / limit) / 10:.1f} times larger, or smooth it there"
        )
        if not nearest:
            raise ReachError(f"{name}: {line}")
        warnings.append(line)
    wrong = float((curvatures.sum(axis=1) < -MIN_WRONG_SIDE_CURVATURE * limit).mean())
    if wrong > MAX_WRONG_SIDE_SHARE and not has_needles:
        warnings.append(
            f"{100 * wrong:.0f} % of the target curves to the other side than its stars can: hold it with needles"
        )
    needed = _needed_ratio(target_map)
    if needed > menu.ratio:
        line = _too_much(target_map, menus)
        if needed > MAX_RATIO_EXCESS * menu.ratio and not nearest:
            raise ReachError(f"{name}: {line}")
        warnings.append(line)
    return Reach(needed, menu.ratio, float(size[sharpest]), limit, wrong, tuple(warnings))


def _needed_ratio(target_map: TargetMap) -> float:
    return float(np.exp(np.ptp(target_map.log_contraction)))


def _too_much(target_map: TargetMap, menus: Sequence[StarMenu]) -> str:
    needed, logs, vertices = _needed_ratio(target_map), target_map.log_contraction, target_map.flat.disk.vertices
    low, high = vertices[int(logs.argmin())], vertices[int(logs.argmax())]
    available = ", ".join(f"{each.ratio:.2f} at stretch {each.stretch:g}" for each in menus)
    better = [each for each in menus if each.ratio >= needed]
    remedy = f"stretch {better[0].stretch:g}" if better else "a flatter target, or one cut into parts"
    return (
        f"contractions at {place_text(high, 0)} and {place_text(low, 0)} must differ by a ratio of {needed:.2f}; "
        f"available are {available}: choose {remedy}"
    )
