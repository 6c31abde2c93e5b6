"""The fields of the homogenised shell: rest metric, rest curvature and stiffness from the law at the stars.

At a place shared by several stars (`asterism.previews.fields.star_cells`), the logarithms of contraction and
stiffnesses are averaged, and the curvatures themselves. For a place with contraction `lam` and natural curvature
`kappa`, in printed coordinates:

    a_r = lam^2 I                            rest metric; see `star_arms` where stars change over the sheet,
    b_r = -kappa lam^2 / (1 + nu) I          rest curvature,
    D = bending / lam^4,  c = c3 / lam^6     stiffnesses against printed curvatures, in N mm and N mm^2; c is the factor
                                             of the energy c Re[((b11 - b22)/2 + i b12)^3] per printed area.

- **Sign.** The normal `x_1 x x_2` points up on the print. If the edges of a sheet go down, its second fundamental form
  `b = n . hess x` is negative, and `kappa` is positive.
- **Factor.** An isotropic plate with rest curvature `c I` rolls to a tube of curvature `(1 + nu) c`, and gains the
  energy `D ((1 + nu) c)^2 / 2`. The law's `kappa` is the curvature of the tube; this gain defines its `bending`.
- **Powers of lam.** The curvatures of the law belong to the contracted sheet; a tube of radius r has `b = lam^2/r` per
  squared printed length.
- **Sixfold term.** `b = -kappa lam^2 t t^T` has `Re[...] = -(kappa lam^2)^3 cos(6 phi)/8` if t is at the angle phi to
  the x axis. The law's `c3` is `4 (psi_0 - psi_30)/kappa^3` with angles from y. These are phi = 90 and 120 degrees,
  where cos(6 phi) is -1 and 1.

**Curled sheets contract more.** `lam` is the contraction of the natural tube. Most stars contract less in a flat sheet,
to `lam_flat`. The rest metric of a free sheet follows the curvature:

    a = (lam^2 + e (lam_flat^2 - lam^2) (1 + tr b / (kappa lam^2))) I.

On the natural tube, `tr b = -kappa lam^2`, and a is `lam^2 I` as in the law. The membrane strain is measured from a, so
that membrane and bending are coupled. At rims that curl on their own, `tr b` counts from that curl. Between stars that
curl to opposite sides, `1/kappa` is the mean curvature over the square of the mean absolute curvature.
Cells of long thin stars change most of their length at a fraction of the natural curvature: the change is a tanh of x,
where x is the turn over one spacing in units of `length_turn_rad`. Free sheets are near their natural curvature, so
that the slope there counts: `e = 2x / sinh(2x)` for each star. Supported sheets may have any curvature, and their
lengths are those of the natural tube: e = 0.

**Stars and bare fabric bend in series** (`_in_series`): at a place that they share, their compliances add. Arms carry
no moment into the fabric beyond the last stars. In exact strips, thick outer rows bend 11 to 28 % more than a mean of
the logarithms of the stiffnesses predicts.

**Self-stress favours caps** (`asterism.previews.fields.self_stress`): the Gaussian modulus `-g` adds the energy
`-g det b` per printed area. It is multiplied by the squared share of the stars, so that its slope vanishes at the
border.

**Anisotropic stars** have a bending tensor in place of D and a rest curvature in place of `-kappa lam^2/(1 + nu) I`
(`asterism.previews.fields.directional`). Their lengths are those of the tube of largest energy gain.

**Free rims** of bare fabric have an additional rest curvature (`asterism.previews.fields.free_rim`).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy.sparse as sp

from asterism.equilibrium.arrays import Floats
from asterism.fem.shell.density import Density, isotropic
from asterism.fem.shell.fields import Fields
from asterism.homogenize.law.anisotropy import BENDING_POISSON, min_bending_ratio
from asterism.pattern.design.lattice import DEFAULT_SPACING_MM
from asterism.previews.fields.directional import rest_curvature_tensor, tensors, with_bending_tensor
from asterism.previews.fields.free_rim import beside, rim_curvature, stars_share
from asterism.previews.fields.rim_arms import arm_curvature
from asterism.previews.fields.star_arms import arm_metric
from asterism.previews.fields.star_values import StarValues
from asterism.previews.model import PREVIEW_MODEL, PreviewModel

# lower limit of the saturation curvature of the sixfold term, as a turn over one spacing
MIN_SATURATION_TURN_RAD = 1e-3 * DEFAULT_SPACING_MM
# the lengths of stars that curl by a smaller turn over one spacing do not follow the curvature
MIN_CURLED_TURN_RAD = 3e-3 * DEFAULT_SPACING_MM
# largest Gaussian modulus, as a share of the one at which the bending energy becomes indefinite
MAX_GAUSSIAN_SHARE = 0.95
# quantities of the law that are averaged as they are, without a logarithm
AVERAGED_QUANTITIES = ("kappa", "a12", "c3")


def sheet_fields(
    weights: sp.csr_matrix,
    values: StarValues,
    shape: tuple[int, ...],
    arms: Sequence[tuple[Floats, sp.csr_matrix]] = (),
    normals: Floats | None = None,
    border: Floats | None = None,
    early: float | Floats = 0.0,
    carried: Floats | None = None,
    gaussian: Floats | None = None,
    spacing: float = DEFAULT_SPACING_MM,
    model: PreviewModel = PREVIEW_MODEL,
) -> Fields:
    """Compute the fields of the shell at n places.

    The sixfold term is enlarged by the part that its saturation removes at the natural curvature.

    Parameters
    ----------
    weights : (n, S) share of each star at the places; bare fabric has the rest to 1.
    values : the law at the stars.
    shape : shape of the fields, (T, Q) with n = T Q.
    arms : for each arm of a star its direction (2,), and the weights half a spacing back along it
        (`asterism.previews.fields.star_arms`). Without arms, the rest metric is `lam^2 I`.
    normals : (n, 2) normals of free rims (`asterism.previews.fields.free_rim.free_normals`); without them, rims do not
        curl.
    border : (n,) 1/mm, decrease of the stars' share along the normals; without it, rims do not turn.
    early : e above, one number or (S + 1,); see `free_length_share`.
    carried : (S, N) share of the natural curvature that arms carry into a free rim
        (`asterism.previews.fields.rim_arms`).
    gaussian : (S,) g of each star in N mm; zero by default.
    spacing : mm, spacing of the stars.
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
    kappa, a12, c3 = (mean(values.value[name]) for name in AVERAGED_QUANTITIES)
    square, zero = lam**2, np.zeros(shape)
    metric = np.stack([square, square, zero], axis=-1)
    if arms and model.has_rosette_metric:
        along = [np.exp(mean(np.log(natural), shares)) for _, shares in arms]
        metric = arm_metric(lam, np.stack(along, axis=-1), np.array([direction for direction, _ in arms]))
    bend = -kappa * square / (1.0 + BENDING_POISSON)
    stiffness = isotropic(a11, bending / lam**4, a12 / a11, BENDING_POISSON)
    curvature = np.stack([bend, bend, zero], axis=-1)
    # natural curvature of the tubes, and smallest bending stiffness over the isotropic one
    curl, firm = values.value["kappa"], np.ones(shape)
    if values.anisotropy.shape[1]:
        q, m = tensors(kappa, np.asarray(weights @ values.anisotropy[:-1]).reshape(*shape, -1))
        stiffness, firm = with_bending_tensor(stiffness, bending / lam**4, q), min_bending_ratio(q)
        curvature, curl = rest_curvature_tensor(lam, q, m), values.tube_curvature
    strength = mean(np.abs(curl))
    # relative to lam^2: excess of the metric of a flat sheet, and the decrease of this excess per trace of b
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
        rim = np.zeros((weights.shape[0], 3))
        if border is not None:
            rim += rim_curvature(weights, values, normals, border)
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
    """(S + 1,) factors e above of a free sheet; the spacing is in mm."""
    turn = np.maximum(2.0 * np.abs(values.value["kappa"]) * spacing / model.length_turn_rad, 1e-6)
    return np.asarray(turn / np.sinh(turn))


def _in_series(bending: Floats, weights: sp.csr_matrix) -> Floats:
    """(n,) bending stiffness in N mm of stars, with their mean logarithm, in series with bare fabric."""
    share = np.minimum(stars_share(weights), 1.0)
    # relative to bare fabric: far from all stars the mean logarithm is zero, which is the stiffness of the fabric
    stars = bending[-1] * np.exp(beside(weights, np.log(bending[:-1] / bending[-1])))
    return np.asarray(1.0 / (share / stars + (1.0 - share) / bending[-1]))


def _mean_logarithm(bending: Floats, weights: sp.csr_matrix) -> Floats:
    """(n,) bending stiffness in N mm by the mean logarithm of stars and bare fabric."""
    logs = np.log(bending)
    return np.asarray(np.exp(logs[-1] + weights @ (logs[:-1] - logs[-1])))


def _coupled(stiffness: Floats, coupling: Floats) -> Floats:
    """(..., 6, 6) stiffness for membrane strains measured from `coupling` (mm) times the trace of the curvature."""
    change = np.zeros((*coupling.shape, 6, 6))
    change[...] = np.eye(6)
    change[..., :2, 3:5] = -coupling[..., None, None]
    return np.asarray(np.swapaxes(change, -1, -2) @ stiffness @ change)
