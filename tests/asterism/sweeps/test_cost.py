"""The estimate of a sweep before it begins."""

from __future__ import annotations

import pytest

from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.sweeps.cost import MOTIF_CELL_S, MOTIF_PREVIEW_S, START_S, sweep_cost

VARIED = {"profile": "radial", "from": 0.3, "to": 0.5, "over_mm": 30.0}


@pytest.mark.slow
def test_previews_of_motifs_solve_their_cells_unless_a_law_is_given() -> None:
    net = gallery.load("skew-grid")
    assert sweep_cost(net, [], 10, False, 2).seconds == START_S + 5 * (MOTIF_PREVIEW_S + MOTIF_CELL_S)
    assert sweep_cost(net, [], 10, False, 2, law_is_given=True).seconds == START_S + 5 * MOTIF_PREVIEW_S
    table = net.to_dict()
    table["rods"]["thickness_mm"] = VARIED
    graded = sweep_cost(Design.from_dict(table), [], 1, False, 1).seconds
    assert graded >= START_S + MOTIF_PREVIEW_S + 4 * MOTIF_CELL_S


def test_a_design_without_a_law_counts_as_one_cell() -> None:
    table = gallery.load("skew-grid").to_dict()
    table["fabric"]["bending"] = "none"
    without = Design.from_dict(table)
    assert sweep_cost(without, [], 1, False, 1).seconds == START_S + MOTIF_PREVIEW_S + MOTIF_CELL_S
