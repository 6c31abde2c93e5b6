"""One set of responses from the two meshes of a cell (`arm_segments`)."""

from __future__ import annotations

from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Array

EIGENVALUE_KEYS = ("eigenvalue", "supercell_eigenvalue", "natural_eigenvalue", "natural_supercell_eigenvalue")


def blend_responses(each: list[dict[str, Any]], weights: Array) -> dict[str, Any]:
    """The weighted mean of the responses of two meshes.

    Curves are those of the mesh with the larger weight, and eigenvalues the smallest. A response that one mesh lacks is
    None; if one mesh failed, so does the cell.

    Parameters
    ----------
    each : responses of one or two meshes, see `homogenize.cell.sample.Sample`.
    weights : of the meshes; they add up to 1.
    """
    first = each[int(np.argmax(weights))]
    failed = next((response["failed"] for response in each if "failed" in response), None)
    iterations = sum(response["iterations"] for response in each)
    if failed is not None:
        return {"failed": failed, "iterations": iterations}
    out: dict[str, Any] = {}
    for name, value in first.items():
        values = [response[name] for response in each if response.get(name) is not None]
        if name.startswith("curve_"):
            out[name] = value
        elif len(values) < len(each):
            out[name] = None
        elif name in EIGENVALUE_KEYS:
            out[name] = _same_kind(value, np.min(values, axis=0))
        elif name.endswith("_error"):
            out[name] = float(np.max(values))
        else:
            out[name] = _same_kind(value, np.tensordot(weights, np.array(values), axes=1))
    return out | {"iterations": iterations}


def _same_kind(like: Any, value: Any) -> Any:
    return np.asarray(value) if isinstance(like, np.ndarray) else float(value)
