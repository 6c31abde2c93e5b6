"""The law as a shell: energies, curvatures and metrics of its fields, by direction, at free rims and in holes."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp

from asterism.equilibrium.arrays import Floats
from asterism.exact.simulation import exact_shape
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
from asterism.pattern.layout.layout import Layout
from asterism.previews.fields.sheet_fields import (
    BENDING_POISSON,
    RIM_ARM_FULL,
    RIM_ARM_START,
    arm_curvature,
    arm_metric,
    free_normals,
    gaussian_moduli,
    hole_sites,
    in_holes,
    rim_curvature_share,
    sheet_fields,
    without,
)
from asterism.previews.fields.star_values import StarValues, star_values
from asterism.previews.model import PREVIEW_MODEL
from asterism.previews.session import Preview
from tests.asterism.previews.designs import edited
from tests.asterism.previews.laws import SPACING, places, plain_law, with_values
from tests.homogenize.law.test_anisotropy import min_bending_ratio

SIXFOLD = PREVIEW_MODEL.sixfold_factor
TUBE = gallery.load("tube")
PLAN = layout(TUBE)
VALUES = star_values(TUBE, PLAN, plain_law())
STARS = len(VALUES.sizes)
DIRECTIONS = np.asarray(TUBE.lattice.arm_directions)


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
    three = arm_metric(np.array(0.8), 0.8 - DIRECTIONS @ gradient, DIRECTIONS)
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


NONE, ALL, AMONG = RIM_ARM_START, RIM_ARM_FULL, PREVIEW_MODEL.rim_arm_among
WITHOUT = without("arms into free rims")

RECTANGLE = {"rectangle_mm": [80.0, 60.0]}


def tube(border: dict[str, object], **sections: Any) -> Layout:
    return layout(Design.from_dict(TUBE.to_dict() | {"border": border} | sections))


def curvature(beside: sp.csr_matrix, normals: Floats, along: list[sp.csr_matrix], carried: Floats) -> Floats:
    """(n, 3) 1/mm, where stars have shares `beside` n places, and `along` half a spacing back along each arm."""
    stars = {"directions": DIRECTIONS, "normals": normals, "carried": carried}
    return arm_curvature(places(beside, VALUES, (len(normals), 1), along, **stars))


def test_arms_carry_their_curvature_into_a_free_rim() -> None:
    """Where only the star back along the first arm reaches, that direction curls, and the other one by as much less."""
    beside = sp.csr_matrix(np.full((3, 1), 0.5) * np.eye(1, STARS))
    reaches, nothing = sp.csr_matrix(np.ones((3, 1)) * np.eye(1, STARS)), sp.csr_matrix((3, STARS))
    normals = np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]])
    all_of_it = np.ones((STARS, 3))
    found = curvature(beside, normals, [reaches, nothing, nothing], all_of_it)
    kappa = VALUES.value["kappa"][0]
    x, y = DIRECTIONS[0]
    assert found[0] @ [x * x, y * y, 2.0 * x * y] == pytest.approx(2.0 / 3.0 * kappa)
    assert found[0, 0] + found[0, 1] == pytest.approx(0.0)
    assert found[1] == pytest.approx(found[0])
    assert found[2] == pytest.approx(0.0)  # where the rim is held
    half = np.where(np.arange(3) == 0, 0.5, all_of_it)
    assert curvature(beside, normals, [reaches, nothing, nothing], half) == pytest.approx(0.5 * found)
    assert curvature(beside, normals, [0.5 * reaches, nothing, nothing], all_of_it) == pytest.approx(0.5 * found)
    assert curvature(beside, normals, 3 * [reaches], half) == pytest.approx(0.0)


def test_arms_carry_on_what_the_fabric_before_them_allows() -> None:
    """A lone star in a rectangle: arms at 30, 150 and 270 degrees."""
    x, y = 0.5 * (ALL + NONE) * SPACING * np.sqrt(0.75), (NONE + 0.1 * (ALL - NONE)) * SPACING
    plan = tube({"rectangle_mm": [2.0 * x, 2.0 * y]})
    assert len(plan.centres) == 1
    part = rim_curvature_share(plan, DIRECTIONS)[0]
    assert part[np.abs(DIRECTIONS[:, 0]) > 0.5] == pytest.approx(0.5)
    assert part[DIRECTIONS[:, 1] < -0.9] == pytest.approx(0.1)
    # stars of a hexagon: arms that lead to others, and those of the last stars
    parts = rim_curvature_share(PLAN, DIRECTIONS)
    middle = int(np.linalg.norm(PLAN.centres, axis=1).argmin())
    assert parts[middle] == pytest.approx(AMONG)
    outwards = (np.sqrt(0.75) - NONE) / (ALL - NONE)
    assert np.unique(parts.round(9)) == pytest.approx(np.sort([AMONG, outwards]))
    # arms between the lines of the lattice lead to other stars too, and none carries on more than all of its curvature
    turned = Design.from_dict(TUBE.to_dict() | {"lattice": {"orientation_deg": 30.0}})
    plan = layout(turned)
    middle = int(np.linalg.norm(plan.centres, axis=1).argmin())
    assert rim_curvature_share(plan, np.asarray(turned.lattice.arm_directions))[middle] == pytest.approx(AMONG)
    wide = tube({"rectangle_mm": [90.0, 90.0], "star_margin_mm": 35.0})
    assert rim_curvature_share(wide, DIRECTIONS) == pytest.approx(np.ones((1, 3)))


@pytest.mark.slow
def test_corners_under_arms_hang_from_a_free_hexagon() -> None:
    stars = {"length_mm": 8.0, "thickness_mm": 0.35}
    design = Design.from_dict({"border": {"rings": 1}, "stars": stars, "mesh": {"edge_mm": 2.4}})
    exact = exact_shape(design)
    corners = 0.99 * Preview(design).sheet.layout.outline

    def turns(places: np.ndarray) -> float:
        """mm, by how much three corners of the hexagon lie higher than the other three."""
        heights = places - places.mean(axis=0)
        normal = np.linalg.svd(heights)[2][2]
        return float(abs((heights[::2] - heights[1::2]).mean(axis=0) @ normal))

    right, found = turns(exact.at(corners)), turns(Preview(design).at(corners).bumpy)
    without = turns(Preview(design, model=WITHOUT).at(corners).bumpy)
    assert right > 1.0
    assert abs(found - right) < 0.7 * abs(without - right), (right, found, without)


def test_normals_are_those_of_the_nearest_side_and_vanish_where_it_is_held() -> None:
    places = np.array([[35.0, 0.0], [-35.0, 2.0], [0.0, 25.0], [3.0, -25.0]])
    free = tube(RECTANGLE)
    expected = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
    assert free_normals(free, places) == pytest.approx(expected)
    middle = 0.5 * (free.outline + np.roll(free.outline, -1, axis=0))
    held = int(middle[:, 0].argmax())
    plan = tube(RECTANGLE, pins=[{"edges": [held], "scale": 0.8}])
    assert free_normals(plan, places) == pytest.approx(expected * np.array([[0.0], [1.0], [1.0], [1.0]]))
    # points on the right side and near the lower one
    pulled = tube(RECTANGLE, pins=[{"points_mm": [[40.0, 5.0], [10.0, -28.0]], "scale": 0.8}])
    assert free_normals(pulled, places) == pytest.approx(expected * np.array([[0.0], [1.0], [1.0], [0.0]]))
    sliding = tube(RECTANGLE, pins=[{"points_mm": [[40.0, 5.0], [10.0, -28.0]], "slide": "plane"}])
    assert free_normals(sliding, places) == pytest.approx(expected)
    alone = tube(RECTANGLE, pins=[{"points_mm": [[40.0, 25.0]], "scale": 0.8}])
    assert free_normals(alone, places) == pytest.approx(expected)


def test_a_side_in_pieces_is_one_side() -> None:
    """Held at a corner it keeps no curl along its whole length, however many corners lie on it."""
    corners = PLAN.outline
    pieces = np.concatenate(
        [np.linspace(a, b, 5)[:-1] for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)]
    )
    points = np.random.default_rng(3).uniform(-60.0, 60.0, (200, 2))
    for held in (corners[:1], corners[:2], corners[::3]):
        pins = [{"points_mm": held.tolist(), "scale": 0.9}]
        rings = corners.tolist(), np.roll(pieces, 2, axis=0).tolist()
        one, other = (free_normals(tube({"polygon_mm": ring}, pins=pins), points) for ring in rings)
        np.testing.assert_allclose(one, other, atol=1e-9)


def without_stars(border: dict[str, object], *removed: int) -> Layout:
    return tube(
        border, stars=TUBE.to_dict()["stars"] | {"override": [{"star": star, "remove": True} for star in removed]}
    )


def test_places_nearer_to_a_removed_star_than_to_others_are_in_its_hole() -> None:
    assert len(hole_sites(PLAN)) == 0 and not in_holes(PLAN, PLAN.outline).any()
    wide = hole_sites(without_stars(TUBE.to_dict()["border"], *range(7)))
    assert np.sort(np.linalg.norm(wide, axis=1)) == pytest.approx([0.0, *[SPACING] * 6], abs=1e-9)
    plan = without_stars(TUBE.to_dict()["border"], 0)
    assert hole_sites(plan) == pytest.approx(np.zeros((1, 2)), abs=1e-9)
    there = np.array([[0.0, 0.0], [0.0, 0.49 * SPACING], [0.0, 0.51 * SPACING], plan.outline[0]])
    assert in_holes(plan, there).tolist() == [True, True, False, False]


def test_the_fabric_of_a_hole_does_not_dip() -> None:
    """In the exact model it is 0.1 mm above the stars around it; with a rim's fall it would be 1.6 mm below them."""
    stars = {"length_mm": 9.0, "thickness_mm": 0.5, "override": [{"star": 0, "remove": True}]}
    preview = Preview(edited("tube", border={"rings": 2}, stars=stars))
    turns = np.radians(30.0 + 60.0 * np.arange(6))
    around = preview.at(SPACING * np.column_stack([np.cos(turns), np.sin(turns)])).bumpy
    middle = around.mean(axis=0)
    normal = np.linalg.svd(around - middle)[2][2]
    above = float((preview.at(np.zeros((1, 2))).bumpy[0] - middle) @ normal * np.sign(normal[2]))
    assert abs(above) < 0.4


def test_what_is_open_to_the_rim_is_no_hole() -> None:
    border = {"rectangle_mm": [100.0, 90.0], "star_margin_mm": 0.8 * SPACING}
    whole = tube(border)
    assert len(hole_sites(whole)) == 0
    # a star missing from any side of a wide rim, and a row of them from the middle to the rim
    for axis in whole.lattice_vectors @ np.array([[0.0, -1.0], [1.0, 0.0]]):
        along = whole.centres @ axis
        for star in (along.argmin(), along.argmax()):
            assert len(hole_sites(without_stars(border, int(whole.star_number[star])))) == 0
    row = PLAN.star_number[(np.abs(PLAN.centres[:, 0]) < 1.0) & (PLAN.centres[:, 1] > -1.0)]
    assert len(hole_sites(without_stars(TUBE.to_dict()["border"], *row.tolist()))) == 0
    # a narrow dent takes a site's place, with stars all around; or it runs between stars, that site alone has none
    dent = [[-60, -50], [60, -50], [60, 50], [1.5, 50], [0, -3], [-1.5, 50], [-60, 50]]
    assert len(hole_sites(tube({"polygon_mm": dent}))) == 0
    polygon = [[-60, -50], [60, -50], [60, -0.5], [3, 0], [60, 0.5], [60, 50], [-60, 50]]
    plan = tube({"polygon_mm": polygon, "star_margin_mm": 6.0})
    assert np.linalg.norm(plan.centres, axis=1).min() == pytest.approx(SPACING)
    assert (np.linalg.norm(plan.centres, axis=1) < 1.01 * SPACING).sum() == 6
    assert len(hole_sites(plan)) == 0
