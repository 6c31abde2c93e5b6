"""The dimensionless groups that the responses of a unit cell depend on.

All energies of a cell are divided by `E2 h2 d^2` (fabric modulus and thickness, spacing) and all lengths by d. Then the
energies depend on the stretch, on the arm's length over d, on the mesh's edge over d, and on the coefficients of five
energies:

| energy | coefficient |
|---|---|
| bending of an arm about its width | `E1 w h^3/(12 E2 h2 d^3)`, the bending number |
| its rest curvature | `kappa d`; the law uses the couple number instead |
| bending of the fabric | `h2^2/d^2` |
| bending of an arm in the plane, twist | bending number times functions of `w/h` |
| stretch of an arm | bending number times `12 (d/h)^2` |

The couple number is `bending number x kappa d/(1 - 1/s^2)`: the couple that straightens an arm over that of the
released fabric's tension. For the formula `paper` of the rest curvature it is `w (h + h2)/(2 d^2)`, so that it varies
little from fabric to fabric; kappa d varies by a factor of thousands.

Poisson's ratios, the kind of membrane and the kind of bending are no groups: the law is for one choice of them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.materials import Fabric, Plastic, rest_curvature


@dataclass(frozen=True)
class Group:
    """One dimensionless group.

    Attributes
    ----------
    key : in the code.
    name : in sentences.
    limits : range of the universal law.
    logarithmic : the law is interpolated over the logarithm.
    """

    key: str
    name: str
    limits: tuple[float, float]
    logarithmic: bool = True

    def coordinate(self, values: Floats) -> Floats:
        """From 0 to 1 over the limits; the same shape as the values."""
        low, high = self.limits
        if self.logarithmic:
            return np.asarray(np.log(values / low) / np.log(high / low))
        return np.asarray((values - low) / (high - low))


GROUPS = (
    Group("arm", "arm length over spacing", (0.06, 0.8), logarithmic=False),
    Group("stretch", "stretch", (1.1, 2.0), logarithmic=False),
    Group("bending", "bending number", (4e-4, 0.06)),
    Group("couple", "couple number", (4e-4, 0.007)),
    Group("fabric", "fabric thickness over spacing", (0.03, 0.08)),
    Group("aspect", "width over thickness", (1.3, 8.0)),
    Group("thickness", "arm thickness over spacing", (0.01, 0.05)),
    Group("edge", "mesh edge over spacing", (0.05, 0.1), logarithmic=False),
)
GROUP_KEYS = tuple(group.key for group in GROUPS)
# rest curvature times spacing, above which a released arm would curl to a third of the spacing
MAX_ARM_CURL = 3.0
# fabric thickness over mesh edge; on coarser meshes the compressed fabric between the stars buckles as the mesh lets it
MIN_FABRIC_TO_EDGE = 0.45


def star_groups(fabric: Fabric, plastic: Plastic, spacing_mm: float, edge_mm: float, sizes: Floats) -> Floats:
    """(N, G) the groups of stars, in the order of `GROUPS`.

    Parameters
    ----------
    fabric, plastic : of a design; the stretch is the same in x and y.
    edge_mm : of the mesh.
    sizes : (N, 3) mm, length, thickness and width of the arms.

    Examples
    --------
    >>> paper = star_groups(Fabric(), Plastic(), 17.32, 1.15, np.array([[8.66, 0.4, 1.2]]))
    >>> dict(zip(GROUP_KEYS, paper[0].round(4).tolist()))  # doctest: +NORMALIZE_WHITESPACE
    {'arm': 0.5, 'stretch': 1.35, 'bending': 0.0049, 'couple': 0.0024, 'fabric': 0.0462, 'aspect': 3.0,
     'thickness': 0.0231, 'edge': 0.0664}
    """
    length, thickness, width = np.asarray(sizes, dtype=float).T
    stretch = fabric.stretch_xy[0]
    d, h2 = spacing_mm, fabric.thickness_mm
    bending = plastic.modulus_ratio * width * thickness**3 / (12.0 * h2 * d**3)
    curl = rest_curvature(thickness, fabric, plastic) * d
    with np.errstate(divide="ignore", invalid="ignore"):
        couple = bending * curl / mismatch(stretch)
    ones = np.ones(len(length))
    columns = (length / d, stretch * ones, bending, couple, h2 / d * ones, width / thickness, thickness / d)
    return np.column_stack([*columns, edge_mm / d * ones])


def arm_curl(groups: Floats) -> Floats:
    """(...) rest curvature of an arm times the spacing, of groups (..., G)."""
    stretch, bending, couple = (groups[..., GROUP_KEYS.index(key)] for key in ("stretch", "bending", "couple"))
    return np.asarray(couple * mismatch(stretch) / bending)


def mismatch(stretch: Floats | float) -> Floats:
    """`1 - 1/s^2`, the difference of the printed and the released metric."""
    return np.asarray(1.0 - 1.0 / np.square(stretch))


def coordinates_of_groups(groups: Floats) -> Floats:
    """(N, G) from 0 to 1 over the limits of each group, of groups (N, G)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.column_stack([group.coordinate(groups[:, n]) for n, group in enumerate(GROUPS)])
