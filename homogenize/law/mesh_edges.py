"""A law on meshes of other edge lengths, and its limit for an infinitely fine mesh.

Cells on a coarser grid of sizes are solved with several edge lengths of their mesh. Their differences from the law's
own cells, in the forms that the law interpolates, are smooth functions of the sizes and of the edge. They are added to
the law's table. Bare fabric has no difference.

The limit follows from the three finest edges (Richardson 1911): the error of the natural curvature is `c edge^p` with
the observed order p. Where p is outside of its limits the cells show no order, and there is no limit. The other
quantities change little, and are extrapolated with the order 1 of the stress at the tips of the arms, which is singular
(docs/explanation/mesh.md).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from asterism.equilibrium.arrays import Bools, Floats
from asterism.homogenize.errors import LawError
from asterism.homogenize.law.axes import AXES, coordinates
from asterism.homogenize.law.hermite_grid import HermiteGrid
from asterism.homogenize.law.law_table import QUANTITY_NAMES, LawTable, from_stored, to_stored

# an observed order of the natural curvature outside of these limits gives no limit
MIN_CURVATURE_ORDER = 0.5
MAX_CURVATURE_ORDER = 2.5
# order of what is not the curvature, and of curvatures that change too little to show one
TIP_ORDER = 1.0
# natural curvature times spacing: smaller changes between the first and the last of three edges show no order
MIN_OBSERVED_CHANGE = 0.01
# an order needs so many edges
EDGES_OF_ORDER = 3
# orders among which the observed one is sought
_ORDERS = np.linspace(0.05, 4.0, 400)
# relative difference of edge lengths that count as equal
EDGE_TOLERANCE = 1e-3
# the sixfold term stays that of the law's own cells. In the cell of the gallery's tube it falls by a factor of 2.7 from
# edges of 1.92 to 0.48 mm, but the tube rolls about the same axes on all of these meshes
_SIXFOLD = QUANTITY_NAMES.index("c3")
_NATURAL = QUANTITY_NAMES.index("kappa")


@dataclass(frozen=True)
class EdgeTables:
    """Tables of a law from cells whose mesh has another edge length.

    Attributes
    ----------
    edge_mm : of the cells' mesh.
    tables : for some or all stretches of the law, on a coarser grid of sizes.
    """

    edge_mm: float
    tables: tuple[LawTable, ...]


def whole_edge(edge_mm: float, spacing_mm: float) -> float:
    """mm, the edge of a mesh with a whole number of edges between adjacent stars; 0 for the limit.

    Examples
    --------
    >>> round(whole_edge(2.0, 18.0), 6), whole_edge(0.0, 18.0)
    (2.0, 0.0)
    """
    return spacing_mm / max(1, round(spacing_mm / edge_mm)) if edge_mm else 0.0


def table_at_edge(table: LawTable, own_edge: float, others: Sequence[tuple[float, LawTable]], edge: float) -> LawTable:
    """The table on a mesh of another edge length.

    Each node has the edges whose cells lie around it. It counts as solved between these edges, and below the finest of
    three or more if its curvature shows an order.

    Parameters
    ----------
    own_edge : mm, of the table.
    others : edges (mm) and tables of other edges, at least two for a limit.
    edge : mm; 0 for an infinitely fine mesh.

    Raises
    ------
    LawError
        The edge is outside of the range of the tables.
    """
    ordered = sorted(others, key=lambda pair: pair[0])
    ends = [own_edge, *(each for each, _ in ordered)]
    if edge > max(ends) * (1.0 + EDGE_TOLERANCE):
        raise LawError(f"mesh edge {edge:.3g} mm: the law covers 0 to {max(ends):.3g} mm", field="mesh.edge_mm")
    if edge < min(ends) * (1.0 - EDGE_TOLERANCE) and len(ends) < EDGES_OF_ORDER:
        covered = f"{min(ends):.3g} to {max(ends):.3g} mm"
        raise LawError(f"mesh edge {edge:.3g} mm: the law covers {covered}", field="mesh.edge_mm")
    nodes = np.stack(np.meshgrid(*table.axis_nodes, indexing="ij"), axis=-1)
    sizes = nodes.reshape(-1, nodes.shape[-1])
    stored = table.stored_rows(sizes)
    along = [(own_edge, stored, np.ones(len(sizes), dtype=bool))]
    along += [(each, stored + _change(table, other, sizes), other.covers(sizes)) for each, other in ordered]
    along.sort(key=lambda entry: entry[0])
    edges, values, covers = (np.array(part) for part in zip(*along, strict=True))
    rows, solved = stored.copy(), sizes[:, 0] == 0.0
    for pattern in np.unique(covers.T, axis=0):  # nodes that have cells of the same edges
        here = (pattern == covers.T).all(axis=1) & ~solved
        known = values[pattern][:, here]
        rows[here], has_value = _at(edges[pattern], known, edge, table)
        solved[here] = has_value
    rows[:, _SIXFOLD] = stored[:, _SIXFOLD]
    return table.with_stored_rows(rows, table.solved & solved.reshape(table.solved.shape))


def _at(edges: Floats, along: Floats, edge: float, table: LawTable) -> tuple[Floats, Bools]:
    """Rows (N, C) at an edge, from those at increasing edges (E, N, C); (N,) whether there is a value."""
    count = along.shape[1]
    if edges[0] * (1.0 - EDGE_TOLERANCE) <= edge <= edges[-1] * (1.0 + EDGE_TOLERANCE):
        if len(edges) == 1:
            return along[0], np.ones(count, dtype=bool)
        from scipy.interpolate import PchipInterpolator  # slow to import, and most previews do without

        inside = np.clip(edge, edges[0], edges[-1])
        return np.asarray(PchipInterpolator(edges, along)(inside)), np.ones(count, dtype=bool)
    if edge > edges[-1] or len(edges) < EDGES_OF_ORDER:
        return along[0], np.zeros(count, dtype=bool)
    return _below(edges[:EDGES_OF_ORDER], along[:EDGES_OF_ORDER], edge, table)


def curvature_orders(edges: Floats, kappa: Floats) -> Floats:
    """(N,) order p of curvatures (3, N) at three edges, the finest first; NaN if they do not converge with an order.

    Examples
    --------
    >>> edges = np.array([0.5, 1.0, 2.0])
    >>> curvature_orders(edges, 0.03 + 0.001 * edges[:, None] ** [1.0, 2.0]).round(2)
    array([1., 2.])
    """
    fine, middle, coarse = edges
    seen = (coarse**_ORDERS - fine**_ORDERS) / (middle**_ORDERS - fine**_ORDERS)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = (kappa[2] - kappa[0]) / (kappa[1] - kappa[0])
    return np.asarray(np.interp(ratio, seen, _ORDERS, left=np.nan, right=np.nan))


def _change(table: LawTable, other: LawTable, sizes: Floats) -> Floats:
    """(N, C) what another edge changes at sizes (N, A), from the nodes of its coarser grid."""
    nodes = np.stack(np.meshgrid(*other.axis_nodes, indexing="ij"), axis=-1)
    flat = nodes.reshape(-1, nodes.shape[-1])
    values = replace(other, units=table.units).stored_rows(flat) - table.stored_rows(flat)
    values[flat[:, 0] == 0.0] = 0.0
    axes = [axis.coordinate(each) for axis, each in zip(AXES, other.axis_nodes, strict=True)]
    grid = HermiteGrid(axes, values.reshape(*nodes.shape[:-1], -1), ["monotone"] * values.shape[1])
    low, high = (np.array([each[end] for each in other.axis_nodes]) for end in (0, -1))
    return grid(coordinates(np.clip(sizes, low, high)))[0]


def _below(edges: Floats, along: Floats, edge: float, table: LawTable) -> tuple[Floats, Bools]:
    """Rows (N, C) below the finest of three edges, from those on them (3, N, C); (N,) where there is an order."""
    count = len(QUANTITY_NAMES)
    kappa = np.array([from_stored(each[:, :count], table.units)[:, _NATURAL] for each in along]) * table.spacing_mm
    orders = curvature_orders(edges, kappa)
    has_order = (orders >= MIN_CURVATURE_ORDER) & (orders <= MAX_CURVATURE_ORDER)
    is_still = np.abs(kappa[2] - kappa[0]) < MIN_OBSERVED_CHANGE
    power = np.where(has_order & ~is_still, orders, TIP_ORDER)
    rows = along[0] - _share(edges, edge, TIP_ORDER) * (along[1] - along[0])
    # the curvature has an order, not the form that is interpolated
    curl = kappa[0] - _share(edges, edge, power) * (kappa[1] - kappa[0])
    values = from_stored(rows[:, :count], table.units)
    values[:, _NATURAL] = curl / table.spacing_mm
    rows[:, _NATURAL] = to_stored(values, table.units)[:, _NATURAL]
    return rows, has_order | is_still


def _share(edges: Floats, edge: float, power: Floats | float) -> Floats:
    """How far an edge is beyond the finest one, over the step from there to the next, for an error `c edge^power`."""
    fine, middle = edges[:2]
    return np.asarray((fine**power - edge**power) / (middle**power - fine**power))
