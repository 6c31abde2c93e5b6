"""The fields of the homogenised shell: rest metric, rest curvature and stiffness from the law at the stars.

At a place shared by several stars (`asterism.previews.fields.star_cells`), the logarithms of contraction and
stiffnesses are averaged, and the curvatures themselves. For a place with contraction `lam` and natural curvature
`kappa`, in printed coordinates:

    a_r = lam^2 I                            rest metric,
    b_r = -kappa lam^2 / (1 + nu) I          rest curvature,
    D = bending / lam^4                      stiffness against printed curvatures, in N mm.

- **Sign.** The normal `x_1 x x_2` points up on the print. If the edges of a sheet go down, its second fundamental form
  `b = n . hess x` is negative, and `kappa` is positive.
- **Factor.** An isotropic plate with rest curvature `c I` rolls to a tube of curvature `(1 + nu) c`, and gains the
  energy `D ((1 + nu) c)^2 / 2`. The law's `kappa` is the curvature of the tube; this gain defines its `bending`.
- **Powers of lam.** The curvatures of the law belong to the contracted sheet; a tube of radius r has `b = lam^2/r` per
  squared printed length.

The corrections describe what cells of endless sheets of equal stars leave out. They act one after the other; each has
its equation and its constants in its own file, and a model without it lacks its name in `PreviewModel.parts`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from asterism.fem.shell.density import Density, isotropic
from asterism.fem.shell.fields import Fields
from asterism.homogenize.law.anisotropy import BENDING_POISSON
from asterism.previews.fields.directional import directions
from asterism.previews.fields.rim_arms import rim_arms
from asterism.previews.fields.roll_axis import roll_axis
from asterism.previews.fields.rosette import rosette_metric
from asterism.previews.fields.self_stress import self_stress
from asterism.previews.fields.star_places import StarPlaces
from asterism.previews.point_pins import neo_hookean_fabric, softness_at_points

CORRECTIONS: dict[str, Callable[[Fields, StarPlaces], Fields]] = {
    "rosette metric": rosette_metric,
    "directions": directions,
    "roll axis": roll_axis,
    "arms into free rims": rim_arms,
    "Gaussian curvature": self_stress,
    "softness at points": softness_at_points,
    "neo-Hookean fabric": neo_hookean_fabric,
}


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
        if name in at.model.parts:
            fields = correction(fields, at)
    return fields
