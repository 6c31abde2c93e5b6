"""How far off a preview expects its height to be, from what it knows itself.

The height is from the lowest to the highest point, stars' bumps and all. What puts it off, each in mm and by itself:

- **The lowest point** is a bump's edge, most often the tip of an arm beside the border. It is wrong by a part LOWEST of
  how far the bumps take it from the smooth sheet. On nearly flat sheets that is much of the height.
- **Softness.** The energy E at stake would part the highest from the lowest point by `sqrt(2 E c)`, if c mm is what a
  force of one N at each of them does. The law's energies are wrong by a small part, as in
  `asterism.previews.uncertainty.expected`; SOFT times the `share_of` that goes into the distance goes into the height.
- **The law** is wrong by a part PART of the height, whatever the sheet.
- **Stars that may turn over.** In held sheets some stars bump down, where the law's are all up. They have arms of at
  least LONG of the spacing, and sit where the sheet is curled by less than FLAT of its natural curvature and is not
  pulled wider than its flat cell. Which of them turn is not known; the height is off by TURNED times the size of their
  bumps, rms over all stars.

`expected_height_percent` is the root of the sum of their squares, and a root mean square over designs. The constants
are fitted to it by `python -m benchmarks.accuracy.expectation`. Other forms are not in it: the preview warns of them,
and most are as high.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from asterism.previews.fields.star_values import REACH, StarValues
from asterism.previews.surface.smooth_surface import smooth_surface
from asterism.shape.shape import Shape
from equilibrium.linear.factor import Factor
from fem.elements.tabulation import Floats
from fem.search.compliance import compliance
from fem.supports.loads import point_load
from pattern.layout.layout import Layout

if TYPE_CHECKING:
    from asterism.previews.session import Preview

LOWEST, SOFT, PART, TURNED = 0.65, 0.5, 0.02, 1.25
LONG, FLAT = 0.5, 0.5


@dataclass(frozen=True)
class HeightDoubts:
    """What the height of a preview depends on, mm.

    Attributes
    ----------
    height : of the preview.
    lowest : between the lowest point and the smooth sheet there.
    softness : by which the energy of the sheet would part the lowest and the highest point.
    turning : bumps of stars that may turn over, rms over all stars.
    """

    height: float
    lowest: float
    softness: float
    turning: float


def expected_height_percent(doubts: HeightDoubts, share: float) -> float | None:
    """The error of the height to be expected, in % of it; None for a sheet without height.

    `share`: see `asterism.previews.uncertainty.expected.share_of`. Over many designs it is a root mean square: most are
    nearer.
    """
    if doubts.height <= 0.0:
        return None
    parts = LOWEST * doubts.lowest, SOFT * share * doubts.softness, PART * doubts.height, TURNED * doubts.turning
    return 100.0 * math.hypot(*parts) / doubts.height


def in_words(expected_percent: float, height_mm: float) -> str:
    """An expected error of a height: in mm where it is more than the height itself."""
    if expected_percent <= 100.0:
        return f"{expected_percent:.0f} %"
    return f"{expected_percent / 100.0 * height_mm:.1f} mm"


def height_doubts(preview: Preview, shape: Shape, up: Floats, factor: Factor) -> HeightDoubts:
    """Of a preview at its equilibrium.

    Parameters
    ----------
    shape : the sheet with its bumps, its height along z.
    up : (3,) unit vector, where the shell has that direction.
    factor : holds the exact Hessian at the equilibrium.
    """
    found, sheet = preview.equilibrium, preview.sheet
    height = shape.positions[:, 2]
    ends = [int(height.argmax()), int(height.argmin())]
    forces = point_load(sheet.space, shape.printed[ends], np.array([up, -up]))
    apart = compliance(preview.shell, found.x, factor, forces)
    surface = smooth_surface(sheet.arms.at_centres, found.x)
    return HeightDoubts(
        height=shape.height_mm,
        lowest=abs(float(shape.point_fields["bump_mm"][ends[1], 2])),
        softness=math.sqrt(2.0 * max(found.absolute_energy, 0.0) * max(apart, 0.0)),
        turning=turning(preview.values, sheet.layout, 2.0 * surface.mean_curvature, surface.area),
    )


def turning(values: StarValues, layout: Layout, curvature: Floats, area: Floats) -> float:
    """mm, bumps of stars that may turn over, rms over all stars; none in a free sheet.

    Parameters
    ----------
    curvature : (S,) 1/mm at the star centres, sum of the principal curvatures, positive where the plastic is outside.
    area : (S,) of the surface per printed area.
    """
    if not layout.pins:
        return 0.0
    kappa, length = values.value["kappa"][:-1], values.sizes[:, 0]
    bumps = 0.5 * values.caps[:-1] * np.minimum(length, REACH * layout.spacing_mm) ** 2
    may = (
        (length >= LONG * layout.spacing_mm)
        & (curvature * np.sign(kappa) < FLAT * np.abs(kappa))
        & (np.sqrt(area) < values.value["lam"][:-1])
    )
    return float(np.sqrt((bumps**2 * may).mean()))
