"""The law as a shell: tubes of it have the curvature and the energies that the law says, in every direction."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
import scipy.sparse as sp

from asterism.equilibrium.arrays import Floats
from asterism.fem.shell.fields import Fields
from asterism.homogenize.errors import LawError
from asterism.homogenize.law.axes import law_coordinates
from asterism.homogenize.law.star_law import QUANTITY_NAMES
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.previews.fields.sheet_fields import BENDING_POISSON, gaussian_moduli, sheet_fields
from asterism.previews.fields.star_values import star_values
from asterism.previews.model import PREVIEW_MODEL
from tests.asterism.previews.designs import edited
from tests.asterism.previews.laws import places, plain_law, with_values

changed = partial(edited, "tube")

SIXFOLD = PREVIEW_MODEL.sixfold_factor

TUBE = gallery.load("tube")
VALUES = star_values(TUBE, layout(TUBE), plain_law())
STARS = len(VALUES.sizes)


def tube_energy(curvature: float, direction_deg: float) -> float:
    """N/mm of a sheet rolled with the plastic outside, with lengths at rest; counted from flat."""
    fields = sheet_fields(places(sp.csr_matrix(np.eye(1, STARS)), VALUES, (1, 1)))
    lam = VALUES.value["lam_n"][0]
    a = np.radians(direction_deg)
    t = np.array([np.cos(a) ** 2, np.sin(a) ** 2, 2 * np.cos(a) * np.sin(a)])
    rest = fields.rest(np.zeros((1, 1, 2)))[0, 0]

    def energy(k: float) -> float:
        # edges go down where the plastic is outside: n . hess x is negative
        state = np.r_[0.5 * lam**2, 0.5 * lam**2, 0.0, -k * lam**2 * t]
        density = fields.density
        return float(density((state - rest)[None, None])[0][0, 0])  # type: ignore[operator]

    return energy(curvature) - energy(0.0)


def test_a_tube_of_the_natural_curvature_gains_what_the_law_says() -> None:
    kappa, bending, c3 = (VALUES.value[name][0] for name in ("kappa", "bending", "c3"))
    both = [tube_energy(kappa, direction) for direction in (90.0, 120.0)]
    assert np.mean(both) == pytest.approx(-0.5 * bending * kappa**2)
    # angles of the law are counted from y
    assert both[0] - both[1] == pytest.approx(SIXFOLD * c3 * kappa**3 / 4.0)
    assert tube_energy(kappa, 75.0) == pytest.approx(np.mean(both))


def test_the_natural_curvature_is_the_best_one() -> None:
    kappa = VALUES.value["kappa"][0]
    curvatures = np.linspace(0.5, 1.5, 101) * kappa
    energies = [tube_energy(k, 75.0) for k in curvatures]
    assert curvatures[int(np.argmin(energies))] == pytest.approx(kappa, rel=0.011)
    assert tube_energy(-kappa, 75.0) > 0.0


def test_the_rim_is_bare_fabric() -> None:
    fields = sheet_fields(places(sp.csr_matrix((1, STARS)), VALUES, (1, 1)))
    points = np.zeros((1, 1, 2))
    assert fields.rest(points)[0, 0] == pytest.approx([0.5 / 1.35**2, 0.5 / 1.35**2, 0, 0, 0, 0])
    stiffness: Floats = np.asarray(fields.densities(points).stiffness)[0, 0]
    bare = {name: VALUES.value[name][-1] for name in ("a11", "a12", "bending")}
    assert stiffness[0, :2] == pytest.approx([bare["a11"], bare["a12"]])
    assert stiffness[3, 3:5] == pytest.approx(bare["bending"] * 1.35**4 * np.array([1.0, BENDING_POISSON]))


def test_caps_of_stars_cost_less_and_bare_fabric_has_no_modulus_of_gaussian_curvature() -> None:
    shares = np.array([0.0, 0.5, 1.0])
    weights = sp.csr_matrix(shares[:, None] * np.eye(1, STARS))
    bending = VALUES.value["bending"][0] / VALUES.value["lam_n"][0] ** 4

    def fields(share: float) -> Fields:
        """With a modulus of this share of the bending stiffness."""
        area = share * bending / gaussian_moduli(VALUES, 1.0, replace(PREVIEW_MODEL, gaussian_area=1.0))[0]
        model = replace(PREVIEW_MODEL, gaussian_area=area)
        return sheet_fields(places(weights, VALUES, (3, 1), spacing_mm=1.0, model=model))

    modulus = np.asarray(fields(0.1).gaussian)[:, 0]
    assert modulus[0] == 0.0
    # as the square of the share
    assert modulus[1:] == pytest.approx(-0.1 * bending * np.array([0.25, 1.0]))
    stiffness = np.asarray(fields(10.0).densities(np.zeros((3, 1, 2))).stiffness)[:, 0, 3:, 3:]
    assert (np.linalg.eigvalsh(stiffness) > 0.0).all()


def test_half_way_between_two_stars_logarithms_are_averaged() -> None:
    values = star_values(gallery.load("fig8-l-decreasing"), layout(gallery.load("fig8-l-decreasing")), plain_law())
    weights = np.zeros((1, STARS))
    weights[0, [0, 30]] = 0.5
    rest = sheet_fields(places(sp.csr_matrix(weights), values, (1, 1))).rest(np.zeros((1, 1, 2)))[0, 0]
    lam = values.value["lam_n"][[0, 30]]
    assert 2.0 * rest[0] == pytest.approx(lam[0] * lam[1])


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("lam_n", 1.2, "lam_n = 1.2, a sheet needs a contraction above 0"),
        ("a12", 20.0, r"a11 = [\d.]+, a sheet needs a positive membrane stiffness"),
    ],
)
def test_what_no_sheet_can_do_is_refused_with_star_and_value(name: str, value: float, said: str) -> None:
    law = plain_law()
    table = law.tables[0]
    nodes = table.node_values.copy()
    nodes[9:, ..., QUANTITY_NAMES.index(name)] = value
    broken = replace(law, tables=(with_values(table, nodes),))
    with pytest.raises(LawError, match=rf"star 0 at \[0.0, 0.0\]: the law's {said}"):
        star_values(TUBE, layout(TUBE), broken)


def test_an_arm_cut_short_counts_as_it_is() -> None:
    data = TUBE.to_dict() | {"border": {"rectangle_mm": [46.0, 60.0], "star_margin_mm": 5.0}}
    design = Design.from_dict(data)
    plan = layout(design)
    sizes = law_coordinates(plan, 3)
    assert sizes[:, 0].min() < 9.9 < sizes[:, 0].max() == pytest.approx(10.0)
    assert sizes[:, 1:] == pytest.approx(np.tile([0.4, 1.2], (len(sizes), 1)))
