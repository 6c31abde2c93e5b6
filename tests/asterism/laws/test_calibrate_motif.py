"""`asterism calibrate` for a motif: the law of one design, shown, named by designs, continued, refused."""

from __future__ import annotations

import functools
import json
from pathlib import Path

import numpy as np
import pytest

from asterism import load_design, load_law
from asterism.homogenize.errors import LawError
from asterism.homogenize.law.law_file import law_bytes
from asterism.homogenize.law.motif_law import MotifLaw
from asterism.laws import law as module
from asterism.laws.from_files import law_from_file
from asterism.pattern.layout.build import layout
from asterism.previews.law_choice import serving_law
from tests.asterism.commands import Cli
from tests.homogenize import same_process
from tests.homogenize.motif_laws import made_up

SIZES = "thickness_mm = {thickness}\nwidth_mm = 1.2\n"
LINES = "[[rods.motif]]\nline_mm = [[0, 0], [5, 0]]\n"
REST = '[lattice]\nkind = "square"\nspacing_mm = 5\n[border]\nrectangle_mm = [40, 40]\n[mesh]\nedge_mm = 2.5\n'
VARIED = '{ profile = "radial", from = 0.4, to = 0.45, over_mm = 20 }'


def design(thickness: str = "0.4", more: str = "") -> str:
    return "[rods]\n" + SIZES.format(thickness=thickness) + LINES + REST + more


BESIDE_STARS = design(more="[stars]\nlength_mm = 1\n").replace("[[0, 0], [5, 0]]", "[[0, 2.5], [5, 2.5]]")


@pytest.fixture
def place(here: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a design, and cells that take no time."""
    same_process.use(monkeypatch)
    monkeypatch.setattr(module, "calibrate", functools.partial(module.calibrate, respond=made_up))
    (here / "net.toml").write_text(design(VARIED))
    return here


def test_a_design_gets_its_law(place: Path, cli: Cli) -> None:
    lines = cli(["calibrate", "net.toml", "--jobs", "1"]).done.out.splitlines()
    assert lines[1] == "  pattern     1 line; thickness 0.4 to 0.45 mm, width 1.2 mm"
    assert lines[-2:] == [
        f"net-law.npz: the law; its cells stay in {place / 'cells'}",
        "now run  asterism preview net.toml --law net-law.npz",
    ]
    law = load_law(place / "net-law.npz")
    assert law.made["command"] == "asterism calibrate net.toml" and law.edge_mm == 2.5
    assert len(list((place / "cells").glob("*.json"))) == 7
    again = cli(["calibrate", "net.toml", "--jobs", "1", "-o", "net-law.npz"]).done
    assert again.err.splitlines() == ["  7 of 7 cells"]


def test_another_material_is_part_of_the_law(place: Path, cli: Cli) -> None:
    (place / "soft.toml").write_text("[plastic]\nmodulus_ratio = 1000\n")
    (place / "net.toml").write_text(design())
    done = cli(["calibrate", "net.toml", "--material", "soft.toml", "--jobs", "1"]).done
    assert done.out.endswith("net.toml --material soft.toml --law net-law-soft.npz\n")
    assert load_law(place / "net-law-soft.npz").plan.design.plastic.modulus_ratio == 1000


@pytest.mark.slow
def test_show_prints_range_and_errors_and_simulate_does_not_use_the_law(place: Path, cli: Cli) -> None:
    cli(["calibrate", "net.toml", "--jobs", "1"])
    shown = cli(["law", "show", "net-law.npz"]).done
    assert "held out, 4 cells" in shown.out and "    curvature " in shown.out
    assert shown.out.splitlines()[-1] == "net-law: law.png, summary.json"
    summary = json.loads((place / "net-law" / "summary.json").read_text())
    assert summary["cells"] == 7 and summary["cells_without_law"] == []
    assert summary["residuals"]["1.35"]["held_out"]["count"] == 4
    (place / "stars.toml").write_text("[stars]\nlength_mm = 8\n[border]\nrings = 1\n")
    refusal = cli(["preview", "stars.toml", "--law", "net-law.npz"]).refusal
    assert "stars: the law is for a motif of drawn rods (net-law.npz)" in refusal
    done = cli(["simulate", "net.toml", "--law", "net-law.npz", "-q"]).done
    assert "asterism: --law is not used: drawn rods start from the flat print alone" in done.err


def test_parts_of_the_range_without_a_law_are_named(place: Path, cli: Cli) -> None:
    (place / "thin.toml").write_text(design(VARIED.replace("0.4,", "0.33,")))
    done = cli(["calibrate", "thin.toml", "--jobs", "1"]).done
    assert "  no answer: thickness 0.33 mm: the motif has no law of one cell: 2 x 2 cells relax to" in done.err
    assert "cells without a law" in done.out
    assert "   1  the motif has no law of one cell" in done.out


def test_a_motif_that_does_not_repeat_cell_by_cell_is_status_one(place: Path, cli: Cli) -> None:
    (place / "thin.toml").write_text(design("0.3"))
    ended = cli(["calibrate", "thin.toml", "--jobs", "1"])
    assert ended.status == 1
    assert ended.err.splitlines()[-1].startswith(
        "asterism: thickness 0.3 mm, width 1.2 mm: the motif has no law of one cell: 2 x 2 cells relax to"
    )
    assert not list(place.glob("*.npz"))


def test_designs_name_their_law(place: Path, cli: Cli) -> None:
    cli(["calibrate", "net.toml", "--jobs", "1"])
    (place / "named.toml").write_text(design("0.42", '[material]\nlaw = "net-law.npz"\n'))
    sheet = load_design(place / "named.toml")
    law = law_from_file(sheet, None, place / "named.toml")
    assert isinstance(law, MotifLaw) and law.evaluate_at(sheet, np.zeros((1, 2))).inside.all()
    (place / "other.toml").write_text(design("0.42", "[fabric]\nstretch = 1.5\n"))
    with pytest.raises(LawError) as refused:
        law_from_file(load_design(place / "other.toml"), place / "net-law.npz", Path("other.toml"))
    assert str(refused.value) == (
        f"other.toml: fabric.stretch = 1.5: the law was made for 1.35 ({place / 'net-law.npz'}); "
        "without it the preview makes its own law"
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (design(more="[fabric]\nbending = 'none'\n"), "d.toml: fabric.bending = 'none': has no law"),
        (design(more="[[rods.draw]]\nline_mm = [[-9, 2], [9, 2]]\n"), "d.toml: rods.draw: must be left out: a law is"),
        (design().replace("rods.motif", "rods.draw"), "d.toml: rods.motif: is missing: lines that do not repeat"),
        (BESIDE_STARS, "d.toml: stars: must be left out: a law is for a motif alone"),
    ],
)
def test_designs_without_a_law_are_refused(text: str, message: str, place: Path, cli: Cli) -> None:
    (place / "d.toml").write_text(text)
    assert cli(["calibrate", "d.toml"]).refusal.startswith(f"asterism: {message}")
    assert not list(place.glob("*.npz"))


def test_without_a_file_the_cells_are_solved_once(tmp_path: Path) -> None:
    said: list[str] = []
    (tmp_path / "net.toml").write_text(design())
    sheet = load_design(tmp_path / "net.toml")
    first, again = (serving_law(sheet, layout(sheet), None, said.append, made_up) for _ in range(2))
    assert said == ["learning this fabric: cell 1 of 1"] and law_bytes(first) == law_bytes(again)
    (tmp_path / "thin.toml").write_text(design("0.3"))
    thin = load_design(tmp_path / "thin.toml")
    with pytest.raises(LawError, match=r"^rods.motif: the motif has no law of one cell"):
        serving_law(thin, layout(thin), respond=made_up)


def test_a_motif_that_lies_on_its_copies_beside_the_sheet_is_refused_with_its_place_once(tmp_path: Path) -> None:
    text = design().replace("[5, 0]", "[7, 0]")
    outline = "polygon_mm = [[2.5, -2], [4.5, -2], [4.5, 2], [2.5, 2]]"
    (tmp_path / "net.toml").write_text(text.replace("rectangle_mm = [40, 40]", outline))
    sheet = load_design(tmp_path / "net.toml")
    with pytest.raises(
        LawError, match=r"^rods: two lines named motif\[0\] lie on each other.*; use the exact"
    ) as refused:
        serving_law(sheet, layout(sheet))
    assert refused.value.field == "rods"
