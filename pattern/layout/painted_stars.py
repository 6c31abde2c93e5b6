"""Designs with stars that are painted or removed by hand, without a design file in between."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.design.design import Design
from asterism.pattern.design.stars import SIZE_KEYS, Override, Site, SizeName
from asterism.pattern.layout.build import sheet_sites
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.star_cells import site_of

NO_SIZES = (None,) * len(SIZE_KEYS)


def size_rows(sizes: Mapping[SizeName, ArrayLike]) -> Floats:
    """(n, L) sizes of stars for `with_painted_stars`: some of them, (n,) each; nan for the others.

    >>> size_rows({"thickness_mm": [0.3, 0.4]})[:, :3].tolist()
    [[nan, 0.3, nan], [nan, 0.4, nan]]
    """
    count = max(np.size(values) for values in sizes.values())
    return np.column_stack([np.broadcast_to(sizes.get(key, np.nan), count) for key in SIZE_KEYS])


def with_painted_stars(design: Design, sites: ArrayLike, sizes_mm: ArrayLike, removed: ArrayLike = ()) -> Design:
    """The design with other sizes at some lattice sites, as entries of `stars.override`.

    Further entries of the design stay. The sizes are not checked here: `layout` refuses those out of range. Raises
    `ValueError` if the arrays have other shapes, or a site is not of whole numbers.

    Parameters
    ----------
    sites : (n, 2) lattice sites, whole numbers. Sites off the sheet count as soon as the outline includes them.
    sizes_mm : (n, L) `STAR_SIZES` (length, thickness and width); nan keeps the size that the design has there.
    removed : (m, 2) lattice sites without a star.

    >>> design = Design.from_dict({"stars": {"length_mm": 10}, "border": {"rings": 1}})
    >>> painted = with_painted_stars(design, [[0, 0]], [[6.0, np.nan, np.nan]], removed=[[1, 0]])
    >>> [(entry.site, entry.length_mm, entry.remove) for entry in painted.stars.override]
    [((0, 0), 6.0, False), ((1, 0), None, True)]
    """
    painted, gone = _whole_pairs(sites, "sites"), _whole_pairs(removed, "removed")
    sizes = np.asarray(sizes_mm if len(painted) else [], dtype=float).reshape(-1, len(SIZE_KEYS))
    if len(sizes) != len(painted):
        raise ValueError(f"sizes_mm must have one row a site, {len(painted)}, got {len(sizes)}")
    entries = {entry.site: entry for entry in overrides_by_site(design)}
    for site, row in zip(map(tuple, painted.tolist()), sizes.tolist(), strict=True):
        given = tuple(None if size != size else size for size in row)
        old = entries.get(site)
        if old is not None and not old.remove:
            sizes_of_star = zip(SIZE_KEYS, given, strict=True)
            entries[site] = old.model_copy(update={key: size for key, size in sizes_of_star if size is not None})
        elif given != NO_SIZES:
            entries[site] = _entry(site, given)
    for site in map(tuple, gone.tolist()):
        entries[site] = _entry(site, NO_SIZES)
    stars = design.required_stars.model_copy(update={"override": tuple(entries.values())})
    return design.model_copy(update={"stars": stars})


def overrides_by_site(design: Design) -> list[Override]:
    """The entries of `stars.override`, each by its lattice site.

    Entries that no star fits stay as they are, and so do second entries of one star: `layout` names them.
    """
    lattice, entries = design.lattice, list(design.required_stars.override)
    is_numbered = any(entry.star is not None for entry in entries)
    cells = sheet_sites(design) if is_numbered else np.empty((0, 2), dtype=np.int64)
    out: list[Override] = []
    for entry in entries:
        site = site_of(entry, cells, lattice)
        out.append(entry.model_copy(update={"star": None, "at_mm": None, "site": site}) if site else entry)
    return out


def stars_apart(layout: Layout, steps: int) -> list[Ints]:
    """Numbers of the stars of a layout in groups, within which they are at least so many lattice steps apart."""
    group = (layout.sites % steps) @ np.array([steps, 1])
    return [np.flatnonzero(group == number) for number in np.unique(group)]


@lru_cache(maxsize=20_000)
def _entry(site: Site, given: tuple[float | None, ...]) -> Override:
    """The entry of a star, without its checks; of a removed one if it has no size. A stroke changes few of many."""
    sizes: dict[str, Any] = dict(zip(SIZE_KEYS, given, strict=True))
    return Override.model_construct(site=site, remove=given == NO_SIZES, **sizes)


def _whole_pairs(values: ArrayLike, name: str) -> Ints:
    """(n, 2) of pairs of whole numbers, also written as floats."""
    pairs = np.asarray(values, dtype=float)
    if pairs.size == 0:
        return np.empty((0, 2), dtype=np.int64)
    if pairs.ndim != 2 or pairs.shape[1] != 2 or not (np.isfinite(pairs).all() and (pairs == np.rint(pairs)).all()):
        raise ValueError(f"{name} must be pairs of whole numbers, shape (n, 2)")
    return pairs.astype(np.int64)
