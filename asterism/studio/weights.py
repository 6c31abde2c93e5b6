"""Weights of places in a fit: painted by lattice site, and passed on to the target through the shown sheet."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from asterism.equilibrium.arrays import Array, Floats
from asterism.pattern.design.stars import Site
from asterism.pattern.layout.layout import Layout
from asterism.studio.requests import RequestError
from asterism.studio.target import Target

if TYPE_CHECKING:
    from asterism.fitting.target import TargetSurface

# of a place that nobody has painted
PLAIN_WEIGHT = 1.0


@dataclass(frozen=True)
class SheetWeights:
    """Weights of a shown sheet beside its target, for the process of a fit.

    Attributes
    ----------
    centres : (S, 2) mm, printed lattice sites.
    weight : (S,) of the cells around them.
    printed : (V, 2) mm, vertices of the shown sheet.
    positions : (V, 3) mm, the same in space, in the pose of the target's file.
    """

    centres: Array
    weight: Array
    printed: Array
    positions: Array

    def at_vertices(self, target: TargetSurface) -> Floats:
        """(V,) weights at the vertices of the target: each has that of the nearest place of the sheet."""
        from scipy.spatial import cKDTree  # the server does not need it

        of_sheet = self.weight[cKDTree(self.centres).query(self.printed)[1]]
        posed = self.positions @ target.motion.T + target.shift_mm
        return np.asarray(of_sheet[cKDTree(posed).query(target.disk.vertices)[1]], dtype=float)


def weights_by_site(table: Mapping[str, Any]) -> dict[Site, float]:
    """The weights of a design file's table by lattice site."""
    return {tuple(entry["site"]): entry["weight"] for entry in table.get("fit", {}).get("weights", ())}


def weighed(table: Mapping[str, Any], sites: Sequence[Site], weights: Sequence[float | None]) -> dict[str, Any]:
    """The table with other weights at some sites; None is the weight of a place that nobody has painted.

    Examples
    --------
    >>> weighed({"name": "a"}, [(0, 0), (1, 0)], [4.0, None])
    {'name': 'a', 'fit': {'weights': [{'site': [0, 0], 'weight': 4.0}]}}
    """
    kept = weights_by_site(table)
    for site, weight in zip(sites, weights, strict=True):
        # of a weight in the design file
        kept[site] = PLAIN_WEIGHT if weight is None else round(weight, 3)
    entries = [{"site": list(site), "weight": weight} for site, weight in kept.items() if weight != PLAIN_WEIGHT]
    rest = {key: value for key, value in table.items() if key != "fit"}
    return {**rest, "fit": {"weights": entries}} if entries else rest


def sheet_weights(
    table: Mapping[str, Any], layout: Layout, shown: tuple[Array, Array] | None, target: Target
) -> SheetWeights | None:
    """The weights of a design on the shown sheet; None if all places have the same.

    Parameters
    ----------
    shown : printed (V, 2) and shown (V, 3) places of the sheet, mm; None without a shape.

    Raises
    ------
    RequestError
        There are weights, but no shape.
    """
    weights = weights_by_site(table)
    weight = np.array([weights.get(tuple(site), PLAIN_WEIGHT) for site in layout.sheet_sites.tolist()])
    if (weight == PLAIN_WEIGHT).all():
        return None
    if shown is None:
        raise RequestError("fit: wait until the sheet is shown: weights are those of its places")
    printed, positions = (np.asarray(part, dtype=float) for part in shown)
    centres = layout.lattice.place(layout.sheet_sites)
    return SheetWeights(centres, weight, printed, (positions - target.shift) @ target.rotation)
