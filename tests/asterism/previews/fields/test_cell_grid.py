"""The grid of the stars' cells: whose they are, what is on the sheet, where runs of equal points end."""

from __future__ import annotations

import numpy as np
import shapely

from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.previews.fields.star_cells import MIN_SHARE_OFF_SHEET, CellGrid

TUBE = gallery.load("tube")


def design(border: list[list[float]]) -> Design:
    return Design.from_dict(TUBE.to_dict() | {"border": {"polygon_mm": border}})


DENTED = design([[-40.0, -35.0], [45.0, -30.0], [10.0, 0.0], [42.0, 31.0], [-38.0, 40.0]])


def points(grid: CellGrid) -> np.ndarray:
    return grid.origin + grid.step * np.moveaxis(np.indices(grid.owner.shape), 0, -1)


def test_the_nearest_star_owns_a_place() -> None:
    plan = layout(TUBE)
    grid = CellGrid(plan, TUBE.lattice, 1.1, 8.0)
    away = np.linalg.norm(points(grid)[:, :, None] - plan.centres, axis=-1)
    owned = grid.owner < len(plan.centres)
    assert owned[away.min(axis=2) < 0.49 * plan.spacing_mm].all()
    assert not owned[away.min(axis=2) > 0.6 * plan.spacing_mm].any()
    least = np.take_along_axis(away, np.where(owned, grid.owner, 0)[:, :, None], axis=2)[:, :, 0]
    assert np.allclose(least[owned], away.min(axis=2)[owned])


def test_counts_tell_inside_from_outside_in_a_dented_sheet() -> None:
    plan = layout(DENTED)
    grid = CellGrid(plan, DENTED.lattice, 0.7, 5.0)
    inside = shapely.contains_xy(shapely.polygons(plan.outline), points(grid).reshape(-1, 2)).reshape(grid.count.shape)
    assert np.array_equal(grid.count, np.where(inside, 1.0, MIN_SHARE_OFF_SHEET))


def test_what_is_on_the_outline_is_not_inside() -> None:
    square = design([[-30.0, -30.0], [30.0, -30.0], [30.0, 30.0], [-30.0, 30.0]])
    grid = CellGrid(layout(square), square.lattice, 0.5, 2.0)
    # the grid passes through the middle between its points, so that it has no point on these sides, and is symmetric
    assert np.array_equal(grid.count, grid.count[::-1]) and np.array_equal(grid.count, grid.count[:, ::-1])
    shifted = CellGrid(layout(square), square.lattice, 60.0 / 119.0, 2.0)
    places = points(shifted)
    on = np.isclose(np.abs(places).max(axis=-1), 30.0)
    assert not (shifted.count[on] == 1.0).any()


def test_runs_end_where_owner_or_count_change() -> None:
    grid = CellGrid(layout(DENTED), DENTED.lattice, 1.3, 4.0)
    for owner, count, ends in zip(grid.owner, grid.count, grid.ends, strict=True):
        for j, end in enumerate(ends.tolist()):
            assert (owner[j:end] == owner[j]).all() and (count[j:end] == count[j]).all()
            assert end == len(owner) or owner[end] != owner[j] or count[end] != count[j]
