"""A law that needs no cells: smooth formulas in place of a campaign."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import scipy.sparse as sp

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.cell.corrugation_waves import CorrugationWaves
from asterism.homogenize.law.material import Material
from asterism.homogenize.law.star_law import QUANTITY_NAMES, StarLaw, StarTable, to_stored
from asterism.previews.fields.star_cells import Shares
from asterism.previews.fields.star_values import StarPlaces, StarValues

SPACING = 10.0 * np.sqrt(3.0)


@cache
def plain_law(stretch: float = 1.35) -> StarLaw:
    """Longer stars contract less and curl more, thicker ones curl less; the paper's material."""
    cells = {
        "lengths_mm": np.linspace(1.0, 13.0, 13).tolist(),
        "thicknesses_mm": np.linspace(0.2, 0.6, 5).tolist(),
        "widths_mm": [0.8, 1.2, 1.6],
    }
    plan = Material.from_dict({"name": "plain", "fabric": {"stretch": stretch}, "plan": cells}).law_plan()
    l, h, _ = np.meshgrid(*plan.axis_nodes, indexing="ij")  # noqa: E741
    lam = 1.0 / stretch + 0.12 * np.tanh(l / 8.0) ** 2
    value = {
        "lam": lam,
        "lam_n": lam,
        "kappa": 0.05 * np.tanh(l / 6.0) ** 2 * (0.3 / h) ** 2,
        "bending": 0.55 * np.exp(2.0 * l * h / 4.0),
        "a11": 11.5 * np.exp(-0.02 * l),
        "a12": 3.4 * np.exp(-0.2 * l),
        "c3": 0.02 * l**2,
        "offset_mm": 0.1 * l,
    }
    nodes = np.stack([value[name] for name in QUANTITY_NAMES], axis=-1)
    waves = CorrugationWaves.of(plan.design.lattice)
    reliefs = np.zeros((*l.shape, 2, len(waves)))
    reliefs[..., 0, 0] = 0.1 * l / waves(np.zeros((1, 2)))[0, 0]
    reliefs[..., 1, 0] = 0.5 * l / waves(np.zeros((1, 2)))[0, 0]
    stored = np.concatenate([to_stored(nodes, SPACING), reliefs.reshape(*l.shape, -1)], axis=-1)
    return StarLaw(plan, (StarTable(plan, stretch, stored, np.ones(l.shape, dtype=bool)),), (), {})


def with_values(table: StarTable, nodes: Floats) -> StarTable:
    """The table with other values (n1, ..., nA, Q) at its nodes."""
    rest = table.stored[..., len(QUANTITY_NAMES) :]
    return replace(table, stored=np.concatenate([to_stored(nodes, table.spacing_mm), rest], axis=-1))


class FixedShares(Shares):
    """Shares that do not depend on the length of the arms."""

    def __init__(self, weights: sp.csr_matrix) -> None:
        self.weights = weights

    def __call__(self, length: Floats) -> sp.csr_matrix:
        return self.weights


def places(
    weights: sp.csr_matrix, values: StarValues, shape: tuple[int, ...], arms: Sequence[sp.csr_matrix] = (), **stars: Any
) -> StarPlaces:
    """Places with these shares of the stars, and with `arms` half a spacing back along each arm."""
    back = [FixedShares(each) for each in arms]
    return StarPlaces(FixedShares(weights), shape, values, arms=back, **stars)
