"""The law at the stars of a layout, with checks that a sheet can have these values, and at the places between them.

At a place shared by several stars (`asterism.previews.fields.star_cells`) the values are averaged, or their logarithms.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import scipy.sparse as sp

from asterism.equilibrium.arrays import Floats, Ints
from asterism.homogenize.errors import LawError
from asterism.homogenize.law.anisotropy import BENDING_COLUMNS, MOMENT_COLUMNS, tube_of_largest_gain
from asterism.homogenize.law.plan import law_coordinates
from asterism.homogenize.law.star_law import MAX_SEPARATED_CURL, QUANTITY_NAMES, StarLaw
from asterism.pattern.design.design import Design
from asterism.pattern.design.lattice import DEFAULT_SPACING_MM
from asterism.pattern.layout.layout import Layout
from asterism.previews.fields.star_cells import CELL_RADIUS, Shares, shared
from asterism.previews.model import PREVIEW_MODEL, PreviewModel

# share of the bending stiffness that the sixfold term may take away in one direction: cells of the paper's material
# stay below
MAX_SIXFOLD_SHARE = 0.7


@dataclass(frozen=True)
class StarValues:
    """The law at S stars and at the bare fabric."""

    # each of the law's quantities, (S + 1,); the last entry is the bare fabric's. `c3` is bounded to
    # `MAX_SIXFOLD_SHARE` of `bending/|kappa|`.
    value: dict[str, Floats]
    # (S + 1, 2, W) mm and mm^2, amplitudes of the law's waves: of the flat cell, and change per curvature
    corrugation: Floats
    side: Ints  # (S + 1,) face of the fabric that carries each star: 1 above, -1 below; 1 for bare fabric
    sizes: Floats  # (S, A) sizes of each star's arms (`STAR_SIZES`), at which the law is evaluated
    outside: tuple[str, ...]  # one line for each star beyond the law's range; the nearest star in the range replaces it
    outside_stars: tuple[int, ...]  # numbers of these stars
    # numbers of the stars whose sheet would curl to a radius below two thirds of their spacing, in the mean over
    # directions, or around the tube of largest gain with the whole difference between directions
    not_scale_separated: tuple[int, ...]
    # numbers of the stars whose `c3` exceeds that bound. They curl to one side in some directions, and to the other
    # side, or hardly, in others.
    strongly_anisotropic: tuple[int, ...]
    # (S + 1, 2) mm and mm^2, corrugation at the tips of a star's arms, mean over the arms: flat, and change per
    # curvature
    tip_heights: Floats
    # (S + 1, K) differences between directions (`homogenize.law.anisotropy`); those of bending times `anisotropy_share`
    # if they come from the stars alone. K = 0 for most laws.
    anisotropy: Floats

    @property
    def has_tight_curls(self) -> bool:
        """Whether so many stars are not scale-separated that caps are among the initial guesses."""
        # if a larger share of the stars is not scale-separated, caps are among the initial guesses
        return len(self.not_scale_separated) > 0.4 * len(self.sizes)

    @property
    def is_uniform(self) -> bool:
        """Whether all stars have one size, on one side of the fabric."""
        # star sizes that differ by at most this part are equal
        equal = (np.ptp(self.sizes, axis=0) <= 0.01 * self.sizes.max(axis=0)).all()
        return bool(equal and np.ptp(self.side[:-1]) == 0)


def star_values(design: Design, layout: Layout, law: StarLaw, model: PreviewModel = PREVIEW_MODEL) -> StarValues:
    """Evaluate the law at all stars of a design and at bare fabric.

    Raises LawError: the law is for another material, stretch or lattice, or its value at a star is impossible for a
    sheet.
    """
    sizes = law_coordinates(layout, design.lattice.arms)
    asked = np.vstack([sizes, [0.0, *np.mean(sizes[:, 1:], axis=0)]])
    values = law.evaluate(design, *asked.T)
    where = [
        f"star {number} at [{x:.1f}, {y:.1f}]"
        for number, (x, y) in zip(layout.star_number, layout.centres, strict=True)
    ]
    _check(layout, where, {name: values.value[name][:-1] for name in QUANTITY_NAMES})
    outside = tuple(f"{where[star]}: {why}" for star, why in values.outside.items())
    differs = law.anisotropy(design, *asked.T)
    anisotropy = differs.copy()
    if differs.shape[1] and not design.fabric.is_directional:
        anisotropy[:, [*BENDING_COLUMNS, *MOMENT_COLUMNS]] *= model.anisotropy_share
    # as for cells, the whole difference between directions counts here, without `anisotropy_share`
    curls = values.not_scale_separated | (
        np.abs(tube_of_largest_gain(values.value["kappa"], differs)) * design.lattice.spacing_mm > MAX_SEPARATED_CURL
    )
    not_scale_separated = tuple(layout.star_number[curls[:-1]].tolist())
    corrugation = law.corrugation(design, *asked.T)
    reach = np.minimum(asked[:, 0], CELL_RADIUS * design.lattice.spacing_mm)
    arms = np.asarray(design.lattice.arm_directions)
    waves = law.waves((reach[:, None] * arms[:, None]).reshape(-1, 2)).reshape(len(arms), len(reach), -1)
    tip_heights = np.einsum("nkw,nw->nk", corrugation, waves.mean(axis=0))
    most = MAX_SIXFOLD_SHARE * values.value["bending"] / np.maximum(np.abs(values.value["kappa"]), 1e-300)
    c3 = np.clip(values.value["c3"], -most, most)
    strongly_anisotropic = tuple(layout.star_number[(c3 != values.value["c3"])[:-1]].tolist())
    # a sheet with plastic below is the mirror image of one with plastic above: curvatures and heights change their sign
    side = np.append(layout.star_side, 1)
    flat = np.column_stack([side, np.ones_like(side)])  # heights of the flat cell, and their change per curvature
    if differs.shape[1]:
        anisotropy[:, MOMENT_COLUMNS] *= side[:, None]
    mirrored = {name: side * values.value[name] for name in ("kappa", "offset_mm")}
    return StarValues(
        values.value | {"c3": side * c3} | mirrored,
        flat[:, :, None] * corrugation,
        side,
        sizes,
        outside,
        tuple(layout.star_number[~values.inside[:-1]].tolist()),
        not_scale_separated,
        strongly_anisotropic,
        flat * tip_heights,
        anisotropy,
    )


def _check(layout: Layout, where: Sequence[str], value: dict[str, Floats]) -> None:
    """Raise LawError if the values (S,) of a star are impossible for a sheet; `where` describes each star."""
    lam, bending, a11 = value["lam_n"], value["bending"], value["a11"]
    allowed = {
        "lam_n": ((lam > 0.0) & (lam <= 1.0), "a contraction above 0 and up to 1"),
        "kappa": (np.isfinite(value["kappa"]), "a finite natural curvature"),
        "bending": ((bending > 0.0) & (bending < np.inf), "a positive bending stiffness"),
        "a11": ((np.abs(value["a12"]) < a11) & (a11 < np.inf), "a positive membrane stiffness"),
    }
    wrong = ~np.array([fine for fine, _ in allowed.values()])
    if wrong.any():
        star = int(wrong.any(axis=0).argmax())
        name, (_, what) = list(allowed.items())[int(wrong[:, star].argmax())]
        message = f"{where[star]}: the law's {name} = {value[name][star]:.4g}, a sheet needs {what}"
        raise LawError(message, [layout.star_number[star]], layout.centres[star])


@dataclass(frozen=True)
class StarPlaces:
    """The stars at n places of a sheet, and the law there, from which fields are computed."""

    shares: Shares  # of the stars at the places
    shape: tuple[int, ...]  # of the fields, (T, Q) with n = T Q
    values: StarValues
    directions: Floats = field(default_factory=lambda: np.empty((0, 2)))  # (N, 2) unit vectors of the arms of a star
    arms: Sequence[Shares] = ()  # for each of them the shares half a spacing back along it
    normals: Floats | None = None  # (n, 2) normals of free sides, from `sheet_fields.free_normals`
    # (S, N) share of the natural curvature that arms carry into a free rim; None for supported sheets
    carried: Floats | None = None
    spacing_mm: float = DEFAULT_SPACING_MM  # of the stars
    model: PreviewModel = PREVIEW_MODEL
    softness: Floats | None = None  # (T, Q) around supported points, from `point_pins`; None for sheets without
    has_grain: bool = False  # the fabric is orthotropic

    @cached_property
    def weights(self) -> sp.csr_matrix:
        """(n, S) share of each star; bare fabric has the rest to 1."""
        return self.shares(self.values.sizes[:, 0])

    @cached_property
    def along_arms(self) -> list[sp.csr_matrix]:
        """For each arm the weights half a spacing back along it."""
        return [shares(self.values.sizes[:, 0]) for shares in self.arms]

    def mean(self, name: str) -> Floats:
        """(T, Q) of one of the law's quantities."""
        return self._mean(self.values.value[name], self.weights)

    def log_mean(self, name: str, weights: sp.csr_matrix | None = None) -> Floats:
        """(T, Q) mean by the logarithm, for other weights if they are given."""
        logarithm = np.log(self.values.value[name])
        return np.asarray(np.exp(self._mean(logarithm, self.weights if weights is None else weights)))

    @property
    def anisotropy(self) -> Floats:
        """(T, Q, K) differences between directions."""
        return self._mean(self.values.anisotropy, self.weights)

    @cached_property
    def lam(self) -> Floats:
        """(T, Q) contraction."""
        return self.log_mean("lam_n")

    def _mean(self, of: Floats, weights: sp.csr_matrix) -> Floats:
        return shared(weights, of).reshape(*self.shape, *of.shape[1:])


def rosette(along: Floats, directions: Floats) -> Floats:
    """(..., 3) components 11, 22, 12 of `4/N sum_k (s_k - m) (d_k d_k - I/2)`, the deviator of a strain rosette.

    For four directions, which are opposite in pairs, it is half of that.

    `along`: (..., N) values s_k along the directions; m is their mean; `directions`: (N, 2) unit vectors d_k.
    """
    x, y = directions.T
    rest = (2.0 if len(directions) == 4 else 4.0) / len(directions) * (along - along.mean(axis=-1, keepdims=True))
    return np.stack([rest @ (x * x - 0.5), rest @ (y * y - 0.5), rest @ (x * y)], axis=-1)
