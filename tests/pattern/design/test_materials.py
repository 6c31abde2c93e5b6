"""Rest curvature of an arm against the paper's Eq. (1) and Timoshenko's strip.

Measured materials by name or file, and the section `[material]` of a design.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from asterism.pattern.design import files as user_files
from asterism.pattern.design.design import Design, save_design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.material_files import material_files, material_path, own_material_path
from asterism.pattern.design.materials import (
    HINGES_POISSON,
    MAX_EXPONENT,
    MIN_EXPONENT,
    Fabric,
    Plastic,
    rest_curvature,
    rest_twist,
)
from asterism.pattern.design.spread import Spread
from asterism.pattern.layout.build import load_design


@pytest.mark.parametrize(("h1", "kappa"), [(0.3, 0.02758), (0.4, 0.01269), (0.6, 0.004388)])
def test_paper(h1, kappa):
    assert rest_curvature(h1, Fabric(), Plastic()) == pytest.approx(kappa, rel=2e-3)


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


def knit(**fabric: object) -> Fabric:
    return Fabric.model_validate({"modulus_mpa": [9.0, 4.0], **fabric})


def test_equal_moduli_are_one_modulus():
    one, two = Fabric(modulus_mpa=7.0), Fabric(modulus_mpa=(7.0, 7.0), grain_deg=20.0)
    assert not two.is_orthotropic and two.exponents == (1.0, 1.0)
    assert (one.modulus, one.shear_modulus, one.bending_tensor) == (two.modulus, two.shear_modulus, two.bending_tensor)


@pytest.mark.parametrize("moduli", [(4.0, 4.0), (9.0, 4.0), (4.0, 9.0), (16.0, 4.0)])
def test_default_shear_modulus(moduli):
    """Huber's where the membrane is polyconvex with it."""
    fabric = Fabric(modulus_mpa=moduli)
    assert fabric.moduli == moduli and fabric.modulus == np.sqrt(np.prod(moduli))
    huber = fabric.modulus / (2 * (1 + fabric.poisson))
    assert fabric.shear_modulus == pytest.approx(min(huber, fabric.shear_range[1]))
    assert (fabric.shear_modulus < 0.99 * huber) == (max(moduli) == 16.0)
    assert min(fabric.exponents) >= MIN_EXPONENT - 1e-12 and max(fabric.exponents) <= MAX_EXPONENT


@pytest.mark.parametrize("bending", ["consistent", "plate"])
def test_bending_by_direction(bending):
    """Plates of the thickness in both directions; the shear modulus resists twisting."""
    plates, ratio = (1, 0.3) if bending == "consistent" else (3, HINGES_POISSON)
    moment = plates * 0.8**3 / 12 / (1 - 0.3**2)
    d11, d12, d22, d66 = knit(bending=bending).bending_tensor
    np.testing.assert_allclose([d11, d22, d12], moment * np.array([9.0, 4.0, ratio * 6.0]))
    assert d66 == pytest.approx(0.5 * (1 - ratio) * moment * 6.0)
    assert knit(bending=bending, shear_modulus_mpa=1.2).bending_tensor.d66 == pytest.approx(d66 * 1.2 * 2.6 / 6.0)
    measured = Fabric(bending="consistent", modulus_mpa=7.0, bending_stiffness_n_mm=(0.4, 0.1)).bending_tensor
    np.testing.assert_allclose(measured, [0.4, 0.3 * 0.2, 0.1, 0.35 * 0.2])


def test_rest_curvature_by_direction():
    """Along and across, Eq. (1) with the modulus of that direction, in both formulas."""
    t = np.column_stack([np.cos([0.1, 0.1 + np.pi / 2]), np.sin([0.1, 0.1 + np.pi / 2])])
    for formula in ("paper", "timoshenko"):
        plastic = Plastic(modulus_ratio=300.0, rest_curvature=formula)
        fabric = knit(grain_deg=np.degrees(0.1))
        expected = [
            rest_curvature(0.3, Fabric(), plastic.model_copy(update={"modulus_ratio": 300.0 * 6.0 / e}))
            for e in (9.0, 4.0)
        ]
        np.testing.assert_allclose(rest_curvature(0.3, fabric, plastic, t), expected, rtol=1e-12)
        assert np.abs(rest_twist(0.3, fabric, plastic, t)).max() < 1e-15
    with pytest.raises(ValueError, match="direction"):
        rest_curvature(0.3, knit(), Plastic())


@pytest.mark.parametrize("stretch", [(1.35, 1.35), (1.35, 1.2)])
def test_arms_carry_the_stress_of_the_fabric_below_them(stretch):
    """Off the grain: the moments of the stress of fabric that is held along the arm and in shear, and free across."""
    angle, grain = np.radians(25.0), np.radians(-20.0)
    t, n = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    fabric = knit(grain_deg=-20.0, stretch=stretch)
    e1, e2, mean = 9.0, 4.0, 6.0
    compliance = np.array(
        [[1 / e1, -0.3 / mean, 0.0], [-0.3 / mean, 1 / e2, 0.0], [0.0, 0.0, 1 / fabric.shear_modulus]]
    )
    released = t / stretch
    beta = np.arctan2(released[1], released[0]) - grain
    c, s = np.cos(beta), np.sin(beta)
    # stresses along the arm to those along the grain, and strains the other way by its transpose
    turn = np.array([[c * c, s * s, -2 * s * c], [s * s, c * c, 2 * s * c], [s * c, -s * c, c * c - s * s]])
    in_arm = turn.T @ compliance @ turn
    m = np.eye(2) - np.diag(1 / np.square(stretch))
    tension, shear = np.linalg.solve(in_arm[np.ix_([0, 2], [0, 2])], [t @ m @ t / 2, t @ m @ n])
    h1, h2, plastic = 0.3, 0.8, Plastic()
    lever = 6 * h2 * (h1 + h2) / h1**3
    e_plastic = plastic.modulus_ratio * mean
    assert float(rest_curvature(h1, fabric, plastic, t)) == pytest.approx(lever * 2 * tension / e_plastic, rel=1e-12)
    twist = lever * shear / (e_plastic / (2 * (1 + plastic.poisson)))
    assert float(rest_twist(h1, fabric, plastic, t)) == pytest.approx(twist, rel=1e-12)


MATERIAL = """
name = "soft"
[measured]
source = "strips.csv"
date = "2026-11-25"
[fabric]
thickness_mm = 0.5
stretch = 1.5
[plastic]
modulus_ratio = 900.0
"""
SHEET: dict[str, Any] = {"stars": {"length_mm": 8.0}, "border": {"rings": 1}}


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The list of materials of a user who has one."""
    monkeypatch.delenv(user_files.PROFILES_VARIABLE, raising=False)
    monkeypatch.setattr(user_files, "user_folder", lambda: tmp_path / "home")
    (tmp_path / "home" / "materials").mkdir(parents=True)
    (tmp_path / "home" / "materials" / "soft.toml").write_text(MATERIAL)
    (tmp_path / "near.toml").write_text(MATERIAL.replace("900", "800"))
    return tmp_path


def test_the_list_has_the_materials_of_the_user_and_of_the_package(home: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert list(material_files()) == ["paper", "soft"]
    lab = home / "lab" / "materials"
    lab.mkdir(parents=True)
    (lab / "soft.toml").write_text(MATERIAL)
    monkeypatch.setenv(user_files.PROFILES_VARIABLE, str(home / "lab"))
    assert material_files()["soft"] == lab / "soft.toml"
    assert own_material_path("new", "--save") == lab / "new.toml"
    assert material_path("near.toml", "--material", home) == home / "near.toml"
    with pytest.raises(DesignError, match=r"--material = 'wool': must be a file \(.toml\) or a name: paper, soft"):
        material_path("wool", "--material")
    for name in ("", "a/b", "../x", "paper"):
        with pytest.raises(DesignError, match="--save"):
            own_material_path(name, "--save")


@pytest.mark.parametrize(("file", "ratio"), [("soft", 900.0), ("near.toml", 800.0)])
def test_a_design_takes_the_values_of_its_material(home: Path, file: str, ratio: float) -> None:
    design = Design.from_dict(SHEET | {"material": {"file": file}}, home)
    assert (design.plastic.modulus_ratio, design.fabric.thickness_mm, design.fabric.stretch) == (ratio, 0.5, 1.5)
    assert "thickness_mm" in design.fabric.model_fields_set and design.material is None
    # its own stretch stays
    own = SHEET | {"material": {"file": file}, "fabric": {"stretch": 1.35}}
    assert Design.from_dict(own, home).fabric.stretch == 1.35
    # the design is complete without the file
    assert Design.from_dict(design.to_dict(), "elsewhere") == design
    save_design(design, home / "whole.toml")
    assert load_design(home / "whole.toml") == design


def test_a_design_takes_the_intervals_of_its_material(home: Path) -> None:
    assert "spread" not in Design.from_dict(SHEET).to_dict()
    (home / "near.toml").write_text(f"{MATERIAL}[spread]\nmodulus_ratio_factor = 1.05\n")
    design = Design.from_dict(SHEET | {"material": {"file": "near.toml"}, "spread": {"stretch_percent": 3.0}}, home)
    assert design.spread == Spread(modulus_ratio_factor=1.05, stretch_percent=3.0)
    assert Design.from_dict(design.to_dict()) == design


def test_a_law_lies_beside_the_design(home: Path) -> None:
    design = Design.from_dict(SHEET | {"material": {"law": "soft.npz"}}, home)
    assert design.material is not None and design.material.law == str(home / "soft.npz")
    assert Design.from_dict(design.to_dict(), "elsewhere") == design


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"material": {"file": "wool"}}, r"material.file = 'wool': must be a file"),
        ({"material": {"file": "none.toml"}}, r"none.toml: cannot be read"),
        ({"material": {"file": "empty.toml"}}, r"material.file = 'empty.toml': must have values in \[fabric\]"),
        ({"material": {"file": "wrong.toml"}}, r"wrong.toml: plastic.modulus_ratio = -1.*: must be at least 1"),
        ({"material": {"file": ""}}, r"material.file = ''"),
        ({"material": {"fil": "soft"}}, r"material.fil = 'soft': unknown key, did you mean file"),
        ({"material": "soft"}, r"material"),
        (
            {"material": {"file": "soft"}, "plastic": {"modulus_ratio": 3200.0}},
            r"plastic.modulus_ratio = 3200.0: is given by material.file = 'soft' too: remove one",
        ),
    ],
)
def test_mistakes_are_named(home: Path, more: dict[str, Any], said: str) -> None:
    (home / "empty.toml").write_text("name = 'empty'\n")
    (home / "wrong.toml").write_text("[plastic]\nmodulus_ratio = -1.0\n")
    with pytest.raises(DesignError, match=said):
        Design.from_dict(SHEET | more, home)
