"""What a cell says about the sheet: closed forms without stars, symmetry with them, and each number by another way.

The way to the natural tube: by small steps from flat, or from another direction's natural tube.
"""

from __future__ import annotations

import json

import numpy as np
import pytest

from asterism.homogenize.cell.flat_cell import mean_height, relax_flat_cell
from asterism.homogenize.cell.natural_curvature import MAX_SEARCHED_CURL, ROOT_TOLERANCE, TubeBranch, trace_tubes
from asterism.homogenize.cell.rolling import Tube, roll_cell, unroll, unrolled_flat_cell, unrolled_in_direction
from asterism.homogenize.cell.sample import solve_cell
from asterism.homogenize.cell.unit_cell import UnitCell
from asterism.pattern.design.materials import Fabric
from tests.homogenize.cells import EDGE, design, relaxed, sample
from tests.homogenize.linear_cell import effective_stiffness
from tests.homogenize.stability import cell_stability

SPACING = 10.0 * np.sqrt(3.0)
WHOLE = 40.0 / np.sqrt(12.0)  # mm, four edges of the cells' mesh: one mesh says it all

MODULUS, POISSON, THICK, STRETCH = 7.1875, 0.3, 0.8, 1.35


@pytest.mark.parametrize("edge", [5.8, 2.9, 1.92])
def test_bare_fabric(edge):
    """lambda = 1/s, no curvature, the neo-Hookean tangent at rest, and the paper's hinges: three times the plate."""
    bare = sample(0.0, 0.4, edge)
    assert bare.lam == pytest.approx(1.0 / STRETCH, abs=1e-8)
    np.testing.assert_allclose(bare.rest_metric, np.eye(2) / STRETCH**2, atol=1e-8)
    np.testing.assert_array_equal(bare.natural_curvature, 0.0)
    plane = MODULUS * THICK / (1.0 - POISSON**2) * np.array([[1, POISSON, 0], [POISSON, 1, 0], [0, 0, 0.35]])
    # strains of the print are s^2 times smaller than those of the released sheet, whose area is s^2 times smaller
    linear = effective_stiffness(*relaxed(0.0, 0.4, edge))
    np.testing.assert_allclose(linear.stiffness[:3, :3], plane * STRETCH**2, rtol=1e-7, atol=1e-7)
    cylinder = 3.0 * MODULUS * THICK**3 / (12.0 * (1.0 - POISSON**2))
    bending = linear.stiffness[3:, 3:]
    for angle in (0.0, 0.4, 1.1):
        t = np.array([-np.sin(angle), np.cos(angle)])
        form = np.array([t[0] ** 2, t[1] ** 2, 2.0 * t[0] * t[1]])
        assert form @ bending @ form == pytest.approx(cylinder * STRETCH**2, rel=1e-6)
    np.testing.assert_allclose(linear.stiffness[:3, 3:], 0.0, atol=1e-6)
    np.testing.assert_allclose(linear.moment, 0.0, atol=1e-7)
    np.testing.assert_allclose(bare.bending, cylinder / STRETCH**2, rtol=1e-3)  # of a slightly curved tube
    assert bare.sixfold == 0.0


def test_bare_fabric_that_bends_as_a_plate():
    """Both constants of the plate, which the paper's hinges do not have."""
    cell = UnitCell(design(0.0, fabric={"bending": "consistent"}), EDGE)
    stiffness = effective_stiffness(cell, relax_flat_cell(cell)).stiffness
    bare = solve_cell(cell.design, EDGE, (0.2,))
    assert bare.lam == pytest.approx(1.0 / STRETCH, abs=1e-8)
    plate = (
        MODULUS * THICK**3 / (12.0 * (1.0 - POISSON**2)) * np.array([[1, POISSON, 0], [POISSON, 1, 0], [0, 0, 0.35]])
    )
    np.testing.assert_allclose(stiffness[3:, 3:], plate * STRETCH**2, atol=2e-5 * plate.max())
    np.testing.assert_allclose(bare.bending, plate[0, 0] / STRETCH**2, rtol=1e-3)


@pytest.mark.parametrize(
    ("length", "thickness"), [pytest.param(10.0, 0.4, marks=pytest.mark.slow), (10.0, 0.6), (7.0, 0.3)]
)
def test_three_arms_make_isotropic_linear_responses(length, thickness):
    cell, flat = relaxed(length, thickness)
    metric, found = flat.deformation @ flat.deformation, effective_stiffness(cell, flat)
    np.testing.assert_allclose(metric, metric[0, 0] * np.eye(2), atol=1e-6 * metric[0, 0])
    for rows in (slice(0, 3), slice(3, 6)):
        for columns in (slice(0, 3), slice(3, 6)):
            part = found.stiffness[rows, columns]
            isotropic = np.array(
                [[part[0, 0], part[0, 1], 0], [part[0, 1], part[0, 0], 0], [0, 0, 0.5 * (part[0, 0] - part[0, 1])]]
            )
            np.testing.assert_allclose(part, isotropic, atol=1e-6 * np.abs(part).max())
    np.testing.assert_allclose(found.moment, found.moment[0] * np.array([1, 1, 0]), atol=1e-6 * abs(found.moment[0]))


def test_tubes_have_the_symmetry_of_the_star():
    """Three turns by 60 degrees and the mirror, beyond the linear response."""
    cell, flat = relaxed(10.0, 0.4)
    energies = [
        roll_cell(cell, unrolled_flat_cell(flat, angle), 0.04, angle).energy for angle in (0.2, 0.2 + np.pi / 3, -0.2)
    ]
    rise = energies[0] - flat.energy
    np.testing.assert_allclose(energies, energies[0], atol=1e-6 * abs(rise))


@pytest.mark.slow
def test_natural_tube_has_no_moment_and_the_least_energy():
    found = sample(WHOLE, 0.4)
    cell, flat = relaxed(WHOLE, 0.4)
    for angle, natural in zip(found.angles_rad, found.natural_curvature * found.natural_hoop, strict=True):
        branch = trace_tubes(cell, flat, float(angle))
        curvature, energy, moment = np.array([(t.curvature, t.energy, t.moment) for t in branch.tubes]).T
        assert (np.diff(curvature) > 0.0).all()
        assert branch.natural.curvature == pytest.approx(natural, rel=1e-3)
        at = branch.tubes.index(branch.natural)
        assert energy[at] == energy.min()
        assert abs(moment[at]) < 1e-4 * np.abs(moment).max()
    np.testing.assert_allclose(found.bending, -2.0 * found.natural_energy / found.natural_curvature**2, rtol=1e-12)
    assert found.natural_energy[-1] < found.natural_energy[0]  # tubes roll at 30 degrees
    cell.set_tube(branch.natural.curvature, branch.natural.angle)
    assert cell_stability(cell, branch.natural.state).supercell > 0.0  # free to differ from star to star


def test_rest_curvature_of_the_linear_cell_is_that_of_slightly_curled_tubes():
    """A cylinder takes `(1 + nu)` times the isotropic rest curvature, nu of the bending at free membrane."""
    cell = UnitCell(design(SPACING / 3.0, 0.55), 1.92)
    linear, found = effective_stiffness(cell, relax_flat_cell(cell)), solve_cell(cell.design, 1.92, (0.0, np.pi / 6))
    assert 0.05 < SPACING * found.natural_curvature[0] < 0.15
    np.testing.assert_allclose(linear.rest_curvature, linear.rest_curvature[0] * np.array([1, 1, 0]), atol=1e-9)
    a, b, d = linear.stiffness[:3, :3], linear.stiffness[:3, 3:], linear.stiffness[3:, 3:]
    free = d - b.T @ np.linalg.solve(a, b)
    cylinder = linear.rest_curvature[0] * (1.0 + free[0, 1] / free[0, 0])
    np.testing.assert_allclose(found.natural_curvature * found.natural_hoop**2, cylinder, rtol=0.01)


@pytest.mark.parametrize("length", [SPACING * 2.0 / 9.0, pytest.param(4.0, marks=pytest.mark.slow)])
def test_slight_curvatures_continue_those_that_are_looked_for(length, monkeypatch):
    """The parabola of the energy against the tube without a moment, for a star that both can treat."""
    found = {}
    for slight in (0.5, 1e-3):
        monkeypatch.setattr("asterism.homogenize.cell.natural_curvature.MIN_NATURAL_CURL", slight)
        found[slight] = solve_cell(design(length, 0.6), 1.92, (0.0, np.pi / 6))
    rough, exact = found[0.5], found[1e-3]
    assert 0.01 < SPACING * exact.natural_curvature[0] < 0.1
    for name, tolerance in (("natural_curvature", 2e-3), ("bending", 5e-3), ("natural_centre_offset_mm", 0.02)):
        np.testing.assert_allclose(getattr(rough, name), getattr(exact, name), rtol=tolerance, err_msg=name)
    np.testing.assert_allclose(rough.natural_hoop, exact.natural_hoop, atol=1e-4)


def test_offsets():
    cell, flat = relaxed(WHOLE, 0.4)
    found = sample(WHOLE, 0.4)
    assert found.centre_offset_mm == pytest.approx(-mean_height(cell, flat.state), rel=1e-9)
    assert 0.0 < found.centre_offset_mm < found.bump_mm
    assert (found.natural_bump_mm > found.natural_centre_offset_mm).all()
    assert (found.natural_centre_offset_mm > 0.0).all()


@pytest.mark.slow
@pytest.mark.parametrize(("length", "thickness"), [(10.0, 0.2), (13.0, 0.3)], ids=["bistable", "hardly buckled"])
def test_tubes_find_the_up_branch_at_finite_curvature(length, thickness):
    found = sample(length, thickness)
    assert found.bump_mm > 1.0 or length > 10.0
    assert (found.natural_bump_mm > 1.0).all()


@pytest.mark.parametrize("edge, angles", [(0.0, None), (-1.0, None), (np.nan, None), (EDGE, ()), (EDGE, (np.inf,))])
def test_edges_and_angles_that_are_none(edge, angles):
    with pytest.raises(ValueError, match="must be"):
        solve_cell(design(7.0, 0.4), edge, angles)


def test_uneven_stretch():
    bare = solve_cell(design(0.0, fabric={"stretch": [1.2, 1.5]}), EDGE, (0.0,))
    np.testing.assert_allclose(bare.rest_metric, np.diag([1.2**-2, 1.5**-2]), atol=1e-8)


def test_bare_fabric_with_a_grain():
    """It contracts alike, and bends as a plate by the direction around the tube, which is y for the angle 0."""
    fabric = {"modulus_mpa": [9.0, 4.0], "bending": "consistent"}
    bare = solve_cell(design(0.0, fabric=fabric), EDGE, (0.0, np.pi / 2, np.pi / 4))
    np.testing.assert_allclose(bare.rest_metric, np.eye(2) / 1.35**2, atol=1e-8)
    d11, d12, d22, d66 = Fabric.model_validate(fabric).bending_tensor
    plate = np.array([d22, d11, 0.25 * (d11 + d22 + 2.0 * d12 + 4.0 * d66)])
    np.testing.assert_allclose(bare.bending, plate / 1.35**2, rtol=1e-3)


def test_sample_goes_through_json():
    found = sample(10.0, 0.4)
    again = json.loads(json.dumps(found.to_dict()))
    assert again == found.to_dict()
    np.testing.assert_array_equal(again["natural_membrane"], found.natural_membrane)


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
