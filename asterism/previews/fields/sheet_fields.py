"""The fields of a shell that stands for a sheet of stars.

Where stars share a place (`asterism.previews.fields.star_cells`), logarithms of contraction and stiffnesses are
averaged, and curvatures, as they are. With contraction `lam` and natural curvature `kappa` of a place, in printed
coordinates:

    a_r = lam^2 I                            the metric at rest; where stars change, see `star_arms`,
    b_r = -kappa lam^2 / (1 + nu) I          the curvature at rest,
    D = bending / lam^4,  c = c3 / lam^6     per printed curvature; c of the energy c Re[((b11 - b22)/2 + i b12)^3].

**Sign.** With the normal `x_1 x x_2`, upwards on the print, the second fundamental form `b = n . hess x` of a sheet
whose edges go down is negative; `kappa` is positive there. **Factor.** An isotropic plate with rest curvature `c I` in
both directions rolls to a tube of curvature `(1 + nu) c`, and gains `D ((1 + nu) c)^2 / 2` on the way. The law's
`kappa` is the tube's, and its `bending` is defined by that gain. **Powers of lam.** The law's curvatures are those of
the contracted sheet; a tube of radius r has `b = lam^2/r` per printed length squared. **Sixfold.**
`b = -kappa lam^2 t t^T` has `Re[...] = -(kappa lam^2)^3 cos(6 phi)/8` for t at the angle phi to the x axis. The law's
`c3` is `4 (psi_0 - psi_30)/kappa^3`, with angles from y: phi = 90 and 120 degrees, where cos(6 phi) is -1 and 1.

**Curled sheets contract more.** `lam` is that of the natural tube; held flat, most stars are longer, `lam_flat`. The
lengths at rest follow the curvature,

    a = (lam^2 + e (lam_flat^2 - lam^2) (1 + tr b / (kappa lam^2))) I,

which on the natural tube, where `tr b = -kappa lam^2`, is `lam^2 I` again: tubes stay the law's. It couples membrane
and bending, since strains are measured from there. Of rims that curl on their own, `tr b` is what is beyond that curl.
Between stars that curl to opposite sides `1/kappa` is the mean curvature over the square of the mean of its size.
In cells of long thin stars most of the way is made at a fraction of the natural curvature: it is a tanh of x, the turn
over a spacing in units of `length_turn_rad`. Free sheets are near their natural curvature, where its slope counts,
`e = 2x / sinh(2x)` for each star. Held ones are anywhere in between; there a straight line through sheets that are
curled a little starts below the flat cell, `e = supported_length_share`.

**Stars and bare fabric bend in series** (`_in_series`): where they share a place their compliances add. Beyond the last
stars nothing carries on what their arms bear. In exact strips, thick outer rows bend 11 to 28 % more than if logarithms
of stiffnesses were averaged.

**Fabric that is pulled favours caps** (`asterism.previews.fields.self_stress`): a modulus of Gaussian curvature `-g`,
of the energy `-g det b` per printed area. It goes with the share of the stars squared, which leaves a border without a
slope.

**Stars that are not the same in all directions** have a bending tensor in place of D, a rest curvature in place of
`-kappa lam^2/(1 + nu) I` (`asterism.previews.fields.directional`), and lengths by the tube that gains most.

**Free rims** of bare fabric curl on their own (`asterism.previews.edges.free_rim`).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy.sparse as sp

from asterism.previews.edges.free_rim import beside, rim_curvature, stars_share
from asterism.previews.edges.rim_arms import arm_curvature
from asterism.previews.fields.directional import rest_curvature, tensors, with_bending_tensor
from asterism.previews.fields.star_arms import arm_metric
from asterism.previews.fields.star_values import StarValues
from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from fem.shell.density import Density, isotropic
from fem.shell.fields import Fields
from homogenize.law.anisotropy import BENDING_POISSON, min_bending_ratio
from pattern.design.lattice import DEFAULT_SPACING_MM
from pattern.geometry.arrays import Floats

MIN_SATURATION_TURN_RAD = 1e-3 * DEFAULT_SPACING_MM  # over a spacing
MIN_CURLED_TURN_RAD = 3e-3 * DEFAULT_SPACING_MM  # over a spacing: the lengths of flatter stars do not follow curvature
MAX_GAUSSIAN_SHARE = 0.95  # of the Gaussian modulus that leaves the bending energy indefinite
_PLAIN = ("kappa", "a12", "c3")


def sheet_fields(
    weights: sp.csr_matrix,
    values: StarValues,
    shape: tuple[int, ...],
    arms: Sequence[tuple[Floats, sp.csr_matrix]] = (),
    normals: Floats | None = None,
    early: float | Floats = PREVIEW_MODEL.supported_length_share,
    carried: Floats | None = None,
    gaussian: Floats | None = None,
    spacing: float = DEFAULT_SPACING_MM,
    model: PreviewModel = PREVIEW_MODEL,
) -> Fields:
    """The fields at places where stars count with weights (n, S), bare fabric with what is missing to 1.

    `shape`: of the arrays, (T, Q) with n = T Q. `arms`: for each arm of a star its direction (2,) and the weights half
    a spacing back along it (`asterism.previews.fields.star_arms`); without them the metric is `lam^2 I`. `normals`: (n,
    2) of free rims (`asterism.previews.edges.free_rim.free_normals`); without them rims do not curl. `early`: e above,
    of all or of each star (S + 1,), see `free_length_share`. `carried`: (S, N) part of the natural curvature that arms
    carry on into a free rim (`asterism.previews.edges.rim_arms`). `gaussian`: (S,) N mm, g of each star; none without.
    `spacing`: mm, of the stars. The sixfold term is larger by what its saturation takes away from it at the natural
    curvature.
    """

    def mean(of: Floats, shares: sp.csr_matrix = weights) -> Floats:
        return np.asarray(of[-1] + shares @ (of[:-1] - of[-1])).reshape(shape)

    natural = values.value["lam_n"]
    if not model.has_curvature_lengths:
        early = 0.0
    longest = np.sqrt(natural**2 + early * (values.value["lam"] ** 2 - natural**2))
    lam, flat, a11 = (np.exp(mean(np.log(of))) for of in (natural, longest, values.value["a11"]))
    bending = (_in_series if model.has_series_bending else _mean_logarithm)(values.value["bending"], weights).reshape(
        shape
    )
    kappa, a12, c3 = (mean(values.value[name]) for name in _PLAIN)
    square, zero = lam**2, np.zeros(shape)
    metric = np.stack([square, square, zero], axis=-1)
    if arms and model.has_rosette_metric:
        along = [np.exp(mean(np.log(natural), shares)) for _, shares in arms]
        metric = arm_metric(lam, np.stack(along, axis=-1), np.array([direction for direction, _ in arms]))
    bend = -kappa * square / (1.0 + BENDING_POISSON)
    stiffness = isotropic(a11, bending / lam**4, a12 / a11, BENDING_POISSON)
    curvature = np.stack([bend, bend, zero], axis=-1)
    # of the natural tubes, and of the softest bending over the isotropic
    curl, firm = values.value["kappa"], np.ones(shape)
    if values.anisotropy.shape[1]:
        q, m = tensors(kappa, np.asarray(weights @ values.anisotropy[:-1]).reshape(*shape, -1))
        stiffness, firm = with_bending_tensor(stiffness, bending / lam**4, q), min_bending_ratio(q)
        curvature, curl = rest_curvature(lam, q, m), values.tube_curvature
    strength = mean(np.abs(curl))
    # parts of lam^2: by how much a flat sheet's metric is larger, and how much of that the trace of b takes away
    longer = np.where(strength * spacing > MIN_CURLED_TURN_RAD, flat**2 - square, 0.0) / square
    per_trace = longer * mean(curl) / np.where(longer == 0.0, 1.0, strength) ** 2
    metric = metric * (1.0 + longer + per_trace * curvature[..., :2].sum(axis=-1) / square)[..., None]
    density = Density(
        stiffness=_coupled(stiffness, 0.5 * per_trace),
        sixfold=model.sixfold_factor * (1.0 + 1.0 / model.sixfold_saturation**2) * c3 / lam**6,
        orientation=zero,
        saturation=np.maximum(
            model.sixfold_saturation * 0.5 * np.abs(kappa) * square, MIN_SATURATION_TURN_RAD / spacing
        ),
    )
    if normals is not None:
        rim = rim_curvature(weights, values, normals, model)
        if carried is not None:
            rim += arm_curvature(weights, values, normals, arms, carried) / (1.0 + BENDING_POISSON)
        curvature -= square[..., None] * rim.reshape(*shape, 3)
    if gaussian is None:
        return Fields(density, metric, curvature)
    saved = (np.minimum(stars_share(weights), 1.0) * np.asarray(weights @ gaussian)).reshape(shape)
    return Fields(
        density,
        metric,
        curvature,
        -np.minimum(saved, MAX_GAUSSIAN_SHARE * firm * (1.0 + BENDING_POISSON) * bending / lam**4),
    )


def free_length_share(values: StarValues, spacing: float, model: PreviewModel = PREVIEW_MODEL) -> Floats:
    """(S + 1,) e above at the natural curvature of stars with a spacing in mm."""
    turn = np.maximum(2.0 * np.abs(values.value["kappa"]) * spacing / model.length_turn_rad, 1e-6)
    return np.asarray(turn / np.sinh(turn))


def _in_series(bending: Floats, weights: sp.csr_matrix) -> Floats:
    """(n,) N mm, stiffness of places where stars, with their mean logarithm, and bare fabric share a bending moment."""
    share = np.minimum(stars_share(weights), 1.0)
    # over the fabric's: without stars beside, nothing is left of them in any unit
    stars = bending[-1] * np.exp(beside(weights, np.log(bending[:-1] / bending[-1])))
    return np.asarray(1.0 / (share / stars + (1.0 - share) / bending[-1]))


def _mean_logarithm(bending: Floats, weights: sp.csr_matrix) -> Floats:
    """(n,) N mm, mean of the logarithms of stars and bare fabric."""
    logs = np.log(bending)
    return np.asarray(np.exp(logs[-1] + weights @ (logs[:-1] - logs[-1])))


def _coupled(stiffness: Floats, coupling: Floats) -> Floats:
    """(..., 6, 6) where membrane strains count from `coupling` (mm) times the curvature's trace in all directions."""
    change = np.zeros((*coupling.shape, 6, 6))
    change[...] = np.eye(6)
    change[..., :2, 3:5] = -coupling[..., None, None]
    return np.asarray(np.swapaxes(change, -1, -2) @ stiffness @ change)
