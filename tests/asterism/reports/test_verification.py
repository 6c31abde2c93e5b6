"""verify on a small design, its files, and the report in a browser."""

from __future__ import annotations

import re
from base64 import b64decode
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from asterism import Design, Verification, preview, read_shape, verify, write_verification
from asterism.exact.simulation import exact_shape
from asterism.process.version import __version__
from asterism.reports.verification_page import verification_page
from asterism.shape.vtu import write_shape_vtu
from tests.asterism.previews.laws import plain_law
from tests.asterism.verification.printed import design

# what a name must not do to a page
NAME = 'seven <b>"stars"</b> & </title><script>document.title = "broken"</script>'
OF = design(name=NAME, mesh={"edge_mm": 2.5})


def stand_in(of: Design):
    """A shape of the same design in place of its preview: the exact one on a coarser mesh, somewhere else."""
    shape = exact_shape(Design.from_dict(of.to_dict() | {"mesh": {"edge_mm": 3.5}}))
    turned = shape.positions[:, [1, 2, 0]] + 10.0
    return replace(shape, positions=turned, summary={"warnings": ["a star is beyond the law's range"], "wall_s": 0.5})


@pytest.fixture(scope="module")
def found() -> Verification:
    return verify(OF, ready=stand_in(OF), command="asterism verify <stars>.toml --edge 2.5")


@pytest.fixture(scope="module")
def folder(found, tmp_path_factory) -> Path:
    out = tmp_path_factory.mktemp("verified") / "out"
    assert write_verification(found, out) == [
        *("exact.obj", "exact.vtu", "preview.obj", "preview.vtu", "report.html", "summary.json")
    ]
    return out


@pytest.fixture(autouse=True)
def without_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pages that a test makes itself have no pictures, which take seconds; that in `folder` is made before."""
    monkeypatch.setattr("asterism.reports.verification_page._pictures", lambda _: [])


@pytest.mark.slow
def test_summary(found):
    s = found.summary
    assert 0.0 < s["rms_percent"] < s["max_percent"] < 5.0
    assert 0.0 < s["rms_stars_percent"] < 5.0
    assert s["same_branch"] and s["starts_agree"]
    assert s["speedup"] == pytest.approx(s["exact_s"] / s["preview_s"])
    assert s["roll_radius_error_percent"] is None or abs(s["roll_radius_error_percent"]) < 20.0
    assert abs(s["height_error_percent"]) < 20.0
    lowest = min(one["energy_n_mm"] for one in s["starts"].values())
    assert s["exact"]["is_minimum"] and s["exact"]["energy_n_mm"] == pytest.approx(lowest, rel=1e-12)
    # a start that is nearly there saves most of the way
    assert s["starts"]["preview"]["iterations"] < 0.5 * s["starts"]["release"]["iterations"]
    assert s["warnings"][0] == "a star is beyond the law's range"
    assert s["preview"] and s["design"]["name"] == NAME


def test_another_shape_in_its_folder_is_not_taken_for_a_verified_one(found, folder, tmp_path):
    """`asterism report` must not say of any shape what a verification's summary says of two."""
    write_shape_vtu(found.exact["release"], tmp_path / "shape.vtu")
    (tmp_path / "summary.json").write_bytes((folder / "summary.json").read_bytes())
    assert read_shape(tmp_path).summary == {}


def test_names_of_files_that_are_no_text_do_not_stop_it(found, tmp_path):
    """As Python gives them to commands."""
    odd = replace(found, summary=found.summary | {"command": "asterism verify d\udce9.toml"})
    write_verification(odd, tmp_path)
    assert "asterism verify d\\udce9.toml" in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_both_shapes_of_a_verification_can_be_read_again(found, folder):
    exact, preview = read_shape(folder), read_shape(folder / "preview.vtu")
    assert exact.positions == pytest.approx(found.comparison.reference.positions, abs=1e-6)
    assert exact.summary["is_minimum"] and exact.summary["design"] == found.design.to_dict()
    assert preview.positions == pytest.approx(found.comparison.other.positions, abs=1e-6)
    assert preview.summary == found.summary["preview"]


def test_page_needs_nothing_else(folder):
    text = (folder / "report.html").read_text(encoding="utf-8")
    assert "<script" not in text
    assert "&lt;b&gt;&quot;stars&quot;&lt;/b&gt; &amp;" in text
    assert not re.search(r'(src|href)="(?!data:)', text)
    assert not re.search(r"url\(|@import|https?://", text)
    # five views and the distance on the sheet, the distance over the print, and two profiles
    pictures = [Image.open(BytesIO(b64decode(data))) for data in re.findall(r'data:image/png;base64,([^"]+)"', text)]
    assert len(pictures) == 9
    assert all(np.ptp(np.asarray(picture.convert("L"))) > 60 for picture in pictures)


def test_page_says_what_it_was_made_from(found, folder):
    text = (folder / "report.html").read_text(encoding="utf-8").split("Other inputs")[1]
    exact = found.summary["exact"]
    assert "asterism verify &lt;stars&gt;.toml --edge 2.5" in text and f"<td>{__version__}</td>" in text
    assert f"edges of 2.5 mm, {exact['triangles']} triangles" in text and f"solver {exact['backend']}" in text
    assert "<td>law</td>" not in text  # the stand-in has none
    law = replace(plain_law(), made={"command": "asterism calibrate my.toml"})
    made = preview(OF, law).summary
    text = verification_page(replace(found, summary=found.summary | {"preview": made, "command": None})).split(
        "Other inputs"
    )[1]
    edges = f"edges of {law.edge_mm:g} mm"
    assert f"<td>plain, fabric stretched 1.35, {edges}, made by asterism calibrate my.toml</td>" in text
    assert f"{made['shell_triangles']} triangles, side auto" in text and "<td>command</td>" not in text


def test_a_start_without_a_minimum_is_no_other_form(found):
    """However near to the preview it has stopped."""
    result = found.exact[found.result]
    stopped = replace(result, summary=result.summary | {"is_minimum": False})
    moved = replace(result, positions=result.positions * [1.0, 1.0, 1.05])
    bold = replace(result, summary=found.preview.summary)
    one = verify(OF, ready=bold, released=moved, near=stopped)
    assert one.result == "release" and one.summary["starts"]["preview"]["rms_percent"] < one.summary["rms_percent"]
    assert one.summary["same_branch"] and not one.summary["starts_agree"]
    lines = "\n".join((one.summary | {"expected_height_percent": None}).table().values())
    assert "one start in a minimum" in lines and "two minima" not in lines
    assert "one start in a minimum" in verification_page(one)


def test_the_distance_to_each_of_two_minima_is_stated(found):
    result = found.exact[found.result]
    higher = result.summary | {"energy_n_mm": 1.02 * result.summary["energy_n_mm"]}
    second = replace(result, positions=result.positions * [1.0, 1.0, 1.5], summary=higher)
    two = verify(OF, ready=found.preview, released=result, near=second).summary
    first, other = (two["starts"][name]["rms_percent"] for name in ("release", "preview"))
    assert first == two["rms_percent"] < other
    row = two.table()["exact model"]
    assert f"; the preview is {first:.2g} % from the released one, {other:.2g} % from the other one; " in row
    page = verification_page(replace(found, summary=two | {"same_branch": False}))
    assert row in page and 'The preview shows <span class="bad">another form</span> than the exact model, ' in page


def test_nothing_is_said_against_a_preview_where_the_exact_model_has_failed(found):
    """However far from it the exact model stopped."""
    failed = found.exact["release"]
    unstable = "not a minimum: smallest eigenvalue -1.0e-03 N/mm is not positive"
    numbers = failed.summary | {"is_minimum": False, "warnings": [unstable]}
    failed = replace(failed, positions=3.0 * failed.positions, summary=numbers)
    bold = replace(found.preview, summary=found.preview.summary | {"expected_rms_percent": 0.1})
    lost = verify(OF, ready=bold, released=failed, near=failed)
    assert lost.summary["same_branch"] is None
    assert lost.summary["warnings"] == [*bold.summary["warnings"], f"the exact model: {unstable}"]
    lines = "\n".join((lost.summary | {"expected_height_percent": None}).table().values())
    assert "not known: no certified exact shape" in lines and "no minimum; " in lines
    text = verification_page(lost)
    assert "not found a certified equilibrium" in text and "The preview shows" not in text
    assert '<div class="tile">' not in text


def test_a_long_entry_of_the_design_is_cut_on_the_page(found):
    corners = [[float(k), 0.25] for k in range(500)]
    design = found.summary["design"] | {"border": {"polygon_mm": corners}}
    text = verification_page(replace(found, summary=found.summary | {"design": design}))
    assert "[100.0, 0.25]" not in text and "[1.0, 0.25]" in text and " characters)" in text


def test_heights_of_nothing_are_no_percent(found):
    """A preview of 0.001 mm that expects to be 0.4 mm off."""
    flat = {"heights_mm": [0.03, 0.001], "height_error_percent": -96.7, "expected_height_percent": 40000.0}
    s = found.summary | flat
    text = verification_page(replace(found, summary=s))
    assert "height of the preview, against" not in text and "-96.7" not in text
    assert "40000" not in text and "0.4 mm" in text
    assert "height 0.4 mm" in "\n".join((s | {"expected_rms_percent": 0.6}).table().values())


def test_an_axis_that_was_taken_to_an_equivalent_one_is_told(found):
    """The warning of the preview names its own."""
    preview = found.summary["preview"] | {"roll_axis_deg": 90.0}
    for axis, told in ((30.0, True), (90.0, False)):
        s = found.summary | {"preview": preview, "roll_axes_deg": [axis, axis]}
        assert ("before the rigid motion: 90)" in verification_page(replace(found, summary=s))) is told


@pytest.mark.slow
def test_page_in_a_browser(folder: Path, browser: Any) -> None:
    """Every picture is decoded and as large as it should be, nothing sticks out, and the page is not blank."""
    shown = browser.new_page(viewport={"width": 1200, "height": 2600})
    shown.goto((folder / "report.html").as_uri())
    pixels = np.asarray(Image.open(BytesIO(shown.screenshot())).convert("L"))
    # in every screenful of the pictures there is something dark and something white
    for band in np.array_split(pixels[:1800], 4):
        assert band.min() < 120 and band.max() > 250
    for width in (1200, 500):  # a desk, a phone
        shown.set_viewport_size({"width": width, "height": 900})
        pictures = "[document.images.length, [...document.images].every(i => i.naturalWidth > 200)]"
        assert shown.evaluate(pictures) == [9, True] and shown.title() == f"{NAME}: preview and exact model"
        assert shown.evaluate("document.documentElement.scrollWidth <= innerWidth")
    shown.close()
