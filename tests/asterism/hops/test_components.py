"""All components, driven as Hops does."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from starlette.testclient import TestClient

import asterism
from asterism.hops.components import KEPT_PREVIEWS, Work
from tests.asterism.hops.client import Hops, HopsError, bowl, hexagon, places
from tests.asterism.hops.conftest import HOST


def component(client: TestClient, name: str, **options: Any) -> Hops:
    return Hops(client, f"http://{HOST}/{name}", **options)


def curve_points(curve: Any) -> np.ndarray:
    return np.array([[p.X, p.Y, p.Z] for p in (curve.Point(i) for i in range(curve.PointCount))])


def test_the_source_lists_all_components(client: TestClient):
    listed = client.get("/").json()
    assert [entry["Uri"] for entry in listed] == ["/sites", "/sheet", "/rods", "/exact", "/fit", "/print"]
    assert all(client.get(entry["Uri"]).json() == entry for entry in listed)
    kinds = {entry["ParamType"] for part in listed for entry in (*part["Inputs"], *part["Outputs"])}
    assert kinds == {"Number", "Integer", "Boolean", "Text", "Point", "Curve", "Mesh"}


def test_sites_are_those_of_a_design(client: TestClient):
    found = component(client, "sites").solve(outline=hexagon(2))
    plan = asterism.preview(asterism.Design.from_dict({"stars": {"length_mm": 7}, "border": {"rings": 2}})).layout
    assert plan is not None
    np.testing.assert_allclose(np.array(found["sites"])[:, :2], plan.centres, atol=1e-3)
    assert found["numbers"] == list(range(19))


@pytest.mark.slow
def test_a_sheet_is_the_preview_of_its_design(client: TestClient):
    sheet = component(client, "sheet")
    corners = hexagon(1)
    found = sheet.solve(outline=corners, lengths=7.0, thicknesses=0.35, widths=1.1, stretch=1.4)
    design = asterism.Design.from_dict(tomllib.loads(found["design"]))
    shape = asterism.preview(design)
    assert design.fabric.stretch == 1.4 and len(found["arms"]) == len(shape.rods) == 21
    np.testing.assert_allclose(places(found["mesh"]), shape.positions, atol=1e-4)
    np.testing.assert_allclose(curve_points(found["arms"][4]), shape.positions[shape.rods[4]], atol=1e-9)
    rim = curve_points(found["rim"])
    assert np.allclose(rim[0], rim[-1]) and len(rim) > 20
    expected = 0.01 * shape.summary["expected_rms_percent"] * shape.summary["diameter_mm"]
    assert found["error"] == pytest.approx(expected)


def test_a_list_gives_each_site_its_star(client: TestClient):
    lengths = [8.0, 7.5, 7.0, 6.5, 6.0, 5.5, 0.0]
    found = component(client, "sheet").solve(outline=hexagon(1), lengths=lengths, thicknesses=0.3)
    plan = asterism.preview(asterism.Design.from_dict(tomllib.loads(found["design"]))).layout
    assert plan is not None and plan.star_sizes_mm[:, 0].tolist() == lengths[:-1]
    with pytest.raises(HopsError, match="400: lengths: got 3, must be one, or one for each of the 7 sites"):
        component(client, "sheet").solve(outline=hexagon(1), lengths=[1.0, 2.0, 3.0])


def test_holes_material_and_needles(client: TestClient):
    hole = 4.0 * np.column_stack(
        [np.cos(np.linspace(0, 2 * np.pi, 13)), np.sin(np.linspace(0, 2 * np.pi, 13)), np.zeros(13)]
    )
    corners, targets = hexagon(1)[:6:2], 0.75 * hexagon(1)[:6:2] + [0, 0, 2]
    found = component(client, "sheet").solve(
        outline=hexagon(1), holes=hole, lengths=6.0, material="paper", needles=list(corners), targets=list(targets)
    )
    held = places(found["mesh"])
    assert len(found["rim"]) == 2
    assert all(np.linalg.norm(held - target, axis=1).min() < 0.01 for target in targets)
    with pytest.raises(HopsError, match=r"material = 'papyrus': must be one of .*paper"):
        component(client, "sheet").solve(outline=hexagon(1), lengths=6.0, material="papyrus")
    with pytest.raises(HopsError, match="targets: needs one for each of the 3 needles, got 1"):
        component(client, "sheet").solve(outline=hexagon(1), lengths=6.0, needles=list(corners), targets=targets[0])


@pytest.mark.slow
def test_all_lengths_are_in_the_unit_of_the_document(client: TestClient):
    in_mm = component(client, "sheet").solve(outline=hexagon(1), lengths=7.0, widths=1.0, spacing=17.0)
    metres = {"outline": hexagon(1, 1000.0), "lengths": 0.007, "widths": 0.001, "spacing": 0.017}
    in_metres = component(client, "sheet", units="Meters").solve(**metres)
    assert in_metres["error"] == pytest.approx(in_mm["error"] / 1000, rel=1e-3)
    np.testing.assert_allclose(1000 * places(in_metres["mesh"]), places(in_mm["mesh"]), atol=1e-3)
    with pytest.raises(HopsError, match="modelunits = 'Furlongs'"):
        component(client, "sheet", units="Furlongs").solve(outline=hexagon(1), lengths=7.0)


def test_curves_of_all_kinds_are_outlines(client: TestClient):
    sites = component(client, "sites")
    rhino = sites.rhino
    circle = rhino.Circle(rhino.Point3d(0, 0, 0), 45.0)
    arc, nurbs = rhino.ArcCurve.CreateFromCircle(circle), circle.ToNurbsCurve()
    counts = [len(sites.solve(outline=curve)["sites"]) for curve in (arc, nurbs)]
    assert type(arc).__name__ == "ArcCurve" and counts == [19, 19]
    with pytest.raises(HopsError, match="outline: must be a closed curve"):
        sites.solve(outline=hexagon(1)[:-1])
    with pytest.raises(HopsError, match="outline: needs a value, got 0"):
        sites.solve()


def test_a_sheet_follows_its_last_form_until_it_is_searched_anew(client: TestClient, served: tuple[TestClient, Work]):
    sheet = component(client, "sheet")
    sheet.solve(outline=hexagon(1), lengths=6.0)
    sheet.solve(outline=hexagon(1), lengths=6.1)
    assert any("search = true" in warning for warning in sheet.warnings)
    sheet.solve(outline=hexagon(1), lengths=6.1, search=True)
    assert not any("search = true" in warning for warning in sheet.warnings)
    for size in range(KEPT_PREVIEWS + 2):
        sheet.solve(outline=hexagon(1) * (1 + 0.01 * size), lengths=6.0)
    assert len(served[1]._previews) == KEPT_PREVIEWS


def test_a_sheet_that_cannot_be_is_an_error_and_the_next_one_is_not(client: TestClient):
    sheet = component(client, "sheet")
    for lengths in (30.0, -1.0, [7.0] * 6 + [30.0]):
        with pytest.raises(HopsError, match=r"^400: stars.*length_mm"):
            sheet.solve(outline=hexagon(1), lengths=lengths)
    assert sheet.solve(outline=hexagon(1), lengths=7.0)["error"] > 0.0


@pytest.mark.slow
def test_rods_are_solved_exactly(client: TestClient):
    rods = [[(-12, 0, 0), (12, 0, 0)], [(8, -6, 0), (8, 6, 0), (-8, 6, 0), (-8, -6, 0), (8, -6, 0)]]
    found = component(client, "rods").solve(outline=hexagon(0), curves=rods, thicknesses=[0.3, 0.5], widths=1.0)
    assert "equilibrium: stable" in found["certificate"]
    drawn = tomllib.loads(found["design"])["rods"]["draw"]
    assert [rod["thickness_mm"] for rod in drawn] == [0.3, 0.5] and [rod["closed"] for rod in drawn] == [False, True]
    with pytest.raises(HopsError, match="widths: got 3, must be one, or one for each of the 2 curves"):
        component(client, "rods").solve(outline=hexagon(0), curves=rods, widths=[1.0, 1.0, 1.0])


@pytest.mark.slow
def test_exact_shapes_come_with_certificate_and_other_forms(client: TestClient, folder: Path):
    # an outline that is symmetric to five decimals only, as drawings are
    design = component(client, "sheet").solve(outline=hexagon(1, rounded=5), lengths=9.0)["design"]
    # older versions of Hops do not undo the escapes of JSON
    found = component(client, "exact").solve(design=design.replace('"', '\\"').replace("\n", "\\n"))
    shape = asterism.simulate(asterism.Design.from_dict(tomllib.loads(design)))
    np.testing.assert_allclose(places(found["mesh"]), shape.positions, atol=1e-4)
    assert "equilibrium: stable" in found["certificate"]
    assert found["others"] == [] or len(shape.others) > 0


def test_exact_shapes_that_take_too_long_are_refused(client: TestClient, served: tuple[TestClient, Work]):
    served[1].patience_s = 1.0
    try:
        with pytest.raises(HopsError, match=r"takes about .* longer than --patience 1 s"):
            component(client, "exact").solve(design="[stars]\nlength_mm = 7.0\n[border]\nrings = 1\n")
    finally:
        served[1].patience_s = 100.0


@pytest.mark.slow
def test_other_forms_are_branches(client: TestClient):
    found = component(client, "exact").solve(
        design="[stars]\nlength_mm = 7.4\n[border]\nrings = 3\n[fabric]\nbending = 'paper'\n"
    )
    others = found["others"] if isinstance(found["others"], list) else [found["others"]]
    assert [type(other).__name__ for other in others] == ["Mesh"]


@pytest.mark.slow
def test_a_fit_comes_near_to_its_target_and_can_be_previewed(client: TestClient):
    found = component(client, "fit").solve(target=bowl())
    assert found["distance"] < 0.5 and len(found["lengths"]) == len(found["sites"]) == len(found["widths"])
    assert len(curve_points(found["outline"])) > 4
    assert asterism.Design.from_dict(tomllib.loads(found["design"])).pins


@pytest.mark.slow
def test_prints_are_written_below_the_folder_of_the_server(client: TestClient, folder: Path):
    design = component(client, "sheet").solve(outline=hexagon(1), lengths=7.0)["design"]
    paths = component(client, "print").solve(design=design, folder="jobs/one")["paths"]
    assert all(Path(path).is_file() and folder in Path(path).parents for path in paths) and len(paths) > 8
    for name in ("../outside", "/tmp/outside", "C:\\outside", ".hidden", "", "jobs/../../outside"):
        with pytest.raises(HopsError, match=r"^400"):
            component(client, "print").solve(design=design, folder=name)
