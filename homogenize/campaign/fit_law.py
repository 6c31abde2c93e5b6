"""From the samples of a campaign to the tables of a law."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any

import numpy as np
from scipy.interpolate import PchipInterpolator, RBFInterpolator
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Bools, Floats
from asterism.homogenize.campaign.campaign import SampleRecord
from asterism.homogenize.cell.effective_stiffness import isotropic_constants
from asterism.homogenize.cell.tube_directions import MIN_RESOLVED_CURL, averaged_directions
from asterism.homogenize.errors import CampaignError
from asterism.homogenize.law.anisotropy import anisotropy_size, sample_anisotropy
from asterism.homogenize.law.axes import AXES, coordinates, named_sizes
from asterism.homogenize.law.law import Law
from asterism.homogenize.law.law_residuals import broken_symmetry, law_residuals, mesh_differences, unstable_tubes
from asterism.homogenize.law.law_table import (
    QUANTITIES,
    QUANTITY_NAMES,
    LawTable,
    from_stored,
    quantity_units,
    to_stored,
)
from asterism.homogenize.law.material import Material
from asterism.homogenize.law.plan import Sizes

_Q = len(QUANTITY_NAMES)
_SCATTERED_SHAPE = tuple(axis.scattered_nodes for axis in AXES)
# nodes along each axis at which scattered cells meet the bare fabric; of more nodes, every other one
MAX_BARE_NODES = 4
CellRows = Mapping[Sizes, Floats | None]


def fit_law(material: Material, records: Sequence[SampleRecord], made: dict[str, Any] | None = None) -> Law:
    """The law of a campaign. The same records give the same numbers.

    Parameters
    ----------
    records : in the order of `material.tasks()`.
    made : versions, command, machine and seconds, for the law's file.

    Raises
    ------
    CampaignError
        Too many cells have no answer.
    """
    tables, tests = [], []
    for stretch in material.stretches:
        own = [record for record in records if record.task.stretch == stretch]
        tables.append(_table(material, stretch, [record for record in own if not record.task.held_out]))
        tests.append([(record.task, _test_quantities(record)) for record in own if record.task.held_out])
    samples = [_record_data(record) for record in records]
    errors = law_residuals(tables, tests, material.plan.kind)
    for name, entry in errors.items():
        own_samples = [each for each in samples if f"{each['stretch']:g}" == name]
        entry |= {"meshes": mesh_differences(own_samples), "tubes": unstable_tubes(own_samples)}
        entry |= {"symmetry": broken_symmetry(own_samples)}
    return Law(material, tuple(tables), samples, errors, made or {})


def _test_quantities(record: SampleRecord) -> Floats | None:
    row = _sample_row(record, 0)
    return None if row is None else row[:_Q]


def _table(material: Material, stretch: float, records: list[SampleRecord]) -> LawTable:
    columns = anisotropy_size(material.lattice)
    rows = {record.task: _sample_row(record, columns) for record in records}
    fabric = next((row for task, row in rows.items() if task.is_bare), None)
    if fabric is None:
        reason = next((_sample_problem(record) for record in records if record.task.is_bare), "not solved")
        raise CampaignError(f"the bare fabric at stretch {stretch:g} has no answer: {reason}")
    stars = {task.sizes: row for task, row in rows.items() if not task.is_bare}
    if 2 * sum(row is not None for row in stars.values()) < len(stars):
        reason = next(why for record in records if (why := _sample_problem(record)) is not None)
        raise CampaignError(f"fewer than half of the cells at stretch {stretch:g} have an answer; the first: {reason}")
    units = quantity_units(fabric[:_Q], material.lattice.spacing_mm)
    fit = _grid_rows if material.plan.kind == "grid" else _scattered_rows
    axis_nodes, whole, solved = fit(material, fabric, stars, units)
    quantities, anisotropies, corrugations = np.split(whole, np.cumsum([_Q, columns]), axis=-1)
    corrugations = corrugations.reshape(*corrugations.shape[:-1], 2, -1)
    spacing = material.lattice.spacing_mm
    return LawTable(stretch, spacing, axis_nodes, quantities, corrugations, solved, units, anisotropies)


def _grid_rows(
    material: Material, fabric: Floats, stars: CellRows, units: Floats
) -> tuple[tuple[Floats, ...], Floats, Bools]:
    """Axis nodes, rows (n1, ..., nA, Q + K + 2 W) and solved nodes (n1, ..., nA) of a grid of cells."""
    plan = material.plan
    lengths, *others = ([v for v in plan.nodes(axis) if v > 0] for axis in AXES)
    axis_nodes = tuple(np.array(nodes) for nodes in ([0.0, *lengths], *others))
    rows = np.full((*(len(nodes) for nodes in axis_nodes), len(fabric)), np.nan)
    rows[0] = fabric
    for index in np.ndindex(len(lengths), *(len(nodes) for nodes in others)):
        sizes = tuple(nodes[i] for nodes, i in zip((lengths, *others), index, strict=True))
        if (row := stars[sizes]) is not None:
            rows[(index[0] + 1, *index[1:])] = row
    solved = np.isfinite(rows).all(axis=-1)
    stored = fill_failed_rows(axis_nodes[0], _to_stored(rows, units), solved)
    return axis_nodes, np.where(solved[..., None], rows, _from_stored(stored, units)), solved


def fill_failed_rows(lengths: Floats, stored: Floats, solved: Bools) -> Floats:
    """Rows (n1, ..., nA, columns) with failed cells filled in from the others on their line of lengths.

    Rows beyond the last answer on a line repeat that answer; these nodes lie outside the range of the law.
    """
    whole = stored.copy()
    for across in np.ndindex(solved.shape[1:]):
        line = (slice(None), *across)
        fine = solved[line]
        if not fine.all():
            known = lengths[fine]
            if len(known) == 1:
                whole[line] = stored[(fine, *across)]
            else:
                along = PchipInterpolator(known, stored[(fine, *across)])
                whole[(~fine, *across)] = along(np.minimum(lengths[~fine], known[-1]))
    return whole


def _scattered_rows(
    material: Material, fabric: Floats, stars: CellRows, units: Floats
) -> tuple[tuple[Floats, ...], Floats, Bools]:
    """As `_grid_rows`, of scattered cells: cubic radial functions through all cells give the rows at the nodes.

    The grid begins at the shortest arms that the law covers. A node is solved if the nearest cell is.
    """
    (_, longest), *others = material.plan.ranges
    count = AXES[0].scattered_nodes - 1
    first = material.plan.min_length_mm(material.lattice.spacing_mm) or longest / count
    axis_nodes = (
        np.array([0.0, *np.linspace(first, longest, count)]),
        *(np.geomspace(low, high, axis.scattered_nodes) for axis, (low, high) in zip(AXES[1:], others, strict=True)),
    )
    places, rows = scattered_points(stars, fabric, axis_nodes)
    nodes = np.stack(np.meshgrid(*axis_nodes, indexing="ij"), axis=-1).reshape(-1, len(AXES))
    grid = unit_cube_places(nodes, axis_nodes)
    failed = np.array([sizes for sizes, row in stars.items() if row is None]).reshape(-1, len(AXES))
    known, unknown = (cKDTree(cells).query(grid)[0] for cells in (places, unit_cube_places(failed, axis_nodes)))
    solved = (known <= unknown).reshape(_SCATTERED_SHAPE)
    solved[0] = True
    stored = radial_interpolator(places, _to_stored(rows, units))(grid).reshape(*_SCATTERED_SHAPE, -1)
    whole = _from_stored(fill_failed_rows(axis_nodes[0], stored, solved), units)
    whole[0] = fabric
    return axis_nodes, whole, solved


def _to_stored(rows: Floats, units: Floats) -> Floats:
    """Rows (..., Q + K + 2 W) with the quantities in their interpolated forms."""
    return np.concatenate([to_stored(rows[..., :_Q], units), rows[..., _Q:]], axis=-1)


def _from_stored(stored: Floats, units: Floats) -> Floats:
    """The inverse of `_to_stored`."""
    return np.concatenate([from_stored(stored[..., :_Q], units), stored[..., _Q:]], axis=-1)


def scattered_points(stars: CellRows, fabric: Floats, axis_nodes: Sequence[Floats]) -> tuple[Floats, Floats]:
    """Places (n, A) in the unit cube and rows (n, Q + K + 2 W) of all answers.

    The bare fabric stands at many places of the side with length 0.
    """
    known = {sizes: row for sizes, row in stars.items() if row is not None}
    thinned = [nodes[::2] if len(nodes) > MAX_BARE_NODES else nodes for nodes in axis_nodes[1:]]
    bare = [(0.0, *map(float, others)) for others in product(*thinned)]
    rows = np.vstack([np.array(list(known.values())), np.tile(fabric, (len(bare), 1))])
    return unit_cube_places(np.array([*known, *bare]), axis_nodes), rows


def unit_cube_places(sizes: Floats, axis_nodes: Sequence[Floats]) -> Floats:
    """(n, A) places in the unit cube of sizes (n, A): coordinates over the range of the nodes."""
    low, high = coordinates(np.array([[nodes[end] for nodes in axis_nodes] for end in (0, -1)]))
    return np.asarray((coordinates(sizes) - low) / (high - low))


def radial_interpolator(places: Floats, values: Floats) -> RBFInterpolator:
    """Cubic radial functions with a linear part."""
    return RBFInterpolator(places, values, kernel="cubic", degree=1)


def sample_quantities(sample: dict[str, Any], stretch: float) -> Floats:
    """(Q,) the quantities `law_table.QUANTITY_NAMES` of one sample.

    With threefold symmetry, means over directions are those of 0 and 30 degrees, where a sixfold function has its
    extremes. Otherwise they are those of all six directions. The membrane constants are those of the isotropic tensor
    nearest to the mean of the natural tubes.

    Parameters
    ----------
    sample : plain data of `homogenize.cell.sample.Sample`.
    stretch : of the fabric.
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
    quantities = {
        "lam": 1.0 / stretch if bare else sample["lam"],
        "lam_n": 1.0 / stretch if bare else float(np.sqrt(ends["natural_hoop"] * ends["natural_axial"]).mean()),
        "kappa": 0.0 if bare else float(ends["natural_curvature"].mean()),
        "bending": float(ends["bending"].mean()),
        "a11": a11,
        "a12": a12,
        "c3": float(np.array(sample["sixfold"], dtype=float)) if curled else 0.0,
        "offset_mm": 0.0 if bare or offset is None else float(np.mean(np.array(offset, dtype=float)[chosen])),
    }
    return np.array([quantities[name] for name in QUANTITY_NAMES])


def _sample_problem(record: SampleRecord) -> str | None:
    """Why the fit cannot use a sample, in one line; None if it can."""
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


def _sample_row(record: SampleRecord, columns: int) -> Floats | None:
    """(Q + K + 2 W,) quantities, differences between directions (K = `columns`) and corrugation; None if unusable."""
    if _sample_problem(record) is not None or record.sample is None:
        return None
    bare = record.task.is_bare
    anisotropy = sample_anisotropy(record.sample) if columns and not bare else np.zeros(columns)
    corrugation = np.array(record.sample["relief"], dtype=float).ravel()
    quantities = sample_quantities(record.sample, record.task.stretch)
    return np.concatenate([quantities, anisotropy, np.where(bare, 0.0, corrugation)])


def _record_data(record: SampleRecord) -> dict[str, Any]:
    """A record as plain data for the law's file, without the times, which differ from run to run."""
    sample = record.sample and {k: v for k, v in record.sample.items() if k != "seconds"}
    return {
        "stretch": record.task.stretch,
        "held_out": record.task.held_out,
        **named_sizes(record.task.sizes),
        "problem": _sample_problem(record),
        "sample": sample,
    }
