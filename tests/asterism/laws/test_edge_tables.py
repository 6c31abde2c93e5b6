"""Cells of a law on meshes of other edges: which ones, and that a campaign of them makes the tables."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pytest

from asterism.homogenize.campaign.campaign import run_campaign
from asterism.homogenize.campaign.fit_law import fit_law
from asterism.homogenize.errors import CampaignError
from asterism.homogenize.law.law import Law
from asterism.homogenize.law.material import Material
from asterism.laws import edge_tables
from asterism.laws.edge_tables import add_edges, edge_materials
from tests.homogenize import fake, same_process
from tests.homogenize.law.test_law import answers


def law(**plan: Any) -> Law:
    material = Material.from_dict({"name": "test", "plan": plan | {"edge_mm": 1.15, "held_out": 4}})
    return fit_law(material, answers(material, fake.solve_cell))


SMALL = {"lengths_mm": [2.0, 6.0, 12.0], "thicknesses_mm": [0.2, 0.3, 0.4], "widths_mm": [0.8, 1.2, 1.6]}


def test_the_cells_lie_within_the_range_of_the_law() -> None:
    coarse, fine = edge_materials(law(**SMALL), [2.0, 0.7], thicknesses_mm=(0.3, 0.5))
    assert (coarse.plan.edge_mm, fine.plan.edge_mm) == (1.9245, 0.6415)
    assert coarse.plan.lengths_mm == (3.849, 5.7735, 7.698, 9.6225, 11.547)
    assert coarse.plan.thicknesses_mm == (0.3, 0.4) and coarse.plan.widths_mm == (1.2,)
    assert coarse.plan.held_out == 0


def test_a_law_of_one_star_keeps_its_sizes() -> None:
    one = law(lengths_mm=[10.0], thicknesses_mm=[0.4], widths_mm=[1.2])
    assert [each.plan.lengths_mm for each in edge_materials(one)] == [(10.0,)] * 3


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        ({"stretch": 1.5}, "--stretch: must be one of 1.35"),
        ({"lengths_mm": (4.0, 5.0)}, "--length: no ninth of the spacing from 4 to 5 mm"),
        ({"edges_mm": [0.6, 0.1]}, "must differ"),
        ({"thicknesses_mm": (0.7, 0.8)}, "--thickness: the law has no thickness from 0.7 to 0.8 mm"),
    ],
)
def test_cells_that_the_law_lacks_are_refused(changes: dict[str, Any], why: str) -> None:
    with pytest.raises(CampaignError, match=why):
        edge_materials(law(**SMALL), **changes)


def test_the_campaign_makes_tables_of_each_edge(tmp_path, monkeypatch) -> None:
    same_process.use(monkeypatch)
    monkeypatch.setattr(edge_tables, "run_campaign", partial(run_campaign, respond=fake.solve_cell))
    made = add_edges(law(**SMALL), tmp_path / "edges.npz")
    assert [each.edge_mm for each in made.edges] == [1.9245, 0.6415, 0.4811]
    again = add_edges(made, tmp_path / "edges.npz", edges_mm=[0.64], lengths_mm=(7.0, 10.0))
    assert [each.edge_mm for each in again.edges] == [1.9245, 0.4811, 0.6415]
    # these cells do not depend on their mesh, and neither does the law
    value = made.at(1.35)(5.7735, 0.3, 1.2).value["kappa"]
    np.testing.assert_allclose(made.at_edge(0.0).at(1.35)(5.7735, 0.3, 1.2).value["kappa"], value, rtol=0.05)
