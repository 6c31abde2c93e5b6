"""Triangles over a grid of heights, with a smooth border where the surface ends within the grid."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from asterism.equilibrium.arrays import Bools, Floats, Ints
from asterism.fitting.disk import border_edges, directed_edges

# rounds that even out the steps of the border over some cells, and their two shares: the border does not shrink
# (Taubin, A signal processing approach to fair surface design, 1995)
BORDER_ROUNDS = 10
SMOOTHING, UNSHRINKING = 0.5, 0.53
# rounds in which the inner vertices follow
INNER_ROUNDS = 5
# rounds in which heights are continued beyond the border, a cell each
CONTINUED_CELLS = 2


def height_mesh(heights_mm: Floats, x_mm: Floats, y_mm: Floats) -> tuple[Floats, Ints]:
    """Vertices (V, 3) mm and triangles (T, 3) over a grid.

    Parameters
    ----------
    heights_mm : (m, n), nan where there is no surface.
    x_mm, y_mm : (n,) and (m,), increasing.

    Examples
    --------
    >>> vertices, triangles = height_mesh(np.array([[0.0, 1.0], [2.0, np.nan]]), np.arange(2.0), np.arange(2.0))
    >>> triangles.tolist()
    [[0, 1, 2]]
    """
    number = np.arange(heights_mm.size).reshape(heights_mm.shape)
    corners = np.stack([number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]], axis=-1).reshape(-1, 4)
    filled = np.isfinite(heights_mm.ravel())[corners]
    whole, cut = corners[filled.all(axis=1)], filled.sum(axis=1) == 3
    # the three corners in their order
    partial = corners[cut][filled[cut]].reshape(-1, 3)
    triangles = np.concatenate([whole[:, :3], whole[:, [0, 2, 3]], partial])
    grid = np.stack(np.meshgrid(x_mm, y_mm), axis=-1).reshape(-1, 2)
    heights = heights_mm.ravel()
    if not filled.all() and len(triangles):
        is_edge = np.ones(heights_mm.shape, dtype=bool)
        is_edge[1:-1, 1:-1] = False
        step = np.array([np.diff(x_mm).mean(), np.diff(y_mm).mean()])
        grid = _smoothed(grid, triangles, is_edge.ravel(), step)
        heights = _interpolated(_continued(heights_mm), x_mm, y_mm, grid)
    return np.column_stack([grid, np.nan_to_num(heights)]), triangles


def _smoothed(grid: Floats, triangles: Ints, is_edge: Bools, step: Floats) -> Floats:
    """The places (V, 2) with a smooth border half a cell further out, but at the edge of the grid; others follow."""
    border = border_edges(triangles)
    along, beside = _sums(border, len(grid)), np.bincount(border.ravel(), minlength=len(grid))
    moving = (beside == 2) & ~is_edge
    places = grid.copy()
    for _ in range(BORDER_ROUNDS):
        for share in (SMOOTHING, -UNSHRINKING):
            places[moving] += share * (0.5 * (along @ places) - places)[moving]
    # the surface is on the left of its border: it ends between the last height and the next, missing one
    chords = np.zeros_like(places)
    for end in (0, 1):
        np.add.at(chords, border[:, end], places[border[:, 1]] - places[border[:, 0]])
    outwards = np.column_stack([chords[:, 1], -chords[:, 0]])
    outwards /= np.maximum(np.linalg.norm(outwards, axis=1, keepdims=True), 1e-300)
    places[moving] += (0.5 * np.abs(outwards * step).max(axis=1, keepdims=True) * outwards)[moving]
    edges = directed_edges(triangles)
    around, count = _sums(edges, len(grid)), np.bincount(edges.ravel(), minlength=len(grid))
    inner = (count > 0) & (beside == 0) & ~is_edge
    for _ in range(INNER_ROUNDS):
        places[inner] = (around @ places)[inner] / count[inner, None]
    return places


def _sums(pairs: Ints, size: int) -> sp.csr_array:
    """The matrix that adds, for each vertex, the values of those that it is paired with."""
    both = np.concatenate([pairs, pairs[:, ::-1]])
    return sp.coo_array((np.ones(len(both)), (both[:, 0], both[:, 1])), shape=(size, size)).tocsr()


def _continued(heights: Floats) -> Floats:
    """Heights (m, n) continued in straight lines beyond their border; 0 further away."""
    heights = heights.copy()
    for _ in range(CONTINUED_CELLS):
        around = np.lib.stride_tricks.sliding_window_view(np.pad(heights, 2, constant_values=np.nan), (5, 5))
        steps = ((2, 3), (2, 1), (3, 2), (1, 2))
        guesses = np.stack([2.0 * around[..., i, j] - around[..., 2 * i - 2, 2 * j - 2] for i, j in steps])
        known = np.isfinite(guesses)
        mean = np.where(known, guesses, 0.0).sum(axis=0) / np.maximum(known.sum(axis=0), 1)
        heights = np.where(np.isfinite(heights) | ~known.any(axis=0), heights, mean)
    return np.nan_to_num(heights)


def _interpolated(heights: Floats, x: Floats, y: Floats, places: Floats) -> Floats:
    """(V,) heights at places (V, 2)."""
    from scipy.interpolate import RegularGridInterpolator

    inside = np.clip(places, [x[0], y[0]], [x[-1], y[-1]])
    return np.asarray(RegularGridInterpolator((y, x), heights)(inside[:, ::-1]))
