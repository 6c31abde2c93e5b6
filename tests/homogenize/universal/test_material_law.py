"""The universal law of one material is a law like others: same values, derivatives, range, and refusals."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from asterism.homogenize.errors import LawError
from asterism.homogenize.law.law_table import QUANTITY_NAMES
from asterism.homogenize.universal.groups import star_groups
from asterism.homogenize.universal.material_law import (
    law_edge,
    material_law,
    quantity_scales,
    table_nodes,
    universal_law_errors,
)
from asterism.homogenize.universal.universal_law import STATED_QUANTITIES, UniversalLaw, load_universal_law
from asterism.pattern.design.design import Design

SIZES = np.array([[7.0, 0.4, 1.2], [9.0, 0.5, 1.2]])
EDGE = 1.2


def design(**more: Any) -> Design:
    fabric = {"stretch": 1.5, "thickness_mm": 0.9, "modulus_mpa": 2.0}
    return Design.from_dict({"fabric": fabric, "stars": {"length_mm": 7.0}, "border": {"rings": 1}} | more)


@pytest.fixture(scope="module")
def law() -> UniversalLaw:
    return load_universal_law()


def test_the_table_has_the_values_of_the_law(law: UniversalLaw) -> None:
    sheet = design()
    table = material_law(law, sheet, EDGE).check(sheet)
    sizes = np.array([[7.4, 0.42, 1.1], [5.3, 0.48, 1.3]])
    groups = star_groups(sheet.fabric, sheet.plastic, sheet.lattice.spacing_mm, EDGE, sizes)
    scales = quantity_scales(sheet.lattice.spacing_mm, 2.0 * 0.9)
    own = law(groups)[:, : len(QUANTITY_NAMES)] * scales
    found = table(*sizes.T)
    assert found.inside.all()
    for name in ("lam", "lam_n", "kappa", "bending", "a11"):
        np.testing.assert_allclose(found.value[name], own[:, QUANTITY_NAMES.index(name)], rtol=5e-3, err_msg=name)
    more = table(sizes[:, 0] + 0.01, *sizes[:, 1:].T).value["kappa"]
    np.testing.assert_allclose(found.slope["kappa"][:, 0], (more - found.value["kappa"]) / 0.01, rtol=0.02)


def test_bare_fabric_is_exact_and_large_stars_are_outside(law: UniversalLaw) -> None:
    sheet = design()
    found = material_law(law, sheet, EDGE).evaluate(sheet, [0.0, 16.0], 0.4, 1.2)
    assert found.value["lam_n"][0] == pytest.approx(1 / 1.5) and found.value["kappa"][0] == 0.0
    assert found.inside.tolist() == [True, False] and "length_mm = 16" in found.outside[0]


def test_errors_are_those_of_the_nearest_cells(law: UniversalLaw) -> None:
    errors = universal_law_errors(law, design(), SIZES, EDGE)
    assert errors.covered.all() and errors.outside == ""
    typical = errors.typical_percent
    assert list(typical) == list(STATED_QUANTITIES) and 0.0 < typical["lam_n"] < typical["kappa"]


def test_what_is_outside_is_named(law: UniversalLaw) -> None:
    thin = design(fabric={"stretch": 1.5, "thickness_mm": 0.3})
    errors = universal_law_errors(law, thin, SIZES, EDGE)
    assert not errors.covered.any()
    assert errors.outside == "fabric thickness over spacing is 0.0173, and the universal law covers 0.03 to 0.08"
    assert errors.typical_percent["kappa"] == np.inf


@pytest.mark.parametrize(
    "more, field",
    [
        ({"fabric": {"bending": "consistent"}}, "fabric.bending"),
        ({"fabric": {"stretch": [1.3, 1.4]}}, "fabric.stretch"),
        ({"lattice": {"arms": 4}}, "lattice"),
        ({"lattice": {"orientation_deg": 20}}, "lattice"),
        ({"plastic": {"poisson": 0.4}}, "plastic.poisson"),
    ],
)
def test_other_fabrics_and_lattices_are_refused(law: UniversalLaw, more: dict[str, Any], field: str) -> None:
    with pytest.raises(LawError) as refused:
        universal_law_errors(law, design(**more), SIZES, EDGE)
    assert refused.value.field == field and "universal law is for" in str(refused.value)


def test_the_edge_of_the_mesh_is_a_group(law: UniversalLaw) -> None:
    sheet = design()
    coarse, fine = (material_law(law, sheet, edge) for edge in (1.7, 0.9))
    assert coarse.edge_mm == 1.7
    assert coarse.evaluate(sheet, 8.0, 0.4, 1.2).value["kappa"] > fine.evaluate(sheet, 8.0, 0.4, 1.2).value["kappa"]


def test_a_close_lattice_has_no_arms_that_cannot_be_printed(law: UniversalLaw) -> None:
    sheet = design(lattice={"spacing_mm": 12.0})
    table = material_law(law, sheet, 0.9).check(sheet)
    assert table.axis_nodes[0][:2].tolist() == [0.0, 1.0] and table.min_length_mm == 0.0


def test_the_nodes_reach_over_the_range_of_the_groups() -> None:
    lengths, thicknesses, widths = (np.array(nodes) for nodes in table_nodes(20.0))
    assert lengths[[0, 1, -1]] == pytest.approx([0.0, 1.2, 16.0])
    assert thicknesses[[0, -1]] == pytest.approx([0.2, 1.0]) and widths[[0, -1]] == pytest.approx([0.26, 8.0])
    for nodes in (thicknesses, widths):
        assert (nodes[1:] / nodes[:-1]).max() <= 1.2


@pytest.mark.parametrize(
    "wish, fabric, edge", [(1.2, 0.9, 1.2), (2.0, 0.9, 1.7320508), (0.3, 0.9, 0.8660254), (2.0, 0.6, 0.6 / 0.45)]
)
def test_the_law_has_the_edge_of_the_exact_model(wish: float, fabric: float, edge: float) -> None:
    sheet = design(mesh={"edge_mm": wish}, fabric={"thickness_mm": fabric})
    assert law_edge(sheet) == pytest.approx(edge)
