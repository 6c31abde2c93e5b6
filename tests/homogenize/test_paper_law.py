"""The law that comes with the package: how good it says it is, and what it is made of."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.homogenize.law.law_file import load_law
from asterism.homogenize.law.material import PAPER_MATERIAL, load_material
from asterism.homogenize.law.star_law import MAX_SEPARATED_CURL, StarLaw


@pytest.fixture(scope="module")
def law() -> StarLaw:
    return load_law()


def test_it_is_of_the_plan_that_comes_with_it(law: StarLaw) -> None:
    """And says by which command, with which versions, on what machine and in what time."""
    assert law.plan == load_material(PAPER_MATERIAL).law_plan()
    assert law.made["command"] == "asterism calibrate"
    assert {"asterism", "numpy", "scipy"} <= set(law.made["versions"]) and law.made["machine"]["cores"] > 0
    assert law.made["cell_seconds"] > 0.0


@pytest.mark.parametrize("stretch", ["1.35", "1.75"])
def test_cells_that_it_has_not_seen(law: StarLaw, stretch: str) -> None:
    """Over the stated range, in percent of the cell."""
    held = law.residuals[stretch]["held_out"]
    assert held["count"] + held["tight"]["count"] == law.plan.held_out and held["count"] > 20
    typical = {"lam": 0.05, "lam_n": 0.05, "kappa": 1.0, "bending": 1.0}
    assert all(held["errors"][name]["median_percent"] < percent for name, percent in typical.items())
    allowed = {"lam": 0.2, "lam_n": 0.2, "kappa": 8.0, "bending": 8.0}
    worst = {name: held["errors"][name]["largest_percent"] for name in allowed}
    assert all(worst[name] < percent for name, percent in allowed.items()), worst
    for cell in held["cells"]:
        (a, b), (own, other) = ((cell[which]["a11"], cell[which]["a12"]) for which in ("law", "cell"))
        if not cell["tight"]:
            assert _size(a - own, b - other) < 0.08 * _size(own, other), cell


def _size(a11: float, a12: float) -> float:
    """Frobenius norm of an isotropic plane stiffness."""
    return float(np.sqrt(2.0 * a11**2 + 2.0 * a12**2 + (a11 - a12) ** 2))


def test_every_cell_of_the_stated_range_bumps_up(law: StarLaw) -> None:
    seen = 0
    for cell in law.samples:
        found = cell["sample"]
        assert found is not None, cell
        curl = np.mean(found["natural_curvature"]) * found["spacing_mm"]
        if curl > MAX_SEPARATED_CURL or cell["length_mm"] == 0.0:
            continue
        seen += 1
        assert cell["problem"] is None, cell
        assert min(found["natural_bump_mm"]) > 0.0
    assert seen > 0.6 * len(law.samples)
