"""The way to the natural tube: by small steps from flat, or from another direction's natural tube."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.homogenize.cell.natural_curvature import MAX_SEARCHED_CURL, ROOT_TOLERANCE, TubeBranch, trace_tubes
from asterism.homogenize.cell.rolling import Tube, roll_cell, unroll, unrolled_flat_cell, unrolled_in_direction
from tests.homogenize.cells import relaxed

# length, thickness: from hardly to strongly curling, and tight
STARS = [(10.0, 0.6), (10.0, 0.4), (7.0, 0.3), (10.0, 0.2)]
OTHER = np.pi / 6


def _natural(found: TubeBranch) -> Tube:
    assert found.natural is not None
    return found.natural


def _same(one: TubeBranch, other: TubeBranch) -> None:
    a, b = _natural(one), _natural(other)
    assert a.curvature == pytest.approx(b.curvature, rel=2 * ROOT_TOLERANCE)
    for name in ("energy", "hoop", "axial", "radius"):
        assert getattr(a, name) == pytest.approx(getattr(b, name), rel=2 * ROOT_TOLERANCE), name
    assert a.bump == pytest.approx(b.bump, rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize(("length", "thickness"), STARS)
def test_both_ways_end_at_the_same_tube(length: float, thickness: float) -> None:
    cell, flat = relaxed(length, thickness)
    first = trace_tubes(cell, flat, 0.0)
    alone, helped = trace_tubes(cell, flat, OTHER), trace_tubes(cell, flat, OTHER, first)
    _same(alone, helped)
    assert abs(_natural(helped).moment) < 1e-4 * max(abs(tube.moment) for tube in alone.tubes)
    assert sum(tube.iterations for tube in helped.tubes) <= sum(tube.iterations for tube in alone.tubes)


def test_a_tight_tube_is_no_guide() -> None:
    """Tight curls differ from direction to direction, and may be on another branch: the long way is taken."""
    cell, flat = relaxed(10.0, 0.2)
    first = trace_tubes(cell, flat, 0.0)
    assert _natural(first).curvature * cell.spacing > MAX_SEARCHED_CURL
    alone, helped = trace_tubes(cell, flat, OTHER), trace_tubes(cell, flat, OTHER, first)
    assert [tube.curvature for tube in helped.tubes] == pytest.approx([tube.curvature for tube in alone.tubes])


def _wrong_sign(first: TubeBranch) -> TubeBranch:
    """Says that the sheet curls to the other side."""
    cell, flat = relaxed(10.0, 0.4)
    k = _natural(first).curvature
    tubes = [roll_cell(cell, unrolled_flat_cell(flat, 0.0), share * k, 0.0) for share in (-0.3, -0.2)]
    return TubeBranch(tubes, tubes[0])


def _slight(first: TubeBranch) -> TubeBranch:
    """Has no natural tube."""
    return TubeBranch(first.tubes[:1], None, 1e-4, 1.0)


@pytest.mark.slow
@pytest.mark.parametrize("useless", [_wrong_sign, _slight])
def test_a_useless_tube_does_no_harm(useless) -> None:  # type: ignore[no-untyped-def]
    cell, flat = relaxed(10.0, 0.4)
    alone = trace_tubes(cell, flat, OTHER)
    misled = trace_tubes(cell, flat, OTHER, useless(trace_tubes(cell, flat, 0.0)))
    _same(misled, alone)
    assert [tube.curvature for tube in misled.tubes] == pytest.approx([tube.curvature for tube in alone.tubes])


@pytest.mark.parametrize("angle", [0.0, 0.4])
def test_towards_its_own_direction_a_tube_is_just_unrolled(angle: float) -> None:
    cell, flat = relaxed(10.0, 0.4)
    tube = roll_cell(cell, unrolled_flat_cell(flat, angle), 0.05, angle)
    same, turned = unroll(cell, tube), unrolled_in_direction(cell, tube, angle)
    np.testing.assert_allclose(turned.state.positions, same.state.positions, atol=1e-10)
    np.testing.assert_allclose(turned.state.directors, same.state.directors, atol=1e-12)
    assert turned.hoop == pytest.approx(same.hoop, rel=1e-12)


def test_towards_an_equivalent_direction_it_is_the_same_tube_again() -> None:
    """A third of a turn is a symmetry of the star: rolled that way the sheet reaches the same energy."""
    cell, flat = relaxed(10.0, 0.4)
    tube = roll_cell(cell, unrolled_flat_cell(flat, 0.2), 0.05, 0.2)
    again = roll_cell(cell, unrolled_in_direction(cell, tube, 0.2 + 2 * np.pi / 3), 0.05, 0.2 + 2 * np.pi / 3)
    assert again.energy - flat.energy == pytest.approx(tube.energy - flat.energy, rel=1e-6)
    assert (again.hoop, again.axial) == pytest.approx((tube.hoop, tube.axial), rel=1e-6)
