"""`asterism.show`: what the page gets for a shape and for a preview, how requests are answered, and sliders."""

from __future__ import annotations

import json
import re
import sys
from typing import Any

import numpy as np
import pytest

import asterism
from asterism.notebook.show import LiveSheet, SliderBoard, shape_traits
from asterism.notebook.widget import ENTRY, MARK, PACKAGE, module_text, widget_module
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.studio import frames
from asterism.studio.sheet_frames import RIBBON_MM, STATIONS
from tests.asterism.sheets import dome, sheet
from tests.asterism.studio.flat_frames import unpack


def small(name: str = "dome") -> Design:
    return Design.from_dict(asterism.new(name).to_dict() | {"mesh": {"edge_mm": 4.0}})


@pytest.fixture(scope="module")
def preview() -> asterism.Preview:
    return asterism.Preview(small())


def drawn(traits: dict[str, Any]) -> tuple[dict[str, Any], dict[str, Any], dict[str, Any]]:
    """Arrays of the mesh, header and arrays of the shape."""
    kind, mesh_header, mesh = unpack(traits["mesh"])
    assert kind == frames.MESH
    kind, header, shape = unpack(traits["frame"])
    assert kind == frames.SHAPE and header["mesh"] == mesh_header["mesh"]
    return mesh, header, shape


def height(traits: dict[str, Any]) -> float:
    return float(np.ptp(drawn(traits)[2]["positions"][:, 2]))


def test_a_preview_is_shown_on_its_mesh_with_arms_needles_and_numbers(preview: asterism.Preview) -> None:
    shape = preview.shape()
    mesh, header, arrays = drawn(shape_traits(shape))
    np.testing.assert_allclose(arrays["positions"], shape.positions, atol=1e-4)
    np.testing.assert_array_equal(mesh["triangles"], shape.triangles)
    arms = len(shape.layout.arm_star)
    assert arrays["arms"].shape == (arms, 5, 3, 3) and len(mesh["arm_site"]) == arms
    tips = arrays["needles"][:, 1]
    assert len(tips) > 6 and np.abs(tips[:, 2]).max() < 1e-3  # the border of the dome stands on the ground
    assert header["height_mm"] == pytest.approx(shape.height_mm)
    assert all(np.isfinite(arrays[name]).all() for name in ("curvature", "strain"))
    known = dict(shape_traits(shape)["panel"]["figures"])
    assert known["Height"] == f"{shape.height_mm:.1f} mm" and known["Computed"] == "by the preview"
    assert known["Estimated error"].startswith(f"± {shape.summary['expected_rms_percent']:.1f} %")


def test_strains_and_curvatures_are_those_of_the_live_view(preview: asterism.Preview) -> None:
    """The two ways compute them on different meshes: by triangles here, by the shell's polynomials there."""
    _, _, by_shape = drawn(shape_traits(preview.shape()))
    _, _, live = drawn(LiveSheet(preview).opening())
    for name in ("strain", "curvature"):
        spread = np.ptp(np.percentile(live[name], [5, 95]))
        for share in (25, 50, 75):
            assert abs(np.percentile(by_shape[name], share) - np.percentile(live[name], share)) < 0.1 * spread, name


def test_a_free_exact_shape_stands_upright_on_the_ground() -> None:
    bowl = sheet(dome, edge=4.0)
    turned = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    lying = asterism.Shape(**{**vars(bowl), "positions": bowl.positions @ turned.T})
    _, _, arrays = drawn(shape_traits(lying))
    assert arrays["positions"][:, 2].min() == pytest.approx(0.0, abs=1e-4)
    assert np.ptp(arrays["positions"][:, 2]) == pytest.approx(min(lying.extent_mm), rel=1e-4)
    # a shape without a design has arms, of the width of its rods, but neither needles nor strains
    assert arrays["needles"].size == arrays["strain"].size == 0
    left, right = arrays["arms"][:, :, 0], arrays["arms"][:, :, 1]
    assert arrays["arms"].shape == (len(bowl.rod_edges), 2, 3, 3)
    np.testing.assert_allclose(np.linalg.norm(left - right, axis=-1), 1.2, rtol=1e-3)
    foot = arrays["arms"][:, :, 2]
    np.testing.assert_allclose(foot, arrays["positions"][bowl.rod_edges], atol=1e-3)
    np.testing.assert_allclose(np.linalg.norm((left + right) / 2 - foot, axis=-1), 1.0, rtol=1e-3)
    assert np.isfinite(arrays["curvature"]).all() and len(arrays["curvature"]) == len(bowl.printed)


def test_drawn_rods_are_shown_as_the_arms_of_stars_are() -> None:
    drawing = {
        "rods": {"thickness_mm": 0.6, "draw": [{"name": "rim", "circle_mm": {"radius": 20}}]},
        "border": {"rods": "rim"},
        "mesh": {"edge_mm": 5.0},
    }
    shape = asterism.simulate(Design.from_dict(drawing))
    mesh, _, arrays = drawn(shape_traits(shape))
    count = int(np.ceil(2 * np.pi * 20 / RIBBON_MM))
    assert arrays["arms"].shape == (count, STATIONS, 3, 3) and len(mesh["arm_site"]) == count
    assert len(arrays["strain"]) == len(shape.printed)


def test_sliders_change_the_preview_as_an_edit_of_the_design_does(preview: asterism.Preview) -> None:
    live = LiveSheet(preview)
    opened = live.opening()
    answers = list(live.answer({"seq": 4, "values": {"thickness": 1.2}, "is_dragging": False}))
    assert [answer["panel"]["answered"] for answer in answers if "panel" in answer][-1] == 4
    stages = [drawn(answer)[1]["stage"] for answer in answers if "frame" in answer]
    assert stages == ["linear", "equilibrium", "equilibrium"]  # the last one on the fine mesh, as at first
    design = preview.design
    assert design.stars.thickness_mm == pytest.approx(1.2 * small().stars.thickness_mm)
    shown = height(next(answer for answer in reversed(answers) if "frame" in answer))
    again = height(LiveSheet(asterism.Preview(design)).opening())
    assert shown == pytest.approx(again, abs=1e-3) and shown != pytest.approx(height(opened), abs=0.1)
    back = list(live.answer({"seq": 5, "values": {}, "is_dragging": False}))
    assert preview.design == small() and back[-1]["panel"]["values"]["thickness"] == 1.0
    assert height(back[-2]) == pytest.approx(height(opened), abs=1e-3)


def test_while_a_slider_moves_the_mesh_is_coarse_and_stays(preview: asterism.Preview) -> None:
    live = LiveSheet(preview)
    fine = live.opening()["mesh"]
    dragged = [
        answer
        for seq, value in enumerate((1.05, 1.1), 1)
        for answer in live.answer({"seq": seq, "values": {"width": value}, "is_dragging": True})
        if "frame" in answer
    ]
    assert len(dragged) == 4 and len({answer["mesh"] for answer in dragged}) == 1
    assert len(dragged[0]["mesh"]) < len(fine) / 2
    (rest,) = [a for a in live.answer({"seq": 3, "values": {"width": 1.1}, "is_dragging": False}) if "frame" in a]
    assert rest["mesh"] == fine
    list(live.answer({"seq": 4, "values": {}, "is_dragging": True}))


def test_a_request_without_a_shape_is_told_and_the_next_one_works(
    preview: asterism.Preview, monkeypatch: pytest.MonkeyPatch
) -> None:
    live = LiveSheet(preview)
    live.opening()
    before = preview.design
    (answer,) = live.answer({"seq": 1, "values": {"colour": 1.0}})
    assert answer["panel"]["problem"] == "ValueError: 'colour' is no slider of this sheet"
    assert answer["panel"]["answered"] == 1 and preview.design == before
    monkeypatch.setattr(SliderBoard, "design_at", lambda self, values: small("tube").from_dict({"stars": {}}))
    (answer,) = live.answer({"seq": 2, "values": {}})
    assert answer["panel"]["problem"].startswith("stars") and preview.design == before
    monkeypatch.undo()
    *_, last = live.answer({"seq": 3, "values": {"length": 0.95}, "is_dragging": True})
    assert last["panel"]["problem"] is None and last["panel"]["answered"] == 3
    list(live.answer({"seq": 4, "values": {}, "is_dragging": True}))


def test_the_widget_answers_the_page(preview: asterism.Preview) -> None:
    pytest.importorskip("anywidget")
    widget = asterism.show(preview, sliders=["length"], height_px=300)
    before = widget.frame
    assert widget.height_px == 300 and widget.panel["values"] == {"length": 1.0}
    seen: list[str] = []
    widget.observe(lambda change: seen.append(change["name"]), ["mesh", "frame", "panel"])
    widget.request = {"seq": 1, "values": {"length": 0.9}, "is_dragging": False}
    assert widget.panel["answered"] == 1 and widget.panel["values"] == {"length": 0.9} and widget.frame != before
    assert set(seen) == {"mesh", "frame", "panel"}
    widget.request = {"seq": 2, "values": {}, "is_dragging": False}
    assert preview.design == small()
    still = asterism.show(preview.shape())
    assert still.panel["name"] == preview.design.name
    still.request = {"seq": 1, "values": {}}
    assert still.panel["sliders"] == [] and still.panel["answered"] == 0


def test_other_arguments_are_refused_in_one_line(preview: asterism.Preview) -> None:
    with pytest.raises(TypeError, match="a Shape or a Preview is needed, not Design: "):
        asterism.show(small())  # type: ignore[arg-type]
    for height_px in (0, 119, 4001, 300.5):
        with pytest.raises(ValueError, match=rf"height_px = {height_px}: must be a whole number from 120 to 4000"):
            asterism.show(preview, height_px=height_px)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="sliders = 'length': must be a list of names"):
        asterism.show(preview, sliders="length")
    with pytest.raises(ValueError, match="sliders belong to a Preview"):
        asterism.show(preview.shape(), sliders=["length"])


def test_without_anywidget_one_line_names_the_extra(preview: asterism.Preview, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "anywidget", None)
    monkeypatch.delitem(sys.modules, "asterism.notebook.widget")
    with pytest.raises(asterism.Error, match="needs the package anywidget, which the extra notebook installs"):
        asterism.show(preview)


def sources(text: str) -> dict[str, str]:
    """The modules within a module's text, in their order."""
    begin = text.index("{")
    sources: dict[str, str] = json.JSONDecoder().raw_decode(text[begin:])[0]
    return sources


def test_a_module_comes_after_those_that_it_imports_and_once() -> None:
    several = "import {\n  c,\n  d as e,\n}"
    files = {
        "a/main.js": f'import {{ b }} from "./b.js";\n{several} from "../c.js";\nimport s from "./s.css";\n',
        "a/s.css": 'a { content: "\\2013"; }\n',
        "a/b.js": 'import { c } from "../c.js";\nexport const b = c;\n',
        "c.js": "export const c = 1;\nexport const d = 2;\n",
    }
    made = sources(module_text(files, "a/main.js"))
    assert list(made) == ["c.js", "a/b.js", "a/s.css", "a/main.js"]
    assert re.findall(rf'"{MARK}([^"]+)"', made["a/main.js"]) == ["a/b.js", "c.js", "a/s.css"]
    assert made["c.js"] == files["c.js"]
    assert made["a/s.css"] == f"export default {json.dumps(files['a/s.css'])};\n"  # a module with the text


def test_the_widget_holds_the_files_of_the_studio_and_no_import_is_left() -> None:
    made = sources(widget_module())
    assert list(made)[-1] == ENTRY and "studio/page/view/shaders.js" in made
    for name, text in made.items():
        original = (PACKAGE / name).read_text(encoding="utf-8")
        if name.endswith(".js"):
            assert text.replace(MARK, "").splitlines()[0] == original.splitlines()[0]
            assert not re.search(r'(?:^|\s)(?:import|from)\s*\(?\s*"(?!asterism:)', text), name
    assert not re.search(r"\b(?:https?|wss?)://", widget_module().replace("http://www.w3.org/", ""))


CANOPY: dict[str, Any] = {
    "stars": {"length_mm": 7.0},
    "border": {"rings": 2},
    "pins": [
        {
            "points_mm": [[43.0, 24.8], [-43.0, 24.8], [-43.0, -24.8], [43.0, -24.8]],
            "target_mm": [[31.0, 18.0, 0.0], [-31.0, 18.0, 5.0], [-31.0, -18.0, 0.0], [31.0, -18.0, 5.0]],
        }
    ],
}


def board(design: Design, keys: list[str] | None = None) -> SliderBoard:
    return SliderBoard(design, layout(design), asterism.load_law(), keys)


def test_a_design_has_the_sliders_of_what_is_in_it() -> None:
    held, free = Design.from_dict(CANOPY), Design.from_dict({"stars": {"length_mm": 7.0}, "border": {"rings": 2}})
    sizes = ["length", "thickness", "width", "stretch"]
    assert [slider.key for slider in board(held).sliders] == [*sizes, "needle_scale", "needle_height"]
    assert [slider.key for slider in board(free).sliders] == sizes
    chosen = ["needle_scale", "length"]
    assert [slider.key for slider in board(asterism.new("dome"), chosen).sliders] == chosen
    with pytest.raises(ValueError, match=r"'needle_scale', but length, thickness"):
        board(free, ["needle_scale"])
    with pytest.raises(ValueError, match=r"'height' must be one of length, .*needle_height"):
        board(free, ["height"])


def test_sizes_stay_in_the_range_of_the_law_and_stretches_are_its_own() -> None:
    design = asterism.new("dome")
    ranges = asterism.load_law().size_ranges(1.35)
    sizes = layout(design).site_sizes_mm
    for column, key in enumerate(("length", "thickness", "width")):
        (slider,), (low, high) = board(design, [key]).sliders, ranges[f"{key}_mm"]
        assert slider.low < 1.0 < slider.high
        at = [layout(board(design, [key]).design_at({key: value})).site_sizes_mm for value in (slider.low, slider.high)]
        assert at[0][:, column].min() >= low - 1e-3 and at[1][:, column].max() <= high + 1e-3
        others = [other for other in range(3) if other != column]
        np.testing.assert_array_equal(at[0][:, others], sizes[:, others])
    (stretch,) = board(design, ["stretch"]).sliders
    assert stretch.options == (1.35, 1.75) and stretch.start == design.fabric.stretch
    assert board(design).design_at({"stretch": 1.7}).fabric.stretch == 1.75


def test_sizes_of_all_stars_are_multiplied_and_removed_ones_stay_removed() -> None:
    override = [{"site": [0, 0], "remove": True}, {"site": [1, 0], "length_mm": 5.0}]
    painted = Design.from_dict(CANOPY | {"stars": {"length_mm": 7.0, "override": override}})
    for design in (asterism.new("dome"), asterism.new("tunnel"), painted):
        before, after = layout(design), layout(board(design).design_at({"length": 0.9, "width": 1.1}))
        has_arms = before.site_sizes_mm[:, 0] > 0
        expected = before.site_sizes_mm[has_arms] * [0.9, 1.0, 1.1]
        np.testing.assert_allclose(after.site_sizes_mm[has_arms], expected, atol=1e-4)
        assert len(after.centres) == len(before.centres)
    plain = board(Design.from_dict(CANOPY)).design_at({"length": 1.1})
    assert plain.stars.length_mm == pytest.approx(7.7) and plain.stars.override == ()  # a number stays one


def test_needles_move_in_the_plane_and_in_height() -> None:
    targets = np.array(CANOPY["pins"][0]["target_mm"])
    moved = board(Design.from_dict(CANOPY)).design_at({"needle_scale": 1.1, "needle_height": 0.5})
    np.testing.assert_allclose(moved.pins[0].target_mm, targets * [1.1, 1.1, 0.5])
    scaled = board(asterism.new("dome")).design_at({"needle_scale": 1.1})
    assert scaled.pins[0].scale == pytest.approx(1.1 * asterism.new("dome").pins[0].scale)


def test_values_are_checked_and_the_design_comes_back() -> None:
    design = asterism.new("dome")
    sliders = board(design)
    assert sliders.design_at({}) == design == sliders.design_at(sliders.start)
    assert sliders.checked({"length": 99.0})["length"] == next(s.high for s in sliders.sliders if s.key == "length")
    for values, message in (
        ({"colour": 1.0}, "'colour' is no slider"),
        ({"length": "long"}, "length = 'long': must be a number"),
        ({"length": float("nan")}, "length = nan: must be a number"),
        ({"length": True}, "length = True: must be a number"),
    ):
        with pytest.raises(ValueError, match=message):
            sliders.design_at(values)
