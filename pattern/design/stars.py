"""Stars: their sizes at every place of the lattice, with single stars changed by hand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from pydantic import Field, model_validator

from pattern.design.errors import DesignError
from pattern.design.rounding import Rounding
from pattern.design.section import Flag, Number, Point, Section, Whole
from pattern.design.sizing_fields import SizingField, sample
from pattern.geometry.arrays import Floats, Ints

THICKNESS_MM = (0.05, 5.0)
WIDTH_MM = (0.1, 10.0)
# shorter arms are dots that jump off the fabric
SHORTEST_ARM_MM = 1.0
Branch = Literal["up", "down", "free"]
_SIGN = {"up": 1, "down": -1, "free": 0}


class Override(Section):
    """One star changed by hand: by its number (from the origin outwards) or the place of its centre."""

    star: Whole | None = Field(None, ge=0)
    at_mm: Point | None = None
    length_mm: Number | None = None
    thickness_mm: Number | None = None
    width_mm: Number | None = None
    branch: Branch | None = None
    remove: Flag = False

    @model_validator(mode="after")
    def _changes_one_star(self) -> Override:
        self._check_one_of("star", "at_mm")
        changes = [self.length_mm, self.thickness_mm, self.width_mm, self.branch]
        if self.remove == any(change is not None for change in changes):
            raise DesignError("", "must either change a size or remove the star, or set its branch")
        return self


class Stars(Section):
    """Sizes of the stars, each a number or a field over the sheet.

    Attributes
    ----------
    length_mm, length_fraction : length of the arms in mm or as a fraction of the lattice's spacing; one of them.
    thickness_mm, width_mm : cross-section of the arms.
    vary_along_arms : take thickness and width at the arm's tip from the field too, not only at the centre.
    branch : the side to which the stars start: `up` is the plastic's, `free` starts them flat.
    override : single stars changed.
    rounding : thickness and width of every star, also of changed ones, are rounded to what a printer can make.
    """

    length_mm: SizingField | None = None
    length_fraction: SizingField | None = None
    thickness_mm: SizingField = 0.3
    width_mm: SizingField = 1.2
    vary_along_arms: Flag = False
    branch: Branch = "up"
    override: tuple[Override, ...] = ()
    rounding: Rounding | None = None

    @model_validator(mode="after")
    def _one_length(self) -> Stars:
        self._check_one_of("length_mm", "length_fraction")
        return self


@dataclass(frozen=True)
class Sizes:
    """Sizes at the stars of a lattice, before they are rounded for a printer; removed ones have length 0.

    Attributes
    ----------
    length : (S,) mm.
    thickness, width : (S, arms, 2) mm, at the centre and at the tip of each arm.
    branch : (S,) 1 for stars that start up, -1 down, 0 free.
    """

    length: Floats
    thickness: Floats
    width: Floats
    branch: Ints


def sizes(stars: Stars, centres: Floats, spacing: float, arm_directions: Floats) -> Sizes:
    """The sizes of stars at `centres` (S, 2), checked one by one."""
    field = "stars.length_mm" if stars.length_fraction is None else "stars.length_fraction"
    if stars.length_mm is not None:
        length = sample(stars.length_mm, centres)
    else:
        length = spacing * sample(stars.length_fraction, centres)
    changes = _changes(stars, centres, spacing)
    for star, change, name in changes:
        if change.length_mm is not None:
            _check(f"{name}.length_mm", np.array([change.length_mm]), (0.0, spacing), centres[[star]], [star])
            length[star] = change.length_mm
    tips = centres[:, None, :] + np.clip(np.nan_to_num(length), 0, spacing)[:, None, None] * arm_directions
    both = np.stack([np.broadcast_to(centres[:, None, :], tips.shape), tips], axis=2)
    at = both if stars.vary_along_arms else np.broadcast_to(both[:, :, :1], both.shape)
    thickness = sample(stars.thickness_mm, at.reshape(-1, 2)).reshape(at.shape[:-1])
    width = sample(stars.width_mm, at.reshape(-1, 2)).reshape(at.shape[:-1])
    values = {"thickness_mm": thickness, "width_mm": width}
    limits = {"thickness_mm": THICKNESS_MM, "width_mm": WIDTH_MM}
    branch = np.full(len(centres), _SIGN[stars.branch], dtype=np.int64)
    for star, change, name in changes:
        for key in values:
            if (value := getattr(change, key)) is not None:
                _check(f"{name}.{key}", np.array([value]), limits[key], centres[[star]], [star])
                values[key][star] = value
        if change.branch is not None:
            branch[star] = _SIGN[change.branch]
        if change.remove:
            length[star] = 0.0

    unit = 1.0 if stars.length_fraction is None else spacing
    _check(field, length / unit, (0.0, spacing / unit), centres)
    printed = np.flatnonzero(length >= SHORTEST_ARM_MM)
    for key in ("thickness_mm", "width_mm"):
        _check(f"stars.{key}", values[key][printed], limits[key], centres[printed], printed)
    thickness, width = np.minimum(thickness, THICKNESS_MM[1]), np.minimum(width, WIDTH_MM[1])
    return Sizes(np.minimum(length, spacing), thickness, width, branch)


def _changes(stars: Stars, centres: Floats, spacing: float) -> list[tuple[int, Override, str]]:
    """Stars that are changed by hand, how, and the name of the entry that says so."""
    found: dict[int, tuple[int, Override, str]] = {}
    for number, change in enumerate(stars.override):
        name = f"stars.override[{number}]"
        star = _find(change, centres, spacing, name)
        if star in found:
            raise DesignError(name, f"changes star {star} again: write its changes in one entry")
        found[star] = star, change, name
    return list(found.values())


def _find(change: Override, centres: Floats, spacing: float, name: str) -> int:
    if change.star is not None:
        if change.star >= len(centres):
            raise DesignError(f"{name}.star", f"must be at most {len(centres) - 1}, the last star", change.star)
        return change.star
    distance = np.linalg.norm(centres - np.asarray(change.at_mm), axis=1)
    star = int(distance.argmin())
    # near enough to be meant, too near to be mistaken for a neighbour
    if distance[star] > 0.1 * spacing:
        x, y = centres[star]
        raise DesignError(f"{name}.at_mm", f"has no star there, the nearest is at [{x:.3f}, {y:.3f}]", change.at_mm)
    return star


def _check(
    field: str,
    values: Floats,
    limits: tuple[float, float],
    centres: Floats,
    numbers: Sequence[int] | Ints | None = None,
) -> None:
    """Refuse the first star with a value (S, ...) outside the limits, naming it."""
    low, high = limits
    slack = 1e-6 * high  # a spacing written with seven digits
    fine = (values >= low) & (values <= high + slack)
    bad = np.flatnonzero(~fine.all(axis=tuple(range(1, fine.ndim))))
    if len(bad) == 0:
        return
    star, (x, y) = bad[0], centres[bad[0]]
    value = float(values[star][~fine[star]].flat[0])
    number = star if numbers is None else numbers[star]
    raise DesignError(field, f"must be from {low:g} to {high:.6g} at star {number} at [{x:.2f}, {y:.2f}]", value)
