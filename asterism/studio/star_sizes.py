"""What is painted site by site: sizes of stars in `stars.override`, and weights of places in a fit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.design.stars import SIZE_KEYS, Site
from asterism.pattern.layout.layout import Layout

PLAIN_WEIGHT = 1.0  # of a place that nobody has painted


def entries_by_site(table: Mapping[str, Any], layout: Layout) -> dict[Site, dict[str, Any]]:
    """The entries of `stars.override` by lattice site; entries by star number or place become entries by site."""
    entries: dict[Site, dict[str, Any]] = {}
    for entry in table.get("stars", {}).get("override", ()):
        rest = {key: value for key, value in entry.items() if key not in ("site", "star", "at_mm")}
        if "site" in entry:
            site = tuple(entry["site"])
        elif "star" in entry:
            site = tuple(layout.sheet_sites[entry["star"]].tolist())
        else:
            site = tuple(layout.lattice.nearest(np.asarray([entry["at_mm"]], dtype=float))[0].tolist())
        entries[site] = rest
    return entries


def painted(
    table: Mapping[str, Any], layout: Layout, sites: Sequence[Site], sizes: Mapping[str, Sequence[float | None]]
) -> dict[str, Any]:
    """The table with other sizes at some sites; None leaves a size as it is, and a removed star stays removed.

    Parameters
    ----------
    sizes : for some of `SIZE_KEYS`, one size (mm) a site.
    """
    entries = entries_by_site(table, layout)
    for key, values in sizes.items():
        for site, value in zip(sites, values, strict=True):
            entry = entries.setdefault(site, {})
            if value is not None and not entry.get("remove"):
                # Painted sizes are kept to 0.1 micrometre: files stay readable.
                entry[key] = round(float(value), 4)
    return _with_entries(table, entries)


def changed(
    table: Mapping[str, Any], layout: Layout, sites: Sequence[Site], what: Literal["remove", "restore", "reset"]
) -> dict[str, Any]:
    """The table with the stars at these sites removed, with the removed ones back, or without entries of their own.

    Stars without an entry have the sizes of the design's profiles.
    """
    entries = entries_by_site(table, layout)
    for site in sites:
        if what == "remove":
            entries[site] = {"remove": True}
        elif what == "reset" or entries.get(site, {}).get("remove"):
            entries.pop(site, None)
    return _with_entries(table, entries)


def _with_entries(table: Mapping[str, Any], entries: Mapping[Site, Mapping[str, Any]]) -> dict[str, Any]:
    """The table with these entries as its `stars.override`; entries that change nothing are left out."""
    stars = {key: value for key, value in table["stars"].items() if key != "override"}
    kept = [{"site": list(site), **entry} for site, entry in entries.items() if entry]
    if kept:
        stars["override"] = kept
    return {**table, "stars": stars}


def split(table: Mapping[str, Any]) -> tuple[dict[str, Any], Ints, Floats, Ints]:
    """A table as the engine takes it: without sizes by site, and these as arrays.

    Returns
    -------
    The table without weights of a fit, with those entries only that are given by star or place, or set a branch or a
    side; sites (n, 2) and their sizes (n, L), nan where the profile's size holds; sites (m, 2) of removed stars.
    """
    base, sites, sizes, gone = [], [], [], []
    for entry in table.get("stars", {}).get("override", ()):
        if "site" not in entry or "branch" in entry or "side" in entry:
            base.append(entry)
        elif entry.get("remove"):
            gone.append(entry["site"])
        else:
            sites.append(entry["site"])
            sizes.append([entry.get(key, np.nan) for key in SIZE_KEYS])
    rest = {key: value for key, value in table.items() if key != "fit"}  # no matter of the shape
    if "stars" in table:
        stars = {key: value for key, value in table["stars"].items() if key != "override"}
        rest["stars"] = stars | ({"override": base} if base else {})
    return (
        rest,
        np.asarray(sites, dtype=np.int64).reshape(-1, 2),
        np.asarray(sizes, dtype=float).reshape(-1, len(SIZE_KEYS)),
        np.asarray(gone, dtype=np.int64).reshape(-1, 2),
    )


def weights_by_site(table: Mapping[str, Any]) -> dict[Site, float]:
    """The weights of a design file's table by lattice site."""
    return {tuple(entry["site"]): entry["weight"] for entry in table.get("fit", {}).get("weights", ())}


def weighed(table: Mapping[str, Any], sites: Sequence[Site], weights: Sequence[float | None]) -> dict[str, Any]:
    """The table with other weights at some sites; None is the weight of a place that nobody has painted."""
    kept = weights_by_site(table)
    for site, weight in zip(sites, weights, strict=True):
        # of a weight in the design file
        kept[site] = PLAIN_WEIGHT if weight is None else round(weight, 3)
    entries = [{"site": list(site), "weight": weight} for site, weight in kept.items() if weight != PLAIN_WEIGHT]
    rest = {key: value for key, value in table.items() if key != "fit"}
    return {**rest, "fit": {"weights": entries}} if entries else rest
