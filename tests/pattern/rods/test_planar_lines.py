"""Lines cut where they meet: nodes, crossings, joined ends and overlaps."""

from __future__ import annotations

import time

import numpy as np
import pytest

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.errors import DesignError
from asterism.pattern.rods.planar_lines import Piece, cut_lines


def line(*points: tuple[float, float]) -> Floats:
    return np.array(points, dtype=float)


def cut(*lines: Floats, join: float = 0.1, merge: float = 0.5) -> tuple[Floats, list[Piece]]:
    return cut_lines(list(lines), join, merge, [f"line{k}" for k in range(len(lines))])


def degrees(pieces: list[Piece], count: int) -> list[int]:
    return sorted(np.bincount([end for p in pieces for end in (p.start, p.end)], minlength=count).tolist())


def test_crossing_lines_share_a_node_at_the_crossing() -> None:
    nodes, pieces = cut(line((-5, 0), (5, 0)), line((1, -5), (1, 5)))
    assert degrees(pieces, len(nodes)) == [1, 1, 1, 1, 4]
    assert np.abs(nodes - [1.0, 0.0]).sum(axis=1).min() < 1e-12


def test_an_end_beside_a_line_is_joined_to_it_and_not_one_further_away() -> None:
    base = line((-5, 0), (5, 0))
    assert degrees(cut(base, line((1, 0.08), (1, 5)))[1], 4) == [1, 1, 1, 3]
    assert degrees(cut(base, line((1, 0.2), (1, 5)))[1], 4) == [1, 1, 1, 1]


def test_an_end_that_overshoots_leaves_no_stub() -> None:
    nodes, pieces = cut(line((-5, 0), (5, 0)), line((1, -0.3), (1, 5)))
    assert len(pieces) == 3 and degrees(pieces, len(nodes)) == [1, 1, 1, 3]


def test_three_lines_through_nearly_one_point_have_one_node() -> None:
    nodes, pieces = cut(line((-5, 0), (5, 0)), line((0, -5), (0, 5)), line((-5, -4.8), (5, 5.2)))
    assert degrees(pieces, len(nodes)) == [1] * 6 + [6]


def test_corner_is_a_node_and_a_curve_has_none() -> None:
    assert len(cut(line((0, 0), (5, 0), (5, 5)))[1]) == 2
    angle = np.linspace(0.0, np.pi, 60)
    assert len(cut(10.0 * np.column_stack([np.cos(angle), np.sin(angle)]))[1]) == 1


def test_a_ring_has_one_seam_and_a_crossed_ring_is_cut_at_the_crossings() -> None:
    angle = np.linspace(0.0, 2 * np.pi, 121)
    ring = 10.0 * np.column_stack([np.cos(angle), np.sin(angle)])
    ring[-1] = ring[0]
    nodes, pieces = cut(ring)
    assert len(nodes) == len(pieces) == 1 and pieces[0].start == pieces[0].end
    nodes, pieces = cut(ring, line((-20, 3), (20, 3)))
    assert degrees(pieces, len(nodes)) == [1, 1, 2, 4, 4]  # the seam stays a node


def test_a_line_that_crosses_itself() -> None:
    nodes, pieces = cut(line((0, 0), (10, 0), (10, 5), (5, 5), (5, -5)))
    assert sorted(degrees(pieces, len(nodes))) == [1, 1, 2, 2, 2, 4]
    assert sum(np.linalg.norm(np.diff(p.points, axis=0), axis=1).sum() for p in pieces) == pytest.approx(30.0)


def test_lines_on_each_other_are_refused_by_name_and_place() -> None:
    with pytest.raises(DesignError, match=r"line0 and line1 lie on each other at \[.*\]: draw the line once"):
        cut(line((0, 0), (10, 0)), line((2, 0), (7, 0)))


@pytest.mark.slow
def test_a_scribble_is_refused_before_all_its_crossings_are_computed() -> None:
    """200 million of them would take more than the memory."""
    scribble = np.random.default_rng(0).uniform(-45.0, 45.0, (20_000, 2))
    start = time.process_time()
    with pytest.raises(DesignError, match="lines must meet at most 100000 times"):
        cut_lines([scribble], 0.1, 0.6, ["scribble"])
    assert time.process_time() - start < 20.0
