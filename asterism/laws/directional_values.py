"""The tensors of a sheet along directions of the print: what the picture of a motif's law shows."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.law.tensor_forms import TO_VOIGT, SheetTensors

# of two squares of principal stretches that count as one
EVEN_SQUARES = 1e-4


def values_along(tensors: SheetTensors, axes: Floats) -> dict[str, Floats]:
    """Values (n, m) of n sheets along unit vectors (n, m, 2), or (m, 2) for all sheets.

    - `stretch`: length of the flat sheet over its printed length;
    - `membrane`, `bending`: N/mm and N mm, stiffness against a strain or curvature along the direction alone;
    - `rolled`: 1/mm, curvature of a sheet that rolls into a tube along the direction; positive where edges bend down.

    A tube of the curvature k along the direction with Voigt form f has the bending energy (k f - K) D (k f - K) / 2,
    which is least at k = f D K / f D f.

    >>> isotropic = np.diag([2.0, 2.0, 1.0, 3.0, 3.0, 1.5])[None]
    >>> sheet = SheetTensors(np.array([[0.81, 1.0, 0.0]]), isotropic, np.array([[-0.02, -0.01, 0.0]]))
    >>> values = values_along(sheet, np.eye(2))
    >>> values["stretch"].round(3).tolist(), values["bending"].tolist(), values["rolled"].tolist()
    ([[0.9, 1.0]], [[3.0, 3.0]], [[0.02, 0.01]])
    """
    x, y = np.moveaxis(axes, -1, 0)
    forms = np.stack([x * x, y * y, 2.0 * x * y], -1)
    forms = np.broadcast_to(forms, (len(tensors.metric), *forms.shape[-2:]))
    membrane, bending = tensors.stiffness[:, :3, :3], tensors.stiffness[:, 3:, 3:]

    def twice(stiffness: Floats) -> Floats:
        return np.einsum("nma,nab,nmb->nm", forms, stiffness, forms)

    def along(components: Floats) -> Floats:
        return np.einsum("nma,na->nm", forms, components)

    moments = np.einsum("nab,nb->na", bending, tensors.curvature * TO_VOIGT)
    return {
        "stretch": np.sqrt(along(tensors.metric)),
        "membrane": twice(membrane),
        "bending": twice(bending),
        "rolled": -along(moments) / twice(bending),
    }


def stretch_axes(metric: Floats) -> Floats:
    """(n, 2, 2) unit vectors along the smaller stretch of metrics (n, 3), and across it; x and y if both are equal."""
    xx, yy, xy = metric.T
    squares, columns = np.linalg.eigh(np.stack([np.stack([xx, xy], -1), np.stack([xy, yy], -1)], -2))
    axes = np.swapaxes(columns, -1, -2)
    axes[np.ptp(squares, axis=-1) < EVEN_SQUARES] = np.eye(2)
    return axes
