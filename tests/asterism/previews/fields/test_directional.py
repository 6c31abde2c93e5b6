"""Fields of stars that bend differently in each direction."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.cell.corrugation_waves import CorrugationWaves
from asterism.homogenize.law.anisotropy import (
    ANISOTROPY_SIZE,
    BENDING_COLUMNS,
    ISOTROPIC_PLATE,
    MEMBRANE_COLUMNS,
    METRIC_COLUMNS,
    MIN_BENDING_RATIO,
    MOMENT_COLUMNS,
    VOIGT_ENTRIES,
    natural_curvatures,
    tensors,
    tube_of_largest_gain,
)
from asterism.homogenize.law.star_law import MAX_SEPARATED_CURL, StarLaw, StarTable, to_stored
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.previews.fields.sheet_fields import BENDING_POISSON, sheet_fields, without
from asterism.previews.fields.star_values import StarValues, star_values
from asterism.previews.model import PREVIEW_MODEL
from tests.asterism.previews.laws import places, plain_law
from tests.homogenize.law.test_anisotropy import min_bending_ratio

PLAN = layout(gallery.load("tube"))
PLAIN = star_values(gallery.load("tube"), PLAN, plain_law())
STARS = len(PLAN.centres)


def values(along_x: float, moment: float = 0.0) -> StarValues:
    """Stars whose bending along x is `along_x` times the mean's, and along y `2 - along_x`."""
    own = np.zeros((STARS + 1, ANISOTROPY_SIZE))
    own[:-1, BENDING_COLUMNS[:2]] = along_x - 1.0, 1.0 - along_x
    own[:-1, MOMENT_COLUMNS[:2]] = moment, -moment
    return replace(PLAIN, value=PLAIN.value | {"c3": np.zeros(STARS + 1)}, anisotropy=own)


def moments(stars: StarValues, curvature: tuple[float, float]) -> Floats:
    """(6,) stress of a sheet of the first star on its natural length with curvatures about y and x, over lam^2."""
    fields = sheet_fields(places(sp.csr_matrix(np.eye(1, STARS)), stars, (1, 1)))
    square = stars.value["lam_n"][0] ** 2
    state = square * np.array([0.5, 0.5, 0.0, -curvature[0], -curvature[1], 0.0])
    rest = fields.rest(np.zeros((1, 1, 2)))[0, 0]
    return np.asarray(fields.density((state - rest)[None, None])[1][0, 0])  # type: ignore[operator]


@pytest.mark.parametrize(("along_x", "moment"), [(1.0, 0.0), (0.6, 0.0), (1.3, 0.005)])
def test_a_tube_about_either_axis_has_no_moment_around_it_at_its_own_curvature(along_x: float, moment: float) -> None:
    stars = values(along_x, moment)
    kappa = stars.value["kappa"][0]
    x, y = (kappa + moment) / along_x, (kappa - moment) / (2.0 - along_x)
    scale = np.abs(moments(stars, (0.0, 0.0))[3:5]).max()
    assert abs(moments(stars, (x, 0.0))[3]) < 1e-12 * scale
    assert abs(moments(stars, (0.0, y))[4]) < 1e-12 * scale
    gains = (kappa + moment) * x, (kappa - moment) * y
    best = tube_of_largest_gain(stars.value["kappa"], stars.anisotropy)
    assert best[0] == pytest.approx((x, y)[int(np.argmax(gains))])
    assert best[-1] == stars.value["kappa"][-1] == 0.0


def test_bare_fabric_is_the_same_in_all_directions_and_stars_share_it_evenly() -> None:
    stars = values(0.6)
    weights = sp.csr_matrix(np.array([[0.0], [1.0]]) * np.eye(1, STARS))
    model = without("Gaussian curvature")
    fields = sheet_fields(places(weights, stars, (2, 1), model=model))
    stiffness = np.asarray(fields.densities(np.zeros((2, 1, 2))).stiffness)[:, 0, 3:, 3:]
    assert stiffness[0, 0, 0] == stiffness[0, 1, 1]
    assert stiffness[1, 0, 0] / stiffness[1, 1, 1] == pytest.approx(0.6 / 1.4)
    assert stiffness[1, 0, 1] == pytest.approx(BENDING_POISSON * 0.5 * (stiffness[1, 0, 0] + stiffness[1, 1, 1]))


def test_fabric_that_differs_contracts_and_stretches_by_direction() -> None:
    """Bare fabric 2 % longer along x and as much shorter along y than in the mean, and softer along x."""
    own = np.zeros((STARS + 1, ANISOTROPY_SIZE))
    own[-1, METRIC_COLUMNS] = 2.0 * np.log(1.02), 0.0
    own[-1, MEMBRANE_COLUMNS[:2]] = -0.3, 0.3
    stars = replace(PLAIN, anisotropy=own)
    fields = sheet_fields(places(sp.csr_matrix((1, STARS)), stars, (1, 1)))
    lam = stars.value["lam_n"][-1]
    rest = fields.rest(np.zeros((1, 1, 2)))[0, 0]
    assert 2.0 * rest[:3] == pytest.approx([(1.02 * lam) ** 2, (lam / 1.02) ** 2, 0.0])
    membrane = np.asarray(fields.densities(np.zeros((1, 1, 2))).stiffness)[0, 0, :3, :3]
    assert membrane[0, 0] / membrane[1, 1] == pytest.approx(0.7 / 1.3)
    turned = np.zeros((STARS + 1, ANISOTROPY_SIZE))
    turned[-1, METRIC_COLUMNS] = 0.0, 2.0 * np.log(1.02)  # the same about 45 degrees
    fields = sheet_fields(places(sp.csr_matrix((1, STARS)), replace(PLAIN, anisotropy=turned), (1, 1)))
    rest = fields.rest(np.zeros((1, 1, 2)))[0, 0]
    along = 0.25 * lam**2 * (1.02**2 + 1.02**-2)
    assert rest[:3] == pytest.approx([along, along, 0.5 * lam**2 * (1.02**2 - 1.02**-2)])


def test_caps_of_soft_directions_stay_stable() -> None:
    """However much Gaussian curvature saves."""
    stars = values(0.2)
    low = min_bending_ratio(tensors(stars.value["kappa"], stars.anisotropy)[0])
    assert low[0] < 0.21 and low[-1] == pytest.approx(1.0)
    weights = sp.csr_matrix(np.eye(1, STARS))
    fields = sheet_fields(places(weights, stars, (1, 1), model=replace(PREVIEW_MODEL, gaussian_area=1e6)))
    stiffness = np.asarray(fields.densities(np.zeros((1, 1, 2))).stiffness)[0, 0, 3:, 3:]
    assert np.linalg.eigvalsh(stiffness).min() > 0.0


def test_the_better_of_two_near_peaks_is_found() -> None:
    """Over random tensors, some of which gain nearly alike about two axes."""
    rng = np.random.default_rng(2)
    own, kappa = np.zeros((400, ANISOTROPY_SIZE)), np.full(400, 0.02)
    for row in own:
        root = rng.normal(size=(3, 3)) * rng.choice([0.3, 1.0])
        bending = MIN_BENDING_RATIO * ISOTROPIC_PLATE + root @ root.T
        row[BENDING_COLUMNS] = [(bending - ISOTROPIC_PLATE)[entry] for entry in VOIGT_ENTRIES]
        row[MOMENT_COLUMNS] = 0.03 * rng.normal(size=3)
    found = tube_of_largest_gain(kappa, own)
    everywhere, gain = natural_curvatures(*tensors(kappa, own), np.linspace(0.0, np.pi, 3600))
    best = gain.max(axis=1)[:, None]
    off = np.where(gain > 0.999 * best, np.abs(everywhere - found[:, None]), np.inf).min(axis=1)
    assert (off < 0.02 * np.abs(found)).all()


def other_law(lattice: dict[str, Any], along_x: float | None = None) -> StarLaw:
    """The plain law for other stars, without bumps, with bending along x `along_x` times the mean's."""
    law = plain_law()
    table = law.tables[0]
    own = np.zeros((*table.solved.shape, 0 if along_x is None else ANISOTROPY_SIZE))
    if along_x is not None:
        own[1:, ..., BENDING_COLUMNS[0]] = along_x - 1.0
    design = Design.from_dict(law.plan.design.to_dict() | {"lattice": lattice})
    flat = np.zeros((*table.solved.shape, 2 * len(CorrugationWaves.of(design.lattice))))
    values = to_stored(table.node_values, design.lattice.spacing_mm)
    plan = replace(law.plan, design=design)
    stored = np.concatenate([values, own, flat], axis=-1)
    return StarLaw(plan, (StarTable(plan, table.stretch, stored, table.solved),), (), {})


def sheet(thickness: float, lattice: dict[str, Any]) -> Design:
    return Design.from_dict(
        {
            "stars": {"length_mm": 8.0, "thickness_mm": thickness},
            "border": {"rectangle_mm": [70.0, 60.0]},
            "lattice": lattice,
        }
    )


def test_stars_are_tight_where_their_cells_are_though_previews_follow_part_of_that() -> None:
    lattice = {"kind": "square"}
    for thickness, tight in ((0.3, True), (0.4, False)):
        design = sheet(thickness, lattice)
        found = star_values(design, layout(design), other_law(lattice, along_x=0.4))
        curl = tube_of_largest_gain(found.value["kappa"], found.anisotropy)
        assert np.abs(curl).max() * design.lattice.spacing_mm < MAX_SEPARATED_CURL
        assert bool(found.not_scale_separated) is tight
