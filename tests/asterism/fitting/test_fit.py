"""The fit of star sizes: nearer than the first guess, confirmed by a fresh preview, the same twice, printable."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh

from asterism import Fit, FitSettings, Preview, TargetSurface, fit, load_design
from asterism.fitting.first_guess import guess_design
from asterism.fitting.residual import FitPlaces, Residual
from asterism.fitting.search import StarUnknowns, moves_at
from asterism.pattern.layout.build import layout
from asterism.previews.law_choice import paper_law
from asterism.previews.star_sensitivity import star_sensitivity
from asterism.print.printer import load_printer
from tests.asterism.commands import Cli, interrupted
from tests.asterism.fitting.surfaces import spherical_cap

PREVIEW = FitSettings(exact=False)
CAP = spherical_cap(30.0, 68.0)


@pytest.fixture(scope="module")
def target() -> TargetSurface:
    return TargetSurface.of_triangles(*CAP, name="cap.obj")


@pytest.fixture(scope="module")
def fitted(target: TargetSurface) -> Fit:
    return fit(target, PREVIEW, printer=load_printer("ultimaker2"))


@pytest.mark.slow
def test_a_fresh_preview_confirms_the_distance(fitted: Fit, target: TargetSurface) -> None:
    summary = fitted.summary
    assert summary.preview.mean_percent < 0.3 and summary.preview.is_minimum and summary.reached
    assert summary.preview.mean_percent < 0.6 * summary.first_guess.mean_percent
    # the distance by other means: star centres of another preview of the written design
    preview = Preview(fitted.design)
    centres = preview.sheet.layout.centres
    inner = np.linalg.norm(centres - centres.mean(axis=0), axis=1) < 20.0
    gaps = target.nearest(preview.at(centres[inner]).smooth).distance
    assert np.sqrt((gaps**2).mean()) < 0.006 * target.diameter_mm


@pytest.mark.slow
def test_sizes_are_printable(fitted: Fit) -> None:
    rounding = fitted.design.stars.rounding
    plan = layout(fitted.design)
    layers = rounding.layers(plan.arm_thickness)
    assert np.abs(layers - np.rint(layers)).max() < 1e-6
    loss = fitted.summary.rounding_loss_percent
    assert loss is not None and abs(loss) < 0.2


@pytest.mark.slow
def test_the_same_call_gives_the_same_design(fitted: Fit, target: TargetSurface) -> None:
    again = fit(target, PREVIEW, printer=load_printer("ultimaker2"))
    assert again.design.to_dict() == fitted.design.to_dict()


@pytest.mark.slow
def test_a_free_sheet_is_laid_on_the_target(target: TargetSurface) -> None:
    fitted = fit(target, FitSettings(needles=0, exact=False))
    assert fitted.design.pins == () and fitted.summary.needles == 0
    assert fitted.summary.preview.mean_percent < 0.4
    heights, radius = fitted.shape.positions[:, 2], np.linalg.norm(fitted.shape.positions[:, :2], axis=1)
    assert heights[radius.argmin()] > heights[radius.argmax()] + 5.0


@pytest.mark.slow
def test_the_exact_model_corrects_the_fit(target: TargetSurface) -> None:
    fitted = fit(target, FitSettings(corrections=1), printer=load_printer("ultimaker2"))
    summary = fitted.summary
    assert summary.exact is not None and summary.exact.is_minimum
    # more than a quarter of the error goes, and rounding keeps some of that
    first, *others = summary.corrections
    assert first["step_mm"] == 0.0 and any(each["kept"] for each in others)
    assert min(each["mean_percent"] for each in others) < 0.75 * first["mean_percent"]
    assert 0.0 < others[0]["step_mm"] <= 1.0
    assert summary.exact.mean_percent < first["mean_percent"]
    # the verified design is the written one
    assert fitted.verification is not None and fitted.verification.design.to_dict() == fitted.design.to_dict()
    assert (summary.other_exact is None) == summary.exact_agrees


def test_derivatives_of_the_residuals_are_the_limit_of_edits(target: TargetSurface) -> None:
    guess = guess_design(target, paper_law(), PREVIEW)
    plan = layout(guess.design)
    residual = Residual(target, FitPlaces.of(guess.target_map, plan.outline, plan.lattice_vectors), False)
    unknowns = StarUnknowns.of(plan, guess.menu)
    preview = Preview(guess.design)
    lens = preview.lens(residual.places.points)
    state = residual.at(lens())
    responses = star_sensitivity(preview.state, "length_mm")
    columns = residual.derivatives(state, moves_at(preview, lens.points[: residual.places.count], responses))
    step = np.zeros(2 * len(plan.centres))
    step[: len(plan.centres)] = 0.05
    preview.update(unknowns.moved(step).design(guess.design))
    change = residual.at(lens()).values - state.values
    predicted = columns @ step[: len(plan.centres)]
    # the mean of the bumps is not differentiated
    assert np.linalg.norm(change - predicted) < 0.15 * np.linalg.norm(change)


@pytest.mark.slow
def test_the_command_writes_a_design_and_its_evidence(tmp_path: Path, cli: Cli) -> None:
    trimesh.Trimesh(*CAP, process=False).export(tmp_path / "cap.obj")
    design = tmp_path / "out.toml"
    words = ["fit", str(tmp_path / "cap.obj"), "-o", str(design), "--no-exact", "--quiet", "--within", "0.001"]
    outcome = cli(words)
    assert outcome.status == 1, outcome.err  # not as near as that
    assert "not checked with the exact model" in outcome.out
    summary = json.loads((tmp_path / "out-fit" / "summary.json").read_text())
    assert load_design(design).to_dict() == summary["design"]
    names = {file.name for file in (tmp_path / "out-fit").iterdir()}
    assert names == {"report.html", "rods.vtu", "shape.obj", "shape.vtu", "summary.json", "target.obj"}
    # the written target is that of the fit, in its pose
    written = trimesh.load(tmp_path / "out-fit" / "target.obj", process=False)
    assert np.ptp(np.asarray(written.vertices)[:, 2]) == pytest.approx(np.ptp(CAP[0][:, 2]), abs=1e-3)


@pytest.mark.slow
def test_an_interrupted_command_writes_the_best_design_until_then(tmp_path: Path) -> None:
    trimesh.Trimesh(*CAP, process=False).export(tmp_path / "cap.obj")
    # of the first exact shape
    lines = interrupted(["fit", "cap.obj", "-o", "out.toml"], tmp_path, lambda said: "iteration" in said)
    assert lines[-2].startswith("asterism: interrupted: the design is the best one until then")
    assert lines[-1] == "asterism: interrupted"
    summary = json.loads((tmp_path / "out-fit" / "summary.json").read_text())
    assert summary["interrupted"] and summary["exact"] is None
    # the fit by the preview was done, and its sizes are printable
    assert summary["preview"]["mean_percent"] < 0.6 * summary["first_guess"]["mean_percent"]
    design = load_design(tmp_path / "out.toml")
    assert design.to_dict() == summary["design"] and design.stars.rounding is not None


@pytest.mark.slow
@pytest.mark.parametrize(
    ("words", "problem"),
    [
        (["-o", "design.txt"], "must end with .toml"),
        (["--border", "--needles", "8"], "needles = 8: conflicts with border = True"),
        (["--stretch", "1.5"], "fabric.stretch = 1.5"),
        (["--size-mm", "5000"], "mm large, allowed are 10 to 4000 mm"),
        (["--printer", "none"], "none"),
        (["--weight", "1 +"], "the formula of the weight is not a formula"),
    ],
)
def test_the_command_refuses_in_one_line(words: list[str], problem: str, tmp_path: Path, cli: Cli) -> None:
    trimesh.Trimesh(*CAP, process=False).export(tmp_path / "cap.obj")
    outcome = cli(["fit", str(tmp_path / "cap.obj"), "--no-exact", "--quiet", *words])
    assert outcome.status in (1, 2) and problem in outcome.line
    assert sorted(file.name for file in tmp_path.iterdir()) == ["cap.obj"]
