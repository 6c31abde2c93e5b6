"""Of two exact shapes one counts, and what both starts agree on."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from asterism.pattern.design.design import Design
from asterism.pattern.geometry.planar import inside
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.reports.plots import profile_cut
from asterism.verification.minima import _same_stars_down, right_shape, same_energy


def shape(energy: float, off: tuple[int, ...] = (), minimum: bool = True, **more: Any) -> Any:
    summary = {"energy_n_mm": energy, "stars_off_branch": list(off), "is_minimum": minimum}
    return SimpleNamespace(summary=summary | more)


@pytest.mark.parametrize(
    ("release", "preview", "counts"),
    [
        (shape(10.0), shape(9.9), "preview"),
        (shape(10.0), shape(9.9, off=(3,)), "release"),
        (shape(10.0, minimum=False), shape(11.0, off=(3,)), "preview"),
        (shape(10.0), shape(10.0 - 1e-8), "release"),  # the same minimum but for rounding
        (shape(-10.0), shape(-10.1), "preview"),
    ],
)
def test_certified_ones_first_then_sides_then_energy(release: Any, preview: Any, counts: str) -> None:
    assert right_shape({"release": release, "preview": preview}) == counts


def test_two_minima_are_one_if_their_energies_are() -> None:
    assert same_energy(854.4459, 854.4459 + 1e-5) and same_energy(-1.0, -1.0 - 1e-8)
    assert not same_energy(854.4459, 853.9709)


def test_starts_agree_only_on_images_of_each_other() -> None:
    """A star that is down in the middle is not one that is down at a corner; two corners are the same."""
    hexagon = Design.from_dict({"stars": {"length_mm": 8.0}, "border": {"rings": 1}})
    plan = layout(hexagon)
    same, radius = symmetries(hexagon, plan), np.linalg.norm(plan.centres, axis=1)
    middle, corners = int(radius.argmin()), np.flatnonzero(radius > 1.0)

    def down(*stars: int) -> Any:
        return shape(1.0, stars_down=[int(star) for star in stars], stars_total=7)

    def agree(*pair: Any) -> bool:
        return _same_stars_down(*pair, plan, same)

    assert agree(down(), down()) and agree(down(corners[0]), down(corners[2]))
    assert not agree(down(middle), down(corners[0])) and not agree(down(), down(corners[0]))


def test_profiles_of_an_l_stay_on_the_sheet() -> None:
    """The middle of its stars is off the sheet."""
    legs = [[-60, -60], [60, -60], [60, -32], [-32, -32], [-32, 60], [-60, 60]]
    border = {"polygon_mm": legs, "star_margin_mm": 3}
    plan = layout(Design.from_dict({"stars": {"length_mm": 8.0}, "border": border}))
    assert not inside(plan.centres.mean(axis=0)[None], plan.outline)[0]
    seen: list[np.ndarray] = []
    sheet = SimpleNamespace(at=seen.append)
    for direction in np.eye(2):
        profile_cut(SimpleNamespace(layout=plan, reference=sheet, other=sheet), direction)  # type: ignore[arg-type]
    assert len(seen) == 4 and all(inside(points, plan.outline).all() for points in seen)
    assert all(np.ptp(points, axis=0).max() > 25.0 for points in seen)
