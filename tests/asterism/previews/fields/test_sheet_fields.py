"""The law as a shell: energies, curvatures and metrics of its fields, also where they differ between directions."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp

from asterism.equilibrium.arrays import Floats
from asterism.fem.shell.fields import Fields
from asterism.homogenize.cell.corrugation_waves import CorrugationWaves
from asterism.homogenize.errors import LawError
from asterism.homogenize.law.anisotropy import (
    ANISOTROPY_SIZE,
    BENDING_COLUMNS,
    MEMBRANE_COLUMNS,
    METRIC_COLUMNS,
    MOMENT_COLUMNS,
    tensors,
    tube_of_largest_gain,
)
from asterism.homogenize.law.star_law import MAX_SEPARATED_CURL, QUANTITY_NAMES, StarLaw, StarTable, to_stored
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.design.lattice import Lattice
from asterism.pattern.layout.build import layout
from asterism.previews.fields.sheet_fields import BENDING_POISSON, arm_metric, gaussian_moduli, sheet_fields, without
from asterism.previews.fields.star_values import StarValues, star_values
from asterism.previews.model import PREVIEW_MODEL
from tests.asterism.previews.laws import places, plain_law, with_values
from tests.homogenize.law.test_anisotropy import min_bending_ratio

SIXFOLD = PREVIEW_MODEL.sixfold_factor
TUBE = gallery.load("tube")
PLAN = layout(TUBE)
VALUES = star_values(TUBE, PLAN, plain_law())
STARS = len(VALUES.sizes)


def tube_energy(curvature: float, direction_deg: float) -> float:
    """N/mm of a sheet rolled with the plastic outside, with lengths at rest; counted from flat."""
    fields = sheet_fields(places(sp.csr_matrix(np.eye(1, STARS)), VALUES, (1, 1)))
    lam = VALUES.value["lam_n"][0]
    a = np.radians(direction_deg)
    t = np.array([np.cos(a) ** 2, np.sin(a) ** 2, 2 * np.cos(a) * np.sin(a)])
    rest = fields.rest(np.zeros((1, 1, 2)))[0, 0]

    def energy(k: float) -> float:
        # edges go down where the plastic is outside: n . hess x is negative
        state = np.r_[0.5 * lam**2, 0.5 * lam**2, 0.0, -k * lam**2 * t]
        density = fields.density
        return float(density((state - rest)[None, None])[0][0, 0])  # type: ignore[operator]

    return energy(curvature) - energy(0.0)


def test_a_tube_of_the_natural_curvature_gains_what_the_law_says() -> None:
    kappa, bending, c3 = (VALUES.value[name][0] for name in ("kappa", "bending", "c3"))
    both = [tube_energy(kappa, direction) for direction in (90.0, 120.0)]
    assert np.mean(both) == pytest.approx(-0.5 * bending * kappa**2)
    # angles of the law are counted from y
    assert both[0] - both[1] == pytest.approx(SIXFOLD * c3 * kappa**3 / 4.0)
    assert tube_energy(kappa, 75.0) == pytest.approx(np.mean(both))
    # and no other curvature gains more
    curvatures = np.linspace(0.5, 1.5, 101) * kappa
    energies = [tube_energy(k, 75.0) for k in curvatures]
    assert curvatures[int(np.argmin(energies))] == pytest.approx(kappa, rel=0.011)
    assert tube_energy(-kappa, 75.0) > 0.0


def test_the_rim_is_bare_fabric() -> None:
    fields = sheet_fields(places(sp.csr_matrix((1, STARS)), VALUES, (1, 1)))
    points = np.zeros((1, 1, 2))
    assert fields.rest(points)[0, 0] == pytest.approx([0.5 / 1.35**2, 0.5 / 1.35**2, 0, 0, 0, 0])
    stiffness: Floats = np.asarray(fields.densities(points).stiffness)[0, 0]
    bare = {name: VALUES.value[name][-1] for name in ("a11", "a12", "bending")}
    assert stiffness[0, :2] == pytest.approx([bare["a11"], bare["a12"]])
    assert stiffness[3, 3:5] == pytest.approx(bare["bending"] * 1.35**4 * np.array([1.0, BENDING_POISSON]))


def test_caps_of_stars_cost_less_and_bare_fabric_has_no_modulus_of_gaussian_curvature() -> None:
    shares = np.array([0.0, 0.5, 1.0])
    weights = sp.csr_matrix(shares[:, None] * np.eye(1, STARS))
    bending = VALUES.value["bending"][0] / VALUES.value["lam_n"][0] ** 4

    def fields(share: float) -> Fields:
        """With a modulus of this share of the bending stiffness."""
        area = share * bending / gaussian_moduli(VALUES, 1.0, replace(PREVIEW_MODEL, gaussian_area=1.0))[0]
        model = replace(PREVIEW_MODEL, gaussian_area=area)
        return sheet_fields(places(weights, VALUES, (3, 1), spacing_mm=1.0, model=model))

    modulus = np.asarray(fields(0.1).gaussian)[:, 0]
    assert modulus[0] == 0.0
    # as the square of the share
    assert modulus[1:] == pytest.approx(-0.1 * bending * np.array([0.25, 1.0]))
    stiffness = np.asarray(fields(10.0).densities(np.zeros((3, 1, 2))).stiffness)[:, 0, 3:, 3:]
    assert (np.linalg.eigvalsh(stiffness) > 0.0).all()


def test_half_way_between_two_stars_logarithms_are_averaged() -> None:
    values = star_values(gallery.load("fig8-l-decreasing"), layout(gallery.load("fig8-l-decreasing")), plain_law())
    weights = np.zeros((1, STARS))
    weights[0, [0, 30]] = 0.5
    rest = sheet_fields(places(sp.csr_matrix(weights), values, (1, 1))).rest(np.zeros((1, 1, 2)))[0, 0]
    lam = values.value["lam_n"][[0, 30]]
    assert 2.0 * rest[0] == pytest.approx(lam[0] * lam[1])


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("lam_n", 1.2, "lam_n = 1.2, a sheet needs a contraction above 0"),
        ("a12", 20.0, r"a11 = [\d.]+, a sheet needs a positive membrane stiffness"),
    ],
)
def test_what_no_sheet_can_do_is_refused_with_star_and_value(name: str, value: float, said: str) -> None:
    law = plain_law()
    table = law.tables[0]
    nodes = table.node_values.copy()
    nodes[9:, ..., QUANTITY_NAMES.index(name)] = value
    broken = replace(law, tables=(with_values(table, nodes),))
    with pytest.raises(LawError, match=rf"star 0 at \[0.0, 0.0\]: the law's {said}"):
        star_values(TUBE, PLAN, broken)


def moduli(length: float, **stars: float) -> Floats:
    """(S,) of stars with arms of a length and other values of the law; the bare fabric as it was."""
    value = {name: of.copy() for name, of in VALUES.value.items()}
    for name, number in stars.items():
        value[name][:-1] = number
    sizes = VALUES.sizes.copy()
    sizes[:, 0] = length
    return gaussian_moduli(replace(VALUES, value=value, sizes=sizes), PLAN.spacing_mm)


BARE = {name: float(VALUES.value[name][-1]) for name in ("a11", "a12", "lam_n")}


def test_the_gaussian_modulus_is_the_pull_of_the_fabric_by_a_share_of_the_squared_spacing() -> None:
    pull = 0.5 * (BARE["a11"] + BARE["a12"]) * (1.04**2 - 1.0) * BARE["lam_n"] ** 2
    for length in (4.0, 10.0):
        found = moduli(length, lam_n=1.04 * BARE["lam_n"])
        assert found == pytest.approx(PREVIEW_MODEL.gaussian_area * PLAN.spacing_mm**2 * pull)
    # bumps, which are softer, do not change it
    softer = moduli(10.0, lam_n=1.04 * BARE["lam_n"], a11=0.5 * BARE["a11"], a12=0.5 * BARE["a12"])
    assert softer == pytest.approx(found)
    # never negative, and none at bare sites
    assert not moduli(8.0, lam_n=0.9 * BARE["lam_n"]).any() and not moduli(0.0, lam_n=1.1 * BARE["lam_n"]).any()


THREE = Lattice().arm_directions


def tensor(components):
    a, b, c = components
    return np.array([[a, c], [c, b]])


@pytest.mark.parametrize("arms", range(3, 9))
@pytest.mark.parametrize("turn", [0.0, 0.3])
def test_a_known_metric_is_found_from_its_stretches_along_the_arms(arms, turn):
    """Of any number of arms; four, along two lines, miss the shear between them."""
    angles = turn + 2.0 * np.pi * np.arange(arms) / arms
    directions = np.column_stack([np.cos(angles), np.sin(angles)])
    known = np.array([[0.70, 0.03], [0.03, 0.62]])
    if arms == 4:
        known = directions[:2].T @ np.diag([0.70, 0.62]) @ directions[:2]
    along = np.sqrt(np.einsum("ni,ij,nj->n", directions, known, directions))
    lam = float(np.exp(np.log(along).mean()))
    assert tensor(arm_metric(np.array(lam), along, directions)) == pytest.approx(known)


@pytest.mark.parametrize("arms", [4, 5, 6])
def test_a_gradient_leaves_other_stars_isotropic(arms):
    """To first order: only three arms have a tensor of third order."""
    directions = Lattice(arms=arms).arm_directions
    gradient = 1e-4 * np.array([0.3, -0.8])
    metric = arm_metric(np.array(0.8), 0.8 - directions @ gradient, directions)
    assert metric == pytest.approx([0.64, 0.64, 0.0], abs=1e-7)
    three = arm_metric(np.array(0.8), 0.8 - THREE @ gradient, THREE)
    assert np.abs(three - [0.64, 0.64, 0.0]).max() > 2e-5


def values(along_x: float, moment: float = 0.0) -> StarValues:
    """Stars whose bending along x is `along_x` times the mean's, and along y `2 - along_x`."""
    own = np.zeros((STARS + 1, ANISOTROPY_SIZE))
    own[:-1, BENDING_COLUMNS[:2]] = along_x - 1.0, 1.0 - along_x
    own[:-1, MOMENT_COLUMNS[:2]] = moment, -moment
    return replace(VALUES, value=VALUES.value | {"c3": np.zeros(STARS + 1)}, anisotropy=own)


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
    stars = replace(VALUES, anisotropy=own)
    fields = sheet_fields(places(sp.csr_matrix((1, STARS)), stars, (1, 1)))
    lam = stars.value["lam_n"][-1]
    rest = fields.rest(np.zeros((1, 1, 2)))[0, 0]
    assert 2.0 * rest[:3] == pytest.approx([(1.02 * lam) ** 2, (lam / 1.02) ** 2, 0.0])
    membrane = np.asarray(fields.densities(np.zeros((1, 1, 2))).stiffness)[0, 0, :3, :3]
    assert membrane[0, 0] / membrane[1, 1] == pytest.approx(0.7 / 1.3)
    turned = np.zeros((STARS + 1, ANISOTROPY_SIZE))
    turned[-1, METRIC_COLUMNS] = 0.0, 2.0 * np.log(1.02)  # the same about 45 degrees
    fields = sheet_fields(places(sp.csr_matrix((1, STARS)), replace(VALUES, anisotropy=turned), (1, 1)))
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


def other_law(lattice: dict[str, Any]) -> StarLaw:
    """The plain law for other stars, without bumps, with bending along x 0.4 times the mean's."""
    law = plain_law()
    table = law.tables[0]
    own = np.zeros((*table.solved.shape, ANISOTROPY_SIZE))
    own[1:, ..., BENDING_COLUMNS[0]] = -0.6
    design = Design.from_dict(law.plan.design.to_dict() | {"lattice": lattice})
    flat = np.zeros((*table.solved.shape, 2 * len(CorrugationWaves.of(design.lattice))))
    values = to_stored(table.node_values, design.lattice.spacing_mm)
    plan = replace(law.plan, design=design)
    stored = np.concatenate([values, own, flat], axis=-1)
    return StarLaw(plan, (StarTable(plan, table.stretch, stored, table.solved),), (), {})


def test_stars_are_tight_where_their_cells_are_though_previews_follow_part_of_that() -> None:
    lattice, border = {"kind": "square"}, {"rectangle_mm": [70.0, 60.0]}
    for thickness, tight in ((0.3, True), (0.4, False)):
        stars = {"length_mm": 8.0, "thickness_mm": thickness}
        design = Design.from_dict({"stars": stars, "border": border, "lattice": lattice})
        found = star_values(design, layout(design), other_law(lattice))
        curl = tube_of_largest_gain(found.value["kappa"], found.anisotropy)
        assert np.abs(curl).max() * design.lattice.spacing_mm < MAX_SEPARATED_CURL
        assert bool(found.not_scale_separated) is tight
