"""The fields of the homogenised shell: rest metric, rest curvature and stiffness from the law at the stars.

For a place with contraction `lam` and natural curvature `kappa`, in printed coordinates:

    a_r = lam^2 I                            rest metric,
    b_r = -kappa lam^2 / (1 + nu) I          rest curvature,
    D = bending / lam^4                      stiffness against printed curvatures, in N mm.

The logarithms of contraction and stiffnesses are averaged between stars, and the curvatures themselves.

- **Sign.** The normal `x_1 x x_2` points up on the print. If the edges of a sheet go down, its second fundamental form
  `b = n . hess x` is negative, and `kappa` is positive.
- **Factor.** An isotropic plate with rest curvature `c I` rolls to a tube of curvature `(1 + nu) c`, and gains the
  energy `D ((1 + nu) c)^2 / 2`. The law's `kappa` is the curvature of the tube; this gain defines its `bending`.
- **Powers of lam.** The curvatures of the law belong to the contracted sheet; a tube of radius r has `b = lam^2/r` per
  squared printed length.

The corrections describe what cells of endless sheets of equal stars leave out. They act one after the other; each has
its equation with its function. A model without it has its name in `PreviewModel.off`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.ndimage import label
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Bools, Floats
from asterism.fem.shell.density import Density, gaussian_limits, isotropic
from asterism.fem.shell.fields import Fields
from asterism.homogenize.law.anisotropy import (
    BENDING_POISSON,
    MEMBRANE_COLUMNS,
    METRIC_COLUMNS,
    tensors,
    voigt_matrices,
)
from asterism.pattern.design.lattice import DEFAULT_SPACING_MM
from asterism.pattern.geometry.planar import distance_along, distance_to_outline, distance_to_segment, nearest_segment
from asterism.pattern.layout.layout import Layout
from asterism.previews.fields.star_cells import CELL_RADIUS, MIN_STAR_SHARE, beside, stars_share
from asterism.previews.fields.star_values import StarPlaces, StarValues, rosette
from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from asterism.previews.point_pins import softened, stretched_fabric


def rosette_metric(fields: Fields, at: StarPlaces) -> Fields:
    """The fields with the rest metric where the stars change over the sheet.

    A star with three arms differs between opposite directions. Where the lines of the lattice follow the arms, the
    fabric between two neighbours lies under the arm of only one of them. Therefore the contraction along the direction
    `d_k` of an arm is that of the stars half a spacing back along the arm:

        rho_k(X) = lam(X - spacing/2 d_k).

    The rest metric has these contractions along all N arms, like a strain rosette, scaled so that their geometric mean
    is `lam`:

        a_r = lam^2 (m I + 4/N sum_k (s_k - m) (d_k d_k - I/2)),   s_k = rho_k^2 / (prod_j rho_j)^(2/N),   m = mean s_k.

    For four arms the factor is 2/N, since they lie along two lines only, which leaves the shear undetermined. For equal
    stars, a_r is `lam^2 I`. A gradient of the sizes changes a_r only for three arms.
    """
    if not at.along_arms:
        return fields
    along = np.stack([at.log_mean("lam_n", weights) for weights in at.along_arms], axis=-1)
    return replace(fields, metric=arm_metric(at.lam, along, at.directions))


def arm_metric(lam: Floats, along: Floats, directions: Floats) -> Floats:
    """(..., 3) components 11, 22, 12 of the rest metric of places with contraction `lam` (...).

    `along`: (..., N) contraction of the stars half a spacing back along each arm, of directions (N, 2).
    """
    stretch = (along / np.exp(np.log(along).mean(axis=-1, keepdims=True))) ** 2
    mean = stretch.mean(axis=-1)
    mean_part = mean[..., None] * np.array([1.0, 1.0, 0.0])
    return np.asarray((lam**2)[..., None] * (mean_part + rosette(stretch, directions)))


def directions(fields: Fields, at: StarPlaces) -> Fields:
    """The fields with the tensors of sheets that differ between directions (`homogenize.law.anisotropy`).

    The law holds what cells are at their natural curvature. Stars whose arms differ from their lattice bend most
    differently there, while flat cells of them are nearly isotropic, and sheets are in between. Therefore the share
    `anisotropy_share` of these differences in bending acts in the shell. With the deviator d of the metric's logarithm,
    the rest metric is `exp(d/2) a_r exp(d/2)`.
    """
    if not at.values.anisotropy.shape[1]:
        return fields
    assert isinstance(fields.density, Density)
    differs = at.anisotropy
    q, m = tensors(at.mean("kappa"), differs)
    stiffness = np.array(fields.density.stiffness)
    stiffness[..., :3, :3] += stiffness[..., :1, :1] * voigt_matrices(differs[..., MEMBRANE_COLUMNS])
    stiffness[..., 3:, 3:] = (at.log_mean("bending") / at.lam**4)[..., None, None] * q
    along, across = np.moveaxis(0.5 * differs[..., METRIC_COLUMNS], -1, 0)
    deviator = np.moveaxis(np.array([[along, across], [across, -along]]), (0, 1), (-2, -1))
    size = np.hypot(along, across)[..., None, None]
    # the exponential of the deviator; that of scipy goes through the matrices one by one
    root = np.cosh(size) * np.eye(2) + np.sinh(size) / np.where(size > 0.0, size, 1.0) * deviator
    metric = root @ np.asarray(fields.metric)[..., [[0, 2], [2, 1]]] @ root
    # -lam^2 Q^-1 m with components 11, 22, 12
    bend = -(at.lam**2)[..., None] * np.linalg.solve(q, m[..., None])[..., 0] * np.array([1.0, 1.0, 0.5])
    return replace(
        fields,
        density=replace(fields.density, stiffness=stiffness),
        metric=np.stack([metric[..., 0, 0], metric[..., 1, 1], metric[..., 0, 1]], axis=-1),
        curvature=bend,
    )


def roll_axis(fields: Fields, at: StarPlaces) -> Fields:
    """The fields with the sixfold term (`fem.shell.density`): stars prefer some axes of rolling.

    `b = -kappa lam^2 t t^T` has `Re[((b11 - b22)/2 + i b12)^3] = -(kappa lam^2)^3 cos(6 phi)/8` if t is at the angle
    phi to the x axis. The law's `c3` is `4 (psi_0 - psi_30)/kappa^3` with angles from y. These are phi = 90 and 120
    degrees, where cos(6 phi) is -1 and 1. So the factor of the term per printed area is `c3 / lam^6`, in N mm^2, times
    `sixfold_factor`, enlarged by the part that the saturation removes at the natural curvature.
    """
    assert isinstance(fields.density, Density)
    natural = 0.5 * np.abs(at.mean("kappa")) * at.lam**2
    saturation = 3.0  # curvature over the natural one; origin unknown
    density = replace(
        fields.density,
        sixfold=at.model.sixfold_factor * (1.0 + 1.0 / saturation**2) * at.mean("c3") / at.lam**6,
        orientation=np.zeros(at.shape),
        # the lower limit is a turn over one spacing
        saturation=np.maximum(saturation * natural, 1e-3 * DEFAULT_SPACING_MM / at.spacing_mm),
    )
    return replace(fields, density=density)


# border distances in spacings at which an arm carries nothing, without room ahead, and all, with room for a whole cell
RIM_ARM_START = 0.5
RIM_ARM_FULL = 1.5


def rim_arms(fields: Fields, at: StarPlaces) -> Fields:
    """The fields with the curl of free rims along the arms that point into them.

    The fabric between two stars lies under the arm of only one of them (`rosette_metric`). Likewise, a rim below arms
    that point outwards curls along these arms. This term bends three corners of a sheet of three-armed stars down, or
    determines the axis about which it rolls. In a free sheet, the additional rest curvature of bare fabric is the
    deviator of a strain rosette of the stars half a spacing back along each arm.

    **Wide rims.** The tension of the fabric along an arm and beyond its tip bends the arm. An arm that ends at the
    border, half a spacing away, stays nearly straight; one with room for a whole cell ahead bends as much as one among
    other stars. With the distance x from the star to the border along its arm, in spacings, the arm carries this share
    of its natural curvature into the rim:

        (x - RIM_ARM_START) / (RIM_ARM_FULL - RIM_ARM_START), limited to the range from 0 to 1.

    If an arm leads to another star, the rim beside it takes the share `rim_arm_among`.

    **Free sides.** A side is not free if it is supported along its length, or at a point of a sheet with several
    supported points: there the fabric is pulled straight along the rim. Points that slide along the print do not pull.
    A hole in the sheet has sides like the outline. A hole in the pattern, lattice sites without a star that are
    enclosed by stars, has no side: the fabric is whole there.

    On fabric with a grain each arm curls by its own direction, which a mean over the directions does not say: sheets
    are nearer to the exact model without this term.
    """
    if at.carried is None or at.has_grain:
        return fields
    more = at.lam[..., None] ** 2 * arm_curvature(at).reshape(*at.shape, 3) / (1.0 + BENDING_POISSON)
    return replace(fields, curvature=np.asarray(fields.curvature) - more)


def arm_curvature(at: StarPlaces) -> Floats:
    """(n, 3) 1/mm, additional rest curvature, components 11, 22, 12: shares along the arms times natural curvature.

    It is zero among stars and at supported sides.
    """
    assert at.carried is not None and at.normals is not None
    shares = np.column_stack([stars_share(along) for along in at.along_arms])
    parts = np.column_stack([along @ part for along, part in zip(at.along_arms, at.carried.T, strict=True)])
    parts /= np.maximum(shares, MIN_STAR_SHARE)
    more = shares - shares.min(axis=1, keepdims=True)
    deviator = rosette(parts * more, at.directions)
    near = np.where(at.normals.any(axis=1), beside(at.weights, at.values.value["kappa"][:-1]), 0.0)
    return np.asarray(near[:, None] * deviator)


def rim_curvature_share(layout: Layout, directions: Floats, model: PreviewModel = PREVIEW_MODEL) -> Floats:
    """(S, N) share of the natural curvature that the arms of each star, of directions (N, 2), carry into a free rim."""
    part = np.empty((len(layout.centres), len(directions)))
    for k, along in enumerate(directions):
        to_rings = [distance_along(layout.centres, along, ring) for ring in layout.edges.rings]
        width = np.min(to_rings, axis=0) / layout.spacing_mm
        room = np.clip((width - RIM_ARM_START) / (RIM_ARM_FULL - RIM_ARM_START), 0.0, 1.0)
        part[:, k] = np.where(_are_last_arms(layout, along), room, model.rim_arm_among)
    return part


def _are_last_arms(layout: Layout, direction: Floats) -> Bools:
    """(S,) whether the arms of the stars along a direction (2,) end at the rim: the site ahead has no star."""
    ahead = layout.spacing_mm * direction
    steps = np.stack(np.meshgrid(*[np.arange(-3, 4)] * 2, indexing="ij"), axis=-1).reshape(-1, 2)
    sites = cKDTree(steps[steps.any(axis=1)] @ layout.lattice_vectors)
    to_star = cKDTree(layout.centres).query(layout.centres + ahead)[0]
    # an arm is a last one if the next star is further away by this, in spacings; origin unknown
    return np.asarray(to_star > sites.query(ahead)[0] + 0.3 * layout.spacing_mm)


def free_normals(layout: Layout, points: Floats) -> Floats:
    """(n, 2) unit normals of the sides nearest to printed points (n, 2) mm; zero at supported sides and in holes.

    A side is supported along its length, or at a point if supports fix at least two points of the sheet along the
    print.
    """
    edges = layout.edges
    start, end = edges.start, edges.end
    along = end - start
    nearest = nearest_segment(points, start, end)
    normal = np.column_stack([along[:, 1], -along[:, 0]]) / np.linalg.norm(along, axis=1)[:, None]
    normal[layout.supported_edges] = 0.0
    pins = layout.in_plane_pin_points
    if len(pins) > 1:
        # spacings; a side is supported by points nearer to it than this; origin unknown
        near = 0.5 * layout.spacing_mm
        held = (distance_to_segment(pins[:, None], start, end) < near).any(axis=0)
        side = edges.straight_sides
        normal[np.isin(side, side[held])] = 0.0
    return np.where(in_holes(layout, points)[:, None], 0.0, normal[nearest])


def in_holes(layout: Layout, points: Floats) -> Bools:
    """(n,) whether printed points (n, 2) mm are nearer to a site of a hole in the pattern than to all stars."""
    holes = hole_sites(layout)
    if not len(holes):
        return np.zeros(len(points), dtype=bool)
    return np.asarray(cKDTree(holes).query(points)[0] < cKDTree(layout.centres).query(points)[0])


def hole_sites(layout: Layout) -> Floats:
    """(n, 2) mm, lattice sites without a star that are not connected to the rim through other such sites."""
    vectors = layout.lattice_vectors
    sites = np.rint((layout.centres - layout.lattice_origin) @ np.linalg.inv(vectors)).astype(np.int64)
    first = sites.min(axis=0) - 1
    empty = np.ones(np.ptp(sites, axis=0) + 3, dtype=bool)
    empty[tuple((sites - first).T)] = False
    steps = np.array([[(i, j) for j in (-1, 0, 1)] for i in (-1, 0, 1)]) @ vectors
    longest = (1.0 + 1e-6) * np.linalg.norm(vectors, axis=1).max()  # of a step to a neighbour
    region = label(empty, np.linalg.norm(steps, axis=-1) <= longest)[0][empty]
    places = layout.lattice_origin + (np.argwhere(empty) + first) @ vectors
    near = CELL_RADIUS * layout.spacing_mm  # the cells of nearer sites reach the outline
    away = np.min([distance_to_outline(places, ring) for ring in layout.edges.rings], axis=0)
    rim = ~layout.is_on_sheet(places) | (away < near)
    return np.asarray(places[~np.isin(region, region[rim])])


def self_stress(fields: Fields, at: StarPlaces) -> Fields:
    """The fields with a Gaussian modulus: work of the self-stress within cells when the sheet takes Gaussian curvature.

    A flat sheet of stars is self-stressed: its fabric is in tension, its arms are in compression. Gaussian curvature K
    changes lengths within a cell, and the self-stress does work on that. The energy changes by the integral of -phi K.
    Here phi is Airy's stress function, which vanishes at a free border and is positive among the stars. The shell
    includes the part of this energy that acts between bare rim and stars, through its rest metric. The part within
    cells is added as a Gaussian modulus g, of the energy -g det b per printed area,

        g = a d^2 (A11 + A12) (lam^2 - lam_bare^2) / 2,    a = `gaussian_area`,

    with the spacing d and the membrane stiffness A of bare fabric. It is multiplied by the squared share of the stars,
    so that its slope vanishes at the border. Periodic cells on tubes have no Gaussian curvature and cannot show g;
    ribbons can, since all of their area is near a border. The area a d^2 is the difference of two integrals of phi, for
    the exact model and for the shell.

    On fabric with a grain the tension differs between directions, and one number does not describe its work: sheets are
    nearer to the exact model without it.
    """
    if at.has_grain:
        return fields
    assert isinstance(fields.density, Density)
    moduli = gaussian_moduli(at.values, at.spacing_mm, at.model)
    share = np.minimum(stars_share(at.weights), 1.0)
    saved = (share * (at.weights @ moduli)).reshape(at.shape)
    most = -gaussian_limits(np.asarray(fields.density.stiffness)[..., 3:, 3:])[0]
    # largest Gaussian modulus, as a share of the one at which the bending energy becomes indefinite
    return replace(fields, gaussian=-np.minimum(saved, 0.95 * most))


def gaussian_moduli(values: StarValues, spacing: float, model: PreviewModel = PREVIEW_MODEL) -> Floats:
    """(S,) Gaussian moduli g of the stars in N mm; the spacing is in mm. Bare sites have none."""
    value, has_arms = values.value, values.sizes[:, 0] > 0.0
    more = np.maximum(value["lam_n"][:-1] ** 2 - value["lam_n"][-1] ** 2, 0.0)
    # tension in N/mm of bare fabric that is held at the contraction of each star
    pulls = 0.5 * (value["a11"][-1] + value["a12"][-1]) * more
    return np.asarray(model.gaussian_area * spacing**2 * has_arms * pulls)


def neo_hookean_fabric(fields: Fields, at: StarPlaces) -> Fields:
    """The fields with neo-Hookean bare fabric, on sheets that are pulled at points."""
    if at.softness is None:
        return fields
    assert isinstance(fields.density, Density)
    bare = 1.0 - np.asarray(at.weights.sum(axis=1)).reshape(at.shape)
    term = stretched_fabric(fields, np.asarray(fields.density.stiffness), bare)
    return replace(fields, density=replace(fields.density, term=term))


CORRECTIONS: dict[str, Callable[[Fields, StarPlaces], Fields]] = {
    "rosette metric": rosette_metric,
    "directions": directions,
    "roll axis": roll_axis,
    "arms into free rims": rim_arms,
    "Gaussian curvature": self_stress,
    "softness at points": lambda fields, at: softened(fields, at.softness),
    "neo-Hookean fabric": neo_hookean_fabric,
}
PARTS = (*CORRECTIONS, "bumps", "arms that keep their length")


def without(part: str) -> PreviewModel:
    """The model with one part turned off; raises KeyError unless `PARTS` has a part of that name."""
    if part not in PARTS:
        raise KeyError(part)
    return replace(PREVIEW_MODEL, off=(part,))


def sheet_fields(at: StarPlaces) -> Fields:
    """The fields of the shell at places, with all corrections of the model."""
    lam, a11, bending = at.lam, at.log_mean("a11"), at.log_mean("bending")
    square, zero = lam**2, np.zeros(at.shape)
    bend = -at.mean("kappa") * square / (1.0 + BENDING_POISSON)
    fields = Fields(
        Density(isotropic(a11, bending / lam**4, at.mean("a12") / a11, BENDING_POISSON)),
        np.stack([square, square, zero], axis=-1),
        np.stack([bend, bend, zero], axis=-1),
    )
    for name, correction in CORRECTIONS.items():
        if name not in at.model.off:
            fields = correction(fields, at)
    return fields
