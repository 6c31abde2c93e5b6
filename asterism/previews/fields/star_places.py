"""Places of a sheet in its pattern of stars, from which fields are computed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.lattice import DEFAULT_SPACING_MM
from asterism.previews.fields.star_cells import stars_share
from asterism.previews.fields.star_values import StarValues
from asterism.previews.model import PREVIEW_MODEL, PreviewModel


@dataclass(frozen=True)
class StarPlaces:
    """The law at n places.

    Attributes
    ----------
    weights : (n, S) share of each star at the places; bare fabric has the rest to 1.
    values : the law at the stars.
    shape : shape of the fields, (T, Q) with n = T Q.
    arms : for each arm of a star its direction (2,), and the weights half a spacing back along it.
    normals : (n, 2) normals of free sides (`asterism.previews.fields.free_sides`); None for sheets without.
    carried : (S, N) share of the natural curvature that arms carry into a free rim; None without free rims.
    softness : (T, Q) around supported points (`asterism.previews.point_pins`); None for sheets without.
    spacing_mm : of the stars.
    has_grain : the fabric is orthotropic.
    model : constants of the preview.
    """

    weights: sp.csr_matrix
    values: StarValues
    shape: tuple[int, ...]
    arms: Sequence[tuple[Floats, sp.csr_matrix]] = ()
    normals: Floats | None = None
    carried: Floats | None = None
    softness: Floats | None = None
    spacing_mm: float = DEFAULT_SPACING_MM
    has_grain: bool = False
    model: PreviewModel = PREVIEW_MODEL

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
        of = self.values.anisotropy
        return np.asarray(of[-1] + self.weights @ (of[:-1] - of[-1])).reshape(*self.shape, -1)

    @cached_property
    def lam(self) -> Floats:
        """(T, Q) contraction."""
        return self.log_mean("lam_n")

    @cached_property
    def stars(self) -> Floats:
        """(T, Q) share of all stars together."""
        return np.minimum(stars_share(self.weights), 1.0).reshape(self.shape)

    def _mean(self, of: Floats, weights: sp.csr_matrix) -> Floats:
        return np.asarray(of[-1] + weights @ (of[:-1] - of[-1])).reshape(self.shape)
