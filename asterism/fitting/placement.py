"""Turn and shift of a flattened target on the lattice: the fewest bare places along the outline."""

from __future__ import annotations

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats
from asterism.fitting.flattening.boundary_first import FlatDisk
from asterism.fitting.target_map import TargetMap
from asterism.pattern.design.lattice import Lattice
from asterism.pattern.geometry.planar import distance_to_outline, inside

# mm, smallest distance of star centres from the outline of a fitted design: bare rims droop between the needles
FITTED_STAR_MARGIN_MM = 3.0
# candidates: turns within the symmetry of the lattice, and shifts along each lattice vector
TURNS, SHIFTS = 6, 4
# of the spacing: places further than this from all stars are bare
BARE_DISTANCE = 0.5
# of the spacing: width of the band along the outline that counts, and distance of its points
RIM_BAND, RIM_STEP = 0.6, 0.12
# a candidate replaces an earlier one only if it has less bare area than this share of it
MIN_BARE_GAIN = 0.98


def placed(flat: FlatDisk, log_size: float, lattice: Lattice) -> TargetMap:
    """The print with the turn and the shift that leave the least bare area at the rim.

    A first candidate has a star at the centre of the area, others follow in a fixed order.
    """
    start = TargetMap.of(flat, log_size, 0.0, np.zeros(2), lattice.spacing_mm)
    ring = start.printed[flat.disk.border]
    band = _rim_band(ring, lattice.spacing_mm)
    centre = np.array(shapely.Polygon(ring).centroid.coords[0])
    origin = np.asarray(lattice.origin_mm)
    thirds = np.array([[1.0, 1.0], [2.0, 2.0]]) / 3.0
    shifts = np.array([[i, j] for i in range(SHIFTS) for j in range(SHIFTS)]) / SHIFTS
    best, best_score = (0.0, origin - centre), np.inf
    for turn in np.arange(TURNS) * (np.pi / 3.0 / TURNS):
        cos, sin = np.cos(turn), np.sin(turn)
        rotation = np.array([[cos, sin], [-sin, cos]])
        for fraction in np.concatenate([shifts, thirds]):
            shift = origin + fraction @ lattice.vectors - centre @ rotation
            score = _bare(band @ rotation + shift, ring @ rotation + shift, lattice)
            if score < MIN_BARE_GAIN * best_score:
                best, best_score = (float(turn), shift), score
    return TargetMap.of(flat, log_size, *best, lattice.spacing_mm)


def star_sites(ring: Floats, lattice: Lattice) -> Floats:
    """(S, 2) mm, lattice sites within an outline (B, 2), at least `FITTED_STAR_MARGIN_MM` from it."""
    cells = lattice.sites.cells_within(ring.min(axis=0), ring.max(axis=0))
    places = lattice.sites.place(cells)
    places = places[inside(places, ring)]
    return places[distance_to_outline(places, ring) >= FITTED_STAR_MARGIN_MM]


def _bare(band: Floats, ring: Floats, lattice: Lattice) -> float:
    """Mean of the squared distance (spacings) by which places of the rim are further from all stars than others."""
    from scipy.spatial import cKDTree

    stars = star_sites(ring, lattice)
    if not len(stars):
        return np.inf
    distance = cKDTree(stars).query(band)[0] / lattice.spacing_mm
    return float((np.maximum(distance - BARE_DISTANCE, 0.0) ** 2).mean())


def _rim_band(ring: Floats, spacing_mm: float) -> Floats:
    """(n, 2) mm, a grid of places within an outline and near to it."""
    step = RIM_STEP * spacing_mm
    axes = (np.arange(a, b, step) for a, b in zip(ring.min(axis=0), ring.max(axis=0), strict=True))
    points = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
    points = points[inside(points, ring)]
    return points[distance_to_outline(points, ring) < RIM_BAND * spacing_mm]
