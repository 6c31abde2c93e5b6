"""The universal law of one material: a law of the usual kind, whose table comes from the groups and not from cells.

A preview evaluates the table, which is as fast as every other law and gives the same derivatives.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from equilibrium.arrays import Floats
from homogenize.errors import LawError
from homogenize.law.axes import AXES
from homogenize.law.law import Law
from homogenize.law.law_table import QUANTITY_NAMES, LawTable, quantity_units
from homogenize.law.material import Material
from homogenize.universal.cell_rows import WAVE_COUNT, quantity_scales
from homogenize.universal.groups import GROUPS, star_groups
from homogenize.universal.law_errors import left_out_errors
from homogenize.universal.universal_law import UniversalLaw, bare_quantities, within_limits
from pattern.design.design import Design
from pattern.design.lattice import Lattice

# what the cells of the universal law have in common
COMMON = {"fabric.poisson": 0.3, "fabric.model": "neo-hookean", "fabric.bending": "paper", "plastic.poisson": 0.3}
# nodes of the table: lengths after the bare fabric, thicknesses, widths
NODE_COUNTS = (16, 9, 5)
# the table covers the sizes of a design and as many times more and less in thickness and width
SIZE_MARGIN = 1.35
# cells whose left-out errors give the error at a star
NEAREST_CELLS = 12
STATED_QUANTITIES = ("lam_n", "kappa", "bending")


@dataclass(frozen=True)
class UniversalLawErrors:
    """Errors that the universal law has at the cells nearest to the stars of a design, each left out of the law.

    Attributes
    ----------
    percent : (S, 3) rms of `STATED_QUANTITIES` for each star.
    covered : (S,) the star is in the range of the universal law.
    outside : why the first star that is not covered is outside; empty if all are.
    """

    percent: Floats
    covered: np.ndarray
    outside: str

    @property
    def typical_percent(self) -> dict[str, float]:
        """Rms over the covered stars, for each of `STATED_QUANTITIES`."""
        known = self.percent[self.covered]
        rms = np.sqrt((known**2).mean(axis=0)) if len(known) else np.full(len(STATED_QUANTITIES), np.inf)
        return dict(zip(STATED_QUANTITIES, map(float, rms), strict=True))


def check_common(design: Design) -> None:
    """Raise LawError if a design differs from the cells of the universal law in what is no group."""
    for key, value in COMMON.items():
        section, name = key.split(".")
        own = getattr(getattr(design, section), name)
        if own != value:
            raise LawError(f"{key} = {own}: the universal law is for {value}", field=key)
    sx, sy = design.fabric.stretch_xy
    if sx != sy:
        raise LawError(f"fabric.stretch = {[sx, sy]}: the universal law is for equal stretches", field="fabric.stretch")
    lattice, plain = design.lattice, Lattice()
    turn = (lattice.orientation_deg + 1e-7) % 60.0 - 1e-7
    if lattice.kind != plain.kind or lattice.arms != plain.arms or abs(turn) > 1e-6:
        raise LawError(
            "lattice: the universal law is for stars of three arms on the lines of a triangular lattice",
            field="lattice",
        )


def universal_law_errors(law: UniversalLaw, design: Design, sizes: Floats, edge_mm: float) -> UniversalLawErrors:
    """The errors of the law at stars of these sizes (S, A), see `check_common` for LawError."""
    check_common(design)
    groups = star_groups(design.fabric, design.plastic, design.lattice.spacing_mm, edge_mm, sizes)
    covered = law.covers(groups)
    errors = left_out_errors(law)
    near = law.nearest_cells(groups, NEAREST_CELLS)
    columns = [QUANTITY_NAMES.index(name) for name in STATED_QUANTITIES]
    weight = errors.separated[near][..., None].astype(float)
    total = np.maximum(weight.sum(axis=1), 1.0)
    percent = np.sqrt((weight * errors.percent[near][:, :, columns] ** 2).sum(axis=1) / total)
    return UniversalLawErrors(percent, covered, "" if covered.all() else _why_outside(groups[~covered][0]))


def material_law(law: UniversalLaw, design: Design, sizes: Floats, edge_mm: float) -> Law:
    """The law of a design's material, around stars of these sizes (S, A), for a mesh of this edge.

    Raises
    ------
    LawError
        See `check_common`.
    """
    check_common(design)
    spacing = design.lattice.spacing_mm
    nodes = _nodes(sizes, spacing)
    grid = np.stack(np.meshgrid(*nodes, indexing="ij"), axis=-1).reshape(-1, len(AXES))
    groups = star_groups(design.fabric, design.plastic, spacing, edge_mm, grid)
    rows = law(groups)
    shape = tuple(len(each) for each in nodes)
    scales = quantity_scales(spacing, design.fabric.modulus_mpa * design.fabric.thickness_mm)
    values = (rows[:, : len(QUANTITY_NAMES)] * scales).reshape(*shape, -1)
    waves = rows[:, len(QUANTITY_NAMES) :].reshape(*shape, 2, WAVE_COUNT) * np.array([[spacing], [spacing**2]])
    fabric = bare_quantities(groups[:1])[0] * scales
    values[0], waves[0] = fabric, 0.0
    solved = law.covers(groups).reshape(shape)
    solved[0] = True
    stretch = design.fabric.stretch_xy[0]
    units = quantity_units(fabric, spacing)
    table = LawTable(stretch, spacing, nodes, values, waves, solved, units, np.empty((*shape, 0)))
    return Law(_material(design, nodes, edge_mm), (table,), (), {}, {"command": "universal law", **law.made})


def _nodes(sizes: Floats, spacing: float) -> tuple[Floats, ...]:
    """Nodes of the table, (n1,), (n2,), (n3,) mm."""
    longest = GROUPS[0].limits[1] * spacing
    lengths = np.concatenate([[0.0], np.linspace(GROUPS[0].limits[0] * spacing, longest, NODE_COUNTS[0])])
    others = []
    for axis, column, count in zip(AXES[1:], sizes.T[1:], NODE_COUNTS[1:], strict=True):
        low, high = axis.limits
        ends = np.clip([column.min() / SIZE_MARGIN, column.max() * SIZE_MARGIN], low, high)
        others.append(np.geomspace(float(ends[0]), float(ends[1]), count))
    return (lengths, *others)


def _material(design: Design, nodes: tuple[Floats, ...], edge_mm: float) -> Material:
    data = design.to_dict()
    plan = {axis.nodes_key: [float(node) for node in each if node > 0] for axis, each in zip(AXES, nodes, strict=True)}
    return Material.from_dict(
        {
            "name": "universal",
            "fabric": data["fabric"] | {"stretch": design.fabric.stretch_xy[0]},
            "plastic": data["plastic"],
            "lattice": {"spacing_mm": design.lattice.spacing_mm},
            "plan": plan | {"edge_mm": edge_mm, "held_out": 0},
        }
    )


def _why_outside(groups: Floats) -> str:
    """The group of a star that is outside of its limits, in words."""
    within = within_limits(groups[None])[0]
    for group, value, is_within in zip(GROUPS, groups, within, strict=True):
        low, high = group.limits
        if not is_within and not low <= value <= high:
            return f"{group.name} is {value:.3g}, and the universal law covers {low:g} to {high:g}"
    if not within.all():
        return "the released arm curls too tightly, or the mesh is too coarse for so thin a fabric"
    return "the cells of such stars wrap, or their fabric buckles"
