"""A view that follows edits shows what a new view shows."""

from __future__ import annotations

from copy import copy

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.painted_stars import with_painted_stars
from asterism.pattern.mesh.meshing import mesh_layout
from asterism.previews.session import Preview
from asterism.previews.sheet import StarLens
from asterism.studio.engine_frames import SheetView
from asterism.studio.sheet_frames import FABRIC_MM, SheetMarks
from tests.asterism.previews.laws import plain_law

DESIGN = Design.from_dict(
    {
        "stars": {"length_mm": 8.0},
        "border": {"rings": 2},
        "pins": [{"where": "corners", "scale": 0.85}],
        "mesh": {"edge_mm": 4.0},
    }
)
ARRAYS = ("positions", "curvature", "strain", "arms", "arm_normals", "needles")
SITES = np.array([[i, j] for i in range(-2, 3) for j in range(-2, 3) if abs(i + j) <= 2])
STROKES = st.lists(
    st.dictionaries(
        st.integers(0, len(SITES) - 1),
        st.tuples(st.one_of(st.just(0.0), st.floats(4.0, 9.5)), st.floats(0.25, 0.5), st.floats(0.9, 1.4)),
        min_size=1,
        max_size=5,
    ),
    min_size=1,
    max_size=3,
)


@pytest.mark.parametrize("border", [{"circle_mm": {"radius": 40.0}}, {"rectangle_mm": (90, 60)}])
def test_a_tube_holds_a_curve_and_needles_a_straight_edge(border: dict[str, object]) -> None:
    sheet = layout(Design.from_dict({**DESIGN.to_dict(), "border": border, "pins": [{"where": "border"}]}))
    mesh = mesh_layout(sheet, 4.0)
    needles = SheetMarks(mesh.points, mesh.triangles).needles(sheet, np.pad(mesh.points, ((0, 0), (0, 1))))
    if "circle_mm" in border:
        assert len(needles) == len(sheet.outline) and np.allclose(needles[1:, 0], needles[:-1, 1])  # without gaps
        assert np.allclose(np.linalg.norm(needles[:, :, :2], axis=2), 40.0, atol=1e-3)
    else:
        assert len(needles) == 2 * (5 + 3) and np.array_equal(needles[:, 0, :2], needles[:, 1, :2])


def test_plastic_below_hangs_at_the_lower_face_of_the_fabric() -> None:
    override = [{"star": 0, "side": "below"}]
    sheet = layout(Design.from_dict({**DESIGN.to_dict(), "stars": {"length_mm": 8.0, "override": override}}))
    mesh = mesh_layout(sheet, 4.0)
    flat, up = np.pad(mesh.points, ((0, 0), (0, 1))), np.tile([0.0, 0.0, 1.0], (len(mesh.points), 1))
    arms, normals = SheetMarks(mesh.points, mesh.triangles).ribbons(sheet, flat, up)
    below = sheet.arm_star == 0
    assert (normals[below, :, 2] == -1.0).all() and (normals[~below, :, 2] == 1.0).all()
    outer, inner = arms[:, :, 0, 2], arms[:, :, 2, 2]
    assert (outer[below] < inner[below]).all() and np.allclose(inner[below], -FABRIC_MM)
    assert (outer[~below] > inner[~below]).all() and np.allclose(inner[~below], 0.0)


@pytest.fixture(scope="module")
def preview() -> Preview:
    return Preview(DESIGN, plain_law())


@pytest.mark.slow
@settings(max_examples=5, deadline=None, phases=[Phase.explicit, Phase.generate])
@given(STROKES)
def test_a_view_that_follows_strokes_shows_what_a_new_one_shows(
    preview: Preview, strokes: list[dict[int, tuple[float, float, float]]]
) -> None:
    preview.update(DESIGN)
    view = SheetView(preview, is_fine=False)
    view.frame(preview, 0, "equilibrium")
    lens = preview.lens(view.printed)
    for stroke in strokes:
        painted = with_painted_stars(DESIGN, SITES[list(stroke)], list(stroke.values()))
        stage = next(preview.edit(painted))
        state = preview.state
        followed, anew = lens(stage.x), StarLens(state.sheet, view.printed)(stage.x)
        assert np.abs(followed.bumpy - anew.bumpy).max() <= 1e-12
        fresh = copy(view)  # a new view may have another mesh
        fresh._follow(preview)
        one, other = (each.frame(preview, 1, "linear", stage.x).arrays for each in (view, fresh))
        for name in ARRAYS:
            assert one[name] == pytest.approx(other[name], abs=2e-5), name  # numbers of 4 bytes
