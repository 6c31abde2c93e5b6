"""The shape that a preview shows: triangles with rods along their edges, placed on the shell with the stars' bumps."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.layout.layout import Layout
from asterism.pattern.mesh.mesh import Mesh
from asterism.previews.state import PreviewState
from asterism.shape.shape import Shape
from asterism.shape.surface_fields import cell_fields


def shown_shape(state: PreviewState) -> Shape:
    """The shape with bumps, without a summary; the principal axes of a free sheet lie along x, y and z.

    The field `bump_mm` holds the vectors from the smooth surface to the shape. Normals, curvatures and strains are
    those of the smooth surface.
    """
    layout, mesh, places = state.layout, state.sheet.shown.mesh, state.sheet.shown.lens(state.x)
    star = np.full(len(mesh.points), -1, dtype=np.int64)
    star[mesh.star_vertices] = layout.star_number
    shape = Shape(
        printed=mesh.points,
        positions=places.bumpy,
        triangles=mesh.triangles,
        star=star,
        rods=mesh.rods,
        star_vertices=mesh.star_vertices,
        point_fields={
            "bump_mm": places.bumps,
            "normal": places.normals,
            "mean_curvature_per_mm": places.mean_curvature,
            "gaussian_curvature_per_mm2": places.gaussian_curvature,
        },
        cell_fields=cell_fields(mesh.points, places.smooth, mesh.triangles, state.design.fabric.stretch_xy),
        rod_fields=_rod_fields(layout, mesh),
        held=bool(layout.pins),
        plan=layout,
    )
    return shape if shape.held else shape.aligned()


def _rod_fields(layout: Layout, mesh: Mesh) -> dict[str, np.ndarray]:
    """Fields of the rod edges: number of the rod, its star, and thickness and width at the middle of the edge."""
    rods = layout.graph.rods
    number, part = _parts_along([mesh.points[path] for path in mesh.rods])
    within = number[1:] == number[:-1]  # false for steps from one rod to the next
    number, middle = number[1:][within], 0.5 * (part[1:] + part[:-1])[within]
    # all rods on one line, each from its number to the next
    places, knots = number + middle, np.add(*_parts_along([rod.points for rod in rods]))
    thickness, width = (np.concatenate([getattr(rod, name) for rod in rods]) for name in ("thickness", "width"))
    fields = {
        "arm": number,
        "star": layout.star_of_rods[number],
        "thickness_mm": np.interp(places, knots, thickness),
        "width_mm": np.interp(places, knots, width),
    }
    return fields | ({"side": layout.rod_side[number]} if (layout.rod_side < 0).any() else {})


def _parts_along(lines: Sequence[Floats]) -> tuple[Ints, Floats]:
    """(n,) number of its line for each of the points of all lines, and (n,) part of the line's length before it."""
    counts = np.array([len(line) for line in lines])
    number, first = np.repeat(np.arange(len(counts)), counts), np.cumsum(counts) - counts
    points = np.concatenate(lines)
    step = np.linalg.norm(np.diff(points, axis=0, prepend=points[:1]), axis=1)
    step[first] = 0.0
    length, total = np.cumsum(step), np.bincount(number, step)
    return number, (length - length[first][number]) / total[number]
