"""Rest curvature of an arm against the paper's Eq. (1) and Timoshenko's strip."""

import numpy as np
import pytest

from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.materials import Fabric, Plastic, rest_curvature


@pytest.mark.parametrize(("h1", "kappa"), [(0.3, 0.02758), (0.4, 0.01269), (0.6, 0.004388)])
def test_paper(h1, kappa):
    assert rest_curvature(h1, Fabric(), Plastic()) == pytest.approx(kappa, rel=2e-3)


def test_eq_11_is_twice_timoshenko():
    """Eq. (11) in full, with its mismatch of metrics 1 - 1/s^2 (MODEL.md section 4)."""
    h1, h2, n, s = 0.35, 0.8, 40.0, 1.5
    top = 6 * h1 * h2 * n * (h1 + h2)
    bottom = h1**4 * n**2 + 2 * h1 * h2 * n * (2 * h1**2 + 3 * h1 * h2 + 2 * h2**2) + h2**4
    full = top / bottom * (1 - 1 / s**2)
    half = rest_curvature(h1, Fabric(stretch=s), Plastic(modulus_ratio=n, rest_curvature="timoshenko"))
    assert full == pytest.approx(2 * float(half), rel=1e-12)


def test_stiff_plastic_makes_paper_twice_timoshenko():
    h1 = np.array([0.3, 0.5])
    paper = rest_curvature(h1, Fabric(), Plastic(modulus_ratio=1e7))
    strip = rest_curvature(h1, Fabric(), Plastic(modulus_ratio=1e7, rest_curvature="timoshenko"))
    np.testing.assert_allclose(paper, 2 * strip, rtol=1e-4)


def test_kappa_bar_is_added_and_alone_with_none():
    with_bar = rest_curvature(0.3, Fabric(), Plastic(kappa_bar_per_mm=0.01))
    assert with_bar == pytest.approx(float(rest_curvature(0.3, Fabric(), Plastic())) + 0.01)
    alone = rest_curvature([0.3, 0.4], Fabric(), Plastic(rest_curvature="none", kappa_bar_per_mm=0.01))
    np.testing.assert_array_equal(alone, [0.01, 0.01])


def test_kappa_bar_over_thickness():
    table = {"thickness_mm": [0.3, 0.4], "per_mm": [0.004, 0.002]}
    plastic = Plastic(rest_curvature="none", kappa_bar_per_mm=table)
    found = rest_curvature([0.2, 0.3, 0.35, 0.4, 0.6], Fabric(), plastic)
    np.testing.assert_allclose(found, [0.004, 0.004, 0.003, 0.002, 0.002])
    assert Plastic.model_validate(plastic.model_dump(mode="json")) == plastic


def test_stretch_by_direction():
    fabric = Fabric(stretch=[1.35, 1.2])
    along = rest_curvature(0.3, fabric, Plastic(), [[1, 0], [0, 1]])
    np.testing.assert_allclose(along, [rest_curvature(0.3, Fabric(stretch=s), Plastic()) for s in (1.35, 1.2)])
    with pytest.raises(ValueError, match="direction"):
        rest_curvature(0.3, fabric, Plastic())


@pytest.mark.parametrize("section", ["fabric", "plastic"])
def test_a_density_in_other_units_is_refused(section: str):
    design = {"stars": {"length_mm": 10}, "border": {"rings": 0}}
    for wrong, hint in ((1.22, "is it in g/cm3"), (-1.0, "at least 0"), (30_000.0, "at most 20000")):
        with pytest.raises(DesignError, match=rf"^{section}\.density_kg_m3 = {wrong}.*{hint}"):
            Design.from_dict({**design, section: {"density_kg_m3": wrong}})
    assert Design.from_dict({**design, section: {"density_kg_m3": 0.0}})


def test_stretch_xy():
    assert Fabric(stretch=1.2).stretch_xy == (1.2, 1.2)
    assert Fabric(stretch=[1.2, 1.3]).stretch_xy == (1.2, 1.3)


def test_gravity_needs_a_real_modulus():
    design = {"stars": {"length_mm": 10}, "border": {"rings": 0}, "gravity": {"on": True}}
    with pytest.raises(DesignError, match=r"fabric\.modulus_mpa"):
        Design.from_dict(design)
    assert Design.from_dict({**design, "fabric": {"modulus_mpa": 0.01}}).gravity.on
