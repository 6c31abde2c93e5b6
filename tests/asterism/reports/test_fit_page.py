"""The report of a fit: its numbers, its pictures, its causes, and the page in a browser."""

from __future__ import annotations

import re
from base64 import b64decode
from dataclasses import replace
from io import BytesIO
from typing import Any

import numpy as np
import pytest
from PIL import Image

from asterism import Fit, FitSettings, TargetSurface, fit
from asterism.reports.fit_page import fit_page, remainder, star_contractions
from asterism.results.records.fit import TargetDistanceRecord
from tests.asterism.fitting.surfaces import spherical_cap

NAME = '<b>"cap"</b> & </title><script>document.title = "broken"</script>'


@pytest.fixture(scope="module")
def fitted() -> Fit:
    target = TargetSurface.of_triangles(*spherical_cap(30.0, 68.0), name=NAME)
    return with_numbers(fit(target, FitSettings(exact=False)), warnings=["a <line> that limits"])


def with_numbers(fitted: Fit, **values: Any) -> Fit:
    return replace(fitted, summary=replace(fitted.summary, **values))


@pytest.mark.slow
def test_the_page_has_its_pictures_and_numbers(fitted: Fit) -> None:
    page = fit_page(fitted)
    assert "<script>" not in page and "a &lt;line&gt; that limits" in page
    assert "The exact model has not checked it" in page
    pictures = [Image.open(BytesIO(b64decode(data))) for data in re.findall(r"data:image/png;base64,([^\"]+)", page)]
    assert len(pictures) == 10
    assert all(np.ptp(np.asarray(picture.convert("L"))) > 60 for picture in pictures)
    assert f"{fitted.distance.mean_percent:.2f} %" in page
    assert page.count(f"{fitted.distance.record.largest_percent:.1f} %") == 1


@pytest.fixture
def without_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    """They take most of the time of a page."""
    monkeypatch.setattr("asterism.reports.fit_page._pictures", lambda fitted: [])


@pytest.mark.usefixtures("without_pictures")
def test_parts_add_up_to_the_distance(fitted: Fit) -> None:
    def distances(mean: float, surface: float) -> TargetDistanceRecord:
        return fitted.summary.preview | {"mean_percent": mean, "surface_percent": surface}

    values = {
        "unrounded": distances(0.2, 0.3),
        "preview": distances(0.25, 0.35),
        "exact": distances(0.6, 0.7),
        "rounding_loss_percent": 0.05,
    }
    parts, _, _ = remainder(with_numbers(fitted, **values))
    assert list(parts) == [
        "what the stars leave, in the preview",
        "rounding to the printer",
        "exact model against preview",
        "bumps of the stars",
    ]
    assert np.sqrt(sum(size**2 for size, _ in parts.values())) == pytest.approx(0.7)
    assert parts["rounding to the printer"][0] == pytest.approx(0.15)
    page = fit_page(with_numbers(fitted, **values, exact_agrees=False))
    assert "exact model against preview" in page and "+0.050 %" in page
    assert "lead to different minima" in page
    corrected = [{"mean_percent": 0.4, "step_mm": 0.0, "kept": True}]
    parts, _, _ = remainder(with_numbers(fitted, **values, corrections=corrected))
    assert parts["rounding to the printer"][0] == pytest.approx(np.sqrt(0.6**2 - 0.55**2))
    assert np.sqrt(sum(size**2 for size, _ in parts.values())) == pytest.approx(0.7)
    gain, _, _ = remainder(with_numbers(fitted, **values | {"exact": distances(0.1, 0.2)}))
    assert "exact model against preview" not in gain


@pytest.mark.usefixtures("without_pictures")
def test_places_and_limits_are_named(fitted: Fit) -> None:
    weights, away = fitted.shape.weights, fitted.distance
    radius = np.linalg.norm(fitted.shape.printed - fitted.shape.printed.mean(axis=0), axis=1)
    at_rim = replace(away, mean_mm=np.where(radius > np.quantile(radius, 0.8), 1.0, 0.1))
    _, places, advice = remainder(replace(fitted, distance=at_rim))
    rim, inside = list(places.values())[:2]
    assert rim > 1.5 * inside
    assert advice == ["Most of the distance is at the rim. More needles hold it."]
    # the places together have the distance of all
    total = 100.0 * np.sqrt(weights @ at_rim.mean_mm**2) / away.diameter_mm
    assert inside < total < rim
    short, _, _ = remainder(with_numbers(fitted, needed_ratio=1.3, available_ratio=1.2))
    assert "a ratio of 1.300, and stars give 1.200" in short["what the stars leave, in the preview"][1]
    assert "Not reached" in fit_page(with_numbers(fitted, reached=False))


def test_contractions_of_the_target_are_within_those_of_its_stars(fitted: Fit) -> None:
    needed, low, high = star_contractions(fitted)
    assert len(needed) == fitted.summary.stars
    assert ((low < needed) & (needed < high)).mean() > 0.9
    assert needed.max() / needed.min() <= fitted.summary.needed_ratio + 1e-9
