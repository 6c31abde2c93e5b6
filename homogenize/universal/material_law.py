"""The universal law of one material: a law of the usual kind, whose table comes from the groups and not from cells.

A preview evaluates the table, which is as fast as every other law and gives the same derivatives.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import binary_dilation, distance_transform_edt

from asterism.equilibrium.arrays import Bools, Floats
from asterism.homogenize.errors import LawError
from asterism.homogenize.law.axes import AXES
from asterism.homogenize.law.law import Law
from asterism.homogenize.law.law_table import QUANTITY_NAMES, LawTable, quantity_units
from asterism.homogenize.law.material import Material
from asterism.homogenize.universal.groups import GROUP_KEYS, GROUPS, MIN_FABRIC_TO_EDGE, star_groups
from asterism.homogenize.universal.universal_law import (
    STATED_QUANTITIES,
    UniversalLaw,
    bare_quantities,
    within_limits,
)
from asterism.pattern.design.design import Design
from asterism.pattern.design.lattice import Lattice
from asterism.pattern.design.stars import MIN_ARM_MM

# what the cells of the universal law have in common
COMMON = {"fabric.poisson": 0.3, "fabric.model": "neo-hookean", "fabric.bending": "paper", "plastic.poisson": 0.3}
# equal steps of the lengths after the bare fabric
LENGTH_NODES = 16
# largest ratio of adjacent thicknesses and widths
NODE_RATIO = 1.2
# powers of the spacing and of `E2 h2` that each quantity is divided by
LENGTH_POWERS = {"kappa": -1, "bending": 2, "c3": 3, "offset_mm": 1}
FORCE_POWERS = {"bending": 1, "a11": 1, "a12": 1, "c3": 1}


@dataclass(frozen=True)
class UniversalLawErrors:
    """Errors that the universal law has at the cells nearest to the stars of a design, each left out of the law.

    Attributes
    ----------
    percent : (S, 3) rms of `STATED_QUANTITIES` for each star.
    covered : (S,) the star is in the range of the universal law, and the errors there are known.
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


def _check_common(design: Design) -> None:
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
    """The errors of the law at stars of these sizes (S, A).

    Raises
    ------
    LawError
        The design differs from the cells of the law in what is no group.
    """
    _check_common(design)
    groups = star_groups(design.fabric, design.plastic, design.lattice.spacing_mm, edge_mm, sizes)
    covered = law.covers(groups)
    percent = law.errors(groups)
    is_known = np.isfinite(percent).all(axis=1)
    outside = ""
    if not covered.all():
        outside = _why_outside(groups[~covered][0])
    elif not is_known.all():
        outside = "most of the cells nearest to such stars curl to radii below two thirds of the spacing"
    return UniversalLawErrors(percent, covered & is_known, outside)


def material_law(law: UniversalLaw, design: Design, edge_mm: float) -> Law:
    """The law of a design's material, as a table for a mesh of this edge; see `universal_law_errors` for its range."""
    spacing = design.lattice.spacing_mm
    nodes = table_nodes(spacing)
    grid = np.stack(np.meshgrid(*nodes, indexing="ij"), axis=-1).reshape(-1, len(AXES))
    groups = star_groups(design.fabric, design.plastic, spacing, edge_mm, grid)
    shape = tuple(len(each) for each in nodes)
    solved = law.covers(groups).reshape(shape)
    rows = _rows_near(law, groups, solved)
    scales = quantity_scales(spacing, design.fabric.modulus_mpa * design.fabric.thickness_mm)
    values = (rows[:, : len(QUANTITY_NAMES)] * scales).reshape(*shape, -1)
    waves = rows[:, len(QUANTITY_NAMES) :].reshape(*shape, 2, -1) * np.array([[spacing], [spacing**2]])
    fabric = bare_quantities(groups[:1])[0] * scales
    values[0], waves[0] = fabric, 0.0
    solved[0] = True
    stretch = design.fabric.stretch_xy[0]
    units = quantity_units(fabric, spacing)
    axis_nodes = tuple(np.array(each) for each in nodes)
    table = LawTable(stretch, spacing, axis_nodes, values, waves, solved, units, np.empty((*shape, 0)))
    return Law(_material(design, nodes, edge_mm), (table,), (), {}, dict(law.made))


def quantity_scales(spacing_mm: float, force: float) -> Floats:
    """(Q,) units of `law_table.QUANTITY_NAMES`: a quantity is its dimensionless value times its unit.

    Parameters
    ----------
    force : N/mm, modulus times thickness of the fabric.
    """
    return np.array(
        [spacing_mm ** LENGTH_POWERS.get(name, 0) * force ** FORCE_POWERS.get(name, 0) for name in QUANTITY_NAMES]
    )


def _rows_near(law: UniversalLaw, groups: Floats, covered: Bools) -> Floats:
    """(N, Q + 2 W) the law at the covered nodes and their neighbours, on which slopes depend.

    Other nodes are never shown, and have the values of the nearest of these: most nodes are of that kind.
    """
    near = binary_dilation(covered, np.ones((3,) * covered.ndim)) if covered.any() else np.ones_like(covered)
    nearest = distance_transform_edt(~near, return_distances=False, return_indices=True)
    number = np.cumsum(near.ravel()) - 1
    rows: Floats = law(groups[near.ravel()])
    return rows[number[np.ravel_multi_index(nearest, covered.shape).ravel()]]


def table_nodes(spacing: float) -> tuple[tuple[float, ...], ...]:
    """Nodes of the table of a lattice, mm. They reach over all sizes that the groups may have."""
    (least, most), (thinnest, thickest), (narrowest, widest) = (
        GROUPS[GROUP_KEYS.index(key)].limits for key in ("arm", "thickness", "aspect")
    )
    lengths = (0.0, *np.linspace(max(least * spacing, MIN_ARM_MM), most * spacing, LENGTH_NODES).tolist())
    thin, thick = thinnest * spacing, thickest * spacing
    return lengths, _even_ratios(thin, thick), _even_ratios(narrowest * thin, widest * thick)


def _even_ratios(low: float, high: float) -> tuple[float, ...]:
    """From low to high in equal ratios of at most `NODE_RATIO`."""
    count = int(np.ceil(np.log(high / low) / np.log(NODE_RATIO))) + 1
    return tuple(np.geomspace(low, high, count).tolist())


def law_edge(design: Design) -> float:
    """mm, edge of the law's mesh: that of the design's exact model, or the nearest one in the range of the law."""
    spacing, (finest, coarsest) = design.lattice.spacing_mm, GROUPS[GROUP_KEYS.index("edge")].limits
    resolved = design.fabric.thickness_mm / MIN_FABRIC_TO_EDGE
    longest = max(min(coarsest * spacing, resolved), finest * spacing)
    return float(np.clip(design.usual_edge_mm, finest * spacing, longest))


def _material(design: Design, nodes: Sequence[Sequence[float]], edge_mm: float) -> Material:
    data = design.to_dict()
    plan = {axis.nodes_key: [node for node in each if node > 0] for axis, each in zip(AXES, nodes, strict=True)}
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
