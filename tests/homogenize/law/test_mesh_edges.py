"""A law on meshes of other edges: exact at the edges with cells, and a limit only where the cells show an order."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from asterism.homogenize.errors import LawError
from asterism.homogenize.law.law import Law
from asterism.homogenize.law.law_file import law_bytes, law_digest, load_law
from asterism.homogenize.law.law_table import QUANTITY_NAMES
from asterism.homogenize.law.mesh_edges import EdgeTables, whole_edge
from tests.asterism.previews.laws import SPACING, plain_law

KAPPA = QUANTITY_NAMES.index("kappa")
OWN = SPACING / 9
EDGES = (SPACING / 7, SPACING / 15, SPACING / 20)
SIZES = ([3.0, 7.0, 11.0], 0.4, 1.2)


def law(power: float = 1.0, share: float = 0.2, edges: tuple[float, ...] = EDGES) -> Law:
    """Its curvature is `kappa (1 + share edge^power)` of that of `plain_law`, which has edges of two millimetres."""
    plain = plain_law()

    def on(edge: float) -> EdgeTables:
        table = plain.tables[0]
        values = table.node_values.copy()
        values[..., KAPPA] *= (1.0 + share * edge**power) / (1.0 + share * OWN**power)
        chosen = np.ix_(range(0, 14, 1), range(0, 5, 2), [1])
        nodes = (table.axis_nodes[0], table.axis_nodes[1][::2], table.axis_nodes[2][1:2])
        parts = {name: getattr(table, name)[chosen] for name in ("corrugations", "solved", "anisotropies")}
        return EdgeTables(edge, (replace(table, axis_nodes=nodes, node_values=values[chosen], **parts),))

    return replace(plain, edges=tuple(on(edge) for edge in edges))


def kappa(law: Law) -> np.ndarray:
    return law.at(1.35)(*SIZES).value["kappa"]


@pytest.mark.parametrize("power", [0.7, 1.0, 2.0])
def test_the_limit_is_that_of_the_order_that_the_cells_show(power: float) -> None:
    made = law(power)
    right = kappa(made) / (1.0 + 0.2 * OWN**power)
    limit = made.at_edge(0.0)
    assert limit.edge_mm == 0.0 and limit.at(1.35)(*SIZES).inside.all()
    np.testing.assert_allclose(kappa(limit), right, rtol=0.01)
    # between the limit and the finest cells the same order holds
    fine = SPACING / 40
    np.testing.assert_allclose(kappa(made.at_edge(fine)), right * (1.0 + 0.2 * fine**power), rtol=0.01)


def test_the_law_goes_through_the_cells_of_each_edge() -> None:
    made = law()
    for edge in (OWN, *EDGES):
        right = kappa(made) * (1.0 + 0.2 * edge) / (1.0 + 0.2 * OWN)
        np.testing.assert_allclose(kappa(made.at_edge(edge)), right, rtol=1e-2)
    np.testing.assert_allclose(kappa(made.at_edge(OWN)), kappa(made), rtol=1e-12)


def test_bare_fabric_has_no_mesh_error() -> None:
    made = law()
    for edge in (EDGES[0], 0.0):
        bare = made.at_edge(edge).at(1.35)(0.0, 0.4, 1.2)
        assert bare.inside.all()
        for name, value in made.at(1.35)(0.0, 0.4, 1.2).value.items():
            np.testing.assert_allclose(bare.value[name], value, rtol=1e-12)


@pytest.mark.parametrize(("power", "share"), [(0.2, 2.0), (3.5, 0.2)])
def test_cells_without_an_order_have_no_limit(power: float, share: float) -> None:
    made = law(power, share)
    assert not made.at_edge(0.0).at(1.35)(11.0, 0.2, 1.2).inside.any()
    assert made.at_edge(EDGES[-1]).at(1.35)(11.0, 0.2, 1.2).inside.all()


def test_sizes_without_cells_of_other_edges_are_outside() -> None:
    made = law()
    thick = [replace(e, tables=tuple(_without_thin(t) for t in e.tables)) for e in made.edges]
    there = replace(made, edges=tuple(thick)).at_edge(EDGES[0]).at(1.35)
    assert there(7.0, [0.25, 0.45], 1.2).inside.tolist() == [False, True]


def _without_thin(table):
    names = ("node_values", "corrugations", "solved", "anisotropies")
    parts = {name: getattr(table, name)[:, 1:] for name in names}
    return replace(table, axis_nodes=(table.axis_nodes[0], table.axis_nodes[1][1:], table.axis_nodes[2]), **parts)


def test_edges_beyond_the_cells_are_refused_in_one_line() -> None:
    with pytest.raises(LawError, match=re.escape("the law covers 0 to 2.47 mm")):
        law().at_edge(3.4)
    with pytest.raises(LawError, match=re.escape("the law covers 1.92 to 2.47 mm")):
        law(edges=EDGES[:1]).at_edge(0.0)
    with pytest.raises(LawError, match="cells of one mesh edge, 2 mm"):
        plain_law().at_edge(1.0)


def test_the_file_keeps_the_cells_of_other_edges(tmp_path) -> None:
    made = replace(law(), residuals={"1.35": {"held_out": {"errors": {}}}})
    (tmp_path / "law.npz").write_bytes(law_bytes(made))
    again = load_law(tmp_path / "law.npz")
    assert [each.edge_mm for each in again.edges] == list(EDGES)
    assert law_digest(again) == law_digest(made) != law_digest(replace(made, edges=()))
    np.testing.assert_array_equal(kappa(again.at_edge(0.0)), kappa(made.at_edge(0.0)))


def test_edges_are_rounded_to_whole_numbers_between_stars() -> None:
    assert whole_edge(2.0, SPACING) == SPACING / 9 and whole_edge(0.48, SPACING) == SPACING / 36
