"""A law that needs no cells: smooth formulas in place of a campaign."""

from __future__ import annotations

from functools import cache

import numpy as np

from asterism.homogenize.cell.corrugation_waves import CorrugationWaves
from asterism.homogenize.law.law import Law
from asterism.homogenize.law.law_table import QUANTITY_NAMES, LawTable, quantity_units
from asterism.homogenize.law.material import Material

SPACING = 10.0 * np.sqrt(3.0)


@cache
def plain_law(stretch: float = 1.35) -> Law:
    """Longer stars contract less and curl more, thicker ones curl less; the paper's material."""
    material = Material.from_dict({"name": "plain", "fabric": {"stretch": stretch}, "plastic": {}, "lattice": {}})
    lengths, thicknesses, widths = np.linspace(0.0, 13.0, 14), np.linspace(0.2, 0.6, 5), np.array([0.8, 1.2, 1.6])
    l, h, _ = np.meshgrid(lengths, thicknesses, widths, indexing="ij")  # noqa: E741
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
    waves = CorrugationWaves.of(material.lattice)
    reliefs = np.zeros((*l.shape, 2, len(waves)))
    reliefs[..., 0, 0] = 0.1 * l / waves(np.zeros((1, 2)))[0, 0]
    reliefs[..., 1, 0] = 0.5 * l / waves(np.zeros((1, 2)))[0, 0]
    unit = quantity_units(nodes[0, 0, 0], SPACING)
    axes = (lengths, thicknesses, widths)
    table = LawTable(
        stretch, SPACING, axes, nodes, reliefs, np.ones(l.shape, dtype=bool), unit, np.empty((*l.shape, 0))
    )
    return Law(material, (table,), (), {})
