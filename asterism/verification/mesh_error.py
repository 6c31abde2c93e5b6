"""The mesh error of an exact shape: from its own meshes, or from previews."""

from __future__ import annotations

from asterism.results.records.exact import ExactRecord
from asterism.results.records.mesh_limit import MeshLimitRecord
from asterism.results.records.verification import FROM_LAW, FROM_MESHES, FROM_TWO_MESHES


def verified_mesh_error(
    exact: ExactRecord, limit: MeshLimitRecord | None, same_form: bool | None
) -> tuple[float | None, str | None]:
    """The mesh error in percent of the diameter, and where it is from (`mesh_error_from`).

    Three meshes that show an order come first, then the previews, if they have the form of the exact shape, and last
    two meshes with an assumed order, which may agree and be wrong.
    """
    own = exact.mesh_error_percent
    if own is not None and exact.mesh_error_order is not None:
        return own, FROM_MESHES
    if limit is not None and same_form:
        return limit.distance_percent, FROM_LAW
    return own, None if own is None else FROM_TWO_MESHES
