"""The law of stars that are not the same in all directions, from its campaign to a preview."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from asterism.homogenize.errors import LawError
from asterism.homogenize.law.anisotropy import ANISOTROPY_SIZE, sample_anisotropy
from asterism.homogenize.law.law_file import load_law
from asterism.homogenize.law.star_law import StarLaw
from asterism.laws.show_law import directions_warning
from asterism.pattern.design.design import Design
from asterism.previews.session import Preview
from tests.asterism.laws.test_calibrate import PLAN, run

# its law takes a quarter of a minute; files of such laws, and previews with them, have quick tests beside their code
pytestmark = pytest.mark.slow

LEFT = "which previews model in part"


@pytest.fixture(scope="module")
def five(tmp_path_factory: pytest.TempPathFactory) -> tuple[StarLaw, str]:
    """A law of five-armed stars, whose longest arms overlap, and what its command printed."""
    folder: Path = tmp_path_factory.mktemp("five")
    plan = PLAN.replace("[3.0, 10.0]", "[7.0, 12.0]").replace("held_out = 1", "held_out = 0")
    plan = plan.replace("[0.3, 0.5]", "[0.3, 0.4]").replace("edge_mm = 4.0", "edge_mm = 2.2")
    (folder / "five.toml").write_text(plan + "[lattice]\narms = 5\n")
    result = run("calibrate", "five.toml", "--jobs", "2", cwd=folder)
    assert result.returncode == 0, result.stderr
    law = load_law(folder / "five.npz")
    assert isinstance(law, StarLaw)
    return law, result.stdout


def sheet(arms: int, length: float = 6.0) -> Design:
    stars = {"length_mm": length, "thickness_mm": 0.4}
    return Design.from_dict({"lattice": {"arms": arms}, "stars": stars, "border": {"rings": 1}})


def test_the_law_says_what_it_leaves_out(five: tuple[StarLaw, str]) -> None:
    law, printed = five
    line = directions_warning(law)
    assert line is not None and LEFT in line and "% at most" in line
    assert line in printed
    samples = [cell["sample"] for cell in law.samples if cell["sample"] and cell["length_mm"] > 0]
    assert len(samples) == 2
    assert all(len(sample["natural_curvature"]) == 6 for sample in samples)
    values = law.at(1.35)(np.array([0.0, 4.0, 7.0]), 0.3, 1.2).value
    assert values["lam"][0] * 1.35 == pytest.approx(1.0, abs=1e-8)
    assert values["kappa"][0] == 0.0 < values["kappa"][1:].min()
    np.testing.assert_array_equal(values["c3"], 0.0)
    # arms that overlap are cells without an answer
    overlapping = [cell for cell in law.samples if cell["length_mm"] == 12.0]
    assert len(overlapping) == 2 and all("shorten or turn them" in cell["problem"] for cell in overlapping)
    assert "cells without a law" in printed and not law.at(1.35)(10.0, 0.3, 1.2).inside[0]


def test_the_law_holds_what_differs_between_directions(five: tuple[StarLaw, str]) -> None:
    law = five[0]
    table = law.at(1.35)
    assert table.anisotropy(7.0, 0.3, 1.2).shape == (1, ANISOTROPY_SIZE)
    assert not table.anisotropy(0.0, 0.3, 1.2).any()
    cell = next(cell for cell in law.samples if cell["length_mm"] == 7.0 and cell["sample"])
    found = law.anisotropy(sheet(5), *(cell[name] for name in ("length_mm", "thickness_mm", "width_mm")))
    np.testing.assert_allclose(found[0], sample_anisotropy(cell["sample"]), rtol=1e-9, atol=1e-12)


def test_a_sheet_of_five_arms_bends_differently_in_each_direction(five: tuple[StarLaw, str]) -> None:
    with pytest.raises(LawError, match=r"lattice\.arms = 3: the law is for another lattice, of 5"):
        Preview(sheet(3), five[0])
    preview = Preview(sheet(5), five[0])
    bending = np.asarray(preview.shell.density.stiffness)[..., 3:5, 3:5]
    assert np.abs(bending[..., 0, 0] / bending[..., 1, 1] - 1.0).max() > 0.01
    assert preview.equilibrium.is_minimum
    thicker = sheet(5).to_dict()
    thicker["stars"]["thickness_mm"] = 0.45
    edited = preview.update(Design.from_dict(thicker))
    assert edited.height_mm == pytest.approx(Preview(Design.from_dict(thicker), five[0]).shape().height_mm, rel=0.01)
