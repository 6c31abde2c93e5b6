"""Weights of places: read from formulas, pictures and arrays; in the residual, the distance and the design."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from asterism import Design, FitSettings, Preview, TargetSurface, fit
from asterism.equilibrium.arrays import Floats
from asterism.fitting.disk import TargetError
from asterism.fitting.first_guess import FirstGuess, guess_design
from asterism.fitting.residual import FitDistance, FitPlaces, Residual, SheetState
from asterism.fitting.search import moves_at
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.build import layout
from asterism.previews.law_choice import paper_law
from asterism.previews.star_sensitivity import star_sensitivity
from tests.asterism.sheets import sheet

RIGHT = "1 + 7*(x > 5)"


@pytest.fixture(scope="module")
def target() -> TargetSurface:
    return TargetSurface.of_formula("10*(1 - (r/50)**2)", 80.0, name="vault")


@pytest.fixture(scope="module")
def guess(target: TargetSurface) -> FirstGuess:
    return guess_design(target, paper_law())


@pytest.fixture(scope="module")
def preview(guess: FirstGuess) -> Preview:
    return Preview(guess.design)


def residual_of(target: TargetSurface, guess: FirstGuess, is_free: bool) -> Residual:
    plan = layout(guess.design)
    return Residual(target, FitPlaces.of(guess.target_map, plan.outline, plan.lattice_vectors), is_free)


def normal_mm(target: TargetSurface, state: SheetState) -> Floats:
    return np.asarray(np.einsum("nc,nc->n", state.places - target.nearest(state.places).places, state.frame[:, 0]))


def test_a_formula_is_in_the_coordinates_of_the_file(target: TargetSurface) -> None:
    """Also if the file holds the target upside down, elsewhere and in another size."""
    turned = np.diag([1.0, -1.0, -1.0])
    vertices = 0.5 * target.disk.vertices @ turned.T + np.array([300.0, 0.0, 40.0])
    placed = TargetSurface.of_triangles(vertices, target.disk.triangles, size_mm=target.diameter_mm, side="other")
    weight = placed.weighted("1 + (x > 300) + 0*z").weight
    right = vertices[:, 0] > 300.0 + 1e-6
    assert set(weight[right]) == {2.0} and 1.0 in set(weight[~right])


def test_a_picture_lies_over_the_target_with_its_first_row_at_the_back(target: TargetSurface, tmp_path: Path) -> None:
    grey = np.zeros((2, 2), dtype=np.uint8)
    grey[0, 1] = 255  # at the back, on the right
    Image.fromarray(grey).save(tmp_path / "where.png")
    weighted = target.weighted(tmp_path / "where.png")
    corners = np.array([[-40.0, -40.0], [40.0, -40.0], [-40.0, 40.0], [40.0, 40.0], [0.0, 0.0]])
    heights = 10.0 * (1.0 - (corners**2).sum(axis=1) / 2500.0)
    places = np.column_stack([corners, heights]) @ target.motion.T + target.shift_mm
    np.testing.assert_allclose(weighted.weight_at(places), [1.0, 1.0, 1.0, 10.0, 3.25], atol=0.1)


@pytest.mark.parametrize(
    ("weight", "problem"),
    [
        ("1 +", "vault: the formula of the weight is not a formula"),
        ("x", r"vault: the weight at \(.*\) mm in the pose of the fit is -40: must be 0.01 to 100"),
        ("log(-1)", "is nan: must be 0.01 to 100"),
        ("nowhere.png", "vault: the picture of the weight"),
        (np.ones(3), r"vault: weights of shape \(3,\): must be \d+ numbers"),
    ],
)
def test_other_weights_are_refused_in_one_line(target: TargetSurface, weight: Any, problem: str) -> None:
    with pytest.raises(TargetError, match=problem) as error:
        target.weighted(weight)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("is_free", [False, True])
def test_residuals_and_their_derivatives_have_the_weights(
    target: TargetSurface, guess: FirstGuess, preview: Preview, is_free: bool
) -> None:
    weighted, plain = residual_of(target.weighted(RIGHT), guess, is_free), residual_of(target, guess, is_free)
    state = weighted.at(preview.lens(weighted.places.points)())
    weight = weighted.target.weight_at(weighted.places.goals[: weighted.places.count])
    by_hand = np.sqrt(weight @ normal_mm(target, state) ** 2 / weight.sum())
    assert state.rms_mm == pytest.approx(by_hand, rel=1e-12)
    if is_free:
        # a small motion further gives no smaller sum: the sheet is laid on the target by the weights
        turns = np.stack([np.cross(axis, state.places - state.places.mean(axis=0)) for axis in np.eye(3)], axis=-1)
        columns = weighted._columns(state, np.concatenate([turns, np.tile(np.eye(3), (len(turns), 1, 1))], axis=-1))
        assert np.abs(columns.T @ state.values).max() < 0.05 * np.linalg.norm(columns, axis=0).max() * state.rms_mm
        return
    places = weighted.places.points[: weighted.places.count]
    moves = moves_at(preview, places, star_sensitivity(preview.state, "length_mm"))
    of_weighted, of_plain = weighted.derivatives(state, moves), plain.derivatives(state, moves)
    factor = np.repeat(np.sqrt(weight / weight.mean()), 3)
    np.testing.assert_allclose(of_weighted, factor[:, None] * of_plain, rtol=1e-9, atol=1e-12)


def test_the_distance_by_weights_is_that_of_the_heavy_part_in_the_limit() -> None:
    shape = sheet(lambda flat: np.column_stack([flat, np.zeros(len(flat))]))
    mean = np.linspace(1.0, 2.0, len(shape.positions))

    def distance(weight: Floats) -> FitDistance:
        return FitDistance(shape, mean, mean, 100.0, weight)

    assert distance(np.ones(len(mean))).weighted_percent == pytest.approx(distance(np.ones(len(mean))).mean_percent)
    only_last = np.full(len(mean), 1e-12)
    only_last[-1] = 1.0
    assert distance(only_last).weighted_percent == pytest.approx(2.0)


def test_the_design_keeps_the_weights_of_its_sites(target: TargetSurface, guess: FirstGuess) -> None:
    plan, design = layout(guess.design), guess_design(target.weighted(RIGHT), paper_law()).design
    places = guess.target_map.places(plan.lattice.place(np.array([entry.site for entry in design.fit.weights])))
    in_file = np.linalg.solve(target.motion, (places - target.shift_mm).T).T
    assert len(places) > 4 and in_file[:, 0].min() > 2.0
    assert {entry.weight for entry in design.fit.weights} >= {8.0}
    assert Design.from_dict(design.to_dict()).fit == design.fit
    assert "fit" not in guess.design.to_dict()


@pytest.mark.slow
def test_a_fit_comes_nearer_where_the_weight_is_larger() -> None:
    bump = "8*exp(-((x - 18)**2 + y**2)/300)"
    target = TargetSurface.of_formula(f"{bump} + 8*exp(-((x + 18)**2 + y**2)/300)", 90.0, 70.0, name="bumps")
    where = "1 + 9*(hypot(x - 18, y) < 16)"
    at_bump = target.weighted(where)

    def rms(weight: str | None) -> tuple[float, float]:
        """In mm, at the bump and elsewhere."""
        weighted = target if weight is None else target.weighted(weight)
        distance = fit(weighted, FitSettings(exact=False, nearest=True)).distance
        is_heavy = at_bump.weight_at(distance.shape.positions) > 5.0
        parts = [(distance.shape.weights[part], distance.mean_mm[part]) for part in (is_heavy, ~is_heavy)]
        heavy, other = (float(np.sqrt(share @ mean**2 / share.sum())) for share, mean in parts)
        return heavy, other

    (plain, plain_elsewhere), (near, near_elsewhere) = rms(None), rms(where)
    assert near < 0.75 * plain
    assert near_elsewhere > plain_elsewhere


@pytest.mark.parametrize(
    ("weights", "problem"),
    [
        ([{"site": [0, 0], "weight": 0.0}], "fit.weights[0].weight = 0.0"),
        ([{"site": [0, 0], "weight": 200.0}], "fit.weights[0].weight = 200.0"),
        ([{"site": [0, 0], "weight": 2.0}, {"site": [0, 0], "weight": 3.0}], "one entry a site"),
        ([{"weight": 2.0}], "fit.weights[0].site"),
    ],
)
def test_a_design_with_other_weights_is_refused(weights: Any, problem: str) -> None:
    data = {"stars": {"length_mm": 8.0}, "border": {"rings": 1}, "fit": {"weights": weights}}
    with pytest.raises(DesignError) as error:
        Design.from_dict(data)
    assert problem in str(error.value)
