"""Arms on the sheet: cut at the outline, and clear of each other."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.design.errors import DesignError
from asterism.pattern.geometry.planar import shown_place


def cut(
    centres: Floats, tips: Floats, corners: Floats, margin: float, holes: Sequence[Floats] = ()
) -> tuple[Floats, Ints]:
    """Tips pulled back to stay `margin` (mm) inside the outline and off the holes, and which arms were too long.

    Parameters
    ----------
    centres, tips : (A, 2) mm, both ends of every arm.
    corners : (B, 2) mm, outline of the sheet.
    holes : (n, 2) mm each, edges of the holes.
    """
    # mitres would cut long spikes out of the sheet at corners that point inwards
    inner = shapely.Polygon(corners, holes).buffer(-margin, join_style="round", quad_segs=16)
    arms = shapely.linestrings(np.stack([centres, tips], axis=1))
    shapely.prepare(inner)
    # a tip exactly at the margin is inside
    slightly_larger = inner.buffer(1e-9 * margin)
    shapely.prepare(slightly_larger)
    long = np.flatnonzero(~shapely.covers(slightly_larger, arms))
    tips = tips.copy()
    for arm in long:
        tips[arm] = _first_exit(arms[arm], centres[arm], inner)
    return tips, long


def parts_within(line: shapely.LineString, room: shapely.Geometry) -> NDArray[np.object_]:
    """The parts of a line in a room. Where it touches a corner of the room, it is not cut."""
    parts = shapely.get_parts(shapely.intersection(line, room))
    lines = parts[shapely.get_type_id(parts) == shapely.GeometryType.LINESTRING]
    return np.asarray(shapely.get_parts(shapely.line_merge(shapely.multilinestrings(lines))))


def _first_exit(arm: shapely.LineString, centre: Floats, inner: shapely.Geometry) -> Floats:
    """End of the stretch of the arm that starts at its centre; the sheet may come back further out."""
    for part in parts_within(arm, inner):
        ends = shapely.get_coordinates(part)
        distance = np.linalg.norm(ends - centre, axis=1)
        if len(ends) and distance.min() < 1e-9:
            return np.asarray(ends[distance.argmax()])
    return centre


def check_clear(centres: Floats, tips: Floats, star: Ints, width: Floats, meeting: float) -> None:
    """Refuse arms of different stars that cross, or that are too close to print as two.

    Ends that meet within `meeting` (mm) are joined on purpose. They are allowed unless one arm lies on the other.
    """
    arms = shapely.linestrings(np.stack([centres, tips], axis=1))
    tree = shapely.STRtree(arms)
    first, second = tree.query(arms, predicate="dwithin", distance=float(width.max()))
    keep = (first < second) & (star[first] != star[second])
    first, second = first[keep], second[keep]

    ends = np.stack([centres, tips], axis=1)
    gap = np.linalg.norm(ends[first][:, :, None] - ends[second][:, None], axis=-1).reshape(-1, 4)
    joined = gap.min(axis=1) <= meeting if len(gap) else np.zeros(0, dtype=bool)
    # of four ends, two where arms are joined; a third is the far end of the shorter one, if it lies on the longer
    touching = _ends_on(ends[first], arms[second], meeting) + _ends_on(ends[second], arms[first], meeting)
    distance = shapely.distance(arms[first], arms[second])
    clearance = (width[first].max(axis=1) + width[second].max(axis=1)) / 2
    bad = np.flatnonzero(np.where(joined, touching > 2, distance < clearance))
    if len(bad) == 0:
        return
    i, j = first[bad[0]], second[bad[0]]
    apart = f"are {distance[bad[0]]:.3f} mm apart and would print as one"
    what = "overlap" if joined[bad[0]] or distance[bad[0]] == 0 else apart
    # ends closer than this are meant to meet, with a rounded length
    meant = "; length_fraction makes ends meet" if gap[bad[0]].min() < 0.02 else ""
    both = f"arms of the stars at {shown_place(centres[i])} and {shown_place(centres[j])}"
    raise DesignError(
        "stars", f"{both} {what}; shorten or turn them{meant}", stars=[star[i], star[j]], place_mm=centres[i]
    )


def _ends_on(ends: Floats, others: np.ndarray, near: float) -> Ints:
    """(n,) number of ends (n, 2, 2) within `near` (mm) of another arm; intersections would depend on rounding."""
    return np.asarray(np.count_nonzero(shapely.distance(shapely.points(ends), others[:, None]) <= near, axis=1))
