"""The exact model of fabric with a grain or a measured bending stiffness: plates and bilayers by direction."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State
from asterism.equilibrium.arrays import Array
from asterism.exact.simulation import exact_shape
from asterism.pattern.design.design import Design
from asterism.pattern.design.materials import Fabric, rest_curvature
from tests.discrete.models import seven_stars

KNIT = {"modulus_mpa": [9.0, 4.0], "bending": "consistent"}


def bent(of: DiscreteModel, curvature: float, angle: float) -> Array:
    """The released sheet as a shallow cylinder that is curved in this direction, packed."""
    released = of.mesh.points / of.design.fabric.stretch_xy
    along = released @ [np.cos(np.radians(angle)), np.sin(np.radians(angle))]
    return np.column_stack([released, 0.5 * curvature * along**2]).ravel()


@pytest.mark.parametrize("stretch", [1.35, [1.5, 1.2]])
@pytest.mark.parametrize("bending", ["consistent", "plate"])
@pytest.mark.parametrize("angle", [0.0, 30.0, 75.0, 120.0])
def test_a_cylinder_bends_by_direction(stretch: Any, bending: str, angle: float) -> None:
    """The energy of a plate that is curved at an angle to its grain, also where the stretch shears it in print."""
    of = seven_stars(**KNIT | {"grain_deg": 30.0, "stretch": stretch, "bending": bending})
    d11, d12, d22, d66 = of.design.fabric.bending_tensor
    c, s = np.cos(np.radians(angle - 30.0)), np.sin(np.radians(angle - 30.0))
    stiffness = d11 * c**4 + d22 * s**4 + (2.0 * d12 + 4.0 * d66) * c**2 * s**2
    area = of.layout.area_mm2 / np.prod(of.design.fabric.stretch_xy)
    found = of.parts["plate"].energies(bent(of, 1e-4, angle)).sum()
    assert found == pytest.approx(0.5 * stiffness * 1e-8 * area, rel=1e-5)


def test_the_order_of_both_directions_does_not_matter() -> None:
    """Not even where the fabric is sheared."""
    one, two = seven_stars(**KNIT, grain_deg=20.0), seven_stars(**KNIT | {"modulus_mpa": [4.0, 9.0]}, grain_deg=110.0)
    printed = one.printed_state()
    sheared = printed.positions @ np.array([[0.9, 0.0, 0.0], [0.2, 0.8, 0.0], [0.0, 0.0, 1.0]])
    sheared[:, 2] = 0.01 * sheared[:, 0] ** 2 - 0.003 * sheared[:, 0] * sheared[:, 1]
    state = one.moved_to(printed, sheared)
    assert two.energies(state) == pytest.approx(one.energies(state), rel=1e-11)


def test_a_released_sheet_has_its_rest_size() -> None:
    """Without any stress, at oblique grain and unequal stretch."""
    of = seven_stars(**KNIT, grain_deg=30.0, stretch=[1.5, 1.2])
    state = State(bent(of, 0.0, 0.0).reshape(-1, 3), of.printed_state().directors, of.printed_state().frames)
    for name in ("membrane", "membrane_sides", "plate", "folds"):
        part = of.parts[name]
        assert np.abs(part.energies(state.packed)).max() < 1e-14
        assert np.abs(part.gradients(state.packed)).max() < 1e-12


@pytest.mark.parametrize("bending", ["consistent", "plate"])
def test_the_plate_is_proportional_to_its_measured_stiffness(bending: str) -> None:
    fabric, stiffness = {"modulus_mpa": 7.0}, 7.0 * 0.8**3 / (12.0 * (1.0 - 0.3**2))
    measured = [seven_stars(**fabric, bending=bending, bending_stiffness_n_mm=n * stiffness) for n in (1.0, 3.0)]
    plain = seven_stars(**fabric, bending="consistent")
    shape = bent(plain, 1e-3, 20.0)
    plate, same, thrice = (float(one.parts["plate"].energies(shape).sum()) for one in (plain, *measured))
    assert (same, thrice) == pytest.approx((plate, 3.0 * plate), rel=1e-12)
    np.testing.assert_array_equal(plain.parts["membrane"].params, measured[1].parts["membrane"].params)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("fabric", "modulus"),
    [({"bending": "paper"}, 6.0), (KNIT | {"grain_deg": 0.0}, 9.0), (KNIT | {"grain_deg": 90.0}, 4.0)],
)
def test_a_solid_layer_of_lines_rolls_as_timoshenkos_bilayer_of_the_modulus_along_them(
    fabric: dict[str, Any], modulus: float
) -> None:
    """A layer without gaps: lines as far apart as they are wide."""
    lines = [{"line_mm": [(-15.0, y), (15.0, y)]} for y in 1.2 * (np.arange(11) - 5)]
    design = Design.from_dict(
        {
            "fabric": fabric,
            "plastic": {"rest_curvature": "timoshenko", "modulus_ratio": 1600.0},
            "rods": {"draw": lines, "thickness_mm": 0.4, "width_mm": 1.1999},
            "border": {"rectangle_mm": (31.0, 13.2)},
            "mesh": {"edge_mm": 1.5},
        }
    )
    shape = exact_shape(design)
    of_one_modulus = design.plastic.model_copy(update={"modulus_ratio": 1600.0 * 6.0 / modulus})
    expected = float(rest_curvature(0.4, Fabric(), of_one_modulus))
    inner = np.isin(shape.rod_fields["arm"], np.arange(2, 9))
    curvature = float(np.nanmean(shape.rod_fields["curvature_per_mm"][inner]))
    assert shape.summary.is_minimum
    assert 0.97 < curvature / expected < 1.0


@pytest.mark.slow
def test_a_sheet_turns_and_mirrors_with_its_grain() -> None:
    """Seven stars have a third of a turn and mirrors: sheets of 20, 140 and 160 degrees are images of each other."""
    star = {"stars": {"length_mm": 10.0, "thickness_mm": 0.4}, "border": {"rings": 1}, "mesh": {"edge_mm": 4.0}}
    shapes = [
        exact_shape(Design.from_dict(star | {"fabric": KNIT | {"grain_deg": grain}})).summary
        for grain in (20.0, 140.0, 160.0, 50.0)
    ]
    assert all(shape.is_minimum for shape in shapes)
    for image in shapes[1:3]:
        assert image.energy_n_mm == pytest.approx(shapes[0].energy_n_mm, rel=1e-9)
        assert image.height_mm == pytest.approx(shapes[0].height_mm, rel=1e-6)
    assert abs(shapes[3].energy_n_mm / shapes[0].energy_n_mm - 1.0) > 1e-4
