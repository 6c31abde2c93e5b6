"""The graph of one cell: each rod once, whatever the motif's place, and bonded to its neighbours' images."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from asterism.pattern import gallery
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.lattice import Lattice
from asterism.pattern.design.rods import Rods
from asterism.pattern.rods.motif_graph import MotifGraph, motif_graph

SIDE = 10.0
UP = SIDE * np.sqrt(0.75)
HONEYCOMB = Lattice(kind="custom", vectors_mm=[(1.5 * SIDE, UP), (1.5 * SIDE, -UP)])


def honeycomb(x: float = 0.0, y: float = 0.0) -> MotifGraph:
    ends = [(0.5 * SIDE, UP), (0.5 * SIDE, -UP), (-SIDE, 0.0)]
    lines = [{"line_mm": [(x, y), (x + end[0], y + end[1])]} for end in ends]
    return motif_graph(Rods.model_validate({"motif": lines}), HONEYCOMB)


def on_squares(*lines: dict[str, object]) -> MotifGraph:
    return motif_graph(Rods.model_validate({"motif": lines}), Lattice(kind="square", spacing_mm=10.0))


@pytest.mark.slow
@settings(max_examples=6, deadline=None, derandomize=True)
@given(x=st.floats(-50.0, 50.0), y=st.floats(-50.0, 50.0))
def test_a_honeycomb_has_two_nodes_and_three_rods_a_cell(x: float, y: float) -> None:
    graph = honeycomb(x, y)
    assert graph.ends_at.tolist() == [3, 3]
    assert [rod.length for rod in graph.rods] == pytest.approx([SIDE] * 3)
    np.testing.assert_array_equal(graph.end_image, honeycomb().end_image)
    for rod, image in zip(graph.rods, graph.end_image, strict=True):
        np.testing.assert_allclose(rod.points[0], graph.nodes[rod.start], atol=1e-9)
        np.testing.assert_allclose(rod.points[-1], graph.nodes[rod.end] + image @ graph.vectors, atol=1e-6)


def test_ends_in_rounded_numbers_meet_as_they_do_on_the_sheet() -> None:
    """The gallery's honeycomb misses its copies by 0.3 micrometres."""
    design = gallery.load("honeycomb")
    assert design.rods is not None
    graph = motif_graph(design.rods, design.lattice)
    assert graph.ends_at.tolist() == [3, 3]
    for rod, image in zip(graph.rods, graph.end_image, strict=True):
        np.testing.assert_array_equal(rod.points[0], graph.nodes[rod.start])
        np.testing.assert_array_equal(rod.points[-1], graph.nodes[rod.end] + image @ graph.vectors)


@pytest.mark.parametrize(
    ("line", "ends", "image"),
    [
        ({"line_mm": [(0, 0), (10, 0)]}, [2], [[1, 0]]),  # goes on as its copy
        ({"line_mm": [(0, 0), (6, 0)]}, [1, 1], [[0, 0]]),  # ends freely
        ({"circle_mm": {"radius": 3.0}}, [2], [[0, 0]]),  # closed
    ],
)
def test_lines_of_all_kinds(line: dict[str, object], ends: list[int], image: list[list[int]]) -> None:
    graph = on_squares(line)
    assert graph.ends_at.tolist() == ends and graph.end_image.tolist() == image


def test_lines_that_cross_copies_of_each_other_are_cut_there() -> None:
    graph = on_squares({"line_mm": [(-4, 1), (6, 1)]}, {"line_mm": [(11, -5), (11, 5)]})
    assert sum(rod.length for rod in graph.rods) == pytest.approx(20.0)
    assert sorted(graph.ends_at.tolist()) == [2, 2, 4]


def test_a_motif_that_lies_on_its_copies_is_refused() -> None:
    with pytest.raises(DesignError, match="two lines named long lie on each other"):
        on_squares({"name": "long", "line_mm": [(0, 0), (13, 0)]})
    with pytest.raises(DesignError, match=r"^rods\.motif: is too long for its lattice"):
        on_squares({"line_mm": [(0, 0), (700, 31)]})
