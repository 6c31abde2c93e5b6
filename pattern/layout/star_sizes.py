"""Sizes of all stars of a sheet: sizing profiles evaluated, single stars changed, limits checked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pattern.design.errors import DesignError
from pattern.design.sizing.field import sample
from pattern.design.stars import MIN_ARM_MM, THICKNESS_RANGE_MM, WIDTH_RANGE_MM, Override, Stars
from pattern.geometry.arrays import Floats, Ints

# A star is meant by `at_mm` within this part of the spacing: too close to be mistaken for a neighbour.
MAX_STAR_MISS_SPACINGS = 0.1
# A size may exceed its upper limit by this part, as a spacing written with seven digits does.
SIZE_LIMIT_SLACK = 1e-6
_SIGN = {"up": 1, "down": -1, "free": 0}


@dataclass(frozen=True)
class StarSizes:
    """Sizes at the stars of a lattice, before they are rounded for a printer. Removed stars have length 0.

    Attributes
    ----------
    length : (S,) mm.
    thickness, width : (S, arms, 2) mm, at the centre and at the tip of each arm.
    branch : (S,) 1 for stars that start up, -1 for those that start down, 0 for those that start flat.
    """

    length: Floats
    thickness: Floats
    width: Floats
    branch: Ints


@dataclass(frozen=True)
class _Change:
    """An entry of `stars.override`, the number of its star, and the name of the entry in messages."""

    star: int
    entry: Override
    name: str


def star_sizes(stars: Stars, centres: Floats, spacing: float, arm_directions: Floats) -> StarSizes:
    """The sizes of all stars.

    Parameters
    ----------
    centres : (S, 2) mm.
    spacing : mm, the longest arm allowed.
    arm_directions : (arms, 2) unit vectors.

    Raises
    ------
    DesignError
        A size is out of its range, or an entry of `stars.override` fits no star. The message names the first such star.
    """
    field = "stars.length_mm" if stars.length_fraction is None else "stars.length_fraction"
    if stars.length_mm is not None:
        length = sample(stars.length_mm, centres)
    else:
        assert stars.length_fraction is not None  # a section has one of both
        length = spacing * sample(stars.length_fraction, centres)
    changes = _changes(stars, centres, spacing)
    for change in changes:
        if change.entry.length_mm is not None:
            value, star = change.entry.length_mm, change.star
            _check(f"{change.name}.length_mm", np.array([value]), (0.0, spacing), centres[[star]], [star])
            length[star] = value
    tips = centres[:, None, :] + np.clip(np.nan_to_num(length), 0, spacing)[:, None, None] * arm_directions
    both = np.stack([np.broadcast_to(centres[:, None, :], tips.shape), tips], axis=2)
    at = both if stars.vary_along_arms else np.broadcast_to(both[:, :, :1], both.shape)
    thickness = sample(stars.thickness_mm, at.reshape(-1, 2)).reshape(at.shape[:-1])
    width = sample(stars.width_mm, at.reshape(-1, 2)).reshape(at.shape[:-1])
    values = {"thickness_mm": thickness, "width_mm": width}
    limits = {"thickness_mm": THICKNESS_RANGE_MM, "width_mm": WIDTH_RANGE_MM}
    branch = np.full(len(centres), _SIGN[stars.branch], dtype=np.int64)
    for change in changes:
        star, entry = change.star, change.entry
        for key in values:
            if (size := getattr(entry, key)) is not None:
                _check(f"{change.name}.{key}", np.array([size]), limits[key], centres[[star]], [star])
                values[key][star] = size
        if entry.branch is not None:
            branch[star] = _SIGN[entry.branch]
        if entry.remove:
            length[star] = 0.0

    unit = 1.0 if stars.length_fraction is None else spacing
    _check(field, length / unit, (0.0, spacing / unit), centres)
    printed = np.flatnonzero(length >= MIN_ARM_MM)
    for key in values:
        _check(f"stars.{key}", values[key][printed], limits[key], centres[printed], printed)
    thickness, width = np.minimum(thickness, THICKNESS_RANGE_MM[1]), np.minimum(width, WIDTH_RANGE_MM[1])
    return StarSizes(np.minimum(length, spacing), thickness, width, branch)


def _changes(stars: Stars, centres: Floats, spacing: float) -> list[_Change]:
    """The entries of `stars.override`, at most one a star."""
    changes: dict[int, _Change] = {}
    for number, entry in enumerate(stars.override):
        name = f"stars.override[{number}]"
        star = _changed_star(entry, centres, spacing, name)
        if star in changes:
            raise DesignError(name, f"changes star {star} again: write its changes in one entry")
        changes[star] = _Change(star, entry, name)
    return list(changes.values())


def _changed_star(entry: Override, centres: Floats, spacing: float, name: str) -> int:
    """Number of the star that an entry changes."""
    if entry.star is not None:
        if entry.star >= len(centres):
            raise DesignError(f"{name}.star", f"must be at most {len(centres) - 1}, the last star", entry.star)
        return entry.star
    distance = np.linalg.norm(centres - np.asarray(entry.at_mm), axis=1)
    star = int(distance.argmin())
    if distance[star] > MAX_STAR_MISS_SPACINGS * spacing:
        x, y = centres[star]
        raise DesignError(f"{name}.at_mm", f"has no star there, the nearest is at [{x:.3f}, {y:.3f}]", entry.at_mm)
    return star


def _check(
    field: str,
    values: Floats,
    limits: tuple[float, float],
    centres: Floats,
    numbers: Sequence[int] | Ints | None = None,
) -> None:
    """Refuse values (S, ...) outside the limits; the message names the first such star."""
    low, high = limits
    allowed = (values >= low) & (values <= high + SIZE_LIMIT_SLACK * high)
    refused = np.flatnonzero(~allowed.all(axis=tuple(range(1, allowed.ndim))))
    if len(refused) == 0:
        return
    star, (x, y) = refused[0], centres[refused[0]]
    value = float(values[star][~allowed[star]].flat[0])
    number = star if numbers is None else numbers[star]
    raise DesignError(field, f"must be from {low:g} to {high:.6g} at star {number} at [{x:.2f}, {y:.2f}]", value)
