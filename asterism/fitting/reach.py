"""Whether stars can make a target: what they can do by the law, against the contraction and curvature it needs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.errors import Error
from asterism.fitting.disk import place_text
from asterism.fitting.flatten import TargetMap
from asterism.homogenize.law.star_law import MAX_SEPARATED_CURL, StarLaw
from asterism.pattern.design.stars import SizeName
from asterism.pattern.geometry.planar import polygon_area
from asterism.pattern.layout.star_cells import MAX_STARS_OF_DESIGN
from asterism.results.records.fit import ReachRecord


class ReachError(Error):
    """A target is out of reach of the stars; the message is one line with place, needed and available value."""

    exit_status = 1


# mm, shortest arms of a fitted design: shorter ones hardly differ from bare fabric
MIN_FITTED_ARM_MM = 2.0


@dataclass(frozen=True, eq=False)
class StarMenu:
    """Stars at one stretch, alike in what a fit does not change, over a grid of L lengths and H thicknesses."""

    stretch: float  # of all stars, as their spacing
    spacing_mm: float
    kept: dict[SizeName, float]  # width of all stars, and further sizes that the fit does not change
    lengths_mm: Floats  # (L,)
    thicknesses_mm: Floats  # (H,)
    contraction: Floats  # (L, H) length over printed length of the natural tube, as in supported previews
    kappa: Floats  # (L, H) 1/mm, natural curvature, positive with the plastic outside
    allowed: np.ndarray  # (L, H) in the range of the law, and separated in scale from the sheet

    @classmethod
    def of(cls, law: StarLaw, stretch: float, kept: dict[SizeName, float]) -> StarMenu:
        """The menu of a law; `ForeignLaw` if it has no table for the stretch."""
        table = law.at(stretch)
        ranges = table.size_ranges
        low, high = ranges["length_mm"]
        lengths = np.linspace(max(low, MIN_FITTED_ARM_MM), high, 56)
        thicknesses = np.geomspace(*ranges["thickness_mm"], 31)
        grid = np.stack(np.meshgrid(lengths, thicknesses, indexing="ij"), axis=-1).reshape(-1, 2)
        stars = table(grid[:, 0], grid[:, 1], *kept.values())
        shape = (len(lengths), len(thicknesses))
        contraction, kappa = (stars.value[name].reshape(shape) for name in ("lam_n", "kappa"))
        allowed = (stars.inside & ~stars.not_scale_separated).reshape(shape)
        return cls(stretch, table.spacing_mm, kept, lengths, thicknesses, contraction, kappa, allowed)

    @cached_property
    def range(self) -> tuple[float, float]:
        """Smallest and largest contraction of allowed stars."""
        contractions = self.contraction[self.allowed]
        return float(contractions.min()), float(contractions.max())

    @property
    def ratio(self) -> float:
        """Largest contraction over the smallest one: what a target may need at most."""
        low, high = self.range
        return high / low

    def sizes(self, contraction: Floats, kappa: Floats) -> Floats:
        """(S, 2) length and thickness (mm) of the stars nearest to contractions and natural curvatures (S,)."""
        # deviations that count as equal when sizes are chosen: of ln(contraction), and of the curvature times the
        # spacing
        miss = (np.log(self.contraction / contraction[:, None, None]) / 0.01) ** 2
        miss += ((self.kappa - kappa[:, None, None]) * self.spacing_mm / 0.15) ** 2
        best = np.where(self.allowed, miss, np.inf).reshape(len(contraction), -1).argmin(axis=1)
        length, thickness = np.unravel_index(best, self.allowed.shape)
        return np.column_stack([self.lengths_mm[length], self.thicknesses_mm[thickness]])

    def least_thickness(self, lengths_mm: Floats) -> Floats:
        """(S,) mm, smallest thickness of stars of these lengths (S,) from which on all are allowed."""
        # the last thickness that is not allowed, and the next one
        refused = ~self.allowed
        last = np.where(refused.any(axis=1), refused.shape[1] - 1 - refused[:, ::-1].argmax(axis=1), -1)
        least = self.thicknesses_mm[np.minimum(last + 1, len(self.thicknesses_mm) - 1)]
        return np.asarray(np.interp(lengths_mm, self.lengths_mm, least))


# a needed ratio up to this multiple of the available one is tried, with a warning: the sheet strains a little
MAX_RATIO_EXCESS = 1.06


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
) -> ReachRecord:
    """The reach of a placed target.

    A ReachError says that the sheet has room for too few stars, or, unless the `nearest` sheet is wanted, that it
    curves too tightly, or needs too different contractions.

    `stars`: (S, 2) mm, printed centres; `curvatures`: (S, 2) 1/mm, principal curvatures of the target there; `menu`,
    `menus`: of the chosen stretch, and of all stretches of the law, for messages.
    """
    warnings: list[str] = []
    fewest = 19  # of smaller sheets most is rim, which the stars do not shape
    if len(stars) < fewest:
        factor = np.sqrt(fewest / max(len(stars), 1))
        raise ReachError(
            f"{name}: has room for {len(stars)} stars {menu.spacing_mm:.1f} mm apart, at least {fewest} are needed: "
            f"make the target about {np.ceil(10 * factor) / 10:.1f} times larger"
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
    # a place curves to the other side if the sum of its curvatures is below minus this part of the largest curvature
    wrong = float((curvatures.sum(axis=1) < -0.1 * limit).mean())
    # share of the stars that may curve to the other side without a warning
    if wrong > 0.05 and not has_needles:
        warnings.append(
            f"{100 * wrong:.0f} % of the target curves to the other side than its stars can: hold it with needles"
        )
    needed = _needed_ratio(target_map)
    if needed > menu.ratio:
        line = _too_much(target_map, menus)
        if needed > MAX_RATIO_EXCESS * menu.ratio and not nearest:
            raise ReachError(f"{name}: {line}")
        warnings.append(line)
    return ReachRecord(
        needed_ratio=needed,
        available_ratio=menu.ratio,
        largest_curvature_per_mm=float(size[sharpest]),
        available_curvature_per_mm=limit,
        wrong_side_share=wrong,
        warnings=warnings,
    )


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
