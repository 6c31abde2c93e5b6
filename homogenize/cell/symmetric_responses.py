"""Responses with the symmetry of star and lattice.

The mesh of a cell has the symmetry, but its equilibrium may break it: a star with four arms may bend to a saddle, with
one pair of arms up. Its images under the point group are equilibria of the same energy, and tubes that are equal by
symmetry then differ. A sheet takes the form of lower energy. So each of several equal directions gets the responses of
the one with the lowest natural energy, and tensors of the flat cell are means over the group.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Array, Floats, Ints

# rad, and of the stretches
DIRECTION_TOLERANCE = 1e-6
# of a response: responses that differ by less are equal up to the tolerance of Newton's method, and keep their digits
RESPONSE_TOLERANCE = 1e-6
# responses with one value for each direction; a sheet that is turned keeps them
SCALAR_KEYS = (
    "natural_curvature",
    "natural_energy",
    "natural_hoop",
    "natural_axial",
    "natural_bump_mm",
    "natural_centre_offset_mm",
    "natural_eigenvalue",
    "natural_supercell_eigenvalue",
    "bending",
)


def symmetric_responses(responses: dict[str, Any], group: Floats, stretch_xy: tuple[float, float]) -> dict[str, Any]:
    """Responses of `homogenize.cell.sample.Sample` with the symmetry of the point group (G, 2, 2).

    The result has `asymmetry`, see `Sample`. Elements that the stretches in x and y do not share are left out.
    """
    stretch = np.diag(stretch_xy)
    kept = np.abs(group @ stretch @ group.transpose(0, 2, 1) - stretch).max(axis=(1, 2)) < DIRECTION_TOLERANCE
    group = group[kept]
    out = dict(responses)
    turns = np.array([_voigt_strain_turn(element) for element in group])
    both = np.array([np.kron(np.eye(2), turn) for turn in turns])
    means = {
        "rest_metric": (group @ responses["rest_metric"] @ group.transpose(0, 2, 1)).mean(axis=0),
        "stiffness": (both.transpose(0, 2, 1) @ responses["stiffness"] @ both).mean(axis=0),
        "moment": (turns.transpose(0, 2, 1) @ responses["moment"]).mean(axis=0),
    }
    for name, mean in means.items():
        if np.abs(mean - responses[name]).max() > RESPONSE_TOLERANCE * np.abs(mean).max():
            out[name] = mean
            if name == "stiffness":
                out["membrane"] = mean[:3, :3]
    source, element = _lowest_of_equals(responses["angles_rad"], responses["natural_energy"], group)
    for name in SCALAR_KEYS:
        if responses[name] is not None:
            out[name] = np.asarray(responses[name])[source]
    turned = turns[element]
    out["natural_membrane"] = turned.transpose(0, 2, 1) @ np.asarray(responses["natural_membrane"])[source] @ turned
    kappa = np.asarray(responses["natural_curvature"])
    largest = float(np.abs(kappa).max())
    out["asymmetry"] = float(np.abs(out["natural_curvature"] - kappa).max()) / largest if largest else 0.0
    return out


def _lowest_of_equals(angles: Array, energy: Array, group: Floats) -> tuple[Ints, Ints]:
    """(D,) direction of lowest energy among those equal to each direction, and element that takes it back to that.

    A direction without equal ones is its own source, by the identity.
    """
    directions = np.column_stack([-np.sin(angles), np.cos(angles)])
    source, element = np.arange(len(angles)), np.zeros(len(angles), dtype=np.int64)
    moved = np.einsum("gij,dj->gdi", group, directions)
    for target, direction in enumerate(directions):
        parallel = np.abs(moved[..., 0] * direction[1] - moved[..., 1] * direction[0]) < DIRECTION_TOLERANCE
        elements, equals = np.nonzero(parallel)
        best = equals[np.argmin(energy[equals])]
        if energy[best] < energy[target] - RESPONSE_TOLERANCE * abs(energy[target]):
            source[target], element[target] = best, elements[equals == best][0]
    return source, element


def _voigt_strain_turn(element: Floats) -> Floats:
    """(3, 3) the strains (11, 22, 2 x 12) in print axes, before a sheet is moved by an orthogonal matrix (2, 2).

    A sheet with the stiffness C becomes one with `T^T C T`.
    """
    (a, b), (c, d) = element.T
    return np.array([[a * a, b * b, a * b], [c * c, d * d, c * d], [2 * a * c, 2 * b * d, a * d + b * c]])
