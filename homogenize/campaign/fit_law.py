"""From the samples of a campaign to the tables of a law."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.interpolate import PchipInterpolator, RBFInterpolator
from scipy.spatial import cKDTree

from homogenize.campaign.campaign import SampleRecord
from homogenize.cell.isotropy import isotropic_constants
from homogenize.cell.tube_directions import MIN_RESOLVED_CURL, averaged_directions
from homogenize.errors import CampaignError
from homogenize.law.anisotropy import anisotropy_size, sample_anisotropy
from homogenize.law.hermite_grid import Bools, Floats
from homogenize.law.law import Law
from homogenize.law.law_residuals import law_residuals, mesh_differences, unstable_tubes
from homogenize.law.law_table import QUANTITIES, QUANTITY_NAMES, LawTable, from_stored, quantity_units, to_stored
from homogenize.law.material import Material

QUANTITY_COUNT = len(QUANTITY_NAMES)
# of the grid that a law from scattered cells is carried onto: lengths, thicknesses, widths
SCATTERED_GRID = (14, 7, 4)


def fit_law(material: Material, records: Sequence[SampleRecord], made: dict[str, Any] | None = None) -> Law:
    """The law of a campaign; the same records give the same numbers.

    Raises
    ------
    CampaignError
        Too many cells have no answer.
    """
    tables, tests = [], []
    for stretch in material.stretches:
        own = [record for record in records if record.task.stretch == stretch]
        tables.append(_table(material, stretch, [record for record in own if not record.task.held_out]))
        tests.append([(record.task, _quantities(record)) for record in own if record.task.held_out])
    samples = [record_data(record) for record in records]
    missed = law_residuals(tables, tests, material.plan.kind)
    for name, entry in missed.items():
        own_samples = [each for each in samples if f"{each['stretch']:g}" == name]
        entry |= {"meshes": mesh_differences(own_samples), "tubes": unstable_tubes(own_samples)}
    return Law(material, tuple(tables), samples, missed, made or {})


def sample_quantities(sample: dict[str, Any], stretch: float) -> Floats:
    """(Q,) what the law holds of one sample.

    Directions are averaged over the first and the last, 0 and 30 degrees: a sixfold function has its extremes there.
    Stars without threefold symmetry have six directions, and all of them are averaged.
    The membrane's constants are those of the isotropic tensor nearest to the natural tubes'.
    """
    chosen = averaged_directions(sample["natural_curvature"])
    ends = {
        name: np.array(sample[name], dtype=float)[chosen]
        for name in ("natural_curvature", "natural_hoop", "natural_axial", "natural_membrane", "bending")
    }
    a11, a12 = isotropic_constants(ends["natural_membrane"].mean(axis=0))
    offset = sample["natural_centre_offset_mm"]
    curled = abs(ends["natural_curvature"].mean()) * sample["spacing_mm"] > MIN_RESOLVED_CURL
    bare = sample["length_mm"] == 0.0
    found = {
        "lam": 1.0 / stretch if bare else sample["lam"],
        "lam_n": 1.0 / stretch if bare else float(np.sqrt(ends["natural_hoop"] * ends["natural_axial"]).mean()),
        "kappa": 0.0 if bare else float(ends["natural_curvature"].mean()),
        "bending": float(ends["bending"].mean()),
        "a11": a11,
        "a12": a12,
        "c3": float(np.array(sample["sixfold"], dtype=float)) if curled else 0.0,
        "offset_mm": 0.0 if bare or offset is None else float(np.mean(np.array(offset, dtype=float)[chosen])),
    }
    return np.array([found[name] for name in QUANTITY_NAMES])


def sample_problem(record: SampleRecord) -> str | None:
    """Why a cell cannot be used, or None."""
    if record.failed is not None or record.sample is None:
        return record.failed or "no answer"
    bump = float(np.array(record.sample["natural_bump_mm"], dtype=float).min())
    if record.sample["length_mm"] > 0 and not bump > 0:
        return f"the star is not up: bump {bump:.3g} mm"
    values = sample_quantities(record.sample, record.task.stretch)
    for name, value in zip(QUANTITY_NAMES, values, strict=True):
        if not np.isfinite(value) or (QUANTITIES[name].form == "log" and value <= 0):
            return f"{name} = {value:.3g} is no answer"
    return None


def record_data(record: SampleRecord) -> dict[str, Any]:
    """A record for the law's file: what goes in and what comes out, without what differs from run to run."""
    sample = record.sample and {k: v for k, v in record.sample.items() if k != "seconds"}
    return {
        "stretch": record.task.stretch,
        "held_out": record.task.held_out,
        "length_mm": record.task.length_mm,
        "thickness_mm": record.task.thickness_mm,
        "width_mm": record.task.width_mm,
        "problem": sample_problem(record),
        "sample": sample,
    }


def _usable(record: SampleRecord, count: int) -> Floats | None:
    """(Q + K + 2 W,) quantities, what differs between directions (`count`, K) and relief; None without an answer."""
    if sample_problem(record) is not None or record.sample is None:
        return None
    bare = record.task.length_mm == 0.0
    own = sample_anisotropy(record.sample) if count and not bare else np.zeros(count)
    relief = np.array(record.sample["relief"], dtype=float).ravel()
    return np.concatenate([sample_quantities(record.sample, record.task.stretch), own, np.where(bare, 0.0, relief)])


def _quantities(record: SampleRecord) -> Floats | None:
    found = _usable(record, 0)
    return None if found is None else found[:QUANTITY_COUNT]


def _table(material: Material, stretch: float, records: list[SampleRecord]) -> LawTable:
    count = anisotropy_size(material.lattice)
    rows = {record.task: _usable(record, count) for record in records}
    fabric = next((found for task, found in rows.items() if task.length_mm == 0.0), None)
    if fabric is None:
        reason = next((sample_problem(record) for record in records if record.task.length_mm == 0.0), "not solved")
        raise CampaignError(f"the bare fabric at stretch {stretch:g} has no answer: {reason}")
    sizes = {(t.length_mm, t.thickness_mm, t.width_mm): found for t, found in rows.items() if t.length_mm > 0}
    if 2 * sum(found is not None for found in sizes.values()) < len(sizes):
        reason = next(why for record in records if (why := sample_problem(record)) is not None)
        raise CampaignError(f"fewer than half of the cells at stretch {stretch:g} have an answer; the first: {reason}")
    if material.plan.kind == "grid":
        return _from_grid(material, stretch, fabric, sizes)
    return _from_scattered(material, stretch, fabric, sizes)


def _from_grid(
    material: Material, stretch: float, fabric: Floats, sizes: dict[tuple[float, float, float], Floats | None]
) -> LawTable:
    plan = material.plan
    lengths = (0.0, *(v for v in plan.lengths_mm if v > 0))
    axes = (np.array(lengths), np.array(plan.thicknesses_mm), np.array(plan.widths_mm))
    nodes = np.full((*(len(axis) for axis in axes), len(fabric)), np.nan)
    nodes[0] = fabric
    for i, length in enumerate(lengths[1:], start=1):
        for j, h in enumerate(plan.thicknesses_mm):
            for k, w in enumerate(plan.widths_mm):
                found = sizes[length, h, w]
                if found is not None:
                    nodes[i, j, k] = found
    good = np.isfinite(nodes).all(axis=-1)
    unit = quantity_units(fabric[:QUANTITY_COUNT], material.lattice.spacing_mm)
    stored = fill_failed_rows(axes[0], _stored(nodes, unit), good)
    whole = np.where(good[..., None], nodes, _known(stored, unit))
    return _of_rows(material, stretch, axes, whole, good, unit)


def fill_failed_rows(lengths: Floats, stored: Floats, good: Bools) -> Floats:
    """Rows (n0, n1, n2, columns) with those of failed cells made up from the others on their line of lengths.

    Beyond the last answer on a line, that answer stands; there the law says that it does not reach.
    """
    whole = stored.copy()
    for j, k in np.ndindex(good.shape[1:]):
        fine = good[:, j, k]
        if not fine.all():
            known = lengths[fine]
            if len(known) == 1:
                whole[:, j, k] = stored[fine, j, k]
            else:
                along = PchipInterpolator(known, stored[fine, j, k])
                whole[~fine, j, k] = along(np.minimum(lengths[~fine], known[-1]))
    return whole


def _from_scattered(
    material: Material, stretch: float, fabric: Floats, sizes: dict[tuple[float, float, float], Floats | None]
) -> LawTable:
    """Cubic radial functions through all cells, carried onto a grid that begins where the law does.

    A node whose nearest cell has no answer has none.
    """
    low, high = np.transpose(material.plan.ranges)
    first = material.plan.least_length_mm(material.lattice.spacing_mm) or high[0] / (SCATTERED_GRID[0] - 1)
    axes = (
        np.array([0.0, *np.linspace(first, high[0], SCATTERED_GRID[0] - 1)]),
        np.geomspace(low[1], high[1], SCATTERED_GRID[1]),
        np.geomspace(low[2], high[2], SCATTERED_GRID[2]),
    )
    unit = quantity_units(fabric[:QUANTITY_COUNT], material.lattice.spacing_mm)
    places, rows = scattered_points(sizes, fabric, axes)
    grid = unit_cube_places(np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3), axes)
    failed = np.array([size for size, found in sizes.items() if found is None]).reshape(-1, 3)
    known, unknown = (cKDTree(cells).query(grid)[0] for cells in (places, unit_cube_places(failed, axes)))
    good = (known <= unknown).reshape(SCATTERED_GRID)
    good[0] = True
    stored = radial_interpolator(places, _stored(rows, unit))(grid).reshape(*SCATTERED_GRID, -1)
    nodes = _known(fill_failed_rows(axes[0], stored, good), unit)
    nodes[0] = fabric
    return _of_rows(material, stretch, axes, nodes, good, unit)


def _of_rows(
    material: Material, stretch: float, axes: tuple[Floats, Floats, Floats], rows: Floats, good: Bools, unit: Floats
) -> LawTable:
    """The table of rows (n0, n1, n2, Q + K + 2 W)."""
    values, directional, relief = np.split(
        rows, np.cumsum([QUANTITY_COUNT, anisotropy_size(material.lattice)]), axis=-1
    )
    reliefs = relief.reshape(*relief.shape[:-1], 2, -1)
    return LawTable(stretch, material.lattice.spacing_mm, axes, values, reliefs, good, unit, directional)


def _stored(rows: Floats, unit: Floats) -> Floats:
    """Rows (..., Q + K + 2 W) in the forms that are interpolated; all but quantities are as they are."""
    return np.concatenate([to_stored(rows[..., :QUANTITY_COUNT], unit), rows[..., QUANTITY_COUNT:]], axis=-1)


def _known(stored: Floats, unit: Floats) -> Floats:
    """The inverse of `_stored`."""
    return np.concatenate([from_stored(stored[..., :QUANTITY_COUNT], unit), stored[..., QUANTITY_COUNT:]], axis=-1)


def scattered_points(
    sizes: dict[tuple[float, float, float], Floats | None], fabric: Floats, axes: tuple[Floats, Floats, Floats]
) -> tuple[Floats, Floats]:
    """Places (n, 3) in the unit cube and rows (n, Q + K + 2 W), with bare fabric all over the side of length 0."""
    known = {size: found for size, found in sizes.items() if found is not None}
    bare = [(0.0, float(h), float(w)) for h in axes[1][::2] for w in axes[2]]
    rows = np.vstack([np.array(list(known.values())), np.tile(fabric, (len(bare), 1))])
    return unit_cube_places(np.array([*known, *bare]), axes), rows


def unit_cube_places(points: Floats, axes: tuple[Floats, Floats, Floats]) -> Floats:
    """Sizes (n, 3) as places in the unit cube: lengths as they are, thickness and width by their logarithms."""
    x = np.column_stack([points[:, 0], np.log(points[:, 1]), np.log(points[:, 2])])
    low, high = (np.array([axes[0][e], np.log(axes[1][e]), np.log(axes[2][e])]) for e in (0, -1))
    return (x - low) / (high - low)


def radial_interpolator(places: Floats, values: Floats) -> RBFInterpolator:
    """Cubic radial functions with a linear part."""
    return RBFInterpolator(places, values, kernel="cubic", degree=1)
